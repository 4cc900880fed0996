//! The centre line in space: straights (also inclined), horizontal and vertical arcs, and spirals, one behind the other
//! with continuous heading and slope. Nothing is banked (design: chain model, frames).

use crate::base::trig;
use nalgebra::Vector3;

/// What a piece of the centre line is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A straight.
    Straight {
        /// Along the slope, m.
        length: f64,
        /// Rise over run.
        slope: f64,
    },
    /// A horizontal arc.
    Arc {
        /// m
        radius: f64,
        /// rad, left positive.
        turn: f64,
    },
    /// A vertical arc between two slopes (rise over run).
    Vertical {
        /// m
        radius: f64,
        slope_from: f64,
        slope_to: f64,
    },
    /// A horizontal arc of constant slope.
    Spiral {
        /// Of its plan, m.
        radius: f64,
        /// rad, left positive.
        turn: f64,
        /// m
        rise: f64,
    },
}

impl Form {
    /// Along the centre line, m.
    pub fn length(&self) -> f64 {
        match *self {
            Form::Straight { length, .. } => length,
            Form::Arc { radius, turn } => radius * turn.abs(),
            Form::Vertical { radius, slope_from, slope_to } => {
                radius * (trig::atan(slope_to) - trig::atan(slope_from)).abs()
            }
            Form::Spiral { radius, turn, rise } => trig::hypot(radius * turn, rise),
        }
    }

    /// Along its plan, m.
    pub fn run(&self) -> f64 {
        match *self {
            Form::Straight { length, slope } => length / trig::hypot(1.0, slope),
            Form::Arc { radius, turn } | Form::Spiral { radius, turn, .. } => radius * turn.abs(),
            Form::Vertical { radius, .. } => {
                let (begin, end) = self.inclination();
                radius * (trig::sin(end) - trig::sin(begin)).abs()
            }
        }
    }

    /// Along the centre line where its plan is `run` from its begin, m.
    pub fn along(&self, run: f64) -> f64 {
        match *self {
            Form::Straight { slope, .. } => run * trig::hypot(1.0, slope),
            Form::Arc { .. } => run,
            Form::Spiral { .. } => run * self.length() / self.run(),
            Form::Vertical { radius, .. } => {
                let (begin, end) = self.inclination();
                let sine = trig::sin(begin) + (end - begin).signum() * run / radius;
                radius * (trig::asin(sine.clamp(-1.0, 1.0)) - begin).abs()
            }
        }
    }

    /// Change of heading from begin to end, rad.
    pub fn turn(&self) -> f64 {
        match *self {
            Form::Arc { turn, .. } | Form::Spiral { turn, .. } => turn,
            Form::Straight { .. } | Form::Vertical { .. } => 0.0,
        }
    }

    /// Slope angle where it begins and where it ends, rad.
    pub fn inclination(&self) -> (f64, f64) {
        match *self {
            Form::Straight { slope, .. } => (trig::atan(slope), trig::atan(slope)),
            Form::Arc { .. } => (0.0, 0.0),
            Form::Vertical { slope_from, slope_to, .. } => (trig::atan(slope_from), trig::atan(slope_to)),
            Form::Spiral { radius, turn, rise } => {
                let slope = trig::atan2(rise, radius * turn.abs());
                (slope, slope)
            }
        }
    }

    /// The same piece from `from` to `to` along it, m; for a slope angle in between, a vertical arc is cut exactly.
    pub fn part(&self, from: f64, to: f64) -> Form {
        let share = (to - from) / self.length();
        match *self {
            Form::Straight { slope, .. } => Form::Straight { length: to - from, slope },
            Form::Arc { radius, turn } => Form::Arc { radius, turn: turn * share },
            Form::Spiral { radius, turn, rise } => Form::Spiral { radius, turn: turn * share, rise: rise * share },
            Form::Vertical { radius, slope_from, slope_to } => {
                let (begin, end) = (trig::atan(slope_from), trig::atan(slope_to));
                let side = (end - begin).signum();
                let slope = |d: f64| trig::tan(begin + side * d / radius);
                Form::Vertical { radius, slope_from: slope(from), slope_to: slope(to) }
            }
        }
    }
}

