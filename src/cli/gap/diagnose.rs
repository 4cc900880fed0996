//! `lss gap diagnose`.

use super::model::Model;
use super::{apply, text};
use crate::base::json;
use crate::base::number::duration;
use crate::chain_input::Track;
use crate::cli::cases::cases;
use crate::cli::progress::Line;
use crate::cli::{MessageFormat, Outcome, OutputFormat, could_not, report};
use crate::dynamics::Width;
use crate::effects::is_of_machine;
use crate::emit::Files;
use crate::gap::chain::{Chains, Work};
use crate::gap::outside::{self, Outside};
use crate::gap::{
    Answer, ByAccuracy, Cost, Costs, Diagnosis, Left, Remembered, Settings, Simulator, Stage, diagnose_and_explain,
    diagnose_runs,
};
use crate::identify::cases::Case;
use crate::identify::study::Subject;
use crate::solve::Stop;
use crate::source::shown;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Simulations of a diagnosis that was stopped, in the folder of its outputs.
const PARTIAL: &str = "gap.partial";

/// Diagnose the gap between a campaign of measured runs and the simulation of their layouts.
///
/// Fits the nominal model to each run, maps what is left over the floor of two replicate laps, asks every effect of the
/// library whether it explains that, and tells how much of the gap each closes on runs left out. Writes gap.json and
/// gap.html. One that was stopped goes on where it was when it is started again with the same outputs' folder.
#[derive(Debug, clap::Args)]
pub struct Diagnose {
    /// Folder of a campaign, its campaign.toml, or a single data file.
    campaign: PathBuf,
    /// Folder for the outputs; created if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Layout of all runs, .lss or simulation.json, instead of those that campaign and sidecars name.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["model", "fmu"])]
    layout: Option<PathBuf>,
    #[command(flatten)]
    model: Model,
    /// Also write a layout with the verdict's effects added, for `lss simulate`.
    #[arg(long, conflicts_with_all = ["model", "fmu"])]
    apply: bool,
    /// Also print how the likeliest hypotheses came to their scores, with text as the format.
    #[arg(long)]
    explain: bool,
    /// With a program as the model, leave out the diagnoses with half and twice its accuracy.
    #[arg(long)]
    no_sweep: bool,
    /// Which noise simulations get: another seed, another answer that is as good.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How the result is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
}

/// Says which effects of the layouts take no part.
fn left_out(cases: &[Case]) {
    let sensors = |case: &Case| {
        let effects = case.subject.simulation.effects.iter().filter(|effect| !is_of_machine(effect));
        effects.map(|effect| (shown(&case.layout), effect.name.clone())).collect::<Vec<_>>()
    };
    let all: BTreeSet<(String, String)> = cases.iter().flat_map(sensors).collect();
    for (layout, effect) in all {
        report::warning(&format!(
            "effect `{effect}` of {layout} is one of sensors: it is left out, and looked for like any other"
        ));
    }
}

impl Diagnose {
    pub fn run(&self) -> Outcome {
        match self.model.command(&self.campaign) {
            Some(command) => self.outside(&command),
            None => self.chain(),
        }
    }

