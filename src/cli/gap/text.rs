//! A diagnosis for the terminal.

use crate::base::number::{fixed, significant};
use crate::gap::{
    Amount, Axis, Cost, Diagnosis, Explanation, Finding, GapPlace, Terms, bound, draws, percent, probability,
};
use crate::identify::noise::ChannelNoise;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Effects that are listed.
const LISTED: usize = 6;

/// Probability above which they are listed: the weight of the priors alone gives each some 0.2 %.
const LISTED_FROM: f64 = 0.005;

/// Places that are listed of what is left.
const LEFT: usize = 4;

/// How hypotheses came to their scores, in natural logarithms.
pub fn explained(each: &[Explanation]) -> String {
    let mut out =
        "\n  how hypotheses are scored, in natural logarithms: likelihood - strengths + prior - impacts - beyond\n"
            .to_owned();
    let head = ["residual", "likelihood", "in common", "strengths", "prior", "impacts", "beyond", "posterior"];
    let _ = writeln!(out, "  {}  hypothesis", head.map(|h| format!("{h:>11}")).concat());
    for (rank, one) in each.iter().enumerate() {
        let Terms { likelihood, in_common, strengths, prior, impacts, beyond } = one.terms;
        let own = [likelihood, in_common, strengths, prior, impacts, beyond, one.terms.log_posterior()];
        let numbers: Vec<String> =
            [one.mean_square].into_iter().chain(own).map(|x| format!("{:>11}", fixed(x, 2))).collect();
        let name = match (rank, &one.effects[..]) {
            (0, []) => "no gap".to_owned(),
            (_, []) => "none of these effects".to_owned(),
            (_, effects) => effects.join(" + "),
        };
        let screened = if one.simulated { "" } else { ", by its signature" };
        let _ = writeln!(out, "  {}  {name}{screened}", numbers.concat());
    }
    out
}

/// Which stage asked for how many simulations.
pub fn costs(cost: &Cost) -> String {
    let mut out = "\n  what it cost:  simulations  simulated, s  wall, s\n".to_owned();
    let row = |name: &str, cost: &Cost| {
        let (simulated, wall) = (fixed(cost.simulated_s, 0), fixed(cost.wall_s, 1));
        format!("  {name:<16}{:>10}{simulated:>14}{wall:>9}\n", cost.simulations)
    };
    cost.by_stage.iter().for_each(|(stage, cost)| out.push_str(&row(stage, cost)));
    out + &row("all", cost)
}

pub fn text(found: &Diagnosis) -> String {
    let mut out = format!("{}\n\n", found.summary);
    let gap = found.has_gap();
    let closed = |x: Option<f64>| x.filter(|_| gap).map_or("-".to_owned(), percent);
    let _ = writeln!(
        out,
        "  {:<24}{:>12}{:>13}{:>13}  strength, 90 % interval",
        "effect", "probability", "closes", "placebo"
    );
    let row = |out: &mut String, name: &str, p: f64, finding: Option<&Finding>| {
        let _ = write!(out, "  {name:<24}{:>12}", probability(p));
        if let Some(finding) = finding {
            let (own, placebo) = (closed(finding.gap_closed), closed(finding.gap_closed_placebo));
            let untested = finding.untested().then(|| "not simulated".to_owned());
            let strengths: Vec<String> = finding.strength.iter().map(|(n, a)| amount(n, a)).chain(untested).collect();
            let place = if finding.place.is_empty() { String::new() } else { format!(" ({})", finding.place) };
            let _ = write!(out, "{own:>13}{placebo:>13}  {}{place}", strengths.join(", "));
            for other in finding.places().skip(1) {
                let strengths: Vec<String> = other.strength.iter().map(|(n, a)| amount(n, a)).collect();
                let _ = write!(out, "\n{:64}{} ({})", "", strengths.join(", "), other.place);
            }
        }
        out.push('\n');
    };
    for finding in found.effects.iter().take(LISTED).filter(|f| f.probability > LISTED_FROM) {
        row(&mut out, &finding.name, finding.probability, Some(finding));
    }
    row(&mut out, "no gap", found.none_probability, None);
    row(&mut out, "none of these effects", found.unknown_probability, None);
    let places = |out: &mut String, what: &str, places: &[GapPlace]| {
        let _ = writeln!(out, "\n  {what}");
        for p in places {
            let (from, to) = p.extent.ends();
            let extent = format!("{} to {} {}", fixed(from, 1), fixed(to, 1), found.axis.unit());
            // In time there is one kind of deviation only.
            let band = if found.axis == Axis::Time { "" } else { &p.band };
            let _ = writeln!(out, "  {:<14}{band:<14}{extent:<22}{:>6}", p.channel, percent(p.share));
        }
    };
    if !found.places.is_empty() {
        let what = if gap { "where the gap lies" } else { "where what little differs lies" };
        places(&mut out, what, &found.places[..found.places.len().min(LISTED)]);
    }
    let left = &found.unexplained.places;
    if !found.shown.is_empty() && !left.is_empty() {
        places(&mut out, "where what is left lies", &left[..left.len().min(LEFT)]);
    }
    let _ = writeln!(
        out,
        "\n  run                  before    after    (1: the repeatability; limit: 95 % of repeated measurements)"
    );
    for run in &found.runs {
        let [a, b, c] = [run.before, run.after, run.replicate_high].map(|x| fixed(x, 2));
        let _ = writeln!(out, "  {:<18}{a:>9}{b:>9}    {c}", run.run);
    }
    if let Some(draws) = draws(found) {
        let _ = writeln!(out, "  {draws}");
    }
    noise(&mut out, found);
    outside(&mut out, found);
    for group in &found.groups {
        let _ = writeln!(out, "\n  {}", group.experiment);
    }
    found.lost.iter().for_each(|lost| {
        let _ = writeln!(out, "  lost: {lost}");
    });
    let _ = writeln!(out, "\n  next: {}", found.next_experiment);
    out
}

