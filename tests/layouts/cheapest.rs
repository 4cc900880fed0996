//! `optimise cost` against every choice of turns and radii of small random layouts. What pieces cost is counted here by
//! another route, and of straights that close a loop in one way more than they must, the cheapest is where one of them
//! has a length at which pieces change: all those are tried.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::small::{Asked, PITCH, Random, SHORTEST, STEP, Small, WITHIN, choices, last, layout, random, text};
use lss::choose::{self, Measure};
use lss::compiled::{Compiled, order};
use lss::diagnostic::{Code, Diagnostic};
use lss::geometry::{PieceKind, Track};
use lss::kinematics::{fit, level};
use lss::model::Layout;
use lss::semantics::analyse;
use lss::solve::{Counted, Effort, End, Options, pareto, solve};
use lss::source::{Loader, SourceMap};

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

/// The least that the straights of a choice measure in all, m, where two of the free ones close the loop.
fn shortest(choice: &Small, free: &[usize], fits: &dyn Fn(&Small) -> bool) -> f64 {
    let mut shortest = f64::INFINITY;
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let mut choice = choice.clone();
        if choice.close(free[a], free[b]) && fits(&choice) {
            shortest = shortest.min(choice.straights.iter().sum());
        }
    }
    shortest
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
        let shortest = shortest(&choice, &free, &fits);
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

