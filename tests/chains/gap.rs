//! The diagnosis on a made-up model whose truth is known in closed form: features are linear in nuisances and effects,
//! and replicate runs scatter by white noise.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::made_up::{FAR, FEATURES, Failure, LENGTHS, ROUGH, bump, made};
use crate::result_page::ResultPage;
use lss::base::random::normal;
use lss::base::trig;
use lss::chain_input::{CentreLinePiece, Track};
use lss::effects::RandomEffect;
use lss::gap::{Amount, Applied, Bound, CandidateId, Diagnosis, Id, Settings, Verdict, diagnose};
use std::collections::{BTreeMap, BTreeSet};

fn found(truth: &[(usize, f64)], strange: f64, seed: u64) -> Diagnosis {
    diagnose(&made(truth, strange, seed), &Settings::default(), &mut |_| {})
}

#[test]
fn one_effect_is_named_with_its_strength_and_place() {
    for (candidate, name, place, size) in
        [(0, "slope", "", 8.0), (4, "step", "third", -4.0), (3, "step", "second", 5.0)]
    {
        let found = found(&[(candidate, size)], 0.0, 11 + candidate as u64);
        let first = &found.effects[0];
        assert_eq!((found.verdict, first.name.as_str(), first.place.as_str()), (Verdict::Effect, name, place));
        let amount = &first.strength["size"];
        assert!(amount.low <= size && size <= amount.high && amount.high - amount.low < 2.0, "{amount:?}");
        assert!(first.gap_closed.expect("runs left out") > 0.9, "{first:?}");
        assert!(first.gap_closed_placebo.expect("a placebo") < 0.4, "{first:?}");
        assert_reported_as_sealed_cases_were_right(&found);
    }
}

/// However clear the runs are, a share of diagnoses says no more than the priors, and effects are in the order of their
/// probabilities.
fn assert_reported_as_sealed_cases_were_right(found: &Diagnosis) {
    let prior_weight = 0.055;
    let probabilities: Vec<f64> = found.effects.iter().map(|f| f.probability).collect();
    assert!(probabilities.iter().all(|p| *p < 1.0 - 0.5 * prior_weight), "{probabilities:?}");
    assert!(probabilities.is_sorted_by(|a, b| a >= b), "{probabilities:?}");
    // Their priors of 0.2 and 0.15, of what was compared.
    let (none, unknown) = (found.none_probability, found.unknown_probability);
    assert!(
        none > 0.2 * prior_weight && unknown > 0.15 * prior_weight && none + unknown < 0.5 * prior_weight,
        "{none} {unknown}"
    );
}

#[test]
fn an_effect_at_several_places_is_one_effect() {
    let truth = [(2, 6.0), (3, -5.0), (5, 4.0)];
    let found = found(&truth, 0.0, 21);
    let first = &found.effects[0];
    assert_eq!((found.verdict, first.name.as_str()), (Verdict::Effect, "step"), "{}", found.summary);
    assert!(found.explained() && first.probability > 0.95, "{}", found.summary);
    let own = (first.place.as_str(), &first.strength);
    let all = || std::iter::once(own).chain(first.elsewhere.iter().map(|e| (e.place.as_str(), &e.strength)));
    assert_eq!(all().count(), truth.len(), "{first:?}");
    for (place, size) in ["first", "second", "fourth"].into_iter().zip(truth.map(|(_, size)| size)) {
        let amount = &all().find(|(own, _)| *own == place).expect(place).1["size"];
        assert!(amount.low <= size && size <= amount.high && amount.high - amount.low < 2.0, "{place}: {amount:?}");
        assert!(found.summary.contains(place), "{}", found.summary);
    }
    // What is at one place alone stays there.
    let alone = self::found(&[(4, -4.0)], 0.0, 15);
    assert!(alone.effects[0].elsewhere.is_empty(), "{}", alone.summary);
}

