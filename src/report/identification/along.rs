//! Measured against simulated: a force's means along the track, with the repeatability about the simulated ones.

use crate::base::number::{fixed, tick_labels, ticks};
use crate::identify::goodness::{Goodness, Profile, Stretch};
use maud::{Markup, html};

const WIDTH: f64 = 1100.0;
const HEIGHT: f64 = 130.0;
const LEFT: f64 = 60.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 6.0;
const BELOW: f64 = 20.0;

/// Deviations of the repeatability that are drawn to either side: 95 % of replicate cells are within.
const DEVIATIONS: f64 = 2.0;

/// Rules of the style sheet for these pictures.
pub const RULES: &str = "
.repeatability { fill: var(--fill); opacity: 0.6; } .simulated { fill: none; stroke: var(--trace); stroke-width: 1; }
.measured { fill: none; stroke: var(--ink); stroke-width: 1.4; } .off { fill: #f59e0b; opacity: 0.18; }
details > summary { cursor: pointer; margin: 8px 0; } \
.warning { border-left: 4px solid #c2410c; padding: 2px 0 2px 12px; margin: 12px 0; }
.warning p { margin: 4px 0; }
";

/// What the lines mean.
pub fn legend() -> Markup {
    html! {
        p.legend.note {
            span { i style="background: var(--ink)" {} "measured" }
            span { i style="background: var(--trace)" {} "simulated with the fitted values" }
            span { i style="background: var(--fill)" {} "two deviations of repeatability about it" }
            span { i style="background: #f59e0b; opacity: 0.4" {} "over three deviations off" }
        }
    }
}

/// Pixels of stations and values.
struct Scale {
    lap: f64,
    low: f64,
    high: f64,
}

impl Scale {
    fn new(profile: &Profile, lap: f64) -> Option<Scale> {
        let band = profile.simulated.iter().zip(&profile.deviation);
        let band =
            band.filter_map(|(x, d)| Some(((*x)?, (*d)?))).flat_map(|(x, d)| [x - DEVIATIONS * d, x + DEVIATIONS * d]);
        let all = band.chain(profile.measured.iter().copied().flatten());
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let room = (0.06 * (high - low)).max(1e-6 * high.abs().max(1e-6));
        (low <= high).then_some(Scale { lap, low: low - room, high: high + room })
    }

    fn x(&self, s: f64) -> String {
        fixed(LEFT + s / self.lap * (WIDTH - LEFT - RIGHT), 1)
    }

    fn y(&self, value: f64) -> String {
        fixed(TOP + (self.high - value) / (self.high - self.low) * (HEIGHT - TOP - BELOW), 1)
    }
}

/// Pieces of a line between cells that are missing, as paths of middles of cells.
fn pieces(values: &[Option<f64>]) -> Vec<Vec<(usize, f64)>> {
    let mut out: Vec<Vec<(usize, f64)>> = Vec::new();
    let mut open = false;
    for (i, value) in values.iter().enumerate() {
        if let Some(value) = value {
            if !open {
                out.push(Vec::new());
            }
            out.last_mut().into_iter().for_each(|piece| piece.push((i, *value)));
        }
        open = value.is_some();
    }
    out
}

/// One channel's picture.
pub fn along(channel: &str, profile: &Profile, goodness: &Goodness) -> Markup {
    let lap = goodness.lap_m;
    let Some(scale) = Scale::new(profile, lap) else { return html! {} };
    let cells = profile.simulated.len().max(1) as f64;
    let middle = |i: usize| (i as f64 + 0.5) * lap / cells;
    let path = |points: &mut dyn Iterator<Item = (usize, f64)>| {
        points.map(|(i, y)| format!("{},{}", scale.x(middle(i)), scale.y(y))).collect::<Vec<_>>().join(" ")
    };
    let shifted = |by: f64| {
        let each = profile.simulated.iter().zip(&profile.deviation);
        each.map(move |(x, d)| Some((*x)? + by * (*d)?)).collect::<Vec<_>>()
    };
    let (upper, lower) = (pieces(&shifted(DEVIATIONS)), pieces(&shifted(-DEVIATIONS)));
    let (across, along) = (ticks(scale.low, scale.high, 4.0), ticks(0.0, lap, 12.0));
    let off = goodness.stretches.iter().filter(|stretch| stretch.channel == channel && stretch.feature == "mean");
    html! {
        figure {
            figcaption { b { (channel) } ", N over m" }
            svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
                @for stretch in off { (shade(stretch, &scale)) }
                @for (t, label) in across.iter().zip(tick_labels(&across)) {
                    line.axis x1=(LEFT) x2=(WIDTH - RIGHT) y1=(scale.y(*t)) y2=(scale.y(*t)) {}
                    text.tick x=(LEFT - 6.0) y=(scale.y(*t)) dy="4" text-anchor="end" { (label) }
                }
                @for (t, label) in along.iter().zip(tick_labels(&along)) {
                    text.tick x=(scale.x(*t)) y=(HEIGHT - 5.0) text-anchor="middle" { (label) }
                }
                @for (above, below) in upper.iter().zip(&lower) {
                    polygon.repeatability
                        points=(path(&mut above.iter().copied().chain(below.iter().rev().copied()))) {}
                }
                @for piece in pieces(&profile.simulated) { polyline.simulated points=(path(&mut piece.into_iter())) {} }
                @for piece in pieces(&profile.measured) { polyline.measured points=(path(&mut piece.into_iter())) {} }
            }
        }
    }
}

/// A stretch that does not fit, which may go on at the start of the lap.
fn shade(stretch: &Stretch, scale: &Scale) -> Markup {
    let first = (stretch.from_m, stretch.to_m.min(scale.lap));
    let rest = (stretch.to_m > scale.lap).then_some((0.0, stretch.to_m - scale.lap));
    let width = |(from, to): (f64, f64)| fixed((to - from) / scale.lap * (WIDTH - LEFT - RIGHT), 1);
    html! {
        @for part in std::iter::once(first).chain(rest) {
            rect.off x=(scale.x(part.0)) width=(width(part)) y=(TOP) height=(HEIGHT - TOP - BELOW) {}
        }
    }
}
