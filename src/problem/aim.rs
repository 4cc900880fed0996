//! What a problem minimises: the track's length or, beside it, waves that curves send along the chain.
//!
//! With turns and radii held, a curve's polygon action is a constant: its harmonics, each an amplitude and a phase.
//! What varies is the length of the straights between, which turns them against each other (thesis §3.4).

use super::Expansion;
use super::measures::Measures;
use crate::base::trig;
use nalgebra::Complex;

/// Harmonics that are counted: the second and third matter once the first ones have cancelled.
pub const HARMONICS: usize = 3;

/// The objective of a problem.
#[derive(Clone, Debug, Default)]
pub enum Aim {
    /// Length of the track, m.
    #[default]
    Length,
    /// Polygon action, m of track that it is worth.
    Waves(Waves),
    /// Half the squared distance (m²) of the coordinates from those of another layout, per metre.
    Near(Vec<f64>),
}

/// A curve as the chain meets it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wave {
    /// Complex amplitudes of the deviation behind the curve, over the place of a joint past its front end, mm.
    pub harmonics: [Complex<f64>; HARMONICS],
    /// From its front end to its rear end as the lattice of joints passes it: its length less what chords cut off, m.
    pub length: f64,
}

/// The polygon action of a layout whose turns and radii are held.
#[derive(Clone, Debug)]
pub struct Waves {
    /// Length of a cart, m.
    pub pitch: f64,
    /// Curve k is the fillet of the vertex at the end of section k.
    pub curves: Vec<Wave>,
    /// Whether the straight behind this many curves (less one) counts.
    pub counts: Vec<bool>,
    /// What 1 mm² is worth, m.
    pub worth: f64,
    /// What 1 m of track counts beside it.
    pub length: f64,
}

/// A value with its derivatives by the phase of each curve.
struct ByPhase {
    value: f64,
    gradient: Vec<f64>,
    /// Row-major.
    hessian: Vec<f64>,
}

impl Waves {
    /// Σ over what counts of the squared peak to peak, mm², from the lengths of the straights, m. A harmonic of
    /// amplitude a counts (2a)².
    pub fn value(&self, straights: &[f64]) -> f64 {
        let places = self.places(straights);
        (0..HARMONICS).map(|h| self.sums(&self.turned(&places.0, h), places.1, h, |_, _, _| {})).sum()
    }

    /// Distance that each curve's front end lies behind curve 0's in the lattice of joints, m, walking backwards, and
    /// that once around.
    fn places(&self, straights: &[f64]) -> (Vec<f64>, f64) {
        let n = self.curves.len();
        let mut places = vec![0.0; n];
        let mut x = 0.0;
        for m in 0..n {
            let k = (n - m) % n;
            places[k] = x;
            x += self.curves[k].length + straights[k];
        }
        (places, x)
    }

    /// Each curve's harmonic at its place.
    fn turned(&self, places: &[f64], h: usize) -> Vec<Complex<f64>> {
        let wave = trig::TAU * (h + 1) as f64 / self.pitch;
        let turn = |(curve, x): (&Wave, &f64)| {
            let (sin, cos) = trig::sin_cos(wave * x);
            curve.harmonics[h] * Complex::new(cos, sin)
        };
        self.curves.iter().zip(places).map(turn).collect()
    }

    /// Σ |2H|² over what counts; `each` sees every sum H that counts with its first curve and number of curves.
    fn sums(
        &self,
        parts: &[Complex<f64>],
        around: f64,
        h: usize,
        mut each: impl FnMut(usize, usize, Complex<f64>),
    ) -> f64 {
        let n = parts.len();
        let once = phase(trig::TAU * (h + 1) as f64 / self.pitch * around);
        let mut value = 0.0;
        for first in 0..n {
            let mut sum = Complex::default();
            for m in 0..n {
                sum += self.part(parts, once, first, m);
                if self.counts[m] {
                    value += 4.0 * sum.norm_sqr();
                    each(first, m, sum);
                }
            }
        }
        value
    }

    /// The m-th curve behind `first`: behind curve 0 the chain has gone around.
    fn part(&self, parts: &[Complex<f64>], once: Complex<f64>, first: usize, m: usize) -> Complex<f64> {
        let n = parts.len();
        let k = (first + n - m) % n;
        // Curve 0 has the least place, and n − 1 follows it.
        let wrapped = first != 0 && (k == 0 || k > first);
        if wrapped { parts[k] * once } else { parts[k] }
    }

    fn wraps(&self, first: usize, k: usize) -> bool {
        first != 0 && (k == 0 || k > first)
    }

