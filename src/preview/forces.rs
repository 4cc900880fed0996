//! What a simulated run says of each straight and curve, where there is one of this very track.

use crate::base::number::fixed;
use crate::chain_input::Simulation;
use crate::compiled::Compiled;
use crate::geometry::PieceKind;
use crate::signal::measures::{TrackSection, by_section};
use crate::signal::position::{self, Position};
use crate::signal::{Channel, Entry, Run};
use crate::source::{input, root, shown};
use std::collections::BTreeMap;
use std::path::Path;

/// Forces that are told, each with what it is.
const TOLD: [(Channel, &str); 5] = [
    (Channel::JointXi, "pull of the joint"),
    (Channel::SteerLeft, "steering wheel, left"),
    (Channel::SteerRight, "steering wheel, right"),
    (Channel::RunLeft, "running wheel, left"),
    (Channel::RunRight, "running wheel, right"),
];

/// A run and the input that it was made from.
#[derive(Debug)]
pub struct Forces {
    simulation: Simulation,
    run: Run,
}

impl Forces {
    /// Reads a run, and the `simulation.json` beside it.
    ///
    /// # Errors
    ///
    /// What cannot be read, and why, in a sentence.
    pub fn read(path: &Path) -> Result<Forces, String> {
        let run = Entry::read(path).map_err(|why| why.to_string())?.1;
        let beside = path.parent().unwrap_or(Path::new("")).join("simulation.json");
        let bytes = root::read_given(&beside, input::JSON_LIMIT)
            .map_err(|why| format!("{}: {why}; `lss simulate` writes it beside its run", shown(&beside)))?;
        let simulation = Simulation::read(&bytes).map_err(|why| format!("{}: {why}", shown(&beside)))?;
        Ok(Forces { simulation, run })
    }

    /// Where the run's samples were taken.
    ///
    /// # Errors
    ///
    /// The run is of another track, or does not tell its places.
    pub fn places(&self, compiled: &Compiled) -> Result<Position, &'static str> {
        if Simulation::new(compiled).track != self.simulation.track {
            return Err("the run is of another track: `lss simulate` makes one of this");
        }
        position::position(&self.run, self.simulation.chain.track_length_m)
            .ok_or("the run does not tell where its carts are")
    }

    /// Mean and extremes on each straight and curve (`s3`, `c3`), in words.
    ///
    /// # Errors
    ///
    /// As [`Forces::places`].
    pub fn of(&self, compiled: &Compiled) -> Result<BTreeMap<String, Vec<String>>, &'static str> {
        let place = self.places(compiled)?;
        let lap = self.simulation.chain.track_length_m;
        let pieces: Vec<_> = compiled.track.pieces.iter().filter(|piece| piece.length > 1e-9).collect();
        let sections: Vec<TrackSection> = pieces
            .iter()
            .map(|piece| {
                let kind = if piece.kind == PieceKind::Straight { 's' } else { 'c' };
                let name = format!("{kind}{}", piece.vertex);
                let [from, to] = [piece.s, piece.s + piece.length].map(|plan| compiled.past_start(plan));
                TrackSection { name, from, to }
            })
            .collect();
        let mut told: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for (channel, words) in TOLD {
            let Some(samples) = self.run.channels.get(&channel) else { continue };
            for (section, found) in sections.iter().zip(by_section(&place.s, samples, lap, &sections)) {
                let Some(found) = found else { continue };
                let [mean, min, max] = [found.mean, found.min, found.max].map(|x| fixed(x, 0));
                let line = format!("{words}: {mean} N ({min} … {max})");
                told.entry(section.name.clone()).or_default().push(line);
            }
        }
        Ok(told)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::emit::samples;
    use crate::model::fixture::rectangle;
    use crate::signal::Sidecar;

    /// A run whose steering force is the arc length itself: what is told of a place is where it is, on a level track and
    /// along slopes.
    #[test]
    fn forces_are_told_of_the_place_where_they_were_measured() {
        for compiled in [compile(rectangle(30.0, 20.0, 4.0)), samples::raised()] {
            let simulation = Simulation::new(&compiled);
            let (lap, speed) = (simulation.chain.track_length_m, 2.0);
            let time: Vec<f64> = (0..).map(|k| f64::from(k) * 0.01).take_while(|t| t * speed < 2.0 * lap).collect();
            let s: Vec<f64> = time.iter().map(|t| (t * speed).rem_euclid(lap)).collect();
            let trigger = s.iter().map(|s| if *s < 0.5 { 1.0 } else { 0.0 }).collect();
            let sidecar = Sidecar { sensor_cart: 1, speed_setpoint: speed, laps: 2, ..Sidecar::default() };
            let channels = [(Channel::SteerLeft, s), (Channel::Trigger, trigger)].into();
            let forces = Forces { simulation, run: Run { time, channels, sidecar } };
            let told = forces.of(&compiled).unwrap();
            assert_eq!(told.len(), 8, "{told:?}");
            for piece in &compiled.track.pieces {
                let kind = if piece.kind == PieceKind::Straight { 's' } else { 'c' };
                // Where the middle of its plan lies in space.
                let (point, _) = piece.at(piece.length / 2.0);
                let metres = (0..(100.0 * lap) as usize).map(|k| f64::from(k as u32) / 100.0);
                let away = |s: &f64| compiled.station_at(*s).point.distance(point);
                let middle = metres.min_by(|a, b| away(a).total_cmp(&away(b))).unwrap();
                let [line] = told[&format!("{kind}{}", piece.vertex)].as_slice() else { panic!("{told:?}") };
                let mean = line.split(": ").nth(1).and_then(|t| t.split(' ').next()).unwrap().parse::<f64>().unwrap();
                assert!((mean - middle).abs() <= 1.0, "{line} in the middle of {middle}");
            }
            // Of another track there is nothing to say but that.
            assert!(forces.of(&compile(rectangle(31.0, 20.0, 4.0))).is_err());
        }
    }
}
