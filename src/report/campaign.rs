//! `runs.html`: a campaign's runs beside each other: levels of every force, and their means along the track.

use super::plot::{Axis, Curve, Pictures, Plot, Rounded, cells, document, how, middles};
use super::rows::{self, RowScale, row};
use crate::base::number::{decimal, fixed, tick_labels, ticks};
use crate::signal::measures::Statistics;
use crate::signal::{Channel, Run, position};
use maud::{Markup, html};
use std::collections::BTreeMap;

/// Numbers of all curves together, so that the page of a large campaign stays small.
const NUMBERS: usize = 120_000;

/// Cells along the track of a curve, at least and at most, and the runs that have curves.
const FEWEST: usize = 100;
const MOST: usize = 600;
const CURVES: usize = 120;

/// Runs whose curves are shown at first.
const SHOWN: usize = 8;

/// A run of the campaign.
pub struct Glance {
    pub name: String,
    /// What it is, in a few words: laps, rate, speed.
    pub about: String,
    /// m/s, as the trigger has it, else as it was set; `None` where neither is known.
    pub speed: Option<f64>,
    /// N, as it was set; `None` where nobody says.
    pub tension: Option<f64>,
    pub channels: BTreeMap<Channel, Statistics>,
    /// Means of forces along the track; empty where places cannot be told.
    pub along: BTreeMap<Channel, Vec<f64>>,
    /// m; 0 where it is not known.
    pub lap: f64,
    pub warnings: Vec<String>,
}

/// Means of a run's forces along its lap (m), for a campaign of so many runs.
pub fn along(run: &Run, lap: f64, runs: usize) -> BTreeMap<Channel, Vec<f64>> {
    let Some(place) = position::position(run, lap) else { return BTreeMap::new() };
    let stations: Vec<f64> = place.s.iter().map(|s| s.rem_euclid(lap)).collect();
    let count = (NUMBERS / (runs.max(1) * Channel::FORCES.len())).clamp(FEWEST, MOST);
    let forces = run.channels.iter().filter(|(channel, _)| channel.is_force());
    forces.map(|(channel, samples)| (*channel, cells(&stations, samples, lap, count).mean)).collect()
}

/// The page of a campaign; `refused` are the names of runs that cannot be read, each with the reason.
pub fn page(title: &str, runs: &[Glance], refused: &[(String, String)]) -> String {
    let mut pictures = Pictures::new(title);
    let body = html! {
        p.kicker.note { "A campaign at a glance · " (title) }
        h1 { (headline(runs, refused)) }
        p.lead { (lead(runs)) }
        (warnings(runs, refused))
        h2 { "Levels" }
        p.note { "A dot is the mean of a run, the thick bar a standard deviation to either side, the thin one from its least to its \
            largest value. Short gaps of lost samples are bridged." }
        @for channel in Channel::FORCES {
            @if runs.iter().any(|run| run.channels.contains_key(&channel)) { (levels(channel, runs)) }
        }
        @if runs.iter().any(|run| !run.along.is_empty()) {
            h2 { "Along the track" }
            p.note { "Means of all laps of a run in each cell."
                @if runs.len() > CURVES { " Of " (runs.len()) " runs, the first " (CURVES) " have curves." }
                @if runs.len() > SHOWN { " The first " (SHOWN) " are shown; the name of another turns it on." } }
            (how())
            @for channel in Channel::FORCES {
                @for plot in curves(channel, runs) {
                    figure {
                        figcaption { b { (channel.name()) } ", N over m: " (channel.label()) }
                        (pictures.add(plot))
                    }
                }
            }
        }
        h2 { "Runs" }
        (table(runs))
    };
    document(&format!("{title}: runs"), &[rows::RULES, RULES].concat(), &body, &pictures.data)
}

const RULES: &str = "
.row-scale i.reach { height: 1px; top: 10px; bottom: auto; background: var(--soft); }
.row-scale i.swing { height: 6px; top: 8px; bottom: auto; background: var(--fill); }
.dot.mean { background: var(--trace); } .rows.levels { --first: 150px; --last: 190px; }
";

fn headline(runs: &[Glance], refused: &[(String, String)]) -> String {
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let odd = runs.iter().filter(|run| !run.warnings.is_empty()).count();
    let mut text = count(runs.len(), "run");
    text += &match odd {
        0 => ", nothing that looks wrong".to_owned(),
        n => format!(", {n} with something to look at"),
    };
    if !refused.is_empty() {
        text += &format!(", {} that cannot be read", refused.len());
    }
    text
}

/// Speeds that differ by less than this share are one.
const SPEED: f64 = 0.005;
/// Swings and peaks that differ by less than this share are not told: two runs of one lap differ by so much.
const TOLD: f64 = 0.05;

