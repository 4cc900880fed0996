//! Inductions, chutes and scanners that fail.

use super::*;
use crate::base::trig;

fn fails(between: f64, duration: f64) -> Option<Failures> {
    Some(Failures { name: "it".to_owned(), between, duration })
}

fn settings(hours: f64) -> Settings {
    Settings { hours, replications: 4, seed: 5, threads: 2, stop: Stop::NEVER }
}

/// b / (b + d) (Barlow and Proschan 1965), of carriers that pass and of items.
#[test]
fn an_induction_works_for_its_availability() {
    let mut sorter = sorter(100, &[0.0], &[30.0, 60.0]);
    sorter.inductions[0].fails = fails(600.0, 100.0);
    let available = 600.0 / 700.0;
    let measured = measure(&sorter, &settings(250.0));
    near(measured.available[0], available, 8e-3);
    near(measured.throughput.value, available * Q, 8e-3);
    let found = bound(&sorter, Some(&[1.0])).unwrap();
    near(found.throughput, available * Q, 1e-9);
    assert_eq!(found.limit, Limit::Induction(0));
    // A slow one loses the same share of what it can put on carriers.
    sorter.inductions[0].most = 2000.0;
    near(bound(&sorter, Some(&[1.0])).unwrap().throughput, available * 2000.0, 1e-9);
    near(measure(&sorter, &settings(250.0)).throughput.value, available * 2000.0, 8e-3);
}

/// Repairs that take many laps: the sorter of two zones has both inductions, one, or none, and each of these as often as the
/// availabilities say.
#[test]
fn the_other_induction_uses_the_carriers() {
    let mut sorter = sorter(100, &[0.0, 62.5], &[20.0, 40.0, 80.0, 100.0]);
    sorter.inductions.iter_mut().for_each(|i| i.fails = fails(6000.0, 1000.0));
    let a = 6.0 / 7.0;
    let expected = a * a * 4.0 / 3.0 * Q + 2.0 * a * (1.0 - a) * Q;
    near(measure(&sorter, &settings(500.0)).throughput.value, expected, 0.01);
    assert!(bound(&sorter, Some(&[1.0, 1.0])).unwrap().throughput > expected);
}

/// Few items, which find carriers whatever goes round: each meets its chute down with probability 1 - A, and again after a
/// lap with that of a Markov process with two states.
#[test]
fn items_go_round_while_their_chute_is_down() {
    for (between, duration) in [(2000.0, 30.0), (900.0, 100.0), (3000.0, 600.0)] {
        let mut sorter = sorter(100, &[0.0], &[30.0, 60.0, 90.0]);
        sorter.inductions[0].demand = Some(0.03 * Q);
        sorter.chutes[1].fails = fails(between, duration);
        let measured = measure(&sorter, &settings(6000.0));
        let down = duration / (between + duration);
        let again = down + (1.0 - down) * trig::exp(-(1.0 / between + 1.0 / duration) * 62.5);
        near(measured.down, down / (1.0 - again) / 3.0, 0.04);
        near(sorter.chutes[1].fails.as_ref().unwrap().laps(62.5, usize::MAX), down / (1.0 - again), 1e-9);
        // Of the items that come, with those that go round.
        near(measured.chutes_down[1], measured.down / (measured.down + 1.0 / 3.0), 0.04);
        near(measured.throughput.value, 0.03 * Q, 0.01);
        assert_eq!((measured.refused, measured.closed, measured.misplaced), (0.0, 0.0, 0.0));
    }
}

/// An item that made its laps leaves at the next chute.
#[test]
fn laps_are_no_more_than_are_allowed() {
    let mut sorter = sorter(100, &[0.0], &[30.0, 60.0, 90.0]);
    sorter.inductions[0].demand = Some(0.03 * Q);
    sorter.items.most_laps = 2;
    sorter.chutes[1].fails = fails(3000.0, 600.0);
    let measured = measure(&sorter, &settings(3000.0));
    near(measured.down, sorter.chutes[1].fails.as_ref().unwrap().laps(62.5, 2) / 3.0, 0.05);
    let again = sorter.chutes[1].fails.as_ref().unwrap().still_down(62.5);
    // Those that were down twice, when they first came and a lap later.
    near(measured.misplaced, 600.0 / 3600.0 * again / 3.0, 0.05);
}

