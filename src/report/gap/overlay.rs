//! A channel over a stretch: measured, simulated before and after, their difference, and how far repeated measurements
//! stray.

use super::words::{band, percent, scale_of, stretch};
use crate::gap::{Axis, Overlay};
use crate::report::plot::{self, Curve, Pictures, Plot, Rounded};
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
/// number can be drawn. `share` is the channel's share of the gap, `number` that of the picture.
pub fn chart(overlay: &Overlay, axis: Axis, share: Option<f64>, number: usize, pictures: &mut Pictures) -> Markup {
    let (from, to) = bounds(&overlay.at);
    let less = |simulated: &[f64]| overlay.measured.iter().zip(simulated).map(|(m, s)| m - s).collect::<Vec<f64>>();
    let zero = vec![0.0; overlay.at.len()];
    let (low, _) = bounds(&[overlay.before.as_slice(), &overlay.after].concat());
    if !(from < to && low.is_finite()) {
        return html! {};
    }
    let placed = overlay.band == "track" || overlay.band == "fluctuation";
    let draw = |id: &str, measured: Option<&Vec<f64>>, middle: &[f64], before: Vec<f64>, after: Vec<f64>| {
        let along = match axis {
            Axis::Track if placed => plot::Axis::Track,
            Axis::Time if placed => plot::Axis::Time,
            _ => plot::Axis::Own,
        };
        let unit = if overlay.unit.is_empty() { String::new() } else { scale_of(&overlay.band, &overlay.unit) };
        let mut drawn = Plot::new(format!("{id}-{number}"), along, unit, Rounded::new(overlay.at.clone()));
        let edge = |sign: f64| -> Vec<f64> {
            middle.iter().zip(&overlay.repeatability).map(|(m, f)| m + sign * BAND * f).collect()
        };
        drawn.curves.push(Curve::band("repeatability", "quiet", edge(-1.0), edge(1.0)));
        drawn.curves.extend(measured.map(|m| Curve::line("measured", "ink", m.clone())));
        let name = if changed(overlay) { "before" } else { "simulated" };
        drawn.curves.push(Curve::line(name, "gap", before).dashed());
        if changed(overlay) {
            drawn.curves.push(Curve::line("with the effect", "trace", after));
        }
        drawn
    };
    let both =
        draw("overlay", Some(&overlay.measured), &overlay.measured, overlay.before.clone(), overlay.after.clone());
    let difference = draw("difference", None, &zero, less(&overlay.before), less(&overlay.after));
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
            (pictures.add(both))
            p.note.difference { "measured less simulated" }
            (pictures.add(difference))
        }
    }
}

fn bounds(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().filter(|x| x.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let mut pictures = Pictures::default();
        assert_eq!(chart(&nothing, Axis::Track, None, 0, &mut pictures).into_string(), "");
        assert!(pictures.data.plots.is_empty());
    }
}
