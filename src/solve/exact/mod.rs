//! Stage 3 with a proof: branch and bound over turns on the angle step and radii on the catalogue's list.
//!
//! With headings chosen, length, closure and nearly every other row are linear in straights and radii, and sums over sections
//! and vertices. So the Lagrangian dual of a choice of open headings is a shortest path through them
//! ([`network`]); its best multipliers come from column generation ([`master`]); a search branches on headings, radii and on
//! the ways past regions ([`search`], [`beside`]); chains between fixed sections are searched apart ([`parts`]). Regions may be
//! relaxed in a bound, never in a layout: that meets every row of its [`Problem`].

mod beside;
mod grid;
mod master;
mod network;
mod parts;
mod row;
mod search;

pub use search::Effort;

use super::sqp::{Settings, Solution};
use super::stages::Discretised;
use super::{Certificate, Violation, discrete};
use crate::geometry::{Point, bounds, self_crossings};
use crate::model::Layout;
use crate::problem::Problem;
use beside::Beside;
use grid::{Grid, NoGrid};
use network::{Limits, Open};
use search::{FEASIBLE, Found, Setting};
use std::time::Instant;

/// The shortest layout on the catalogue's grid, from the saw-tooth's. What is found is proven, or says how far it may be from the
/// shortest.
pub fn discretise(
    layout: &Layout,
    problem: &Problem,
    start: &Solution,
    settings: &Settings,
    effort: &Effort,
) -> Discretised {
    let rough = discrete::discretise(layout, problem, start, settings);
    let clock = Instant::now();
    let polish = |x: &[f64]| {
        let held = discrete::hold(layout, problem, settings, x)?;
        sound(problem, &held.variables).then_some(held.variables)
    };
    let grid = match Grid::new(layout, problem, &rough.variables) {
        Ok(grid) => grid,
        Err(why) => return Discretised { refused: refusal(problem, &why), ..rough.into() },
    };
    let incumbent = (sound(problem, &rough.variables) && parts::place(&grid, &rough.variables).is_some())
        .then(|| (rough.variables.clone(), rough.length));
    let (found, assumed) = prove(layout, problem, &grid, incumbent, *effort, &polish);
    let Some(variables) = found.variables else { return rough.into() };
    let mut certificate = Certificate::new(found.length, found.bound, found.nodes, assumed);
    certificate.seconds = clock.elapsed().as_secs_f64();
    let at = problem.evaluate(&variables, 0.0);
    let solution = Solution {
        length: found.length,
        max_violation: at.rows.iter().map(|r| r.violation()).fold(0.0, f64::max),
        variables,
        iterations: rough.iterations,
        converged: rough.converged || certificate.proven,
        multipliers: rough.multipliers,
    };
    Discretised { solution, certificate: Some(certificate), refused: Vec::new() }
}

/// Whether a layout meets every row and does not cross itself.
fn sound(problem: &Problem, x: &[f64]) -> bool {
    let at = problem.evaluate(x, 0.0);
    at.rows.iter().all(|r| r.violation() <= FEASIBLE) && self_crossings(&at.track).is_empty()
}

fn refusal(problem: &Problem, why: &NoGrid) -> Vec<Violation> {
    match *why {
        NoGrid::Apart { first, other, off } => {
            let row = format!(
                "the headings of {} and {}, which no whole number of angle steps joins",
                problem.section_name(first),
                problem.section_name(other)
            );
            vec![Violation { row, span: problem.vertex_span(other), amount: off, unit: "rad" }]
        }
        NoGrid::Step | NoGrid::Empty => Vec::new(),
    }
}

/// Searches, and says what the bound takes for granted.
fn prove(
    layout: &Layout,
    problem: &Problem,
    grid: &Grid,
    incumbent: Option<(Vec<f64>, f64)>,
    effort: Effort,
    polish: &dyn Fn(&[f64]) -> Option<Vec<f64>>,
) -> (Found, Vec<String>) {
    let stated = row::state(problem, grid);
    let longest = incumbent.as_ref().map_or(10.0 * problem.evaluate(&problem.start, 0.0).length, |i| i.1);
    let straights = stated.straights.iter().map(|s| (s.0, s.1.min(longest).max(s.0))).collect();
    let first = match stated.fixed.first() {
        Some(&(0, p)) => (p, p),
        _ => surroundings(layout, longest),
    };
    let mut known = vec![search::track(&problem.start)];
    known.extend(incumbent.iter().map(|i| search::track(&i.0)));
    let open = Open { headings: grid.headings.clone(), radii: grid.radii.iter().map(|r| (0, r.len() - 1)).collect() };
    let setting = Setting {
        problem,
        grid,
        limits: Limits { straights, first },
        rows: stated.rows.clone(),
        beside: Beside { problem, grid, known },
        effort,
        open,
        coupled: None,
        fixed: stated.fixed.clone(),
        polish,
    };
    let mut assumed = vec!["turns go the way they are written, and as often around".to_owned()];
    if !problem.keepouts.is_empty() {
        assumed.push(
            "every straight and curve passes an obstacle on its side, but where another strand runs between them in the \
             written or the built layout"
                .to_owned(),
        );
    }
    let found = match incumbent {
        Some(incumbent) => parts::search(setting, &stated, incumbent, longest),
        None => search::search(&setting, None),
    };
    (found, assumed)
}

/// A box that holds the first vertex: no more than a whole track away from what is known.
fn surroundings(layout: &Layout, longest: f64) -> (Point, Point) {
    let (low, high) = match &layout.building {
        Some(building) => building.polygon.bounds(),
        None => bounds(layout.corners().iter().map(|c| c.point)),
    };
    let reach = Point::new(longest, longest);
    (low - reach, high + reach)
}
