//! What a hall is set out from: coordinates from the drawing's origin, and how far the track lies from the walls.

use crate::compiled::{Compiled, Station};
use crate::geometry::{Piece, PieceKind, Point, Polygon, Track};
use crate::model::{Chutes, Coordinate, Layout};

use super::PlanCurve;
use super::marks::stations;

/// Directions that differ by less are parallel, rad: a millimetre over ten metres.
const PARALLEL: f64 = 1e-4;
/// Least common length of a straight and a wall beside it, m.
const BESIDE: f64 = 0.1;
/// Coordinates that differ by less are one, m.
const SAME: f64 = 1e-6;

/// A point with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct SettingPoint {
    pub name: String,
    /// From the drawing's origin, m.
    pub at: Point,
    /// Arc length from the layout's start, m, of what stands on the track.
    pub s: Option<f64>,
    /// Height, m, of what stands on a track with heights.
    pub z: Option<f64>,
}

/// Points of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct PointGroup {
    pub title: &'static str,
    pub points: Vec<SettingPoint>,
}

/// Coordinates of everything that is set out: the track's vertices, its equipment, the building's corners, the obstacles.
/// Groups without points are left out.
pub fn points(compiled: &Compiled) -> Vec<PointGroup> {
    let layout = &compiled.layout;
    let fixed = |name: String, at: Point| SettingPoint { name, at: from_origin(layout, at), s: None, z: None };
    let vertices = compiled.track.corners.iter().zip(&layout.vertices);
    let vertices = vertices.map(|(corner, vertex)| fixed(vertex.name.clone(), corner.point)).collect();
    let corners = layout.building.iter().flat_map(|b| b.polygon.points()).enumerate();
    let corners = corners.map(|(i, p)| fixed(format!("corner {}", i + 1), *p)).collect();
    let obstacles = layout.obstacles.iter().flat_map(|o| {
        let points = outline(&o.polygon);
        let several = points.len() > 2;
        let name = move |i: usize| match (i, several) {
            (_, true) => format!("{}, corner {}", o.name, i + 1),
            (0, false) => format!("{}, lower left", o.name),
            (_, false) => format!("{}, upper right", o.name),
        };
        points.into_iter().enumerate().map(move |(i, p)| (name(i), p))
    });
    let obstacles = obstacles.map(|(name, p)| fixed(name, p)).collect();
    let groups = [
        PointGroup { title: "vertices of the track", points: vertices },
        PointGroup { title: "equipment, on the centre line", points: equipment(compiled) },
        PointGroup { title: "where feeding conveyors begin", points: feeding(compiled) },
        PointGroup { title: "building, counter-clockwise", points: corners },
        PointGroup { title: "obstacles", points: obstacles },
    ];
    groups.into_iter().filter(|group| !group.points.is_empty()).collect()
}

/// A point's coordinates on the drawing.
pub fn from_origin(layout: &Layout, p: Point) -> Point {
    p - layout.drawing.origin
}

/// Every corner, or two opposite ones of a rectangle along the axes.
fn outline(polygon: &Polygon) -> Vec<Point> {
    let points = polygon.points();
    let (low, high) = polygon.bounds();
    let along = points.iter().all(|p| [low.x, high.x].contains(&p.x) && [low.y, high.y].contains(&p.y));
    if points.len() == 4 && along { vec![low, high] } else { points.to_vec() }
}

fn equipment(compiled: &Compiled) -> Vec<SettingPoint> {
    let (layout, equipment) = (&compiled.layout, &compiled.layout.equipment);
    let mut points = Vec::new();
    let mut add = |name: String, station: Station| {
        let z = compiled.raised().then_some(station.z);
        points.push(SettingPoint { name, at: from_origin(layout, station.point), s: Some(station.s), z });
    };
    add("s = 0".to_owned(), compiled.station_at(0.0));
    if let Some(place) = equipment.photocell {
        add("photocell".to_owned(), compiled.station(place));
    }
    for (i, induction) in equipment.inductions.iter().enumerate() {
        add(equipment.induction_name(i), compiled.station(induction.place));
    }
    for chutes in &equipment.chutes {
        let ends = ends(compiled, chutes);
        let several = ends.len() > 1;
        for (number, station) in ends {
            let name = if several { format!("{}, chute {number}", chutes.name) } else { chutes.name.clone() };
            add(name, station);
        }
    }
    for (name, station) in stations(compiled) {
        add(name, station);
    }
    for (i, station) in compiled.motors().into_iter().enumerate() {
        add(format!("M{}, begin", i + 1), station);
    }
    points
}

/// Where what feeds equipment begins, by the name of what is fed.
fn feeding(compiled: &Compiled) -> Vec<SettingPoint> {
    let declared = compiled.layout.equipment.declared.iter();
    let point = |(name, from): (&String, Point)| {
        let at = from_origin(&compiled.layout, from);
        SettingPoint { name: name.clone(), at, s: None, z: None }
    };
    declared.filter_map(|d| Some(point((&d.name, d.fed?)))).collect()
}

