//! A plan from CAD as a layout: the centre line of a DXF drawing becomes vertices with radii, its outlines become
//! building and obstacles.
//!
//! 1. `tags` splits the text into group codes and values,
//! 2. `drawing` finds unit, blocks and entities, and `shapes` gives their lines and arcs in the plane,
//! 3. `walk` joins loose pieces into loops,
//! 4. `heal` turns a loop into vertices with radii, and proves how far the drawn line lies from the result,
//! 5. `outline` makes polygons of the other layers,
//! 6. `hall` reads a drawing without a track, with lines where its sections are to lie,
//! 7. `write` and `write_hall` put everything down as source text.
//!
//! The reader is its own rather than a library's: messages cite lines of the drawing, which no reader keeps, and only
//! a handful of entities matters.

mod drawing;
mod hall;
mod heal;
mod outline;
mod shapes;
mod tags;
mod unit;
mod walk;
mod write;
mod write_hall;

pub use hall::{Hall, hall};
pub use unit::LengthUnit;
pub use write::{as_name, write};
pub use write_hall::write_hall;

use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Corner, Point, Polygon, point_piece};
use crate::source::{FileId, SourceMap, Span};
use drawing::Drawing;
use shapes::Drawn;

/// Layers that the DXF export of this tool writes beside those that can be chosen.
const LEFT_SIDE: &str = "TRACK_LEFT";
const BUILDING_CLEARANCE: &str = "BUILDING_CLEARANCE";
const OBSTACLE_CLEARANCE: &str = "OBSTACLE_CLEARANCE";
const VERTICES: &str = "VERTICES";

/// What is read of a drawing, and how strictly.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Layer of the centre line. Layer names have no case in DXF.
    pub centre_line: String,
    pub building: String,
    pub obstacles: Vec<String>,
    /// Instead of the one that the drawing states.
    pub unit: Option<LengthUnit>,
    /// Largest gap that is closed, and largest distance by which a drawn point may be moved, m.
    pub tolerance: f64,
    /// Drive against the order of the drawing.
    pub reverse: bool,
    /// Radius for corners that are drawn sharp, m.
    pub radius: Option<f64>,
    /// Width of the track, m; else that of the drawn sides.
    pub width: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            centre_line: "TRACK_CENTRE".into(),
            building: "BUILDING".into(),
            obstacles: vec!["OBSTACLES".into()],
            unit: None,
            tolerance: 1e-3,
            reverse: false,
            radius: None,
            width: None,
        }
    }
}

/// A vertex with the name that the drawing gives it, or `P1`, `P2` and so on.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnVertex {
    pub name: String,
    pub corner: Corner,
}

/// A polygon of the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnArea {
    pub name: String,
    /// m
    pub points: Vec<Point>,
    /// m
    pub clearance: f64,
}

/// How far the drawing was from a closed, tangent line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Healed {
    /// Ends that did not meet, and the farthest two, m.
    pub gaps: usize,
    pub largest_gap: f64,
    /// Largest bend between neighbours, rad.
    pub largest_bend: f64,
    /// Farthest that a drawn point lies from the imported centre line, m.
    pub largest_shift: f64,
    /// Pieces drawn twice, or shorter than the tolerance and beside the line.
    pub dropped: usize,
}

/// What a drawing says of a layout, in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub unit: LengthUnit,
    pub vertices: Vec<DrawnVertex>,
    /// Length of the centre line, m.
    pub length: f64,
    /// Distance from the first section's tangent point at which the drawing begins, m.
    pub start: Option<f64>,
    pub width: f64,
    pub building: Option<DrawnArea>,
    pub obstacles: Vec<DrawnArea>,
    pub healed: Healed,
}

/// Width of a track whose sides are not drawn, m.
const WIDTH: f64 = 1.2;

/// Reads a drawing. There is a plan when no diagnostic is an error.
pub fn read(sources: &SourceMap, file: FileId, options: &Options) -> (Option<Plan>, Vec<Diagnostic>) {
    let mut said = Vec::new();
    let plan = plan(sources, file, options, &mut said);
    (plan.filter(|_| !said.iter().any(Diagnostic::is_error)), said)
}

