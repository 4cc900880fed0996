//! `simulation.json`: everything the dynamic simulator needs, without any `.lss` (design: chain model).

use super::number::tidy;
use super::{Compiled, document};
use crate::elements::{Sequence, Shape};
use crate::geometry::{Point, trig};
use crate::model;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Standard gravity as the chain model takes it, m/s².
const GRAVITY: f64 = 9.81;

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
    pub chain: Chain,
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
    pub effects: Vec<Effect>,
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
    pub elements: Vec<Piece>,
}

/// A piece of the centre line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Piece {
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
}

/// How a contact's restitution becomes damping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactLaw {
    /// Herbert and McWhannell 1977: χ(e) = 6(1−e) / ((2e−1)² + 3).
    HerbertMcwhannell,
}

/// The chain of carts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Chain {
    /// Number of carts: the whole number whose pitch comes nearest to the cart's length.
    pub carts: usize,
    /// Distance between joints as the cart family has it, m.
    pub pitch_m: f64,
    /// Length of the centre line, m.
    pub track_length_m: f64,
    /// What the chain is shorter than the centre line because carts are chords of the curves: Σ θL²/(24R) − L³/(120R²), the mean
    /// over phases, m.
    pub chord_excess_m: f64,
    /// Track length less chord excess less carts at their pitch, m; negative when the chain has to be compressed.
    pub left_over_m: f64,
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
    pub contact: Contact,
    /// c_rr
    pub rolling_resistance: f64,
}

/// F = K δⁿ (1 + χ(e) δ̇ / v₀).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contact {
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
    pub axial: Contact,
    /// Along η and ζ, each on its own.
    pub radial: Contact,
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
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// The effect's name.
    pub name: String,
    /// Its strengths by name, in SI units.
    pub strengths: BTreeMap<String, f64>,
}

/// `simulation.json`
pub fn json(compiled: &Compiled) -> Vec<u8> {
    document::to_json(&Simulation::new(compiled))
}

impl Simulation {
    pub fn new(compiled: &Compiled) -> Self {
        let layout = &compiled.layout;
        let (cart, motor, controller) = (&layout.cart, &layout.drive.motor, &layout.drive.controller);
        Simulation {
            name: layout.name.clone(),
            track: Track::new(&layout.name, &compiled.sequence, compiled.start()),
            gravity_m_s2: GRAVITY,
            contact_law: ContactLaw::HerbertMcwhannell,
            chain: Chain::new(compiled),
            cart: Cart {
                name: cart.name.clone(),
                length_m: cart.length,
                mass_kg: cart.mass,
                inertia_kg_m2: cart.inertia,
                centre_of_mass_m: cart.centre_of_mass,
                motor_height_m: cart.motor_height,
            },
            steering_wheel: wheel(&cart.steering),
            running_wheel: wheel(&cart.running),
            joint: Joint {
                name: cart.joint.name.clone(),
                axial: contact(&cart.joint.axial),
                radial: contact(&cart.joint.radial),
                approach_floor_m_s: cart.joint.approach_floor,
            },
            motors: Motors {
                name: motor.name.clone(),
                length_m: motor.length,
                force_n: motor.force,
                s_m: compiled.motors().iter().map(|m| m.s).collect(),
            },
            controller: Controller {
                name: controller.name.clone(),
                proportional_n_s_per_m: controller.proportional,
                integral_n_per_m: controller.integral,
                derivative_n_s2_per_m: controller.derivative,
                period_s: controller.period,
            },
            sensor: Sensor {
                name: layout.sensor.name.clone(),
                cart: layout.equipment.sensor_cart,
                lowpass_hz: layout.sensor.lowpass,
                rate_hz: layout.sensor.rate,
                photocell_s_m: layout.equipment.photocell.map_or(0.0, |place| compiled.station(place).s),
                trigger_length_m: layout.sensor.trigger_length,
            },
            supports_every_m: layout.equipment.supports.map(|s| s.value),
            effects: layout.effects.iter().map(effect).collect(),
        }
    }
}

