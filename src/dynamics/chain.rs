//! A chain that moves: state, memory of its contacts, controller and clock.

use super::control::Control;
use super::forces::{Evaluation, Forces, Memory};
use super::model::{Model, Unfit};
use super::start::start;
use super::state::{Accelerations, PACK, State};
use super::width::Width;
use std::sync::Arc;

/// A chain at one moment.
#[derive(Clone, Debug)]
pub struct Chain {
    pub model: Arc<Model>,
    pub state: State,
    pub memory: Memory,
    pub forces: Forces,
    pub accelerations: Vec<Accelerations>,
    pub control: Control,
    /// s
    pub time: f64,
    pub width: Width,
    /// Pitch at which this phase closes, m.
    pub closing_pitch: f64,
    /// Evaluations of all forces so far; where only the command changed, they are not counted.
    pub evaluations: u64,
}

impl Chain {
    /// The kinematic initial state, at the speed of the model, with the front joint of the first cart at arc length `front`, m.
    pub fn new(model: Arc<Model>, front: f64, width: Width) -> Result<Chain, Unfit> {
        let (state, memory, closed) = start(&model, front, model.speed)?;
        let forces = Forces::new(&model);
        let accelerations = vec![Accelerations::default(); state.bodies.len()];
        let mut chain = Chain {
            model,
            state,
            memory,
            forces,
            accelerations,
            control: Control::default(),
            time: 0.0,
            width,
            closing_pitch: closed.pitch,
            evaluations: 0,
        };
        chain.evaluate(true);
        Ok(chain)
    }

    /// Forces and accelerations of the present state.
    pub fn evaluate(&mut self, commit: bool) {
        self.evaluations += 1;
        self.run(commit, false);
    }

    fn run(&mut self, commit: bool, again: bool) {
        self.width.run(Evaluation {
            model: &self.model,
            bodies: &self.state.bodies,
            memory: &mut self.memory,
            forces: &mut self.forces,
            out: &mut self.accelerations,
            command: self.control.command,
            commit,
            again,
        });
    }

    /// A sample of the speed controller, and the forces under its new command.
    pub fn sample_control(&mut self) {
        let speed = self.forces.mean_speed(self.model.carts);
        let before = self.control.command;
        self.control.sample(&self.model.controller, self.model.motors.force, self.model.speed, speed);
        if self.control.command != before {
            self.run(true, true);
        }
    }

    /// Fastest rate at which damping at a joint acts now, 1/s: |F| χ/v₀ + c, times the joint's mobility.
    pub fn damping_rate(&self) -> f64 {
        let model = &self.model;
        let (along, across) = model.mobility();
        let (mut axial, mut radial) = (0.0, 0.0);
        for (loads, approach) in self.forces.loads.iter().zip(&self.memory.approach).take(model.carts / PACK) {
            for lane in 0..PACK {
                let damping = |k: usize| (loads.joint[k][lane] * approach.joint[k][lane]).abs();
                let (x, y, z) = (damping(0), damping(1), damping(2));
                axial = if x > axial { x } else { axial };
                radial = if y > radial { y } else { radial };
                radial = if z > radial { z } else { radial };
            }
        }
        let axial = along * (model.axial.factor * axial + model.axial.viscosity);
        let radial = across * (model.radial.factor * radial + model.radial.viscosity);
        axial.max(radial)
    }

    /// Largest step that damping at the joints leaves stable now, with a margin, s: the integrator is stable below hλ = 2,
    /// as Heun's method.
    pub fn stable_step(&self) -> f64 {
        1.1 / self.damping_rate().max(1e-9)
    }

    /// Kinetic energy of all carts, J.
    pub fn kinetic_energy(&self) -> f64 {
        let cart = &self.model.cart;
        (0..self.model.carts)
            .map(|i| {
                let bodies = &self.state.bodies[i / PACK];
                let square = |rows: &[[f64; PACK]; 3], weights: [f64; 3]| -> f64 {
                    (0..3).map(|k| weights[k] * rows[k][i % PACK] * rows[k][i % PACK]).sum()
                };
                0.5 * (square(&bodies.velocity, [cart.mass; 3]) + square(&bodies.spin, cart.inertia))
            })
            .sum()
    }

    /// Energy of weight and of springs, J: K δⁿ⁺¹/(n+1) at every contact.
    pub fn potential_energy(&self) -> f64 {
        let model = &self.model;
        let spring = |law: &super::law::Damped, depth: f64| {
            law.stiffness * crate::geometry::trig::pow(depth.max(0.0), law.exponent + 1.0) / (law.exponent + 1.0)
        };
        (0..model.carts)
            .map(|i| {
                let place = self.placed(i);
                let [e, n, z] = place.elongation.map(f64::abs);
                let joints = spring(&model.axial, e) + spring(&model.radial, n) + spring(&model.radial, z);
                let steering = spring(&model.steering.contact, place.lateral.abs() - model.steering.gap);
                let running: f64 = place
                    .heights
                    .iter()
                    .map(|h| spring(&model.running.contact, -h) + spring(&model.running.contact, h - model.running.gap))
                    .sum();
                let height = self.state.bodies[i / PACK].position[2][i % PACK];
                joints + steering + running + model.cart.mass * model.gravity * height
            })
            .sum()
    }
}
