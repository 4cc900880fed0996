//! Linear motors: what they do to the carts whose plates lie over them (design: chain model, linear motors).

use super::{Evaluation, Forces, Memory, arm, lever, load};
use crate::dynamics::coverage::LEAST_SHARE;
use crate::dynamics::lanes::{Axes, Lane, Lane3, Splat};
use crate::dynamics::model::Model;
use crate::dynamics::segments::{Handover, Home, Homes, Local, Segments, foot};
use crate::dynamics::state::{Accelerations, PACK};
use pulp::{Simd, WithSimd};

impl Evaluation<'_> {
    /// Fills `share`: of each plate, from the cart's front joint to its follower's, what lies over motors.
    #[inline(always)]
    pub(super) fn motors<S: Simd>(&mut self, simd: S, pack: usize, part: usize) {
        let place = pack * PACK + part * S::F64_LANES;
        let forces = &mut *self.forces;
        let before = Lane::load(simd, &forces.share[place..]);
        let (own, behind) =
            (Lane::load(simd, &forces.covered[place..]), Lane::load(simd, &forces.covered[place + 1..]));
        let share = own - behind;
        let least = share.constant(LEAST_SHARE);
        // Where the lap begins, all motors of the lap are between.
        let share = (share + share.constant(self.model.coverage.total)).select(share.less(-least), share);
        let driven = least.less(share);
        share.select(driven, share.constant(0.0)).store(&mut forces.share[place..]);
        if driven.and(before.less(least)).any() {
            let home = &mut self.memory.home[pack];
            let lanes = part * S::F64_LANES..(part + 1) * S::F64_LANES;
            come_over(&self.model.segments, home, &forces.share[pack * PACK..], lanes);
        }
        if !self.model.even && driven.any() {
            uneven(self.model, forces, place..place + S::F64_LANES);
        }
    }
}

/// Where motors act is sought from where the cart's front joint is, once a cart comes over one: since the motor before, it
/// may have passed segments that go on beside the one where it is.
#[cold]
#[inline(never)]
fn come_over(segments: &Segments, home: &mut Homes, share: &[f64], lanes: std::ops::Range<usize>) {
    for lane in lanes.filter(|lane| share[*lane] > 0.0) {
        let segment = home.front.segment[lane] as usize;
        home.motor.set(lane, segment, &segments.list[segment]);
    }
}

/// Shares of plates over motors that are not alike, each times its motor's factor.
#[cold]
#[inline(never)]
fn uneven(model: &Model, forces: &mut Forces, places: std::ops::Range<usize>) {
    let (lap, length) = (model.segments.line.length, model.motors.length);
    for cart in places {
        if forces.share[cart] == 0.0 || cart >= model.carts {
            continue;
        }
        let follower = if cart + 1 == model.carts { 0 } else { cart + 1 };
        let plate = (forces.station[cart] - forces.station[follower]).rem_euclid(lap);
        let over = |(motor, begin): (usize, &f64)| {
            let ahead = (forces.station[cart] - begin).rem_euclid(lap);
            let own = (ahead.min(length) - (ahead - plate).max(0.0)).max(0.0) / length;
            // Deviations cost nothing where there are none.
            if own > 0.0 { own * model.deviations.factor(motor, ahead) } else { 0.0 }
        };
        forces.share[cart] = model.motors.s.iter().enumerate().map(over).sum();
    }
}

/// What a newton of the motors' command does to several carts.
pub(super) struct Thrust<S: Simd> {
    /// In the world, N.
    pub force: Lane3<S>,
    /// About the centre of mass, in the cart's axes, N m.
    pub torque: Lane3<S>,
}

/// The motors' thrust on parts of plates, along the track nearest the middle of each cart.
#[inline(always)]
pub(super) fn thrust<S: Simd, const LEVEL: bool>(
    simd: S,
    model: &Model,
    home: &mut Home,
    part: usize,
    front: Lane3<S>,
    axes: &Axes<S>,
    share: Lane<S>,
) -> Thrust<S> {
    let c = Splat(simd);
    let (back, down) = (c.of(-0.5 * model.cart.length), c.of(-model.cart.motor_height));
    let point = axes.xi.scale_add(back, axes.zeta.scale_add(down, front));
    let segments: &Segments = &model.segments;
    let local = Local::load(simd, home, part, segments.sharp);
    let middle = foot::<S, LEVEL>(&local, point);
    let mut tangent = middle.tangent;
    let outside = middle.outside(&local).and(c.of(0.0).less(share));
    if outside.any() {
        let (there, _) = simd.vectorize(Handover::<S, LEVEL> { simd, segments, home, part, point, outside });
        tangent = there.tangent;
    }
    let force = tangent.scale(share);
    let [x, z] = arm(simd, model);
    Thrust { force, torque: lever(x + back, z + down, axes.turn_back(force)) }
}

/// Adds to accelerations what a change of the motors' command does.
pub struct CommandChange<'a> {
    pub model: &'a Model,
    pub memory: &'a mut Memory,
    pub forces: &'a Forces,
    pub accelerations: &'a mut [Accelerations],
    /// N
    pub change: f64,
}

