//! Exact derivatives of the polygon action with respect to the vertices of a plane layout, by implicit differentiation
//! through the chords.
//!
//! A chord r from the joint behind to the one ahead keeps its length: r·dr = 0. Seen from the joint behind, r runs over
//! parts of pieces of curvature κ and length w, and with X the point and t the tangent where such a part ends, P the
//! joint ahead,
//!
//! dr = (t + κ ẑ×(P − X)) dw + (∂c/∂κ + w ẑ×(P − X)) dκ,
//!
//! c the part's own chord. That gives the joint behind by the one ahead and the lengths and curvatures between, joint
//! after joint; lengths and curvatures follow from radii, turns and straights, and those from the vertices (thesis
//! §3.2).

use super::chain::{JointPosition, Ride, Unrolled};
use super::{Course, PolygonObjective, STEPS, Unsuited, front, harmonic};
use crate::base::trig;
use crate::geometry::{Form, Point, Track};
use crate::problem::measures::{Measures, radius, to_corners};

/// Values and gradients of an objective.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    /// Sum of squares of ΔP, m². Its gradient exists where each peak is a single step, almost everywhere.
    pub value: f64,
    /// By the problem's variables (x, y, R of each vertex), m.
    pub gradient: Vec<f64>,
    /// The same of the first harmonics, which is smooth everywhere.
    pub smooth: f64,
    pub smooth_gradient: Vec<f64>,
}

/// An objective of the plane layout with these variables (x, y, R of each vertex, m) and its gradients.
///
/// # Errors
/// As [`super::action`].
pub fn gradient(variables: &[f64], pitch: f64, objective: PolygonObjective) -> Result<Gradient, Unsuited> {
    let track = Track::new(&to_corners(variables));
    let course = Course::of_track(&track)?;
    course.takes(pitch)?;
    let n = course.len();
    let mut out = Gradient { value: 0.0, gradient: Vec::new(), smooth: 0.0, smooth_gradient: Vec::new() };
    let (mut sharp, mut smooth) = (vec![0.0; 3 * n], vec![0.0; 3 * n]);
    for i in 0..n {
        let unrolled = Unrolled::new(&course, i, n);
        let rides: Vec<Ride> =
            (0..STEPS).map(|step| unrolled.ride(pitch, front(step, pitch))).collect::<Result<_, _>>()?;
        // What a deviation at each step is worth.
        let mut worth = vec![[(0.0, 0.0); STEPS]; n];
        for (m, worth) in worth.iter_mut().enumerate().filter(|(m, _)| objective.counts(m + 1, n)) {
            let mut series = [0.0; STEPS];
            series.iter_mut().zip(&rides).for_each(|(x, ride)| *x = ride.landings[m].deviation);
            let extreme =
                |sign: f64| (0..STEPS).fold(0, |a, b| if sign * series[b] > sign * series[a] { b } else { a });
            let (high, low) = (extreme(1.0), extreme(-1.0));
            let delta = series[high] - series[low];
            out.value += delta * delta;
            worth[high].0 += 2.0 * delta;
            worth[low].0 -= 2.0 * delta;
            let first = harmonic::first(&series);
            out.smooth += 4.0 * first.norm_sqr();
            for (step, worth) in worth.iter_mut().enumerate() {
                let wave = harmonic::turned(-trig::TAU * step as f64 / STEPS as f64);
                worth.1 = 16.0 / STEPS as f64 * (first.re * wave.re + first.im * wave.im);
            }
        }
        for (step, ride) in rides.iter().enumerate() {
            Sweep { unrolled: &unrolled, ride, n }.run(|m, slope| {
                let (by_peak, by_wave) = worth[m][step];
                for (k, x) in slope.iter().enumerate() {
                    sharp[k] += by_peak * x;
                    smooth[k] += by_wave * x;
                }
            });
        }
    }
    let measures = Measures::new(variables, &signs(&track));
    out.gradient = to_vertices(&sharp, &measures);
    out.smooth_gradient = to_vertices(&smooth, &measures);
    Ok(out)
}