/// Items at any time: what goes round for a chute takes the room of what follows.
#[test]
fn failing_chutes_cost_carriers() {
    for (count, between, duration) in [(40, 7200.0, 120.0), (40, 7200.0, 600.0), (12, 7200.0, 600.0)] {
        let places: Vec<f64> = (0..count).map(|k| 20.0 + 90.0 * f64::from(k) / f64::from(count)).collect();
        let mut sorter = sorter(100, &[0.0], &places);
        sorter.chutes.iter_mut().for_each(|c| c.fails = fails(between, duration));
        let measured = measure(&sorter, &settings(600.0));
        let found = bound(&sorter, Some(&[1.0])).unwrap();
        assert!(found.throughput < 0.99 * Q);
        near(measured.throughput.value, found.throughput, 0.02);
        // The lost carriers are those that go round.
        near(measured.throughput.value * (1.0 + measured.down), Q, 2e-3);
    }
}

/// A sorter with one scanner takes nothing while that is down, whatever laps a repair takes.
#[test]
fn nothing_leaves_while_the_only_scanner_is_down() {
    for (between, duration) in [(7200.0, 600.0), (7200.0, 60.0), (1800.0, 20.0)] {
        let mut sorter = sorter(100, &[0.0], &[30.0, 60.0, 90.0]);
        sorter.scanners = vec![Scanner { s: 5.0, fails: fails(between, duration) }];
        let found = bound(&sorter, None).unwrap();
        near(found.throughput, Q * between / (between + duration), 1e-9);
        let measured = measure(&sorter, &settings(400.0));
        near(measured.throughput.value, found.throughput, 0.01);
        // Each item uses the carriers of the laps that it made.
        near(measured.throughput.value * (1.0 + measured.unread), Q, 3e-3);
        assert_eq!((measured.refused, measured.down, measured.misplaced), (0.0, 0.0, 0.0));
    }
}

/// Two scanners behind each other read for each other; two of zones do so a zone later, so that a sorter of two zones takes
/// 4/3 Q with both, less with one, and nothing with none.
#[test]
fn other_scanners_read_what_one_that_is_down_does_not() {
    let mut both = sorter(100, &[0.0], &[30.0, 60.0, 90.0]);
    both.scanners = [5.0, 6.0].map(|s| Scanner { s, fails: fails(6000.0, 1000.0) }).into();
    let none = 1.0 / 49.0;
    near(bound(&both, None).unwrap().throughput, (1.0 - none) * Q, 1e-6);
    near(measure(&both, &settings(400.0)).throughput.value, (1.0 - none) * Q, 0.01);
    let mut zones = sorter(100, &[0.0, 62.5], &[20.0, 40.0, 80.0, 100.0]);
    zones.scanners = [5.0, 67.5].map(|s| Scanner { s, fails: fails(6000.0, 1000.0) }).into();
    let mut one = zones.clone();
    one.scanners = scanners(&[67.5]);
    let (works, with_one) = (6.0 / 7.0, bound(&one, None).unwrap().throughput);
    let expected = works * works * 4.0 / 3.0 * Q + 2.0 * works * (1.0 - works) * with_one;
    near(bound(&zones, None).unwrap().throughput, expected, 1e-6);
    near(measure(&zones, &settings(500.0)).throughput.value, expected, 0.02);
}

/// A closed form of thirty scanners does not look at all their states.
#[test]
fn many_scanners_have_few_likely_states() {
    let mut many = sorter(100, &[0.0], &[60.0, 90.0]);
    many.scanners = (0..30).map(|k| Scanner { s: 5.0 + f64::from(k), fails: fails(6000.0, 1000.0) }).collect();
    near(bound(&many, None).unwrap().throughput, Q, 1e-9);
    many.scanners[1..].iter_mut().for_each(|scanner| scanner.fails = None);
    near(bound(&many, None).unwrap().throughput, Q, 1e-9);
}

