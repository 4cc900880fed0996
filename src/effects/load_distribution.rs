//! Items on the carts: every second cart, in an irregular order, carries a mass, at its centre of mass (thesis, chapter
//! 2: carts without items). The sensor cart is thought to be empty, and so are both carts beside it, unless `on_sensor`
//! is 1, where all carts carry an item, 2 or 3, where the cart of the number before or after carries one, or 4, where
//! both do. Another `draw` loads others.
//!
//! Signature: joint_xi along the track and, in curves, steering forces; with `on_sensor` the running wheels' forces.

use super::sites::Site;
use super::{Act, Effect, Experiment, RandomEffect, Sites, StrengthSearch, Strengths, spread};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions::{self, PlaceDefinition};

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::LOAD_DISTRIBUTION,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch { trial: 3.0, as_built: 0.0 }],
    sites: Sites::Listed(loads),
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
    let beside = Beside::of(strengths.of("on_sensor"));
    let drawn = APART * strengths.index(DRAW.name);
    deviations.load.resize(carts, 0.0);
    for (i, load) in deviations.load.iter_mut().enumerate() {
        let loaded = match beside {
            None => true,
            Some(_) if i == sensor => false,
            Some(beside) if (i + 1) % carts == sensor => beside.before,
            Some(beside) if i == (sensor + 1) % carts => beside.after,
            Some(_) => spread(i + drawn) > 0.0,
        };
        *load += if loaded { share } else { 0.0 };
    }
}

/// Which carts beside the empty one with the sensors carry an item: they lean on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Beside {
    pub before: bool,
    pub after: bool,
}

impl Beside {
    /// `None` where all carts are loaded.
    fn of(on_sensor: f64) -> Option<Beside> {
        match on_sensor.round() as i64 {
            1 => None,
            which => Some(Beside { before: which == 2 || which == 4, after: which == 3 || which == 4 }),
        }
    }

    /// Of an input with items on its carts.
    pub fn in_input(simulation: &Simulation) -> Option<Beside> {
        let effect = simulation.effects.iter().find(|e| e.name == EFFECT.name())?;
        Beside::of(effect.strengths.get("on_sensor").copied().unwrap_or(0.0))
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
    ]
}
