//! Shortest paths between two poses whose curvature is bounded (Dubins 1957), without obstacles.

use crate::base::trig;
use crate::geometry::Point;

/// A point with a direction of travel, a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub point: Point,
    pub direction: Point,
}

impl Pose {
    /// The pose so far ahead, m.
    pub fn ahead(self, by: f64) -> Pose {
        Pose { point: self.point + self.direction * by, ..self }
    }
}

/// An arc this close to a full turn is none, rad: rounding must not make a path longer.
const FULL: f64 = 1e-6;

/// Length (m) of the shortest path between two poses that nowhere bends tighter than `radius`: an arc, a straight or an
/// arc the other way of more than a half turn, and an arc. Equations: Shkel and Lumelsky 2001, §3.
pub fn shortest(from: Pose, to: Pose, radius: f64) -> f64 {
    let between = to.point - from.point;
    let d = between.norm() / radius;
    let along = if d > 0.0 { between.heading() } else { 0.0 };
    let (a, b) = (from.direction.heading() - along, to.direction.heading() - along);
    let ((sa, ca), (sb, cb)) = (trig::sin_cos(a), trig::sin_cos(b));
    let difference = trig::cos(a - b);
    let arc = |angle: f64| {
        let angle = angle.rem_euclid(trig::TAU);
        if angle > trig::TAU - FULL { 0.0 } else { angle }
    };
    let root = |square: f64| (square > -1e-9).then(|| libm::sqrt(square.max(0.0)));
    let atan = trig::atan2;
    let mut best = f64::INFINITY;
    let mut take = |length: f64| best = best.min(length);
    // Left, straight, left, and right, straight, right.
    if let Some(p) = root(2.0 + d * d - 2.0 * difference + 2.0 * d * (sa - sb)) {
        let straight = atan(cb - ca, d + sa - sb);
        take(arc(straight - a) + p + arc(b - straight));
    }
    if let Some(p) = root(2.0 + d * d - 2.0 * difference + 2.0 * d * (sb - sa)) {
        let straight = atan(ca - cb, d - sa + sb);
        take(arc(a - straight) + p + arc(straight - b));
    }
    // Left, straight, right, and right, straight, left.
    if let Some(p) = root(-2.0 + d * d + 2.0 * difference + 2.0 * d * (sa + sb)) {
        let straight = atan(-ca - cb, d + sa + sb) - atan(-2.0, p);
        take(arc(straight - a) + p + arc(straight - b));
    }
    if let Some(p) = root(-2.0 + d * d + 2.0 * difference - 2.0 * d * (sa + sb)) {
        let straight = atan(ca + cb, d - sa - sb) - atan(2.0, p);
        take(arc(a - straight) + p + arc(b - straight));
    }
    // Right, left, right, and left, right, left.
    let middle = |cosine: f64| (cosine.abs() <= 1.0 + 1e-9).then(|| trig::TAU - trig::acos(cosine.clamp(-1.0, 1.0)));
    if let Some(p) = middle((6.0 - d * d + 2.0 * difference + 2.0 * d * (sa - sb)) / 8.0) {
        let t = arc(a - atan(ca - cb, d - sa + sb) + p / 2.0);
        take(t + p + arc(a - b - t + p));
    }
    if let Some(p) = middle((6.0 - d * d + 2.0 * difference + 2.0 * d * (sb - sa)) / 8.0) {
        let t = arc(-a + atan(cb - ca, d + sa - sb) + p / 2.0);
        take(t + p + arc(b - a - t + p));
    }
    best * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(x: f64, y: f64, degrees: f64) -> Pose {
        Pose { point: Point::new(x, y), direction: Point::unit(degrees.to_radians()) }
    }

    #[test]
    fn paths_that_can_be_told_by_hand() {
        let pi = trig::PI;
        for (from, to, expected) in [
            // Straight on; half a circle; a half turn and a quarter turn with a straight in them.
            (pose(1.0, 2.0, 30.0), pose(1.0 + 5.0 * trig::cos(trig::PI / 6.0), 4.5, 30.0), 5.0),
            (pose(0.0, 0.0, 0.0), pose(0.0, 8.0, 180.0), 4.0 * pi),
            (pose(0.0, 0.0, 0.0), pose(10.0, 20.0, 180.0), trig::hypot(10.0, 12.0) + 4.0 * pi),
            (pose(0.0, 0.0, 0.0), pose(20.0, -15.0, -90.0), trig::hypot(16.0, 11.0) + 2.0 * pi),
            // A quarter to the left and one to the right; two half circles, to a place behind.
            (pose(0.0, 0.0, 0.0), pose(8.0, 8.0, 0.0), 4.0 * pi),
            (pose(0.0, 0.0, 0.0), pose(-10.0, 0.0, 0.0), 8.0 * pi + 10.0),
        ] {
            let found = shortest(from, to, 4.0);
            // A straight of no length is the root of a difference.
            assert!((found - expected).abs() < 1e-6, "{from:?} {to:?}: {found}, not {expected}");
        }
    }

    /// Beside each other and closer than two radii, a turn back swings out: three arcs about centres in a triangle.
    #[test]
    fn a_turn_back_in_a_narrow_place_swings_out() {
        let (radius, apart) = (4.0, 3.0);
        // Centres: 4 m to the right of the one line, 4 m to the right of the other, and one 8 m from both.
        let base = apart + 2.0 * radius;
        let swing = trig::acos(base / 2.0 / (2.0 * radius));
        let expected = radius * (swing + (trig::PI + 2.0 * swing) + swing);
        let found = shortest(pose(0.0, 0.0, 0.0), pose(0.0, apart, 180.0), radius);
        assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    }

    /// Against a search over headings and arcs that knows nothing of words: integrate the extremes of curvature.
    #[test]
    fn no_sampled_path_is_shorter() {
        use crate::base::random::Random;
        let mut random = Random::new(7);
        for _ in 0..2_000 {
            let from = pose(0.0, 0.0, 0.0);
            let mut at = from;
            let mut length = 0.0;
            for _ in 0..4 {
                let (bend, by) = ([-1.0, 0.0, 1.0][(random.uniform() * 3.0) as usize], 10.0 * random.uniform());
                let turn = bend * by / 4.0;
                if bend == 0.0 {
                    at = at.ahead(by);
                } else {
                    let centre = at.point + at.direction.left() * (4.0 * bend);
                    let (sin, cos) = trig::sin_cos(turn);
                    let turned = |p: Point| Point::new(p.x * cos - p.y * sin, p.x * sin + p.y * cos);
                    at = Pose { point: centre + turned(at.point - centre), direction: turned(at.direction) };
                }
                length += by;
            }
            let found = shortest(from, at, 4.0);
            assert!(found <= length + 1e-6, "{at:?}: {found} > {length}");
            assert!(found >= at.point.norm() - 1e-6, "{at:?}: {found}");
        }
    }
}
