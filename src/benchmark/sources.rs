//! What is put into cases, written anew: profiles, distributions over carts and sensors' answers are not those of the
//! library, though a strength means the same. What the library has not is at the end of [`unknown`].

use super::curves;
use crate::base::random::{normal, uniform};
use crate::base::trig;
use crate::benchmark::draw::{add, draw, draw_log, lap, pick, shuffle};
use crate::benchmark::source::{Act, Change, Source, chain, sign};
use crate::chain_input::{Every, Guides, HARMONICS, Ripple, Simulation, WheelPlace, WornWheel};
use crate::dynamics::law::tangent;
use crate::signal::{Channel, FORCES, Run};
use std::collections::BTreeMap;

/// Effects of the machine, of the sensors, and of neither that can be drawn.
pub const MACHINE: usize = 16;
pub const SENSORS: usize = 6;
pub const UNKNOWN: usize = 7;

/// An effect of the machine by number.
pub fn machine(which: usize, nominal: &Simulation, state: &mut u64) -> Source {
    let lap = lap(nominal);
    match which {
        0 => chain("joint_clearance", "gap", (2e-5, 1.5e-3), Box::new(|x, _, d| d.clearance += x)),
        1 => {
            let (slow, held) = (draw(state, 0.004, 0.03), uniform(state) < 0.5);
            let act: Act = Box::new(move |x, _, d| {
                (d.sliding, d.smoothing[0], d.held) = (d.sliding + x, slow, held);
            });
            let mut source = chain("wheel_sliding", "friction", (0.01, 0.6), act);
            source.fixed.insert("held".to_owned(), f64::from(u8::from(held)));
            source
        }
        2 => {
            let slow = draw(state, 0.01, 0.04);
            let act: Act = Box::new(move |x, _, d| (d.swivel, d.smoothing[1]) = (d.swivel + x, slow));
            chain("fork_swivel", "moment", (0.3, 60.0), act)
        }
        3 if uniform(state) < 0.5 => flexibility(nominal, lap, state),
        3 => guides(nominal, state),
        4 => wheel(nominal, state),
        5 => step(lap, state),
        6 => ripple(nominal, state),
        7 => {
            let motor = pick(state, nominal.motors.s_m.len());
            let mut source = chain(
                "motor_imbalance",
                "loss",
                (0.05, 1.0),
                Box::new(move |x, _, d| d.thrust.iter_mut().skip(motor).take(1).for_each(|share| *share *= 1.0 - x)),
            );
            source.fixed.insert("motor".to_owned(), motor as f64 + 1.0);
            source.place = nominal.motors.s_m.get(motor).map(|s| (*s, s + nominal.motors.length_m));
            source
        }
        8 => {
            let slow = draw(state, 0.01, 0.04);
            let act: Act = Box::new(move |x, _, d| (d.joint_friction, d.smoothing[1]) = (d.joint_friction + x, slow));
            chain("joint_friction", "moment", (0.2, 60.0), act)
        }
        9 => load(nominal, state),
        10 => {
            let (each, way) = ([(); 4].map(|()| draw(state, 0.9, 1.1)), sign(state));
            let act: Act = Box::new(move |x, sim, _| {
                let change = way * x;
                sim.joint.axial.stiffness_n_per_m_n *= 1.0 + change * each[0];
                sim.joint.radial.stiffness_n_per_m_n *= 1.0 + change * each[1];
                sim.steering_wheel.contact.stiffness_n_per_m_n *= 1.0 + change * each[2];
                sim.running_wheel.contact.stiffness_n_per_m_n *= 1.0 + change * each[3];
            });
            let mut source = chain("stiffness_temperature", "change", (0.05, 0.6), act);
            source.strengths[0].1 = way;
            source
        }
        11 => curves::curve(nominal, lap, state),
        12 => {
            let carts = nominal.chain.carts;
            let mut each: Vec<f64> = (0..carts).map(|i| 2.0 * (i as f64 + 0.5) / carts.max(1) as f64 - 1.0).collect();
            shuffle(&mut each, state);
            let act: Act = Box::new(move |x, _, d| d.pitch.iter_mut().zip(&each).for_each(|(p, e)| *p += x * e));
            chain("pitch_wear", "deviation", (2e-5, 1.5e-3), act)
        }
        // As a force that a run's speed sets, not one that follows each cart's.
        13 => {
            let act: Act = Box::new(move |x, sim, d| {
                let speed = sim.chain.speed_m_s;
                add(&mut d.resistance, lap, |_| x * speed * speed);
            });
            chain("speed_drag", "drag", (0.05, 25.0), act)
        }
        14 => chain("control_delay", "delay", (0.02, 2.0), Box::new(|x, _, d| d.delay += x)),
        _ => {
            // Both springs at the load where a joint carries four fifths of what it does at rest.
            let act: Act = Box::new(|x, sim, _| {
                let load = 0.4 * sim.cart.mass_kg * sim.gravity_m_s2;
                let radial = &mut sim.joint.radial;
                let own = 1.0 / tangent(radial.stiffness_n_per_m_n, radial.exponent, load);
                radial.stiffness_n_per_m_n *= own / (own + x);
            });
            chain("cart_bending", "compliance", (5e-8, 2e-5), act)
        }
    }
}

