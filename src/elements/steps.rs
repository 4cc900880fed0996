//! What a straight costs beyond its metres, by its length: prices of pieces and cuts are steps.
//!
//! A cover of m stock lengths that sum to a and of c cut pieces makes every length from a + c·low to a + c·high. Offers
//! are taken from the cheapest on; each has the lengths that no cheaper one makes.

use crate::model::StraightStock;
use std::collections::BTreeMap;

/// Lengths that differ by less are one, m.
const EXACT: f64 = 1e-9;
/// Most sums of stock lengths, and most break points.
const MOST: usize = 4_000;

/// A step function on the lengths 0..=longest.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    /// Ascending.
    points: Vec<PriceStep>,
}

/// A length where the price changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PriceStep {
    /// m
    pub length: f64,
    /// Pieces and cuts of this very length, EUR; infinite where the stock cannot make it.
    pub price: f64,
    /// The same of every length between this and the next step.
    pub after: f64,
}

impl Steps {
    /// The cheapest covers of every length up to `longest`, m. `None` where there are too many steps to list, as of
    /// stock lengths that share no common measure.
    pub fn new(stock: &StraightStock, longest: f64) -> Option<Self> {
        let mut offers: Vec<(f64, f64, f64)> = Vec::new();
        let most_cuts =
            stock.cut.map_or(0, |c| if c.high > EXACT { (longest / c.high).ceil() as usize + 1 } else { 0 });
        let price = |pieces: usize, cuts: usize| stock.price.per_piece * pieces as f64 + stock.cut_price * cuts as f64;
        for (sum, pieces) in sums(&stock.stock, longest)? {
            offers.push((price(pieces, 0), sum, sum));
            for (cuts, cut) in (1..=most_cuts).flat_map(|c| stock.cut.map(|cut| (c, cut))) {
                let low = sum + cuts as f64 * cut.low;
                if low > longest + EXACT {
                    break;
                }
                offers.push((price(pieces + cuts, cuts), low, sum + cuts as f64 * cut.high));
            }
        }
        offers.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(b.2.total_cmp(&a.2)));
        let mut taken: Vec<(f64, f64)> = Vec::new();
        let mut parts: Vec<(f64, f64, f64)> = Vec::new();
        for (price, low, high) in offers {
            parts.extend(take(&mut taken, low, high.min(longest)).into_iter().map(|(low, high)| (low, high, price)));
            if parts.len() > MOST {
                return None;
            }
        }
        parts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut points: Vec<PriceStep> = Vec::new();
        for (low, high, price) in parts {
            match points.last_mut() {
                // Where two parts meet, both make the length.
                Some(last) if (last.length - low).abs() <= EXACT => last.price = last.price.min(price),
                _ => points.push(PriceStep { length: low, price, after: f64::INFINITY }),
            }
            if high - low > EXACT {
                if let Some(last) = points.last_mut() {
                    last.after = price;
                }
                points.push(PriceStep { length: high, price, after: f64::INFINITY });
            }
        }
        Some(Steps { points })
    }

    pub fn points(&self) -> &[PriceStep] {
        &self.points
    }

    /// Pieces and cuts of a straight, EUR; infinite where the stock cannot make it.
    pub fn price(&self, length: f64) -> f64 {
        let next = self.points.partition_point(|p| p.length <= length + EXACT);
        let Some(last) = next.checked_sub(1).and_then(|i| self.points.get(i)) else { return f64::INFINITY };
        if length - last.length <= EXACT { last.price } else { last.after }
    }

    /// The length of a step within `tolerance` that is cheaper than this one.
    pub fn nearest_cheaper(&self, length: f64, tolerance: f64) -> Option<f64> {
        let first = self.points.partition_point(|p| p.length < length - tolerance);
        let near = self.points[first..].iter().take_while(|p| p.length <= length + tolerance);
        let plain = |p: &&PriceStep| p.price < p.after || first == 0 || p.price < self.price(p.length - 2.0 * EXACT);
        let best = near.filter(plain).min_by(|a, b| a.price.total_cmp(&b.price))?;
        best.price.is_finite().then_some(best.length)
    }
}

/// Sums of stock lengths up to `longest`, each with its fewest pieces; 0 is made of none.
fn sums(stock: &[f64], longest: f64) -> Option<Vec<(f64, usize)>> {
    let key = |length: f64| (length / EXACT).round() as i64;
    let mut known: BTreeMap<i64, (f64, usize)> = BTreeMap::from([(0, (0.0, 0))]);
    let mut latest = vec![0.0];
    for pieces in 1.. {
        let mut next = Vec::new();
        for length in latest.iter().flat_map(|sum| stock.iter().map(move |piece| sum + piece)) {
            if length <= longest + EXACT && !known.contains_key(&key(length)) {
                known.insert(key(length), (length, pieces));
                next.push(length);
            }
        }
        if known.len() > MOST {
            return None;
        }
        if next.is_empty() {
            break;
        }
        latest = next;
    }
    Some(known.into_values().collect())
}

