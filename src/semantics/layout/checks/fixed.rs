//! Sections that are fixed where an obstacle or a wall leaves them no room: nothing that may be moved can help there.

use super::Facts;
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Piece, PieceKind, Point, Polygon, piece_distance};
use crate::model::{Constraint, ConstraintKind, TOLERANCE, Vertex};
use crate::semantics::layout::Geometry;
use crate::semantics::scope::Context;
use crate::semantics::value::metres;
use crate::source::Span;

/// Something that the band keeps off.
struct Region<'a> {
    what: String,
    polygon: &'a Polygon,
    clearance: f64,
    /// Whether the band stays inside of it.
    inside: bool,
    span: Span,
}

impl Context<'_> {
    /// Compares the part of each fixed section that is straight whatever its curves become with obstacles and walls;
    /// `width` is the band's, m.
    pub fn check_fixed(
        &self,
        constraints: &[Constraint],
        vertices: &[Vertex],
        geometry: &Geometry,
        facts: &Facts,
        width: f64,
    ) {
        let regions = regions(geometry);
        let held = held(constraints, vertices.len());
        for (i, span) in held.iter().enumerate() {
            let next = (i + 1) % vertices.len();
            let (Some(first), Some(second)) = (span, &held[next]) else { continue };
            let span = if facts.as_written() { None } else { Some((*first).max(*second)) };
            let (Some(span), Some(part)) = (span, straight_part(i, constraints, vertices, geometry, facts, &held))
            else {
                continue;
            };
            let name = format!("{}..{}", vertices[i].name, vertices[next].name);
            for region in &regions {
                self.check_room(&name, span, &part, region, width);
            }
        }
    }

    fn check_room(&self, name: &str, span: Span, part: &Piece, region: &Region, width: f64) {
        let needed = width / 2.0 + region.clearance;
        let walls = region.polygon.edges().map(|(a, b)| line(a, b));
        let nearest = walls.map(|wall| piece_distance(&wall, part)).fold(f64::INFINITY, f64::min);
        let wrong = region.polygon.contains(part.begin) != region.inside;
        if !wrong && nearest >= needed - TOLERANCE {
            return;
        }
        let (message, found) = match (region.inside, wrong || nearest < TOLERANCE) {
            (false, true) => {
                (format!("`{name}` is fixed and runs through {}", region.what), "it runs through".to_owned())
            }
            (true, true) => (format!("`{name}` is fixed and leaves {}", region.what), "it leaves".to_owned()),
            (_, false) => (
                format!("`{name}` is fixed too near to {}", region.what),
                format!("{} from the centre line", metres((nearest * 1e6).round() / 1e6)),
            ),
        };
        let band = "half the band's width and the clearance";
        self.report(
            Diagnostic::new(Code::E0502, message, span, "held where it is written")
                .related(region.span, "in its way")
                .expected(format!("{} at least, {band}", metres(needed)), found)
                .help("no layout can meet both: move the vertices or the obstacle, or fix less"),
        );
    }
}

fn regions<'a>(geometry: &'a Geometry) -> Vec<Region<'a>> {
    let obstacle = |o: &'a crate::model::Obstacle| Region {
        what: format!("obstacle `{}`", o.name),
        polygon: &o.polygon,
        clearance: o.clearance,
        inside: false,
        span: o.span,
    };
    let building = |b: &'a crate::model::Building| Region {
        what: "the building".to_owned(),
        polygon: &b.polygon,
        clearance: b.clearance,
        inside: true,
        span: b.span,
    };
    geometry.obstacles.iter().map(obstacle).chain(geometry.building.iter().map(building)).collect()
}

/// The statement that holds each vertex in its place.
pub(super) fn held(constraints: &[Constraint], n: usize) -> Vec<Option<Span>> {
    let mut held = vec![None; n];
    for constraint in constraints {
        let vertices = match &constraint.kind {
            ConstraintKind::FixVertex { vertex } => vec![*vertex],
            ConstraintKind::FixSection { target, kinds } if kinds.len() == 4 && !target.straight => {
                vec![target.from, (target.from + 1) % n]
            }
            _ => Vec::new(),
        };
        for vertex in vertices {
            held[vertex].get_or_insert(constraint.span);
        }
    }
    held
}

/// What of a section lies beyond the longest tangents that its curves may take. `None` where they may take it all.
fn straight_part(
    section: usize,
    constraints: &[Constraint],
    vertices: &[Vertex],
    geometry: &Geometry,
    facts: &Facts,
    held: &[Option<Span>],
) -> Option<Piece> {
    let n = vertices.len();
    let (limits, track) = (facts.limits?, geometry.track.as_ref()?);
    let tangent = |i: usize| {
        let around = [(i + n - 1) % n, i, (i + 1) % n];
        let known = around.iter().all(|&k| held[k].is_some());
        let turn = if known { track.fillets[i].turn.abs() } else { limits.turns.value.high };
        let fixed = |c: &Constraint| matches!(c.kind, ConstraintKind::FixRadius { vertex } if vertex == i);
        let radius = if constraints.iter().any(fixed) { vertices[i].radius.value } else { limits.radii.value.high };
        if turn < 3.1 { radius * trig::tan(turn / 2.0) } else { f64::INFINITY }
    };
    let next = (section + 1) % n;
    let (a, b) = (vertices[section].point, vertices[next].point);
    let length = a.distance(b);
    let (from, to) = (tangent(section), length - tangent(next));
    (from < to).then(|| line(a.lerp(b, from / length), a.lerp(b, to / length)))
}

fn line(begin: Point, end: Point) -> Piece {
    let (heading, length) = ((end - begin).heading(), begin.distance(end));
    Piece { kind: PieceKind::Straight, vertex: 0, begin, end, heading, s: 0.0, length }
}