/// Each span of its own length and softness, sagging as a simple beam does under even load, u − 2u³ + u⁴.
fn flexibility(nominal: &Simulation, lap: f64, state: &mut u64) -> Source {
    let span = nominal.supports_every_m.unwrap_or(3.0);
    let count = (lap / span).round().max(2.0) as usize;
    let mut ends: Vec<f64> = (0..count).map(|k| (k as f64 + 0.04 * normal(state)) * lap / count as f64).collect();
    ends[0] = 0.0;
    ends.push(lap);
    let soft: Vec<[f64; 2]> = (0..count).map(|_| [draw(state, 0.85, 1.15), draw(state, 0.85, 1.15)]).collect();
    let act: Act = Box::new(move |x, sim, d| {
        let sag = x * sim.cart.mass_kg * sim.gravity_m_s2;
        for (side, rail) in d.rails[1..].iter_mut().enumerate() {
            add(rail, lap, |s| {
                let k = ends.partition_point(|end| *end <= s).clamp(1, count) - 1;
                let u = ((s - ends[k]) / (ends[k + 1] - ends[k])).clamp(0.0, 1.0);
                -sag * soft[k][side] * 3.2 * u * (1.0 + u * u * (u - 2.0))
            });
        }
    });
    chain("track_flexibility", "compliance", (3e-8, 5e-6), act)
}

/// Guides that give way between supports which are not where the drawing has them.
fn guides(nominal: &Simulation, state: &mut u64) -> Source {
    let span = draw(state, 0.6, 1.4) * nominal.supports_every_m.unwrap_or(3.0);
    let first = span * uniform(state);
    let act: Act = Box::new(move |x, _, d| d.guides = Guides { compliance: x, span, first });
    chain("track_flexibility", "guides", (5e-8, 1e-5), act)
}

