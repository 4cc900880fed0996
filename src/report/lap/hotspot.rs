//! The places where forces peak, in words.

use crate::base::number::fixed;
use crate::chain_input::Simulation;
use crate::report::lap_track::LapTrack;
use crate::signal::{Channel, Run, position};
use std::fmt;

/// A peak of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Hotspot {
    pub channel: Channel,
    /// In the channel's unit.
    pub value: f64,
    /// Arc length, m.
    pub s: f64,
    /// How far into the part that `place` names, m.
    pub into: f64,
    pub place: String,
}

impl Hotspot {
    /// As a part of a sentence.
    pub fn short(&self) -> String {
        format!("{} N {} m into {}", fixed(self.value, 0), fixed(self.into, 1), self.place)
    }
}

impl fmt::Display for Hotspot {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{} peaks at {} N {} m into {}, s = {} m",
            self.channel.name(),
            fixed(self.value, 0),
            fixed(self.into, 1),
            self.place,
            fixed(self.s, 2)
        )
    }
}

/// Peaks that lie nearer than this are one, m.
const APART: f64 = 5.0;

/// The hardest steering at two places, then the largest axial force of the joint, the hardest run of each wheel, and
/// the joint's largest lateral force. The largest is by absolute value, and keeps its sign. Empty when the run's places
/// cannot be told.
pub fn hotspots(simulation: &Simulation, run: &Run) -> Vec<Hotspot> {
    let track = LapTrack::new(simulation);
    let lap = track.line.length;
    let Some(place) = position::position(run, lap) else { return Vec::new() };
    let spot = |channel: Channel, k: usize, value: f64| {
        let s = place.s.get(k)?.rem_euclid(lap);
        let part = track.part(s)?;
        Some(Hotspot { channel, value, s, into: s - part.from, place: part.name.clone() })
    };
    let sorted = |channel: Channel| {
        let samples = run.channels.get(&channel)?;
        let mut order: Vec<usize> = (0..samples.len()).filter(|k| samples[*k].is_finite()).collect();
        order.sort_by(|a, b| samples[*b].abs().total_cmp(&samples[*a].abs()).then(a.cmp(b)));
        Some((samples, order))
    };
    // The largest by absolute value first, each apart from those before it.
    let peaks = |channel: Channel, count: usize| {
        let mut found: Vec<Hotspot> = Vec::new();
        if let Some((samples, order)) = sorted(channel) {
            for k in order {
                let Some(next) = spot(channel, k, samples[k]) else { continue };
                let apart = |f: &Hotspot| (f.s - next.s).abs().min(lap - (f.s - next.s).abs()) > APART;
                if found.iter().all(apart) {
                    found.push(next);
                }
                if found.len() == count {
                    break;
                }
            }
        }
        found
    };
    let mut steering: Vec<Hotspot> =
        [Channel::SteerLeft, Channel::SteerRight].into_iter().flat_map(|c| peaks(c, 2)).collect();
    steering.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
    let mut all = steering;
    for channel in [Channel::JointXi, Channel::RunLeft, Channel::RunRight, Channel::JointEta] {
        all.extend(peaks(channel, 1));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::model::fixture;

    #[test]
    fn a_peak_is_the_largest_by_absolute_value_and_keeps_its_sign() {
        let simulation = Simulation::new(&compile(fixture::rectangle(20.0, 12.0, 4.0)));
        let time: Vec<f64> = (0..300).map(|i| f64::from(i) / 10.0).collect();
        let trigger = time.iter().map(|t| f64::from(u8::from((1.0..1.5).contains(t)))).collect();
        let mut lateral = vec![0.0; time.len()];
        (lateral[50], lateral[150]) = (18.0, -25.4);
        let channels = [(Channel::Trigger, trigger), (Channel::JointEta, lateral)].into();
        let mut run = Run { time, channels, ..Run::default() };
        run.sidecar.speed_setpoint = 2.0;
        let spots = hotspots(&simulation, &run);
        let of_joint: Vec<f64> = spots.iter().filter(|h| h.channel == Channel::JointEta).map(|h| h.value).collect();
        assert_eq!(of_joint, [-25.4]);
    }
}
