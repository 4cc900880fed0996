//! `layout.json`: the layout as it was built, for every program that reads on.

use super::number::{normal, tidy};
use super::station::Station;
use super::{Compiled, document};
use crate::elements::{Element, Shape};
use crate::geometry::{Piece, PieceKind, Point, trig};
use crate::problem::{Problem, RowKey, Scope, measures, relation};
use crate::solve::{Stage, Status};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A layout as lss built it. Lengths in metres; arc length s counts along the centre line in driving
/// direction, from the layout's start; headings count from +x, left turns are positive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "lss layout")]
#[serde(deny_unknown_fields)]
pub struct LayoutFile {
    /// The layout's name.
    pub name: String,
    /// How the last stage ended: `converged`, `feasible`, `infeasible` (what follows is the best that was found, and
    /// `violations` says what is wrong with it) or `as_written`.
    pub status: String,
    /// What the layout breaks, and by how much.
    pub violations: Vec<Breach>,
    /// Length of the centre line, m.
    pub length_m: f64,
    /// Width of the band that carts and carriers sweep, m.
    pub width_m: f64,
    /// Floor covered by that band, m².
    pub footprint_m2: f64,
    /// Chain speed, m/s.
    pub speed_m_s: f64,
    /// The catalogue that elements are from.
    pub catalog: String,
    /// The cart's name.
    pub cart: String,
    /// In driving order; the loop closes from the last to the first.
    pub vertices: Vec<Corner>,
    /// Section i leads from vertex i to the next.
    pub sections: Vec<Section>,
    /// The centre line in driving order, beginning behind the first vertex.
    pub centre_line: Vec<Line>,
    /// The elements in driving order, beginning behind the first vertex.
    pub elements: Vec<Part>,
    /// Distance between the last element's end and the first one's begin, m.
    pub closure_m: f64,
    /// The same for the heading, rad.
    pub closure_rad: f64,
    /// What stands along the track.
    pub equipment: Vec<Item>,
    /// Distance between supports, m; `null` when the layout places none.
    pub supports_every_m: Option<f64>,
    /// How the band meets obstacles and the building.
    pub contacts: Vec<Meeting>,
    /// What the layout asks for, one row each, and the value it has.
    pub constraints: Vec<Demand>,
    /// The stages of optimisation.
    pub stages: Vec<Step>,
}

/// A row that is not met.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Breach {
    /// What is not met.
    pub row: String,
    /// By how much, in `unit`.
    pub amount: f64,
    /// `m` or `rad`.
    pub unit: String,
}

/// A vertex and its fillet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Corner {
    /// As the layout names it.
    pub name: String,
    /// m
    pub x_m: f64,
    /// m
    pub y_m: f64,
    /// Radius of the fillet, m.
    pub radius_m: f64,
    /// Turn of the track, deg, left positive.
    pub turn_deg: f64,
}

/// The line from one vertex to the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// `P4..P5`
    pub name: String,
    /// Distance between the vertices, m.
    pub length_m: f64,
    /// Length of the straight between the tangent points, m.
    pub straight_m: f64,
    /// Heading, deg, in (-180, 180].
    pub heading_deg: f64,
}

/// A straight or an arc of the centre line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Arc length where it begins, m.
    pub s_m: f64,
    /// Of its centre line, m.
    pub length_m: f64,
    /// [x, y], m.
    pub begin_m: [f64; 2],
    /// [x, y], m.
    pub end_m: [f64; 2],
    /// Heading where it begins, rad, in (-π, π].
    pub heading_rad: f64,
    /// Signed curvature, 1/m, left positive; 0 for a straight.
    pub curvature_per_m: f64,
}

/// A standard track element at its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Article number, as in the bill of elements.
    pub article: String,
    /// Straight or curve.
    #[serde(flatten)]
    pub shape: PartShape,
    /// Arc length where it begins, m.
    pub s_m: f64,
    /// [x, y] where it begins, m.
    pub begin_m: [f64; 2],
    /// Heading where it begins, rad, in (-π, π].
    pub heading_rad: f64,
    /// Whether the catalogue has it.
    pub in_catalog: bool,
}

