//! Covering one straight with stock lengths and cut pieces, and one turn with curve pieces.
//!
//! A straight's price is a part per piece, a part per metre and a surcharge per cut, so of all covers with the same
//! length only the numbers of pieces and of cuts matter: for each number of cuts the fewest stock lengths that leave a
//! remainder which that many cut pieces can make.

use std::collections::BTreeMap;

use crate::model::{Goal, Interval, Layout, StraightStock};

/// Two lengths are alike, m.
const EXACT: f64 = 1e-10;
/// Sums closer than this are one state of the search, m.
const GRAIN: f64 = 1e-10;
/// A search gives up after this many different sums. Stock lengths that are whole multiples of 1 mm stay below it
/// on straights of 200 m; sums beyond it count as not to be had.
const MOST_SUMS: usize = 200_000;
/// More pieces than this on one straight or in one turn are not an order anyone places.
const MOST_PIECES: usize = 100_000;

/// What a cover of straights is best at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cover {
    /// Fewest pieces; of these the cheapest.
    Fewest,
    /// Cheapest; of these the one with the fewest pieces.
    Cheapest,
}

impl Cover {
    /// [`Cover::Cheapest`] when the layout optimises cost, or keeps to a budget of it.
    pub fn of(layout: &Layout) -> Self {
        let goals = layout.objective.terms.iter().map(|(_, goal)| *goal);
        let cost = goals.chain(layout.objective.within.map(|(goal, _)| goal)).any(|goal| goal == Goal::Cost);
        if cost { Cover::Cheapest } else { Cover::Fewest }
    }
}

/// One piece of a covered straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightPiece {
    /// m
    pub length: f64,
    pub cut: bool,
}

/// The pieces that cover a straight of this length (m), stock lengths first and longest first, then the cut pieces;
/// `None` when the stock cannot cover it. Among equally good covers the one with the longest stock pieces is taken.
pub fn straight(length: f64, stock: &StraightStock, cover: Cover) -> Option<Vec<StraightPiece>> {
    best(length, EXACT, stock, cover)
}

/// The sum of stock lengths within `tolerance` of this length, if they are what would be ordered for it.
pub fn nearest_stock(length: f64, tolerance: f64, stock: &StraightStock, cover: Cover) -> Option<f64> {
    let parts = best(length, tolerance, stock, cover)?;
    (!parts.iter().any(|p| p.cut)).then(|| parts.iter().map(|p| p.length).sum())
}

/// The best cover, where stock lengths alone need only come within `tolerance`.
fn best(length: f64, tolerance: f64, stock: &StraightStock, cover: Cover) -> Option<Vec<StraightPiece>> {
    let price = |pieces: usize, cuts: usize| stock.price.per_piece * pieces as f64 + stock.cut_price * cuts as f64;
    // Worth of a cover by its numbers of pieces and cuts: less is better.
    let worth = |pieces: usize, cuts: usize| match cover {
        Cover::Fewest => (pieces as f64, price(pieces, cuts)),
        Cover::Cheapest => (price(pieces, cuts), pieces as f64),
    };
    let mut best: Option<Vec<StraightPiece>> = None;
    for cuts in 0..=MOST_PIECES {
        // More cuts alone are already worse, or longer than the straight.
        let hopeless = best.as_ref().is_some_and(|b| {
            let cut = b.iter().filter(|p| p.cut).count();
            worth(cuts, cuts) >= worth(b.len(), cut)
        });
        let range = stock.cut.filter(|_| cuts > 0);
        let beyond = cuts > 0 && range.is_none_or(|r| cuts as f64 * r.low > length + EXACT || r.high <= EXACT);
        let enough = range.is_some_and(|r| (cuts - 1) as f64 * r.high > length);
        if hopeless || beyond || enough {
            break;
        }
        let (low, high) = match range {
            None => (length - tolerance, length + tolerance),
            // What remains is a piece, so it is longer than nothing.
            Some(range) => (
                (length - cuts as f64 * range.high - EXACT).max(0.0),
                (length - cuts as f64 * range.low + EXACT).min(length - 2.0 * EXACT),
            ),
        };
        let Some(lengths) = fewest(&stock.stock, low, high, MOST_PIECES) else { continue };
        let pieces = lengths.len() + cuts;
        let better =
            best.as_ref().is_none_or(|b| worth(pieces, cuts) < worth(b.len(), b.iter().filter(|p| p.cut).count()));
        if better {
            let rest = length - lengths.iter().sum::<f64>();
            let whole = lengths.iter().map(|&length| StraightPiece { length, cut: false });
            let cut = range.map_or(Vec::new(), |range| split(rest, cuts, range));
            best = Some(whole.chain(cut.into_iter().map(|length| StraightPiece { length, cut: true })).collect());
        }
    }
    best
}

