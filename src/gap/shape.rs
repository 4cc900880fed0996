//! The shape that an effect gives a wheel, a rail or a thrust, with the band of its strengths.

use super::diagnosis::{Amount, Shape};
use super::ids::CandidateId;
use super::simulator::{Applied, Outline, Simulator};
use crate::base::number::tidy;
use std::collections::BTreeMap;

/// Of a candidate with fitted strengths; `None` where it gives nothing a shape.
pub fn shape(simulator: &dyn Simulator, candidate: CandidateId, strength: &BTreeMap<String, Amount>) -> Option<Shape> {
    let with = |of: fn(&Amount) -> f64, at: Option<&[f64]>| -> Option<Outline> {
        let strengths = simulator.candidates()[candidate].strengths.iter();
        let strengths = strengths.map(|s| strength.get(&s.name).map_or(0.0, of)).collect();
        simulator.outline(&Applied { candidate, strengths }, at)
    };
    let whole = with(|amount| amount.value, None)?;
    let at: Vec<f64> = whole.points.iter().map(|(at, _)| *at).collect();
    let ends = [with(|amount| amount.low, Some(&at)), with(|amount| amount.high, Some(&at))];
    // A strength of 0 has no shape, which is one of zeros.
    let at_end = |end: &Option<Outline>, k: usize| {
        end.as_ref().filter(|p| p.of == whole.of).and_then(|p| p.points.get(k)).map_or(0.0, |(_, y)| *y)
    };
    let values = |of: &dyn Fn(usize) -> f64| (0..whole.points.len()).map(|k| tidy(of(k))).collect();
    let edge = |pick: fn(f64, f64) -> f64| {
        values(&|k| pick(whole.points[k].1, pick(at_end(&ends[0], k), at_end(&ends[1], k))))
    };
    Some(Shape {
        of: whole.of.clone(),
        over: whole.over.to_owned(),
        unit: whole.unit.to_owned(),
        at: values(&|k| at[k]),
        value: values(&|k| whole.points[k].1),
        low: edge(f64::min),
        high: edge(f64::max),
    })
}
