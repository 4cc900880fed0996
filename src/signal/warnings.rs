//! What cannot be told from a run.

use super::{Run, position};
use crate::base::number;

impl Run {
    /// What cannot be told from this run, as sentences. The lap's length, when known, in m.
    pub fn warnings(&self, lap_length: Option<f64>) -> Vec<String> {
        let mut said = Vec::new();
        let place = lap_length.and_then(|lap| position::position(self, lap));
        if let (Some(lap), None) = (lap_length, &place) {
            let travelled = self.duration() * self.sidecar.speed_setpoint;
            said.push(format!(
                "the trigger never rises: places on the track and laps cannot be told{}",
                if travelled < lap { ", and the run seems shorter than a lap" } else { "" }
            ));
        }
        if let (Some(lap), Some(place)) = (lap_length, &place) {
            let travelled = place.laps() * lap;
            // The speed is a mean, so a lap that was recorded to the sample may seem a little short.
            if travelled < 0.995 * lap {
                said.push(format!(
                    "the run covers {} of the lap's {} m: nothing can be told of the rest of the track, nor how laps \
                     differ",
                    number::fixed(travelled, 1),
                    number::fixed(lap, 1)
                ));
            }
        }
        let step = 1.0 / self.rate();
        let jumps = self.time.windows(2).filter(|w| w[1] - w[0] > 1.5 * step).count();
        if jumps > 0 {
            said.push(format!("rows are missing: time jumps {jumps} times by more than one step of {step} s"));
        }
        said
    }
}
