//! A study on a cluster with Slurm: job arrays whose jobs take about a minute, and what is known of them.
//!
//! An array is a script and a list beside it, a line of tasks for each job. A job calls `lss study task`, which skips
//! what is done and waits for what somebody else is at. So a job may be started as often as Slurm likes: again after its
//! node died (`--requeue`), or twice.

use super::place::Place;
use crate::base::json::to_json;
use crate::source::disk::Files;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of scripts in that of a study.
const FOLDER: &str = "slurm";

/// What a script asks of the cluster.
#[derive(Clone, Debug, Default)]
pub struct Wishes {
    pub partition: Option<String>,
    pub account: Option<String>,
    /// Limit of time of a job, in Slurm's words.
    pub time: Option<String>,
    /// Memory of a job, in Slurm's words.
    pub memory: Option<String>,
    /// Processors of a job, and threads of a task.
    pub cpus: usize,
    /// Further options of sbatch.
    pub more: Vec<String>,
}

/// Tasks in groups that take about so long, in their order. A task that takes longer is alone.
pub fn chunks<'a>(tasks: &[(&'a str, f64)], seconds: f64) -> Vec<Vec<&'a str>> {
    let mut all: Vec<Vec<&str>> = Vec::new();
    let mut filled = f64::INFINITY;
    for (hash, takes) in tasks {
        // Half of a task may stand over, so that groups are as long as asked for on average.
        if filled + takes / 2.0 > seconds || filled.is_infinite() {
            all.push(Vec::new());
            filled = 0.0;
        }
        filled += takes;
        if let Some(last) = all.last_mut() {
            last.push(hash);
        }
    }
    all
}

/// An array that was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    pub script: PathBuf,
    pub jobs: usize,
    number: usize,
}

/// `array-N.json`: an array that Slurm has.
#[derive(Serialize, Deserialize)]
struct Submitted {
    job: String,
    jobs: Vec<Vec<String>>,
}

/// The study's arrays.
pub struct Arrays<'a> {
    pub place: &'a Place,
    /// This program.
    pub program: &'a Path,
}

