//! The report as a table for people.

use super::{PolygonReport, Sweep, rms};
use crate::base::number::{fixed, trimmed};
use crate::kinematics::polygon::PolygonObjective;

/// Straights up to which the whole matrix is shown.
const WIDE: usize = 14;
/// Letters a line of notes.
const LINE: usize = 110;

/// Objectives, matrix, curves and notes.
pub fn text(report: &PolygonReport) -> String {
    let n = report.curves.len();
    let mut out = format!(
        "{}\n  carts of {} m on {} m with {n} curves\n",
        report.layout,
        trimmed(report.cart_length_m, 3),
        fixed(report.track_length_m, 3)
    );
    for objective in PolygonObjective::EACH {
        let value = report.values.get(objective);
        let chosen = if objective.name() == report.objective { "  <- objective" } else { "" };
        out += &format!(
            "  {:<12} {:>10} mm²  {:>7} mm rms  (first harmonics {} mm²){chosen}\n",
            objective.name(),
            fixed(value, 3),
            fixed(rms(value, objective, n), 3),
            fixed(report.first_harmonic_values.get(objective), 3)
        );
    }
    out += &format!(
        "  with these curves, whatever the straights: not below {} mm² ({})\n",
        fixed(report.lower_bound, 3),
        report.objective
    );
    out += &if n <= WIDE { matrix(report) } else { straights(report) };
    out += &curves(report);
    out += "\nwhat cancels what\n";
    for note in &report.notes {
        out += &wrapped(note);
    }
    out
}

fn widest<'a>(names: impl Iterator<Item = &'a String>) -> usize {
    names.map(|n| n.chars().count()).max().unwrap_or(0)
}

fn matrix(report: &PolygonReport) -> String {
    let wide = widest(report.straights.iter().map(|s| &s.name)).max(5);
    let mut out = format!("\nΔP, mm: rows where the chain starts, columns where it is measured\n  {:wide$}", "");
    for straight in &report.straights {
        out += &format!("  {:>wide$}", straight.name);
    }
    out += "\n";
    for (straight, row) in report.straights.iter().zip(&report.delta_p_mm) {
        out += &format!("  {:wide$}", straight.name);
        for value in row {
            out += &format!("  {:>wide$}", fixed(*value, 3));
        }
        out += "\n";
    }
    out
}

/// Where the matrix is too wide.
fn straights(report: &PolygonReport) -> String {
    let wide = widest(report.straights.iter().map(|s| &s.name)).max(8);
    let mut out = format!(
        "\nΔP, mm, over all starts (the whole matrix: --format json)\n  {:wide$}  {:>8}  {:>8}  from\n",
        "straight", "rms", "worst"
    );
    for s in &report.straights {
        let (rms, worst) = (fixed(s.rms_mm, 3), fixed(s.worst_mm, 3));
        out += &format!("  {:wide$}  {rms:>8}  {worst:>8}  {}\n", s.name, s.worst_from);
    }
    out
}

fn curves(report: &PolygonReport) -> String {
    let wide = widest(report.curves.iter().map(|c| &c.name)).max(5);
    let mut out = format!(
        "\n{:>w$}  {:>9}  {:>7}  {:>9}  {:>9}  {:>13}  {:>7}\n",
        "curve",
        "length, m",
        "carts",
        "alone, mm",
        "most, mm",
        "to next, deg",
        "share",
        w = wide + 2
    );
    for c in &report.curves {
        out += &format!(
            "{:>w$}  {:>9}  {:>7}  {:>9}  {:>9}  {:>13}  {:>5} %\n",
            c.name,
            fixed(c.length_m, 3),
            fixed(c.carts, 3),
            fixed(c.alone_mm, 3),
            c.most_mm.map_or("-".to_owned(), |x| fixed(x, 3)),
            fixed(c.phase_to_next_deg, 0),
            fixed(100.0 * c.share, 0),
            w = wide + 2
        );
    }
    out
}

/// A note as an item of a list, broken into lines.
fn wrapped(note: &str) -> String {
    let mut out = String::new();
    let mut line = String::from("  -");
    for word in note.split(' ') {
        if line.chars().count() + 1 + word.chars().count() > LINE {
            out += &line;
            out.push('\n');
            line = String::from("   ");
        }
        line.push(' ');
        line += word;
    }
    out + &line + "\n"
}

/// A sweep with a bar a line.
pub fn sweep_text(sweep: &Sweep) -> String {
    let most = sweep.points.iter().filter_map(|p| p.against_chance).fold(0.0, f64::max);
    let mut out = format!(
        "{}\n  {:>11}  {:>6}  {:>10}  {:>12}  {:>8}  {:>11}\n",
        sweep.layout, "cart length", "carts", "left over", sweep.objective, "rms", "over chance"
    );
    for point in &sweep.points {
        let cell = |x: Option<f64>, digits| x.map_or("-".to_owned(), |x| fixed(x, digits));
        let bar = point.against_chance.map_or(0.0, |x| 24.0 * x / most.max(1e-12)).round() as usize;
        let line = format!(
            "  {:>8} mm  {:>6}  {:>7} mm  {:>8} mm²  {:>5} mm  {:>11}  {}",
            fixed(1e3 * point.cart_length_m, 0),
            point.carts,
            fixed(1e3 * point.left_over_m, 0),
            cell(point.value, 3),
            cell(point.rms_mm, 3),
            cell(point.against_chance, 2),
            "#".repeat(bar)
        );
        out += line.trim_end();
        out.push('\n');
    }
    out + "\nover chance: rms over that of the same curves at phases left to chance; below 1 they cancel each other\n"
}
