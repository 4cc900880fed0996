//! Measured against simulated: a force's means along the track, with the repeatability about the simulated ones.

use crate::identify::goodness::{Goodness, Profile, Stretch};
use crate::report::plot::{Axis, Curve, Pictures, Plot, Rounded, Shade, middles};
use maud::{Markup, html};

/// Deviations of the repeatability that are drawn to either side: 95 % of replicate cells are within.
const DEVIATIONS: f64 = 2.0;

/// Height of a picture, px.
const HEIGHT: u32 = 140;

/// Rules of the style sheet for these pictures.
pub const RULES: &str = "
:root { --off: #f59e0b; } details > summary { cursor: pointer; margin: 8px 0; } \
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
            span { i style="background: var(--off); opacity: 0.4" {} "over three deviations off" }
        }
    }
}

/// One channel's picture of a run.
pub fn along(run: usize, channel: &str, profile: &Profile, goodness: &Goodness, pictures: &mut Pictures) -> Markup {
    let known = |values: &[Option<f64>]| values.iter().map(|x| x.unwrap_or(f64::NAN)).collect::<Vec<f64>>();
    if !profile.measured.iter().chain(&profile.simulated).any(Option::is_some) {
        return html! {};
    }
    let edge = |by: f64| -> Vec<f64> {
        let each = profile.simulated.iter().zip(&profile.deviation);
        each.map(|(x, d)| x.zip(*d).map_or(f64::NAN, |(x, d)| x + by * d)).collect()
    };
    let middles = Rounded::to(middles(goodness.lap_m, profile.simulated.len()), 2);
    let mut plot = Plot::new(format!("along-{run}-{channel}"), Axis::Track, "N", middles);
    plot.height = HEIGHT;
    plot.curves.push(Curve::band("repeatability", "fill", edge(-DEVIATIONS), edge(DEVIATIONS)));
    plot.curves.push(Curve::line("simulated", "trace", known(&profile.simulated)));
    plot.curves.push(Curve::line("measured", "ink", known(&profile.measured)));
    let off = goodness.stretches.iter().filter(|stretch| stretch.channel == channel && stretch.feature == "mean");
    plot.shades = off.flat_map(|stretch| shade(stretch, goodness.lap_m)).collect();
    html! {
        figure {
            figcaption { b { (channel) } ", N over m" }
            (pictures.add(plot))
        }
    }
}

/// A stretch that does not fit, which may go on at the start of the lap.
fn shade(stretch: &Stretch, lap: f64) -> Vec<Shade> {
    let to_mm = |x: f64| (1e3 * x).round() / 1e3;
    let part = |from: f64, to: f64| Shade { from: to_mm(from), to: to_mm(to), colour: "off".to_owned() };
    let first = part(stretch.from_m, stretch.to_m.min(lap));
    let rest = (stretch.to_m > lap).then(|| part(0.0, stretch.to_m - lap));
    std::iter::once(first).chain(rest).collect()
}