/// A remainder as cut pieces: the longest there are and one for the rest, which shares with its neighbour when it alone
/// would be too short.
fn split(rest: f64, cuts: usize, range: Interval) -> Vec<f64> {
    let mut pieces = Vec::with_capacity(cuts);
    let mut left = rest;
    for remaining in (1..=cuts).rev() {
        let others = (remaining - 1) as f64 * range.low;
        let piece = if remaining == 2 && left - range.high < range.low - EXACT {
            left / 2.0
        } else {
            range.high.min(left - others)
        };
        let piece = if remaining == 1 { left } else { piece };
        pieces.push(piece);
        left -= piece;
    }
    pieces
}

/// Numbers of angle steps of the pieces that make a turn of `steps`, in driving order.
///
/// The fewest pieces there can be. They are equal when the turn divides evenly (70° of at most 45° is 35° twice: one
/// article), else as many of the largest as fit and one remainder (87.5° is 45° and 42.5°), because the largest
/// piece is the article that other turns need as well. `None` when no piece fits or there would be too many.
pub fn turn(steps: usize, largest: usize) -> Option<Vec<usize>> {
    if largest == 0 || steps.div_ceil(largest) > MOST_PIECES {
        return None;
    }
    let count = steps.div_ceil(largest);
    if count > 0 && steps.is_multiple_of(count) {
        return Some(vec![steps / count; count]);
    }
    let mut pieces = vec![largest; steps / largest];
    pieces.extend((!steps.is_multiple_of(largest)).then_some(steps % largest));
    Some(pieces)
}

/// A sum of gaps that has been reached: what a number of pieces falls short of as many of the longest.
#[derive(Clone, Copy)]
struct Reached {
    gap: f64,
    /// Fewest pieces that are not the longest.
    shorter: usize,
    /// Where it was reached from, and with which length.
    from: usize,
    kind: usize,
}

/// The fewest stock lengths (repetition allowed), and no more than `most`, whose sum lies in `low..=high`, longest
/// first; of these the largest sum.
///
/// With M the longest stock length, n pieces sum to nM minus the gaps M − a of the shorter ones, so the search goes
/// through n upwards and through the sums of gaps in ascending order, each with the fewest pieces that reach it. Only
/// sums of gaps up to nM − low are ever looked at, which are few as long as a cover exists.
fn fewest(stock: &[f64], low: f64, high: f64, most: usize) -> Option<Vec<f64>> {
    if !(low <= high && high >= 0.0 && high.is_finite()) {
        return None;
    }
    if low <= 0.0 {
        return Some(Vec::new());
    }
    let mut lengths: Vec<f64> = stock.iter().copied().filter(|a| *a > EXACT && a.is_finite()).collect();
    lengths.sort_by(|a, b| b.total_cmp(a));
    lengths.dedup_by(|a, b| (*a - *b).abs() <= EXACT);
    let (longest, shortest) = (*lengths.first()?, *lengths.last()?);
    if !has_multiple(&lengths, low, high) {
        return None;
    }
    let first = (low / longest).ceil();
    let most = (high / shortest).floor().min(most.min(MOST_PIECES) as f64);
    if first > most {
        return None;
    }
    let mut pending = BTreeMap::from([(0, Reached { gap: 0.0, shorter: 0, from: 0, kind: 0 })]);
    let mut reached: Vec<Reached> = Vec::new();
    for count in first as usize..=most as usize {
        let full = count as f64 * longest;
        let (from, to) = (full - high, full - low);
        while let Some(entry) = pending.first_entry().filter(|e| e.get().gap <= to) {
            let node = entry.remove();
            let at = reached.len();
            if at == MOST_SUMS {
                return None;
            }
            reached.push(node);
            for (kind, length) in lengths.iter().enumerate().skip(1) {
                let next = Reached { gap: node.gap + (longest - length), shorter: node.shorter + 1, from: at, kind };
                let slot = pending.entry((next.gap / GRAIN).round() as i64).or_insert(next);
                if next.shorter < slot.shorter {
                    *slot = next;
                }
            }
        }
        let start = reached.partition_point(|r| r.gap < from);
        if let Some(i) = (start..reached.len()).find(|&i| reached[i].shorter <= count) {
            return Some(unwind(&reached, i, &lengths, count));
        }
    }
    None
}

