//! The bill of elements: how many of each article, what they cost and what they weigh.

use std::collections::BTreeMap;

use super::sequence::{degrees, millimetres};
use super::{OrderedPiece, Part};
use crate::model::Layout;
use serde::Serialize;

/// One article of the bill.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BillLine {
    pub article: String,
    pub description: String,
    /// Of one piece, as [`Part::turned`] has it.
    pub part: Part,
    pub count: usize,
    /// EUR a piece and in all; a piece's price is rounded to the cent.
    pub unit_price: f64,
    pub price: f64,
    /// kg a piece and in all; a piece's mass is rounded to the gram.
    pub unit_mass: f64,
    pub mass: f64,
    pub in_catalog: bool,
}

/// The bill of elements: articles in a fixed order (straights by length, then curves, vertical curves and spirals by
/// radius and angle).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bill {
    pub lines: Vec<BillLine>,
    pub count: usize,
    /// EUR
    pub price: f64,
    /// kg
    pub mass: f64,
}

/// Counts the elements by article.
///
/// Lengths that differ by less than a micrometre have the same article number and stand on one line. A piece cut to a
/// stock length (which happens when a cut costs no surcharge) is still a line of its own. Special pieces, which the
/// catalogue does not have, are priced by its rates as an estimate.
pub fn bill(pieces: &[OrderedPiece], layout: &Layout) -> Bill {
    let mut counts: BTreeMap<Key, (usize, &OrderedPiece)> = BTreeMap::new();
    for piece in pieces {
        counts.entry(Key::of(&piece.part.turned(), piece.in_catalog)).or_insert((0, piece)).0 += 1;
    }
    let lines: Vec<BillLine> = counts.into_values().map(|(count, piece)| line(count, piece, layout)).collect();
    Bill {
        count: lines.iter().map(|l| l.count).sum(),
        price: rounded(lines.iter().map(|l| l.price).sum(), 100.0),
        mass: rounded(lines.iter().map(|l| l.mass).sum(), 1000.0),
        lines,
    }
}

/// What pieces cost together before prices are rounded to the cent, EUR. [`bill`] rounds the price of each piece.
pub fn price(pieces: &[OrderedPiece], layout: &Layout) -> f64 {
    pieces.iter().map(|piece| rates(&piece.part, layout).0).sum()
}

/// Price (EUR) and mass (kg) of a piece.
fn rates(part: &Part, layout: &Layout) -> (f64, f64) {
    let catalog = &layout.catalog;
    let (straight, curve) = (&catalog.straight, &catalog.curve);
    let length = part.length();
    // What the catalogue has none of is estimated by its curves.
    let (price, mass) = match part {
        Part::Straight { .. } => (straight.price, straight.mass),
        Part::Curve { .. } => (curve.price, curve.mass),
        Part::Vertical { .. } => catalog.vertical.as_ref().map_or((curve.price, curve.mass), |v| (v.price, v.mass)),
        Part::Spiral { .. } => catalog.spiral.as_ref().map_or((curve.price, curve.mass), |s| (s.price, s.mass)),
    };
    let surcharge = if matches!(part, Part::Straight { cut: true, .. }) { straight.cut_price } else { 0.0 };
    (price.of(length) + surcharge, mass.of(length))
}

