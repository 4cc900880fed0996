//! A hall without a track: its building and obstacles, and lines where sections of a track are to lie.

use super::drawing::Drawing;
use super::shapes::{Items, Label};
use super::{DrawnArea, LengthUnit, Options, WIDTH, outline, unknown_unit, write};
use crate::base::number::tidy;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Curve, Point};
use crate::model::TrackSection;
use crate::source::{FileId, SourceMap, Span};

/// Layer of the sections; one called `SECTIONS-NAME` names those that are drawn on it.
pub const SECTIONS: &str = "SECTIONS";
/// A text this near to a section names it, m.
const NEAR: f64 = 2.0;
/// Coordinates are taken to a micrometre: CAD leaves noise behind that, and headings are to be exact.
const PARTS: f64 = 1e6;

/// What a drawing says of a hall, in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Hall {
    pub unit: LengthUnit,
    pub width: f64,
    pub building: Option<DrawnArea>,
    pub obstacles: Vec<DrawnArea>,
    /// In the order of the drawing, each driven as it is drawn.
    pub sections: Vec<TrackSection>,
}

/// Reads a drawing of a hall with marked sections. There is a hall when no diagnostic is an error.
pub fn hall(sources: &SourceMap, file: FileId, options: &Options) -> (Option<Hall>, Vec<Diagnostic>) {
    let mut said = Vec::new();
    let hall = read(sources, file, options, &mut said);
    (hall.filter(|_| !said.iter().any(Diagnostic::is_error)), said)
}

fn read(sources: &SourceMap, file: FileId, options: &Options, said: &mut Vec<Diagnostic>) -> Option<Hall> {
    let text = &sources.file(file).text;
    // Which layers hold sections, the drawing itself says.
    let layers = Drawing::read(file, text, &[], said)?.layers;
    let marked: Vec<&str> = layers.iter().map(String::as_str).filter(|layer| of_sections(layer).is_some()).collect();
    let mut wanted: Vec<&str> = vec![&options.building];
    wanted.extend(options.obstacles.iter().map(String::as_str));
    wanted.extend(&marked);
    let drawing = Drawing::read(file, text, &wanted, &mut Vec::new())?;
    let Some(unit) = options.unit.or(drawing.unit) else {
        said.push(unknown_unit(drawing.unit_span));
        return None;
    };
    let items = drawing.scaled(unit.metres());
    said.extend(
        items
            .unreadable
            .iter()
            .filter(|u| wanted.iter().any(|w| w.eq_ignore_ascii_case(&u.layer)))
            .map(|u| u.diagnostic()),
    );
    let sections = sections(&items, said);
    if sections.is_empty() {
        let shown: Vec<String> = layers.iter().take(12).map(|layer| format!("`{layer}`")).collect();
        let found = if shown.is_empty() {
            "a drawing without lines".to_owned()
        } else {
            format!("lines on {}", shown.join(", "))
        };
        said.push(
            Diagnostic::new(
                Code::E0803,
                format!("layer `{SECTIONS}` has no sections"),
                drawing.begin,
                "in this drawing",
            )
            .expected(format!("lines on a layer `{SECTIONS}` or `{SECTIONS}-NAME`"), found)
            .help("draw a line for each straight that the loop has to have, in its driving direction"),
        );
        return None;
    }
    let areas = outline::Areas { items: &items, tolerance: options.tolerance };
    let building = areas.building(&options.building, said);
    let obstacles = areas.obstacles(&options.obstacles, said);
    Some(Hall { unit, width: options.width.unwrap_or(WIDTH), building, obstacles, sections })
}

/// What a layer calls its sections: nothing, or a name; `None` for other layers.
fn of_sections(layer: &str) -> Option<&str> {
    let (head, rest) = layer.split_at_checked(SECTIONS.len())?;
    match (head.eq_ignore_ascii_case(SECTIONS), rest.strip_prefix(['-', '_'])) {
        (true, None) if rest.is_empty() => Some(""),
        (true, Some(name)) if !name.is_empty() => Some(name),
        _ => None,
    }
}

fn sections(items: &Items, said: &mut Vec<Diagnostic>) -> Vec<TrackSection> {
    let mut sections: Vec<TrackSection> = Vec::new();
    for shape in &items.shapes {
        let Some(layer) = of_sections(&shape.layer) else { continue };
        for (curve, span) in &shape.curves {
            let Curve::Segment { begin, end } = *curve else {
                said.push(
                    Diagnostic::new(
                        Code::W0802,
                        format!("an arc on layer `{}` is no section", shape.layer),
                        *span,
                        "ignored",
                    )
                    .expected("straight lines", "an arc")
                    .help("a section is a straight; the curves between are found"),
                );
                continue;
            };
            let (from, to) = (rounded(begin), rounded(end));
            if from.distance(to) < 1e-3 {
                continue;
            }
            let wanted = match layer {
                "" => {
                    label(items, from, to).map_or_else(|| "section".to_owned(), |l| write::as_name(&l.text, "section"))
                }
                layer => write::as_name(&layer.to_lowercase(), "section"),
            };
            let name = free(&wanted, &sections, layer.is_empty() && wanted == "section");
            sections.push(TrackSection {
                name,
                from,
                to,
                length: None,
                either_way: false,
                from_span: *span,
                to_span: *span,
                span: Span { ..*span },
            });
        }
    }
    sections
}

/// The name, with a number behind it where it is taken.
fn free(name: &str, sections: &[TrackSection], numbered: bool) -> String {
    let taken = |name: &String| sections.iter().any(|s| s.name == *name);
    let plain = (!numbered).then(|| name.to_owned());
    let first = if numbered { 1 } else { 2 };
    plain.into_iter().chain((first..).map(|k| format!("{name}_{k}"))).find(|name| !taken(name)).unwrap_or_default()
}

/// The text beside a line that is nearest to its middle.
fn label(items: &Items, from: Point, to: Point) -> Option<&Label> {
    let middle = from.lerp(to, 0.5);
    let beside = |label: &&Label| {
        crate::geometry::distance_to_segment(label.at, from, to) <= NEAR && label.text.chars().any(char::is_alphabetic)
    };
    let distance = |label: &&Label| label.at.distance(middle);
    items.labels.iter().filter(beside).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

fn rounded(p: Point) -> Point {
    let round = |v: f64| tidy((v * PARTS).round() / PARTS);
    Point::new(round(p.x), round(p.y))
}
