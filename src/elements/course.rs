//! The centre line as a course of straights and turns on the catalogue's grid, closed again.
//!
//! A solver leaves turns, radii and lengths within its tolerance of the grid. Here turns become exact multiples of the
//! angle step and radii the catalogue's own, and the straights take up what that opens: with headings fixed, closure
//! is linear in their lengths.

use super::{Cover, Shape, Steps, cover};
use crate::base::trig;
use crate::geometry::{PieceKind, Point, Track};
use crate::model::{Catalog, Layout, StraightStock, TOLERANCE};

/// A solver's tolerance: this near to the grid is on it (m, rad), and a straight shorter than this is none.
pub const SNAP: f64 = TOLERANCE;
/// A course that closes this well is closed, m. Well below 1e-9, which walking it by pieces must still meet.
const CLOSED: f64 = 1e-11;

/// A whole straight or a whole turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CourseRun {
    /// Straights are not cut yet: `cut` is false.
    pub shape: Shape,
    pub vertex: usize,
    /// Number of angle steps of a turn on the grid.
    pub steps: Option<usize>,
    /// Whether a turn's radius is one of the catalogue's.
    pub listed: bool,
}

/// Straights and turns in driving order, from vertex 0's outgoing tangent point.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    pub begin: Point,
    pub heading: f64,
    pub runs: Vec<CourseRun>,
}

impl Course {
    /// Snaps the track to the layout's catalogue and closes it. Fillets that overlap (a straight of negative length,
    /// as only a failed solve has) are left as they are, without a straight between them, and the course stays open.
    pub fn new(track: &Track, layout: &Layout) -> Self {
        let catalog = &layout.catalog;
        let mut runs: Vec<CourseRun> = Vec::with_capacity(track.pieces.len());
        let mut overlap = false;
        for piece in &track.pieces {
            runs.push(match piece.kind {
                PieceKind::Straight => {
                    overlap |= piece.length < -SNAP;
                    let length = if piece.length < SNAP { 0.0 } else { piece.length };
                    let shape = Shape::Straight { length, cut: false };
                    CourseRun { shape, vertex: piece.vertex, steps: None, listed: true }
                }
                PieceKind::Arc { radius, turn, .. } => snap_turn(radius, turn, piece.vertex, catalog),
            });
        }
        spread_heading(&mut runs);
        let (begin, heading) = track.pieces.first().map_or_else(Default::default, |p| (p.begin, p.heading));
        let mut course = Course { begin, heading, runs };
        if !overlap {
            course.close(&catalog.straight, Cover::of(layout));
        }
        course
    }

    /// From the end of the walk back to its beginning, m.
    fn gap(&self) -> Point {
        let (mut position, mut heading) = (Point::default(), self.heading);
        for run in &self.runs {
            (position, heading) = run.shape.advance(position, heading);
        }
        -position
    }

    /// Closes the course by the least-norm change of the straights' lengths, none below 0. Straights that stock lengths
    /// (or, where cost counts, fewer pieces) make up keep that length unless the course cannot close without them.
    fn close(&mut self, stock: &StraightStock, wanted: Cover) {
        let written = self.runs.clone();
        let mut held: Vec<bool> = Vec::with_capacity(self.runs.len());
        let straight = |run: &CourseRun| if let Shape::Straight { length, .. } = run.shape { length } else { 0.0 };
        let longest = self.runs.iter().map(straight).fold(0.0, f64::max);
        // A straight may be a hair shorter than the shortest cut or, where cost counts, longer than what fewer pieces
        // make.
        let unmade = |run: &CourseRun| straight(run) > 0.0 && cover::straight(straight(run), stock, wanted).is_none();
        let stepped = wanted == Cover::Cheapest || self.runs.iter().any(unmade);
        let steps = stepped.then(|| Steps::new(stock, longest + 2.0 * SNAP)).flatten();
        for run in &mut self.runs {
            let steps = steps.as_ref().filter(|_| wanted == Cover::Cheapest || unmade(run));
            let nearest = match run.shape {
                Shape::Straight { length, .. } if length > 0.0 => {
                    cover::nearest_stock(length, SNAP, stock, wanted).or_else(|| steps?.nearest_cheaper(length, SNAP))
                }
                _ => None,
            };
            if let Some(length) = nearest {
                run.shape = Shape::Straight { length, cut: false };
            }
            held.push(nearest.is_some());
        }
        if held.contains(&true) && self.settle(held) {
            return;
        }
        self.runs = written;
        self.settle(vec![false; self.runs.len()]);
    }

