//! A block for each article, inserted where its pieces lie, with what the bill says of it as attributes.

use std::collections::BTreeMap;

use crate::base::number::trimmed;
use crate::base::trig;
use crate::compiled::Compiled;
use crate::elements::{OrderedPiece, Part};
use crate::emit::plan::PlanCurve;
use crate::geometry::Point;

use super::tags::symbol;
use super::writer::{Attribute, Writer};

const LAYER: &str = "ELEMENTS";

/// Blocks of the articles, and every piece of the track.
pub fn elements(dxf: &mut Writer, compiled: &Compiled) {
    let half = compiled.layout.width.value / 2.0;
    // Name of the block and how long its picture is in the plan, by article.
    let mut blocks: BTreeMap<&str, (String, f64)> = BTreeMap::new();
    for piece in &compiled.pieces {
        if !blocks.contains_key(piece.article.as_str()) {
            let name = unused(&symbol(&piece.article), &blocks);
            define(dxf, &name, piece, half, &attributes(compiled, piece));
            blocks.insert(&piece.article, (name, piece.place.run));
        }
        let Some((name, run)) = blocks.get(piece.article.as_str()) else { continue };
        let (at, heading) = (piece.place.position, piece.place.heading);
        let values = attributes(compiled, piece);
        match turn(&piece.part) {
            // A left curve turned end for end is a right one.
            Some((radius, turn)) if turn < 0.0 => {
                let centre = at - Point::unit(heading).left() * radius;
                let end = centre + Point::unit(heading + turn).left() * radius;
                dxf.insert(LAYER, name, end, heading + turn + trig::PI, 1.0, &values);
            }
            Some(_) => dxf.insert(LAYER, name, at, heading, 1.0, &values),
            // On a slope, a straight is shorter in the plan.
            None => dxf.insert(LAYER, name, at, heading, piece.place.run / run, &values),
        }
    }
}

/// The name, or with a number where another article has it.
fn unused(name: &str, blocks: &BTreeMap<&str, (String, f64)>) -> String {
    let is_free = |name: &String| blocks.values().all(|(other, _)| !other.eq_ignore_ascii_case(name));
    let numbered = (2..).map(|k| format!("{name}${k}"));
    std::iter::once(name.to_owned()).chain(numbered).find(is_free).unwrap_or_default()
}

/// Radius and turn (left positive) of what is an arc in the plan.
fn turn(part: &Part) -> Option<(f64, f64)> {
    match *part {
        Part::Curve { radius, turn } | Part::Spiral { radius, turn, .. } => Some((radius, turn)),
        Part::Straight { .. } | Part::Vertical { .. } => None,
    }
}

/// The outline of a piece from its begin along +x, turning left where it turns.
fn define(dxf: &mut Writer, name: &str, piece: &OrderedPiece, half: f64, attributes: &[Attribute]) {
    dxf.block(name.to_owned(), 2, |dxf| {
        let end = |at: Point, heading: f64| {
            let across = Point::unit(heading).left() * half;
            (at + across, at - across)
        };
        let (left, right) = end(Point::default(), 0.0);
        dxf.line(LAYER, left, right);
        let (far_left, far_right) = match turn(&piece.part) {
            Some((radius, turn)) => {
                let (centre, turn) = (Point::new(0.0, radius), turn.abs());
                for radius in [radius - half, radius + half].into_iter().filter(|radius| *radius > 1e-9) {
                    let arc = PlanCurve::Arc { centre, radius, start: -trig::FRAC_PI_2, sweep: turn };
                    dxf.curve(LAYER, &arc);
                }
                end(centre - Point::unit(turn).left() * radius, turn)
            }
            None => {
                let far = end(Point::new(piece.place.run, 0.0), 0.0);
                dxf.line(LAYER, left, far.0);
                dxf.line(LAYER, right, far.1);
                far
            }
        };
        dxf.line(LAYER, far_left, far_right);
        for attribute in attributes {
            dxf.attribute(LAYER, attribute);
        }
    });
}

/// What the bill says of an article, in mm and degrees.
fn attributes(compiled: &Compiled, piece: &OrderedPiece) -> Vec<Attribute> {
    let millimetres = |metres: f64| trimmed(1e3 * metres, 3);
    let degrees = |angle: f64| trimmed(angle * 180.0 / trig::PI, 4);
    let line = compiled.bill.lines.iter().find(|line| line.article == piece.article);
    let description = line.map_or(String::new(), |line| line.description.clone());
    let mut attributes = vec![
        ("ARTICLE", "article", piece.article.clone()),
        ("DESCRIPTION", "description", description),
        ("LENGTH_MM", "length of the centre line, mm", millimetres(piece.part.length())),
    ];
    match piece.part {
        Part::Straight { .. } => {}
        Part::Curve { radius, turn } => {
            attributes.push(("RADIUS_MM", "radius of the centre line, mm", millimetres(radius)));
            attributes.push(("ANGLE_DEG", "turn, degrees", degrees(turn.abs())));
        }
        Part::Vertical { radius, turn } => {
            attributes.push(("RADIUS_MM", "radius of the centre line, mm", millimetres(radius)));
            attributes.push(("ANGLE_DEG", "change of the slope angle, degrees", degrees(turn)));
        }
        Part::Spiral { radius, turn, rise } => {
            attributes.push(("RADIUS_MM", "radius of the centre line, mm", millimetres(radius)));
            attributes.push(("ANGLE_DEG", "turn, degrees", degrees(turn.abs())));
            attributes.push(("RISE_MM", "rise, mm", millimetres(rise)));
        }
    }
    attributes
}