/// Of all carts, or of the one with the sensors only.
fn wheel(nominal: &Simulation, state: &mut u64) -> Source {
    const POINTS: usize = 64;
    let (number, flat) = (pick(state, WheelPlace::ALL.len()), uniform(state) < 0.4);
    let wheel = WheelPlace::ALL[number];
    let (phase, second) = (trig::TAU * uniform(state), draw(state, 0.0, 0.2));
    let own = Every { nth: nominal.chain.carts, from: nominal.sensor.cart.saturating_sub(1) };
    let carts = if uniform(state) < 0.5 { own } else { Every::default() };
    let wheels = if wheel.is_running() { &nominal.running_wheel } else { &nominal.steering_wheel };
    let nominal_radius = wheels.radius_m;
    let act: Act = Box::new(move |x, _, d| {
        // Half the angle of the worn spot, whose bottom is rounded.
        let half = (2.0 * x / nominal_radius.max(1e-6)).sqrt().max(0.3);
        let at = |k: usize| {
            let angle = trig::TAU * k as f64 / POINTS as f64;
            let off = trig::wrap(angle - phase);
            if !flat {
                x * (trig::sin(angle + phase) + second * trig::sin(2.0 * angle))
            } else if off.abs() < half {
                -0.5 * x * (1.0 + trig::cos(trig::PI * off / half))
            } else {
                0.0
            }
        };
        d.worn.push(WornWheel { wheel, radius: (0..POINTS).map(at).collect(), carts });
    });
    let mut source = chain("wheel_out_of_round", "amplitude", (1e-5, 1.5e-3), act);
    source.fixed = [("wheel".to_owned(), number as f64 + 1.0), ("shape".to_owned(), f64::from(u8::from(flat)))].into();
    source
}

/// Up within 5 to 100 mm, and back as a cosine.
fn step(lap: f64, state: &mut u64) -> Source {
    let (at, rail, back, way) = (draw(state, 0.0, lap), pick(state, 3), draw(state, 1.5, 2.5), sign(state));
    let rises_over = draw_log(state, 5e-3, 0.1);
    let act: Act = Box::new(move |x, _, d| {
        add(&mut d.rails[rail], lap, |s| {
            let past = (s - at).rem_euclid(lap);
            let rise = (past / rises_over).min(1.0);
            if past < back { way * x * rise * 0.5 * (1.0 + trig::cos(trig::PI * past / back)) } else { 0.0 }
        });
    });
    let mut source = chain("rail_step", "height", (3e-5, 4e-3), act);
    source.strengths[0].1 = way;
    source.fixed = [("at".to_owned(), at), ("rail".to_owned(), rail as f64 + 1.0)].into();
    source.place = Some((at, (at + back).min(lap)));
    source
}

/// One sine, or as often one with two harmonics. Each has a phase of its own, and thrust never turns round.
fn ripple(nominal: &Simulation, state: &mut u64) -> Source {
    let wavelength = draw_log(state, 0.05, 0.5) * nominal.motors.length_m;
    let phases = [(); HARMONICS].map(|()| trig::TAU * uniform(state));
    let harmonics = uniform(state) < 0.5;
    let over = if harmonics { [1.0, draw(state, 0.3, 0.8), draw(state, 0.2, 0.5)] } else { [1.0, 0.0, 0.0] };
    let act: Act =
        Box::new(move |ratio, _, d| d.ripple = Ripple { ratios: over.map(|x| x * ratio), wavelength, phases });
    let mut source = chain("motor_ripple", "ratio", (0.03, 1.0 / over.iter().sum::<f64>()), act);
    if harmonics {
        source.strengths.extend([("twice", over[1]), ("thrice", over[2])]);
    }
    source.fixed.insert("wavelength".to_owned(), wavelength);
    source
}

/// Some carts by chance, with unequal items, the one with the sensors among them or not; or all of them.
fn load(nominal: &Simulation, state: &mut u64) -> Source {
    let (all, share) = (uniform(state) < 0.3, draw(state, 0.2, 0.7));
    let (sensor, empty) = (nominal.sensor.cart, uniform(state) < 0.6);
    let each: Vec<f64> = (0..nominal.chain.carts)
        .map(|i| match all {
            true => draw(state, 0.95, 1.05),
            false if i + 1 == sensor && empty => 0.0,
            false => f64::from(u8::from(uniform(state) < share)) * draw(state, 0.7, 1.3),
        })
        .collect();
    let act: Act = Box::new(move |mass, sim, d| {
        d.load.resize(each.len(), 0.0);
        d.load.iter_mut().zip(&each).for_each(|(x, e)| *x += e * mass / sim.cart.mass_kg.max(1e-9));
    });
    let mut source = chain("load_distribution", "mass", (0.3, 100.0), act);
    if all {
        source.fixed.insert("on_sensor".to_owned(), 1.0);
    }
    source
}

