//! What the stdlib's catalogues and families say, after defaults, parameters and `from`.

use crate::source::Span;
use serde::Serialize;

use super::Interval;

/// Standard track elements that can be ordered.
#[derive(Clone, Debug, Serialize)]
pub struct Catalog {
    pub name: String,
    pub span: Span,
    pub straight: StraightStock,
    pub curve: CurveStock,
    pub vertical: Option<VerticalStock>,
    pub spiral: Option<SpiralStock>,
    /// Length that the chain's take-up compensates, m, unless the layout names a take-up: [`super::Layout::take_up_travel`].
    pub take_up: f64,
    /// From one section's centre line up to that of another which crosses it, at least, m.
    pub headroom: f64,
    /// One support of the track.
    pub support: Article,
}

/// Price (EUR) and mass (kg) of a piece: a part per piece and a part per unit of its size
/// (metres of centre line).
#[derive(Clone, Copy, Debug, PartialEq, Default, Serialize)]
pub struct Rate {
    pub per_piece: f64,
    pub per_metre: f64,
}

impl Rate {
    pub fn of(&self, length: f64) -> f64 {
        self.per_piece + self.per_metre * length
    }
}

/// How a component is ordered, as far as its declaration says.
#[derive(Clone, Debug, PartialEq, Default, Serialize)]
pub struct Article {
    /// Article number; of carts what their length is added to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<String>,
    /// EUR
    #[serde(skip_serializing_if = "Option::is_none")]
    pub price: Option<f64>,
    /// kg
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
}

impl Article {
    /// Its price rounded to the cent, EUR; nothing where the declaration has none.
    pub fn cost(&self) -> f64 {
        (self.price.unwrap_or(0.0) * 100.0).round() / 100.0
    }
}

/// Straight track: stock lengths, and pieces cut to length.
#[derive(Clone, Debug, Serialize)]
pub struct StraightStock {
    /// Article number prefix; a piece is `PREFIX-<length in mm>`.
    pub article: String,
    /// Lengths on stock, m, ascending, without repetition. May be empty when cutting is possible.
    pub stock: Vec<f64>,
    /// Lengths a piece may be cut to, m; `None` when only stock lengths exist.
    pub cut: Option<Interval>,
    /// Surcharge for a cut piece, EUR.
    pub cut_price: f64,
    /// Shortest straight between two curves, m.
    pub shortest: f64,
    pub price: Rate,
    pub mass: Rate,
}

/// Horizontal curves.
#[derive(Clone, Debug, Serialize)]
pub struct CurveStock {
    /// A piece is `PREFIX-<radius in mm>-<angle in deg>`.
    pub article: String,
    /// Radii, m, ascending, without repetition.
    pub radii: Vec<f64>,
    /// Every turn is a multiple of this, rad.
    pub angle_step: f64,
    /// Largest angle of a single piece, rad (a multiple of the step).
    pub largest: f64,
    /// Least and largest turn at a vertex, rad.
    pub turns: Interval,
    pub price: Rate,
    pub mass: Rate,
}

/// Vertical curves between slopes.
#[derive(Clone, Debug, Serialize)]
pub struct VerticalStock {
    pub article: String,
    /// m, ascending
    pub radii: Vec<f64>,
    /// Step of the slope angle, rad; 0 when any slope can be had.
    pub angle_step: f64,
    /// Largest slope (rise over run).
    pub steepest: f64,
    pub price: Rate,
    pub mass: Rate,
}

/// Spirals: horizontal arcs of constant slope.
#[derive(Clone, Debug, Serialize)]
pub struct SpiralStock {
    pub article: String,
    /// m, ascending
    pub radii: Vec<f64>,
    /// rad
    pub angle_step: f64,
    /// Largest slope (rise over run).
    pub steepest: f64,
    pub price: Rate,
    pub mass: Rate,
}

/// Law of a contact: F = K δⁿ (1 + χ(e) δ̇ / v₀).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContactParameters {
    /// K, N/mⁿ
    pub stiffness: f64,
    /// n
    pub exponent: f64,
    /// e, coefficient of restitution
    pub restitution: f64,
}

/// What a wheel or a joint carries, as far as its declaration says.
#[derive(Clone, Copy, Debug, PartialEq, Default, Serialize)]
pub struct Strength {
    /// Largest force, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rated: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fatigue: Option<Fatigue>,
}

