//! The best multipliers of the dual, by column generation: the simplex method on convex combinations of choices, which
//! the shortest path prices (Dantzig and Wolfe 1960).
//!
//! Nothing here has to be exact: whatever multipliers come out, the bound is evaluated by [`network`](super::network).
//!
//! Written here, because columns come one at a time, each from a shortest path under the multipliers of the last step:
//! a solver that takes a whole linear program would begin anew with each of them.

use super::grid::Grid;
use super::network::{Dual, Limits, minimise};
use super::row::GridRow;
use super::tariff::Tariff;
use crate::solve::exact::choice::Choice;
use crate::solve::exact::open::Open;
use std::rc::Rc;

/// A choice with what it costs and the rows' values.
#[derive(Clone, Debug)]
pub struct Column {
    pub choice: Rc<Choice>,
    /// In the tariff's units.
    pub cost: f64,
    pub values: Vec<f64>,
}

impl Column {
    pub fn new(grid: &Grid, tariff: &Tariff, open: &Open, choice: Rc<Choice>, rows: &[GridRow]) -> Self {
        let vertices = choice.vertices(grid);
        let values = rows.iter().map(|row| choice.value(grid, row, &vertices)).collect();
        Column { cost: choice.cost(grid, tariff, open), choice, values }
    }

    /// Values of rows that were added since, and what it costs among what is open now.
    pub fn complete(&mut self, grid: &Grid, tariff: &Tariff, open: &Open, rows: &[GridRow]) {
        if !open.hulls.is_empty() {
            self.cost = self.choice.cost(grid, tariff, open);
        }
        if self.values.len() < rows.len() {
            let vertices = self.choice.vertices(grid);
            let known = self.values.len();
            self.values.extend(rows[known..].iter().map(|row| self.choice.value(grid, row, &vertices)));
        }
    }
}

/// The relaxation's optimum, or as much of it as was needed.
pub struct Relaxed {
    /// Rigorous lower bound, in the tariff's units.
    pub bound: f64,
    /// Least total through each heading, as rigorous.
    pub through: Vec<Vec<f64>>,
    /// Choices with their weights, if the optimum meets every row.
    pub mix: Option<Vec<(Rc<Choice>, f64)>>,
}

const PIVOTS: usize = 400;
const PIVOT: f64 = 1e-9;
const PRICED: f64 = 1e-9;

#[derive(Clone, Copy, PartialEq)]
enum Variable {
    Column(usize),
    /// How far a row is exceeded.
    Surplus(usize),
    /// How far a row is missed from below, from above.
    Short(usize),
    Over(usize),
}

/// Maximises the dual until `cutoff` is reached or nothing is left to gain. No multiplier is larger than `dear`, the
/// price of a metre by which a row is not met. `None` when no headings fit together.
pub fn relax(
    grid: &Grid,
    limits: &Limits,
    open: &Open,
    rows: &[GridRow],
    pool: &mut Vec<Column>,
    cutoff: f64,
    dear: f64,
) -> Option<Relaxed> {
    let m = rows.len();
    if pool.is_empty() {
        let dual = minimise(grid, limits, open, rows, &vec![0.0; m])?;
        pool.push(Column::new(grid, &limits.tariff, open, Rc::new(dual.choice), rows));
    }
    let miss = |c: &Column| -> f64 {
        let off = |(row, v): (&GridRow, &f64)| if row.equal { (row.low - v).abs() } else { (row.low - v).max(0.0) };
        c.cost + dear * rows.iter().zip(&c.values).map(off).sum::<f64>()
    };
    let start = (0..pool.len()).min_by(|&a, &b| miss(&pool[a]).total_cmp(&miss(&pool[b]))).unwrap_or(0);
    let mut basis: Vec<Variable> = (0..m)
        .map(|r| {
            let lack = rows[r].low - pool[start].values[r];
            match (lack >= 0.0, rows[r].equal) {
                (true, _) => Variable::Short(r),
                (false, true) => Variable::Over(r),
                (false, false) => Variable::Surplus(r),
            }
        })
        .collect();
    basis.push(Variable::Column(start));
    let mut best: Option<Dual> = None;
    let mut weights = Vec::new();
    for _ in 0..PIVOTS {
        let Some(factors) = Factors::new(&basis, pool, m) else { break };
        let mut right: Vec<f64> = rows.iter().map(|r| r.low).collect();
        right.push(1.0);
        weights = factors.solve(&right);
        let costs: Vec<f64> = basis.iter().map(|v| cost(*v, pool, dear)).collect();
        let y = factors.solve_transposed(&costs);
        let (prices, share) = y.split_at(m);
        let mut entering = cheapest(rows, pool, &basis, prices, share[0], dear);
        if entering.is_none() {
            let y: Vec<f64> = prices.iter().zip(rows).map(|(y, r)| if r.equal { *y } else { y.max(0.0) }).collect();
            let dual = minimise(grid, limits, open, rows, &y)?;
            let constant: f64 = y.iter().zip(rows).map(|(y, r)| y * r.low).sum();
            let reduced = dual.value - constant - share[0];
            let column = Rc::new(dual.choice.clone());
            let bound = dual.bound;
            if best.as_ref().is_none_or(|b| bound > b.bound) {
                best = Some(dual);
            }
            if bound >= cutoff || reduced > -PRICED {
                break;
            }
            pool.push(Column::new(grid, &limits.tariff, open, column, rows));
            entering = Some(Variable::Column(pool.len() - 1));
        }
        let Some(entering) = entering else { break };
        let direction = factors.solve(&column_of(entering, pool, m));
        let Some(leaving) = leaving(&weights, &direction) else { break };
        basis[leaving] = entering;
    }
    let best = match best {
        Some(best) => best,
        None => minimise(grid, limits, open, rows, &vec![0.0; m])?,
    };
    let missed = |(v, w): (&Variable, &f64)| matches!(v, Variable::Short(_) | Variable::Over(_)) && *w > 1e-7;
    let met = best.bound < cutoff && weights.len() == basis.len() && !basis.iter().zip(&weights).any(missed);
    let mix = met.then(|| {
        let shares = basis.iter().zip(&weights).filter_map(|(v, &w)| match v {
            Variable::Column(j) if w > 1e-9 => Some((pool[*j].choice.clone(), w)),
            _ => None,
        });
        shares.collect()
    });
    // Children start from the basis and the latest columns.
    let kept = |j: usize| basis.contains(&Variable::Column(j));
    let count = pool.len();
    let mut place = 0;
    pool.retain(|_| {
        place += 1;
        kept(place - 1) || place + 24 > count
    });
    Some(Relaxed { bound: best.bound, through: best.through, mix })
}

