//! Vertices, building and obstacles.

use super::draft::{Draft, Placed};
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{NotSimple, Point, Polygon, Track};
use crate::model::{Building, Interval, Obstacle, Side, Vertex};
use crate::semantics::dimension::Dimension;
use crate::semantics::fields::{Bounds, COORDINATE};
use crate::semantics::program::mentions;
use crate::semantics::scope::{Context, Named, Scope};
use crate::semantics::value::metres;
use crate::source::{Span, Spanned};
use crate::syntax::tree::{self, Block, Expr, SideWord, Statement};

/// Most vertices of a layout, points of a polygon, and obstacles.
const MOST_VERTICES: usize = 2_000;
const MOST_POINTS: usize = 1_000;

/// The layout's geometry as far as it is known.
#[derive(Debug, Default)]
pub(in crate::semantics) struct Geometry<'t> {
    pub named: Named<'t>,
    /// `None` when one of them has a mistake.
    pub vertices: Option<Vec<Vertex>>,
    /// Filled in by the checks, once the vertices make a loop.
    pub track: Option<Track>,
    pub building: Option<Building>,
    pub obstacles: Vec<Obstacle>,
}

impl<'t> Context<'t> {
    pub(super) fn geometry(&self, draft: &Draft<'t>, radii: Option<Spanned<Interval>>) -> Geometry<'t> {
        let mut geometry = Geometry::default();
        let mut vertices: Vec<Option<Vertex>> = Vec::new();
        let incomplete = !draft.base_known || draft.doubtful || mentions(&draft.bad, "vertex");
        for placed in &draft.statements {
            match placed.statement {
                Statement::Vertex { name, point, radius } => {
                    geometry.named.vertices.insert(&name.text, vertices.len());
                    geometry.named.order.push(&name.text);
                    if vertices.len() == MOST_VERTICES {
                        self.too_many("vertices", MOST_VERTICES, placed.span);
                    }
                    if vertices.len() >= MOST_VERTICES {
                        vertices.push(None);
                        continue;
                    }
                    let at = self.point(placed, point);
                    let radius = match radius {
                        Some(expr) => {
                            let bounds = Bounds::above(0.0, 1e4);
                            self.bounded_constant(&placed.env, expr, Dimension::LENGTH, "the radius", bounds)
                        }
                        None => radii.map(|r| Spanned::new(r.value.low, placed.span)),
                    };
                    vertices.push(at.zip(radius).map(|(at, radius)| Vertex {
                        name: name.text.clone(),
                        point: at,
                        point_span: point.span,
                        radius,
                        span: placed.span,
                    }));
                }
                Statement::Building { polygon, clearance } => {
                    geometry.named.building = true;
                    let polygon = self.polygon(placed, polygon, "the building");
                    let clearance = self.clearance(placed, clearance.as_ref());
                    geometry.building = polygon.zip(clearance).map(|(polygon, clearance)| Building {
                        polygon,
                        clearance,
                        span: placed.span,
                    });
                }
                Statement::Obstacle { name, polygon, clearance } => {
                    geometry.named.obstacles.insert(&name.text, geometry.obstacles.len());
                    let polygon = self.polygon(placed, polygon, &format!("`{}`", name.text));
                    let clearance = self.clearance(placed, clearance.as_ref());
                    // A stand-in keeps the numbering of a faulty obstacle; the layout is refused anyway.
                    let Some(polygon) = polygon.or_else(stand_in) else { continue };
                    geometry.obstacles.push(Obstacle {
                        name: name.text.clone(),
                        polygon,
                        clearance: clearance.unwrap_or(0.0),
                        side: Side::Either,
                        pass: None,
                        span: placed.span,
                    });
                }
                _ => {}
            }
        }
        geometry.named.incomplete = incomplete;
        geometry.named.bad = draft.bad.clone();
        let route = draft.once("route").is_some();
        if let (true, Some(vertex)) =
            (route, draft.statements.iter().find(|p| matches!(p.statement, Statement::Vertex { .. })))
        {
            self.vertices_beside_route(draft, vertex.span);
        }
        if vertices.len() < 3 && !incomplete && !route {
            let diagnostic =
                Diagnostic::new(Code::E0401, "a loop needs at least three vertices", draft.name.span, "in this layout")
                    .expected("at least 3", vertices.len().to_string());
            self.report(diagnostic.help(
                "for example `vertex P1 (2 m, 1.5 m) radius 4 m`, in driving order; or `route` and the sections that a \
                 loop is to pass, to have the vertices found",
            ));
        }
        let known = vertices.len() >= 3 && !incomplete && !route;
        geometry.vertices = vertices.into_iter().collect::<Option<Vec<_>>>().filter(|_| known);
        self.passes(draft, &mut geometry);
        geometry
    }

    fn vertices_beside_route(&self, draft: &Draft<'t>, vertex: Span) {
        let route = draft.once("route").map_or(draft.name.span, |placed| placed.span);
        self.report(
            Diagnostic::new(Code::E0413, "the layout has vertices and asks for them", route, "asks for vertices")
                .related(vertex, "there is one")
                .help("remove the vertices, to have them found; or the route, to keep them"),
        );
    }

    fn too_many(&self, what: &str, most: usize, span: Span) {
        self.report(
            Diagnostic::new(Code::E0309, format!("there are too many {what}"), span, "one too many")
                .expected(format!("at most {most}"), "more"),
        );
    }

    pub(super) fn point(&self, placed: &Placed<'t>, point: &'t tree::PointExpr) -> Option<Point> {
        let coordinate = |expr: &'t Expr, what| {
            self.bounded_constant(&placed.env, expr, Dimension::LENGTH, what, COORDINATE).map(|v| v.value)
        };
        let (x, y) = (coordinate(&point.x, "the x coordinate"), coordinate(&point.y, "the y coordinate"));
        // -0 m would print as such.
        Some(Point::new(x? + 0.0, y? + 0.0))
    }

