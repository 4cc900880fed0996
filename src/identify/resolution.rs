//! The resolution of a sensor: where it is coarser than its noise, a value stays for long and jumps by a step, so that
//! means along the track are off by up to half a step however often a place is passed (Widrow and Kollár 2008). Where noise
//! or motion changes the value with every other sample, rounding is white noise, and nothing is to be done.

/// Steps below this do nothing, N.
const LEAST: f64 = 1e-3;
/// Values that differ from the one before, as a share: more are white noise.
const MOST_CHANGES: f64 = 0.35;
/// Values that there may be.
const MOST_VALUES: usize = 1 << 16;
/// How far a value may lie from a step, in steps.
const OFF: f64 = 0.02;

/// The values that a sensor gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// N
    pub step: f64,
    /// One of them, N.
    from: f64,
}

impl Resolution {
    /// Of recorded samples; `None` where no steps show.
    pub fn of(samples: &[f64]) -> Option<Resolution> {
        let pairs = samples.windows(2).filter(|pair| pair.iter().all(|x| x.is_finite()));
        let (all, changes) = pairs.fold((0, 0), |(n, k), pair| (n + 1, k + usize::from(pair[0] != pair[1])));
        if changes as f64 > MOST_CHANGES * f64::from(all) {
            return None;
        }
        let mut values: Vec<f64> = samples.iter().copied().filter(|x| x.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let (first, last) = (*values.first()?, *values.last()?);
        if values.len() < 3 || values.len() > MOST_VALUES {
            return None;
        }
        let smallest = values.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let step = (last - first) / ((last - first) / smallest).round();
        let off = |x: &f64| {
            let steps = (x - first) / step;
            (steps - steps.round()).abs()
        };
        (step > LEAST && values.iter().all(|x| off(x) < OFF)).then_some(Resolution { step, from: first })
    }

    /// Rounds samples to it.
    pub fn round(&self, samples: &mut [f32]) {
        for x in samples {
            let steps = ((f64::from(*x) - self.from) / self.step).round();
            *x = (self.from + steps * self.step) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::normal;
    use crate::base::trig;

    fn signal(noise: f64) -> Vec<f64> {
        let mut state = 7;
        let one = |k: i32| 200.0 + 3.0 * trig::sin(0.02 * f64::from(k)) + noise * normal(&mut state);
        (0..5000).map(one).collect()
    }

    fn rounded(samples: &[f64], step: f64, from: f64) -> Vec<f64> {
        samples.iter().map(|x| from + ((x - from) / step).round() * step).collect()
    }

    #[test]
    fn coarse_steps_are_found_and_simulated_forces_are_rounded_alike() {
        let found = Resolution::of(&rounded(&signal(0.0), 1.7, 0.4)).expect("steps of 1.7 N");
        assert!((found.step - 1.7).abs() < 1e-9);
        let mut simulated: Vec<f32> = signal(0.0).iter().map(|x| *x as f32).collect();
        found.round(&mut simulated);
        let same = |(a, b): (&f32, &f64)| (f64::from(*a) - b).abs() < 1e-3;
        assert!(simulated.iter().zip(&rounded(&signal(0.0), 1.7, 0.4)).all(same));
    }

    #[test]
    fn fine_steps_noise_and_a_constant_have_none() {
        assert_eq!(Resolution::of(&signal(0.0)), None, "no steps");
        assert_eq!(Resolution::of(&rounded(&signal(1.5), 1.7, 0.0)), None, "noise as large as a step");
        assert_eq!(Resolution::of(&rounded(&signal(0.0), 1e-6, 0.0)), None, "digits");
        assert_eq!(Resolution::of(&[3.0; 500]), None);
        assert_eq!(Resolution::of(&[]), None);
        // A wheel that rests for most of the time.
        let resting: Vec<f64> = signal(0.0).iter().map(|x| (x - 202.0).max(0.0)).collect();
        assert_eq!(Resolution::of(&resting), None);
    }
}
