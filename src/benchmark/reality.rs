//! The system that a case is measured on: nuisances by chance, a scatter that every built chain has, another contact
//! smoothing than the model's, finer steps or another integrator, records that begin and end anywhere, and a measuring
//! chain with noise, hum, drift, a jittering trigger and quantisation.

use crate::base::random::{normal, uniform};
use crate::base::trig;
use crate::benchmark::draw::{add, draw, draw_log, lap, pick, shuffle};
use crate::benchmark::source::Change;
use crate::chain_input::{Deviations, Every, Simulation, WheelPlace, WornWheel};
use crate::dynamics;
use crate::dynamics::{End, Method, Plan, Progress, Width};
use crate::identify::{COUNT, Parameter};
use crate::signal::compare::{Scale, compare};
use crate::signal::{Channel, Run};
use std::collections::BTreeMap;

/// Time before a run, s: what the start leaves has died away.
const SETTLE: f64 = 20.0;

/// Steps a second that an adaptive integrator may need: joints with much damping ask it for steps of microseconds, for
/// which nobody waits.
const MOST_STEPS: f64 = 40_000.0;

/// Laps of which a part is recorded, where records begin and end anywhere.
const LAPS: usize = 2;
/// Frequency of the mains, Hz.
const MAINS: f64 = 50.0;

/// A built system.
#[derive(Clone, Debug)]
pub struct Reality {
    /// As its layout has it, at the settings of each run.
    pub planned: Vec<Simulation>,
    /// As it is.
    pub built: Vec<Simulation>,
    /// What every chain has.
    pub scatter: Deviations,
    /// Where the chain stands when a run begins, m.
    fronts: Vec<f64>,
    /// Which part of `LAPS` laps each run's record covers; whole laps where that is not given.
    windows: Vec<Option<(f64, f64)>>,
    method: Method,
}

impl Reality {
    /// Three runs of a layout at different speeds and tensions.
    pub fn new(nominal: &Simulation, method: Method, state: &mut u64) -> Self {
        let mut speeds = [0.85, 1.0, 1.12];
        let mut tensions = [0.8, 1.0, 1.5];
        shuffle(&mut speeds, state);
        shuffle(&mut tensions, state);
        let planned: Vec<Simulation> = speeds
            .into_iter()
            .zip(tensions)
            .map(|(speed, tension)| {
                let mut run = nominal.clone();
                run.chain.speed_m_s = rounded(run.chain.speed_m_s * speed, 0.01);
                run.chain.tension_n = rounded(run.chain.tension_n * tension, 10.0);
                run
            })
            .collect();
        let shared: [f64; COUNT] = std::array::from_fn(|k| match Parameter::ALL[k] {
            Parameter::Speed => 1.0,
            Parameter::Tension => draw(state, 0.75, 1.4),
            Parameter::RollingResistance => draw(state, 0.7, 1.4),
            Parameter::TriggerPosition => draw(state, -0.4, 0.4),
            Parameter::KP | Parameter::KI => draw(state, 0.6, 1.6),
            _ => draw(state, 0.35, 0.85),
        });
        let smoothing = draw(state, 0.7, 1.4);
        let built = planned.iter().map(|planned| {
            let mut real = planned.clone();
            for (p, x) in Parameter::ALL.into_iter().zip(shared) {
                let nominal = p.get(planned);
                let value = match p {
                    Parameter::Speed => nominal * draw(state, 0.98, 1.02),
                    Parameter::Tension => nominal * x * draw(state, 0.95, 1.05),
                    Parameter::TriggerPosition => nominal + x,
                    _ if p.is_restitution() => (x + 0.02 * normal(state)).clamp(0.1, 0.95),
                    _ => nominal * x,
                };
                p.set(&mut real, value);
            }
            real.joint.approach_floor_m_s *= smoothing;
            real
        });
        let built = built.collect();
        let scatter = scatter(nominal, state);
        let fronts = planned.iter().map(|p| p.chain.pitch_m * uniform(state)).collect();
        let anywhere = uniform(state) < 0.5;
        let window = |state: &mut u64| {
            let long = draw(state, 0.95, 1.8) / LAPS as f64;
            let from = draw(state, 0.0, 1.0 - long);
            anywhere.then_some((from, from + long))
        };
        let windows = planned.iter().map(|_| window(state)).collect();
        Reality { planned, built, scatter, fronts, windows, method }
    }

    /// A lap at the diagnosis' own steps, from one of two fronts; to see what effects do over what chance does.
    pub fn sketch(&self, change: Option<&Changes<'_>>, front: f64) -> Option<Run> {
        let pitch = self.planned.first()?.chain.pitch_m;
        let plan = Plan { front: front * pitch, settle: SETTLE, ..Plan::default() };
        self.run(0, change, plan, None)
    }

