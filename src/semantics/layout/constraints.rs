//! `fix`, `require`, `equal` and `mirror` to constraints of the model.

use super::draft::{Draft, Placed};
use super::vertices::Geometry;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Constraint, ConstraintKind, FixKind, Formula, Target, Unit};
use crate::semantics::dimension::Dimension;
use crate::semantics::scope::Context;
use crate::semantics::value::{Quantity, negative, sum};
use crate::source::Span;
use crate::syntax::tree::{self, Axis, Expr, Relation, Statement};

/// A coordinate of a vertex as a formula.
type Coordinate = fn(usize) -> Formula;

impl<'t> Context<'t> {
    /// All constraints, unless one has a mistake.
    pub(super) fn constraints(&self, draft: &Draft<'t>, geometry: &Geometry<'t>) -> Option<Vec<Constraint>> {
        let mut constraints = Vec::new();
        let mut sound = true;
        for placed in &draft.statements {
            match self.constraint(placed, geometry) {
                Some(made) => constraints.extend(made),
                None => sound = false,
            }
        }
        sound.then_some(constraints)
    }

    /// The constraints of one statement; none for statements of other kinds.
    fn constraint(&self, placed: &Placed<'t>, geometry: &Geometry<'t>) -> Option<Vec<Constraint>> {
        let named = &geometry.named;
        let one = |kind| Some(vec![Constraint { kind, span: placed.span, reason: None }]);
        match placed.statement {
            Statement::FixSection { kinds, target } => {
                let from = self.section(named, &target.section)?;
                one(ConstraintKind::FixSection {
                    target: Target { from, straight: target.straight },
                    kinds: fix_kinds(kinds),
                })
            }
            Statement::FixVertex { vertex } => one(ConstraintKind::FixVertex { vertex: self.vertex(named, vertex)? }),
            Statement::FixRadius { vertex } => one(ConstraintKind::FixRadius { vertex: self.vertex(named, vertex)? }),
            Statement::Require { first, rest, reason } => {
                self.require(placed, geometry, first, rest, reason.as_deref())
            }
            Statement::Equal { values } => self.equal(placed, geometry, values),
            Statement::Mirror { first, second, axis, at } => {
                let at = self.constant(self.scope(placed, geometry), at, Dimension::LENGTH, "the mirror axis");
                let (a, b) = (self.vertex(named, first), self.vertex(named, second));
                let (a, b, at) = (a?, b?, at?);
                if a == b {
                    let message = format!("`{}` is mirrored onto itself", first.text);
                    self.report(
                        Diagnostic::new(Code::E0307, message, second.span, "the same vertex")
                            .expected("two vertices", "one")
                            .help("to hold a vertex on the axis, write `require`"),
                    );
                    return None;
                }
                let (across, along): (Coordinate, Coordinate) = match axis {
                    Axis::X => (Formula::X, Formula::Y),
                    Axis::Y => (Formula::Y, Formula::X),
                };
                let held = |formula, value| Constraint {
                    kind: ConstraintKind::Require { formula, low: value, high: value, unit: Unit::Metre },
                    span: placed.span,
                    reason: None,
                };
                Some(vec![
                    held(sum(vec![across(a), across(b)]), 2.0 * at),
                    held(sum(vec![along(a), negative(along(b))]), 0.0),
                ])
            }
            _ => Some(Vec::new()),
        }
    }

    /// `equal a, b, c`: each one equals the first.
    fn equal(&self, placed: &Placed<'t>, geometry: &Geometry<'t>, values: &'t [Expr]) -> Option<Vec<Constraint>> {
        let scope = self.scope(placed, geometry);
        let quantities: Vec<Option<Quantity>> = values.iter().map(|e| self.quantity(scope, e)).collect();
        let (first_expr, first) = (values.first()?, quantities.first()?.clone());
        let mut constraints = Vec::new();
        let mut sound = first.is_some();
        for (expr, quantity) in values.iter().zip(quantities).skip(1) {
            let (Some(first), Some(quantity)) = (&first, quantity) else {
                sound = false;
                continue;
            };
            if let Some((formula, low, high)) = self.row(first, first_expr, Relation::Equal, &quantity, expr) {
                constraints.push(self.required_row(placed, formula, low, high, first.dimension, None));
            } else {
                sound = false;
            }
        }
        sound.then_some(constraints)
    }

