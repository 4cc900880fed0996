use super::*;
use crate::geometry::Track;
use crate::model::instances::{horseshoe, thesis10};
use crate::model::{Layout, Target};
use crate::problem::measures::to_variables;
use crate::problem::{ConstraintRow, Scope, perturbed};
use crate::solve::{Discretise, Options, solve_with};

/// A problem with every linear measure of a layout held where it is, and the walls as near as they are.
fn tight(layout: &Layout, at: &[f64]) -> Problem {
    let mut problem = Problem::new(layout, Scope::Building);
    let track = Track::new(&crate::problem::measures::to_corners(at));
    let n = problem.vertices.len();
    let functions = (0..n).flat_map(|i| {
        let direction = Point::unit(0.3);
        [
            Function::Turn(i),
            Function::Section(i),
            Function::Straight(i),
            Function::Linear(vec![(x(i), 1.0), (radius(i), -2.0)]),
            Function::StraightMiddle { section: i, direction },
            Function::StraightEnd { section: i, end: false, direction },
            Function::StraightEnd { section: i, end: true, direction },
            Function::Formula(Formula::Sum(vec![
                Formula::Length(Target { from: i, straight: true }),
                Formula::Negative(Box::new(Formula::Angle(i))),
                Formula::Product(vec![Formula::Constant(2.0), Formula::Y(i)]),
            ])),
        ]
    });
    problem.rows = functions
        .map(|function| ConstraintRow {
            function,
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
            unit: crate::model::Unit::Metre,
            weight: None,
            label: String::new(),
            span: layout.span,
            reason: None,
        })
        .collect();
    problem.bounds.iter_mut().zip(at).for_each(|(b, v)| (b.low, b.high) = (b.low.min(*v), b.high.max(*v)));
    problem.rotations.clear();
    let values: Vec<f64> = problem.evaluate(at, 0.0).rows.iter().map(|r| r.expansion.value).collect();
    problem.rows.iter_mut().zip(values).for_each(|(row, value)| (row.low, row.high) = (value, value));
    for keepout in &mut problem.keepouts {
        let walls = &keepout.region.polygon;
        let points = (0..20_000).map(|k| track.at(track.length * f64::from(k) / 20_000.0).0);
        let near = |p: Point| walls.distance_to_outline(p) * if walls.contains(p) { 1.0 } else { -1.0 };
        // A sampled distance is too long by a sagitta of the widest arc, at most.
        keepout.distance = points.map(near).fold(f64::INFINITY, f64::min) - 1e-6;
    }
    problem
}

/// Headings of a layout, unwrapped, with room on both sides.
fn around(problem: &Problem, at: &[f64], room: f64) -> Headings {
    let track = Track::new(&crate::problem::measures::to_corners(at));
    let mut heading = track.straight(0).heading;
    let mut ranges = vec![(heading - 0.3 * room, heading + 0.7 * room)];
    for i in 1..problem.vertices.len() {
        heading += track.fillets[i].turn;
        let share = 0.1 * (i % 10) as f64;
        ranges.push((heading - share * room, heading + (1.0 - share) * room));
    }
    Headings { ranges }
}

/// What a layout meets with nothing to spare is refuted in no box that holds the layout.
#[test]
fn nothing_that_is_met_is_refuted() {
    let nothing: Discretise = |_, _, solution, _, _, _| solution.clone().into();
    for layout in [thesis10(), horseshoe()] {
        let stages = solve_with(&layout, &Options::default(), nothing, &|_| {});
        let walls = Problem::new(&layout, Scope::Building);
        let mut layouts: Vec<Vec<f64>> = stages.iter().map(|s| to_variables(&s.corners)).collect();
        layouts.extend((1..5).map(|seed| perturbed(&layout, &walls, 0.4, seed)));
        let mut tried = 0;
        for at in layouts {
            let problem = tight(&layout, &at);
            let straights = problem.rows.iter().filter(|row| matches!(row.function, Function::Straight(_)));
            // Where curves overlap there is no layout.
            if straights.map(|row| row.low).fold(f64::INFINITY, f64::min) < 0.0 {
                continue;
            }
            tried += 1;
            for room in [0.0, 1e-4, 0.02, 0.3, 1.5, 4.0] {
                let box_of = around(&problem, &at, room);
                assert!(!Loop::new(&problem).refuted(&box_of), "{} {room} {at:?}", layout.name);
            }
            assert!(!infeasible(&problem), "{} {at:?}", layout.name);
        }
        assert!(tried >= 2, "{tried}");
    }
}

#[test]
fn a_measure_that_is_out_of_reach_is_refuted() {
    let layout = thesis10();
    let mut problem =
        tight(&layout, &layout.corners().iter().flat_map(|c| [c.point.x, c.point.y, c.radius]).collect::<Vec<_>>());
    let at = problem.start.clone();
    let longer = problem.rows.iter_mut().find(|row| matches!(row.function, Function::Section(_))).unwrap();
    (longer.low, longer.high) = (longer.low + 0.1, longer.high + 0.1);
    assert!(Loop::new(&problem).refuted(&around(&problem, &at, 1e-4)));
}