#[test]
fn places_of_an_effect_have_shapes_of_their_own() {
    // Each runs into the next ones, over another length than the library's.
    let truth = [(bump(0, 2), 9.0), (bump(1, 1), -8.0), (bump(2, 2), 7.0)];
    let expected =
        [(0.1, 2, 9.0), (0.3, 1, -8.0), (0.5, 2, 7.0)].map(|(at, n, x)| (format!("{at} over {}", LENGTHS[n]), x));
    let places = |found: &Diagnosis| -> BTreeMap<String, Amount> {
        let first = &found.effects[0];
        let own = (first.place.clone(), first.strength["size"].clone());
        let further = first.elsewhere.iter().map(|e| (e.place.clone(), e.strength["size"].clone()));
        std::iter::once(own).chain(further).collect()
    };
    let found = found(&truth, 0.0, 22);
    assert_eq!((found.verdict, found.effects[0].name.as_str()), (Verdict::Effect, "bump"), "{}", found.summary);
    assert!(found.explained(), "{}", found.summary);
    let own = places(&found);
    assert!(own.keys().eq(expected.iter().map(|(place, _)| place)), "{own:?}");
    for (place, size) in &expected {
        // Of three 90 % intervals one misses in a quarter of all cases: twice as far is 0.1 % each.
        let Amount { value, low, high, .. } = own[place];
        assert!((value - size).abs() < high - low && high - low < 2.0, "{place}: {value} [{low}, {high}]");
    }
    // One after the other they are found in other shapes.
    let mut settings = Settings::default();
    settings.selection.reshapings = 0;
    let one_by_one = diagnose(&made(&truth, 0.0, 22), &settings, &mut |_| {});
    assert!(!places(&one_by_one).keys().eq(own.keys()) && !one_by_one.explained(), "{}", one_by_one.summary);
}

#[test]
fn a_search_begins_with_what_the_runs_were_fitted_with() {
    // Of these places none is found in its own shape where they are looked for one by one.
    let truth = [(bump(0, 2), 9.0), (bump(1, 1), -8.0), (bump(2, 2), 7.0)];
    let mut settings = Settings::default();
    settings.selection.reshapings = 0;
    let mut made = made(&truth, 0.0, 22);
    assert!(!diagnose(&made, &settings, &mut |_| {}).explained());
    // Strengths that are half as large are enough, as they are fitted on from there.
    let half = truth.map(|(k, size)| Applied { candidate: CandidateId::new(k), strengths: vec![0.5 * size] });
    made.begin = half.to_vec();
    let found = diagnose(&made, &settings, &mut |_| {});
    let first = &found.effects[0];
    assert!(found.explained() && first.elsewhere.len() == 2, "{}", found.summary);
    for ((_, size), at) in truth.iter().zip(first.places()) {
        let Amount { value, low, high, .. } = at.strength["size"];
        assert!((value - size).abs() < high - low && high - low < 2.0, "{}: {value} [{low}, {high}]", at.place);
    }
}

#[test]
fn sensors_pairs_and_nothing_have_verdicts_of_their_own() {
    assert_eq!(found(&[(6, 4.0)], 0.0, 5).verdict, Verdict::Sensor);
    let pair = found(&[(0, 8.0), (6, 3.0)], 0.0, 6);
    assert_eq!(pair.verdict, Verdict::Pair);
    let mut names: Vec<&str> = pair.effects[..2].iter().map(|e| e.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["sensor", "slope"]);
    let alarms = (0..20).filter(|seed| found(&[], 0.0, 100 + seed).verdict != Verdict::None).count();
    assert!(alarms <= 1, "{alarms} of 20 false alarms");
}

#[test]
fn what_does_little_everywhere_is_seen_along_its_signature() {
    // A tenth more than the repeatability as a mean square, six deviations along the signature.
    let each: Vec<Diagnosis> = (0..10).map(|seed| found(&[(0, 1.3)], 0.0, 300 + seed)).collect();
    let named = each.iter().filter(|d| d.verdict == Verdict::Effect && d.effects[0].name == "slope");
    let amounts: Vec<_> = named.map(|d| &d.effects[0].strength["size"]).collect();
    assert!(amounts.len() >= 8, "{} of 10", amounts.len());
    let held = amounts.iter().filter(|a| a.low <= 1.3 && 1.3 <= a.high).count();
    assert!(held + 2 >= amounts.len(), "{held} of {}", amounts.len());
}

