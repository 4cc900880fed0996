//! A chain that moves: state, memory of its contacts, controller and clock.

use super::control::{Control, Late};
use super::forces::{CommandChange, Evaluation, Forces, Memory};
use super::law::Damped;
use super::model::Model;
use super::start::start;
use super::state::{Accelerations, PACK, PackRow, State};
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

    /// Fastest rates at which damping acts now, 1/s: |F| χ/v₀ + c of the joints along the chain, and of joints and
    /// wheels across it; each pack of carts taken for an endless chain with the strongest of its own.
    pub fn damping_rates(&self) -> (f64, f64) {
        let model = &self.model;
        let along = 4.0 / model.cart.mass;
        let ends = model.cart.ends();
        let (mut axial, mut across) = (0.0_f64, 0.0_f64);
        for (loads, approach) in self.forces.loads.iter().zip(&self.memory.approach).take(model.carts / PACK) {
            // Halved again and again, which takes several carts at once.
            let strongest = |load: &PackRow, approach: &PackRow| {
                let larger = |a: f64, b: f64| if b > a { b } else { a };
                let each: PackRow = std::array::from_fn(|k| (load[k] * approach[k]).abs());
                let four: [f64; 4] = std::array::from_fn(|k| larger(each[k], each[k + 4]));
                larger(larger(four[0], four[2]), larger(four[1], four[3]))
            };
            let at = |law: &Damped, strongest: f64| law.factor * strongest + law.viscosity;
            let joint = |law: &Damped, k: usize| at(law, strongest(&loads.joint[k], &approach.joint[k]));
            let steering = at(&model.steering.contact, strongest(&loads.steering, &approach.steering));
            let run = |k: usize| at(&model.running.contact, strongest(&loads.running[k], &approach.running[k]));
            let lateral = ends.rate(joint(&model.radial, 1), steering);
            let vertical = ends.rate(joint(&model.radial, 2), run(0) + run(1));
            axial = axial.max(along * joint(&model.axial, 0));
            across = across.max(lateral).max(vertical);
        }
        (axial, across)
    }

    /// Largest step that damping leaves stable now, s. A step h of the integrator leaves a mode of frequency ω and
    /// damping rate λ stable where hλ + (hω)²/4 ≤ 1, so kept across the chain, where all carts are alike. Along it,
    /// peaks pass: only the few joints within one are damped that fast, and 1.1/λ is enough.
    pub fn stable_step(&self) -> f64 {
        let (axial, across) = self.damping_rates();
        // The root of h²ω²/4 + hλ = 1 that stays exact where ω is small.
        let root = 2.0 / (across + (across * across + self.model.stiffness_rate).sqrt());
        (1.1 / axial.max(1e-9)).min(root)
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
