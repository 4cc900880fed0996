//! Box plots (Tukey 1977) in SVG, one row a group.

use crate::emit::number::{fixed, ticks, trimmed};
use maud::{Markup, html};

/// Values of one group.
pub struct Group {
    pub name: String,
    pub values: Vec<f64>,
}

const WIDTH: f64 = 1100.0;
const LEFT: f64 = 190.0;
const RIGHT: f64 = 90.0;
const ROW: f64 = 26.0;
const BELOW: f64 = 22.0;

/// Quantile of sorted values, linear between them; NaN of none.
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let at = q * sorted.len().saturating_sub(1) as f64;
    let (i, share) = (at.floor() as usize, at - at.floor());
    match (sorted.get(i), sorted.get(i + 1)) {
        (Some(a), Some(b)) => a + share * (b - a),
        (Some(a), None) => *a,
        _ => f64::NAN,
    }
}

/// The plot; `bounds` are dotted.
pub fn boxes(groups: &[Group], bounds: Option<(f64, f64)>, unit: &str) -> Markup {
    let all =
        || groups.iter().flat_map(|g| g.values.iter().copied()).chain(bounds.into_iter().flat_map(|b| [b.0, b.1]));
    let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    if !(low.is_finite() && high.is_finite()) {
        return html! { p.note { "Not fitted." } };
    }
    let room = (0.04 * (high - low)).max(1e-6 * high.abs().max(1e-6));
    let (low, high) = (low - room, high + room);
    let x = |value: f64| LEFT + (value - low) / (high - low) * (WIDTH - LEFT - RIGHT);
    let height = ROW * groups.len() as f64 + BELOW;
    let label = |value: f64| {
        trimmed(
            value,
            if high - low >= 50.0 {
                0
            } else if high - low >= 0.5 {
                2
            } else {
                4
            },
        )
    };
    let at = |value: f64| fixed(x(value), 1);
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {height}")) role="img" {
            @for value in ticks(low, high, 6.0) {
                line.axis x1=(at(value)) x2=(at(value)) y1="0" y2=(fixed(height - BELOW, 1)) {}
                text.tick x=(at(value)) y=(fixed(height - 6.0, 1)) text-anchor="middle" { (label(value)) }
            }
            @for bound in bounds.into_iter().flat_map(|b| [b.0, b.1]) {
                line.dotted x1=(at(bound)) x2=(at(bound)) y1="0" y2=(fixed(height - BELOW, 1)) {}
            }
            @for (row, group) in groups.iter().enumerate() {
                @let y = ROW * (row as f64 + 0.5);
                (one(group, y, &at, label(quantile(&in_order(&group.values), 0.5)), unit))
            }
        }
    }
}

fn in_order(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

fn one(group: &Group, y: f64, at: &impl Fn(f64) -> String, middle: String, unit: &str) -> Markup {
    let sorted = in_order(&group.values);
    let [lower, median, upper] = [0.25, 0.5, 0.75].map(|q| quantile(&sorted, q));
    let reach = 1.5 * (upper - lower);
    let first = sorted.iter().copied().find(|v| *v >= lower - reach).unwrap_or(lower);
    let last = sorted.iter().rev().copied().find(|v| *v <= upper + reach).unwrap_or(upper);
    let level = |by: f64| fixed(y + by, 1);
    html! {
        text.tick x=(fixed(LEFT - 10.0, 1)) y=(level(4.0)) text-anchor="end" { (group.name) }
        @if sorted.len() > 2 {
            line.mark x1=(at(first)) x2=(at(last)) y1=(level(0.0)) y2=(level(0.0)) {}
            polygon.fill points=(format!("{a},{t} {b},{t} {b},{u} {a},{u}", a = at(lower), b = at(upper), t = level(-7.0), u = level(7.0))) {}
            line.trace x1=(at(median)) x2=(at(median)) y1=(level(-8.0)) y2=(level(8.0)) stroke-width="2" {}
        }
        @for value in &sorted { circle.motor cx=(at(*value)) cy=(level(0.0)) r="2" {} }
        @if !sorted.is_empty() {
            text.tick x=(fixed(WIDTH - RIGHT + 8.0, 1)) y=(level(4.0)) { (middle) " " (unit) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_lie_between_values() {
        let sorted = [1.0, 2.0, 3.0, 4.0];
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|q| quantile(&sorted, q)), [1.0, 1.75, 2.5, 4.0]);
        assert!(quantile(&[], 0.5).is_nan());
    }
}
