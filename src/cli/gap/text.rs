//! A diagnosis for the terminal.

use crate::emit::number::{fixed, significant};
use crate::gap::{Amount, Diagnosis, Finding};
use std::fmt::Write;

/// Effects that are listed.
const LISTED: usize = 6;

pub fn text(found: &Diagnosis) -> String {
    let mut out = format!("{}\n\n", found.summary);
    let percent = |x: f64| format!("{} %", fixed(100.0 * x, 0));
    let closed = |x: Option<f64>| x.map_or("-".to_owned(), percent);
    let _ = writeln!(
        out,
        "  {:<24}{:>12}{:>9}{:>9}  strength, 90 % interval",
        "effect", "probability", "closes", "placebo"
    );
    let row = |out: &mut String, name: &str, p: f64, finding: Option<&Finding>| {
        let _ = write!(out, "  {name:<24}{:>12}", percent(p));
        if let Some(finding) = finding {
            let (own, placebo) = (closed(finding.gap_closed), closed(finding.gap_closed_placebo));
            let strengths: Vec<String> = finding.strength.iter().map(|(n, a)| amount(n, a)).collect();
            let place = if finding.place.is_empty() { String::new() } else { format!(" ({})", finding.place) };
            let _ = write!(out, "{own:>9}{placebo:>9}  {}{place}", strengths.join(", "));
        }
        out.push('\n');
    };
    for finding in found.effects.iter().take(LISTED).filter(|f| f.probability > 0.0005) {
        row(&mut out, &finding.name, finding.probability, Some(finding));
    }
    row(&mut out, "no gap", found.none_probability, None);
    row(&mut out, "none of these effects", found.unknown_probability, None);
    if !found.places.is_empty() {
        let _ = writeln!(out, "\n  where the gap lies");
        for p in found.places.iter().take(LISTED) {
            let extent = format!("{} to {} {}", fixed(p.from_m, 1), fixed(p.to_m, 1), found.axis);
            let _ = writeln!(out, "  {:<14}{:<14}{extent:<22}{:>6}", p.channel, p.band, percent(p.share));
        }
    }
    let _ = writeln!(
        out,
        "\n  run                  before    after    (1: as near as honest laps are; 95 % of them below)"
    );
    for run in &found.runs {
        let [a, b, c] = [run.before, run.after, run.honest_high].map(|x| fixed(x, 2));
        let _ = writeln!(out, "  {:<18}{a:>9}{b:>9}    {c}", run.run);
    }
    for group in &found.groups {
        let _ = writeln!(out, "\n  {}", group.experiment);
    }
    found.lost.iter().for_each(|lost| {
        let _ = writeln!(out, "  lost: {lost}");
    });
    let _ = writeln!(out, "\n  next: {}", found.next_experiment);
    out
}

fn amount(name: &str, a: &Amount) -> String {
    let [value, low, high] = [a.value, a.low, a.high].map(|x| significant(x, 3));
    format!("{name} {value} {} [{low}, {high}]", a.unit).replace("  ", " ")
}
