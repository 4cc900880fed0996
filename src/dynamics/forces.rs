//! All forces on all carts at one moment, several carts at once (design: chain model).
//!
//! Two passes over the packs: the first finds each front joint with its velocity, its foot on the centre line and its arc
//! length; the second takes joint, wheels, motors and weight together into accelerations.

use super::contact::{Side, contact, joint};
use super::lanes::{Axes, Lane, Lane3, Mask, Splat};
use super::model::Model;
use super::motors;
use super::segments::{Foot, Home, Local, foot, mend, rehome};
use super::state::{Accelerations, Approach, Bodies, Loads, PACK, Row, packs};
use pulp::{Simd, WithSimd};

/// Lateral or vertical offset of a front joint from the centre line beyond which the cart is off the rail, m.
pub const OFF_RAIL: f64 = 0.05;

/// Elongation of a joint beyond which the chain is broken, m.
pub const BROKEN: f64 = 0.02;

/// What the evaluation of forces keeps from one time to the next: where each cart is on the track, and what each contact
/// remembers.
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
    /// On the cart's front joint by its leader, in the world, N: one place later, as the first belongs to the last's
    /// follower.
    pull: [Vec<f64>; 3],
    /// Offset of the front joints from the centre line: y and z, m.
    pub offset: Vec<[Row; 2]>,
    motor_cursor: Vec<usize>,
    /// Whether a cart is off the rail, a joint broken, or a number no number.
    pub trouble: bool,
}

impl Forces {
    pub fn new(model: &Model) -> Self {
        let packs = packs(model.carts);
        let padded = packs * PACK;
        let row = || vec![0.0; padded + PACK];
        let rows = || [row(), row(), row()];
        Forces {
            loads: vec![Loads::default(); packs],
            station: row(),
            speed: row(),
            share: row(),
            front: rows(),
            front_velocity: rows(),
            pull: rows(),
            offset: vec![[[0.0; PACK]; 2]; packs],
            motor_cursor: vec![0; model.motors.s.len()],
            trouble: false,
        }
    }

