//! Clearance rows: the signed distance of an [`Approach`] or a [`Meeting`] with its derivatives.
//!
//! A row stays valid while the nearest point slides from one part of the track to the next, because the signed distance
//! to a smooth curve is itself smooth there: every evaluation picks the part beside the corner anew among the
//! neighbours of the part the row was found at. What it picked is a [`ClearanceForm`], which other readers of the
//! problem share.

use super::expansion::Expansion;
use super::jet::{Jet, Vector};
use super::measures::{self, AtVertex, Measures};
use crate::geometry::clearance::{Approach, Edge, Feature, NearPiece, Region, offset};
use crate::geometry::proximity::Meeting;
use crate::geometry::{Point, Track};

/// How many parts before and after the one a row was found at are searched for the nearest point.
const WINDOW: usize = 2;

/// The closed form of a clearance row where the track runs now.
#[derive(Clone, Copy, Debug)]
pub enum ClearanceForm {
    /// Offset of a region's corner from a section's line, towards the side where the region lies.
    CornerAtLine { section: usize, corner: Point, lies: f64 },
    /// The same from the circle of the fillet at a vertex.
    CornerAtCircle { vertex: usize, corner: Point, lies: f64 },
    /// Height of a spot of an arc over a region's edge.
    ArcOverEdge { vertex: usize, edge: Edge, spot: Spot },
    /// Distance of a spot of an arc from a section's line, on one side of it.
    ArcAtLine { arc: usize, section: usize, side: f64, spot: Spot },
    /// Distance between an arc and the one it bulges towards, or within which it lies.
    Arcs { arc: usize, other: usize, within: bool },
}

/// Where an arc comes closest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spot {
    /// Beside the centre.
    Crest,
    Begin,
    End,
}

/// The form of an approach to a region.
pub fn form(region: &Region, approach: &Approach, track: &Track) -> ClearanceForm {
    match approach.feature {
        Feature::Corner(i) => {
            let (corner, lies) = (region.polygon.points()[i], region.lies);
            match nearest_part(track, approach.part, corner) {
                NearPiece::Straight(section) => ClearanceForm::CornerAtLine { section, corner, lies },
                NearPiece::Arc(vertex) => ClearanceForm::CornerAtCircle { vertex, corner, lies },
            }
        }
        Feature::Edge(i) => {
            let NearPiece::Arc(vertex) = approach.part else { unreachable!("edges are approached by arcs only") };
            let edge = region.edge(i);
            let fillet = &track.fillets[vertex];
            let height = |p: Point| edge.normal.dot(p - edge.begin);
            let spot = match fillet.faces(-edge.normal) {
                true => Spot::Crest,
                false if height(fillet.begin) < height(fillet.end) => Spot::Begin,
                false => Spot::End,
            };
            ClearanceForm::ArcOverEdge { vertex, edge, spot }
        }
    }
}

/// The form of a meeting of the track with itself.
pub fn own_form(meeting: &Meeting, track: &Track, signs: &[f64]) -> ClearanceForm {
    let (arc, side) = (meeting.arc, meeting.side);
    match meeting.other {
        NearPiece::Straight(section) => {
            let (a, b) = (track.corners[section].point, track.corners[(section + 1) % track.corners.len()].point);
            let (fillet, towards) = (&track.fillets[arc], (b - a).left() * -side);
            let away = |p: Point| -towards.dot(p - a);
            let spot = match fillet.faces(towards) {
                true => Spot::Crest,
                false if away(fillet.begin) < away(fillet.end) => Spot::Begin,
                false => Spot::End,
            };
            ClearanceForm::ArcAtLine { arc, section, side, spot }
        }
        NearPiece::Arc(other) => ClearanceForm::Arcs { arc, other, within: side == signs[other] },
    }
}

