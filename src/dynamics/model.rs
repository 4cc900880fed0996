//! The chain model's constants, worked out once from a simulation input (design: chain model).

use super::coverage::Coverage;
use super::law::{self, Damped, tangent};
use super::segments::Segments;
use super::state::{PACK, PackRow};
use super::step::stable;
use crate::chain_input as input;
use crate::chain_input::{ContactLaw, Deviations, Simulation, Unfit};
use crate::kinematics::closing;
use std::fmt;

/// Phases of one pitch over which the closing pitch is averaged.
const PHASES: usize = 16;

/// Elongation of a joint beyond which the chain is broken, m.
pub const BROKEN: f64 = 0.02;

/// Lateral or vertical offset of a front joint from the centre line beyond which the cart is off the rail, m.
pub const OFF_RAIL: f64 = 0.05;

/// A contact load at which Kelvin-Voigt is linearised at a steering wheel, N.
const STEERING_LOAD: f64 = 100.0;

/// A chain of carts on its track.
#[derive(Clone, Debug)]
pub struct Model {
    pub segments: Segments,
    pub carts: usize,
    /// m/s²
    pub gravity: f64,
    pub cart: Cart,
    pub steering: Wheel,
    pub running: Wheel,
    pub axial: Damped,
    pub radial: Damped,
    /// Axial force at which a joint counts as broken, N: K δⁿ of the elongation that no chain survives, see [`BROKEN`].
    pub breaking: f64,
    /// v_min, m/s
    pub floor: f64,
    pub motors: Motors,
    pub coverage: Coverage,
    pub controller: Controller,
    pub speed: f64,
    /// T₀, N
    pub tension: f64,
    /// Squares of the highest frequencies along the chain and across it, 1/s², with joints at their static stretch and
    /// running wheels under their weight.
    pub stiffness_rates: [f64; 2],
    pub answers: Answers,
    /// Mean closing pitch over 16 phases, m.
    pub pitch: f64,
    /// How it deviates from the nominal chain.
    pub deviations: Box<Deviations>,
    /// Whether all motors' thrust is even and alike.
    pub even: bool,
    /// What each cart is longer by, in packs, m; empty when they are alike.
    pub longer: Vec<PackRow>,
    /// What the way between rails that are off is longer by, [`Deviations::longer`].
    pub way_longer: Vec<f64>,
}

/// A rigid cart; lengths in m, from the front joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cart {
    /// Free length, adapted to the closing pitch and the tension.
    pub length: f64,
    /// kg
    pub mass: f64,
    /// kg m², about the centre of mass along ξ, η, ζ.
    pub inertia: [f64; 3],
    /// ξ_c, ζ_c
    pub centre: [f64; 2],
    /// h_m
    pub motor_height: f64,
}

/// A pair of wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    pub contact: Damped,
    /// b, m
    pub half_spacing: f64,
    /// h_r, m
    pub height: f64,
    /// g, m
    pub gap: f64,
    /// m
    pub radius: f64,
    /// c_rr
    pub resistance: f64,
}

/// Linear motors.
#[derive(Clone, Debug, PartialEq)]
pub struct Motors {
    /// Arc length where each begins, m.
    pub s: Vec<f64>,
    /// l_m, m
    pub length: f64,
    /// F_max, N
    pub force: f64,
}

/// PID with its sampling time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    pub proportional: f64,
    pub integral: f64,
    pub derivative: f64,
    /// T_c, s
    pub period: f64,
}

