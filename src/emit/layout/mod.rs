//! `layout.json`: the layout as it was built, for every program that reads on.

mod document;

pub use document::*;

use crate::base::number::{normal, tidy};
use crate::base::{json, trig};
use crate::compiled::{Compiled, Station};
use crate::elements::Shape;
use crate::geometry::{Form, Frame, PieceKind, Point, Stretch};
use crate::problem::{Problem, RowKey, Scope, measures};
use crate::{elements, geometry, solve};

/// `layout.json`
pub fn json(compiled: &Compiled) -> Vec<u8> {
    json::to_json(&LayoutFile::new(compiled))
}

impl LayoutFile {
    pub fn new(compiled: &Compiled) -> Self {
        let (layout, track) = (&compiled.layout, &compiled.track);
        let last = compiled.stages.last();
        let names = layout.vertices.iter().map(|v| v.name.clone());
        let vertices = names.zip(&track.corners).zip(&track.fillets).map(|((name, corner), fillet)| Vertex {
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
            status: last.map_or(Status::AsWritten, |s| s.status.into()),
            violations: last.map_or_else(Vec::new, violations),
            length_m: tidy(compiled.length()),
            width_m: layout.width.value,
            footprint_m2: tidy(compiled.footprint),
            speed_m_s: layout.speed.value,
            catalog: layout.catalog.name.clone(),
            cart: layout.cart.name.clone(),
            chain: compiled.chain.map(|fit| ChainFit {
                carts: fit.carts,
                cart_length_m: layout.cart.length,
                left_over_m: tidy(fit.left_over),
                take_up_m: layout.take_up_travel(),
                fits: compiled.chain_fits(),
            }),
            vertices: vertices.collect(),
            sections: sections.collect(),
            centre_line: centre_line(compiled),
            elements: compiled.sequence.elements.iter().map(|e| part(compiled, e)).collect(),
            closure_m: tidy(compiled.sequence.closure),
            closure_rad: tidy(compiled.sequence.closure_heading),
            equipment: equipment(compiled),
            placement: (!layout.equipment.declared.is_empty()).then(|| placement(compiled)),
            supports_every_m: layout.equipment.supports.map(|s| s.value),
            contacts: contacts(compiled),
            constraints: constraints(compiled),
            stages: compiled.stages.iter().map(step).collect(),
        }
    }
}

impl From<solve::Status> for Status {
    fn from(status: solve::Status) -> Self {
        match status {
            solve::Status::Local => Status::Local,
            solve::Status::BestFound => Status::BestFound,
            solve::Status::Proven => Status::Proven,
            solve::Status::Feasible => Status::Feasible,
            solve::Status::Infeasible => Status::Infeasible,
            solve::Status::AsWritten => Status::AsWritten,
        }
    }
}

fn pair(point: Point) -> [f64; 2] {
    [tidy(point.x), tidy(point.y)]
}

fn violations(stage: &solve::Stage) -> Vec<Violation> {
    let violation =
        |v: &solve::Violation| Violation { row: v.row.clone(), amount: tidy(v.amount), unit: v.unit.to_owned() };
    stage.violations.iter().map(violation).collect()
}

fn centre_line(compiled: &Compiled) -> Vec<CentreLinePiece> {
    if compiled.raised() {
        compiled.space.line.stretches.iter().map(|stretch| raised(compiled, stretch)).collect()
    } else {
        compiled.track.pieces.iter().map(|piece| line(compiled, piece)).collect()
    }
}

fn raised(compiled: &Compiled, stretch: &Stretch) -> CentreLinePiece {
    let (begin, end) = (stretch.begin, stretch.at(stretch.length));
    let flat = |frame: &Frame| [tidy(frame.position.x), tidy(frame.position.y)];
    CentreLinePiece {
        s_m: compiled.round_trip(stretch.s - compiled.start()),
        length_m: tidy(stretch.length),
        begin_m: flat(&begin),
        end_m: flat(&end),
        z_m: [tidy(begin.position.z), tidy(end.position.z)],
        slope: [tidy(begin.slope()), tidy(end.slope())],
        heading_deg: tidy(begin.heading().to_degrees()),
        curvature_per_m: match stretch.form {
            Form::Arc { radius, turn } | Form::Spiral { radius, turn, .. } => tidy(turn.signum() / radius),
            Form::Straight { .. } | Form::Vertical { .. } => 0.0,
        },
        vertical_curvature_per_m: match stretch.form {
            Form::Vertical { radius, slope_from, slope_to } => tidy((slope_to - slope_from).signum() / radius),
            _ => 0.0,
        },
    }
}

fn line(compiled: &Compiled, piece: &geometry::Piece) -> CentreLinePiece {
    CentreLinePiece {
        s_m: compiled.round_trip(piece.s - compiled.start()),
        length_m: tidy(piece.length),
        begin_m: pair(piece.begin),
        end_m: pair(piece.end),
        z_m: [0.0; 2],
        slope: [0.0; 2],
        heading_deg: tidy(trig::wrap(piece.heading).to_degrees()),
        curvature_per_m: match piece.kind {
            PieceKind::Straight => 0.0,
            PieceKind::Arc { radius, turn, .. } => tidy(turn.signum() / radius),
        },
        vertical_curvature_per_m: 0.0,
    }
}

fn part(compiled: &Compiled, element: &elements::Element) -> Element {
    let length_m = tidy(element.length);
    Element {
        article: element.article.clone(),
        shape: match element.shape {
            Shape::Straight { cut, .. } => ElementShape::Straight { length_m, cut },
            Shape::Curve { radius, turn } => {
                ElementShape::Curve { length_m, radius_m: tidy(radius), turn_deg: tidy(turn.to_degrees()) }
            }
        },
        s_m: compiled.past_start(element.s),
        begin_m: pair(element.position),
        heading_deg: tidy(element.heading.to_degrees()),
        in_catalog: element.in_catalog,
    }
}

fn equipment(compiled: &Compiled) -> Vec<Equipment> {
    let equipment = &compiled.layout.equipment;
    let item = |kind, name: String, station: Station| Equipment {
        kind,
        name,
        s_m: station.s,
        x_m: tidy(station.point.x),
        y_m: tidy(station.point.y),
        z_m: tidy(station.z),
        heading_deg: tidy(station.heading.to_degrees()),
        of: None,
        footprints_m: Vec::new(),
        conveyor_m: None,
    };
    let mut items = vec![item(EquipmentKind::Start, "start".to_owned(), compiled.station_at(0.0))];
    if let Some(place) = equipment.photocell {
        items.push(item(EquipmentKind::Photocell, "photocell".to_owned(), compiled.station(place)));
    }
    for (i, induction) in equipment.inductions.iter().enumerate() {
        items.push(item(EquipmentKind::Induction, equipment.induction_name(i), compiled.station(induction.place)));
    }
    for chutes in &equipment.chutes {
        for (i, station) in compiled.chutes(chutes).into_iter().enumerate() {
            items.push(item(EquipmentKind::Chute, format!("{} {}", chutes.name, i + 1), station));
        }
    }
    for (kind, of) in [
        (EquipmentKind::Scanner, crate::model::EquipmentKind::Scanner),
        (EquipmentKind::Gate, crate::model::EquipmentKind::Gate),
        (EquipmentKind::Lift, crate::model::EquipmentKind::Lift),
    ] {
        let placed = compiled.placement.placed.iter().filter(|p| equipment.declared[p.declared].of.kind == of);
        items.extend(
            placed.map(|p| item(kind, equipment.declared[p.declared].one(p.number), compiled.station(p.place))),
        );
    }
    // What is of a declared kind has a footprint.
    for placed in &compiled.placement.placed {
        let declared = &equipment.declared[placed.declared];
        let name = declared.one(placed.number);
        if let Some(item) = items.iter_mut().find(|item| item.name == name && item.footprints_m.is_empty()) {
            item.of = Some(declared.of.name.clone());
            item.footprints_m = placed.footprint.covers.iter().map(|r| r.map(pair).to_vec()).collect();
            item.conveyor_m = placed.conveyor.map(tidy);
        }
    }
    for (i, station) in compiled.motors().into_iter().enumerate() {
        items.push(item(EquipmentKind::Motor, format!("motor {}", i + 1), station));
    }
    items
}

fn placement(compiled: &Compiled) -> Placement {
    let found = &compiled.placement;
    Placement {
        equipment_eur: tidy(found.equipment),
        conveyors_eur: tidy(found.conveyors),
        conveyors_lower_bound_eur: tidy(found.bound),
        missing: found.missing.iter().map(|(_, n)| n).sum(),
    }
}

fn contacts(compiled: &Compiled) -> Vec<ContactArea> {
    let meeting = |c: &crate::compiled::ContactArea| ContactArea {
        name: c.name.clone(),
        area_left_m2: tidy(c.area_left),
        area_right_m2: tidy(c.area_right),
        clearance_m: tidy(c.clearance),
        required_m: c.required,
    };
    compiled.contacts.iter().map(meeting).collect()
}

/// What the user's statements ask for; the limits that every layout has are not repeated for each vertex.
fn constraints(compiled: &Compiled) -> Vec<Constraint> {
    let layout = &compiled.layout;
    let problem = Problem::new(layout, Scope::Building);
    let variables = measures::to_variables(&compiled.track.corners);
    // A reach below every distance leaves clearances out: `contacts` reports them.
    let values = problem.evaluate(&variables, f64::NEG_INFINITY).rows;
    let limit = |value: f64| value.is_finite().then(|| tidy(value));
    let mut constraints = Vec::new();
    for (k, bound) in problem.bounds.iter().enumerate().filter(|(_, b)| b.low == b.high) {
        constraints.push(Constraint {
            row: format!("fix {}", problem.variable_name(k)),
            reason: None,
            low: limit(bound.low),
            high: limit(bound.high),
            value: tidy(variables[k]),
            unit: "m".to_owned(),
            difference: false,
        });
    }
    for value in &values {
        let RowKey::Listed(i) = value.key else { continue };
        let row = &problem.rows[i];
        if !layout.constraints.iter().any(|c| c.span == row.span) {
            continue;
        }
        let required = row.required(layout);
        constraints.push(Constraint {
            difference: required.as_ref().is_some_and(|required| required.difference),
            row: required.map_or_else(|| row.label.clone(), |required| required.relation),
            reason: row.reason.clone(),
            low: limit(value.low),
            high: limit(value.high),
            value: tidy(value.expansion.value),
            unit: problem.unit(value.key).to_owned(),
        });
    }
    constraints
}

fn step(stage: &solve::Stage) -> Stage {
    Stage {
        name: stage.name.to_owned(),
        status: stage.status.into(),
        length_m: tidy(stage.length),
        cut: stage.cut.map(|solve::Cut::Time| "time".to_owned()),
        max_violation_m: normal(stage.max_violation),
        iterations: stage.iterations,
        starts: stage.starts,
        vertices_m: stage.corners.iter().map(|c| [tidy(c.point.x), tidy(c.point.y), tidy(c.radius)]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use crate::compiled::fixture::{compile, on};
    use crate::geometry::Polygon;
    use crate::model::*;
    use crate::source::{FileId, Span, Spanned};

    use super::{LayoutFile, Point};

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
        let row = PlaceRow { place: on(2, 4.0), every: 1.25, count: 2 };
        layout.equipment.chutes.push(Chutes { name: "row_a".to_owned(), row, more: Vec::new() });
        layout.equipment.motors = Motors::Evenly { count: 1 };
        layout.equipment.supports = Some(Spanned::new(2.5, fixture::span()));
        let text = String::from_utf8(super::json(&compile(layout))).unwrap();
        let read: LayoutFile = serde_json::from_str(&text).unwrap();
        assert_eq!(crate::base::json::to_json(&read), text.as_bytes());
        insta::assert_snapshot!(text);
    }
}
