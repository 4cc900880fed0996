//! Searches against what a layout had before, brute force, and the rows that must hold.

use super::*;
use crate::base::random::uniform;
use crate::geometry::{CentreLine, Corner, Form, Point, Polygon, Track};
use crate::kinematics::polygon::{Course, PolygonObjective, action, curve_phasor};
use crate::kinematics::{fit, level};
use crate::model::instances::thesis10;
use crate::model::{Constraint, ConstraintKind, Formula, Goal, Objective, Obstacle, Side, Target, Unit, fixture};
use crate::problem::measures::to_variables;
use crate::solve::solve;
use crate::source::{FileId, Span};

fn quiet(_: Progress) {}

/// Radii written in the source.
fn written(mut layout: Layout) -> Layout {
    layout.vertices.iter_mut().for_each(|v| v.radius.span = Span::new(FileId(0), 1, 2));
    layout
}

fn smooth(mut layout: Layout, within: Option<f64>) -> Layout {
    layout.objective.terms = vec![(1.0, Goal::PolygonAction)];
    layout.objective.within = within.map(|ratio| (Goal::Length, ratio));
    written(layout)
}

fn value(corners: &[Corner], pitch: f64) -> f64 {
    let course = Course::of_track(&Track::new(corners)).expect("a course");
    1e6 * action(&course, pitch).expect("a chain").value(PolygonObjective::All)
}

#[test]
fn thesis10_runs_evenly_within_a_budget() {
    let layout = smooth(thesis10(), Some(0.005));
    let stages = solve(&layout, &Options::default(), &quiet);
    let [first, .., base, last] = stages.as_slice() else { panic!("{stages:?}") };
    assert_eq!((first.name, base.name, last.name), ("stage1", "stage3", "polygon"));
    assert!(last.max_violation <= 1e-6, "{:?}", last.violations);
    assert!(last.length <= base.length * 1.005 + 1e-6);
    let (before, after) = (value(&base.corners, 1.25), value(&last.corners, 1.25));
    println!("{before} -> {after}, {} m -> {} m", base.length, last.length);
    assert!(after < 0.3 * before, "{before} {after}");
    for (corner, vertex) in last.corners.iter().zip(&layout.vertices) {
        assert_eq!(corner.radius, vertex.radius.value);
    }
    // On the grid, with every constraint of the source.
    let problem = Problem::new(&layout, Scope::Obstacles);
    let x = to_variables(&last.corners);
    assert!(super::super::violations::off_grid(&layout, &problem, &x, 1e-6).is_empty());
    let at = problem.evaluate(&x, 0.0);
    assert!(at.rows.iter().all(|r| r.violation() <= 1e-6));
}

#[test]
fn alone_it_stays_near_what_is_written() {
    let layout = smooth(fixture::rectangle(30.0, 20.0, 4.0), None);
    let stages = solve(&layout, &Options::default(), &quiet);
    let last = stages.last().expect("a stage");
    assert_eq!((stages[0].name, stages[0].status, last.name), ("written", Status::AsWritten, "polygon"));
    assert!(last.max_violation <= 1e-6, "{:?}", last.violations);
    let (before, after) = (value(&stages[0].corners, 1.25), value(&last.corners, 1.25));
    assert!(after < 0.8 * before, "{before} {after}");
    for (a, b) in last.corners.iter().zip(&stages[0].corners) {
        assert!((a.point.x - b.point.x).abs() <= 1.25 + 1e-9 && (a.point.y - b.point.y).abs() <= 1.25 + 1e-9);
    }
    assert!(last.length <= 1.01 * stages[0].length + 1e-6);
}

/// The corners of what is found, whose chain closes to a width, m, with its joints on the track.
fn closes(mut layout: Layout, within: f64) -> Vec<Corner> {
    layout.chain.closes_within = Some(crate::source::Spanned::new(within, fixture::span()));
    let stages = solve(&layout, &Options::default(), &quiet);
    let last = stages.last().expect("a stage");
    assert!(last.max_violation <= 1e-6, "{:?}", last.violations);
    let fit = fit(&level(&Track::new(&last.corners)), layout.cart.length).expect("a chain");
    assert!(fit.is_within(within), "{fit:?}");
    last.corners.clone()
}