impl Model {
    /// Checks the input and closes the chain: the free cart length is ℓ − sign(T₀)(|T₀|/K)^(1/n), with ℓ the pitch at
    /// which the chain closes, averaged over phases. The take-up takes what a built track is longer by, so T₀ is the
    /// tension there, too.
    ///
    /// # Errors
    ///
    /// [`Unfit`] for an input that no chain can have, or one with effects that were not turned into deviations.
    pub fn new(simulation: &Simulation, deviations: Deviations) -> Result<Model, Unfit> {
        if !simulation.effects.is_empty() {
            let why = "effects are turned into deviations first, by `effects::model` or `effects::simulate`".to_owned();
            return Err(Unfit { place: "effects".to_owned(), why });
        }
        check(simulation)?;
        let line = simulation.track.centre_line();
        let (gap, angle) = line.closure;
        if gap > 1e-4 || angle > 1e-4 {
            let why = format!("its elements do not close: {gap:.3e} m and {angle:.3e} rad remain at the end");
            return Err(Unfit { place: "track.elements".into(), why });
        }
        let carts = simulation.chain.carts;
        let unclosed = |why: &dyn fmt::Display| Unfit { place: "chain.carts".into(), why: why.to_string() };
        let pitch_at = |front: f64| closing(&line, carts, front).map(|c| c.pitch).map_err(|why| unclosed(&why));
        let first = pitch_at(0.0)?;
        let mut pitch = 0.0;
        for phase in 0..PHASES {
            pitch += pitch_at(first * phase as f64 / PHASES as f64)? / PHASES as f64;
        }
        let law = simulation.contact_law;
        let (mass, tension) = (simulation.cart.mass_kg, simulation.chain.tension_n);
        let damped = |contact: &input::ContactParameters, load: f64| damped(law, contact, load, mass);
        let axial = damped(&simulation.joint.axial, tension);
        let stretch =
            crate::base::trig::pow(tension.abs() / axial.stiffness, 1.0 / axial.exponent) + 0.5 * deviations.clearance;
        let way_longer = deviations.longer(&line);
        let built = pitch + deviations.chain_longer(&line, carts, PHASES) / carts as f64;
        let length = if tension < 0.0 { built + stretch } else { built - stretch };
        let wheel = |wheel: &input::Wheel, load: f64| Wheel {
            contact: damped(&wheel.contact, load),
            half_spacing: wheel.half_spacing_m,
            height: wheel.height_m,
            gap: wheel.gap_m,
            radius: wheel.radius_m,
            resistance: wheel.rolling_resistance,
        };
        let cart = Cart {
            length,
            mass,
            inertia: simulation.cart.inertia_kg_m2,
            centre: simulation.cart.centre_of_mass_m,
            motor_height: simulation.cart.motor_height_m,
        };
        let weight = mass * simulation.gravity_m_s2;
        let widest = simulation.running_wheel.half_spacing_m.max(simulation.running_wheel.height_m.abs());
        let widest = widest.max(simulation.cart.motor_height_m.abs()) + OFF_RAIL;
        // Steps have to do for the stiffest that it gets.
        let stiffest = 1.0 + deviations.warming.change.max(0.0);
        let (running, radial) = (&simulation.running_wheel, damped(&simulation.joint.radial, tension));
        let wheels = 2.0 * tangent_of(&running.contact, weight / 2.0);
        let motors = Motors {
            s: simulation.motors.s_m.iter().map(|s| s.rem_euclid(line.length)).collect(),
            length: simulation.motors.length_m,
            force: simulation.motors.force_n,
        };
        Ok(Model {
            carts,
            gravity: simulation.gravity_m_s2,
            cart,
            steering: wheel(&simulation.steering_wheel, STEERING_LOAD),
            running: wheel(running, weight / 2.0),
            breaking: axial.at_rest(BROKEN),
            axial,
            radial,
            stiffness_rates: [
                4.0 * tangent_of(&simulation.joint.axial, tension.abs().max(0.25 * weight)) / mass,
                cart.ends().rate(tangent_of(&simulation.joint.radial, weight / 2.0), wheels),
            ]
            .map(|rate| stiffest * rate),
            answers: cart.answers(simulation.running_wheel.half_spacing_m),
            floor: simulation.joint.approach_floor_m_s,
            coverage: Coverage::new(&motors.s, motors.length, line.length),
            motors,
            controller: Controller {
                proportional: simulation.controller.proportional_n_s_per_m,
                integral: simulation.controller.integral_n_per_m,
                derivative: simulation.controller.derivative_n_s2_per_m,
                period: simulation.controller.period_s,
            },
            speed: simulation.chain.speed_m_s,
            tension,
            pitch,
            even: deviations.thrust.is_empty() && deviations.ripple.is_none(),
            longer: rows(&deviations.pitch, carts),
            way_longer,
            deviations: Box::new(deviations),
            segments: Segments::new(line, widest),
        })
    }

    /// Whether every wheel has Hertz' exponent, 1.5.
    pub fn hertzian(&self) -> bool {
        self.steering.contact.exponent == 1.5 && self.running.contact.exponent == 1.5
    }

    /// Whether joints follow linear laws without play.
    pub fn linear_joints(&self) -> bool {
        self.axial.exponent == 1.0 && self.radial.exponent == 1.0 && self.deviations.clearance == 0.0
    }

    /// Largest step that the joints' stiffness leaves accurate, s: 1.3/ω of the chain's highest axial mode, ω² = 4K/m,
    /// at the static stretch of T₀ where the law is not linear.
    pub fn largest_step(&self) -> f64 {
        ACCURATE / self.stiffness_rates[0].sqrt()
    }

    /// Largest step with which a chain at its static tension is sure to run, s: with twice that tension at the joints.
    pub fn rest_step(&self) -> f64 {
        let damping = 2.0 * self.tension.abs() * self.axial.factor / self.floor + self.axial.viscosity;
        self.largest_step().min(stable(self.answers.along * damping, self.stiffness_rates[0]))
    }
}

