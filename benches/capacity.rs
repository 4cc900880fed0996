//! Item events a second of the simulation of a sorter's capacity, on one core: `cargo bench --bench capacity`.
//!
//! An event is an item that comes, is put on a carrier, read, given out, or refused. Beside the plain sorter: with waves whose
//! shares are drawn, and with failures of every induction and chute.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::capacity::sorter::{Chute, Failures, Induction, Items, Scanner, Stops, Waves};
use lss::capacity::{Settings, Sorter, measure};
use std::time::Instant;

/// Two zones with fifteen chutes each and everything that a layout may say.
fn sorter() -> Sorter {
    let induction = |s: &f64| Induction {
        name: String::new(),
        s: *s,
        demand: None,
        most: 5000.0,
        efficiency: 0.97,
        to: None,
        fails: None,
    };
    let chute = |k: u32| Chute {
        name: String::new(),
        s: 12.0 + 88.2 * f64::from(k % 2) + 2.4 * f64::from(k / 2),
        share: 1.0,
        storage: Some((25, 12.0)),
        fails: None,
    };
    Sorter {
        carriers: 147,
        pitch: 1.2,
        speed: 2.2,
        inductions: [2.0, 90.0].iter().map(induction).collect(),
        chutes: (0..30).map(chute).collect(),
        scanners: [6.0, 94.0].map(|s| Scanner { s, fails: None }).into(),
        items: Items { double: 0.04, no_read: 0.01, most_laps: 6 },
        stops: Some(Stops { between: 14_400.0, duration: 240.0 }),
        waves: None,
    }
}

fn main() {
    let plain = sorter();
    let waves = Some(Waves { every: 1800.0, changeover: 120.0, spread: 0.3, each: Vec::new() });
    let waved = Sorter { waves, ..plain.clone() };
    let mut failing = waved.clone();
    let fails = Some(Failures { name: String::new(), between: 14_400.0, duration: 600.0 });
    failing.inductions.iter_mut().for_each(|i| i.fails.clone_from(&fails));
    failing.chutes.iter_mut().for_each(|c| c.fails.clone_from(&fails));
    println!("{:>24}  {:>12}  {:>10}  {:>14}", "", "events", "s", "events/s");
    for (name, sorter) in [("plain", plain), ("waves", waved), ("waves and failures", failing)] {
        let begin = Instant::now();
        let measured = measure(&sorter, &Settings { hours: 200.0, replications: 4, ..Settings::default() });
        let seconds = begin.elapsed().as_secs_f64();
        println!("{name:>24}  {:>12}  {seconds:>10.2}  {:>14.0}", measured.events, measured.events as f64 / seconds);
    }
}
