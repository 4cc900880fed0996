//! Polygon action against closed forms, by hand, and of both measures against each other.

use super::*;
use crate::base::trig;
use crate::geometry::{CentreLine, Form, Track};
use crate::model::instances::thesis10;
use crate::problem::measures::{to_corners, to_variables};

const PITCH: f64 = 1.25;

fn straight(length: f64) -> Form {
    Form::Straight { length, slope: 0.0 }
}

/// Straights and left turns of one radius by (straight, turn) as one course; it need not close.
fn course(parts: &[(f64, f64)], radius: f64) -> Course {
    let forms: Vec<Form> =
        parts.iter().flat_map(|&(length, turn)| [straight(length), Form::Arc { radius, turn }]).collect();
    Course::new(&CentreLine::new([0.0; 4], &forms)).expect("a course")
}

/// Design, chain model: a whole curve between 0 and 0.0226 L³/R² as frac(Rθ/L) says, one transition half of the most.
#[test]
fn a_curve_is_the_closed_form() {
    for radius in [3.0, 4.0, 8.0] {
        let unit = PITCH * PITCH * PITCH / (radius * radius);
        let of = |pitches: f64| {
            let one = course(&[(20.0, pitches * PITCH / radius)], radius);
            curve_phasor(&one, 0, PITCH).expect("a chain")
        };
        let all: Vec<CurvePhasor> = (0..40).map(|k| of(4.0 + f64::from(k) / 40.0)).collect();
        let (least, most) = all.iter().fold((f64::MAX, 0.0f64), |(l, m), x| (l.min(x.delta_p), m.max(x.delta_p)));
        assert!(least / unit < 0.003 && (most / unit - 0.0226).abs() < 0.0008, "{radius}: {least} {most}");
        // Two transitions of amplitude a at both ends: 2a |sin π Rθ/L| about the effective length of the curve.
        let amplitude = |x: &CurvePhasor| x.first.norm_sqr().sqrt();
        let strongest = all.iter().map(amplitude).fold(0.0, f64::max);
        assert!((2.0 * strongest / most - 1.0).abs() < 0.03, "{strongest} {most}");
        // Period in the curve's length.
        assert!((of(4.3).delta_p - of(7.3).delta_p).abs() < 0.002 * unit);
        // Chords cut off θL²/(24R) − L³/(120R²), the mean over phases.
        let turn = 6.5 * PITCH / radius;
        let excess = turn * PITCH * PITCH / (24.0 * radius) - PITCH * unit / PITCH / 120.0;
        let mean = of(6.5).mean;
        assert!((mean + excess).abs() < 0.02 * excess, "{mean} {excess}");
    }
}

/// Two equal curves half a cart apart in phase cancel; in phase they double.
#[test]
fn curves_in_series_add_and_cancel() {
    let turn = 6.5 * PITCH / 4.0;
    let alone = curve_phasor(&course(&[(20.0, turn)], 4.0), 0, PITCH).expect("a chain");
    let both = |gap: f64| {
        let parts = [(20.0, turn), (gap - 6.5 * PITCH - alone.mean, turn)];
        let action = action(&course(&parts, 4.0), PITCH).expect("a chain");
        (action.delta_p[0][0], 2.0 * action.first[0][0].norm_sqr().sqrt())
    };
    let (together, apart) = (both(16.0 * PITCH), both(16.5 * PITCH));
    assert!((together.0 / (2.0 * alone.delta_p) - 1.0).abs() < 0.01, "{together:?} {}", alone.delta_p);
    // Half a cart is a whole period of the second harmonics: those add up, an eighth of the first each.
    assert!(apart.1 < 0.01 * alone.delta_p && apart.0 < 0.25 * alone.delta_p, "{apart:?} {}", alone.delta_p);
}

/// The first harmonics of single curves, turned by their phases, are those of the whole chain.
#[test]
fn harmonics_superpose() {
    let course = Course::of_track(&Track::new(&thesis10().corners())).expect("a course");
    let n = course.len();
    let curves: Vec<CurvePhasor> = (0..n).map(|k| curve_phasor(&course, k, PITCH).expect("a chain")).collect();
    let whole = action(&course, PITCH).expect("a chain");
    let largest = whole.first.iter().flatten().map(|h| h.norm_sqr()).fold(0.0, f64::max).sqrt();
    for (i, parts) in superposed(&course, &curves, PITCH).iter().enumerate() {
        let mut sum = Phasor::default();
        for (m, part) in parts.iter().enumerate() {
            sum += part;
            let off = (sum - whole.first[i][straight_behind(i, m + 1, n)]).norm_sqr().sqrt();
            assert!(off < 0.02 * largest, "{i} {m}: {off} of {largest}");
        }
    }
}

/// Where the first joint starts does not matter, and neither does where arc length 0 lies.
#[test]
fn starts_do_not_matter() {
    let turn = trig::FRAC_PI_2;
    let arc = Form::Arc { radius: 4.0, turn };
    let whole = [straight(20.0), arc, straight(7.3), arc, straight(20.0), arc, straight(7.3), arc];
    let split = [straight(12.0), arc, straight(7.3), arc, straight(20.0), arc, straight(7.3), arc, straight(8.0)];
    let in_curve = [arc, straight(7.3), arc, straight(20.0), arc, straight(7.3), arc, straight(20.0)];
    let of = |forms: &[Form]| {
        action(&Course::new(&CentreLine::new([0.0; 4], forms)).expect("a course"), PITCH).expect("a chain")
    };
    let (a, b, c) = (of(&whole), of(&split), of(&in_curve));
    for i in 0..4 {
        for j in 0..4 {
            assert!((a.delta_p[i][j] - b.delta_p[i][j]).abs() < 1e-12);
            assert!((a.delta_p[i][j] - c.delta_p[(i + 3) % 4][(j + 3) % 4]).abs() < 1e-12);
        }
    }
}

