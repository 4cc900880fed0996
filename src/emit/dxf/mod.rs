//! `drawing.dxf`: the layout in metres on named layers, with true arcs, for CAD programs to snap to.

mod dimensions;
mod elements;
mod sheet;
mod tables;
mod tags;
mod writer;

#[cfg(test)]
mod tests;

use crate::compiled::Compiled;
use crate::emit::plan::{self, Mark, MarkKind, PlanCurve};
use crate::emit::{DrawError, svg};
use crate::geometry::{PieceKind, Point, bounds};
use crate::model::Coordinate;

use writer::{Layer, Writer};

const fn layer(name: &'static str, colour: u8, line_type: &'static str, weight: u16) -> Layer {
    Layer { name, colour, line_type, weight }
}

/// How many of the layers every drawing has; the others are of equipment of declared kinds.
const BESIDE: usize = 21;

static LAYERS: [Layer; BESIDE + 2] = [
    layer("TRACK_CENTRE", 1, "CENTER", 25),
    layer("TRACK_LEFT", 5, "Continuous", 50),
    layer("TRACK_RIGHT", 5, "Continuous", 50),
    layer("ELEMENT_JOINTS", 4, "Continuous", 25),
    layer("BUILDING", 7, "Continuous", 70),
    layer("BUILDING_CLEARANCE", 8, "DASHED", 18),
    layer("OBSTACLES", 30, "Continuous", 50),
    layer("OBSTACLE_CLEARANCE", 30, "DASHED", 18),
    layer("VERTICES", 6, "Continuous", 25),
    layer("MOTORS", 150, "Continuous", 35),
    layer("INDUCTIONS", 40, "Continuous", 35),
    layer("CHUTES", 94, "Continuous", 35),
    layer("SUPPORTS", 8, "Continuous", 25),
    layer("SENSORS", 200, "Continuous", 35),
    layer("TEXT", 7, "Continuous", 18),
    layer("ELEMENTS", 8, "Continuous", 18),
    layer("DIMENSIONS", 3, "Continuous", 18),
    layer("GRID_AXES", 9, "CENTER", 18),
    layer("SHEET", 7, "Continuous", 25),
    layer("VIEWPORTS", 9, "Continuous", 18),
    layer("DEFPOINTS", 7, "Continuous", 18),
    layer("STATIONS", 200, "Continuous", 35),
    layer("CONVEYORS", 40, "DASHED", 25),
];

/// Height of text on the sheet, mm.
const TEXT: f64 = 1.8;

/// The layout as DXF R2000: the model in metres, and a sheet with a window on it.
///
/// # Errors
/// [`DrawError::Extent`] when no standard sheet and scale can show the layout.
pub fn drawing(compiled: &Compiled) -> Result<String, DrawError> {
    let furniture = svg::furniture(compiled)?;
    let (layout, track) = (&compiled.layout, &compiled.track);
    let height = TEXT * furniture.sheet.scale / 1000.0;
    let layers: &[Layer] = if layout.equipment.declared.is_empty() { &LAYERS[..BESIDE] } else { &LAYERS };
    let mut dxf = Writer::new(layers, height);

    if let Some(building) = &layout.building {
        dxf.polygon("BUILDING", building.polygon.points());
        plan::inset(&building.polygon, building.clearance).iter().for_each(|c| dxf.curve("BUILDING_CLEARANCE", c));
    }
    for obstacle in &layout.obstacles {
        dxf.polygon("OBSTACLES", obstacle.polygon.points());
        plan::outset(&obstacle.polygon, obstacle.clearance).iter().for_each(|c| dxf.curve("OBSTACLE_CLEARANCE", c));
        let (low, high) = obstacle.polygon.bounds();
        dxf.text("TEXT", (low + high) * 0.5, 0.0, &obstacle.name);
    }
    let half = layout.width.value / 2.0;
    for (name, shift) in [("TRACK_CENTRE", 0.0), ("TRACK_LEFT", half), ("TRACK_RIGHT", -half)] {
        plan::side(track, shift).iter().for_each(|curve| dxf.curve(name, curve));
    }
    for piece in &compiled.pieces {
        let across = Point::unit(piece.place.heading).left() * half;
        dxf.line("ELEMENT_JOINTS", piece.place.position - across, piece.place.position + across);
    }
    for (corner, vertex) in track.corners.iter().zip(&layout.vertices) {
        dxf.node("VERTICES", corner.point);
        dxf.text("TEXT", corner.point + Point::new(0.0, 1.5 * height), 0.0, &vertex.name);
    }
    elements::elements(&mut dxf, compiled);
    dimensions(&mut dxf, compiled, half, height);
    grid_axes(&mut dxf, compiled, height);
    for mark in plan::marks(compiled) {
        equipment(&mut dxf, compiled, &mark, half, height);
    }
    let paper = sheet::sheet(&mut dxf, &furniture);
    Ok(tables::finish(dxf, &paper))
}

