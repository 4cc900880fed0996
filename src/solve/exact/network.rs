//! The Lagrangian dual of a loop over headings and radii: for any multipliers a shortest path.
//!
//! min L(x) s.t. rows a_r(x) >= b_r is bounded from below by Σ y_r b_r + min_x [L(x) − Σ y_r a_r(x)] for every y_r >= 0
//! (of any sign for equalities; Geoffrion 1974). With headings chosen, every row is a sum over sections and vertices,
//! so the inner minimum is a shortest path through the headings of one section after another, straights and radii each
//! at an end of their interval.

use super::grid::Grid;
use super::row::{GridRow, Touch};
use super::tariff::Tariff;
use super::touched::Touched;
use crate::geometry::Point;
use crate::solve::exact::choice::Choice;
use crate::solve::exact::open::Open;

/// Limits that hold everywhere.
pub struct Limits {
    pub tariff: Tariff,
    /// Of each straight, m, by stage; finite.
    pub straights: Vec<(f64, f64)>,
    /// Corners of a box that holds the first vertex, m.
    pub first: (Point, Point),
    /// What a metre costs by which rows of one relief may be short, in the tariff's units.
    pub reliefs: Vec<f64>,
}

/// The sum of rows under multipliers, by the stage that each part belongs to.
struct Prices {
    /// On the displacement of a section.
    section: Vec<Point>,
    straight: Vec<f64>,
    length: Vec<f64>,
    radius: Vec<f64>,
    into: Vec<Point>,
    out: Vec<Point>,
    normal: Vec<Point>,
    /// On arcs, by stage 1..=n, and on straights, by stage; sizes of pulls on either.
    arcs: Vec<Touched>,
    straights: Vec<Touched>,
    pulled: Vec<f64>,
    /// How many touches there are at the stage that has most.
    touches: usize,
    /// On the first vertex.
    first: Point,
    /// Σ y b
    constant: f64,
    /// Σ |y b|
    size: f64,
}

impl Prices {
    fn new(grid: &Grid, rows: &[GridRow], y: &[f64]) -> Self {
        let n = grid.len();
        let zero = vec![Point::default(); n];
        let mut p = Prices {
            section: zero.clone(),
            straight: vec![0.0; n],
            length: vec![0.0; n],
            radius: vec![0.0; n],
            into: zero.clone(),
            out: zero.clone(),
            normal: zero,
            arcs: Vec::new(),
            straights: Vec::new(),
            pulled: vec![0.0; n + 1],
            touches: 0,
            first: Point::default(),
            constant: 0.0,
            size: 0.0,
        };
        let mut pulls = vec![Point::default(); n + 1];
        let mut touches: Vec<Vec<Touch>> = vec![Vec::new(); n + 1];
        for (row, &y) in rows.iter().zip(y).filter(|(_, y)| **y != 0.0) {
            row.at.iter().for_each(|&(k, g)| pulls[k] = pulls[k] - g * y);
            row.straight.iter().for_each(|&(k, a)| p.straight[k] -= a * y);
            row.length.iter().for_each(|&(k, a)| p.length[k] -= a * y);
            row.radius.iter().for_each(|&(k, a)| p.radius[k] -= a * y);
            row.into.iter().for_each(|&(k, g)| p.into[k] = p.into[k] - g * y);
            row.out.iter().for_each(|&(k, g)| p.out[k] = p.out[k] - g * y);
            row.normal.iter().for_each(|&(k, g)| p.normal[k] = p.normal[k] - g * y);
            for t in &row.touch {
                let priced = Touch { pull: -(t.pull * y), ..*t };
                (t.from..=t.to).for_each(|k| touches[k].push(priced));
            }
            p.constant += row.low * y;
            p.size += (row.low * y).abs();
        }
        let mut ahead = Point::default();
        for k in (0..n).rev() {
            ahead = ahead + pulls[k + 1];
            p.section[k] = ahead;
        }
        p.first = ahead + pulls[0];
        let size = |t: &Touch| t.pull.x.abs() + t.pull.y.abs();
        for (k, touches) in touches.into_iter().enumerate() {
            p.pulled[k] = touches.iter().map(size).sum();
            p.touches = p.touches.max(touches.len());
            let along = touches.iter().filter(|t| t.from <= k && k < t.to).copied().collect();
            let sign = touches.first().map_or(1, |t| grid.signs[t.from % n]);
            p.straights.push(Touched::new(along, k, sign));
            p.arcs.push(Touched::new(touches, k, sign));
        }
        p
    }
}

