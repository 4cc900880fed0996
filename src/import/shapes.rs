//! Entities as lines and arcs in the plane: LINE, ARC, CIRCLE, LWPOLYLINE and POLYLINE, where they lie in the world
//! (AutoCAD DXF Reference, "Entities" and "Object Coordinate Systems"). Heights are left out.

use super::tags::Tag;
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Curve, Point};
use crate::source::Span;

/// An entity as it stands in the file.
#[derive(Clone, Debug)]
pub struct Raw<'a> {
    pub kind: &'a str,
    pub span: Span,
    pub tags: &'a [Tag<'a>],
    /// Of a POLYLINE.
    pub vertices: Vec<Raw<'a>>,
}

/// A line or an arc with the entity that it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    pub curve: Curve,
    pub span: Span,
    /// Whether the file gives it a direction: an ARC runs counter-clockwise whatever was meant.
    pub directed: bool,
}

/// The lines and arcs of an entity, one behind the other.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnShape {
    pub layer: String,
    /// Each with the line of the file that it is written on.
    pub curves: Vec<(Curve, Span)>,
    pub directed: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub layer: String,
    pub at: Point,
}

/// A text and its anchor.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    pub at: Point,
    pub text: String,
}

/// An entity that is no line and no arc in the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Unreadable {
    pub layer: String,
    pub what: String,
    pub span: Span,
}

/// Everything that was found, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Items {
    pub shapes: Vec<DrawnShape>,
    pub points: Vec<Mark>,
    pub labels: Vec<Label>,
    pub unreadable: Vec<Unreadable>,
}

type Read<T> = Result<T, Box<Diagnostic>>;

impl Raw<'_> {
    pub fn text(&self, code: i32) -> Option<&str> {
        self.tags.iter().find(|tag| tag.code == code).map(|tag| tag.value)
    }

    /// The number of that code, or what the format says where it is not there (or is no number).
    pub fn real_or(&self, code: i32, default: f64) -> f64 {
        self.tags.iter().find(|tag| tag.code == code).and_then(|tag| tag.real().ok()).unwrap_or(default)
    }

    /// In paper space, or invisible.
    pub fn hidden(&self) -> bool {
        self.real_or(67, 0.0) == 1.0 || self.real_or(60, 0.0) == 1.0
    }

    fn real(&self, code: i32) -> Read<f64> {
        match self.tags.iter().find(|tag| tag.code == code) {
            Some(tag) => tag.real(),
            None => Err(Box::new(
                Diagnostic::new(Code::E0801, "an entity is not complete", self.span, format!("this {}", self.kind))
                    .expected(format!("a value for group code {code}"), "none"),
            )),
        }
    }

    fn point(&self, code: i32) -> Read<Point> {
        Ok(Point::new(self.real(code)?, self.real(code + 10)?))
    }

    fn flags(&self) -> i64 {
        self.real_or(70, 0.0) as i64
    }
}

/// Where an entity's coordinates lie in the world: p ↦ M p + shift.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    x: Point,
    y: Point,
    shift: Point,
}

impl Default for Placement {
    fn default() -> Self {
        Placement { x: Point::new(1.0, 0.0), y: Point::new(0.0, 1.0), shift: Point::default() }
    }
}

impl Placement {
    fn vector(&self, v: Point) -> Point {
        self.x * v.x + self.y * v.y
    }

    fn at(&self, p: Point) -> Point {
        self.vector(p) + self.shift
    }

    /// First `inner`, then this one.
    fn after(&self, inner: &Placement) -> Placement {
        Placement { x: self.vector(inner.x), y: self.vector(inner.y), shift: self.at(inner.shift) }
    }

    /// A block at its insert; columns and rows count from zero.
    pub fn insert(&self, entity: &Raw, base: Point, column: usize, row: usize) -> Placement {
        let (sin, cos) = trig::sin_cos(entity.real_or(50, 0.0) * trig::PI / 180.0);
        let turn = Placement { x: Point::new(cos, sin), y: Point::new(-sin, cos), shift: Point::default() };
        let at = Point::new(entity.real_or(10, 0.0), entity.real_or(20, 0.0));
        let grid = Point::new(entity.real_or(44, 0.0) * column as f64, entity.real_or(45, 0.0) * row as f64);
        let (across, up) = (Point::new(entity.real_or(41, 1.0), 0.0), Point::new(0.0, entity.real_or(42, 1.0)));
        let scaled = Placement { x: across, y: up, shift: grid - (across * base.x + up * base.y) };
        let placed = Placement { shift: at, ..turn }.after(&scaled);
        self.after(&if mirrored(entity) { MIRROR.after(&placed) } else { placed })
    }

    /// Factor of lengths and sense of rotation, if circles stay circles.
    fn similar(&self) -> Option<(f64, f64)> {
        let (a, b) = (self.x.norm(), self.y.norm());
        let round = (a - b).abs() <= 1e-9 * a && self.x.dot(self.y).abs() <= 1e-9 * a * a && a > 0.0;
        round.then(|| (a, self.x.cross(self.y).signum()))
    }

