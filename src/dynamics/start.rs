//! The kinematic initial state: joints one closing pitch apart on the centre line, or between the rails where these are
//! off it; no roll, both joints of every cart moving along the track (design: chain model, start).

use super::coverage::OverMotors;
use super::forces::Memory;
use super::model::Model;
use super::segments::Homes;
use super::state::{Approach, PACK, State, packs};
use crate::base::trig;
use crate::chain_input::Unfit;
use crate::geometry::Frame;
use crate::kinematics::{Closing, closing};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// State and memory at time 0, with the front joint of the first cart at arc length `front`, m, and the chain at
/// `speed`.
pub fn start(model: &Model, front: f64, speed: f64) -> Result<(State, Memory, Closing), Unfit> {
    let line = &model.segments.line;
    let closed =
        closing(line, model.carts, front).map_err(|why| Unfit { place: "chain.carts".into(), why: why.to_string() })?;
    let mut state = State::new(model.carts);
    let packs = packs(model.carts);
    let memory = Memory {
        home: vec![Homes::default(); packs],
        motors: vec![OverMotors::default(); packs],
        approach: vec![
            Approach {
                // Stretched by the tension.
                joint: [[-model.tension.signum() / model.floor; PACK]; 3],
                ..Approach::default()
            };
            packs
        ],
    };
    let mut memory = memory;
    let spaced = |s: &f64| model.deviations.spaced(line, &model.way_longer, s.rem_euclid(line.length));
    let stations: Vec<f64> = closed.stations.iter().map(spaced).collect();
    let on_rails = |s: &f64| Frame { position: model.deviations.way(line, *s), ..line.at(*s) };
    let frames: Vec<Frame> = stations.iter().map(on_rails).collect();
    for i in 0..packs * PACK {
        // Idle places rest where the first cart starts.
        let cart = if i < model.carts { i } else { 0 };
        let follower = (cart + 1) % model.carts;
        let moving = if i < model.carts { speed } else { 0.0 };
        let pose = pose(model, &frames[cart], &frames[follower], moving);
        let (pack, lane) = (i / PACK, i % PACK);
        let bodies = &mut state.bodies[pack];
        for k in 0..3 {
            bodies.position[k][lane] = pose.position[k];
            bodies.velocity[k][lane] = pose.velocity[k];
            bodies.spin[k][lane] = pose.spin[k];
        }
        let q = pose.attitude;
        for (k, value) in [q.w, q.i, q.j, q.k].into_iter().enumerate() {
            bodies.attitude[k][lane] = value;
        }
        let segment = model.segments.at(stations[cart]);
        memory.home[pack].set(lane, segment, &model.segments.list[segment]);
    }
    Ok((state, memory, closed))
}

struct Pose {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    spin: Vector3<f64>,
    attitude: UnitQuaternion<f64>,
}

/// A cart whose front joint is at one frame and which points away from another.
fn pose(model: &Model, front: &Frame, rear: &Frame, speed: f64) -> Pose {
    let chord = front.position - rear.position;
    let xi = chord.normalize();
    let eta = Vector3::new(-xi.y, xi.x, 0.0) / trig::hypot(xi.x, xi.y);
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[xi, eta, xi.cross(&eta)]));
    let difference = (front.tangent - rear.tangent) * speed;
    // Perpendicular to the cart: what makes both joints move along the track.
    let turning = xi.cross(&difference) / chord.norm();
    let arm = rotation * Vector3::new(model.cart.centre[0], 0.0, model.cart.centre[1]);
    Pose {
        position: front.position + arm,
        velocity: front.tangent * speed + turning.cross(&arm),
        spin: rotation.inverse() * turning,
        attitude: UnitQuaternion::from_rotation_matrix(&rotation),
    }
}
