//! A measured run made ready: gaps bridged, and every sample's place told from the trigger and the wheels.

use super::coverage::{Coverage, Weighing};
use super::hum::{Hum, take_off};
use super::recorder::Recorder;
use super::steady::{running, steady};
use crate::base::trig;
use crate::chain_input::Simulation;
use crate::identify::accumulator::Samples;
use crate::signal::gaps::bridge;
use crate::signal::measures::statistics;
use crate::signal::position::position;
use crate::signal::{Channel, FORCES, Run};
use std::collections::BTreeMap;
use std::sync::Arc;

/// How well the wheels tell the speed, as a share of it: their radii are known to no better.
const WHEELS: f64 = 1e-4;

/// So many deviations of what is left of hum, its amplitude differs from place to place.
const UNSEEN: f64 = 5.0;

/// A run whose samples have places.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Samples a second, Hz.
    pub rate: f64,
    /// Laps covered, whole and in part.
    pub laps: f64,
    /// Corner of the low-pass, Hz.
    pub lowpass: f64,
    /// Mean speed and its deviation, m/s; `None` when neither two edges of the trigger nor a wheel tell it.
    pub speed: Option<(f64, f64)>,
    /// Speed set and trigger's place by the sidecar.
    pub nominal_speed: f64,
    pub nominal_trigger: f64,
    /// Samples left out of every residual, and those bridged.
    pub masked: usize,
    pub filled: usize,
    /// Time that is left out because the chain's speed changed, s.
    pub unsteady: f64,
    /// Hum that was taken off, by channel.
    pub hum: BTreeMap<Channel, Vec<Hum>>,
    /// What was done to the forces.
    pub recorder: Recorder,
    /// Distance past the first edge of the trigger, m.
    past: Vec<f32>,
    speeds: Vec<f32>,
    forces: [Vec<f32>; FORCES],
    coverage: Arc<Coverage>,
}

impl Measured {
    /// The mean speed as it was measured, or else the nominal one, m/s.
    pub fn speed(&self) -> f64 {
        self.speed.map_or(self.nominal_speed, |(mean, _)| mean)
    }

    /// Variances of forces that show nothing, as they may be what is left of hum, N².
    pub fn unseen(&self) -> [f64; FORCES] {
        Channel::FORCES.map(|force| {
            let left = self.hum.get(&force).into_iter().flatten().map(|hum| UNSEEN * hum.left);
            left.map(|left| left * left).sum()
        })
    }

    /// How long the run takes on a track of this length, s.
    pub fn duration(&self, lap: f64) -> f64 {
        self.laps * lap / self.speed()
    }

    /// Places the samples of a run on the layout's track.
    ///
    /// # Errors
    ///
    /// In words, when the run cannot be used: no force was measured, or the trigger never rises.
    pub fn new(run: &Run, simulation: &Simulation, lap: f64) -> Result<Measured, String> {
        if !Channel::FORCES.iter().any(|c| run.channels.contains_key(c)) {
            return Err(format!("it has none of {}", Channel::FORCES.map(Channel::name).join(", ")));
        }
        let Some(place) = position(run, lap) else {
            return Err("the trigger never rises, so no sample has a place on the track".into());
        };
        let (mut masked, mut filled) = (0, 0);
        let mut hum = BTreeMap::new();
        // Frequencies of the passing of carts and of wheels: their multiples are the chain's.
        let pitch = lap / simulation.chain.carts.max(1) as f64;
        let wheels = [&simulation.running_wheel, &simulation.steering_wheel].map(|wheel| trig::TAU * wheel.radius_m);
        let own = [pitch, wheels[0], wheels[1]].map(|length| place.speed / length);
        let mut channel = |channel: Channel| {
            let samples = run.channels.get(&channel)?;
            let mut bridged = bridge(&run.time, samples);
            let lines = take_off(&mut bridged.samples, run.rate(), &own);
            if !lines.is_empty() {
                hum.insert(channel, lines);
            }
            masked += bridged.masked.iter().filter(|m| **m).count();
            filled += bridged.filled;
            bridged.samples.iter().any(|x| !x.is_nan()).then_some(bridged.samples)
        };
        let mut forces = Channel::FORCES.map(|c| channel(c).unwrap_or_default());
        let wheels = [
            (Channel::WheelSpeedRunLeft, Channel::WheelSpeedRunRight, simulation.running_wheel.radius_m),
            (Channel::WheelSpeedSteerLeft, Channel::WheelSpeedSteerRight, simulation.steering_wheel.radius_m),
        ];
        // A pair's mean is that of the front joint, in curves too.
        let mut speeds = wheels.into_iter().find_map(|(left, right, radius)| {
            let (left, right) = (channel(left)?, channel(right)?);
            let speeds: Vec<f64> = left.iter().zip(&right).map(|(a, b)| 0.5 * (a + b) * radius).collect();
            // A sensor that stands still tells no place.
            let set = run.sidecar.speed_setpoint;
            running(&speeds, set).filter(|v| (0.5..2.0).contains(&(v / set))).map(|_| speeds)
        });
        let past = match &speeds {
            Some(speeds) => travelled(run, speeds, &place.edges, lap),
            None => place.s.iter().map(|s| s - run.sidecar.trigger_position).collect(),
        };
        let set = run.sidecar.speed_setpoint;
        let steady = speeds.as_deref().and_then(|v| steady(&run.time, v, set, pitch / set));
        let duration = run.duration();
        let mut unsteady = 0.0;
        if let Some(kept) = &steady {
            let leave_out = |samples: &mut Vec<f64>| {
                samples.iter_mut().zip(kept).filter(|(_, kept)| !**kept).for_each(|(x, _)| *x = f64::NAN);
            };
            forces.iter_mut().for_each(leave_out);
            speeds.iter_mut().for_each(leave_out);
            unsteady = duration * kept.iter().filter(|kept| !**kept).count() as f64 / kept.len() as f64;
        }
        let (laps, time) = laps(run, &place.edges, steady.as_deref());
        let speed = if laps > 0 {
            let speed = laps as f64 * lap / time;
            Some((speed, speed * 1.5 / run.rate() / time))
        } else {
            speeds.as_deref().and_then(mean).map(|v| (v, WHEELS * v))
        };
        let narrow = |x: Vec<f64>| x.into_iter().map(|x| x as f32).collect::<Vec<f32>>();
        let (past, mut forces) = (narrow(past), forces.map(narrow));
        let each = std::array::from_fn(|k| forces[k].as_slice());
        let coverage = Arc::new(Coverage::new(&past, each, lap, run.rate()));
        let recorder = Recorder::new(run);
        recorder.zero(&mut forces, &past, Weighing::Measured(&coverage));
        Ok(Measured {
            rate: run.rate(),
            laps: (duration - unsteady) * speed.map_or(place.speed, |s| s.0) / lap,
            lowpass: run.sidecar.lowpass,
            speed,
            nominal_speed: run.sidecar.speed_setpoint,
            nominal_trigger: run.sidecar.trigger_position,
            masked,
            filled,
            unsteady,
            hum,
            recorder,
            past,
            speeds: speeds.map(narrow).unwrap_or_default(),
            forces,
            coverage,
        })
    }

