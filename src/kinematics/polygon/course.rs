//! The centre line as straights and curves in turn.

use crate::base::trig;
use crate::geometry::{CentreLine, Form};
use std::fmt;

/// Curves that meet without a straight between them are this far apart, m: the straight still has a direction to
/// measure on.
pub(super) const TOUCHING: f64 = 1e-9;
/// Joints that one chain may have.
const MOST_JOINTS: f64 = 1e6;

/// A curve: what lies between two straights.
#[derive(Clone, Debug, PartialEq)]
pub struct Bend {
    /// In driving order; more than one piece where a ramp begins or a spiral climbs.
    pub forms: Vec<Form>,
    /// Arc length of the centre line where it begins, m.
    pub s: f64,
}

impl Bend {
    /// m
    pub fn length(&self) -> f64 {
        self.forms.iter().map(Form::length).sum()
    }
}

/// Straights and curves of a closed centre line in driving order: straight 0, curve 0, straight 1, curve 1, ...
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// Length (m) and slope (rise over run) of each straight; curve k lies ahead of straight k.
    pub straights: Vec<(f64, f64)>,
    /// Arc length of the centre line where each straight begins, m.
    pub begins: Vec<f64>,
    pub curves: Vec<Bend>,
}

/// Why a centre line has no polygon action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unsuited {
    /// There is no straight to start on.
    NoStraight,
    /// There is no curve.
    NoCurve,
    /// Lengths or radii that are not finite, or a cart without length.
    NotFinite,
    /// The track has room for more than a million carts.
    TooLong,
    /// The joint behind one at this arc length (m) cannot be found: the cart is too long for the curve.
    TooTight(f64),
}

impl fmt::Display for Unsuited {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Unsuited::NoStraight => write!(f, "polygon action is measured on straights, and the track has none"),
            Unsuited::NoCurve => write!(f, "the track has no curve, and so no polygon action"),
            Unsuited::NotFinite => write!(f, "the track's lengths or the cart's are not finite and positive"),
            Unsuited::TooLong => write!(f, "the track has room for more than a million carts"),
            Unsuited::TooTight(s) => write!(f, "a cart is too long for the curve near s = {s:.3} m"),
        }
    }
}

impl std::error::Error for Unsuited {}

impl Course {
    /// Takes a closed centre line apart. Pieces of one straight, also around arc length 0, and of one bend are joined;
    /// straight 0 is the one that arc length 0 lies on or, where a curve begins there, the first behind it.
    ///
    /// # Errors
    /// [`Unsuited::NoStraight`], [`Unsuited::NoCurve`], [`Unsuited::NotFinite`].
    pub fn new(line: &CentreLine) -> Result<Self, Unsuited> {
        let finite =
            |x: &crate::geometry::Stretch| x.length.is_finite() && x.begin.position.iter().all(|p| p.is_finite());
        if !line.stretches.iter().all(finite) || !line.length.is_finite() {
            return Err(Unsuited::NotFinite);
        }
        let straight = |form: &Form| matches!(form, Form::Straight { .. });
        let pieces: Vec<(Form, f64)> = line.stretches.iter().map(|p| (p.form, p.s)).collect();
        let n = pieces.len();
        // From a straight whose piece before is none; that before arc length 0 comes first.
        let begins = |k: usize| straight(&pieces[k].0) && !straight(&pieces[(k + n - 1) % n].0);
        if !pieces.iter().any(|p| straight(&p.0)) {
            return Err(Unsuited::NoStraight);
        }
        let first = match (0..n).find(|&k| begins(k)) {
            None => return Err(Unsuited::NoCurve),
            Some(_) if straight(&pieces[0].0) && !begins(0) => (0..n).rev().find(|&k| begins(k)).unwrap_or(0),
            Some(k) => k,
        };
        let mut course = Course { straights: Vec::new(), begins: Vec::new(), curves: Vec::new() };
        for k in 0..n {
            let (form, s) = pieces[(first + k) % n];
            course.take(form, s);
        }
        Ok(course)
    }

    fn take(&mut self, form: Form, s: f64) {
        let open = self.curves.len() < self.straights.len();
        match form {
            Form::Straight { length, slope } => match self.straights.last_mut() {
                // Directions are continuous: another piece of the same straight.
                Some((whole, _)) if open => *whole += length,
                _ => {
                    self.straights.push((length, slope));
                    self.begins.push(s);
                }
            },
            bend if open => self.curves.push(Bend { forms: vec![bend], s }),
            bend => match self.curves.last_mut() {
                Some(curve) if curve.forms.last().is_some_and(|last| goes_on(last, &bend)) => {
                    curve.forms.push(bend);
                }
                _ => {
                    self.straights.push((TOUCHING, trig::tan(bend.inclination().0)));
                    self.begins.push(s);
                    self.curves.push(Bend { forms: vec![bend], s });
                }
            },
        }
    }

    /// Number of straights, and of curves.
    pub fn len(&self) -> usize {
        self.curves.len()
    }

    pub fn is_empty(&self) -> bool {
        self.curves.is_empty()
    }

    /// m
    pub fn length(&self) -> f64 {
        self.straights.iter().map(|s| s.0).sum::<f64>() + self.curves.iter().map(Bend::length).sum::<f64>()
    }

    /// Whether carts of this length are worth a try.
    pub(super) fn takes(&self, pitch: f64) -> Result<(), Unsuited> {
        if !(pitch.is_finite() && pitch > 0.0) {
            return Err(Unsuited::NotFinite);
        }
        if self.length() / pitch > MOST_JOINTS {
            return Err(Unsuited::TooLong);
        }
        Ok(())
    }
}

/// Whether a bend is the same curve as the one before it: a piece of the same arc, or a change between plan and slope.
fn goes_on(before: &Form, bend: &Form) -> bool {
    let plan = |form: &Form| match *form {
        Form::Arc { radius, turn } | Form::Spiral { radius, turn, .. } => Some((radius, turn > 0.0)),
        Form::Straight { .. } | Form::Vertical { .. } => None,
    };
    match (plan(before), plan(bend)) {
        (Some((a, left)), Some((b, also))) => (a - b).abs() < 1e-9 * a.abs() && left == also,
        (None, None) => false,
        _ => true,
    }
}
