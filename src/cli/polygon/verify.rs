//! `lss polygon FILE --verify`: the layout before and after, run in the dynamic model.

use super::Polygon;
use crate::base::json;
use crate::chain_input::Simulation;
use crate::cli::{Outcome, OutputFormat, could_not, limits, read, report};
use crate::compiled::Compiled;
use crate::diagnostic::Diagnostic;
use crate::dynamics::{End, Plan, Width};
use crate::effects;
use crate::emit::{Files, stages_png, stages_svg};
use crate::kinematics::polygon::PolygonObjective;
use crate::model::{Goal, Layout};
use crate::report::polygon::{Case, Names, PolygonReport, Values, Verification, case_name, verify_page, verify_text};
use crate::solve::polygon::{Smooth, solve};
use crate::solve::{Options, Stage, Status, diagnose, discretise, unsupported};

/// Budget of length where the layout asks for the shortest track.
const BUDGET: f64 = 0.005;

/// A layout to run.
struct Subject {
    name: &'static str,
    compiled: Compiled,
    simulation: Simulation,
}

impl Polygon {
    pub(super) fn verify(&self) -> Outcome {
        if read::is_json(&self.file) {
            report::error("--verify optimises the layout, and a simulation input has no vertices: give the .lss");
            return Outcome::CouldNotRun;
        }
        let read = match read::read(&self.file, self.layout.as_deref(), self.message_format) {
            Ok(read) => read,
            Err(outcome) => return outcome,
        };
        let layout = smooth(&read.layout);
        let mut said = read.said;
        said.extend(unsupported(&layout));
        if said.iter().any(Diagnostic::is_error) {
            return read::tell(&read.sources, &said, self.message_format);
        }
        let subjects = match subjects(&layout) {
            Ok(subjects) => subjects,
            Err(stages) => {
                said.extend(diagnose(&layout, &stages));
                return read::tell(&read.sources, &said, self.message_format);
            }
        };
        if read::tell(&read.sources, &said, self.message_format) != Outcome::Clean {
            return Outcome::Problems;
        }
        self.compare(&subjects)
    }

    fn compare(&self, subjects: &[Subject]) -> Outcome {
        let threads = limits::threads();
        let inputs: Vec<(Simulation, Plan)> =
            subjects.iter().map(|s| (s.simulation.clone(), Plan::default())).collect();
        let mut laps = Vec::new();
        for (subject, outcome) in subjects.iter().zip(effects::simulate_all(&inputs, Width::used(), threads)) {
            match outcome {
                Ok(lap) if lap.end == End::Complete => laps.push(lap),
                Ok(lap) => {
                    let why = if let End::Trouble(trouble) = &lap.end { trouble.to_string() } else { String::new() };
                    report::error(&format!("the simulation of `{}` stopped: {why}", subject.name));
                    return Outcome::Problems;
                }
                Err(unfit) => {
                    report::error(&format!("{unfit}"));
                    return Outcome::Problems;
                }
            }
        }
        let mut cases = Vec::new();
        for (subject, lap) in subjects.iter().zip(&laps) {
            let simulation = &subject.simulation;
            let values = match values(subject) {
                Ok(values) => values,
                Err(why) => return self.unsuited(why),
            };
            let (left, speed) = (simulation.chain.left_over_m, simulation.chain.speed_m_s);
            cases.push(Case::new(subject.name, lap, left, values, speed));
        }
        let Some(before) = subjects.first() else { return Outcome::Problems };
        let verification = Verification::new(&before.simulation.name, cases);
        if let Some(folder) = &self.output {
            let runs: Vec<_> = subjects.iter().map(|s| &s.simulation).zip(laps.iter().map(|lap| &lap.run)).collect();
            let mut files = Files::default();
            files.push("verify.json", json::to_json(&verification));
            files.push("verify.html", verify_page(&verification, &runs));
            let drawn = overlaid(before, subjects);
            let written = before.compiled.layout.corners();
            let start = before.compiled.stages.last().map_or(written, |s| s.corners.clone());
            match (stages_svg(&drawn, &start), stages_png(&drawn, &start)) {
                (Ok(svg), Ok(png)) => {
                    files.push("verify.svg", svg);
                    files.push("verify.png", png);
                }
                (Err(why), _) | (_, Err(why)) => return could_not("draw", &self.file, why),
            }
            if let Err(error) = files.write_set(folder, "polygon-verify") {
                return could_not("write", &error.path, &error.reason);
            }
        }
        report::print(&match self.format {
            OutputFormat::Json => serde_json::to_string(&verification).unwrap_or_default() + "\n",
            OutputFormat::Text => verify_text(&verification) + &report::written_to(self.output.as_deref()),
        });
        Outcome::Clean
    }
}

/// The layout as one that asks for an even run: within a budget where it asks for the shortest, near what is written
/// where it asks for nothing.
fn smooth(layout: &Layout) -> Layout {
    let mut layout = layout.clone();
    if Smooth::of(&layout.objective).is_none() {
        let short = layout.objective.terms.iter().any(|(_, goal)| *goal == Goal::Length);
        layout.objective.terms = vec![(1.0, Goal::PolygonAction)];
        layout.objective.within = short.then_some((Goal::Length, BUDGET));
    }
    layout
}

/// The base, and a layout for each objective; the stages of a solve that failed.
fn subjects(layout: &Layout) -> Result<Vec<Subject>, Vec<Stage>> {
    let threads = limits::threads();
    let options = Options { threads, stop: limits::stop(), ..Options::default() };
    let subject = |name: &'static str, stages: Vec<Stage>| {
        let compiled = Compiled::new(layout.clone(), stages);
        Subject { name, simulation: Simulation::new(&compiled), compiled }
    };
    let mut found: Vec<Subject> = Vec::new();
    for counted in PolygonObjective::EACH {
        let Some(goal) = Smooth::of(&layout.objective) else { continue };
        let mut stages = solve(layout, Smooth { counted, ..goal }, &options, discretise, &|_| ());
        if stages.last().is_none_or(|s| s.status == Status::Infeasible) {
            return Err(stages);
        }
        let last = stages.pop();
        if found.is_empty() {
            found.push(subject(case_name(None), stages.clone()));
        }
        stages.extend(last);
        found.push(subject(case_name(Some(counted)), stages));
    }
    Ok(found)
}

fn values(subject: &Subject) -> Result<Values, crate::kinematics::polygon::Unsuited> {
    let simulation = &subject.simulation;
    let line = simulation.track.centre_line();
    let names = Names::of(&subject.compiled);
    let report = PolygonReport::new(&simulation.name, &line, simulation.chain.pitch_m, PolygonObjective::All, &names)?;
    Ok(report.values)
}

/// The optimised layouts as stages of one drawing.
fn overlaid(before: &Subject, subjects: &[Subject]) -> Compiled {
    let stages: Vec<Stage> = subjects
        .iter()
        .skip(1)
        .filter_map(|s| s.compiled.stages.last().map(|stage| Stage { name: s.name, ..stage.clone() }))
        .collect();
    Compiled::new(before.compiled.layout.clone(), stages)
}