    /// The curve where it lies; `None` for an arc that becomes an ellipse.
    fn curve(&self, curve: &Curve) -> Option<Curve> {
        Some(match *curve {
            Curve::Segment { begin, end } => Curve::Segment { begin: self.at(begin), end: self.at(end) },
            Curve::Arc { begin, end, centre, radius, sweep, .. } => {
                let (factor, sense) = self.similar()?;
                let (begin, end, centre) = (self.at(begin), self.at(end), self.at(centre));
                let (radius, start) = (radius * factor, (begin - centre).heading());
                Curve::Arc { begin, end, centre, radius, start, sweep: sweep * sense }
            }
        })
    }
}

/// Object coordinates seen from below: x points the other way (arbitrary axis algorithm).
const MIRROR: Placement = Placement { x: Point::new(-1.0, 0.0), y: Point::new(0.0, 1.0), shift: Point::new(0.0, 0.0) };

fn mirrored(entity: &Raw) -> bool {
    entity.real_or(230, 1.0) < 0.0
}

fn tilted(entity: &Raw) -> bool {
    entity.real_or(210, 0.0).abs() > 1e-6 || entity.real_or(220, 0.0).abs() > 1e-6
}

/// An arc or, where the sweep is a whole turn, a circle.
pub fn arc(centre: Point, radius: f64, start: f64, sweep: f64) -> Curve {
    let at = |angle: f64| centre + Point::unit(angle) * radius;
    Curve::Arc { begin: at(start), end: at(start + sweep), centre, radius, start, sweep }
}

/// The side of a polyline with its bulge, the tangent of a quarter of the angle that the arc sweeps.
fn side(begin: Point, end: Point, bulge: f64) -> Curve {
    let chord = end - begin;
    if bulge.abs() < 1e-9 || chord.norm() == 0.0 {
        return Curve::Segment { begin, end };
    }
    let sweep = 4.0 * trig::atan(bulge);
    let radius = chord.norm() * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
    let centre = begin + chord * 0.5 + chord.left() * ((1.0 - bulge * bulge) / (4.0 * bulge));
    Curve::Arc { begin, end, centre, radius, start: (begin - centre).heading(), sweep }
}

/// A polyline's vertex with the bulge of the side behind it.
struct Vertex {
    at: Point,
    bulge: f64,
    span: Span,
}

fn polyline(vertices: &[Vertex], closed: bool) -> Vec<(Curve, Span)> {
    let around = vertices.first().filter(|_| closed && vertices.len() > 1);
    let ends = vertices.iter().skip(1).chain(around);
    let sides = vertices.iter().zip(ends).map(|(a, b)| (side(a.at, b.at, a.bulge), a.span));
    // Without points that are drawn twice.
    sides.filter(|(curve, _)| curve.length() > 0.0).collect()
}

/// Kinds that describe a drawing and are no part of it.
const ANNOTATIONS: [&str; 18] = [
    "ATTDEF",
    "ATTRIB",
    "ACAD_TABLE",
    "ARC_DIMENSION",
    "DIMENSION",
    "HATCH",
    "IMAGE",
    "LEADER",
    "MTEXT",
    "MULTILEADER",
    "SEQEND",
    "SOLID",
    "TEXT",
    "TOLERANCE",
    "TRACE",
    "VERTEX",
    "VIEWPORT",
    "WIPEOUT",
];

/// Takes an entity over. Points and texts are kept from every layer, shapes from the wanted ones.
pub fn read(entity: &Raw, layer: &str, placement: &Placement, wanted: bool, items: &mut Items) -> Read<()> {
    // LINE and POINT have world coordinates, the others those of their object.
    let flat = matches!(entity.kind, "LINE" | "POINT");
    let placement = &if mirrored(entity) && !flat { placement.after(&MIRROR) } else { *placement };
    match entity.kind {
        "POINT" => items.points.push(Mark { layer: layer.to_string(), at: placement.at(entity.point(10)?) }),
        "TEXT" => {
            // Aligned text has its anchor in 11 and 21.
            let anchored = entity.real_or(72, 0.0) != 0.0 || entity.real_or(73, 0.0) != 0.0;
            let at = entity.point(if anchored { 11 } else { 10 }).or_else(|_| entity.point(10));
            if let (Ok(at), Some(text)) = (at, entity.text(1)) {
                items.labels.push(Label { at: placement.at(at), text: plain(text) });
            }
        }
        _ if !wanted => {}
        kind if ANNOTATIONS.contains(&kind) => {}
        _ if tilted(entity) && !flat => items.refuse(entity, layer, "an entity that does not lie in the plan"),
        _ => match curves(entity)? {
            Ok((curves, directed)) => {
                let placed = curves.iter().map(|(curve, span)| Some((placement.curve(curve)?, *span)));
                match placed.collect::<Option<Vec<(Curve, Span)>>>() {
                    Some(curves) if curves.is_empty() => {}
                    Some(curves) => items.shapes.push(DrawnShape { layer: layer.to_string(), curves, directed }),
                    None => items.refuse(entity, layer, "an arc in a block that is stretched to an ellipse"),
                }
            }
            Err(what) => items.refuse(entity, layer, what),
        },
    }
    Ok(())
}

