//! A drive that answers late, u(t − T), and gives no more than a share of F_max (Åström and Hägglund 2006).
//!
//! Signature: slow swings of the chain's speed and of joint_xi everywhere.

use super::{Act, Effect, Strength, Strengths, sites};
use crate::dynamics::Deviations;
use crate::emit::simulation::Simulation;
use crate::identify::Parameter;

pub const EFFECT: Effect = Effect {
    name: "control_delay",
    about: "a drive that answers late",
    strengths: &[Strength {
        name: "delay",
        unit: "s",
        about: "from speed to thrust",
        trial: 0.1,
        usual: 0.0,
        low: 0.0,
        high: 5.0,
    }],
    places: &[("saturation", 1.0)],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

/// Nuisances that a fit without the delay bends to imitate its swings: with it they begin as they are planned.
pub const BENT: [Parameter; 2] = [Parameter::KP, Parameter::KI];

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.delay += strengths.of("delay");
    deviations.saturation = deviations.saturation.min(strengths.of("saturation").clamp(0.01, 1.0));
}
