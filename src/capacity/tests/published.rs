//! Figures that others published.

use super::*;

/// Zones of one induction and one chute each, with items from anywhere to anywhere.
fn zones(count: usize, carriers: usize, pitch: f64) -> Sorter {
    let lap = pitch * carriers as f64;
    let places = |phase: f64| -> Vec<f64> { (0..count).map(|z| lap * (z as f64 + phase) / count as f64).collect() };
    Sorter { pitch, ..sorter(carriers, &places(0.0), &places(0.5)) }
}

/// "How multiple infeeds increase sorting throughput" (Equinox MHE, a maker of sorters): 12,000 items an hour with one infeed;
/// 15,960 with two, by a factor of 1.33, where items go to any outfeed.
#[test]
fn infeeds_of_a_sorter_of_12000_trays_an_hour() {
    for (count, published) in [(1, 12_000.0), (2, 15_960.0)] {
        let sorter = zones(count, 100, 0.6);
        near(bound(&sorter, Some(&vec![1.0; count])).unwrap().throughput, published, 3e-3);
        let measured = measure(&sorter, &Settings { hours: 10.0, ..Settings::default() });
        near(measured.throughput.value, published, 6e-3);
    }
}

/// The same maker: 24,000 with two, by a factor of 2, where the items of each infeed go to the outfeeds before the other.
#[test]
fn presorted_items_double_it() {
    let mut sorter = zones(2, 100, 0.6);
    for (zone, induction) in sorter.inductions.iter_mut().enumerate() {
        induction.to = Some((0..2).map(|chute| if chute == zone { 1.0 } else { 0.0 }).collect());
    }
    near(bound(&sorter, None).unwrap().throughput, 24_000.0, 1e-6);
    let measured = measure(&sorter, &Settings { hours: 10.0, ..Settings::default() });
    near(measured.throughput.value, 24_000.0, 6e-3);
}

/// Trays filled in a round of 100, over those of one induction zone: a simulation by others (github.com/RandomCoder987/TiltTray,
/// README, a million rounds).
#[test]
fn zones_of_a_simulation_by_others() {
    for (count, published) in
        [(2, 1.333_408), (4, 1.599_835), (5, 1.667_068), (10, 1.818_764), (20, 1.905_234), (50, 1.960_088)]
    {
        let sorter = zones(count, 100, 1.25);
        near(bound(&sorter, Some(&vec![1.0; count])).unwrap().throughput / Q, published, 5e-4);
        let measured = measure(&sorter, &Settings { hours: 4.0, ..Settings::default() });
        near(measured.throughput.value / Q, published, 6e-3);
    }
}

/// Inductions that use each free carrier with probability p (Johnson and Meller 2002): two side by side load 2 p - p² of the
/// carriers, two on opposite sides 4 p / (2 + p), which is more, and more by much with p = 1.
#[test]
fn split_inductions_beat_those_side_by_side() {
    for p in [0.5, 0.8, 1.0] {
        let places: Vec<f64> = (0..40).map(|k| 1.3 + 62.5 * f64::from(k / 20) + 3.0 * f64::from(k % 20)).collect();
        for (second, expected) in [(1.0, 2.0 * p - p * p), (62.5, 4.0 * p / (2.0 + p))] {
            let mut sorter = sorter(100, &[0.0, second], &places);
            sorter.inductions.iter_mut().for_each(|i| i.efficiency = p);
            let measured = measure(&sorter, &Settings { hours: 10.0, ..Settings::default() });
            near(measured.throughput.value / Q, expected, 5e-3);
        }
    }
}
