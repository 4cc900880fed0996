//! Polygon action: what a chain of straight carts on a curved centre line does to its own speed (thesis §3.4).
//!
//! An open chain is laid from a straight backwards through every curve. While its first joint moves evenly by one cart,
//! the joints behind a curve lead and lag, because chords cut corners by a little more or less as the cart's place on
//! the curve changes. On a straight every joint deviates alike, so that one number says how rough it runs there: ΔP,
//! peak to peak.
//!
//! Curves are in series. What one adds to the next depends on their phase, the length between them modulo the cart, and
//! two equal curves half a cart apart cancel. A layout of n straights thus has n² values, one for each straight seen
//! from each starting straight; [`PolygonObjective`] says which of them count.
//!
//! - [`Course`]: the centre line as straights and curves in turn,
//! - [`action`]: ΔP of each straight from each start, by Newton's method on the chords,
//! - [`Phasor`]s: the first harmonic of each curve, smooth where the peak is not; [`superposed`] adds them up,
//! - [`gradient`]: exact derivatives with respect to the vertices.

mod chain;
mod course;
mod derivative;
mod harmonic;
#[cfg(test)]
mod tests;

pub use course::{Bend, Course, Unsuited};
pub use derivative::{Gradient, gradient};
pub use harmonic::{CurvePhasor, Phasor, curve_phasor, superposed};

use chain::Unrolled;
use serde::{Deserialize, Serialize};

/// Steps in which the first joint moves over one cart.
pub const STEPS: usize = 64;

/// Which values of ΔP count: the three of thesis §3.4.2, each a sum of squares.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, clap::ValueEnum, Hash,
)]
#[serde(rename_all = "snake_case")]
#[clap(rename_all = "snake_case")]
pub enum PolygonObjective {
    /// Every straight from every start.
    #[default]
    All,
    /// The straights behind the first three curves from each start.
    FirstThree,
    /// The last cart: the starting straight itself, when every curve lies between.
    Last,
}

impl PolygonObjective {
    /// The three, in the thesis' order.
    pub const EACH: [PolygonObjective; 3] =
        [PolygonObjective::All, PolygonObjective::FirstThree, PolygonObjective::Last];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            PolygonObjective::All => "all",
            PolygonObjective::FirstThree => "first_three",
            PolygonObjective::Last => "last",
        }
    }

    /// Whether the straight behind `passed` of `curves` curves counts.
    pub fn counts(self, passed: usize, curves: usize) -> bool {
        match self {
            PolygonObjective::All => true,
            PolygonObjective::FirstThree => passed <= 3,
            PolygonObjective::Last => passed == curves,
        }
    }
}

/// The polygon action of a course.
#[derive(Clone, Debug, PartialEq)]
pub struct Action {
    /// ΔP in m: of the straight (second index) when the chain starts on another (first index). The chain runs
    /// backwards: from straight i it comes to i − 1 first, and to i itself last, behind every curve.
    pub delta_p: Vec<Vec<f64>>,
    /// First harmonic of the same deviations, m: amplitude and phase over the first joint's way from the begin of its
    /// straight.
    pub first: Vec<Vec<Phasor>>,
}

impl Action {
    /// Sum of the squares of what counts, m².
    pub fn value(&self, objective: PolygonObjective) -> f64 {
        sum(&self.delta_p, objective, |x| x * x)
    }

    /// The same of the first harmonic, as the peak to peak 2|H| of each, m².
    pub fn smooth(&self, objective: PolygonObjective) -> f64 {
        sum(&self.first, objective, |h| 4.0 * h.norm_sqr())
    }
}

/// Σ over what counts of a matrix by starting straight and straight.
fn sum<T>(matrix: &[Vec<T>], objective: PolygonObjective, of: impl Fn(&T) -> f64) -> f64 {
    let n = matrix.len();
    let row = |(i, row): (usize, &Vec<T>)| -> f64 {
        row.iter().enumerate().filter(|(j, _)| objective.counts(passed(i, *j, n), n)).map(|(_, x)| of(x)).sum()
    };
    matrix.iter().enumerate().map(row).sum()
}

/// Curves between starting straight `i` and straight `j` of `n`, 1 to n.
pub fn passed(i: usize, j: usize, n: usize) -> usize {
    (i + n - j - 1) % n + 1
}

/// The straight that the chain comes to behind `passed` curves from straight `i` of `n`.
pub fn straight_behind(i: usize, passed: usize, n: usize) -> usize {
    (i + n - passed % n) % n
}

/// ΔP of every straight from every start, carts of length `pitch`, m.
///
/// # Errors
/// [`Unsuited::TooTight`] where a cart does not fit a curve.
pub fn action(course: &Course, pitch: f64) -> Result<Action, Unsuited> {
    course.takes(pitch)?;
    let n = course.len();
    let mut delta_p = vec![vec![0.0; n]; n];
    let mut first = vec![vec![Phasor::default(); n]; n];
    for i in 0..n {
        let deviations = deviations(&Unrolled::new(course, i, n), pitch)?;
        for (m, series) in deviations.iter().enumerate() {
            let j = straight_behind(i, m + 1, n);
            let (low, high) = series.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
            delta_p[i][j] = high - low;
            first[i][j] = harmonic::first(series);
        }
    }
    Ok(Action { delta_p, first })
}

/// Deviation of a joint behind each curve, m, at each step of the first joint.
fn deviations(unrolled: &Unrolled, pitch: f64) -> Result<Vec<[f64; STEPS]>, Unsuited> {
    let mut all = vec![[0.0; STEPS]; unrolled.straights.len()];
    for step in 0..STEPS {
        let ride = unrolled.ride(pitch, front(step, pitch))?;
        for (series, landing) in all.iter_mut().zip(&ride.landings) {
            series[step] = landing.deviation;
        }
    }
    Ok(all)
}

/// Distance of the first joint from the begin of its straight at a step, m.
fn front(step: usize, pitch: f64) -> f64 {
    pitch * step as f64 / STEPS as f64
}

/// What an objective would be if the phases of curves were left to chance: each value then the sum of squares of the
/// curves passed, m².
pub fn by_chance(curves: &[CurvePhasor], objective: PolygonObjective) -> f64 {
    let n = curves.len();
    let from = |i: usize| -> f64 {
        let mut sum = 0.0;
        (1..=n)
            .map(|m| {
                let alone = curves[straight_behind(i, m, n)].delta_p;
                sum += alone * alone;
                if objective.counts(m, n) { sum } else { 0.0 }
            })
            .sum()
    };
    (0..n).map(from).sum()
}
