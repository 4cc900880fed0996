//! A plan as source text of the language.

use std::fmt::Write;

use super::{DrawnArea, Plan};
use crate::base::number::trimmed;
use crate::geometry::Point;
use crate::source::FileId;
use crate::syntax;

/// The text of a layout `name`. `from` says where it comes from, for the first line.
pub fn write(plan: &Plan, name: &str, from: &str) -> String {
    let from: String = from.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let mut out = format!("// {from}\n");
    out.push_str("use std.carts.tilt_tray\nuse std.tracks.standard\n\n");
    let _ = writeln!(out, "layout {name} {{");
    out.push_str("catalog standard\ncart tilt_tray(length: 1250 mm)\nspeed 2.0 m/s\n");
    let _ = writeln!(out, "width {}\n", metres(plan.width));
    for vertex in &plan.vertices {
        let corner = &vertex.corner;
        let _ = writeln!(out, "vertex {} {} radius {}", vertex.name, point(corner.point), metres(corner.radius));
    }
    if plan.areas() > 0 {
        out.push('\n');
    }
    if let Some(building) = &plan.building {
        let _ = writeln!(out, "building {}", area(building));
    }
    for obstacle in &plan.obstacles {
        let _ = writeln!(out, "obstacle {} {}", obstacle.name, area(obstacle));
    }
    if let (Some(start), [first, second, ..]) = (plan.start, plan.vertices.as_slice()) {
        let _ = writeln!(out, "\nstart on {}..{} at {}", first.name, second.name, metres(start));
    }
    out.push_str("\noptimise nothing\n}\n");
    let (tree, _) = syntax::parse(FileId(0), &out);
    syntax::format(&tree, &out)
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
