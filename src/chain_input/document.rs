//! What stands in `simulation.json`. The doc comments are the schema's descriptions; messages and schema keep the names
//! that `rename` says.

use crate::geometry::{CentreLine, Form};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Input of a dynamic simulation of the chain of carts. Arc length s counts from the layout's start in driving
/// direction; cart axes are ξ forward, η left, ζ up, with the front joint at the origin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "lss simulation input")]
#[serde(deny_unknown_fields)]
pub struct Simulation {
    /// The layout's name.
    pub name: String,
    /// The centre line.
    pub track: Track,
    /// m/s²
    pub gravity_m_s2: f64,
    /// The law that damps every contact.
    pub contact_law: ContactLaw,
    /// The chain as a whole.
    pub chain: ChainInput,
    /// Every cart.
    pub cart: Cart,
    /// A pair of wheels that guides the cart between the rails.
    pub steering_wheel: Wheel,
    /// A pair of wheels that carries the cart.
    pub running_wheel: Wheel,
    /// The joint between two carts.
    pub joint: Joint,
    /// Linear motors.
    pub motors: Motors,
    /// The speed controller of all motors.
    pub controller: Controller,
    /// The sensor cart's chain of measurement.
    pub sensor: Sensor,
    /// Distance between supports, m; `null` when the layout places none.
    pub supports_every_m: Option<f64>,
    /// Effects beyond the nominal model.
    pub effects: Vec<DeclaredEffect>,
    /// Equipment of declared kinds along the track, which the chain does not feel; absent without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub equipment: Vec<Equipment>,
}

/// A piece of equipment along the track.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Equipment {
    /// `induction`, `chute`, `scanner`, `gate` or `lift`.
    pub kind: String,
    /// `west`; chutes are numbered from 1: `row_a 3`.
    pub name: String,
    /// Arc length of its middle, m.
    pub s_m: f64,
    /// Length along the track, m.
    pub length_m: f64,
}

/// A closed centre line as a list of elements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Track {
    /// The layout's name.
    pub name: String,
    /// x, y, z (m) and heading (rad) at arc length 0.
    pub start: [f64; 4],
    /// In driving order from there.
    pub elements: Vec<CentreLinePiece>,
}

/// A piece of the centre line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Piece", tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum CentreLinePiece {
    /// A straight.
    Straight {
        /// Along the slope, m.
        length: f64,
        /// Rise over run.
        slope: f64,
    },
    /// A horizontal arc.
    Arc {
        /// m
        radius: f64,
        /// deg, left positive.
        turn_deg: f64,
    },
    /// A vertical arc between two slopes.
    Vertical {
        /// m
        radius: f64,
        /// Rise over run.
        slope_from: f64,
        /// Rise over run.
        slope_to: f64,
    },
    /// A horizontal arc of constant slope.
    Spiral {
        /// Of its plan, m.
        radius: f64,
        /// deg, left positive.
        turn_deg: f64,
        /// m
        rise: f64,
    },
}

impl CentreLinePiece {
    /// The piece as geometry knows it.
    pub fn form(&self) -> Form {
        match *self {
            CentreLinePiece::Straight { length, slope } => Form::Straight { length, slope },
            CentreLinePiece::Arc { radius, turn_deg } => Form::Arc { radius, turn: turn_deg.to_radians() },
            CentreLinePiece::Vertical { radius, slope_from, slope_to } => {
                Form::Vertical { radius, slope_from, slope_to }
            }
            CentreLinePiece::Spiral { radius, turn_deg, rise } => {
                Form::Spiral { radius, turn: turn_deg.to_radians(), rise }
            }
        }
    }
}

impl Track {
    /// The centre line in space.
    pub fn centre_line(&self) -> CentreLine {
        let forms: Vec<Form> = self.elements.iter().map(CentreLinePiece::form).collect();
        CentreLine::new(self.start, &forms)
    }
}

/// How a contact's restitution e becomes the damping factor χ(e) of its force.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema, clap::ValueEnum,
)]
#[serde(rename_all = "snake_case")]
#[clap(rename_all = "snake_case")]
pub enum ContactLaw {
    /// Hunt and Crossley 1975: χ(e) = 3(1−e)/2.
    HuntCrossley,
    /// Herbert and McWhannell 1977: χ(e) = 6(1−e) / ((2e−1)² + 3).
    #[default]
    HerbertMcwhannell,
    /// Lankarani and Nikravesh 1990: χ(e) = 3(1−e²)/4.
    LankaraniNikravesh,
    /// Lee and Wang 1983: χ(e) = 3(1−e)/4.
    LeeWang,
    /// Gonthier 2004, exact: the d of d(1+e) = ln((1+d)/(1−e·d)).
    Gonthier,
    /// Flores 2011: χ(e) = 8(1−e)/(5e).
    Flores,
    /// Hu and Guo 2015: χ(e) = 3(1−e)/(2e).
    HuGuo,
    /// Kelvin and Voigt, for comparison: a linear damper beside the spring, c = 2ζ√(K_t m).
    KelvinVoigt,
}

