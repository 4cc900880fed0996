//! Items on the carts: a share of them, in an irregular order, carries a mass, at its centre of mass (thesis, chapter
//! 2: carts without items). The sensor cart is thought to be empty, and so are both carts beside it, unless `on_sensor`
//! is 1, where all carts carry an item, 2 or 3, where the cart of the number before or after carries one, or 4, where
//! both do; from 5 to 8 the same with an item on the sensor cart, too. Another `draw` loads others.
//!
//! Signature: joint_xi along the track and, in curves, steering forces; with `on_sensor` the running wheels' forces.

use super::sites::Site;
use super::{Act, Effect, Experiment, RandomEffect, Sites, StrengthSearch, Strengths, spread};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions::{self, PlaceDefinition};

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::LOAD_DISTRIBUTION,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(3.0, 0.0)],
    sites: Sites::Listed(loads),
    alternatives: |site, _| shares(site),
    separated_by: Experiment::Runs,
    random: Some((RandomEffect::ByCart, |site| site.of("on_sensor") == Some(0.0))),
    act: Act::Chain(act),
    ..Effect::PLAIN
};

/// Which carts are loaded, and that of a layout that does not say.
pub const DRAW: PlaceDefinition = effect_definitions::LOAD_DISTRIBUTION.places[1];

/// Carts from one draw to the next.
const APART: usize = 1 << 16;

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let share = strengths.of("mass") / simulation.cart.mass_kg.max(1e-9);
    let (carts, sensor) = (simulation.chain.carts, simulation.sensor.cart.saturating_sub(1));
    let like = Loaded::of(strengths.of("on_sensor"));
    // Uniform in (−1, 1).
    let beyond = 1.0 - 2.0 * strengths.of("share").clamp(0.0, 1.0);
    let drawn = APART * strengths.index(DRAW.name);
    deviations.load.resize(carts, 0.0);
    for (i, load) in deviations.load.iter_mut().enumerate() {
        let loaded = match like {
            None => true,
            Some(like) if i == sensor => like.own,
            Some(like) if (i + 1) % carts == sensor => like.before,
            Some(like) if i == (sensor + 1) % carts => like.after,
            Some(_) => spread(i + drawn) > beyond,
        };
        *load += if loaded { share } else { 0.0 };
    }
}

/// Which of the cart with the sensors and those beside it, which lean on it, carry an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loaded {
    pub own: bool,
    pub before: bool,
    pub after: bool,
}

impl Loaded {
    /// `None` where all carts are loaded.
    fn of(on_sensor: f64) -> Option<Loaded> {
        let which = on_sensor.round() as i64;
        let beside = if which > 4 { which - 4 } else { which };
        let like = Loaded { own: which > 4, before: beside == 2 || beside == 4, after: beside == 3 || beside == 4 };
        (which != 1).then_some(like)
    }

    /// Of an input with items on its carts.
    pub fn in_input(simulation: &Simulation) -> Option<Loaded> {
        let effect = simulation.effects.iter().find(|e| e.name == EFFECT.name())?;
        Loaded::of(effect.strengths.get("on_sensor").copied().unwrap_or(0.0))
    }
}

fn loads(_: &Simulation) -> Vec<Site> {
    let site = |on: f64, words: &str| Site { words: words.to_owned(), fixed: vec![("on_sensor", on)] };
    vec![
        site(0.0, "on other carts, none beside the sensors"),
        site(1.0, "on all carts"),
        site(2.0, "on other carts, the one before the sensors too"),
        site(3.0, "on other carts, the one after the sensors too"),
        site(4.0, "on other carts, both beside the sensors too"),
        site(5.0, "on the cart with the sensors and others, none beside it"),
        site(6.0, "on the cart with the sensors and others, the one before it too"),
        site(7.0, "on the cart with the sensors and others, the one after it too"),
        site(8.0, "on the cart with the sensors and others, both beside it too"),
    ]
}

/// Fewer and more of the others.
fn shares(load: &Site) -> Vec<(Site, Vec<Site>)> {
    let Some(on) = load.of("on_sensor").filter(|on| *on != 1.0) else { return Vec::new() };
    let site = |(share, words): (f64, &str)| {
        let words = format!("{}; {words} of the others", load.words);
        (Site { words, fixed: vec![("on_sensor", on), ("share", share)] }, Vec::new())
    };
    [(0.15, "a seventh"), (0.3, "a third"), (0.7, "two thirds")].map(site).to_vec()
}
