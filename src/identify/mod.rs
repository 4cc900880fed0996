//! The model's parameters from measurements.

pub mod static_test;
pub mod stiffness;
pub mod student;
