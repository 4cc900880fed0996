//! A hall as source text that asks for the loop through its sections.

use std::fmt::Write;

use super::hall::Hall;
use super::write::{areas, head, point};
use crate::source::FileId;
use crate::syntax;

/// The text of a layout `name` that asks for the loop through a hall's sections.
pub fn write_hall(hall: &Hall, name: &str, from: &str) -> String {
    let mut out = head(name, from, hall.width);
    out.push_str(&areas(hall.building.as_ref(), &hall.obstacles));
    out.push_str("\n// What has to be there. `section NAME 20 m within (x, y)..(x, y)` may slide along a wall; `either way` is open.\n");
    for section in &hall.sections {
        let _ = writeln!(out, "section {} {}..{}", section.name, point(section.from), point(section.to));
    }
    let names: Vec<&str> = hall.sections.iter().map(|s| s.name.as_str()).collect();
    // One or two sections have one order.
    let order = if names.len() > 2 { " in any order" } else { "" };
    let _ = writeln!(out, "route {}{order}", names.join(", "));
    out.push_str("\nchain closes within 20 mm\n\noptimise length\n}\n");
    let (tree, _) = syntax::parse(FileId(0), &out);
    syntax::format(&tree, &out)
}