/// How runs differ: by their speeds, and by the forces whose means, swings and peaks differ most.
fn lead(runs: &[Glance]) -> String {
    if runs.len() < 2 {
        return String::new();
    }
    let told = [speeds(runs), tensions(runs), means(runs)];
    let swing = |s: &Statistics| s.sd;
    let peak = |s: &Statistics| s.max.abs().max(s.min.abs());
    let more = [most(runs, "standard deviations", &swing), most(runs, "peaks", &peak)];
    told.into_iter().chain(more).flatten().collect::<Vec<_>>().join(" ")
}

/// A force of each run that has it.
fn of(channel: Channel, runs: &[Glance]) -> Vec<(&str, &Statistics)> {
    runs.iter().filter_map(|run| Some((run.name.as_str(), run.channels.get(&channel)?))).collect()
}

/// The runs with the least and the largest of something.
fn ends<'a>(all: impl Iterator<Item = (&'a str, f64)> + Clone) -> Option<[(&'a str, f64); 2]> {
    let low = all.clone().min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some([low, all.max_by(|a, b| a.1.total_cmp(&b.1))?])
}

/// That speeds differ, which explains differing forces.
fn speeds(runs: &[Glance]) -> Option<String> {
    let [low, high] = ends(runs.iter().filter_map(|run| Some((run.name.as_str(), run.speed?))))?;
    (low.1 > 0.0 && high.1 / low.1 - 1.0 >= SPEED).then(|| {
        let ((low, from), (high, to)) = (low, high);
        let [from, to] = [from, to].map(|speed| fixed(speed, 3));
        format!(
            "The runs have different speeds, from {from} m/s in {low} to {to} m/s in {high}; forces differ with that."
        )
    })
}

/// That the chain was set to other tensions, which explains differing forces, too.
fn tensions(runs: &[Glance]) -> Option<String> {
    let [low, high] = ends(runs.iter().filter_map(|run| Some((run.name.as_str(), run.tension?))))?;
    (high.1 - low.1 >= SPEED * high.1 && high.1 > 0.0).then(|| {
        let ((low, from), (high, to)) = (low, high);
        let [from, to] = [from, to].map(|tension| fixed(tension, 0));
        format!("Their chains were set to tensions from {from} N in {low} to {to} N in {high}.")
    })
}

/// The force whose means differ most, seen against its least swing.
fn means(runs: &[Glance]) -> Option<String> {
    let spread = |channel: Channel| {
        let own = of(channel, runs);
        let [low, high] = ends(own.iter().map(|(name, s)| (*name, s.mean)))?;
        let swing = own.iter().map(|run| run.1.sd).fold(f64::INFINITY, f64::min).max(1e-9);
        Some(((high.1 - low.1) / swing, channel, low, high))
    };
    let all = Channel::FORCES.into_iter().filter_map(spread);
    let (share, channel, (low, from), (high, to)) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (share > 0.0).then(|| {
        format!(
            "The means differ most in {}, seen against its swing: from {} N in {low} to {} N in {high}.",
            channel.name(),
            decimal(from, 4),
            decimal(to, 4)
        )
    })
}

/// The force of which a size above zero differs most, as a share of the least.
fn most(runs: &[Glance], what: &str, size: &dyn Fn(&Statistics) -> f64) -> Option<String> {
    let spread = |channel: Channel| {
        let own = of(channel, runs);
        let [low, high] = ends(own.iter().map(|(name, s)| (*name, size(s))))?;
        Some((high.1 / low.1.max(1e-9) - 1.0, channel, low, high))
    };
    let all = Channel::FORCES.into_iter().filter_map(spread);
    let (share, channel, (low, from), (high, to)) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (share >= TOLD).then(|| {
        format!(
            "The {what} differ most in {}: from {} N in {low} to {} N in {high}.",
            channel.name(),
            decimal(from, 4),
            decimal(to, 4)
        )
    })
}

fn warnings(runs: &[Glance], refused: &[(String, String)]) -> Markup {
    let odd: Vec<&Glance> = runs.iter().filter(|run| !run.warnings.is_empty()).collect();
    html! {
        @if !odd.is_empty() || !refused.is_empty() {
            h2 { "To look at" }
            ul {
                @for (name, why) in refused { li { b { (name) } " cannot be read: " (why) } }
                @for run in odd { @for warning in &run.warnings { li { b { (run.name) } ": " (warning) } } }
            }
        }
    }
}

fn levels(channel: Channel, runs: &[Glance]) -> Markup {
    let own = of(channel, runs);
    let low = own.iter().map(|(_, s)| s.min.min(s.mean - s.sd)).fold(f64::INFINITY, f64::min);
    let high = own.iter().map(|(_, s)| s.max.max(s.mean + s.sd)).fold(f64::NEG_INFINITY, f64::max);
    // A force that is the same all the time has some width, too.
    let room = (0.03 * (high - low)).max(1e-3 * high.abs().max(1.0));
    let scale = RowScale { low: low - room, high: high + room };
    let at = ticks(scale.low, scale.high, 7.0);
    let numbers: Vec<(f64, String)> = at.iter().copied().zip(tick_labels(&at)).collect();
    let marks = |s: &Statistics| {
        html! {
            (scale.grid(&at))
            (scale.span("reach", s.min, s.max))
            (scale.span("swing", s.mean - s.sd, s.mean + s.sd))
            (scale.dot("mean", s.mean))
        }
    };
    html! {
        figure {
            figcaption { b { (channel.name()) } ", N: " (channel.label()) }
            div.rows.levels {
                @for (name, s) in &own {
                    (row("", name, &marks(s), &format!("{} ± {}", decimal(s.mean, 4), decimal(s.sd, 3))))
                }
                (scale.ticks(&numbers))
            }
        }
    }
}

/// A plot a length of the lap: runs of other tracks have other places.
fn curves(channel: Channel, runs: &[Glance]) -> Vec<Plot> {
    let mut laps: Vec<f64> = Vec::new();
    let drawn = || runs.iter().take(CURVES).filter_map(|run| Some((run, run.along.get(&channel)?)));
    for (run, _) in drawn() {
        if !laps.iter().any(|lap| same(*lap, run.lap)) {
            laps.push(run.lap);
        }
    }
    let plot = |(k, lap): (usize, &f64)| {
        let own: Vec<(usize, &Glance, &Vec<f64>)> =
            drawn().enumerate().filter(|(_, (run, _))| same(run.lap, *lap)).map(|(n, (run, y))| (n, run, y)).collect();
        let count = own.first().map_or(0, |(.., y)| y.len());
        // Of several tracks, each has places of its own.
        let axis = if laps.len() == 1 { Axis::Track } else { Axis::Own };
        let mut plot =
            Plot::new(format!("along-{}-{k}", channel.name()), axis, "N", Rounded::to(middles(*lap, count), 2));
        plot.x_unit = "m".to_owned();
        plot.height = 210;
        plot.curves = own
            .into_iter()
            .map(|(n, run, y)| Curve::line(run.name.clone(), &format!("c{}", n % 8), y.clone()).hidden(n >= SHOWN))
            .collect();
        plot
    };
    laps.iter().enumerate().map(plot).collect()
}

/// Whether two laps are of one track, m.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-3
}

