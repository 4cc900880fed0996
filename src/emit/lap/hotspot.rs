//! The places where forces peak, in words.

use super::lap_track::LapTrack;
use crate::emit::number::fixed;
use crate::emit::simulation::Simulation;
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

/// The hardest steering at two places, then the largest and least pull, the hardest run of each wheel, and the joint's
/// largest lateral force. Empty when the run's places cannot be told.
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
        order.sort_by(|a, b| samples[*b].total_cmp(&samples[*a]).then(a.cmp(b)));
        Some((samples, order))
    };
    // The largest first, each apart from those before it.
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
    steering.sort_by(|a, b| b.value.total_cmp(&a.value));
    let mut all = steering;
    for channel in [Channel::JointXi, Channel::RunLeft, Channel::RunRight, Channel::JointEta] {
        all.extend(peaks(channel, 1));
    }
    all
}