    fn require(
        &self,
        placed: &Placed<'t>,
        geometry: &Geometry<'t>,
        first: &'t Expr,
        rest: &'t [(Relation, Span, Expr)],
        reason: Option<&str>,
    ) -> Option<Vec<Constraint>> {
        let scope = self.scope(placed, geometry);
        let mut constraints: Vec<Constraint> = Vec::new();
        let mut left = (first, self.quantity(scope, first));
        let mut sound = left.1.is_some();
        for (relation, _, right) in rest {
            let quantity = self.quantity(scope, right);
            if let (Some(a), Some(b)) = (&left.1, &quantity) {
                match self.row(a, left.0, *relation, b, right) {
                    // `low <= f` and `f <= high` make one row.
                    Some((formula, low, high)) => match constraints.last_mut().map(|c| &mut c.kind) {
                        Some(ConstraintKind::Require { formula: same, low: l, high: h, .. }) if *same == formula => {
                            (*l, *h) = (l.max(low), h.min(high));
                        }
                        _ => constraints.push(self.required_row(placed, formula, low, high, a.dimension, reason)),
                    },
                    None => sound = false,
                }
            } else {
                sound = false;
            }
            left = (right, quantity);
        }
        sound.then_some(constraints)
    }

    fn required_row(
        &self,
        placed: &Placed<'t>,
        formula: Formula,
        low: f64,
        high: f64,
        dimension: Dimension,
        reason: Option<&str>,
    ) -> Constraint {
        let unit = match dimension {
            Dimension::LENGTH => Unit::Metre,
            Dimension::ANGLE => Unit::Radian,
            Dimension::NONE => Unit::One,
            Dimension::AREA => Unit::SquareMetre,
            _ => Unit::Other,
        };
        let kind = ConstraintKind::Require { formula, low: low + 0.0, high: high + 0.0, unit };
        Constraint { kind, span: placed.span, reason: reason.map(str::to_string) }
    }

    /// `a relation b` as `low <= formula <= high`, the constant side as the bound.
    fn row(
        &self,
        a: &Quantity,
        a_expr: &Expr,
        relation: Relation,
        b: &Quantity,
        b_expr: &Expr,
    ) -> Option<(Formula, f64, f64)> {
        if a.dimension != b.dimension {
            // The side that is a constant is the one to fix.
            let (wrong, expr, wanted, place) = match a.as_constant() {
                Some(_) => (a, a_expr, b.dimension, b_expr),
                None => (b, b_expr, a.dimension, a_expr),
            };
            let diagnostic = self.wrong_dimension(wrong, expr.span, wanted, "what is compared");
            self.report(diagnostic.related(place.span, wanted.with_article()));
            return None;
        }
        let (formula, bound, relation) = match (a.as_constant(), b.as_constant()) {
            (_, Some(bound)) => (a.formula.clone(), bound, relation),
            (Some(bound), None) => (b.formula.clone(), bound, reversed(relation)),
            (None, None) => (sum(vec![a.formula.clone(), negative(b.formula.clone())]), 0.0, relation),
        };
        Some(match relation {
            Relation::Less | Relation::LessEqual => (formula, f64::NEG_INFINITY, bound),
            Relation::Equal => (formula, bound, bound),
            Relation::GreaterEqual | Relation::Greater => (formula, bound, f64::INFINITY),
        })
    }
}

fn reversed(relation: Relation) -> Relation {
    match relation {
        Relation::Less => Relation::Greater,
        Relation::LessEqual => Relation::GreaterEqual,
        Relation::Equal => Relation::Equal,
        Relation::GreaterEqual => Relation::LessEqual,
        Relation::Greater => Relation::Less,
    }
}

/// `all` is the four others.
fn fix_kinds(kinds: &[(tree::FixKind, Span)]) -> Vec<FixKind> {
    let mut out = Vec::new();
    for (kind, _) in kinds {
        match kind {
            tree::FixKind::Length => out.push(FixKind::Length),
            tree::FixKind::Rotation => out.push(FixKind::Rotation),
            tree::FixKind::Parallel => out.push(FixKind::Parallel),
            tree::FixKind::Perpendicular => out.push(FixKind::Perpendicular),
            tree::FixKind::All => {
                out.extend([FixKind::Length, FixKind::Rotation, FixKind::Parallel, FixKind::Perpendicular])
            }
        }
    }
    out.sort();
    out.dedup();
    out
}
