//! The plan of a track as its picture needs it.

use super::data::{Part, Plan, Rounded};
use crate::report::lap_track::LapTrack;

/// Longest step between points of the centre line, m, and how many points there may be: on an arc of 2 m, a chord of
/// 0.25 m is off by 4 mm.
const STEP: f64 = 0.25;
const FEWEST: f64 = 200.0;
const MOST: f64 = 4000.0;

/// Without layers and spots.
pub fn plan(track: &LapTrack) -> Plan {
    let lap = track.line.length;
    let count = (lap / STEP).ceil().clamp(FEWEST, MOST) as usize;
    let points: Vec<_> = (0..count).map(|k| track.line.at(lap * k as f64 / count as f64).position).collect();
    let heights: Vec<f64> = points.iter().map(|p| p.z).collect();
    let level = heights.iter().all(|z| (z - heights[0]).abs() < 1e-3);
    let parts = track.parts.iter().map(|part| Part {
        from: to_mm(part.from),
        to: to_mm(part.to),
        kind: part.kind.class(),
        name: part.name.clone(),
    });
    Plan {
        lap_m: (1e6 * lap).round() / 1e6,
        x: Rounded::to(points.iter().map(|p| p.x).collect(), 3),
        y: Rounded::to(points.iter().map(|p| p.y).collect(), 3),
        z: Rounded::to(if level { Vec::new() } else { heights }, 3),
        parts: parts.collect(),
        motors: track.motors.iter().map(|(from, to)| Rounded::to(vec![*from, *to], 3)).collect(),
        layers: Vec::new(),
        shown: 0,
        spots: Vec::new(),
    }
}

fn to_mm(metres: f64) -> f64 {
    (1e3 * metres).round() / 1e3
}