/// A point of the centre line with its axes: t in driving direction, n horizontal to the left, u = t × n up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// m
    pub position: Vector3<f64>,
    pub tangent: Vector3<f64>,
    pub normal: Vector3<f64>,
    pub up: Vector3<f64>,
}

impl Frame {
    /// Axes from heading and slope angle, rad.
    pub fn new(position: Vector3<f64>, heading: f64, inclination: f64) -> Self {
        let (sin, cos) = trig::sin_cos(heading);
        let (rise, run) = trig::sin_cos(inclination);
        Frame {
            position,
            tangent: Vector3::new(cos * run, sin * run, rise),
            normal: Vector3::new(-sin, cos, 0.0),
            up: Vector3::new(-cos * rise, -sin * rise, run),
        }
    }

    /// rad in (-π, π]
    pub fn heading(&self) -> f64 {
        trig::atan2(-self.normal.x, self.normal.y)
    }

    /// Rise over run.
    pub fn slope(&self) -> f64 {
        self.tangent.z / self.up.z
    }
}

/// A piece at its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    pub form: Form,
    /// Arc length where it begins, m.
    pub s: f64,
    /// m
    pub length: f64,
    /// Where it begins.
    pub begin: Frame,
    heading: f64,
    inclination: f64,
}

impl Stretch {
    /// The frame at distance `d` from the begin, m; beyond either end the piece goes on as it is.
    pub fn at(&self, d: f64) -> Frame {
        let begin = self.begin.position;
        let (sin, cos) = trig::sin_cos(self.heading);
        match self.form {
            Form::Straight { .. } => Frame { position: begin + self.begin.tangent * d, ..self.begin },
            Form::Arc { radius, turn } | Form::Spiral { radius, turn, .. } => {
                let (rise, run) = trig::sin_cos(self.inclination);
                let side = turn.signum();
                let heading = self.heading + side * d * run / radius;
                let (sin_to, cos_to) = trig::sin_cos(heading);
                let step = Vector3::new(sin_to - sin, cos - cos_to, 0.0) * (side * radius);
                let climb = Vector3::new(0.0, 0.0, d * rise);
                Frame::new(begin + step + climb, heading, self.inclination)
            }
            Form::Vertical { radius, slope_from, slope_to } => {
                let side = (slope_to - slope_from).signum();
                let inclination = self.inclination + side * d / radius;
                let (sin_from, cos_from) = trig::sin_cos(self.inclination);
                let (sin_to, cos_to) = trig::sin_cos(inclination);
                let run = (sin_to - sin_from) * side * radius;
                let climb = (cos_from - cos_to) * side * radius;
                Frame::new(begin + Vector3::new(cos * run, sin * run, climb), self.heading, inclination)
            }
        }
    }

    /// Distance from the begin of the point of this piece, or of its continuation, that lies nearest, m.
    pub fn project(&self, point: &Vector3<f64>) -> f64 {
        let r = point - self.begin.position;
        match self.form {
            Form::Straight { .. } => r.dot(&self.begin.tangent),
            Form::Arc { radius, turn } => turned(r, &self.begin, self.begin.normal * turn.signum(), radius, turn),
            Form::Vertical { radius, slope_from, slope_to } => {
                let turn = self.length / radius;
                turned(r, &self.begin, self.begin.up * (slope_to - slope_from).signum(), radius, turn)
            }
            Form::Spiral { radius, turn, .. } => {
                let run = trig::cos(self.inclination);
                let plan = Frame::new(self.begin.position, self.heading, 0.0);
                let flat = Vector3::new(r.x, r.y, 0.0);
                let mut d = turned(flat, &plan, plan.normal * turn.signum(), radius, turn) / run;
                // Newton's method on (r − c)·t = 0. With t' = κ n horizontal, its derivative is κ (r − c)·n − 1.
                let curvature = turn.signum() * run * run / radius;
                for _ in 0..NEWTON {
                    let at = self.at(d);
                    let away = point - at.position;
                    let step = away.dot(&at.tangent) / (1.0 - curvature * away.dot(&at.normal));
                    d += step;
                    if step.abs() < 1e-13 {
                        break;
                    }
                }
                d
            }
        }
    }
}

