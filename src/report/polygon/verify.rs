//! `verify.json`: layouts before and after, run in the dynamic model.

use super::Values;
use crate::base::number::{fixed, tidy};
use crate::dynamics::Outcome;
use crate::kinematics::polygon::PolygonObjective;
use crate::signal::measures::statistics;
use crate::signal::spectrum::{Spectrum, welch};
use crate::signal::{Channel, rainflow};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Channels that the thesis looks at (its figures 3.9 and 3.10), with the running wheels' least.
pub const CHANNELS: [Channel; 3] = [Channel::JointXi, Channel::SteerLeft, Channel::SteerRight];
/// Segment of the spectra, s: lines 0.1 Hz apart.
const SEGMENT: f64 = 10.0;
/// Half the width of the band of cart passing, relative to its frequency.
const BAND: f64 = 0.15;
/// Slope of the S-N curve and number of cycles of the damage-equivalent loads, as on the page of a lap.
const SLOPE: f64 = 3.0;
const CYCLES: f64 = 1e6;

/// What optimising a layout for an even run does to the forces of the dynamic model.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(title = "lss polygon verification")]
pub struct Verification {
    /// The layout's name.
    pub layout: String,
    /// Before, then a layout optimised for each objective.
    pub cases: Vec<Case>,
    /// The objective whose layout has the least forces: mean ratio of the standard deviations to those before.
    pub best: String,
    /// In words.
    pub summary: String,
}

/// One layout with its lap.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Case {
    /// `before`, or the objective.
    pub name: String,
    /// m
    pub track_length_m: f64,
    /// Number of carts.
    pub carts: usize,
    /// What they lack to the centre line, m; the simulation adapts the carts' length to it.
    pub left_over_m: f64,
    /// Polygon action, mm².
    pub polygon_action: Values,
    /// Carts that pass a second, Hz.
    pub passing_hz: f64,
    /// Forces of the sensor cart by channel.
    pub channels: BTreeMap<String, Force>,
    /// Mean ratio of the standard deviations to those before.
    pub ratio: f64,
}

/// A force over the lap.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Force {
    /// N
    pub mean: f64,
    /// Standard deviation, N.
    pub sd: f64,
    /// Least, N.
    pub min: f64,
    /// Largest, N.
    pub max: f64,
    /// Root mean square in the band of cart passing, N.
    pub passing_rms: f64,
    /// Damage-equivalent range (rainflow, slope 3, 10⁶ cycles), N.
    pub damage: Option<f64>,
}

/// The spectrum of a channel, N²/Hz.
pub fn spectrum(samples: &[f64], rate: f64) -> Spectrum {
    welch(samples, rate, (SEGMENT * rate) as usize)
}

impl Case {
    /// From a simulated lap.
    pub fn new(name: &str, outcome: &Outcome, left_over: f64, polygon_action: Values, speed: f64) -> Self {
        let passing = speed * outcome.carts as f64 / outcome.track;
        let force = |channel: Channel| {
            let samples = outcome.run.channels.get(&channel)?;
            let s = statistics(samples)?;
            let power = spectrum(samples, outcome.run.rate()).band((1.0 - BAND) * passing, (1.0 + BAND) * passing);
            let damage = rainflow::damage_equivalent(&rainflow::rainflow(samples), SLOPE, CYCLES);
            let force = Force { mean: s.mean, sd: s.sd, min: s.min, max: s.max, passing_rms: power.sqrt(), damage };
            Some((channel.name().to_owned(), force))
        };
        Case {
            name: name.to_owned(),
            track_length_m: tidy(outcome.track),
            carts: outcome.carts,
            left_over_m: left_over,
            polygon_action,
            passing_hz: tidy(passing),
            channels: CHANNELS.into_iter().filter_map(force).collect(),
            ratio: 1.0,
        }
    }
}

impl Verification {
    /// The first case is the layout before.
    pub fn new(layout: &str, mut cases: Vec<Case>) -> Self {
        let before = cases.first().map(|c| c.channels.clone()).unwrap_or_default();
        for case in &mut cases {
            let ratios: Vec<f64> = case
                .channels
                .iter()
                .filter_map(|(name, force)| before.get(name).filter(|b| b.sd > 0.0).map(|b| force.sd / b.sd))
                .collect();
            case.ratio = tidy(ratios.iter().sum::<f64>() / ratios.len().max(1) as f64);
        }
        let after = cases.get(1..).unwrap_or_default();
        let best = after.iter().min_by(|a, b| a.ratio.total_cmp(&b.ratio)).map_or(String::new(), |c| c.name.clone());
        let summary = words(&cases, &best);
        Verification { layout: layout.to_owned(), best, summary, cases }
    }
}

