//! A choice in the dynamic model: forces in joints and on wheels against what they carry, and how long they live.
//!
//! A joint's force along the chain is counted by rainflow over the laps (ASTM E1049, begun at the largest so that every cycle
//! closes); a wheel's tread carries its force once a revolution, whatever else changes. Damage adds up after Palmgren (1924)
//! and Miner (1945) on S-N curves of constant slope.

use super::settings::Settings;
use crate::base::trig::{TAU, pow};
use crate::chain_input::{DeclaredEffect, Simulation};
use crate::compiled::Compiled;
use crate::dynamics::{End, Outcome, Plan, Progress};
use crate::effects;
use crate::model::{DriveDuty, Fatigue, Strength};
use crate::signal::Channel;
use crate::signal::rainflow::{damage_equivalent, rainflow};
use std::collections::BTreeMap;

/// Laps that are recorded.
const LAPS: usize = 2;
/// Share of all laps that a chain may fall behind before it is stopped.
const PATIENCE: f64 = 0.25;
/// A chain is slower than it should be from this share on.
const SLOW: f64 = 0.98;

/// What was found in the dynamic model.
#[derive(Clone, Debug)]
pub struct Check {
    pub carried: Vec<Carried>,
    /// Mean thrust of all motors, N, and speed, m/s.
    pub thrust: f64,
    pub speed: f64,
    /// Largest force that a load cell of the sensor cart measures, and its range, N; `None` where the layout measures
    /// nothing, or says no range.
    pub measured: Option<(f64, f64)>,
    /// Speed with the spare motors out of order, m/s; `None` where there are none.
    pub spare_speed: Option<f64>,
    /// What the chain is to run with, m/s.
    pub wanted_speed: f64,
    /// Years that it is to live, if the layout says so.
    pub years: Option<f64>,
}

/// What a part carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// `joint`
    pub part: &'static str,
    /// Largest force, with all motors and with the spare ones out of order, N.
    pub peak: f64,
    pub rated: Option<f64>,
    /// Years until its damage is 1; infinite where it takes none, `None` where no S-N curve is declared.
    pub life: Option<f64>,
}

impl Check {
    /// Whether forces are within what is declared and what load cells measure, parts live as long as they have to, and the
    /// chain keeps its speed.
    pub fn passes(&self) -> bool {
        self.is_but_for_range() && self.beyond_range().is_none()
    }

    /// What a load cell has to measure and cannot, N.
    pub fn beyond_range(&self) -> Option<f64> {
        self.measured.filter(|(peak, range)| peak > range).map(|(peak, _)| peak)
    }

    /// Whether it passes as far as chain and drive go.
    pub fn is_but_for_range(&self) -> bool {
        let slow = |speed: f64| speed < SLOW * self.wanted_speed;
        self.carried.iter().all(|part| part.passes(self.years))
            && !slow(self.speed)
            && !self.spare_speed.is_some_and(slow)
    }
}

impl Carried {
    /// Whether its force is within what is declared, and it lives as long as it has to, years.
    pub fn passes(&self, years: Option<f64>) -> bool {
        let strong = self.rated.is_none_or(|rated| self.peak <= rated);
        strong && !self.life.zip(years).is_some_and(|(life, years)| life < years)
    }
}

/// Runs a choice with its load on every cart. `running` has the time of running in a year, s, and the years.
///
/// # Errors
/// What stops the simulation.
pub fn check(
    compiled: &Compiled,
    duty: &DriveDuty,
    running: Option<(f64, f64)>,
    settings: &Settings,
) -> Result<Check, String> {
    let whole = loaded(compiled, duty);
    // The harder run first.
    let mut outcomes = Vec::new();
    if duty.spare > 0 {
        let mut without = whole.clone();
        without.motors.s_m.truncate(whole.motors.s_m.len().saturating_sub(duty.spare));
        outcomes.push(run(&without, settings).map_err(|why| format!("with the spare motors out of order, {why}"))?);
    }
    outcomes.insert(0, run(&whole, settings)?);
    let cart = &compiled.layout.cart;
    let wanted = compiled.layout.speed.value;
    let speed = |outcome: &Outcome| {
        let time = outcome.run.time.last().copied().unwrap_or(f64::INFINITY);
        LAPS as f64 * outcome.track / time
    };
    let seconds = running.map_or(365.0 * 24.0 * 3600.0, |(seconds, _)| seconds);
    let laps = seconds * wanted / outcomes[0].track / LAPS as f64;
    let peak = |channels: &[Channel]| outcomes.iter().map(|outcome| largest(outcome, channels)).fold(0.0, f64::max);
    let of = |part, channels: &[Channel], strength: &Strength, damage: &dyn Fn(&Fatigue) -> f64| Carried {
        part,
        peak: peak(channels),
        rated: strength.rated,
        life: strength.fatigue.as_ref().map(|fatigue| 1.0 / (damage(fatigue) * laps)),
    };
    let tread = |channels: [Channel; 2], radius: f64| {
        let outcome = &outcomes[0];
        move |fatigue: &Fatigue| {
            let worn = channels.map(|c| rolled(outcome.run.channels.get(&c), fatigue, outcome.track, radius));
            worn.into_iter().fold(0.0, f64::max)
        }
    };
    let joint = |fatigue: &Fatigue| pulled(outcomes[0].run.channels.get(&Channel::JointXi), fatigue);
    let (steering, running_wheels) = ([Channel::SteerLeft, Channel::SteerRight], [Channel::RunLeft, Channel::RunRight]);
    let joints = [Channel::JointXi, Channel::JointEta, Channel::JointZeta];
    Ok(Check {
        carried: vec![
            of("joint", &joints, &cart.joint.strength, &joint),
            of("steering wheel", &steering, &cart.steering.strength, &tread(steering, cart.steering.radius)),
            of("running wheel", &running_wheels, &cart.running.strength, &tread(running_wheels, cart.running.radius)),
        ],
        measured: {
            let range = compiled.layout.sensor.range.filter(|_| compiled.layout.equipment.photocell.is_some());
            let largest = || Channel::FORCES.iter().map(|force| peak(&[*force])).fold(0.0, f64::max);
            range.map(|range| (largest(), range))
        },
        thrust: outcomes[0].mean_thrust,
        speed: speed(&outcomes[0]),
        spare_speed: outcomes.get(1).map(speed),
        wanted_speed: wanted,
        years: running.map(|(_, years)| years),
    })
}

