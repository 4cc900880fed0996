//! The discrete stage without building and obstacles as a mixed-integer linear problem, in free MPS.
//!
//! With headings on the grid, a layout's only nonlinear terms are products with a choice. Each is linear in columns
//! that stand for the choice itself:
//!
//! - `heading[S][h]` is 1 where section S has the heading h; `length[S][h]` is its length then, else 0, so the
//!   section's vector is Σ length·(cos h, sin h) (disaggregation: Balas 1985);
//! - `curve[P][t][r]` is 1 where vertex P turns by t with the radius r: its tangent length R tan(t/2) and its arc R t
//!   are numbers;
//! - `bend[P][h][t][r]` is 1 where besides the section before P has the heading h: a flow from heading to heading along
//!   the loop, which ties curves to headings and takes its tangent lengths of both sections.
//!
//! Building, obstacles and the track's own width are left out, so the optimum is a lower bound of stage 3.

mod grid;
mod linear;
mod rows;

use super::Problem;
use super::measures::{x, y};
use crate::base::number::trimmed;
use crate::base::trig;
use crate::model::Layout;
use grid::Grid;
use linear::{Milp, Sum};

/// Writes the file. No section is longer than a track of the length `longest` (m) could have it.
pub fn write(layout: &Layout, problem: &Problem, longest: f64) -> String {
    let grid = Grid::new(layout, problem);
    let mut writer = Writer::new(problem, &grid, layout.catalog.straight.shortest);
    writer.sections(longest);
    writer.vertices();
    writer.close_the_loop();
    let left_out = writer.user_rows();
    writer.milp.notes = notes(problem, &grid, longest, &left_out);
    writer.milp.mps()
}

/// The columns of a vertex.
#[derive(Clone, Debug, Default)]
struct AtVertex {
    x: usize,
    y: usize,
    /// Turn in its written direction (steps), radius (m), column.
    curves: Vec<(i64, f64, usize)>,
}

struct Writer<'a> {
    problem: &'a Problem,
    grid: &'a Grid,
    /// Shortest straight between two curves, m.
    shortest: f64,
    milp: Milp,
    vertices: Vec<AtVertex>,
    /// Of each section: heading in steps, column of its choice, column of its length.
    sections: Vec<Vec<(i64, usize, usize)>>,
}

impl<'a> Writer<'a> {
    fn new(problem: &'a Problem, grid: &'a Grid, shortest: f64) -> Self {
        let milp = Milp { name: problem.layout.clone(), ..Milp::default() };
        let mut writer = Writer { problem, grid, shortest, milp, vertices: Vec::new(), sections: Vec::new() };
        for i in 0..problem.signs.len() {
            let mut coordinate = |k: usize, letter: &str| {
                let bound = problem.bounds[k];
                writer.milp.column(format!("{letter}[{}]", problem.vertices[i]), bound.low, bound.high, false)
            };
            let (x, y) = (coordinate(x(i), "x"), coordinate(y(i), "y"));
            writer.vertices.push(AtVertex { x, y, curves: Vec::new() });
        }
        writer
    }

    fn next(&self, i: usize) -> usize {
        (i + 1) % self.vertices.len()
    }

    fn before(&self, i: usize) -> usize {
        (i + self.vertices.len() - 1) % self.vertices.len()
    }

    /// Heading and length of each section, and where it leads.
    fn sections(&mut self, longest: f64) {
        let widest = self.grid.radii.iter().flatten().copied().fold(0.0, f64::max);
        // A chord of a closed track is no longer than half of it; the tangent lengths at both ends come on top.
        let longest = longest / 2.0 + 2.0 * widest * trig::tan(self.grid.turns.1 as f64 * self.grid.step / 2.0);
        for i in 0..self.vertices.len() {
            let name = self.problem.section_name(i);
            let (first, last) = self.grid.headings[i];
            let mut choices = Vec::new();
            for h in first..=last {
                let choice = self.milp.column(format!("heading[{name}][{h}]"), 0.0, 1.0, true);
                choices.push((h, choice, 0));
            }
            for (h, choice, length) in &mut choices {
                *length = self.milp.column(format!("length[{name}][{h}]"), 0.0, f64::INFINITY, false);
                self.milp.objective.insert(*length, 1.0);
                let terms = Sum::from([(*length, 1.0), (*choice, -longest)]);
                self.milp.row(format!("only_if_chosen[{name}][{h}]"), terms, f64::NEG_INFINITY, 0.0);
            }
            let one = choices.iter().map(|&(_, choice, _)| (choice, 1.0)).collect();
            self.milp.row(format!("one_heading[{name}]"), one, 1.0, 1.0);
            let (from, to) = (&self.vertices[i], &self.vertices[self.next(i)]);
            for (letter, from, to, of) in
                [("x", from.x, to.x, trig::cos as fn(f64) -> f64), ("y", from.y, to.y, trig::sin as fn(f64) -> f64)]
            {
                let mut terms: Sum = choices.iter().map(|&(h, _, l)| (l, of(self.grid.heading(h)))).collect();
                terms.insert(from, 1.0);
                terms.insert(to, -1.0);
                self.milp.row(format!("leads_{letter}[{name}]"), terms, 0.0, 0.0);
            }
            self.sections.push(choices);
        }
    }