/// The chain closes as the source asks.
#[test]
fn closing_is_a_constraint() {
    let corners = closes(smooth(fixture::rectangle(30.0, 20.3, 4.0), None), 0.005);
    // Curves far from each other cut off what the series says.
    let excess = 4.0 * (crate::base::trig::FRAC_PI_2 * 1.5625 / 96.0 - 1.953125 / 1920.0);
    let carts = (Track::new(&corners).length - excess) / 1.25;
    assert!((carts - carts.round()).abs() * 1.25 <= 0.005 + 1e-6, "{carts}");
}

/// Also where curves near each other cut off more or less than each alone: within a width that this exceeds.
#[test]
fn a_chain_closes_on_curves_near_each_other() {
    let mut layout = smooth(thesis10(), None);
    layout.objective.terms.push((1.0, Goal::Cost));
    layout.objective.terms[0].0 = 20.0;
    closes(layout, 0.001);
}

/// On a layout with two degrees of freedom, a fine grid over all of it finds nothing better.
#[test]
fn the_search_finds_the_best_of_a_fine_grid() {
    let layout = smooth(fixture::rectangle(30.0, 20.0, 4.0), None);
    let problem = Problem::new(&layout, Scope::Obstacles);
    let goal = Smooth::of(&layout.objective).expect("a goal");
    let (_, base) = base::base(&layout, goal, &Options::default(), |_, _, s, _, _, _| s.clone().into(), &quiet);
    let base = base.expect("a base");
    let held =
        base.problem(&Problem::new(&base.layout, Scope::Obstacles), &base.turns(&base.variables), &base.variables);
    let waves = candidate::waves(&base.variables, goal, 1.25).expect("waves");
    let polytope = polytope::Polytope::new(&held, &base.variables, base.reach);
    let found = &search::search(&polytope, search::Merit { waves: &waves, price: None }, 1).0[0];
    let straights = waves_at(&waves, polytope.straights(&found.z).as_slice());
    let track = Track::new(&crate::problem::measures::to_corners(&problem.start));
    let limit = track.length * 1.01;
    let mut best = f64::INFINITY;
    for i in -250..=250 {
        for j in -250..=250 {
            let (a, b) = (22.0 + 0.01 * f64::from(i), 12.0 + 0.01 * f64::from(j));
            if track.length + 2.0 * (a - 22.0 + b - 12.0) <= limit {
                best = waves_at(&waves, &[a, b, a, b]).min(best);
            }
        }
    }
    assert!(straights <= best * 1.001, "{straights} {best}");
}

/// How much a whole number of carts may leave over, m.
const CLOSES: f64 = 0.6;

/// A rectangle whose straights are at least 22.6 m and 12.3 m long, with terms and a budget.
fn boxed(terms: Vec<(f64, Goal)>, within: Option<(Goal, f64)>) -> Layout {
    let mut layout = written(fixture::rectangle(30.9, 20.5, 4.0));
    layout.objective.terms = terms;
    layout.objective.within = within;
    layout.chain.closes_within = Some(crate::source::Spanned::new(CLOSES, fixture::span()));
    for section in 0..4 {
        let formula = Formula::Length(Target { from: section, straight: true });
        let low = if section % 2 == 0 { 22.6 } else { 12.3 };
        let kind = ConstraintKind::Require { formula, low, high: f64::INFINITY, unit: Unit::Metre };
        layout.constraints.push(Constraint { kind, span: fixture::span(), reason: None });
    }
    layout
}

/// What a rectangle with straights a and b measures: length, m, price, EUR, and polygon action, mm².
fn measured(layout: &Layout, corners: &[Corner]) -> [f64; 3] {
    let mut priced = layout.clone();
    priced.objective = Objective { terms: vec![(1.0, Goal::Cost)], ..Objective::default() };
    let track = Track::new(corners);
    [track.length, crate::solve::worth(&priced, &track, 0.0), value(corners, 1.25)]
}

/// All rectangles whose straights are up to 1.2 m longer than they have to be, each by multiples of 25 mm, and that as
/// many carts fit as a track of this length, m.
fn rectangles(layout: &Layout, length: f64) -> Vec<[f64; 3]> {
    let excess = 4.0 * (crate::base::trig::FRAC_PI_2 * 1.5625 / 96.0 - 1.953125 / 1920.0);
    let carts = ((length - excess) / 1.25).round();
    let closes = |length: f64| (length - excess - carts * 1.25).abs() <= CLOSES;
    let of = |i: u32, j: u32| {
        let (a, b) = (30.6 + 0.025 * f64::from(i), 20.3 + 0.025 * f64::from(j));
        measured(layout, &fixture::rectangle(a, b, 4.0).corners())
    };
    (0..=48)
        .flat_map(|i| (0..=48).map(move |j| (i, j)))
        .map(|(i, j)| of(i, j))
        .filter(|[length, ..]| closes(*length))
        .collect()
}

