//! Elementary functions, the same digits on every platform: everything here is libm in Rust.

pub use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

pub fn sin_cos(x: f64) -> (f64, f64) {
    (libm::sin(x), libm::cos(x))
}

pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

pub fn hypot(x: f64, y: f64) -> f64 {
    libm::hypot(x, y)
}

pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

pub fn log10(x: f64) -> f64 {
    libm::log10(x)
}

/// The angle's equal in (-π, π].
pub fn wrap(angle: f64) -> f64 {
    let turns = (angle / TAU).round();
    let wrapped = angle - turns * TAU;
    if wrapped <= -PI { wrapped + TAU } else { wrapped }
}

/// Natural logarithm.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// x to the power of y.
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

pub fn asinh(x: f64) -> f64 {
    libm::asinh(x)
}

pub fn tanh(x: f64) -> f64 {
    libm::tanh(x)
}
