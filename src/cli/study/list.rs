//! `lss study plan`: what there is to do.

use super::{Builds, planned, tasks};
use crate::base::number::duration;
use crate::cli::{MessageFormat, Outcome, OutputFormat, could_not, limits, report};
use crate::study::{Place, Plan, State, Task};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// List the tasks of a study.
///
/// With the folder of the results it says which of them are done, and how long the others will take.
#[derive(Debug, clap::Args)]
pub struct List {
    /// The study, study.toml.
    study: PathBuf,
    /// Folder of the results; the plan is kept there, for `lss study task`.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    builds: Builds,
    /// How the list is written to standard output: json is one object a line, a task each.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
    /// How diagnostics are written to standard error.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
}

#[derive(Serialize)]
struct Line<'a> {
    hash: &'a str,
    sweep: &'a str,
    state: &'static str,
    parameters: BTreeMap<&'a str, &'a str>,
    steps: Vec<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    estimated_s: Option<f64>,
}

impl List {
    pub fn run(&self) -> Outcome {
        let plan = match planned(&self.study, self.message_format) {
            Ok(plan) => plan,
            Err(outcome) => return outcome,
        };
        let place = match self.output.as_ref().map(|out| self.builds.place(out)).transpose() {
            Ok(place) => place,
            Err(outcome) => return outcome,
        };
        if let Some(place) = &place
            && let Err(error) = place.keep_plan(&plan)
        {
            return could_not("write", &error.path, &error.reason);
        }
        let known = Known::new(&plan, place.as_ref());
        report::print(&match self.format {
            OutputFormat::Text => known.text(&plan, limits::threads()),
            OutputFormat::Json => plan.tasks.iter().map(|task| known.json(task)).collect(),
        });
        Outcome::Clean
    }
}

/// What is known of each task.
pub struct Known {
    states: BTreeMap<String, State>,
    seconds: BTreeMap<String, f64>,
    /// Of a sweep, how long its tasks took on average.
    means: BTreeMap<String, f64>,
    others: usize,
}

impl Known {
    pub fn new(plan: &Plan, place: Option<&Place>) -> Known {
        let mut known = Known { states: BTreeMap::new(), seconds: BTreeMap::new(), means: BTreeMap::new(), others: 0 };
        let mut sums: BTreeMap<String, (f64, f64)> = BTreeMap::new();
        for task in plan.unique() {
            let state = place.map_or(State::Open, |place| place.state(&task.hash));
            known.states.insert(task.hash.clone(), state);
            known.others += usize::from(place.is_some_and(|place| place.is_of_another_build(&task.hash)));
            // A result of another build took about as long.
            if let Some(seconds) = place.and_then(|place| place.seconds(&task.hash)) {
                let sum = sums.entry(task.sweep.clone()).or_default();
                *sum = (sum.0 + seconds, sum.1 + 1.0);
                if state == State::Done {
                    known.seconds.insert(task.hash.clone(), seconds);
                }
            }
        }
        known.means = sums.into_iter().map(|(sweep, (sum, count))| (sweep, sum / count)).collect();
        known
    }

    pub fn state(&self, task: &Task) -> State {
        self.states.get(&task.hash).copied().unwrap_or(State::Open)
    }

    pub fn count(&self, state: State) -> usize {
        self.states.values().filter(|s| **s == state).count()
    }

    /// How long a task will take, as far as others of its sweep tell.
    pub fn estimate(&self, task: &Task) -> Option<f64> {
        self.means.get(&task.sweep).copied()
    }

    /// `12 done, 1 failed, 27 open`
    pub fn counts(&self) -> String {
        let all = [State::Done, State::Failed, State::Claimed, State::Open];
        let said: Vec<String> = all
            .into_iter()
            .filter(|state| self.count(*state) > 0)
            .map(|state| format!("{} {}", self.count(state), state.name()))
            .collect();
        said.join(", ")
    }

