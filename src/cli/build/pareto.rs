//! `lss build --emit pareto`: what may be traded of a layout, and the trade.

use crate::choose::{self, Measure};
use crate::cli::choose::lacks_energy;
use crate::cli::progress::Solving;
use crate::cli::{MessageFormat, Outcome, report};
use crate::diagnostic::Diagnostic;
use crate::emit::pareto::Pareto;
use crate::model::Layout;
use crate::solve::{self, End, Options, unsupported};

/// What is traded where nothing else is asked for.
pub const USUAL: [Measure; 2] = [Measure::Length, Measure::Cost];

/// Whether measures cannot be traded of a layout, which is told; `said` gets what may not be built of their ends.
pub fn unready(layout: &Layout, measures: &[Measure], said: &mut Vec<Diagnostic>) -> Option<Outcome> {
    let priced = measures.iter().any(|m| matches!(m, Measure::Cost | Measure::Price));
    if priced && layout.catalog.unpriced().next().is_some() {
        report::error("--emit pareto needs a catalogue in which straights and curves cost something");
        return Some(Outcome::CouldNotRun);
    }
    if lacks_energy(layout, measures) {
        return Some(Outcome::CouldNotRun);
    }
    // What may be built of the layout's own objective may not be of others.
    let smooth = measures.contains(&Measure::Smoothness).then_some(End::PolygonAction);
    for end in smooth.into_iter().chain(priced.then_some(End::Cost)) {
        let of_end = Layout { objective: solve::objective(layout, end), ..layout.clone() };
        let new: Vec<Diagnostic> = unsupported(&of_end).into_iter().filter(|d| !said.contains(d)).collect();
        said.extend(new);
    }
    None
}

/// Trades the measures of a layout.
pub fn trade(
    layout: &Layout,
    measures: &[Measure],
    options: &Options,
    format: MessageFormat,
) -> Result<Pareto, Outcome> {
    let line = Solving::new(format);
    let found = choose::pareto(layout, measures, options, &|progress| line.show(progress));
    line.finish();
    let found = found.map_err(|too_many| {
        report::error(&too_many.to_string());
        Outcome::Problems
    })?;
    if let Some(measure) = found.lacking {
        let (name, ..) = measure.words();
        let help = match measure {
            Measure::Capacity => "  help: nothing comes or goes here; give the layout inductions and chutes",
            _ => "  help: leave it out of --pareto",
        };
        report::error(&format!("no layout that was found has a {name}"));
        report::note(help);
        return Err(Outcome::CouldNotRun);
    }
    Ok(Pareto::new(layout, &found))
}