/// Lengths inside the loop beside the band, radii and turns, distances from walls, coordinates of the building and its
/// axes from the origin.
fn dimensions(dxf: &mut Writer, compiled: &Compiled, half: f64, height: f64) {
    let (layout, track) = (&compiled.layout, &compiled.track);
    let winding = plan::winding(track);
    let distance = half + height;
    for piece in track.pieces.iter().filter(|piece| piece.length > 1e-9) {
        match piece.kind {
            PieceKind::Straight => {
                dimensions::aligned(dxf, piece.begin, piece.end, winding * (half + 2.0 * height), "");
            }
            PieceKind::Arc { centre, turn, .. } => {
                dimensions::radius(dxf, centre, piece.at(piece.length / 2.0).0, turn, half);
            }
        }
    }
    for wall in plan::wall_distances(compiled) {
        let middle = |(p, q): (Point, Point)| p.lerp(q, 0.5);
        dimensions::aligned(dxf, middle(wall.track), middle(wall.wall), 0.0, if wall.least { " min" } else { "" });
    }
    let (low, high) = extent(compiled);
    let origin = layout.drawing.origin;
    for x in plan::ordinates(layout, Coordinate::X).into_iter().filter(|x| *x >= low.x && *x <= high.x) {
        let at = Point::new(x, low.y);
        dimensions::ordinate(dxf, origin, at, at - Point::new(0.0, 3.0 * height), true);
    }
    for y in plan::ordinates(layout, Coordinate::Y).into_iter().filter(|y| *y >= low.y && *y <= high.y) {
        let at = Point::new(low.x, y);
        dimensions::ordinate(dxf, origin, at, at - Point::new(3.0 * height, 0.0), false);
    }
    dxf.circle("DIMENSIONS", origin, height);
    for across in [Point::new(1.5 * height, 0.0), Point::new(0.0, 1.5 * height)] {
        dxf.line("DIMENSIONS", origin - across, origin + across);
    }
    dxf.text("TEXT", origin - Point::new(2.5 * height, 2.0 * height), 0.0, "0, 0");
    // Outside: slopes and heights.
    for climb in plan::climbs(compiled) {
        let (at, heading) = track.at(climb.middle.rem_euclid(track.length));
        let outside = Point::unit(heading).left() * (-winding * distance);
        dxf.text("TEXT", at + outside, dimensions::upright(heading), &climb.text(2, 3));
    }
}

/// Smallest and largest coordinates of building, obstacles and centre line, m.
fn extent(compiled: &Compiled) -> (Point, Point) {
    let layout = &compiled.layout;
    let polygons = layout.building.iter().map(|b| &b.polygon).chain(layout.obstacles.iter().map(|o| &o.polygon));
    let corners = polygons.flat_map(|polygon| polygon.points().iter().copied());
    bounds(corners.chain(compiled.track.corners.iter().map(|corner| corner.point)))
}

