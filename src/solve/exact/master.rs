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

/// Choices that a relaxation is mixed from, with the basis of the last one: rows are only ever added, so that it begins the
/// next one, unless one of its choices is excluded.
#[derive(Clone, Debug, Default)]
pub struct Pool {
    columns: Vec<Column>,
    basis: Option<Vec<Variable>>,
}

impl Pool {
    /// Leaves out choices that are excluded now, and completes the others with rows that were added.
    pub fn renew(&mut self, grid: &Grid, tariff: &Tariff, open: &Open, rows: &[GridRow]) {
        let keep: Vec<bool> = self.columns.iter().map(|c| open.admits(&c.choice, grid)).collect();
        self.retain(&keep);
        self.columns.iter_mut().for_each(|c| c.complete(grid, tariff, open, rows));
    }

    fn retain(&mut self, keep: &[bool]) {
        let places: Vec<usize> =
            keep.iter().scan(0, |n, &kept| Some(std::mem::replace(n, *n + usize::from(kept)))).collect();
        let moved = |v: &Variable| match *v {
            Variable::Column(j) => keep[j].then(|| Variable::Column(places[j])),
            other => Some(other),
        };
        self.basis = self.basis.take().and_then(|basis| basis.iter().map(moved).collect());
        let mut kept = keep.iter();
        self.columns.retain(|_| kept.next().copied().unwrap_or(false));
    }