    /// What is recorded of a run, without the measuring chain's noise: a quarter of the usual step or less, or by Cash
    /// and Karp.
    pub fn record(&self, run: usize, change: Option<&Changes<'_>>) -> Option<Run> {
        let front = *self.fronts.get(run)?;
        let window = *self.windows.get(run)?;
        let laps = if window.is_some() { LAPS } else { 1 };
        let plan = Plan { laps, method: self.method, front, step: Some(2.5e-4), settle: SETTLE, ..Plan::default() };
        self.run(run, change, plan, window)
    }

    fn run(
        &self,
        number: usize,
        changes: Option<&Changes<'_>>,
        mut plan: Plan,
        window: Option<(f64, f64)>,
    ) -> Option<Run> {
        let mut real = self.built.get(number)?.clone();
        let mut deviations = self.scatter.clone();
        for (change, strength) in changes.into_iter().flatten() {
            if let Change::Chain(act) = change {
                act(*strength, &mut real, &mut deviations);
            }
        }
        for _ in 0..4 {
            let adaptive = plan.method == Method::CashKarp;
            let watch = &mut |p: Progress| !adaptive || p.steps as f64 <= MOST_STEPS * (p.time + 1.0);
            let outcome = dynamics::simulate(&real, deviations.clone(), &plan, Width::used(), watch).ok()?;
            if outcome.end == End::Complete {
                let mut run = outcome.run;
                if let Some((from, to)) = window {
                    keep(&mut run, from, to);
                }
                for (change, strength) in changes.into_iter().flatten() {
                    if let Change::Sensor(act) = change {
                        act(*strength, &mut run);
                    }
                }
                return Some(run);
            }
            // Damping at the joints may ask for shorter steps, and for such that are none of an adaptive integrator's.
            if adaptive {
                plan.method = Method::Verlet;
            } else {
                plan.step = Some(0.5 * plan.step.unwrap_or(outcome.step));
            }
        }
        None
    }
}

/// Keeps what lies between two shares of a run. Its clock runs on.
fn keep(run: &mut Run, from: f64, to: f64) {
    let samples = run.time.len() as f64;
    let range = (samples * from) as usize..((samples * to) as usize).min(run.time.len());
    run.time = run.time[range.clone()].to_vec();
    for channel in run.channels.values_mut() {
        *channel = channel[range.clone()].to_vec();
    }
}

/// Changes with their strengths.
pub type Changes<'a> = Vec<(&'a Change, f64)>;

fn rounded(value: f64, to: f64) -> f64 {
    // By the inverse where that is whole, so that decimals stay short.
    if to < 1.0 { (value / to).round() / (1.0 / to).round() } else { (value / to).round() * to }
}

/// Carts a little unequal in length, rails not quite even, wheels not quite round, motors not quite alike.
fn scatter(nominal: &Simulation, state: &mut u64) -> Deviations {
    let lap = lap(nominal);
    let pitch = (0..nominal.chain.carts).map(|_| 8e-6 * normal(state)).collect();
    let mut scatter = Deviations { pitch, ..Deviations::default() };
    let mean = scatter.pitch.iter().sum::<f64>() / scatter.pitch.len().max(1) as f64;
    scatter.pitch.iter_mut().for_each(|x| *x -= mean);
    for table in &mut scatter.rails {
        // Lengths of 1 m and more, 10 µm together.
        let waves: Vec<(f64, f64, f64)> = (0..12)
            .map(|_| {
                let number = (lap / draw_log(state, 1.0, 30.0)).round().max(1.0);
                (4e-6 * normal(state), trig::TAU * number / lap, trig::TAU * uniform(state))
            })
            .collect();
        add(table, lap, |s| waves.iter().map(|(a, k, phase)| a * trig::sin(k * s + phase)).sum());
    }
    for wheel in [WheelPlace::Steering, WheelPlace::RunningLeft, WheelPlace::RunningRight] {
        let (amplitude, phase) = (3e-6 * normal(state), trig::TAU * uniform(state));
        let radius = (0..64).map(|k| amplitude * trig::sin(trig::TAU * f64::from(k) / 64.0 + phase)).collect();
        scatter.worn.push(WornWheel { wheel, radius, carts: Every::default() });
    }
    scatter.thrust = nominal.motors.s_m.iter().map(|_| 1.0 + 0.01 * normal(state)).collect();
    scatter
}

/// Root mean square distance of the two-cart means of two laps in each force, N.
pub fn distances(a: &Run, b: &Run, nominal: &Simulation) -> BTreeMap<Channel, f64> {
    let pitch = nominal.chain.track_length_m / nominal.chain.carts.max(1) as f64;
    let scale = Scale { lap: Some(lap(nominal)), pitch: Some(pitch), exponent: 3.0 };
    let found = compare(a, b, &scale).into_iter().filter(|(c, _)| c.is_force());
    found.filter_map(|(c, d)| Some((c, d.nrmsd_two_carts? * (d.reference.max - d.reference.min)))).collect()
}

