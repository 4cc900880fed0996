//! All forces on all carts at one moment, several carts at once (design: chain model).
//!
//! Three passes over the packs: front joints with their velocities, feet on the centre line and arc lengths; joints;
//! wheels, motors and weight, into accelerations. Each keeps its branches to what is rare, so that the processor can
//! overlap the long latencies of roots and divisions.

mod built;
mod carts;
mod fronts;
mod joints;

use self::built::Built;
use super::lanes::{Axes, Lane, Lane3};
use super::model::Model;
use super::motors;
use super::segments::Home;
use super::state::{Accelerations, Approach, Bodies, Loads, PACK, PackRow, packs};
use pulp::{Simd, WithSimd};

/// Lateral or vertical offset of a front joint from the centre line beyond which the cart is off the rail, m.
pub const OFF_RAIL: f64 = 0.05;

/// What the evaluation of forces keeps from one time to the next: where each cart is on the track, and what each
/// contact remembers.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    pub home: Vec<Home>,
    pub approach: Vec<Approach>,
}

/// What it leaves for others to read.
#[derive(Clone, Debug)]
pub struct Forces {
    pub loads: Vec<Loads>,
    /// Arc length of each front joint, m.
    pub station: Vec<f64>,
    /// Speed of each front joint along the track, m/s.
    pub speed: Vec<f64>,
    /// Length of the cart's plate over motors, in motor lengths.
    pub share: Vec<f64>,
    /// Front joints in the world, m, m/s: rows of numbers, one a cart, and behind the last the first again.
    front: [Vec<f64>; 3],
    front_velocity: [Vec<f64>; 3],
    /// Of each cart on its follower's front joint, in the world, N; before the first, what the last pulls the first
    /// with.
    pull: [Vec<f64>; 3],
    /// Torque of the joint behind about the centre of mass, in the cart's axes, N m.
    joint_torque: Vec<[PackRow; 3]>,
    /// Offset of the front joints from the centre line: y and z, m.
    pub offset: Vec<[PackRow; 2]>,
    motor_cursor: Vec<usize>,
    /// What deviations do to each cart; empty without them.
    built: Vec<Built>,
    /// Whether a cart is off the rail, a joint broken, or a number no number.
    pub trouble: bool,
}

impl Forces {
    pub fn new(model: &Model) -> Self {
        let packs = packs(model.carts);
        let row = || vec![0.0; (packs + 1) * PACK];
        let rows = || [row(), row(), row()];
        Forces {
            loads: vec![Loads::default(); packs],
            station: row(),
            speed: row(),
            share: row(),
            front: rows(),
            front_velocity: rows(),
            pull: rows(),
            joint_torque: vec![[[0.0; PACK]; 3]; packs],
            offset: vec![[[0.0; PACK]; 2]; packs],
            motor_cursor: vec![0; model.motors.s.len()],
            built: if model.deviations.on_carts() { vec![Built::default(); packs] } else { Vec::new() },
            trouble: false,
        }
    }

    /// What is wrong with cart `i`, if anything.
    pub fn troubled(&self, model: &Model, i: usize) -> Option<Fault> {
        let (pack, lane) = (i / PACK, i % PACK);
        let [y, z] = self.offset[pack].map(|row| row[lane]);
        let pull = self.loads[pack].joint[0][lane];
        if !(y + z + pull).is_finite() {
            Some(Fault::NotANumber)
        } else if y.abs() >= OFF_RAIL || z.abs() >= OFF_RAIL {
            Some(Fault::OffRail)
        } else if pull.abs() >= model.breaking {
            Some(Fault::Broken)
        } else {
            None
        }
    }

    /// Mean speed of the chain: of the front joints along the track, m/s.
    pub fn mean_speed(&self, carts: usize) -> f64 {
        self.speed[..carts].iter().sum::<f64>() / carts as f64
    }

    /// Mean tension at the joints, N.
    pub fn mean_tension(&self, carts: usize) -> f64 {
        let tension = |i: usize| -self.loads[i / PACK].joint[0][i % PACK];
        (0..carts).map(tension).sum::<f64>() / carts as f64
    }
}

/// What is wrong with a cart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    OffRail,
    Broken,
    NotANumber,
}

