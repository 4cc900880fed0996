//! Running wheels that slide sideways: Coulomb friction −μN tanh(v/v_s) where they touch the track (thesis §4.2 names it
//! missing; the smoothing of dry friction after Andersson, Söderberg and Björklund 2007). Wheels in forks that swivel
//! slide across the track; wheels that the cart holds slide across the cart, and so all through a curve, where a cart is a
//! chord.
//!
//! Signature: sideways motion of the carts is damped; steering forces peak less where curves begin. In curves one running
//! wheel carries more than the other, as the friction acts below the joints, and wheels that the cart holds cost thrust.

use super::sites::Site;
use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths};
use crate::chain_input::{Deviations, Simulation};

/// Wheels that creep slower than v_s tell only μ/v_s, and what v_s is of a tyre on its rail is known to a factor of
/// about two.
const CREEP: f64 = 0.6;
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::WHEEL_SLIDING,
    discrepancy: CREEP,
    fitted: &[StrengthSearch::alone(0.05, 0.0)],
    sites: Sites::Listed(axles),
    alternatives: |site, _| creeping(site),
    separated_by: Experiment::Runs,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.sliding += strengths.of("friction");
    deviations.smoothing[0] = strengths.of("creep").max(1e-4);
    deviations.held = strengths.of("held") > 0.5;
}

fn axles(_: &Simulation) -> Vec<Site> {
    let site = |(held, words): (f64, &str)| Site { words: words.to_owned(), fixed: vec![("held", held)] };
    [(0.0, "wheels that swivel"), (1.0, "wheels that the cart holds")].map(site).to_vec()
}

/// Wheels that creep faster or slower before they slide.
fn creeping(axle: &Site) -> Vec<(Site, Vec<Site>)> {
    let site = |creep: f64| {
        let words = format!("{}, sliding beyond {:.0} mm/s", axle.words, 1e3 * creep);
        let fixed = axle.fixed.iter().copied().chain([("creep", creep)]).collect();
        (Site { words, fixed }, Vec::new())
    };
    [0.003, 0.03, 0.1].map(site).to_vec()
}
