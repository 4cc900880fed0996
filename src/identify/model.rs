//! The chain as a model of accumulators: parameters in, features out.

use super::effort::Counter;
use super::measured::Measured;
use super::parameter::{COUNT, Parameter};
use super::places::Places;
use crate::base::trig;
use crate::chain_input::{ContactLaw, Simulation};
use crate::dynamics::{CartRecord, Ensemble, EnsemblePlan, Method, Settled, Width};
use crate::effects;
use crate::identify::accumulator::{FeatureAccumulator, FeatureSpec, NoiseDraw, Samples};
use crate::signal::FORCES;
use crate::solve::Stop;
use std::sync::Arc;

/// A point of the parameters' space, in coordinates.
pub type Coordinates = [f64; COUNT];

/// Time before an ensemble is recorded, s, from the start and from a chain that has settled with nearly the same
/// parameters: the waves along the chain that a start leaves die away slowly.
const SETTLE: (f64, f64) = (40.0, 12.0);

/// A layout's chain in one law, as it may have measured one run.
#[derive(Clone)]
pub struct Model {
    pub simulation: Simulation,
    pub law: ContactLaw,
    pub nominal: [f64; COUNT],
    pub bounds: [(f64, f64); COUNT],
    pub spec: FeatureSpec,
    pub width: Width,
    /// What was simulated with this model and its clones.
    pub counter: Counter,
    /// When nothing more can be simulated.
    pub stop: Stop,
}

/// How a point is simulated.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plan<'a> {
    /// Carts that pass each place while it is recorded.
    pub passes: f64,
    /// Logarithm of a factor on the floor of approach speeds.
    pub approach_floor: f64,
    /// Largest step, s, when not the usual one.
    pub step: Option<f64>,
    pub from: Option<&'a Settled>,
    /// Time before recording, s, when not the usual one.
    pub settle: Option<f64>,
}

/// What a simulated point gives.
pub struct Answer {
    pub accumulator: FeatureAccumulator,
    pub features: Vec<f64>,
    /// m/s
    pub speed: f64,
}

impl Model {
    /// `simulation` with the nominal values of a run's sidecar.
    pub fn new(simulation: &Simulation, law: ContactLaw, measured: &Measured, width: Width) -> Self {
        let mut simulation = simulation.clone();
        simulation.contact_law = law;
        simulation.sensor.lowpass_hz = measured.lowpass;
        simulation.sensor.rate_hz = measured.rate;
        simulation.chain.speed_m_s = measured.nominal_speed;
        simulation.sensor.photocell_s_m = measured.nominal_trigger;
        let nominal = Parameter::ALL.map(|p| p.get(&simulation));
        let places = Arc::new(Places::new(&simulation));
        let duration = measured.duration(places.lap);
        simulation.effects = effects::stiffness_temperature::at_rest(&simulation.effects, |w| w.mean_share(duration));
        let pitch = places.lap / simulation.chain.carts as f64;
        let passing = measured.speed() / pitch;
        let mut spec = FeatureSpec::new(places, measured.rate, passing, measured.lowpass, width);
        (spec.unseen, spec.recorder) = (measured.unseen(), measured.recorder);
        Model {
            nominal,
            bounds: Parameter::ALL.map(|p| p.bounds(nominal[p.index()])),
            spec,
            simulation,
            law,
            width,
            counter: Counter::default(),
            stop: Stop::NEVER,
        }
    }

    pub fn value(&self, p: Parameter, at: &Coordinates) -> f64 {
        p.value(self.law, at[p.index()], self.bounds[p.index()])
    }

    pub fn coordinate(&self, p: Parameter, value: f64) -> f64 {
        p.coordinate(self.law, value)
    }

    /// Bounds in the coordinate, lower first.
    pub fn range(&self, p: Parameter) -> (f64, f64) {
        let (a, b) = self.bounds[p.index()];
        let (a, b) = (self.coordinate(p, a), self.coordinate(p, b));
        (a.min(b), a.max(b))
    }

    /// The simulation input of a point.
    pub fn input(&self, at: &Coordinates) -> Simulation {
        let mut simulation = self.simulation.clone();
        for p in Parameter::ALL {
            p.set(&mut simulation, self.value(p, at));
        }
        simulation
    }

    /// Simulates a point. `None` where its chain cannot be simulated, or the work is stopped.
    pub fn run_ensemble(&self, at: &Coordinates, plan: &Plan) -> Option<Ensemble> {
        if self.stop.now() {
            return None;
        }
        let mut simulation = self.input(at);
        simulation.joint.approach_floor_m_s *= trig::exp(plan.approach_floor);
        let pitch = self.spec.places.lap / simulation.chain.carts as f64;
        let ensemble = EnsemblePlan {
            settle: plan.settle.unwrap_or(if plan.from.is_some() { SETTLE.1 } else { SETTLE.0 }),
            duration: plan.passes * pitch / simulation.chain.speed_m_s,
            step: plan.step,
            method: Method::Verlet,
            front: 0.0,
            stop: self.stop,
        };
        self.counter.add(ensemble.settle + ensemble.duration);
        let ensemble = effects::run_ensemble(&simulation, &ensemble, plan.from, self.width).ok();
        let mut ensemble = ensemble.filter(|ensemble| ensemble.trouble.is_none() && !self.stop.now())?;
        self.record(&mut ensemble.carts);
        Some(ensemble)
    }

    /// Does to simulated forces what the run's recorder did, as far as it covers the lap.
    pub fn record(&self, carts: &mut [CartRecord]) {
        self.spec.recorder.record(carts, self.spec.weighing(None));
    }

    /// The usual largest step at a point, s.
    pub fn step(&self, at: &Coordinates) -> Option<f64> {
        effects::model(&self.input(at)).ok().map(|model| model.largest_step())
    }

    /// The features of an ensemble, moved along the track by `offset`, m.
    pub fn answer(&self, ensemble: &Ensemble, offset: f64, noise: u64) -> Answer {
        let mut accumulator = FeatureAccumulator::new(&self.spec);
        for (k, cart) in ensemble.carts.iter().enumerate() {
            accumulator.add(&self.spec, &samples(cart), offset, NoiseDraw::Mean(noise.wrapping_add(k as u64)));
        }
        Answer { features: accumulator.features(1.0), speed: accumulator.mean_speed().unwrap_or(f64::NAN), accumulator }
    }

    /// Each cart's own accumulator.
    pub fn each(&self, ensemble: &Ensemble, noise: u64) -> Vec<FeatureAccumulator> {
        let one = |(k, cart): (usize, &CartRecord)| {
            let mut accumulator = FeatureAccumulator::new(&self.spec);
            accumulator.add(&self.spec, &samples(cart), 0.0, NoiseDraw::Lap(noise.wrapping_add(k as u64)));
            accumulator
        };
        ensemble.carts.iter().enumerate().map(one).collect()
    }
}

/// A cart's record as samples.
pub fn samples(cart: &CartRecord) -> Samples<'_> {
    let forces: [&[f32]; FORCES] = std::array::from_fn(|k| cart.forces[k].as_slice());
    Samples { station: &cart.station, speed: &cart.speed, forces, coverage: None }
}