/// Prices have steps, which the search meets as well as a grid over all rectangles does, whose points lie on them.
#[test]
fn cost_beside_polygon_action_meets_a_fine_grid() {
    for weight in [0.5, 5.0] {
        let layout = boxed(vec![(1.0, Goal::Cost), (weight, Goal::PolygonAction)], None);
        let stages = solve(&layout, &Options::default(), &quiet);
        let [.., base, last] = stages.as_slice() else { panic!("{stages:?}") };
        assert!(last.name == "polygon" && last.max_violation <= 1e-6, "{:?}", last.violations);
        let merit = |[_, price, action]: [f64; 3]| price + weight * action;
        let found = measured(&layout, &last.corners);
        let best = rectangles(&layout, base.length).into_iter().map(merit).fold(f64::INFINITY, f64::min);
        assert!(merit(found) <= best * 1.0005, "{weight}: {found:?} {best}");
    }
}

#[test]
fn a_budget_of_cost_is_kept_and_used() {
    let layout = boxed(vec![(1.0, Goal::PolygonAction)], Some((Goal::Cost, 0.03)));
    let stages = solve(&layout, &Options::default(), &quiet);
    let [.., base, last] = stages.as_slice() else { panic!("{stages:?}") };
    assert!(base.name == "stage3" && last.max_violation <= 1e-6, "{:?}", last.violations);
    let limit = 1.03 * measured(&layout, &base.corners)[1];
    let found = measured(&layout, &last.corners);
    let best = rectangles(&layout, base.length).into_iter().filter(|[_, price, _]| *price <= limit);
    let best = best.map(|[_, _, action]| action).fold(f64::INFINITY, f64::min);
    assert!(found[1] <= limit * (1.0 + 1e-9) && found[2] <= best * 1.001, "{found:?} {limit} {best}");
    let before = measured(&layout, &base.corners)[2];
    assert!(found[2] < 0.97 * before, "the budget buys something: {before} {found:?}");
}

#[test]
fn length_and_cost_keep_to_a_limit_of_polygon_action() {
    let action = boxed(vec![(1.0, Goal::PolygonAction)], None);
    let even = solve(&action, &Options::default(), &quiet);
    let even = measured(&action, &even.last().expect("a stage").corners);
    for (goal, index) in [(Goal::Length, 0), (Goal::Cost, 1)] {
        let layout = boxed(vec![(1.0, goal)], Some((Goal::PolygonAction, 0.5)));
        let stages = solve(&layout, &Options::default(), &quiet);
        let last = stages.last().expect("a stage");
        let found = measured(&layout, &last.corners);
        assert!(last.max_violation <= 1e-6 && found[2] <= 1.5 * even[2] * (1.0 + 1e-6), "{goal:?}: {found:?} {even:?}");
        assert!(found[index] <= even[index], "{goal:?}: {found:?} {even:?}");
    }
}

/// Beside a goal of length the sides are those of the shortest layout.
#[test]
fn an_obstacle_may_be_passed_on_either_side() {
    let mut layout = boxed(vec![(1.0, Goal::PolygonAction)], Some((Goal::Length, 0.05)));
    let points = [(14.5, -1.4), (15.5, -1.4), (15.5, -0.4), (14.5, -0.4)];
    layout.obstacles.push(Obstacle {
        name: "pillar".to_owned(),
        polygon: Polygon::new(points.map(|(x, y)| Point::new(x, y)).to_vec()).expect("a square"),
        clearance: 0.0,
        side: Side::Either,
        pass: Some(fixture::span()),
        span: fixture::span(),
    });
    let stages = solve(&layout, &Options::default(), &quiet);
    let last = stages.last().expect("a stage");
    assert!(last.name == "polygon" && last.max_violation <= 1e-6, "{:?}", last.violations);
}

fn waves_at(waves: &crate::problem::Waves, straights: &[f64]) -> f64 {
    waves.value(straights)
}

