//! Waves with changeovers and with shares of their own.

use super::super::waves::drawn;
use super::*;

fn waves(minutes: f64, changeover: f64) -> Waves {
    Waves { every: 60.0 * minutes, changeover, spread: 0.0, each: Vec::new() }
}

fn wave(name: &str, shares: &[f64]) -> Wave {
    Wave { name: name.to_owned(), shares: shares.to_vec() }
}

fn settings(hours: f64) -> Settings {
    Settings { hours, replications: 3, seed: 5, threads: 2, stop: Stop::NEVER }
}

/// One induction with chutes all around, closed for c, not longer than a lap L. A carrier that goes by loaded is one that the
/// induction cannot load. Of the items on the sorter, c - c²/2L times Q are due while chutes are closed; of the carriers that
/// reach the induction after t, 1 - t/L are free and get an item, which is due in time to find its chute closed with
/// probability (c - t)/L. Together they cost c - c³/6L² of the time.
#[test]
fn a_changeover_costs_a_little_less_than_its_time() {
    let places: Vec<f64> = (0..50).map(|k| 1.25 + 2.5 * f64::from(k)).collect();
    let mut sorter = sorter(100, &[0.0], &places);
    let lap = 62.5;
    for changeover in [10.0, 30.0, 50.0, lap] {
        sorter.waves = Some(waves(10.0, changeover));
        let lost = changeover - changeover * changeover * changeover / (6.0 * lap * lap);
        let measured = measure(&sorter, &settings(20.0));
        near(measured.throughput.value, Q * (1.0 - lost / 600.0), 1e-3);
        near(measured.closed * measured.throughput.value, Q * lost / 600.0, 0.03);
        // Nobody is given out elsewhere, and nothing is full.
        assert_eq!((measured.refused, measured.misplaced), (0.0, 0.0));
        // What was on the sorter when it began is lost to any way of feeding.
        let due = changeover - changeover * changeover / (2.0 * lap);
        near(bound(&sorter, Some(&[1.0])).unwrap().throughput, Q / (1.0 + due / 600.0), 1e-3);
    }
    // After a lap every carrier is loaded: each second more is lost.
    let lost = |changeover: f64| {
        let mut sorter = sorter.clone();
        sorter.waves = Some(waves(10.0, changeover));
        600.0 * (1.0 - measure(&sorter, &settings(20.0)).throughput.value / Q)
    };
    near(lost(5.0 * lap) - lost(2.0 * lap), 3.0 * lap, 0.01);
}

/// Few items: one meets its chute closed as often as the changeover's share of time is, and a lap later no more.
#[test]
fn an_item_meets_a_closed_chute_by_chance() {
    let mut sorter = sorter(100, &[0.0], &[30.0, 60.0, 90.0]);
    sorter.inductions[0].demand = Some(0.05 * Q);
    sorter.waves = Some(waves(10.0, 50.0));
    let measured = measure(&sorter, &settings(400.0));
    near(measured.closed, 50.0 / 600.0, 0.03);
    near(measured.throughput.value, 0.05 * Q, 0.01);
    // Two laps and a half: those that come in the last lap of it miss one, a lap before two, in the first half lap three.
    sorter.waves = Some(waves(10.0, 2.5 * 62.5));
    let measured = measure(&sorter, &settings(400.0));
    near(measured.closed, 62.5 / 600.0 * (1.0 + 2.0 + 0.5 * 3.0), 0.03);
}