/// A dual bound with everything that a choice through each heading costs at least.
pub struct Dual {
    /// In the tariff's units; holds in exact arithmetic: what rounding may have added is taken off.
    pub bound: f64,
    /// As computed, with the choice that attains it.
    pub value: f64,
    pub choice: Choice,
    /// Least total through each open heading, by stage and place in the list, m; as rigorous as the bound.
    pub through: Vec<Vec<f64>>,
}

/// Minimises over all that is open. `None` when no headings fit together.
pub fn minimise(grid: &Grid, limits: &Limits, open: &Open, rows: &[GridRow], y: &[f64]) -> Option<Dual> {
    let n = grid.len();
    let p = Prices::new(grid, rows, y);
    let straight = |k: usize, h: i32| {
        let u = grid.unit(h);
        let touched = p.straights[k].straight(h, u);
        let price = limits.tariff.straight[k] + p.straight[k] + p.length[k] + p.section[k].dot(u) + touched;
        if let Some(hull) = open.hulls.get(k) {
            let total = |v: &(f64, f64)| (price * v.0 + v.1, v.0);
            return hull.iter().map(total).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 0.0));
        }
        let (low, high) = limits.straights[k];
        if price >= 0.0 { (price * low, low) } else { (price * high, high) }
    };
    let (low, high) = limits.first;
    let corner = |g: f64, low: f64, high: f64| if g >= 0.0 { low } else { high };
    let first = Point::new(corner(p.first.x, low.x, high.x), corner(p.first.y, low.y, high.y));
    let constant = p.constant + p.first.dot(first);

    let own = |k: usize| open.headings[k].iter().map(|&h| if k == n { 0.0 } else { straight(k, h).0 }).collect();
    let own: Vec<Vec<f64>> = (0..=n).map(own).collect();

    // Forward, with the vertex (section) before as parent.
    let mut reach: Vec<Vec<f64>> = vec![vec![own[0][0]]];
    let mut from: Vec<Vec<(usize, f64)>> = vec![vec![(0, 0.0)]];
    let mut steps: Vec<Vec<Edge>> = Vec::with_capacity(n);
    for k in 1..=n {
        let edges = edges(grid, &limits.tariff, open, &p, k);
        let mut best = vec![(f64::INFINITY, 0, 0.0); open.headings[k].len()];
        for edge in &edges {
            let total = reach[k - 1][edge.from] + edge.cost;
            if total < best[edge.to].0 {
                best[edge.to] = (total, edge.from, edge.radius);
            }
        }
        reach.push(best.iter().zip(&own[k]).map(|(b, own)| b.0 + own).collect());
        from.push(best.iter().map(|b| (b.1, b.2)).collect());
        steps.push(edges);
    }
    let value = reach[n][0];
    if !value.is_finite() {
        return None;
    }
    let margin = margin(grid, limits, open, &p, first);
    let mut rest: Vec<Vec<f64>> = open.headings.iter().map(|h| vec![f64::INFINITY; h.len()]).collect();
    rest[n][0] = 0.0;
    for k in (1..=n).rev() {
        for edge in &steps[k - 1] {
            let total = edge.cost + own[k][edge.to] + rest[k][edge.to];
            if total < rest[k - 1][edge.from] {
                rest[k - 1][edge.from] = total;
            }
        }
    }
    let through = reach
        .iter()
        .zip(&rest)
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a + b + constant - margin).collect())
        .collect();
    let mut headings = vec![0; n + 1];
    let mut radii = vec![0.0; n];
    let mut place = 0;
    for k in (1..=n).rev() {
        headings[k] = open.headings[k][place];
        (place, radii[k % n]) = from[k][place];
    }
    headings[0] = open.headings[0][place];
    let straights = (0..n).map(|k| straight(k, headings[k]).1).collect();
    let choice = Choice { headings, radii, straights, first };
    let value = value + constant;
    Some(Dual { bound: value - margin, value, choice, through })
}

