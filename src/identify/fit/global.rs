//! The global stage: what would fool a local one is found roughly first (noise, trigger, tension).

use super::Fitter;
use crate::base::random::{normal, uniform};
use crate::base::trig;
use crate::dynamics::{CartRecord, Ensemble};
use crate::identify::accumulator::{FeatureAccumulator, NoiseDraw};
use crate::identify::excess::{BandPower, Excess};
use crate::identify::feature_spec::{BANDS, Samples};
use crate::identify::grid::{Grid, Lap};
use crate::identify::local::Centre;
use crate::identify::measured::Measured;
use crate::identify::model::{Coordinates, Model, samples};
use crate::identify::noise::Noise;
use crate::identify::parameter::Parameter;
use crate::identify::repeatability::Repeatability;
use crate::identify::scales::{Known, Power, Record, noise};
use crate::identify::unshared::Residuals;
use crate::signal::FORCES;

/// The channel whose mean tells the tension: joint_xi.
const TELLS_TENSION: usize = 4;

/// Logarithm of how much worse the other channels may fit, each, where they hardly tell the tension.
const HARDLY_WORSE: f64 = 0.1;

/// A cell is covered with so much of a passage, at a speed up to a tenth above the nominal one.
const WHOLE: f64 = 0.88;

/// Simulated laps whose power is held beside the measured one, at most.
const LAPS: usize = 16;

/// White noise of a sensor that has less, N and m/s: that of a file's digits.
const LEAST_FORCE: f64 = 1e-3;
const LEAST_SPEED: f64 = 1e-6;

/// Variance of white noise by steps from sample to sample, where nothing else changes as fast.
fn variance_of_steps(samples: &[f32]) -> f64 {
    let steps = samples.windows(2).map(|two| f64::from(two[1] - two[0])).filter(|x| x.is_finite());
    let (count, sum) = steps.fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + 0.5 * x * x));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// How a record tells places: a chain that swings has forces that change by newtons a millimetre, so that two passes
/// differ by that, too, and it is no noise of their sensors.
struct MisplacedBy {
    /// Deviation of the way that the wheels tell from sample to sample, m.
    step: f64,
    /// The way from sample to sample, m: an edge of the trigger lies anywhere between two.
    sample: f64,
}

impl MisplacedBy {
    /// Stations of a cart that goes around once as its record would tell them: right at both ends but for the edges,
    /// and by the wheels between.
    fn of(&self, station: &[f32], seed: u64) -> Vec<f32> {
        let mut state = seed;
        let mut edge = || self.sample * (uniform(&mut state) - 0.5);
        let (first, last) = (edge(), edge());
        let mut walk = Vec::with_capacity(station.len());
        let mut sum = 0.0;
        for _ in station {
            walk.push(sum);
            sum += self.step * normal(&mut state);
        }
        let length = station.len().max(1) as f64;
        let off = |(k, walked): (usize, f64)| {
            let share = k as f64 / length;
            first + (last - first) * share + walked - sum * share
        };
        station.iter().zip(walk.into_iter().enumerate().map(off)).map(|(s, off)| s + off as f32).collect()
    }
}

/// What a run's passes of the same places differ by beyond those of an ensemble at a point.
pub fn excess(model: &Model, measured: &Measured, at: &Coordinates, ensemble: &Ensemble) -> Excess {
    let samples = measured.samples();
    let trigger = at[Parameter::TriggerPosition.index()];
    // The point is the nominal one yet, whose power says nothing of noise.
    let bands = bands(model, &samples, ensemble.rate, &[]);
    let records = (ensemble.rate, ensemble.carts.as_slice());
    Excess::new((samples.station, samples.forces), bands, trigger, lap(model, measured), records)
}

/// What a run's means along the track are off those of an ensemble at a point.
pub fn residuals(model: &Model, measured: &Measured, at: &Coordinates, ensemble: &Ensemble) -> Residuals {
    let samples = measured.samples();
    let trigger = at[Parameter::TriggerPosition.index()];
    let noise = (model.spec.noise(), bands(model, &samples, ensemble.rate, &ensemble.carts));
    let records = (ensemble.rate, ensemble.carts.as_slice());
    Residuals::new((samples.station, samples.forces), noise, trigger, lap(model, measured), records)
}

fn lap(model: &Model, measured: &Measured) -> Lap {
    Lap { length: model.spec.places.lap, speed: measured.speed(), carts: model.simulation.chain.carts }
}