/// Each chute holds so many until the wave's end: the one with the largest share fills first, in the wave in which that share
/// is largest. What is beyond that may wait on the hundred carriers for the next wave.
#[test]
fn the_busiest_chute_of_the_worst_wave_limits() {
    let mut sorter = sorter(100, &[0.0], &[30.0, 60.0, 90.0]);
    sorter.waves =
        Some(Waves { each: vec![wave("even", &[1.0, 1.0, 1.0]), wave("odd", &[3.0, 1.0, 1.0])], ..waves(30.0, 120.0) });
    sorter.chutes.iter_mut().for_each(|c| c.storage = Some((300, f64::INFINITY)));
    let found = bound(&sorter, Some(&[1.0])).unwrap();
    let [even, odd] = &found.waves[..] else { panic!("{found:?}") };
    near(even.share, 1.0 / 3.0, 1e-12);
    near(even.fits, 2.0 * 900.0, 1e-12);
    near(even.throughput, 2.0 * (900.0 + 100.0), 1e-12);
    assert_eq!((odd.limit, odd.busiest, found.limit), (Limit::Chute(0), 0, Limit::Chute(0)));
    near(odd.share, 0.6, 1e-12);
    near(odd.fits, 2.0 * 300.0 / 0.6, 1e-12);
    near(odd.throughput, 2.0 * (300.0 + 100.0) / 0.6, 1e-12);
    near(found.throughput, 0.5 * (even.throughput + odd.throughput), 1e-12);
    // Fewer come than fit: all are given out, in their chutes. More come: no chute takes more than it holds.
    for (demand, expected) in [(950.0, 950.0), (5000.0, f64::INFINITY)] {
        sorter.inductions[0].demand = Some(demand);
        let measured = measure(&sorter, &settings(40.0));
        if expected.is_finite() {
            near(measured.throughput.value, expected, 0.01);
            assert!(measured.refused < 0.05, "{}", measured.refused);
        } else {
            assert!(measured.chutes.iter().all(|(rate, _)| *rate <= 600.0 + 1e-9));
            assert!(measured.refused > 1.0, "{}", measured.refused);
        }
    }
    // Taken away in between, too: so much more fits.
    sorter.chutes.iter_mut().for_each(|c| c.storage = Some((300, 12.0)));
    let found = bound(&sorter, Some(&[1.0])).unwrap();
    near(found.waves[1].fits, 2.0 * (300.0 + 1680.0 / 12.0) / 0.6, 1e-12);
}

/// Shares by wave: each chute is given what the waves say, and each wave what it can.
#[test]
fn waves_take_turns() {
    let mut sorter = sorter(100, &[0.0, 62.5], &[20.0, 40.0, 80.0, 100.0]);
    sorter.waves = Some(Waves {
        each: vec![wave("both", &[1.0, 1.0, 1.0, 1.0]), wave("one", &[1.0, 1.0, 0.0, 0.0])],
        ..waves(60.0, 0.0)
    });
    let measured = measure(&sorter, &settings(60.0));
    // 4/3 for any chute. Where all leave in the first zone, each uses a carrier behind the first induction.
    near(measured.waves[0], 4.0 / 3.0 * Q, 0.02);
    near(measured.waves[1], Q, 0.02);
    near(measured.throughput.value, 0.5 * (measured.waves[0] + measured.waves[1]), 2e-3);
    let share = |c: usize| measured.chutes[c].0 / measured.chutes.iter().map(|c| c.0).sum::<f64>();
    near(share(2), 0.25 * 4.0 / 3.0 / (7.0 / 3.0), 0.02);
    near(share(0), (0.25 * 4.0 / 3.0 + 0.5) / (7.0 / 3.0), 0.02);
}

/// Equal shares that are drawn with a coefficient of variation of 1 are a stick broken at random: the largest of n pieces is
/// (1 + 1/2 + ... + 1/n) / n in the mean (David and Nagaraja 2003).
#[test]
fn drawn_shares_have_their_spread() {
    let mut random = Random::new(4);
    let n = 25;
    let largest = |random: &mut Random| {
        let shares = drawn(vec![1.0; n], 1.0, random);
        shares.iter().copied().fold(0.0, f64::max) / shares.iter().sum::<f64>()
    };
    let mean = (0..20_000).map(|_| largest(&mut random)).sum::<f64>() / 20_000.0;
    let harmonic: f64 = (1..=n).map(|k| 1.0 / k as f64).sum();
    near(mean, harmonic / n as f64, 5e-3);
    // And any other spread: mean 1, and that variance.
    for spread in [0.3, 0.8, 1.5] {
        let all = drawn(vec![1.0; 400_000], spread, &mut random);
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let variance = all.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / all.len() as f64;
        near(mean, 1.0, 0.01);
        near(variance.sqrt(), spread, 0.02);
    }
    assert_eq!(drawn(vec![1.0, 2.0], 0.0, &mut random), [1.0, 2.0]);
}