fn table(runs: &[Glance]) -> Markup {
    html! {
        div.scroll { table {
            thead { tr { th { "run" } th { "what" } @for c in Channel::FORCES { th { (c.name()) ", N" } } } }
            tbody { @for run in runs { tr {
                td { (run.name) } td { (run.about) }
                @for c in Channel::FORCES {
                    td.number { @if let Some(s) = run.channels.get(&c) { (decimal(s.mean, 4)) " ± " (decimal(s.sd, 3)) } }
                }
            } } }
        } }
        p.note { "Mean and standard deviation." }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(name: &str, speed: f64, steer: (f64, f64, f64)) -> Glance {
        let (mean, sd, max) = steer;
        let level = Statistics { count: 10, mean, sd, min: 0.0, max, rms: mean };
        let same = Statistics { count: 10, mean: 500.0, sd: 40.0, min: 400.0, max: 600.0, rms: 500.0 };
        Glance {
            name: name.into(),
            about: String::new(),
            speed: Some(speed),
            tension: None,
            channels: [(Channel::SteerLeft, level), (Channel::JointXi, same)].into(),
            along: BTreeMap::new(),
            lap: 0.0,
            warnings: Vec::new(),
        }
    }

    #[test]
    fn speeds_come_first_and_swings_and_peaks_count() {
        let runs = [run("a", 2.0, (100.0, 20.0, 300.0)), run("b", 1.9, (110.0, 30.0, 450.0))];
        assert_eq!(
            lead(&runs),
            "The runs have different speeds, from 1.900 m/s in b to 2.000 m/s in a; forces differ with that. The means \
             differ most in steer_left, seen against its swing: from 100 N in a to 110 N in b. The standard deviations \
             differ most in steer_left: from 20 N in a to 30 N in b. The peaks differ most in steer_left: from 300 N in \
             a to 450 N in b."
        );
        // What two runs of one lap differ by is not told, nor a speed that is the same.
        let alike = lead(&[run("a", 2.0, (100.0, 20.0, 300.0)), run("b", 2.001, (101.0, 20.5, 310.0))]);
        assert!(alike.starts_with("The means differ most") && !alike.contains("peaks"), "{alike}");
        assert_eq!(lead(&runs[..1]), "");
    }
}