impl Arrays<'_> {
    fn folder(&self) -> PathBuf {
        self.place.folder().join(FOLDER)
    }

    fn numbers(&self, ending: &str) -> BTreeSet<usize> {
        let entries = std::fs::read_dir(self.folder()).into_iter().flatten().filter_map(Result::ok);
        let number = |name: &str| name.strip_prefix("array-")?.strip_suffix(ending)?.parse().ok();
        entries.filter_map(|entry| number(&entry.file_name().to_string_lossy())).collect()
    }

    /// Writes scripts for jobs, so many to an array at most.
    ///
    /// # Errors
    ///
    /// In words: a file that cannot be written, a word that a script cannot hold.
    pub fn write(&self, jobs: &[Vec<&str>], most: usize, wishes: &Wishes) -> Result<Vec<Array>, String> {
        let first = self.numbers(".sh").last().map_or(1, |last| last + 1);
        let mut arrays = Vec::new();
        for (k, part) in jobs.chunks(most.max(1)).enumerate() {
            let number = first + k;
            let lines: String = part.iter().map(|hashes| hashes.join(" ") + "\n").collect();
            let mut files = Files::default();
            files.push(format!("array-{number}.txt"), lines);
            files.push(format!("array-{number}.sh"), self.script(number, part.len(), wishes)?);
            files.write(&self.folder()).map_err(|why| why.to_string())?;
            arrays.push(Array { script: self.folder().join(format!("array-{number}.sh")), jobs: part.len(), number });
        }
        Ok(arrays)
    }

    fn script(&self, number: usize, jobs: usize, wishes: &Wishes) -> Result<String, String> {
        let folder = self.folder();
        let [log, list] = ["-%a.log", ".txt"].map(|end| folder.join(format!("array-{number}{end}")));
        let mut script = "#!/bin/sh\n".to_owned();
        let mut line = |text: String| -> Result<(), String> {
            if text.contains(|c: char| c.is_control() || c == '"') {
                return Err(format!(
                    "`{text}` cannot stand in a script for Slurm: it holds quotes or control characters"
                ));
            }
            script += &format!("#SBATCH {}\n", quoted_value(&text));
            Ok(())
        };
        line("--job-name=lss-study".into())?;
        line(format!("--array=0-{}", jobs.saturating_sub(1)))?;
        line("--requeue".into())?;
        line("--open-mode=append".into())?;
        line(format!("--output={}", log.to_string_lossy()))?;
        line("--ntasks=1".into())?;
        line(format!("--cpus-per-task={}", wishes.cpus.max(1)))?;
        for (name, value) in [
            ("partition", &wishes.partition),
            ("account", &wishes.account),
            ("time", &wishes.time),
            ("mem", &wishes.memory),
        ] {
            if let Some(value) = value {
                line(format!("--{name}={value}"))?;
            }
        }
        wishes.more.iter().try_for_each(|more| line(more.clone()))?;
        let [program, out, list] = [self.program, self.place.folder(), list.as_path()].map(in_shell);
        script += &format!(
            "# The tasks of this job: a line of the list.\n\
             tasks=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" {list})\n\
             exec {program} study task --threads={} -o {out} $tasks\n",
            wishes.cpus.max(1)
        );
        Ok(script)
    }

    /// Hands an array to Slurm. Returns the job's number.
    ///
    /// # Errors
    ///
    /// In words, what sbatch says.
    pub fn submit(&self, array: &Array) -> Result<String, String> {
        let mut sbatch = Command::new("sbatch");
        let output = sbatch.args(["--parsable", "--requeue"]).arg(&array.script).stdin(Stdio::null()).output();
        let output = output.map_err(|why| match why.kind() {
            io::ErrorKind::NotFound => "sbatch is not there: submit from a host of the cluster".to_owned(),
            _ => format!("sbatch: {why}"),
        })?;
        if !output.status.success() {
            return Err(format!("sbatch: {}", String::from_utf8_lossy(&output.stderr).trim()));
        }
        let printed = String::from_utf8_lossy(&output.stdout);
        // `123` or `123;cluster`
        let job = printed.trim().split(';').next().unwrap_or_default().to_owned();
        if job.is_empty() || !job.bytes().all(|b| b.is_ascii_digit()) {
            return Err(format!("sbatch answered `{}`", printed.trim()));
        }
        let list = std::fs::read_to_string(array.script.with_extension("txt")).map_err(|why| why.to_string())?;
        let jobs = list.lines().map(|line| line.split(' ').map(str::to_owned).collect()).collect();
        let mut files = Files::default();
        files.push(format!("array-{}.json", array.number), to_json(&Submitted { job: job.clone(), jobs }));
        files.write(&self.folder()).map_err(|why| why.to_string())?;
        Ok(job)
    }

    fn submitted(&self) -> Vec<Submitted> {
        let read = |number: usize| {
            let bytes = std::fs::read(self.folder().join(format!("array-{number}.json"))).ok()?;
            let known: Submitted = serde_json::from_slice(&bytes).ok()?;
            known.job.bytes().all(|b| b.is_ascii_digit()).then_some(known)
        };
        self.numbers(".json").into_iter().filter_map(read).collect()
    }

    /// What Slurm still has of this study's arrays; `None` where there are none, or no Slurm here.
    pub fn queued(&self) -> Option<Queue> {
        let mut queue = Queue::default();
        let submitted = self.submitted();
        if submitted.is_empty() {
            return None;
        }
        for known in submitted {
            let mut squeue = Command::new("squeue");
            squeue.args(["--noheader", "--array", "--format=%K %T", &format!("--jobs={}", known.job)]);
            let output = squeue.stdin(Stdio::null()).output().ok()?;
            // A job that ended long ago is not known any more.
            for line in String::from_utf8_lossy(&output.stdout).lines() {
                let mut words = line.split_whitespace();
                let (Some(index), Some(state)) = (words.next(), words.next()) else { continue };
                match state {
                    "RUNNING" | "COMPLETING" | "CONFIGURING" => queue.running += 1,
                    _ => queue.waiting += 1,
                }
                let tasks = index.parse::<usize>().ok().and_then(|index| known.jobs.get(index));
                queue.tasks.extend(tasks.into_iter().flatten().cloned());
            }
        }
        Some(queue)
    }
}