/// The signed distance, m, with its derivatives.
pub fn distance(form: &ClearanceForm, measures: &Measures, signs: &[f64]) -> Expansion {
    match *form {
        ClearanceForm::CornerAtLine { section, corner, lies } => {
            let [a, b] = measures.section_ends(section);
            let to_corner = Vector { x: Jet::constant(corner.x) - a.x, y: Jet::constant(corner.y) - a.y };
            let jet = (b - a).cross(&to_corner) * measures.sections[section].reciprocal();
            Expansion::from_jet(&jet, &measures.section_variables(section)).scale(lies)
        }
        ClearanceForm::CornerAtCircle { vertex, corner, lies } => {
            let lateral = measures.at(vertex, |m| {
                let from =
                    Vector { x: m.centre.x + Jet::constant(-corner.x), y: m.centre.y + Jet::constant(-corner.y) };
                (Jet::variable(measures.corners[vertex].radius, 4) - from.norm()).scale(signs[vertex])
            });
            lateral.scale(lies)
        }
        ClearanceForm::ArcOverEdge { vertex, edge, spot } => {
            let height = |v: Vector<7>| {
                (v.x + Jet::constant(-edge.begin.x)).scale(edge.normal.x)
                    + (v.y + Jet::constant(-edge.begin.y)).scale(edge.normal.y)
            };
            let radius = Jet::variable(measures.corners[vertex].radius, 4);
            measures.at(vertex, |m| match spot {
                Spot::Crest => height(m.centre) - radius,
                Spot::Begin => height(m.begin),
                Spot::End => height(m.end),
            })
        }
        ClearanceForm::ArcAtLine { arc, section, side, spot } => arc_at_line(arc, section, side, spot, measures),
        ClearanceForm::Arcs { arc, other, within } => {
            let between = between_centres(arc, other, measures);
            let radius = |v: usize| Expansion::variable(measures.corners[v].radius, measures::radius(v));
            match within {
                true => radius(other).sub(&between).sub(&radius(arc)),
                false => between.sub(&radius(other)).sub(&radius(arc)),
            }
        }
    }
}

fn nearest_part(track: &Track, anchor: NearPiece, q: Point) -> NearPiece {
    let count = track.pieces.len();
    let index = match anchor {
        NearPiece::Straight(v) => 2 * v,
        NearPiece::Arc(v) => (2 * v + count - 1) % count,
    };
    (0..=2 * WINDOW)
        .filter_map(|k| offset(track, (index + count + k - WINDOW) % count, q))
        .min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .map_or(anchor, |(part, _)| part)
}

/// x and y of a point that belongs to a vertex.
fn coordinates(vertex: usize, pick: fn(&AtVertex) -> Vector<7>, measures: &Measures) -> (Expansion, Expansion) {
    (measures.at(vertex, |m| pick(m).x), measures.at(vertex, |m| pick(m).y))
}

fn arc_at_line(arc: usize, section: usize, side: f64, spot: Spot, measures: &Measures) -> Expansion {
    let (x, y) = match spot {
        Spot::Crest => coordinates(arc, |m| m.centre, measures),
        Spot::Begin => coordinates(arc, |m| m.begin, measures),
        Spot::End => coordinates(arc, |m| m.end, measures),
    };
    let [a, b] = measures.section_ends(section);
    let along = (b - a).times(&measures.sections[section].reciprocal());
    let on_line = |jet: &Jet<4>| Expansion::from_jet(jet, &measures.section_variables(section));
    let (ux, uy, ax, ay) = (on_line(&along.x), on_line(&along.y), on_line(&a.x), on_line(&a.y));
    let lateral = ux.mul(&y.sub(&ay)).sub(&uy.mul(&x.sub(&ax))).scale(side);
    match spot {
        Spot::Crest => lateral.sub(&Expansion::variable(measures.corners[arc].radius, measures::radius(arc))),
        Spot::Begin | Spot::End => lateral,
    }
}

fn between_centres(a: usize, b: usize, measures: &Measures) -> Expansion {
    let ((x, y), (u, v)) = (coordinates(a, |m| m.centre, measures), coordinates(b, |m| m.centre, measures));
    let (dx, dy) = (x.sub(&u), y.sub(&v));
    dx.mul(&dx).add(&dy.mul(&dy)).square_root()
}
