//! Places of the equipment on the centre line.

use crate::compiled::{Compiled, Station};
use crate::geometry::Point;
use crate::model::{EquipmentKind, StraightPlace};
use crate::placement::Rectangle;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MarkKind {
    Start,
    Photocell,
    Induction,
    Chute,
    Motor,
    Support,
    /// A scanner, a gate or a lift.
    Station,
}

/// One thing on the centre line.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub kind: MarkKind,
    /// Arc length from vertex 0's outgoing tangent point, m.
    pub s: f64,
    pub point: Point,
    /// Of travel, rad.
    pub heading: f64,
    /// Along the centre line from `s` on, m; 0 for what has no length.
    pub length: f64,
    /// What stands beside it: a name or number; in a row of chutes only the middle one has it.
    pub label: Option<String>,
    /// Corners of what equipment of a declared kind covers beside the band; empty for all other.
    pub covers: Vec<Rectangle>,
    /// +1 where it stands outside of the loop, -1 inside.
    pub out: f64,
    /// The conveyor that feeds it, from where it begins to its end.
    pub conveyor: Option<(Point, Point)>,
}

/// Everything on the track: start, photocell, inductions, chutes, motors, supports, each in driving order.
pub fn marks(compiled: &Compiled) -> Vec<Mark> {
    let equipment = &compiled.layout.equipment;
    let mut marks = Vec::new();
    let mut add = |kind, station: Station, label| {
        let length = if kind == MarkKind::Motor { compiled.layout.drive.motor.length } else { 0.0 };
        let s = compiled.plan_arc_length(&station);
        let (point, heading, covers) = (station.point, station.heading, Vec::new());
        marks.push(Mark { kind, s, point, heading, length, label, covers, out: 1.0, conveyor: None });
    };
    add(MarkKind::Start, compiled.station_at(0.0), Some("s = 0".to_owned()));
    if let Some(place) = equipment.photocell {
        add(MarkKind::Photocell, compiled.station(place), Some("photocell".to_owned()));
    }
    for (i, induction) in equipment.inductions.iter().enumerate() {
        add(MarkKind::Induction, compiled.station(induction.place), Some(equipment.induction_name(i)));
    }
    for chutes in &equipment.chutes {
        let count = chutes.count();
        let text = if count == 1 { chutes.name.clone() } else { format!("{} {count}×", chutes.name) };
        for (i, station) in compiled.chutes(chutes).into_iter().enumerate() {
            add(MarkKind::Chute, station, (i == count / 2).then(|| text.clone()));
        }
    }
    for (name, station) in stations(compiled) {
        add(MarkKind::Station, station, Some(name));
    }
    for (j, station) in compiled.motors().into_iter().enumerate() {
        add(MarkKind::Motor, station, Some(format!("M{}", j + 1)));
    }
    for station in compiled.supports() {
        add(MarkKind::Support, station, None);
    }
    covered(compiled, &mut marks);
    marks
}

/// Scanners, gates and lifts of declared kinds by name, and the other scanners, which have none, by number.
pub fn stations(compiled: &Compiled) -> Vec<(String, Station)> {
    let declared = &compiled.layout.equipment.declared;
    let is_station = |kind| matches!(kind, EquipmentKind::Scanner | EquipmentKind::Gate | EquipmentKind::Lift);
    let placed = compiled.placement.placed.iter().filter(|placed| is_station(declared[placed.declared].of.kind));
    let named =
        placed.map(|placed| (declared[placed.declared].one(placed.number), compiled.station(placed.place))).collect();
    let mut stations: Vec<(String, Station)> = named;
    let others: Vec<StraightPlace> = compiled.layout.own_scanners().collect();
    for (i, place) in others.iter().enumerate() {
        let name = if others.len() > 1 { format!("scanner {}", i + 1) } else { "scanner".to_owned() };
        stations.push((name, compiled.station(*place)));
    }
    stations
}

