//! Proportions that the inductions find by themselves, and items that go to some chutes only.

use super::*;

/// Two inductions with chutes all around, a share b of them behind the second: x + (1 - b) y = Q and y + b x = Q, where each
/// fills what the other leaves free, so Q / (1 - b (1 - b)) together, more than 2 Q / (1 + max(b, 1 - b)) in equal parts.
#[test]
fn two_inductions_find_their_proportions() {
    for behind in [1, 3, 5] {
        let places: Vec<f64> =
            (0..10).map(|k| if k < behind { 72.1 + f64::from(k) } else { 10.3 + f64::from(k) }).collect();
        let sorter = sorter(100, &[0.0, 70.0], &places);
        let b = f64::from(behind) / 10.0;
        let expected = Q / (1.0 - b * (1.0 - b));
        let found = bound(&sorter, None).unwrap();
        near(found.throughput, expected, 1e-7);
        near(per_hour(&sorter, 20.0), expected, 5e-3);
        near(found.used[0], 1.0, 1e-6);
        near(found.used[1], 1.0, 1e-6);
        near(bound(&sorter, Some(&[1.0, 1.0])).unwrap().throughput, 2.0 * Q / (1.0 + b.max(1.0 - b)), 1e-9);
    }
}

/// Whatever the sorter, with items at every induction at any time, items that are presorted, chutes that are full, and waves.
#[test]
fn no_way_of_feeding_beats_the_most_of_all_proportions() {
    let mut random = Random::new(8);
    for trial in 0..80 {
        let mut pick = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mut sorter = any_sorter(&mut pick);
        scan(&mut sorter, &mut pick);
        let chutes = sorter.chutes.len();
        for induction in &mut sorter.inductions {
            let factor = |_| if pick(0.0, 1.0) < 0.4 { 0.0 } else { pick(0.2, 1.0) };
            let to: Vec<f64> = (0..chutes).map(factor).collect();
            induction.to = (to.iter().any(|factor| *factor > 0.0)).then_some(to);
            if pick(0.0, 1.0) < 0.3 {
                induction.most = pick(500.0, 4000.0);
            }
        }
        for chute in &mut sorter.chutes {
            chute.share = pick(0.2, 1.0);
            if trial % 2 == 0 && pick(0.0, 1.0) < 0.5 {
                // Few, so that filling them takes little of the hours.
                chute.storage = Some((pick(1.0, 4.0) as usize, pick(2.0, 30.0)));
            }
        }
        if trial % 3 == 0 {
            sorter.waves = Some(Waves { every: 1800.0, changeover: pick(0.0, 120.0), spread: 0.0, each: Vec::new() });
        }
        let found = bound(&sorter, None).unwrap();
        // Which items a chute that is full takes is chance: of n of them, 1/√n of all.
        let settings = Settings { hours: 20.0, replications: 4, seed: 4, threads: 2, stop: Stop::NEVER };
        let Mean { value, half_width } = measure(&sorter, &settings).throughput;
        assert!(value - 2.0 * half_width <= 1.005 * found.throughput, "{value} {} {sorter:?}", found.throughput);
        // No proportions take more.
        for _ in 0..5 {
            let any: Vec<f64> = sorter.inductions.iter().map(|_| pick(0.1, 1.0)).collect();
            let throughput = bound(&sorter, Some(&any)).unwrap().throughput;
            assert!(throughput <= found.throughput * (1.0 + 1e-7), "{throughput} {} {any:?}", found.throughput);
        }
    }
}

/// With chutes that fail, what goes round depends on the throughput: no proportions of a fine grid take more.
#[test]
fn chutes_that_fail_change_the_best_proportions() {
    let mut sorter = sorter(100, &[0.0, 40.0], &[10.3, 20.3, 50.3, 60.3, 70.3, 80.3, 90.3]);
    let fails = Some(Failures { name: String::new(), between: 4.0 * 3600.0, duration: 1800.0 });
    sorter.chutes[..4].iter_mut().for_each(|chute| chute.fails.clone_from(&fails));
    sorter.inductions[0].to = Some(vec![1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
    let found = bound(&sorter, None).unwrap().throughput;
    let of = |k: u32| bound(&sorter, Some(&[f64::from(k), f64::from(1000 - k)])).unwrap().throughput;
    let best = (0..=1000).map(of).fold(0.0, f64::max);
    assert!(found >= best * (1.0 - 1e-6) && found <= best * (1.0 + 3e-3), "{found} {best}");
}

/// Items of an induction go where they are told, in waves too, and nowhere else.
#[test]
fn items_go_to_the_chutes_of_their_induction() {
    let mut sorter = sorter(100, &[0.0, 60.0], &[20.3, 40.3, 80.3, 100.3]);
    sorter.inductions[0].to = Some(vec![3.0, 1.0, 0.0, 0.0]);
    sorter.inductions[1].to = Some(vec![0.0, 0.0, 1.0, 1.0]);
    sorter.inductions.iter_mut().for_each(|i| i.demand = Some(2000.0));
    let settings = Settings { hours: 40.0, ..Settings::default() };
    let measured = measure(&sorter, &settings);
    for (chute, expected) in measured.chutes.iter().zip([1500.0, 500.0, 1000.0, 1000.0]) {
        near(chute.0, expected, 0.02);
    }
    // In every second wave half of the chutes take none.
    let wave = |shares: [f64; 4]| Wave { name: String::new(), shares: shares.to_vec() };
    let each = vec![wave([1.0, 1.0, 1.0, 1.0]), wave([0.0, 1.0, 0.0, 1.0])];
    sorter.waves = Some(Waves { every: 1800.0, changeover: 0.0, spread: 0.0, each });
    let measured = measure(&sorter, &settings);
    for (chute, expected) in measured.chutes.iter().zip([750.0, 1250.0, 500.0, 1500.0]) {
        near(chute.0, expected, 0.03);
    }
}
