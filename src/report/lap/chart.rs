//! Line charts in SVG: a channel along the track, a spectrum, the supports.

use super::lap_track::{LapTrack, PartKind};
use crate::base::number::{fixed, ticks, trimmed};
use crate::base::trig;
use crate::emit::paper::PaperPoint;
use crate::signal::SupportLoad;
use crate::signal::spectrum::Spectrum;
use maud::{Markup, html};

pub const WIDTH: f64 = 1100.0;
pub const HEIGHT: f64 = 170.0;
/// Room for the numbers at the left and below.
pub const LEFT: f64 = 52.0;
pub const BELOW: f64 = 22.0;
pub const TOP: f64 = 8.0;
/// Columns in which samples are gathered to their least and largest.
const COLUMNS: usize = 1000;

/// From values to the picture, px.
pub struct Scale {
    from: f64,
    to: f64,
    low: f64,
    high: f64,
}

impl Scale {
    /// With a margin, and never without height.
    pub fn new(from: f64, to: f64, low: f64, high: f64) -> Self {
        let room = (0.05 * (high - low)).max(1e-6 * high.abs().max(1.0));
        Scale { from, to, low: low - room, high: high + room }
    }

    pub fn x(&self, value: f64) -> f64 {
        LEFT + (value - self.from) / (self.to - self.from) * (WIDTH - LEFT - 8.0)
    }

    pub fn y(&self, value: f64) -> f64 {
        TOP + (self.high - value) / (self.high - self.low) * (HEIGHT - TOP - BELOW)
    }

    /// A value over another, px.
    pub fn at(&self, x: f64, y: f64) -> PaperPoint {
        PaperPoint::new(self.x(x), self.y(y))
    }
}

/// `x y` to a tenth of a pixel, as the data of paths have it.
pub fn coordinates(p: PaperPoint) -> String {
    format!("{} {}", fixed(p.x, 1), fixed(p.y, 1))
}

fn number(value: f64) -> String {
    trimmed(value, if value.abs() < 1.0 { 4 } else { 1 })
}

/// Lines and numbers of both axes.
pub fn frame(scale: &Scale, unit: &str) -> Markup {
    html! {
        @for t in ticks(scale.low, scale.high, 5.0) {
            line.axis x1=(LEFT) x2=(WIDTH - 8.0) y1=(fixed(scale.y(t), 1)) y2=(fixed(scale.y(t), 1)) {}
            text.tick x=(LEFT - 6.0) y=(fixed(scale.y(t) + 4.0, 1)) text-anchor="end" { (number(t)) }
        }
        @for t in ticks(scale.from, scale.to, 12.0) {
            text.tick x=(fixed(scale.x(t), 1)) y=(HEIGHT - 6.0) text-anchor="middle" { (number(t)) " " (unit) }
        }
    }
}

/// Curves, climbs, spirals and motors behind a chart.
pub fn shades(track: &LapTrack, scale: &Scale) -> Markup {
    html! {
        @for part in track.parts.iter().filter(|part| part.kind != PartKind::Straight) {
            rect class=(part.kind.class()) x=(fixed(scale.x(part.from), 1)) y=(TOP)
                width=(fixed(scale.x(part.to) - scale.x(part.from), 1)) height=(HEIGHT - TOP - BELOW) {}
        }
        @for (from, to) in &track.motors {
            rect.motor x=(fixed(scale.x(*from), 1)) y=(HEIGHT - BELOW - 3.0)
                width=(fixed(scale.x(to.min(scale.to)) - scale.x(*from), 1)) height="3" {}
        }
    }
}

/// What the shades mean.
pub fn legend() -> Markup {
    html! {
        p.legend.note {
            span { i style="background: var(--curve)" {} "curve" }
            span { i style="background: var(--climb)" {} "ramp" }
            span { i style="background: var(--spiral)" {} "spiral" }
            span { i style="background: var(--motor)" {} "motor" }
            span { i style="background: var(--fill)" {} "least to largest value at the place" }
            span { i style="background: var(--trace)" {} "mean" }
        }
    }
}

/// A channel over arc length: least, largest and mean in each column.
pub fn along(track: &LapTrack, stations: &[f64], samples: &[f64]) -> Markup {
    let lap = track.line.length;
    let mut columns: Vec<Option<(f64, f64, f64, f64)>> = vec![None; COLUMNS];
    for (s, x) in stations.iter().zip(samples).filter(|(_, x)| x.is_finite()) {
        let column = ((s / lap * COLUMNS as f64) as usize).min(COLUMNS - 1);
        let (low, high, sum, count) = columns[column].get_or_insert((*x, *x, 0.0, 0.0));
        (*low, *high, *sum, *count) = (low.min(*x), high.max(*x), *sum + x, *count + 1.0);
    }
    let seen: Vec<(f64, f64, f64, f64)> = columns
        .iter()
        .enumerate()
        .filter_map(|(k, c)| c.map(|(low, high, sum, n)| ((k as f64 + 0.5) / COLUMNS as f64 * lap, low, high, sum / n)))
        .collect();
    let low = seen.iter().map(|c| c.1).fold(f64::INFINITY, f64::min);
    let high = seen.iter().map(|c| c.2).fold(f64::NEG_INFINITY, f64::max);
    if !(low.is_finite() && high.is_finite()) {
        return html! {};
    }
    let scale = Scale::new(0.0, lap, low, high);
    let point = |s: f64, y: f64| coordinates(scale.at(s, y));
    let there: Vec<String> = seen.iter().map(|c| point(c.0, c.2)).collect();
    let back: Vec<String> = seen.iter().rev().map(|c| point(c.0, c.1)).collect();
    let mean: Vec<String> = seen.iter().map(|c| point(c.0, c.3)).collect();
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
            (shades(track, &scale))
            (frame(&scale, "m"))
            path.fill d=(format!("M{}L{}Z", there.join("L"), back.join("L"))) {}
            path.trace d=(format!("M{}", mean.join("L"))) {}
        }
    }
}