fn cost(v: Variable, pool: &[Column], dear: f64) -> f64 {
    match v {
        Variable::Column(j) => pool[j].cost,
        Variable::Surplus(_) => 0.0,
        Variable::Short(_) | Variable::Over(_) => dear,
    }
}

fn column_of(v: Variable, pool: &[Column], m: usize) -> Vec<f64> {
    let unit = |r: usize, value: f64| {
        let mut column = vec![0.0; m + 1];
        column[r] = value;
        column
    };
    match v {
        Variable::Column(j) => pool[j].values.iter().copied().chain([1.0]).collect(),
        Variable::Short(r) => unit(r, 1.0),
        Variable::Surplus(r) | Variable::Over(r) => unit(r, -1.0),
    }
}

/// The variable of least reduced cost, if that is negative.
fn cheapest(
    rows: &[GridRow],
    pool: &[Column],
    basis: &[Variable],
    y: &[f64],
    share: f64,
    dear: f64,
) -> Option<Variable> {
    let mut best = (-PRICED, None);
    let mut offer = |reduced: f64, v: Variable| {
        if reduced < best.0 && !basis.contains(&v) {
            best = (reduced, Some(v));
        }
    };
    for (j, column) in pool.iter().enumerate() {
        let rows: f64 = column.values.iter().zip(y).map(|(v, y)| v * y).sum();
        offer(column.cost - rows - share, Variable::Column(j));
    }
    for (r, row) in rows.iter().enumerate() {
        offer(dear - y[r], Variable::Short(r));
        if row.equal {
            offer(dear + y[r], Variable::Over(r));
        } else {
            offer(y[r], Variable::Surplus(r));
        }
    }
    best.1
}

/// The row of the basis that reaches zero first; among near ties the largest pivot.
fn leaving(weights: &[f64], direction: &[f64]) -> Option<usize> {
    let ratio = |i: usize| weights[i].max(0.0) / direction[i];
    let candidates = || (0..weights.len()).filter(|&i| direction[i] > PIVOT);
    let least = candidates().map(ratio).fold(f64::INFINITY, f64::min);
    candidates().filter(|&i| ratio(i) <= least + 1e-12).max_by(|&a, &b| direction[a].total_cmp(&direction[b]))
}

/// LU factors of a basis, with partial pivoting.
struct Factors {
    size: usize,
    lu: Vec<f64>,
    order: Vec<usize>,
}

impl Factors {
    fn new(basis: &[Variable], pool: &[Column], m: usize) -> Option<Self> {
        let size = m + 1;
        let mut lu = vec![0.0; size * size];
        for (j, v) in basis.iter().enumerate() {
            for (i, value) in column_of(*v, pool, m).into_iter().enumerate() {
                lu[i * size + j] = value;
            }
        }
        let mut order: Vec<usize> = (0..size).collect();
        for k in 0..size {
            let pivot = (k..size).max_by(|&a, &b| lu[a * size + k].abs().total_cmp(&lu[b * size + k].abs()))?;
            if lu[pivot * size + k].abs() < 1e-13 {
                return None;
            }
            if pivot != k {
                order.swap(pivot, k);
                (0..size).for_each(|j| lu.swap(k * size + j, pivot * size + j));
            }
            for i in k + 1..size {
                let factor = lu[i * size + k] / lu[k * size + k];
                if factor == 0.0 {
                    continue;
                }
                lu[i * size + k] = factor;
                for j in k + 1..size {
                    lu[i * size + j] -= factor * lu[k * size + j];
                }
            }
        }
        Some(Factors { size, lu, order })
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.lu[i * self.size + j]
    }

    /// B x = b
    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = self.order.iter().map(|&i| b[i]).collect();
        for i in 0..self.size {
            x[i] -= (0..i).map(|j| self.at(i, j) * x[j]).sum::<f64>();
        }
        for i in (0..self.size).rev() {
            x[i] -= (i + 1..self.size).map(|j| self.at(i, j) * x[j]).sum::<f64>();
            x[i] /= self.at(i, i);
        }
        x
    }

    /// Bᵀ y = c
    fn solve_transposed(&self, c: &[f64]) -> Vec<f64> {
        let mut z = c.to_vec();
        for i in 0..self.size {
            z[i] -= (0..i).map(|j| self.at(j, i) * z[j]).sum::<f64>();
            z[i] /= self.at(i, i);
        }
        for i in (0..self.size).rev() {
            z[i] -= (i + 1..self.size).map(|j| self.at(j, i) * z[j]).sum::<f64>();
        }
        let mut y = vec![0.0; self.size];
        for (k, &i) in self.order.iter().enumerate() {
            y[i] = z[k];
        }
        y
    }
}
