//! Last: all forces on a cart, into its accelerations (design: chain model).

use super::motors::{Thrust, answers, thrust};
use super::{Evaluation, Turned, arm, lever, load};
use crate::dynamics::lanes::{Lane, Lane3, Splat};
use crate::dynamics::model::OFF_RAIL;
use crate::dynamics::state::PACK;
use pulp::Simd;

impl Evaluation<'_> {
    /// Accelerations of several carts. Returns whether a cart is in trouble.
    #[inline(always)]
    pub(super) fn carts<S: Simd, const LEVEL: bool>(&mut self, simd: S, pack: usize, part: usize) -> bool {
        let c = Splat(simd);
        let place = pack * PACK + part * S::F64_LANES;
        let turned = self.turned(simd, pack, part);
        let [joint, joint_damping] = self.joints(simd, pack, part, &turned);
        let wheels = self.wheels::<S, LEVEL>(simd, pack, part, &turned);

        let Turned { axes, spin } = &turned;
        let mut at_front = wheels.steering + wheels.running - load(simd, &self.forces.pull, place);
        let mut torque = joint + wheels.torque;
        if let Some(built) = self.forces.built.get(pack) {
            at_front = at_front + Lane3::of(simd, &built.push, part);
            torque = torque + Lane3::of(simd, &built.torque, part);
        }
        if self.model.deviations.joint_friction > 0.0 {
            torque = torque - axes.turn_back(load(simd, &self.forces.twist, place));
        }
        let [x, z] = arm(simd, self.model);
        torque = torque + lever(x, z, axes.turn_back(at_front));
        let mut force = at_front + load(simd, &self.forces.pull, place + 1);

        let share = Lane::load(simd, &self.forces.share[place..]);
        if c.of(0.0).less(share).any() {
            let (front, home) = (load(simd, &self.forces.front, place), &mut self.memory.home[pack].motor);
            let of_one = thrust::<S, LEVEL>(simd, self.model, home, part, front, axes, share);
            let command = c.of(self.command);
            let Thrust { force: more, torque: turning } = of_one;
            (force, torque) = (more.scale_add(command, force), turning.scale_add(command, torque));
        }

        // Newton and Euler.
        let [ix, iy, iz] = self.model.cart.inertia;
        let (per_mass, per_inertia) = answers(simd, self.model, self.forces, pack, part);
        let mut linear = force.scale(per_mass);
        linear.z = linear.z - c.of(self.model.gravity);
        let gyroscopic = Lane3::new(
            spin.y * spin.z * c.of(iz - iy),
            spin.z * spin.x * c.of(ix - iz),
            spin.x * spin.y * c.of(iy - ix),
        );
        let angular = (torque - gyroscopic).times(per_inertia);
        let dampings = self.dampings(simd, pack, part, joint_damping, wheels.damping);
        self.hold(simd, pack, part, axes, [linear, angular], &dampings);

        let placed = &self.forces.places[pack];
        let near = c.of(OFF_RAIL);
        let (y, z) = (Lane::of(simd, &placed.y, part), Lane::of(simd, &placed.z, part));
        let on_rail = y.abs().less(near).and(z.abs().less(near));
        let axial = Lane::of(simd, &self.forces.loads[pack].joint[0], part);
        let whole = axial.abs().less(c.of(self.model.breaking));
        let finite = (linear.x + angular.x).abs().less(c.of(f64::MAX));
        !on_rail.and(whole).and(finite).all()
    }
}
