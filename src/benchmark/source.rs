//! What a case may be given: one source of a gap, drawn by chance.

use crate::base::random::uniform;
use crate::benchmark::key::Truth;
use crate::chain_input::{Deviations, Simulation};
use crate::signal::Run;
use std::collections::BTreeMap;

/// What a strength makes of a chain.
type OnChain = Box<dyn Fn(f64, &mut Simulation, &mut Deviations) + Send + Sync>;

/// What a strength makes of a measured run.
type OnRun = Box<dyn Fn(f64, &mut Run) + Send + Sync>;

/// What a source does, at a strength of its main measure.
pub enum Change {
    Chain(OnChain),
    Sensor(OnRun),
}

/// A source that was drawn for a case.
pub struct Source {
    pub effect: String,
    /// Names, and what each is over the main measure.
    pub strengths: Vec<(&'static str, f64)>,
    pub fixed: BTreeMap<String, f64>,
    pub place: Option<(f64, f64)>,
    /// Range of the main measure that a built system may have.
    pub range: (f64, f64),
    pub change: Change,
}

impl Source {
    pub fn truth(&self, strength: f64) -> Truth {
        Truth {
            effect: self.effect.clone(),
            strengths: self.strengths.iter().map(|(name, over)| ((*name).to_owned(), over * strength)).collect(),
            fixed: self.fixed.clone(),
            place: self.place,
        }
    }
}

pub(super) type Act = Box<dyn Fn(f64, &mut Simulation, &mut Deviations) + Send + Sync>;

pub fn chain(effect: &str, strength: &'static str, range: (f64, f64), act: Act) -> Source {
    Source {
        effect: effect.to_owned(),
        strengths: vec![(strength, 1.0)],
        fixed: BTreeMap::new(),
        place: None,
        range,
        change: Change::Chain(act),
    }
}

pub fn sign(state: &mut u64) -> f64 {
    if uniform(state) < 0.5 { -1.0 } else { 1.0 }
}