    /// Turn and radius of each vertex.
    fn vertices(&mut self) {
        for i in 0..self.vertices.len() {
            let name = &self.problem.vertices[i];
            for t in self.grid.turns.0..=self.grid.turns.1 {
                let turn = t as f64 * self.grid.step;
                for &r in &self.grid.radii[i] {
                    let column = self.milp.column(format!("curve[{name}][{t}][{}]", trimmed(r, 6)), 0.0, 1.0, true);
                    self.milp.objective.insert(column, r * (turn - 2.0 * trig::tan(turn / 2.0)));
                    self.vertices[i].curves.push((t, r, column));
                }
            }
        }
    }

    /// Flows from heading to heading, through the curves between, and the room that the curves take of a section.
    fn close_the_loop(&mut self) {
        let tangent = |turn: f64, r: f64| r * trig::tan(turn / 2.0);
        let mut taken: Vec<Vec<Sum>> = self.sections.iter().map(|choices| vec![Sum::new(); choices.len()]).collect();
        for i in 0..self.vertices.len() {
            let (name, before) = (&self.problem.vertices[i], self.before(i));
            let (sign, unwound) = (self.problem.signs[i] as i64, self.grid.unwound(i));
            let ends = |section: &[(i64, usize, usize)]| -> Vec<Sum> {
                section.iter().map(|&(_, choice, _)| Sum::from([(choice, -1.0)])).collect()
            };
            let (mut out, mut into) = (ends(&self.sections[before]), ends(&self.sections[i]));
            let (first_out, first_in) = (self.grid.headings[before].0, self.grid.headings[i].0);
            for (c, &(t, r, chosen)) in self.vertices[i].curves.iter().enumerate() {
                let turn = t as f64 * self.grid.step;
                let mut curved = Sum::from([(chosen, -1.0)]);
                for (k, out) in out.iter_mut().enumerate() {
                    let h = first_out + k as i64;
                    let target = usize::try_from(h + sign * t - unwound - first_in).ok();
                    let Some((j, into)) = target.and_then(|j| Some((j, into.get_mut(j)?))) else { continue };
                    let flow = self.milp.column(format!("bend[{name}][{h}][{t}][{}]", trimmed(r, 6)), 0.0, 1.0, false);
                    out.insert(flow, 1.0);
                    into.insert(flow, 1.0);
                    curved.insert(flow, 1.0);
                    taken[before][k].insert(flow, -tangent(turn, r));
                    taken[i][j].insert(flow, -tangent(turn, r));
                }
                self.milp.row(format!("curves[{name}][{c}]"), curved, 0.0, 0.0);
            }
            for (k, sum) in out.into_iter().enumerate() {
                self.milp.row(format!("leaves[{name}][{}]", first_out + k as i64), sum, 0.0, 0.0);
            }
            for (k, sum) in into.into_iter().enumerate() {
                self.milp.row(format!("enters[{name}][{}]", first_in + k as i64), sum, 0.0, 0.0);
            }
        }
        for (i, taken) in taken.into_iter().enumerate() {
            let name = self.problem.section_name(i);
            for (mut sum, &(h, choice, length)) in taken.into_iter().zip(&self.sections[i]) {
                sum.insert(length, 1.0);
                sum.insert(choice, -self.shortest);
                self.milp.row(format!("straight[{name}][{h}]"), sum, 0.0, f64::INFINITY);
            }
        }
    }
}

/// What the file is, and what it leaves out.
fn notes(problem: &Problem, grid: &Grid, longest: f64, left_out: &[String]) -> Vec<String> {
    let degrees = |angle: f64| trimmed(angle * 180.0 / trig::PI, 9);
    let anchor = problem.section_name(grid.anchor);
    let mut notes = vec![
        format!("Shortest track of {} on the catalogue's grid, without building, obstacles and the", problem.layout),
        "track's own width: its optimum is a lower bound of the layout with them. Lengths in m.".to_owned(),
        format!(
            "Headings count steps of {} deg from the heading of {anchor}, {} deg,",
            degrees(grid.step),
            degrees(grid.origin)
        ),
        match grid.fixed {
            true => "which the layout fixes.".to_owned(),
            false => "which is assumed to stay as written: nothing in the layout fixes the rotation.".to_owned(),
        },
        format!(
            "No section is longer than a track of {} m can have it, and none turns by more than",
            trimmed(longest, 6)
        ),
        "180 deg from its written heading.".to_owned(),
    ];
    for &i in &grid.off {
        notes.push(format!(
            "The fixed heading of {} is not on this grid: the nearest is taken.",
            problem.section_name(i)
        ));
    }
    notes.extend(left_out.iter().map(|row| format!("Not in this file, as it is not linear: {row}")));
    notes
}
