//! The summary of a simulation, for people and for programs.

use super::length::CartLength;
use crate::chain_input::Simulation;
use crate::cli::report::written_to;
use crate::dynamics::{Outcome, parameters};
use crate::report::lap::hotspots;
use crate::signal::Channel;
use crate::signal::measures::statistics;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Serialize)]
struct Summary {
    carts: usize,
    track_m: f64,
    simulated_s: f64,
    wall_s: f64,
    steps: u64,
    step_s: f64,
    evaluations: u64,
    cart_length_m: f64,
    cart_length: CartLength,
    mean_tension_n: f64,
    channels: BTreeMap<&'static str, Moments>,
}

#[derive(Serialize)]
struct Moments {
    mean: f64,
    sd: f64,
    min: f64,
    max: f64,
}

/// One JSON object.
pub fn json(simulation: &Simulation, outcome: &Outcome, wall: f64) -> String {
    let moments = |(channel, samples): (&Channel, &Vec<f64>)| {
        let s = statistics(samples)?;
        Some((channel.name(), Moments { mean: s.mean, sd: s.sd, min: s.min, max: s.max }))
    };
    let summary = Summary {
        carts: outcome.carts,
        track_m: outcome.track,
        simulated_s: outcome.simulated,
        wall_s: wall,
        steps: outcome.steps,
        step_s: outcome.step,
        evaluations: outcome.evaluations,
        cart_length_m: outcome.cart_length,
        cart_length: CartLength::new(simulation, outcome),
        mean_tension_n: outcome.mean_tension,
        channels: outcome.run.channels.iter().filter_map(moments).collect(),
    };
    serde_json::to_string(&summary).unwrap_or_default() + "\n"
}

/// A table.
pub fn text(simulation: &Simulation, outcome: &Outcome, wall: f64, folder: Option<&Path>) -> String {
    let chain = &simulation.chain;
    let mut out = format!(
        "{}\n  {} carts on {:.3} m, {} m/s, T0 {} N: mean tension {:.1} N\n",
        simulation.name, outcome.carts, outcome.track, chain.speed_m_s, chain.tension_n, outcome.mean_tension
    );
    out += &CartLength::new(simulation, outcome).text();
    out += &format!(
        "  {:.2} s simulated in {wall:.2} s, {} steps of {:.4} ms\n\n",
        outcome.simulated,
        outcome.steps,
        outcome.step * 1e3
    );
    out += &format!("  {:<32}{:>8}{:>10}{:>10}{:>10}\n", "channel", "mean", "sd", "min", "max");
    for (channel, samples) in &outcome.run.channels {
        if let Some(s) = statistics(samples) {
            let unit = if channel.unit().is_empty() { String::new() } else { format!(" ({})", channel.unit()) };
            let name = format!("{}{unit}", channel.name());
            out += &format!("  {name:<32}{:>8.1}{:>10.1}{:>10.1}{:>10.1}\n", s.mean, s.sd, s.min, s.max);
        }
    }
    let spots = hotspots(simulation, &outcome.run);
    if !spots.is_empty() {
        out += "\n";
    }
    for spot in spots {
        out += &format!("  {spot}\n");
    }
    out + &written_to(folder)
}

/// Every parameter with its value.
pub fn parameters(simulation: &Simulation) -> String {
    let all = parameters::parameters(simulation);
    let width = all.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    all.iter().map(|(name, value)| format!("{name:<width$} = {value}\n")).collect()
}