#[test]
fn a_strength_far_from_its_trial_is_found() {
    let found = found(&[(FAR, 12.0)], 0.0, 12);
    let first = &found.effects[0];
    assert_eq!((found.verdict, first.name.as_str()), (Verdict::Effect, "far"), "{}", found.summary);
    assert!((first.strength["size"].value / 12.0 - 1.0).abs() < 0.1, "{first:?}");
}

#[test]
fn a_small_effect_is_found_beside_a_large_one() {
    // At a strength at which it would explain the whole gap it does something else.
    let found = found(&[(0, 40.0), (FAR, 0.2)], 0.0, 31);
    assert_eq!(found.verdict, Verdict::Pair, "{}", found.summary);
    let of = |name: &str| found.effects.iter().find(|f| f.name == name).expect("an effect");
    assert!(of("slope").probability > 0.9 && of("far").probability > 0.9, "{}", found.summary);
    let amount = &of("slope").strength["size"];
    assert!(amount.low <= 40.0 && 40.0 <= amount.high && amount.high - amount.low < 2.0, "{amount:?}");
    // What it does at once hardly grows with it.
    assert!(of("far").strength["size"].value < 1.5, "{:?}", of("far").strength);
}

#[test]
fn what_no_effect_explains_is_unknown() {
    let found = found(&[], 3.0, 7);
    assert_eq!(found.verdict, Verdict::Unknown, "{}", found.summary);
    assert!(found.unknown_probability > 0.8 && !found.places.is_empty());
}

#[test]
fn of_a_gap_that_stays_unknown_the_effect_that_explains_most_is_shown() {
    // At both of its places, though the prior of two is less than that of one, or of an effect that has none.
    for (size, strange) in [(3.0, 3.0), (4.0, 4.0), (5.0, 6.0)] {
        let found = found(&[(2, size), (4, -size)], strange, 7);
        assert_eq!(
            (found.verdict, &found.shown[..]),
            (Verdict::Unknown, &["step".to_owned()][..]),
            "{}",
            found.summary
        );
        let step = found.with()[0];
        let places: BTreeSet<&str> = step.places().map(|at| at.place).collect();
        assert_eq!(places, BTreeSet::from(["first", "third"]), "{}", found.summary);
        assert!(found.gap_closed > Some(0.3), "{}", found.summary);
    }
}

#[test]
fn what_no_lap_of_its_model_leaves_is_not_certain() {
    // The slope is beyond doubt, and so is that there is more than it.
    let found = found(&[(0, 40.0)], 1.5, 7);
    assert_eq!((found.verdict, found.effects[0].name.as_str()), (Verdict::Effect, "slope"), "{}", found.summary);
    assert!(found.effects[0].probability > 0.9, "{}", found.summary);
    let check = found.predictive_check.as_ref().expect("a check");
    assert!(!check.passed && check.runs.iter().all(|run| (run.draws, run.leave_as_much) == (40, 0)), "{check:?}");
    assert!(found.summary.contains("not certain: none of 40 laps"), "{}", found.summary);
}

#[test]
fn the_right_model_is_in_doubt_as_often_as_a_run_is_the_last_of_all_laps() {
    let (mut failed, mut shares) = (0, Vec::new());
    for seed in 0..60 {
        let found = found(&[(0, 8.0)], 0.0, 500 + seed);
        assert_eq!(found.effects[0].name, "slope", "{}", found.summary);
        let check = found.predictive_check.expect("a check");
        failed += usize::from(!check.passed);
        shares.extend(check.runs.iter().map(|run| run.leave_as_much as f64 / run.draws as f64));
        // Of the nominal model no lap leaves as much.
        assert!(check.no_gap.iter().all(|run| run.leave_as_much == 0));
    }
    // 3/41 of 60 are 4.4; more than 11 are rarer than once in a thousand.
    assert!(failed <= 11, "{failed} of 60");
    // Evenly distributed shares have a mean of one half, here within 0.022.
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    assert!((mean - 0.5).abs() < 0.075, "{mean}");
}

