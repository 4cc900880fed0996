//! Reading `simulation.json`: what contradicts itself is refused, with its place and a way out.
//!
//! Ranges of single parameters are for dynamics to judge, which knows what it can integrate. Here is what every reader
//! relies on: the track's elements are elements, and chain, motors and sensor belong to that track.

use super::{CentreLinePiece, Simulation};
use crate::base::number::shortest;
use crate::source::steers;
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;
use std::fmt;

/// Beyond this no number of a simulation means anything; forces, stiffnesses and times are far below.
const FARTHEST: f64 = 1e15;
/// Lengths that are said twice agree to this, m.
const SAME: f64 = 1e-3;
/// Pitches by which a chain may be off its track: joints and take-up give less, but a user may try another number of
/// carts.
const OFF: f64 = 1.5;
/// Most elements, carts.
const ELEMENTS: usize = 10_000;
const CARTS: usize = 100_000;
/// Most motors, and most effects.
const MOTORS: usize = 10_000;
const EFFECTS: usize = 100;
/// Longest name, characters.
const NAME: usize = 200;

/// Why a text is no input of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub enum Unusable {
    /// No JSON, or not of this form; with line and column.
    Malformed(String),
    /// At least one.
    Contradictory(Vec<Contradiction>),
}

/// Something that cannot be.
#[derive(Clone, Debug, PartialEq)]
pub struct Contradiction {
    /// Path in the JSON, as `--set` names it.
    pub path: String,
    pub why: String,
    /// A way out.
    pub help: String,
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`: {}\n  help: {}", self.path, self.why, self.help)
    }
}

impl fmt::Display for Unusable {
    /// As what follows the file's name: one problem a line, each with its way out.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unusable::Malformed(why) => write!(f, " is not a simulation input: {why}"),
            Unusable::Contradictory(all) => {
                let (more, all) = (all.len().saturating_sub(MOST), &all[..all.len().min(MOST)]);
                let all: Vec<String> = all.iter().map(ToString::to_string).collect();
                write!(f, ", {}", all.join("\n  also "))?;
                if more > 0 { write!(f, "\n  and {more} more") } else { Ok(()) }
            }
        }
    }
}

/// Contradictions that are said at once.
const MOST: usize = 8;

impl std::error::Error for Unusable {}

impl Simulation {
    /// Reads `simulation.json`.
    ///
    /// # Errors
    ///
    /// [`Unusable`]
    pub fn read(bytes: &[u8]) -> Result<Simulation, Unusable> {
        let simulation: Simulation = serde_json::from_slice(bytes)
            .map_err(|why| Unusable::Malformed(crate::source::one_line(&why.to_string()).into_owned()))?;
        match simulation.contradictions() {
            found if found.is_empty() => Ok(simulation),
            found => Err(Unusable::Contradictory(found)),
        }
    }

    /// Everything that cannot be, in the order of the file; what follows from another mistake is left out.
    pub fn contradictions(&self) -> Vec<Contradiction> {
        let mut found = Found(Vec::new());
        found.leaves(self);
        found.elements(self);
        found.counts(self);
        if found.0.is_empty() {
            found.chain(self);
            found.places(self);
        }
        found.0
    }
}

struct Found(Vec<Contradiction>);

impl Found {
    fn add(&mut self, path: impl Into<String>, why: impl Into<String>, help: impl Into<String>) {
        self.0.push(Contradiction { path: path.into(), why: why.into(), help: help.into() });
    }

    /// Absurd numbers, and names that no file of ours has.
    fn leaves(&mut self, simulation: &Simulation) {
        if let Ok(value) = serde_json::to_value(simulation) {
            self.leaf(&value, String::new());
        }
    }

    fn leaf(&mut self, value: &Value, path: String) {
        let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        match value {
            Value::Number(x) if x.as_f64().is_none_or(|x| x.abs() > FARTHEST) => {
                let x = x.as_f64().unwrap_or(f64::INFINITY);
                let help = "write a number in the SI unit that the name ends in, or build the layout again";
                self.add(path, format!("{x:e} is beyond ±{FARTHEST:e}"), help);
            }
            Value::String(text) if text.chars().count() > NAME || text.contains(steers) => {
                self.add(
                    path,
                    format!("a name has at most {NAME} characters, and no control characters"),
                    "shorten it",
                );
            }
            Value::Object(fields) => fields.iter().for_each(|(key, value)| match key.contains(steers) {
                true => self.add(path.clone(), "a name below it holds a control character", "write it as plain text"),
                false => self.leaf(value, below(key)),
            }),
            Value::Array(items) => {
                items.iter().enumerate().for_each(|(k, value)| self.leaf(value, below(&k.to_string())));
            }
            _ => {}
        }
    }

    fn elements(&mut self, simulation: &Simulation) {
        let elements = &simulation.track.elements;
        if elements.is_empty() || elements.len() > ELEMENTS {
            let why = format!("{} elements, where a track has 1 to {ELEMENTS}", elements.len());
            self.add("track.elements", why, "list the centre line's straights and curves in driving order");
        }
        for (k, piece) in elements.iter().enumerate().take(ELEMENTS) {
            let mut low = |key: &str, x: f64| {
                if x.is_nan() || x <= 0.0 {
                    let why = format!("{} m is not above 0", shortest(x));
                    self.add(
                        format!("track.elements.{k}.{key}"),
                        why,
                        "write its length in metres, or leave the element out",
                    );
                }
            };
            let (turn, slopes) = match *piece {
                CentreLinePiece::Straight { length, slope } => {
                    low("length", length);
                    (0.0, vec![("slope", slope)])
                }
                CentreLinePiece::Arc { radius, turn_deg } => {
                    low("radius", radius);
                    (turn_deg, vec![])
                }
                CentreLinePiece::Vertical { radius, slope_from, slope_to } => {
                    low("radius", radius);
                    (0.0, vec![("slope_from", slope_from), ("slope_to", slope_to)])
                }
                CentreLinePiece::Spiral { radius, turn_deg, .. } => {
                    low("radius", radius);
                    (turn_deg, vec![])
                }
            };
            if turn.abs() > 36_000.0 {
                let why = format!("{}° are more than a hundred turns", shortest(turn));
                self.add(format!("track.elements.{k}.turn_deg"), why, "write the angle in degrees");
            }
            for (key, slope) in slopes {
                if slope.abs() > 100.0 {
                    let why = format!("{} is steeper than a wall", shortest(slope));
                    self.add(format!("track.elements.{k}.{key}"), why, "write rise over run: 0.1 for 100 mm a metre");
                }
            }
        }
    }

    fn counts(&mut self, simulation: &Simulation) {
        let (chain, cart) = (&simulation.chain, &simulation.cart);
        if !(3..=CARTS).contains(&chain.carts) {
            let why = format!("{} carts, where a chain has 3 to {CARTS}", chain.carts);
            self.add("chain.carts", why, "write the number of carts");
        }
        for (path, count, most) in
            [("motors.s_m", simulation.motors.s_m.len(), MOTORS), ("effects", simulation.effects.len(), EFFECTS)]
        {
            if count > most {
                self.add(path, format!("{count} are more than {most}"), "leave some out");
            }
        }
        for (path, x, of) in [
            ("chain.pitch_m", chain.pitch_m, "a pitch"),
            ("chain.track_length_m", chain.track_length_m, "a length"),
            ("cart.length_m", cart.length_m, "a length"),
            ("cart.mass_kg", cart.mass_kg, "a mass"),
            ("chain.speed_m_s", chain.speed_m_s, "a speed"),
            ("supports_every_m", simulation.supports_every_m.unwrap_or(1.0), "a distance"),
        ] {
            if x.is_nan() || x <= 0.0 {
                self.add(
                    path,
                    format!("{} is not above 0, as {of} is", shortest(x)),
                    "write it in the unit that the name ends in",
                );
            }
        }
        if chain.chord_excess_m < 0.0 {
            let why = format!("{} is below 0, but chords are shorter than their arcs", shortest(chain.chord_excess_m));
            self.add(
                "chain.chord_excess_m",
                why,
                "write what the chain is shorter than the centre line, or build the layout again",
            );
        }
    }

    /// The chain against its track.
    fn chain(&mut self, simulation: &Simulation) {
        let chain = &simulation.chain;
        let length: f64 = simulation.track.elements.iter().map(|piece| piece.form().length()).sum();
        let said = chain.track_length_m;
        let off = (length - said).abs();
        if off.is_nan() || off > SAME + 1e-6 * length {
            let why = format!("{} m contradict the elements, which are {} m long", shortest(said), metres(length));
            self.add("chain.track_length_m", why, format!("write {}, or correct the elements", metres(length)));
            return;
        }
        let cart = simulation.cart.length_m;
        if (chain.pitch_m - cart).abs() > 0.01 * cart {
            let why =
                format!("{} m contradict `cart.length_m`, which is {} m", shortest(chain.pitch_m), shortest(cart));
            self.add(
                "chain.pitch_m",
                why,
                "the pitch is the length of a cart between its joints: write one of the two in both",
            );
            return;
        }
        // Carts are chords of curves: on an arc of radius R none is longer than 2R, and what is cut off stays below
        // (π/2 − 1) of a chord.
        if chain.chord_excess_m > said * (FRAC_PI_2 - 1.0) {
            let why = format!(
                "{} m are more than chords can be shorter than {} m",
                shortest(chain.chord_excess_m),
                shortest(said)
            );
            self.add("chain.chord_excess_m", why, "build the layout again");
            return;
        }
        let left_over = said - chain.chord_excess_m - chain.carts as f64 * chain.pitch_m;
        if left_over.abs() > OFF * chain.pitch_m {
            let nearest = ((said - chain.chord_excess_m) / chain.pitch_m).round().max(3.0);
            let why = format!(
                "{} carts at {} m do not fit a track of {} m: {} m are left over",
                chain.carts,
                shortest(chain.pitch_m),
                shortest(said),
                metres(left_over)
            );
            self.add(
                "chain.carts",
                why,
                format!("write {nearest:.0}, the number that comes nearest, or another pitch"),
            );
        } else if (left_over - chain.left_over_m).abs() > SAME + 1e-6 * length {
            let why = format!(
                "{} m contradict track, chord excess and carts, which leave {} m",
                shortest(chain.left_over_m),
                metres(left_over)
            );
            self.add("chain.left_over_m", why, format!("write {}", metres(left_over)));
        }
    }

    /// Places on the track and in the chain.
    fn places(&mut self, simulation: &Simulation) {
        let (length, carts) = (simulation.chain.track_length_m, simulation.chain.carts);
        let on = |s: f64| (-SAME..=length + SAME).contains(&s);
        let motors = simulation.motors.s_m.iter().enumerate().map(|(k, s)| (format!("motors.s_m.{k}"), *s));
        let photocell = ("sensor.photocell_s_m".to_owned(), simulation.sensor.photocell_s_m);
        for (path, s) in motors.chain([photocell]) {
            if !on(s) {
                let why = format!("{} m is not on the track, which is {} m long", shortest(s), metres(length));
                self.add(path, why, "write an arc length from 0 up to the track's length");
            }
        }
        let cart = simulation.sensor.cart;
        if !(1..=carts).contains(&cart) {
            let help = format!("write a number from 1 to {carts}");
            self.add("sensor.cart", format!("there is no cart {cart} among {carts}"), help);
        }
    }
}

/// To a micrometre.
fn metres(x: f64) -> String {
    crate::base::number::trimmed(x, 6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::model::fixture;

    fn good() -> Value {
        let simulation = Simulation::new(&compile(fixture::rectangle(20.0, 10.0, 4.0)));
        serde_json::to_value(simulation).unwrap()
    }

    /// What is said of the input with other values at some places.
    fn told(changes: &[(&str, Value)]) -> String {
        let mut input = good();
        for (path, value) in changes {
            *input.pointer_mut(&format!("/{}", path.replace('.', "/"))).expect(path) = value.clone();
        }
        match Simulation::read(&serde_json::to_vec(&input).unwrap()) {
            Ok(_) => String::new(),
            Err(why) => why.to_string(),
        }
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(told(&[]), "");
    }

    #[test]
    fn contradictions_are_told_with_their_path_and_a_way_out() {
        let cases: &[(&[(&str, Value)], &str)] = &[
            (
                &[("chain.pitch_m", (-1.25).into())],
                ", `chain.pitch_m`: -1.25 is not above 0, as a pitch is\n  help: write it",
            ),
            (
                &[("chain.pitch_m", 1.5.into())],
                ", `chain.pitch_m`: 1.5 m contradict `cart.length_m`, which is 1.25 m\n  help: ",
            ),
            (
                &[("chain.track_length_m", 60.0.into())],
                ", `chain.track_length_m`: 60 m contradict the elements, which are 53.",
            ),
            (&[("chain.track_length_m", 0.0.into())], ", `chain.track_length_m`: 0 is not above 0"),
            (&[("track.elements.0.length", 3.0.into())], ", `chain.track_length_m`: "),
            (&[("track.elements.0.length", (-3.0).into())], ", `track.elements.0.length`: -3 m is not above 0"),
            (&[("track.elements.1.radius", 0.0.into())], ", `track.elements.1.radius`: 0 m is not above 0"),
            (&[("track.elements.1.turn_deg", 1e6.into())], ", `track.elements.1.turn_deg`: 1000000° are more"),
            (&[("track.elements.0.slope", 1e3.into())], ", `track.elements.0.slope`: 1000 is steeper than a wall"),
            (
                &[("track.elements", Value::Array(vec![]))],
                ", `track.elements`: 0 elements, where a track has 1 to 10000",
            ),
            (&[("chain.carts", 2.into())], ", `chain.carts`: 2 carts, where a chain has 3 to 100000"),
            (&[("chain.carts", 20.into())], ", `chain.carts`: 20 carts at 1.25 m do not fit a track of 53."),
            (&[("chain.carts", 4_000_000_000_u64.into())], ", `chain.carts`: 4000000000 carts, where"),
            (
                &[("chain.left_over_m", 1.0.into())],
                ", `chain.left_over_m`: 1 m contradict track, chord excess and carts, which leave ",
            ),
            (&[("chain.chord_excess_m", (-0.1).into())], ", `chain.chord_excess_m`: -0.1 is below 0"),
            (&[("chain.chord_excess_m", 50.0.into())], ", `chain.chord_excess_m`: 50 m are more than chords"),
            (&[("cart.mass_kg", 0.0.into())], ", `cart.mass_kg`: 0 is not above 0, as a mass is"),
            (&[("cart.length_m", (-1.0).into())], ", `cart.length_m`: -1 is not above 0"),
            (&[("chain.speed_m_s", (-2.0).into())], ", `chain.speed_m_s`: -2 is not above 0"),
            (&[("supports_every_m", 0.0.into())], ", `supports_every_m`: 0 is not above 0"),
            (
                &[("motors.force_n", 1e308.into())],
                ", `motors.force_n`: 1e308 is beyond ±1e15\n  help: write a number in the SI unit",
            ),
            (&[("track.start.2", (-1e300).into())], ", `track.start.2`: -1e300 is beyond"),
            (&[("motors.s_m", Value::Array(vec![99.0.into()]))], ", `motors.s_m.0`: 99 m is not on the track"),
            (&[("motors.s_m", Value::Array(vec![1.0.into(); 10_001]))], ", `motors.s_m`: 10001 are more than 10000"),
            (&[("sensor.photocell_s_m", (-5.0).into())], ", `sensor.photocell_s_m`: -5 m is not on the track"),
            (&[("sensor.cart", 0.into())], ", `sensor.cart`: there is no cart 0 among "),
            (&[("sensor.cart", 1000.into())], ", `sensor.cart`: there is no cart 1000 among "),
            (
                &[("name", "a\u{1b}[2J".into())],
                ", `name`: a name has at most 200 characters, and no control characters",
            ),
            (&[("cart.name", "x".repeat(300).into())], ", `cart.name`: a name has at most 200"),
            (&[("chain.carts", (-1).into())], " is not a simulation input: invalid value: integer `-1`"),
            (&[("chain.pitch_m", Value::Null)], " is not a simulation input: invalid type: null, expected f64"),
            (
                &[("chain.pitch_m", (-1).into()), ("cart.mass_kg", 0.into())],
                ", `chain.pitch_m`: -1 is not above 0, as a pitch is\n  \
                 help: write it in the unit that the name ends in\n  also `cart.mass_kg`: ",
            ),
        ];
        for (changes, expected) in cases {
            let told = told(changes);
            assert!(told.starts_with(expected), "{changes:?}\n{told}\n{expected}");
            assert!(told.contains("\n  help: ") || told.contains(" at line "), "{told}");
        }
        let endless = br#"{"name": "a", "gravity_m_s2": 1e999}"#;
        assert!(matches!(Simulation::read(endless), Err(Unusable::Malformed(why)) if why.contains("out of range")));
    }
}
