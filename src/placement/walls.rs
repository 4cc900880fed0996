//! What walls ask of a section for what has to stand beside it: on the side of its equipment there is room up to a wall
//! that has all of the building before it.

use super::footprint::TOUCH;
use super::needs::sides;
use crate::geometry::clearance::Region;
use crate::geometry::{Point, Track};
use crate::model::{Declared, Layout, Stands};

/// `pull`·V >= low, of a vertex V, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    pub vertex: usize,
    pub pull: Point,
    pub low: f64,
    /// Index among what the layout declares.
    pub declared: usize,
}

/// Of all equipment that may stand on one section only, where `is_held` says that its heading is the written one. What stands
/// beside the section reaches as far to its side everywhere, so that of the section's line the vertex that is farther from
/// the wall is far enough; beside a parallel wall nothing else can be asked.
pub fn walls(layout: &Layout, written: &Track, is_held: &dyn Fn(usize) -> bool) -> Vec<Wall> {
    let Some(building) = &layout.building else { return Vec::new() };
    let region = Region { polygon: building.polygon.clone(), outside: true, lies: 1.0 };
    let edges = 0..building.polygon.points().len();
    let edges: Vec<(Point, Point)> =
        edges.filter(|i| region.encloses(*i)).map(|i| (region.edge(i).begin, region.edge(i).normal)).collect();
    let half = layout.width.value / 2.0;
    let of = |(index, own): (usize, &Declared)| -> Vec<Wall> {
        let section = match &own.stands {
            Stands::Free { on, .. } if matches!(on[..], [_]) && is_held(on[0]) => on[0],
            _ => return Vec::new(),
        };
        let heading = Point::unit(written.straight(section).heading);
        let far = half + own.of.depth + own.of.aisle;
        let (left, right) = sides(&own.of, written);
        let sides = [(left, 1.0), (right, -1.0)].into_iter().filter(|(stands, _)| *stands > 0.0);
        let row = |side: f64, (begin, normal): (Point, Point)| {
            let vertex = if normal.dot(heading) >= 0.0 { layout.next(section) } else { section };
            let low = normal.dot(begin) - normal.dot(heading.left()) * side * far - 2.0 * TOUCH;
            Wall { vertex, pull: normal, low, declared: index }
        };
        sides.flat_map(|(_, side)| edges.iter().map(move |edge| row(side, *edge))).collect()
    };
    layout.equipment.declared.iter().enumerate().flat_map(of).collect()
}