/// The first and the last place of a row, and of each part of one that stands in several, with their numbers.
fn ends(compiled: &Compiled, chutes: &Chutes) -> Vec<(usize, Station)> {
    let mut ends = Vec::new();
    let mut before = 0;
    for row in chutes.rows() {
        let stations = compiled.stations(row);
        let last = stations.len();
        let numbered = stations.into_iter().enumerate().filter(|(i, _)| *i == 0 || *i + 1 == last);
        ends.extend(numbered.map(|(i, station)| (before + i + 1, station)));
        before += last;
    }
    ends
}

/// Coordinates (m, of the hall) of the building's corners and of its axes, in order, each once.
pub fn ordinates(layout: &Layout, coordinate: Coordinate) -> Vec<f64> {
    let of = |p: &Point| if coordinate == Coordinate::X { p.x } else { p.y };
    let corners = layout.building.iter().flat_map(|b| b.polygon.points()).map(of);
    let axes = layout.drawing.axes.iter().filter(|axis| axis.coordinate == coordinate).map(|axis| axis.at);
    let mut all: Vec<f64> = corners.chain(axes).collect();
    if !all.is_empty() {
        all.push(of(&layout.drawing.origin));
    }
    all.sort_by(f64::total_cmp);
    all.dedup_by(|b, a| *b - *a < SAME);
    all
}

/// How far the centre line lies from a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallDistance {
    /// Nearest points of the stretch over which the distance holds, on the centre line, and those of the wall opposite.
    pub track: (Point, Point),
    pub wall: (Point, Point),
    /// m
    pub distance: f64,
    /// Whether the centre line comes nowhere nearer to a wall.
    pub least: bool,
}

/// Distances from the building's walls: of every straight that runs beside one, and where the track is nearest to a wall.
pub fn wall_distances(compiled: &Compiled) -> Vec<WallDistance> {
    let Some(building) = &compiled.layout.building else { return Vec::new() };
    let (track, polygon) = (&compiled.track, &building.polygon);
    let mut distances: Vec<WallDistance> =
        track.pieces.iter().filter_map(|piece| beside(piece, compiled, polygon)).collect();
    if let Some((on_track, on_wall)) = nearest(track, polygon) {
        let least = on_track.distance(on_wall);
        let mut shown = false;
        for distance in &mut distances {
            distance.least = distance.distance < least + SAME;
            shown |= distance.least;
        }
        if !shown && least > SAME {
            let (track, wall) = ((on_track, on_track), (on_wall, on_wall));
            distances.push(WallDistance { track, wall, distance: least, least: true });
        }
    }
    distances
}

/// The distance of a straight from the nearest wall that is parallel to it, with nothing between in some place.
fn beside(piece: &Piece, compiled: &Compiled, polygon: &Polygon) -> Option<WallDistance> {
    if piece.kind != PieceKind::Straight || piece.length < BESIDE {
        return None;
    }
    let along = Point::unit(piece.heading);
    let mut best: Option<WallDistance> = None;
    for (a, b) in polygon.edges() {
        let edge = (b - a) * (1.0 / a.distance(b));
        // The hall lies to the left of each edge.
        let distance = edge.cross(piece.begin - a);
        if edge.cross(along).abs() > PARALLEL || distance <= 0.0 {
            continue;
        }
        let (from, to) = ((a - piece.begin).dot(along), (b - piece.begin).dot(along));
        let (from, to) = (from.min(to).max(0.0), from.max(to).min(piece.length));
        if to - from < BESIDE || best.is_some_and(|best| best.distance <= distance) {
            continue;
        }
        let on_track = (piece.begin + along * from, piece.begin + along * to);
        let foot = |p: Point| p - edge.left() * edge.cross(p - a);
        let wall = (foot(on_track.0), foot(on_track.1));
        let obstacles = || compiled.layout.obstacles.iter().flat_map(|o| o.polygon.edges());
        let others = || compiled.track.pieces.iter().filter(|other| other.s != piece.s);
        let is_open = |k: u8| {
            let t = f64::from(k) / 10.0;
            let sight = (on_track.0.lerp(on_track.1, t), wall.0.lerp(wall.1, t));
            let walls = polygon.edges().filter(|edge| *edge != (a, b));
            walls.chain(obstacles()).all(|edge| !segments_cross(sight, edge))
                && others().all(|other| !blocks(other, sight))
        };
        if (0..=10).any(is_open) {
            best = Some(WallDistance { track: on_track, wall, distance, least: false });
        }
    }
    best
}

/// Whether a piece lies across a line of sight.
fn blocks(piece: &Piece, sight: (Point, Point)) -> bool {
    let parts = if piece.kind == PieceKind::Straight { 1 } else { 12 };
    (0..parts).any(|i| {
        let at = |k: usize| piece.at(piece.length * k as f64 / f64::from(parts)).0;
        segments_cross(sight, (at(i as usize), at(i as usize + 1)))
    })
}

