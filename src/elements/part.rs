//! What has to be ordered: the pieces of the track in space.

use super::course::SNAP;
use super::sequence::{degrees, millimetres};
use super::space::{Leg, Space};
use super::{Cover, Sequence, Shape, cover};
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Form, Point};
use crate::model::{Catalog, Layout};
use serde::Serialize;

/// What a piece is, wherever it lies. Metres and radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Part {
    Straight {
        length: f64,
        cut: bool,
    },
    Curve {
        radius: f64,
        turn: f64,
    },
    /// Between two slopes; the slope angle changes by `turn`: upwards (a sag) where positive, else a crest.
    Vertical {
        radius: f64,
        turn: f64,
    },
    /// A curve that climbs.
    Spiral {
        /// Of its plan.
        radius: f64,
        turn: f64,
        rise: f64,
    },
}

impl Part {
    /// Of the centre line, m.
    pub fn length(&self) -> f64 {
        match *self {
            Part::Straight { length, .. } => length,
            Part::Curve { radius, turn } | Part::Vertical { radius, turn } => radius * turn.abs(),
            Part::Spiral { radius, turn, rise } => trig::hypot(radius * turn, rise),
        }
    }

    /// Turned end for end where that makes fewer articles: a right curve is a left one, and a spiral that falls to the
    /// right one that rises to the left. A sag stays a sag.
    pub fn turned(self) -> Part {
        match self {
            Part::Curve { radius, turn } => Part::Curve { radius, turn: turn.abs() },
            Part::Spiral { radius, turn, rise } if rise < 0.0 => Part::Spiral { radius, turn: -turn, rise: -rise },
            other => other,
        }
    }

    fn article(&self, in_catalog: bool, catalog: &Catalog) -> String {
        let special = if in_catalog { "" } else { "X-" };
        match self.turned() {
            Part::Straight { length, .. } => format!("{special}{}-{}", catalog.straight.article, millimetres(length)),
            Part::Curve { radius, turn } => {
                format!("{special}{}-{}-{}", catalog.curve.article, millimetres(radius), degrees(turn))
            }
            Part::Vertical { radius, turn } => {
                let prefix = catalog.vertical.as_ref().map_or("VC", |v| v.article.as_str());
                let kind = if turn < 0.0 { "C" } else { "S" };
                format!("{special}{prefix}-{}-{}{kind}", millimetres(radius), degrees(turn))
            }
            Part::Spiral { radius, turn, rise } => {
                let prefix = catalog.spiral.as_ref().map_or("SP", |s| s.article.as_str());
                let hand = if turn < 0.0 { "R" } else { "L" };
                let (radius, rise) = (millimetres(radius), millimetres(rise));
                format!("{special}{prefix}-{radius}-{}-{rise}{hand}", degrees(turn))
            }
        }
    }
}

/// One orderable piece of the track in space.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderedPiece {
    pub part: Part,
    /// `ST-3000`, `CU-4000-45` as in the sequence; `VC-10000-8S` is the vertical curve of 10 m and 8° that is a sag
    /// (`C`: a crest), `SP-4000-45-400L` the spiral of 4 m and 45° that rises by 400 mm to the left. `X-` is before
    /// what the catalogue lacks.
    pub article: String,
    pub in_catalog: bool,
    pub place: PlaceInPlan,
}

/// Where a piece lies in the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceInPlan {
    /// Vertex whose section or fillet it belongs to.
    pub vertex: usize,
    /// Arc length of the plan where it begins, m, from vertex 0's outgoing tangent point.
    pub s: f64,
    /// How far it reaches in the plan, m.
    pub run: f64,
    /// Where it begins, m, and its heading there, rad.
    pub position: Point,
    pub heading: f64,
}

/// The pieces of a track in driving order: its elements where it lies level, else what its legs in space are made of.
pub fn pieces(sequence: &Sequence, space: &Space, layout: &Layout) -> Vec<OrderedPiece> {
    if layout.levels.is_empty() {
        return sequence.elements.iter().map(|e| OrderedPiece::of(e, in_plan(e))).collect();
    }
    let plan = sequence.length().max(f64::MIN_POSITIVE);
    let mut list = Vec::new();
    let mut s = space.plan_begin();
    for (leg, stretch) in space.legs.iter().zip(&space.line.stretches) {
        let mut within = 0.0;
        let share = leg.form.run() / leg.form.length().max(f64::MIN_POSITIVE);
        for (part, article, in_catalog) in parts_of_leg(leg, sequence, layout) {
            let run = part.length() * share;
            let frame = stretch.at(leg.form.along(within));
            let place = PlaceInPlan {
                vertex: leg.vertex,
                s: (s + within).rem_euclid(plan),
                run,
                position: Point::new(frame.position.x, frame.position.y),
                heading: frame.heading(),
            };
            list.push(OrderedPiece { part, article, in_catalog, place });
            within += run;
        }
        s += leg.form.run();
    }
    list
}

impl OrderedPiece {
    fn of(e: &super::Element, place: PlaceInPlan) -> Self {
        OrderedPiece { part: part(e), article: e.article.clone(), in_catalog: e.in_catalog, place }
    }