    fn clearance(&self, placed: &Placed<'t>, clearance: Option<&'t Expr>) -> Option<f64> {
        let Some(expr) = clearance else { return Some(0.0) };
        let bounds = Bounds::between(0.0, 1e3);
        self.bounded_constant(&placed.env, expr, Dimension::LENGTH, "the clearance", bounds).map(|v| v.value)
    }

    fn polygon(&self, placed: &Placed<'t>, block: &'t Block<tree::PointExpr>, what: &str) -> Option<Polygon> {
        if block.nodes.len() > MOST_POINTS {
            self.too_many("points in a polygon", MOST_POINTS, block.nodes[MOST_POINTS].value.span);
            return None;
        }
        let points: Vec<Option<Point>> = block.nodes.iter().map(|n| self.point(placed, &n.value)).collect();
        let points = points.into_iter().collect::<Option<Vec<Point>>>()?;
        let place = |i: usize| block.nodes[i % block.nodes.len()].value.span;
        let reason = match Polygon::new(points.clone()) {
            Ok(polygon) => return Some(polygon),
            Err(reason) => reason,
        };
        let diagnostic = |span: Span, label: &str| {
            Diagnostic::new(Code::E0406, format!("{what} is not a simple polygon"), span, label)
        };
        let n = points.len();
        let shown = |i: usize| format!("({}, {})", metres(points[i % n].x), metres(points[i % n].y));
        self.report(match reason {
            NotSimple::TooFewPoints => {
                diagnostic(block.span, "an outline needs area").expected("at least 3 points", n.to_string())
            }
            NotSimple::Repeated(i) => diagnostic(place(i + 1), "the same point again")
                .related(place(i), "the point before")
                .expected("neighbours that differ", format!("{} twice", shown(i)))
                .help("the outline closes by itself: the first point is not repeated at the end"),
            NotSimple::Flat => {
                diagnostic(block.span, "all points lie on one line").expected("an outline with area", "none")
            }
            NotSimple::Crossing(i, j) => diagnostic(place(j), "the edge that begins here")
                .related(place(i), "crosses or touches the edge that begins here")
                .expected(
                    "an outline that does not meet itself",
                    format!("{} to {} meeting {} to {}", shown(i), shown(i + 1), shown(j), shown(j + 1)),
                )
                .help("write the points in the order in which the outline is walked"),
        });
        None
    }

    /// Takes over the sides of `pass` statements.
    fn passes(&self, draft: &Draft<'t>, geometry: &mut Geometry<'t>) {
        for placed in &draft.statements {
            let Statement::Pass { obstacle, side } = placed.statement else { continue };
            let Some(index) = geometry.named.obstacles.get(obstacle.text.as_str()).copied() else {
                if draft.base_known && !mentions(&draft.bad, &obstacle.text) {
                    let message = format!("there is no obstacle `{}`", obstacle.text);
                    let diagnostic = Diagnostic::new(Code::E0208, message, obstacle.span, "not an obstacle");
                    self.report(self.with_nearest(diagnostic, obstacle, geometry.named.obstacles.keys().copied()));
                }
                continue;
            };
            if let Some(obstacle) = geometry.obstacles.get_mut(index) {
                obstacle.pass = Some(placed.span);
                obstacle.side = match side {
                    SideWord::Left => Side::Left,
                    SideWord::Right => Side::Right,
                    SideWord::Either => Side::Either,
                };
            }
        }
    }

    /// A scope in which formulas may ask the geometry.
    pub(super) fn scope<'a>(&self, placed: &'a Placed<'t>, geometry: &'a Geometry<'t>) -> Scope<'a, 't> {
        Scope { env: &placed.env, geometry: Some(&geometry.named) }
    }
}

fn stand_in() -> Option<Polygon> {
    Polygon::new(vec![Point::new(0.0, 0.0), Point::new(1.0, 0.0), Point::new(0.0, 1.0)]).ok()
}