impl Course {
    /// The course of a plane layout: straight k is section k's, curve k the fillet of the vertex at its end. Straights
    /// that are too short to have a direction are given a nanometre.
    ///
    /// # Errors
    /// [`Unsuited::NotFinite`].
    pub fn of_track(track: &Track) -> Result<Self, Unsuited> {
        let n = track.fillets.len();
        if !track.length.is_finite() {
            return Err(Unsuited::NotFinite);
        }
        let arc = |k: usize| {
            let fillet = &track.fillets[(k + 1) % n];
            let form = Form::Arc { radius: fillet.radius, turn: fillet.turn };
            super::Bend { forms: vec![form], s: track.pieces[2 * k + 1].s }
        };
        Ok(Course {
            straights: (0..n).map(|k| (track.straight(k).length.max(super::course::TOUCHING), 0.0)).collect(),
            begins: (0..n).map(|k| track.straight(k).s).collect(),
            curves: (0..n).map(arc).collect(),
        })
    }
}

fn signs(track: &Track) -> Vec<f64> {
    track.fillets.iter().map(|f| if f.turn < 0.0 { -1.0 } else { 1.0 }).collect()
}

/// From derivatives by straights, radii and turns of the course to those by the vertices.
fn to_vertices(own: &[f64], measures: &Measures) -> Vec<f64> {
    let n = own.len() / 3;
    let mut out = vec![0.0; 3 * n];
    let mut add = |e: crate::problem::Expansion, by: f64| {
        e.variables.iter().zip(&e.gradient).for_each(|(v, g)| out[*v] += by * g);
    };
    for k in 0..n {
        let vertex = measures.next(k);
        add(measures.straight(k), own[k]);
        add(measures.at(vertex, |m| m.turn), own[2 * n + k]);
    }
    for k in 0..n {
        out[radius(measures.next(k))] += own[n + k];
    }
    out
}

/// The derivatives of one chain's joints, from the first to the last: by straight k at k, radius of curve k at n + k,
/// its turn at 2n + k.
struct Sweep<'a> {
    unrolled: &'a Unrolled,
    ride: &'a Ride,
    n: usize,
}

