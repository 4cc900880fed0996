//! What the track puts on its supports.

/// Reaction of one support over a lap: least and largest load, N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportLoad {
    /// Arc length of the support, m.
    pub s: f64,
    /// Downwards.
    pub vertical: (f64, f64),
    /// To the left of travel.
    pub lateral: (f64, f64),
    /// In driving direction.
    pub longitudinal: (f64, f64),
}
