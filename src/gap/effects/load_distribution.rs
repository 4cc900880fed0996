//! Items on the carts: every second cart, in an irregular order, carries a mass, at its centre of mass (thesis, chapter 2: carts without items).
//! The sensor cart is thought to be empty unless `on_sensor` is 1, where all carts carry it.
//!
//! Signature: joint_xi along the track and, in curves, steering forces; with `on_sensor` the running wheels' forces.

use super::{Act, Effect, Strength, Strengths, sites::Site, spread};
use crate::dynamics::Deviations;
use crate::emit::simulation::Simulation;

pub const EFFECT: Effect = Effect {
    name: "load_distribution",
    about: "items on the carts",
    strengths: &[Strength {
        name: "mass",
        unit: "kg",
        about: "of items on a loaded cart",
        trial: 3.0,
        usual: 0.0,
        low: 0.0,
        high: 200.0,
    }],
    places: &[("on_sensor", 0.0)],
    sites: loads,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let share = strengths.of("mass") / simulation.cart.mass_kg.max(1e-9);
    let all = strengths.of("on_sensor") > 0.5;
    deviations.load.resize(simulation.chain.carts, 0.0);
    for (i, load) in deviations.load.iter_mut().enumerate() {
        if all || (spread(i) > 0.0 && i + 1 != simulation.sensor.cart) {
            *load += share;
        }
    }
}

fn loads(_: &Simulation) -> Vec<Site> {
    let site = |on: f64, words: &str| Site { words: words.to_owned(), fixed: vec![("on_sensor", on)] };
    vec![site(0.0, "on other carts"), site(1.0, "on all carts")]
}
