//! Every kind of row against central differences, on the reference instance moved off its written place.

use super::{Evaluation, Problem, RowKey, Scope, measures};
use crate::geometry::Point;
use crate::model::instances::{horseshoe, thesis10};
use crate::model::{Constraint, ConstraintKind, FixKind, Formula, Layout, Target, TrackSection, Unit, fixture::span};

/// thesis10 with a row of every kind.
fn every_row() -> Layout {
    let mut layout = thesis10();
    let target = Target { from: 8, straight: true };
    let all = vec![FixKind::Length, FixKind::Rotation, FixKind::Parallel, FixKind::Perpendicular];
    let section = Target { from: 5, straight: false };
    let mut kinds: Vec<ConstraintKind> = vec![ConstraintKind::FixSection { target, kinds: all.clone() }];
    kinds.extend(all.iter().map(|k| ConstraintKind::FixSection { target: section, kinds: vec![*k] }));
    kinds.push(ConstraintKind::Holds { section: 3, part: Box::new(part()) });
    let formulas = [
        Formula::Sum(vec![Formula::X(0), Formula::Negative(Box::new(Formula::Y(3)))]),
        Formula::Product(vec![Formula::Radius(2), Formula::Angle(3), Formula::Length(target)]),
        Formula::Heading(4),
        Formula::Reciprocal(Box::new(Formula::DistanceVertices(0, 6))),
        Formula::SquareRoot(Box::new(Formula::DistanceObstacle(0, 0))),
        Formula::DistanceObstacle(4, 2),
        Formula::DistanceBuilding(9),
        Formula::Absolute(Box::new(Formula::Angle(6))),
        Formula::Smallest(vec![Formula::Length(section), Formula::Radius(1)]),
        Formula::Largest(vec![Formula::Length(section), Formula::Radius(1)]),
    ];
    kinds.extend(formulas.into_iter().map(|formula| ConstraintKind::Require {
        formula,
        low: 1.0,
        high: f64::INFINITY,
        unit: Unit::Metre,
    }));
    layout.constraints = kinds.into_iter().map(|kind| Constraint { kind, span: span(), reason: None }).collect();
    layout
}

/// A part of the track that slides along an oblique line.
fn part() -> TrackSection {
    let (from, to) = (Point::new(1.0, 2.0), Point::new(9.0, 5.0));
    let (name, length) = ("part".to_owned(), Some(3.0));
    TrackSection { name, from, to, length, either_way: false, from_span: span(), to_span: span(), span: span() }
}

#[test]
fn gradients_and_hessians_are_exact() {
    for (layout, expect_own) in [(every_row(), 0), (horseshoe(), 2)] {
        compare(&layout, expect_own);
    }
}

/// The same by lifted variables, and off the manifold where sections end at their vertices.
#[test]
fn lifted_gradients_and_hessians_are_exact() {
    for (layout, expect_own) in [(every_row(), 0), (horseshoe(), 2)] {
        let plain = Problem::new(&layout, Scope::Obstacles);
        let lifted = plain.lift();
        compare_at(&lifted, expect_own, |seed| {
            let mut x = measures::lift(&crate::problem::perturbed(&layout, &plain, 0.4, seed));
            let n = plain.vertices.len();
            (0..n).for_each(|i| x[measures::lifted(n, i)[(seed + i as u64) as usize % 2]] += 0.03 * (i % 5) as f64);
            x
        });
    }
}

/// Where sections end at their vertices, every row and the objective have the value they have without lifting.
#[test]
fn lifting_changes_no_value() {
    let layout = every_row();
    let problem = Problem::new(&layout, Scope::Obstacles);
    let x = crate::problem::perturbed(&layout, &problem, 0.4, 7);
    let (plain, lifted) = (problem.evaluate(&x, 60.0), problem.lift().evaluate(&measures::lift(&x), 60.0));
    assert!((plain.value() - lifted.value()).abs() < 1e-9);
    let (gaps, others): (Vec<_>, Vec<_>) = lifted.rows.iter().partition(|r| matches!(r.key, RowKey::Gap(..)));
    assert_eq!((gaps.len(), others.len()), (2 * problem.vertices.len(), plain.rows.len()));
    assert!(gaps.iter().all(|gap| gap.violation() < 1e-9));
    for (row, other) in plain.rows.iter().zip(others) {
        let name = problem.describe(row.key).0;
        assert!(row.key == other.key && (row.expansion.value - other.expansion.value).abs() < 1e-9, "{name}");
    }
}

fn compare(layout: &Layout, expect_own: usize) {
    let problem = Problem::new(layout, Scope::Obstacles);
    compare_at(&problem, expect_own, |seed| crate::problem::perturbed(layout, &problem, 0.4, seed));
}

fn compare_at(problem: &Problem, expect_own: usize, at: impl Fn(u64) -> Vec<f64>) {
    let mut own_rows = 0;
    for seed in 1..=5 {
        let x = at(seed);
        let here = problem.evaluate(&x, 60.0);
        let own = here.rows.iter().filter(|r| matches!(r.key, RowKey::Own(..))).count();
        assert!(here.rows.len() - own > problem.rows.len() + 2);
        own_rows += own;
        let step = 1e-5;
        let moved = |k: usize, by: f64| {
            let mut y = x.clone();
            y[k] += by;
            problem.evaluate_like(&y, &here)
        };
        for k in 0..x.len() {
            let (up, down) = (moved(k, step), moved(k, -step));
            for (r, row) in here.rows.iter().enumerate() {
                let e = |at: &Evaluation| at.rows[r].expansion.clone();
                let name = problem.describe(row.key).0;
                check(&name, k, &row.expansion, &e(&up), &e(&down), step);
            }
            for (t, term) in here.objective.iter().enumerate() {
                check("length", k, term, &up.objective[t], &down.objective[t], step);
            }
        }
    }
    assert!(own_rows >= expect_own, "{own_rows}");
}

fn check(name: &str, k: usize, e: &super::Expansion, up: &super::Expansion, down: &super::Expansion, step: f64) {
    let place = |e: &super::Expansion| e.variables.binary_search(&k).ok();
    let gradient = place(e).map_or(0.0, |i| e.gradient[i]);
    let difference = (up.value - down.value) / (2.0 * step);
    assert!((gradient - difference).abs() < 1e-6 * (1.0 + gradient.abs()), "{name} d{k}: {gradient} {difference}");
    // A row that slid to a neighbouring part between the two sides has other variables there.
    if up.variables != e.variables || down.variables != e.variables {
        return;
    }
    if let Some(i) = place(e) {
        let n = e.variables.len();
        for j in 0..n {
            let exact = e.hessian[i * n + j];
            let difference = (up.gradient[j] - down.gradient[j]) / (2.0 * step);
            assert!((exact - difference).abs() < 1e-5 * (1.0 + exact.abs()), "{name} d{k}d{j}: {exact} {difference}");
        }
    }
}
