//! A chain that moves: state, memory of its contacts, controller and clock.

use super::control::{Control, Late};
use super::forces::{CommandChange, Evaluation, Forces, Memory};
use super::model::Model;
use super::start::start;
use super::state::{Accelerations, PACK, State};
use super::step::stable;
use super::width::Width;
use crate::chain_input::{Deviations, Unfit};
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
    /// Evaluations of all forces so far.
    pub evaluations: u64,
}

impl Chain {
    /// The kinematic initial state, at the speed of the model, with the front joint of the first cart at arc length
    /// `front`, m.
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
        self.run(commit, None);
    }

    /// A step of velocity Verlet, s.
    pub(super) fn step(&mut self, h: f64) {
        self.run(true, Some(h));
    }

    fn run(&mut self, commit: bool, step: Option<f64>) {
        self.evaluations += 1;
        self.width.run(Evaluation {
            model: &self.model,
            bodies: &mut self.state.bodies,
            memory: &mut self.memory,
            forces: &mut self.forces,
            accelerations: &mut self.accelerations,
            command: self.control.command,
            commit,
            step,
        });
    }

    /// A sample of the speed controller, and the forces under its new command.
    pub fn sample_control(&mut self) {
        let speed = self.forces.mean_speed(self.model.carts);
        let before = self.control.command;
        let model = &self.model;
        let deviations = &model.deviations;
        if deviations.delay > 0.0 || deviations.saturation < 1.0 || deviations.hum[0] != 0.0 {
            let Deviations { delay, saturation, hum, .. } = **deviations;
            let late = Late { delay, saturation, hum, time: self.time };
            self.control.sample_late(&model.controller, model.motors.force, model.speed, speed, &late);
        } else {
            self.control.sample(&model.controller, model.motors.force, model.speed, speed);
        }
        let change = self.control.command - before;
        if change != 0.0 {
            self.width.run(CommandChange {
                model: &self.model,
                memory: &mut self.memory,
                forces: &self.forces,
                accelerations: &mut self.accelerations,
                change,
            });
        }
    }

    /// Largest step that damping leaves stable now, s: kept across the chain, where all carts are alike. Along it, peaks
    /// pass, as only the few joints within one are damped that fast.
    pub fn stable_step(&self) -> f64 {
        let [axial, across] = self.forces.damping_rates();
        let [along_square, across_square] = self.model.stiffness_rates;
        stable(axial / 1.1, along_square).min(stable(across, across_square))
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
            law.stiffness * crate::base::trig::pow(depth.max(0.0), law.exponent + 1.0) / (law.exponent + 1.0)
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
