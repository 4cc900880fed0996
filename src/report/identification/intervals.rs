//! Estimates and intervals of a parameter over the runs: a row a run with a dot and a bar, runs of one set point
//! together.

use crate::base::number::{tick_labels, ticks};
use crate::report::rows::{RowScale, row};
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

/// Rules of the style sheet for these pictures.
pub const RULES: &str = "
.rows.intervals { --first: 150px; --last: 290px; } .row-scale i.bar { height: 2px; top: 10px; bottom: auto; background: var(--trace); }
.row-scale i.bar::before, .row-scale i.bar::after { content: ''; position: absolute; left: 0; top: -4px; height: 10px; width: 2px; \
background: var(--trace); } .row-scale i.bar::after { left: auto; right: 0; }
.dot.estimate { background: var(--trace); border: 2px solid var(--trace); } .dot.estimate.hollow { background: var(--paper); }
.warned { --trace: #c2410c; } .warned .row-name, .warned .row-value { color: #c2410c; }
@media (prefers-color-scheme: dark) { .warned { --trace: #fb923c; } .warned .row-name, .warned .row-value { color: #fb923c; } }
.row-scale i.quartiles { top: 0; bottom: -2px; background: var(--band); } .row-scale i.median { top: 0; bottom: -2px; width: 0; \
border-left: 1px dashed var(--soft); } .row-scale i.limit { top: 0; bottom: -2px; width: 0; border-left: 1px dotted var(--soft); }
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
    let scale = RowScale { low, high };
    let at = ticks(low, high, 6.0);
    let numbers: Vec<(f64, String)> = at.iter().copied().zip(tick_labels(&at)).collect();
    html! {
        div.rows.intervals {
            @for band in bands { (one(band, marks, scale, &at)) }
            (scale.ticks(&numbers))
        }
    }
}

/// A set point's heading and rows.
fn one(band: &Band, limits: &[f64], scale: RowScale, ticks: &[f64]) -> Markup {
    let [lower, median, upper] = band.quartiles;
    let line = |class: &str, value: f64| html! { i class=(class) style=(format!("left:{}%", scale.at(value))) {} };
    let behind = html! {
        @if band.rows.len() > 2 { (scale.span("quartiles", lower, upper)) (line("median", median)) }
        (scale.grid(ticks))
        @for limit in limits { (line("limit", *limit)) }
    };
    html! {
        @if !band.name.is_empty() { div.row-head { (band.name) } }
        @for estimate in &band.rows {
            @let marks = html! {
                (behind)
                @if let Some((from, to)) = estimate.interval { (scale.span("bar", from, to)) }
                (scale.dot(if estimate.hollow { "estimate hollow" } else { "estimate" }, estimate.value))
            };
            (row(if estimate.warned { "warned" } else { "" }, &estimate.name, &marks, &estimate.note))
        }
    }
}