/// An effect of a sensor by number; on what was recorded, before noise.
pub fn sensor(which: usize, state: &mut u64) -> Source {
    let first = pick(state, FORCES);
    let second = (first + 1 + pick(state, FORCES - 1)) % FORCES;
    let way = sign(state);
    let (a, b) = (Channel::FORCES[first], Channel::FORCES[second]);
    let number = |k: usize| k as f64 + 1.0;
    let one: BTreeMap<String, f64> = [("channel".to_owned(), number(first))].into();
    let pair = |x: usize, y: usize| -> BTreeMap<String, f64> {
        [("first".to_owned(), number(x)), ("second".to_owned(), number(y))].into()
    };
    type Act = Box<dyn Fn(f64, &mut Run) + Send + Sync>;
    let of = |effect: &str, strengths: Vec<(&'static str, f64)>, fixed, range, act: Act| Source {
        effect: effect.to_owned(),
        strengths,
        fixed,
        place: None,
        range,
        change: Change::Sensor(act),
    };
    match which {
        0 => {
            let act: Act = Box::new(move |x, run| each(run, a, |_, y| y + way * x * y));
            of("sensor_gain", vec![("gain", way)], one, (0.005, 0.8), act)
        }
        1 => {
            // Towards a new balance, over five times the run.
            let rate = draw(state, -0.02, 0.02);
            let act: Act = Box::new(move |x, run| {
                let long = 5.0 * run.duration().max(1.0);
                each(run, a, |t, y| y + way * x + x * rate * long * (1.0 - trig::exp(-t / long)));
            });
            of("sensor_bias_drift", vec![("offset", way), ("drift", rate)], one, (0.5, 400.0), act)
        }
        2 => {
            let act: Act = Box::new(move |x, run| {
                let other = run.channels.get(&a).cloned().unwrap_or_default();
                let into = run.channels.get_mut(&b).into_iter().flatten();
                into.zip(other).for_each(|(y, h)| *y += way * x * h);
            });
            of("sensor_crosstalk", vec![("ratio", way)], pair(first, second), (0.003, 0.5), act)
        }
        3 => {
            let act: Act = Box::new(move |x, run| lag(run, a, x));
            of("sensor_lag", vec![("delay", 1.0)], one, (0.004, 1.5), act)
        }
        4 => {
            let act: Act =
                Box::new(move |x, run| {
                    let top = run.channels.get(&a).into_iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
                    // An amplifier that runs into its end within a hundredth of its range.
                    let (limit, knee) = (top * (1.0 - x), 0.01 * top.abs().max(1e-9));
                    each(run, a, |_, y| {
                        if y < limit - knee { y } else { limit - knee * trig::exp((limit - knee - y) / knee) }
                    });
                });
            of("sensor_clipping", vec![("loss", 1.0)], one, (0.02, 0.9), act)
        }
        _ => {
            let (x, y) = (first.min(second), first.max(second));
            let act: Act = Box::new(move |_, run| {
                let (one, other) = (run.channels.remove(&a), run.channels.remove(&b));
                run.channels.extend(other.map(|samples| (a, samples)));
                run.channels.extend(one.map(|samples| (b, samples)));
            });
            of("sensor_swapped", vec![("share", 1.0)], pair(x, y), (1.0, 1.0), act)
        }
    }
}

/// A new value of each sample of a channel, from its time and the old one.
fn each(run: &mut Run, channel: Channel, of: impl Fn(f64, f64) -> f64) {
    let Some(samples) = run.channels.get_mut(&channel) else { return };
    samples.iter_mut().zip(&run.time).for_each(|(x, t)| *x = of(*t, *x));
}

