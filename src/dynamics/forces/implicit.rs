//! Damping at the end of a step, linearly implicit (Rosenbrock 1963; Hairer and Wanner 1996, section IV.7).
//!
//! The forces at a step's end meet velocities that were predicted with the accelerations a at its begin. With f, what
//! these forces make of the carts, the trapezoidal rule asks for a' = a + (I + h/2 M⁻¹ C)⁻¹ (f − a), where C are the
//! dampers of joints and wheels. Its first approximation, I − h/2 M⁻¹ Cᵏ, needs the nearest neighbours only: Cᵏ is C with
//! each damper c taken as c/(1 + h/2 λ), where λ is the fastest rate at which the dampers of its direction act. So it is
//! exact where carts move alike, and where neighbours move against each other, as fast as it can be. See
//! [`stable`](crate::dynamics::step::stable) for the steps that it leaves stable.

use super::{Evaluation, arm, load, store};
use crate::dynamics::lanes::{Axes, Lane, Lane3, Splat};
use crate::dynamics::model::Model;
use crate::dynamics::state::{PACK, PackRow};
use crate::dynamics::step::kick;
use pulp::Simd;

/// How the contacts of several carts are damped, N s/m.
pub(super) struct Dampings<S: Simd> {
    /// Of the joint behind, along the cart's axes.
    pub joint: Lane3<S>,
    /// Of the steering wheels, the left and the right running wheel.
    pub wheels: [Lane<S>; 3],
    /// The fastest rates at which they act along the chain, to its side and upwards, 1/s.
    pub rates: Lane3<S>,
}

/// The fastest rates at which dampers act on carts of some packs, along the chain and across it, 1/s.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Fastest {
    along: PackRow,
    across: PackRow,
}

impl Fastest {
    /// Of all carts.
    pub fn of_all(&self) -> [f64; 2] {
        let larger = |a: f64, b: &f64| if *b > a { *b } else { a };
        [self.along.iter().fold(0.0, larger), self.across.iter().fold(0.0, larger)]
    }
}

/// What is held of a pack until its neighbours are there.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Held {
    /// f − a, in the world, m/s², and in the cart's axes, rad/s².
    linear: [PackRow; 3],
    angular: [PackRow; 3],
    /// h/2 Cᵏ of the joint behind and of the wheels, kg.
    joint: [PackRow; 3],
    wheels: [PackRow; 3],
}

