//! What every layout is worth at least that can be moved from a given one without passing over an obstacle: from the
//! length of such loops ([`homotopy`]).
//!
//! Where price counts, straights cost the least that a metre can. What a curve costs more than as many metres of straight
//! hangs on its turn and radius alone, and all turns together are the loop's winding: a price λ for each step of turn
//! leaves the sum over vertices of the least of each (Lagrange), for the best λ.

use super::grid::{Grid, track};
use super::sections::known;
use super::tariff::{Aim, Detail, Tariff, unit, worth};
use crate::model::Layout;
use crate::problem::Problem;
use crate::solve::Effort;
use crate::solve::homotopy::{self, CLASS, CLASS_WITH_SECTIONS, Held, Place};

/// Narrowings of the range of λ, each by a third.
const NARROWINGS: usize = 60;
/// What rounding can have added, as a share.
const ROUNDING: f64 = 1e-12;

/// A bound of a layout's class, m or EUR, and what that class is. None where nothing holds such loops up.
pub fn of_class(layout: &Layout, problem: &Problem, x: &[f64]) -> Option<(f64, &'static str)> {
    let radii = (0..problem.vertices.len()).flat_map(|i| problem.radii(layout, i));
    let smallest = radii.fold(f64::INFINITY, f64::min);
    let track = track(x);
    let all = known(layout, problem, x);
    let fixed: Vec<Held> = all.iter().filter(|held| matches!(held.place, Place::Known(_))).cloned().collect();
    let mut choices = vec![(Vec::new(), CLASS), (fixed, CLASS_WITH_SECTIONS), (all, CLASS_WITH_SECTIONS)];
    choices.dedup_by_key(|(sections, _)| sections.len());
    let bound = |(sections, class): &(Vec<Held>, &'static str)| {
        Some((homotopy::shortest(problem, &track, smallest, sections)?, *class))
    };
    // The widest class of those that are alike.
    let best = choices.iter().filter_map(bound).reduce(|best, next| if next.0 > best.0 { next } else { best });
    let (length, class) = best?;
    Some((at_length(layout, problem, x, length)?, class))
}

/// Whether a layout is so near the best of its class that none needs to be looked for.
pub fn suffices(layout: &Layout, problem: &Problem, x: &[f64], effort: &Effort) -> bool {
    if !effort.class || effort.gap <= 0.0 {
        return false;
    }
    let value = match Aim::of(layout) {
        Aim::Length => track(x).length,
        Aim::Price { metre } => worth(layout, &track(x), metre),
    };
    of_class(layout, problem, x).is_some_and(|(bound, _)| value - bound <= effort.gap * value)
}

/// A bound for all layouts that are at least so long, m, and turn around as `x` does.
fn at_length(layout: &Layout, problem: &Problem, x: &[f64], length: f64) -> Option<f64> {
    let aim = Aim::of(layout);
    let Aim::Price { metre } = aim else { return Some(length) };
    let grid = Grid::new(layout, problem, x, 0.0).ok().filter(|_| layout.is_flat())?;
    let straights = vec![(0.0, length); grid.len()];
    let tariff = Tariff::prices(layout, problem, &grid, (metre, Detail::Envelope), &straights);
    let metre = tariff.straight.iter().copied().fold(f64::INFINITY, f64::min);
    let winding = f64::from(grid.headings[grid.len()][0] - grid.headings[0][0]);
    let vertex = |k: usize, price: f64| {
        let (fewest, most) = grid.turns[k];
        let choice = |steps: i32, radius: f64| {
            let more = (tariff.arc[k] - metre) * radius * grid.turn(steps).0 + tariff.turn(k, steps);
            more - price * f64::from(grid.signs[k] * steps)
        };
        let of_radius = |radius: f64| (fewest..=most).map(move |steps| (steps, radius));
        let choices = grid.radii[k].iter().copied().flat_map(of_radius);
        choices.map(|(steps, radius)| choice(steps, radius)).fold(f64::INFINITY, f64::min)
    };
    let curves = |price: f64| (0..grid.len()).map(|k| vertex(k, price)).sum::<f64>() + price * winding;
    // Concave in λ; beyond what all curves cost together it falls.
    let reach = curves(0.0).abs() + metre * length;
    let (mut low, mut high) = (-reach, reach);
    for _ in 0..NARROWINGS {
        let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if curves(a) < curves(b) { low = a } else { high = b }
    }
    let best = curves(0.0).max(curves(0.5 * (low + high)));
    Some((metre * length + best) * unit(layout, aim) * (1.0 - ROUNDING))
}
