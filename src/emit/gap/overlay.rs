//! A channel over a stretch: measured, simulated before and after, and how far honest laps stray.

use super::words::stretch;
use crate::emit::lap::chart::{HEIGHT, Scale, WIDTH, frame};
use crate::emit::number::fixed;
use crate::gap::Overlay;
use maud::{Markup, html};

/// Deviations of honest laps that the floor's band is wide to either side.
const BAND: f64 = 2.0;

/// Whether the simulation with the effect differs from that without.
pub fn changed(overlay: &Overlay) -> bool {
    overlay.before.iter().zip(&overlay.after).any(|(a, b)| a.is_finite() && b.is_finite() && a != b)
}

/// The curves of the charts below.
pub fn legend(changed: bool) -> Markup {
    html! {
        p.legend.note {
            span { i.line-measured {} "measured" }
            span { i.line-before {} @if changed { "simulated before" } @else { "simulated" } }
            @if changed { span { i.line-after {} "with the named effect" } }
            span { i.line-floor {} "twice the deviation of honest laps" }
        }
    }
}

/// The chart; nothing where no number can be drawn.
pub fn chart(overlay: &Overlay, axis: &str) -> Markup {
    let finite = |x: &&f64| x.is_finite();
    let (from, to) = bounds(overlay.at.iter().filter(finite).copied());
    let edges = |sign: f64| overlay.measured.iter().zip(&overlay.floor).map(move |(m, f)| m + sign * BAND * f);
    let drawn = [&overlay.measured, &overlay.before, &overlay.after];
    let (low, high) = bounds(drawn.into_iter().flatten().copied().chain(edges(1.0)).chain(edges(-1.0)));
    if !(from < to && low <= high) {
        return html! {};
    }
    let scale = Scale::new(from, to, low, high);
    let point = |s: f64, y: f64| format!("{} {}", fixed(scale.x(s), 1), fixed(scale.y(y), 1));
    let paths = |values: &[f64]| -> String {
        let mut path = String::new();
        for part in known(&overlay.at, values) {
            path += &format!("M{}", part.iter().map(|(s, y)| point(*s, *y)).collect::<Vec<_>>().join("L"));
            if part.len() == 1 {
                path += "h0.1";
            }
        }
        path
    };
    let (lower, upper): (Vec<f64>, Vec<f64>) = (edges(-1.0).collect(), edges(1.0).collect());
    let band: String = known(&overlay.at, &lower)
        .into_iter()
        .zip(known(&overlay.at, &upper))
        .map(|(below, above)| {
            let outline: Vec<String> = below.iter().chain(above.iter().rev()).map(|(s, y)| point(*s, *y)).collect();
            format!("M{}Z", outline.join("L"))
        })
        .collect();
    html! {
        figure {
            figcaption { b { (overlay.channel) } @if !overlay.unit.is_empty() { ", " (overlay.unit) } " — " (overlay.run) ", " (stretch(from, to, axis)) }
            svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
                (frame(&scale, axis))
                path.floor d=(band) {}
                path.measured d=(paths(&overlay.measured)) {}
                path.before d=(paths(&overlay.before)) {}
                @if changed(overlay) { path.after d=(paths(&overlay.after)) {} }
            }
        }
    }
}

fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|x| x.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
}

/// Stretches of known values.
fn known(at: &[f64], values: &[f64]) -> Vec<Vec<(f64, f64)>> {
    let mut parts: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    for (s, y) in at.iter().zip(values) {
        if s.is_finite() && y.is_finite() {
            if let Some(part) = parts.last_mut() {
                part.push((*s, *y));
            }
        } else if parts.last().is_some_and(|part| !part.is_empty()) {
            parts.push(Vec::new());
        }
    }
    parts.retain(|part| !part.is_empty());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lost_values_break_the_line() {
        let at = [0.0, 1.0, 2.0, 3.0, 4.0];
        let parts = known(&at, &[f64::NAN, 5.0, f64::NAN, f64::NAN, 6.0]);
        assert_eq!(parts, [vec![(1.0, 5.0)], vec![(4.0, 6.0)]]);
    }

    #[test]
    fn nothing_known_draws_nothing() {
        let nothing = Overlay {
            run: String::new(),
            channel: String::new(),
            unit: String::new(),
            at: vec![0.0, 1.0],
            measured: vec![f64::NAN; 2],
            before: vec![f64::NAN; 2],
            after: Vec::new(),
            floor: Vec::new(),
        };
        assert_eq!(chart(&nothing, "m").into_string(), "");
    }
}