/// Ends and what lies between them, each the best for its price of a metre; how many of them no other one beats.
fn trades(small: &Small, asked: &Asked, fewest: &[usize]) -> usize {
    let layout = layout(&text(small, asked));
    let options = Options { threads: 1, ..Options::default() };
    let trades = pareto(&layout, &[End::Cost, End::Length], &[], &options, &|_| {});
    for trade in trades.iter().filter(|t| t.certificate.as_ref().is_some_and(|c| c.proven)) {
        let Some(metre) = trade.objective.metre() else { continue };
        let best = cheapest(small, asked, metre, fewest);
        assert!(trade.price + metre * trade.length >= best - 1e-2);
        for other in &trades {
            assert!(other.price + metre * other.length >= trade.price + metre * trade.length - 1e-2);
        }
    }
    let front = choose::pareto(&layout, &[Measure::Length, Measure::Cost], &options, &|_| {}).expect("few enough");
    let values: Vec<&[f64]> = front.layouts.iter().map(|own| own.values.as_slice()).collect();
    assert!(values.windows(2).all(|v| v[0][0] < v[1][0] && v[0][1] > v[1][1]), "{values:?}");
    assert_eq!(front.tracks, trades.len());
    values.len()
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
        if let Some(hasty) = last(&small, &asked, Effort { nodes: 3, ..Effort::default() }) {
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
    let found = choose::pareto(&layout, &[Measure::Length, Measure::Cost], &Options::default(), &|_| {});
    assert_eq!(found.expect("few enough").layouts.len(), 1);
}

/// Lengths that a track with these turns and radii may have, m.
type Bands<'a> = &'a dyn Fn(&Small) -> Vec<(f64, f64)>;

/// The cheapest of the layouts with a length in a band, where one straight is free when two close the loop: at a length
/// at which pieces change, or at the end of a band.
fn cheapest_within(small: &Small, asked: &Asked, fewest: &[usize], bands: Bands) -> f64 {
    let n = small.turns.len();
    let free: Vec<usize> = (1..n).collect();
    assert_eq!(free.len(), 3);
    let fits = |choice: &Small| choice.straights.iter().all(|&s| (SHORTEST - 1e-9..LONGEST - 5.0).contains(&s));
    let mut best = f64::INFINITY;
    choices(small, asked, &mut |choice| {
        let curves = curves(&choice);
        let shortest = shortest(&choice, &free, &fits);
        if curves + (STRAIGHT.0 + STRAIGHT.1 / 3.0) * shortest >= best {
            return;
        }
        // Two carts' lengths on, metres alone cost more than what other pieces save.
        let arcs = choice.length() - choice.straights.iter().sum::<f64>();
        let near = |band: &(f64, f64)| band.1 >= arcs + shortest - 1e-6 && band.0 <= arcs + shortest + 3.0;
        let bands: Vec<(f64, f64)> = bands(&choice).into_iter().filter(near).collect();
        for k in 0..3 {
            let (a, b) = (free[(k + 1) % 3], free[(k + 2) % 3]);
            let closed = |straight: f64| {
                let mut choice = choice.clone();
                choice.straights[free[k]] = straight;
                choice.close(a, b).then_some(choice)
            };
            let (Some(zero), Some(one)) = (closed(0.0), closed(1.0)) else { continue };
            let (start, slope) = (zero.length(), one.length() - zero.length());
            let ends = bands.iter().flat_map(|band| [band.0, band.1]).map(|end| (end - start) / slope);
            let steps =
                (0..(2.0 * LONGEST) as usize).flat_map(|half| [0.0, 0.2, 0.4].map(|more| 0.5 * half as f64 + more));
            for straight_length in ends.chain(steps).filter(|s| s.is_finite()) {
                let Some(choice) = closed(straight_length) else { continue };
                let length = choice.length();
                let inside = bands.iter().any(|band| length >= band.0 - 1e-9 && length <= band.1 + 1e-9);
                if inside && fits(&choice) {
                    best = best.min(curves + choice.straights.iter().map(|&s| straight(s, fewest)).sum::<f64>());
                }
            }
        }
    });
    best
}

/// Lengths at which a chain surely closes: what chords cut off is θL²/(24R) − L³/(120R²), to a millimetre for these radii.
fn closing(choice: &Small) -> Vec<(f64, f64)> {
    let cut = |(turn, radius): (&i32, &f64)| {
        let angle = (f64::from(turn.abs()) * STEP).to_radians();
        angle * PITCH * PITCH / (24.0 * radius) - PITCH * PITCH * PITCH / (120.0 * radius * radius)
    };
    let cut: f64 = choice.turns.iter().zip(&choice.radii).map(cut).sum();
    let within = WITHIN - 0.001;
    (20..300).map(|carts| f64::from(carts) * PITCH + cut).map(|middle| (middle - within, middle + within)).collect()
}

#[test]
fn no_layout_whose_chain_closes_is_cheaper_than_the_bound() {
    let mut seeds = Random(5);
    let fewest = fewest();
    let (mut solved, mut near, mut proven, mut open, count) = (0, 0, 0, 0, 6);
    for case in 0..count {
        let small = random(&mut seeds, 4);
        let asked = Asked { goal: Some("cost"), closes: true, ..Asked::default() };
        let Some(stage) = last(&small, &asked, Effort { nodes: 3000, ..Effort::default() }) else { continue };
        let certificate = stage.certificate.clone().expect("a certificate");
        let best = cheapest_within(&small, &asked, &fewest, &closing);
        assert!(certificate.lower_bound <= best + 1e-4, "{case}: {certificate:?} {best}\n{}", text(&small, &asked));
        let left = fit(&level(&Track::new(&stage.corners)), PITCH).expect("a chain").left_over;
        assert!(left.abs() <= WITHIN + 1e-5, "{case}: {left}");
        solved += 1;
        proven += usize::from(certificate.proven);
        // A millimetre at the ends of a band is worth less than an EUR; the track's own width may forbid the rest.
        near += usize::from(certificate.value <= best + 1.0);
        let any = Asked { closes: false, ..asked.clone() };
        open += usize::from(last(&small, &any, Effort::default()).is_some_and(|stage| {
            fit(&level(&Track::new(&stage.corners)), PITCH).is_none_or(|fit| fit.left_over.abs() > WITHIN + 1e-5)
        }));
    }
    println!("solved {solved}, near {near}, proven {proven}, open when cheapest {open}, of {count}");
    assert!(solved * 10 >= count * 8 && near * 10 >= solved * 7 && open > 0, "{solved} {near} {open}");
}

#[test]
fn no_layout_within_a_budget_is_better_than_the_bound() {
    let mut seeds = Random(11);
    let fewest = fewest();
    let (mut solved, mut near, mut tight, count) = (0, 0, 0, 5);
    for _ in 0..count {
        let small = random(&mut seeds, 4);
        let shortest = Asked { goal: Some("length"), ..Asked::default() };
        let Some(shortest) = last(&small, &shortest, Effort::default()) else { continue };
        let limit = 1.02 * shortest.length;
        let asked = Asked { goal: Some("cost within length + 2 %"), ..Asked::default() };
        let Some(stage) = last(&small, &asked, Effort { nodes: 3000, ..Effort::default() }) else { continue };
        let certificate = stage.certificate.clone().expect("a certificate");
        assert!(certificate.budget.is_some() && stage.length <= limit + 1e-6, "{certificate:?}");
        let best = cheapest_within(&small, &asked, &fewest, &|_| vec![(0.0, limit)]);
        assert!(certificate.lower_bound <= best + 1e-4, "{certificate:?} {best}\n{}", text(&small, &asked));
        let free = cheapest(&small, &Asked { goal: Some("cost"), ..Asked::default() }, 0.0, &fewest);
        solved += 1;
        tight += usize::from(best > free + 1.0);
        near += usize::from(certificate.value <= 1.01 * best);
    }
    println!("solved {solved}, near {near}, tight {tight}, of {count}");
    assert!(solved * 10 >= count * 8 && near * 10 >= solved * 7 && tight > 0, "{solved} {near} {tight}");
}

/// The shortest of the layouts that cost little more than the cheapest lies between the two.
#[test]
fn length_within_a_budget_of_cost_keeps_to_it() {
    let mut seeds = Random(17);
    let mut shorter = 0;
    for _ in 0..6 {
        let small = random(&mut seeds, 4);
        let told = |goal: &'static str| {
            let asked = Asked { goal: Some(goal), ..Asked::default() };
            let stage = last(&small, &asked, Effort::default())?;
            let priced = Asked { goal: Some("cost"), ..Asked::default() };
            let bill = Compiled::new(layout(&text(&small, &priced)), vec![stage.clone()]).bill.price;
            Some((stage, bill))
        };
        let (Some(cheap), Some(short), Some(kept)) = (told("cost"), told("length"), told("length within cost + 3 %"))
        else {
            continue;
        };
        let certificate = kept.0.certificate.clone().expect("a certificate");
        assert!(kept.1 <= 1.03 * cheap.1 + 0.2, "{} {}", kept.1, cheap.1);
        assert!(kept.0.length <= cheap.0.length + 1e-6 && kept.0.length >= short.0.length - 1e-6);
        assert!(certificate.lower_bound >= short.0.certificate.expect("a certificate").lower_bound - 1e-6);
        assert!(certificate.lower_bound <= kept.0.length + 1e-9);
        shorter += usize::from(kept.0.length < cheap.0.length - 1e-3);
    }
    assert!(shorter > 0);
}