    /// With the chain of carts as the model.
    fn chain(&self) -> Outcome {
        let (cases, broken) = match cases(&self.campaign, self.layout.as_deref()) {
            Ok(found) => found,
            Err(outcome) => return outcome,
        };
        let Some(first) = cases.first() else {
            report::error("no run is left to diagnose");
            return Outcome::Problems;
        };
        left_out(&cases);
        let mut bar = Progress::new();
        let subjects: Vec<Subject> = cases.iter().map(|c| c.subject.clone()).collect();
        bar.say("fitting the nominal model to each run");
        let (line, fits) = (bar.line.clone(), RunsFitted::new(subjects.len()));
        let tell = |run: &str| {
            let said = fits.one_more(run);
            line.say(|| said.clone());
        };
        let (settings, origin) = (Settings::default(), self.origin(&subjects));
        let work = Work { seed: self.seed, threads: threads(), width: Width::used(), stop: Stop::NEVER };
        let mut books = Vec::new();
        let mut diagnose = |chains: &Chains, round: usize| {
            let name = if round == 1 { PARTIAL.to_owned() } else { format!("{PARTIAL}.{round}") };
            let answer = bar.diagnose(&self.remembered(chains, &origin, &name), &settings);
            books.push(self.output.join(name));
            if round == 1 {
                bar.say("fitting the runs with what was found");
                fits.begin();
                bar.costs.enter("nominal_fits", chains.effort());
            }
            answer
        };
        let (chains, mut answer) = match diagnose_runs(&subjects, &settings, work, &tell, &mut diagnose) {
            Ok(found) => found,
            Err((run, why)) => {
                bar.clear();
                report::error(&format!("{run}: {why}\n  help: leave the run out of campaign.toml"));
                return Outcome::Problems;
            }
        };
        bar.clear();
        let found = &mut answer.found;
        let mut files = Files::default();
        if self.apply {
            match apply::files(&cases, &chains, found, &self.output) {
                Ok(more) => files.extend(more),
                Err(outcome) => return outcome,
            }
        }
        // One map is drawn of runs on one layout.
        let same = subjects.iter().all(|s| s.simulation.track == first.subject.simulation.track);
        let track = same.then_some(&first.subject.simulation.track);
        self.finish(&answer, track, files, broken, &books)
    }

    /// With a program outside as the model.
    fn outside(&self, command: &str) -> Outcome {
        let mut bar = Progress::new();
        bar.say("fitting the program's model to each run");
        let settings = self.model.settings();
        let (model, mut answer, books) = match self.until_the_noise_stays(command, &settings, &mut bar) {
            Ok(found) => found,
            Err(error) => {
                bar.clear();
                report::error(&format!("{error}\n  help: {}", error.help()));
                return Outcome::Problems;
            }
        };
        let found = &mut answer.found;
        let mut beside = model.told(found);
        if !self.no_sweep && model.hangs_on_accuracy() {
            bar.say("diagnosing with other accuracies");
            match by_accuracy(&model, found, &settings) {
                Ok(rows) => beside.by_accuracy = rows,
                Err(error) => report::warning(&format!("other accuracies could not be tried: {error}")),
            }
        }
        bar.clear();
        found.outside = Some(beside);
        found.lost.extend(model.lost());
        found.overlays.iter_mut().for_each(|o| o.unit = model.channels().get(&o.channel).cloned().unwrap_or_default());
        found.lost.iter().filter(|lost| !lost.effect.is_empty()).for_each(|lost| report::warning(&lost.to_string()));
        // Without an effect that might be the cause the answer is not complete.
        let incomplete = !found.untested().is_empty();
        self.finish(&answer, None, Files::default(), incomplete, &books)
    }

    /// Diagnoses, finds the noise again by what the best hypothesis leaves, and diagnoses again, until it stays. Also
    /// the files of what was simulated.
    fn until_the_noise_stays(
        &self,
        command: &str,
        settings: &outside::Settings,
        bar: &mut Progress,
    ) -> Result<(Outside, Answer, Vec<PathBuf>), outside::Error> {
        let mut model = Outside::open(command, &self.campaign, settings)?;
        let mut books = Vec::new();
        let rounds = settings.constants.outside.noise.rounds.max(1);
        bar.expected = Some(model.questions());
        loop {
            let round = books.len() + 1;
            let name = if round == 1 { PARTIAL.to_owned() } else { format!("{PARTIAL}.{round}") };
            let answer = bar.diagnose(&self.remembered(&model, &model.origin(), &name), &settings.constants);
            books.push(self.output.join(name));
            match if round < rounds { model.anew(&answer.found)? } else { None } {
                Some(next) => model = next,
                None => return Ok((model, answer, books)),
            }
        }
    }