#[test]
fn effects_with_one_signature_are_a_group() {
    let found = found(&[(1, 4.0)], 0.0, 8);
    let group = found.groups.first().expect("a group");
    let mut members = group.members.clone();
    members.sort_unstable();
    assert_eq!(members, ["twin", "wave"]);
    assert!(found.effects[..2].iter().all(|e| e.group == group.name), "{:?}", &found.effects[..2]);
}

#[test]
fn the_gap_lies_where_it_was_put() {
    let found = found(&[(4, 6.0)], 0.0, 9);
    let worst = &found.places[0];
    assert!(
        (worst.extent.ends().0 - 30.0).abs() <= 2.0 && (worst.extent.ends().1 - 45.0).abs() <= 2.0 && worst.share > 0.2,
        "{worst:?}"
    );
    let shares: f64 = found.places.iter().map(|p| p.share).sum();
    assert!(shares <= 1.0 + 1e-9);
}

#[test]
fn what_chance_does_is_found_by_how_laps_scatter() {
    let mut made = made(&[(ROUGH, 4.0)], 0.0, 10);
    let found = diagnose(&made, &Settings::default(), &mut |_| {});
    let first = &found.effects[0];
    assert_eq!((found.verdict, first.name.as_str()), (Verdict::Effect, "rough"), "{}", found.summary);
    let amount = &first.strength["size"];
    assert!(amount.low <= 4.0 && 4.0 <= amount.high && (amount.value / 4.0 - 1.0).abs() < 0.25, "{amount:?}");
    // A repeatability that is raised fourfold counts as left: (8.5 − 4.1)/(8.5 − 1).
    assert!((first.gap_closed.expect("runs left out") - 0.59).abs() < 0.15, "{first:?}");
    // Whoever does not know how laps scatter cannot name it.
    made.tells = false;
    assert_eq!(diagnose(&made, &Settings::default(), &mut |_| {}).verdict, Verdict::Unknown);
}

#[test]
fn what_all_runs_have_in_common_is_not_what_differs_from_lap_to_lap() {
    let rough = |same: bool| {
        // Offered, but not there; in its place a pattern of its size in its channel.
        let mut made = made(&[(ROUGH, 0.0)], 0.0, 10);
        for (run, frame) in made.frames.iter_mut().enumerate() {
            let mut state = if same { 77 } else { 77 + run as u64 };
            frame.measured[..60].iter_mut().for_each(|x| *x += 4.0 * normal(&mut state));
        }
        let found = diagnose(&made, &Settings::default(), &mut |_| {});
        let named = found.effects.iter().find(|e| e.name == "rough").map_or(0.0, |e| e.probability);
        (named, found.unknown_probability)
    };
    assert!(rough(false).0 > 0.9, "{:?}", rough(false));
    // Something unknown at its place has such a pattern.
    assert!(rough(true).0 < 0.1 && rough(true).1 > 0.8, "{:?}", rough(true));
}

#[test]
fn what_differs_from_cart_to_cart_is_not_told_from_what_sits_along_the_track() {
    let mut made = made(&[(ROUGH, 0.0)], 0.0, 10);
    made.candidates[CandidateId::new(ROUGH)].random_effect = Some(RandomEffect::ByCart);
    for frame in &mut made.frames {
        let mut state = 77;
        frame.measured[..60].iter_mut().for_each(|x| *x += 4.0 * normal(&mut state));
        // Carts are the same in all runs.
        let mut state = 78;
        frame.laps.scatter = (0..40).map(|_| (0..FEATURES).map(|_| normal(&mut state)).collect()).collect();
    }
    let found = diagnose(&made, &Settings::default(), &mut |_| {});
    let rough = found.effects.iter().find(|e| e.name == "rough").map_or(0.0, |e| e.probability);
    assert!(rough > 0.2 && found.unknown_probability > 0.2, "{rough} and {}", found.unknown_probability);
}