/// What an element is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum PartShape {
    /// A straight piece.
    Straight {
        /// m
        length_m: f64,
        /// Whether it is cut to this length.
        cut: bool,
    },
    /// A curved piece.
    Curve {
        /// Of the centre line, m.
        length_m: f64,
        /// Of the centre line, m.
        radius_m: f64,
        /// deg, left positive.
        turn_deg: f64,
    },
}

/// What stands along the track.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Item {
    /// What it is.
    pub kind: ItemKind,
    /// `west`; chutes and motors are numbered from 1: `row_a 3`.
    pub name: String,
    /// Arc length, m; of a motor, where it begins.
    pub s_m: f64,
    /// On the centre line, m.
    pub x_m: f64,
    /// On the centre line, m.
    pub y_m: f64,
    /// Heading of the track, rad, in (-π, π].
    pub heading_rad: f64,
}

/// Kinds of equipment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ItemKind {
    /// Where arc length is 0.
    Start,
    /// Trigger of the sensor cart.
    Photocell,
    /// Where items come onto the sorter.
    Induction,
    /// Where items leave it.
    Chute,
    /// A linear motor, where it begins.
    Motor,
}

/// How the track's band meets an obstacle or the outside of the building.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Meeting {
    /// The obstacle's name, or `building`.
    pub name: String,
    /// Overlap with the left side of the band, m².
    pub area_left_m2: f64,
    /// Overlap with the right side of the band, m².
    pub area_right_m2: f64,
    /// Distance from the band's edge, m; negative when they overlap.
    pub clearance_m: f64,
    /// The clearance that the layout asks for, m.
    pub required_m: f64,
}

/// A constraint of the layout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Demand {
    /// What is constrained: `fix length P2..P3`, `length(P7..P8) >= 18`.
    pub row: String,
    /// The user's words.
    pub reason: Option<String>,
    /// Least value, in `unit`; `null` when there is none.
    pub low: Option<f64>,
    /// Greatest value, in `unit`; `null` when there is none.
    pub high: Option<f64>,
    /// The layout's value, in `unit`.
    pub value: f64,
    /// `m` or `rad`; formulas of another dimension are in SI units.
    pub unit: String,
}

/// A stage of optimisation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// `stage1`, `stage2`, `stage3` or `written`.
    pub name: String,
    /// How it ended.
    pub status: String,
    /// Length of the centre line, m.
    pub length_m: f64,
    /// Largest violation, m (angles as rad).
    pub max_violation_m: f64,
    /// Number of iterations.
    pub iterations: usize,
    /// [x, y, radius] of each vertex, m.
    pub vertices_m: Vec<[f64; 3]>,
}

/// `layout.json`
pub fn json(compiled: &Compiled) -> Vec<u8> {
    document::to_json(&LayoutFile::new(compiled))
}

impl LayoutFile {
    pub fn new(compiled: &Compiled) -> Self {
        let (layout, track) = (&compiled.layout, &compiled.track);
        let last = compiled.stages.last();
        let names = layout.vertices.iter().map(|v| v.name.clone());
        let vertices = names.zip(&track.corners).zip(&track.fillets).map(|((name, corner), fillet)| Corner {
            name,
            x_m: tidy(corner.point.x),
            y_m: tidy(corner.point.y),
            radius_m: tidy(corner.radius),
            turn_deg: tidy(fillet.turn.to_degrees()),
        });
        let sections = (0..track.corners.len()).map(|i| {
            let straight = track.straight(i);
            Section {
                name: format!("{}..{}", layout.vertices[i].name, layout.vertices[layout.next(i)].name),
                length_m: tidy(track.corners[i].point.distance(track.corners[layout.next(i)].point)),
                straight_m: tidy(straight.length),
                heading_deg: tidy(straight.heading.to_degrees()),
            }
        });
        LayoutFile {
            name: layout.name.clone(),
            status: status(last.map_or(Status::AsWritten, |s| s.status)).to_owned(),
            violations: last.map_or_else(Vec::new, breaches),
            length_m: tidy(track.length),
            width_m: layout.width.value,
            footprint_m2: tidy(compiled.footprint),
            speed_m_s: layout.speed.value,
            catalog: layout.catalog.name.clone(),
            cart: layout.cart.name.clone(),
            vertices: vertices.collect(),
            sections: sections.collect(),
            centre_line: track.pieces.iter().map(|p| line(compiled, p)).collect(),
            elements: compiled.sequence.elements.iter().map(|e| part(compiled, e)).collect(),
            closure_m: tidy(compiled.sequence.closure),
            closure_rad: tidy(compiled.sequence.closure_heading),
            equipment: equipment(compiled),
            supports_every_m: layout.equipment.supports.map(|s| s.value),
            contacts: contacts(compiled),
            constraints: demands(compiled),
            stages: compiled.stages.iter().map(step).collect(),
        }
    }
}

