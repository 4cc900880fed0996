//! Stiffness that comes up in a run. Each cart of a simulated chain is a lap, to whose places times of the run belong: it
//! is simulated as stiff as at the run's begin and as it comes to, and each feature lies between, by the share of the
//! change that is there when its place is passed.

use super::FittedRun;
use crate::base::trig;
use crate::chain_input::Warming;
use crate::gap::simulator::Frame;
use crate::identify::Parameter;

/// Into how many parts a place is divided.
const PARTS: usize = 20;

impl FittedRun {
    /// How long the run is, s.
    pub fn duration(&self) -> f64 {
        self.laps * self.model.spec.places.lap / trig::exp(self.landing.at[Parameter::Speed.index()])
    }

    /// Features between those of a chain without the change and with all of it.
    pub fn warming(&self, frame: &Frame, warming: Warming, cold: &[f64], warm: &[f64]) -> Vec<f64> {
        let lap = self.model.spec.places.lap;
        let whole = (1e3 * lap).round() as i64;
        let all = warming.mean_share(self.duration());
        let share = |k: usize| match frame.labels.get(k) {
            Some(label) if label.to - label.from < whole / 2 => {
                // Parts of it, as the run may begin within it.
                let length = 1e-3 * (label.to - label.from) as f64 / PARTS as f64;
                let part = |n: usize| 1e-3 * label.from as f64 + (n as f64 + 0.5) * length;
                let times: Vec<f64> = (0..PARTS).flat_map(|n| self.pass_times.at(part(n))).collect();
                times.iter().map(|time| warming.share(*time)).sum::<f64>() / times.len() as f64
            }
            _ => all,
        };
        cold.iter().zip(warm).enumerate().map(|(k, (cold, warm))| cold + share(k) * (warm - cold)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_share_is_that_of_all_times() {
        let warming = Warming { change: -0.2, after: 20.0 };
        let mean = (0..1000).map(|k| warming.share(0.05 * (f64::from(k) + 0.5))).sum::<f64>() / 1000.0;
        assert!((warming.mean_share(50.0) - mean).abs() < 1e-6, "{mean}");
        assert_eq!(Warming { after: 0.0, ..warming }.mean_share(50.0), 1.0);
    }
}