fn check(text: &str) -> (Option<Layout>, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("l.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    (analysis.chosen().ok().flatten().cloned(), analysis.diagnostics)
}

/// The cheapest pieces are on a longer track, which needs more carts; what is ordered in all is told by the bill alone. No
/// layout that another goal finds contradicts the bound.
#[test]
fn the_price_of_all_that_is_ordered_counts_carts_and_supports() {
    let text =
        include_str!("../../examples/thesis10.lss").replace("  optimise length", "  supports every 2.5 m\n  GOAL");
    let effort = Effort { nodes: 400, ..Effort::default() };
    let built = |goal: &str| {
        let layout = check(&text.replace("GOAL", goal)).0.expect("a layout");
        let stages = solve(&layout, &Options { effort, threads: 2, ..Options::default() }, &|_| ());
        Compiled::new(layout, stages)
    };
    let [pieces, shortest, all] = ["optimise cost", "optimise length", "optimise total_price"].map(built);
    let [of_pieces, of_shortest, of_all] = [&pieces, &shortest, &all].map(|compiled| order::total(compiled).all);
    assert!(of_all < of_shortest && of_shortest < of_pieces, "{of_all} {of_shortest} {of_pieces}");
    assert!(pieces.bill.price < all.bill.price && all.length() < pieces.length());
    let certificate = all.stages.last().and_then(|stage| stage.certificate.clone()).expect("a certificate");
    assert!((certificate.value - of_all).abs() < 0.005, "{certificate:?} {of_all}");
    assert!(certificate.lower_bound <= of_all && certificate.gap < 0.02, "{certificate:?}");
    assert!(certificate.words()[0].contains("EUR in all"), "{:?}", certificate.words());
    // By hand: 128 pitches with cart and joint, supports counted up, motors and take-up beside the pieces.
    let carts = all.chain.expect("a chain").carts as f64;
    let [chain, supports] = [order::Group::Chain, order::Group::Supports].map(|group| {
        order::lines(&all).iter().filter(|line| line.group == group).filter_map(|l| l.price()).sum::<f64>()
    });
    assert!((chain - carts * all.layout.price_of_a_pitch()).abs() < 0.005, "{chain}");
    assert!(supports > 0.0 && supports == (all.length() / 2.5).ceil() * all.layout.price_of_a_support());
    // What one metre counts is what a long track takes for each of its metres, but for rounding.
    let metres = all.layout.price_of_a_metre() * all.length();
    let rounding = all.layout.price_of_a_pitch() + all.layout.price_of_a_support();
    assert!((metres - chain - supports).abs() < rounding, "{metres} {chain} {supports}");
}

#[test]
fn the_total_price_stands_alone() {
    let text = include_str!("../../examples/thesis10.lss");
    for goal in [
        "total_price + length",
        "total_price within length + 1 %",
        "length within total_price + 1 %",
        "2 * total_price",
    ] {
        let (_, said) = check(&text.replace("optimise length", &format!("optimise {goal}")));
        assert!(said.iter().any(|d| d.code == Code::E0304 && d.message.contains("stands alone")), "{goal}: {said:?}");
    }
}

/// Carts are chords: a chain is shorter than its track, the more so the more it turns, and has a whole number of carts. What
/// other goals and layouts as they are written cost in all does not contradict the bound.
#[test]
fn no_layout_is_cheaper_in_all_than_the_bound() {
    let tray = "cart tilt_tray(length: 1250 mm)";
    let big = "cart big from tilt_tray(length: 1250 mm) {\n  length = 2.542 m\n  lengths = [2.542 m]\n  price = 20000 EUR\n}\n";
    let cases = [
        ("", tray, 22.69, ""),
        ("", tray, 22.7, ""),
        ("", tray, 22.4197, "take_up spring_60\n  chain closes within 60 mm"),
        (big, "cart big", 23.0, "chain closes within 20 mm"),
    ];
    for (head, cart, right, more) in cases {
        let built = |goal: &str, height: f64| {
            let top = 3.0 + height;
            let text = format!(
                "use std.carts.tilt_tray\nuse std.take_ups.spring_60\nuse std.tracks.standard\n{head}layout c {{\n  \
                 catalog standard\n  {cart}\n  speed 2.0 m/s\n  width 1.2 m\n  vertex P1 (3 m, 3 m) radius 3 m\n  \
                 vertex P2 ({right} m, 3 m) radius 3 m\n  vertex P3 ({right} m, {top} m) radius 3 m\n  \
                 vertex P4 (3 m, {top} m) radius 3 m\n  fix all P1..P2\n  \
                 require length(straight(P2..P3)) >= 0.9 m\n  {more}\n  optimise {goal}\n}}\n"
            );
            let (layout, said) = check(&text);
            let layout = layout.unwrap_or_else(|| panic!("{said:#?}"));
            let stages = solve(&layout, &Options::default(), &|_| ());
            let failed = stages.last().is_some_and(|stage| stage.status == lss::solve::Status::Infeasible);
            (!failed).then(|| Compiled::new(layout, stages))
        };
        let all = built("total_price", 7.0).expect("a layout");
        let certificate = all.stages.last().and_then(|stage| stage.certificate.clone()).expect("a certificate");
        assert!(certificate.lower_bound > 0.9 * certificate.value, "{certificate:?}");
        let others = [("cost", 7.0), ("length", 7.0), ("nothing", 6.95), ("nothing", 7.0), ("nothing", 7.5)];
        for (goal, height) in others {
            let Some(other) = built(goal, height) else { continue };
            let closed = other
                .layout
                .chain
                .closes_within
                .is_none_or(|w| other.chain.is_some_and(|fit| fit.left_over.abs() <= w.value));
            let total = order::total(&other).all;
            assert!(
                !closed || certificate.lower_bound <= total,
                "{cart} {right} {goal} {height}: {total} {certificate:?}"
            );
        }
    }
}
