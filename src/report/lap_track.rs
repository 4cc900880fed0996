//! The track as the page shades and names it.

use crate::base::number::trimmed;
use crate::chain_input::{CentreLinePiece, Simulation, Track};
use crate::geometry::CentreLine;

/// Kinds of stretches that are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartKind {
    Straight,
    Curve,
    /// A vertical curve or an inclined straight.
    Climb,
    Spiral,
}

impl PartKind {
    /// Its class in the style sheet.
    pub fn class(self) -> &'static str {
        match self {
            PartKind::Straight => "",
            PartKind::Curve => "curve",
            PartKind::Climb => "climb",
            PartKind::Spiral => "spiral",
        }
    }
}

/// A stretch of the track with the name that hotspots use.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackPart {
    pub kind: PartKind,
    /// Arc length where it begins and ends, m.
    pub from: f64,
    pub to: f64,
    /// `curve 4 (4 m, left)`; of a straight, the one before it: `the straight behind curve 4`.
    pub name: String,
}

/// The centre line with its parts and motors.
pub struct LapTrack {
    pub line: CentreLine,
    pub parts: Vec<TrackPart>,
    /// Arc lengths where motors begin and end, m.
    pub motors: Vec<(f64, f64)>,
}

impl LapTrack {
    pub fn new(simulation: &Simulation) -> Self {
        let motors = simulation.motors.s_m.iter().map(|s| (*s, s + simulation.motors.length_m)).collect();
        LapTrack { motors, ..LapTrack::without_motors(&simulation.track) }
    }

    /// Of a track whose motors are not shown.
    pub fn without_motors(track: &Track) -> Self {
        let line = track.centre_line();
        let (mut curves, mut spirals, mut verticals) = (0, 0, 0);
        let mut parts: Vec<TrackPart> = Vec::new();
        let mut s = 0.0;
        let mut last_curve: Option<String> = None;
        let hand = |turn: f64| if turn > 0.0 { "left" } else { "right" };
        for piece in &track.elements {
            let to = s + piece.form().length();
            let (kind, name) = match *piece {
                CentreLinePiece::Straight { slope, .. } if slope != 0.0 => {
                    let way = if slope > 0.0 { "up" } else { "down" };
                    (PartKind::Climb, format!("the slope {way} ({} %)", trimmed(slope.abs() * 100.0, 1)))
                }
                CentreLinePiece::Straight { .. } => {
                    let name = match &last_curve {
                        Some(curve) => format!("the straight behind {curve}"),
                        None => "the straight at the start".to_owned(),
                    };
                    (PartKind::Straight, name)
                }
                CentreLinePiece::Arc { radius, turn_deg } => {
                    curves += 1;
                    last_curve = Some(format!("curve {curves}"));
                    (PartKind::Curve, format!("curve {curves} ({} m, {})", trimmed(radius, 3), hand(turn_deg)))
                }
                CentreLinePiece::Spiral { radius, turn_deg, .. } => {
                    spirals += 1;
                    last_curve = Some(format!("spiral {spirals}"));
                    (PartKind::Spiral, format!("spiral {spirals} ({} m, {})", trimmed(radius, 3), hand(turn_deg)))
                }
                CentreLinePiece::Vertical { radius, .. } => {
                    verticals += 1;
                    (PartKind::Climb, format!("vertical curve {verticals} ({} m)", trimmed(radius, 3)))
                }
            };
            parts.push(TrackPart { kind, from: s, to, name });
            s = to;
        }
        LapTrack { line, parts, motors: Vec::new() }
    }

    /// The part at arc length `s`, in [0, S).
    pub fn part(&self, s: f64) -> Option<&TrackPart> {
        self.parts.iter().find(|part| part.from <= s && s < part.to)
    }
}