/// The chain of carts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Chain", deny_unknown_fields)]
pub struct ChainInput {
    /// Number of carts: the whole number whose pitch comes nearest to the cart's length.
    pub carts: usize,
    /// Distance between joints as the cart family has it, m.
    pub pitch_m: f64,
    /// Length of the centre line, m.
    pub track_length_m: f64,
    /// What the chain is shorter than the centre line because carts are chords of the curves: Σ θL²/(24R) − L³/(120R²),
    /// the mean over phases, m.
    pub chord_excess_m: f64,
    /// Track length less chord excess less carts at their pitch, m; negative when the chain has to be compressed.
    pub left_over_m: f64,
    /// What the take-up compensates, m; `null` when not known.
    #[serde(default)]
    pub take_up_m: Option<f64>,
    /// Tension on the centre line, T₀, N.
    pub tension_n: f64,
    /// m/s
    pub speed_m_s: f64,
}

/// A cart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cart {
    /// The cart family.
    pub name: String,
    /// Between front and rear joint, L, m.
    pub length_m: f64,
    /// m, kg.
    pub mass_kg: f64,
    /// About the centre of mass, along ξ, η, ζ, kg m².
    pub inertia_kg_m2: [f64; 3],
    /// ξ and ζ of the centre of mass, m.
    pub centre_of_mass_m: [f64; 2],
    /// Height of the motor force below the joint, h_m, m.
    pub motor_height_m: f64,
}

/// A pair of wheels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wheel {
    /// The wheel's name.
    pub name: String,
    /// m
    pub radius_m: f64,
    /// Half the lateral distance of the pair (b_s, b_r), m.
    pub half_spacing_m: f64,
    /// Height of the contact below the joint (h_r), m.
    pub height_m: f64,
    /// Clearance to the rail (g_s), or to its upper surface (g_u), m.
    pub gap_m: f64,
    /// Of the wheel on the rail.
    pub contact: ContactParameters,
    /// c_rr
    pub rolling_resistance: f64,
}

/// F = K δⁿ (1 + χ(e) δ̇ / v₀).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Contact", deny_unknown_fields)]
pub struct ContactParameters {
    /// K, N/mⁿ.
    pub stiffness_n_per_m_n: f64,
    /// n
    pub exponent: f64,
    /// e
    pub restitution: f64,
}

/// The joint between two carts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// The joint's name.
    pub name: String,
    /// Along ξ.
    pub axial: ContactParameters,
    /// Along η and ζ, each on its own.
    pub radial: ContactParameters,
    /// Floor of the approach speed in every contact law, v_min, m/s.
    pub approach_floor_m_s: f64,
}

/// Linear motors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Motors {
    /// The motor's name.
    pub name: String,
    /// l_m, m.
    pub length_m: f64,
    /// Largest force of a motor, F_max, N.
    pub force_n: f64,
    /// Arc length where each begins, m.
    pub s_m: Vec<f64>,
}

/// The speed controller: one command, in force a motor, clamped to [0, F_max], with a zero-order hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Controller {
    /// The controller's name.
    pub name: String,
    /// K_p, N s/m.
    pub proportional_n_s_per_m: f64,
    /// K_i, N/m.
    pub integral_n_per_m: f64,
    /// K_d, N s²/m.
    pub derivative_n_s2_per_m: f64,
    /// T_c, s.
    pub period_s: f64,
}

/// The sensor cart's chain of measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// The sensor's name.
    pub name: String,
    /// Number of the cart that carries it, from 1.
    pub cart: usize,
    /// Corner frequency of the low-pass, Hz.
    pub lowpass_hz: f64,
    /// Samples a second, Hz.
    pub rate_hz: f64,
    /// Arc length of the photocell, m; 0 when the layout places none.
    pub photocell_s_m: f64,
    /// Length past the photocell over which the trigger reads 1, m.
    pub trigger_length_m: f64,
}

/// An effect beyond the nominal model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Effect", deny_unknown_fields)]
pub struct DeclaredEffect {
    /// The effect's name.
    pub name: String,
    /// Its strengths by name, in SI units.
    pub strengths: BTreeMap<String, f64>,
}
