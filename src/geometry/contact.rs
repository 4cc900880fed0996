//! The contact area between a track side and a polygon, A_q(G_d, χ_q) (thesis §3.3.1, Eq. 3.2).
//!
//! The thesis walks along the boundary of each overlap in four steps. The same steps are taken here strip by strip,
//! which needs no walk that a touching vertex or a common edge could lead astray:
//!
//! 1. All intersections between the side and the polygon (and of the side with itself) are found. Vertical lines
//!    through these, through all corners and through the arcs' leftmost and rightmost points divide the plane into
//!    strips, and within a strip no two boundaries cross.
//! 2. Within a strip the boundaries are ordered by height. Going up, each is an ingoing or an outgoing crossing of
//!    the side or of the polygon: two winding numbers say what lies inside which.
//! 3. The area between an ingoing boundary and its outgoing one is the trapezoid between the chords, and the circular
//!    segments between arcs and their chords, exactly.
//! 4. The areas are summed up.
//!
//! An intersection that rounding hides or doubles only moves a strip's border where two boundaries (nearly) coincide,
//! so degenerate contacts cost the area of a sliver as thin as rounding: tangents, vertices on the side, and common
//! edges are no special cases. The area is continuous in the layout of a simple loop, and zero unless
//! something lies on the wrong side.

use super::side::{Strand, StrandShape};
use super::{Hand, Outline, Point, Polygon, Track};

/// Area of that part of `polygon`, m², that lies on the wrong side of the track's `hand` side curve at `half_width`, m:
/// not to its left when the polygon is to lie (`lies`) to the left of travel, not to its right otherwise.
///
/// For a loop driven counter-clockwise left of the side is its inside. To measure many polygons against one side, build
/// the [`Outline`] once and call [`Outline::contact`].
pub fn contact_area(track: &Track, half_width: f64, hand: Hand, polygon: &Polygon, lies: Hand) -> f64 {
    Outline::side(track, half_width, hand).contact(polygon, lies)
}

/// Area, m², enclosed by the track's `hand` side at `half_width`, m, that lies outside the building.
pub fn outside_area(track: &Track, half_width: f64, hand: Hand, building: &Polygon) -> f64 {
    Outline::side(track, half_width, hand).area_outside(building)
}

impl Outline {
    /// See [`contact_area`].
    pub fn contact(&self, polygon: &Polygon, lies: Hand) -> f64 {
        let inside_is_left = self.orientation() > 0;
        let inside_is_wrong = inside_is_left != (lies == Hand::Left);
        self.measure_within(polygon, |enclosed, within| within && enclosed == inside_is_wrong)
    }

    /// Area of that part of the polygon that lies inside, m².
    pub fn area_within(&self, polygon: &Polygon) -> f64 {
        self.measure_within(polygon, |enclosed, within| within && enclosed)
    }

    /// Area of that part of the inside that lies outside the polygon, m².
    pub fn area_outside(&self, polygon: &Polygon) -> f64 {
        let strands = self.strands().iter().map(|&s| Boundary { strand: s, of_polygon: false });
        self.measure(strands.chain(polygon_boundaries(polygon)).collect(), &[], |enclosed, within| enclosed && !within)
    }

    /// Area of the inside, m².
    pub fn area(&self) -> f64 {
        let strands = self.strands().iter().map(|&s| Boundary { strand: s, of_polygon: false });
        self.measure(strands.collect(), &[], |enclosed, _| enclosed)
    }

    /// [`Outline::measure`] for a region that is part of the polygon: only the strands that reach its bounding box
    /// bound it, and those below matter to the winding number alone.
    fn measure_within(&self, polygon: &Polygon, region: impl Fn(bool, bool) -> bool) -> f64 {
        let (low, high) = polygon.bounds();
        let mut near: Vec<Boundary> = polygon_boundaries(polygon).collect();
        let mut below = Vec::new();
        for &strand in self.strands().iter().filter(|s| s.x0 <= high.x && s.x1 >= low.x) {
            let (bottom, top) = strand.y_range();
            if top < low.y {
                below.push(strand);
            } else if bottom <= high.y {
                near.push(Boundary { strand, of_polygon: false });
            }
        }
        self.measure(near, &below, region)
    }

