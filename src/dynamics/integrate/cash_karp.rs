//! The thesis' integrator (§2.2): the embedded Runge-Kutta method of orders 5 and 4 of Cash and Karp (1990), with steps
//! adapted to a tolerance.
//!
//! Contacts keep their memory through the stages of a step and look at it anew at the step's end, so that a step taken
//! back leaves no trace.

use super::{Integrator, TooFine};
use crate::base::trig;
use crate::dynamics::chain::Chain;
use crate::dynamics::state::{Accelerations, Bodies, PACK};

/// Adaptive steps.
#[derive(Clone, Debug)]
pub struct CashKarp {
    /// Largest error of a step relative to the scales below.
    pub tolerance: f64,
    /// The next step to try, s.
    step: f64,
    /// Steps taken and taken back.
    pub accepted: u64,
    pub rejected: u64,
}

/// Sizes that errors are measured by: m, rad, m/s, rad/s.
const SCALES: [f64; 4] = [1e-3, 1e-3, 0.1, 0.1];

/// Shortest step, s.
const SHORTEST: f64 = 1e-9;

const WEIGHTS: [[f64; 5]; 5] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0],
    [3.0 / 10.0, -9.0 / 10.0, 6.0 / 5.0, 0.0, 0.0],
    [-11.0 / 54.0, 5.0 / 2.0, -70.0 / 27.0, 35.0 / 27.0, 0.0],
    [1631.0 / 55296.0, 175.0 / 512.0, 575.0 / 13824.0, 44275.0 / 110592.0, 253.0 / 4096.0],
];
const FIFTH: [f64; 6] = [37.0 / 378.0, 0.0, 250.0 / 621.0, 125.0 / 594.0, 0.0, 512.0 / 1771.0];
const FOURTH: [f64; 6] = [2825.0 / 27648.0, 0.0, 18575.0 / 48384.0, 13525.0 / 55296.0, 277.0 / 14336.0, 1.0 / 4.0];

impl CashKarp {
    pub fn new(tolerance: f64) -> Self {
        CashKarp { tolerance, step: 1e-4, accepted: 0, rejected: 0 }
    }
}

/// Time derivative of a pack.
#[derive(Clone, Copy)]
struct Rate {
    position: [[f64; PACK]; 3],
    attitude: [[f64; PACK]; 4],
    accelerations: Accelerations,
}

impl Integrator for CashKarp {
    fn advance(&mut self, chain: &mut Chain, duration: f64) -> Result<(), TooFine> {
        let mut left = duration;
        while left > 1e-12 * duration {
            let h = self.step.min(left);
            let begin = chain.state.bodies.clone();
            let mut rates = vec![derivative(&begin, &chain.accelerations)];
            for weights in &WEIGHTS {
                chain.state.bodies = moved(&begin, &rates, weights, h);
                chain.evaluate(false);
                rates.push(derivative(&chain.state.bodies, &chain.accelerations));
            }
            chain.state.bodies = moved(&begin, &rates, &FIFTH, h);
            let error = error(&rates, chain.model.carts, h) / self.tolerance;
            // NaN is an error too large.
            if error <= 1.0 {
                normalise(&mut chain.state.bodies);
                chain.evaluate(true);
                chain.time += h;
                left -= h;
                self.accepted += 1;
                let growth = 0.9 * trig::pow(error.max(1e-10), -0.2);
                // A step cut short by the end of the duration says little about the next.
                if h == self.step || growth < 1.0 {
                    self.step = h * growth.min(4.0);
                }
            } else {
                chain.state.bodies = begin;
                self.rejected += 1;
                let shrink = if error.is_finite() { 0.9 * trig::pow(error, -0.25) } else { 0.1 };
                self.step = h * shrink.max(0.1);
                if self.step < SHORTEST {
                    chain.evaluate(false);
                    return Err(TooFine { step: self.step });
                }
                chain.evaluate(false);
            }
        }
        Ok(())
    }

    fn steps(&self) -> u64 {
        self.accepted
    }
}

/// ẋ = v, q̇ = q ω / 2, and the accelerations.
fn derivative(bodies: &[Bodies], accelerations: &[Accelerations]) -> Vec<Rate> {
    let rate = |(b, a): (&Bodies, &Accelerations)| {
        let mut attitude = [[0.0; PACK]; 4];
        for lane in 0..PACK {
            let [w, i, j, k] = b.attitude.map(|row| row[lane]);
            let [x, y, z] = b.spin.map(|row| 0.5 * row[lane]);
            attitude[0][lane] = -(i * x + j * y + k * z);
            attitude[1][lane] = w * x + j * z - k * y;
            attitude[2][lane] = w * y + k * x - i * z;
            attitude[3][lane] = w * z + i * y - j * x;
        }
        Rate { position: b.velocity, attitude, accelerations: *a }
    };
    bodies.iter().zip(accelerations).map(rate).collect()
}

/// The state at `begin` plus h times the weighted rates.
fn moved(begin: &[Bodies], rates: &[Vec<Rate>], weights: &[f64], h: f64) -> Vec<Bodies> {
    let mut out = begin.to_vec();
    for (stage, weight) in rates.iter().zip(weights) {
        let factor = weight * h;
        if factor == 0.0 {
            continue;
        }
        for (bodies, rate) in out.iter_mut().zip(stage) {
            add(&mut bodies.position, &rate.position, factor);
            add(&mut bodies.attitude, &rate.attitude, factor);
            add(&mut bodies.velocity, &rate.accelerations.linear, factor);
            add(&mut bodies.spin, &rate.accelerations.angular, factor);
        }
    }
    out
}

fn add<const N: usize>(to: &mut [[f64; PACK]; N], rate: &[[f64; PACK]; N], factor: f64) {
    for (to, rate) in to.iter_mut().zip(rate) {
        for (to, rate) in to.iter_mut().zip(rate) {
            *to += factor * rate;
        }
    }
}

/// Largest difference between the two orders, in the scales; NaN when any is.
fn error(rates: &[Vec<Rate>], carts: usize, h: f64) -> f64 {
    let mut worst = 0.0;
    for place in 0..carts {
        let (pack, lane) = (place / PACK, place % PACK);
        let difference = |row: &dyn Fn(&Rate) -> f64, scale: f64| {
            let stages = rates.iter().zip(FIFTH).zip(FOURTH);
            (stages.map(|((rates, b5), b4)| (b5 - b4) * row(&rates[pack])).sum::<f64>() * h / scale).abs()
        };
        for k in 0..3 {
            for size in [
                difference(&|r| r.position[k][lane], SCALES[0]),
                difference(&|r| r.attitude[k + 1][lane], SCALES[1]),
                difference(&|r| r.accelerations.linear[k][lane], SCALES[2]),
                difference(&|r| r.accelerations.angular[k][lane], SCALES[3]),
            ] {
                // Not a comparison that NaN would pass.
                worst = if size <= worst { worst } else { size };
                if size.is_nan() {
                    return size;
                }
            }
        }
    }
    worst
}

fn normalise(bodies: &mut [Bodies]) {
    for b in bodies {
        for lane in 0..PACK {
            let length = b.attitude.iter().map(|row| row[lane] * row[lane]).sum::<f64>().sqrt();
            for row in &mut b.attitude {
                row[lane] /= length;
            }
        }
    }
}
