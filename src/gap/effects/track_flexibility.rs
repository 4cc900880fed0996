//! A track that gives way between its supports: its surface sinks by c m g sin²(πs/l) under the carts' weight, the static deflection of
//! a span in its first mode (Frýba 1999, moving loads; inertia of the track is left out).
//!
//! Signature: run_left and run_right vary together with the spacing of supports.

use super::{Act, Effect, Strength, Strengths, add_profile, sites};
use crate::dynamics::Deviations;
use crate::emit::simulation::Simulation;
use crate::geometry::trig;

pub const EFFECT: Effect = Effect {
    name: "track_flexibility",
    about: "a track that bends between supports",
    strengths: &[Strength {
        name: "compliance",
        unit: "m/N",
        about: "deflection in a span's middle over a cart's weight",
        trial: 3e-7,
        usual: 0.0,
        low: 0.0,
        high: 1e-4,
    }],
    places: &[("span", 0.0)],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let span = strengths.of("span");
    let span = if span > 0.0 { span } else { simulation.supports_every_m.unwrap_or(3.0) };
    let deflection = strengths.of("compliance") * simulation.cart.mass_kg * simulation.gravity_m_s2;
    let lap = simulation.track.centre_line().length;
    // A whole number of spans, so that the lap closes.
    let span = lap / (lap / span).round().max(1.0);
    let sunk = |s: f64| {
        let sin = trig::sin(trig::PI * s / span);
        -deflection * sin * sin
    };
    add_profile(&mut deviations.rails[1], lap, sunk);
    add_profile(&mut deviations.rails[2], lap, sunk);
}