fn segments_cross((a, b): (Point, Point), (c, d): (Point, Point)) -> bool {
    let side = |p: Point, q: Point, r: Point| (q - p).cross(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Where the centre line and the outline are nearest, the point of the track first.
fn nearest(track: &Track, polygon: &Polygon) -> Option<(Point, Point)> {
    let pairs = super::side(track, 0.0)
        .into_iter()
        .flat_map(|curve| polygon.edges().filter_map(move |(a, b)| nearest_of(&curve, a, b)));
    pairs.min_by(|p, q| p.0.distance(p.1).total_cmp(&q.0.distance(q.1)))
}

/// The nearest points of a curve and a segment that do not cross.
fn nearest_of(curve: &PlanCurve, a: Point, b: Point) -> Option<(Point, Point)> {
    let length = a.distance(b);
    let along = (b - a) * (1.0 / length);
    let foot = |p: Point| a + along * (p - a).dot(along).clamp(0.0, length);
    let mut pairs: Vec<(Point, Point)> = [curve.begin(), curve.end()].map(|p| (p, foot(p))).to_vec();
    match *curve {
        PlanCurve::Line { begin, end } => {
            let heading = (end - begin) * (1.0 / begin.distance(end));
            let on = |p: Point| begin + heading * (p - begin).dot(heading).clamp(0.0, begin.distance(end));
            pairs.extend([a, b].map(|p| (on(p), p)));
        }
        PlanCurve::Arc { centre, radius, .. } => {
            let across = along.left();
            let radial = [a, b].map(|p| (p - centre) * (1.0 / p.distance(centre)));
            for direction in radial.into_iter().chain([across, -across]) {
                let p = centre + direction * radius;
                if super::offset::fraction(curve, p).is_some() {
                    pairs.push((p, foot(p)));
                }
            }
        }
    }
    pairs.into_iter().min_by(|p, q| p.0.distance(p.1).total_cmp(&q.0.distance(q.1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::plan::samples;
    use crate::model::GridAxis;

    #[test]
    fn coordinates_count_from_the_stated_origin() {
        let mut compiled = samples::ten_vertices();
        compiled.layout.drawing.origin = Point::new(2.0, 1.0);
        let groups = points(&compiled);
        let find = |name: &str| {
            groups.iter().flat_map(|g| &g.points).find(|p| p.name == name).unwrap_or_else(|| panic!("{name}")).clone()
        };
        assert_eq!(find("P2").at, Point::new(24.0, 6.0));
        assert_eq!(find("O2, lower left").at, Point::new(46.0, 23.0));
        assert_eq!(find("O1, corner 2").at, Point::new(28.5, 13.5));
        assert!(find("s = 0").s.is_some_and(|s| s == 0.0));
        // A row is set out by its ends: 17 times 1.25 m apart, along +x.
        let (first, last) = (find("row_a, chute 1"), find("row_a, chute 18"));
        assert!(last.at.distance(first.at + Point::new(17.0 * 1.25, 0.0)) < 1e-9, "{first:?} {last:?}");
        assert!((last.s.unwrap() - first.s.unwrap() - 21.25).abs() < 1e-9);
    }

    #[test]
    fn ordinates_are_those_of_corners_axes_and_origin() {
        let mut layout = samples::ten_vertices().layout;
        let axis =
            |at| GridAxis { name: format!("{at}"), coordinate: Coordinate::X, at, span: crate::model::fixture::span() };
        layout.drawing.axes = vec![axis(14.0), axis(28.0)];
        layout.drawing.origin = Point::new(0.0, -3.0);
        assert_eq!(ordinates(&layout, Coordinate::X), [0.0, 14.0, 28.0, 68.0, 69.9, 86.0, 112.0]);
        assert_eq!(ordinates(&layout, Coordinate::Y), [-3.0, 0.0, 8.0, 35.0, 41.0, 42.3, 62.0]);
    }

    #[test]
    fn straights_tell_their_distance_from_the_wall_beside() {
        let compiled = samples::ten_vertices();
        let distances = wall_distances(&compiled);
        // P2..P3 runs along y = 7 over the wall y = 0, P8..P9 along y = 55 under y = 62.
        assert_eq!(distances.iter().filter(|d| (d.distance - 7.0).abs() < 1e-9).count(), 2, "{distances:?}");
        let least: Vec<&WallDistance> = distances.iter().filter(|d| d.least).collect();
        assert_eq!(least.len(), 1);
        // Nothing found by walking along the track is nearer, and something is as near.
        let polygon = &compiled.layout.building.as_ref().expect("a building").polygon;
        let steps = (compiled.track.length / 0.01) as usize;
        let walked = (0..steps).map(|i| polygon.distance_to_outline(compiled.track.at(i as f64 * 0.01).0));
        let walked = walked.fold(f64::INFINITY, f64::min);
        assert!((walked - least[0].distance).abs() < 1e-4, "{walked} {least:?}");
    }

    #[test]
    fn no_building_has_no_walls() {
        assert!(wall_distances(&samples::rectangle()).is_empty());
        assert!(ordinates(&samples::rectangle().layout, Coordinate::X).is_empty());
    }
}