/// Gives marks of equipment of declared kinds their footprints and conveyors.
fn covered(compiled: &Compiled, marks: &mut [Mark]) {
    let winding = super::winding(&compiled.track);
    for placed in &compiled.placement.placed {
        let declared = &compiled.layout.equipment.declared[placed.declared];
        let kind = match declared.of.kind {
            EquipmentKind::Induction => MarkKind::Induction,
            EquipmentKind::Chute => MarkKind::Chute,
            EquipmentKind::Scanner | EquipmentKind::Gate | EquipmentKind::Lift => MarkKind::Station,
        };
        let point = compiled.station(placed.place).point;
        let stands =
            |mark: &&mut Mark| mark.kind == kind && mark.covers.is_empty() && mark.point.distance(point) < 1e-4;
        let Some(mark) = marks.iter_mut().find(stands) else { continue };
        mark.covers = placed.footprint.covers.clone();
        mark.out = if placed.sides.contains(&-winding) { 1.0 } else { -1.0 };
        mark.conveyor = declared.fed.and_then(|from| Some((from, placed.footprint.conveyor_end(from)?)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::{compile, on};
    use crate::model::fixture;
    use crate::source::Spanned;

    #[test]
    fn motors_and_supports_stand_evenly_from_the_start_mark() {
        let mut layout = fixture::rectangle(20.0, 10.0, 3.0);
        layout.equipment.start = Some(on(1, 1.0));
        layout.equipment.supports = Some(Spanned::new(2.5, fixture::span()));
        let compiled = compile(layout);
        let (length, marks) = (compiled.track.length, marks(&compiled));
        let start = marks.iter().find(|m| m.kind == MarkKind::Start).expect("start");
        assert!(start.point.distance(Point::new(20.0, 4.0)) < 1e-12);
        let ahead = |kind: MarkKind| -> Vec<f64> {
            marks.iter().filter(|m| m.kind == kind).map(|m| (m.s - start.s).rem_euclid(length)).collect()
        };
        for (j, s) in ahead(MarkKind::Motor).into_iter().enumerate() {
            assert!((s - (j as f64 + 0.5) * length / 4.0).abs() < 1e-9);
        }
        // 36 + 6π = 54.85 m
        let supports = ahead(MarkKind::Support);
        assert_eq!(supports.len(), 22);
        assert!((supports[21] - 52.5).abs() < 1e-9);
    }

    #[test]
    fn scanners_without_a_name_are_numbered() {
        let mut layout = fixture::rectangle(20.0, 10.0, 3.0);
        layout.capacity.scanners = vec![on(0, 2.0)];
        let named = |layout: &crate::model::Layout| -> Vec<String> {
            stations(&compile(layout.clone())).into_iter().map(|(name, _)| name).collect()
        };
        assert_eq!(named(&layout), ["scanner"]);
        layout.capacity.scanners.push(on(2, 3.0));
        assert_eq!(named(&layout), ["scanner 1", "scanner 2"]);
        let marks = marks(&compile(layout));
        let points: Vec<Point> = marks.iter().filter(|m| m.kind == MarkKind::Station).map(|m| m.point).collect();
        // Straights begin at the curve's end, 3 m behind the vertex.
        assert!(points[0].distance(Point::new(5.0, 0.0)) < 1e-9, "{points:?}");
        assert!(points[1].distance(Point::new(14.0, 10.0)) < 1e-9, "{points:?}");
    }

    #[test]
    fn a_row_of_chutes_is_named_once() {
        let mut layout = fixture::rectangle(20.0, 10.0, 3.0);
        let row = crate::model::PlaceRow { place: on(2, 1.0), every: 1.25, count: 7 };
        layout.equipment.chutes = vec![crate::model::Chutes { name: "row_a".to_owned(), row, more: Vec::new() }];
        let marks = marks(&compile(layout));
        let chutes: Vec<&Mark> = marks.iter().filter(|m| m.kind == MarkKind::Chute).collect();
        assert_eq!(chutes.len(), 7);
        assert_eq!(chutes.iter().filter_map(|m| m.label.as_deref()).collect::<Vec<_>>(), ["row_a 7×"]);
        assert!(chutes[6].point.distance(Point::new(17.0 - 1.0 - 7.5, 10.0)) < 1e-9);
    }
}