fn status(status: Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::Feasible => "feasible",
        Status::Infeasible => "infeasible",
        Status::AsWritten => "as_written",
    }
}

fn pair(point: Point) -> [f64; 2] {
    [tidy(point.x), tidy(point.y)]
}

fn breaches(stage: &Stage) -> Vec<Breach> {
    let breach =
        |v: &crate::solve::Violation| Breach { row: v.row.clone(), amount: tidy(v.amount), unit: v.unit.to_owned() };
    stage.violations.iter().map(breach).collect()
}

fn line(compiled: &Compiled, piece: &Piece) -> Line {
    Line {
        s_m: compiled.round_trip(piece.s - compiled.start()),
        length_m: tidy(piece.length),
        begin_m: pair(piece.begin),
        end_m: pair(piece.end),
        heading_rad: tidy(trig::wrap(piece.heading)),
        curvature_per_m: match piece.kind {
            PieceKind::Straight => 0.0,
            PieceKind::Arc { radius, turn, .. } => tidy(turn.signum() / radius),
        },
    }
}

fn part(compiled: &Compiled, element: &Element) -> Part {
    let length_m = tidy(element.length);
    Part {
        article: element.article.clone(),
        shape: match element.shape {
            Shape::Straight { cut, .. } => PartShape::Straight { length_m, cut },
            Shape::Curve { radius, turn } => {
                PartShape::Curve { length_m, radius_m: tidy(radius), turn_deg: tidy(turn.to_degrees()) }
            }
        },
        s_m: compiled.round_trip(element.s - compiled.start()),
        begin_m: pair(element.position),
        heading_rad: tidy(element.heading),
        in_catalog: element.in_catalog,
    }
}

fn equipment(compiled: &Compiled) -> Vec<Item> {
    let equipment = &compiled.layout.equipment;
    let item = |kind, name: String, station: Station| Item {
        kind,
        name,
        s_m: station.s,
        x_m: tidy(station.point.x),
        y_m: tidy(station.point.y),
        heading_rad: tidy(station.heading),
    };
    let mut items = vec![item(ItemKind::Start, "start".to_owned(), compiled.station_at(0.0))];
    if let Some(place) = equipment.photocell {
        items.push(item(ItemKind::Photocell, "photocell".to_owned(), compiled.station(place)));
    }
    for induction in &equipment.inductions {
        items.push(item(ItemKind::Induction, induction.name.clone(), compiled.station(induction.place)));
    }
    for chutes in &equipment.chutes {
        for (i, station) in compiled.stations(&chutes.row).into_iter().enumerate() {
            items.push(item(ItemKind::Chute, format!("{} {}", chutes.name, i + 1), station));
        }
    }
    for (i, station) in compiled.motors().into_iter().enumerate() {
        items.push(item(ItemKind::Motor, format!("motor {}", i + 1), station));
    }
    items
}