    /// By the phases of the curves, and of once around in the last place.
    fn by_phase(&self, straights: &[f64]) -> ByPhase {
        let n = self.curves.len();
        let (places, around) = self.places(straights);
        let size = n + 1;
        let mut out = ByPhase { value: 0.0, gradient: vec![0.0; size], hessian: vec![0.0; size * size] };
        for h in 0..HARMONICS {
            let parts = self.turned(&places, h);
            let once = phase(trig::TAU * (h + 1) as f64 / self.pitch * around);
            // Phases of the h-th harmonic are h times those of the first.
            let times = (h + 1) as f64;
            let (mut gradient, mut hessian) = (vec![0.0; size], vec![0.0; size * size]);
            let value = self.sums(&parts, around, h, |first, m, sum| {
                // Slopes of the sum: i p by a curve's phase, and by that of once around for those behind curve 0.
                let mut slopes = vec![Complex::new(0.0, 0.0); size];
                let turned = Complex::new(0.0, times);
                for behind in 0..=m {
                    let k = (first + n - behind) % n;
                    let p = self.part(&parts, once, first, behind);
                    slopes[k] += turned * p;
                    let bent = 8.0 * times * times * (sum.re * p.re + sum.im * p.im);
                    hessian[k * size + k] -= bent;
                    if self.wraps(first, k) {
                        slopes[n] += turned * p;
                        hessian[n * size + n] -= bent;
                        hessian[k * size + n] -= bent;
                        hessian[n * size + k] -= bent;
                    }
                }
                for a in 0..size {
                    gradient[a] += 8.0 * (sum.re * slopes[a].re + sum.im * slopes[a].im);
                    for b in 0..size {
                        hessian[a * size + b] += 8.0 * (slopes[b].re * slopes[a].re + slopes[b].im * slopes[a].im);
                    }
                }
            });
            out.value += value;
            out.gradient.iter_mut().zip(&gradient).for_each(|(o, g)| *o += g);
            out.hessian.iter_mut().zip(&hessian).for_each(|(o, g)| *o += g);
        }
        out
    }

    /// The objective with its derivatives by all variables.
    pub fn expand(&self, measures: &Measures) -> Vec<Expansion> {
        let n = self.curves.len();
        let straights: Vec<Expansion> = (0..n).map(|k| measures.straight(k)).collect();
        let lengths: Vec<f64> = straights.iter().map(|s| s.value).collect();
        let own = self.by_phase(&lengths);
        let wave = trig::TAU / self.pitch;
        // Phases are sums of straights: curve k's of those behind curves 0, n − 1, ..., k + 1; the last of all.
        let mut by_straight = ByPhase { value: own.value, gradient: vec![0.0; n], hessian: vec![0.0; n * n] };
        let within = |phase: usize, straight: usize| phase == n || (phase != 0 && (straight == 0 || straight > phase));
        for a in 0..=n {
            for s in (0..n).filter(|s| within(a, *s)) {
                by_straight.gradient[s] += wave * own.gradient[a];
                for b in 0..=n {
                    for t in (0..n).filter(|t| within(b, *t)) {
                        by_straight.hessian[s * n + t] += wave * wave * own.hessian[a * (n + 1) + b];
                    }
                }
            }
        }
        let mut terms = vec![composed(&by_straight, &straights, 3 * n, self.worth)];
        if self.length > 0.0 {
            terms.extend(measures.track_length().iter().map(|e| e.scale(self.length)));
        }
        terms
    }
}

/// e^{iφ}
fn phase(angle: f64) -> Complex<f64> {
    let (sin, cos) = trig::sin_cos(angle);
    Complex::new(cos, sin)
}

/// f(inner(x)) over all `size` variables, times `worth`.
fn composed(outer: &ByPhase, inner: &[Expansion], size: usize, worth: f64) -> Expansion {
    let mut out = Expansion {
        value: worth * outer.value,
        variables: (0..size).collect(),
        gradient: vec![0.0; size],
        hessian: vec![0.0; size * size],
    };
    let n = inner.len();
    for (a, e) in inner.iter().enumerate() {
        let slope = worth * outer.gradient[a];
        let own = e.variables.len();
        for (i, &v) in e.variables.iter().enumerate() {
            out.gradient[v] += slope * e.gradient[i];
            for (j, &w) in e.variables.iter().enumerate() {
                out.hessian[v * size + w] += slope * e.hessian[i * own + j];
            }
        }
        for (b, f) in inner.iter().enumerate() {
            let bend = worth * outer.hessian[a * n + b];
            for (&v, g) in e.variables.iter().zip(&e.gradient) {
                for (&w, k) in f.variables.iter().zip(&f.gradient) {
                    out.hessian[v * size + w] += bend * g * k;
                }
            }
        }
    }
    out
}

/// ½ Σ (x − there)² over the coordinates.
pub(super) fn near(variables: &[f64], there: &[f64]) -> Vec<Expansion> {
    let coordinates = variables.iter().zip(there).enumerate().filter(|(k, _)| k % 3 != 2);
    let term = |(k, (x, y)): (usize, (&f64, &f64))| {
        let off = x - y;
        Expansion { value: 0.5 * off * off, variables: vec![k], gradient: vec![off], hessian: vec![1.0] }
    };
    coordinates.map(term).collect()
}