/// What the sensor cart brings home: noise, white and with a memory, hum and a drift on some, a trigger that comes a
/// sample early or late, whole steps of a converter.
pub fn measured(mut run: Run, planned: &Simulation, layout: &str, state: &mut u64) -> Run {
    let (force, speed) = (draw(state, 0.5, 1.5), draw(state, 0.03, 0.08));
    let (force_step, speed_step) = ([0.1, 0.2, 0.5][pick(state, 3)], [0.005, 0.01, 0.02][pick(state, 3)]);
    let jitter = pick(state, 5) as i64 - 2;
    let (slow, time) = (draw(state, 0.0, 0.6), draw_log(state, 0.1, 0.6));
    let period = run.time.get(1).zip(run.time.first()).map_or(0.0, |(b, a)| b - a);
    let memory = trig::exp(-period / time);
    let innovation = (1.0 - memory * memory).sqrt();
    let hum = if uniform(state) < 0.3 { draw(state, 0.2, 1.0) } else { 0.0 };
    let drift = if uniform(state) < 0.3 { draw(state, -0.5, 0.5) } else { 0.0 };
    let duration = run.duration().max(period);
    let begin = run.time.first().copied().unwrap_or(0.0);
    for (channel, samples) in &mut run.channels {
        let (deviation, step) = match channel.unit() {
            "N" => (force, force_step),
            "rad/s" => (speed, speed_step),
            "rad" => (1e-4, 1e-5),
            _ => (0.0, 0.0),
        };
        let slow = match *channel {
            Channel::JointXi => 3.0 * slow,
            _ if channel.unit() == "N" => slow,
            _ => 0.0,
        };
        let mut remembered = normal(state);
        let (hum, drift) = if channel.unit() == "N" { (hum, drift) } else { (0.0, 0.0) };
        let phase = trig::TAU * uniform(state);
        if step > 0.0 {
            for (t, x) in run.time.iter().zip(samples.iter_mut()) {
                let sensor = hum * trig::sin(trig::TAU * MAINS * t + phase) + drift * (t - begin) / duration;
                *x = ((*x + deviation * normal(state) + slow * remembered + sensor) / step).round() * step;
                remembered = memory * remembered + innovation * normal(state);
            }
        }
        if *channel == Channel::Trigger && !samples.is_empty() {
            let now = samples.clone();
            let last = now.len() as i64 - 1;
            for (k, x) in samples.iter_mut().enumerate() {
                *x = now[(k as i64 - jitter).clamp(0, last) as usize];
            }
        }
    }
    run.sidecar.layout = layout.to_owned();
    run.sidecar.speed_setpoint = planned.chain.speed_m_s;
    run.sidecar.tension_setpoint = None;
    run.sidecar.trigger_position = planned.sensor.photocell_s_m;
    // Whatever a simulation noted of itself.
    run.sidecar.notes.clear();
    run
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measuring_chain_rounds_and_keeps_the_trigger_binary() {
        let mut run = Run { time: (0..100).map(|k| f64::from(k) / 500.0).collect(), ..Run::default() };
        run.channels.insert(Channel::SteerLeft, vec![100.0; 100]);
        run.channels.insert(Channel::Trigger, (0..100).map(|k| f64::from(u8::from((40..45).contains(&k)))).collect());
        let planned = crate::benchmark::tracks::all().unwrap().remove(0).simulation;
        for seed in 0..20 {
            let found = measured(run.clone(), &planned, "oval.lss", &mut { seed });
            let trigger = &found.channels[&Channel::Trigger];
            assert_eq!(trigger.iter().sum::<f64>(), 5.0);
            assert!(trigger.iter().position(|x| *x == 1.0).is_some_and(|k| (38..=42).contains(&k)));
            let tenths = found.channels[&Channel::SteerLeft].iter().map(|x| 10.0 * x);
            assert!(tenths.clone().all(|x| (x - x.round()).abs() < 1e-9) && tenths.clone().any(|x| x != 1000.0));
        }
    }

    #[test]
    fn records_begin_and_end_anywhere() {
        let nominal = crate::benchmark::tracks::all().unwrap().remove(0).simulation;
        let realities = (0..40).map(|seed| Reality::new(&nominal, Method::Verlet, &mut { seed }));
        let windows: Vec<(f64, f64)> = realities.filter_map(|r| r.windows[0]).collect();
        assert!((10..=30).contains(&windows.len()));
        for (from, to) in windows {
            let laps = LAPS as f64 * (to - from);
            assert!(from >= 0.0 && to <= 1.0 && (0.95..=1.8).contains(&laps), "{from} {to}");
        }
        let mut run = Run { time: (0..100).map(|k| f64::from(k) / 500.0).collect(), ..Run::default() };
        run.channels.insert(Channel::SteerLeft, run.time.clone());
        keep(&mut run, 0.25, 0.75);
        assert_eq!((run.time[0], run.time.len()), (0.05, 50));
        assert_eq!(run.channels[&Channel::SteerLeft], run.time);
    }

    #[test]
    fn a_shuffle_keeps_everything() {
        let mut items: Vec<usize> = (0..50).collect();
        shuffle(&mut items, &mut 3);
        assert_ne!(items, (0..50).collect::<Vec<_>>());
        items.sort_unstable();
        assert_eq!(items, (0..50).collect::<Vec<_>>());
    }
}