/// The value of waves in series is that of the whole chain, but for what lies beyond the third harmonic, and its
/// derivatives are exact.
#[test]
fn waves_are_the_chain() {
    let layout = smooth(thesis10(), None);
    let x = to_variables(&layout.corners());
    for counted in PolygonObjective::EACH {
        let goal = Smooth { counted, ..Smooth::of(&layout.objective).expect("a goal") };
        let waves = candidate::waves(&x, goal, 1.25).expect("waves");
        let track = Track::new(&layout.corners());
        let straights: Vec<f64> = (0..10).map(|k| track.straight(k).length).collect();
        let whole = action(&Course::of_track(&track).expect("a course"), 1.25).expect("a chain");
        let (a, b) = (waves.value(&straights), 1e6 * whole.value(counted));
        assert!((a / b - 1.0).abs() < 0.06, "{counted:?}: {a} {b}");
        let mut problem = Problem::new(&layout, Scope::Obstacles);
        problem.aim = crate::problem::Aim::Waves(waves);
        let here = problem.evaluate(&x, 0.0);
        let e = &here.objective[0];
        for k in (0..x.len()).filter(|k| k % 3 != 2) {
            let at = |by: f64| {
                let mut y = x.clone();
                y[k] += by;
                problem.evaluate(&y, 0.0).objective[0].clone()
            };
            let (up, down) = (at(1e-6), at(-1e-6));
            let difference = (up.value - down.value) / 2e-6;
            assert!((e.gradient[k] - difference).abs() < 1e-5 * (1.0 + difference.abs()), "{k}");
            for j in (0..x.len()).filter(|j| j % 3 != 2) {
                let difference = (up.gradient[j] - down.gradient[j]) / 2e-6;
                let exact = e.hessian[k * x.len() + j];
                assert!((exact - difference).abs() < 1e-3 * (1.0 + difference.abs()), "{k} {j}: {exact} {difference}");
            }
        }
    }
}

#[test]
fn impossible_layouts_say_so() {
    let mut layout = smooth(thesis10(), Some(0.005));
    layout.constraints.push(crate::model::Constraint {
        kind: crate::model::ConstraintKind::Require {
            formula: crate::model::Formula::Length(crate::model::Target { from: 5, straight: false }),
            low: 100.0,
            high: f64::INFINITY,
            unit: crate::model::Unit::Metre,
        },
        span: fixture::span(),
        reason: None,
    });
    let stages = solve(&layout, &Options::default(), &quiet);
    assert_eq!(stages.last().map(|s| s.status), Some(Status::Infeasible));
}

/// No straights between the same curves come below the bound, and it is not so low as to say nothing.
#[test]
fn the_bound_holds_whatever_the_straights() {
    const PITCH: f64 = 1.25;
    let turns = [1.6, 1.2, 2.0, 0.9, 1.3];
    let mut state = 5;
    let mut least = [f64::INFINITY; 3];
    let mut bounds = [0.0; 3];
    for _ in 0..300 {
        let parts = turns.iter().flat_map(|&turn| {
            let length = 8.0 + 1.5 * uniform(&mut state);
            [Form::Straight { length, slope: 0.0 }, Form::Arc { radius: 4.0, turn }]
        });
        let forms: Vec<Form> = parts.collect();
        let course = Course::new(&CentreLine::new([0.0; 4], &forms)).expect("a course");
        let alone: Vec<f64> =
            (0..turns.len()).map(|k| curve_phasor(&course, k, PITCH).expect("a chain").delta_p).collect();
        let action = action(&course, PITCH).expect("a chain");
        for (k, objective) in PolygonObjective::EACH.into_iter().enumerate() {
            bounds[k] = least_action(&alone, objective).expect("a bound");
            least[k] = least[k].min(action.value(objective));
        }
    }
    for (least, bound) in least.into_iter().zip(bounds) {
        assert!(least >= 0.99 * bound, "{least} {bound}");
    }
    // 300 draws come within a factor of four of the bound on all straights.
    assert!(bounds[0] > 0.25 * least[0], "{bounds:?} {least:?}");
}

/// By hand: of two curves the second leaves at least what the first is larger by.
#[test]
fn the_bound_of_two_curves() {
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-5 * b, "{a} {b}");
    near(least_action(&[3.0, 1.0], PolygonObjective::Last).expect("a bound"), 8.0);
    near(least_action(&[3.0, 1.0], PolygonObjective::All).expect("a bound"), 9.0 + 1.0 + 8.0);
    assert_eq!(least_action(&[0.0, 0.0], PolygonObjective::All), Some(0.0));
}
