//! The library of effects that the nominal model lacks: each a change to the chain or to what its sensors say, with strengths.
//!
//! [`LIBRARY`] lists them; one file each. [`built`] and [`sense`] are what a simulation with effects is made of, so that
//! `effect joint_clearance(gap: 0.05 mm)` in a layout runs in `lss simulate` as it does in a diagnosis.

mod cart_bending;
pub mod control_delay;
pub mod curve_geometry;
mod fork_swivel;
mod joint_clearance;
mod joint_friction;
pub mod load_distribution;
mod motor_imbalance;
mod motor_ripple;
mod pitch_wear;
pub mod rail_step;
mod rail_waviness;
mod rebuilt;
mod sensor_bias_drift;
mod sensor_clipping;
mod sensor_crosstalk;
mod sensor_gain;
mod sensor_lag;
mod sensor_swapped;
pub mod sites;
mod speed_drag;
mod stiffness_temperature;
mod track_flexibility;
mod wheel_out_of_round;
mod wheel_sliding;

use crate::base::random::uniform;
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;
use crate::dynamics::Unfit;
use crate::syntax::by_likeness;
use sites::Site;
use std::collections::BTreeMap;

/// All effects that a diagnosis knows.
pub const LIBRARY: [&Effect; 22] = [
    &joint_clearance::EFFECT,
    &wheel_sliding::EFFECT,
    &fork_swivel::EFFECT,
    &track_flexibility::EFFECT,
    &wheel_out_of_round::EFFECT,
    &rail_step::EFFECT,
    &motor_ripple::EFFECT,
    &motor_imbalance::EFFECT,
    &joint_friction::EFFECT,
    &load_distribution::EFFECT,
    &stiffness_temperature::EFFECT,
    &curve_geometry::EFFECT,
    &pitch_wear::EFFECT,
    &speed_drag::EFFECT,
    &control_delay::EFFECT,
    &cart_bending::EFFECT,
    &sensor_gain::EFFECT,
    &sensor_bias_drift::EFFECT,
    &sensor_crosstalk::EFFECT,
    &sensor_lag::EFFECT,
    &sensor_clipping::EFFECT,
    &sensor_swapped::EFFECT,
];

/// What every built chain has, so that no diagnosis names it; a layout may.
pub const BUILT: [&Effect; 1] = [&rail_waviness::EFFECT];

/// How far a strength is off, as a share, where another equation made it: of the ones that challenges had and a diagnosis named, half were
/// within 5 %, three quarters within 25 % (docs/gap-challenges.md).
const ASSUMED: f64 = 0.15;

/// Of a ratio or a level that a sensor is off by, which has no other equation.
const EXACT: f64 = 0.0;

/// An effect.
pub struct Effect {
    pub name: &'static str,
    /// What is unlike the nominal model, in a few words.
    pub about: &'static str,
    /// By what share of itself a strength may be another in the machine, whose equation is not this one: a standard deviation.
    pub doubt: f64,
    /// What is fitted.
    pub strengths: &'static [Strength],
    /// What says where it sits, with the value that an `effect` without it has.
    pub places: &'static [(&'static str, f64)],
    /// Where it may sit in a layout.
    pub sites: fn(&Simulation) -> Vec<Site>,
    pub act: Act,
}

/// What an effect changes.
pub enum Act {
    /// The chain.
    Chain(fn(&Strengths, &mut Simulation, &mut Deviations)),
    /// What the sensor cart's channels say.
    Sensor(fn(&Strengths, &mut Sensed)),
}

/// A strength that is fitted.
pub struct Strength {
    pub name: &'static str,
    /// SI unit; empty for a ratio.
    pub unit: &'static str,
    pub about: &'static str,
    /// A small one, of which the signature is taken.
    pub trial: f64,
    /// What every built chain has of it, as a deviation: that much is no gap.
    pub usual: f64,
    pub low: f64,
    pub high: f64,
}

/// Strengths and places of an effect by name; what is not given has its default.
pub struct Strengths<'a> {
    pub given: &'a BTreeMap<String, f64>,
    effect: &'a Effect,
}

impl Strengths<'_> {
    pub fn of(&self, name: &str) -> f64 {
        let default = || self.effect.places.iter().find(|(n, _)| *n == name).map_or(0.0, |(_, x)| *x);
        self.given.get(name).copied().unwrap_or_else(default)
    }

    /// A number that counts from 1, as an index.
    pub fn index(&self, name: &str) -> usize {
        (self.of(name).round().max(1.0) as usize) - 1
    }
}

