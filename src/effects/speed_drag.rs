//! Drag that grows with speed, −c v² on each cart (air and splashing lubricant; Hoerner 1965): like rolling resistance
//! in one run, but not over runs of several speeds.
//!
//! Signature: joint_xi falls from motor to motor, more at higher speed.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, sites};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::SPEED_DRAG,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(0.3, 0.0)],
    sites: Sites::Listed(sites::everywhere),
    separated_by: Experiment::Speed,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.drag += strengths.of("drag");
}