impl Strength {
    /// Whether the declaration says nothing of it.
    pub fn is_unsaid(&self) -> bool {
        self.rated.is_none() && self.fatigue.is_none()
    }
}

/// An S-N curve of constant slope: so many cycles of this range are carried, N = N₀ (S₀/S)^m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fatigue {
    /// S₀, from valley to peak, N.
    pub range: f64,
    /// N₀
    pub cycles: f64,
    /// m
    pub exponent: f64,
}

/// A cart with its wheels and joints (design: chain model).
#[derive(Clone, Debug, Serialize)]
pub struct Cart {
    pub name: String,
    pub span: Span,
    /// Distance between front and rear joint, m.
    pub length: f64,
    /// Lengths that the product line is made in, m; empty where it does not say.
    pub lengths: Vec<f64>,
    /// kg
    pub mass: f64,
    /// About the centre of mass, along ξ, η, ζ, kg m².
    pub inertia: [f64; 3],
    /// (ξ_c, ζ_c), m
    pub centre_of_mass: [f64; 2],
    pub steering: Wheel,
    pub running: Wheel,
    pub joint: Joint,
    /// Height of the motor force below the joint, h_m, m.
    pub motor_height: f64,
    /// Air drag, c in c v², kg/m; `None` where the declaration does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drag: Option<f64>,
    /// Tension of a chain of them, N, where the layout does not say another: [`super::Layout::tension_with`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tension: Option<f64>,
    /// Its mass is the cart's own.
    pub article: Article,
}

#[derive(Clone, Debug, Serialize)]
pub struct Wheel {
    pub name: String,
    /// m
    pub radius: f64,
    /// Half the lateral distance of the pair (b_s, b_r), m.
    pub half_spacing: f64,
    /// Contact height below the joint (h_r), m; 0 for steering wheels.
    pub height: f64,
    /// Clearance to the rail (g_s, or g_u of the upper surface), m.
    pub gap: f64,
    pub contact: ContactParameters,
    /// c_rr
    pub rolling_resistance: f64,
    #[serde(skip_serializing_if = "Strength::is_unsaid")]
    pub strength: Strength,
}

#[derive(Clone, Debug, Serialize)]
pub struct Joint {
    pub name: String,
    pub axial: ContactParameters,
    pub radial: ContactParameters,
    /// v_min, m/s: floor of the approach speed in every contact law.
    pub approach_floor: f64,
    #[serde(skip_serializing_if = "Strength::is_unsaid")]
    pub strength: Strength,
    pub article: Article,
}

/// Linear motors and their speed controller.
#[derive(Clone, Debug, Serialize)]
pub struct Drive {
    pub motor: Motor,
    pub controller: Controller,
}

#[derive(Clone, Debug, Serialize)]
pub struct Motor {
    pub name: String,
    /// l_m, m
    pub length: f64,
    /// F_max, N
    pub force: f64,
    /// Thrust times speed over electrical power; `None` where the declaration does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efficiency: Option<f64>,
    pub article: Article,
}

#[derive(Clone, Debug, Serialize)]
pub struct Controller {
    pub name: String,
    /// K_p, N s/m
    pub proportional: f64,
    /// K_i, N/m
    pub integral: f64,
    /// K_d, N s²/m
    pub derivative: f64,
    /// T_c, s
    pub period: f64,
}

/// The sensor cart's chain of measurement.
#[derive(Clone, Debug, Serialize)]
pub struct Sensor {
    pub name: String,
    /// Corner frequency of the low-pass, Hz.
    pub lowpass: f64,
    /// Samples a second, Hz.
    pub rate: f64,
    /// Length past the photocell over which the trigger reads 1, m.
    pub trigger_length: f64,
    /// Largest force that its load cells measure, N; `None` where the declaration does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<f64>,
    pub article: Article,
}

/// The unit that keeps the chain at its tension.
#[derive(Clone, Debug, Serialize)]
pub struct TakeUp {
    pub name: String,
    /// Length of chain that it compensates, longer or shorter, m.
    pub travel: f64,
    /// Largest tension of the chain that it holds, N; `None` where the declaration does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    pub article: Article,
}

impl TakeUp {
    /// Whether it holds a chain's tension, N.
    pub fn holds(&self, tension: f64) -> bool {
        self.force.is_none_or(|force| tension <= force)
    }
}
