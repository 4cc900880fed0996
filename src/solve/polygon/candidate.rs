//! A layout with held turns, searched and solved.

use super::base::Base;
use super::polytope::Polytope;
use super::price::Price;
use super::search::{Merit, search};
use super::{Effort, Smooth};
use crate::geometry::Track;
use crate::kinematics::polygon::{Course, CurvePhasor, action, curve_phasor};
use crate::problem::measures::to_corners;
use crate::problem::{Aim, Problem, Wave, Waves};
use crate::solve::budget::ROUNDING;
use crate::solve::sqp::{self, Solution, SqpSettings};
use crate::solve::worth;

/// Places of a search that are solved exactly.
pub const POLISHED: usize = 4;
/// Iterations of each.
const ITERATIONS: usize = 60;
/// Cheaper lengths of a straight that are tried.
const NEAREST: usize = 2;

/// A solved layout.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// On the problem's own rows; its length is the track's.
    pub solution: Solution,
    /// The goal, of ΔP itself; infinite where rows are violated.
    pub merit: f64,
}

impl Candidate {
    /// The layout at these variables as it is.
    pub fn at(base: &Base, problem: &Problem, goal: Smooth, solution: Solution) -> Self {
        Candidate::judged(base, problem, goal, solution, SqpSettings::default().feasibility)
    }

    /// The same with another tolerance of rows, m or rad.
    pub fn judged(base: &Base, problem: &Problem, goal: Smooth, solution: Solution, tolerance: f64) -> Self {
        let pitch = base.layout.cart.length;
        let track = Track::new(&to_corners(&solution.variables));
        let price = if goal.weighs_cost() { worth(&base.layout, &track, 0.0) } else { 0.0 };
        let within = base.limit.is_none_or(|limit| price <= limit * (1.0 + ROUNDING));
        let feasible = solution.max_violation <= tolerance && within && price.is_finite();
        let value = Course::of_track(&track).and_then(|course| action(&course, pitch)).map(|a| a.value(goal.counted));
        let merit = match value {
            Ok(value) if feasible => goal.action * 1e6 * value + goal.length * track.length + goal.cost * price,
            _ => f64::INFINITY,
        };
        let length = problem.evaluate(&solution.variables, 0.0).length;
        Candidate { solution: Solution { length, ..solution }, merit }
    }
}

/// The waves of the curves of a layout.
pub fn waves(variables: &[f64], goal: Smooth, pitch: f64) -> Option<Waves> {
    let course = Course::of_track(&Track::new(&to_corners(variables))).ok()?;
    let n = course.len();
    let curves: Vec<CurvePhasor> = (0..n).map(|k| curve_phasor(&course, k, pitch).ok()).collect::<Option<_>>()?;
    let wave = |(k, curve): (usize, &CurvePhasor)| Wave {
        harmonics: [curve.first, curve.higher[0], curve.higher[1]].map(|h| h * 1e3),
        length: course.curves[k].length() + curve.mean,
    };
    let mut waves = Waves {
        pitch,
        curves: curves.iter().enumerate().map(wave).collect(),
        counts: (1..=n).map(|m| goal.counted.counts(m, n)).collect(),
        worth: goal.action,
        length: goal.length,
    };
    // The solver prices violations in metres: what phases left to chance would cost is one.
    let chance = 1e6 * crate::kinematics::polygon::by_chance(&curves, goal.counted);
    let scale = 1.0 / (goal.action * chance).max(1e-12);
    waves.worth *= scale;
    waves.length *= scale;
    Some(waves)
}

/// The best layout with these turns that a search from `from` finds; `from` meets the rows of `held`.
pub fn best(
    base: &Base,
    held: &Problem,
    goal: Smooth,
    from: &[f64],
    polished: usize,
    effort: &mut Effort,
) -> Option<Candidate> {
    let pitch = base.layout.cart.length;
    let waves = waves(from, goal, pitch)?;
    let price = Price::new(base, goal, &waves, &Track::new(&to_corners(from)));
    let polytope = Polytope::new(held, from, base.reach);
    effort.choices += 1;
    let (found, phases) = search(&polytope, Merit { waves: &waves, price: price.as_ref() }, effort.choices as u64);
    effort.phases += phases;
    let mut polish = polish(base, held, goal, (waves, price.as_ref()), effort);
    let mut seen: Vec<Vec<f64>> = Vec::new();
    let mut best: Option<Candidate> = None;
    for place in found {
        if seen.len() >= polished {
            break;
        }
        let straights = polytope.straights(&place.z).as_slice().to_vec();
        let near = |other: &Vec<f64>| other.iter().zip(&straights).all(|(a, b)| (a - b).abs() < 0.02 * pitch);
        if seen.iter().any(near) {
            continue;
        }
        let mut candidate = polish(&polytope.variables(&place.z), &straights);
        if let Some(price) = price.as_ref().filter(|_| goal.cost > 0.0) {
            candidate = cheaper(candidate, price, base.reach, &mut polish);
        }
        seen.push(straights);
        if best.as_ref().is_none_or(|b| candidate.merit < b.merit) {
            best = Some(candidate);
        }
    }
    best
}

/// A layout near this one that meets the rows of `held`.
pub fn polished(base: &Base, held: &Problem, goal: Smooth, from: &[f64], effort: &mut Effort) -> Option<Candidate> {
    let waves = waves(from, goal, base.layout.cart.length)?;
    let track = Track::new(&to_corners(from));
    let price = Price::new(base, goal, &waves, &track);
    let straights: Vec<f64> = (0..track.fillets.len()).map(|k| track.straight(k).length).collect();
    Some(polish(base, held, goal, (waves, price.as_ref()), effort)(from, &straights))
}

/// Solves exactly from variables, with the pieces that straights of these lengths have.
fn polish<'a>(
    base: &'a Base,
    held: &'a Problem,
    goal: Smooth,
    (waves, price): (Waves, Option<&'a Price>),
    effort: &'a mut Effort,
) -> impl FnMut(&[f64], &[f64]) -> Candidate + 'a {
    let aim = Waves { length: waves.length + price.map_or(0.0, Price::slope), ..waves };
    let settings = SqpSettings {
        radius: 0.1,
        largest_radius: 0.3,
        iterations: ITERATIONS,
        dearest: 2e3,
        ..SqpSettings::default()
    };
    move |start, straights| {
        let mut problem = held.clone();
        problem.aim = Aim::Waves(aim.clone());
        if let Some(price) = price {
            price.hold(&mut problem, straights);
        }
        let solution = sqp::minimise(&problem, start, &settings, &|_, _, _| {});
        effort.iterations += solution.iterations;
        Candidate::at(base, held, goal, Solution::at(held, &solution.variables))
    }
}

/// One straight after another is given the nearest length whose pieces are cheaper, where that is better in all.
fn cheaper(
    mut candidate: Candidate,
    price: &Price,
    reach: f64,
    polish: &mut impl FnMut(&[f64], &[f64]) -> Candidate,
) -> Candidate {
    let straights = |candidate: &Candidate| -> Vec<f64> {
        let track = Track::new(&to_corners(&candidate.solution.variables));
        (0..track.fillets.len()).map(|k| track.straight(k).length).collect()
    };
    for k in 0..straights(&candidate).len() {
        let now = straights(&candidate);
        for length in price.cheaper(now[k], reach).into_iter().take(NEAREST) {
            let mut wanted = now.clone();
            wanted[k] = length;
            let other = polish(&candidate.solution.variables, &wanted);
            if other.merit < candidate.merit {
                candidate = other;
                break;
            }
        }
    }
    candidate
}
