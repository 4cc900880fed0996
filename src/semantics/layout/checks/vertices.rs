//! Vertices: coincident neighbours, turns, radii, and fillets that overlap.

use super::{Facts, Limits};
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{PieceKind, Track};
use crate::model::{TOLERANCE, Vertex};
use crate::semantics::scope::Context;
use crate::semantics::value::{degrees, metres};

/// Vertices closer than this coincide, m.
const COINCIDENT: f64 = 1e-6;
/// Turns below this have no direction, and turns this close to a half turn throw their tangent points to infinity, rad.
const LEAST_TURN: f64 = 0.05 * trig::PI / 180.0;
const LARGEST_TURN: f64 = 175.0 * trig::PI / 180.0;

impl Context<'_> {
    /// Whether neighbouring vertices differ.
    pub(super) fn check_neighbours(&self, vertices: &[Vertex]) -> bool {
        let mut sound = true;
        for (i, vertex) in vertices.iter().enumerate() {
            let next = &vertices[(i + 1) % vertices.len()];
            if vertex.point.distance(next.point) < COINCIDENT {
                let message = format!("`{}` and `{}` are the same point", vertex.name, next.name);
                let mut diagnostic = Diagnostic::new(Code::E0402, message, next.point_span, "the same point again")
                    .related(vertex.point_span, "the vertex before")
                    .expected(
                        "neighbours that differ",
                        format!("({}, {}) twice", metres(next.point.x), metres(next.point.y)),
                    );
                if i + 1 == vertices.len() {
                    diagnostic = diagnostic
                        .help("the loop closes by itself: the first vertex is not repeated at the end")
                        .fix(vertex.span, "");
                }
                self.report(diagnostic);
                sound = false;
            }
        }
        sound
    }

    /// Whether every vertex turns by an angle that a fillet can round.
    pub(super) fn check_turns(&self, vertices: &[Vertex], track: &Track) -> bool {
        let mut sound = true;
        for (vertex, fillet) in vertices.iter().zip(&track.fillets) {
            let turn = fillet.turn.abs();
            let found = degrees(turn);
            if !(LEAST_TURN..=LARGEST_TURN).contains(&turn) {
                let (message, help) = if turn < 1.0 {
                    (
                        format!("the track does not turn at `{}`", vertex.name),
                        "remove the vertex, or move it off the line",
                    )
                } else {
                    (format!("the track turns back at `{}`", vertex.name), "split the turn over two vertices")
                };
                let label = format!("turns by {found}");
                let diagnostic = Diagnostic::new(Code::E0408, message, vertex.point_span, label)
                    .expected(format!("a turn of {} .. {}", degrees(LEAST_TURN), degrees(LARGEST_TURN)), found)
                    .help(help);
                // Without one of three vertices there is no loop.
                let removable = turn < 1.0 && vertices.len() > 3;
                self.report(if removable { diagnostic.fix(vertex.span, "") } else { diagnostic });
                sound = false;
            }
        }
        sound
    }

    /// Warns of turns and radii outside their limits. What the catalogue lacks inside them is the build's to say
    /// (`elements::lacking`), once it is known which pieces the track needs.
    pub(super) fn check_limits(&self, vertices: &[Vertex], track: &Track, limits: Limits, facts: &Facts) {
        for (vertex, fillet) in vertices.iter().zip(&track.fillets) {
            let (turn, range) = (fillet.turn.abs(), limits.turns.value);
            let found = degrees(turn);
            if turn < range.low - TOLERANCE || turn > range.high + TOLERANCE {
                let message = format!("the turn at `{}` is outside its limits", vertex.name);
                self.report(
                    Diagnostic::new(Code::W0702, message, vertex.point_span, format!("turns by {found}"))
                        .related(limits.turns.span, facts.source_of(limits.turns.span))
                        .expected(format!("{} .. {}", degrees(range.low), degrees(range.high)), found)
                        .help(fix_for(facts)),
                );
            }
        }
        self.check_radii(vertices, limits, facts);
    }

    fn check_radii(&self, vertices: &[Vertex], limits: Limits, facts: &Facts) {
        let range = limits.radii.value;
        for vertex in vertices {
            let (radius, found) = (vertex.radius.value, metres(vertex.radius.value));
            // Compiled as written, a radius that the catalogue lacks is said when building.
            let listed = facts.catalog.is_none_or(|c| c.curve.radii.iter().any(|r| (r - radius).abs() < TOLERANCE));
            if facts.as_written() && !listed {
                continue;
            }
            if radius < range.low - TOLERANCE || radius > range.high + TOLERANCE {
                let message = format!("the radius at `{}` is outside its limits", vertex.name);
                self.report(
                    Diagnostic::new(Code::W0703, message, vertex.radius.span, found.clone())
                        .related(limits.radii.span, facts.source_of(limits.radii.span))
                        .expected(format!("{} .. {}", metres(range.low), metres(range.high)), found)
                        .help(fix_for(facts)),
                );
            }
        }
    }

    /// Whether the fillets leave room for each other on every section.
    pub(super) fn check_fillets(&self, vertices: &[Vertex], track: &Track) -> bool {
        let n = vertices.len();
        let mut sound = true;
        for piece in track.pieces.iter().filter(|p| p.kind == PieceKind::Straight && p.length < -TOLERANCE) {
            sound = false;
            let (i, j) = (piece.vertex, (piece.vertex + 1) % n);
            // The larger fillet is the one to change; when it is too large for both its sections, it is said once.
            let (large, small) = if track.fillets[i].tangent > track.fillets[j].tangent { (i, j) } else { (j, i) };
            let room = [(large + n - 1) % n, large].map(|section| {
                let other = if section == large { (large + 1) % n } else { section };
                let length = vertices[section].point.distance(vertices[(section + 1) % n].point);
                length - track.fillets[other].tangent
            });
            let largest = room[0].min(room[1]) / trig::tan(track.fillets[large].turn.abs() / 2.0);
            let section = piece.length + track.fillets[i].tangent + track.fillets[j].tangent;
            let overlap = -piece.length;
            let (a, b) = (&vertices[large], &vertices[small]);
            let fitting = (largest > 0.01).then(|| metres((largest * 1000.0).floor() / 1000.0));
            let help = if let Some(radius) = &fitting {
                format!("the largest radius that fits at `{}` is `{radius}`", a.name)
            } else {
                let factor = section / (section + overlap);
                let both = |v: &Vertex| metres((v.radius.value * factor * 1000.0).floor() / 1000.0);
                format!("radii up to {} at `{}` and {} at `{}` fit together", both(a), a.name, both(b), b.name)
            };
            let message = format!("the fillets of `{}` and `{}` overlap", vertices[i].name, vertices[j].name);
            let tangents = metres(section + overlap);
            let label = format!("too large by {}", metres(overlap));
            let diagnostic = Diagnostic::new(Code::E0404, message, a.radius.span, label)
                .related(b.span, "its neighbour")
                .expected(
                    format!("tangents that fit into the {} between the vertices", metres(section)),
                    format!("tangents of {tangents}"),
                )
                .help(help);
            self.report(match fitting.filter(|_| a.has_radius()) {
                Some(radius) => diagnostic.fix(a.radius.span, radius),
                None => diagnostic,
            });
        }
        sound
    }
}

fn fix_for(facts: &Facts) -> &'static str {
    match facts.as_written() {
        true => "the layout is compiled as written, outside its limits",
        false => "the optimiser starts from here and must bring it within the limits",
    }
}
