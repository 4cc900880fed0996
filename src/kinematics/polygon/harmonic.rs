//! First harmonics: a curve's polygon action as amplitude and phase.
//!
//! A curve maps the lattice of joints ahead of it to the lattice behind it, shifted by a small periodic function of
//! where the lattice stands. Deviations (millimetres) are small against the cart, so that harmonics of curves in series
//! add up like alternating currents, each turned by its phase; [`superposed`] does that, and tests hold it against
//! [`action`].
//!
//! [`action`]: super::action

use super::chain::Unrolled;
use super::{Course, STEPS, Unsuited, deviations, straight_behind};
use crate::base::trig;
use nalgebra::Complex;

/// A complex amplitude, m.
pub type Phasor = Complex<f64>;

/// A curve by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePhasor {
    /// First harmonic of the deviation behind it, over the way of a joint from the curve's front end, m.
    pub first: Phasor,
    /// The second and third, m.
    pub higher: [Phasor; 2],
    /// Mean deviation, m: negative, because chords are shorter than their arcs.
    pub mean: f64,
    /// Peak to peak, m.
    pub delta_p: f64,
}

/// Amplitude and phase of a periodic series: x ≈ Re(H e^{iφ}) about its mean.
pub fn first(series: &[f64; STEPS]) -> Phasor {
    harmonic(series, 1)
}

/// The same of a multiple of its frequency.
fn harmonic(series: &[f64; STEPS], order: usize) -> Phasor {
    let mut sum = Phasor::default();
    for (step, x) in series.iter().enumerate() {
        sum += turned(-trig::TAU * (order * step) as f64 / STEPS as f64) * *x;
    }
    sum * (2.0 / STEPS as f64)
}

/// e^{iφ}
pub fn turned(angle: f64) -> Phasor {
    let (sin, cos) = trig::sin_cos(angle);
    Complex::new(cos, sin)
}

/// What curve `k` of the course does alone.
///
/// # Errors
/// [`Unsuited::TooTight`] where a cart does not fit it.
pub fn curve_phasor(course: &Course, k: usize, pitch: f64) -> Result<CurvePhasor, Unsuited> {
    course.takes(pitch)?;
    let n = course.len();
    let series = deviations(&Unrolled::new(course, (k + 1) % n, 1), pitch)?;
    let Some(series) = series.first() else { return Err(Unsuited::NoCurve) };
    let (low, high) = series.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
    Ok(CurvePhasor {
        first: first(series),
        higher: [2, 3].map(|order| harmonic(series, order)),
        mean: series.iter().sum::<f64>() / STEPS as f64,
        delta_p: high - low,
    })
}

/// First harmonics of every straight from every start (as [`super::Action::first`]) with each curve's part:
/// `[start][passed − 1]` is the phasor of the `passed`-th curve at its place.
pub fn superposed(course: &Course, curves: &[CurvePhasor], pitch: f64) -> Vec<Vec<Phasor>> {
    let n = course.len();
    (0..n)
        .map(|i| {
            let mut x = 0.0;
            (1..=n)
                .map(|m| {
                    let k = straight_behind(i, m, n);
                    // Joints of this lattice lie x + φ past the curve's front end.
                    let part = curves[k].first * turned(trig::TAU * x / pitch);
                    x += curves[k].mean + course.curves[k].length() + course.straights[k].0;
                    part
                })
                .collect()
        })
        .collect()
}
