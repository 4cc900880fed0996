//! Arc length as users count it: 0 at the layout's start, which may lie anywhere on a straight.

use crate::base::number::tidy;
use crate::base::trig;
use crate::compiled::Compiled;
use crate::geometry::{Piece, PieceKind, Point};
use crate::model::{Chutes, Motors, PlaceRow, StraightPlace};

/// A place on the centre line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// From the layout's start, m.
    pub s: f64,
    pub point: Point,
    /// Height, m.
    pub z: f64,
    /// rad in (-π, π]
    pub heading: f64,
}

impl Compiled {
    /// Arc length of the layout's start from where the centre line begins, m.
    pub fn start(&self) -> f64 {
        let first = if self.raised() { self.space.section(0, &self.layout) } else { 0.0 };
        self.layout.equipment.start.map_or(first, |place| self.past_first_vertex(place))
    }

    /// Where a place lies.
    pub fn station(&self, place: StraightPlace) -> Station {
        self.station_at(self.past_first_vertex(place) - self.start())
    }

    /// The place `s` past the layout's start, m.
    pub fn station_at(&self, s: f64) -> Station {
        let (point, z, heading) = if self.raised() {
            let frame = self.space.line.at(s + self.start());
            (Point::new(frame.position.x, frame.position.y), frame.position.z, frame.heading())
        } else {
            let (point, heading) = self.track.at(s + self.start());
            (point, 0.0, heading)
        };
        Station { s: self.round_trip(s), point, z, heading: trig::wrap(heading) }
    }

    /// The places of a row.
    pub fn stations(&self, row: &PlaceRow) -> Vec<Station> {
        row.places().map(|place| self.station(place)).collect()
    }

    /// The places of a row of chutes, and where it goes on.
    pub fn chutes(&self, chutes: &Chutes) -> Vec<Station> {
        chutes.rows().flat_map(|row| self.stations(row)).collect()
    }

    /// Arc length from the layout's start of what lies so far along the plan from vertex 0's outgoing tangent point, m.
    pub fn past_start(&self, plan: f64) -> f64 {
        let along = if self.raised() { self.space.from_plan(plan) } else { plan };
        self.round_trip(along - self.start())
    }

    /// Where the track's supports stand: at the start and every so many metres on.
    pub fn supports(&self) -> Vec<Station> {
        let Some(every) = self.layout.equipment.supports.map(|every| every.value).filter(|every| *every > 0.0) else {
            return Vec::new();
        };
        // The last one would stand on the first when the length is a multiple.
        let count = ((self.length() - 1e-6) / every).floor() as usize + 1;
        (0..count).map(|i| self.station_at(i as f64 * every)).collect()
    }

    /// Arc length of a station in the plan, from vertex 0's outgoing tangent point, m: where drawings put it.
    pub fn plan_arc_length(&self, station: &Station) -> f64 {
        if !self.raised() {
            return (station.s + self.start()).rem_euclid(self.track.length);
        }
        let along = |piece: &Piece| {
            let d = match piece.kind {
                PieceKind::Straight => (station.point - piece.begin).dot(Point::unit(piece.heading)),
                PieceKind::Arc { radius, turn, .. } => {
                    radius * trig::wrap(station.heading - piece.heading) * turn.signum()
                }
            };
            let d = d.clamp(0.0, piece.length.max(0.0));
            (piece.at(d).0.distance(station.point), piece.s + d)
        };
        let nearest = self.track.pieces.iter().map(along).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or(0.0, |(_, s)| s)
    }

    /// Where each motor begins. Motor j of N that stand evenly begins at (j + 1/2) S / N (design: chain model).
    pub fn motors(&self) -> Vec<Station> {
        match &self.layout.equipment.motors {
            Motors::Evenly { count } => {
                let pitch = self.length() / *count as f64;
                (0..*count).map(|j| self.station_at((j as f64 + 0.5) * pitch)).collect()
            }
            Motors::Rows(rows) => rows.iter().flat_map(|row| self.stations(row)).collect(),
        }
    }

    /// Arc length in [0, S) of one past or before it; what is a full lap to within rounding is 0.
    pub fn round_trip(&self, s: f64) -> f64 {
        let s = tidy(s.rem_euclid(self.length()));
        if self.length() - s < 1e-9 { 0.0 } else { s }
    }

    fn past_first_vertex(&self, place: StraightPlace) -> f64 {
        let begin = if self.raised() {
            self.space.section(place.section, &self.layout)
        } else {
            self.track.straight(place.section).s
        };
        begin + place.at
    }
}

#[cfg(test)]
mod tests {
    use crate::base::trig;
    use crate::compiled::fixture::{compile, on};
    use crate::geometry::Point;
    use crate::model::{Motors, PlaceRow, fixture};

    #[test]
    fn stations_count_from_the_start() {
        // Straights of 12 and 2 m, curves of 2π m; the start 1 m into the second straight.
        let mut layout = fixture::rectangle(20.0, 10.0, 4.0);
        layout.equipment.start = Some(on(1, 1.0));
        let compiled = compile(layout);
        let curve = trig::TAU;
        assert!((compiled.start() - (12.0 + curve + 1.0)).abs() < 1e-12);
        let start = compiled.station(on(1, 1.0));
        assert_eq!(start.s, 0.0);
        assert!(start.point.distance(Point::new(20.0, 5.0)) < 1e-12);
        assert!((start.heading - trig::FRAC_PI_2).abs() < 1e-12);
        // Behind the start, hence almost a lap ahead.
        assert!((compiled.station(on(1, 0.5)).s - (28.0 + 4.0 * curve - 0.5)).abs() < 1e-9);
        assert!((compiled.station(on(2, 3.0)).s - (1.0 + curve + 3.0)).abs() < 1e-9);
    }

    #[test]
    fn motors_stand_evenly_or_in_rows() {
        let mut layout = fixture::rectangle(20.0, 10.0, 4.0);
        let lap = 28.0 + 4.0 * trig::TAU;
        for (j, motor) in compile(layout.clone()).motors().iter().enumerate() {
            assert!((motor.s - (j as f64 + 0.5) * lap / 4.0).abs() < 1e-9);
        }
        layout.equipment.motors = Motors::Rows(vec![PlaceRow { place: on(0, 1.0), every: 2.5, count: 3 }]);
        let s: Vec<f64> = compile(layout).motors().iter().map(|m| m.s).collect();
        assert_eq!(s, [1.0, 3.5, 6.0]);
    }
}