fn contacts(compiled: &Compiled) -> Vec<Meeting> {
    let meeting = |c: &super::Contact| Meeting {
        name: c.name.clone(),
        area_left_m2: tidy(c.area_left),
        area_right_m2: tidy(c.area_right),
        clearance_m: tidy(c.clearance),
        required_m: c.required,
    };
    compiled.contacts.iter().map(meeting).collect()
}

/// What the user's statements ask for; the limits that every layout has are not repeated for each vertex.
fn demands(compiled: &Compiled) -> Vec<Demand> {
    let layout = &compiled.layout;
    let problem = Problem::new(layout, Scope::Building);
    let variables = measures::to_variables(&compiled.track.corners);
    // A reach below every distance leaves clearances out: `contacts` reports them.
    let values = problem.evaluate(&variables, f64::NEG_INFINITY).rows;
    let limit = |value: f64| value.is_finite().then(|| tidy(value));
    let mut demands = Vec::new();
    for (k, bound) in problem.bounds.iter().enumerate().filter(|(_, b)| b.low == b.high) {
        demands.push(Demand {
            row: format!("fix {}", problem.variable_name(k)),
            reason: None,
            low: limit(bound.low),
            high: limit(bound.high),
            value: tidy(variables[k]),
            unit: "m".to_owned(),
        });
    }
    for value in &values {
        let RowKey::Listed(i) = value.key else { continue };
        let row = &problem.rows[i];
        if !layout.constraints.iter().any(|c| c.span == row.span) {
            continue;
        }
        demands.push(Demand {
            row: if row.label == "require" { relation(&problem, row) } else { row.label.clone() },
            reason: row.reason.clone(),
            low: limit(value.low),
            high: limit(value.high),
            value: tidy(value.expansion.value),
            unit: problem.unit(value.key).to_owned(),
        });
    }
    demands
}

fn step(stage: &Stage) -> Step {
    Step {
        name: stage.name.to_owned(),
        status: status(stage.status).to_owned(),
        length_m: tidy(stage.length),
        max_violation_m: normal(stage.max_violation),
        iterations: stage.iterations,
        vertices_m: stage.corners.iter().map(|c| [tidy(c.point.x), tidy(c.point.y), tidy(c.radius)]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use crate::emit::fixture::{compile, on};
    use crate::geometry::Polygon;
    use crate::model::*;
    use crate::source::{FileId, Span, Spanned};

    use super::Point;

    #[test]
    fn a_layout_with_everything_in_it() {
        let mut layout = fixture::rectangle(20.0, 10.0, 4.0);
        let corners = [(8.0, 0.5), (9.0, 0.5), (9.0, 1.5), (8.0, 1.5)].map(|(x, y)| Point::new(x, y));
        layout.obstacles.push(Obstacle {
            name: "column_a".to_owned(),
            polygon: Polygon::new(corners.to_vec()).unwrap(),
            clearance: 0.3,
            side: Side::Left,
            pass: None,
            span: fixture::span(),
        });
        let span = Span::new(FileId(0), 1, 2);
        let formula = Formula::Length(Target { from: 0, straight: false });
        layout.constraints = vec![
            Constraint { kind: ConstraintKind::FixVertex { vertex: 0 }, span, reason: None },
            Constraint {
                kind: ConstraintKind::Require { formula, low: 18.0, high: f64::INFINITY, unit: Unit::Metre },
                span,
                reason: Some("the chute wall needs 18 m".to_owned()),
            },
        ];
        layout.equipment.start = Some(on(0, 2.0));
        layout.equipment.photocell = Some(on(0, 3.0));
        layout.equipment.inductions.push(Induction { name: "west".to_owned(), place: on(2, 1.0) });
        let row = Row { place: on(2, 4.0), every: 1.25, count: 2 };
        layout.equipment.chutes.push(Chutes { name: "row_a".to_owned(), row });
        layout.equipment.motors = Motors::Evenly { count: 1 };
        layout.equipment.supports = Some(Spanned::new(2.5, fixture::span()));
        let text = String::from_utf8(super::json(&compile(layout))).unwrap();
        insta::assert_snapshot!(text);
    }
}
