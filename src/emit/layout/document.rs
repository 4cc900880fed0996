//! What stands in `layout.json`. The doc comments are the schema's descriptions.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A layout as lss built it. Lengths in metres; arc length s counts along the centre line in driving
/// direction, from the layout's start; headings count from +x, left turns are positive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "lss layout")]
#[serde(deny_unknown_fields)]
pub struct LayoutFile {
    /// The layout's name.
    pub name: String,
    /// How the last stage ended. When infeasible, what follows is the best that was found, and `violations` says what
    /// is wrong with it.
    pub status: Status,
    /// What the layout breaks, and by how much.
    pub violations: Vec<Violation>,
    /// Length of the centre line, m; along the slope where there are heights.
    pub length_m: f64,
    /// Width of the band that carts and carriers sweep, m.
    pub width_m: f64,
    /// Floor covered by that band, m².
    pub footprint_m2: f64,
    /// Chain speed, m/s.
    pub speed_m_s: f64,
    /// The catalogue that elements are from.
    pub catalog: String,
    /// The cart's name.
    pub cart: String,
    /// How a whole number of carts fits; `null` when no chain of these carts closes.
    pub chain: Option<ChainFit>,
    /// In driving order; the loop closes from the last to the first.
    pub vertices: Vec<Vertex>,
    /// Section i leads from vertex i to the next.
    pub sections: Vec<Section>,
    /// The centre line in driving order, beginning behind the first vertex.
    pub centre_line: Vec<CentreLinePiece>,
    /// The elements in driving order, beginning behind the first vertex.
    pub elements: Vec<Element>,
    /// Distance between the last element's end and the first one's begin, m.
    pub closure_m: f64,
    /// The same for the heading, rad.
    pub closure_rad: f64,
    /// What stands along the track.
    pub equipment: Vec<Equipment>,
    /// What equipment of declared kinds and its conveyors cost; absent without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub placement: Option<Placement>,
    /// Distance between supports, m; `null` when the layout places none.
    pub supports_every_m: Option<f64>,
    /// How the band meets obstacles and the building.
    pub contacts: Vec<ContactArea>,
    /// What the layout asks for, one row each, and the value it has.
    pub constraints: Vec<Constraint>,
    /// The stages of optimisation.
    pub stages: Vec<Stage>,
}

/// The chain of carts on the centre line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChainFit {
    /// The whole number that fits best.
    pub carts: usize,
    /// Of the product line, m.
    pub cart_length_m: f64,
    /// What so many carts lack to close, m, the mean over phases; negative when the chain has to be compressed.
    pub left_over_m: f64,
    /// What the take-up compensates, m.
    pub take_up_m: f64,
    /// Whether it compensates what is left over.
    pub fits: bool,
}

/// A row that is not met.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Violation {
    /// What is not met.
    pub row: String,
    /// By how much, in `unit`.
    pub amount: f64,
    /// `m` or `rad`.
    pub unit: String,
}

/// A vertex and its fillet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Vertex {
    /// As the layout names it.
    pub name: String,
    /// m
    pub x_m: f64,
    /// m
    pub y_m: f64,
    /// Radius of the fillet, m.
    pub radius_m: f64,
    /// Turn of the track, deg, left positive.
    pub turn_deg: f64,
}

/// The line from one vertex to the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// `P4..P5`
    pub name: String,
    /// Distance between the vertices, m.
    pub length_m: f64,
    /// Length of the straight between the tangent points, m.
    pub straight_m: f64,
    /// Heading, deg, in (-180, 180].
    pub heading_deg: f64,
}

/// A straight, a horizontal or vertical arc, or a spiral of the centre line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CentreLinePiece {
    /// Arc length where it begins, m.
    pub s_m: f64,
    /// Of its centre line, m.
    pub length_m: f64,
    /// [x, y], m.
    pub begin_m: [f64; 2],
    /// [x, y], m.
    pub end_m: [f64; 2],
    /// Heights there, m.
    pub z_m: [f64; 2],
    /// Slopes there, rise over run.
    pub slope: [f64; 2],
    /// Heading where it begins, deg, in (-180, 180].
    pub heading_deg: f64,
    /// Signed horizontal curvature in the plan, 1/m, left positive; 0 for a straight.
    pub curvature_per_m: f64,
    /// Signed vertical curvature, 1/m, upwards positive; 0 but for a vertical curve.
    pub vertical_curvature_per_m: f64,
}

/// A standard track element at its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Element {
    /// Article number, as in the bill of elements.
    pub article: String,
    /// Straight or curve.
    #[serde(flatten)]
    pub shape: ElementShape,
    /// Arc length where it begins, m.
    pub s_m: f64,
    /// [x, y] where it begins, m.
    pub begin_m: [f64; 2],
    /// Heading where it begins, deg, in (-180, 180].
    pub heading_deg: f64,
    /// Whether the catalogue has it.
    pub in_catalog: bool,
}

