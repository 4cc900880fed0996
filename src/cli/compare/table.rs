//! The measures between two runs as a table for people.

use super::{Moments, Report, Side};
use crate::base::number::{fixed, trimmed};
use crate::source::one_line;

/// Two lines a channel: the reference, and what the other run has more.
pub fn text(report: &Report) -> String {
    let mut out = format!("{}{}", side('A', &report.reference), side('B', &report.other));
    out += &scale("lap", report.lap_m, report.lap_from, "places cannot be compared: give --lap");
    out += &scale("pitch", report.pitch_m, report.pitch_from, "there is no mean over two carts: give --pitch");
    let widest = report.channels.keys().map(|name| name.len()).max().unwrap_or(0);
    out += &format!(
        "\n{:widest$}  {:<5} {:<5} {:>10} {:>10} {:>10} {:>10} {:>9} {:>9} {:>9} {:>7}\n",
        "channel", "unit", "", "mean", "sd", "min", "max", "NRMSD", "2 carts", "spectrum", "damage"
    );
    for (name, m) in &report.channels {
        let percent = |x: Option<f64>| or_dash(x.map(|x| fixed(100.0 * x, 2) + " %"));
        out += &format!(
            "{name:widest$}  {:<5} {:<5} {} {:>9} {:>9} {:>9} {:>7}\n",
            m.unit,
            "A",
            moments(&m.reference, |x| fixed(x, decimals(&m.reference))),
            percent(m.nrmsd),
            percent(m.nrmsd_two_carts),
            or_dash(m.spectral_distance_db.map(|x| fixed(x, 1) + " dB")),
            or_dash(m.damage_ratio.map(|x| fixed(x, 3))),
        );
        let (a, b) = (&m.reference, &m.other);
        let more = Moments { mean: b.mean - a.mean, sd: b.sd - a.sd, min: b.min - a.min, max: b.max - a.max };
        out += &format!("{:widest$}  {:<5} {:<5} {}\n", "", "", "B - A", moments(&more, |x| signed(x, decimals(a))));
    }
    let lost: Vec<String> = report
        .channels
        .iter()
        .filter(|(_, m)| m.filled != [0; 2] || m.masked != [0; 2])
        .map(|(name, m)| {
            let [a, b] = [0, 1].map(|i| format!("{} bridged, {} left out", m.filled[i], m.masked[i]));
            format!("  {name}: A {a}; B {b}\n")
        })
        .collect();
    if !lost.is_empty() {
        out += &format!("\nlost samples\n{}", lost.concat());
    }
    out += &format!(
        "
NRMSD     root mean square of B - A at the same place, over A's range; two replicate simulations of a lap: 0.5 to 3 %
2 carts   the same of the moving mean over two carts; two replicate simulations: 0.0 to 0.3 %
spectrum  log-spectral distance up to the low-pass; chance alone leaves about 1.5 dB for 100 s
damage    damage-equivalent load of B over A for the same distance, slope {}
",
        trimmed(report.slope, 3)
    );
    out
}

fn side(letter: char, side: &Side) -> String {
    let laps = side.laps.map_or(String::new(), |laps| format!(", {} laps", fixed(laps, 2)));
    format!(
        "{letter}      {}: {} s at {} Hz{laps}\n",
        one_line(side.file),
        fixed(side.duration_s, 1),
        trimmed(side.rate_hz, 2)
    )
}

fn scale(what: &str, value: Option<f64>, from: Option<&str>, without: &str) -> String {
    match (value, from) {
        (Some(value), Some(from)) => format!("{what:<6} {} m, from {from}\n", fixed(value, 3)),
        _ => format!("{what:<6} unknown; {without}\n"),
    }
}

fn moments(m: &Moments, write: impl Fn(f64) -> String) -> String {
    format!("{:>10} {:>10} {:>10} {:>10}", write(m.mean), write(m.sd), write(m.min), write(m.max))
}

/// Two decimals for forces of hundreds, more for angles of thousandths.
fn decimals(m: &Moments) -> usize {
    let size = m.min.abs().max(m.max.abs());
    if size >= 10.0 || size == 0.0 {
        2
    } else if size >= 0.1 {
        4
    } else {
        6
    }
}

fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.starts_with('-') || text.bytes().all(|b| matches!(b, b'0' | b'.')) { text } else { format!("+{text}") }
}

fn or_dash(text: Option<String>) -> String {
    text.unwrap_or_else(|| "-".to_owned())
}