/// What Slurm has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Queue {
    /// Jobs.
    pub running: usize,
    pub waiting: usize,
    /// Hashes of the tasks in them.
    pub tasks: BTreeSet<String>,
}

/// `--output="a b"`: sbatch takes quotes around a value.
fn quoted_value(option: &str) -> String {
    match option.split_once('=') {
        Some((name, value)) if value.contains(char::is_whitespace) => format!("{name}=\"{value}\""),
        _ => option.to_owned(),
    }
}

/// A path as one word of a shell.
fn in_shell(path: &Path) -> String {
    let text = path.to_string_lossy();
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    if text.chars().all(plain) { text.into_owned() } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_take_about_as_long_as_asked_for() {
        let tasks: Vec<(String, f64)> = (0..100).map(|k| (format!("{k:016x}"), 7.0 + f64::from(k % 5))).collect();
        let tasks: Vec<(&str, f64)> = tasks.iter().map(|(hash, s)| (hash.as_str(), *s)).collect();
        let chunks = chunks(&tasks, 60.0);
        assert_eq!(chunks.concat(), tasks.iter().map(|(hash, _)| *hash).collect::<Vec<_>>(), "each once, in order");
        let total = |chunk: &Vec<&str>| -> f64 {
            tasks.iter().filter(|(hash, _)| chunk.contains(hash)).map(|(_, seconds)| seconds).sum()
        };
        for chunk in &chunks[..chunks.len() - 1] {
            assert!((50.0..70.0).contains(&total(chunk)), "{}", total(chunk));
        }
        assert_eq!(super::chunks(&[("a", 500.0), ("b", 1.0), ("c", 300.0)], 60.0), [vec!["a"], vec!["b"], vec!["c"]]);
        assert!(super::chunks(&[], 60.0).is_empty());
    }

    #[test]
    fn a_script_calls_the_tasks_of_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let place = Place::new(&folder.path().join("it's out"), false).unwrap();
        let arrays = Arrays { place: &place, program: Path::new("/opt/lss") };
        let wishes = Wishes { partition: Some("short".into()), cpus: 2, ..Wishes::default() };
        let written = arrays.write(&[vec!["a", "b"], vec!["c"], vec!["d"]], 2, &wishes).unwrap();
        assert_eq!(written.iter().map(|a| a.jobs).collect::<Vec<_>>(), [2, 1]);
        let at = place.folder().to_string_lossy().into_owned();
        let script = std::fs::read_to_string(&written[0].script).unwrap().replace(&at, "OUT");
        insta::assert_snapshot!(script.replace(&at.replace('\'', r"'\''"), "OUT"), @r#"
        #!/bin/sh
        #SBATCH --job-name=lss-study
        #SBATCH --array=0-1
        #SBATCH --requeue
        #SBATCH --open-mode=append
        #SBATCH --output="OUT/slurm/array-1-%a.log"
        #SBATCH --ntasks=1
        #SBATCH --cpus-per-task=2
        #SBATCH --partition=short
        # The tasks of this job: a line of the list.
        tasks=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" 'OUT/slurm/array-1.txt')
        exec /opt/lss study task --threads=2 -o 'OUT' $tasks
        "#);
        assert_eq!(std::fs::read_to_string(written[0].script.with_extension("txt")).unwrap(), "a b\nc\n");
        // The next ones do not replace these.
        assert!(arrays.write(&[vec!["e"]], 2, &wishes).unwrap()[0].script.ends_with("slurm/array-3.sh"));
        let odd = Wishes { account: Some("a\n#SBATCH --wrap=x".into()), ..wishes };
        assert!(arrays.write(&[vec!["e"]], 2, &odd).is_err());
    }
}
