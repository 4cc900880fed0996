//! A loop as a layout that the solver takes.

use super::loops::Loop;
use super::round::Round;
use crate::geometry::{Corner, Point, Track, self_crossings};
use crate::model::{Constraint, ConstraintKind, Layout, Obstacle, Side, TrackSection, Vertex};
use crate::problem::measures::to_corners;
use crate::problem::{Problem, Scope};
use crate::semantics::settle_sides;
use crate::solve::Stop;
use crate::solve::sqp::{self, SqpSettings};
use crate::source::Spanned;

/// The layout with the vertices of a loop, its sections held on them, and obstacles on the sides where it passes them;
/// `None` where a `pass` asks for another side.
pub fn layout(asked: &Layout, round: &Round, made: &Loop) -> Option<Layout> {
    let route = asked.route.as_ref()?;
    let vertex = |(k, corner): (usize, &Corner)| Vertex {
        name: format!("P{}", k + 1),
        point: corner.point,
        point_span: route.span,
        radius: Spanned::new(corner.radius, route.span),
        span: route.span,
    };
    let mut layout =
        Layout { vertices: made.corners.iter().enumerate().map(vertex).collect(), route: None, ..asked.clone() };
    let holds = round.sections.iter().zip(&made.on).map(|(part, &section)| Constraint {
        kind: ConstraintKind::Holds { section, part: Box::new(part.clone()) },
        span: part.span,
        reason: None,
    });
    layout.constraints.extend(holds);
    let track = Track::new(&layout.corners());
    let mut sides: Vec<Obstacle> = layout.obstacles.iter().map(|o| Obstacle { pass: None, ..o.clone() }).collect();
    settle_sides(&track, self_crossings(&track).is_empty(), &mut sides);
    for (obstacle, settled) in layout.obstacles.iter_mut().zip(sides) {
        let asked = obstacle.pass.is_some() && obstacle.side != Side::Either;
        if asked && obstacle.side != settled.side {
            return None;
        }
        obstacle.side = settled.side;
    }
    Some(layout)
}

/// The loop of a layout's corners, with the round that it is one of.
pub fn back(layout: &Layout, corners: &[Corner]) -> (Round, Loop) {
    let held = layout.constraints.iter().filter_map(|c| match &c.kind {
        ConstraintKind::Holds { section, part } => Some(((**part).clone(), *section)),
        _ => None,
    });
    let (sections, on) = held.unzip();
    (Round { sections }, Loop { corners: corners.to_vec(), on })
}

/// Most steps towards a layout that meets every row.
const STEPS: usize = 120;

/// A layout that meets every row but the catalogue's grid, near a loop, with its length, m; `None` where none was come
/// by in so many steps.
pub fn settled(layout: &Layout, stop: Stop) -> Option<(f64, Layout)> {
    let problem = Problem::new(layout, Scope::Obstacles);
    let settings = SqpSettings { iterations: STEPS, stop, ..SqpSettings::default() };
    let found = sqp::minimise(&problem, &problem.start, &settings, &|_, _, _| ());
    if found.max_violation > settings.feasibility {
        return None;
    }
    let mut settled = layout.clone();
    for (vertex, corner) in settled.vertices.iter_mut().zip(to_corners(&found.variables)) {
        vertex.point = corner.point;
        vertex.radius.value = corner.radius;
    }
    onto_lines(&mut settled);
    Some((found.length, settled))
}

/// Puts the vertices of sections exactly on their lines, whose headings the catalogue's grid counts from.
fn onto_lines(layout: &mut Layout) {
    let n = layout.vertices.len();
    let mut lines: Vec<Vec<TrackSection>> = vec![Vec::new(); n];
    for constraint in &layout.constraints {
        let ConstraintKind::Holds { section, part } = &constraint.kind else { continue };
        for vertex in [*section, (section + 1) % n] {
            // Parts of one straight hold one line.
            if lines[vertex].iter().all(|l| l.direction().cross(part.direction()).abs() > 1e-9) {
                lines[vertex].push((**part).clone());
            }
        }
    }
    for (vertex, lines) in layout.vertices.iter_mut().zip(lines) {
        let onto = |line: &TrackSection, p: Point| line.from + line.direction() * line.direction().dot(p - line.from);
        match &lines[..] {
            [] => {}
            [a] => vertex.point = onto(a, vertex.point),
            [a, b, ..] => {
                let (u, v) = (a.direction(), b.direction());
                vertex.point = a.from + u * ((b.from - a.from).cross(v) / u.cross(v));
            }
        }
    }
}
