//! Where on the track features are taken: cells of two carts' length for means, and straights and curves for the rest.

use crate::chain_input::Simulation;
use crate::geometry::{CentreLine, Form};

/// What the track does at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceKind {
    Straight,
    Left,
    Right,
    /// A vertical curve.
    Vertical,
}

/// A piece of track long enough for statistics of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// Arc length, m.
    pub from: f64,
    pub to: f64,
    pub kind: PlaceKind,
}

/// The places of a track.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    /// m
    pub lap: f64,
    /// Cells of two pitches, as nearly as a whole number of them fills the lap: within one, what repeats with each cart
    /// cancels.
    pub cells: usize,
    pub zones: Vec<Zone>,
    /// Zone of each of [`Places::fine`] equal parts of the lap.
    zone_of: Vec<u16>,
}

/// A zone is at least so many carts long.
const LEAST: f64 = 2.0;

/// Parts of a cell of which the zone is looked up.
const FINE: usize = 16;

impl Places {
    pub fn new(simulation: &Simulation) -> Self {
        let line = simulation.track.centre_line();
        let (lap, pitch) = (line.length, line.length / simulation.chain.carts as f64);
        Places::of(lap, ((lap / (2.0 * pitch)).round() as usize).max(1), zones(&line, LEAST * pitch))
    }

    /// Places of a lap with so many cells, and zones that fill it.
    pub fn of(lap: f64, cells: usize, zones: Vec<Zone>) -> Self {
        let fine = cells * FINE;
        let middle = |k: usize| (k as f64 + 0.5) * lap / fine as f64;
        let holds = |s: f64| zones.iter().position(|z| z.from <= s && s < z.to).unwrap_or(0) as u16;
        Places { lap, cells, zone_of: (0..fine).map(|k| holds(middle(k))).collect(), zones }
    }

    /// Parts of the lap that a sample may be in: [`Places::cell`] and [`Places::zone`] take them.
    pub fn fine(&self) -> usize {
        self.zone_of.len()
    }

    /// Part of the lap in which a station lies.
    #[inline(always)]
    pub fn part(&self, station: f64) -> u32 {
        part(station, self.lap, self.fine())
    }

    pub fn cell(fine: usize) -> usize {
        fine / FINE
    }

    pub fn zone(&self, fine: usize) -> usize {
        self.zone_of[fine] as usize
    }
}

/// Which of so many equal parts of a lap a station lies in; any lap's.
#[inline(always)]
pub fn part(station: f64, lap: f64, parts: usize) -> u32 {
    let (share, most) = (station / lap, parts as u32 - 1);
    (((share - share.floor()) * f64::from(most + 1)) as u32).min(most)
}

/// The pieces of the centre line; short ones belong to the one before.
fn zones(line: &CentreLine, least: f64) -> Vec<Zone> {
    let mut zones: Vec<Zone> = Vec::new();
    for piece in &line.stretches {
        let kind = match piece.form {
            Form::Straight { .. } => PlaceKind::Straight,
            Form::Vertical { .. } => PlaceKind::Vertical,
            Form::Arc { turn, .. } | Form::Spiral { turn, .. } if turn > 0.0 => PlaceKind::Left,
            Form::Arc { .. } | Form::Spiral { .. } => PlaceKind::Right,
        };
        let to = piece.s + piece.length;
        match zones.last_mut() {
            Some(last) if last.kind == kind || piece.length < least => last.to = to,
            _ => zones.push(Zone { from: piece.s, to, kind }),
        }
    }
    zones
}
