//! A whole simulation: settle, then record laps of the sensor cart.

use super::chain::Chain;
use super::clock::Clock;
use super::integrate::{CashKarp, Integrator, Verlet};
use super::model::Model;
use super::reactions::Reactions;
use super::sensor::SensorCart;
use super::trouble::Trouble;
use super::warming::Cold;
use super::width::Width;
use crate::chain_input::{Deviations, Simulation, Unfit};
use crate::signal::{Channel, Run, Sidecar, SupportLoad};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What to simulate of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Laps of the sensor cart to record.
    pub laps: usize,
    /// Time before recording, s.
    pub settle: f64,
    /// Largest step, s. When not given, what the joints' stiffness leaves accurate and their damping stable.
    pub step: Option<f64>,
    pub method: Method,
    /// Arc length of the first cart's front joint at the start, m.
    pub front: f64,
    /// Whether to keep what the track's supports carry; it takes a fifth more time.
    pub supports: bool,
}

impl Default for Plan {
    fn default() -> Self {
        Plan { laps: 1, settle: 30.0, step: None, method: Method::Verlet, front: 0.0, supports: false }
    }
}

/// Time integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
#[clap(rename_all = "snake_case")]
pub enum Method {
    /// Velocity Verlet with fixed steps.
    #[default]
    Verlet,
    /// Runge-Kutta of orders 5(4) of Cash and Karp, with adaptive steps.
    CashKarp,
}

impl Method {
    /// An integrator with steps of at most `step`, s; steps that are not `fixed` keep to what the joints' damping
    /// leaves stable.
    pub(super) fn integrator(self, step: f64, fixed: bool) -> Box<dyn Integrator> {
        match self {
            Method::Verlet if fixed => Box::new(Verlet::new(step)),
            Method::Verlet => Box::new(Verlet::bounded(step)),
            Method::CashKarp => Box::new(CashKarp::new(TOLERANCE)),
        }
    }
}

/// Local error that Cash-Karp keeps a step below, relative to 1 mm, 1 mrad, 0.1 m/s and 0.1 rad/s.
const TOLERANCE: f64 = 1e-4;

/// Samples of a run, at most: 2.4 GB of channels while it is recorded.
const MOST_SAMPLES: f64 = 2e7;

/// How far a simulation is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Simulated, s.
    pub time: f64,
    /// Laps recorded.
    pub laps: f64,
    /// Share of the whole that is done, 0 to 1.
    pub done: f64,
    /// Steps taken.
    pub steps: u64,
}

/// How a simulation ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    Complete,
    /// Stopped from outside; what was recorded is kept.
    Interrupted,
    /// So is it here.
    Trouble(Trouble),
}

/// What a simulation leaves.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub end: End,
    pub run: Run,
    /// Empty when the layout has no supports, or nobody asked for them.
    pub supports: Vec<SupportLoad>,
    pub carts: usize,
    /// m
    pub track: f64,
    /// s
    pub simulated: f64,
    /// Steps and evaluations of all forces.
    pub steps: u64,
    pub evaluations: u64,
    /// The step, s: of Cash-Karp the time between looks at the controller and the filters.
    pub step: f64,
    /// Free length of the carts, as adapted to the closing pitch and the tension, m.
    pub cart_length: f64,
    /// Mean tension of all joints while recording, N.
    pub mean_tension: f64,
    /// Mean thrust of all motors together while recording, N.
    pub mean_thrust: f64,
}

