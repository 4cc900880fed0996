//! The shape that a named effect gives a wheel, a rail or a thrust, with its band.

use super::words::heading;
use crate::gap::{Finding, Shape};
use crate::report::plot::{Axis, Curve, Pictures, Plot, Rounded};
use maud::{Markup, html};

/// Of each effect that has one.
pub fn shapes(named: &[&Finding], pictures: &mut Pictures) -> Markup {
    html! {
        @for (k, (finding, shape)) in named.iter().filter_map(|f| Some((f, f.shape.as_ref()?))).enumerate() {
            figure {
                figcaption {
                    b { (heading(&finding.name)) } ": the shape that was found — " (shape.of) ", " (scale(shape).1) "; the band is that of the \
                    strengths' 90 % intervals"
                }
                (chart(shape, k, pictures))
            }
        }
    }
}

/// The unit that a shape is drawn in, and how many of it are one of its own.
fn scale(shape: &Shape) -> (f64, &'static str) {
    if shape.unit.is_empty() {
        return (100.0, "%");
    }
    let most = shape.value.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    if most < 1e-3 { (1e6, "µm") } else { (1e3, "mm") }
}

/// Nothing where no number can be drawn.
fn chart(shape: &Shape, number: usize, pictures: &mut Pictures) -> Markup {
    let ends = |of: &[f64]| {
        of.iter().filter(|x| x.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)))
    };
    // Degrees around a wheel.
    let (factor, unit) = if shape.over == "rad" { (1f64.to_degrees(), "°") } else { (1.0, "m") };
    let (from, to) = ends(&shape.at);
    let (low, high) = (ends(&shape.low).0, ends(&shape.high).1);
    if !(from < to && low < high) {
        return html! {};
    }
    let own = scale(shape).0;
    let x = shape.at.iter().map(|x| factor * x).collect();
    let of = |values: &[f64]| values.iter().map(|y| own * y).collect::<Vec<f64>>();
    let mut drawn = Plot::new(format!("shape-{number}"), Axis::Own, scale(shape).1, Rounded::new(x));
    drawn.x_unit = unit.to_owned();
    drawn.curves.push(Curve::band("90 % interval", "quiet", of(&shape.low), of(&shape.high)));
    drawn.curves.push(Curve::line("found", "trace", of(&shape.value)));
    pictures.add(drawn)
}
