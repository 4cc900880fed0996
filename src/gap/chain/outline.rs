//! What shape an effect gives wheels, rails and the motors' thrust, read from what it does to the chain.

use super::Chains;
use crate::base::trig;
use crate::chain_input::{Deviations, Simulation, closed};
use crate::effects::deviations_of;
use crate::gap::simulator::{Applied, Outline};

/// Points around a wheel, and over a pitch of a motor's poles.
const AROUND: usize = 72;

/// Points along a rail at most, and the length that is shown of a shape which goes all around the lap, m.
const ALONG: usize = 200;
const SHOWN: f64 = 10.0;

impl Chains {
    /// The first wheel, rail or thrust that an effect changes; `None` where it changes none.
    pub(super) fn outline_of(&self, applied: &Applied, at: Option<&[f64]>) -> Option<Outline> {
        let id = self.runs.ids().next()?;
        let run = &self.runs[id];
        // Without what the layout itself has.
        let alone = Simulation { effects: vec![self.effect(applied, id)], ..run.model.simulation.clone() };
        let deviations = deviations_of(&alone).ok()?.1;
        wheel(&deviations, at)
            .or_else(|| rail(&deviations, run.model.spec.places.lap, at))
            .or_else(|| thrust(&deviations, at))
    }
}

/// The radius beside the nominal one over a turn.
fn wheel(deviations: &Deviations, at: Option<&[f64]>) -> Option<Outline> {
    let worn = deviations.worn.iter().find(|worn| worn.radius.iter().any(|x| *x != 0.0))?;
    let around = || (0..=AROUND).map(|k| trig::TAU * k as f64 / AROUND as f64).collect();
    let points = at.map_or_else(around, <[f64]>::to_vec).into_iter();
    let points = points.map(|angle| (angle, closed(&worn.radius, angle / trig::TAU).0)).collect();
    Some(Outline { of: format!("{}, radius", worn.wheel.name()), over: "rad", unit: "m", points })
}

/// Where a rail is beside the centre line's, over the stretch on which it is off.
fn rail(deviations: &Deviations, lap: f64, at: Option<&[f64]>) -> Option<Outline> {
    let names = ["steering rails, to the left", "left rail, upwards", "right rail, upwards"];
    let off = |table: &Vec<f64>| table.iter().any(|x| *x != 0.0);
    let (name, table) = names.into_iter().zip(&deviations.rails).find(|(_, table)| off(table))?;
    let places = at.map_or_else(|| stretch(table, lap), |at| Some(at.to_vec()))?;
    let points = places.into_iter().map(|at| (at, closed(table, at / lap).0)).collect();
    Some(Outline { of: name.to_owned(), over: "m", unit: "m", points })
}

/// What the motors' thrust has more, over its mean, over a pitch of their poles.
fn thrust(deviations: &Deviations, at: Option<&[f64]>) -> Option<Outline> {
    let ripple = &deviations.ripple;
    if ripple.is_none() {
        return None;
    }
    let along = || (0..=AROUND).map(|k| ripple.wavelength * k as f64 / AROUND as f64).collect();
    let places = at.map_or_else(along, <[f64]>::to_vec).into_iter();
    // Features are powers, which no phase changes.
    let of =
        "thrust of a motor beside its mean, over a pitch; phases of harmonics are not known and drawn as 0".to_owned();
    Some(Outline { of, over: "m", unit: "", points: places.map(|at| (at, ripple.at(at))).collect() })
}

/// Places of the stretch on which a table is off.
fn stretch(table: &[f64], lap: f64) -> Option<Vec<f64>> {
    let n = table.len();
    // From behind the longest stretch that is not off, so that one over the lap's begin stays whole.
    let some: Vec<usize> = (0..n).filter(|k| table[*k] != 0.0).collect();
    let gap = |k: usize| (some[(k + 1) % some.len()] + n - some[k] - 1) % n + 1;
    let widest = (0..some.len()).max_by_key(|k| gap(*k))?;
    let (first, last) = (some[(widest + 1) % some.len()], some[widest]);
    let count = (last + n - first) % n + 1;
    let length = (count + 1) as f64 * lap / n as f64;
    let around = 2 * count > n;
    let begin = if around { 0.0 } else { (first as f64 - 1.0) * lap / n as f64 };
    let length = if around { SHOWN.min(lap) } else { length };
    let points = ALONG.min(count + 2).max(2);
    Some((0..points).map(|k| begin + length * k as f64 / (points - 1) as f64).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain_input::{Every, Ripple, WheelPlace, WornWheel};

    #[test]
    fn a_wheel_is_shown_over_a_turn_and_a_rail_where_it_is_off() {
        let table =
            |from: usize, to: usize| (0..1000).map(|k| if (from..to).contains(&k) { 1e-3 } else { 0.0 }).collect();
        let flat = Deviations {
            worn: vec![WornWheel {
                wheel: WheelPlace::SteeringLeft,
                radius: vec![0.0, -1e-4, 0.0, 0.0],
                carts: Every::default(),
            }],
            ..Deviations::default()
        };
        let found = wheel(&flat, None).expect("a wheel");
        assert_eq!(
            (found.of.as_str(), found.over, found.points.len()),
            ("left steering wheel, radius", "rad", AROUND + 1)
        );
        assert!((found.points[AROUND / 4].1 + 1e-4).abs() < 1e-12);
        let step = Deviations { rails: [Vec::new(), table(300, 340), Vec::new()], ..Deviations::default() };
        let found = rail(&step, 50.0, None).expect("a rail");
        let ends = (found.points[0].0, found.points[found.points.len() - 1].0);
        assert!((ends.0 - 14.95).abs() < 0.06 && (ends.1 - 17.0).abs() < 0.06, "{ends:?}");
        // Another one at the same places.
        let places: Vec<f64> = found.points.iter().map(|(at, _)| *at).collect();
        let wider = Deviations { rails: [Vec::new(), table(260, 380), Vec::new()], ..Deviations::default() };
        let wider = rail(&wider, 50.0, Some(&places)).expect("a rail");
        assert!(wider.points.iter().zip(&places).all(|((at, y), other)| at == other && (y - 1e-3).abs() < 1e-9));
        // Over the begin of the lap.
        let mut over = table(0, 20);
        table(980, 1000).iter().zip(&mut over).for_each(|(x, y): (&f64, &mut f64)| *y += x);
        let found = rail(&Deviations { rails: [over, Vec::new(), Vec::new()], ..Deviations::default() }, 50.0, None)
            .expect("a rail");
        assert!((found.points[0].0 - 48.95).abs() < 0.06, "{:?}", found.points[0]);
        assert_eq!(rail(&Deviations::default(), 50.0, None), None);
    }

    #[test]
    fn a_thrust_is_shown_over_a_pitch_as_a_share() {
        let ripple = Ripple { ratios: [0.1, 0.0, 0.02], wavelength: 0.4, ..Ripple::default() };
        let found = thrust(&Deviations { ripple, ..Deviations::default() }, None).expect("a thrust");
        assert_eq!((found.over, found.unit, found.points.len()), ("m", "", AROUND + 1));
        let (at, most) = found.points[AROUND / 4];
        // Both crests, the third harmonic's upside down.
        assert!((at - 0.1).abs() < 1e-12 && (most - 0.08).abs() < 1e-12, "{at} {most}");
        assert_eq!(thrust(&Deviations::default(), None), None);
    }
}