    /// Where results do not count as another build found them.
    pub fn note(&self) -> Option<String> {
        (self.others > 0).then(|| {
            format!(
                "{} done by another build of lss, which may answer otherwise: done again, unless --any-build is given",
                if self.others == 1 { "1 task was".to_owned() } else { format!("{} tasks were", self.others) }
            )
        })
    }

    /// What is left, in words, where it can be told.
    pub fn left(&self, plan: &Plan, cores: usize) -> Option<String> {
        let left: Vec<Option<f64>> = plan
            .unique()
            .into_iter()
            .filter(|task| matches!(self.state(task), State::Open | State::Claimed))
            .map(|task| self.estimate(task))
            .collect();
        let known: Vec<f64> = left.iter().copied().flatten().collect();
        if known.is_empty() || known.len() < left.len() {
            return None;
        }
        let on = if cores == 1 { "one core".to_owned() } else { format!("{cores} cores") };
        Some(format!("about {} left on {on}", duration(known.iter().sum::<f64>() / cores.min(known.len()) as f64)))
    }

    fn text(&self, plan: &Plan, cores: usize) -> String {
        let mut out = format!("{}: {}", plan.name, tasks(plan.unique().len()));
        if plan.tasks.len() > plan.unique().len() {
            out += &format!(" for {} rows", plan.tasks.len());
        }
        out += &format!(", {}", self.counts());
        if let Some(left) = self.left(plan, cores) {
            out += &format!(", {left}");
        }
        out += "\n";
        out += &self.note().map_or_else(String::new, |note| format!("  {note}\n"));
        let several = plan.tasks.iter().any(|task| task.sweep != plan.tasks[0].sweep);
        let varies = varying(plan);
        out += &format!("\n  {:<16}  {:<7} {:>7}  parameters\n", "task", "state", "s");
        for task in &plan.tasks {
            let seconds = match (self.seconds.get(&task.hash), self.estimate(task)) {
                (Some(seconds), _) => crate::base::number::fixed(*seconds, 1),
                (None, Some(about)) => format!("~{}", crate::base::number::fixed(about, 1)),
                (None, None) => String::new(),
            };
            let shown = |key: &str| varies.get(task.sweep.as_str()).is_some_and(|keys| keys.contains(key));
            let words: Vec<String> = task
                .parameters
                .iter()
                .filter(|(key, _)| shown(key))
                .map(|(key, value)| format!("{key}={value}"))
                .collect();
            let sweep = if several { format!("{}: ", task.sweep) } else { String::new() };
            let state = self.state(task).name();
            out += format!("  {}  {state:<7} {seconds:>7}  {sweep}{}", task.hash, words.join("  ")).trim_end();
            out += "\n";
        }
        out
    }

    fn json(&self, task: &Task) -> String {
        let state = self.state(task);
        let line = Line {
            hash: &task.hash,
            sweep: &task.sweep,
            state: state.name(),
            parameters: task.parameters.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect(),
            steps: task.steps.iter().map(|step| step.verb.name()).collect(),
            seconds: self.seconds.get(&task.hash).copied(),
            estimated_s: self.estimate(task).filter(|_| state != State::Done),
        };
        serde_json::to_string(&line).unwrap_or_default() + "\n"
    }
}

/// Of each sweep, the parameters that are not the same in all of its tasks.
fn varying(plan: &Plan) -> BTreeMap<&str, BTreeSet<&str>> {
    let mut seen: BTreeMap<(&str, &str), BTreeSet<&str>> = BTreeMap::new();
    for task in &plan.tasks {
        for (key, value) in &task.parameters {
            seen.entry((&task.sweep, key)).or_default().insert(value);
        }
    }
    let mut out: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for ((sweep, key), _) in seen.into_iter().filter(|(_, values)| values.len() > 1) {
        out.entry(sweep).or_default().insert(key);
    }
    out
}
