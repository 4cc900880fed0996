//! A run at a glance: what it holds, what it lost, how fast it went, and which channels look wrong.
//!
//! Suspicions, each with a rule that can be argued with:
//!
//! - empty: every sample is lost,
//! - dead: a force or wheel speed takes at most [`DEAD`] different values in a hundred samples or more: the last digits
//!   of a constant. A steering wheel at 0 is none on a layout without a curve to its side,
//! - clipped: a force or wheel speed stays at its largest or smallest value for [`CLIPPED_ROW`] samples or more at a
//!   time, [`CLIPPED`] in all, and more than three times as often as at the value next to it. A wheel without load is
//!   at 0, which is no clipping,
//! - left and right exchanged: the difference left − right goes against what the layout makes of it: slope of the
//!   regression on the expected difference, about the mean, below −0.5, correlation below −0.2,
//! - curves not followed: the same slope of the steering wheels is between −0.2 and 0.2: the layout or
//!   `trigger_position` is not the run's,
//! - another place of the trigger: moved along the track, the same difference follows the curves clearly better,
//! - spikes: a sample or a few equal ones that no signal behind a low-pass jumps to and back from,
//! - joint axes exchanged: `joint_eta` or `joint_zeta` pulls more than `joint_xi` in the mean, and `joint_xi` is below
//!   a quarter of it. A chain is under tension, hardly any force is sideways in the mean, and the carts hang in their
//!   joints,
//! - exchanged, as their means say: `exchanged.rs`,
//! - in another unit, reversed, set to zero under load: `implausible.rs`,
//! - speeds differ: running wheels and trigger disagree by more than [`SLIP`].
//!
//! **What is expected in a curve** of curvature κ (left positive) for cart length L, mass m, μ = m/L, tension T and
//! speed v, from the balance of a cart: its steering wheels push with (T − μv²)Lκ to the outside, which loads the inner
//! one (thesis §2.3; the chain model's long-curve check). About the centre of mass, which is z_c above the joints, with
//! the steering contact h_s below the joints and the running wheels ±b_r aside: run_left − run_right = (h_s (T − μv²)Lκ
//! − z_c m v²κ)/b_r. The inner wheels turn slower, by 2bvκ/r. T is what `joint_xi` measures, else the layout's tension.

mod exchanged;
mod implausible;
mod sides;
mod spikes;
mod suspect;

use super::gaps::Gaps;
use super::measures::{Statistics, statistics, statistics_of};
use super::position::{self, Position};
use super::{Channel, Run};
use crate::base::number::significant;
use crate::chain_input::Simulation;
use std::collections::BTreeMap;

pub use implausible::Implausible;
pub use suspect::{CLIPPED, CLIPPED_ROW, DEAD, SLIP};

/// A run at a glance.
#[derive(Clone, Debug, PartialEq)]
pub struct Health {
    pub samples: usize,
    /// Hz
    pub rate: f64,
    /// s
    pub duration: f64,
    /// Laps, whole and in part, that the run covers, when the trigger and the lap's length tell.
    pub laps: Option<f64>,
    /// Rising edges of the trigger.
    pub edges: usize,
    /// Lost samples of all channels.
    pub lost: usize,
    /// Those of them that were bridged.
    pub bridged: usize,
    /// Those of them that are left out.
    pub masked: usize,
    /// Laps over their time, from the first to the last edge of two or more, m/s.
    pub speed_trigger: Option<f64>,
    /// Mean of the running wheels' speed times their radius, m/s.
    pub speed_wheels: Option<f64>,
    /// What each channel amounts to, short gaps bridged; a channel without a sample is left out.
    pub channels: BTreeMap<Channel, Statistics>,
    /// Samples of each channel that are no measurements.
    pub spikes: BTreeMap<Channel, Vec<usize>>,
    /// Channels that cannot be compared with the layout.
    pub implausible: Vec<Implausible>,
    /// Where the trigger seems to be, m, if not where the sidecar has it.
    pub trigger_position: Option<f64>,
    /// What cannot be told, as sentences.
    pub lacks: Vec<String>,
    /// What looks wrong, likewise.
    pub suspicions: Vec<String>,
}

impl Health {
    /// All sentences.
    pub fn warnings(&self) -> Vec<String> {
        [self.lacks.as_slice(), &self.suspicions].concat()
    }
}

