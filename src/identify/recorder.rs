//! What a recorder makes of forces: rounded to its steps, and of channels that were set to zero under load nothing but
//! deviations from their mean. Simulated forces are treated alike before they are compared.

use super::coverage::Weighing;
use super::resolution::Resolution;
use crate::dynamics::CartRecord;
use crate::signal::{Channel, FORCES, Run};

/// What was done to each force of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Recorder {
    /// Set to zero under load, so that it has no mean.
    pub zeroed: [bool; FORCES],
    /// Steps that are so coarse that they show.
    pub resolution: [Option<Resolution>; FORCES],
}

impl Recorder {
    /// Of a run, by its sidecar and its samples.
    pub fn new(run: &Run) -> Recorder {
        let zeroed = |force: &Channel| run.sidecar.zeroed.contains(force);
        // Where steps lie from the zero under load is not known.
        let samples = |force: Channel| run.channels.get(&force).filter(|_| !zeroed(&force));
        let resolution = Channel::FORCES.map(|force| samples(force).and_then(|samples| Resolution::of(samples)));
        Recorder { zeroed: Channel::FORCES.map(|force| zeroed(&force)), resolution }
    }

    /// Steps that show, N.
    pub fn steps(&self) -> [Option<f64>; FORCES] {
        self.resolution.map(|resolution| resolution.map(|resolution| resolution.step))
    }

    /// Takes means off measured forces, every place that was passed counting the same.
    pub fn zero(&self, forces: &mut [Vec<f32>; FORCES], station: &[f32], weighing: Weighing) {
        for force in (0..FORCES).filter(|force| self.zeroed[*force]) {
            let mut sums = Sums::default();
            sums.add(station, &forces[force], force, weighing);
            sums.take_off(&mut forces[force]);
        }
    }

    /// Does to simulated forces what was done to measured ones; means are those over all carts where the run measured.
    pub fn record(&self, carts: &mut [CartRecord], weighing: Weighing) {
        for force in 0..FORCES {
            carts.iter_mut().for_each(|cart| self.round(force, &mut cart.forces[force]));
            if self.zeroed[force] {
                zero_simulated(carts, force, weighing);
            }
        }
    }

    /// Rounds simulated samples of a force, with their noise or without, as far as steps show.
    pub fn round(&self, force: usize, samples: &mut [f32]) {
        if let Some(resolution) = self.resolution[force] {
            resolution.round(samples);
        }
    }
}

fn zero_simulated(carts: &mut [CartRecord], force: usize, weighing: Weighing) {
    let mut sums = Sums::default();
    carts.iter().for_each(|cart| sums.add(&cart.station, &cart.forces[force], force, weighing));
    carts.iter_mut().for_each(|cart| sums.take_off(&mut cart.forces[force]));
}

/// Weights, and forces times their weights.
#[derive(Default)]
struct Sums {
    weight: f64,
    force: f64,
}

impl Sums {
    fn add(&mut self, station: &[f32], values: &[f32], force: usize, weighing: Weighing) {
        for (s, x) in station.iter().zip(values).filter(|(_, x)| !x.is_nan()) {
            let weight = weighing.sample(force, weighing.part(*s)).own;
            self.weight += weight;
            self.force += weight * f64::from(*x);
        }
    }

    fn take_off(&self, values: &mut [f32]) {
        if self.weight > 0.0 {
            let mean = self.force / self.weight;
            values.iter_mut().for_each(|x| *x = (f64::from(*x) - mean) as f32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::coverage::Coverage;

    /// Whatever was on a sensor when it was set to zero, and however often its places were passed, what is left is as
    /// what a simulation leaves of the same places.
    #[test]
    fn what_is_left_is_the_same_however_much_was_covered() {
        let lap = 40.0;
        let force = |s: f32| 300.0 + 50.0 * (s / 40.0 * std::f32::consts::TAU).sin() + 0.5 * s.rem_euclid(40.0);
        // 1.4 laps from 7 m before the trigger on, with a gap.
        let station: Vec<f32> = (0..14_000_i16).map(|i| 0.004 * f32::from(i) - 6.999).collect();
        let lost = |s: f32| (12.0..15.0).contains(&s);
        let measured = |offset: f32| -> Vec<f32> {
            station.iter().map(|s| if lost(*s) { f32::NAN } else { force(*s) + offset }).collect()
        };
        let zeroed = std::array::from_fn(|force| force == 4);
        let only_joint = Recorder { zeroed, resolution: [None; FORCES] };
        let zero = |offset: f32| {
            let mut forces: [Vec<f32>; FORCES] = std::array::from_fn(|_| measured(offset));
            let each = std::array::from_fn(|k| forces[k].as_slice());
            let coverage = Coverage::new(&station, each, lap, 500.0);
            only_joint.zero(&mut forces, &station, Weighing::Measured(&coverage));
            (forces, coverage)
        };
        let ((one, coverage), (other, _)) = (zero(0.0), zero(-287.0));
        assert_eq!(one[0][10], force(station[10]), "what was not set to zero keeps its mean");
        let same = |(a, b): (&f32, &f32)| (a.is_nan() && b.is_nan()) || (a - b).abs() < 1e-3;
        assert!(one[4].iter().zip(&other[4]).all(same));
        // Two carts that go half around each.
        let cart = |from: f32| {
            let station: Vec<f32> = (0..5_000_i16).map(|i| from + 0.004 * f32::from(i)).collect();
            let forces = std::array::from_fn(|_| station.iter().map(|s| force(*s)).collect());
            CartRecord { speed: Vec::new(), forces, station }
        };
        let mut carts = [cart(0.0), cart(20.0)];
        zero_simulated(&mut carts, 4, Weighing::Within(&coverage, 0.0));
        let at = |s: f32| station.iter().position(|x| (x - s).abs() < 0.003).expect("a sample");
        for (cart, s) in [(0, 3.0), (1, 30.0)] {
            let simulated = carts[cart].forces[4][((s - 20.0 * cart as f32) / 0.004) as usize];
            assert!((simulated - one[4][at(s)]).abs() < 0.2, "{s} m: {simulated} {}", one[4][at(s)]);
        }
        assert_eq!(carts[0].forces[3][0], force(0.0));
    }
}
