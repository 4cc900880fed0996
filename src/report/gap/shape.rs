//! The shape that a named effect gives a wheel or a rail, with its band.

use super::words::heading;
use crate::gap::{Finding, Shape};
use crate::report::lap::chart::{HEIGHT, Scale, WIDTH, coordinates, frame};
use maud::{Markup, html};

/// Of each effect that has one.
pub fn shapes(named: &[&Finding]) -> Markup {
    html! {
        @for (finding, shape) in named.iter().filter_map(|f| Some((f, f.shape.as_ref()?))) {
            figure {
                figcaption {
                    b { (heading(&finding.name)) } ": the shape that was found — " (shape.of) ", " (scale(shape).1) "; the band is that of the \
                    strengths' 90 % intervals"
                }
                (chart(shape))
            }
        }
    }
}

/// Units a metre that a shape is drawn in.
fn scale(shape: &Shape) -> (f64, &'static str) {
    let most = shape.value_m.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    if most < 1e-3 { (1e6, "µm") } else { (1e3, "mm") }
}

/// Nothing where no number can be drawn.
fn chart(shape: &Shape) -> Markup {
    let ends = |of: &[f64]| {
        of.iter().filter(|x| x.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)))
    };
    // Degrees around a wheel.
    let (factor, unit) = if shape.over == "rad" { (1f64.to_degrees(), "°") } else { (1.0, "m") };
    let (from, to) = ends(&shape.at);
    let (low, high) = (ends(&shape.low_m).0, ends(&shape.high_m).1);
    if !(from < to && low < high) {
        return html! {};
    }
    let a_metre = scale(shape).0;
    let scale = Scale::new(factor * from, factor * to, a_metre * low.min(0.0), a_metre * high.max(0.0));
    let points = |values: &[f64]| -> Vec<String> {
        shape.at.iter().zip(values).map(|(x, y)| coordinates(scale.at(factor * x, a_metre * y))).collect()
    };
    let around: Vec<String> = points(&shape.low_m).into_iter().chain(points(&shape.high_m).into_iter().rev()).collect();
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
            (frame(&scale, unit))
            path.repeatability d=(format!("M{}Z", around.join("L"))) {}
            path.after d=(format!("M{}", points(&shape.value_m).join("L"))) {}
        }
    }
}
