//! A dry run: what a model is asked at first, whether its answers can be used, and what a diagnosis would cost.

use super::data::RunPart;
use super::fit::{left, share};
use super::protocol::Description;
use super::told::root_mean_square;
use super::{Error, Outside, Rows, Settings};
use crate::base::number::{duration, fixed, significant};
use crate::gap::Applied;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

/// What a dry run found.
pub struct Dry {
    /// For people.
    pub text: String,
    /// What should be changed before a diagnosis.
    pub warnings: Vec<String>,
}

/// Asks a model for what a diagnosis begins with.
///
/// # Errors
///
/// As [`Outside::open`], without fits.
pub fn check(command: &str, campaign: &Path, settings: &Settings) -> Result<Dry, Error> {
    let (outside, parts) = Outside::begun(command, campaign, settings)?;
    let mut dry = Dry { text: String::new(), warnings: Vec::new() };
    outside.described(&mut dry);
    let Some(first) = parts.first() else { return Ok(dry) };
    let start = outside.nominal_start();
    let mut slowest = 0.0_f64;
    let mut rows = Vec::new();
    for part in &parts {
        let begin = Instant::now();
        let answer = outside.ask(part, &start, &[]).map_err(|error| error.in_run(&part.name))?;
        let wall = begin.elapsed().as_secs_f64();
        slowest = slowest.max(wall);
        outside.is_the_same(part, &start, &answer)?;
        outside.run_told(part, &answer, wall, &mut dry);
        rows.push(answer);
    }
    let mut asked = 2 * parts.len();
    if let Some(nominal) = rows.first() {
        asked += outside.bounds_told(first, &start, nominal, &mut dry);
    }
    let questions = outside.questions_of(parts.len());
    let minutes = questions as f64 * slowest / outside.pool.most() as f64 / 60.0;
    let _ = writeln!(
        dry.text,
        "\n  asked {asked} questions; a diagnosis asks about {questions}, which takes about {} with {} processes",
        duration(60.0 * minutes),
        outside.pool.most()
    );
    Ok(dry)
}

impl Outside {
    /// Where the nuisances begin.
    pub(super) fn nominal_start(&self) -> Vec<f64> {
        self.description.nuisances.iter().map(|n| share(n, n.nominal)).collect()
    }

    /// Questions that a diagnosis of so many runs asks, from what it is made of; those of the benchmark came within a
    /// factor of 1.7.
    pub fn questions(&self) -> u64 {
        self.questions_of(self.parts.len())
    }

    fn questions_of(&self, runs: usize) -> u64 {
        let constants = &self.settings;
        let strengths: usize = self.description.effects.iter().map(|e| e.strengths.len()).sum();
        let nominal = 2 * runs * (15 + 4 * self.description.nuisances.len());
        let screened = 2 * strengths * (runs + 3);
        let hypotheses = (strengths * (strengths + 1) / 2).min(11);
        let fits = hypotheses * runs * (constants.fitting.rounds + constants.fitting.along / 2);
        (nominal + screened + fits) as u64
    }

    fn described(&self, dry: &mut Dry) {
        let Description { nuisances, effects, accuracy } = &self.description;
        let number = |x: f64| significant(x, 4);
        let of = |unit: &str| if unit.is_empty() { "(a ratio)".to_owned() } else { unit.to_owned() };
        let _ = writeln!(dry.text, "  channels");
        for (name, unit) in &self.channels {
            let own = accuracy.get(name).map_or("not given".to_owned(), |x| format!("{} {unit}", number(*x)));
            let _ = writeln!(dry.text, "  {name:<24}{unit:<10}accuracy {own}");
            if unit.is_empty() {
                dry.warnings.push(format!("the channel {name} has no unit in campaign.toml"));
            }
        }
        let _ = writeln!(dry.text, "\n  nuisances");
        for n in nuisances {
            let (low, nominal, high) = (number(n.low), number(n.nominal), number(n.high));
            let shared = if n.shared { ", shared by all runs" } else { "" };
            let _ = writeln!(dry.text, "  {:<24}{nominal} {} [{low}, {high}]{shared}", n.name, of(&n.unit));
        }
        let _ = writeln!(dry.text, "\n  effects");
        for e in effects {
            for s in &e.strengths {
                let (low, trial, high) = (number(s.low), number(s.trial), number(s.high));
                let name = format!("{}.{}", e.effect, s.name);
                let line = format!("  {name:<24}trial {trial} {} [{low}, {high}] {}", of(&s.unit), e.place);
                let _ = writeln!(dry.text, "{}", line.trim_end());
            }
        }
        let _ =
            writeln!(dry.text, "\n  runs                      simulated   error before any fit, and of all it does");
    }

