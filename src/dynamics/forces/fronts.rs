//! First pass: where the front joints are, how they move, and their place on the track.

use super::{Evaluation, arm, axes, store};
use crate::dynamics::lanes::Lane3;
use crate::dynamics::segments::{Handover, Local, Rehome, foot};
use crate::dynamics::state::PACK;
use pulp::Simd;

impl Evaluation<'_> {
    #[inline(always)]
    pub(super) fn fronts<S: Simd, const LEVEL: bool>(&mut self, simd: S, pack: usize, part: usize) {
        let bodies = &self.bodies[pack];
        let axes = axes(simd, bodies, part);
        let spin = Lane3::of(simd, &bodies.spin, part);
        let arm = arm(simd, self.model);
        let position = Lane3::of(simd, &bodies.position, part) + axes.turn(arm);
        let velocity = Lane3::of(simd, &bodies.velocity, part) + axes.turn(spin.cross(arm));
        let place = pack * PACK + part * S::F64_LANES;
        let forces = &mut *self.forces;
        store(position, &mut forces.front, place);
        store(velocity, &mut forces.front_velocity, place);
        let segments = &self.model.segments;
        let mut local = Local::load(simd, &self.memory.home[pack], part);
        let mut feet = foot::<S, LEVEL>(&local, position);
        let mut station = feet.station(&local);
        if feet.outside(&local).any() {
            simd.vectorize(Rehome::<S, LEVEL> {
                simd,
                segments,
                home: &mut self.memory.home[pack],
                part,
                point: position,
            });
            local = Local::load(simd, &self.memory.home[pack], part);
            feet = foot::<S, LEVEL>(&local, position);
            station = feet.station(&local);
            // On a spiral, still.
            let outside = feet.outside(&local);
            if outside.any() {
                let home = &self.memory.home[pack];
                (feet, station) =
                    simd.vectorize(Handover::<S, LEVEL> { simd, segments, home, part, point: position, outside });
            }
        }
        station.store(&mut forces.station[place..]);
        feet.tangent.dot(velocity).store(&mut forces.speed[place..]);
    }
}
