//! What moves, in packs of eight carts: each number of a cart beside the same number of its seven neighbours, so that a
//! vector of any width up to eight loads it at once. Behind the last cart a pack holds idle places, which rest.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Carts a pack.
pub const PACK: usize = 8;

/// One number for each cart of a pack.
pub type PackRow = [f64; PACK];

/// Position, orientation and velocities of the carts.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bodies {
    /// Of the centre of mass in the world, m.
    pub position: [PackRow; 3],
    /// Unit quaternion (w, x, y, z), cart to world.
    pub attitude: [PackRow; 4],
    /// Of the centre of mass in the world, m/s.
    pub velocity: [PackRow; 3],
    /// Angular velocity in the cart's axes, rad/s.
    pub spin: [PackRow; 3],
}

/// Their rates of change that forces decide.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accelerations {
    /// In the world, m/s².
    pub linear: [PackRow; 3],
    /// In the cart's axes, rad/s².
    pub angular: [PackRow; 3],
}

/// What contacts remember: one over the approach speed v₀ when they last closed, s/m; 0 where open. At a joint the sign
/// is that of its elongation.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Approach {
    pub steering: PackRow,
    /// Left, right.
    pub running: [PackRow; 2],
    /// Along ξ, η and ζ of the leader, at the cart's rear joint.
    pub joint: [PackRow; 3],
}

/// Forces in the contacts of a cart, N.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loads {
    /// Of the left steering wheel, or less that of the right one.
    pub steering: PackRow,
    /// Left and right, on the lower surface, or less that on the upper one.
    pub running: [PackRow; 2],
    /// Of this cart on its follower's front joint, along ξ, η and ζ of this cart.
    pub joint: [PackRow; 3],
}

/// A chain's packs and how many carts are in them.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub bodies: Vec<Bodies>,
    pub carts: usize,
}

impl State {
    /// Of carts at rest in the origin.
    pub fn new(carts: usize) -> Self {
        let mut idle = Bodies::default();
        idle.attitude[0] = [1.0; PACK];
        State { bodies: vec![idle; packs(carts)], carts }
    }
}

/// Packs that hold so many carts.
pub fn packs(carts: usize) -> usize {
    carts.div_ceil(PACK)
}

/// Orientation of a cart.
pub fn attitude(bodies: &Bodies, lane: usize) -> UnitQuaternion<f64> {
    let [w, i, j, k] = bodies.attitude.map(|row| row[lane]);
    UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k))
}

/// A row of three at one cart.
pub fn vector(rows: &[[f64; PACK]; 3], lane: usize) -> Vector3<f64> {
    Vector3::new(rows[0][lane], rows[1][lane], rows[2][lane])
}