/// The building's axes, with their names in circles at the upper and the right end.
fn grid_axes(dxf: &mut Writer, compiled: &Compiled, height: f64) {
    let (low, high) = extent(compiled);
    let (beyond, radius) = (4.0 * height, 1.5 * height);
    for axis in &compiled.layout.drawing.axes {
        let (from, to, out) = match axis.coordinate {
            Coordinate::X => {
                (Point::new(axis.at, low.y), Point::new(axis.at, high.y + beyond), Point::new(0.0, radius))
            }
            Coordinate::Y => {
                (Point::new(low.x, axis.at), Point::new(high.x + beyond, axis.at), Point::new(radius, 0.0))
            }
        };
        dxf.line("GRID_AXES", from, to);
        dxf.circle("GRID_AXES", to + out, radius);
        dxf.text("GRID_AXES", to + out, 0.0, &axis.name);
    }
}

fn equipment(dxf: &mut Writer, compiled: &Compiled, mark: &Mark, half: f64, height: f64) {
    let track = &compiled.track;
    let along = Point::unit(mark.heading);
    let out = along.left() * (-plan::winding(track) * mark.out);
    let at = |ahead: f64, aside: f64| mark.point + along * ahead + out * aside;
    let tall = half.max(0.2);
    match mark.kind {
        MarkKind::Start => dxf.line("SENSORS", at(0.0, -1.5 * half), at(0.0, 1.5 * half)),
        MarkKind::Photocell => {
            dxf.line("SENSORS", at(0.0, -1.25 * half), at(0.0, 1.25 * half));
            dxf.circle("SENSORS", at(0.0, 1.4 * half), 0.15 * half);
        }
        MarkKind::Induction | MarkKind::Chute | MarkKind::Station if !mark.covers.is_empty() => {
            let name = match mark.kind {
                MarkKind::Induction => "INDUCTIONS",
                MarkKind::Chute => "CHUTES",
                _ => "STATIONS",
            };
            mark.covers.iter().for_each(|corners| dxf.polygon(name, corners));
            if let Some((from, to)) = mark.conveyor {
                dxf.line("CONVEYORS", from, to);
            }
        }
        MarkKind::Station => {
            let corners = [(-0.15, 0.0), (0.15, 0.0), (0.15, tall), (-0.15, tall)];
            dxf.polygon("STATIONS", &corners.map(|(ahead, aside)| at(ahead, half + aside)));
        }
        MarkKind::Induction => {
            dxf.polygon("INDUCTIONS", &[at(0.0, half), at(0.4 * tall, half + tall), at(-0.4 * tall, half + tall)]);
        }
        MarkKind::Chute => {
            let corners = [at(-0.3, half), at(0.3, half), at(0.2, half + tall), at(-0.2, half + tall)];
            dxf.polygon("CHUTES", &corners);
        }
        MarkKind::Motor => {
            let sides = [0.45, -0.45].map(|k| plan::stretch(track, mark.s, mark.length, k * half));
            sides.iter().flatten().for_each(|curve| dxf.curve("MOTORS", curve));
            if let [left, right] = &sides
                && let (Some(a), Some(b), Some(c), Some(d)) = (left.first(), right.first(), left.last(), right.last())
            {
                dxf.line("MOTORS", PlanCurve::begin(a), PlanCurve::begin(b));
                dxf.line("MOTORS", PlanCurve::end(c), PlanCurve::end(d));
            }
        }
        MarkKind::Support => {
            for side in [-half, half] {
                let d = 0.08;
                dxf.polygon("SUPPORTS", &[at(-d, side - d), at(d, side - d), at(d, side + d), at(-d, side + d)]);
            }
        }
    }
    if let Some(label) = &mark.label {
        let beyond = |p: &Point| (*p - mark.point).dot(out);
        let tall = mark.covers.iter().flatten().map(beyond).fold(half + tall, f64::max);
        dxf.text("TEXT", at(mark.length / 2.0, tall + height), 0.0, label);
    }
}
