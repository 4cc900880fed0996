//! All forces on all carts at one moment, several carts at once (design: chain model), and the step in time around
//! them.
//!
//! One sweep over the packs: [`fronts`] of the pack ahead, with where they are on the centre line; then the joints
//! behind, the wheels and the motors of the pack itself, into accelerations. So a pack is in the processor's nearest
//! memory for all that is done to it. Branches are kept to what is rare, so that the processor can overlap the long
//! latencies of roots and divisions.

mod built;
mod carts;
mod fronts;
mod implicit;
mod joints;
mod motors;
mod wheels;

use self::built::Built;
use self::implicit::{Fastest, Held};
use super::coverage::OverMotors;
use super::lanes::{Axes, Lane, Lane3};
use super::model::{Model, OFF_RAIL};
use super::segments::Homes;
use super::state::{Accelerations, Approach, Bodies, Loads, PACK, PackRow, packs};
pub use motors::CommandChange;
use pulp::{Simd, WithSimd};

/// How many packs ahead front joints are worked out.
const AHEAD: usize = 2;

/// What the evaluation of forces keeps from one time to the next: where each cart is on the track, and what each
/// contact remembers.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    pub home: Vec<Homes>,
    pub approach: Vec<Approach>,
    pub motors: Vec<OverMotors>,
}

/// What it leaves for others to read.
#[derive(Clone, Debug)]
pub struct Forces {
    pub loads: Vec<Loads>,
    /// Arc length of each front joint, m.
    pub station: Vec<f64>,
    /// Speed of each front joint along the track, m/s.
    pub speed: Vec<f64>,
    /// Length of the cart's plate over motors, in motor lengths; times the motors' own factors.
    pub share: Vec<f64>,
    /// Length of motors up to each front joint, in motor lengths; behind the last cart the first again.
    covered: Vec<f64>,
    /// Front joints in the world, m, m/s: rows of numbers, one a cart, and behind the last the first again.
    front: [Vec<f64>; 3],
    front_velocity: [Vec<f64>; 3],
    /// Angular velocities in the world, rad/s, the same way; kept only where joints have friction.
    front_spin: [Vec<f64>; 3],
    /// Of the joint at each cart's front on its leader, in the world, N and N m.
    pull: [Vec<f64>; 3],
    twist: [Vec<f64>; 3],
    /// How carts and their front joints are on the track.
    places: Vec<Placed>,
    /// What damping at a step's end is worked out from: changes of the accelerations of the carts and, in the world,
    /// m/s², of the front joints; then the forces at front joints that damp them, N.
    held: Vec<Held>,
    front_change: [Vec<f64>; 3],
    damped: [Vec<f64>; 3],
    /// Of the whole chain, but for carts beside idle places.
    fastest: Fastest,
    /// What deviations do to each cart; empty without them.
    built: Vec<Built>,
    /// Whether a cart is off the rail, a joint broken, or a number no number.
    pub trouble: bool,
}

/// How the carts of a pack and their front joints are on the track.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Placed {
    /// Axes of the carts in the world, each as a vector.
    axes: [[PackRow; 3]; 3],
    /// Of the centre line nearest to the front joint.
    tangent: [PackRow; 3],
    /// To the left.
    normal: [PackRow; 3],
    /// Offset of the joints along the normal and upwards, m.
    y: PackRow,
    z: PackRow,
}

impl Placed {
    /// The centre line's direction under several front joints.
    #[inline(always)]
    fn track<S: Simd, const LEVEL: bool>(&self, simd: S, part: usize) -> Track<S> {
        if LEVEL {
            let (x, y) = (Lane::of(simd, &self.tangent[0], part), Lane::of(simd, &self.tangent[1], part));
            let zero = x.constant(0.0);
            Track { tangent: Lane3::new(x, y, zero), normal: Lane3::new(-y, x, zero) }
        } else {
            Track { tangent: Lane3::of(simd, &self.tangent, part), normal: Lane3::of(simd, &self.normal, part) }
        }
    }
}

