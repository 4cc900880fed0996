//! What a built chain's deviations do to each cart: offsets of rails and wheels, dry friction, drag. One cart after the
//! other, as only simulations with effects pay for it.

use super::Forces;
use crate::base::trig;
use crate::chain_input::{WheelPlace, closed};
use crate::dynamics::law::tangent;
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
    /// Torque about the front joint, in the cart's axes, N m.
    pub torque: [PackRow; 3],
    /// Nominal over real mass.
    pub lightness: PackRow,
    /// How far the guide gave way to the left, m, when the forces were last worked out.
    pub given: PackRow,
}

impl Default for Built {
    fn default() -> Self {
        let zero = [[0.0; PACK]; 3];
        Built { offset: zero, rate: zero, push: zero, torque: zero, lightness: [1.0; PACK], given: zero[0] }
    }
}

/// Works them out for a pack, from the forces of the last evaluation and where its carts are now.
#[cold]
#[inline(never)]
pub(super) fn build(model: &Model, home: &Home, bodies: &Bodies, pack: usize, forces: &Forces, built: &mut Built) {
    let deviations = &model.deviations;
    let carts = PACK.min(model.carts - pack * PACK);
    (built.offset[0], built.rate[0]) = ([0.0; PACK], [0.0; PACK]);
    if deviations.has_profiles() {
        profiles(model, pack, carts, forces, built);
    }
    if deviations.guides.compliance > 0.0 {
        guides(model, home, pack, carts, forces, built);
    }
    for lane in 0..carts {
        let load = deviations.load.get(pack * PACK + lane).copied().unwrap_or(0.0);
        built.lightness[lane] = 1.0 / (1.0 + load);
    }
    if deviations.has_pushes() {
        pushes(model, home, bodies, pack, carts, forces, built);
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

/// Whether it is one steering wheel of its own.
fn steers(wheel: WheelPlace) -> bool {
    matches!(wheel, WheelPlace::SteeringLeft | WheelPlace::SteeringRight)
}

/// Offsets of rails and wheels.
fn profiles(model: &Model, pack: usize, carts: usize, forces: &Forces, built: &mut Built) {
    let lap = model.segments.line.length;
    let radii = [model.steering.radius, model.running.radius, model.running.radius];
    let deviations = &model.deviations;
    for (k, radius) in radii.into_iter().enumerate() {
        let steered = k == 0 && deviations.worn.iter().any(|worn| steers(worn.wheel));
        let own = deviations.worn.iter().any(|worn| worn.wheel == WheelPlace::ALL[k]);
        if deviations.rails[k].is_empty() && !own && !steered {
            continue;
        }
        for lane in 0..carts {
            let i = pack * PACK + lane;
            let (mut offset, mut slope) = deviations.offset(k, i, forces.station[i], lap, radius);
            if steered {
                let (more, steeper) =
                    deviations.steered(forces.places[pack].y[lane] - offset, i, forces.station[i], radius);
                (offset, slope) = (offset + more, slope + steeper);
            }
            built.offset[k][lane] = offset;
            built.rate[k][lane] = slope * forces.speed[i];
        }
    }
}

/// Guides that give way to the steering wheels, in series with their contact: with the force F that was found where a
/// guide had given way by d, and the contact's slope K, Newton's step for d = c F(y − d) is d + (c F − d)/(1 + c K). As
/// the wheel moves, the guide has its share c K/(1 + c K) of the rate.
fn guides(model: &Model, home: &Home, pack: usize, carts: usize, forces: &Forces, built: &mut Built) {
    let deviations = &model.deviations;
    let contact = &model.steering.contact;
    for lane in 0..carts {
        let i = pack * PACK + lane;
        let (force, compliance) = (forces.loads[pack].steering[lane], deviations.guides.at(forces.station[i]));
        let given = &mut built.given[lane];
        if force == 0.0 {
            *given = 0.0;
            continue;
        }
        let share = compliance * tangent(contact.stiffness, contact.exponent, force);
        *given += (compliance * force - *given) / (1.0 + share);
        let normal = model.segments.list[home.segment[lane] as usize].normal_at(forces.station[i]);
        let across: f64 = (0..3).map(|k| forces.front_velocity[k][i] * normal[k]).sum();
        built.offset[0][lane] += *given;
        built.rate[0][lane] += across * share / (1.0 + share);
    }
}

/// Forces along and across the track. Running wheels slide where they touch, at (0, ±b, −h) from the front joint, so that
/// they tilt the cart, too.
fn pushes(model: &Model, home: &Home, bodies: &Bodies, pack: usize, carts: usize, forces: &Forces, built: &mut Built) {
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
            let axle = match deviations.held {
                true => [0, 1, 2].map(|k| forces.places[pack].axes[1][k][lane]),
                false => normal.into(),
            };
            let at_front: f64 = (0..3).map(|k| forces.front_velocity[k][i] * axle[k]).sum();
            let lateral = at_front + model.running.height * bodies.spin[0][lane];
            let load: f64 = forces.loads[pack].running.iter().map(|row| row[lane].abs()).sum();
            let slide = -deviations.sliding * load * trig::tanh(lateral / deviations.smoothing[0]);
            let (side, _) = closed(&deviations.side_force, station / lap);
            (0..3).for_each(|k| push[k] += axle[k] * slide + normal[k] * side);
            built.torque[0][lane] = model.running.height * slide;
        }
        (0..3).for_each(|k| built.push[k][lane] = push[k]);
    }
}
