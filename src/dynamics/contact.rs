//! The contact law F = K δⁿ (1 + χ δ̇/v₀) + c δ̇ at wheels and joints (thesis §2.3; design: chain model, contact law).
//!
//! A contact remembers one over the approach speed v₀ of when it last closed, s/m. It is called fresh when it has
//! closed since the last look, and then remembers anew.

use super::lanes::{Lane, Mask};
use super::law::Damped;
use pulp::{Simd, WithSimd};

/// A wheel between two surfaces, which it meets at most one of.
pub struct Between<S: Simd> {
    /// From the middle between the surfaces, m.
    offset: Lane<S>,
    /// Indentation of the surface that is nearer, m; less than 0 where the wheel is clear.
    depth: Lane<S>,
    /// Of the indentation, m/s.
    rate: Lane<S>,
    touches: Mask<S>,
}

impl<S: Simd> Between<S> {
    /// At an offset, m, from the middle of surfaces that are `half` to either side, m; and its rate, m/s.
    #[inline(always)]
    pub fn new(offset: Lane<S>, rate: Lane<S>, half: f64) -> Self {
        let depth = offset.abs() - offset.constant(half);
        let touches = depth.constant(0.0).less(depth);
        Between { offset, depth, rate: rate.times_sign_of(offset), touches }
    }

    /// Approach speed, m/s.
    #[inline(always)]
    pub fn rate(&self) -> Lane<S> {
        self.rate
    }

    /// Whether a wheel that was clear touches now.
    #[inline(always)]
    pub fn fresh(&self, memory: Lane<S>) -> Mask<S> {
        self.touches.and(memory.less(memory.constant(f64::MIN_POSITIVE)))
    }

    /// The memory, 0 where the wheel is clear.
    #[inline(always)]
    pub fn opened(&self, memory: Lane<S>) -> Lane<S> {
        memory.select(self.touches, memory.constant(0.0))
    }

    /// Indentation, m, 0 where the wheel is clear.
    #[inline(always)]
    pub fn indentation(&self) -> Lane<S> {
        self.depth.select(self.touches, self.depth.constant(0.0))
    }

    /// Force of the surface, N, at least 0, and how it is damped, N s/m; from δⁿ.
    #[inline(always)]
    pub fn force(&self, law: &Damped, power: Lane<S>, memory: Lane<S>) -> [Lane<S>; 2] {
        let zero = memory.constant(0.0);
        let [force, damping] = damped(law, power, self.rate, memory);
        let pushes = zero.less(force).and(self.touches);
        [force.select(pushes, zero), damping.select(pushes, zero)]
    }

    /// What pushes the wheel back to the middle: less than 0 where it is on the side of positive offsets.
    #[inline(always)]
    pub fn back(&self, force: Lane<S>) -> Lane<S> {
        (-force).times_sign_of(self.offset)
    }
}

/// δ^1.5: Hertz' exponent, which needs a root only.
#[inline(always)]
pub fn hertz<S: Simd>(depth: Lane<S>) -> Lane<S> {
    depth * depth.sqrt()
}

/// δⁿ of three, with any exponents: for laws that are rare.
pub struct Powers<S: Simd>(pub [Lane<S>; 3], pub [f64; 3]);

impl<S: Simd> WithSimd for Powers<S> {
    type Output = [Lane<S>; 3];

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) -> Self::Output {
        let Powers([a, b, c], exponents) = self;
        [raised(a, exponents[0]), raised(b, exponents[1]), raised(c, exponents[2])]
    }
}

/// Elongations of a joint, eased by half a play and raised to their exponents, each with its sign: for laws that are
/// rare.
pub struct Stretched<S: Simd> {
    /// m
    pub e: [Lane<S>; 3],
    /// m
    pub half_play: f64,
    pub exponents: [f64; 3],
}

impl<S: Simd> WithSimd for Stretched<S> {
    type Output = [Lane<S>; 3];

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) -> Self::Output {
        let mut out = self.e;
        for (e, exponent) in out.iter_mut().zip(self.exponents) {
            let zero = e.constant(0.0);
            let size = e.abs() - e.constant(self.half_play);
            *e = raised(size.select(zero.less(size), zero), exponent).times_sign_of(*e);
        }
        out
    }
}

/// Whether an elongation, m, has changed its sign since it was remembered.
#[inline(always)]
pub fn turned_over<S: Simd>(e: Lane<S>, memory: Lane<S>) -> Mask<S> {
    (e * memory).less(e.constant(f64::MIN_POSITIVE))
}

/// One over three approach speeds, each floored, s/m: all with one division.
#[inline(always)]
pub fn one_over<S: Simd>(floor: f64, rates: [Lane<S>; 3]) -> [Lane<S>; 3] {
    let floor = rates[0].constant(floor);
    let a = rates[0].select(floor.less(rates[0]), floor);
    let b = rates[1].select(floor.less(rates[1]), floor);
    let c = rates[2].select(floor.less(rates[2]), floor);
    let bc = b * c;
    let inverse = a.constant(1.0).over(a * bc);
    let of_a = inverse * a;
    [inverse * bc, of_a * c, of_a * b]
}

/// K δⁿ (1 + χ δ̇/v₀) + c δ̇, N, and its derivative by δ̇, N s/m. At a joint, which pulls and pushes without a clamp, δⁿ
/// and the memory have the elongation's sign, and so has the force.
#[inline(always)]
pub fn damped<S: Simd>(law: &Damped, power: Lane<S>, rate: Lane<S>, memory: Lane<S>) -> [Lane<S>; 2] {
    let c = power.splat_like();
    let elastic = power * c.of(law.stiffness);
    let mut damping = memory * c.of(law.factor) * elastic;
    if law.viscosity != 0.0 {
        damping = damping + c.of(law.viscosity);
    }
    [rate.mul_add(damping, elastic), damping]
}

#[inline(always)]
fn raised<S: Simd>(x: Lane<S>, exponent: f64) -> Lane<S> {
    if exponent == 1.5 {
        x * x.sqrt()
    } else if exponent == 1.0 {
        x
    } else {
        x.map(|x| crate::base::trig::pow(x, exponent))
    }
}
