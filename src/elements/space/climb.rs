//! A climb: a vertical curve into the slope, the slope, and a vertical curve out of it.
//!
//! With radius R and slope angle α, the two curves rise 2R(1 − cos α) over 2R sin α of plan.

use super::{Leg, flat};
use crate::base::trig;
use crate::elements::Shape;
use crate::geometry::Form;

/// What a climb is to do: lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Climb {
    /// Signed.
    pub rise: f64,
    /// Of the vertical curves.
    pub radius: f64,
    /// Rise over run, unsigned; `None`: what ends the climb where the last straight ends.
    pub slope: Option<f64>,
    /// From the begin of the first straight; `None`: centred on a single straight, at the begin of a run.
    pub from: Option<f64>,
}

/// Why a climb does not fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Misfit {
    /// By so much, m.
    TooLong(f64),
    /// A vertical curve would reach into a horizontal one: so much of a straight is missing at its begin or end, m.
    IntoCurve(f64),
    /// It fits only at a slope beyond the catalogue's.
    TooSteep { used: f64, steepest: f64 },
}

/// Plan that a climb takes at a slope, and that of one of its vertical curves, m. A rise too small for the slope is
/// climbed by curves alone, with less of it.
pub fn plan(rise: f64, radius: f64, slope: f64) -> (f64, f64) {
    let slope = slope.min(only_curves(rise.abs(), radius));
    let (sin, cos) = trig::sin_cos(trig::atan(slope));
    let straight_rise = (rise.abs() - 2.0 * radius * (1.0 - cos)).max(0.0);
    (2.0 * radius * sin + straight_rise / slope, radius * sin)
}

/// The run of a plan, from a straight to a straight, as it climbs. Returns its legs and the slope.
pub fn climb(run: &[(usize, Shape)], climb: &Climb) -> Result<(Vec<Leg>, f64), Misfit> {
    let whole: f64 = run.iter().map(|(_, shape)| shape.length()).sum();
    let (size, radius) = (climb.rise.abs(), climb.radius);
    let ends = |k: Option<&(usize, Shape)>| k.map_or(0.0, |(_, shape)| shape.length());
    let (first, last) = (ends(run.first()), ends(run.last()));
    let slope = match climb.slope {
        Some(slope) => slope.min(only_curves(size, radius)),
        None => fitting(size, radius, whole - climb.from.unwrap_or(0.0)).ok_or(Misfit::TooLong(0.0))?,
    };
    let slope = filling(climb, whole, slope).unwrap_or(slope);
    let (plan, curve) = plan(size, radius, slope);
    let from = climb.from.unwrap_or(if run.len() == 1 { ((whole - plan) / 2.0).max(0.0) } else { 0.0 });
    let to = from + plan;
    if to > whole + NEAR {
        return Err(Misfit::TooLong(to - whole));
    }
    // The curve in lies on the first straight, the curve out on the last.
    let (into, out) = (from + curve, to - curve);
    if run.len() > 1 && into > first + NEAR {
        return Err(Misfit::IntoCurve(into - first));
    }
    if run.len() > 1 && out < whole - last - NEAR {
        return Err(Misfit::IntoCurve(whole - last - out));
    }
    let signed = slope * climb.rise.signum();
    let mut legs = Vec::new();
    let mut begin = 0.0;
    for (vertex, shape) in run {
        let end = begin + shape.length();
        match *shape {
            Shape::Straight { .. } => {
                let part = |from: f64, to: f64, slope: f64| {
                    let length = (to - from) / trig::cos(trig::atan(slope));
                    (length > NEAR).then_some(Form::Straight { length, slope })
                };
                let curve_in = Form::Vertical { radius, slope_from: 0.0, slope_to: signed };
                let curve_out = Form::Vertical { radius, slope_from: signed, slope_to: 0.0 };
                let forms = [
                    part(begin.min(from), end.min(from), 0.0),
                    (begin <= from && from < end).then_some(curve_in),
                    part(begin.clamp(into, out.max(into)), end.clamp(into, out.max(into)), signed),
                    (begin < to && to <= end + NEAR).then_some(curve_out),
                    part(begin.max(to), end.max(to), 0.0),
                ];
                legs.extend(forms.into_iter().flatten().map(|form| Leg { vertex: *vertex, curve: false, form }));
            }
            Shape::Curve { radius, turn } if begin >= into - NEAR && end <= out + NEAR => {
                let rise = radius * turn.abs() * signed;
                legs.push(Leg { vertex: *vertex, curve: true, form: Form::Spiral { radius, turn, rise } });
            }
            Shape::Curve { .. } => legs.push(flat(*vertex, *shape)),
        }
        begin = end;
    }
    Ok((legs, slope))
}