/// Adds an interval to disjoint ones, ascending, and returns the parts of it that are new.
fn take(taken: &mut Vec<(f64, f64)>, low: f64, high: f64) -> Vec<(f64, f64)> {
    let first = taken.partition_point(|t| t.1 < low - EXACT);
    let end = first + taken[first..].partition_point(|t| t.0 <= high + EXACT);
    let mut new = Vec::new();
    let mut from = low;
    for &(a, b) in &taken[first..end] {
        if a - from > EXACT {
            new.push((from, a));
        }
        from = from.max(b);
    }
    if high - from > EXACT || (first == end && high >= low) {
        new.push((from, high.max(from)));
    }
    let union = taken[first..end].iter().fold((low, high), |u, t| (u.0.min(t.0), u.1.max(t.1)));
    taken.splice(first..end, [union]);
    new
}

#[cfg(test)]
mod tests {
    use super::super::cover::{self, Cover};
    use super::*;
    use crate::model::{Interval, Rate};
    use proptest::prelude::*;

    fn stock(lengths: &[f64], cut: Option<(f64, f64)>, cut_price: f64) -> StraightStock {
        StraightStock {
            article: "ST".into(),
            stock: lengths.to_vec(),
            cut: cut.map(|(low, high)| Interval { low, high }),
            cut_price,
            shortest: 0.0,
            price: Rate { per_piece: 60.0, per_metre: 210.0 },
            mass: Rate::default(),
        }
    }

    /// What `cover` orders, EUR.
    fn ordered(length: f64, stock: &StraightStock) -> f64 {
        cover::straight(length, stock, Cover::Cheapest).map_or(f64::INFINITY, |parts| {
            let cuts = parts.iter().filter(|p| p.cut).count();
            60.0 * parts.len() as f64 + stock.cut_price * cuts as f64
        })
    }

    #[test]
    fn pieces_and_cuts_are_steps() {
        let steps = Steps::new(&stock(&[], Some((0.0, 3.0)), 35.0), 7.0).expect("few steps");
        let told: Vec<_> = steps.points().iter().map(|p| (p.length, p.price, p.after)).collect();
        assert_eq!(told, [(0.0, 0.0, 95.0), (3.0, 95.0, 190.0), (6.0, 190.0, 285.0), (7.0, 285.0, f64::INFINITY)]);
        assert_eq!(steps.nearest_cheaper(3.000_000_4, 1e-6), Some(3.0));
        assert_eq!(steps.nearest_cheaper(2.0, 1e-6), None);
    }

    #[test]
    fn stock_without_cuts_is_a_set_of_lengths() {
        let steps = Steps::new(&stock(&[1.0, 2.5], None, 0.0), 4.0).expect("few steps");
        let told: Vec<_> = steps.points().iter().map(|p| (p.length, p.price)).collect();
        assert_eq!(
            told,
            [(0.0, 0.0), (1.0, 60.0), (2.0, 120.0), (2.5, 60.0), (3.0, 180.0), (3.5, 120.0), (4.0, 240.0)]
        );
        assert_eq!(steps.price(2.2), f64::INFINITY);
    }

    proptest! {
        #[test]
        fn steps_are_what_covers_cost(
            lengths in prop::collection::vec(1u32..40, 0..4),
            low in 0u32..8,
            more in 1u32..30,
            cuts in any::<bool>(),
            cut_price in 0u32..90,
            at in prop::collection::vec(0u32..2000, 12),
        ) {
            let mut lengths: Vec<f64> = lengths.into_iter().map(|l| f64::from(l) / 10.0).collect();
            lengths.sort_by(f64::total_cmp);
            lengths.dedup();
            let cut = (cuts || lengths.is_empty()).then_some((f64::from(low) / 10.0, f64::from(low + more) / 10.0));
            let stock = stock(&lengths, cut, f64::from(cut_price));
            if let Some(steps) = Steps::new(&stock, 20.0) {
                // On tenths, where steps are, and between them.
                for length in at.into_iter().map(|a| f64::from(a) / 100.0) {
                    prop_assert_eq!(steps.price(length), ordered(length, &stock), "{} {:?}", length, stock);
                }
            }
        }
    }
}
