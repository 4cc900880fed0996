//! The library of effects that the nominal model lacks: each a change to the chain or to what its sensors say, with
//! strengths.
//!
//! [`LIBRARY`] lists them; one file each. [`deviations_of`] and [`sense`] are what a simulation with effects is made
//! of, so that `effect joint_clearance(gap: 0.05 mm)` in a layout runs in `lss simulate` as it does in a diagnosis.

mod cart_bending;
mod control_delay;
mod curve_geometry;
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
mod simulate;
pub mod sites;
mod speed_drag;
pub mod stiffness_temperature;
mod track_flexibility;
mod wheel_out_of_round;
mod wheel_sliding;

use crate::base::random::uniform;
use crate::chain_input::{DeclaredEffect, Deviations, Simulation, Unfit};
use crate::model::effect_definitions::{self, EffectDefinition, StrengthDefinition};
use crate::signal::FORCES;
use crate::syntax::by_likeness;
pub use simulate::{model, run_ensemble, simulate, simulate_all};
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
pub const AS_BUILT: [&Effect; 1] = [&rail_waviness::EFFECT];

/// How far a strength is off, as a share, where another equation made it: of the ones that challenges had and a
/// diagnosis named, half were within 5 %, three quarters within 25 % (docs/gap-challenges.md).
const ASSUMED: f64 = 0.15;

/// Of a ratio or a level that a sensor is off by, which has no other equation.
const EXACT: f64 = 0.0;

/// From a site and how well it is known, m, to sites like it, each with those beside it.
pub type Alternatives = fn(&Site, f64) -> Vec<(Site, Vec<Site>)>;

/// Whether something holds at a site.
pub type AtSite = fn(&Site) -> bool;

/// An effect.
pub struct Effect {
    /// Its name, strengths and places, as a layout may write them.
    pub definition: &'static EffectDefinition,
    /// Model discrepancy: by what share of itself a strength may be another in the machine, whose equation is not this
    /// one, as a standard deviation.
    pub discrepancy: f64,
    /// Of each strength, in the order of the definition.
    pub fitted: &'static [StrengthSearch],
    pub sites: Sites,
    /// Whether it has a strength at a site.
    pub has: fn(&Site, &str) -> bool,
    /// Whether it may be at several of its sites at once.
    pub several: bool,
    /// Sites that look much like one at which the effect explains something, each with those beside it in turn. The
    /// number is how well the site is known, m.
    pub alternatives: Alternatives,
    /// By what the effect differs in a way that nobody knows, and at which sites it does.
    pub random: Option<(RandomEffect, AtSite)>,
    /// How a chain with these strengths begins.
    pub start: fn(&BTreeMap<String, f64>) -> Start,
    /// What separates it from effects that look like it.
    pub separated_by: Experiment,
    pub act: Act,
}

/// How a strength is looked for.
pub struct StrengthSearch {
    /// A small one, of which the signature is taken.
    pub trial: f64,
    /// As-built tolerance: what every built chain has of it, as a deviation. That much is no gap.
    pub as_built: f64,
    /// Whether it is looked for only beside the effect's other strengths, where these explain something: without them
    /// it is what they are at another site.
    pub beside: bool,
    /// Whether each run may have a strength of its own, as repeated passes of a place tell it.
    pub by_run: bool,
}

impl StrengthSearch {
    /// Of a strength that is looked for by itself.
    const fn alone(trial: f64, as_built: f64) -> Self {
        StrengthSearch { trial, as_built, beside: false, by_run: false }
    }

    /// Of one that is looked for only beside the others.
    const fn beside(trial: f64) -> Self {
        StrengthSearch { trial, as_built: 0.0, beside: true, by_run: false }
    }

    /// Of one that each run may have of its own.
    const fn by_run(trial: f64) -> Self {
        StrengthSearch { trial, as_built: 0.0, beside: false, by_run: true }
    }
}

/// Where an effect may sit in a layout.
pub enum Sites {
    Listed(fn(&Simulation) -> Vec<Site>),
    /// Anywhere along the track: looked for where the gap is largest.
    Suspected,
}

/// In what an effect differs by chance (Pinheiro and Bates 2000: random effects by group).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RandomEffect {
    /// From cart to cart: which ones is known for none.
    ByCart,
    /// From lap to lap.
    ByLap,
}

/// How a simulation with an effect begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// From the chain as it has settled without the effect.
    Settled,
    /// From a start of its own, of which something is left that a settled chain does not have. The parameters named
    /// begin as planned: a fit without the effect bends them to imitate it.
    Unsettled(&'static [&'static str]),
}

/// An experiment that separates effects, in the order in which it is proposed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Experiment {
    Speed,
    Tension,
    Sensors,
    Motors,
    /// More runs at other operating points.
    Runs,
}