struct Edge {
    from: usize,
    to: usize,
    cost: f64,
    radius: f64,
}

/// The turns from each open heading of stage k − 1 to each of stage k.
fn edges(grid: &Grid, tariff: &Tariff, open: &Open, p: &Prices, k: usize) -> Vec<Edge> {
    let n = grid.len();
    let v = k % n;
    let (low, high) = open.radii[v];
    let (low, high) = (grid.radii[v][low], grid.radii[v][high]);
    let before = p.section[k - 1] + p.into[v];
    let after = p.section[v] + p.out[v];
    let lengths = p.length[k - 1] + p.length[v];
    let entering: Vec<(f64, f64)> = open.headings[k - 1]
        .iter()
        .map(|&h| {
            let u = grid.unit(h);
            let price = p.normal[v].dot(u.left()) + p.radius[v];
            (before.dot(u) + lengths, price)
        })
        .collect();
    let leaving: Vec<f64> = open.headings[k].iter().map(|&h| after.dot(grid.unit(h))).collect();
    let touched = &p.arcs[k];
    let touch = |list: &[i32]| -> Vec<(usize, Point)> {
        if touched.len() == 0 { Vec::new() } else { list.iter().map(|&h| (touched.passed(h), grid.unit(h))).collect() }
    };
    let (into, out_of) = (touch(&open.headings[k - 1]), touch(&open.headings[k]));
    let mut out = Vec::new();
    let (least, most) = grid.turns[v];
    let sign = grid.signs[v];
    for (from, &h) in open.headings[k - 1].iter().enumerate() {
        let (begin, end) = if sign > 0 { (h + least, h + most) } else { (h - most, h - least) };
        let begin = open.headings[k].partition_point(|&t| t < begin);
        for (to, &t) in open.headings[k].iter().enumerate().skip(begin) {
            if t > end {
                break;
            }
            let (angle, tangent) = grid.turn(t - h);
            let mut price = tariff.arc[v] * angle + entering[from].1 + tangent * (entering[from].0 + leaving[to]);
            if touched.len() > 0 {
                let (along, across) = touched.arc(into[from], out_of[to]);
                price += tangent * along + across;
            }
            let radius = if price >= 0.0 { low } else { high };
            let cost = price * radius + tariff.turn(v, t - h);
            out.push(Edge { from, to, cost, radius });
        }
    }
    out
}

/// More than floating-point arithmetic can have added to a bound: every sum has at most 32 + 4n roundings, and four more
/// for each touch of a stage, each of at most half an ulp of the sum of absolute values (Higham 2002, §4.2); unit vectors and tangents are good to 4 ulps.
fn margin(grid: &Grid, limits: &Limits, open: &Open, p: &Prices, first: Point) -> f64 {
    let n = grid.len();
    let size = |g: Point| g.x.abs() + g.y.abs();
    let mut total = p.size + size(p.first) * (first.x.abs() + first.y.abs());
    for k in 0..n {
        let touched = |k: usize| p.pulled[k];
        let tariff = &limits.tariff;
        let price = tariff.straight[k] + p.straight[k].abs() + p.length[k].abs() + size(p.section[k]) + touched(k);
        total += price * limits.straights[k].1.abs().max(limits.straights[k].0.abs());
        total += open.hulls.get(k).map_or(0.0, |hull| hull.iter().map(|v| v.1).fold(0.0, f64::max));
        total += tariff.turn(k, grid.turns[k].1);
        let before = (k + n - 1) % n;
        let radius = grid.radii[k][open.radii[k].1];
        let (angle, tangent) = grid.turn(grid.turns[k].1);
        let turning = size(p.section[before]) + size(p.section[k]) + size(p.into[k]) + size(p.out[k]);
        let lengths = p.length[before].abs() + p.length[k].abs();
        let stage = if k == 0 { n } else { k };
        let touching = (2.0 + 2.0 * tangent) * touched(stage);
        let turning = tangent * (turning + lengths) + touching;
        total += radius * (tariff.arc[k] * angle + p.radius[k].abs() + size(p.normal[k]) + turning);
    }
    f64::EPSILON * (32.0 + 4.0 * n as f64 + 4.0 * p.touches as f64) * total
}