impl WithSimd for CommandChange<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        for pack in 0..self.accelerations.len() {
            for part in 0..PACK / S::F64_LANES {
                if self.model.segments.level {
                    self.push::<S, true>(simd, pack, part);
                } else {
                    self.push::<S, false>(simd, pack, part);
                }
            }
        }
    }
}

impl CommandChange<'_> {
    #[inline(always)]
    fn push<S: Simd, const LEVEL: bool>(&mut self, simd: S, pack: usize, part: usize) {
        let c = Splat(simd);
        let place = pack * PACK + part * S::F64_LANES;
        let share = Lane::load(simd, &self.forces.share[place..]);
        if !c.of(0.0).less(share).any() {
            return;
        }
        let axes = Axes::of_rows(simd, &self.forces.places[pack].axes, part);
        let front = load(simd, &self.forces.front, place);
        let home = &mut self.memory.home[pack].motor;
        let Thrust { force, torque } = thrust::<S, LEVEL>(simd, self.model, home, part, front, &axes, share);
        let (per_mass, per_inertia) = answers(simd, self.model, self.forces, pack, part);
        let accelerations = &mut self.accelerations[pack];
        let change = c.of(self.change);
        let linear = Lane3::of(simd, &accelerations.linear, part);
        force.scale(per_mass).scale_add(change, linear).put(&mut accelerations.linear, part);
        let angular = Lane3::of(simd, &accelerations.angular, part);
        torque.times(per_inertia).scale_add(change, angular).put(&mut accelerations.angular, part);
    }
}

/// One over the mass, 1/kg, and over the inertia, 1/(kg m²).
#[inline(always)]
pub(super) fn answers<S: Simd>(
    simd: S,
    model: &Model,
    forces: &Forces,
    pack: usize,
    part: usize,
) -> (Lane<S>, Lane3<S>) {
    let c = Splat(simd);
    let [ix, iy, iz] = model.cart.inertia;
    let per_mass = c.of(1.0 / model.cart.mass);
    let per_inertia = Lane3::new(c.of(1.0 / ix), c.of(1.0 / iy), c.of(1.0 / iz));
    match forces.built.get(pack) {
        Some(built) => {
            let lightness = Lane::of(simd, &built.lightness, part);
            (per_mass * lightness, per_inertia.scale(lightness))
        }
        None => (per_mass, per_inertia),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig;
    use crate::chain_input::{Deviations, Ripple, Simulation};
    use crate::compiled::fixture::compile;
    use crate::model::fixture;

    /// Sines of twice and three times an angle by those of the angle.
    fn closed_sum(ratios: [f64; 3], phases: [f64; 3], angle: f64) -> f64 {
        let (s, c) = trig::sin_cos(angle);
        let sines = [s, 2.0 * s * c, 3.0 * s - 4.0 * s * s * s];
        let cosines = [c, 1.0 - 2.0 * s * s, 4.0 * c * c * c - 3.0 * c];
        let wave = |k: usize| ratios[k] * (sines[k] * trig::cos(phases[k]) + cosines[k] * trig::sin(phases[k]));
        (0..3).map(wave).sum()
    }

    #[test]
    fn thrust_ripples_by_the_closed_sum_and_is_as_large_on_average() {
        const PLACES: usize = 4000;
        let mut input = Simulation::new(&compile(fixture::rectangle(20.0, 12.0, 4.0)));
        input.motors.s_m = vec![3.0];
        let (ratios, phases) = ([0.3, 0.2, 0.1], [0.4, -1.1, 2.0]);
        // Ripple has no mean where pitches of its poles fill the motor.
        let wavelength = input.motors.length_m / 5.0;
        let ripple = Ripple { ratios, wavelength, phases };
        let model = Model::new(&input, Deviations { ripple, ..Deviations::default() }).expect("a model");
        assert!(!model.even);
        let lap = model.segments.line.length;
        let plate = lap / model.carts as f64;
        let mut forces = Forces::new(&model);
        let (mut whole, mut even, mut off) = (0.0, 0.0, 0.0_f64);
        for place in 0..PLACES {
            let mut expected = vec![0.0; model.carts];
            let mut plain = 0.0;
            for (cart, expected) in expected.iter_mut().enumerate() {
                let front = (3.0 + plate * (place as f64 / PLACES as f64 - cart as f64)).rem_euclid(lap);
                (forces.station[cart], forces.share[cart]) = (front, 1.0);
                // Where plate and motor lie over each other.
                let (from, to) = ((front - plate).max(3.0), front.min(3.0 + input.motors.length_m));
                let own = (to - from).max(0.0) / input.motors.length_m;
                plain += own;
                *expected = own * (1.0 + closed_sum(ratios, phases, trig::TAU * (front - 3.0) / wavelength));
            }
            uneven(&model, &mut forces, 0..model.carts);
            for (found, expected) in forces.share.iter().zip(&expected) {
                off = off.max((found - expected).abs());
            }
            (whole, even) = (whole + forces.share[..model.carts].iter().sum::<f64>(), even + plain);
        }
        assert!(off < 1e-9, "{off}");
        assert!((even / PLACES as f64 - 1.0).abs() < 1e-9, "{even}");
        assert!((whole / even - 1.0).abs() < 1e-4, "{whole} for {even}");
    }
}