    /// A model with what a stopped diagnosis left.
    fn remembered<'a>(&self, model: &'a dyn Simulator, origin: &str, name: &str) -> Remembered<'a> {
        let known = Remembered::new(model, &self.output.join(name), origin, &Settings::default().checks);
        match known.left() {
            Left::Nothing => {}
            Left::Used(count) => {
                report::note(&format!("a diagnosis was stopped here: {count} of its simulations are used again"));
            }
            Left::OfOthers => report::note(
                "a diagnosis was stopped here, but of another version of lss, model, layout, run or seed: nothing of \
                 it is used",
            ),
            Left::Contradicted(count) => report::warning(&format!(
                "a diagnosis was stopped here, but asked again the model gives another answer: its {count} simulations \
                 are not used"
            )),
        }
        known
    }

    /// All that simulations of the chain come from.
    fn origin(&self, subjects: &[Subject]) -> String {
        let each: Vec<String> = subjects.iter().map(Subject::content).collect();
        format!("{} {} {}", crate::base::program(), self.seed, each.join(" "))
    }

    /// Writes and prints what was found.
    fn finish(
        &self,
        answer: &Answer,
        track: Option<&Track>,
        mut files: Files,
        broken: bool,
        books: &[PathBuf],
    ) -> Outcome {
        let Answer { found, explained, cost } = answer;
        let title = self.campaign.file_name().map_or_else(|| "campaign".into(), |n| n.to_string_lossy().into_owned());
        files.push("gap.json", json::to_json(found));
        files.push("gap.html", crate::report::gap::page(found, track, &title));
        if let Err(error) = files.write_set(&self.output, "gap") {
            return could_not("write", &error.path, &error.reason);
        }
        // What is written needs no simulations any more.
        books.iter().for_each(|book| Remembered::forget(book));
        report::print(&match self.format {
            OutputFormat::Json => with_cost(found, cost),
            OutputFormat::Text => {
                let explained =
                    if self.explain { text::explained(explained) + &text::costs(cost) } else { String::new() };
                format!("{}{explained}written to {}\n", text::text(found), shown(&self.output))
            }
        });
        if broken { Outcome::Problems } else { Outcome::Clean }
    }
}