    /// The samples; an accumulator's offset is the trigger's place.
    pub fn samples(&self) -> Samples<'_> {
        Samples {
            station: &self.past,
            speed: &self.speeds,
            forces: std::array::from_fn(|k| self.forces[k].as_slice()),
            coverage: Some(&self.coverage),
        }
    }

    /// The run without offsets that grow at so many N/s from its beginning.
    pub fn without_drift(&self, rates: &[f64; FORCES]) -> Measured {
        let mut run = self.clone();
        for (force, rate) in run.forces.iter_mut().zip(rates).filter(|(_, rate)| **rate != 0.0) {
            force.iter_mut().enumerate().for_each(|(k, x)| *x -= (rate * k as f64 / self.rate) as f32);
        }
        run.recorder.zero(&mut run.forces, &run.past, Weighing::Measured(&run.coverage));
        run
    }

    /// What of the lap was measured.
    pub fn coverage(&self) -> &Arc<Coverage> {
        &self.coverage
    }

    /// Whether a force was measured.
    pub fn has(&self, force: usize) -> bool {
        !self.forces[force].is_empty()
    }
}

/// How many laps between edges of the trigger are steady, and how long they took, s.
fn laps(run: &Run, edges: &[f64], steady: Option<&[bool]>) -> (usize, f64) {
    let Some(kept) = steady else {
        let time = edges.last().zip(edges.first()).map_or(0.0, |(last, first)| last - first);
        return (edges.len().saturating_sub(1), time);
    };
    let at = |t: f64| run.time.partition_point(|x| *x < t);
    let is_steady = |lap: &&[f64]| kept[at(lap[0])..at(lap[1])].iter().all(|kept| *kept);
    edges.windows(2).filter(is_steady).fold((0, 0.0), |(n, time), lap| (n + 1, time + lap[1] - lap[0]))
}

/// Of what is not lost.
fn mean(samples: &[f64]) -> Option<f64> {
    statistics(samples).map(|s| s.mean)
}

/// Distance past the first edge by the wheels' speed, stretched so that a lap lies between two edges.
fn travelled(run: &Run, speeds: &[f64], edges: &[f64], lap: f64) -> Vec<f64> {
    let mean = mean(speeds).unwrap_or(run.sidecar.speed_setpoint);
    let mut path = Vec::with_capacity(speeds.len());
    let mut s = 0.0;
    for (i, v) in speeds.iter().enumerate() {
        if i > 0 {
            let (a, b) = (speeds[i - 1], *v);
            let v = 0.5 * (if a.is_nan() { mean } else { a } + if b.is_nan() { mean } else { b });
            s += v * (run.time[i] - run.time[i - 1]);
        }
        path.push(s);
    }
    // Distance by the wheels at each edge.
    let at = |t: f64| {
        let i = run.time.partition_point(|x| *x <= t).clamp(1, run.time.len() - 1);
        let share = (t - run.time[i - 1]) / (run.time[i] - run.time[i - 1]);
        path[i - 1] + share * (path[i] - path[i - 1])
    };
    let marks: Vec<f64> = edges.iter().map(|t| at(*t)).collect();
    let (first, last) = (marks[0], marks[marks.len() - 1]);
    let overall = if marks.len() > 1 { (marks.len() - 1) as f64 * lap / (last - first) } else { 1.0 };
    path.iter()
        .map(|&d| {
            let k = marks.partition_point(|m| *m <= d);
            match (k, marks.get(k)) {
                (0, _) => (d - first) * overall,
                (k, Some(next)) => (k - 1) as f64 * lap + lap * (d - marks[k - 1]) / (next - marks[k - 1]),
                (_, None) => (marks.len() - 1) as f64 * lap + (d - last) * overall,
            }
        })
        .collect()
}
