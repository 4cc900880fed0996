//! Where effects may sit in a layout.

use crate::chain_input::{CentreLinePiece, Simulation};
use crate::signal::{Channel, FORCES};

/// A place of an effect: what says it, in words and in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Site {
    pub words: String,
    pub fixed: Vec<(&'static str, f64)>,
}

impl Site {
    /// A number that says the place.
    pub fn of(&self, name: &str) -> Option<f64> {
        self.fixed.iter().find(|(n, _)| *n == name).map(|(_, x)| *x)
    }
}

/// An effect without a place.
pub fn everywhere(_: &Simulation) -> Vec<Site> {
    vec![Site { words: String::new(), fixed: Vec::new() }]
}

/// Each motor.
pub fn motors(simulation: &Simulation) -> Vec<Site> {
    let site = |(k, s): (usize, &f64)| Site {
        words: format!("motor {} at {:.1} m", k + 1, s),
        fixed: vec![("motor", k as f64 + 1.0)],
    };
    simulation.motors.s_m.iter().enumerate().map(site).collect()
}

/// Curves of the track: number from 1, arc length where each begins and ends, m.
pub fn curves(simulation: &Simulation) -> Vec<(usize, f64, f64)> {
    let mut found: Vec<(usize, f64, f64)> = Vec::new();
    let mut s = 0.0;
    let mut open = false;
    for piece in &simulation.track.elements {
        let end = s + piece.form().length();
        let bends = matches!(piece, CentreLinePiece::Arc { .. } | CentreLinePiece::Spiral { .. });
        match found.last_mut() {
            Some(last) if bends && open => last.2 = end,
            _ if bends => found.push((found.len() + 1, s, end)),
            _ => {}
        }
        open = bends;
        s = end;
    }
    found
}

/// Each curve.
pub fn each_curve(simulation: &Simulation) -> Vec<Site> {
    let site = |(k, from, to): (usize, f64, f64)| Site {
        words: format!("curve {k}, {from:.1} to {to:.1} m"),
        fixed: vec![("curve", k as f64)],
    };
    curves(simulation).into_iter().map(site).collect()
}

/// Each force channel, numbered from 1.
pub fn channels(_: &Simulation) -> Vec<Site> {
    let site =
        |(k, c): (usize, &Channel)| Site { words: c.name().to_owned(), fixed: vec![("channel", k as f64 + 1.0)] };
    Channel::FORCES.iter().enumerate().map(site).collect()
}

/// Ordered pairs of force channels.
pub fn ordered_pairs(_: &Simulation) -> Vec<Site> {
    pairs().filter(|(a, b)| a != b).map(|(a, b)| pair(a, b, "of", "into")).collect()
}

/// Pairs of force channels.
pub fn unordered_pairs(_: &Simulation) -> Vec<Site> {
    pairs().filter(|(a, b)| a < b).map(|(a, b)| pair(a, b, "", "and")).collect()
}

fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..FORCES).flat_map(|a| (0..FORCES).map(move |b| (a, b)))
}

fn pair(a: usize, b: usize, before: &str, between: &str) -> Site {
    let (x, y) = (Channel::FORCES[a].name(), Channel::FORCES[b].name());
    Site {
        words: format!("{before} {x} {between} {y}").trim().to_owned(),
        fixed: vec![("first", a as f64 + 1.0), ("second", b as f64 + 1.0)],
    }
}