/// Curves with their lines of the file, and whether they have a direction.
type Directed = (Vec<(Curve, Span)>, bool);

/// An entity's curves in its own coordinates; or what it is instead.
fn curves(entity: &Raw) -> Read<Result<Directed, &'static str>> {
    let one = |curve: Option<Curve>| Vec::from_iter(curve.map(|curve| (curve, entity.span)));
    Ok(Ok(match entity.kind {
        "LINE" => {
            let line = Curve::Segment { begin: entity.point(10)?, end: entity.point(11)? };
            (one((line.length() > 0.0).then_some(line)), true)
        }
        "CIRCLE" | "ARC" => {
            let (centre, radius) = (entity.point(10)?, entity.real(40)?.abs());
            let angles = match entity.kind {
                "ARC" => (entity.real(50)? * trig::PI / 180.0, entity.real(51)? * trig::PI / 180.0),
                _ => (0.0, trig::TAU),
            };
            let sweep = (angles.1 - angles.0).rem_euclid(trig::TAU);
            // An arc that ends where it begins is a whole circle.
            let sweep = if sweep < 1e-9 { trig::TAU } else { sweep };
            (one((radius > 0.0).then(|| arc(centre, radius, angles.0, sweep))), entity.kind == "CIRCLE")
        }
        "LWPOLYLINE" => {
            let mut vertices: Vec<Vertex> = Vec::new();
            for tag in entity.tags {
                match (tag.code, vertices.last_mut()) {
                    (10, _) => {
                        vertices.push(Vertex { at: Point::new(tag.real()?, 0.0), bulge: 0.0, span: tag.span });
                    }
                    (20, Some(last)) => last.at.y = tag.real()?,
                    (42, Some(last)) => last.bulge = tag.real()?,
                    _ => {}
                }
            }
            (polyline(&vertices, entity.flags() & 1 != 0), true)
        }
        "POLYLINE" if entity.flags() & (16 | 64) != 0 => return Ok(Err("a mesh")),
        "POLYLINE" => {
            let mut vertices = Vec::new();
            // The frame of a spline is no part of its line.
            for vertex in entity.vertices.iter().filter(|vertex| vertex.flags() & 16 == 0) {
                vertices.push(Vertex { at: vertex.point(10)?, bulge: vertex.real_or(42, 0.0), span: vertex.span });
            }
            (polyline(&vertices, entity.flags() & 1 != 0), true)
        }
        "SPLINE" => return Ok(Err("a spline")),
        "ELLIPSE" => return Ok(Err("an ellipse")),
        _ => return Ok(Err("an entity that is neither line nor arc")),
    }))
}

/// A text without its control codes: `\U+00B0` is a degree sign, `%%%` a percent sign.
fn plain(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find("\\U+") {
        let (before, after) = rest.split_at(at);
        out.push_str(before);
        let code = after.get(3..7).and_then(|hex| u32::from_str_radix(hex, 16).ok()).and_then(char::from_u32);
        let Some(c) = code else {
            rest = after;
            break;
        };
        out.push(c);
        rest = after.get(7..).unwrap_or_default();
    }
    out.push_str(rest);
    out.replace("%%%", "%")
}

impl Items {
    pub fn refuse(&mut self, entity: &Raw, layer: &str, what: &str) {
        let (layer, what) = (layer.to_string(), what.to_string());
        self.unreadable.push(Unreadable { layer, what, span: entity.span });
    }

    pub fn scaled(&self, factor: f64) -> Items {
        let scale = Placement { x: Point::new(factor, 0.0), y: Point::new(0.0, factor), shift: Point::default() };
        let mut items = self.clone();
        for shape in &mut items.shapes {
            shape.curves = shape.curves.iter().filter_map(|(c, span)| Some((scale.curve(c)?, *span))).collect();
        }
        items.points.iter_mut().for_each(|mark| mark.at = mark.at * factor);
        items.labels.iter_mut().for_each(|label| label.at = label.at * factor);
        items
    }
}

impl DrawnShape {
    pub fn pieces(&self) -> Vec<Drawn> {
        self.curves.iter().map(|(curve, span)| Drawn { curve: *curve, span: *span, directed: self.directed }).collect()
    }
}

impl Unreadable {
    pub fn diagnostic(&self) -> Diagnostic {
        let message = format!("layer `{}` has {}", self.layer, self.what);
        Diagnostic::new(Code::E0806, message, self.span, "cannot be read")
            .expected("lines, arcs, circles and polylines in the plan", self.what.clone())
            .help("draw it with lines and arcs, or put it on a layer that is not read")
    }
}