impl Track {
    /// The elements from arc length `start` on, with the pieces of one straight or one turn as one. The straight on
    /// which the start lies is split there.
    fn new(name: &str, sequence: &Sequence, start: f64) -> Self {
        let mut position = sequence.elements.first().map_or_else(Point::default, |e| e.position);
        let mut heading = sequence.elements.first().map_or(0.0, |e| e.heading);
        let (mut before, mut after) = (Vec::new(), Vec::new());
        let mut begin = (position, heading);
        let mut s = 0.0;
        for shape in merged(sequence) {
            let split = start - s;
            s += shape.length();
            // Only straights are split; a start that is nearer to a joint than the solver's tolerance lies on it.
            match shape {
                Shape::Straight { length, cut } if split > NEAR && split < length - NEAR => {
                    let first = Shape::Straight { length: split, cut };
                    begin = first.advance(position, heading);
                    before.push(first);
                    after.push(Shape::Straight { length: length - split, cut });
                }
                _ if split <= NEAR => after.push(shape),
                _ => before.push(shape),
            }
            (position, heading) = shape.advance(position, heading);
            if after.is_empty() {
                begin = (position, heading);
            }
        }
        let (point, heading) = begin;
        let elements = after.into_iter().chain(before).map(piece).collect();
        Track { name: name.to_owned(), start: [tidy(point.x), tidy(point.y), 0.0, tidy(trig::wrap(heading))], elements }
    }
}

/// A solver's tolerance, m.
const NEAR: f64 = 1e-6;

/// Straights and turns as a whole.
fn merged(sequence: &Sequence) -> Vec<Shape> {
    let mut shapes: Vec<(usize, Shape)> = Vec::new();
    for element in &sequence.elements {
        match (shapes.last_mut(), element.shape) {
            (Some((vertex, Shape::Straight { length, .. })), Shape::Straight { length: more, .. })
                if *vertex == element.vertex =>
            {
                *length += more;
            }
            (Some((vertex, Shape::Curve { turn, .. })), Shape::Curve { turn: more, .. })
                if *vertex == element.vertex =>
            {
                *turn += more;
            }
            (_, shape) => shapes.push((element.vertex, shape)),
        }
    }
    shapes.into_iter().map(|(_, shape)| shape).collect()
}

fn piece(shape: Shape) -> Piece {
    match shape {
        Shape::Straight { length, .. } => Piece::Straight { length: tidy(length), slope: 0.0 },
        Shape::Curve { radius, turn } => Piece::Arc { radius: tidy(radius), turn_deg: tidy(turn.to_degrees()) },
    }
}

impl Chain {
    fn new(compiled: &Compiled) -> Self {
        let layout = &compiled.layout;
        let (length, pitch) = (compiled.sequence.length(), layout.cart.length);
        let chord_excess: f64 = merged(&compiled.sequence).iter().map(|shape| chord_excess(shape, pitch)).sum();
        let path = length - chord_excess;
        let carts = (path / pitch).round();
        Chain {
            carts: carts as usize,
            pitch_m: pitch,
            track_length_m: tidy(length),
            chord_excess_m: tidy(chord_excess),
            left_over_m: tidy(path - carts * pitch),
            tension_n: layout.chain.tension,
            speed_m_s: layout.speed.value,
        }
    }
}

/// What chords of length L cut off a turn, mean over phases: θL²/(24R) − L³/(120R²) (design: chain model), m.
fn chord_excess(shape: &Shape, chord: f64) -> f64 {
    match *shape {
        Shape::Straight { .. } => 0.0,
        Shape::Curve { radius, turn } => {
            let square = chord * chord;
            (turn.abs() * square / (24.0 * radius) - square * chord / (120.0 * radius * radius)).max(0.0)
        }
    }
}

fn wheel(wheel: &model::Wheel) -> Wheel {
    Wheel {
        name: wheel.name.clone(),
        radius_m: wheel.radius,
        half_spacing_m: wheel.half_spacing,
        height_m: wheel.height,
        gap_m: wheel.gap,
        contact: contact(&wheel.contact),
        rolling_resistance: wheel.rolling_resistance,
    }
}

fn contact(contact: &model::Contact) -> Contact {
    Contact { stiffness_n_per_m_n: contact.stiffness, exponent: contact.exponent, restitution: contact.restitution }
}

