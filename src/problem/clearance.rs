//! Clearance rows: the signed distance of an [`Approach`] or a [`Meeting`] with its derivatives.
//!
//! A row stays valid while the nearest point slides from one part of the track to the next, because the signed
//! distance to a smooth curve is itself smooth there: every evaluation picks the part beside the corner anew among
//! the neighbours of the part the row was found at.

use super::expansion::Expansion;
use super::jet::{Jet, Vector};
use super::measures::{self, AtVertex, Measures};
use crate::geometry::clearance::{Approach, Feature, Part, Region, offset};
use crate::geometry::proximity::Meeting;
use crate::geometry::{Point, Track};

/// How many parts before and after the one a row was found at are searched for the nearest point.
const WINDOW: usize = 2;

/// Signed distance from the centre line to the region at this approach, m.
pub fn distance(region: &Region, approach: &Approach, track: &Track, measures: &Measures, signs: &[f64]) -> Expansion {
    match approach.feature {
        Feature::Corner(i) => {
            let q = region.polygon.points()[i];
            let part = nearest_part(track, approach.part, q);
            lateral(part, q, measures, signs).scale(region.lies)
        }
        Feature::Edge(i) => {
            let Part::Arc(vertex) = approach.part else { unreachable!("edges are approached by arcs only") };
            let edge = region.edge(i);
            let fillet = &track.fillets[vertex];
            let normal = edge.normal;
            let toward = |v: Vector<7>| {
                (v.x + Jet::constant(-edge.begin.x)).scale(normal.x)
                    + (v.y + Jet::constant(-edge.begin.y)).scale(normal.y)
            };
            // The arc's lowest point over the edge: beside the centre, or an end of the arc.
            if fillet.faces(-normal) {
                let radius = Jet::variable(fillet.radius, 4);
                measures.at(vertex, |m| toward(m.centre) - radius)
            } else if normal.dot(fillet.begin - edge.begin) < normal.dot(fillet.end - edge.begin) {
                measures.at(vertex, |m| toward(m.begin))
            } else {
                measures.at(vertex, |m| toward(m.end))
            }
        }
    }
}

fn nearest_part(track: &Track, anchor: Part, q: Point) -> Part {
    let count = track.pieces.len();
    let index = match anchor {
        Part::Straight(v) => 2 * v,
        Part::Arc(v) => (2 * v + count - 1) % count,
    };
    (0..=2 * WINDOW)
        .filter_map(|k| offset(track, (index + count + k - WINDOW) % count, q))
        .min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .map_or(anchor, |(part, _)| part)
}

/// Lateral offset of `q` from the line or circle of a part, m, left positive.
fn lateral(part: Part, q: Point, measures: &Measures, signs: &[f64]) -> Expansion {
    match part {
        Part::Straight(i) => {
            let [a, b] = measures.section_ends(i);
            let along = b - a;
            let to_q = Vector { x: Jet::constant(q.x) - a.x, y: Jet::constant(q.y) - a.y };
            let jet = along.cross(&to_q) * measures.sections[i].reciprocal();
            Expansion::from_jet(&jet, &measures.section_variables(i))
        }
        Part::Arc(i) => measures.at(i, |m| {
            let from_q = Vector { x: m.centre.x + Jet::constant(-q.x), y: m.centre.y + Jet::constant(-q.y) };
            (Jet::variable(measures.corners[i].radius, 4) - from_q.norm()).scale(signs[i])
        }),
    }
}

/// Distance between two parts of the centre line, m.
pub fn own_distance(meeting: &Meeting, track: &Track, measures: &Measures, signs: &[f64]) -> Expansion {
    let arc = meeting.arc;
    let coordinates =
        |v: usize, pick: fn(&AtVertex) -> Vector<7>| (measures.at(v, |m| pick(m).x), measures.at(v, |m| pick(m).y));
    let (x, y) = coordinates(arc, |m| m.centre);
    let radius = |v: usize| Expansion::variable(measures.corners[v].radius, measures::radius(v));
    match meeting.other {
        Part::Straight(i) => {
            let [a, b] = measures.section_ends(i);
            let along = (b - a).times(&measures.sections[i].reciprocal());
            let on_line = |jet: &Jet<4>| Expansion::from_jet(jet, &measures.section_variables(i));
            let (ux, uy, ax, ay) = (on_line(&along.x), on_line(&along.y), on_line(&a.x), on_line(&a.y));
            let lateral =
                |x: &Expansion, y: &Expansion| ux.mul(&y.sub(&ay)).sub(&uy.mul(&x.sub(&ax))).scale(meeting.side);
            let straight = track.straight(i);
            let towards = (straight.end - straight.begin).left() * -meeting.side;
            if track.fillets[arc].faces(towards) {
                return lateral(&x, &y).sub(&radius(arc));
            }
            // The arc's end that is nearer to the line.
            let [begin, end] =
                [coordinates(arc, |m| m.begin), coordinates(arc, |m| m.end)].map(|(x, y)| lateral(&x, &y));
            if begin.value < end.value { begin } else { end }
        }
        Part::Arc(other) => {
            let (u, v) = coordinates(other, |m| m.centre);
            let (dx, dy) = (x.sub(&u), y.sub(&v));
            let squared = dx.mul(&dx).add(&dy.mul(&dy));
            let between = squared.square_root();
            if meeting.side == signs[other] {
                radius(other).sub(&between).sub(&radius(arc))
            } else {
                between.sub(&radius(other)).sub(&radius(arc))
            }
        }
    }
}
