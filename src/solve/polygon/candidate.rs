//! A layout with held turns, searched and solved.

use super::base::Base;
use super::polytope::Polytope;
use super::search::search;
use super::{Effort, Smooth};
use crate::geometry::Track;
use crate::kinematics::polygon::{Course, CurvePhasor, action, curve_phasor};
use crate::problem::measures::to_corners;
use crate::problem::{Aim, Problem, Wave, Waves};
use crate::solve::sqp::{self, Solution, SqpSettings};

/// Places of a search that are solved exactly.
pub const POLISHED: usize = 4;
/// Iterations of each.
const ITERATIONS: usize = 60;

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
    pub fn at(problem: &Problem, goal: Smooth, pitch: f64, solution: Solution) -> Self {
        Candidate::judged(problem, goal, pitch, solution, SqpSettings::default().feasibility)
    }

    /// The same with another tolerance of rows, m or rad.
    pub fn judged(problem: &Problem, goal: Smooth, pitch: f64, solution: Solution, tolerance: f64) -> Self {
        let track = Track::new(&to_corners(&solution.variables));
        let feasible = solution.max_violation <= tolerance;
        let value = Course::of_track(&track).and_then(|course| action(&course, pitch)).map(|a| a.value(goal.counted));
        let merit = match value {
            Ok(value) if feasible => goal.action * 1e6 * value + goal.length * track.length,
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
    let polytope = Polytope::new(held, from, base.reach);
    effort.choices += 1;
    let (found, phases) = search(&polytope, &waves, effort.choices as u64);
    effort.phases += phases;
    let mut problem = held.clone();
    problem.aim = Aim::Waves(waves.clone());
    let settings = SqpSettings {
        radius: 0.1,
        largest_radius: 0.3,
        iterations: ITERATIONS,
        dearest: 2e3,
        ..SqpSettings::default()
    };
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
        seen.push(straights);
        let solution = sqp::minimise(&problem, &polytope.variables(&place.z), &settings, &|_, _, _| {});
        effort.iterations += solution.iterations;
        let candidate = Candidate::at(held, goal, pitch, solution);
        if best.as_ref().is_none_or(|b| candidate.merit < b.merit) {
            best = Some(candidate);
        }
    }
    best
}