/// Chutes that hold what a wave brings in the mean are too small for most waves of drawn shares.
#[test]
fn drawn_shares_cost_what_the_closed_form_says() {
    let places: Vec<f64> = (0..25).map(|k| 20.0 + 4.0 * f64::from(k)).collect();
    let mut sorter = sorter(100, &[0.0], &places);
    sorter.waves = Some(Waves { spread: 1.0, ..waves(30.0, 60.0) });
    sorter.chutes.iter_mut().for_each(|c| c.storage = Some((200, f64::INFINITY)));
    let found = bound(&sorter, Some(&[1.0])).unwrap();
    let harmonic: f64 = (1..=25).map(|k| 1.0 / f64::from(k)).sum();
    near(found.waves[0].share, harmonic / 25.0, 0.05);
    // 200 items at most into the busiest chute: no wave takes more than 400 an hour over its share, so neither does the mean
    // over waves more than 400 times the mean of 1 / share.
    let fits = found.waves[0].fits;
    assert!(fits < 400.0 * 25.0 && fits > 400.0 * 25.0 / harmonic && fits < found.throughput);
    // Fewer come than fit in the mean: they are given out, if some of them in the next wave.
    sorter.inductions[0].demand = Some(0.8 * fits);
    let measured = measure(&sorter, &settings(60.0));
    near(measured.throughput.value, 0.8 * fits, 0.01);
}

#[test]
fn waves_are_the_same_on_any_thread_and_with_any_demand() {
    let mut sorter = sorter(80, &[0.0, 50.0], &[30.0, 60.0, 90.0]);
    sorter.waves = Some(Waves { spread: 0.5, ..waves(20.0, 60.0) });
    let settings = Settings { hours: 3.0, replications: 4, ..Settings::default() };
    assert_eq!(measure(&sorter, &settings), measure(&sorter, &Settings { threads: 3, ..settings }));
    let causes: Vec<Cause> =
        costs(&sorter, &measure(&sorter, &settings), &settings).into_iter().map(|c| c.cause).collect();
    assert_eq!(causes, [Cause::Changeover, Cause::Shares]);
}

/// With waves no way of feeding beats the closed form, in the proportions in which items got on, and with chutes that fail
/// none did here by a hundredth.
#[test]
fn the_bound_holds_with_waves_and_failures() {
    let mut random = Random::new(17);
    for _ in 0..40 {
        let mut pick = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mut sorter = any_sorter(&mut pick);
        for induction in &mut sorter.inductions {
            induction.demand = Some(pick(500.0, 6000.0));
            induction.most = pick(2000.0, 9000.0);
        }
        let kind = pick(0.0, 1.0);
        if kind < 0.7 {
            let every = 60.0 * pick(5.0, 30.0);
            let each = (0..pick(0.0, 3.0) as usize)
                .map(|k| wave(&k.to_string(), &sorter.chutes.iter().map(|_| pick(0.1, 1.0)).collect::<Vec<_>>()))
                .collect();
            sorter.waves = Some(Waves { every, changeover: every * pick(0.0, 0.3), spread: 0.0, each });
        }
        if pick(0.0, 1.0) < 0.5 {
            let storage = Some((pick(5.0, 200.0) as usize, pick(3.0, 60.0)));
            sorter.chutes.iter_mut().for_each(|c| c.storage = storage);
        }
        if kind > 0.4 {
            for chute in &mut sorter.chutes {
                let (between, duration) = (pick(3000.0, 9000.0), pick(20.0, 400.0));
                chute.fails = Some(Failures { name: String::new(), between, duration });
            }
        }
        let hours = 60.0;
        let seen = simulate(&sorter, &Plan { duration: 3600.0 * hours, seed: 11, interval: 60.0 }, Stop::NEVER);
        let taken: Vec<f64> = seen.counts.inductions.iter().map(|i| i.items as f64).collect();
        // What is left at the end, on carriers and in chutes, is not through.
        let left: usize = sorter.chutes.iter().filter_map(|c| c.storage).map(|(count, _)| count).sum();
        let found = (taken.iter().sum::<f64>() - (left + sorter.carriers) as f64) / hours;
        let bound = bound(&sorter, Some(&taken)).unwrap().throughput;
        assert!(found <= 1.01 * bound, "{found} {bound} {sorter:?}");
    }
}
