//! The contact law F = K δⁿ (1 + χ δ̇/v₀) + c δ̇ at wheels and joints (thesis §2.3; design: chain model, contact law).
//!
//! A contact remembers one over the approach speed v₀ of when it last closed, s/m. It is called fresh when it has
//! closed since the last look, and then remembers anew.

use super::lanes::{Lane, Mask};
use super::law::Damped;
use pulp::Simd;

/// A wheel and its surface: indentation, m, and its rate, m/s.
pub struct Side<S: Simd> {
    pub depth: Lane<S>,
    pub rate: Lane<S>,
}

/// Whether a wheel that was clear touches now.
#[inline(always)]
pub fn fresh_contact<S: Simd>(side: &Side<S>, memory: Lane<S>) -> Mask<S> {
    memory.constant(0.0).less(side.depth).and(memory.less(memory.constant(f64::MIN_POSITIVE)))
}

/// The memory, 0 where the wheel is clear.
#[inline(always)]
pub fn opened<S: Simd>(side: &Side<S>, memory: Lane<S>) -> Lane<S> {
    let zero = memory.constant(0.0);
    memory.select(zero.less(side.depth), zero)
}

/// δ^1.5, 0 where the wheel is clear: Hertz' exponent, which needs a root only.
#[inline(always)]
pub fn hertz<S: Simd>(side: &Side<S>) -> Lane<S> {
    let depth = clamped(side.depth);
    depth * depth.sqrt()
}

/// δⁿ, 0 where the wheel is clear.
#[inline(always)]
pub fn power<S: Simd>(side: &Side<S>, exponent: f64) -> Lane<S> {
    raised(clamped(side.depth), exponent)
}

/// Force of a surface on a wheel, N, at least 0; from δⁿ.
#[inline(always)]
pub fn contact<S: Simd>(law: &Damped, side: &Side<S>, power: Lane<S>, memory: Lane<S>) -> Lane<S> {
    let zero = memory.constant(0.0);
    let force = damped(law, power, side.rate, memory);
    force.select(zero.less(force).and(zero.less(side.depth)), zero)
}

#[inline(always)]
fn clamped<S: Simd>(depth: Lane<S>) -> Lane<S> {
    let zero = depth.constant(0.0);
    depth.select(zero.less(depth), zero)
}

/// A joint along one axis, which pulls and pushes without a clamp.
pub struct Joint<S: Simd> {
    /// Whether it is compressed: e > 0.
    pushes: Mask<S>,
    /// |e|, m
    size: Lane<S>,
    /// d|e|/dt, m/s
    growth: Lane<S>,
    /// Positive while the sign of e is the one remembered.
    pub memory: Lane<S>,
}

impl<S: Simd> Joint<S> {
    #[inline(always)]
    pub fn new(e: Lane<S>, rate: Lane<S>, memory: Lane<S>) -> Self {
        let pushes = e.constant(0.0).less(e);
        Joint { pushes, size: e.abs(), growth: rate.select(pushes, -rate), memory: memory.select(pushes, -memory) }
    }

    /// Takes half a play from the elongation.
    #[inline(always)]
    pub fn ease(&mut self, half: Lane<S>) {
        self.size = clamped(self.size - half);
    }

    /// With the sign of e.
    #[inline(always)]
    pub fn signed(&self, x: Lane<S>) -> Lane<S> {
        x.select(self.pushes, -x)
    }
}

/// Whether e has changed its sign.
#[inline(always)]
pub fn fresh_joint<S: Simd>(joint: &Joint<S>) -> Mask<S> {
    joint.memory.less(joint.memory.constant(f64::MIN_POSITIVE))
}

/// Force of a joint on its leader, N.
#[inline(always)]
pub fn joint<S: Simd>(law: &Damped, joint: &Joint<S>, memory: Lane<S>) -> Lane<S> {
    let power = if law.exponent == 1.0 { joint.size } else { raised(joint.size, law.exponent) };
    joint.signed(damped(law, power, joint.growth, memory))
}

/// One over the approach speed, floored, where a contact is fresh.
#[inline(always)]
pub fn refreshed<S: Simd>(fresh: Mask<S>, floor: f64, rate: Lane<S>, memory: Lane<S>) -> Lane<S> {
    let floor = rate.constant(floor);
    let approach = rate.select(floor.less(rate), floor);
    rate.constant(1.0).over(approach).select(fresh, memory)
}

/// K δⁿ (1 + χ δ̇/v₀) + c δ̇
#[inline(always)]
fn damped<S: Simd>(law: &Damped, power: Lane<S>, rate: Lane<S>, memory: Lane<S>) -> Lane<S> {
    let c = power.splat_like();
    let damping = (memory * c.of(law.factor)).mul_add(rate, c.of(1.0));
    (power * c.of(law.stiffness)).mul_add(damping, c.of(law.viscosity) * rate)
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
