//! What a layout could do instead whose vertex is too near to another, or to an obstacle.
//!
//! A vertex P at a distance of at least d from a convex region, with c its nearest point there, has c·w at its greatest
//! in the direction w = (P − c)/|P − c|. Where w lies within an angle δ of a direction m,
//! m·P = m·c + |P − c| m·w >= min m·c + d cos δ over all c that are farthest in some direction of that sector. So each
//! sector has a row, and the sectors are halved as they are needed. Two vertices are the same without a region.

use super::alternative::{About, Alternative, Decided, What};
use super::grid::Grid;
use super::row::GridRow;
use crate::base::trig;
use crate::geometry::{Point, Polygon, Track};
use crate::model::Formula;
use crate::problem::{Function, Problem, nearest};

/// Sectors of the circle at first.
const SECTORS: usize = 8;
/// A sector is halved no further, rad: the cosine of that is 1 in all its digits.
const LEAST: f64 = 1e-8;
/// Corners as far in a direction as this are alike, m.
const ALIKE: f64 = 1e-9;

/// The vertex that has to stay away, and from what.
enum From<'a> {
    Vertex(usize),
    Region(&'a Polygon),
}

/// Alternatives to a listed row that asks for a distance; `None` for any other row.
pub fn apart(
    problem: &Problem,
    grid: &Grid,
    listed: usize,
    track: &Track,
    decided: &[Decided],
) -> Option<Vec<Alternative>> {
    let row = problem.rows.get(listed).filter(|row| row.weight.is_none() && row.low.is_finite() && row.low > 0.0)?;
    let (vertex, from) = match &row.function {
        Function::Formula(Formula::DistanceVertices(a, b)) => (*b, From::Vertex(*a)),
        Function::Formula(Formula::DistanceObstacle(v, k)) => {
            (*v, From::Region(problem.places.obstacles.get(*k).filter(|p| is_convex(p))?))
        }
        _ => return None,
    };
    let at = |vertex: usize| track.corners[vertex].point;
    let away = match &from {
        From::Vertex(other) => at(vertex) - at(*other),
        From::Region(polygon) => at(vertex) - nearest(polygon, at(vertex))?.foot,
    };
    let sector = |begin: f64, end: f64| -> Option<Alternative> {
        let m = Point::unit((begin + end) / 2.0);
        let low = row.low * trig::cos((end - begin) / 2.0);
        let pull = vec![(grid.stage(vertex), m)];
        let stated = match &from {
            From::Vertex(other) => {
                let at = pull.into_iter().chain([(grid.stage(*other), -m)]).collect();
                GridRow { at, low, ..GridRow::default() }
            }
            From::Region(polygon) => {
                let nearest = farthest(polygon, begin, end).map(|c| m.dot(c)).fold(f64::INFINITY, f64::min);
                GridRow { at: pull, low: low + nearest, ..GridRow::default() }
            }
        };
        let decided = Some(Decided { about: About::Row(listed), what: What::Away(begin, end) });
        Some(Alternative { decided, ..Alternative::row(stated) })
    };
    let known = decided.iter().find_map(|d| match (d.about, d.what) {
        (About::Row(row), What::Away(begin, end)) if row == listed => Some((begin, end)),
        _ => None,
    });
    let middle = if away.norm() > ALIKE { away.heading() } else { 0.0 };
    match known {
        Some((begin, end)) => {
            if end - begin < LEAST {
                return None;
            }
            let centre = (begin + end) / 2.0;
            let here = centre + trig::wrap(middle - centre);
            let inner = 0.1 * (end - begin);
            let cut = if here > begin + inner && here < end - inner { here } else { centre };
            [sector(begin, cut), sector(cut, end)].into_iter().collect()
        }
        None => {
            let wide = trig::TAU / SECTORS as f64;
            (0..SECTORS)
                .map(|k| (middle + (k as f64 - 0.5) * wide, middle + (k as f64 + 0.5) * wide))
                .map(|(a, b)| sector(a, b))
                .collect()
        }
    }
}

/// Corners that are farthest in some direction of a sector.
fn farthest(polygon: &Polygon, begin: f64, end: f64) -> impl Iterator<Item = Point> {
    let points = polygon.points();
    let centre = (begin + end) / 2.0;
    // Between the ends of a sector the farthest corner changes at the outward normals of edges.
    let outward = polygon.edges().map(|(a, b)| (b - a).left().heading() + trig::PI);
    let inside =
        outward.map(|angle| centre + trig::wrap(angle - centre)).filter(move |angle| (begin..=end).contains(angle));
    let directions: Vec<Point> = [begin, end].into_iter().chain(inside).map(Point::unit).collect();
    let all: Vec<Point> = directions
        .iter()
        .flat_map(|w| {
            let most = points.iter().map(|c| w.dot(*c)).fold(f64::NEG_INFINITY, f64::max);
            points.iter().filter(move |c| w.dot(**c) >= most - ALIKE).copied()
        })
        .collect();
    all.into_iter()
}

