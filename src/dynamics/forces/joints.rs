//! Second pass: the joint between each cart and its follower (design: chain model, joints).

use super::{Evaluation, arm, axes, load, store};
use crate::dynamics::contact::{Joint, fresh_joint, joint, refreshed};
use crate::dynamics::lanes::{Lane, Lane3, Splat};
use crate::dynamics::state::PACK;
use pulp::Simd;

impl Evaluation<'_> {
    #[inline(always)]
    pub(super) fn joints<S: Simd>(&mut self, simd: S, pack: usize, part: usize) {
        let model = self.model;
        let c = Splat(simd);
        let bodies = &self.bodies[pack];
        let axes = axes(simd, bodies, part);
        let spin = Lane3::of(simd, &bodies.spin, part);
        let place = pack * PACK + part * S::F64_LANES;
        let forces = &mut *self.forces;
        let behind = load(simd, &forces.front, place + 1) - load(simd, &forces.front, place);
        let relative = load(simd, &forces.front_velocity, place + 1) - load(simd, &forces.front_velocity, place);
        // e and its rate in the leader's axes; its rear joint is at (−L, 0, 0) and moves there with ω × (−L, 0, 0).
        let mut length = c.of(model.cart.length);
        if let Some(row) = model.longer.get(pack) {
            length = length + Lane::of(simd, row, part);
        }
        let mut e = axes.turn_back(behind);
        e.x = e.x + length;
        let rear = Lane3::new(c.of(0.0), -(spin.z * length), spin.y * length);
        let rate = axes.turn_back(relative) - rear - spin.cross(e);

        let approach = &mut self.memory.approach[pack].joint;
        let memory = Lane3::of(simd, approach, part);
        let (mut x, mut y, mut z) =
            (Joint::new(e.x, rate.x, memory.x), Joint::new(e.y, rate.y, memory.y), Joint::new(e.z, rate.z, memory.z));
        if model.deviations.clearance > 0.0 {
            let half = c.of(0.5 * model.deviations.clearance);
            x.ease(half);
            y.ease(half);
            z.ease(half);
        }
        let (mut mx, mut my, mut mz) = (x.memory, y.memory, z.memory);
        if fresh_joint(&x).or(fresh_joint(&y)).or(fresh_joint(&z)).any() {
            mx = refreshed(fresh_joint(&x), model.floor, rate.x.abs(), mx);
            my = refreshed(fresh_joint(&y), model.floor, rate.y.abs(), my);
            mz = refreshed(fresh_joint(&z), model.floor, rate.z.abs(), mz);
            if self.commit {
                Lane3::new(x.signed(mx), y.signed(my), z.signed(mz)).put(approach, part);
            }
        }
        let force = Lane3::new(joint(&model.axial, &x, mx), joint(&model.radial, &y, my), joint(&model.radial, &z, mz));
        store(-axes.turn(force), &mut forces.pull, place + 1);
        force.put(&mut forces.loads[pack].joint, part);
        // The reaction acts at the follower's front joint.
        let arm = arm(simd, model);
        let lever = Lane3::new(e.x + arm.x - length, e.y, e.z + arm.z);
        lever.cross(force).put(&mut forces.joint_torque[pack], part);
    }
}
