//! Features of simulations as the sensors of a fitted run would have them.

use super::FittedRun;
use super::force_slope::ForceSlopes;
use super::impacts;
use super::laps::observed;
use crate::chain_input as input;
use crate::chain_input::Deviations;
use crate::dynamics::{CartRecord, Ensemble};
use crate::effects::{Sensed, sense};
use crate::gap::simulator::{Band, Frame};
use crate::identify::accumulator::{FeatureAccumulator, NoiseDraw};
use crate::identify::model::{Coordinates, samples};
use crate::identify::{Model, Parameter};
use crate::signal::FORCES;
use std::collections::BTreeMap;

impl FittedRun {
    /// How many parts its lap has.
    pub fn parts(&self) -> usize {
        impacts::parts(self.model.spec.places.lap, self.settings.impacts.part)
    }

    /// The model with more effects than its layout has.
    pub fn with(&self, effects: Vec<input::DeclaredEffect>) -> Model {
        let mut model = self.model.clone();
        model.simulation.effects.extend(effects);
        model
    }

    /// Features of an ensemble as sensors with the model's effects observe it; of the carts that are not loaded, where
    /// some are.
    pub fn features(
        &self,
        model: &Model,
        ensemble: &Ensemble,
        deviations: &Deviations,
        sensor: bool,
        at: Coordinates,
    ) -> Vec<f64> {
        let observed = observed(&model.simulation, deviations, ensemble.carts.len());
        // Moving the measured samples ahead leaves the model behind.
        let trigger = Parameter::TriggerPosition.index();
        let moved = at[trigger] - self.landing.at[trigger];
        let (mut accumulator, mut force_slopes) = (FeatureAccumulator::new(&self.model.spec), ForceSlopes::new(self));
        let carts = || ensemble.carts.iter().enumerate().filter(|(k, _)| observed[*k]);
        // What was set to zero has the mean of the cart with the sensors, and not of others with other loads.
        let anew = sensor || (self.model.spec.recorder.zeroed.contains(&true) && observed.contains(&false));
        let count = carts().count();
        let sensed = |(i, (_, cart)): (usize, (usize, &CartRecord))| match sensor {
            true => self.sensed(model, cart, ensemble.rate, (i, count)),
            false => cart.clone(),
        };
        let mut own: Vec<CartRecord> = carts().enumerate().filter(|_| anew).map(sensed).collect();
        self.model.record(&mut own);
        for (i, (k, cart)) in carts().enumerate() {
            let noise = NoiseDraw::Mean(self.seed.wrapping_add(k as u64));
            let samples = samples(own.get(i).unwrap_or(cart));
            accumulator.add(&self.model.spec, &samples, 0.0, noise);
            force_slopes.add(&samples, -moved);
        }
        let mut features = accumulator.features(1.0);
        let landing = &self.landing;
        for (k, x) in features.iter_mut().enumerate() {
            *x += landing.numerics.correction[k] + landing.repeatability.bias[k] / landing.passes[k];
        }
        if moved != 0.0 {
            for (k, x) in features.iter_mut().enumerate() {
                *x += landing.sensitivity.slopes[(k, trigger)] * moved;
            }
        }
        features.push(accumulator.mean_speed().unwrap_or(f64::NAN));
        features.extend(force_slopes.features());
        features
    }

