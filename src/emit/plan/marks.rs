//! Places of the equipment on the centre line.

use crate::geometry::{Point, Track};
use crate::model::{Layout, Motors, Place, Row};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MarkKind {
    Start,
    Photocell,
    Induction,
    Chute,
    Motor,
    Support,
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
}

/// Largest number of motors or supports that a drawing shows one by one.
const MOST: usize = 10_000;

/// Everything on the track: start, photocell, inductions, chutes, motors, supports, each in driving order.
pub fn marks(layout: &Layout, track: &Track) -> Vec<Mark> {
    let equipment = &layout.equipment;
    let start = equipment.start.map_or(0.0, |place| arc_length(track, &place));
    let mut marks = Vec::new();
    let mut add = |kind, s: f64, length, label| {
        let s = s.rem_euclid(track.length);
        let (point, heading) = track.at(s);
        marks.push(Mark { kind, s, point, heading, length, label });
    };
    add(MarkKind::Start, start, 0.0, Some("s = 0".to_owned()));
    if let Some(place) = &equipment.photocell {
        add(MarkKind::Photocell, arc_length(track, place), 0.0, Some("photocell".to_owned()));
    }
    for induction in &equipment.inductions {
        add(MarkKind::Induction, arc_length(track, &induction.place), 0.0, Some(induction.name.clone()));
    }
    for chutes in &equipment.chutes {
        let count = chutes.row.count;
        for (i, s) in places(track, &chutes.row).enumerate() {
            let label = (i == count / 2).then(|| match count {
                1 => chutes.name.clone(),
                _ => format!("{} {count} ×", chutes.name),
            });
            add(MarkKind::Chute, s, 0.0, label);
        }
    }
    let motor = layout.drive.motor.length;
    let motors: Vec<f64> = match &equipment.motors {
        Motors::Evenly { count } => {
            let pitch = track.length / *count as f64;
            (0..(*count).min(MOST)).map(|j| start + (j as f64 + 0.5) * pitch).collect()
        }
        Motors::Rows(rows) => rows.iter().flat_map(|row| places(track, row)).collect(),
    };
    for (j, s) in motors.into_iter().enumerate() {
        add(MarkKind::Motor, s, motor, Some(format!("M{}", j + 1)));
    }
    if let Some(every) = equipment.supports
        && every.value > 0.0
    {
        // The last one would stand on the first when the length is a multiple.
        let count = ((track.length - 1e-6) / every.value).floor() as usize + 1;
        for i in 0..count.min(MOST) {
            add(MarkKind::Support, start + i as f64 * every.value, 0.0, None);
        }
    }
    marks
}

fn arc_length(track: &Track, place: &Place) -> f64 {
    track.straight(place.section).s + place.at
}

fn places<'a>(track: &'a Track, row: &'a Row) -> impl Iterator<Item = f64> + 'a {
    let first = arc_length(track, &row.place);
    (0..row.count.min(MOST)).map(move |i| first + i as f64 * row.every)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::fixture;
    use crate::source::Spanned;

    #[test]
    fn motors_stand_evenly_from_the_start_mark() {
        let mut layout = fixture::rectangle(20.0, 10.0, 3.0);
        layout.equipment.start = Some(Place { section: 1, at: 1.0, span: fixture::span() });
        layout.equipment.supports = Some(Spanned::new(2.5, fixture::span()));
        let track = Track::new(&layout.corners());
        let marks = marks(&layout, &track);
        let start = marks.iter().find(|m| m.kind == MarkKind::Start).expect("start");
        assert!(start.point.distance(Point::new(20.0, 4.0)) < 1e-12);
        let motors: Vec<&Mark> = marks.iter().filter(|m| m.kind == MarkKind::Motor).collect();
        assert_eq!(motors.len(), 4);
        for (j, motor) in motors.iter().enumerate() {
            let ahead = (motor.s - start.s).rem_euclid(track.length);
            assert!((ahead - (j as f64 + 0.5) * track.length / 4.0).abs() < 1e-9);
        }
        // 36 + 6π = 54.85 m
        assert_eq!(marks.iter().filter(|m| m.kind == MarkKind::Support).count(), 22);
    }
}