fn effect(effect: &model::Effect) -> Effect {
    Effect { name: effect.name.clone(), strengths: effect.strengths.iter().cloned().collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::fixture::{compile, on};
    use crate::model::{Layout, fixture};

    /// Ten curves of 4 m and 90°, 7 left and 3 right, 214.0 m, from its element list's vertices.
    fn reference() -> Layout {
        let d = 23.792_036_732_051_03;
        let straights = [12.0, 12.0, 12.0, 2.0 * d - 20.0, 7.0, 12.0, 4.5, 12.0, 4.5, 2.0 * d];
        let turns = [1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0];
        let mut point = Point::new(d + 4.0, 0.0);
        let mut heading = 0.0;
        let mut corners = Vec::new();
        for (straight, turn) in straights.into_iter().zip(turns) {
            corners.push((point.x, point.y, 4.0));
            heading += turn * trig::FRAC_PI_2;
            point = point + Point::unit(heading) * (straight + 8.0);
        }
        let mut layout = fixture::loop_through("reference", &corners);
        layout.equipment.start = Some(on(9, d));
        layout
    }

    #[test]
    fn the_reference_track_is_the_element_list_it_came_from() {
        let simulation = Simulation::new(&compile(reference()));
        let d = 23.792_036_732_051_03;
        let lengths: Vec<f64> = simulation
            .track
            .elements
            .iter()
            .map(|e| match e {
                Piece::Straight { length, .. } => *length,
                Piece::Arc { turn_deg, .. } => *turn_deg,
            })
            .collect();
        let expected = [
            d,
            90.0,
            12.0,
            90.0,
            12.0,
            -90.0,
            12.0,
            90.0,
            2.0 * d - 20.0,
            90.0,
            7.0,
            -90.0,
            12.0,
            90.0,
            4.5,
            90.0,
            12.0,
            -90.0,
            4.5,
            90.0,
            d,
        ];
        assert_eq!(lengths.len(), expected.len());
        for (length, expected) in lengths.iter().zip(expected) {
            assert!((length - expected).abs() < 1e-9, "{length} {expected}");
        }
        assert!(simulation.track.start.iter().all(|x| x.abs() < 1e-9), "{:?}", simulation.track.start);
        // Design: 171 carts at a pitch of 1.250017 m.
        let chain = &simulation.chain;
        assert_eq!(chain.carts, 171);
        assert!((chain.track_length_m - 214.0).abs() < 1e-9);
        let pitch = chain.pitch_m + chain.left_over_m / chain.carts as f64;
        assert!((pitch - 1.250017).abs() < 2e-5, "{pitch}");
    }

    #[test]
    fn the_track_closes_when_read_back() {
        let mut layout = fixture::rectangle(20.3, 10.7, 4.0);
        layout.equipment.start = Some(on(2, 1.7));
        let bytes = json(&compile(layout));
        let read: Simulation = serde_json::from_slice(&bytes).unwrap();
        let [x, y, _, start] = read.track.start;
        let (mut point, mut heading) = (Point::new(x, y), start);
        for element in &read.track.elements {
            let shape = match *element {
                Piece::Straight { length, .. } => Shape::Straight { length, cut: false },
                Piece::Arc { radius, turn_deg } => Shape::Curve { radius, turn: turn_deg.to_radians() },
            };
            (point, heading) = shape.advance(point, heading);
        }
        assert!(point.distance(Point::new(x, y)) < 1e-9);
        assert!(trig::wrap(heading - start).abs() < 1e-9);
        // The third section leads back along -x at the top, from x = 16.3.
        assert!((x - 14.6).abs() < 1e-9 && (y - 10.7).abs() < 1e-9);
        assert!(matches!(read.track.elements[0], Piece::Straight { length, .. } if (length - 10.6).abs() < 1e-9));
    }

    #[test]
    fn a_start_at_a_joint_splits_nothing() {
        for at in [0.0, 5e-7, 12.0] {
            let mut layout = fixture::rectangle(20.0, 10.0, 4.0);
            layout.equipment.start = Some(on(0, at));
            assert_eq!(Simulation::new(&compile(layout)).track.elements.len(), 8, "{at}");
        }
    }

    #[test]
    fn an_input_for_the_simulator() {
        let mut layout = fixture::rectangle(20.0, 10.0, 4.0);
        layout.equipment.photocell = Some(on(0, 1.0));
        let text = String::from_utf8(json(&compile(layout))).unwrap();
        insta::assert_snapshot!(text);
    }
}
