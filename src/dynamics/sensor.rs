//! The sensor cart's chain of measurement: forces through a low-pass that runs at the simulation's step, then sampled
//! (thesis §2.3; design: chain model, sensor cart).

use super::chain::Chain;
use super::state::PACK;
use crate::chain_input::Sensor;
use crate::dynamics::state::{attitude, vector};
use crate::signal::filter::Lowpass;
use crate::signal::{Channel, FORCES};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Nominal temperature of the wheels' cores, °C.
const TEMPERATURE: f64 = 20.0;

/// The cart that carries the sensors.
#[derive(Clone, Debug)]
pub struct SensorCart {
    /// Its place in the chain, from 0.
    cart: usize,
    /// Arc length of the photocell and how far past it the trigger reads 1, m.
    photocell: (f64, f64),
    filters: [Lowpass; FORCES],
    filtered: [f64; FORCES],
}

impl SensorCart {
    /// At rest at the present forces. `None` when the low-pass is at or above half the rate of steps.
    pub fn new(sensor: &Sensor, chain: &Chain, step: f64) -> Option<Self> {
        let mut filters = [Lowpass::new(sensor.lowpass_hz, 1.0 / step)?; FORCES];
        let cart = sensor.cart - 1;
        let now = forces(chain, cart);
        for (filter, force) in filters.iter_mut().zip(now) {
            filter.reset_to(force);
        }
        Some(SensorCart { cart, photocell: (sensor.photocell_s_m, sensor.trigger_length_m), filters, filtered: now })
    }

    /// Takes the forces of another step.
    pub fn step(&mut self, chain: &Chain) {
        for ((filter, filtered), force) in self.filters.iter_mut().zip(&mut self.filtered).zip(forces(chain, self.cart))
        {
            *filtered = filter.step(force);
        }
    }

    /// All channels now.
    pub fn sample(&self, chain: &Chain, into: &mut BTreeMap<Channel, Vec<f64>>) {
        let mut put = |channel: Channel, value: f64| into.entry(channel).or_default().push(value);
        for (channel, value) in Channel::FORCES.into_iter().zip(self.filtered) {
            put(channel, value);
        }
        for (channel, value) in self.wheel_speeds(chain) {
            put(channel, value);
        }
        put(Channel::ForkLeft, 0.0);
        put(Channel::ForkRight, 0.0);
        put(Channel::Temperature, TEMPERATURE);
        let (photocell, length) = self.photocell;
        let past = (chain.forces.station[self.cart] - photocell).rem_euclid(chain.model.segments.line.length);
        put(Channel::Trigger, if past < length { 1.0 } else { 0.0 });
    }

    /// v/r of the four wheels along the track, in contact or not, rad/s.
    fn wheel_speeds(&self, chain: &Chain) -> [(Channel, f64); 4] {
        let model = &chain.model;
        let (pack, lane) = (self.cart / PACK, self.cart % PACK);
        let bodies = &chain.state.bodies[pack];
        let (turn, spin) = (attitude(bodies, lane), vector(&bodies.spin, lane));
        let velocity = vector(&bodies.velocity, lane);
        let [xi, zeta] = model.cart.centre;
        let segment = chain.memory.home[pack].front.segment[lane] as usize;
        let speed = |y: f64, z: f64, radius: f64| {
            let arm = Vector3::new(-xi, y, z - zeta);
            let point = chain.point(self.cart, [0.0, y, z]);
            let tangent = Vector3::from(model.segments.footing(point.into(), segment).tangent);
            (velocity + turn * spin.cross(&arm)).dot(&tangent) / radius
        };
        let (steering, running) = (&model.steering, &model.running);
        let steer = |side: f64| speed(side * steering.half_spacing, -steering.height, steering.radius);
        let run = |side: f64| speed(side * running.half_spacing, -running.height, running.radius);
        [
            (Channel::WheelSpeedSteerLeft, steer(1.0)),
            (Channel::WheelSpeedSteerRight, steer(-1.0)),
            (Channel::WheelSpeedRunLeft, run(1.0)),
            (Channel::WheelSpeedRunRight, run(-1.0)),
        ]
    }
}

/// Wheel forces and the force of the leader on the front joint, in the leader's axes, N.
pub fn forces(chain: &Chain, cart: usize) -> [f64; FORCES] {
    let loads = &chain.forces.loads[cart / PACK];
    let lane = cart % PACK;
    let leader = (cart + chain.model.carts - 1) % chain.model.carts;
    let pull = &chain.forces.loads[leader / PACK].joint;
    let [xi, eta, zeta] = [0, 1, 2].map(|k| -pull[k][leader % PACK]);
    let steering = loads.steering[lane];
    [steering.max(0.0), (-steering).max(0.0), loads.running[0][lane].abs(), loads.running[1][lane].abs(), xi, eta, zeta]
}