/// Direction of the centre line.
struct Track<S: Simd> {
    tangent: Lane3<S>,
    /// To the left.
    normal: Lane3<S>,
}

impl<S: Simd> Track<S> {
    /// The part of a vector across the track.
    #[inline(always)]
    fn across<const LEVEL: bool>(&self, v: Lane3<S>) -> Lane<S> {
        if LEVEL { self.tangent.x.mul_add(v.y, -(self.tangent.y * v.x)) } else { self.normal.dot(v) }
    }

    /// A force along the track and across it, in the world, N.
    #[inline(always)]
    fn sideways<const LEVEL: bool>(&self, along: Lane<S>, across: Lane<S>) -> Lane3<S> {
        let Track { tangent: t, normal } = self;
        if LEVEL {
            let (x, y) = (t.y.neg_mul_add(across, t.x * along), t.x.mul_add(across, t.y * along));
            Lane3::new(x, y, along.constant(0.0))
        } else {
            normal.scale_add(across, t.scale(along))
        }
    }
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
            covered: row(),
            front: rows(),
            front_velocity: rows(),
            front_spin: rows(),
            pull: rows(),
            twist: rows(),
            places: vec![Placed::default(); packs],
            held: vec![Held::default(); packs],
            front_change: rows(),
            damped: rows(),
            fastest: Fastest::default(),
            built: if model.deviations.on_carts() { vec![Built::default(); packs] } else { Vec::new() },
            trouble: false,
        }
    }

    /// What is wrong with cart `i`, if anything.
    pub fn troubled(&self, model: &Model, i: usize) -> Option<Fault> {
        let (pack, lane) = (i / PACK, i % PACK);
        let (y, z) = (self.places[pack].y[lane], self.places[pack].z[lane]);
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

    /// Fastest rates at which dampers act now, along the chain and across it, 1/s.
    pub fn damping_rates(&self) -> [f64; 2] {
        self.fastest.of_all()
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

/// One evaluation, alone or at the end of a step.
pub struct Evaluation<'a> {
    pub model: &'a Model,
    pub bodies: &'a mut [Bodies],
    pub memory: &'a mut Memory,
    pub forces: &'a mut Forces,
    /// Those at the begin of a step are overwritten with those at its end.
    pub accelerations: &'a mut [Accelerations],
    /// Force of every motor, N.
    pub command: f64,
    /// Whether contacts remember what they meet: not in the stages of a step that may be taken back.
    pub commit: bool,
    /// The step that leads here, s, which the bodies have still to take; none for the forces where they are.
    pub step: Option<f64>,
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
        let (packs, parts, carts) = (self.bodies.len(), PACK / S::F64_LANES, self.model.carts);
        // The last pack and the first, between which the chain closes, and one that is further ahead than needed: what
        // is still on its way to memory would be waited for.
        let last = packs - 1;
        for pack in [last, 0, 1].into_iter().take(packs) {
            for part in 0..parts {
                self.fronts::<S, LEVEL>(simd, pack, part);
            }
        }
        self.close_ring();
        self.joint_of_the_first(simd);
        // Packs with idle places are looked at one by one.
        let whole = carts / PACK * PACK;
        let mut trouble = false;
        self.forces.fastest = Fastest::default();
        for pack in 0..packs {
            if pack + AHEAD < last {
                for part in 0..parts {
                    self.fronts::<S, LEVEL>(simd, pack + AHEAD, part);
                }
            }
            for part in 0..parts {
                self.motors(simd, pack, part);
            }
            if pack == last {
                // Nothing is behind the last cart.
                self.forces.share[carts..].fill(0.0);
            }
            if let Some(built) = self.forces.built.get_mut(pack) {
                let mut own = *built;
                let (home, bodies) = (&self.memory.home[pack].front, &self.bodies[pack]);
                built::build(self.model, home, bodies, pack, self.forces, &mut own);
                self.forces.built[pack] = own;
            }
            for part in 0..parts {
                let bad = self.carts::<S, LEVEL>(simd, pack, part);
                trouble |= bad && pack * PACK < whole;
            }
            // The pack before has both its neighbours now.
            if let (Some(h), true) = (self.step, pack > 0) {
                self.end_step(simd, pack - 1, h);
            }
        }
        if let Some(h) = self.step {
            for row in &mut self.forces.front_change {
                row[carts] = row[0];
            }
            self.end_step(simd, last, h);
            for row in &mut self.forces.damped {
                row[0] = row[carts];
            }
            for part in 0..parts {
                self.release(simd, 0, part, h);
            }
        }
        self.rest_idle();
        let forces = &*self.forces;
        self.forces.trouble = trouble || (whole..carts).any(|i| forces.troubled(self.model, i).is_some());
    }

    /// Ends the step of a pack, of the first but for what the last cart does to it.
    #[inline(always)]
    fn end_step<S: Simd>(&mut self, simd: S, pack: usize, h: f64) {
        for part in 0..PACK / S::F64_LANES {
            self.damp(simd, pack, part);
            if pack > 0 {
                self.release(simd, pack, part, h);
            }
        }
    }

    /// The last cart's follower is the first.
    fn close_ring(&mut self) {
        let carts = self.model.carts;
        let forces = &mut *self.forces;
        let rows = forces.front.iter_mut().chain(&mut forces.front_velocity).chain(&mut forces.front_spin);
        for row in rows.chain([&mut forces.covered]) {
            row[carts] = row[0];
        }
        // No reason to look closer at idle places.
        forces.speed[carts..].fill(1.0);
    }

    /// The joint at the first cart's front, which is behind the last cart.
    #[inline(always)]
    fn joint_of_the_first<S: Simd>(&mut self, simd: S) {
        let carts = self.model.carts;
        let (pack, part) = ((carts - 1) / PACK, (carts - 1) % PACK / S::F64_LANES);
        let turned = self.turned(simd, pack, part);
        self.joints(simd, pack, part, &turned);
        for row in self.forces.pull.iter_mut().chain(&mut self.forces.twist) {
            row[0] = row[carts];
        }
    }

    /// How carts are turned, as [`fronts`] left it, and how they turn.
    #[inline(always)]
    fn turned<S: Simd>(&self, simd: S, pack: usize, part: usize) -> Turned<S> {
        let axes = Axes::of_rows(simd, &self.forces.places[pack].axes, part);
        Turned { axes, spin: Lane3::of(simd, &self.bodies[pack].spin, part) }
    }

    /// Places behind the last cart rest.
    fn rest_idle(&mut self) {
        let used = self.model.carts % PACK;
        if let (true, Some(out), Some(bodies)) = (used > 0, self.accelerations.last_mut(), self.bodies.last_mut()) {
            let moving = bodies.velocity.iter_mut().chain(&mut bodies.spin);
            for row in out.linear.iter_mut().chain(&mut out.angular).chain(moving) {
                row[used..].fill(0.0);
            }
        }
    }
}

/// How several carts are turned and turn.
struct Turned<S: Simd> {
    axes: Axes<S>,
    /// In the cart's axes, rad/s.
    spin: Lane3<S>,
}

/// From the centre of mass to the front joint, in the cart's axes: x and z; it is in the plane of symmetry.
#[inline(always)]
fn arm<S: Simd>(simd: S, model: &Model) -> [Lane<S>; 2] {
    let [xi, zeta] = model.cart.centre;
    [Lane::splat(simd, -xi), Lane::splat(simd, -zeta)]
}

/// (x, 0, z) × v
#[inline(always)]
fn lever<S: Simd>(x: Lane<S>, z: Lane<S>, v: Lane3<S>) -> Lane3<S> {
    Lane3::new(-(z * v.y), x.neg_mul_add(v.z, z * v.x), x * v.y)
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
