//! Building and obstacles: closed outlines as polygons that a layout can keep clear of.
//!
//! The language's polygons have straight sides. Where an outline is round, the polygon errs to the safe side: an
//! obstacle's holds the whole of it, a building's lies within it.

use super::shapes::{Drawn, Items, Label};
use super::walk::{self, metres, place};
use super::{BUILDING_CLEARANCE, DrawnArea, OBSTACLE_CLEARANCE, Plan, simple, write};
use crate::base::number::tidy;
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Curve, Point, Polygon};
use crate::source::Span;

/// An arc becomes sides of at most this angle, rad.
const STEP: f64 = trig::PI / 8.0;
/// Points of a polygon of the language.
const MOST: usize = 1000;

/// Reads areas off a drawing.
pub struct Areas<'a> {
    pub items: &'a Items,
    /// m
    pub tolerance: f64,
}

/// A polygon with the place it comes from.
struct Outline {
    polygon: Polygon,
    span: Span,
}

impl Areas<'_> {
    /// The largest outline of the layer.
    pub fn building(&self, layer: &str, said: &mut Vec<Diagnostic>) -> Option<DrawnArea> {
        let mut outlines = self.outlines(layer, false, said);
        outlines.sort_by(|a, b| b.polygon.area().total_cmp(&a.polygon.area()));
        let mut outlines = outlines.into_iter();
        let largest = outlines.next()?;
        let rest: Vec<Outline> = outlines.collect();
        if let Some(first) = rest.first() {
            let mut diagnostic = Diagnostic::new(
                Code::W0802,
                format!("layer `{layer}` has more outlines than the building's"),
                first.span,
                "not taken over",
            )
            .related(largest.span, "the largest one, taken for the building")
            .expected("one closed outline", (rest.len() + 1).to_string())
            .help("put columns and rooms on a layer of obstacles");
            for other in rest.iter().skip(1).take(12) {
                diagnostic = diagnostic.related(other.span, "not taken over");
            }
            said.push(diagnostic);
        }
        let clearances = self.clearances(&[&largest], BUILDING_CLEARANCE);
        let clearance = clearances.first().copied().unwrap_or(0.0);
        Some(DrawnArea { name: String::new(), points: largest.polygon.points().to_vec(), clearance })
    }

    /// Every outline of the layers, named by a text in it if there is one.
    pub fn obstacles(&self, layers: &[String], said: &mut Vec<Diagnostic>) -> Vec<DrawnArea> {
        let outlines: Vec<Outline> = layers.iter().flat_map(|layer| self.outlines(layer, true, said)).collect();
        let clearances = self.clearances(&outlines.iter().collect::<Vec<_>>(), OBSTACLE_CLEARANCE);
        let mut areas: Vec<DrawnArea> = Vec::with_capacity(outlines.len());
        for (number, (outline, clearance)) in outlines.iter().zip(clearances).enumerate() {
            let taken = |name: &String| areas.iter().any(|area| area.name == *name);
            let label = self.label(&outline.polygon).map(|label| write::as_name(&label.text, "obstacle"));
            let name = label.filter(|name| !taken(name)).unwrap_or_else(|| {
                let numbers = (number + 1..).map(|k| format!("obstacle_{k}"));
                numbers.into_iter().find(|name| !taken(name)).unwrap_or_default()
            });
            areas.push(DrawnArea { name, points: outline.polygon.points().to_vec(), clearance });
        }
        areas
    }

    /// The text in the polygon that is nearest to its middle.
    fn label(&self, polygon: &Polygon) -> Option<&Label> {
        let (low, high) = polygon.bounds();
        let middle = low.lerp(high, 0.5);
        let inside = |label: &&Label| {
            let p = label.at;
            let near = p.x >= low.x && p.y >= low.y && p.x <= high.x && p.y <= high.y;
            near && (p.distance(middle) < 1e-6 || polygon.contains(p)) && label.text.chars().any(char::is_alphabetic)
        };
        let distance = |label: &&Label| label.at.distance(middle);
        self.items.labels.iter().filter(inside).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Clearance of each outline as our own export draws it: lines that all keep one distance, m; else 0.
    fn clearances(&self, outlines: &[&Outline], layer: &str) -> Vec<f64> {
        let mut distances = vec![Vec::new(); outlines.len()];
        for piece in self.on(layer) {
            let middle = piece.curve.at(piece.curve.length() / 2.0);
            let away = outlines.iter().map(|o| o.polygon.distance_to_outline(middle)).enumerate();
            if let Some((i, distance)) = away.min_by(|a, b| a.1.total_cmp(&b.1)) {
                distances[i].push(distance);
            }
        }
        let rounded = |d: f64| tidy((d * 1e6).round() / 1e6);
        distances.into_iter().map(|all| agreed(all.into_iter()).map_or(0.0, rounded)).collect()
    }

    fn on(&self, layer: &str) -> Vec<Drawn> {
        let shapes = self.items.shapes.iter().filter(|shape| shape.layer.eq_ignore_ascii_case(layer));
        shapes.flat_map(|shape| shape.pieces()).collect()
    }

    /// The closed outlines of a layer; `outside` when a polygon must hold all of a round outline.
    fn outlines(&self, layer: &str, outside: bool, said: &mut Vec<Diagnostic>) -> Vec<Outline> {
        let (mut outlines, mut loose) = (Vec::new(), Vec::new());
        let mut take = |ring: &[Drawn], said: &mut Vec<Diagnostic>| match polygon(ring, outside) {
            Ok(polygon) => outlines.push(Outline { polygon, span: ring[0].span }),
            Err(found) => said.push(
                Diagnostic::new(
                    Code::W0802,
                    format!("an outline on layer `{layer}` is no area"),
                    ring[0].span,
                    "ignored",
                )
                .expected("a closed outline that does not cross itself", found)
                .help("fix it in the drawing, or add the polygon to the layout by hand"),
            ),
        };
        for shape in self.items.shapes.iter().filter(|shape| shape.layer.eq_ignore_ascii_case(layer)) {
            let pieces = shape.pieces();
            match (pieces.first(), pieces.last()) {
                (Some(first), Some(last)) if first.curve.begin().distance(last.curve.end()) <= self.tolerance => {
                    take(&pieces, said);
                }
                _ => loose.extend(pieces),
            }
        }
        let (closed, open) = walk::loops(&loose, self.tolerance);
        for ring in closed {
            take(&ring, said);
        }
        if let Some(first) = open.first() {
            let label = format!("begins {}", place(first.curve.begin()));
            let message = format!("an outline on layer `{layer}` is not closed");
            let mut diagnostic = Diagnostic::new(Code::W0802, message, first.span, label)
                .expected(
                    format!("ends that meet within {}", metres(self.tolerance)),
                    format!("{}, left out", walk::count(open.len(), "open outline")),
                )
                .help("close it in the drawing, or add the polygon to the layout by hand");
            for other in open.iter().skip(1).take(12) {
                diagnostic = diagnostic.related(other.span, "not closed either");
            }
            said.push(diagnostic);
        }
        outlines
    }
}