#[test]
fn objectives_count_from_the_start() {
    let matrix = Action {
        delta_p: (0..5).map(|i| (0..5).map(|j| if passed(i, j, 5) == 4 { 1.0 } else { 0.0 }).collect()).collect(),
        first: Vec::new(),
    };
    assert_eq!(PolygonObjective::EACH.map(|o| matrix.value(o)), [5.0, 0.0, 0.0]);
    let third = |i: usize, j: usize| if passed(i, j, 5) == 3 { 1.0 } else { 0.0 };
    let matrix = Action { delta_p: (0..5).map(|i| (0..5).map(|j| third(i, j)).collect()).collect(), ..matrix };
    assert_eq!(matrix.value(PolygonObjective::FirstThree), 5.0);
    assert_eq!((passed(2, 2, 5), passed(2, 1, 5), straight_behind(0, 5, 5)), (5, 1, 0));
}

/// Ranks of values, ties apart.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    order.iter().enumerate().for_each(|(rank, k)| ranks[*k] = rank as f64);
    ranks
}

/// The peak and the first harmonic rank layouts alike (Spearman's correlation), for every objective.
#[test]
fn both_measures_rank_layouts_alike() {
    let layout = thesis10();
    let problem = crate::problem::Problem::new(&layout, crate::problem::Scope::Obstacles);
    let actions: Vec<Action> = (1..=40)
        .map(|seed| {
            let x = crate::problem::perturbed(&layout, &problem, 0.5, seed);
            let track = Track::new(&to_corners(&x));
            action(&Course::of_track(&track).expect("a course"), PITCH).expect("a chain")
        })
        .collect();
    for objective in PolygonObjective::EACH {
        let of = |f: &dyn Fn(&Action) -> f64| ranks(&actions.iter().map(f).collect::<Vec<_>>());
        let (peak, smooth) = (of(&|a| a.value(objective)), of(&|a| a.smooth(objective)));
        let n = actions.len() as f64;
        let apart: f64 = peak.iter().zip(&smooth).map(|(a, b)| (a - b) * (a - b)).sum();
        let correlation = 1.0 - 6.0 * apart / (n * (n * n - 1.0));
        assert!(correlation > 0.98, "{}: {correlation}", objective.name());
    }
}

/// Ramps and spirals are curves as well.
#[test]
fn heights_have_polygon_action() {
    let slope = 0.14;
    let up = Form::Vertical { radius: 10.0, slope_from: 0.0, slope_to: slope };
    let forms = [
        straight(12.0),
        up,
        Form::Straight { length: 6.0, slope },
        Form::Spiral { radius: 4.0, turn: 3.0, rise: 12.0 * slope },
        Form::Vertical { radius: 10.0, slope_from: slope, slope_to: 0.0 },
        straight(5.0),
        Form::Arc { radius: 4.0, turn: 1.0 },
    ];
    let course = Course::new(&CentreLine::new([0.0; 4], &forms)).expect("a course");
    assert_eq!(course.len(), 3);
    let action = action(&course, PITCH).expect("a chain");
    assert!(action.delta_p.iter().flatten().all(|x| *x > 0.0 && *x < 0.02), "{:?}", action.delta_p);
}

#[test]
fn what_has_no_polygon_action_says_why() {
    let line = |forms: &[Form]| Course::new(&CentreLine::new([0.0; 4], forms));
    assert_eq!(line(&[Form::Arc { radius: 10.0, turn: trig::TAU }]), Err(Unsuited::NoStraight));
    assert_eq!(line(&[straight(10.0)]), Err(Unsuited::NoCurve));
    assert_eq!(line(&[straight(f64::NAN)]), Err(Unsuited::NotFinite));
    let sharp = course(&[(20.0, 3.0)], 0.3);
    assert!(matches!(action(&sharp, PITCH), Err(Unsuited::TooTight(_))));
    assert_eq!(action(&sharp, 0.0), Err(Unsuited::NotFinite));
    assert_eq!(action(&course(&[(2e6, 3.0)], 4.0), PITCH), Err(Unsuited::TooLong));
}

/// Two curves of one hand and radius that touch are one; of different ones, two with a straight of no length between.
#[test]
fn touching_curves_are_told_apart_by_their_bend() {
    let arc = |radius: f64, turn: f64| Form::Arc { radius, turn };
    let count =
        |a: Form, b: Form| Course::new(&CentreLine::new([0.0; 4], &[straight(9.0), a, b])).expect("a course").len();
    assert_eq!(count(arc(4.0, 1.0), arc(4.0, 0.5)), 1);
    assert_eq!(count(arc(4.0, 1.0), arc(5.0, 0.5)), 2);
    assert_eq!(count(arc(4.0, 1.0), arc(4.0, -0.5)), 2);
}

#[test]
fn gradients_and_actions_agree() {
    let x = to_variables(&thesis10().corners());
    let whole = action(&Course::of_track(&Track::new(&to_corners(&x))).expect("a course"), PITCH).expect("a chain");
    for objective in PolygonObjective::EACH {
        let found = gradient(&x, PITCH, objective).expect("a chain");
        assert!((found.value / whole.value(objective) - 1.0).abs() < 1e-12);
        assert!((found.smooth / whole.smooth(objective) - 1.0).abs() < 1e-12);
    }
}
