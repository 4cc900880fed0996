//! First: the step to where the carts are now; where their front joints are, how they move, and their place on the
//! track.

use super::{Evaluation, arm, store};
use crate::dynamics::coverage::covered;
use crate::dynamics::lanes::{Axes, Lane3};
use crate::dynamics::segments::feet;
use crate::dynamics::state::PACK;
use crate::dynamics::step::drift;
use pulp::Simd;

impl Evaluation<'_> {
    #[inline(always)]
    pub(super) fn fronts<S: Simd, const LEVEL: bool>(&mut self, simd: S, pack: usize, part: usize) {
        let model = self.model;
        let bodies = &mut self.bodies[pack];
        if let Some(h) = self.step {
            drift(simd, bodies, &self.accelerations[pack], part, h);
        }
        let axes = Axes::of_attitude(simd, &bodies.attitude, part);
        let spin = Lane3::of(simd, &bodies.spin, part);
        let [x, z] = arm(simd, model);
        // ω × (x, 0, z)
        let swing = Lane3::new(spin.y * z, spin.x.neg_mul_add(z, spin.z * x), -(spin.y * x));
        let point = axes.xi.scale_add(x, axes.zeta.scale_add(z, Lane3::of(simd, &bodies.position, part)));
        let velocity = Lane3::of(simd, &bodies.velocity, part) + axes.turn(swing);
        let place = pack * PACK + part * S::F64_LANES;
        let forces = &mut *self.forces;
        store(point, &mut forces.front, place);
        store(velocity, &mut forces.front_velocity, place);
        if model.deviations.joint_friction > 0.0 {
            store(axes.turn(spin), &mut forces.front_spin, place);
        }
        let home = &mut self.memory.home[pack].front;
        let (foot, station) = feet::<S, LEVEL>(simd, &model.segments, home, part, point);
        station.store(&mut forces.station[place..]);
        foot.rail().along::<LEVEL>(velocity).store(&mut forces.speed[place..]);
        covered(simd, &model.coverage, &mut self.memory.motors[pack], part, station)
            .store(&mut forces.covered[place..]);
        let placed = &mut forces.places[pack];
        axes.put(&mut placed.axes, part);
        foot.tangent.x.put(&mut placed.tangent[0], part);
        foot.tangent.y.put(&mut placed.tangent[1], part);
        if !LEVEL {
            foot.tangent.z.put(&mut placed.tangent[2], part);
            foot.normal.put(&mut placed.normal, part);
        }
        foot.y.put(&mut placed.y, part);
        foot.z.put(&mut placed.z, part);
    }
}
