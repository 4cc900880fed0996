//! The contact law F = K δⁿ (1 + χ δ̇/v₀) + c δ̇ at wheels and joints (thesis §2.3; design: chain model, contact law).

use super::lanes::{Lane, Mask};
use super::law::Damped;
use pulp::Simd;

/// Indentation, m, and its rate, m/s.
pub struct Side<S: Simd> {
    pub depth: Lane<S>,
    pub rate: Lane<S>,
}

/// A wheel on its surface: force, N, at least 0, and one over the approach speed to remember, 0 where open.
#[inline(always)]
pub fn contact<S: Simd>(law: &Damped, floor: f64, side: Side<S>, memory: Lane<S>) -> (Lane<S>, Lane<S>) {
    let zero = memory.constant(0.0);
    let closed = zero.less(side.depth);
    let fresh = closed.and(memory.less(memory.constant(f64::MIN_POSITIVE)));
    let memory = refreshed(fresh, floor, side.rate, memory);
    let depth = side.depth.select(closed, zero);
    let force = damped(law, depth, side.rate, memory);
    (force.select(zero.less(force).and(closed), zero), memory.select(closed, zero))
}

/// A joint along one axis: its force on the leader, N, and what to remember. It pulls and pushes, without a clamp.
#[inline(always)]
pub fn joint<S: Simd>(law: &Damped, floor: f64, e: Lane<S>, rate: Lane<S>, memory: Lane<S>) -> (Lane<S>, Lane<S>) {
    let zero = e.constant(0.0);
    let pushes = zero.less(e);
    let size = e.abs();
    let growth = rate.select(pushes, -rate);
    // The memory's sign is that of the elongation it belongs to.
    let own = memory.select(pushes, -memory);
    let fresh = own.less(e.constant(f64::MIN_POSITIVE));
    let own = refreshed(fresh, floor, rate.abs(), own);
    let force = damped(law, size, growth, own);
    (force.select(pushes, -force), own.select(pushes, -own))
}

/// K δⁿ (1 + χ δ̇/v₀) + c δ̇
#[inline(always)]
fn damped<S: Simd>(law: &Damped, depth: Lane<S>, rate: Lane<S>, memory: Lane<S>) -> Lane<S> {
    let c = depth.splat_like();
    let spring = power(law.exponent, depth) * c.of(law.stiffness);
    let damping = (memory * c.of(law.factor)).mul_add(rate, c.of(1.0));
    if law.viscosity == 0.0 { spring * damping } else { spring.mul_add(damping, c.of(law.viscosity) * rate) }
}

/// One over the approach speed, floored, where a contact has just closed.
#[inline(always)]
fn refreshed<S: Simd>(fresh: Mask<S>, floor: f64, rate: Lane<S>, memory: Lane<S>) -> Lane<S> {
    if fresh.any() {
        let floor = rate.constant(floor);
        let approach = rate.select(floor.less(rate), floor);
        rate.constant(1.0).over(approach).select(fresh, memory)
    } else {
        memory
    }
}

#[inline(always)]
fn power<S: Simd>(exponent: f64, x: Lane<S>) -> Lane<S> {
    if exponent == 1.5 {
        x * x.sqrt()
    } else if exponent == 1.0 {
        x
    } else {
        x.map(|x| crate::geometry::trig::pow(x, exponent))
    }
}
