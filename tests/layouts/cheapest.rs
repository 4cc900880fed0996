//! `optimise cost` against every choice of turns and radii of small random layouts. What pieces cost is counted here by
//! another route, and of straights that close a loop in one way more than they must, the cheapest is where one of them
//! has a length at which pieces change: all those are tried.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::small::{Asked, Random, SHORTEST, STEP, Small, choices, last, layout, random, text};
use lss::compiled::Compiled;
use lss::geometry::PieceKind;
use lss::solve::{Counted, Effort, Options, pareto};

/// The catalogue of `small`, from `standard`: EUR a metre, a piece and a cut of straights; EUR a metre and a piece of
/// curves.
const STRAIGHT: (f64, f64, f64) = (210.0, 60.0, 35.0);
const CURVE: (f64, f64) = (340.0, 140.0);
/// Stock lengths and the steps of a curve's largest piece.
const STOCK: [usize; 4] = [1, 2, 4, 6];
const LARGEST: i32 = 3;
const LONGEST: f64 = 45.0;

/// Fewest stock lengths by sum, both in half metres.
fn fewest() -> Vec<usize> {
    let mut fewest = vec![0];
    for sum in 1..=(2.0 * LONGEST) as usize {
        let shorter = STOCK.iter().filter(|&&s| s <= sum).map(|s| fewest[sum - s] + 1);
        fewest.push(shorter.min().expect("half a metre is on stock"));
    }
    fewest
}

/// What a straight costs, by every number of cuts and every sum of stock lengths beside them.
fn straight(length: f64, fewest: &[usize]) -> f64 {
    let (metre, piece, cut) = STRAIGHT;
    let mut best = f64::INFINITY;
    for cuts in 0..4 {
        for (sum, &count) in fewest.iter().enumerate() {
            let rest = length - 0.5 * sum as f64;
            let (least, most) = (0.2 * f64::from(cuts), 3.0 * f64::from(cuts));
            if rest >= least - 1e-8 && rest <= most + 1e-8 {
                best = best.min(piece * (count as f64 + f64::from(cuts)) + cut * f64::from(cuts));
            }
        }
    }
    metre * length + best
}

fn curves(small: &Small) -> f64 {
    let curve = |(turn, radius): (&i32, &f64)| {
        let arc = radius * (f64::from(turn.abs()) * STEP).to_radians();
        CURVE.0 * arc + CURVE.1 * f64::from((turn.abs() + LARGEST - 1) / LARGEST)
    };
    small.turns.iter().zip(&small.radii).map(curve).sum()
}

/// The cheapest with each metre at so much more, EUR, where one straight is free when two close the loop.
fn cheapest(small: &Small, asked: &Asked, metre: f64, fewest: &[usize]) -> f64 {
    let n = small.turns.len();
    let free: Vec<usize> = (1..n).filter(|&i| !(asked.third && i == 2)).collect();
    assert_eq!(free.len(), 3);
    let fits = |choice: &Small| choice.straights.iter().all(|&s| (SHORTEST - 1e-9..LONGEST - 5.0).contains(&s));
    let mut best = f64::INFINITY;
    choices(small, asked, &mut |choice| {
        let curves = curves(&choice) + metre * (choice.length() - choice.straights.iter().sum::<f64>());
        let mut shortest = f64::INFINITY;
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            let mut choice = choice.clone();
            if choice.close(free[a], free[b]) && fits(&choice) {
                shortest = shortest.min(choice.straights.iter().sum());
            }
        }
        if curves + (metre + STRAIGHT.0 + STRAIGHT.1 / 3.0) * shortest >= best {
            return;
        }
        for k in 0..3 {
            let (a, b) = (free[(k + 1) % 3], free[(k + 2) % 3]);
            for half in 0..(2.0 * LONGEST) as usize {
                for more in [0.0, 0.2, 0.4] {
                    let mut choice = choice.clone();
                    choice.straights[free[k]] = 0.5 * half as f64 + more;
                    if choice.close(a, b) && fits(&choice) {
                        let straights: f64 = choice.straights.iter().map(|&s| straight(s, fewest) + metre * s).sum();
                        best = best.min(curves + straights);
                    }
                }
            }
        }
    });
    best
}

