//! What a built chain's deviations do to each cart: offsets of rails and wheels, dry friction, drag. One cart after the
//! other, as only simulations with effects pay for it.

use super::Forces;
use crate::base::trig;
use crate::chain_input::closed;
use crate::dynamics::model::Model;
use crate::dynamics::segments::Home;
use crate::dynamics::state::{Bodies, PACK, PackRow};

/// Of a pack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Built {
    /// Of the rails and wheels: to the left; upwards on the left and on the right, m.
    pub offset: [PackRow; 3],
    /// Their rates, m/s.
    pub rate: [PackRow; 3],
    /// Force at the front joint, in the world, N.
    pub push: [PackRow; 3],
    /// Torque about the centre of mass, in the cart's axes, N m.
    pub torque: [PackRow; 3],
    /// Nominal over real mass.
    pub lightness: PackRow,
}

impl Default for Built {
    fn default() -> Self {
        let zero = [[0.0; PACK]; 3];
        Built { offset: zero, rate: zero, push: zero, torque: zero, lightness: [1.0; PACK] }
    }
}

/// Works them out for a pack, from the forces of the last evaluation and where its carts are now.
#[cold]
#[inline(never)]
pub(super) fn build(model: &Model, home: &Home, bodies: &Bodies, pack: usize, forces: &Forces, built: &mut Built) {
    let deviations = &model.deviations;
    let carts = PACK.min(model.carts - pack * PACK);
    if deviations.has_profiles() {
        profiles(model, pack, carts, forces, built);
    }
    for lane in 0..carts {
        let load = deviations.load.get(pack * PACK + lane).copied().unwrap_or(0.0);
        built.lightness[lane] = 1.0 / (1.0 + load);
    }
    if deviations.has_pushes() {
        pushes(model, home, pack, carts, forces, built);
    }
    if deviations.swivel > 0.0 {
        let [xi, eta, zeta] = [0, 1, 2].map(|axis| forces.places[pack].axes[axis][2]);
        for lane in 0..carts {
            // How fast the cart turns against the track under its fork.
            let [x, y, z] = bodies.spin.map(|row| row[lane]);
            let segment = &model.segments.list[home.segment[lane] as usize];
            let yaw =
                xi[lane] * x + eta[lane] * y + zeta[lane] * z - segment.turning() * forces.speed[pack * PACK + lane];
            built.torque[2][lane] = -deviations.swivel * trig::tanh(yaw / deviations.smoothing[1]);
        }
    }
}

/// Offsets of rails and wheels.
fn profiles(model: &Model, pack: usize, carts: usize, forces: &Forces, built: &mut Built) {
    let lap = model.segments.line.length;
    let radii = [model.steering.radius, model.running.radius, model.running.radius];
    let deviations = &model.deviations;
    for (k, radius) in radii.into_iter().enumerate() {
        if deviations.rails[k].is_empty() && deviations.wheels[k].is_empty() {
            continue;
        }
        for lane in 0..carts {
            let i = pack * PACK + lane;
            let (offset, slope) = deviations.offset(k, i, forces.station[i], lap, radius);
            built.offset[k][lane] = offset;
            built.rate[k][lane] = slope * forces.speed[i];
        }
    }
}

/// Forces along and across the track.
fn pushes(model: &Model, home: &Home, pack: usize, carts: usize, forces: &Forces, built: &mut Built) {
    let deviations = &model.deviations;
    let lap = model.segments.line.length;
    for lane in 0..carts {
        let i = pack * PACK + lane;
        let (station, speed) = (forces.station[i], forces.speed[i]);
        let (resistance, _) = closed(&deviations.resistance, station / lap);
        let drag = -deviations.drag * speed * speed.abs() - resistance;
        let mut push = [0, 1, 2].map(|k| forces.places[pack].axes[0][k][lane] * drag);
        if deviations.sliding > 0.0 || !deviations.side_force.is_empty() {
            let normal = model.segments.list[home.segment[lane] as usize].normal_at(station);
            let lateral = (0..3).map(|k| forces.front_velocity[k][i] * normal[k]).sum::<f64>();
            let load: f64 = forces.loads[pack].running.iter().map(|row| row[lane].abs()).sum();
            let slide = -deviations.sliding * load * trig::tanh(lateral / deviations.smoothing[0]);
            let (side, _) = closed(&deviations.side_force, station / lap);
            (0..3).for_each(|k| push[k] += normal[k] * (slide + side));
        }
        (0..3).for_each(|k| built.push[k][lane] = push[k]);
    }
}