/// Steps of Newton's method: quadratic, from a start that is good to a few centimetres.
const NEWTON: usize = 20;

/// Progress along an arc towards `inward` from its begin, of the arc's point nearest to `r` (from the begin), m. Angles
/// are counted from the arc's middle, so that the cut of atan2 lies opposite to it.
fn turned(r: Vector3<f64>, begin: &Frame, inward: Vector3<f64>, radius: f64, turn: f64) -> f64 {
    let half = turn.abs() / 2.0;
    let out = r - inward * radius;
    let (forward, outward) = (out.dot(&begin.tangent), -out.dot(&inward));
    let (sin, cos) = trig::sin_cos(half);
    radius * (half + trig::atan2(forward * cos - outward * sin, outward * cos + forward * sin))
}

/// A closed centre line.
#[derive(Clone, Debug, PartialEq)]
pub struct CentreLine {
    pub stretches: Vec<Stretch>,
    /// m
    pub length: f64,
    /// Distance between the last piece's end and the first one's begin, m, and the angle between their tangents, rad.
    pub closure: (f64, f64),
}

/// The nearest point of the centre line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Index of the piece.
    pub stretch: usize,
    /// Arc length in [0, S], m.
    pub s: f64,
    pub frame: Frame,
}

impl CentreLine {
    /// Puts pieces one behind the other from `start` (x, y, z in m, heading in rad). Pieces without length are left
    /// out.
    pub fn new(start: [f64; 4], forms: &[Form]) -> Self {
        let [x, y, z, heading] = start;
        let mut stretches: Vec<Stretch> = Vec::with_capacity(forms.len());
        let (mut s, mut heading) = (0.0, heading);
        let mut position = Vector3::new(x, y, z);
        for form in forms {
            let length = form.length();
            if length <= 0.0 {
                continue;
            }
            let inclination = form.inclination().0;
            let begin = Frame::new(position, heading, inclination);
            let stretch = Stretch { form: *form, s, length, begin, heading, inclination };
            position = stretch.at(length).position;
            heading += form.turn();
            s += length;
            stretches.push(stretch);
        }
        let closure = match (stretches.first(), stretches.last()) {
            (Some(first), Some(last)) => {
                let end = last.at(last.length);
                let angle = 2.0 * trig::asin(((end.tangent - first.begin.tangent).norm() / 2.0).min(1.0));
                ((end.position - first.begin.position).norm(), angle)
            }
            _ => (0.0, 0.0),
        };
        CentreLine { stretches, length: s, closure }
    }

    /// Index of the piece at arc length `s` in [0, S).
    pub fn stretch_at(&self, s: f64) -> usize {
        self.stretches.partition_point(|p| p.s <= s).max(1) - 1
    }

    /// The frame at arc length `s`, taken modulo the length.
    pub fn at(&self, s: f64) -> Frame {
        let s = s.rem_euclid(self.length);
        let stretch = &self.stretches[self.stretch_at(s)];
        stretch.at(s - stretch.s)
    }

    /// The nearest point, sought from piece `from` onwards or backwards: the local minimum of the distance that a
    /// moving point stays with.
    pub fn nearest(&self, point: &Vector3<f64>, from: usize) -> Nearest {
        let n = self.stretches.len();
        let mut i = from % n;
        let mut came_forward = false;
        for _ in 0..=n {
            let stretch = &self.stretches[i];
            let d = stretch.project(point);
            if d > stretch.length {
                i = (i + 1) % n;
                came_forward = true;
            } else if d < 0.0 && !came_forward {
                i = (i + n - 1) % n;
            } else {
                let d = d.max(0.0);
                return Nearest { stretch: i, s: stretch.s + d, frame: stretch.at(d) };
            }
        }
        let stretch = &self.stretches[i];
        let d = stretch.project(point).clamp(0.0, stretch.length);
        Nearest { stretch: i, s: stretch.s + d, frame: stretch.at(d) }
    }

