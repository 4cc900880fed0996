//! Layouts that campaigns are driven on.

use crate::base::json::to_json;
use crate::chain_input::Simulation;
use crate::compiled::Compiled;
use crate::semantics::analyse;
use crate::solve::{self, Options};
use crate::source::{Loader, SourceMap};

/// File and text.
const LAYOUTS: [(&str, &str); 5] = [
    ("oval.lss", include_str!("../../benches/identify/layouts/oval.lss")),
    ("slant.lss", include_str!("../../benches/identify/layouts/slant.lss")),
    ("hook.lss", include_str!("../../benches/identify/layouts/hook.lss")),
    ("reference.lss", include_str!("../../examples/reference.lss")),
    ("comb.lss", include_str!("../../benches/identify/layouts/comb.lss")),
];

/// A layout as it is planned.
#[derive(Clone, Debug)]
pub struct Planned {
    /// The file that cases hold, and its text.
    pub file: &'static str,
    pub text: Vec<u8>,
    pub simulation: Simulation,
}

impl Planned {
    /// One that is given, without the effects it may have.
    pub fn given(mut simulation: Simulation) -> Planned {
        simulation.effects.clear();
        Planned { file: "simulation.json", text: to_json(&simulation), simulation }
    }
}

/// All of them.
///
/// # Errors
///
/// In words, for a layout that does not compile.
pub fn all() -> Result<Vec<Planned>, String> {
    LAYOUTS.into_iter().map(|(file, text)| planned(file, text)).collect()
}

fn planned(file: &'static str, text: &'static str) -> Result<Planned, String> {
    let mistaken = || format!("{file} does not compile");
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[(file, text.as_bytes())]).map_err(|_| mistaken())?;
    let analysis = analyse(&mut sources, &mut loader, main, None);
    let layout = analysis.chosen().ok().flatten().ok_or_else(mistaken)?.clone();
    let solution = solve::solve(&layout, &Options::default(), &|_| {});
    Ok(Planned { file, text: text.into(), simulation: Simulation::new(&Compiled::new(layout, solution)) })
}
