//! Closing: the pitch at which a whole number of joints, each a straight chord from the next, meets itself on the
//! centre line.

use crate::geometry::CentreLine;
use std::fmt;

/// A closed chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Closing {
    /// Distance between neighbouring joints, m.
    pub pitch: f64,
    /// Arc length of each joint in driving order backwards, m: the first where it was asked for, each less than the one
    /// before, without wrapping.
    pub stations: Vec<f64>,
}

/// The Newton iteration did not close: the centre line is too short or too tight for so many chords.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unclosed {
    pub joints: usize,
}

impl fmt::Display for Unclosed {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "a chain of {} carts does not close on this centre line", self.joints)
    }
}

/// Closes `joints` equal chords on the centre line, the first joint at arc length `front`, m.
///
/// Newton's method on the pitch, around Newton's method for each chord. With chord vector d from joint k+1 to joint k,
/// |d|² = ℓ² gives d·t_k ds_k − d·t_{k+1} ds_{k+1} = ℓ dℓ, and so the derivative of the last joint.
pub fn closing(line: &CentreLine, joints: usize, front: f64) -> Result<Closing, Unclosed> {
    let failed = Unclosed { joints };
    if joints < 3 || line.length <= 0.0 {
        return Err(failed);
    }
    // Each chord is placed to its rounding.
    let near = f64::max(1e-10, f64::EPSILON * line.length * joints as f64);
    let mut pitch = line.length / joints as f64;
    for _ in 0..ITERATIONS {
        let mut stations = Vec::with_capacity(joints);
        let mut slope = 0.0;
        let mut ahead = front;
        let mut at_ahead = line.at(ahead);
        for _ in 0..joints {
            stations.push(ahead);
            let (behind, at_behind) = follow(line, ahead, pitch).ok_or(failed)?;
            let chord = at_ahead.position - at_behind.position;
            slope = (chord.dot(&at_ahead.tangent) * slope - pitch) / chord.dot(&at_behind.tangent);
            (ahead, at_ahead) = (behind, at_behind);
        }
        let gap = ahead - (front - line.length);
        if gap.abs() < near {
            return Ok(Closing { pitch, stations });
        }
        pitch -= gap / slope;
        if !pitch.is_finite() || pitch <= 0.0 {
            return Err(failed);
        }
    }
    Err(failed)
}

/// Newton converges in four or five steps from the arc length's pitch.
const ITERATIONS: usize = 50;