/// A power spectral density as its root, on logarithmic axes.
pub fn spectrum(spectrum: &Spectrum, marks: &[(&str, f64, bool)]) -> Markup {
    let log = |x: f64| trig::log10(x);
    // Far below the largest is only noise of rounding.
    let largest = spectrum.points().skip(1).map(|p| p.1).fold(0.0, f64::max);
    let lines: Vec<(f64, f64)> = spectrum
        .points()
        .filter(|(f, p)| *f >= 0.2 && *f <= 120.0 && *p > 1e-12 * largest)
        .map(|(f, p)| (log(f), 0.5 * log(p)))
        .collect();
    let (Some(first), Some(last)) = (lines.first(), lines.last()) else { return html! {} };
    let low = lines.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let high = lines.iter().map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
    let scale = Scale::new(first.0, last.0, low, high);
    let path: Vec<String> = lines.iter().map(|&(x, y)| coordinates(scale.at(x, y))).collect();
    let decades = (scale.low.ceil() as i64..=scale.high.floor() as i64).map(|k| k as f64);
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
            @for t in decades {
                line.axis x1=(LEFT) x2=(WIDTH - 8.0) y1=(fixed(scale.y(t), 1)) y2=(fixed(scale.y(t), 1)) {}
                text.tick x=(LEFT - 6.0) y=(fixed(scale.y(t) + 4.0, 1)) text-anchor="end" {
                    (trimmed(trig::pow(10.0, t), 6))
                }
            }
            @for f in [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0] {
                @if log(f) > scale.from && log(f) < scale.to {
                    text.tick x=(fixed(scale.x(log(f)), 1)) y=(HEIGHT - 6.0) text-anchor="middle" {
                        (trimmed(f, 1)) " Hz"
                    }
                }
            }
            @for (name, f, passing) in marks {
                @if log(*f) > scale.from && log(*f) < scale.to {
                    line class=(if *passing { "mark" } else { "dotted" }) x1=(fixed(scale.x(log(*f)), 1))
                        x2=(fixed(scale.x(log(*f)), 1))
                        y1=(TOP + 10.0) y2=(HEIGHT - BELOW) {}
                    // To either side, as cart passing and a ring mode may lie near each other.
                    @let (side, anchor) = if *passing { (-3.0, "end") } else { (3.0, "start") };
                    text.tick x=(fixed(scale.x(log(*f)) + side, 1)) y=(TOP + 7.0) text-anchor=(anchor) { (name) }
                }
            }
            path.trace d=(format!("M{}", path.join("L"))) {}
        }
    }
}

/// An amplitude spectrum over orders, up to so many.
pub fn orders(spectrum: &Spectrum, most: f64) -> Markup {
    let lines: Vec<(f64, f64)> = spectrum.points().skip(1).take_while(|(order, _)| *order <= most).collect();
    let high = lines.iter().map(|p| p.1).fold(0.0, f64::max);
    if lines.len() < 2 || !high.is_finite() {
        return html! {};
    }
    let scale = Scale::new(0.0, most, 0.0, high);
    let path: Vec<String> = lines.iter().map(|&(x, y)| coordinates(scale.at(x, y))).collect();
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
            (frame(&scale, ""))
            path.trace d=(format!("M{}", path.join("L"))) {}
        }
    }
}

/// The envelope of the supports' loads as bars.
pub fn supports(track: &LapTrack, supports: &[SupportLoad], of: impl Fn(&SupportLoad) -> (f64, f64)) -> Markup {
    let low = supports.iter().map(|s| of(s).0).fold(0.0, f64::min);
    let high = supports.iter().map(|s| of(s).1).fold(0.0, f64::max);
    let scale = Scale::new(0.0, track.line.length, low, high);
    let width = (0.5 * (WIDTH - LEFT) / supports.len() as f64).clamp(1.0, 10.0);
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
            (shades(track, &scale))
            (frame(&scale, "m"))
            @for support in supports {
                @let (least, most) = of(support);
                rect.fill x=(fixed(scale.x(support.s) - width / 2.0, 1)) y=(fixed(scale.y(most), 1))
                    width=(fixed(width, 1))
                    height=(fixed((scale.y(least) - scale.y(most)).max(1.0), 1)) {}
            }
        }
    }
}