/// Which objective wins, and whether the kinematic measure would have said so.
fn words(cases: &[Case], best: &str) -> String {
    let Some((before, after)) = cases.split_first() else { return String::new() };
    let Some(winner) = after.iter().find(|c| c.name == best) else { return String::new() };
    let percent = |ratio: f64| format!("{} %", fixed(100.0 * (ratio - 1.0).abs(), 0));
    // What would be told as 0 % is no change.
    let is_alike = |ratio: f64| 100.0 * (ratio - 1.0).abs() < 0.5;
    let mut out = if is_alike(winner.ratio) {
        format!("No objective lowers the swing of the forces; `{best}` leaves it as it is, to within half a percent")
    } else if winner.ratio < 1.0 {
        format!(
            "Optimising `{best}` lowers the swing of the forces most, by {} in the mean of the channels",
            percent(winner.ratio)
        )
    } else {
        format!("No objective lowers the swing of the forces; `{best}` raises it least, by {}", percent(winner.ratio))
    };
    let others: Vec<String> = after
        .iter()
        .filter(|c| c.name != best)
        .map(|c| match (is_alike(c.ratio), c.ratio < 1.0) {
            (true, _) => format!("`{}` leaves it as it is", c.name),
            (false, true) => format!("`{}` lowers it by {}", c.name, percent(c.ratio)),
            (false, false) => format!("`{}` raises it by {}", c.name, percent(c.ratio)),
        })
        .collect();
    if !others.is_empty() {
        out += &format!("; {}", others.join(", "));
    }
    out += ".";
    if let (Some(a), Some(b)) = (before.channels.get("joint_xi"), winner.channels.get("joint_xi")) {
        out += &format!(
            " The joint swings by {} N (standard deviation) instead of {} N, at cart passing by {} N instead of {} N.",
            fixed(b.sd, 1),
            fixed(a.sd, 1),
            fixed(b.passing_rms, 1),
            fixed(a.passing_rms, 1)
        );
    }
    let worse: Vec<&str> = after.iter().filter(|c| c.ratio >= 1.0).map(|c| c.name.as_str()).collect();
    if !worse.is_empty() {
        out += " The kinematic measure is no promise: what else moves the chain (motors, closing, ring modes) is not \
                in it.";
    }
    out
}

/// A table for people.
pub fn verify_text(v: &Verification) -> String {
    let mut out = format!("{}\n", v.layout);
    out += &format!(
        "  {:<12} {:>9} {:>6} {:>9} {:>10} {:>12} {:>10} {:>7}\n",
        "layout", "length", "carts", "left over", "all", "first_three", "last", "forces"
    );
    for c in &v.cases {
        let p = &c.polygon_action;
        out += &format!(
            "  {:<12} {:>7} m {:>6} {:>6} mm {:>10} {:>12} {:>10} {:>7}\n",
            c.name,
            fixed(c.track_length_m, 3),
            c.carts,
            fixed(1e3 * c.left_over_m, 0),
            fixed(p.all, 2),
            fixed(p.first_three, 2),
            fixed(p.last, 2),
            fixed(c.ratio, 3)
        );
    }
    out += &format!(
        "\n  {:<12} {:<12} {:>9} {:>9} {:>9} {:>9} {:>11} {:>9}\n",
        "force, N", "layout", "mean", "sd", "min", "max", "at passing", "damage"
    );
    for channel in CHANNELS {
        for c in &v.cases {
            let Some(f) = c.channels.get(channel.name()) else { continue };
            out += &format!(
                "  {:<12} {:<12} {:>9} {:>9} {:>9} {:>9} {:>11} {:>9}\n",
                channel.name(),
                c.name,
                fixed(f.mean, 1),
                fixed(f.sd, 1),
                fixed(f.min, 1),
                fixed(f.max, 1),
                fixed(f.passing_rms, 2),
                f.damage.map_or("-".to_owned(), |d| fixed(d, 2))
            );
        }
    }
    out + "\n  polygon action in mm²; forces: mean ratio of standard deviations to those before\n"
        + &format!("  {}\n", v.summary)
}

/// The objectives with the names of their cases.
pub fn case_name(objective: Option<PolygonObjective>) -> &'static str {
    objective.map_or("before", PolygonObjective::name)
}
