//! A drive that answers late, u(t − T), and gives no more than a share of F_max; `gains` are its own, over the planned
//! ones, as it is late by more than it bears the sooner the larger these are (Åström and Hägglund 2006, delay margin).
//!
//! Signature: slow swings of the chain's speed and of joint_xi everywhere, at any phase.

use super::sites::Site;
use super::{Act, Effect, Experiment, RandomEffect, Sites, Start, StrengthSearch, Strengths};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::CONTROL_DELAY,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(0.1, 0.0)],
    sites: Sites::Listed(with_gains),
    separated_by: Experiment::Motors,
    random: Some((RandomEffect::ByLap, |_| true)),
    start: |_| Start::Unsettled(&BENT),
    act: Act::Chain(act),
    ..Effect::PLAIN
};

/// Parameters of identification that a fit without the delay bends to imitate its swings.
const BENT: [&str; 2] = ["k_p", "k_i"];

/// Gains over the planned ones at which a late drive swings sooner.
const LARGE: f64 = 1.5;

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let gains = strengths.of("gains").clamp(0.01, 100.0);
    simulation.controller.proportional_n_s_per_m *= gains;
    simulation.controller.integral_n_per_m *= gains;
    deviations.delay += strengths.of("delay");
    deviations.saturation = deviations.saturation.min(strengths.of("saturation").clamp(0.01, 1.0));
}

fn with_gains(_: &Simulation) -> Vec<Site> {
    let site = |gains: f64, words: &str| Site { words: words.to_owned(), fixed: vec![("gains", gains)] };
    vec![site(1.0, ""), site(LARGE, "with half as much gain again")]
}
