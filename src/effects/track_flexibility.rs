//! A track that gives way between its supports, by c m g in a span's middle: as each cart's own weight bends a span in
//! its first mode, sin²(πs/l) under it, or with `shape` 1 as the weight of the whole chain does, which lies evenly on
//! spans that are hinged at their supports, sin(πs/l) (Frýba 1999, moving loads; inertia of the track is left out).
//!
//! Signature: run_left and run_right vary together with the spacing of supports, with `shape` 1 also at its multiples.

use super::sites::Site;
use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, add_profile};
use crate::base::trig;
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::TRACK_FLEXIBILITY,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch { trial: 3e-7, as_built: 0.0 }],
    sites: Sites::Listed(shapes),
    separated_by: Experiment::Runs,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let span = strengths.of("span");
    let span = if span > 0.0 { span } else { simulation.supports_every_m.unwrap_or(3.0) };
    let deflection = strengths.of("compliance") * simulation.cart.mass_kg * simulation.gravity_m_s2;
    let hinged = strengths.of("shape") > 0.5;
    let lap = simulation.track.centre_line().length;
    // A whole number of spans, so that the lap closes.
    let span = lap / (lap / span).round().max(1.0);
    let sunk = |s: f64| {
        let sin = trig::sin(trig::PI * s / span).abs();
        -deflection * if hinged { sin } else { sin * sin }
    };
    add_profile(&mut deviations.rails[1], lap, sunk);
    add_profile(&mut deviations.rails[2], lap, sunk);
}

fn shapes(_: &Simulation) -> Vec<Site> {
    let site = |shape: f64, words: &str| Site { words: words.to_owned(), fixed: vec![("shape", shape)] };
    vec![site(0.0, "spans that run on over their supports"), site(1.0, "hinged spans")]
}
