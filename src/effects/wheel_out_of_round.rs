//! A wheel out of round, r(φ) = r₀ + Σ aₙ sin nφ with waves once to four times a turn, or with a flat spot, a chord of
//! depth a (Nielsen and Johansson 2000). Over a chord the wheel turns about its one end, then about its other: with the
//! chord's half angle α, cos α = 1 − a/r₀, its middle is r₀ cos(α − |φ|) from the rail, which for a small α is
//! r₀ − a (1 − |φ|/α)². Wheel 1 is both steering wheels, 2 the left and 3 the right running wheel, 4 the left and 5 the
//! right steering wheel; shape 1 is the flat spot.
//!
//! Signature: the wheel's force at the order of its turning, v/(2πr), and its multiples.

use super::sites::Site;
use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths};
use crate::base::trig;
use crate::chain_input::{Deviations, Every, Simulation, WheelPlace, WornWheel};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::WHEEL_OUT_OF_ROUND,
    discrepancy: super::ASSUMED,
    fitted: &[
        StrengthSearch::alone(3e-5, 5e-6),
        StrengthSearch::alone(2e-5, 0.0),
        StrengthSearch::alone(1e-5, 0.0),
        StrengthSearch::alone(1e-5, 0.0),
    ],
    sites: Sites::Listed(wheels),
    alternatives: |site, _| own(site),
    has: |site, strength| strength == "amplitude" || (site.of("shape") == Some(0.0) && site.of("wheel") != Some(1.0)),
    separated_by: Experiment::Speed,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    const POINTS: usize = 512;
    let (amplitude, flat) = (strengths.of("amplitude"), strengths.of("shape") > 0.5);
    let wheel = WheelPlace::ALL[strengths.index("wheel").min(WheelPlace::ALL.len() - 1)];
    let wheels = if wheel.is_running() { &simulation.running_wheel } else { &simulation.steering_wheel };
    let waves = ["twice", "thrice", "four_times"].map(|name| strengths.of(name));
    let round = wheels.radius_m.max(1e-6);
    // Half the angle of a chord of that depth, and no less than the table tells.
    let reach = trig::acos(1.0 - (amplitude / round).min(1.0)).max(2.5 / POINTS as f64 * trig::TAU);
    let radius = (0..POINTS).map(|k| {
        let angle = trig::TAU * k as f64 / POINTS as f64;
        let inside = (1.0 - (angle - trig::PI).abs() / reach).max(0.0);
        // Less radius lets the cart down.
        let first = if flat { -amplitude * inside * inside } else { amplitude * trig::sin(angle) };
        first + waves.iter().zip(2..).map(|(wave, n)| wave * trig::sin(f64::from(n) * angle)).sum::<f64>()
    });
    let nth = strengths.of("every").round().max(1.0) as usize;
    let carts = Every { nth, from: simulation.sensor.cart.saturating_sub(1) };
    deviations.worn.push(WornWheel { wheel, radius: radius.collect(), carts });
}

fn wheels(_: &Simulation) -> Vec<Site> {
    let all = WheelPlace::ALL
        .map(WheelPlace::name)
        .into_iter()
        .enumerate()
        .flat_map(|(k, name)| [(k, name, 0.0), (k, name, 1.0)]);
    all.map(|(k, name, shape)| Site {
        words: if shape > 0.5 { format!("{name}, flat spot") } else { name.to_owned() },
        fixed: vec![("wheel", k as f64 + 1.0), ("shape", shape)],
    })
    .collect()
}

/// So far apart, carts do not feel each other's wheels.
const APART: f64 = 3.0;

/// A wheel of the cart with the sensors, and of none beside it.
fn own(site: &Site) -> Vec<(Site, Vec<Site>)> {
    if site.of("wheel") == Some(1.0) {
        return Vec::new();
    }
    let words = format!("{}, of the cart with the sensors", site.words);
    let fixed = site.fixed.iter().copied().chain([("every", APART)]).collect();
    vec![(Site { words, fixed }, Vec::new())]
}
