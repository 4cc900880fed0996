//! A step where two elements of the track meet: the rail is off by h behind the joint and comes back over the next 2 m. A wheel of radius r
//! climbs it over √(2rh), which is less than the 25 mm of the profile's points (Johnson 1985). Rail 1 is the steering wheels' (to the
//! left), 2 the left and 3 the right running wheel's.
//!
//! Signature: a blow at one place of the track, in the channels of one side.

use super::{Act, Effect, Strength, Strengths, add_profile, sites};
use crate::dynamics::Deviations;
use crate::emit::simulation::Simulation;

pub const EFFECT: Effect = Effect {
    name: "rail_step",
    about: "a step at a joint of the track",
    strengths: &[Strength {
        name: "height",
        unit: "m",
        about: "of the step",
        trial: 1e-4,
        usual: 2e-5,
        low: -5e-3,
        high: 5e-3,
    }],
    places: &[("at", 0.0), ("rail", 2.0)],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let (height, at) = (strengths.of("height"), strengths.of("at"));
    let lap = simulation.track.centre_line().length;
    let rail = strengths.index("rail").min(2);
    add_profile(&mut deviations.rails[rail], lap, |s| {
        let past = (s - at).rem_euclid(lap);
        if past < BACK { height * (1.0 - past / BACK) } else { 0.0 }
    });
}

/// Length over which the rail comes back, m.
const BACK: f64 = 2.0;