/// Largest step that is accurate, times the frequency of the chain's highest axial mode.
const ACCURATE: f64 = 1.3;

impl Cart {
    /// How fast dampers act on it, with running wheels at `spacing` from its middle, m.
    fn answers(&self, spacing: f64) -> Answers {
        let ends = self.ends();
        Answers {
            along: 4.0 / self.mass,
            ends: ends.rate(1.0, 0.0),
            front: ends.front,
            // A wheel lifts the cart and rolls it; both together do one or the other, twice as fast.
            wheels: 2.0 * ends.front.max(spacing * spacing / self.inertia[0]),
        }
    }

    /// How its ends answer forces across the chain.
    pub fn ends(&self) -> Ends {
        let turning = self.inertia[1].min(self.inertia[2]);
        let (front, rear) = (-self.centre[0], -self.centre[0] - self.length);
        let answer = |a: f64, b: f64| 1.0 / self.mass + a * b / turning;
        Ends { front: answer(front, front), rear: answer(rear, rear), between: answer(front, rear) }
    }
}

/// How fast dampers of one direction act at most, for each N s/m, 1/kg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answers {
    /// Joints along the chain, and across it.
    pub along: f64,
    pub ends: f64,
    /// Wheels across it: steering, and the running one that is damped most.
    pub front: f64,
    pub wheels: f64,
}

/// How a cart's ends answer forces across the chain, 1/kg: each to one on itself, and each to one on the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    front: f64,
    rear: f64,
    between: f64,
}

impl Ends {
    /// Fastest rate at which dampers act in an endless chain, 1/s: `joint` between each cart's rear and the next one's
    /// front, `wheels` between front and track, N s/m; of springs, N/m, the square of the highest frequency, 1/s². The
    /// larger eigenvalue of W D, with the ends' answers W and the dampers D = joint [[1, ±1], [±1, 1]] + wheels [[1,
    /// 0], [0, 0]] where neighbours move alike or against each other.
    pub fn rate(&self, joint: f64, wheels: f64) -> f64 {
        let trace = joint * (self.front + self.rear + 2.0 * self.between.abs()) + wheels * self.front;
        let determinant = (self.front * self.rear - self.between * self.between) * joint * wheels;
        0.5 * (trace + (trace * trace - 4.0 * determinant).max(0.0).sqrt())
    }
}

/// One number a cart, in packs; what all have in common, which the take-up takes, is left out. Empty of an empty list.
fn rows(list: &[f64], carts: usize) -> Vec<PackRow> {
    if list.is_empty() {
        return Vec::new();
    }
    let of = |i: usize| list.get(i).copied().unwrap_or(0.0);
    let mean = (0..carts).map(of).sum::<f64>() / carts as f64;
    let value = |i: usize| if i < carts { of(i) - mean } else { 0.0 };
    (0..carts.div_ceil(PACK)).map(|pack| std::array::from_fn(|lane| value(pack * PACK + lane))).collect()
}

fn tangent_of(contact: &input::ContactParameters, load: f64) -> f64 {
    tangent(contact.stiffness_n_per_m_n, contact.exponent, load)
}

fn damped(law: ContactLaw, contact: &input::ContactParameters, load: f64, mass: f64) -> Damped {
    let (stiffness, exponent, e) = (contact.stiffness_n_per_m_n, contact.exponent, contact.restitution);
    Damped {
        stiffness,
        exponent,
        factor: law::factor(law, e),
        viscosity: law::viscosity(law, e, stiffness, exponent, load, mass),
    }
}