    /// What is wrong with cart `i`, if anything.
    pub fn troubled(&self, model: &Model, i: usize) -> Option<Fault> {
        let (pack, lane) = (i / PACK, i % PACK);
        let [y, z] = self.offset[pack].map(|row| row[lane]);
        let pull = self.loads[pack].joint[0][lane];
        let slack = crate::geometry::trig::pow(pull.abs() / model.axial.stiffness, 1.0 / model.axial.exponent);
        if !(y + z + pull).is_finite() {
            Some(Fault::NotANumber)
        } else if y.abs() >= OFF_RAIL || z.abs() >= OFF_RAIL {
            Some(Fault::OffRail)
        } else if slack >= BROKEN {
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
        let packs = self.bodies.len();
        for pack in 0..packs {
            let mut at = 0;
            while at < PACK {
                self.fronts::<S, LEVEL>(simd, pack, at);
                at += S::F64_LANES;
            }
        }
        self.close_ring();
        let command = self.command;
        let forces = &mut *self.forces;
        motors::share(self.model, &forces.station, &mut forces.share, &mut forces.motor_cursor);
        self.forces.trouble = false;
        self.last_pull(simd);
        for pack in 0..packs {
            let mut at = 0;
            while at < PACK {
                let bad = self.cart::<S, LEVEL>(simd, pack, at, command);
                self.forces.trouble |= bad && pack * PACK + at + S::F64_LANES <= self.model.carts;
                at += S::F64_LANES;
            }
        }
        self.rest_idle();
        // Packs with idle places are looked at one by one.
        let whole = self.model.carts / PACK * PACK;
        self.forces.trouble |= (whole..self.model.carts).any(|i| self.forces.troubled(self.model, i).is_some());
    }

    /// Front joints, their feet and arc lengths.
    #[inline(always)]
    fn fronts<S: Simd, const LEVEL: bool>(&mut self, simd: S, pack: usize, at: usize) {
        let bodies = &self.bodies[pack];
        let axes = axes(simd, bodies, at);
        let spin = Lane3::load(simd, &bodies.spin, at);
        let arm = self.arm(simd);
        let position = Lane3::load(simd, &bodies.position, at) + axes.turn(arm);
        let velocity = Lane3::load(simd, &bodies.velocity, at) + axes.turn(spin.cross(arm));
        let place = pack * PACK + at;
        let forces = &mut *self.forces;
        store(position, &mut forces.front, place);
        store(velocity, &mut forces.front_velocity, place);
        let segments = &self.model.segments;
        let mut local = Local::load(simd, &self.memory.home[pack], at);
        let mut feet = foot::<S, LEVEL>(&local, position);
        if feet.outside(&local).any() {
            rehome(segments, &mut self.memory.home[pack], at, position, &feet);
            local = Local::load(simd, &self.memory.home[pack], at);
            feet = foot::<S, LEVEL>(&local, position);
        }
        let mut station = feet.station(&local);
        if feet.outside(&local).any() {
            (feet, station) = mend(simd, segments, &self.memory.home[pack], at, position, &feet, &local);
        }
        station.store(&mut forces.station[place..]);
        feet.tangent.dot(velocity).store(&mut forces.speed[place..]);
    }

    /// From the front joint to the centre of mass and back: the arm of the front joint, in the cart's axes.
    #[inline(always)]
    fn arm<S: Simd>(&self, simd: S) -> Lane3<S> {
        let [xi, zeta] = self.model.cart.centre;
        let c = Splat(simd);
        Lane3::new(c.of(-xi), c.of(0.0), c.of(-zeta))
    }

    /// The last cart's follower is the first.
    fn close_ring(&mut self) {
        let carts = self.model.carts;
        let forces = &mut *self.forces;
        for k in 0..3 {
            forces.front[k][carts] = forces.front[k][0];
            forces.front_velocity[k][carts] = forces.front_velocity[k][0];
        }
        forces.station[carts] = forces.station[0];
    }

    /// The pull of the last cart on the first, before anything else needs it.
    #[inline(always)]
    fn last_pull<S: Simd>(&mut self, simd: S) {
        let last = self.model.carts - 1;
        let (pack, at) = (last / PACK, last % PACK / S::F64_LANES * S::F64_LANES);
        let pulled = self.joint(simd, pack, at);
        // Nothing is remembered here: the cart's own turn comes.
        let mut rows = [[0.0; PACK]; 3];
        (-pulled.world).store(&mut rows, 0);
        for k in 0..3 {
            self.forces.pull[k][0] = rows[k][last - pack * PACK - at];
        }
    }

    /// The joint between each cart and its follower.
    #[inline(always)]
    fn joint<S: Simd>(&self, simd: S, pack: usize, at: usize) -> Pulled<S> {
        let model = self.model;
        let bodies = &self.bodies[pack];
        let axes = axes(simd, bodies, at);
        let spin = Lane3::load(simd, &bodies.spin, at);
        let place = pack * PACK + at;
        let front = load(simd, &self.forces.front, place);
        let velocity = load(simd, &self.forces.front_velocity, place);
        let c = Splat(simd);
        let length = c.of(model.cart.length);
        let behind = load(simd, &self.forces.front, place + 1) - front;
        let behind_velocity = load(simd, &self.forces.front_velocity, place + 1) - velocity;
        // e and ė in the leader's axes; the rear joint is at (−L, 0, 0) and moves there with ω × (−L, 0, 0).
        let mut e = axes.turn_back(behind);
        e.x = e.x + length;
        let relative = axes.turn_back(behind_velocity);
        let rear = Lane3::new(c.of(0.0), -(spin.z * length), spin.y * length);
        let rate = relative - rear - spin.cross(e);
        let approach = &self.memory.approach[pack].joint;
        let memory = Lane3::load(simd, approach, at);
        let (fx, mx) = joint(&model.axial, model.floor, e.x, rate.x, memory.x);
        let (fy, my) = joint(&model.radial, model.floor, e.y, rate.y, memory.y);
        let (fz, mz) = joint(&model.radial, model.floor, e.z, rate.z, memory.z);
        let force = Lane3::new(fx, fy, fz);
        Pulled { force, elongation: e, world: axes.turn(force), memory: Lane3::new(mx, my, mz) }
    }

    /// Joints, wheels, motors and weight of some carts, into accelerations. Returns whether any is in trouble.
    #[inline(always)]
    fn cart<S: Simd, const LEVEL: bool>(&mut self, simd: S, pack: usize, at: usize, command: f64) -> bool {
        let model = self.model;
        let c = Splat(simd);
        let place = pack * PACK + at;
        let bodies = &self.bodies[pack];
        let axes = axes(simd, bodies, at);
        let spin = Lane3::load(simd, &bodies.spin, at);
        let arm = self.arm(simd);

        // The joint behind, on this cart and, one place later, on its follower.
        let pulled = self.joint(simd, pack, at);
        store(-pulled.world, &mut self.forces.pull, place + 1);
        let rear_arm = Lane3::new(
            pulled.elongation.x + arm.x - c.of(model.cart.length),
            pulled.elongation.y,
            pulled.elongation.z + arm.z,
        );
        let mut torque = rear_arm.cross(pulled.force);
        let front = load(simd, &self.forces.front, place);
        let velocity = load(simd, &self.forces.front_velocity, place);
        let mut at_front = load(simd, &self.forces.pull, place);

        // Steering wheels at the front joint; one of them at most is in contact.
        let home = &self.memory.home[pack];
        let local = Local::load(simd, home, at);
        let feet = self.feet::<S, LEVEL>(simd, home, &local, at, front);
        let approach = &self.memory.approach[pack];
        let wheel = &model.steering;
        let lateral = feet.normal.dot(velocity);
        let left = c.of(0.0).less(feet.y);
        let side = Side { depth: feet.y.abs() - c.of(wheel.gap), rate: lateral.select(left, -lateral) };
        let (force, steer_memory) =
            contact(&wheel.contact, model.floor, side, Lane::load(simd, &approach.steering[at..]));
        let steering = force.select(left, -force);
        let resistance = drag(wheel.resistance, force, feet.tangent.dot(velocity));
        at_front = feet.normal.scale_add(-steering, feet.tangent.scale_add(resistance, at_front));

        // Running wheels, left and right, on the lower surface or under the upper one.
        let wheel = &model.running;
        let (b, h) = (c.of(wheel.half_spacing), c.of(wheel.height));
        let below = axes.zeta.scale_add(-h, front);
        let beside = axes.eta.scale(b);
        // ω × (0, ±b, −h)
        let swing = axes.turn(Lane3::new(-(h * spin.y), h * spin.x, c.of(0.0))) + velocity;
        let roll = axes.turn(Lane3::new(-(b * spin.z), c.of(0.0), b * spin.x));
        let mut running = [c.of(0.0); 2];
        let mut run_memory = [c.of(0.0); 2];
        let mut at_wheel = [at_front; 2];
        let points = [(below + beside, swing + roll), (below - beside, swing - roll)];
        for k in 0..2 {
            let (point, speed) = points[k];
            let feet = self.feet::<S, LEVEL>(simd, home, &local, at, point);
            let (height, climb) =
                if LEVEL { (feet.z + h, speed.z) } else { (feet.z + h, feet.up.dot(speed)) };
            let low = height.less(c.of(0.5 * wheel.gap));
            let side = Side {
                depth: (-height).select(low, height - c.of(wheel.gap)),
                rate: (-climb).select(low, climb),
            };
            let (force, memory) =
                contact(&wheel.contact, model.floor, side, Lane::load(simd, &approach.running[k][at..]));
            let signed = force.select(low, -force);
            let drag = drag(wheel.resistance, force, feet.tangent.dot(speed));
            at_wheel[k] = if LEVEL {
                Lane3::new(feet.tangent.x * drag, feet.tangent.y * drag, signed)
            } else {
                feet.up.scale_add(signed, feet.tangent.scale(drag))
            };
            running[k] = signed;
            run_memory[k] = memory;
        }
        let both = at_wheel[0] + at_wheel[1];
        let difference = axes.turn_back(at_wheel[0] - at_wheel[1]);
        let both_here = axes.turn_back(both);
        let front_here = axes.turn_back(at_front);
        torque = torque + arm.cross(front_here + both_here);
        torque.x = b.mul_add(difference.z, h.mul_add(both_here.y, torque.x));
        torque.y = h.neg_mul_add(both_here.x, torque.y);
        torque.z = b.neg_mul_add(difference.x, torque.z);
        let mut force = pulled.world + at_front + both;

        // Linear motors: along the track nearest the middle of the cart.
        let share = Lane::load(simd, &self.forces.share[place..]);
        if c.of(0.0).less(share).any() {
            let (back, down) = (c.of(-0.5 * model.cart.length), c.of(-model.cart.motor_height));
            let point = axes.xi.scale_add(back, axes.zeta.scale_add(down, front));
            let feet = self.feet::<S, LEVEL>(simd, home, &local, at, point);
            let thrust = feet.tangent.scale(share * c.of(command));
            force = force + thrust;
            let lever = Lane3::new(arm.x + back, arm.y, arm.z + down);
            torque = torque + lever.cross(axes.turn_back(thrust));
        }

        // Newton and Euler.
        let inverse_mass = c.of(1.0 / model.cart.mass);
        let mut linear = force.scale(inverse_mass);
        linear.z = linear.z - c.of(model.gravity);
        let inertia = model.cart.inertia;
        let momentum = Lane3::new(spin.x * c.of(inertia[0]), spin.y * c.of(inertia[1]), spin.z * c.of(inertia[2]));
        let net = torque - spin.cross(momentum);
        let angular = Lane3::new(
            net.x * c.of(1.0 / inertia[0]),
            net.y * c.of(1.0 / inertia[1]),
            net.z * c.of(1.0 / inertia[2]),
        );
        let out = &mut self.out[pack];
        linear.store(&mut out.linear, at);
        angular.store(&mut out.angular, at);

        let loads = &mut self.forces.loads[pack];
        steering.store(&mut loads.steering[at..]);
        running[0].store(&mut loads.running[0][at..]);
        running[1].store(&mut loads.running[1][at..]);
        pulled.force.store(&mut loads.joint, at);
        let offset = &mut self.forces.offset[pack];
        feet.y.store(&mut offset[0][at..]);
        feet.z.store(&mut offset[1][at..]);
        if self.commit {
            let approach = &mut self.memory.approach[pack];
            steer_memory.store(&mut approach.steering[at..]);
            run_memory[0].store(&mut approach.running[0][at..]);
            run_memory[1].store(&mut approach.running[1][at..]);
            pulled.memory.store(&mut approach.joint, at);
        }
        let astray = feet.y.abs().less(c.of(OFF_RAIL)).and(feet.z.abs().less(c.of(OFF_RAIL)));
        let whole = pulled.elongation.x.abs().less(c.of(BROKEN));
        let fine = astray.and(whole).and(finite(linear.x + angular.x));
        !fine.all()
    }

    /// The foot of a point of these carts, whichever segment it is on.
    #[inline(always)]
    fn feet<S: Simd, const LEVEL: bool>(
        &self,
        simd: S,
        home: &Home,
        local: &Local<S>,
        at: usize,
        point: Lane3<S>,
    ) -> Foot<S> {
        let feet = foot::<S, LEVEL>(local, point);
        if feet.outside(local).any() {
            mend(simd, &self.model.segments, home, at, point, &feet, local).0
        } else {
            feet
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

/// A joint's force on its leader, in the leader's axes and in the world, and what made it.
struct Pulled<S: Simd> {
    force: Lane3<S>,
    world: Lane3<S>,
    elongation: Lane3<S>,
    memory: Lane3<S>,
}

#[inline(always)]
fn finite<S: Simd>(x: Lane<S>) -> Mask<S> {
    x.abs().less(x.constant(f64::MAX))
}

#[inline(always)]
fn axes<S: Simd>(simd: S, bodies: &Bodies, at: usize) -> Axes<S> {
    let attitude = &bodies.attitude;
    Axes::of(
        Lane::load(simd, &attitude[0][at..]),
        Lane::load(simd, &attitude[1][at..]),
        Lane::load(simd, &attitude[2][at..]),
        Lane::load(simd, &attitude[3][at..]),
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

/// Rolling resistance along the track: −c_rr N tanh(v/0.01 m/s), N.
#[inline(always)]
fn drag<S: Simd>(resistance: f64, normal: Lane<S>, speed: Lane<S>) -> Lane<S> {
    let x = speed * speed.constant(100.0);
    // tanh is 1 to the last digit beyond 20.
    let tanh = if x.abs().less(x.constant(20.0)).any() {
        x.map(crate::geometry::trig::tanh)
    } else {
        let one = x.constant(1.0);
        one.select(x.constant(0.0).less(x), -one)
    };
    -(normal * tanh.constant(resistance) * tanh)
}
