//! Rows that speak of where the track has a heading, under multipliers: sums over all of them for a pair of headings,
//! without going over them.

use super::row::Touch;
use crate::geometry::Point;

/// The touches of one stage, in the order in which a track that turns to one side comes to their headings, with sums up
/// to each.
#[derive(Clone, Debug, Default)]
pub struct Touched {
    sign: f64,
    /// Headings times the sign, ascending.
    headings: Vec<f64>,
    /// Of pulls, of those whose arc is the first, and of pulls along the normals.
    pulls: Vec<Point>,
    first: Vec<Point>,
    normals: Vec<f64>,
}

impl Touched {
    /// Of touches at an arc's stage, or at a straight's. All are on a run of arcs with this sign.
    pub fn new(mut touches: Vec<Touch>, stage: usize, sign: i32) -> Touched {
        let sign = f64::from(sign);
        touches.sort_by(|a, b| (sign * a.heading).total_cmp(&(sign * b.heading)));
        let mut out = Touched { sign, ..Touched::default() };
        let (mut pull, mut first, mut normal) = (Point::default(), Point::default(), 0.0);
        for touch in &touches {
            out.headings.push(sign * touch.heading);
            out.pulls.push(pull);
            out.first.push(first);
            out.normals.push(normal);
            pull = pull + touch.pull;
            first = if touch.from == stage { first + touch.pull } else { first };
            normal += touch.pull.dot(touch.normal);
        }
        out.pulls.push(pull);
        out.first.push(first);
        out.normals.push(normal);
        out
    }

    pub fn len(&self) -> usize {
        self.headings.len()
    }

    /// How many a heading is beyond.
    pub fn passed(&self, heading: i32) -> usize {
        let heading = self.sign * f64::from(heading);
        self.headings.partition_point(|own| *own <= heading)
    }

    /// The sum of [`Touch::arc`]: for each metre of the arc's tangent length and of its radius, with as many passed by the
    /// heading before, u, and by that after, v.
    pub fn arc(&self, (before, u): (usize, Point), (after, v): (usize, Point)) -> (f64, f64) {
        let all = self.len();
        if before == all {
            return (0.0, 0.0);
        }
        let after = after.max(before);
        let on = self.pulls[after] - self.pulls[before];
        let on_first = self.first[after] - self.first[before];
        let beyond = self.pulls[all] - self.pulls[after];
        let beyond_later = beyond - (self.first[all] - self.first[after]);
        let along = beyond.dot(v) + beyond_later.dot(u) - on_first.dot(u);
        let across = self.sign * (on.dot(u.left()) - (self.normals[after] - self.normals[before]));
        (along, across)
    }

    /// The sum of [`Touch::straight`] for each metre.
    pub fn straight(&self, heading: i32, u: Point) -> f64 {
        let all = self.len();
        (self.pulls[all] - self.pulls[self.passed(heading)]).dot(u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::uniform;

    #[test]
    fn sums_are_those_of_each() {
        let mut state = 3;
        let mut draw = |from: f64, to: f64| from + (to - from) * uniform(&mut state);
        for sign in [1, -1] {
            let unit = |heading: f64| Point::unit(0.1 * heading);
            let touches: Vec<Touch> = (0..9)
                .map(|k| {
                    let heading = draw(-8.0, 8.0).round();
                    let pull = Point::new(draw(-1.0, 1.0), draw(-1.0, 1.0));
                    Touch { from: if k % 3 == 0 { 4 } else { 2 }, to: 6, heading, normal: unit(heading).left(), pull }
                })
                .collect();
            let all = Touched::new(touches.clone(), 4, sign);
            for h in -9..9 {
                let (t, u) = (h + 3 * sign, unit(f64::from(h)));
                let v = unit(f64::from(t));
                let each = touches.iter().map(|touch| touch.arc(4, sign, (h, u), (t, v)));
                let expected = each.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
                let found = all.arc((all.passed(h), u), (all.passed(t), v));
                assert!((found.0 - expected.0).abs() < 1e-12 && (found.1 - expected.1).abs() < 1e-12);
                let straight: f64 = touches.iter().map(|touch| touch.straight(4, sign, (h, u))).sum();
                assert!((all.straight(h, u) - straight).abs() < 1e-12);
            }
        }
    }
}
