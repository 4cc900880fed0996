//! Exact derivatives of a few variables: a value with its gradient and Hessian, carried through arithmetic
//! (second-order forward differentiation, Griewank and Walther 2008, ch. 13).
//!
//! Written here, because values go through [`trig`](crate::base::trig), so that derivatives are the same digits on
//! every platform; a row's few variables fit in an array.

use crate::base::trig;
use std::ops::{Add, Mul, Neg, Sub};

/// A number that depends on `N` local variables, to second order.
#[derive(Clone, Copy, Debug)]
pub struct Jet<const N: usize> {
    pub value: f64,
    pub gradient: [f64; N],
    pub hessian: [[f64; N]; N],
}

impl<const N: usize> Jet<N> {
    pub fn constant(value: f64) -> Self {
        Jet { value, gradient: [0.0; N], hessian: [[0.0; N]; N] }
    }

    /// The local variable `i` at `value`.
    pub fn variable(value: f64, i: usize) -> Self {
        let mut jet = Jet::constant(value);
        jet.gradient[i] = 1.0;
        jet
    }

    /// f(self) from f and its first two derivatives at `self.value`.
    pub fn chain(&self, f: f64, f1: f64, f2: f64) -> Self {
        let mut out = Jet::constant(f);
        for i in 0..N {
            out.gradient[i] = f1 * self.gradient[i];
            for j in 0..N {
                out.hessian[i][j] = f1 * self.hessian[i][j] + f2 * self.gradient[i] * self.gradient[j];
            }
        }
        out
    }

    pub fn sqrt(&self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root, -0.25 / (root * self.value))
    }

    pub fn reciprocal(&self) -> Self {
        let r = 1.0 / self.value;
        self.chain(r, -r * r, 2.0 * r * r * r)
    }

    pub fn tan(&self) -> Self {
        let t = trig::tan(self.value);
        let slope = 1.0 + t * t;
        self.chain(t, slope, 2.0 * t * slope)
    }

    /// The unit vector in the direction of this angle.
    pub fn unit(&self) -> Vector<N> {
        let (sin, cos) = trig::sin_cos(self.value);
        Vector { x: self.chain(cos, -sin, -cos), y: self.chain(sin, cos, -sin) }
    }

    /// The same derivatives at another value.
    pub fn shift(mut self, by: f64) -> Self {
        self.value += by;
        self
    }

    pub fn scale(&self, k: f64) -> Self {
        self.chain(self.value * k, k, 0.0)
    }

    /// atan2(self, x): the angle of the vector (x, self).
    pub fn atan2(&self, x: &Self) -> Self {
        let (v, u) = (self.value, x.value);
        let r2 = u * u + v * v;
        let (fv, fu) = (u / r2, -v / r2);
        let (fvv, fuv) = (-2.0 * u * v / (r2 * r2), (v * v - u * u) / (r2 * r2));
        let mut out = Jet::constant(trig::atan2(v, u));
        for i in 0..N {
            let (vi, ui) = (self.gradient[i], x.gradient[i]);
            out.gradient[i] = fv * vi + fu * ui;
            for j in 0..N {
                let (vj, uj) = (self.gradient[j], x.gradient[j]);
                out.hessian[i][j] = fv * self.hessian[i][j]
                    + fu * x.hessian[i][j]
                    + fvv * (vi * vj - ui * uj)
                    + fuv * (vi * uj + ui * vj);
            }
        }
        out
    }
}

impl<const N: usize> Add for Jet<N> {
    type Output = Self;
    fn add(mut self, o: Self) -> Self {
        self.value += o.value;
        for i in 0..N {
            self.gradient[i] += o.gradient[i];
            for j in 0..N {
                self.hessian[i][j] += o.hessian[i][j];
            }
        }
        self
    }
}

impl<const N: usize> Neg for Jet<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.scale(-1.0)
    }
}

impl<const N: usize> Sub for Jet<N> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl<const N: usize> Mul for Jet<N> {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let mut out = Jet::constant(self.value * o.value);
        for i in 0..N {
            out.gradient[i] = self.value * o.gradient[i] + o.value * self.gradient[i];
            for j in 0..N {
                out.hessian[i][j] = self.value * o.hessian[i][j]
                    + o.value * self.hessian[i][j]
                    + self.gradient[i] * o.gradient[j]
                    + self.gradient[j] * o.gradient[i];
            }
        }
        out
    }
}

/// A plane vector of jets.
#[derive(Clone, Copy, Debug)]
pub struct Vector<const N: usize> {
    pub x: Jet<N>,
    pub y: Jet<N>,
}

impl<const N: usize> Vector<N> {
    pub fn dot(&self, o: &Self) -> Jet<N> {
        self.x * o.x + self.y * o.y
    }

    pub fn cross(&self, o: &Self) -> Jet<N> {
        self.x * o.y - self.y * o.x
    }

    pub fn norm(&self) -> Jet<N> {
        self.dot(self).sqrt()
    }

    pub fn left(&self) -> Self {
        Vector { x: -self.y, y: self.x }
    }

    pub fn times(&self, k: &Jet<N>) -> Self {
        Vector { x: self.x * *k, y: self.y * *k }
    }
}

impl<const N: usize> Add for Vector<N> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Vector { x: self.x + o.x, y: self.y + o.y }
    }
}

impl<const N: usize> Sub for Vector<N> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Vector { x: self.x - o.x, y: self.y - o.y }
    }
}