#[test]
fn a_nuisance_that_is_not_linear_does_not_bend_strengths() {
    let mut made = made(&[(1, 4.0)], 0.0, 12);
    made.bent = 60.0;
    let found = diagnose(&made, &Settings::default(), &mut |_| {});
    let first = &found.effects[0];
    let amount = &first.strength["size"];
    assert!(["wave", "twin"].contains(&first.name.as_str()) && first.probability > 0.4, "{}", found.summary);
    assert!((amount.value / 4.0 - 1.0).abs() < 0.15, "{amount:?}");
    assert!(first.gap_closed.expect("runs left out") > 0.9, "{first:?}");
}

/// What is asked keeps to the bounds, where they hold less than the truth, one sign only, or hardly more than the
/// trial.
#[test]
fn no_strength_beyond_its_bounds_is_ever_asked_for() {
    for (low, high, trial) in
        [(-10.0, 10.0, 1.0), (0.0, 10.0, 1.0), (-10.0, 0.0, -1.0), (0.0, 1.1, 1.0), (-0.3, 0.9, 0.9)]
    {
        for truth in [&[(0, 30.0)][..], &[(0, -30.0)], &[(1, 25.0), (6, -20.0)], &[(0, 1.3)]] {
            let mut made = made(truth, 0.0, 21);
            for strength in made.candidates.iter_mut().flat_map(|c| &mut c.strengths) {
                (strength.low, strength.high, strength.trial) = (low, high, trial);
            }
            let found = diagnose(&made, &Settings::default(), &mut |_| {});
            for (candidate, x) in made.asked.lock().unwrap().iter() {
                assert!((low..=high).contains(x), "candidate {candidate} at {x} of {low} to {high}");
            }
            for amount in found.effects.iter().flat_map(|f| f.strength.values()) {
                let at = amount.value != 0.0 && (amount.value == high || amount.value == low);
                assert!((low..=high).contains(&amount.value) && at == amount.at_bound.is_some(), "{amount:?}");
            }
        }
    }
}

#[test]
fn a_strength_at_its_bound_says_so() {
    let mut made = made(&[(0, 30.0)], 0.0, 21);
    made.candidates[CandidateId::new(0)].strengths[0].high = 25.0;
    let found = diagnose(&made, &Settings::default(), &mut |_| {});
    let first = &found.effects[0];
    assert_eq!((first.name.as_str(), first.strength["size"].value), ("slope", 25.0), "{}", found.summary);
    assert_eq!(first.strength["size"].at_bound, Some(Bound::Upper));
    assert!(found.summary.contains("slope is at its upper bound, 25 m"), "{}", found.summary);
    assert!(!found.summary.contains("explains the gap"), "{}", found.summary);
}

/// The cause cannot be simulated: nothing else is sure, and it is named with what was asked.
#[test]
fn what_cannot_be_simulated_is_not_ruled_out() {
    let sure = found(&[(1, 4.0)], 0.0, 8);
    let twin = |d: &Diagnosis| d.effects.iter().find(|f| f.name == "twin").cloned().expect("an effect");
    assert!(!twin(&sure).untested() && sure.lost.is_empty() && sure.untested_probability == 0.0);
    for how in [Failure::NoAnswer, Failure::NotFinite, Failure::InOneRun] {
        let mut made = made(&[(1, 4.0)], 0.0, 8);
        made.fails = Some((1, how));
        let found = diagnose(&made, &Settings::default(), &mut |_| {});
        let wave = found.effects.iter().find(|f| f.name == "wave").expect("an effect");
        assert!(wave.untested() && wave.strength.is_empty(), "{wave:?}");
        // Both have one place and one strength: the untested one has as much as the best.
        let others = found.effects.iter().filter(|f| f.name != "wave").map(|f| f.probability);
        assert!(others.fold(0.0, f64::max) < 0.55 && wave.probability > 0.3, "{:#?}", found.effects);
        let lost = found.lost.first().expect("a loss");
        assert_eq!(
            (lost.effect.as_str(), lost.strength["size"], lost.run.is_empty()),
            ("wave", 1.0, false),
            "{lost:?}"
        );
        assert!(found.summary.contains("Not ruled out, as it could not be simulated: wave"), "{}", found.summary);
        assert!(!found.named().iter().any(|f| f.name == "wave"));
    }
}