/// The diagnosis with other accuracies of the model, and with its own among them; nothing where all say the same.
fn by_accuracy(
    model: &Outside,
    found: &Diagnosis,
    settings: &outside::Settings,
) -> Result<Vec<ByAccuracy>, outside::Error> {
    let row = |model: &Outside, found: &Diagnosis| ByAccuracy {
        accuracy: model.accuracies(),
        verdict: found.verdict,
        effects: found.effects.iter().take(3).map(|e| (e.name.clone(), e.probability)).collect(),
        none_probability: found.none_probability,
        unknown_probability: found.unknown_probability,
    };
    let same = |other: &Diagnosis| other.verdict == found.verdict && other.shown == found.shown;
    let (mut rows, mut hangs) = (vec![(1.0, row(model, found))], false);
    for factor in settings.constants.outside.noise.accuracies {
        let other = model.with_accuracy(factor)?;
        let answer = diagnose_and_explain(&other, &settings.constants, &mut |_| {}).0;
        hangs |= !same(&answer);
        rows.push((factor, row(&other, &answer)));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(if hangs { rows.into_iter().map(|(_, row)| row).collect() } else { Vec::new() })
}

/// A diagnosis in JSON, and what it cost: the time on the wall is in no file, as files are the same every time.
fn with_cost(found: &Diagnosis, cost: &Cost) -> String {
    let mut value = serde_json::to_value(found).unwrap_or_default();
    if let (Some(fields), Ok(cost)) = (value.as_object_mut(), serde_json::to_value(cost)) {
        fields.insert("cost".to_owned(), cost);
    }
    value.to_string() + "\n"
}

fn threads() -> usize {
    crate::cli::limits::threads()
}

/// How far a pass of fits is: one of each run.
struct RunsFitted {
    of: usize,
    /// When the pass began, and how many runs are fitted.
    state: Mutex<(Instant, usize)>,
}

impl RunsFitted {
    fn new(of: usize) -> Self {
        RunsFitted { of, state: Mutex::new((Instant::now(), 0)) }
    }

    /// A pass begins.
    fn begin(&self) {
        *self.state.lock().unwrap_or_else(PoisonError::into_inner) = (Instant::now(), 0);
    }

    /// One more run is fitted; in words, with the time that is left of the pass. The last one begins another.
    fn one_more(&self, run: &str) -> String {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let (begin, done) = (state.0, state.1 + 1);
        let left = match self.of.saturating_sub(done) {
            0 => String::new(),
            more => {
                let seconds = begin.elapsed().as_secs_f64() / done as f64 * more as f64;
                format!(", about {} left of this step", duration(seconds))
            }
        };
        *state = if done >= self.of { (Instant::now(), 0) } else { (begin, done) };
        format!("fitted {run}, {done} of {} runs{left}", self.of)
    }
}

/// How far a diagnosis is, and what it costs.
struct Progress {
    line: Arc<Line>,
    costs: Costs,
    begin: Instant,
    /// Simulations that are thought to be needed, where that is known.
    expected: Option<u64>,
    /// The stage that is counted, and when it began.
    stage: (&'static str, Instant),
}

impl Progress {
    fn new() -> Self {
        let begin = Instant::now();
        let line = Arc::new(Line::open(MessageFormat::Text));
        Progress { line, costs: Costs::new("nominal_fits"), begin, expected: None, stage: ("", begin) }
    }

    fn say(&self, what: &str) {
        self.line.say(|| what.to_owned());
    }

    fn clear(&self) {
        self.line.finish();
    }

    /// What is left of the time: of all, where the number of simulations is known, else of a stage whose steps are.
    fn left(&mut self, stage: &Stage, simulations: u64) -> String {
        if self.stage.0 != stage.name() {
            self.stage = (stage.name(), Instant::now());
        }
        let about = |seconds: f64, of: &str| format!(", about {} left{of}", duration(seconds));
        match (self.expected, stage) {
            (Some(expected), _) if simulations > 0 && expected > simulations => {
                let each = self.begin.elapsed().as_secs_f64() / simulations as f64;
                about(each * (expected - simulations) as f64, "")
            }
            (None, Stage::Screening { done, of } | Stage::Relinearising { done, of }) if *done > 0 && done < of => {
                let since = self.stage.1.elapsed().as_secs_f64();
                // What has only begun tells nothing, nor what was known before.
                if since < 1.0 {
                    String::new()
                } else {
                    about(since / *done as f64 * (of - done) as f64, " of this step")
                }
            }
            _ => String::new(),
        }
    }

    fn diagnose(&mut self, model: &dyn Simulator, settings: &Settings) -> Answer {
        let mut costs = self.costs.clone();
        // A diagnosis may come again.
        costs.enter("nominal_fits", model.effort());
        let (found, explained) = diagnose_and_explain(model, settings, &mut |stage| {
            costs.enter(stage.name(), model.effort());
            let left = self.left(&stage, model.effort().simulations);
            match stage {
                Stage::Screening { done, of } => {
                    self.say(&format!("screening effects: {done} of {of} strengths{left}"))
                }
                Stage::Relinearising { done, of } => {
                    self.say(&format!("looking again: {done} of {of} strengths{left}"))
                }
                Stage::Fitting { done, of } => {
                    self.say(&format!("fitting what is left: round {} of {of}{left}", done + 1))
                }
                Stage::Replicating => self.say("simulating replicates"),
                Stage::ByChance => self.say("trying differences by chance"),
            }
        });
        self.clear();
        self.costs = costs.clone();
        Answer { found, explained, cost: costs.finish(model.effort()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pass_of_fits_is_counted_anew() {
        let fits = RunsFitted::new(2);
        for _ in 0..2 {
            assert!(fits.one_more("a").starts_with("fitted a, 1 of 2 runs, about "));
            assert_eq!(fits.one_more("b"), "fitted b, 2 of 2 runs");
        }
        fits.one_more("a");
        fits.begin();
        assert!(fits.one_more("b").starts_with("fitted b, 1 of 2 runs"));
    }
}
