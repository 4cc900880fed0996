//! Equal steps that meet samples and control.

/// Equal steps that meet the sensor's samples and, where periods allow, the controller's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// s
    pub step: f64,
    pub ticks_a_second: f64,
    /// Steps from one sample to the next.
    pub a_sample: u64,
    /// T_c in steps; need not be whole.
    a_control: f64,
    /// Steps from one progress report to the next.
    pub a_look: u64,
}

impl Clock {
    pub fn new(largest: f64, rate: f64, period: f64) -> Self {
        let least = (1.0 / (rate * largest) - 1e-9).ceil().max(1.0) as u64;
        let whole = |n: &u64| {
            let steps = period * rate * *n as f64;
            (steps - steps.round()).abs() < 1e-6 && steps > 0.5
        };
        let a_sample = (least..least + 64).find(whole).unwrap_or(least);
        let ticks_a_second = rate * a_sample as f64;
        Clock {
            step: 1.0 / ticks_a_second,
            ticks_a_second,
            a_sample,
            a_control: period * ticks_a_second,
            a_look: (ticks_a_second / 20.0).ceil().max(1.0) as u64,
        }
    }

    pub fn samples(&self, tick: u64) -> bool {
        tick.is_multiple_of(self.a_sample)
    }

    /// Whether the controller's next period begins at this step, or has begun since the last.
    pub fn controls(&self, tick: u64) -> bool {
        let now = (tick as f64 / self.a_control + 1e-9).floor();
        let last = ((tick as f64 - 1.0) / self.a_control + 1e-9).floor();
        now > last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_meet_samples_and_control() {
        let clock = Clock::new(0.546e-3, 500.0, 0.01);
        assert_eq!((clock.step, clock.a_sample), (0.5e-3, 4));
        let controls: Vec<u64> = (0..61).filter(|k| clock.controls(*k)).collect();
        assert_eq!(controls, [0, 20, 40, 60]);
        // A period of three and a half samples needs steps of half a sample.
        assert_eq!(Clock::new(2e-3, 500.0, 0.007).a_sample, 2);
        // One that no step divides is sampled at the step after.
        let odd = Clock::new(1e-3, 1000.0, 0.002_345_678_9);
        let controls: Vec<u64> = (0..9).filter(|k| odd.controls(*k)).collect();
        assert_eq!(controls, [0, 3, 5, 8]);
    }
}