/// Lengths below this are none, m.
const NEAR: f64 = 1e-9;
/// A straight that is shorter is not cut, m: a climb leaves it where the plan has just the room that the climb takes.
const UNCUT: f64 = 1e-4;

/// The slope with which a climb takes all of its run, where it would leave less than can be cut. One of curves alone has no
/// slope to take it up.
fn filling(climb: &Climb, whole: f64, slope: f64) -> Option<f64> {
    let (size, room) = (climb.rise.abs(), whole - climb.from.unwrap_or(0.0));
    let left = room - plan(size, climb.radius, slope).0;
    let fills = left > NEAR && left < UNCUT && slope < only_curves(size, climb.radius) - UNCUT;
    fills.then(|| fitting(size, climb.radius, room)).flatten()
}

/// The slope of a climb that is nothing but its two vertical curves: 2R(1 − cos α) is the rise.
fn only_curves(size: f64, radius: f64) -> f64 {
    let cos = 1.0 - size / (2.0 * radius);
    if cos <= 0.0 { f64::INFINITY } else { trig::tan(trig::acos(cos)) }
}

/// The slope of a climb over so much plan, by bisection: its rise grows with the slope until it is nothing but curves.
fn fitting(size: f64, radius: f64, plan: f64) -> Option<f64> {
    let rise = |slope: f64| {
        let (sin, cos) = trig::sin_cos(trig::atan(slope));
        2.0 * radius * (1.0 - cos) + (plan - 2.0 * radius * sin) * slope
    };
    // Steeper than this, the curves alone would be longer than the plan.
    let most = (plan / (2.0 * radius)).min(0.9);
    let (mut low, mut high) = (0.0, trig::tan(trig::asin(most)));
    if rise(high) < size {
        return None;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if rise(middle) < size { low = middle } else { high = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_climb_leaves_no_straight_that_nobody_can_cut() {
        let (rise, radius, slope) = (0.6, 6.0, 0.2);
        let (room, _) = plan(rise, radius, slope);
        for (left, from, pieces) in
            [(0.0, None, 3), (1e-5, None, 3), (9e-5, Some(1.0), 4), (0.01, None, 5), (0.01, Some(1.0), 5)]
        {
            let length = room + left + from.unwrap_or(0.0);
            let run = [(0, Shape::Straight { length, cut: true })];
            let (legs, used) = climb(&run, &Climb { rise, radius, slope: Some(slope), from }).expect("it fits");
            assert_eq!(legs.len(), pieces, "{left}, {from:?}: {legs:?}");
            assert!((used - slope).abs() < 1e-4 && used <= slope, "{used}");
            // What is drawn of it: the plan as long as before, and the rise.
            let of = |leg: &Leg| match leg.form {
                Form::Straight { length, slope } => {
                    let (sin, cos) = trig::sin_cos(trig::atan(slope));
                    [length * cos, length * sin]
                }
                Form::Vertical { radius, slope_from, slope_to } => {
                    let angle = trig::atan(slope_to) - trig::atan(slope_from);
                    let chord = 2.0 * radius * trig::sin_cos(angle.abs() / 2.0).0;
                    let (sin, cos) = trig::sin_cos((trig::atan(slope_to) + trig::atan(slope_from)) / 2.0);
                    [chord * cos, chord * sin]
                }
                ref other => panic!("{other:?}"),
            };
            let [plan, height] = legs.iter().map(of).fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
            assert!((plan - length).abs() < 1e-9 && (height - rise).abs() < 1e-9, "{plan} of {length}, {height}");
        }
    }
}