/// Simulates a chain that deviates from its input as it is told. `watch` is told how far it is some times a simulated
/// second, and returns whether to go on.
///
/// # Errors
///
/// [`Unfit`] for an input that no chain can have. Numerical trouble on the way is not an error: it ends the run with
/// what was recorded.
pub fn simulate(
    simulation: &Simulation,
    deviations: Deviations,
    plan: &Plan,
    width: Width,
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Result<Outcome, Unfit> {
    let model = Arc::new(Model::new(simulation, deviations)?);
    let sensor = &simulation.sensor;
    let samples = plan.laps as f64 * model.segments.line.length / model.speed * sensor.rate_hz;
    if samples > MOST_SAMPLES {
        let why =
            format!("{samples:.1e} samples are more than {MOST_SAMPLES:.0e}: record fewer laps, or at a lower rate");
        return Err(Unfit { place: "sensor.rate_hz".into(), why });
    }
    let clock = Clock::new(plan.step.unwrap_or_else(|| model.largest_step()), sensor.rate_hz, model.controller.period);
    let mut integrator = plan.method.integrator(clock.step, plan.step.is_some());
    let mut chain = Chain::new(model.clone(), plan.front, width)?;
    let filter = |chain: &Chain| {
        SensorCart::new(sensor, chain, clock.step).ok_or_else(|| Unfit {
            place: "sensor.lowpass_hz".into(),
            why: format!("{} Hz must be below half the rate of steps, {:.0} Hz", sensor.lowpass_hz, 0.5 / clock.step),
        })
    };
    let cold = Cold::new(&model);
    let mut measuring = filter(&chain)?;
    let lap = model.segments.line.length;
    let mut recorder = Recorder {
        time: Vec::new(),
        channels: BTreeMap::new(),
        reactions: simulation.supports_every_m.filter(|_| plan.supports).map(|every| Reactions::new(every, lap)),
        tension: 0.0,
        thrust: 0.0,
    };
    let settling = (plan.settle / clock.step).round() as u64;
    let (cart, nominal) = (sensor.cart - 1, plan.laps as f64 * lap / model.speed);
    // Nobody waits for a chain that hardly moves.
    let patience = settling + (4.0 * nominal / clock.step) as u64 + 1;
    let (mut travelled, mut before) = (0.0, chain.forces.station[cart]);
    let mut end = End::Complete;
    let mut tick: u64 = 0;
    loop {
        if clock.controls(tick) {
            if let Some(cold) = cold.as_ref().filter(|_| tick > settling) {
                cold.warm(&mut chain, (tick - settling) as f64 / clock.ticks_a_second);
            }
            chain.sample_control();
        }
        if tick >= settling {
            if tick == settling {
                measuring = filter(&chain)?;
                (travelled, before) = (0.0, chain.forces.station[cart]);
            }
            if clock.samples(tick - settling) {
                let now = chain.forces.station[cart];
                let moved = now - before;
                travelled += moved - lap * (moved / lap).round();
                before = now;
                if travelled >= plan.laps as f64 * lap || tick > patience {
                    break;
                }
                recorder.sample((tick - settling) as f64 / clock.ticks_a_second, &chain, &measuring);
            }
        }
        if tick.is_multiple_of(clock.a_look) {
            let laps = travelled / lap;
            let left = plan.laps as f64 * lap - travelled;
            let time = tick as f64 / clock.ticks_a_second;
            let to_go = (plan.settle - time).max(0.0) + left / model.speed;
            let done = time / (time + to_go).max(1e-9);
            if !watch(Progress { time, laps, done, steps: integrator.steps() }) {
                end = End::Interrupted;
                break;
            }
        }
        if let Err(too_fine) = integrator.advance(&mut chain, clock.step) {
            end = End::Trouble(Trouble::too_fine(&chain, too_fine));
            break;
        }
        tick += 1;
        // Without adding up rounding.
        chain.time = tick as f64 / clock.ticks_a_second;
        if chain.forces.trouble {
            end = End::Trouble(Trouble::of(&chain, clock.step));
            break;
        }
        if tick > settling {
            measuring.step(&chain);
        }
    }
    let samples = recorder.time.len().max(1) as f64;
    Ok(Outcome {
        end,
        supports: recorder.reactions.as_ref().map_or_else(Vec::new, Reactions::envelopes),
        mean_tension: recorder.tension / samples,
        mean_thrust: recorder.thrust / samples,
        run: Run { time: recorder.time, channels: recorder.channels, sidecar: sidecar(simulation, plan) },
        carts: model.carts,
        track: lap,
        simulated: chain.time,
        steps: integrator.steps(),
        evaluations: chain.evaluations,
        step: clock.step,
        cart_length: model.cart.length,
    })
}

/// What is kept while recording.
struct Recorder {
    time: Vec<f64>,
    channels: BTreeMap<Channel, Vec<f64>>,
    reactions: Option<Reactions>,
    tension: f64,
    thrust: f64,
}

impl Recorder {
    fn sample(&mut self, time: f64, chain: &Chain, measuring: &SensorCart) {
        self.time.push(time);
        measuring.sample(chain, &mut self.channels);
        self.tension += chain.forces.mean_tension(chain.model.carts);
        self.thrust += chain.control.command * chain.forces.share.iter().take(chain.model.carts).sum::<f64>();
        if let Some(reactions) = &mut self.reactions {
            reactions.take(chain);
        }
    }
}

/// The nominal values beside a run.
fn sidecar(simulation: &Simulation, plan: &Plan) -> Sidecar {
    Sidecar {
        layout: "simulation.json".into(),
        sensor_cart: simulation.sensor.cart,
        speed_setpoint: simulation.chain.speed_m_s,
        tension_setpoint: Some(simulation.chain.tension_n),
        trigger_position: simulation.sensor.photocell_s_m,
        lowpass: simulation.sensor.lowpass_hz,
        laps: plan.laps,
        zeroed: Vec::new(),
        notes: BTreeMap::new(),
    }
}
