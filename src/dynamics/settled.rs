//! A chain that has settled, from which others with nearly the same parameters settle sooner.

use super::chain::Chain;
use super::forces::Memory;
use super::model::Model;
use super::start::start;
use super::state::{PACK, State, attitude, vector};
use crate::chain_input::Unfit;
use std::sync::Arc;

/// A chain after it settled.
#[derive(Clone, Debug)]
pub struct Settled {
    model: Arc<Model>,
    state: State,
    memory: Memory,
    /// Arc length of the first cart's front joint, m.
    front: f64,
    /// What the controller's integral commands, N a motor.
    thrust: f64,
}

impl Settled {
    pub(super) fn of(chain: &Chain) -> Self {
        Settled {
            model: chain.model.clone(),
            state: chain.state.clone(),
            memory: chain.memory.clone(),
            front: chain.forces.station.first().copied().unwrap_or(0.0),
            thrust: chain.model.controller.integral * chain.control.integral,
        }
    }

    /// Puts a chain of as many carts in this state, at its own speed, on its own track, and with the thrust that its
    /// own resistance needs.
    ///
    /// # Errors
    ///
    /// [`Unfit`] where the chain does not close where this one is.
    pub(super) fn put(&self, chain: &mut Chain) -> Result<(), Unfit> {
        let model = chain.model.clone();
        if self.state.carts != model.carts {
            return Ok(());
        }
        let faster = model.speed / self.model.speed;
        if self.model.segments.line == model.segments.line {
            chain.state = self.state.clone();
            chain.memory = self.memory.clone();
            for bodies in &mut chain.state.bodies {
                for row in bodies.velocity.iter_mut().chain(&mut bodies.spin) {
                    row.iter_mut().for_each(|x| *x *= faster);
                }
            }
        } else {
            let lap = |model: &Model| model.segments.line.length;
            let from = start(&self.model, self.front, self.model.speed)?.0;
            let (state, memory, _) = start(&model, self.front * lap(&model) / lap(&self.model), model.speed)?;
            (chain.state, chain.memory) = (state, memory);
            chain.memory.approach.clone_from(&self.memory.approach);
            for cart in 0..model.carts {
                move_as(&mut chain.state, &self.state, &from, cart);
            }
        }
        let thrust = self.thrust * model.running.resistance / self.model.running.resistance;
        if model.controller.integral > 0.0 && thrust.is_finite() {
            chain.control.integral = thrust / model.controller.integral;
        }
        chain.evaluate(true);
        Ok(())
    }
}

/// Moves a cart of a chain that starts as far from there as one has moved from its own start, in the cart's axes.
fn move_as(chain: &mut State, moved: &State, from: &State, cart: usize) {
    let (pack, lane) = (cart / PACK, cart % PACK);
    let (own, moved, from) = (&mut chain.bodies[pack], &moved.bodies[pack], &from.bodies[pack]);
    let (at_start, began) = (attitude(own, lane), attitude(from, lane));
    let other = at_start * began.inverse();
    let position = vector(&own.position, lane) + other * (vector(&moved.position, lane) - vector(&from.position, lane));
    let velocity = vector(&own.velocity, lane) + other * (vector(&moved.velocity, lane) - vector(&from.velocity, lane));
    let spin = vector(&own.spin, lane) + vector(&moved.spin, lane) - vector(&from.spin, lane);
    for k in 0..3 {
        own.position[k][lane] = position[k];
        own.velocity[k][lane] = velocity[k];
        own.spin[k][lane] = spin[k];
    }
    let turned = other * attitude(moved, lane);
    for (k, value) in [turned.w, turned.i, turned.j, turned.k].into_iter().enumerate() {
        own.attitude[k][lane] = value;
    }
}