    /// Whether it lies on a turn of the plan.
    pub fn turns(&self) -> bool {
        matches!(self.part, Part::Curve { .. } | Part::Spiral { .. })
    }
}

fn in_plan(e: &super::Element) -> PlaceInPlan {
    PlaceInPlan { vertex: e.vertex, s: e.s, run: e.length, position: e.position, heading: e.heading }
}

fn part(e: &super::Element) -> Part {
    match e.shape {
        Shape::Straight { length, cut } => Part::Straight { length, cut },
        Shape::Curve { radius, turn } => Part::Curve { radius, turn },
    }
}

/// What a leg in space is made of, with the article and whether the catalogue has it.
fn parts_of_leg(leg: &Leg, sequence: &Sequence, layout: &Layout) -> Vec<(Part, String, bool)> {
    let catalog = &layout.catalog;
    let made = |part: Part, in_catalog: bool| (part, part.article(in_catalog, catalog), in_catalog);
    match leg.form {
        Form::Straight { length, .. } => match cover::straight(length, &catalog.straight, Cover::of(layout)) {
            Some(parts) => {
                parts.into_iter().map(|p| made(Part::Straight { length: p.length, cut: p.cut }, true)).collect()
            }
            None => vec![made(Part::Straight { length, cut: true }, false)],
        },
        Form::Arc { .. } => {
            let curve = |e: &&super::Element| e.vertex == leg.vertex && matches!(e.shape, Shape::Curve { .. });
            let elements = sequence.elements.iter().filter(curve);
            elements.map(|e| (part(e), e.article.clone(), e.in_catalog)).collect()
        }
        Form::Vertical { radius, slope_from, slope_to } => {
            let turn = trig::atan(slope_to) - trig::atan(slope_from);
            vec![made(Part::Vertical { radius, turn }, has_vertical(catalog, radius, turn))]
        }
        Form::Spiral { radius, turn, rise } => {
            spiral(catalog, radius, turn, rise).into_iter().map(|(part, has)| made(part, has)).collect()
        }
    }
}

fn has_vertical(catalog: &Catalog, radius: f64, turn: f64) -> bool {
    catalog.vertical.as_ref().is_some_and(|stock| {
        let step = stock.angle_step;
        let on_grid = step <= 0.0 || (turn - (turn / step).round() * step).abs() <= SNAP;
        on_grid && stock.radii.iter().any(|r| (r - radius).abs() <= SNAP)
    })
}

/// A spiral as pieces of at most the largest angle of a curve, each with its share of the rise.
fn spiral(catalog: &Catalog, radius: f64, turn: f64, rise: f64) -> Vec<(Part, bool)> {
    let listed = catalog.spiral.as_ref().filter(|stock| {
        let slope = rise.abs() / (radius * turn.abs());
        stock.radii.iter().any(|r| (r - radius).abs() <= SNAP) && slope <= stock.steepest + SNAP
    });
    let parts = listed.and_then(|stock| {
        let steps = (turn.abs() / stock.angle_step).round();
        let on_grid = (steps * stock.angle_step - turn.abs()).abs() <= SNAP && steps < 1e6;
        let largest = ((catalog.curve.largest + SNAP) / stock.angle_step).floor() as usize;
        let parts = on_grid.then(|| cover::turn(steps as usize, largest)).flatten()?;
        Some(parts.into_iter().map(|k| k as f64 / steps).collect::<Vec<f64>>())
    });
    let in_catalog = parts.is_some();
    let share = |k: f64| (Part::Spiral { radius, turn: turn * k, rise: rise * k }, in_catalog);
    parts.unwrap_or_else(|| vec![1.0]).into_iter().map(share).collect()
}

/// A warning for the vertical curves and spirals that the layout's catalogue does not have.
pub fn climbs_lacking(pieces: &[OrderedPiece], layout: &Layout) -> Option<Diagnostic> {
    let climbs = |p: &&OrderedPiece| matches!(p.part, Part::Vertical { .. } | Part::Spiral { .. }) && !p.in_catalog;
    let mut articles: Vec<&str> = pieces.iter().filter(climbs).map(|p| p.article.as_str()).collect();
    articles.sort_unstable();
    articles.dedup();
    let span = layout.ramps.first().map(|r| r.span).or(layout.levels.first().map(|l| l.span))?;
    articles.first()?;
    let message =
        format!("catalogue `{}` lacks vertical curves or spirals that this layout needs", layout.catalog.name);
    let expected = match &layout.catalog.vertical {
        Some(stock) if stock.angle_step > 0.0 => {
            format!("slope angles in steps of {}°, at the catalogue's radii", degrees(stock.angle_step))
        }
        Some(_) => "the catalogue's radii".to_string(),
        None => "a catalogue with vertical curves".to_string(),
    };
    Some(
        Diagnostic::new(Code::W0711, message, span, "a climb of this layout")
            .expected(expected, articles.join(", "))
            .help("the bill has them as special pieces: choose another slope or radius, or extend the catalogue"),
    )
}