fn plan(sources: &SourceMap, file: FileId, options: &Options, said: &mut Vec<Diagnostic>) -> Option<Plan> {
    let mut wanted: Vec<&str> = vec![&options.centre_line, &options.building];
    wanted.extend(options.obstacles.iter().map(String::as_str));
    let (readable, sides) = (wanted.len(), [LEFT_SIDE, BUILDING_CLEARANCE, OBSTACLE_CLEARANCE]);
    wanted.extend(sides);
    let drawing = Drawing::read(file, &sources.file(file).text, &wanted, said)?;
    let (unit, unit_span) = (options.unit.or(drawing.unit), drawing.unit_span);
    let Some(unit) = unit else {
        said.push(unknown_unit(unit_span));
        return None;
    };
    let items = drawing.scaled(unit.metres());
    // What cannot be read matters only where something is read from.
    for unreadable in &items.unreadable {
        if wanted.iter().take(readable).any(|layer| layer.eq_ignore_ascii_case(&unreadable.layer)) {
            said.push(unreadable.diagnostic());
        }
    }
    let on = |layer: &str| -> Vec<Drawn> {
        items.shapes.iter().filter(|s| s.layer.eq_ignore_ascii_case(layer)).flat_map(|s| s.pieces()).collect()
    };

    let pieces = on(&options.centre_line);
    if pieces.is_empty() {
        if said.iter().all(|d| d.code != Code::E0806) {
            said.push(no_centre_line(&options.centre_line, &drawing.layers, drawing.begin));
        }
        return None;
    }
    let ring = walk::centre_line(pieces, options, said)?;
    let marks: Vec<Point> =
        items.points.iter().filter(|p| p.layer.eq_ignore_ascii_case(VERTICES)).map(|p| p.at).collect();
    let line = heal::centre_line(&ring, &marks, options, said)?;

    let areas = outline::Areas { items: &items, tolerance: options.tolerance };
    let building = areas.building(&options.building, said);
    let obstacles = areas.obstacles(&options.obstacles, said);
    Some(Plan {
        unit,
        vertices: named(&line.track.corners, &items, &marks),
        length: line.track.length,
        start: line.start,
        width: options.width.or_else(|| drawn_width(&on(LEFT_SIDE), &line.track)).unwrap_or(WIDTH),
        building,
        obstacles,
        healed: line.healed,
    })
}

/// The track's width if the drawing shows its left side: all of it equally far from the centre line.
fn drawn_width(side: &[Drawn], track: &crate::geometry::Track) -> Option<f64> {
    let distance = |drawn: &Drawn| {
        let middle = drawn.curve.at(drawn.curve.length() / 2.0);
        track.pieces.iter().map(|piece| point_piece(middle, piece).1).fold(f64::INFINITY, f64::min)
    };
    outline::agreed(side.iter().map(distance)).map(|half| crate::base::number::tidy((2e6 * half).round() / 1e6))
}

/// Vertices with the texts that our own export writes above them; all or none.
fn named(corners: &[Corner], items: &shapes::Items, marks: &[Point]) -> Vec<DrawnVertex> {
    let above = |corner: &Corner| {
        marks.iter().find(|mark| mark.distance(corner.point) < 1e-6)?;
        let over = |text: &&shapes::Label| {
            let d = text.at - corner.point;
            d.x.abs() < 1e-6 && d.y > 0.0 && d.y < 10.0 && write::is_name(&text.text)
        };
        let nearest = |a: &&shapes::Label, b: &&shapes::Label| a.at.y.total_cmp(&b.at.y);
        items.labels.iter().filter(over).min_by(nearest).map(|text| text.text.clone())
    };
    let mut names: Vec<String> = corners.iter().map_while(above).collect();
    let distinct: std::collections::BTreeSet<&String> = names.iter().collect();
    if distinct.len() < corners.len() {
        names = (1..=corners.len()).map(|i| format!("P{i}")).collect();
    }
    names.into_iter().zip(corners).map(|(name, corner)| DrawnVertex { name, corner: *corner }).collect()
}

fn unknown_unit(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0802, "the drawing does not say its unit", span, "no unit of length here")
        .expected("`$INSUNITS` with a unit of length", "none")
        .help("say which it is: `--unit mm`, `cm`, `m`, `in` or `ft`")
}

fn no_centre_line(layer: &str, layers: &[String], span: Span) -> Diagnostic {
    let there = match layers {
        [] => "a drawing without lines and arcs".to_string(),
        [one] => format!("lines and arcs on layer `{one}` alone"),
        several => {
            let shown: Vec<String> = several.iter().take(12).map(|l| format!("`{l}`")).collect();
            let more = if several.len() > 12 { ", …" } else { "" };
            format!("lines and arcs on {}{more}", shown.join(", "))
        }
    };
    Diagnostic::new(Code::E0803, format!("layer `{layer}` has no centre line"), span, "in this drawing")
        .expected("lines, arcs or polylines on that layer", there)
        .help("name the layer that the centre line is drawn on: `--centre-line LAYER`")
}

/// A simple polygon, if the points make one.
fn simple(points: &[Point]) -> Option<Polygon> {
    Polygon::new(points.to_vec()).ok()
}
