//! `require` formulas with exact derivatives.

use super::expansion::Expansion;
use super::jet::Jet;
use super::measures::{Measures, radius, x, y};
use crate::geometry::{Point, Polygon};
use crate::model::{Formula, Target};

/// The polygons that `distance` may name.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct Places {
    pub obstacles: Vec<Polygon>,
    pub building: Option<Polygon>,
}

/// Value and derivatives of a formula. Where it has a kink (an absolute value, the nearest edge of a polygon), the
/// derivatives of the side taken.
pub fn expand(formula: &Formula, m: &Measures, signs: &[f64], places: &Places) -> Expansion {
    let sub = |f: &Formula| expand(f, m, signs, places);
    match formula {
        Formula::Constant(value) => Expansion::constant(*value),
        Formula::X(i) => Expansion::variable(m.corners[*i].point.x, x(*i)),
        Formula::Y(i) => Expansion::variable(m.corners[*i].point.y, y(*i)),
        Formula::Radius(i) => Expansion::variable(m.corners[*i].radius, radius(*i)),
        Formula::Length(Target { from, straight: false }) => m.section(*from),
        Formula::Length(Target { from, straight: true }) => m.straight(*from),
        Formula::Heading(i) => {
            let [a, b] = m.section_ends(*i);
            let along = b - a;
            Expansion::from_jet(&along.y.atan2(&along.x), &m.section_variables(*i))
        }
        Formula::Angle(i) => m.at(*i, |v| v.turn).scale(signs[*i]),
        Formula::DistanceVertices(a, b) => {
            let delta = |p: fn(usize) -> usize, u: f64, v: f64| {
                Expansion::variable(v, p(*b)).sub(&Expansion::variable(u, p(*a)))
            };
            let (p, q) = (m.corners[*a].point, m.corners[*b].point);
            let (dx, dy) = (delta(x, p.x, q.x), delta(y, p.y, q.y));
            dx.mul(&dx).add(&dy.mul(&dy)).square_root()
        }
        Formula::DistanceObstacle(i, k) => to_outline(*i, &places.obstacles[*k], m),
        Formula::DistanceBuilding(i) => match &places.building {
            Some(walls) => to_outline(*i, walls, m).scale(-1.0),
            None => Expansion::constant(f64::INFINITY),
        },
        Formula::Sum(terms) => terms.iter().fold(Expansion::constant(0.0), |sum, t| sum.add(&sub(t))),
        Formula::Product(terms) => terms.iter().fold(Expansion::constant(1.0), |product, t| product.mul(&sub(t))),
        Formula::Negative(f) => sub(f).scale(-1.0),
        Formula::Reciprocal(f) => {
            let e = sub(f);
            let r = 1.0 / e.value;
            e.chain(r, -r * r, 2.0 * r * r * r)
        }
        Formula::Absolute(f) => {
            let e = sub(f);
            if e.value < 0.0 { e.scale(-1.0) } else { e }
        }
        Formula::SquareRoot(f) => sub(f).square_root(),
        Formula::Smallest(terms) => pick(terms.iter().map(sub), |a, b| b.value < a.value),
        Formula::Largest(terms) => pick(terms.iter().map(sub), |a, b| b.value > a.value),
    }
}

fn pick(mut terms: impl Iterator<Item = Expansion>, better: impl Fn(&Expansion, &Expansion) -> bool) -> Expansion {
    let first = terms.next().unwrap_or_else(|| Expansion::constant(0.0));
    terms.fold(first, |best, e| if better(&best, &e) { e } else { best })
}

/// The part of a polygon's outline that is nearest to a point, and the side the point is on.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    pub foot: Point,
    /// Unit normal of the edge beside the point, towards it; `None` where a corner is nearest.
    pub normal: Option<Point>,
    /// -1 inside the polygon, else 1.
    pub sign: f64,
}

/// `None` for a polygon without edges.
pub fn nearest(polygon: &Polygon, p: Point) -> Option<Nearest> {
    let (_, foot, along) = polygon
        .edges()
        .map(|(a, b)| {
            let along = b - a;
            let t = (p - a).dot(along) / along.dot(along);
            let foot = a.lerp(b, t.clamp(0.0, 1.0));
            (p.distance(foot), foot, (0.0..=1.0).contains(&t).then_some(along * (1.0 / along.norm())))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let normal = along.map(|u| if u.cross(p - foot) < 0.0 { -u.left() } else { u.left() });
    Some(Nearest { foot, normal, sign: if polygon.contains(p) { -1.0 } else { 1.0 } })
}

/// Distance from a vertex to a polygon's outline, negative inside: the language's distance is 0 there, which has no
/// slope to leave by.
fn to_outline(vertex: usize, polygon: &Polygon, m: &Measures) -> Expansion {
    let p = m.corners[vertex].point;
    let Some(Nearest { foot, normal, sign }) = nearest(polygon, p) else { return Expansion::constant(f64::INFINITY) };
    let (px, py) = (Jet::<2>::variable(p.x, 0), Jet::<2>::variable(p.y, 1));
    let (dx, dy) = (px + Jet::constant(-foot.x), py + Jet::constant(-foot.y));
    let jet = match normal {
        // Beside an edge: the distance to its line.
        Some(normal) => dx.scale(normal.x) + dy.scale(normal.y),
        None => (dx * dx + dy * dy).sqrt(),
    };
    Expansion::from_jet(&jet.scale(sign), &[x(vertex), y(vertex)])
}
