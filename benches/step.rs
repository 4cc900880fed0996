//! What larger steps cost in accuracy: a settled chain with every cart a sensor cart, at several steps, against 0.1 ms.
//!
//! Three kinds of numbers, each along the track: the mean over two neighbouring carts, the spread about it, and the
//! power in bands of frequency. Beside the differences stands what two runs at 0.1 ms differ by that began apart, and
//! what one lap of one cart repeats to.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::chain_input::Simulation;
use lss::dynamics::{Ensemble, EnsemblePlan, Method, Width};
use lss::effects::run_ensemble;
use lss::signal::{Channel, FORCES};
use lss::solve::Stop;
use realfft::RealFftPlanner;
use std::path::Path;
use std::time::Instant;

fn input(name: &str) -> Simulation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/cases/{name}/5-simulation.snap"));
    let text = std::fs::read_to_string(path).expect("a snapshot");
    serde_json::from_str(text.splitn(3, "---\n").nth(2).expect("a body")).expect("a simulation input")
}

/// Edges of the bands, Hz.
const BANDS: [f64; 5] = [0.5, 5.0, 20.0, 50.0, 100.0];

/// Places a metre.
const PLACES: f64 = 4.0;

/// What is compared, of each channel.
struct Numbers {
    /// Along the track: two-cart means, N, and spreads about them, N.
    mean: [Vec<f64>; FORCES],
    spread: [Vec<f64>; FORCES],
    /// What the two-cart mean of one pass of one cart repeats to, N.
    repeats: [f64; FORCES],
    /// N²
    power: [[f64; BANDS.len() - 1]; FORCES],
    /// Simulated s a wall s.
    speed: f64,
}

fn numbers(simulation: &Simulation, step: f64, settle: f64) -> Numbers {
    let plan = EnsemblePlan {
        settle,
        duration: 30.0,
        step: Some(step),
        method: Method::Verlet,
        front: 0.0,
        stop: Stop::NEVER,
    };
    let clock = Instant::now();
    let ensemble = run_ensemble(simulation, &plan, None, Width::widest()).expect("fit");
    let speed = (plan.settle + plan.duration) / clock.elapsed().as_secs_f64();
    assert!(ensemble.trouble.is_none(), "{step}: {:?}", ensemble.trouble);
    let lap = simulation.track.centre_line().length;
    let places = (lap * PLACES).round() as usize;
    let window = (2.0 * simulation.cart.length_m * PLACES).round() as usize;
    let mut numbers = Numbers {
        mean: Default::default(),
        spread: Default::default(),
        repeats: [0.0; FORCES],
        power: [[0.0; BANDS.len() - 1]; FORCES],
        speed,
    };
    for channel in 0..FORCES {
        let mut sums = vec![[0.0; 3]; places];
        let mut passes: Vec<Vec<f64>> = vec![Vec::new(); places];
        for cart in &ensemble.carts {
            let mut pass = vec![[0.0; 2]; places];
            for (station, force) in cart.station.iter().zip(&cart.forces[channel]) {
                let place = (f64::from(*station) / lap * places as f64) as usize % places;
                let force = f64::from(*force);
                for (sum, x) in sums[place].iter_mut().zip([1.0, force, force * force]) {
                    *sum += x;
                }
                pass[place][0] += 1.0;
                pass[place][1] += force;
            }
            for (place, passes) in passes.iter_mut().enumerate() {
                let (count, sum) = (place..place + window).fold((0.0, 0.0), |(c, s), k| {
                    let [count, sum] = pass[k % places];
                    (c + count.min(1.0), s + if count > 0.0 { sum / count } else { 0.0 })
                });
                if count as usize == window {
                    passes.push(sum / count);
                }
            }
        }
        let over = |place: usize, k: usize| (place..place + window).map(|p| sums[p % places][k]).sum::<f64>();
        for place in 0..places {
            let count = over(place, 0);
            let mean = over(place, 1) / count;
            numbers.mean[channel].push(mean);
            numbers.spread[channel].push((over(place, 2) / count - mean * mean).max(0.0).sqrt());
        }
        let scatter = |values: &Vec<f64>| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (values.len() as f64 - 1.0)
        };
        numbers.repeats[channel] = (passes.iter().map(scatter).sum::<f64>() / places as f64).sqrt();
        numbers.power[channel] = powers(&ensemble, channel);
    }
    numbers
}

/// Mean power of all carts in each band, N².
fn powers(ensemble: &Ensemble, channel: usize) -> [f64; BANDS.len() - 1] {
    let samples = ensemble.carts[0].forces[channel].len();
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(samples);
    let mut bands = [0.0; BANDS.len() - 1];
    for cart in &ensemble.carts {
        let mut input: Vec<f64> = cart.forces[channel].iter().map(|x| f64::from(*x)).collect();
        let mut out = fft.make_output_vec();
        fft.process(&mut input, &mut out).expect("sizes fit");
        for (k, value) in out.iter().enumerate() {
            let frequency = k as f64 * ensemble.rate / samples as f64;
            if let Some(band) = BANDS.windows(2).position(|b| (b[0]..b[1]).contains(&frequency)) {
                bands[band] += 2.0 * value.norm_sqr() / (samples * samples) as f64 / ensemble.carts.len() as f64;
            }
        }
    }
    bands
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / a.len() as f64).sqrt()
}

fn main() {
    // `cargo test --benches` and clippy only want to see it start.
    if std::env::args().any(|a| a == "--test") {
        return;
    }
    for name in ["reference", "levels"] {
        let simulation = input(name);
        let exact = numbers(&simulation, 0.1e-3, 40.0);
        println!("{name}, {} carts, 40 s settled, 30 s recorded, against 0.1 ms", simulation.chain.carts);
        println!("  channel      | two-cart mean, N | spread, N | power by band {BANDS:?} Hz, %");
        for (step, settle) in
            [(0.1e-3, 43.0), (0.25e-3, 40.0), (0.5e-3, 40.0), (1e-3, 40.0), (1e-3, 43.0), (2e-3, 40.0), (2e-3, 43.0)]
        {
            let other = numbers(&simulation, step, settle);
            println!("  {:.2} ms, {settle} s settled: {:.0} simulated s a wall s", 1e3 * step, other.speed);
            for channel in 0..FORCES {
                let power: Vec<String> = (0..BANDS.len() - 1)
                    .map(|b| format!("{:+.1}", 100.0 * (other.power[channel][b] / exact.power[channel][b] - 1.0)))
                    .collect();
                println!(
                    "  {:<12} | {:>7.3} of {:>6.3} | {:>6.3} of {:>6.2} | {}",
                    Channel::FORCES[channel].name(),
                    rms(&other.mean[channel], &exact.mean[channel]),
                    exact.repeats[channel],
                    rms(&other.spread[channel], &exact.spread[channel]),
                    exact.spread[channel].iter().sum::<f64>() / exact.spread[channel].len() as f64,
                    power.join(" ")
                );
            }
        }
    }
}
