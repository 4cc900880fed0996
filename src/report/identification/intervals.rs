//! Estimates and intervals of a parameter over the runs: a row a run with a dot and a bar, runs of one set point
//! together.

use crate::base::number::{fixed, tick_labels, ticks};
use maud::{Markup, html};

/// A run's estimate.
pub struct IntervalRow {
    pub name: String,
    pub value: f64,
    /// The interval; none where there is none.
    pub interval: Option<(f64, f64)>,
    /// What stands behind the row.
    pub note: String,
    /// Whether the dot is hollow: not fitted, or not believed.
    pub hollow: bool,
    /// Whether it is drawn as a warning.
    pub warned: bool,
}

/// Runs of one set point.
pub struct Band {
    /// Empty where there is one set point only.
    pub name: String,
    /// Lower quartile, median and upper quartile.
    pub quartiles: [f64; 3],
    pub rows: Vec<IntervalRow>,
}

const WIDTH: f64 = 1100.0;
const LEFT: f64 = 190.0;
const RIGHT: f64 = 280.0;
const ROW: f64 = 20.0;
const BELOW: f64 = 22.0;

/// Rules of the style sheet for these pictures.
pub const RULES: &str = "
.estimate { fill: var(--trace); stroke: var(--trace); } .estimate.hollow { fill: var(--paper); }
.bar { stroke: var(--trace); stroke-width: 2; } .warned { --trace: #c2410c; } .warned text { fill: #c2410c; }
.quartiles { fill: var(--band); } .median { stroke: var(--soft); stroke-dasharray: 4 3; } \
.set-point { fill: var(--ink); font-weight: 600; }
";

/// Least and largest of what is to be seen.
fn range(bands: &[Band], marks: &[f64]) -> Option<(f64, f64)> {
    let of = |row: &IntervalRow| [Some(row.value), row.interval.map(|i| i.0), row.interval.map(|i| i.1)];
    let rows = bands.iter().flat_map(|band| &band.rows).flat_map(of).flatten();
    let all = rows.chain(marks.iter().copied()).filter(|x| x.is_finite());
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let room = (0.04 * (high - low)).max(1e-6 * high.abs().max(1e-6));
    (low <= high).then_some((low - room, high + room))
}

/// The picture; `marks` are dotted: bounds, or a limit.
pub fn intervals(bands: &[Band], marks: &[f64]) -> Markup {
    let Some((low, high)) = range(bands, marks) else { return html! { p.note { "Not fitted." } } };
    let x = |value: f64| LEFT + (value - low) / (high - low) * (WIDTH - LEFT - RIGHT);
    let at = |value: f64| fixed(x(value), 1);
    let heads = bands.iter().filter(|band| !band.name.is_empty()).count();
    let rows = heads + bands.iter().map(|band| band.rows.len()).sum::<usize>();
    let bottom = ROW * rows as f64;
    let ticks = ticks(low, high, 6.0);
    let mut top = 0.0;
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {}", bottom + BELOW)) role="img" {
            @for (value, label) in ticks.iter().zip(tick_labels(&ticks)) {
                line.axis x1=(at(*value)) x2=(at(*value)) y1="0" y2=(fixed(bottom, 1)) {}
                text.tick x=(at(*value)) y=(fixed(bottom + 16.0, 1)) text-anchor="middle" { (label) }
            }
            @for band in bands {
                (one(band, &mut top, &at))
            }
            @for mark in marks {
                line.dotted x1=(at(*mark)) x2=(at(*mark)) y1="0" y2=(fixed(bottom, 1)) {}
            }
        }
    }
}

/// A set point's heading and rows, from `top` on.
fn one(band: &Band, top: &mut f64, at: &impl Fn(f64) -> String) -> Markup {
    let head = *top;
    if !band.name.is_empty() {
        *top += ROW;
    }
    let (from, [lower, median, upper]) = (*top, band.quartiles);
    *top += ROW * band.rows.len() as f64;
    let (level, several) = (|y: f64| fixed(y, 1), band.rows.len() > 2);
    html! {
        @if !band.name.is_empty() {
            text.set-point x="0" y=(level(head + 14.0)) { (band.name) }
        }
        @if several {
            @let (a, b, t, u) = (at(lower), at(upper), level(from), level(*top));
            polygon.quartiles points=(format!("{a},{t} {b},{t} {b},{u} {a},{u}")) {}
            line.median x1=(at(median)) x2=(at(median)) y1=(level(from)) y2=(level(*top)) {}
        }
        @for (k, row) in band.rows.iter().enumerate() {
            (estimate(row, from + ROW * (k as f64 + 0.5), at))
        }
    }
}

fn estimate(row: &IntervalRow, y: f64, at: &impl Fn(f64) -> String) -> Markup {
    let level = |by: f64| fixed(y + by, 1);
    html! {
        g class=(if row.warned { "warned" } else { "" }) {
            text.tick x=(fixed(LEFT - 10.0, 1)) y=(level(4.0)) text-anchor="end" { (row.name) }
            @if let Some((low, high)) = row.interval {
                line.bar x1=(at(low)) x2=(at(high)) y1=(level(0.0)) y2=(level(0.0)) {}
                @for end in [low, high] { line.bar x1=(at(end)) x2=(at(end)) y1=(level(-4.0)) y2=(level(4.0)) {} }
            }
            circle class=(if row.hollow { "estimate hollow" } else { "estimate" }) cx=(at(row.value)) cy=(level(0.0))
                r="4" {}
            text.tick x=(fixed(WIDTH - RIGHT + 10.0, 1)) y=(level(4.0)) { (row.note) }
        }
    }
}