/// Four lags of the first order in a row, late by `delay` together.
fn lag(run: &mut Run, channel: Channel, delay: f64) {
    let rate = run.rate();
    let Some(samples) = run.channels.get_mut(&channel) else { return };
    let share = 1.0 - trig::exp(-4.0 / (rate * delay).max(1e-9));
    for _ in 0..4 {
        let mut said = samples.first().copied().unwrap_or(0.0);
        for x in samples.iter_mut() {
            said += share * (*x - said);
            *x = said;
        }
    }
}

/// What no effect of the library is, by number.
pub fn unknown(which: usize, nominal: &Simulation, state: &mut u64) -> Source {
    let lap = lap(nominal);
    let (from, length, way) = (draw(state, 0.0, lap), draw(state, 2.0, 8.0), sign(state));
    let inside = move |s: f64| {
        let u = (s - from).rem_euclid(lap) / length;
        if u < 1.0 { trig::sin(trig::PI * u).sqrt().max(0.0) } else { 0.0 }
    };
    let there = Some((from, (from + length).min(lap)));
    let line = nominal.track.centre_line();
    let heading = move |s: f64| line.at(s).heading();
    match which {
        0 => {
            let act: Act = Box::new(move |x, _, d| add(&mut d.resistance, lap, |s| x * inside(s)));
            Source { place: there, ..chain("friction on one stretch", "force", (1.0, 400.0), act) }
        }
        1 => {
            let act: Act = Box::new(move |x, _, d| add(&mut d.side_force, lap, |s| way * x * inside(s)));
            Source { place: there, ..chain("a side force on one stretch", "force", (1.0, 600.0), act) }
        }
        2 => {
            let frequency = draw_log(state, 0.15, 3.0);
            let most = 0.6 * nominal.motors.force_n;
            let act: Act = Box::new(move |x, _, d| d.hum = [x, frequency]);
            chain("hum in the motors' command", "force", (0.005 * most, most), act)
        }
        3 => {
            // A repeatability that leans: gravity along and across the track, by its heading.
            let towards = trig::TAU * uniform(state);
            let act: Act = Box::new(move |x, sim, d| {
                let weight = sim.cart.mass_kg * sim.gravity_m_s2;
                add(&mut d.resistance, lap, |s| -x * weight * trig::cos(heading(s) - towards));
                add(&mut d.side_force, lap, |s| -x * weight * trig::sin(heading(s) - towards));
            });
            chain("a floor that leans", "slope", (1e-4, 0.05), act)
        }
        4 | 5 => {
            // Supports that sank over a long stretch, under both rails or with a twist.
            let (wide, twist) = (draw(state, 8.0, 20.0).min(0.4 * lap), if which == 5 { -1.0 } else { 1.0 });
            let dip = move |s: f64| {
                let u = (s - from).rem_euclid(lap) / wide;
                if u < 1.0 { 0.5 * (1.0 - trig::cos(trig::TAU * u)) } else { 0.0 }
            };
            let act: Act = Box::new(move |x, _, d| {
                add(&mut d.rails[1], lap, |s| -x * dip(s));
                add(&mut d.rails[2], lap, |s| -x * twist * dip(s));
            });
            let name = if which == 5 { "a twisted track" } else { "sunken supports" };
            Source { place: Some((from, (from + wide).min(lap))), ..chain(name, "depth", (1e-4, 0.03), act) }
        }
        _ => {
            // Guides that wander from side to side, slowly, all along.
            let waves = (lap / draw(state, 6.0, 15.0)).round().max(1.0);
            let phase = trig::TAU * uniform(state);
            let act: Act = Box::new(move |x, _, d| {
                add(&mut d.rails[0], lap, |s| x * trig::sin(trig::TAU * waves * s / lap + phase));
            });
            chain("guides that wander", "amplitude", (1e-4, 0.02), act)
        }
    }
}