fn line(count: usize, piece: &OrderedPiece, layout: &Layout) -> BillLine {
    let special = if piece.in_catalog { "" } else { ", special" };
    let part = piece.part.turned();
    let description = match part {
        Part::Straight { length, cut } => {
            let how = if cut { " cut to" } else { "," };
            format!("straight{how} {} mm{special}", millimetres(length))
        }
        Part::Curve { radius, turn } => {
            format!("curve, radius {} mm, {}°{special}", millimetres(radius), degrees(turn))
        }
        Part::Vertical { radius, turn } => {
            let (radius, angle) = (millimetres(radius), degrees(turn));
            let kind = if turn < 0.0 { "crest" } else { "sag" };
            format!("vertical curve, {kind}, radius {radius} mm, {angle}°{special}")
        }
        Part::Spiral { radius, turn, rise } => {
            let (radius, angle, rise) = (millimetres(radius), degrees(turn), millimetres(rise));
            let hand = if turn < 0.0 { "right" } else { "left" };
            format!("spiral, rising {rise} mm to the {hand}, radius {radius} mm, {angle}°{special}")
        }
    };
    let (price, mass) = rates(&part, layout);
    let (unit_price, unit_mass) = (rounded(price, 100.0), rounded(mass, 1000.0));
    BillLine {
        article: piece.article.clone(),
        description,
        part,
        count,
        unit_price,
        price: rounded(unit_price * count as f64, 100.0),
        unit_mass,
        mass: rounded(unit_mass * count as f64, 1000.0),
        in_catalog: piece.in_catalog,
    }
}

fn rounded(value: f64, units: f64) -> f64 {
    (value * units).round() / units
}

/// What makes two pieces one article, in the order of the bill: straights, curves, vertical curves, spirals; then
/// length or radius (µm), angle (0.0001°) and rise (µm), stock before cut, the catalogue's before special ones.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    kind: u8,
    size: i64,
    angle: i64,
    rise: i64,
    cut: bool,
    special: bool,
}

impl Key {
    fn of(part: &Part, in_catalog: bool) -> Self {
        let micrometres = |length: f64| (length * 1e6).round() as i64;
        let angle = |turn: f64| (turn.to_degrees() * 1e4).round() as i64;
        let (kind, size, angle, rise, cut) = match *part {
            Part::Straight { length, cut } => (0, length, 0, 0.0, cut),
            Part::Curve { radius, turn } => (1, radius, angle(turn), 0.0, false),
            Part::Vertical { radius, turn } => (2, radius, angle(turn), 0.0, false),
            Part::Spiral { radius, turn, rise } => (3, radius, angle(turn), rise, false),
        };
        Key { kind, size: micrometres(size), angle, rise: micrometres(rise), cut, special: !in_catalog }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Track;
    use crate::model::fixture;

    fn pieces(layout: &Layout) -> Vec<OrderedPiece> {
        let sequence = super::super::sequence(&Track::new(&layout.corners()), layout);
        let (space, _) = super::super::Space::new(layout, &sequence);
        super::super::pieces(&sequence, &space, layout)
    }

    #[test]
    fn a_rectangle_is_billed() {
        let layout = fixture::rectangle(20.0, 10.5, 4.0);
        let bill = bill(&pieces(&layout), &layout);
        let lines: Vec<_> =
            bill.lines.iter().map(|l| (l.article.as_str(), l.description.as_str(), l.count, l.price, l.mass)).collect();
        // Straights: 40 EUR and 100 EUR/m, 25 EUR a cut, 2 kg and 20 kg/m. Curves of π m: 60 EUR and 200 EUR/m
        // (688.32 a piece), 3 kg and 25 kg/m (81.540 kg).
        assert_eq!(
            lines,
            [
                ("ST-2500", "straight cut to 2500 mm", 2, 630.0, 104.0),
                ("ST-3000", "straight, 3000 mm", 8, 2720.0, 496.0),
                ("CU-4000-45", "curve, radius 4000 mm, 45°", 8, 5506.56, 652.32),
            ]
        );
        assert_eq!((bill.count, bill.price, bill.mass), (18, 8856.56, 1252.32));
    }

    #[test]
    fn special_pieces_have_their_own_lines() {
        let mut layout = fixture::rectangle(20.0, 10.5, 4.0);
        layout.vertices[2].radius.value = 4.2;
        let bill = bill(&pieces(&layout), &layout);
        let special: Vec<_> =
            bill.lines.iter().filter(|l| !l.in_catalog).map(|l| (l.description.as_str(), l.count)).collect();
        assert_eq!(special, [("curve, radius 4200 mm, 45°, special", 2)]);
    }
}