    /// Features of the nominal chain, sensed by sensors with effects: a sensor's effect needs no simulation, and few
    /// carts, as what chaos does to them is the same with and without it.
    pub fn sensed_features(&self, model: &Model, nominal: &[f64]) -> Vec<f64> {
        let ensemble = &self.landing.centre.ensemble;
        let every = (ensemble.carts.len() / self.settings.ensembles.sensor_carts).max(1);
        let (mut plain, mut other) =
            (FeatureAccumulator::new(&self.model.spec), FeatureAccumulator::new(&self.model.spec));
        let (mut force_slopes, mut other_slopes) = (ForceSlopes::new(self), ForceSlopes::new(self));
        let carts = || ensemble.carts.iter().enumerate().step_by(every);
        let count = carts().count();
        let sensed =
            |(i, (_, cart)): (usize, (usize, &CartRecord))| self.sensed(model, cart, ensemble.rate, (i, count));
        let mut all: Vec<CartRecord> = carts().enumerate().map(sensed).collect();
        let mut as_they_are: Vec<CartRecord> = carts().map(|(_, cart)| cart.clone()).collect();
        // Both with the means of these carts, so that a channel that nothing was done to stays the same.
        self.model.record(&mut all);
        self.model.record(&mut as_they_are);
        for ((k, _), (mut sensed, mut as_it_is)) in carts().zip(all.into_iter().zip(as_they_are)) {
            let noise = NoiseDraw::Mean(self.seed.wrapping_add(k as u64));
            for force in 0..FORCES {
                // Channels that nothing was done to say nothing.
                if sensed.forces[force] == as_it_is.forces[force] {
                    sensed.forces[force].clear();
                    as_it_is.forces[force].clear();
                }
            }
            plain.add(&self.model.spec, &samples(&as_it_is), 0.0, noise);
            other.add(&self.model.spec, &samples(&sensed), 0.0, noise);
            force_slopes.add(&samples(&as_it_is), 0.0);
            other_slopes.add(&samples(&sensed), 0.0);
        }
        // The chain's speed has no sensor of these.
        let plain = plain.features(1.0).into_iter().chain([0.0]).chain(force_slopes.features());
        let other = other.features(1.0).into_iter().chain([0.0]).chain(other_slopes.features());
        let changed = nominal.iter().zip(plain.zip(other));
        changed.map(|(n, (a, b))| if (b - a).is_finite() { n + b - a } else { *n }).collect()
    }

    /// A cart's record as sensors with effects have it, one of several. Time is that of the measured run at the same
    /// place, of each cart in one of the passes.
    fn sensed(&self, model: &Model, cart: &CartRecord, rate: f64, one: (usize, usize)) -> CartRecord {
        let time: Vec<f64> = cart.station.iter().map(|s| self.pass_times.of_one(f64::from(*s), one)).collect();
        let mut forces: [Vec<f64>; FORCES] =
            std::array::from_fn(|k| cart.forces[k].iter().map(|x| f64::from(*x)).collect());
        sense(&model.simulation, &mut Sensed { time: &time, period: 1.0 / rate, forces: &mut forces, tops: self.tops });
        CartRecord {
            station: cart.station.clone(),
            speed: cart.speed.clone(),
            forces: forces.map(|f| f.into_iter().map(|x| x as f32).collect()),
        }
    }

    /// Features moved back towards the nominal ones by the share of their difference that chaos makes (James and Stein
    /// 1961, positive part), block by block.
    pub fn calmed(&self, frame: &Frame, raw: &[f64], passes: f64) -> Vec<f64> {
        let mut sums: BTreeMap<(&str, Band), (f64, f64)> = BTreeMap::new();
        let mut each = Vec::with_capacity(raw.len());
        for (k, (x, n)) in raw.iter().zip(&frame.nominal).enumerate() {
            let own = self.landing.repeatability.chaos.get(k).copied().unwrap_or(0.0);
            let difference = if (x - n).is_finite() { x - n } else { 0.0 };
            each.push(difference);
            if own > 0.0 {
                let label = &frame.labels[k];
                let sum = sums.entry((&label.channel, label.band)).or_default();
                *sum = (sum.0 + difference * difference / (own * own), sum.1 + 1.3 / passes);
            }
        }
        let keep = |k: usize| {
            let label = &frame.labels[k];
            let (square, noise) = sums.get(&(label.channel.as_str(), label.band)).copied().unwrap_or((1.0, 0.0));
            (1.0 - noise / square.max(1e-300)).max(0.0)
        };
        each.iter().enumerate().map(|(k, d)| frame.nominal[k] + keep(k) * d).collect()
    }
}