impl Experiment {
    /// What to do, and why that separates.
    pub fn words(self) -> &'static str {
        match self {
            Experiment::Speed => "a run at 0.7 of the speed, as these effects go with it differently",
            Experiment::Tension => "a run at twice the tension, which closes play and presses joints",
            Experiment::Sensors => "a run with the sensor cart turned around or the channel's sensor exchanged",
            Experiment::Motors => "a run with one motor after the other switched off, and wheel speeds measured",
            Experiment::Runs => "runs at another speed and another tension, of two laps each",
        }
    }
}

/// What an effect changes.
pub enum Act {
    /// The chain.
    Chain(fn(&Strengths, &mut Simulation, &mut Deviations)),
    /// What the sensor cart's channels say.
    Sensor(fn(&Strengths, &mut Sensed)),
}

/// Strengths and places of an effect by name; what is not given has its default.
pub struct Strengths<'a> {
    pub given: &'a BTreeMap<String, f64>,
    effect: &'a Effect,
}

impl Strengths<'_> {
    pub fn of(&self, name: &str) -> f64 {
        let default = || self.effect.definition.places.iter().find(|p| p.name == name).map_or(0.0, |p| p.default);
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
    /// `steer_left`, `steer_right`, `run_left`, `run_right`, `joint_xi`, `joint_eta`, `joint_zeta`, N; an empty one was
    /// not measured.
    pub forces: &'a mut [Vec<f64>; FORCES],
    /// The largest of each channel in the whole run, N.
    pub tops: [f64; FORCES],
}

/// The effect of a name.
pub fn named(name: &str) -> Option<&'static Effect> {
    LIBRARY.into_iter().chain(AS_BUILT).find(|e| e.name() == name)
}

/// Whether an effect moves the chain; otherwise it is one of sensors alone.
pub fn is_of_machine(declared: &DeclaredEffect) -> bool {
    named(&declared.name).is_none_or(|effect| !effect.is_sensor())
}

/// The chain of an input with effects: the input without them, and how the chain deviates from it.
///
/// # Errors
///
/// [`Unfit`] for an effect or a strength that there is not.
pub fn deviations_of(simulation: &Simulation) -> Result<(Simulation, Deviations), Unfit> {
    let mut deviations = Deviations::default();
    if simulation.effects.is_empty() {
        return Ok((simulation.clone(), deviations));
    }
    let mut nominal = simulation.clone();
    nominal.effects.clear();
    for (k, given) in simulation.effects.iter().enumerate() {
        let place = |name: &str| format!("effects.{k}.{name}");
        let Some(effect) = named(&given.name) else {
            let names = by_likeness(&given.name, LIBRARY.iter().chain(&AS_BUILT).map(|e| e.name()));
            let why = format!("there is no effect `{}`; the nearest first, there are {}", given.name, names.join(", "));
            return Err(Unfit { place: place("name"), why });
        };
        let definition = effect.definition;
        for (name, value) in &given.strengths {
            let place = place(&format!("strengths.{name}"));
            match definition.strengths.iter().find(|s| s.name == name) {
                Some(s) if (s.low..=s.high).contains(value) => {}
                Some(s) => {
                    return Err(Unfit {
                        place,
                        why: format!("{value} must be between {} and {} {}", s.low, s.high, s.unit),
                    });
                }
                None if definition.places.iter().any(|p| p.name == name) && value.is_finite() => {}
                None => {
                    let names =
                        definition.strengths.iter().map(|s| s.name).chain(definition.places.iter().map(|p| p.name));
                    let names: Vec<&str> = names.collect();
                    return Err(Unfit { place, why: format!("`{}` has {}", definition.name, names.join(", ")) });
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
    /// An effect of the chain that has one place, no alternatives to it, and differs in nothing by chance: what most
    /// begin with.
    const PLAIN: Effect = Effect {
        definition: &effect_definitions::JOINT_CLEARANCE,
        discrepancy: ASSUMED,
        fitted: &[],
        sites: Sites::Listed(sites::everywhere),
        has: |_, _| true,
        several: false,
        alternatives: |_, _| Vec::new(),
        random: None,
        start: |_| Start::Settled,
        separated_by: Experiment::Runs,
        act: Act::Chain(|_, _, _| {}),
    };

    pub fn name(&self) -> &'static str {
        self.definition.name
    }

    /// Its strengths, each with how it is looked for.
    pub fn strengths(&self) -> impl Iterator<Item = (&'static StrengthDefinition, &'static StrengthSearch)> {
        self.definition.strengths.iter().zip(self.fitted)
    }

    /// By what it differs by chance at a site.
    pub fn random_at(&self, site: &Site) -> Option<RandomEffect> {
        self.random.filter(|(_, at)| at(site)).map(|(random, _)| random)
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

/// A number in (−1, 1) for a cart, by chance but always the same. A sequence that is more even than chance would leave
/// out the long waves along the chain, which pull most.
fn spread(i: usize) -> f64 {
    2.0 * uniform(&mut (i as u64 + 1)) - 1.0
}

#[cfg(test)]
mod tests;
