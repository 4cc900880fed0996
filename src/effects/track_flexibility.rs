//! A track that gives way between its supports. Under the carts' weight its rails sink by c m g in a span's middle: as
//! each cart's own weight bends a span in its first mode, sin²(πs/l) under it, or with `shape` 1 as the weight of the
//! whole chain does, which lies evenly on spans that are hinged at their supports, sin(πs/l) (Frýba 1999, moving loads;
//! inertia of the track is left out). Its guides give way to the steering wheels' force F by c F sin²(πs/l), in series
//! with the contact.
//!
//! Signature: run_left and run_right vary together with the spacing of supports, with `shape` 1 also at its multiples;
//! where guides give way, steering forces and joint_xi fluctuate less as carts pass through curves.

use super::sites::Site;
use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, add_profile};
use crate::base::trig;
use crate::chain_input::{Deviations, Guides, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::TRACK_FLEXIBILITY,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(3e-7, 0.0), StrengthSearch::alone(3e-7, 0.0)],
    sites: Sites::Listed(shapes),
    alternatives: |site, _| spans(site),
    separated_by: Experiment::Runs,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let span = strengths.of("span");
    let span = if span > 0.0 { span } else { strengths.of("wider") * simulation.supports_every_m.unwrap_or(3.0) };
    let deflection = strengths.of("compliance") * simulation.cart.mass_kg * simulation.gravity_m_s2;
    let hinged = strengths.of("shape") > 0.5;
    let lap = simulation.track.centre_line().length;
    // A whole number of spans, so that the lap closes.
    let span = lap / (lap / span).round().max(1.0);
    let first = strengths.of("first");
    let guides = strengths.of("guides");
    if guides > 0.0 {
        deviations.guides = Guides { compliance: guides, span, first };
    }
    if deflection == 0.0 {
        return;
    }
    let sunk = |s: f64| {
        let sin = trig::sin(trig::PI * (s - first) / span).abs();
        -deflection * if hinged { sin } else { sin * sin }
    };
    add_profile(&mut deviations.rails[1], lap, sunk);
    add_profile(&mut deviations.rails[2], lap, sunk);
}

const SHAPES: [(f64, &str); 2] = [(0.0, "spans that run on over their supports"), (1.0, "hinged spans")];

fn shapes(_: &Simulation) -> Vec<Site> {
    SHAPES.map(|(shape, words)| Site { words: words.to_owned(), fixed: vec![("shape", shape)] }).to_vec()
}

/// Supports that are closer or farther apart than the layout has them.
fn spans(site: &Site) -> Vec<(Site, Vec<Site>)> {
    let Some(shape) = site.of("shape") else { return Vec::new() };
    let other = |factor: f64| {
        let words = format!("{}, {factor} times as far apart as drawn", site.words);
        (Site { words, fixed: vec![("shape", shape), ("wider", factor)] }, Vec::new())
    };
    [0.5, 0.65, 0.8, 1.25, 1.6].map(other).to_vec()
}