/// Where items leave after some laps, they do so at any chute while nothing is read.
#[test]
fn items_that_nothing_reads_leave_after_their_laps() {
    let mut sorter = sorter(100, &[0.0], &[30.0, 60.0, 90.0]);
    sorter.scanners = vec![Scanner { s: 5.0, fails: fails(6000.0, 3000.0) }];
    sorter.items.most_laps = 2;
    let measured = measure(&sorter, &settings(500.0));
    let found = bound(&sorter, None).unwrap().throughput;
    // Then, items for the last chute pass the induction thrice, the others twice.
    near(found, (2.0 / 3.0 + 1.0 / 7.0) * Q, 1e-6);
    near(measured.throughput.value, found, 0.02);
    assert!(measured.misplaced > 0.1);
    // Both readings of a lap that fail are one lap in vain.
    sorter.scanners = scanners(&[5.0, 6.0]);
    sorter.items = Items { no_read: 0.5, ..Items::default() };
    near(measure(&sorter, &settings(20.0)).unread, 0.25 / 0.75, 0.02);
}

/// The items that come do not depend on what fails, and what fails not on what comes.
#[test]
fn failures_have_random_numbers_of_their_own() {
    let mut sorter = sorter(80, &[0.0, 50.0], &[30.0, 60.0, 90.0]);
    sorter.inductions.iter_mut().for_each(|i| i.demand = Some(1500.0));
    let plan = Plan { duration: 20.0 * 3600.0, seed: 9, interval: 60.0 };
    let before = simulate(&sorter, &plan, Stop::NEVER);
    sorter.inductions[1].fails = fails(3000.0, 300.0);
    let came = |seen: &super::super::simulate::Seen| -> Vec<u64> {
        seen.counts.inductions.iter().zip(&seen.queues).map(|(i, queue)| i.items + *queue as u64).collect()
    };
    let failing = simulate(&sorter, &plan, Stop::NEVER);
    for (a, b) in came(&before).iter().zip(came(&failing)) {
        assert!(a.abs_diff(b) <= 1, "{a} {b}");
    }
    assert!(failing.counts.inductions[0].down == 0 && failing.counts.inductions[1].down > 0);
    sorter.inductions[1].demand = Some(700.0);
    sorter.chutes[0].fails = fails(3000.0, 300.0);
    assert_eq!(simulate(&sorter, &plan, Stop::NEVER).counts.inductions[1].down, failing.counts.inductions[1].down);
    let settings = Settings { hours: 5.0, replications: 4, ..Settings::default() };
    assert_eq!(measure(&sorter, &settings), measure(&sorter, &Settings { threads: 3, ..settings }));
}

/// What a failure costs is what is won without it.
#[test]
fn costs_are_those_of_the_sorter_without() {
    let mut sorter = sorter(100, &[0.0], &[30.0, 60.0]);
    sorter.inductions[0].fails = fails(3000.0, 300.0);
    sorter.stops = Some(Stops { between: 3600.0, duration: 360.0 });
    let settings = settings(200.0);
    let costs = costs(&sorter, &measure(&sorter, &settings), &settings);
    let [stops, failures] = &costs[..] else { panic!("{costs:?}") };
    assert_eq!((&stops.cause, &failures.cause), (&Cause::Stops, &Cause::Failures("it".to_owned())));
    let (running, working) = (1.0 / 1.1, 1.0 / 1.1);
    for (cost, expected) in [(stops, working * (1.0 - running) * Q), (failures, running * (1.0 - working) * Q)] {
        near(cost.per_hour.value, expected, 0.1);
    }
}

/// What is no bound is not called one: chutes that fail make it a mean, and so does leaving full ones for others.
#[test]
fn a_mean_is_told_as_about() {
    let mut plain = sorter(100, &[0.0], &[30.0, 60.0]);
    let words = |sorter: &Sorter| most_words(sorter, &bound(sorter, Some(&[1.0])).unwrap());
    assert_eq!(words(&plain), "at most");
    plain.inductions[0].fails = fails(900.0, 100.0);
    assert_eq!(words(&plain), "at most");
    let mut failing = plain.clone();
    failing.chutes[1].fails.clone_from(&plain.inductions[0].fails);
    assert_eq!(words(&failing), "about");
    let mut full = plain;
    full.chutes.iter_mut().for_each(|chute| chute.storage = Some((5, 30.0)));
    assert_eq!(words(&full), "at most");
    full.items.most_laps = 3;
    assert_eq!(words(&full), "about");
}