/// What is known of a model outside beside: errors of samples, nuisances, and remarks.
fn outside(out: &mut String, found: &Diagnosis) {
    let Some(own) = &found.outside else { return };
    let _ = writeln!(out, "\n  error of samples         before     after     noise  (root mean square)");
    for (channel, error) in &own.sample_error {
        let [a, b, c] = [error.before, error.after, error.noise].map(|x| significant(x, 3));
        let _ = writeln!(out, "  {channel:<20}{a:>11}{b:>10}{c:>10}  {}, compared by {}", error.unit, error.compared);
    }
    if own.nuisances.values().any(|each| !each.is_empty()) {
        let _ = writeln!(out, "\n  nuisances as fitted, 90 % interval");
        for (run, each) in &own.nuisances {
            let each: Vec<String> = each.iter().map(|(n, a)| amount(n, a)).collect();
            let _ = writeln!(out, "  {run:<18}{}", each.join("; "));
        }
    }
    if !own.by_accuracy.is_empty() {
        let _ = writeln!(out, "\n  the verdict by the model's accuracy");
        for row in &own.by_accuracy {
            let accuracy: Vec<String> =
                row.accuracy.iter().map(|(c, x)| format!("{c} {}", significant(*x, 2))).collect();
            let mut said: Vec<String> =
                row.effects.iter().map(|(name, p)| format!("{name} {}", probability(*p))).collect();
            said.push(format!("no gap {}", probability(row.none_probability)));
            said.push(format!("none of these {}", probability(row.unknown_probability)));
            let _ = writeln!(out, "  {:<24}{}", accuracy.join(", "), said.join(", "));
        }
    }
    own.remarks.iter().for_each(|remark| {
        let _ = writeln!(out, "\n  note: {remark}");
    });
}

/// The sensors' noise, a channel a line; all runs of one where they differ.
fn noise(out: &mut String, found: &Diagnosis) {
    let channels: BTreeSet<&String> = found.noise.values().flat_map(BTreeMap::keys).collect();
    if channels.is_empty() {
        return;
    }
    let _ = writeln!(out, "\n  noise of the sensors");
    for channel in channels {
        let runs: Vec<String> =
            found.noise.values().filter_map(|run| run.get(channel)).map(ChannelNoise::words).collect();
        let alike = runs.windows(2).all(|two| two[0] == two[1]);
        let words = if alike { runs.first().cloned().unwrap_or_default() } else { runs.join("; ") };
        let _ = writeln!(out, "  {channel:<14}{words}");
    }
}

fn amount(name: &str, a: &Amount) -> String {
    let [value, low, high] = [a.value, a.low, a.high].map(|x| significant(x, 3));
    let bound = bound(a);
    let bound = if bound.is_empty() { bound } else { format!(", {bound}") };
    let by_run = a.by_run.iter().map(|(run, x)| format!(", {} in {run}", significant(*x, 3)));
    format!("{name} {value} {} [{low}, {high}]{bound}{}", a.unit, by_run.collect::<String>()).replace("  ", " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::random_reports::{hold, report};

    #[test]
    fn every_sentence_on_the_terminal_agrees_with_its_numbers() {
        for seed in 0..2000 {
            let found = report(seed);
            hold(&text(&found), &found).unwrap_or_else(|wrong| panic!("{seed}: {wrong}"));
        }
    }
}
