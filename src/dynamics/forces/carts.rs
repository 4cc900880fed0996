//! Third pass: wheels, motors and weight, and with the joints the accelerations (design: chain model, wheels, rolling
//! resistance, linear motors).

use super::{Evaluation, OFF_RAIL, arm, axes, load};
use crate::dynamics::contact::{Side, contact, fresh_contact, hertz, opened, power, refreshed};
use crate::dynamics::lanes::{Lane, Lane3, Mask, Splat};
use crate::dynamics::model::Wheel;
use crate::dynamics::segments::{Foot, Handover, Local, foot};
use crate::dynamics::state::PACK;
use pulp::Simd;

/// A running wheel's contact with whichever surface is nearer.
struct Running<S: Simd> {
    side: Side<S>,
    /// Whether the surface is the lower one.
    low: Mask<S>,
    /// Speed along the track, m/s.
    speed: Lane<S>,
}

impl<S: Simd> Running<S> {
    #[inline(always)]
    fn new<const LEVEL: bool>(wheel: &Wheel, foot: &Foot<S>, velocity: Lane3<S>) -> Self {
        let c = foot.z.splat_like();
        let height = foot.z + c.of(wheel.height);
        let climb = if LEVEL { velocity.z } else { foot.up.dot(velocity) };
        let low = height.less(c.of(0.5 * wheel.gap));
        let depth = (-height).select(low, height - c.of(wheel.gap));
        Running { side: Side { depth, rate: (-climb).select(low, climb) }, low, speed: foot.tangent.dot(velocity) }
    }

    /// Rail and wheel meet higher by `offset`, which changes at a rate.
    #[inline(always)]
    fn lift(&mut self, offset: Lane<S>, rate: Lane<S>) {
        self.side.depth = self.side.depth + offset.select(self.low, -offset);
        self.side.rate = self.side.rate + rate.select(self.low, -rate);
    }

    /// On the cart, in the world, N.
    #[inline(always)]
    fn force<const LEVEL: bool>(&self, foot: &Foot<S>, normal: Lane<S>, drag: Lane<S>) -> Lane3<S> {
        let signed = normal.select(self.low, -normal);
        if LEVEL {
            Lane3::new(foot.tangent.x * drag, foot.tangent.y * drag, signed)
        } else {
            foot.up.scale_add(signed, foot.tangent.scale(drag))
        }
    }
}

