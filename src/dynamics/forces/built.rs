//! What a built chain's deviations do to each cart: offsets of rails and wheels, dry friction, drag. One cart after the
//! other, as only simulations with effects pay for it.

use super::Forces;
use crate::base::trig;
use crate::chain_input::closed;
use crate::dynamics::model::Model;
use crate::dynamics::segments::Home;
use crate::dynamics::state::{Bodies, PACK, PackRow, attitude, vector};
use nalgebra::Vector3;

/// Of a pack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Built {
    /// Of the rails and wheels: to the left; upwards on the left and on the right, m.
    pub offset: [PackRow; 3],
    /// Their rates, m/s.
    pub rate: [PackRow; 3],
    /// Force at the front joint, in the world, N.
    pub push: [PackRow; 3],
    /// Nominal over real mass.
    pub lightness: PackRow,
}

impl Default for Built {
    fn default() -> Self {
        Built { offset: [[0.0; PACK]; 3], rate: [[0.0; PACK]; 3], push: [[0.0; PACK]; 3], lightness: [1.0; PACK] }
    }
}

/// Fills `forces.built`, and adds to the joints' torques.
pub(super) fn build(model: &Model, bodies: &[Bodies], home: &[Home], forces: &mut Forces) {
    let deviations = &model.deviations;
    if deviations.has_profiles() {
        profiles(model, forces);
    }
    if !deviations.load.is_empty() {
        for (i, load) in deviations.load.iter().enumerate().take(model.carts) {
            forces.built[i / PACK].lightness[i % PACK] = 1.0 / (1.0 + load);
        }
    }
    if deviations.has_pushes() {
        pushes(model, bodies, home, forces);
    }
    if deviations.swivel > 0.0 || deviations.joint_friction > 0.0 {
        moments(model, bodies, home, forces);
    }
}

/// Offsets of rails and wheels.
fn profiles(model: &Model, forces: &mut Forces) {
    let lap = model.segments.line.length;
    let radii = [model.steering.radius, model.running.radius, model.running.radius];
    for i in 0..model.carts {
        let built = &mut forces.built[i / PACK];
        for (k, radius) in radii.into_iter().enumerate() {
            let (offset, slope) = model.deviations.offset(k, i, forces.station[i], lap, radius);
            built.offset[k][i % PACK] = offset;
            built.rate[k][i % PACK] = slope * forces.speed[i];
        }
    }
}

/// Forces along and across the track.
fn pushes(model: &Model, bodies: &[Bodies], home: &[Home], forces: &mut Forces) {
    let deviations = &model.deviations;
    let lap = model.segments.line.length;
    for i in 0..model.carts {
        let (pack, lane) = (i / PACK, i % PACK);
        let (station, speed) = (forces.station[i], forces.speed[i]);
        let (resistance, _) = closed(&deviations.resistance, station / lap);
        let drag = -deviations.drag * speed * speed.abs() - resistance;
        let mut push = attitude(&bodies[pack], lane) * Vector3::x() * drag;
        if deviations.sliding > 0.0 || !deviations.side_force.is_empty() {
            let normal = model.segments.list[home[pack].segment[lane] as usize].normal_at(station);
            let lateral = (0..3).map(|k| forces.front_velocity[k][i] * normal[k]).sum::<f64>();
            let load: f64 = forces.loads[pack].running.iter().map(|row| row[lane].abs()).sum();
            let slide = -deviations.sliding * load * trig::tanh(lateral / deviations.smoothing[0]);
            let (side, _) = closed(&deviations.side_force, station / lap);
            push += normal * (slide + side);
        }
        let built = &mut forces.built[pack];
        (0..3).for_each(|k| built.push[k][lane] = push[k]);
    }
}

/// Dry friction against turning: of forks on the track, and of carts on each other.
fn moments(model: &Model, bodies: &[Bodies], home: &[Home], forces: &mut Forces) {
    let deviations = &model.deviations;
    let slow = deviations.smoothing[1];
    let turn = |i: usize| attitude(&bodies[i / PACK], i % PACK);
    let spin = |i: usize| turn(i) * vector(&bodies[i / PACK].spin, i % PACK);
    let first = spin(0);
    let mut own = first;
    for i in 0..model.carts {
        let (pack, lane) = (i / PACK, i % PACK);
        let follower = if i + 1 == model.carts { 0 } else { i + 1 };
        let next = if follower == 0 { first } else { spin(follower) };
        if deviations.swivel > 0.0 {
            // How fast the cart turns against the track under its fork.
            let segment = &model.segments.list[home[pack].segment[lane] as usize];
            let yaw = own.z - segment.turning() * forces.speed[i];
            forces.joint_torque[pack][2][lane] -= deviations.swivel * trig::tanh(yaw / slow);
        }
        let relative = next - own;
        let rate = relative.norm();
        if deviations.joint_friction > 0.0 && rate > 0.0 {
            let torque = relative * (deviations.joint_friction * trig::tanh(rate / slow) / rate);
            let mut add = |cart: usize, torque: Vector3<f64>| {
                let own = turn(cart).inverse() * torque;
                (0..3).for_each(|k| forces.joint_torque[cart / PACK][k][cart % PACK] += own[k]);
            };
            add(i, torque);
            add(follower, -torque);
        }
        own = next;
    }
}