/// What an element is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ElementShape {
    /// A straight piece.
    Straight {
        /// m
        length_m: f64,
        /// Whether it is cut to this length.
        cut: bool,
    },
    /// A curved piece.
    Curve {
        /// Of the centre line, m.
        length_m: f64,
        /// Of the centre line, m.
        radius_m: f64,
        /// deg, left positive.
        turn_deg: f64,
    },
}

/// What stands along the track.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Equipment {
    /// What it is.
    pub kind: EquipmentKind,
    /// `west`; chutes and motors are numbered from 1: `row_a 3`.
    pub name: String,
    /// Arc length, m; of a motor, where it begins.
    pub s_m: f64,
    /// On the centre line, m.
    pub x_m: f64,
    /// On the centre line, m.
    pub y_m: f64,
    /// Height of the centre line, m.
    pub z_m: f64,
    /// Heading of the track, deg, in (-180, 180].
    pub heading_deg: f64,
    /// The kind that the layout declares; absent without one, as what follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Corners [x, y] of the rectangles that it covers beside the band, m.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub footprints_m: Vec<Vec<[f64; 2]>>,
    /// Length of the conveyor that feeds it, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conveyor_m: Option<f64>,
}

/// The price of equipment of declared kinds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Placement {
    /// The equipment itself, EUR.
    pub equipment_eur: f64,
    /// The conveyors that feed it, EUR.
    pub conveyors_eur: f64,
    /// No places on this track need cheaper conveyors, EUR.
    pub conveyors_lower_bound_eur: f64,
    /// How many pieces found no place.
    pub missing: usize,
}

/// Kinds of equipment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EquipmentKind {
    /// Where arc length is 0.
    Start,
    /// Trigger of the sensor cart.
    Photocell,
    /// Where items come onto the sorter.
    Induction,
    /// Where items leave it.
    Chute,
    /// A linear motor, where it begins.
    Motor,
    /// Where items are read; one of a declared kind.
    Scanner,
    /// Where the track can be crossed.
    Gate,
    /// Brings containers to the track's height.
    Lift,
}

/// How the track's band meets an obstacle or the outside of the building.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContactArea {
    /// The obstacle's name, or `building`.
    pub name: String,
    /// Overlap with the left side of the band, m².
    pub area_left_m2: f64,
    /// Overlap with the right side of the band, m².
    pub area_right_m2: f64,
    /// Distance from the band's edge, m; negative when they overlap.
    pub clearance_m: f64,
    /// The clearance that the layout asks for, m.
    pub required_m: f64,
}

/// A constraint of the layout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constraint {
    /// What is constrained: `fix length P2..P3`, `length(P7..P8) >= 18 m`.
    pub row: String,
    /// The user's words.
    pub reason: Option<String>,
    /// Least value, in `unit`; `null` when there is none.
    pub low: Option<f64>,
    /// Greatest value, in `unit`; `null` when there is none.
    pub high: Option<f64>,
    /// The layout's value, in `unit`.
    pub value: f64,
    /// `m`, `rad` or `m^2`; empty for a number without unit, and for formulas of another dimension, in SI units.
    pub unit: String,
    /// Whether the row sets two sides against each other, and `value` is their difference.
    #[serde(skip)]
    pub difference: bool,
}

/// A stage of optimisation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// `stage1`, `stage2`, `stage3` or `written`.
    pub name: String,
    /// How it ended.
    pub status: Status,
    /// Length of the centre line, m.
    pub length_m: f64,
    /// `time` where a limit of time ended the solve before it was done.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cut: Option<String>,
    /// Largest violation, m (angles as rad).
    pub max_violation_m: f64,
    /// Number of iterations.
    pub iterations: usize,
    /// From how many starts local optima were looked for that lead to a better layout on the grid, where from more than
    /// one: where the search over the grid proves nothing.
    #[serde(default = "one", skip_serializing_if = "crate::base::number::is_one")]
    pub starts: usize,
    /// [x, y, radius] of each vertex, m.
    pub vertices_m: Vec<[f64; 3]>,
}

/// How a stage ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// A local optimum, feasible: nothing near it is better.
    Local,
    /// The best that the search over the catalogue's grid came by; something better may be left.
    BestFound,
    /// Nothing on the catalogue's grid is better.
    Proven,
    /// Feasible, but the iteration limit came first.
    Feasible,
    /// No feasible layout was found; this is the least infeasible one.
    Infeasible,
    /// Nothing was optimised.
    AsWritten,
}

fn one() -> usize {
    1
}
