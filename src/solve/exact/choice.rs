//! A choice of everything that a search decides.

use super::grid::Grid;
use super::open::Open;
use super::tariff::{Tariff, on_hull};
use crate::geometry::{Corner, Point};
use crate::problem::measures::to_variables;
use crate::solve::exact::row::{GridRow, Touch};
use std::rc::Rc;

/// A radius this close to the list is on it, m.
pub const ON_LIST: f64 = 1e-7;

/// A choice of everything.
#[derive(Clone, Debug)]
pub struct Choice {
    pub headings: Vec<i32>,
    pub radii: Vec<f64>,
    pub straights: Vec<f64>,
    pub first: Point,
}

impl Choice {
    /// The layout that a mix of choices with the same headings is.
    pub fn blend(mix: &[(Rc<Choice>, f64)]) -> Choice {
        let total: f64 = mix.iter().map(|m| m.1).sum();
        let mut out = (*mix[0].0).clone();
        let sum = |f: &dyn Fn(&Choice) -> f64| mix.iter().map(|(c, w)| f(c) * w).sum::<f64>() / total;
        for k in 0..out.radii.len() {
            out.radii[k] = sum(&|c| c.radii[k]);
            out.straights[k] = sum(&|c| c.straights[k]);
        }
        out.first = Point::new(sum(&|c| c.first.x), sum(&|c| c.first.y));
        out
    }

    /// The problem's variables.
    pub fn variables(&self, grid: &Grid) -> Vec<f64> {
        let vertices = self.vertices(grid);
        let corner = |v: usize| {
            let k = grid.stage(v);
            let near = |r: f64| grid.radii[k].iter().copied().find(|l| (l - r).abs() <= ON_LIST).unwrap_or(r);
            Corner { point: vertices[k], radius: near(self.radii[k]) }
        };
        let corners: Vec<Corner> = (0..grid.len()).map(corner).collect();
        to_variables(&corners)
    }

    /// What it costs at least with straights in their cells, in the tariff's units.
    pub fn cost(&self, grid: &Grid, tariff: &Tariff, open: &Open) -> f64 {
        let n = grid.len();
        let arc = |k: usize| {
            let steps = self.headings[k] - self.headings[k - 1];
            tariff.arc[k % n] * self.radii[k % n] * grid.turn(steps).0 + tariff.turn(k % n, steps)
        };
        let straight = |k: usize| {
            let pieces = open.hulls.get(k).map_or(0.0, |hull| on_hull(hull, self.straights[k]));
            tariff.straight[k] * self.straights[k] + pieces
        };
        (0..n).map(straight).sum::<f64>() + (1..=n).map(arc).sum::<f64>()
    }

    /// Tangent length at a vertex stage, m.
    pub fn tangent(&self, grid: &Grid, k: usize) -> f64 {
        let k = if k == 0 { grid.len() } else { k };
        self.radii[k % grid.len()] * grid.turn(self.headings[k] - self.headings[k - 1]).1
    }

    /// Vertices by stage 0..=n.
    pub fn vertices(&self, grid: &Grid) -> Vec<Point> {
        let n = grid.len();
        let mut at = vec![self.first];
        for k in 0..n {
            let length = self.straights[k] + self.tangent(grid, k) + self.tangent(grid, (k + 1) % n);
            at.push(at[k] + grid.unit(self.headings[k]) * length);
        }
        at
    }

    /// The row's value.
    pub fn value(&self, grid: &Grid, row: &GridRow, vertices: &[Point]) -> f64 {
        let n = grid.len();
        let scalars =
            |list: &[(usize, f64)], f: &dyn Fn(usize) -> f64| list.iter().map(|&(k, a)| a * f(k)).sum::<f64>();
        let before = |k: usize| grid.unit(self.headings[if k == 0 { n - 1 } else { k - 1 }]);
        let t = |k: usize| self.tangent(grid, k);
        row.at.iter().map(|&(k, g)| g.dot(vertices[k])).sum::<f64>()
            + scalars(&row.straight, &|k| self.straights[k])
            + scalars(&row.length, &|k| self.straights[k] + t(k) + t((k + 1) % n))
            + scalars(&row.radius, &|k| self.radii[k])
            + row.into.iter().map(|&(k, g)| t(k) * g.dot(before(k))).sum::<f64>()
            + row.out.iter().map(|&(k, g)| t(k) * g.dot(grid.unit(self.headings[k]))).sum::<f64>()
            + row.normal.iter().map(|&(k, g)| self.radii[k] * g.dot(before(k).left())).sum::<f64>()
            + row.touch.iter().map(|touch| self.touched(grid, touch)).sum::<f64>()
    }

    fn touched(&self, grid: &Grid, touch: &Touch) -> f64 {
        let sign = grid.signs[touch.from % grid.len()];
        let along = |k: usize| (self.headings[k], grid.unit(self.headings[k]));
        let arc = |k: usize| {
            let (tangent, radius) = touch.arc(k, sign, along(k - 1), along(k));
            tangent * self.tangent(grid, k % grid.len()) + radius * self.radii[k % grid.len()]
        };
        let straight = |k: usize| touch.straight(k, sign, along(k)) * self.straights[k];
        (touch.from..=touch.to).map(arc).sum::<f64>() + (touch.from..touch.to).map(straight).sum::<f64>()
    }
}

impl Open {
    /// Whether a choice lies within it.
    pub fn admits(&self, choice: &Choice, grid: &Grid) -> bool {
        let inside = |(h, value): (&Vec<i32>, &i32)| h.binary_search(value).is_ok();
        let within =
            |((range, list), r): ((&(usize, usize), &Vec<f64>), &f64)| list[range.0] <= *r && *r <= list[range.1];
        let made = |(hull, s): (&Rc<[(f64, f64)]>, &f64)| match (hull.first(), hull.last()) {
            (Some(first), Some(last)) => first.0 <= *s && *s <= last.0,
            _ => false,
        };
        self.hulls.iter().zip(&choice.straights).all(made)
            && self.headings.iter().zip(&choice.headings).all(inside)
            && self.radii.iter().zip(&grid.radii).zip(&choice.radii).all(within)
    }
}
