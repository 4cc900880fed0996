//! One cart in plain numbers: where its joints and wheels are. For energies, supports and messages, not for speed.

use super::chain::Chain;
use super::state::PACK;
use crate::dynamics::state::{attitude, vector};
use nalgebra::Vector3;

/// Where a cart's points are in relation to the track and to its follower.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// e of the joint behind, in the cart's axes, m.
    pub elongation: [f64; 3],
    /// y of the front joint, m.
    pub lateral: f64,
    /// Height of each running wheel (left, right) above the lower surface, m.
    pub heights: [f64; 2],
    /// Arc length of the front joint, m.
    pub s: f64,
}

impl Chain {
    /// A point of cart `i` in the world, from its front joint, m.
    pub fn point(&self, i: usize, from_front: [f64; 3]) -> Vector3<f64> {
        let bodies = &self.state.bodies[i / PACK];
        let [xi, zeta] = self.model.cart.centre;
        let arm = Vector3::from(from_front) - Vector3::new(xi, 0.0, zeta);
        vector(&bodies.position, i % PACK) + attitude(bodies, i % PACK) * arm
    }

    /// Where cart `i` is, from 0.
    pub fn placed(&self, i: usize) -> Placement {
        let model = &self.model;
        let (pack, lane) = (i / PACK, i % PACK);
        let follower = (i + 1) % model.carts;
        let apart = self.point(follower, [0.0; 3]) - self.point(i, [-model.cart.length, 0.0, 0.0]);
        let elongation = attitude(&self.state.bodies[pack], lane).inverse() * apart;
        let segment = self.memory.home[pack].front.segment[lane] as usize;
        let front = model.segments.footing(self.point(i, [0.0; 3]).into(), segment);
        let wheel = &model.running;
        let height = |side: f64| {
            let point = self.point(i, [0.0, side * wheel.half_spacing, -wheel.height]);
            model.segments.footing(point.into(), segment).z + wheel.height
        };
        Placement { elongation: elongation.into(), lateral: front.y, heights: [height(1.0), height(-1.0)], s: front.s }
    }
}