/// The lengths behind a sum of gaps, filled up with the longest to `count` pieces, longest first.
fn unwind(reached: &[Reached], mut i: usize, lengths: &[f64], count: usize) -> Vec<f64> {
    let mut pieces = vec![lengths[0]; count - reached[i].shorter];
    while reached[i].shorter > 0 {
        pieces.push(lengths[reached[i].kind]);
        i = reached[i].from;
    }
    pieces.sort_by(|a, b| b.total_cmp(a));
    pieces
}

/// Whether a whole multiple of the lengths' greatest common divisor lies in `low..=high`. Lengths that are not
/// whole tenths of a micrometre are taken to have none, and everything is then possible.
fn has_multiple(lengths: &[f64], low: f64, high: f64) -> bool {
    const UNIT: f64 = 1e7;
    let mut divisor: u64 = 0;
    for length in lengths {
        let units = (length * UNIT).round();
        if (length * UNIT - units).abs() > 1e-5 || units > 1e15 {
            return true;
        }
        divisor = gcd(divisor, units as u64);
    }
    let divisor = divisor as f64 / UNIT;
    (high / divisor).floor() * divisor >= low
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Rate;
    use proptest::prelude::*;

    fn stock(lengths: &[f64], cut: Option<(f64, f64)>, cut_price: f64) -> StraightStock {
        StraightStock {
            article: "ST".to_owned(),
            stock: lengths.to_vec(),
            cut: cut.map(|(low, high)| Interval { low, high }),
            cut_price,
            shortest: 0.0,
            price: Rate { per_piece: 40.0, per_metre: 100.0 },
            mass: Rate::default(),
        }
    }

    fn lengths(parts: &[StraightPiece]) -> Vec<f64> {
        parts.iter().map(|p| p.length).collect()
    }

    /// Fewest pieces of the stock that sum to a whole number of millimetres, tried one by one.
    fn brute(stock: &[u32], low: i64, high: i64) -> Option<usize> {
        if high < 0 {
            return None;
        }
        let mut best: Vec<Option<usize>> = vec![None; high as usize + 1];
        best[0] = Some(0);
        for sum in 1..best.len() {
            best[sum] = stock
                .iter()
                .filter(|&&a| a as usize <= sum)
                .filter_map(|&a| best[sum - a as usize])
                .min()
                .map(|count| count + 1);
        }
        best[low.max(0) as usize..].iter().flatten().min().copied()
    }

    #[test]
    fn known_straights() {
        type Case = (&'static [f64], Option<(f64, f64)>, f64, Option<&'static [f64]>);
        let cases: [Case; 11] = [
            (&[1.0, 2.0, 3.0], None, 12.0, Some(&[3.0; 4])),
            (&[1.0, 2.0, 3.0], None, 7.0, Some(&[3.0, 3.0, 1.0])),
            (&[1.0, 2.0, 3.0], None, 7.5, None),
            (&[1.0, 2.0, 3.0], Some((0.2, 3.0)), 7.5, Some(&[3.0, 3.0, 1.5])),
            // A greedy choice would leave 0.1 m, which cannot be cut.
            (&[2.0, 3.0], Some((0.2, 0.9)), 6.1, Some(&[3.0, 2.0, 0.9, 0.2])),
            (&[2.0, 3.0], Some((0.2, 1.2)), 6.1, Some(&[3.0, 2.0, 1.1])),
            // The longest first is not the fewest: 3 x 4 m beats 5 + 5 + 1 + 1.
            (&[1.0, 4.0, 5.0], None, 12.0, Some(&[4.0; 3])),
            (&[], Some((0.0, 3.0)), 2.5, Some(&[2.5])),
            (&[], Some((0.0, 3.0)), 7.5, Some(&[3.0, 3.0, 1.5])),
            (&[], Some((0.5, 3.0)), 6.25, Some(&[3.0, 1.625, 1.625])),
            (&[], Some((0.5, 3.0)), 0.3, None),
        ];
        for (stocked, cut, length, expected) in cases {
            let found = straight(length, &stock(stocked, cut, 25.0), Cover::Fewest).map(|p| lengths(&p));
            let close = match (&found, expected) {
                (Some(a), Some(b)) => a.len() == b.len() && a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-12),
                (a, b) => a.is_none() && b.is_none(),
            };
            assert!(close, "{length} m of {stocked:?}, cut {cut:?}: {found:?}, not {expected:?}");
        }
    }

    #[test]
    fn a_dear_cut_is_avoided_only_by_the_cheapest_cover() {
        // 3 + 0.5 cut, or seven pieces of 0.5 m.
        let cheap = stock(&[0.5, 3.1], Some((0.1, 3.0)), 25.0);
        let dear = stock(&[0.5, 3.1], Some((0.1, 3.0)), 1000.0);
        assert_eq!(straight(3.5, &cheap, Cover::Cheapest).unwrap().len(), 2);
        assert_eq!(straight(3.5, &dear, Cover::Cheapest).unwrap(), vec![StraightPiece { length: 0.5, cut: false }; 7]);
        assert_eq!(straight(3.5, &dear, Cover::Fewest).unwrap().len(), 2);
    }

    #[test]
    fn long_straights_and_odd_lengths_stay_quick() {
        let odd: Vec<f64> = (1..=10).map(|i| f64::from(i * i + 7).sqrt() / 3.0).collect();
        let parts = straight(123.456, &stock(&odd, Some((0.3, 2.0)), 25.0), Cover::Fewest).unwrap();
        assert!((lengths(&parts).iter().sum::<f64>() - 123.456).abs() < 1e-9);
        assert_eq!(straight(123.456, &stock(&odd, None, 25.0), Cover::Fewest), None);
        let even: Vec<f64> = (0..10).map(|i| 0.605 + 0.25 * f64::from(i)).collect();
        assert!(straight(100.0, &stock(&even, None, 25.0), Cover::Fewest).is_some());
        assert_eq!(straight(1e12, &stock(&even, None, 25.0), Cover::Fewest), None);
    }

    #[test]
    fn turns_are_split_into_few_articles() {
        for (steps, expected) in [
            (36, Some(vec![18, 18])),
            (28, Some(vec![14, 14])),
            (35, Some(vec![18, 17])),
            (18, Some(vec![18])),
            (2, Some(vec![2])),
            (55, Some(vec![18, 18, 18, 1])),
            (0, Some(vec![])),
        ] {
            assert_eq!(turn(steps, 18), expected);
        }
        assert_eq!(turn(4, 0), None);
    }

    proptest! {
        #[test]
        fn a_cover_is_optimal(
            kinds in prop::collection::btree_set(30u32..400, 1..5),
            cut in prop::option::of((0u32..200, 0u32..200)),
            length in 1u32..2500,
            cut_price in 0u32..200,
        ) {
            let kinds: Vec<u32> = kinds.into_iter().collect();
            let metres: Vec<f64> = kinds.iter().map(|&a| f64::from(a) / 100.0).collect();
            let cut = cut.map(|(low, width)| (low, low + width));
            let bounds = cut.map(|(low, high)| (f64::from(low) / 100.0, f64::from(high) / 100.0));
            let stocked = stock(&metres, bounds, f64::from(cut_price));
            let whole = brute(&kinds, length.into(), length.into());
            // The cut piece may have any real length; with integers a shortest one of 1 stands for all above 0.
            let price = |count: usize, cuts: usize| 40 * count + cuts * cut_price as usize;
            let mut options: Vec<(usize, usize)> = whole.map(|n| (n, price(n, 0))).into_iter().collect();
            if let Some((low, high)) = cut.filter(|c| c.1 > 0) {
                let (length, low, high) = (i64::from(length), i64::from(low.max(1)), i64::from(high));
                for cuts in 1..=length {
                    let count = brute(&kinds, length - cuts * high, length - cuts * low);
                    options.extend(count.map(|n| (n + cuts as usize, price(n + cuts as usize, cuts as usize))));
                    if (cuts - 1) * high > length { break; }
                }
            }
            for cover in [Cover::Fewest, Cover::Cheapest] {
                let found = straight(f64::from(length) / 100.0, &stocked, cover);
                if let Some(parts) = &found {
                    let sum: f64 = lengths(parts).iter().sum();
                    prop_assert!((sum - f64::from(length) / 100.0).abs() < 1e-9);
                    for part in parts {
                        let allowed = match part.cut {
                            true => bounds.is_some_and(|(l, h)| l - 1e-9 <= part.length && part.length <= h + 1e-9),
                            false => metres.contains(&part.length),
                        };
                        prop_assert!(allowed, "{part:?}");
                    }
                }
                let found = found.map(|p| (p.len(), price(p.len(), p.iter().filter(|p| p.cut).count())));
                let best = options.iter().copied();
                let best = match cover {
                    Cover::Fewest => best.min(),
                    Cover::Cheapest => best.map(|(n, p)| (p, n)).min().map(|(p, n)| (n, p)),
                };
                prop_assert_eq!(found, best);
            }
        }

        #[test]
        fn a_turn_is_whole_and_short(steps in 0usize..200, largest in 1usize..40) {
            let pieces = turn(steps, largest).unwrap();
            prop_assert_eq!(pieces.iter().sum::<usize>(), steps);
            prop_assert_eq!(pieces.len(), steps.div_ceil(largest));
            prop_assert!(pieces.iter().all(|p| (1..=largest).contains(p)));
        }
    }
}
