//! DIMENSION entities, each with the block that shows it where a reader does not draw dimensions itself.

use crate::base::number::fixed;
use crate::base::trig;
use crate::geometry::Point;

use super::tags::escape;
use super::writer::{Align, Writer};

const LAYER: &str = "DIMENSIONS";
/// Kinds of dimensions as group 70 has them; an ordinate of x has its flag besides.
const ALIGNED: i64 = 1;
const RADIUS: i64 = 4;
const ORDINATE: i64 = 6;
const OF_X: i64 = 64;

/// Decimals of lengths, as in the dimension style.
const DECIMALS: usize = 3;

/// A name for the block of the next dimension.
fn block_name(dxf: &Writer) -> String {
    format!("*D{}", dxf.blocks.len() + 1)
}

/// Text that reads from below or from the right along this heading (rad).
pub fn upright(heading: f64) -> f64 {
    let heading = trig::wrap(heading);
    if trig::cos(heading) < -1e-9 || (trig::cos(heading).abs() <= 1e-9 && heading < 0.0) {
        trig::wrap(heading + trig::PI)
    } else {
        heading
    }
}

fn arrow(dxf: &mut Writer, tip: Point, along: Point) {
    let size = dxf.text_height;
    let (base, across) = (tip - along * size, along.left() * (size / 6.0));
    dxf.triangle(LAYER, [tip, base + across, base - across]);
}

/// The distance from `a` to `b`, on a line that lies `aside` to the left of the way there; `note` stands behind the
/// number.
pub fn aligned(dxf: &mut Writer, a: Point, b: Point, aside: f64, note: &str) {
    let (name, tall) = (block_name(dxf), dxf.text_height);
    let length = a.distance(b);
    let along = (b - a) * (1.0 / length);
    let across = along.left() * aside;
    let (from, to) = (a + across, b + across);
    let angle = upright(along.heading());
    let above = Point::unit(angle).left() * (0.8 * tall);
    // Beside its line where that is shorter than the number.
    let number = fixed(length, DECIMALS) + note;
    let middle = from.lerp(to, 0.5) + above;
    dxf.block(name.clone(), 1, |dxf| {
        dxf.line(LAYER, from, to);
        if aside.abs() > 1e-9 {
            let out = across * (1.0 / aside.abs());
            for (p, end) in [(a, from), (b, to)] {
                dxf.line(LAYER, p + out * (0.4 * tall), end + out * (0.5 * tall));
            }
        }
        if length > 3.0 * tall {
            arrow(dxf, to, along);
            arrow(dxf, from, -along);
        }
        dxf.sized_text(LAYER, middle, angle, tall, Align::Middle, &number);
        for p in [a, b, to] {
            dxf.node("DEFPOINTS", p);
        }
    });
    let text = if note.is_empty() { String::new() } else { format!("<>{}", escape(note)) };
    dxf.dimension(LAYER, &name, ALIGNED, to, middle, length, &text);
    dxf.tags.text(100, "AcDbAlignedDimension");
    dxf.tags.point(13, a);
    dxf.tags.point(14, b);
}

/// The radius of an arc about `centre` that goes through `on_arc`, with its turn (rad) behind it. The number stands
/// inside the arc.
pub fn radius(dxf: &mut Writer, centre: Point, on_arc: Point, turn: f64, gap: f64) {
    let (name, tall) = (block_name(dxf), dxf.text_height);
    let radius = centre.distance(on_arc);
    let out = (on_arc - centre) * (1.0 / radius);
    let note = format!(" {}°", fixed(turn.abs() * 180.0 / trig::PI, 2));
    let number = format!("R{}{note}", fixed(radius, DECIMALS));
    let angle = upright(out.heading());
    let half = 0.42 * tall * number.chars().count() as f64;
    let at = on_arc - out * (gap + tall + half);
    let middle = at + Point::unit(angle).left() * (0.8 * tall);
    dxf.block(name.clone(), 1, |dxf| {
        dxf.line(LAYER, at - out * half, on_arc);
        arrow(dxf, on_arc, out);
        dxf.sized_text(LAYER, middle, angle, tall, Align::Middle, &number);
        for p in [centre, on_arc] {
            dxf.node("DEFPOINTS", p);
        }
    });
    dxf.dimension(LAYER, &name, RADIUS, centre, middle, radius, &format!("<>{}", escape(&note)));
    dxf.tags.text(100, "AcDbRadialDimension");
    dxf.tags.point(15, on_arc);
    dxf.tags.real(40, gap + tall);
}

/// The x or y coordinate of a point from the origin, at the end of a line from it.
pub fn ordinate(dxf: &mut Writer, origin: Point, at: Point, end: Point, of_x: bool) {
    let (name, tall) = (block_name(dxf), dxf.text_height);
    let value = if of_x { at.x - origin.x } else { at.y - origin.y };
    let number = fixed(value, DECIMALS);
    let along = if of_x { Point::new(0.0, -1.0) } else { Point::new(-1.0, 0.0) };
    let angle = if of_x { trig::FRAC_PI_2 } else { 0.0 };
    let middle = end + along * (0.42 * tall * number.len() as f64 + 0.5 * tall);
    dxf.block(name.clone(), 1, |dxf| {
        let gap = along * (0.4 * tall);
        if at.distance(end) > 0.5 * tall {
            dxf.line(LAYER, at + gap, end);
        }
        dxf.sized_text(LAYER, middle, angle, tall, Align::Middle, &number);
        for p in [origin, at] {
            dxf.node("DEFPOINTS", p);
        }
    });
    dxf.dimension(LAYER, &name, ORDINATE + if of_x { OF_X } else { 0 }, origin, middle, value, "");
    dxf.tags.text(100, "AcDbOrdinateDimension");
    dxf.tags.point(13, at);
    dxf.tags.point(14, end);
}