/// A closed outline as a polygon, or what it is instead.
fn polygon(ring: &[Drawn], outside: bool) -> Result<Polygon, String> {
    // Twice the signed area, with the segments between chords and arcs.
    let area: f64 = ring
        .iter()
        .map(|piece| match piece.curve {
            Curve::Segment { begin, end } => begin.cross(end),
            Curve::Arc { begin, end, radius, sweep, .. } => {
                begin.cross(end) + radius * radius * (sweep - trig::sin(sweep))
            }
        })
        .sum();
    let mut points: Vec<Point> = Vec::new();
    for piece in ring {
        let Curve::Arc { begin, centre, radius, start, sweep, .. } = piece.curve else {
            points.push(piece.curve.begin());
            continue;
        };
        let count = (sweep.abs() / STEP - 1e-9).ceil().max(1.0);
        let step = sweep / count;
        let around = (sweep.abs() - trig::TAU).abs() < 1e-9;
        let bulges = sweep * area > 0.0;
        if !around || bulges != outside {
            points.push(begin);
        }
        let inner = (0..count as usize).map(|k| k as f64);
        match bulges == outside {
            // Tangents, which meet outside the arc.
            true => points.extend(
                inner.map(|k| centre + Point::unit(start + (k + 0.5) * step) * (radius / trig::cos(step / 2.0))),
            ),
            // Chords.
            false => points.extend(inner.skip(1).map(|k| centre + Point::unit(start + k * step) * radius)),
        }
    }
    points = points.into_iter().map(|p| Point::new(tidy(p.x), tidy(p.y))).collect();
    points.dedup_by(|a, b| a.distance(*b) < 1e-6);
    while points.len() > 1 && points[0].distance(points[points.len() - 1]) < 1e-6 {
        points.pop();
    }
    if points.len() > MOST {
        return Err(format!("{} corners, more than the {MOST} of a polygon", points.len()));
    }
    simple(&points).ok_or_else(|| "an outline that is flat, or crosses or touches itself".to_string())
}

/// The distance that all share, m.
pub fn agreed(mut distances: impl Iterator<Item = f64>) -> Option<f64> {
    let first = distances.next()?;
    distances.all(|d| (d - first).abs() < 1e-6).then_some(first)
}

impl Plan {
    /// Number of polygons.
    pub fn areas(&self) -> usize {
        self.obstacles.len() + usize::from(self.building.is_some())
    }
}
