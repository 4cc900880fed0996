//! The layout's own rows where they are linear in the columns.

use super::super::affine::Affine;
use super::super::measures::{x, y};
use super::super::{Function, relation};
use super::Writer;
use super::linear::Sum;
use crate::base::trig;
use crate::model::{Formula, Target};

impl Affine {
    fn of(terms: impl IntoIterator<Item = (usize, f64)>) -> Self {
        Affine { terms: terms.into_iter().collect(), constant: 0.0 }
    }
}

impl Writer<'_> {
    /// Adds the rows that are linear; gives the others as text.
    pub fn user_rows(&mut self) -> Vec<String> {
        let mut left_out = Vec::new();
        for (k, row) in self.problem.rows.iter().enumerate() {
            // Turns are chosen within their limits, and straights have a row a heading; both stand first.
            if k < 2 * self.vertices.len() {
                continue;
            }
            match self.linear(&row.function) {
                Some(Affine { terms, constant }) => {
                    let name = format!("{}#{k}", row.label.replace(' ', "_"));
                    self.milp.row(name, terms, row.low - constant, row.high - constant);
                }
                None => left_out.push(format!("{} ({})", row.label, relation(self.problem, row))),
            }
        }
        left_out
    }

    fn linear(&self, function: &Function) -> Option<Affine> {
        match function {
            Function::Turn(i) => Some(self.turn(*i)),
            Function::Section(i) => Some(self.section(*i)),
            Function::Straight(i) => Some(self.straight(*i)),
            Function::Linear(terms) => {
                let sum = terms.iter().fold(Affine::default(), |sum, &(k, c)| sum.plus(c, &self.variable(k)));
                Some(sum)
            }
            Function::StraightMiddle { .. } | Function::StraightEnd { .. } => None,
            Function::Formula(formula) => self.formula(formula),
        }
    }

    fn formula(&self, formula: &Formula) -> Option<Affine> {
        match formula {
            Formula::Constant(value) => Some(Affine { terms: Sum::new(), constant: *value }),
            Formula::X(i) => Some(self.variable(x(*i))),
            Formula::Y(i) => Some(self.variable(y(*i))),
            Formula::Radius(i) => Some(self.curves(*i, |_, r| r)),
            Formula::Length(Target { from, straight: false }) => Some(self.section(*from)),
            Formula::Length(Target { from, straight: true }) => Some(self.straight(*from)),
            Formula::Angle(i) => Some(Affine::default().plus(self.problem.signs[*i], &self.turn(*i))),
            Formula::Heading(i) => {
                Some(Affine::of(self.sections[*i].iter().map(|&(h, choice, _)| (choice, self.grid.heading(h)))))
            }
            Formula::Sum(terms) => {
                terms.iter().try_fold(Affine::default(), |sum, term| Some(sum.plus(1.0, &self.formula(term)?)))
            }
            Formula::Product(factors) => {
                let one = Affine { terms: Sum::new(), constant: 1.0 };
                factors.iter().try_fold(one, |product, factor| {
                    let factor = self.formula(factor)?;
                    let (k, of) = if product.terms.is_empty() { (&product, &factor) } else { (&factor, &product) };
                    k.terms.is_empty().then(|| Affine::default().plus(k.constant, of))
                })
            }
            Formula::Negative(inner) => Some(Affine::default().plus(-1.0, &self.formula(inner)?)),
            Formula::Reciprocal(inner) => {
                let inner = self.formula(inner)?;
                inner.terms.is_empty().then(|| Affine { terms: Sum::new(), constant: 1.0 / inner.constant })
            }
            Formula::DistanceVertices(..)
            | Formula::DistanceObstacle(..)
            | Formula::DistanceBuilding(_)
            | Formula::Absolute(_)
            | Formula::SquareRoot(_)
            | Formula::Smallest(_)
            | Formula::Largest(_) => None,
        }
    }

    /// One of the problem's variables: x, y or R of a vertex.
    fn variable(&self, k: usize) -> Affine {
        let vertex = &self.vertices[k / 3];
        match k % 3 {
            0 => Affine::of([(vertex.x, 1.0)]),
            1 => Affine::of([(vertex.y, 1.0)]),
            _ => self.curves(k / 3, |_, r| r),
        }
    }

    /// What the chosen turn (rad) and radius (m) at a vertex come to.
    fn curves(&self, i: usize, of: impl Fn(f64, f64) -> f64) -> Affine {
        let turn = |t: i64| t as f64 * self.grid.step;
        Affine::of(self.vertices[i].curves.iter().map(|&(t, r, column)| (column, of(turn(t), r))))
    }

    fn turn(&self, i: usize) -> Affine {
        self.curves(i, |turn, _| turn)
    }

    fn section(&self, i: usize) -> Affine {
        Affine::of(self.sections[i].iter().map(|&(.., length)| (length, 1.0)))
    }

    fn straight(&self, i: usize) -> Affine {
        let tangent = |v: usize| self.curves(v, |turn, r| r * trig::tan(turn / 2.0));
        self.section(i).plus(-1.0, &tangent(i)).plus(-1.0, &tangent(self.next(i)))
    }
}
