//! A channel over a stretch: measured, simulated before and after, their difference, and how far repeated measurements
//! stray.

use super::words::{band, percent, scale_of, stretch};
use crate::gap::{Axis, Overlay};
use crate::report::lap::chart::{HEIGHT, Scale, WIDTH, coordinates, frame};
use maud::{Markup, html};

/// Deviations of repeated measurements that the band is wide to either side.
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
            @if changed { span { i.line-after {} "with the effect" } }
            span { i.line-repeatability {} "repeatability: twice its deviation" }
        }
        p.note { "Below each, the difference, measured less simulated: what is beyond the band is gap." }
    }
}

/// Measured against simulated, and below it the difference of both with the band of repeatability; nothing where no
/// number can be drawn. `share` is the channel's share of the gap.
pub fn chart(overlay: &Overlay, axis: Axis, share: Option<f64>) -> Markup {
    let (from, to) = bounds(overlay.at.iter().filter(|x| x.is_finite()).copied());
    let less = |simulated: &[f64]| overlay.measured.iter().zip(simulated).map(|(m, s)| m - s).collect::<Vec<f64>>();
    let (before, after) = (less(&overlay.before), less(&overlay.after));
    let zero = vec![0.0; overlay.at.len()];
    let both = Panel { overlay, band: &overlay.measured, before: &overlay.before, after: &overlay.after };
    let difference = Panel { overlay, band: &zero, before: &before, after: &after };
    let placed = overlay.band == "track" || overlay.band == "fluctuation";
    let unit = if placed { axis.unit() } else { "" };
    let (Some(above), Some(below)) = (both.draw(from, to, unit, true), difference.draw(from, to, unit, false)) else {
        return html! {};
    };
    html! {
        figure {
            figcaption {
                b { (overlay.channel) } @if let Some(share) = share { ", " (percent(share)) " of the gap" }
                " — " (overlay.run) ", "
                @if placed { (stretch(from, to, axis)) } @else { "feature by feature" }
                @if !band(&overlay.band, axis).is_empty() { "; " (band(&overlay.band, axis)) }
                @let unit = scale_of(&overlay.band, &overlay.unit);
                @if !unit.is_empty() { ", " (unit) }
            }
            (above)
            p.note.difference { "measured less simulated" }
            (below)
        }
    }
}

/// Places and values that follow each other.
type Stretch = Vec<(f64, f64)>;

/// What is drawn in one system of axes.
struct Panel<'a> {
    overlay: &'a Overlay,
    /// The middle of the band of repeatability.
    band: &'a [f64],
    before: &'a [f64],
    after: &'a [f64],
}

impl Panel<'_> {
    fn draw(&self, from: f64, to: f64, unit: &str, measured: bool) -> Option<Markup> {
        let Panel { overlay, band, before, after } = *self;
        let edge = |sign: f64| -> Vec<f64> {
            band.iter().zip(&overlay.repeatability).map(|(m, f)| m + sign * BAND * f).collect()
        };
        let (lower, upper) = (edge(-1.0), edge(1.0));
        let drawn = [before, after, &lower, &upper].into_iter().flatten().copied();
        let own = overlay.measured.iter().filter(|_| measured).copied();
        let (low, high) = bounds(drawn.chain(own));
        if !(from < to && low <= high) {
            return None;
        }
        let scale = Scale::new(from, to, low, high);
        let changed = changed(overlay);
        let line = |values: &[f64]| path(overlay, &scale, values);
        Some(html! {
            svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
                (frame(&scale, unit))
                path.repeatability d=(outline(overlay, &scale, &lower, &upper)) {}
                @if measured { path.measured d=(line(&overlay.measured)) {} }
                path.before d=(line(before)) {}
                @if changed { path.after d=(line(after)) {} }
            }
        })
    }
}

fn point(scale: &Scale, (s, y): &(f64, f64)) -> String {
    coordinates(scale.at(*s, *y))
}

fn path(overlay: &Overlay, scale: &Scale, values: &[f64]) -> String {
    let mut path = String::new();
    for part in known(&overlay.at, values) {
        path += &format!("M{}", part.iter().map(|p| point(scale, p)).collect::<Vec<_>>().join("L"));
        if part.len() == 1 {
            path += "h0.1";
        }
    }
    path
}

fn outline(overlay: &Overlay, scale: &Scale, lower: &[f64], upper: &[f64]) -> String {
    let parts = known(&overlay.at, lower).into_iter().zip(known(&overlay.at, upper));
    let one = |(below, above): (Stretch, Stretch)| {
        let around: Vec<String> = below.iter().chain(above.iter().rev()).map(|p| point(scale, p)).collect();
        format!("M{}Z", around.join("L"))
    };
    parts.map(one).collect()
}

fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|x| x.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
}

/// Stretches of known values.
fn known(at: &[f64], values: &[f64]) -> Vec<Stretch> {
    let mut parts: Vec<Stretch> = vec![Vec::new()];
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
            band: "track".into(),
            unit: String::new(),
            at: vec![0.0, 1.0],
            measured: vec![f64::NAN; 2],
            before: vec![f64::NAN; 2],
            after: Vec::new(),
            repeatability: Vec::new(),
        };
        assert_eq!(chart(&nothing, Axis::Track, None).into_string(), "");
    }
}
