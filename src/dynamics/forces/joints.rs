//! The joint between each cart and its follower (design: chain model, joints).

use super::{Evaluation, Turned, arm, load, store};
use crate::base::trig;
use crate::dynamics::contact::{Stretched, damped, one_over, turned_over};
use crate::dynamics::lanes::{Lane, Lane3, Splat};
use crate::dynamics::state::PACK;
use pulp::{Simd, WithSimd};

impl Evaluation<'_> {
    /// Forces of the joints behind several carts. Returns their torque about the centre of mass, in the cart's axes,
    /// N m, and how they are damped along the axes, N s/m.
    #[inline(always)]
    pub(super) fn joints<S: Simd>(&mut self, simd: S, pack: usize, part: usize, turned: &Turned<S>) -> [Lane3<S>; 2] {
        let model = self.model;
        let c = Splat(simd);
        let Turned { axes, spin } = turned;
        let place = pack * PACK + part * S::F64_LANES;
        let forces = &mut *self.forces;
        let behind = load(simd, &forces.front, place + 1) - load(simd, &forces.front, place);
        let relative = load(simd, &forces.front_velocity, place + 1) - load(simd, &forces.front_velocity, place);
        // In the leader's axes: the follower's front joint, e and its rate; the leader's rear joint is at (−L, 0, 0).
        let from_front = axes.turn_back(behind);
        let mut length = c.of(model.cart.length);
        if let Some(row) = model.longer.get(pack) {
            length = length + Lane::of(simd, row, part);
        }
        let e = Lane3::new(from_front.x + length, from_front.y, from_front.z);
        let rate = axes.turn_back(relative) - spin.cross(from_front);

        let approach = &mut self.memory.approach[pack].joint;
        let memory = [
            Lane::of(simd, &approach[0], part),
            Lane::of(simd, &approach[1], part),
            Lane::of(simd, &approach[2], part),
        ];
        // Across the chain elongations change their signs in every second step of a pack: too often for a branch.
        let fresh = [turned_over(e.x, memory[0]), turned_over(e.y, memory[1]), turned_over(e.z, memory[2])];
        let now = one_over(model.floor, [rate.x.abs(), rate.y.abs(), rate.z.abs()]);
        let memory = [
            now[0].times_sign_of(e.x).select(fresh[0], memory[0]),
            now[1].times_sign_of(e.y).select(fresh[1], memory[1]),
            now[2].times_sign_of(e.z).select(fresh[2], memory[2]),
        ];
        if self.commit {
            memory[0].put(&mut approach[0], part);
            memory[1].put(&mut approach[1], part);
            memory[2].put(&mut approach[2], part);
        }
        let mut stretched = [e.x, e.y, e.z];
        if !model.linear_joints() {
            let exponents = [model.axial.exponent, model.radial.exponent, model.radial.exponent];
            let half_play = 0.5 * model.deviations.clearance;
            let [x, y, z] = simd.vectorize(Stretched { e: stretched, half_play, exponents });
            stretched = [x, y, z];
        }
        let [x, x_damping] = damped(&model.axial, stretched[0], rate.x, memory[0]);
        let [y, y_damping] = damped(&model.radial, stretched[1], rate.y, memory[1]);
        let [z, z_damping] = damped(&model.radial, stretched[2], rate.z, memory[2]);
        let force = Lane3::new(x, y, z);
        store(axes.turn(force), &mut forces.pull, place + 1);
        force.put(&mut forces.loads[pack].joint, part);
        // The force acts at the follower's front joint.
        let [x, z] = arm(simd, model);
        let mut torque = Lane3::new(from_front.x + x, from_front.y, from_front.z + z).cross(force);
        if model.deviations.joint_friction > 0.0 {
            let relative = load(simd, &forces.front_spin, place + 1) - load(simd, &forces.front_spin, place);
            let (most, slow) = (model.deviations.joint_friction, model.deviations.smoothing[1]);
            let twist = simd.vectorize(Friction { relative, most, slow });
            store(twist, &mut forces.twist, place + 1);
            torque = torque + axes.turn_back(twist);
        }
        [torque, Lane3::new(x_damping, y_damping, z_damping)]
    }
}

/// Dry friction against turning, on the leader: `most`, N m, against whatever turns faster than `slow`, rad/s.
struct Friction<S: Simd> {
    /// Angular velocity of the follower against the leader, rad/s.
    relative: Lane3<S>,
    most: f64,
    slow: f64,
}

impl<S: Simd> WithSimd for Friction<S> {
    type Output = Lane3<S>;

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) -> Self::Output {
        let rate = self.relative.dot(self.relative).sqrt();
        let (most, slow) = (self.most, self.slow);
        let over_rate = |rate: f64| if rate > 0.0 { most * trig::tanh(rate / slow) / rate } else { 0.0 };
        self.relative.scale(rate.map(over_rate))
    }
}