impl Sweep<'_> {
    /// Hands over the slope of each landing's deviation.
    fn run(&self, mut each: impl FnMut(usize, &[f64])) {
        let mut landings = self.ride.landings.iter().enumerate().peekable();
        // Of the joint's distance from its piece's begin, and of the lengths of the pieces passed.
        let mut at = vec![0.0; 3 * self.n];
        let mut passed = vec![0.0; 3 * self.n];
        for (k, joint) in self.ride.joints.iter().enumerate() {
            while let Some((m, landing)) = landings.next_if(|(_, landing)| landing.behind == k) {
                let on = self.behind(*joint, landing.joint, &at);
                // Deviation = −(what lies between) + d, and d counts from the piece's begin.
                let mut slope: Vec<f64> = passed.iter().zip(&on).map(|(between, on)| on - between).collect();
                for piece in landing.joint.piece..joint.piece {
                    self.lengthens(piece, -1.0, &mut slope);
                }
                each(m, &slope);
            }
            let Some(next) = self.ride.joints.get(k + 1) else { break };
            if next.piece == joint.piece && self.curvature(joint.piece) == 0.0 {
                continue;
            }
            at = self.behind(*joint, *next, &at);
            for piece in next.piece..joint.piece {
                self.lengthens(piece, 1.0, &mut passed);
            }
        }
    }

    fn curvature(&self, piece: usize) -> f64 {
        match self.unrolled.line.stretches[piece].form {
            Form::Arc { radius, turn } => turn.signum() / radius,
            _ => 0.0,
        }
    }

    /// Adds a piece's length.
    fn lengthens(&self, piece: usize, by: f64, slope: &mut [f64]) {
        let (k, n) = (self.unrolled.parts[piece].0, self.n);
        match self.unrolled.line.stretches[piece].form {
            Form::Arc { radius, turn } => {
                slope[n + k] += by * turn.abs();
                slope[2 * n + k] += by * radius;
            }
            _ => slope[k] += by,
        }
    }

    /// Adds a piece's curvature.
    fn bends(&self, piece: usize, by: f64, slope: &mut [f64]) {
        if let Form::Arc { radius, turn } = self.unrolled.line.stretches[piece].form {
            slope[self.n + self.unrolled.parts[piece].0] -= by * turn.signum() / (radius * radius);
        }
    }

    /// Slope of the place of the joint behind, `at` being that of the joint ahead.
    fn behind(&self, ahead: JointPosition, behind: JointPosition, at: &[f64]) -> Vec<f64> {
        let stretches = &self.unrolled.line.stretches;
        let place = |joint: JointPosition| stretches[joint.piece].at(joint.d);
        let plane = |v: nalgebra::Vector3<f64>| Point::new(v.x, v.y);
        let front = plane(place(ahead).position);
        let chord = front - plane(place(behind).position);
        let mut slope = vec![0.0; at.len()];
        let mut own = 1.0;
        for (piece, stretch) in stretches.iter().enumerate().take(ahead.piece + 1).skip(behind.piece) {
            let from = if piece == behind.piece { behind.d } else { 0.0 };
            let to = if piece == ahead.piece { ahead.d } else { stretch.length };
            let end = stretch.at(to);
            let curvature = self.curvature(piece);
            let lever = (front - plane(end.position)).left();
            // What a longer part, and a more bent one, add to r·dr.
            let longer = chord.dot(plane(end.tangent) + lever * curvature);
            let part = self.by_curvature(piece, from, to);
            let bent = chord.dot(part + lever * (to - from));
            self.bends(piece, bent, &mut slope);
            if piece == behind.piece {
                own = longer;
            }
            if piece == ahead.piece {
                slope.iter_mut().zip(at).for_each(|(s, a)| *s += longer * a);
            } else {
                self.lengthens(piece, longer, &mut slope);
            }
        }
        slope.iter_mut().for_each(|s| *s /= own);
        slope
    }

    /// ∂c/∂κ of a piece's part: c = ((sin κw)/κ, (1 − cos κw)/κ) along and across the tangent where it begins.
    fn by_curvature(&self, piece: usize, from: f64, to: f64) -> Point {
        let (stretch, w) = (&self.unrolled.line.stretches[piece], to - from);
        let k = self.curvature(piece);
        if k == 0.0 {
            return Point::default();
        }
        let (sin, cos) = trig::sin_cos(k * w);
        let along = (k * w * cos - sin) / (k * k);
        let across = (k * w * sin - 1.0 + cos) / (k * k);
        let tangent = stretch.at(from).tangent;
        let t = Point::new(tangent.x, tangent.y);
        t * along + t.left() * across
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::polygon::straight_behind;
    use crate::model::instances::thesis10;
    use crate::problem::measures::to_variables;

    /// Against central differences, on the thesis' layout: straights of every length, both hands, two radii.
    #[test]
    fn gradients_are_exact() {
        let x = to_variables(&thesis10().corners());
        for objective in PolygonObjective::EACH {
            let here = gradient(&x, 1.25, objective).expect("a chain");
            let step = 1e-6;
            for k in 0..x.len() {
                let moved = |by: f64| {
                    let mut y = x.clone();
                    y[k] += by;
                    gradient(&y, 1.25, objective).expect("a chain")
                };
                let (up, down) = (moved(step), moved(-step));
                let check = |name: &str, exact: f64, high: f64, low: f64| {
                    let difference = (high - low) / (2.0 * step);
                    let size = here.value.max(1e-8);
                    assert!((exact - difference).abs() < 1e-4 * size, "{name} {k}: {exact:e} {difference:e}");
                };
                check("smooth", here.smooth_gradient[k], up.smooth, down.smooth);
                check("peak", here.gradient[k], up.value, down.value);
            }
            assert!(here.smooth_gradient.iter().any(|g| g.abs() > here.smooth));
        }
    }

    /// Straights that are shorter than a cart, or not there, have slopes as well.
    #[test]
    fn short_straights_have_gradients() {
        let mut layout = crate::model::fixture::rectangle(8.7, 8.2, 4.0);
        layout.vertices[1].point.y -= 0.4;
        let x = to_variables(&layout.corners());
        let here = gradient(&x, 1.25, PolygonObjective::All).expect("a chain");
        for k in 0..x.len() {
            let moved = |by: f64| {
                let mut y = x.clone();
                y[k] += by;
                gradient(&y, 1.25, PolygonObjective::All).expect("a chain").smooth
            };
            let difference = (moved(1e-6) - moved(-1e-6)) / 2e-6;
            assert!((here.smooth_gradient[k] - difference).abs() < 1e-4 * here.smooth, "{k}");
        }
    }

    #[test]
    fn a_start_is_left_through_the_curve_behind() {
        assert_eq!([1, 2, 4].map(|m| straight_behind(0, m, 4)), [3, 2, 0]);
    }
}
