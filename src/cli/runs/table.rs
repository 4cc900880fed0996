//! A campaign as tables for people: a line a run, then what looks wrong.

use super::{Glance, Report};
use crate::base::number::{fixed, trimmed};
use crate::signal::Channel;

/// Two tables with a row a run, and the warnings below.
pub fn text(report: &Report) -> String {
    let Report { runs, refused } = report;
    let widest = runs.iter().map(|r| r.name.chars().count()).max().unwrap_or(0).max("run".len());
    let mut out = String::new();
    if !runs.is_empty() {
        out += &format!(
            "{:widest$} {:>8} {:>7} {:>9} {:>6} {:>6} {:>6} {:>8} {:>7} {:>9} {:>9}\n",
            "run", "samples", "Hz", "s", "laps", "edges", "lost", "bridged", "masked", "trigger", "wheels"
        );
        for run in runs {
            out += &overview(run, widest);
        }
        out += &forces(runs, widest);
    }
    for run in runs.iter().filter(|run| !run.warnings.is_empty()) {
        out += &format!("\n{}\n", run.name);
        for warning in &run.warnings {
            out += &format!("  {warning}\n");
        }
    }
    if !refused.is_empty() {
        let names: Vec<_> = refused.iter().map(|r| r.name.as_str()).collect();
        out += &format!("{}not read: {}\n", if runs.is_empty() { "" } else { "\n" }, names.join(", "));
    }
    out
}

fn overview(run: &Glance, widest: usize) -> String {
    let speed = |v: Option<f64>| v.map_or("-".to_owned(), |v| fixed(v, 3) + " m/s");
    format!(
        "{:widest$} {:>8} {:>7} {:>9} {:>6} {:>6} {:>6} {:>8} {:>7} {:>9} {:>9}\n",
        run.name,
        run.samples,
        trimmed(run.rate_hz, 2),
        fixed(run.duration_s, 1),
        run.laps.map_or("-".to_owned(), |laps| fixed(laps, 2)),
        run.edges,
        run.lost,
        run.bridged,
        run.masked,
        speed(run.speed_trigger),
        speed(run.speed_wheels),
    )
}

/// Mean and standard deviation of the forces.
fn forces(runs: &[Glance], widest: usize) -> String {
    let forces: Vec<&str> = Channel::ALL.into_iter().filter(|c| c.is_force()).map(Channel::name).collect();
    let cell = |text: String| format!(" {text:>14}");
    let mut out = format!("\n{:widest$}{}\n", "mean ± sd, N", "", widest = 1 + widest.max(11));
    out += &format!("{:widest$}{}\n", "run", forces.iter().map(|name| cell((*name).to_owned())).collect::<String>());
    for run in runs {
        let levels = forces.iter().map(|name| {
            cell(
                run.channels.get(name).map_or("-".to_owned(), |l| format!("{} ± {}", fixed(l.mean, 1), fixed(l.sd, 1))),
            )
        });
        out += &format!("{:widest$}{}\n", run.name, levels.collect::<String>());
    }
    out
}