    /// Changes the straights that are not held; whether the course is closed then.
    fn settle(&mut self, mut held: Vec<bool>) -> bool {
        let mut headings = Vec::with_capacity(self.runs.len());
        let mut heading = self.heading;
        for run in &self.runs {
            headings.push(Point::unit(heading));
            (_, heading) = run.shape.advance(Point::default(), heading);
        }
        for (held, run) in held.iter_mut().zip(&self.runs) {
            *held |= !matches!(run.shape, Shape::Straight { length, .. } if length > 0.0);
        }
        // Each round either ends or holds one more straight at 0.
        for _ in 0..=self.runs.len() {
            let free = |i: &usize| !held[*i];
            let pull = least_norm((0..held.len()).filter(free).map(|i| headings[i]), self.gap());
            let mut bounded = false;
            let change: Vec<f64> = headings.iter().map(|u| u.dot(pull)).collect();
            let shortened = |run: &CourseRun, change: f64| run.shape.length() + change;
            for i in 0..held.len() {
                if !held[i] && shortened(&self.runs[i], change[i]) < 0.0 {
                    self.runs[i].shape = Shape::Straight { length: 0.0, cut: false };
                    held[i] = true;
                    bounded = true;
                }
            }
            if bounded {
                continue;
            }
            for i in (0..held.len()).filter(|&i| !held[i]) {
                let length = shortened(&self.runs[i], change[i]);
                self.runs[i].shape = Shape::Straight { length, cut: false };
            }
            break;
        }
        self.gap().norm() <= CLOSED
    }
}

/// λ of the least-norm solution dᵢ = uᵢ·λ of Σ dᵢ uᵢ = gap: (Σ uᵢ uᵢᵀ) λ = gap. When all uᵢ are parallel, the
/// pseudo-inverse closes what can be closed.
fn least_norm(units: impl Iterator<Item = Point>, gap: Point) -> Point {
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for u in units {
        xx += u.x * u.x;
        xy += u.x * u.y;
        yy += u.y * u.y;
    }
    let (trace, determinant) = (xx + yy, xx * yy - xy * xy);
    if trace == 0.0 {
        Point::default()
    } else if determinant > 1e-12 * trace * trace {
        Point::new(yy * gap.x - xy * gap.y, xx * gap.y - xy * gap.x) * (1.0 / determinant)
    } else {
        // Of rank one, M = trace · vvᵀ, and its pseudo-inverse is M / trace².
        Point::new(xx * gap.x + xy * gap.y, xy * gap.x + yy * gap.y) * (1.0 / (trace * trace))
    }
}

/// The turn at a vertex, on the grid where it is near it.
fn snap_turn(radius: f64, turn: f64, vertex: usize, catalog: &Catalog) -> CourseRun {
    let curve = &catalog.curve;
    let listed = curve.radii.iter().copied().find(|r| (r - radius).abs() <= SNAP);
    let steps = (turn.abs() / curve.angle_step).round();
    let snapped = steps * curve.angle_step;
    let steps = ((snapped - turn.abs()).abs() <= SNAP).then_some(steps as usize);
    let turn = if steps.is_some() { snapped * turn.signum() } else { turn };
    CourseRun {
        shape: Shape::Curve { radius: listed.unwrap_or(radius), turn },
        vertex,
        steps,
        listed: listed.is_some() || steps == Some(0),
    }
}