impl Evaluation<'_> {
    /// Returns whether a cart is in trouble.
    #[inline(always)]
    pub(super) fn carts<S: Simd, const LEVEL: bool>(&mut self, simd: S, pack: usize, part: usize) -> bool {
        let model = self.model;
        let c = Splat(simd);
        let place = pack * PACK + part * S::F64_LANES;
        let bodies = &self.bodies[pack];
        let axes = axes(simd, bodies, part);
        let spin = Lane3::of(simd, &bodies.spin, part);
        let front = load(simd, &self.forces.front, place);
        let velocity = load(simd, &self.forces.front_velocity, place);

        // The steering wheels at the front joint, and the running wheels at (0, ±b, −h) from it.
        let (b, h) = (c.of(model.running.half_spacing), c.of(model.running.height));
        let below = axes.zeta.scale_add(-h, front);
        let beside = axes.eta.scale(b);
        let (left, right) = (below + beside, below - beside);
        // ω × (0, ±b, −h)
        let swing = axes.turn(Lane3::new(-(h * spin.y), h * spin.x, c.of(0.0))) + velocity;
        let roll = axes.turn(Lane3::new(-(b * spin.z), c.of(0.0), b * spin.x));
        let segments = &model.segments;
        let home = &self.memory.home[pack];
        let local = Local::load(simd, home, part);
        let mut at_front = foot::<S, LEVEL>(&local, front);
        let mut at_left = foot::<S, LEVEL>(&local, left);
        let mut at_right = foot::<S, LEVEL>(&local, right);
        let (out, out_left, out_right) = (at_front.outside(&local), at_left.outside(&local), at_right.outside(&local));
        if out.or(out_left).or(out_right).any() {
            if out.any() {
                at_front =
                    simd.vectorize(Handover::<S, LEVEL> { simd, segments, home, part, point: front, outside: out }).0;
            }
            if out_left.any() {
                at_left = simd
                    .vectorize(Handover::<S, LEVEL> { simd, segments, home, part, point: left, outside: out_left })
                    .0;
            }
            if out_right.any() {
                let handover = Handover::<S, LEVEL> { simd, segments, home, part, point: right, outside: out_right };
                at_right = simd.vectorize(handover).0;
            }
        }

        // One steering wheel and one surface a running wheel can be in contact at a time.
        let mut lateral = at_front.normal.dot(velocity);
        if let Some(built) = self.forces.built.get(pack) {
            at_front.y = at_front.y - Lane::of(simd, &built.offset[0], part);
            lateral = lateral - Lane::of(simd, &built.rate[0], part);
        }
        let leftward = c.of(0.0).less(at_front.y);
        let steering =
            Side { depth: at_front.y.abs() - c.of(model.steering.gap), rate: lateral.select(leftward, -lateral) };
        let mut left = Running::new::<LEVEL>(&model.running, &at_left, swing + roll);
        let mut right = Running::new::<LEVEL>(&model.running, &at_right, swing - roll);
        if let Some(built) = self.forces.built.get(pack) {
            left.lift(Lane::of(simd, &built.offset[1], part), Lane::of(simd, &built.rate[1], part));
            right.lift(Lane::of(simd, &built.offset[2], part), Lane::of(simd, &built.rate[2], part));
        }
        let approach = &mut self.memory.approach[pack];
        let mut steer_memory = Lane::of(simd, &approach.steering, part);
        let mut left_memory = Lane::of(simd, &approach.running[0], part);
        let mut right_memory = Lane::of(simd, &approach.running[1], part);
        let fresh = fresh_contact(&steering, steer_memory);
        let fresh_left = fresh_contact(&left.side, left_memory);
        let fresh_right = fresh_contact(&right.side, right_memory);
        if fresh.or(fresh_left).or(fresh_right).any() {
            steer_memory = refreshed(fresh, model.floor, steering.rate, steer_memory);
            left_memory = refreshed(fresh_left, model.floor, left.side.rate, left_memory);
            right_memory = refreshed(fresh_right, model.floor, right.side.rate, right_memory);
        }
        if self.commit {
            opened(&steering, steer_memory).put(&mut approach.steering, part);
            opened(&left.side, left_memory).put(&mut approach.running[0], part);
            opened(&right.side, right_memory).put(&mut approach.running[1], part);
        }
        let mut powers = [hertz(&steering), hertz(&left.side), hertz(&right.side)];
        if !model.hertzian() {
            powers = [
                power(&steering, model.steering.contact.exponent),
                power(&left.side, model.running.contact.exponent),
                power(&right.side, model.running.contact.exponent),
            ];
        }
        let steer = contact(&model.steering.contact, &steering, powers[0], steer_memory);
        let run_left = contact(&model.running.contact, &left.side, powers[1], left_memory);
        let run_right = contact(&model.running.contact, &right.side, powers[2], right_memory);
        let signed = steer.select(leftward, -steer);

        // Rolling resistance.
        let speed = at_front.tangent.dot(velocity);
        let (sign, sign_left, sign_right) = directions(speed, left.speed, right.speed);
        let (steering_drag, running_drag) = (c.of(-model.steering.resistance), c.of(-model.running.resistance));
        let pull = load(simd, &self.forces.pull, place);
        let resisted = at_front.tangent.scale_add(steer * steering_drag * sign, pull);
        let mut pulled = at_front.normal.scale_add(-signed, resisted);
        if let Some(built) = self.forces.built.get(pack) {
            pulled = pulled + Lane3::of(simd, &built.push, part);
        }
        let on_left = left.force::<LEVEL>(&at_left, run_left, run_left * running_drag * sign_left);
        let on_right = right.force::<LEVEL>(&at_right, run_right, run_right * running_drag * sign_right);

        let both = on_left + on_right;
        let difference = axes.turn_back(on_left - on_right);
        let both_here = axes.turn_back(both);
        let arm = arm(simd, model);
        let mut torque =
            Lane3::of(simd, &self.forces.joint_torque[pack], part) + arm.cross(axes.turn_back(pulled) + both_here);
        torque.x = b.mul_add(difference.z, h.mul_add(both_here.y, torque.x));
        torque.y = h.neg_mul_add(both_here.x, torque.y);
        torque.z = b.neg_mul_add(difference.x, torque.z);
        let mut force = pulled + both - load(simd, &self.forces.pull, place + 1);

        // Linear motors: along the track nearest the middle of the cart.
        let share = Lane::load(simd, &self.forces.share[place..]);
        let driven = c.of(0.0).less(share);
        if driven.any() {
            let (back, down) = (c.of(-0.5 * model.cart.length), c.of(-model.cart.motor_height));
            let point = axes.xi.scale_add(back, axes.zeta.scale_add(down, front));
            let mut feet = foot::<S, LEVEL>(&local, point);
            let outside = feet.outside(&local).and(driven);
            if outside.any() {
                feet = simd.vectorize(Handover::<S, LEVEL> { simd, segments, home, part, point, outside }).0;
            }
            let thrust = feet.tangent.scale(share * c.of(self.command));
            force = force + thrust;
            let lever = Lane3::new(arm.x + back, arm.y, arm.z + down);
            torque = torque + lever.cross(axes.turn_back(thrust));
        }

        // Newton and Euler.
        let [ix, iy, iz] = model.cart.inertia;
        let momentum = Lane3::new(spin.x * c.of(ix), spin.y * c.of(iy), spin.z * c.of(iz));
        let mut linear = force.scale(c.of(1.0 / model.cart.mass));
        let mut net = torque - spin.cross(momentum);
        if let Some(built) = self.forces.built.get(pack) {
            let lightness = Lane::of(simd, &built.lightness, part);
            (linear, net) = (linear.scale(lightness), net.scale(lightness));
        }
        linear.z = linear.z - c.of(model.gravity);
        let angular = Lane3::new(net.x * c.of(1.0 / ix), net.y * c.of(1.0 / iy), net.z * c.of(1.0 / iz));
        let out = &mut self.out[pack];
        linear.put(&mut out.linear, part);
        angular.put(&mut out.angular, part);

        let loads = &mut self.forces.loads[pack];
        signed.put(&mut loads.steering, part);
        run_left.select(left.low, -run_left).put(&mut loads.running[0], part);
        run_right.select(right.low, -run_right).put(&mut loads.running[1], part);
        let axial = Lane::of(simd, &loads.joint[0], part);
        let offset = &mut self.forces.offset[pack];
        at_front.y.put(&mut offset[0], part);
        at_front.z.put(&mut offset[1], part);
        let on_rail = at_front.y.abs().less(c.of(OFF_RAIL)).and(at_front.z.abs().less(c.of(OFF_RAIL)));
        let whole = axial.abs().less(c.of(model.breaking));
        let finite = (linear.x + angular.x).abs().less(c.of(f64::MAX));
        !on_rail.and(whole).and(finite).all()
    }
}

/// tanh(v / 0.01 m/s) of three speeds; ±1 to the last digit beyond 0.2 m/s.
#[inline(always)]
fn directions<S: Simd>(a: Lane<S>, b: Lane<S>, c: Lane<S>) -> (Lane<S>, Lane<S>, Lane<S>) {
    let slow = a.constant(0.2);
    if a.abs().less(slow).or(b.abs().less(slow)).or(c.abs().less(slow)).any() {
        (a.map(direction), b.map(direction), c.map(direction))
    } else {
        let (one, zero) = (a.constant(1.0), a.constant(0.0));
        (one.select(zero.less(a), -one), one.select(zero.less(b), -one), one.select(zero.less(c), -one))
    }
}

fn direction(speed: f64) -> f64 {
    if speed.abs() < 0.2 { crate::base::trig::tanh(100.0 * speed) } else { speed.signum() }
}