/// The joint one chord behind the one at `ahead`.
fn follow(line: &CentreLine, ahead: f64, pitch: f64) -> Option<(f64, crate::geometry::Frame)> {
    let from = line.at(ahead).position;
    let mut s = ahead - pitch;
    // Positions are good to some units of their last place; convergence is quadratic.
    let near = f64::max(1e-12, 4.0 * f64::EPSILON * line.length.max(from.norm()));
    for _ in 0..ITERATIONS {
        let at = line.at(s);
        let chord = from - at.position;
        let distance = chord.norm();
        let step = (distance - pitch) * distance / chord.dot(&at.tangent);
        s += step;
        if !s.is_finite() {
            return None;
        }
        if step.abs() < near {
            return Some((s, line.at(s)));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig;
    use crate::geometry::Form;

    /// A circle is closed by a regular polygon.
    #[test]
    fn a_circle_takes_a_regular_polygon() {
        let line = CentreLine::new([0.0; 4], &[Form::Arc { radius: 10.0, turn: trig::TAU }]);
        let closed = closing(&line, 50, 3.0).unwrap();
        assert!((closed.pitch - 20.0 * trig::sin(trig::PI / 50.0)).abs() < 1e-12);
        for (k, s) in closed.stations.iter().enumerate() {
            assert!((s - (3.0 - k as f64 * line.length / 50.0)).abs() < 1e-9);
        }
    }

    /// Design, chain model: what chords cut off a curve is θL²/(24R) − L³/(120R²), the mean over phases.
    #[test]
    fn chords_cut_off_the_closed_form() {
        let (radius, turn, straight) = (4.0, trig::FRAC_PI_2, 18.0);
        let forms: Vec<Form> = (0..4)
            .flat_map(|_| [Form::Straight { length: straight, slope: 0.0 }, Form::Arc { radius, turn }])
            .collect();
        let line = CentreLine::new([0.0; 4], &forms);
        let joints = 77;
        let phases = 64;
        let near = line.length / joints as f64;
        let mean: f64 =
            (0..phases).map(|k| closing(&line, joints, near * k as f64 / phases as f64).unwrap().pitch).sum::<f64>()
                / phases as f64;
        let excess = turn * mean * mean / (24.0 * radius) - mean * mean * mean / (120.0 * radius * radius);
        let got = line.length - mean * joints as f64;
        // The series' next term is 0.45 (L/2R)² of the first, 1.1 % here.
        let second =
            4.0 * turn * mean * mean / (24.0 * radius) * 0.45 * (mean / (2.0 * radius)) * (mean / (2.0 * radius));
        assert!((got - 4.0 * excess - second).abs() < 5e-4, "{got} {} {second}", 4.0 * excess);
        assert!((got / (4.0 * excess) - 1.0).abs() < 0.01);
    }

    /// Design, chain model: one transition from straight to arc makes a joint behind it lead and lag by about 0.0113
    /// L³/R² in all while the chain moves by one pitch, and a whole curve by up to twice that, as the fractional part
    /// of Rθ/L decides.
    #[test]
    fn polygon_action_is_the_closed_form() {
        let (radius, pitch) = (4.0, 1.25);
        let unit = pitch * pitch * pitch / (radius * radius);
        // Deviation of a joint twelve places behind one that moves through a pitch, peak to peak.
        let action = |line: &CentreLine, front: f64| {
            let deviation = |k: u32| {
                let ahead = front + pitch * f64::from(k) / 64.0;
                let behind = (0..12).try_fold(ahead, |s, _| follow(line, s, pitch).map(|f| f.0)).expect("a chain");
                behind - ahead
            };
            // In an open chain with one end in an arc, every pitch adds a chord there: that is a trend, no ripple.
            let trend = (deviation(64) - deviation(0)) / 64.0;
            let all: Vec<f64> = (0..=64).map(|k| deviation(k) - trend * f64::from(k)).collect();
            all.iter().fold(f64::MIN, |a, b| a.max(*b)) - all.iter().fold(f64::MAX, |a, b| a.min(*b))
        };
        let straight = |length: f64| Form::Straight { length, slope: 0.0 };
        // The front joint in a long arc, the twelfth behind it on the straight.
        let one = CentreLine::new([0.0; 4], &[straight(40.0), Form::Arc { radius, turn: 6.0 }]);
        let transition = action(&one, 40.0 + 7.0) / unit;
        assert!((transition - 0.0113).abs() < 0.0006, "{transition}");
        let whole = |pitches: f64| {
            let turn = pitches * pitch / radius;
            let line = CentreLine::new([0.0; 4], &[straight(40.0), Form::Arc { radius, turn }, straight(40.0)]);
            action(&line, 40.0 + turn * radius + 2.0) / unit
        };
        let all: Vec<f64> = (0..20).map(|k| whole(4.0 + f64::from(k) / 20.0)).collect();
        let (least, most) = all.iter().fold((f64::MAX, 0.0), |(l, m), x| (x.min(l), x.max(m)));
        assert!(least < 0.003 && (most - 0.0226).abs() < 0.0004, "{least} {most}");
        assert!((whole(4.3) - whole(5.3)).abs() < 0.002);
    }

    #[test]
    fn too_many_chords_are_an_error() {
        let line = CentreLine::new([0.0; 4], &[Form::Arc { radius: 1.0, turn: trig::TAU }]);
        assert!(closing(&line, 2, 0.0).is_err());
    }
}