    /// A basis that is feasible where multipliers may be as large as one likes: the last one with what rows that were added
    /// are missed by, or the choice that misses rows by least, at this price.
    fn begin(&mut self, rows: &[GridRow], dear: f64) -> Vec<Variable> {
        let lack = |r: usize, value: f64| match (rows[r].low - value, rows[r].equal) {
            (lack, _) if lack >= 0.0 => Variable::Short(r),
            (_, true) => Variable::Over(r),
            (_, false) => Variable::Surplus(r),
        };
        if let Some(mut basis) = self.basis.take() {
            let known = basis.len() - 1;
            let mut right: Vec<f64> = rows[..known].iter().map(|r| r.low).collect();
            right.push(1.0);
            if let Some(inverse) = Inverse::new(&basis, &self.columns, &rows[..known]) {
                let weights = inverse.solve(&right);
                let value = |r: usize| {
                    let mix = basis.iter().zip(&weights).filter_map(|(v, w)| match v {
                        Variable::Column(j) => Some(w * self.columns[*j].values[r]),
                        Variable::Relief(of) if rows[r].relief == Some(*of) => Some(*w),
                        _ => None,
                    });
                    mix.sum()
                };
                let added: Vec<Variable> = (known..rows.len()).map(|r| lack(r, value(r))).collect();
                basis.extend(added);
                return basis;
            }
        }
        let miss = |c: &Column| -> f64 {
            let off = |(row, v): (&GridRow, &f64)| if row.equal { (row.low - v).abs() } else { (row.low - v).max(0.0) };
            c.cost + dear * rows.iter().zip(&c.values).map(off).sum::<f64>()
        };
        let all = 0..self.columns.len();
        let start = all.min_by(|&a, &b| miss(&self.columns[a]).total_cmp(&miss(&self.columns[b]))).unwrap_or(0);
        let mut basis = vec![Variable::Column(start)];
        basis.extend((0..rows.len()).map(|r| lack(r, self.columns[start].values[r])));
        basis
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
/// So many pivots after one another the inverse of a basis is updated.
const RENEWED: usize = 40;
/// What weights may miss rows by, m.
const SOLVED: f64 = 1e-7;
const PIVOT: f64 = 1e-9;
const PRICED: f64 = 1e-9;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Variable {
    Column(usize),
    /// How far a row is exceeded.
    Surplus(usize),
    /// How far a row is missed from below, from above.
    Short(usize),
    Over(usize),
    /// By how much all rows of a relief may be short.
    Relief(usize),
}

/// Maximises the dual until `cutoff` is reached or nothing is left to gain. No multiplier is larger than `dear`, the
/// price of a metre by which a row is not met. `None` when no headings fit together.
pub fn relax(
    grid: &Grid,
    limits: &Limits,
    open: &Open,
    rows: &[GridRow],
    pool: &mut Pool,
    cutoff: f64,
    dear: f64,
) -> Option<Relaxed> {
    let m = rows.len();
    if pool.columns.is_empty() {
        let dual = minimise(grid, limits, open, rows, &vec![0.0; m])?;
        pool.columns.push(Column::new(grid, &limits.tariff, open, Rc::new(dual.choice), rows));
    }
    let mut basis = pool.begin(rows, dear);
    let columns = &mut pool.columns;
    let mut right: Vec<f64> = rows.iter().map(|r| r.low).collect();
    right.push(1.0);
    let mut best: Option<Dual> = None;
    let mut inverse = Inverse::new(&basis, columns, rows);
    for pivot in 1..=PIVOTS {
        let Some(at) = &mut inverse else { break };
        let costs: Vec<f64> = basis.iter().map(|v| cost(*v, columns, &limits.reliefs, dear)).collect();
        let y = at.solve_transposed(&costs);
        let (prices, share) = y.split_at(m);
        let mut entering = cheapest((rows, columns, &limits.reliefs), &basis, prices, share[0], dear);
        if entering.is_none() {
            let mut y: Vec<f64> = prices.iter().zip(rows).map(|(y, r)| if r.equal { *y } else { y.max(0.0) }).collect();
            hold_to_reliefs(&mut y, rows, &limits.reliefs);
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
            columns.push(Column::new(grid, &limits.tariff, open, column, rows));
            entering = Some(Variable::Column(columns.len() - 1));
        }
        let Some(entering) = entering else { break };
        let direction = at.solve(&column_of(entering, columns, rows));
        let Some(leaving) = leaving(&at.solve(&right), &direction) else { break };
        basis[leaving] = entering;
        if pivot % RENEWED == 0 {
            inverse = Inverse::new(&basis, columns, rows);
        } else {
            at.pivot(leaving, &direction);
        }
    }
    let best = match best {
        Some(best) => best,
        None => minimise(grid, limits, open, rows, &vec![0.0; m])?,
    };
    // Nearly singular, a basis means nothing.
    let weights = Inverse::new(&basis, columns, rows).map(|at| at.solve(&right));
    let weights = weights.filter(|weights| is_solved(&basis, weights, columns, (rows, &right)));
    let missed = |(v, w): (&Variable, &f64)| matches!(v, Variable::Short(_) | Variable::Over(_)) && *w > 1e-7;
    let mix = weights.as_ref().filter(|w| best.bound < cutoff && !basis.iter().zip(*w).any(missed)).map(|weights| {
        let shares = basis.iter().zip(weights).filter_map(|(v, &w)| match v {
            Variable::Column(j) if w > 1e-9 => Some((columns[*j].choice.clone(), w)),
            _ => None,
        });
        shares.collect()
    });
    // Children start from the basis and the latest columns.
    let count = columns.len();
    let keep: Vec<bool> = (0..count).map(|j| basis.contains(&Variable::Column(j)) || j + 25 > count).collect();
    pool.basis = weights.is_some().then_some(basis);
    pool.retain(&keep);
    Some(Relaxed { bound: best.bound, through: best.through, mix })
}

/// Whether weights are those of a basis, none of them negative.
fn is_solved(basis: &[Variable], weights: &[f64], pool: &[Column], (rows, right): (&[GridRow], &[f64])) -> bool {
    let mut left = right.to_vec();
    for (v, w) in basis.iter().zip(weights) {
        let column = column_of(*v, pool, rows);
        left.iter_mut().zip(&column).for_each(|(left, value)| *left -= w * value);
    }
    weights.iter().all(|w| *w >= -SOLVED) && left.iter().all(|left| left.abs() <= SOLVED)
}

/// No rows of one relief have higher multipliers in all than it costs: else the dual has no bound.
fn hold_to_reliefs(y: &mut [f64], rows: &[GridRow], reliefs: &[f64]) {
    for (relief, price) in reliefs.iter().enumerate() {
        let own = |row: &GridRow| row.relief == Some(relief);
        let all: f64 = y.iter().zip(rows).filter(|(_, row)| own(row)).map(|(y, _)| y).sum();
        if all > price * (1.0 - 1e-12) {
            let share = price / all * (1.0 - 1e-12);
            y.iter_mut().zip(rows).filter(|(_, row)| own(row)).for_each(|(y, _)| *y *= share);
        }
    }
}

fn cost(v: Variable, pool: &[Column], reliefs: &[f64], dear: f64) -> f64 {
    match v {
        Variable::Relief(of) => reliefs[of],
        Variable::Column(j) => pool[j].cost,
        Variable::Surplus(_) => 0.0,
        Variable::Short(_) | Variable::Over(_) => dear,
    }
}

fn column_of(v: Variable, pool: &[Column], rows: &[GridRow]) -> Vec<f64> {
    let m = rows.len();
    let unit = |r: usize, value: f64| {
        let mut column = vec![0.0; m + 1];
        column[r] = value;
        column
    };
    match v {
        Variable::Column(j) => pool[j].values[..m].iter().copied().chain([1.0]).collect(),
        Variable::Short(r) => unit(r, 1.0),
        Variable::Surplus(r) | Variable::Over(r) => unit(r, -1.0),
        Variable::Relief(of) => rows.iter().map(|row| f64::from(row.relief == Some(of))).chain([0.0]).collect(),
    }
}

/// The variable of least reduced cost, if that is negative.
fn cheapest(
    (rows, pool, reliefs): (&[GridRow], &[Column], &[f64]),
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
    for (of, price) in reliefs.iter().enumerate() {
        let own: f64 = rows.iter().zip(y).filter(|(row, _)| row.relief == Some(of)).map(|(_, y)| y).sum();
        offer(price - own, Variable::Relief(of));
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

/// The inverse of a basis, by rows.
struct Inverse {
    size: usize,
    rows: Vec<f64>,
}

impl Inverse {
    /// By elimination with partial pivoting (Gauss and Jordan). `None` where the basis is singular.
    fn new(basis: &[Variable], pool: &[Column], rows: &[GridRow]) -> Option<Self> {
        let size = rows.len() + 1;
        let wide = 2 * size;
        let mut a = vec![0.0; size * wide];
        for (j, v) in basis.iter().enumerate() {
            for (i, value) in column_of(*v, pool, rows).into_iter().enumerate() {
                a[i * wide + j] = value;
            }
        }
        (0..size).for_each(|i| a[i * wide + size + i] = 1.0);
        for k in 0..size {
            let pivot = (k..size).max_by(|&p, &q| a[p * wide + k].abs().total_cmp(&a[q * wide + k].abs()))?;
            if a[pivot * wide + k].abs() < 1e-13 {
                return None;
            }
            if pivot != k {
                (0..wide).for_each(|j| a.swap(k * wide + j, pivot * wide + j));
            }
            let factor = 1.0 / a[k * wide + k];
            let row: Vec<f64> = a[k * wide..][..wide].iter().map(|v| v * factor).collect();
            a[k * wide..][..wide].copy_from_slice(&row);
            for i in (0..size).filter(|&i| i != k) {
                subtract(&mut a[i * wide..][..wide], k, &row);
            }
        }
        Some(Inverse { size, rows: a.chunks(wide).flat_map(|row| row[size..].iter().copied()).collect() })
    }

    /// That of the basis with another variable at a place, `direction` being what [`solve`](Self::solve) makes of it.
    fn pivot(&mut self, place: usize, direction: &[f64]) {
        let n = self.size;
        let row: Vec<f64> = self.rows[place * n..][..n].iter().map(|v| v / direction[place]).collect();
        for (i, own) in self.rows.chunks_mut(n).enumerate() {
            if i == place {
                own.copy_from_slice(&row);
            } else if direction[i] != 0.0 {
                own.iter_mut().zip(&row).for_each(|(a, b)| *a -= direction[i] * b);
            }
        }
    }

    /// B x = b
    fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.rows.chunks(self.size).map(|row| row.iter().zip(b).map(|(r, b)| r * b).sum()).collect()
    }

    /// Bᵀ y = c
    fn solve_transposed(&self, c: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.size];
        for (row, c) in self.rows.chunks(self.size).zip(c).filter(|(_, c)| **c != 0.0) {
            y.iter_mut().zip(row).for_each(|(y, r)| *y += c * r);
        }
        y
    }
}

/// Takes from a row as much of another as its entry at a place, where the other has one.
fn subtract(own: &mut [f64], place: usize, row: &[f64]) {
    let factor = own[place];
    if factor != 0.0 {
        own.iter_mut().zip(row).for_each(|(a, b)| *a -= factor * b);
    }
}
