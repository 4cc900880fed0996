//! Which cart length a simulation used, and why when that is not the product line's.

use crate::base::number::{tenths_of_mm, trimmed};
use crate::chain_input::Simulation;
use crate::dynamics::Outcome;
use crate::kinematics::{Fit, left_over};
use serde::Serialize;

/// The carts' length in the simulation beside the product line's.
#[derive(Debug, Serialize)]
pub struct CartLength {
    /// What was simulated: the length in which the chain closes under its tension, m.
    used_m: f64,
    /// m
    product_line_m: f64,
    /// What carts of the product line lack to close, m; `None` where no chain closes.
    left_over_m: Option<f64>,
    /// m
    take_up_m: Option<f64>,
    /// Whether the take-up compensates that; `None` where it is not known.
    fits: Option<bool>,
    why: String,
}

impl CartLength {
    pub fn new(simulation: &Simulation, outcome: &Outcome) -> Self {
        let (product, used) = (simulation.cart.length_m, outcome.cart_length);
        let left = left_over(&simulation.track.centre_line(), outcome.carts, product);
        let take_up = simulation.chain.take_up_m;
        let fit = left.map(|left_over| Fit { carts: outcome.carts, left_over });
        let fits = take_up.map(|take_up| fit.is_some_and(|fit| fit.is_within(take_up)));
        let (carts, length) = (outcome.carts, trimmed(product, 6));
        let over = match left {
            Some(left) => format!("{carts} carts of {length} m leave {} over", tenths_of_mm(left)),
            None => format!("no {carts} carts of {length} m close"),
        };
        let why = match (fits, take_up) {
            (Some(false), Some(take_up)) => format!(
                "{over}, beyond the take-up of {}; carts of a length that closes the chain under its tension are \
                 simulated",
                tenths_of_mm(take_up)
            ),
            (Some(true), Some(take_up)) => {
                let take_up = tenths_of_mm(take_up);
                format!(
                    "{over}, within the take-up of {take_up}; each takes its share of it, less what the tension \
                     stretches a joint by"
                )
            }
            _ => format!("{over}; carts of a length that closes the chain under its tension are simulated"),
        };
        CartLength { used_m: used, product_line_m: product, left_over_m: left, take_up_m: take_up, fits, why }
    }

    /// A line for people.
    pub fn text(&self) -> String {
        let (used, product) = (self.used_m, trimmed(self.product_line_m, 6));
        let away = format!("{:+.3} mm", 1e3 * (used - self.product_line_m));
        let of = if self.fits == Some(false) { "instead of" } else { "for" };
        format!("  cart length {used:.6} m {of} the product line's {product} m ({away}):\n    {}\n", self.why)
    }
}
