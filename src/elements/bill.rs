//! The bill of elements: how many of each article, what they cost and what they weigh.

use std::collections::BTreeMap;

use super::sequence::{degrees, millimetres};
use super::{Sequence, Shape};
use crate::model::Layout;
use serde::Serialize;

/// One article of the bill.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BillLine {
    pub article: String,
    pub description: String,
    /// Of one piece; a curve's turn is positive, since a left curve turned end for end is a right one.
    pub shape: Shape,
    pub count: usize,
    /// EUR a piece and in all; a piece's price is rounded to the cent.
    pub unit_price: f64,
    pub price: f64,
    /// kg a piece and in all; a piece's mass is rounded to the gram.
    pub unit_mass: f64,
    pub mass: f64,
    pub in_catalog: bool,
}

/// The bill of elements: articles in a fixed order (straights by length, then curves by radius and angle).
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
pub fn bill(sequence: &Sequence, layout: &Layout) -> Bill {
    let mut counts: BTreeMap<Key, (usize, &super::Element)> = BTreeMap::new();
    for element in &sequence.elements {
        counts.entry(Key::of(&element.shape, element.in_catalog)).or_insert((0, element)).0 += 1;
    }
    let lines: Vec<BillLine> = counts.into_values().map(|(count, element)| line(count, element, layout)).collect();
    Bill {
        count: lines.iter().map(|l| l.count).sum(),
        price: rounded(lines.iter().map(|l| l.price).sum(), 100.0),
        mass: rounded(lines.iter().map(|l| l.mass).sum(), 1000.0),
        lines,
    }
}

fn line(count: usize, element: &super::Element, layout: &Layout) -> BillLine {
    let (straight, curve) = (&layout.catalog.straight, &layout.catalog.curve);
    let special = if element.in_catalog { "" } else { ", special" };
    let (shape, price, mass, description) = match element.shape {
        Shape::Straight { length, cut } => {
            let how = if cut { " cut to" } else { "," };
            let surcharge = if cut { straight.cut_price } else { 0.0 };
            let description = format!("straight{how} {} mm{special}", millimetres(length));
            (element.shape, straight.price.of(length) + surcharge, straight.mass.of(length), description)
        }
        Shape::Curve { radius, turn } => {
            let length = element.shape.length();
            let description = format!("curve, radius {} mm, {}°{special}", millimetres(radius), degrees(turn));
            let shape = Shape::Curve { radius, turn: turn.abs() };
            (shape, curve.price.of(length), curve.mass.of(length), description)
        }
    };
    let (unit_price, unit_mass) = (rounded(price, 100.0), rounded(mass, 1000.0));
    BillLine {
        article: element.article.clone(),
        description,
        shape,
        count,
        unit_price,
        price: rounded(unit_price * count as f64, 100.0),
        unit_mass,
        mass: rounded(unit_mass * count as f64, 1000.0),
        in_catalog: element.in_catalog,
    }
}

fn rounded(value: f64, units: f64) -> f64 {
    (value * units).round() / units
}

/// What makes two pieces one article, in the order of the bill: straights before curves, then length or radius (µm),
/// then angle (0.0001°), stock before cut, the catalogue's before special ones.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    curve: bool,
    size: i64,
    angle: i64,
    cut: bool,
    special: bool,
}

impl Key {
    fn of(shape: &Shape, in_catalog: bool) -> Self {
        let micrometres = |length: f64| (length * 1e6).round() as i64;
        let special = !in_catalog;
        match *shape {
            Shape::Straight { length, cut } => Key { curve: false, size: micrometres(length), angle: 0, cut, special },
            Shape::Curve { radius, turn } => {
                let angle = (turn.abs().to_degrees() * 1e4).round() as i64;
                Key { curve: true, size: micrometres(radius), angle, cut: false, special }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Track;
    use crate::model::fixture;

    #[test]
    fn a_rectangle_is_billed() {
        let layout = fixture::rectangle(20.0, 10.5, 4.0);
        let bill = bill(&super::super::sequence(&Track::new(&layout.corners()), &layout), &layout);
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
        let bill = bill(&super::super::sequence(&Track::new(&layout.corners()), &layout), &layout);
        let special: Vec<_> =
            bill.lines.iter().filter(|l| !l.in_catalog).map(|l| (l.description.as_str(), l.count)).collect();
        assert_eq!(special, [("curve, radius 4200 mm, 45°, special", 2)]);
    }
}