/// The power in each band of each force that was measured, at a rate, Hz, beside that of laps of a fitted model whose sensors
/// are as white, where there are some.
fn bands(model: &Model, measured: &Samples, rate: f64, laps: &[CartRecord]) -> [Vec<BandPower>; FORCES] {
    let spec = &model.spec;
    let power = |samples: &Samples| -> [[f64; BANDS]; FORCES] {
        let mut power = FeatureAccumulator::new(spec);
        power.add(spec, samples, 0.0, NoiseDraw::None);
        std::array::from_fn(|force| power.band_power(force))
    };
    let own = power(measured);
    let laps: Vec<[[f64; BANDS]; FORCES]> = laps.iter().take(LAPS).map(|cart| power(&samples(cart))).collect();
    let duration = measured.station.len() as f64 / rate;
    let of = |force: usize, band: usize| {
        let hz = |line: usize| line as f64 / spec.segment as f64 * rate;
        let (measured, (from, to)) = (own[force][band], (hz(spec.bands[band].0), hz(spec.bands[band].1)));
        let beyond = (!laps.is_empty()).then(|| {
            let each = || laps.iter().map(|lap| lap[force][band]);
            let count = laps.len() as f64;
            let mean = each().sum::<f64>() / count;
            let square = each().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
            let white = spec.noise()[force].white;
            // Of noise, as many waves as fit into the record tell the power of a band.
            let sampled = measured / (duration * (to - from)).max(1.0).sqrt();
            (measured - mean - white * white * 2.0 * (to - from) / rate, trig::hypot(square.sqrt(), sampled))
        });
        BandPower { measured, beyond, band: (from, to) }
    };
    std::array::from_fn(|force| {
        let known = (0..BANDS).filter(|band| own[force][*band].is_finite() && !measured.forces[force].is_empty());
        known.map(|band| of(force, band)).collect()
    })
}