    fn run_told(&self, part: &RunPart, rows: &Rows, wall: f64, dry: &mut Dry) {
        let errors = left(part, rows);
        let each = self.channels.iter().enumerate().map(|(c, (name, unit))| {
            let known: Vec<f64> = part.channels[c].iter().copied().filter(|x| x.is_finite()).collect();
            let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
            let moves = root_mean_square(known.iter().map(|x| x - mean));
            let error = root_mean_square(errors[c].iter().copied());
            format!("{name} {} of {} {unit}", significant(error, 2), significant(moves, 2))
        });
        let each: Vec<String> = each.collect();
        let _ = writeln!(dry.text, "  {:<26}{:>8} s  {}", part.name, fixed(wall, 2), each.join(", "));
    }

    /// Asks at the bounds of the nuisances and at each strength's trial and bounds, in one run; how many questions it
    /// were.
    fn bounds_told(&self, part: &RunPart, start: &[f64], nominal: &Rows, dry: &mut Dry) -> usize {
        let mut asked = 0;
        let mut ask = |what: String, at: &[f64], effects: &[Applied], trial: bool| {
            asked += 1;
            match self.ask(part, at, effects) {
                Err(error) => dry.warnings.push(format!("{what}: {error}")),
                Ok(rows) if rows == *nominal => dry.warnings.push(format!("{what} changes nothing in {}", part.name)),
                Ok(rows) if trial => {
                    let errors = left(part, nominal);
                    let change = |c: usize| {
                        let by = rows[c].iter().zip(&nominal[c]).map(|(a, b)| a - b);
                        root_mean_square(by) / root_mean_square(errors[c].iter().copied()).max(1e-300)
                    };
                    let most = (0..rows.len()).map(change).fold(0.0, f64::max);
                    // Far below what is off, rounding and the solver's tolerance are seen; far above, nothing is linear.
                    if !(1e-3..30.0).contains(&most) {
                        let size = significant(most, 2);
                        dry.warnings.push(format!(
                            "{what} changes {size} times what the nominal model is off: choose a trial that changes \
                             about as much"
                        ));
                    }
                }
                Ok(_) => {}
            }
        };
        for (k, n) in self.description.nuisances.iter().enumerate() {
            for (end, bound) in [(0.0, n.low), (1.0, n.high)] {
                let mut at = start.to_vec();
                if at[k] != end {
                    at[k] = end;
                    ask(format!("the nuisance {} at {} {}", n.name, significant(bound, 4), n.unit), &at, &[], false);
                }
            }
        }
        for (candidate, effect) in self.description.effects.with_ids() {
            for (k, s) in effect.strengths.iter().enumerate() {
                for (x, trial) in [(s.trial, true), (s.low, false), (s.high, false)] {
                    let mut strengths = vec![0.0; effect.strengths.len()];
                    strengths[k] = x;
                    if x != 0.0 && (trial || x != s.trial) {
                        let what = format!("{} with {} {} {}", effect.effect, s.name, significant(x, 4), s.unit);
                        ask(what.trim_end().to_owned(), start, &[Applied { candidate, strengths }], trial);
                    }
                }
            }
        }
        asked
    }
}