/// Lets the turns off the grid take up what snapping the others did to the heading, in equal parts.
fn spread_heading(runs: &mut [CourseRun]) {
    let turn = |run: &CourseRun| if let Shape::Curve { turn, .. } = run.shape { turn } else { 0.0 };
    let excess = trig::wrap(runs.iter().map(turn).sum());
    let off = |run: &CourseRun| matches!(run.shape, Shape::Curve { .. }) && run.steps.is_none();
    let count = runs.iter().filter(|r| off(r)).count();
    for run in runs.iter_mut().filter(|r| off(r)) {
        if let Shape::Curve { turn, .. } = &mut run.shape {
            *turn -= excess / count as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::fixture;

    fn lengths(course: &Course) -> Vec<f64> {
        course.runs.iter().step_by(2).map(|r| r.shape.length()).collect()
    }

    fn course(layout: &Layout) -> Course {
        Course::new(&Track::new(&layout.corners()), layout)
    }

    #[test]
    fn a_rough_rectangle_is_put_on_the_grid_and_closed() {
        // A solver's leftovers, and straights (12.3, 2.7) that no stock lengths make.
        let mut layout = fixture::rectangle(20.3, 10.7, 4.0);
        layout.vertices[1].point.x += 3e-7;
        layout.vertices[2].point.y -= 4e-7;
        layout.vertices[3].radius.value += 2e-7;
        let course = course(&layout);
        assert!(course.gap().norm() < 1e-12);
        for (length, expected) in lengths(&course).iter().zip([12.3, 2.7, 12.3, 2.7]) {
            assert!((length - expected).abs() < 2e-6, "{length}");
        }
        assert!(course.runs.iter().skip(1).step_by(2).all(|r| {
            r.steps == Some(36) && r.listed && matches!(r.shape, Shape::Curve { radius, .. } if radius == 4.0)
        }));
    }

    #[test]
    fn straights_near_a_stock_length_are_that_length() {
        let mut layout = fixture::rectangle(20.0, 10.0, 4.0);
        layout.vertices[1].point.x += 3e-7;
        layout.vertices[2].point.x += 3e-7;
        assert_eq!(lengths(&course(&layout)), [12.0, 2.0, 12.0, 2.0]);
    }

    /// A solver leaves a straight at the shortest cut, short of it by its tolerance.
    #[test]
    fn straights_near_the_shortest_cut_can_be_cut() {
        let mut layout = fixture::rectangle(20.0, 8.2, 4.0);
        layout.catalog.straight.cut = Some(crate::model::Interval { low: 0.2, high: 3.0 });
        for vertex in &mut layout.vertices[2..] {
            vertex.point.y -= 4e-7;
        }
        let lengths = lengths(&course(&layout));
        assert_eq!((lengths[1], lengths[3]), (0.2, 0.2));
    }

    #[test]
    fn straights_that_vanish_leave_no_run_behind() {
        // Straights of 6 m along x only: the correction across has nothing to act on.
        let course = course(&fixture::rectangle(14.0, 8.0, 4.0));
        let lengths = lengths(&course);
        assert!((lengths[0] - 6.0).abs() < 1e-12 && (lengths[2] - 6.0).abs() < 1e-12);
        assert_eq!((lengths[1], lengths[3]), (0.0, 0.0));
        assert!(course.gap().norm() < 1e-12);
    }

    #[test]
    fn overlapping_fillets_stay_open() {
        let course = course(&fixture::rectangle(20.0, 7.0, 4.0));
        assert_eq!(lengths(&course)[1], 0.0);
        assert!((lengths(&course)[0] - 12.0).abs() < 1e-12);
    }

    #[test]
    fn turns_off_the_grid_take_up_the_heading() {
        let layout =
            fixture::loop_through("odd", &[(0.0, 0.0, 4.0), (30.0, 0.0, 4.1), (31.0, 17.0, 5.0), (0.0, 20.0, 4.0)]);
        let course = course(&layout);
        let sum: f64 =
            course.runs.iter().map(|r| if let Shape::Curve { turn, .. } = r.shape { turn } else { 0.0 }).sum();
        assert!((sum - trig::TAU).abs() < 1e-14);
        assert!(course.gap().norm() < 1e-12);
        let listed: Vec<_> = course.runs.iter().skip(1).step_by(2).map(|r| (r.listed, r.steps)).collect();
        assert_eq!(listed, [(false, None), (true, None), (true, None), (true, Some(36))]);
    }
}