/// Looks at a run; with the simulation input of its layout also at lap, speeds, and sides.
pub fn health(run: &Run, layout: Option<&Simulation>) -> Health {
    let mut health = Health {
        samples: run.time.len(),
        rate: run.rate(),
        duration: run.duration(),
        laps: None,
        edges: position::edges(run).len(),
        lost: 0,
        bridged: 0,
        masked: 0,
        speed_trigger: None,
        speed_wheels: None,
        channels: BTreeMap::new(),
        spikes: BTreeMap::new(),
        implausible: Vec::new(),
        trigger_position: None,
        lacks: run.warnings(layout.map(|l| l.chain.track_length_m)),
        suspicions: Vec::new(),
    };
    // A run may fill most of the memory, so that no channel is copied.
    for (&channel, samples) in &run.channels {
        health.lost += samples.iter().filter(|x| x.is_nan()).count();
        let level = if channel == Channel::Trigger {
            statistics_of(samples.iter().copied())
        } else {
            let gaps = Gaps::new(&run.time, samples);
            health.bridged += gaps.filled();
            statistics_of(gaps.iter())
        };
        match level {
            Some(level) => {
                let idle = level.rms == 0.0 && layout.is_some_and(|layout| !suspect::loaded(channel, layout));
                // What was filled in is no measurement, so that values are looked at as they were recorded.
                let sorted = suspect::sorted(channel, samples).filter(|_| !idle).unwrap_or_default();
                if let Some(why) = suspect::dead(channel, &sorted) {
                    health.suspicions.push(why.clone());
                    health.implausible.push(Implausible { channels: vec![channel], why, zeroed: false });
                } else {
                    health.suspicions.extend(suspect::clipped(channel, &sorted, samples));
                }
                let spikes = spikes::spikes(run, channel, samples, level.sd);
                if let Some(first) = spikes.first() {
                    health.suspicions.push(format!(
                        "{channel} has spikes, samples that jump there and back: {}, the first at {} s to {} {}",
                        spikes.len(),
                        significant(run.time[*first], 6),
                        significant(samples[*first], 4),
                        channel.unit()
                    ));
                    health.spikes.insert(channel, spikes);
                }
                health.channels.insert(channel, level);
            }
            None => health.suspicions.push(format!("{channel} is empty: every sample is lost")),
        }
    }
    health.masked = health.lost - health.bridged;
    let axes = suspect::joint(&health.channels);
    let mut exchanged: Vec<Channel> = Vec::new();
    if let Some(layout) = layout {
        let of_joint = |c: Channel| matches!(c, Channel::JointXi | Channel::JointEta | Channel::JointZeta);
        // Dead or exchanged, which is told already, or set to zero, which the sidecar says.
        let told = |c: Channel| {
            let said = run.sidecar.zeroed.contains(&c);
            said || (axes.is_some() && of_joint(c)) || health.implausible.iter().any(|f| f.channels.contains(&c))
        };
        let untold = health.channels.iter().filter(|(c, _)| !told(**c)).map(|(c, level)| (*c, *level));
        let mut levels: BTreeMap<Channel, Statistics> = untold.collect();
        let expected = implausible::Expected::of(layout);
        if let Some((two, why)) = exchanged::exchanged(&levels, &expected) {
            health.suspicions.push(why);
            levels.retain(|channel, _| !two.contains(channel));
            exchanged.extend(two);
        }
        let found = implausible::implausible(&levels, &expected);
        health.suspicions.extend(found.iter().map(|found| found.why.clone()));
        health.implausible.extend(found);
    }
    // Then joint_xi is no tension that curves could be judged by.
    let no_tension = axes.is_some();
    health.suspicions.extend(axes);
    if let Some(layout) = layout {
        let place = position::position(run, layout.chain.track_length_m);
        health.laps = place.as_ref().map(Position::laps);
        health.speed_trigger = place.as_ref().filter(|p| p.edges.len() > 1).map(|p| p.speed);
        health.speed_wheels = wheels(&health.channels, layout.running_wheel.radius_m);
        health.suspicions.extend(suspect::speeds(health.speed_trigger, health.speed_wheels));
        if let Some(place) = &place {
            health.suspicions.extend(suspect::laps(place));
            let speed = health.speed_trigger.or(health.speed_wheels).unwrap_or(place.speed);
            // What is implausible follows no curves, which is told already.
            let usable = |channel: Channel| {
                let zeroed = run.sidecar.zeroed.contains(&channel);
                let implausible = zeroed || health.implausible.iter().any(|found| found.channels.contains(&channel));
                !(implausible || exchanged.contains(&channel) || no_tension && channel == Channel::JointXi)
            };
            let (sides, trigger) = sides::sides(run, &usable, place, speed, layout);
            health.suspicions.extend(sides);
            health.trigger_position = trigger;
        }
    }
    health
}

/// Mean speed of the running wheels that are there, m/s.
fn wheels(levels: &BTreeMap<Channel, Statistics>, radius: f64) -> Option<f64> {
    let wheels = [Channel::WheelSpeedRunLeft, Channel::WheelSpeedRunRight];
    let speeds: Vec<f64> = wheels.iter().filter_map(|c| levels.get(c)).map(|l| l.mean * radius).collect();
    statistics(&speeds).map(|s| s.mean)
}