    /// Area of the region where `region(inside the outline, inside the polygon)` holds, m².
    fn measure(&self, mut near: Vec<Boundary>, below: &[Strand], region: impl Fn(bool, bool) -> bool) -> f64 {
        near.sort_by(|a, b| a.strand.x0.total_cmp(&b.strand.x0));
        let borders = strip_borders(&near);
        let mut waiting = near.iter().peekable();
        let mut active: Vec<(f64, &Boundary)> = Vec::new();
        let mut area = 0.0;
        for strip in borders.windows(2) {
            let &[left, right] = strip else { continue };
            let middle = left + (right - left) / 2.0;
            while let Some(boundary) = waiting.next_if(|b| b.strand.x0 <= left) {
                active.push((0.0, boundary));
            }
            active.retain(|(_, b)| b.strand.x1 >= right);
            for (height, boundary) in &mut active {
                *height = boundary.strand.y(middle);
            }
            active.sort_by(|a, b| a.0.total_cmp(&b.0));

            let mut around_side: i32 =
                below.iter().filter(|s| s.x0 <= middle && middle < s.x1).map(|s| s.winding).sum();
            let mut around_polygon = 0;
            let mut ingoing: Option<&Strand> = None;
            for &(height, boundary) in &active {
                let strand = &boundary.strand;
                if boundary.of_polygon {
                    around_polygon += strand.winding;
                } else {
                    around_side += strand.winding;
                }
                match (ingoing, region(self.encloses(around_side), around_polygon > 0)) {
                    (None, true) => ingoing = Some(strand),
                    (Some(bottom), false) => {
                        area += strand.area_above(height, left, right) - bottom.area_above(height, left, right);
                        ingoing = None;
                    }
                    _ => {}
                }
            }
        }
        // Slivers of rounding may be negative; an area is not.
        if area > 0.0 { area } else { 0.0 }
    }
}

/// A part of the side's or of the polygon's boundary.
#[derive(Clone, Copy)]
struct Boundary {
    strand: Strand,
    of_polygon: bool,
}

fn polygon_boundaries(polygon: &Polygon) -> impl Iterator<Item = Boundary> + '_ {
    polygon.edges().map(|(a, b)| Boundary { strand: Strand::line(a, b), of_polygon: true })
}

/// The strips' borders, ascending: where a boundary begins, ends or crosses another. `near` is sorted by x0.
fn strip_borders(near: &[Boundary]) -> Vec<f64> {
    let mut borders = Vec::with_capacity(4 * near.len());
    for (i, a) in near.iter().enumerate() {
        borders.extend([a.strand.x0, a.strand.x1]);
        let (bottom, top) = a.strand.y_range();
        for b in near[i + 1..].iter().take_while(|b| b.strand.x0 < a.strand.x1) {
            // A simple polygon's edges do not cross.
            if a.of_polygon && b.of_polygon {
                continue;
            }
            let (low, high) = b.strand.y_range();
            if low <= top && bottom <= high {
                crossings(&a.strand, &b.strand, &mut borders);
            }
        }
    }
    borders.sort_by(f64::total_cmp);
    borders.dedup();
    borders
}

/// Adds every x where the two strands cross. More than these may be added: a needless border does no harm.
fn crossings(a: &Strand, b: &Strand, borders: &mut Vec<f64>) {
    let (left, right) = (a.x0.max(b.x0), a.x1.min(b.x1));
    let mut add = |x: f64| {
        if left < x && x < right {
            borders.push(x);
        }
    };
    match (a.shape, b.shape) {
        (StrandShape::Line { .. }, StrandShape::Line { .. }) => {
            let (from, to) = (a.y(left) - b.y(left), a.y(right) - b.y(right));
            if from * to < 0.0 {
                add(left + (right - left) * (from / (from - to)));
            }
        }
        (StrandShape::Line { y0, y1 }, StrandShape::Arc { centre, radius, .. }) => {
            line_circle(Point::new(a.x0, y0), Point::new(a.x1, y1), centre, radius).map(|p| p.map(|p| add(p.x)));
        }
        (StrandShape::Arc { centre, radius, .. }, StrandShape::Line { y0, y1 }) => {
            line_circle(Point::new(b.x0, y0), Point::new(b.x1, y1), centre, radius).map(|p| p.map(|p| add(p.x)));
        }
        (StrandShape::Arc { centre, radius, .. }, StrandShape::Arc { centre: other, radius: r, .. }) => {
            circle_circle(centre, radius, other, r).map(|p| p.map(|p| add(p.x)));
        }
    }
}

/// The two points that the line through `a` and `b` has in common with a circle; equal where it is tangent.
pub(super) fn line_circle(a: Point, b: Point, centre: Point, radius: f64) -> Option<[Point; 2]> {
    let along = (b - a) * (1.0 / a.distance(b));
    let foot = a + along * (centre - a).dot(along);
    let distance = along.cross(centre - a).abs();
    let half = ((radius - distance) * (radius + distance)).sqrt();
    // Not a number where the line misses the circle, or where a and b coincide.
    half.is_finite().then(|| [foot - along * half, foot + along * half])
}

/// The two points that two circles have in common; equal where they touch. `None` for concentric ones.
pub(super) fn circle_circle(a: Point, r: f64, b: Point, s: f64) -> Option<[Point; 2]> {
    let distance = a.distance(b);
    let along = (b - a) * (1.0 / distance);
    let reach = (distance + (r - s) * (r + s) / distance) / 2.0;
    let half = ((r - reach) * (r + reach)).sqrt();
    half.is_finite().then(|| [-half, half].map(|h| a + along * reach + along.left() * h))
}
