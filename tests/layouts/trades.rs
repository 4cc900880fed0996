//! Layouts that no other one beats in two or three measures, against building each of them, and against the choice of
//! components alone.

use crate::small::layout;
use lss::choose::{self, Measure, Settings, choose, pareto, undominated};
use lss::compiled::{Compiled, order};
use lss::dynamics::Width;
use lss::kinematics::polygon::{Course, PolygonObjective, action};
use lss::model::{Goal, Layout, Objective, objective_text};
use lss::solve::{End, Options, solve};

/// A loop around an obstacle, whose radii are free.
const LOOP: &str = "use std.carts.tilt_tray
use std.tracks.standard

layout around {
  catalog standard
  cart tilt_tray(length: 500 mm)
  speed 2 m/s
  width 1 m
  building [(0 m, 0 m), (40 m, 0 m), (40 m, 24 m), (0 m, 24 m)]
  vertex P1 (3 m, 3 m)
  vertex P2 (32 m, 3 m)
  vertex P3 (32 m, 18 m)
  vertex P4 (18 m, 18 m)
  vertex P5 (14 m, 12 m)
  vertex P6 (3 m, 12 m)
  fix all P1..P2
  obstacle pillar [(23 m, 8 m), (26 m, 8 m), (26 m, 13 m), (23 m, 13 m)]
}
";

fn values(compiled: &Compiled) -> [f64; 3] {
    let course = Course::new(&compiled.space.line).expect("a course");
    let all = action(&course, compiled.layout.cart.length).expect("polygon action").value(PolygonObjective::All);
    [compiled.length(), order::total(compiled).all, 1e3 * (all / (course.len() * course.len()) as f64).sqrt()]
}

/// Built of its own line, each layout is what it was said to be; none is beaten, and no budget of the ladder gives one that
/// all of them are worse than.
#[test]
fn each_layout_is_what_its_line_builds() {
    let layout = layout(LOOP);
    let measures = [Measure::Length, Measure::Price, Measure::Smoothness];
    let found = pareto(&layout, &measures, &Options::default(), &|_| {}).expect("few enough");
    assert!(found.layouts.len() > 3, "{}", found.layouts.len());
    for (i, own) in found.layouts.iter().enumerate() {
        let alike = |other: &choose::pareto::Traded| {
            measures.iter().zip(other.values.iter().zip(&own.values)).all(|(m, (a, b))| *a <= b - m.step())
        };
        assert!(!found.layouts.iter().any(alike), "{i}: {:?}", own.values);
        for (a, b) in own.values.iter().zip(values(&own.compiled)) {
            assert!((a - b).abs() < 0.011, "{i}: {:?} {:?}", own.values, values(&own.compiled));
        }
        if own.radii.is_some() {
            continue;
        }
        let mut again = Layout { objective: own.objective.clone(), ..layout.clone() };
        let stages = solve(&again, &Options::default(), &|_| {});
        if own.objective.weight(Goal::Cost).is_none() {
            again.objective = lss::solve::objective(&layout, End::Cost);
        }
        let built = values(&Compiled::new(again, stages));
        for (said, built) in own.values.iter().zip(built) {
            assert!((said - built).abs() < 0.011, "{}: {said} {built}", objective_text(&own.objective));
        }
    }
    let budget = Objective {
        terms: vec![(1.0, Goal::PolygonAction)],
        within: Some((Goal::Length, 0.005)),
        ..Objective::default()
    };
    let even = Layout { objective: budget, ..layout.clone() };
    let stages = solve(&even, &Options::default(), &|_| {});
    let bought = Layout { objective: lss::solve::objective(&layout, End::Cost), ..layout };
    let single = values(&Compiled::new(bought, stages));
    let as_good = |own: &choose::pareto::Traded| {
        measures.iter().zip(own.values.iter().zip(&single)).all(|(m, (own, single))| *own <= single + m.step())
    };
    assert!(found.layouts.iter().any(as_good), "{single:?}");
}

/// What is proven of an end holds for every layout, and the shortest is the one that a build finds.
#[test]
fn ends_are_bounds() {
    let layout = layout(LOOP);
    let found =
        pareto(&layout, &[Measure::Footprint, Measure::Cost], &Options::default(), &|_| {}).expect("few enough");
    let shortest = Compiled::new(layout.clone(), solve(&layout, &Options::default(), &|_| {}));
    assert!((found.ends[0].value - shortest.footprint).abs() < 1e-6);
    for (k, end) in found.ends.iter().enumerate() {
        let bound = end.bound.expect("a bound");
        assert!(bound <= end.value && bound > 0.9 * end.value, "{end:?}");
        for own in &found.layouts {
            assert!(own.values[k] >= end.value - 1e-9);
        }
    }
}

/// On tracks that are traded, too, components are at least as good as on those of the layout's objective.
#[test]
fn components_are_chosen_on_traded_tracks() {
    let text = include_str!("../../examples/choice.lss");
    let layout = layout(text);
    let measures = [Measure::Price, Measure::Capacity];
    let settings = Settings { options: Options::default(), width: Width::used(), checks: 0, tracks_within: None };
    let chosen = choose(&layout, &settings, &|_| {}).expect("few enough");
    let found = pareto(&layout, &measures, &Options::default(), &|_| {}).expect("few enough");
    assert!(found.layouts.iter().all(|own| own.choice.is_some()));
    let fronted = undominated(&chosen, &measures);
    assert!(fronted.len() > 3);
    for (_, row) in fronted {
        let as_good = |own: &choose::pareto::Traded| {
            own.values[0] <= row[0] + Measure::Price.step() && own.values[1] >= row[1] - Measure::Capacity.step()
        };
        assert!(found.layouts.iter().any(as_good), "{row:?}");
    }
    let most = found.layouts.iter().map(|own| own.values[1]).fold(0.0, f64::max);
    assert_eq!(found.ends[1].value, most);
    assert!(found.ends[1].proven);
    let price = found.ends[0];
    let bound = price.bound.expect("a bound");
    assert!(bound <= price.value && bound > 0.95 * price.value, "{price:?}");

    let energies =
        pareto(&layout, &[Measure::Energy, Measure::Length], &Options::default(), &|_| {}).expect("few enough");
    let end = energies.ends[0];
    let bound = end.bound.expect("a bound");
    assert!(bound <= end.value && bound > 0.9 * end.value, "{end:?}");
}
