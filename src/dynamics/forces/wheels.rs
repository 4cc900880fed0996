//! The wheels (design: chain model, wheels, rolling resistance).

use super::{Evaluation, Turned, load};
use crate::dynamics::contact::{Between, Powers, hertz, one_over};
use crate::dynamics::lanes::{Lane, Lane3, Splat};
use crate::dynamics::segments::feet;
use crate::dynamics::state::PACK;
use pulp::{Simd, WithSimd};

/// Forces of the track on the wheels of several carts.
pub(super) struct OnWheels<S: Simd> {
    /// On the steering wheels, at the front joint, in the world, N.
    pub steering: Lane3<S>,
    /// On both running wheels, in the world, N.
    pub running: Lane3<S>,
    /// Of the running wheels' forces about the front joint, in the cart's axes, N m.
    pub torque: Lane3<S>,
    /// Of the steering wheels, the left and the right running wheel, N s/m.
    pub damping: [Lane<S>; 3],
}

impl Evaluation<'_> {
    /// Forces on the wheels, and what they leave to be read.
    #[inline(always)]
    pub(super) fn wheels<S: Simd, const LEVEL: bool>(
        &mut self,
        simd: S,
        pack: usize,
        part: usize,
        turned: &Turned<S>,
    ) -> OnWheels<S> {
        let model = self.model;
        let c = Splat(simd);
        let place = pack * PACK + part * S::F64_LANES;
        let front = load(simd, &self.forces.front, place);
        let velocity = load(simd, &self.forces.front_velocity, place);

        // The running wheels at (0, ±b, −h) from the front joint, and ω × (0, ±b, −h).
        let Turned { axes, spin } = turned;
        let (b, h) = (c.of(model.running.half_spacing), c.of(model.running.height));
        let below = axes.zeta.scale_add(-h, front);
        let beside = axes.eta.scale(b);
        let swing = axes.eta.scale_add(h * spin.x, axes.xi.scale_add(-(h * spin.y), velocity));
        let roll = axes.zeta.scale_add(b * spin.x, axes.xi.scale(-(b * spin.z)));
        let at_front = &self.forces.places[pack];
        let track = at_front.track::<S, LEVEL>(simd, part);
        let [home_left, home_right] = &mut self.memory.home[pack].running;
        let at_left = feet::<S, LEVEL>(simd, &model.segments, home_left, part, below + beside).0;
        let at_right = feet::<S, LEVEL>(simd, &model.segments, home_right, part, below - beside).0;
        let (on_left, on_right) = (at_left.rail(), at_right.rail());

        // Each between two surfaces: their offsets from the middle, and the rates of these.
        let middle = c.of(model.running.height - 0.5 * model.running.gap);
        let mut y = Lane::of(simd, &at_front.y, part);
        let (mut left, mut right) = (at_left.z + middle, at_right.z + middle);
        let mut y_rate = track.across::<LEVEL>(velocity);
        let (mut left_rate, mut right_rate) =
            (on_left.above::<LEVEL>(swing + roll), on_right.above::<LEVEL>(swing - roll));
        if let Some(built) = self.forces.built.get(pack) {
            let offset = Lane3::of(simd, &built.offset, part);
            let rate = Lane3::of(simd, &built.rate, part);
            (y, left, right) = (y - offset.x, left - offset.y, right - offset.z);
            (y_rate, left_rate, right_rate) = (y_rate - rate.x, left_rate - rate.y, right_rate - rate.z);
        }
        let steering = Between::new(y, y_rate, model.steering.gap);
        let left = Between::new(left, left_rate, 0.5 * model.running.gap);
        let right = Between::new(right, right_rate, 0.5 * model.running.gap);

        let approach = &mut self.memory.approach[pack];
        let mut memory = [
            Lane::of(simd, &approach.steering, part),
            Lane::of(simd, &approach.running[0], part),
            Lane::of(simd, &approach.running[1], part),
        ];
        let fresh = [steering.fresh(memory[0]), left.fresh(memory[1]), right.fresh(memory[2])];
        if fresh[0].or(fresh[1]).or(fresh[2]).any() {
            let now = one_over(model.floor, [steering.rate(), left.rate(), right.rate()]);
            memory = [
                now[0].select(fresh[0], memory[0]),
                now[1].select(fresh[1], memory[1]),
                now[2].select(fresh[2], memory[2]),
            ];
        }
        if self.commit {
            steering.opened(memory[0]).put(&mut approach.steering, part);
            left.opened(memory[1]).put(&mut approach.running[0], part);
            right.opened(memory[2]).put(&mut approach.running[1], part);
        }
        let depths = [steering.indentation(), left.indentation(), right.indentation()];
        let mut powers = [hertz(depths[0]), hertz(depths[1]), hertz(depths[2])];
        if !model.hertzian() {
            let running = model.running.contact.exponent;
            let exponents = [model.steering.contact.exponent, running, running];
            let [a, b, c] = simd.vectorize(Powers(depths, exponents));
            powers = [a, b, c];
        }
        let [steer, steer_damping] = steering.force(&model.steering.contact, powers[0], memory[0]);
        let [run_left, left_damping] = left.force(&model.running.contact, powers[1], memory[1]);
        let [run_right, right_damping] = right.force(&model.running.contact, powers[2], memory[2]);
        let (back, up_left, up_right) = (steering.back(steer), left.back(run_left), right.back(run_right));
        let loads = &mut self.forces.loads[pack];
        (-back).put(&mut loads.steering, part);
        up_left.put(&mut loads.running[0], part);
        up_right.put(&mut loads.running[1], part);

        // Rolling resistance, against each wheel's direction: forwards, but for a chain that hardly moves.
        let (steering_drag, running_drag) = (c.of(-model.steering.resistance), c.of(-model.running.resistance));
        let mut drags = [steer * steering_drag, run_left * running_drag, run_right * running_drag];
        let speed = Lane::load(simd, &self.forces.speed[place..]);
        let turning = (b + h.abs()) * (spin.x.abs() + spin.y.abs() + spin.z.abs());
        if !c.of(SLOW).less(speed - turning).all() {
            let speeds = [speed, on_left.along::<LEVEL>(swing + roll), on_right.along::<LEVEL>(swing - roll)];
            let [a, b, c] = simd.vectorize(Slowly { drags, speeds });
            drags = [a, b, c];
        }
        let on_left = on_left.force::<LEVEL>(drags[1], up_left);
        let on_right = on_right.force::<LEVEL>(drags[2], up_right);
        let running = on_left + on_right;
        let difference = axes.turn_back(on_left - on_right);
        let both = axes.turn_back(running);
        // (0, b, −h) × left + (0, −b, −h) × right
        let torque = Lane3::new(b.mul_add(difference.z, h * both.y), -(h * both.x), -(b * difference.x));
        let damping = [steer_damping, left_damping, right_damping];
        OnWheels { steering: track.sideways::<LEVEL>(drags[0], back), running, torque, damping }
    }
}

/// Speed beyond which a wheel's rolling resistance is against it to the last digit, m/s.
const SLOW: f64 = 0.2;

/// Rolling resistance of wheels that may be slow: times tanh(v / 0.01 m/s).
struct Slowly<S: Simd> {
    drags: [Lane<S>; 3],
    /// m/s
    speeds: [Lane<S>; 3],
}

impl<S: Simd> WithSimd for Slowly<S> {
    type Output = [Lane<S>; 3];

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) -> Self::Output {
        let Slowly { drags: [a, b, c], speeds } = self;
        [a * speeds[0].map(direction), b * speeds[1].map(direction), c * speeds[2].map(direction)]
    }
}

fn direction(speed: f64) -> f64 {
    if speed.abs() < SLOW { crate::base::trig::tanh(100.0 * speed) } else { speed.signum() }
}
