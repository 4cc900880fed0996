//! The open chain: joints laid backwards from a starting straight, each a straight chord behind the one before.
//!
//! The centre line is unrolled once around, from the starting straight back to itself, so that nothing wraps. Only what
//! lies behind the first joint matters, and so the starting straight may be taken to go on ahead of it; in the same way
//! a straight that is shorter than a cart, on which some phases have no joint, is measured on its line produced
//! backwards. The chain itself stays on the track.

use super::{Course, Unsuited};
use crate::geometry::{CentreLine, Form};

/// Newton converges in three or four steps from the arc length's pitch.
const ITERATIONS: usize = 50;
/// Positions are good to some 1e-14 m; convergence is quadratic.
const CLOSE: f64 = 1e-12;

/// The course from the starting straight (the last piece) backwards to the straight behind some curves (the first
/// piece).
pub struct Unrolled {
    pub line: CentreLine,
    /// Index of the piece that is the straight behind one curve, two curves, ...
    pub straights: Vec<usize>,
    /// Index in the course of each piece's straight or curve, and whether it is a curve.
    pub parts: Vec<(usize, bool)>,
    /// Arc length of the course where the starting straight begins, m.
    start: f64,
}

/// A joint: the piece it rides on and its distance from that piece's begin, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPosition {
    pub piece: usize,
    pub d: f64,
}

/// A joint on the straight behind a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Index in [`Ride::joints`] of the joint that it hangs on.
    pub behind: usize,
    pub joint: JointPosition,
    /// Its arc length less that of the first joint and the carts between, m.
    pub deviation: f64,
}

/// A chain at one place of its first joint.
pub struct Ride {
    /// From the first joint on; of the joints on one straight the first and last only.
    pub joints: Vec<JointPosition>,
    /// One a curve.
    pub landings: Vec<Landing>,
}

impl Unrolled {
    /// Straight `start` of the course, and `curves` curves behind it with their straights.
    pub fn new(course: &Course, start: usize, curves: usize) -> Self {
        let n = course.len();
        let straight = |k: usize| {
            let (length, slope) = course.straights[k];
            Form::Straight { length, slope }
        };
        let (mut forms, mut parts, mut straights) = (Vec::new(), Vec::new(), Vec::new());
        for m in (1..=curves).rev() {
            let k = (start + n - m % n) % n;
            straights.push(forms.len());
            forms.push(straight(k));
            parts.push((k, false));
            for form in &course.curves[k].forms {
                forms.push(*form);
                parts.push((k, true));
            }
        }
        forms.push(straight(start));
        parts.push((start, false));
        straights.reverse();
        Unrolled { line: CentreLine::new([0.0; 4], &forms), straights, parts, start: course.begins[start] }
    }

    /// The chain with its first joint at `front` (m) past the begin of the starting straight, down to the last
    /// straight.
    pub fn ride(&self, pitch: f64, front: f64) -> Result<Ride, Unsuited> {
        let stretches = &self.line.stretches;
        let last = stretches.len() - 1;
        let begin = stretches[last].s + front;
        let mut joint = JointPosition { piece: last, d: front };
        let mut carts = 0.0;
        let mut joints = vec![joint];
        let mut landings: Vec<Landing> = Vec::with_capacity(self.straights.len());
        while landings.len() < self.straights.len() {
            if matches!(stretches[joint.piece].form, Form::Straight { .. }) && joint.d >= pitch {
                let whole = (joint.d / pitch).floor();
                joint.d -= whole * pitch;
                carts += whole;
                joints.push(joint);
            }
            let tight = Unsuited::TooTight(self.start + stretches[joint.piece].s + joint.d - stretches[last].s);
            let next = self.behind(joint, pitch, None).ok_or(tight)?;
            while let Some(&piece) = self.straights.get(landings.len()) {
                if piece < next.piece {
                    break;
                }
                let on =
                    if piece == next.piece { next } else { self.behind(joint, pitch, Some(piece)).ok_or(tight)? };
                let deviation = stretches[piece].s + on.d - begin + (carts + 1.0) * pitch;
                landings.push(Landing { behind: joints.len() - 1, joint: on, deviation });
            }
            joint = next;
            carts += 1.0;
            joints.push(joint);
        }
        Ok(Ride { joints, landings })
    }

    /// The joint one chord behind: on the track, or on the line of one piece produced.
    fn behind(&self, ahead: JointPosition, pitch: f64, line: Option<usize>) -> Option<JointPosition> {
        let stretches = &self.line.stretches;
        let from = stretches[ahead.piece].at(ahead.d).position;
        let mut s = stretches[ahead.piece].s + ahead.d - pitch;
        let mut piece = line.unwrap_or(ahead.piece);
        for _ in 0..ITERATIONS {
            if line.is_none() {
                while piece > 0 && s < stretches[piece].s {
                    piece -= 1;
                }
                while piece < ahead.piece && s >= stretches[piece].s + stretches[piece].length {
                    piece += 1;
                }
            }
            let at = stretches[piece].at(s - stretches[piece].s);
            let chord = from - at.position;
            let distance = chord.norm();
            let step = (distance - pitch) * distance / chord.dot(&at.tangent);
            // A chord never spans more than half a turn's arc of itself.
            if !step.is_finite() || step.abs() > 2.0 * pitch {
                return None;
            }
            s += step;
            if step.abs() < CLOSE {
                return Some(JointPosition { piece, d: s - stretches[piece].s });
            }
        }
        None
    }
}
