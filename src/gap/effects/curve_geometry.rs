//! A curve built with another radius or heading: its rails lie off the centre line by y sin²(πd/l) over the curve's length l, whose
//! curvature differs by −y″, so more in the middle and less at its ends.
//!
//! Signature: steering forces of one curve.

use super::{Act, Effect, Strength, Strengths, add_profile, sites};
use crate::dynamics::Deviations;
use crate::emit::simulation::Simulation;
use crate::geometry::trig;

pub const EFFECT: Effect = Effect {
    name: "curve_geometry",
    about: "a curve that was built otherwise",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "offset",
        unit: "m",
        about: "to the left in the curve's middle",
        trial: 1e-3,
        usual: 0.0,
        low: -0.04,
        high: 0.04,
    }],
    places: &[("curve", 1.0)],
    sites: sites::each_curve,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let Some((_, from, to)) = sites::curves(simulation).into_iter().nth(strengths.index("curve")) else { return };
    let (offset, lap) = (strengths.of("offset"), simulation.track.centre_line().length);
    add_profile(&mut deviations.rails[0], lap, |s| {
        if !(from..to).contains(&s) {
            return 0.0;
        }
        let sin = trig::sin(trig::PI * (s - from) / (to - from));
        offset * sin * sin
    });
}
