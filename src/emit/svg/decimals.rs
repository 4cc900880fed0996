//! Numbers of one kind with the same number of decimals.

use crate::base::number::{fixed, trimmed};
use crate::base::trig;
use crate::compiled::Compiled;
use crate::emit::plan::{Climb, PointGroup, WallDistance};
use crate::geometry::PieceKind;
use crate::model::Coordinate;

/// How many decimals each kind of number has on a drawing: as many as its longest number needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Decimals {
    /// Of straights, m.
    pub length: usize,
    /// Of straights, degrees.
    pub heading: usize,
    pub radius: usize,
    pub turn: usize,
    /// Of slopes, %.
    pub slope: usize,
    pub height: usize,
    /// Distances from walls, m.
    pub wall: usize,
    /// Coordinates and arc lengths, m.
    pub coordinate: usize,
}

/// The decimals, at most so many, that the longest of these numbers needs.
pub fn needed(values: impl IntoIterator<Item = f64>, most: usize) -> usize {
    let of = |value: f64| trimmed(value, most).split_once('.').map_or(0, |(_, decimals)| decimals.len());
    values.into_iter().map(of).max().unwrap_or(0)
}

impl Decimals {
    pub fn new(compiled: &Compiled, climbs: &[Climb], walls: &[WallDistance], points: &[PointGroup]) -> Self {
        let (track, drawing) = (&compiled.track, &compiled.layout.drawing);
        let straights = || track.pieces.iter().filter(|p| p.kind == PieceKind::Straight && p.length.abs() > 1e-9);
        let curved = || track.fillets.iter().filter(|fillet| fillet.length() > 1e-9);
        let points = || points.iter().flat_map(|group| &group.points);
        let axes = drawing.axes.iter().map(|axis| match axis.coordinate {
            Coordinate::X => axis.at - drawing.origin.x,
            Coordinate::Y => axis.at - drawing.origin.y,
        });
        let degrees = |angle: f64| angle * 180.0 / trig::PI;
        Decimals {
            length: needed(straights().map(|piece| piece.length), 3),
            heading: needed(straights().map(|piece| degrees(piece.heading)), 2),
            radius: needed(curved().map(|fillet| fillet.radius), 3),
            turn: needed(curved().map(|fillet| degrees(fillet.turn)), 2),
            slope: needed(climbs.iter().map(|climb| 100.0 * climb.slope), 2),
            height: needed(climbs.iter().flat_map(|climb| [climb.from, climb.to]), 3),
            wall: needed(walls.iter().map(|wall| wall.distance), 3),
            coordinate: needed(points().flat_map(|p| [p.at.x, p.at.y, p.s.unwrap_or(0.0)]).chain(axes), 3),
        }
    }

    /// A length (m) or angle as text.
    pub fn text(value: f64, decimals: usize) -> String {
        fixed(value, decimals)
    }
}

#[cfg(test)]
mod tests {
    use super::needed;

    #[test]
    fn the_longest_number_decides() {
        assert_eq!(needed([1.0, 2.5, 3.25], 3), 2);
        assert_eq!(needed([4.0, 5.0], 3), 0);
        assert_eq!(needed([1.0 / 3.0], 3), 3);
        assert_eq!(needed([2.0 + 1e-9], 3), 0);
        assert_eq!(needed([], 3), 0);
    }
}
