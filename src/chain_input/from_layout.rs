//! The simulation of a compiled layout.

use super::{
    Cart, CentreLinePiece, ChainInput, ContactLaw, ContactParameters, Controller, DeclaredEffect, Equipment, Joint,
    Motors, Sensor, Simulation, Track, Wheel,
};
use crate::base::number::tidy;
use crate::base::trig;
use crate::compiled::Compiled;
use crate::geometry::Form;
use crate::model;
use crate::placement::Placed;

/// Standard gravity as the chain model takes it, m/s².
const GRAVITY: f64 = 9.81;

impl Simulation {
    pub fn new(compiled: &Compiled) -> Self {
        let layout = &compiled.layout;
        let (cart, motor, controller) = (&layout.cart, &layout.drive.motor, &layout.drive.controller);
        Simulation {
            name: layout.name.clone(),
            track: Track::new(compiled),
            gravity_m_s2: GRAVITY,
            contact_law: ContactLaw::HerbertMcwhannell,
            chain: ChainInput::new(compiled),
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
            equipment: equipment(compiled),
        }
    }
}

/// What stands along the track of declared kinds, in the order of declarations.
fn equipment(compiled: &Compiled) -> Vec<Equipment> {
    let one = |placed: &Placed| {
        let declared = &compiled.layout.equipment.declared[placed.declared];
        Equipment {
            kind: declared.of.kind.word().to_owned(),
            name: declared.one(placed.number),
            s_m: compiled.station(placed.place).s,
            length_m: declared.of.stretch,
        }
    };
    compiled.placement.placed.iter().map(one).collect()
}

impl Simulation {
    /// Writes anew what of the chain follows from track, cart and number of carts.
    pub fn derive(&mut self) {
        let forms: Vec<Form> = self.track.elements.iter().map(CentreLinePiece::form).collect();
        let (length, pitch) = (forms.iter().map(Form::length).sum::<f64>(), self.cart.length_m);
        let chord_excess: f64 = forms.iter().map(|form| chord_excess(form, pitch)).sum();
        self.chain.pitch_m = pitch;
        self.chain.track_length_m = tidy(length);
        self.chain.chord_excess_m = tidy(chord_excess);
        self.chain.left_over_m = tidy(length - chord_excess - self.chain.carts as f64 * pitch);
    }
}

impl ChainInput {
    fn new(compiled: &Compiled) -> Self {
        let layout = &compiled.layout;
        let pitch = layout.cart.length;
        let length = if compiled.raised() { compiled.space.line.length } else { compiled.sequence.length() };
        let chord_excess: f64 = compiled.space.legs.iter().map(|leg| chord_excess(&leg.form, pitch)).sum();
        let path = length - chord_excess;
        let carts = (path / pitch).round();
        ChainInput {
            carts: carts as usize,
            pitch_m: pitch,
            track_length_m: tidy(length),
            chord_excess_m: tidy(chord_excess),
            left_over_m: tidy(path - carts * pitch),
            take_up_m: Some(layout.take_up_travel()),
            tension_n: layout.chain.tension,
            speed_m_s: layout.speed.value,
        }
    }
}

/// What chords of length L cut off a bend, mean over phases: θL²/(24R) − L³/(120R²) (design: chain model), m. A spiral
/// of slope angle α bends with the radius R/cos²α.
fn chord_excess(form: &Form, chord: f64) -> f64 {
    let bend = |radius: f64, angle: f64| {
        let square = chord * chord;
        (angle.abs() * square / (24.0 * radius) - square * chord / (120.0 * radius * radius)).max(0.0)
    };
    match *form {
        Form::Straight { .. } => 0.0,
        Form::Arc { radius, turn } => bend(radius, turn),
        Form::Vertical { radius, .. } => bend(radius, form.length() / radius),
        Form::Spiral { radius, turn, .. } => {
            let cos = trig::cos(form.inclination().0);
            let bent = radius / (cos * cos);
            bend(bent, form.length() / bent * turn.signum())
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

fn contact(contact: &model::ContactParameters) -> ContactParameters {
    ContactParameters {
        stiffness_n_per_m_n: contact.stiffness,
        exponent: contact.exponent,
        restitution: contact.restitution,
    }
}

fn effect(effect: &model::DeclaredEffect) -> DeclaredEffect {
    DeclaredEffect { name: effect.name.clone(), strengths: effect.strengths.iter().cloned().collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::{compile, on};
    use crate::geometry::Point;
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
                CentreLinePiece::Straight { length, .. } => *length,
                curve => curve.form().turn().to_degrees(),
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
        let bytes = crate::base::json::to_json(&Simulation::new(&compile(layout)));
        let read: Simulation = serde_json::from_slice(&bytes).unwrap();
        let [x, y, _, _] = read.track.start;
        let (gap, angle) = read.track.centre_line().closure;
        assert!(gap < 1e-9 && angle < 1e-9);
        // The third section leads back along -x at the top, from x = 16.3.
        assert!((x - 14.6).abs() < 1e-9 && (y - 10.7).abs() < 1e-9);
        assert!(
            matches!(read.track.elements[0], CentreLinePiece::Straight { length, .. } if (length - 10.6).abs() < 1e-9)
        );
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
    fn a_start_survives_the_correction_of_lengths() {
        let mut layout = fixture::rectangle(20.0, 10.0, 4.0);
        layout.vertices[1].point.x += 9e-7;
        layout.vertices[2].point.x += 9e-7;
        layout.vertices[3].point.y += 9e-7;
        for (section, at) in [(3, 0.0), (2, 12.0 + 9e-7)] {
            layout.equipment.start = Some(on(section, at));
            assert_eq!(Simulation::new(&compile(layout.clone())).track.elements.len(), 8, "{section} {at}");
        }
    }

    #[test]
    fn an_input_for_the_simulator() {
        let mut layout = fixture::rectangle(20.0, 10.0, 4.0);
        layout.equipment.photocell = Some(on(0, 1.0));
        let text = String::from_utf8(crate::base::json::to_json(&Simulation::new(&compile(layout)))).unwrap();
        insta::assert_snapshot!(text);
    }
}
