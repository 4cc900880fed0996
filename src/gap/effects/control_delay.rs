//! A drive that answers late, u(t − T), and gives no more than a share of F_max; `gains` are its own, over the planned ones, as it is late by
//! more than it bears the sooner the larger these are (Åström and Hägglund 2006, delay margin).
//!
//! Signature: slow swings of the chain's speed and of joint_xi everywhere, at any phase.

use super::{Act, Effect, Strength, Strengths, sites::Site};
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;
use crate::identify::Parameter;

pub const EFFECT: Effect = Effect {
    name: "control_delay",
    about: "a drive that answers late",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "delay",
        unit: "s",
        about: "from speed to thrust",
        trial: 0.1,
        usual: 0.0,
        low: 0.0,
        high: 5.0,
    }],
    places: &[("saturation", 1.0), ("gains", 1.0)],
    sites: with_gains,
    act: Act::Chain(act),
};

/// Nuisances that a fit without the delay bends to imitate its swings: with it they begin as they are planned.
pub const BENT: [Parameter; 2] = [Parameter::KP, Parameter::KI];

/// Gains over the planned ones at which a late drive swings sooner.
const LARGE: f64 = 1.5;

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let gains = strengths.of("gains").clamp(0.01, 100.0);
    for p in BENT {
        let planned = p.get(simulation);
        p.set(simulation, gains * planned);
    }
    deviations.delay += strengths.of("delay");
    deviations.saturation = deviations.saturation.min(strengths.of("saturation").clamp(0.01, 1.0));
}

fn with_gains(_: &Simulation) -> Vec<Site> {
    let site = |gains: f64, words: &str| Site { words: words.to_owned(), fixed: vec![("gains", gains)] };
    vec![site(1.0, ""), site(LARGE, "with half as much gain again")]
}
