//! `drawing.dxf`: the layout in metres on named layers, with true arcs, for CAD programs to snap to.

mod writer;

#[cfg(test)]
mod tests;

use crate::base::trig;
use crate::compiled::Compiled;
use crate::emit::plan::{self, Mark, MarkKind, PlanCurve};
use crate::geometry::{PieceKind, Point, bounds};

use writer::{Layer, Writer};

const fn layer(name: &'static str, colour: u8, line_type: &'static str, weight: u16) -> Layer {
    Layer { name, colour, line_type, weight }
}

const LAYERS: [Layer; 15] = [
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
];

/// The layout as DXF R2000.
pub fn drawing(compiled: &Compiled) -> String {
    let (layout, track) = (&compiled.layout, &compiled.track);
    let (low, high) = bounds(track.corners.iter().map(|corner| corner.point));
    // Readable with the whole layout on a screen, in steps of 5 cm.
    let height = ((high - low).norm() / 250.0 / 0.05).round().clamp(1.0, 100.0) * 0.05;
    let mut dxf = Writer::new(&LAYERS, height);

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
    dimensions(&mut dxf, compiled, half + height);
    for mark in plan::marks(compiled) {
        equipment(&mut dxf, compiled, &mark, half, height);
    }
    dxf.finish()
}

/// Lengths, radii and turns, inside the loop beside the band.
fn dimensions(dxf: &mut Writer, compiled: &Compiled, distance: f64) {
    let track = &compiled.track;
    let winding = plan::winding(track);
    for piece in track.pieces.iter().filter(|piece| piece.length > 1e-9) {
        let (at, heading) = piece.at(piece.length / 2.0);
        let inside = Point::unit(heading).left() * (winding * distance);
        let upright = if trig::cos(heading) < -1e-9 { heading + trig::PI } else { heading };
        let text = match piece.kind {
            PieceKind::Straight => format!("{:.3}", piece.length),
            PieceKind::Arc { radius, turn, .. } => format!("R{radius:.3} {:.2}°", turn.abs() * 180.0 / trig::PI),
        };
        dxf.text("TEXT", at + inside, trig::wrap(upright), &text);
    }
    // Outside: slopes and heights.
    for climb in plan::climbs(compiled) {
        let (at, heading) = track.at(climb.middle.rem_euclid(track.length));
        let outside = Point::unit(heading).left() * (-winding * distance);
        let upright = if trig::cos(heading) < -1e-9 { heading + trig::PI } else { heading };
        dxf.text("TEXT", at + outside, trig::wrap(upright), &climb.text(2, 3));
    }
}

fn equipment(dxf: &mut Writer, compiled: &Compiled, mark: &Mark, half: f64, height: f64) {
    let track = &compiled.track;
    let along = Point::unit(mark.heading);
    let out = along.left() * -plan::winding(track);
    let at = |ahead: f64, aside: f64| mark.point + along * ahead + out * aside;
    let tall = half.max(0.2);
    match mark.kind {
        MarkKind::Start => dxf.line("SENSORS", at(0.0, -1.5 * half), at(0.0, 1.5 * half)),
        MarkKind::Photocell => {
            dxf.line("SENSORS", at(0.0, -1.25 * half), at(0.0, 1.25 * half));
            dxf.circle("SENSORS", at(0.0, 1.4 * half), 0.15 * half);
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
        dxf.text("TEXT", at(mark.length / 2.0, half + tall + height), 0.0, label);
    }
}
