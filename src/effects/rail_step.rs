//! A step where two elements of the track meet: the rail goes off by h over `rise`, at once when not given, and comes
//! back over the next `back`, 2 m when not given. A wheel of radius r needs √(2rh) to climb a sharp one (Johnson 1985),
//! and 10 mm hold two points of the profile: a smaller rise is no sharper. A joint that was ground off, or that bends
//! under the wheel, rises over more. Rail 1 is the steering wheels' (to the left), 2 the left and 3 the right running
//! wheel's; 4 are both of these, where a whole element is higher than the next.
//!
//! Signature: an impact at one place of the track, in the channels of one side, or of both running wheels.

use super::sites::Site;
use super::{Act, Effect, Experiment, SPACING, Sites, StrengthSearch, Strengths, add_profile};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::RAIL_STEP,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(1e-4, 3e-5)],
    sites: Sites::Suspected,
    several: true,
    separated_by: Experiment::Runs,
    alternatives,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let (height, at) = (strengths.of("height"), strengths.of("at"));
    let lap = simulation.track.centre_line().length;
    let rails = RAILS[strengths.index("rail").min(BOTH)].1;
    let wheel = if rails == [0] { &simulation.steering_wheel } else { &simulation.running_wheel };
    let climbed = (2.0 * wheel.radius_m * height.abs()).sqrt();
    let (rise, back) = (strengths.of("rise").max(climbed).max(SHARPEST), strengths.of("back").max(0.05));
    let step = |s: f64| {
        let past = (s - at).rem_euclid(lap);
        if past < back { height * (past / rise).min(1.0) * (1.0 - past / back) } else { 0.0 }
    };
    rails.iter().for_each(|rail| add_profile(&mut deviations.rails[*rail], lap, step));
}

/// What steps, with the rails that go off, counted from 0.
const RAILS: [(&str, &[usize]); 4] =
    [("steering rail", &[0]), ("left rail", &[1]), ("right rail", &[2]), ("both running rails", &[1, 2])];
/// The running rails together, as a place in [`RAILS`].
pub const BOTH: usize = 3;

/// No step is sharper, whatever its height, m.
const SHARPEST: f64 = 2.0 * SPACING;

/// Lengths over which the rail of a step that is looked for goes off and comes back at first, m. A sharp one strikes, and
/// what it does is far from in proportion to its height: it is tried beside one that rises over more.
pub const RISE: f64 = 0.05;
pub const BACK: f64 = effect_definitions::RAIL_STEP.places[3].default;

/// Over what else it may rise, m: 0 of a sharp one.
const OTHER_RISES: [f64; 3] = [0.0, 0.025, 0.15];

/// A step of a rail, counted from 0, or of [`BOTH`] running rails, at an arc length, with its lengths, m.
pub fn site(at: f64, rail: usize, rise: f64, back: f64) -> Site {
    let name = RAILS[rail.min(BOTH)].0;
    Site {
        words: format!("{name} at {at:.1} m"),
        fixed: vec![("at", at), ("rail", rail as f64 + 1.0), ("rise", rise), ("back", back)],
    }
}

/// Beside a step such as are sharper or smoother, come back sooner or later, or lie near; and steps as far away as its
/// place may be off, each with those beside it.
fn alternatives(step: &Site, known: f64) -> Vec<(Site, Vec<Site>)> {
    let (Some(at), Some(rail)) = (step.of("at"), step.of("rail")) else { return Vec::new() };
    let rail = (rail - 1.0).max(0.0) as usize;
    let near = |at: f64| {
        let sharper_or_smoother = OTHER_RISES.map(|rise| site(at, rail, rise, BACK));
        let sooner_or_later = [0.25, 0.5, 2.5].map(|share| site(at, rail, RISE, share * BACK));
        let between = [-0.25, -0.125, 0.125, 0.25].map(|share| site(at + share * known, rail, RISE, BACK));
        sharper_or_smoother.into_iter().chain(sooner_or_later).chain(between)
    };
    let own = near(at).map(|site| (site, Vec::new()));
    let far = [-1.0, -0.5, 0.5, 1.0].map(|share| at + share * known);
    own.chain(far.map(|at| (site(at, rail, RISE, BACK), near(at).collect()))).collect()
}