impl Evaluation<'_> {
    /// How the joint behind several carts and their wheels are damped. Two dampers of a direction act no faster than
    /// both together.
    #[inline(always)]
    pub(super) fn dampings<S: Simd>(
        &mut self,
        simd: S,
        pack: usize,
        part: usize,
        joint: Lane3<S>,
        wheels: [Lane<S>; 3],
    ) -> Dampings<S> {
        let c = Splat(simd);
        let answers = &self.model.answers;
        let [steering, left, right] = wheels;
        let Lane3 { x, y, z } = joint;
        let (ends, running) = (c.of(answers.ends), left.select(right.less(left), right));
        let along = x * c.of(answers.along);
        let lateral = y.mul_add(ends, steering * c.of(answers.front));
        let vertical = z.mul_add(ends, running * c.of(answers.wheels));
        // Idle places say nothing.
        if (pack + 1) * PACK <= self.model.carts {
            let fastest = &mut self.forces.fastest;
            let most = Lane::of(simd, &fastest.along, part);
            along.select(most.less(along), most).put(&mut fastest.along, part);
            let most = Lane::of(simd, &fastest.across, part);
            let most = lateral.select(most.less(lateral), most);
            vertical.select(most.less(vertical), most).put(&mut fastest.across, part);
        }
        Dampings { joint, wheels, rates: Lane3::new(along, lateral, vertical) }
    }

    /// Holds what forces make of several carts after a step; without a step it is their accelerations.
    #[inline(always)]
    pub(super) fn hold<S: Simd>(
        &mut self,
        simd: S,
        pack: usize,
        part: usize,
        axes: &Axes<S>,
        [linear, angular]: [Lane3<S>; 2],
        dampings: &Dampings<S>,
    ) {
        let Some(h) = self.step else {
            let accelerations = &mut self.accelerations[pack];
            linear.put(&mut accelerations.linear, part);
            angular.put(&mut accelerations.angular, part);
            return;
        };
        let c = Splat(simd);
        let half = c.of(0.5 * h);
        let before = &self.accelerations[pack];
        let linear = linear - Lane3::of(simd, &before.linear, part);
        let angular = angular - Lane3::of(simd, &before.angular, part);
        let held = &mut self.forces.held[pack];
        linear.put(&mut held.linear, part);
        angular.put(&mut held.angular, part);

        let one = c.of(1.0);
        let Lane3 { x, y, z } = dampings.joint.scale(half);
        let [steering, left, right] = dampings.wheels;
        let (steering, left, right) = (steering * half, left * half, right * half);
        let rates = dampings.rates;
        let along = rates.x.mul_add(half, one);
        let lateral = rates.y.mul_add(half, one);
        let vertical = rates.z.mul_add(half, one);
        // All with one division.
        let both = lateral * vertical;
        let inverse = one.over(along * both);
        let of_along = inverse * along;
        let (along, lateral, vertical) = (inverse * both, of_along * vertical, of_along * lateral);
        Lane3::new(x * along, y * lateral, z * vertical).put(&mut held.joint, part);
        Lane3::new(steering * lateral, left * vertical, right * vertical).put(&mut held.wheels, part);

        // ω' × (x, 0, z)
        let [x, z] = arm(simd, self.model);
        let swing = Lane3::new(angular.y * z, angular.x.neg_mul_add(z, angular.z * x), -(angular.y * x));
        let place = pack * PACK + part * S::F64_LANES;
        store(linear + axes.turn(swing), &mut self.forces.front_change, place);
    }

    /// Damps what is held of several carts by their wheels and the joints behind them, and keeps what these do to the
    /// followers.
    #[inline(always)]
    pub(super) fn damp<S: Simd>(&mut self, simd: S, pack: usize, part: usize) {
        let c = Splat(simd);
        let model = self.model;
        let place = pack * PACK + part * S::F64_LANES;
        let forces = &mut *self.forces;
        let axes = Axes::of_rows(simd, &forces.places[pack].axes, part);
        let held = &mut forces.held[pack];
        let angular = Lane3::of(simd, &held.angular, part);
        let front = load(simd, &forces.front_change, place);
        let apart = axes.turn_back(load(simd, &forces.front_change, place + 1) - front);
        // Less ω' × (−L, 0, 0).
        let length = c.of(model.cart.length);
        let apart = Lane3::new(apart.x, length.mul_add(angular.z, apart.y), length.neg_mul_add(angular.y, apart.z));
        let behind = apart.times(Lane3::of(simd, &held.joint, part));
        let wheels = Lane3::of(simd, &held.wheels, part);
        let roll = c.of(model.running.half_spacing) * angular.x;
        let (sideways, upwards) = (axes.eta.dot(front), axes.zeta.dot(front));
        let left = wheels.y * (upwards + roll);
        let right = wheels.z * (upwards - roll);
        let (sideways, upwards) = (-(wheels.x * sideways), -(left + right));

        let world = axes.turn(behind);
        let own = axes.zeta.scale_add(upwards, axes.eta.scale_add(sideways, world));
        let per_mass = c.of(1.0 / model.cart.mass);
        own.scale_add(per_mass, Lane3::of(simd, &held.linear, part)).put(&mut held.linear, part);
        let [x, z] = arm(simd, model);
        let rear = x - length;
        let torque = Lane3::new(
            c.of(model.running.half_spacing).neg_mul_add(left - right, -(z * (behind.y + sideways))),
            rear.neg_mul_add(behind.z, x.neg_mul_add(upwards, z * behind.x)),
            rear.mul_add(behind.y, x * sideways),
        );
        let turned = torque.times(per_inertia(simd, model));
        (angular + turned).put(&mut held.angular, part);
        store(world, &mut forces.damped, place + 1);
    }

    /// Damps what is held of several carts by the joints in front of them, and ends their step h, s, with it.
    #[inline(always)]
    pub(super) fn release<S: Simd>(&mut self, simd: S, pack: usize, part: usize, h: f64) {
        let c = Splat(simd);
        let model = self.model;
        let forces = &*self.forces;
        let axes = Axes::of_rows(simd, &forces.places[pack].axes, part);
        let held = &forces.held[pack];
        let ahead = load(simd, &forces.damped, pack * PACK + part * S::F64_LANES);
        let linear = ahead.scale_add(c.of(-1.0 / model.cart.mass), Lane3::of(simd, &held.linear, part));
        let [x, z] = arm(simd, model);
        let torque = super::lever(x, z, axes.turn_back(ahead));
        let angular = Lane3::of(simd, &held.angular, part) - torque.times(per_inertia(simd, model));
        kick(simd, &mut self.bodies[pack], &mut self.accelerations[pack], [linear, angular], part, h);
    }
}

/// 1/I of the carts about their axes, 1/(kg m²).
#[inline(always)]
fn per_inertia<S: Simd>(simd: S, model: &Model) -> Lane3<S> {
    let c = Splat(simd);
    let [x, y, z] = model.cart.inertia;
    Lane3::new(c.of(1.0 / x), c.of(1.0 / y), c.of(1.0 / z))
}