/// Laps of a chain. One that falls behind by a quarter of them is not waited for.
fn run(input: &Simulation, settings: &Settings) -> Result<Outcome, String> {
    let plan = Plan { laps: LAPS, ..Plan::default() };
    let lap_time = input.chain.track_length_m / input.chain.speed_m_s;
    let keeps_up = |p: Progress| p.time - plan.settle < (p.laps + PATIENCE * LAPS as f64) * lap_time;
    match effects::simulate(input, &plan, settings.width, &mut |p| keeps_up(p)) {
        Ok(Outcome { end: End::Trouble(trouble), .. }) => Err(trouble.to_string()),
        Ok(Outcome { end: End::Interrupted, .. }) => Err("the chain does not keep its speed".to_owned()),
        Ok(outcome) => Ok(outcome),
        Err(unfit) => Err(unfit.to_string()),
    }
}

/// The simulation of a choice, with its load and its drag.
fn loaded(compiled: &Compiled, duty: &DriveDuty) -> Simulation {
    let mut input = Simulation::new(compiled);
    input.cart.mass_kg += duty.load;
    if let Some(drag) = compiled.layout.cart.drag.filter(|drag| *drag > 0.0)
        && !input.effects.iter().any(|effect| effect.name == "speed_drag")
    {
        input.effects.push(DeclaredEffect {
            name: "speed_drag".to_owned(),
            strengths: BTreeMap::from([("drag".to_owned(), drag)]),
        });
    }
    input
}

/// Largest force of a part: of three channels the length of what they are the parts of, else the largest of each, N.
fn largest(outcome: &Outcome, channels: &[Channel]) -> f64 {
    let of = |channel: &Channel| outcome.run.channels.get(channel);
    let series: Vec<&Vec<f64>> = channels.iter().filter_map(of).collect();
    let samples = series.iter().map(|x| x.len()).min().unwrap_or(0);
    let at = |k: usize| match channels.len() {
        3 => series.iter().map(|x| x[k] * x[k]).sum::<f64>().sqrt(),
        _ => series.iter().map(|x| x[k].abs()).fold(0.0, f64::max),
    };
    (0..samples).map(at).fold(0.0, f64::max)
}

/// Damage of a history that repeats: whole cycles by rainflow, begun at the largest.
pub(super) fn pulled(force: Option<&Vec<f64>>, fatigue: &Fatigue) -> f64 {
    let Some(force) = force else { return 0.0 };
    let Some(top) = (0..force.len()).max_by(|a, b| force[*a].total_cmp(&force[*b])) else { return 0.0 };
    let mut history: Vec<f64> = force[top..].iter().chain(&force[..top]).copied().collect();
    history.push(force[top]);
    let equivalent = damage_equivalent(&rainflow(&history), fatigue.exponent, fatigue.cycles);
    equivalent.map_or(0.0, |load| pow(load / fatigue.range, fatigue.exponent))
}

/// Damage of a tread over all laps: each revolution a cycle from nothing to the force.
pub(super) fn rolled(force: Option<&Vec<f64>>, fatigue: &Fatigue, lap: f64, radius: f64) -> f64 {
    let Some(force) = force.filter(|force| !force.is_empty()) else { return 0.0 };
    let revolutions = LAPS as f64 * lap / (TAU * radius);
    let each = force.iter().map(|force| pow(force.abs() / fatigue.range, fatigue.exponent)).sum::<f64>();
    each / force.len() as f64 * revolutions / fatigue.cycles
}