    /// Whether every piece lies in one horizontal plane.
    pub fn is_level(&self) -> bool {
        self.stretches.iter().all(|p| {
            let (begin, end) = p.form.inclination();
            begin == 0.0 && end == 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ramp() -> CentreLine {
        let slope = 0.14;
        CentreLine::new(
            [3.0, -2.0, 1.0, 0.7],
            &[
                Form::Straight { length: 6.0, slope: 0.0 },
                Form::Vertical { radius: 10.0, slope_from: 0.0, slope_to: slope },
                Form::Straight { length: 5.0, slope },
                Form::Spiral { radius: 4.0, turn: -2.0, rise: slope * 8.0 },
                Form::Vertical { radius: 8.0, slope_from: slope, slope_to: 0.0 },
                Form::Arc { radius: 3.0, turn: 2.5 },
            ],
        )
    }

    /// Against finite differences: unit speed, and axes that fit.
    #[test]
    fn frames_follow_the_curve() {
        let line = ramp();
        let h = 1e-5;
        for k in 1..400 {
            let s = line.length * k as f64 / 401.0;
            let (a, b, at) = (line.at(s - h), line.at(s + h), line.at(s));
            let tangent = (b.position - a.position) / (2.0 * h);
            assert!((tangent - at.tangent).norm() < 1e-6, "{s}: {tangent} {}", at.tangent);
            assert!((at.tangent.cross(&at.normal) - at.up).norm() < 1e-14);
            assert!(at.normal.z == 0.0 && (at.normal.norm() - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn heights_and_lengths_are_the_closed_forms() {
        let line = ramp();
        let angle = libm::atan(0.14);
        let length = 11.0 + 18.0 * angle + libm::hypot(8.0, 1.12) + 3.0 * 2.5;
        assert!((line.length - length).abs() < 1e-12);
        let rise = (10.0 + 8.0) * (1.0 - libm::cos(angle)) + 5.0 * libm::sin(angle) + 1.12;
        assert!((line.at(line.length - 1e-9).position.z - 1.0 - rise).abs() < 1e-9);
    }

    #[test]
    fn places_of_the_plan_are_found_along_the_slope() {
        for stretch in &ramp().stretches {
            let run = stretch.form.run();
            assert!((stretch.form.along(run) - stretch.length).abs() < 1e-12);
            let flat = |d: f64| stretch.at(d).position.xy();
            // The plan's length by many small steps.
            let d = stretch.form.along(0.37 * run);
            let steps = 20_000;
            let step = |k: i32| flat(d * f64::from(k) / f64::from(steps));
            let walked: f64 = (0..steps).map(|k| (step(k + 1) - step(k)).norm()).sum();
            assert!((walked - 0.37 * run).abs() < 1e-7, "{:?}: {walked} of {run}", stretch.form);
        }
    }

    #[test]
    fn parts_join_to_the_whole() {
        for stretch in &ramp().stretches {
            let at = 0.4 * stretch.length;
            let (a, b) = (stretch.form.part(0.0, at), stretch.form.part(at, stretch.length));
            let begin = stretch.begin.position;
            let line = CentreLine::new([begin.x, begin.y, begin.z, stretch.heading], &[a, b]);
            for s in [0.2, 0.5, 0.9].map(|x| x * stretch.length) {
                assert!((line.at(s).position - stretch.at(s).position).norm() < 1e-12);
            }
        }
    }

    proptest! {
        /// A point beside the line finds the foot it was put up on.
        #[test]
        fn the_nearest_point_is_found(share in 0.01..0.99f64, y in -0.3..0.3f64, z in -0.3..0.3f64, off in -1i32..=1) {
            let line = ramp();
            let s = share * line.length;
            let at = line.at(s);
            let point = at.position + at.normal * y + at.up * z;
            let own = line.stretch_at(s) as i32;
            let n = line.stretches.len() as i32;
            let found = line.nearest(&point, (own + off).clamp(0, n - 1) as usize);
            prop_assert!((found.s - s).abs() < 1e-9, "{} {}", found.s, s);
        }
    }
}