/// What a sensor cart sampled.
pub struct Sensed<'a> {
    /// s, from the run's beginning; that of a cart which was elsewhere then jumps back where the run began.
    pub time: &'a [f64],
    /// From one sample to the next, s.
    pub period: f64,
    /// `steer_left`, `steer_right`, `run_left`, `run_right`, `joint_xi`, `joint_eta`, `joint_zeta`, N; an empty one was not
    /// measured.
    pub forces: &'a mut [Vec<f64>; 7],
    /// The largest of each channel in the whole run, N.
    pub tops: [f64; 7],
}

/// The effect of a name.
pub fn named(name: &str) -> Option<&'static Effect> {
    LIBRARY.into_iter().chain(BUILT).find(|e| e.name == name)
}

/// A unit as the language spells it.
pub fn spelled(unit: &str) -> String {
    unit.replace(' ', "*").replace('²', "^2")
}

/// The chain of an input with effects: the input without them, and how the chain deviates from it.
///
/// # Errors
///
/// [`Unfit`] for an effect or a strength that there is not.
pub fn built(simulation: &Simulation) -> Result<(Simulation, Deviations), Unfit> {
    let mut deviations = Deviations::default();
    if simulation.effects.is_empty() {
        return Ok((simulation.clone(), deviations));
    }
    let mut nominal = simulation.clone();
    nominal.effects.clear();
    for (k, given) in simulation.effects.iter().enumerate() {
        let place = |name: &str| format!("effects.{k}.{name}");
        let Some(effect) = named(&given.name) else {
            let names = by_likeness(&given.name, LIBRARY.iter().chain(&BUILT).map(|e| e.name));
            let why = format!("there is no effect `{}`; the nearest first, there are {}", given.name, names.join(", "));
            return Err(Unfit { place: place("name"), why });
        };
        for (name, value) in &given.strengths {
            let place = place(&format!("strengths.{name}"));
            match effect.strengths.iter().find(|s| s.name == name) {
                Some(s) if (s.low..=s.high).contains(value) => {}
                Some(s) => {
                    return Err(Unfit {
                        place,
                        why: format!("{value} must be between {} and {} {}", s.low, s.high, s.unit),
                    });
                }
                None if effect.places.iter().any(|(n, _)| n == name) && value.is_finite() => {}
                None => {
                    let names = effect.strengths.iter().map(|s| s.name).chain(effect.places.iter().map(|p| p.0));
                    let names: Vec<&str> = names.collect();
                    return Err(Unfit { place, why: format!("`{}` has {}", effect.name, names.join(", ")) });
                }
            }
        }
        if let Act::Chain(act) = effect.act {
            act(&Strengths { given: &given.strengths, effect }, &mut nominal, &mut deviations);
        }
    }
    Ok((nominal, deviations))
}

/// Puts the sensors' effects of an input into what was sampled.
pub fn sense(simulation: &Simulation, sensed: &mut Sensed) {
    for given in &simulation.effects {
        if let Some(effect) = named(&given.name)
            && let Act::Sensor(act) = effect.act
        {
            act(&Strengths { given: &given.strengths, effect }, sensed);
        }
    }
}

impl Effect {
    /// SI unit of what says its place; `None` of what does not.
    pub fn place_unit(&self, name: &str) -> Option<&'static str> {
        let (name, _) = self.places.iter().find(|(n, _)| *n == name)?;
        Some(if ["at", "back", "rise", "span", "wavelength"].contains(name) { "m" } else { "" })
    }

    /// SI unit of a strength or of what says its place, as a layout writes it; empty for a ratio.
    pub fn unit(&self, name: &str) -> Option<&'static str> {
        self.strengths.iter().find(|s| s.name == name).map(|s| s.unit).or_else(|| self.place_unit(name))
    }

    /// Whether it is one of the sensors.
    pub fn is_sensor(&self) -> bool {
        matches!(self.act, Act::Sensor(_))
    }
}

/// Points of a table lie no farther apart, m, so that it does not matter where between two a step of 50 mm lies.
const SPACING: f64 = 5e-3;

/// Points of a table over the lap.
fn points(lap: f64) -> usize {
    ((lap / SPACING).ceil() as usize).clamp(16, 1 << 20)
}

/// Adds a profile over the lap to a table.
fn add_profile(table: &mut Vec<f64>, lap: f64, profile: impl Fn(f64) -> f64) {
    if table.is_empty() {
        table.resize(points(lap), 0.0);
    }
    let n = table.len();
    table.iter_mut().enumerate().for_each(|(k, x)| *x += profile(lap * k as f64 / n as f64));
}

/// A number in (−1, 1) for a cart, by chance but always the same. A sequence that is more even than chance would leave out the long waves
/// along the chain, which pull most.
fn spread(i: usize) -> f64 {
    2.0 * uniform(&mut (i as u64 + 1)) - 1.0
}

#[cfg(test)]
mod tests;