impl Fitter<'_> {
    /// Finds the sensors' noise: white noise as what is measured above the low-pass and not simulated there, and
    /// correlated noise by passes of the same places. Where no place was passed twice, it is found once the parameters
    /// are `near`.
    pub(super) fn find_noise(&self, model: &mut Model, at: &Coordinates, ensemble: &Ensemble, near: bool) {
        if let Some(noise) = self.settings.noise {
            model.spec.set_noise(noise);
            return;
        }
        model.spec.set_noise(Default::default());
        model.spec.set_speed_noise(Noise::default());
        let simulated = model.answer(ensemble, 0.0, 0).accumulator;
        let mut measured = FeatureAccumulator::new(&model.spec);
        measured.add(&model.spec, &self.measured.samples(), 0.0, NoiseDraw::None);
        let ((a, share), (b, _)) = (measured.high_power(&model.spec), simulated.high_power(&model.spec));
        let white: [f64; FORCES] = std::array::from_fn(|k| {
            let variance = if share > 0.0 { (a[k] - b[k]).max(0.0) / share } else { 0.0 };
            variance.sqrt()
        });
        if let Some(known) = self.settings.correlated {
            model.spec.set_noise(std::array::from_fn(|k| Noise { white: white[k], ..known[k] }));
            return;
        }
        let samples = self.measured.samples();
        let trigger = at[Parameter::TriggerPosition.index()];
        let grid = Grid::new(lap(model, self.measured), ensemble.rate);
        let own = ensemble.carts.first().map_or(0.0, |cart| variance_of_steps(&cart.speed));
        let white_speed = (variance_of_steps(samples.speed) - own).max(0.0).sqrt();
        let places =
            MisplacedBy { step: white_speed / ensemble.rate, sample: lap(model, self.measured).speed / ensemble.rate };
        let stations: Vec<Vec<f32>> =
            ensemble.carts.iter().zip(0..).map(|(cart, seed)| places.of(&cart.station, seed)).collect();
        let of = |values: &[f32],
                  simulated: &dyn Fn(&CartRecord, &[f32]) -> Vec<f32>,
                  (white, floor),
                  high: Option<Power>,
                  bands| {
            let record = Record { station: samples.station, values, trigger };
            let carts = ensemble.carts.iter().zip(&stations).map(|(cart, station)| simulated(cart, station));
            let carts: Vec<Vec<f32>> = carts.collect();
            let sizes = values.iter().filter(|x| x.is_finite()).map(|x| f64::from(x.abs()));
            let known = Known { white, floor, largest: sizes.fold(0.0, f64::max), high, bands };
            noise(&grid, &record, &carts, &known, near)
        };
        let line = |line: usize| line as f64 / model.spec.segment as f64;
        let band = (line(model.spec.high.0), line(model.spec.high.1));
        let noise = std::array::from_fn(|k| match samples.forces[k] {
            [] => Noise::default(),
            force => {
                let high = Power { measured: a[k], simulated: b[k], band };
                let both = measured.band_power(k).into_iter().zip(simulated.band_power(k)).zip(model.spec.bands);
                let bands = both
                    .filter(|((a, b), _)| a.is_finite() && b.is_finite())
                    .map(|((a, b), (from, to))| Power { measured: a, simulated: b, band: (line(from), line(to)) });
                let once = |cart: &CartRecord, station: &[f32]| grid.once(station, &cart.forces[k]);
                of(force, &once, (white[k], LEAST_FORCE), (share > 0.0).then_some(high), bands.collect())
            }
        });
        model.spec.set_noise(noise);
        if !samples.speed.is_empty() {
            let once = |cart: &CartRecord, station: &[f32]| grid.once(station, &cart.speed);
            model.spec.set_speed_noise(of(samples.speed, &once, (white_speed, LEAST_SPEED), None, Vec::new()));
        }
    }

    /// The global stage for the trigger: where the means along the track fit best, whatever their level. What a channel
    /// misses is of unknown size, so that one that is far off has no more to say than the others.
    pub(super) fn place(&self, model: &Model, at: &mut Coordinates, centre: &Centre, repeatability: &Repeatability) {
        let k = Parameter::TriggerPosition.index();
        if !self.settings.free[k] {
            return;
        }
        let apart = |trigger: f64| {
            let off = self.off_places(model, trigger, centre, repeatability);
            let scatter = |off: &Vec<f64>| {
                let n = off.len() as f64;
                let mean = off.iter().sum::<f64>() / n;
                let square = off.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
                n * trig::ln(square.max(1.0))
            };
            off.iter().filter(|off| !off.is_empty()).map(scatter).sum::<f64>()
        };
        let (low, high) = model.range(Parameter::TriggerPosition);
        let mut best = (at[k], apart(at[k]));
        for reach in [high - low, 0.4, 0.08] {
            let from = best.0;
            for i in -20..=20 {
                let trigger = (from + 0.5 * reach * f64::from(i) / 20.0).clamp(low, high);
                let cost = apart(trigger);
                if cost < best.1 {
                    best = (trigger, cost);
                }
            }
        }
        at[k] = best.0;
    }

    /// Of each channel how far its means along the track are off, over the deviation of a lap's; of those that are
    /// known.
    fn off_places(
        &self,
        model: &Model,
        trigger: f64,
        centre: &Centre,
        repeatability: &Repeatability,
    ) -> [Vec<f64>; FORCES] {
        let mut accumulator = FeatureAccumulator::new(&model.spec);
        accumulator.add_places(&model.spec, &self.measured.samples(), trigger);
        let places = &model.spec.places;
        // Cells that the run covers: of the others it has other places than the simulation.
        let whole = places.lap / places.cells as f64 / self.measured.nominal_speed * self.measured.rate;
        let features = accumulator.features(WHOLE * whole);
        let off = |i: usize| (features[i] - centre.answer.features[i]) / repeatability.deviation[i];
        let cells = places.cells;
        std::array::from_fn(|k| (k * cells..(k + 1) * cells).map(off).filter(|x| x.is_finite()).collect())
    }

    /// Whether the other channels bear out a tension that joint_xi asks for. One farther off than slopes hold may be
    /// its sensor's fault.
    pub(super) fn agree(
        &self,
        model: &Model,
        before: (&Coordinates, &Centre),
        after: (&Coordinates, &Centre),
        repeatability: &Repeatability,
    ) -> bool {
        let tension = Parameter::Tension;
        if (after.0[tension.index()] - before.0[tension.index()]).abs() < tension.reach() {
            return true;
        }
        let off = |(at, centre): (&Coordinates, &Centre)| {
            let each = self.off_places(model, at[Parameter::TriggerPosition.index()], centre, repeatability);
            each.map(|off| off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64)
        };
        let each = off(before).into_iter().zip(off(after)).enumerate();
        // Of channels that were not measured nothing is known.
        let others = each.filter(|(k, (before, after))| *k != TELLS_TENSION && before.is_finite() && after.is_finite());
        others.map(|(_, (before, after))| trig::ln(after.max(1.0) / before.max(1.0)) - HARDLY_WORSE).sum::<f64>() <= 0.0
    }

    /// The global stage for the tension: a chain that is tighter at rest is tighter by as much when it runs, whatever
    /// it loses there. Whether it moved much.
    pub(super) fn tighten(&self, model: &Model, at: &mut Coordinates, centre: &Centre) -> bool {
        let k = Parameter::Tension.index();
        if model.spec.recorder.zeroed[TELLS_TENSION] {
            return false;
        }
        let mut measured = FeatureAccumulator::new(&model.spec);
        measured.add_places(&model.spec, &self.measured.samples(), 0.0);
        let (Some(found), Some(simulated)) =
            (measured.mean(TELLS_TENSION), centre.answer.accumulator.mean(TELLS_TENSION))
        else {
            return false;
        };
        if !self.settings.free[k] {
            return false;
        }
        let (low, high) = model.range(Parameter::Tension);
        let from = at[k];
        let tension = model.value(Parameter::Tension, at) + found - simulated;
        at[k] = model.coordinate(Parameter::Tension, tension).clamp(low, high);
        (at[k] - from).abs() > 0.02
    }
}
