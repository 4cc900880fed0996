//! Rows of a track for a conveyor that is no longer than so much.

use crate::base::trig;
use crate::geometry::{Point, Track};
use crate::model::{Constraint, ConstraintKind, Declared, EquipmentSide, Formula, Layout, Stands, Unit};

/// Equipment whose conveyor has a part in which track is the best.
#[derive(Clone, Copy, Debug)]
pub struct Fed {
    /// Index among what the layout declares.
    pub declared: usize,
    pub from: Point,
    /// EUR/m
    pub price: f64,
}

/// One piece of equipment each, placed freely, with a conveyor that costs.
pub fn fed(layout: &Layout) -> Vec<Fed> {
    let one = |(declared, d): (usize, &Declared)| {
        let single = matches!(d.stands, Stands::Free { count: 1, .. });
        let from = d.fed.filter(|_| single && d.of.conveyor > 0.0)?;
        Some(Fed { declared, from, price: d.of.conveyor })
    };
    layout.equipment.declared.iter().enumerate().filter_map(one).collect()
}

/// Directions in which a conveyor's length is bounded, from along the section to across it, deg.
const DIRECTIONS: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0];

/// What has to hold of the section that equipment stands on for its conveyor to be at most `reach` long, m: its heading is
/// known. The conveyor ends at a point E on the line of the equipment's outer edge, between the section's ends and half the
/// equipment from them. For any direction, |E − F| is no less than what lies between E and F in that direction; with the
/// earliest (or the last) E for those along the section, that is linear in vertices.
pub fn rows(layout: &Layout, written: &Track, fed: &Fed, section: usize, reach: f64) -> Vec<Constraint> {
    let declared = &layout.equipment.declared[fed.declared];
    let of = &declared.of;
    let along = Point::unit(written.straight(section).heading);
    let across = along.left();
    let edge = layout.width.value / 2.0 + of.depth;
    let turned: f64 = written.fillets.iter().map(|f| f.turn).sum();
    let outer = if turned < 0.0 { 1.0 } else { -1.0 };
    let sides: &[f64] = match of.side {
        EquipmentSide::Left => &[1.0],
        EquipmentSide::Right => &[-1.0],
        EquipmentSide::Outer => &[outer],
        EquipmentSide::Inner => &[-outer],
        EquipmentSide::Either | EquipmentSide::Both => &[],
    };
    // gain · (x, y) of a vertex <= high
    let row = |vertex: usize, gain: Point, high: f64| {
        let term = |factor: f64, of: Formula| Formula::Product(vec![Formula::Constant(factor), of]);
        let formula = Formula::Sum(vec![term(gain.x, Formula::X(vertex)), term(gain.y, Formula::Y(vertex))]);
        let kind = ConstraintKind::Require { formula, low: f64::NEG_INFINITY, high, unit: Unit::Metre };
        Constraint { kind, reason: None, span: declared.span }
    };
    let (begin, end) = (section, layout.next(section));
    let inset = of.from_curve + 0.5 * of.stretch;
    let mut rows = Vec::new();
    for degrees in DIRECTIONS {
        let (sin, cos) = trig::sin_cos(degrees.to_radians());
        // Of two sides it may stand on, nothing is known across the section.
        if sides.is_empty() && degrees > 0.0 {
            break;
        }
        let side = sides.first().copied().unwrap_or(0.0);
        for sign in [1.0, -1.0] {
            if degrees == 0.0 && sign < 0.0 {
                continue;
            }
            let aside = sign * sin;
            // E is no earlier than so far behind the first vertex, and no later than as far before the second.
            let of_begin = along * cos + across * aside;
            let of_end = along * -cos + across * aside;
            let offset = aside * side * edge + cos * inset;
            rows.push(row(begin, of_begin, reach + of_begin.dot(fed.from) - offset));
            if degrees < 90.0 {
                rows.push(row(end, of_end, reach + of_end.dot(fed.from) - offset));
            }
        }
    }
    rows
}
