//! A plan as source text of the language.

use std::fmt::Write;

use super::{DrawnArea, Plan};
use crate::base::number::trimmed;
use crate::geometry::Point;
use crate::source::FileId;
use crate::syntax;

/// The text of a layout `name`. `from` says where it comes from, for the first line.
pub fn write(plan: &Plan, name: &str, from: &str) -> String {
    let mut out = head(name, from, plan.width);
    for vertex in &plan.vertices {
        let corner = &vertex.corner;
        let _ = writeln!(out, "vertex {} {} radius {}", vertex.name, point(corner.point), metres(corner.radius));
    }
    if plan.areas() > 0 {
        out.push('\n');
    }
    out.push_str(&areas(plan.building.as_ref(), &plan.obstacles));
    if let (Some(start), [first, second, ..]) = (plan.start, plan.vertices.as_slice()) {
        let _ = writeln!(out, "\nstart on {}..{} at {}", first.name, second.name, metres(start));
    }
    out.push_str("\noptimise nothing\n}\n");
    let (tree, _) = syntax::parse(FileId(0), &out);
    syntax::format(&tree, &out)
}

/// How a layout `name` begins, up to its width, m.
pub fn head(name: &str, from: &str, width: f64) -> String {
    let from: String = from.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!(
        "// {from}\nuse std.carts.tilt_tray\nuse std.tracks.standard\n\nlayout {name} {{\ncatalog standard\n\
         cart tilt_tray(length: 1250 mm)\nspeed 2.0 m/s\nwidth {}\n\n",
        metres(width)
    )
}

/// Building and obstacles.
pub fn areas(building: Option<&DrawnArea>, obstacles: &[DrawnArea]) -> String {
    let walls = building.map(|building| format!("building {}\n", area(building)));
    walls.into_iter().chain(obstacles.iter().map(|o| format!("obstacle {} {}\n", o.name, area(o)))).collect()
}

/// A thousandth of a nanometre: finer than any drawing, and short for round numbers.
pub fn metres(length: f64) -> String {
    format!("{} m", trimmed(length, 12))
}

pub fn point(p: Point) -> String {
    format!("({}, {})", metres(p.x), metres(p.y))
}

pub fn area(area: &DrawnArea) -> String {
    let points: Vec<String> = area.points.iter().map(|p| point(*p)).collect();
    let clearance = if area.clearance > 0.0 { format!(" clearance {}", metres(area.clearance)) } else { String::new() };
    format!("[{}]{clearance}", points.join(", "))
}

/// Whether a text can stand for a name.
pub fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// A text as a name; `prefix` goes before what no name begins with.
pub fn as_name(text: &str, prefix: &str) -> String {
    let mut name: String = text.trim().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name.insert_str(0, &format!("{prefix}_"));
    }
    name
}