/// Of an outline that runs counter-clockwise.
fn is_convex(polygon: &Polygon) -> bool {
    let points = polygon.points();
    let n = points.len();
    (0..n).all(|i| {
        let (a, b, c) = (points[i], points[(i + 1) % n], points[(i + 2) % n]);
        (b - a).cross(c - b) >= -ALIKE
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::uniform;
    use crate::geometry::Corner;
    use crate::model::{Constraint, ConstraintKind, Obstacle, Side, Unit, fixture};
    use crate::problem::Scope;

    const DISTANCE: f64 = 3.0;

    /// A rectangle whose first vertex keeps a distance from something.
    fn problem(formula: Formula) -> (Problem, Grid) {
        let mut layout = fixture::rectangle(30.0, 20.0, 4.0);
        let points = [(12.0, 8.0), (15.0, 7.0), (17.0, 9.5), (13.0, 12.0)].map(|(x, y)| Point::new(x, y));
        layout.obstacles.push(Obstacle {
            name: "column".to_owned(),
            polygon: Polygon::new(points.to_vec()).expect("an outline"),
            clearance: 0.0,
            side: Side::Left,
            pass: None,
            span: fixture::span(),
        });
        let kind = ConstraintKind::Require { formula, low: DISTANCE, high: f64::INFINITY, unit: Unit::Metre };
        layout.constraints.push(Constraint { kind, span: fixture::span(), reason: None });
        let problem = Problem::new(&layout, Scope::Obstacles);
        let grid = Grid::new(&layout, &problem, &problem.start, 0.0).expect("a grid");
        (problem, grid)
    }

    fn track(at: Point) -> Track {
        let mut corners: Vec<Corner> = fixture::rectangle(30.0, 20.0, 4.0).corners();
        corners[0].point = at;
        Track::new(&corners)
    }

    /// Whatever layout they are made for, each that keeps its distance meets one of the alternatives, and the one that
    /// they are made for meets none of the last.
    #[test]
    fn every_layout_that_keeps_its_distance_meets_one() {
        for formula in [Formula::DistanceObstacle(0, 0), Formula::DistanceVertices(2, 0)] {
            let (problem, grid) = problem(formula.clone());
            let listed = problem.rows.iter().position(|row| row.function == Function::Formula(formula.clone()));
            let listed = listed.expect("the row");
            let mut state = 11;
            let mut place = |wide: f64| Point::new(wide * uniform(&mut state), wide * uniform(&mut state));
            let apart_by = |track: &Track| match &formula {
                Formula::DistanceVertices(..) => track.corners[0].point.distance(track.corners[2].point),
                _ => {
                    let (polygon, p) = (&problem.places.obstacles[0], track.corners[0].point);
                    let near = nearest(polygon, p).expect("an outline");
                    near.sign * p.distance(near.foot)
                }
            };
            let about = if matches!(formula, Formula::DistanceVertices(..)) { 25.0 } else { 5.0 };
            let mut refined = 0;
            for _ in 0..400 {
                let shift = Point::new(about, about * 0.6);
                let (near, far) = (track(place(14.0) + shift), track(place(14.0) + shift));
                if apart_by(&far) < DISTANCE {
                    continue;
                }
                let holds = |alternative: &Alternative| {
                    let value = |row: &GridRow| -> f64 {
                        row.at.iter().map(|(k, g)| g.dot(far.corners[grid.vertex(*k)].point)).sum()
                    };
                    alternative.rows.iter().all(|row| value(row) >= row.low - 1e-9)
                };
                let from = match &formula {
                    Formula::DistanceVertices(..) => far.corners[2].point,
                    _ => nearest(&problem.places.obstacles[0], far.corners[0].point).expect("an outline").foot,
                };
                let direction = (far.corners[0].point - from).heading();
                let has = |alternative: &Alternative| match alternative.decided.map(|d| d.what) {
                    Some(What::Away(begin, end)) => {
                        let centre = (begin + end) / 2.0;
                        trig::wrap(direction - centre).abs() <= (end - begin) / 2.0 + 1e-12
                    }
                    _ => false,
                };
                let mut decided: Vec<Decided> = Vec::new();
                for _ in 0..30 {
                    let Some(all) = apart(&problem, &grid, listed, &near, &decided) else { break };
                    let met = all.into_iter().find(has).expect("the sector that it is in");
                    assert!(holds(&met), "{formula:?} {met:?}");
                    decided = met.decided.into_iter().collect();
                    refined += 1;
                }
            }
            assert!(refined > 5_000, "{refined}");
        }
    }

    /// Along the direction that is chosen in the end, the row asks for all of the distance.
    #[test]
    fn narrow_sectors_ask_for_the_whole_distance() {
        let (problem, grid) = problem(Formula::DistanceVertices(2, 0));
        let listed = problem.rows.iter().position(|row| matches!(row.function, Function::Formula(_))).expect("the row");
        let near = track(Point::new(29.0, 19.5));
        let mut decided: Vec<Decided> = Vec::new();
        let mut low = 0.0;
        while let Some(all) = apart(&problem, &grid, listed, &near, &decided) {
            let first = all.into_iter().next().expect("a sector");
            low = first.rows[0].low;
            decided = first.decided.into_iter().collect();
        }
        assert!((low - DISTANCE).abs() < 1e-12, "{low}");
    }
}