/// A second member of which the interval holds 0 is none: the first one stands alone.
#[test]
fn a_member_that_may_be_absent_is_not_named() {
    let pair = |discrepancy: f64| {
        let mut made = made(&[(0, 8.0), (6, 3.0)], 0.0, 6);
        made.candidates[CandidateId::new(6)].discrepancy = discrepancy;
        diagnose(&made, &Settings::default(), &mut |_| {})
    };
    assert_eq!(pair(0.0).verdict, Verdict::Pair);
    let found = pair(2.0);
    let names: Vec<&str> = found.named().iter().map(|f| f.name.as_str()).collect();
    assert!(!names.contains(&"sensor") && found.verdict != Verdict::Pair, "{}", found.summary);
    assert!(
        !found.summary.contains("explains the gap") && !found.summary.contains("explain the gap"),
        "{}",
        found.summary
    );
    for finding in found.named() {
        assert!(finding.strength.values().any(|a| !a.may_be_zero()), "{finding:?}");
    }
}

#[test]
fn what_is_drawn_is_what_ranks_first() {
    for (truth, first) in [(&[(0, 8.0)][..], "a"), (&[(6, 6.0)], "b"), (&[(4, 6.0)], "a")] {
        let found = found(truth, 0.0, 15);
        let ranked: Vec<String> = found.channels().into_iter().map(|(channel, _)| channel).collect();
        let drawn: Vec<&String> = found.overlays.iter().map(|o| &o.channel).collect();
        assert_eq!(drawn, ranked.iter().take(4).collect::<Vec<_>>());
        assert_eq!(ranked.first().map(String::as_str), Some(first), "{:?}", found.places);
    }
}

/// The page of a diagnosis in a browser; skipped where there is none.
#[test]
fn its_page_has_one_cursor_for_curves_rows_and_plan() {
    let Some(browser) = ResultPage::start() else { return };
    let found = found(&[(4, 6.0)], 0.0, 15);
    let length = found.places.iter().map(|p| p.extent.ends().1).fold(0.0, f64::max);
    let straight = || CentreLinePiece::Straight { length: 0.4 * length, slope: 0.0 };
    let arc = || CentreLinePiece::Arc { radius: 0.1 * length / trig::PI, turn_deg: 180.0 };
    let elements = vec![straight(), arc(), straight(), arc()];
    let track = Track { name: "oval".into(), start: [0.0; 4], elements };
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("gap.html");
    std::fs::write(&page, lss::report::gap::page(&found, Some(&track), "made")).unwrap();
    browser.hold(&page);
    browser.open(&page, (1400, 900), false);
    let plots = browser.number("page.curves.size") as usize;
    assert_eq!(plots, 2 * found.overlays.len());
    assert!(plots > 0);
    // Over the rows, a fifth of the way.
    let (x, y) = browser.middle(".strip .row-of:nth-child(2) .row-scale");
    let width = browser.number("document.querySelector('.strip .row-of:nth-child(2) .row-scale').clientWidth");
    browser.mouse("mouseMoved", x - 0.3 * width, y);
    let place = browser.number("page.links.get('track').value");
    assert!((place - 0.2 * length).abs() < 0.01 * length, "{place} of {length}");
    browser.ask("page.stage.view.draw()");
    let dot = browser.ask("page.stage.view.shownAt");
    let there = browser.ask("page.stage.view.at(page.stage.line.at(page.links.get('track').value))");
    assert_eq!(dot, there);
    assert_eq!(browser.errors(), Vec::<String>::new());
}
