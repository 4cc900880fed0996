use super::key::{GapPart, Named, StrengthInterval};
use super::*;
use crate::gap::Verdict;
use std::collections::BTreeMap;

fn case(name: &str, kind: CaseKind, truth: &[&str], strength_over_floor: f64) -> Case {
    let truth = truth.iter().map(|effect| Truth {
        effect: (*effect).into(),
        strengths: [("height".to_owned(), 1.0)].into(),
        fixed: [("at".to_owned(), 10.0)].into(),
        place: Some((10.0, 12.0)),
    });
    let level = (strength_over_floor > 0.0).then(|| StrengthLevel::of(strength_over_floor));
    Case {
        name: name.into(),
        kind,
        truth: truth.collect(),
        strength_over_floor,
        level,
        oracle: Some(0.9),
        about: String::new(),
    }
}

fn named(name: &str, group: &str, probability: f64, interval: (f64, f64), at: f64) -> Named {
    let interval = StrengthInterval { value: Some(1.0), low: Some(interval.0), high: Some(interval.1) };
    Named {
        name: name.into(),
        group: group.into(),
        probability: Some(probability),
        strength: [("height".to_owned(), interval)].into(),
        gap_closed: None,
        gap_closed_placebo: Some(0.1),
        fixed: [("at".to_owned(), at)].into(),
    }
}

fn answer(verdict: Verdict, effects: Vec<Named>, unknown: f64, none: f64) -> Answer {
    Answer {
        verdict: Some(verdict),
        effects,
        places: vec![
            GapPart { from_m: Some(10.0), to_m: Some(15.0), share: Some(0.6) },
            GapPart { from_m: Some(50.0), to_m: Some(60.0), share: Some(0.2) },
            GapPart { from_m: Some(0.0), to_m: Some(100.0), share: Some(0.2) },
        ],
        unknown_probability: Some(unknown),
        none_probability: Some(none),
        gap_closed: Some(0.8),
        gap_closed_black_box: None,
    }
}

/// Four cases: an effect that is found, one that stands second but in the first one's group, one without a gap, one
/// unknown.
fn challenge() -> (Vec<Case>, BTreeMap<String, Answer>) {
    let cases = vec![
        case("a", CaseKind::One, &["rail_step"], 5.0),
        case("b", CaseKind::One, &["rail_step"], 12.0),
        case("c", CaseKind::None, &[], 0.0),
        case("d", CaseKind::Unknown, &["a lean"], 20.0),
        case("e", CaseKind::Pair, &["rail_step", "pitch_wear"], 4.0),
    ];
    let found =
        vec![named("rail_step", "rail_step", 0.8, (0.5, 1.5), 11.0), named("pitch_wear", "", 0.1, (0.0, 1.0), 0.0)];
    let second =
        vec![named("rail_step", "x", 0.55, (1.1, 1.5), 40.0), named("joint_friction", "x", 0.6, (0.0, 2.0), 0.0)];
    let both = vec![named("rail_step", "", 0.7, (0.9, 1.1), 10.0), named("pitch_wear", "", 0.6, (0.9, 1.1), 10.0)];
    let answers = [
        ("a", answer(Verdict::Effect, found, 0.1, 0.0)),
        ("b", answer(Verdict::Effect, second, 0.2, 0.0)),
        ("c", answer(Verdict::None, vec![], 0.15, 0.9)),
        ("d", answer(Verdict::Unknown, vec![], 0.18, 0.1)),
        ("e", answer(Verdict::Pair, both, 0.0, 0.0)),
    ];
    (cases, answers.map(|(name, answer)| (name.to_owned(), answer)).into())
}

#[test]
fn a_score_is_what_one_counts_by_hand() {
    let (cases, answers) = challenge();
    let score = score(&cases, &answers);
    assert_eq!((score.cases, score.failed), (5, 0));
    // a and e are first; b is second, yet first by its group.
    let headline = &score.headline;
    assert_eq!([headline.top_1, headline.top_3].map(|s| (s.hits, s.of)), [(2, 3), (3, 3)]);
    assert_eq!((headline.top_1_group.hits, headline.top_1_group.of), (3, 3));
    assert!((headline.probability.unwrap().value - (0.8 + 0.55 + 0.65) / 3.0).abs() < 1e-12);
    assert_eq!((score.false_alarms.hits, score.false_alarms.of), (0, 1));
    // 0.18 is above 0.1, 0.15 and 0.0, and under 0.2.
    assert!((score.unknown_area.unwrap().value - 0.75).abs() < 1e-12);
    // Named with 0.5 or more: rail_step of a, b and e, pitch_wear of e; b's is elsewhere and too strong.
    assert_eq!((score.places.hits, score.places.of), (3, 4));
    assert_eq!((score.coverage.hits, score.coverage.of), (3, 4));
    // Of 0.8 that is local, 4.5 of 5 m of the 0.6 lie within 7.5 to 14.5 m, which is 7 of 100 m.
    let overlap = 0.6 * 4.5 / 5.0 / 0.8;
    assert!((score.each[0].scored.overlap.unwrap().0 - overlap).abs() < 1e-12);
    assert!((score.each[0].scored.overlap.unwrap().1 - 0.07).abs() < 1e-12);
    assert!((score.closed.unwrap().value - 0.8).abs() < 1e-12);
    assert!((score.closed_oracle.unwrap().value - 0.9).abs() < 1e-12);
    // 22 effects, of each case their square errors.
    let squares = (0.04 + 0.01) + (0.45 * 0.45 + 0.36) + (0.09 + 0.16);
    assert!((score.brier.unwrap().value - squares / 110.0).abs() < 1e-12);
    let levels: Vec<(usize, usize)> =
        score.by_level.iter().map(|r| (r.accuracy.top_1.hits, r.accuracy.top_1.of)).collect();
    assert_eq!(levels, [(0, 0), (2, 2), (0, 1)]);
}

#[test]
fn silence_is_wrong() {
    let (cases, mut answers) = challenge();
    answers.clear();
    let score = score(&cases, &answers);
    assert_eq!((score.failed, score.headline.top_3.hits), (5, 0));
    assert_eq!(score.false_alarms.hits, 1);
    assert!(score.each.iter().all(|line| line.scored.rank.exact > 24));
}

#[test]
fn a_table_shows_every_case() {
    let (cases, answers) = challenge();
    let score = score(&cases, &answers);
    insta::assert_snapshot!("a_table", table::text(&score));
    let markdown = table::markdown(&score);
    assert!(markdown.lines().filter(|l| l.starts_with('|')).all(|l| l.ends_with('|')));
    assert!(cases.iter().all(|c| markdown.contains(&format!("| {} |", c.name))));
}

#[test]
fn cases_on_a_given_layout_hold_it_without_its_effects() {
    let mut given = super::tracks::all().unwrap().remove(0).simulation;
    let strengths = [("gap".to_owned(), 1e-4)].into();
    given.effects = vec![crate::chain_input::DeclaredEffect { name: "joint_clearance".into(), strengths }];
    let planned = super::tracks::Planned::given(given.clone());
    given.effects.clear();
    let read: crate::chain_input::Simulation = serde_json::from_slice(&planned.text).unwrap();
    assert_eq!((planned.file, &read, &planned.simulation), ("simulation.json", &given, &given));
}