/// One evaluation.
pub struct Evaluation<'a> {
    pub model: &'a Model,
    pub bodies: &'a [Bodies],
    pub memory: &'a mut Memory,
    pub forces: &'a mut Forces,
    pub out: &'a mut [Accelerations],
    /// Force of every motor, N.
    pub command: f64,
    /// Whether contacts remember what they meet: not in the stages of a step that may be taken back.
    pub commit: bool,
    /// Whether only the command has changed since the last evaluation: front joints and joints are then as they were.
    pub again: bool,
}

impl WithSimd for Evaluation<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        if self.model.segments.level {
            self.run::<S, true>(simd);
        } else {
            self.run::<S, false>(simd);
        }
    }
}

impl Evaluation<'_> {
    #[inline(always)]
    fn run<S: Simd, const LEVEL: bool>(&mut self, simd: S) {
        // Nested loops, so that the offset in a pack is a constant where vectors are as wide as packs.
        let packs = self.bodies.len();
        if !self.again {
            for pack in 0..packs {
                for part in 0..PACK / S::F64_LANES {
                    self.fronts::<S, LEVEL>(simd, pack, part);
                }
            }
            self.close_ring();
            let forces = &mut *self.forces;
            motors::share(self.model, &forces.station, &mut forces.share, &mut forces.motor_cursor);
            for pack in 0..packs {
                for part in 0..PACK / S::F64_LANES {
                    self.joints(simd, pack, part);
                }
            }
            if !self.forces.built.is_empty() {
                built::build(self.model, self.bodies, &self.memory.home, self.forces);
            }
        }
        let carts = self.model.carts;
        for pull in &mut self.forces.pull {
            pull[0] = pull[carts];
        }
        // Packs with idle places are looked at one by one.
        let whole = carts / PACK * PACK;
        let mut trouble = false;
        for pack in 0..packs {
            for part in 0..PACK / S::F64_LANES {
                let bad = self.carts::<S, LEVEL>(simd, pack, part);
                trouble |= bad && pack * PACK < whole;
            }
        }
        self.rest_idle();
        let forces = &*self.forces;
        self.forces.trouble = trouble || (whole..carts).any(|i| forces.troubled(self.model, i).is_some());
    }

    /// The last cart's follower is the first.
    fn close_ring(&mut self) {
        let carts = self.model.carts;
        let forces = &mut *self.forces;
        for row in forces.front.iter_mut().chain(&mut forces.front_velocity) {
            row[carts] = row[0];
        }
    }

    /// Places behind the last cart rest.
    fn rest_idle(&mut self) {
        let used = self.model.carts % PACK;
        if let (true, Some(out)) = (used > 0, self.out.last_mut()) {
            for row in out.linear.iter_mut().chain(&mut out.angular) {
                row[used..].fill(0.0);
            }
        }
    }
}

/// From the centre of mass to the front joint, in the cart's axes.
#[inline(always)]
fn arm<S: Simd>(simd: S, model: &Model) -> Lane3<S> {
    let [xi, zeta] = model.cart.centre;
    Lane3::new(Lane::splat(simd, -xi), Lane::splat(simd, 0.0), Lane::splat(simd, -zeta))
}

#[inline(always)]
fn axes<S: Simd>(simd: S, bodies: &Bodies, part: usize) -> Axes<S> {
    let attitude = &bodies.attitude;
    Axes::of(
        Lane::of(simd, &attitude[0], part),
        Lane::of(simd, &attitude[1], part),
        Lane::of(simd, &attitude[2], part),
        Lane::of(simd, &attitude[3], part),
    )
}

#[inline(always)]
fn load<S: Simd>(simd: S, rows: &[Vec<f64>; 3], place: usize) -> Lane3<S> {
    Lane3::new(
        Lane::load(simd, &rows[0][place..]),
        Lane::load(simd, &rows[1][place..]),
        Lane::load(simd, &rows[2][place..]),
    )
}

#[inline(always)]
fn store<S: Simd>(v: Lane3<S>, rows: &mut [Vec<f64>; 3], place: usize) {
    v.x.store(&mut rows[0][place..]);
    v.y.store(&mut rows[1][place..]);
    v.z.store(&mut rows[2][place..]);
}
