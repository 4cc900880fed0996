//! What a built chain's deviations do to each cart: offsets of rails and wheels, dry friction, drag. One cart after the other, as only
//! simulations with effects pay for it.

use super::Forces;
use crate::dynamics::deviations::closed;
use crate::dynamics::inspect::{attitude, vector};
use crate::dynamics::model::Model;
use crate::dynamics::segments::Home;
use crate::dynamics::state::{Bodies, PACK, Row};
use crate::geometry::trig;
use nalgebra::Vector3;

/// Of a pack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Built {
    /// Of the rails and wheels: to the left; upwards on the left and on the right, m.
    pub offset: [Row; 3],
    /// Their rates, m/s.
    pub rate: [Row; 3],
    /// Force at the front joint, in the world, N.
    pub push: [Row; 3],
    /// Nominal over real mass.
    pub lightness: Row,
}

impl Default for Built {
    fn default() -> Self {
        Built { offset: [[0.0; PACK]; 3], rate: [[0.0; PACK]; 3], push: [[0.0; PACK]; 3], lightness: [1.0; PACK] }
    }
}

/// Fills `forces.built`, and adds to the joints' torques.
pub(super) fn build(model: &Model, bodies: &[Bodies], home: &[Home], forces: &mut Forces) {
    let deviations = &model.deviations;
    let lap = model.segments.line.length;
    let [slow, slow_turn] = deviations.smoothing;
    let radii = [model.steering.radius, model.running.radius, model.running.radius];
    let spin = |i: usize| attitude(&bodies[i / PACK], i % PACK) * vector(&bodies[i / PACK].spin, i % PACK);
    for i in 0..model.carts {
        let (pack, lane) = (i / PACK, i % PACK);
        let (station, speed) = (forces.station[i], forces.speed[i]);
        let built = &mut forces.built[pack];
        for k in 0..3 {
            let (offset, slope) = deviations.offset(k, i, station, lap, radii[k]);
            built.offset[k][lane] = offset;
            built.rate[k][lane] = slope * speed;
        }
        built.lightness[lane] = 1.0 / (1.0 + deviations.load.get(i).copied().unwrap_or(0.0));

        let turn = attitude(&bodies[pack], lane);
        let forward = turn * Vector3::x();
        let velocity = Vector3::from(std::array::from_fn::<f64, 3, _>(|k| forces.front_velocity[k][i]));
        let load: f64 = forces.loads[pack].running.iter().map(|row| row[lane].abs()).sum();
        let frame = model.segments.list[home[pack].segment[lane] as usize];
        let normal = frame.normal_at(station);
        let lateral = velocity.dot(&normal);
        let slide = -deviations.sliding * load * trig::tanh(lateral / slow);
        let (side, _) = closed(&deviations.side_force, station / lap);
        let (resistance, _) = closed(&deviations.resistance, station / lap);
        let drag = -deviations.drag * speed * speed.abs() - resistance;
        let push = forward * drag + normal * (slide + side);
        for k in 0..3 {
            built.push[k][lane] = push[k];
        }
        if deviations.swivel > 0.0 {
            // How fast the cart turns against the track under its fork.
            let yaw = spin(i).z - frame.turning() * speed;
            forces.joint_torque[pack][2][lane] -= deviations.swivel * trig::tanh(yaw / slow_turn);
        }
        if deviations.joint_friction > 0.0 {
            let follower = (i + 1) % model.carts;
            let relative = spin(follower) - spin(i);
            let rate = relative.norm();
            if rate > 0.0 {
                let torque = relative * (deviations.joint_friction * trig::tanh(rate / slow_turn) / rate);
                let mut add = |cart: usize, torque: Vector3<f64>| {
                    let (pack, lane) = (cart / PACK, cart % PACK);
                    let own = attitude(&bodies[pack], lane).inverse() * torque;
                    for k in 0..3 {
                        forces.joint_torque[pack][k][lane] += own[k];
                    }
                };
                add(i, torque);
                add(follower, -torque);
            }
        }
    }
}