/// Two ends, or one, from the shortest to the cheapest; each the best for its price of a metre.
fn trades(small: &Small, asked: &Asked, fewest: &[usize]) -> usize {
    let layout = layout(&text(small, asked));
    let trades = pareto(&layout, &Options { threads: 1, ..Options::default() }, &|_| {});
    assert!(trades.windows(2).all(|t| t[0].length < t[1].length && t[0].price > t[1].price));
    for trade in trades.iter().filter(|t| t.certificate.as_ref().is_some_and(|c| c.proven)) {
        let Some(metre) = trade.metre else { continue };
        let best = cheapest(small, asked, metre, fewest);
        assert!(trade.price + metre * trade.length >= best - 1e-2);
        for other in &trades {
            assert!(other.price + metre * other.length >= trade.price + metre * trade.length - 1e-2);
        }
    }
    trades.len()
}

#[test]
fn no_choice_of_turns_radii_and_straights_is_cheaper() {
    let mut seeds = Random(23);
    let fewest = fewest();
    let (mut proven, mut met, mut dearer, mut traded, count) = (0, 0, 0, 0, 40);
    for case in 0..count {
        let n = 4 + case % 2;
        let small = random(&mut seeds, n);
        let (goal, metre) = if case % 4 < 2 { ("cost", 0.0) } else { ("2 * cost + 300 * length", 150.0) };
        let asked = Asked { third: n == 5, goal: Some(goal), ..Asked::default() };
        let best = cheapest(&small, &asked, metre, &fewest);
        let Some(stage) = last(&small, &asked, Effort::default()) else { continue };
        let certificate = stage.certificate.clone().expect("a certificate");
        assert_eq!(certificate.counted, Counted::Price { metre });
        assert!(certificate.lower_bound <= best + 1e-4, "{case}: {certificate:?} {best}\n{}", text(&small, &asked));
        if let Some(hasty) = last(&small, &asked, Effort { nodes: 3, gap: 0.0 }) {
            assert!(hasty.certificate.expect("a certificate").lower_bound <= best + 1e-4);
        }
        // A track's own width may forbid what is cheapest without it.
        assert!(certificate.value >= best - 1e-2, "{case}: {certificate:?} {best}\n{}", text(&small, &asked));
        // The bill is what was minimised, each piece rounded to the cent.
        let length = stage.length;
        let compiled = Compiled::new(layout(&text(&small, &asked)), vec![stage]);
        let off = compiled.bill.price + metre * length - certificate.value;
        assert!(off.abs() <= 0.005 * compiled.bill.count as f64 + 1e-3, "{case}: {off}");
        assert!(compiled.sequence.elements.iter().all(|e| e.in_catalog));
        assert!(
            compiled.track.pieces.iter().all(|p| !matches!(p.kind, PieceKind::Straight) || p.length > SHORTEST - 1e-6)
        );
        proven += usize::from(certificate.proven);
        met += usize::from((certificate.value - best).abs() < 1e-2);
        // The shortest layout costs no less.
        let short = Asked { goal: Some("length"), ..asked.clone() };
        if let Some(short) = last(&small, &short, Effort::default()) {
            let bought = Compiled::new(compiled.layout.clone(), vec![short]).bill.price + metre * length;
            assert!(metre > 0.0 || certificate.lower_bound <= bought + 0.5);
            dearer += usize::from(metre == 0.0 && bought > certificate.value + 1.0);
        }
        if case % 10 == 0 {
            traded = traded.max(trades(&small, &asked, &fewest));
        }
    }
    println!("proven {proven}, met {met}, dearer when shortest {dearer}, traded {traded}, of {count}");
    assert!(proven * 10 >= count * 8 && met * 10 >= count * 8, "proven {proven}, met {met} of {count}");
    assert!(dearer > 0 && traded > 1);
}

/// The smallest loop is both.
#[test]
fn the_smallest_loop_has_nothing_to_trade() {
    let layout = layout(include_str!("../../examples/smallest.lss"));
    let trades = pareto(&layout, &Options::default(), &|_| {});
    assert_eq!(trades.len(), 1);
}