/// Refuses numbers that no chain can have.
fn check(simulation: &Simulation) -> Result<(), Unfit> {
    let refuse = |place: &str, why: String| Err(Unfit { place: place.to_owned(), why });
    let (cart, joint) = (&simulation.cart, &simulation.joint);
    let (steering, running) = (&simulation.steering_wheel, &simulation.running_wheel);
    let (motors, control, sensor) = (&simulation.motors, &simulation.controller, &simulation.sensor);
    let contact = |name: &str, c: &input::ContactParameters| {
        [
            (format!("{name}.stiffness_n_per_m_n"), c.stiffness_n_per_m_n, 0.0, 1e15, true),
            (format!("{name}.exponent"), c.exponent, 1.0, 3.0, false),
            (format!("{name}.restitution"), c.restitution, 0.01, 1.0, false),
        ]
    };
    let wheel = |name: &str, w: &input::Wheel| {
        [
            (format!("{name}.radius_m"), w.radius_m, 0.0, 10.0, true),
            (format!("{name}.half_spacing_m"), w.half_spacing_m, 0.0, 10.0, false),
            (format!("{name}.height_m"), w.height_m, -10.0, 10.0, false),
            (format!("{name}.gap_m"), w.gap_m, 0.0, 1.0, false),
            (format!("{name}.rolling_resistance"), w.rolling_resistance, 0.0, 10.0, false),
        ]
    };
    let mut rows = vec![
        ("gravity_m_s2".to_owned(), simulation.gravity_m_s2, 0.0, 1e3, false),
        ("chain.tension_n".to_owned(), simulation.chain.tension_n, -1e6, 1e6, false),
        ("chain.speed_m_s".to_owned(), simulation.chain.speed_m_s, 0.0, 20.0, true),
        ("cart.mass_kg".to_owned(), cart.mass_kg, 0.0, 1e6, true),
        ("cart.centre_of_mass_m.0".to_owned(), cart.centre_of_mass_m[0], -10.0, 10.0, false),
        ("cart.centre_of_mass_m.1".to_owned(), cart.centre_of_mass_m[1], -10.0, 10.0, false),
        ("cart.motor_height_m".to_owned(), cart.motor_height_m, -10.0, 10.0, false),
        ("joint.approach_floor_m_s".to_owned(), joint.approach_floor_m_s, 0.0, 1e3, true),
        ("motors.length_m".to_owned(), motors.length_m, 0.0, 1e3, true),
        ("motors.force_n".to_owned(), motors.force_n, 0.0, 1e6, false),
        ("controller.proportional_n_s_per_m".to_owned(), control.proportional_n_s_per_m, 0.0, 1e9, false),
        ("controller.integral_n_per_m".to_owned(), control.integral_n_per_m, 0.0, 1e9, false),
        ("controller.derivative_n_s2_per_m".to_owned(), control.derivative_n_s2_per_m, 0.0, 1e9, false),
        ("controller.period_s".to_owned(), control.period_s, 1e-5, 1e3, false),
        ("sensor.lowpass_hz".to_owned(), sensor.lowpass_hz, 0.0, 1e6, true),
        ("sensor.rate_hz".to_owned(), sensor.rate_hz, 1.0, 2e4, false),
        ("sensor.photocell_s_m".to_owned(), sensor.photocell_s_m, -1e6, 1e6, false),
        ("sensor.trigger_length_m".to_owned(), sensor.trigger_length_m, 0.0, 1e3, false),
    ];
    rows.extend(simulation.supports_every_m.map(|every| ("supports_every_m".to_owned(), every, 0.05, 1e6, false)));
    rows.extend((0..3).map(|k| (format!("cart.inertia_kg_m2.{k}"), cart.inertia_kg_m2[k], 0.0, 1e6, true)));
    rows.extend(wheel("steering_wheel", steering));
    rows.extend(wheel("running_wheel", running));
    rows.extend(contact("steering_wheel.contact", &steering.contact));
    rows.extend(contact("running_wheel.contact", &running.contact));
    rows.extend(contact("joint.axial", &joint.axial));
    rows.extend(contact("joint.radial", &joint.radial));
    for (place, value, low, high, open) in rows {
        if !value.is_finite() || value > high || value < low || (open && value <= low) {
            let least = if open { "more than" } else { "at least" };
            return refuse(&place, format!("{value} must be {least} {low} and at most {high}"));
        }
    }
    for (k, piece) in simulation.track.elements.iter().enumerate() {
        let form = piece.form();
        let length = form.length();
        if !length.is_finite() || length < 0.0 {
            return refuse(&format!("track.elements.{k}"), format!("its length is {length} m"));
        }
        let (begin, end) = form.inclination();
        let steep = begin.abs().max(end.abs());
        // NaN is refused, too.
        let bearable = steep < 1.2 && form.turn().abs() < 100.0;
        if !bearable {
            return refuse(&format!("track.elements.{k}"), "it is steeper than 60° or turns without end".into());
        }
    }
    if !simulation.track.start.iter().all(|x| x.is_finite()) {
        return refuse("track.start", "it must be four numbers: x, y, z and heading".into());
    }
    let carts = simulation.chain.carts;
    if !(3..=100_000).contains(&carts) {
        return refuse("chain.carts", format!("{carts} must be between 3 and 100000"));
    }
    if sensor.cart == 0 || sensor.cart > carts {
        return refuse("sensor.cart", format!("{} must be between 1 and {carts}, the number of carts", sensor.cart));
    }
    if let Some(k) = motors.s_m.iter().position(|s| !s.is_finite()) {
        return refuse(&format!("motors.s_m.{k}"), "it must be a number".into());
    }
    Ok(())
}
