//! Expressions to values: units, dimensions, names, arithmetic.

use std::rc::Rc;

use super::dimension::{self, Dimension, UnitError, parse_unit};
use super::program::Space;
use super::scope::{Context, Env, Local, Scope, Slot, SlotState};
use super::value::{Quantity, RangeValue, Value, negative, product, sum};
use crate::diagnostic::{Code, Diagnostic};
use crate::model::Formula;
use crate::source::{Span, Spanned};
use crate::syntax::tree::{Expr, ExprKind, Name, ProductOp, SumOp};

impl<'t> Context<'t> {
    /// The value of an expression. Mistakes are reported, and poison what they touch.
    pub fn evaluate(&self, scope: Scope<'_, 't>, expr: &'t Expr) -> Value {
        self.deeper(expr.span, || self.evaluate_here(scope, expr)).unwrap_or(Value::Poison)
    }

    fn evaluate_here(&self, scope: Scope<'_, 't>, expr: &'t Expr) -> Value {
        let all = |items: &mut dyn Iterator<Item = &'t Expr>| -> Vec<Spanned<Value>> {
            items.map(|e| Spanned::new(self.evaluate(scope, e), e.span)).collect()
        };
        match &expr.kind {
            ExprKind::Number { digits, unit } => self.number(digits, unit.as_ref(), expr.span),
            ExprKind::Text(text) => Value::Text(text.clone()),
            ExprKind::Name(name) => self.name(scope, name, expr.span),
            ExprKind::Call { name, args } => self.call(scope, name, args, expr.span),
            ExprKind::Paren(inner) => self.evaluate(scope, inner),
            ExprKind::Negative(inner) => match self.quantity(scope, inner) {
                Some(q) => Value::Quantity(Quantity { formula: negative(q.formula), ..q }),
                None => Value::Poison,
            },
            ExprKind::Sum { first, rest } => self.sum(scope, first, rest, expr.span),
            ExprKind::Product { first, rest } => self.product(scope, first, rest, expr.span),
            ExprKind::List(block) => Value::List(all(&mut block.nodes.iter().map(|n| &n.value))),
            ExprKind::Tuple(items) => Value::Tuple(all(&mut items.iter())),
            ExprKind::Range { low, high, step } => {
                let end = |e: &'t Expr| Spanned::new(self.evaluate(scope, e), e.span);
                let (low, high, step) = (end(low), end(high), step.as_ref().map(|s| end(s)));
                Value::Range(Box::new(RangeValue { low, high, step }))
            }
        }
    }

    /// The value of an expression that must be a number; `None` when poisoned or reported.
    pub fn quantity(&self, scope: Scope<'_, 't>, expr: &'t Expr) -> Option<Quantity> {
        match self.evaluate(scope, expr) {
            Value::Quantity(quantity) => Some(quantity),
            Value::Poison => None,
            other => {
                self.report(
                    Diagnostic::new(Code::E0304, "only numbers can be computed with", expr.span, other.described())
                        .expected("a number", other.described()),
                );
                None
            }
        }
    }

    /// A constant of the given dimension; anything else is reported with `what` (`the speed`).
    pub fn constant(&self, scope: Scope<'_, 't>, expr: &'t Expr, dimension: Dimension, what: &str) -> Option<f64> {
        let value = self.evaluate(scope, expr);
        self.expect_constant(&value, expr.span, dimension, what)
    }

    /// The same for a value at hand.
    pub fn expect_constant(&self, value: &Value, span: Span, dimension: Dimension, what: &str) -> Option<f64> {
        let Value::Quantity(quantity) = value else {
            if *value != Value::Poison {
                let message = format!("{what} must be {}", dimension.with_article());
                self.report(
                    Diagnostic::new(Code::E0304, message, span, value.described())
                        .expected(dimension.with_article(), value.described()),
                );
            }
            return None;
        };
        if quantity.dimension != dimension {
            self.report(self.wrong_dimension(quantity, span, dimension, what));
            return None;
        }
        let constant = quantity.as_constant();
        if constant.is_none() {
            self.report(self.not_constant(span, what));
        }
        constant
    }

    fn not_constant(&self, span: Span, what: &str) -> Diagnostic {
        Diagnostic::new(
            Code::E0308,
            format!("{what} must be known before the layout is solved"),
            span,
            "depends on the geometry",
        )
        .expected("a constant", "a formula over the layout's geometry")
        .help("formulas over the geometry belong in `require` and `equal`")
    }

    /// What to say about a quantity of another dimension.
    pub fn wrong_dimension(&self, quantity: &Quantity, span: Span, wanted: Dimension, what: &str) -> Diagnostic {
        let text = self.sources.text(span);
        let bare =
            text.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+' | b'e' | b'E' | b'_' | b' '));
        if let (true, Dimension::NONE, Some(unit)) = (bare, quantity.dimension, wanted.unit()) {
            let fix = format!("{} {unit}", text.trim());
            return Diagnostic::new(Code::E0302, format!("{what} needs a unit"), span, "a bare number")
                .expected(wanted.with_article(), "a number without unit")
                .help(format!("write `{fix}`"))
                .fix(span, fix);
        }
        Diagnostic::new(
            Code::E0301,
            format!("{what} must be {}, not {}", wanted.with_article(), quantity.dimension.with_article()),
            span,
            quantity.dimension.with_article(),
        )
        .expected(wanted.to_string(), quantity.dimension.to_string())
    }

    fn number(&self, digits: &str, unit: Option<&Name>, span: Span) -> Value {
        let clean: String = digits.chars().filter(|c| *c != '_').collect();
        let Ok(value) = clean.parse::<f64>() else {
            self.report(Diagnostic::new(Code::E0305, format!("`{digits}` is no number"), span, "cannot be read"));
            return Value::Poison;
        };
        let unit = match unit.map(|u| parse_unit(&u.text).map_err(|e| (e, u))).transpose() {
            Ok(unit) => unit,
            Err((error, name)) => {
                self.report(self.bad_unit(error, name));
                return Value::Poison;
            }
        };
        let (value, dimension) = match unit {
            Some(unit) => (value * unit.factor + unit.offset, unit.dimension),
            None => (value, Dimension::NONE),
        };
        self.finite(Formula::Constant(value), dimension, span, "the number is too large")
    }

    fn bad_unit(&self, error: UnitError, name: &Name) -> Diagnostic {
        match error {
            UnitError::Exponent(part) => Diagnostic::new(
                Code::E0303,
                format!("the unit `{part}` has an odd exponent"),
                name.span,
                "not understood",
            )
            .expected("exponents in steps of 0.5, from -6 to 6", format!("`{part}`")),
            UnitError::Unknown(symbol) => {
                let mut diagnostic =
                    Diagnostic::new(Code::E0303, format!("`{symbol}` is not a unit"), name.span, "not known")
                        .expected(dimension::symbols().collect::<Vec<_>>().join(", "), format!("`{symbol}`"));
                if let Some(near) = dimension::meant(&symbol) {
                    diagnostic = diagnostic.fix(name.span, name.text.replacen(&symbol, near, 1));
                }
                diagnostic
            }
        }
    }

    /// A quantity, unless a constant has left the numbers.
    pub fn finite(&self, formula: Formula, dimension: Dimension, span: Span, message: &str) -> Value {
        if let Formula::Constant(value) = formula
            && !value.is_finite()
        {
            self.report(
                Diagnostic::new(Code::E0305, message, span, if value.is_nan() { "not a number" } else { "infinite" })
                    .expected("a finite number", if value.is_nan() { "none" } else { "infinity" }),
            );
            return Value::Poison;
        }
        Value::Quantity(Quantity { formula, dimension })
    }

    fn name(&self, scope: Scope<'_, 't>, name: &str, span: Span) -> Value {
        if let Some((env, local)) = scope.env.find(name) {
            return match local {
                Local::Param(value) => value.clone(),
                Local::Let(slot) => self.slot(env, slot, span),
            };
        }
        if let Some(symbol) = self.find(scope.env.module, Space::Let, name)
            && let Some(slot) = self.global(symbol)
        {
            return self.slot(&Env::global(symbol.module), &slot, span);
        }
        self.unknown_value(scope, name, span);
        Value::Poison
    }

    /// The value of a `let`, evaluated at most once.
    pub fn slot(&self, env: &Rc<Env<'t>>, slot: &Slot<'t>, used_at: Span) -> Value {
        let state = slot.state.borrow().clone();
        match state {
            SlotState::Known(value) => value,
            SlotState::Busy => {
                self.report(
                    Diagnostic::new(
                        Code::E0216,
                        format!("`{}` depends on itself", slot.name.text),
                        used_at,
                        "needed to compute itself",
                    )
                    .related(slot.name.span, "defined here")
                    .help("break the circle: write one of the values as a number"),
                );
                Value::Poison
            }
            SlotState::Unknown => {
                *slot.state.borrow_mut() = SlotState::Busy;
                let value = self.evaluate(Scope { env, geometry: None }, slot.expr);
                *slot.state.borrow_mut() = SlotState::Known(value.clone());
                self.values.borrow_mut().entry(slot.name.span).or_insert_with(|| value.clone());
                value
            }
        }
    }

    fn sum(&self, scope: Scope<'_, 't>, first: &'t Expr, rest: &'t [(SumOp, Expr)], span: Span) -> Value {
        let start = self.quantity(scope, first);
        let mut dimension = start.as_ref().map(|q| (q.dimension, first.span));
        let mut sound = start.is_some();
        let mut terms: Vec<Formula> = start.into_iter().map(|q| q.formula).collect();
        for (op, expr) in rest {
            let Some(q) = self.quantity(scope, expr) else {
                sound = false;
                continue;
            };
            match dimension {
                Some((wanted, place)) if wanted != q.dimension => {
                    let what = "what is added or subtracted";
                    let diagnostic = self.wrong_dimension(&q, expr.span, wanted, what);
                    self.report(diagnostic.related(place, wanted.with_article()));
                    sound = false;
                }
                _ => dimension = Some((q.dimension, expr.span)),
            }
            terms.push(if *op == SumOp::Minus { negative(q.formula) } else { q.formula });
        }
        match (sound, dimension) {
            (true, Some((dimension, _))) => self.finite(sum(terms), dimension, span, "the sum is too large"),
            _ => Value::Poison,
        }
    }

    fn product(&self, scope: Scope<'_, 't>, first: &'t Expr, rest: &'t [(ProductOp, Expr)], span: Span) -> Value {
        let start = self.quantity(scope, first);
        let mut sound = start.is_some();
        let mut dimension = start.as_ref().map_or(Dimension::NONE, |q| q.dimension);
        let mut factors: Vec<Formula> = start.into_iter().map(|q| q.formula).collect();
        for (op, expr) in rest {
            let Some(q) = self.quantity(scope, expr) else {
                sound = false;
                continue;
            };
            let combined = match op {
                ProductOp::Times => dimension.times(q.dimension),
                ProductOp::Divide => dimension.over(q.dimension),
            };
            let Some(combined) = combined else {
                let message = "the product's dimension makes no sense any more";
                self.report(Diagnostic::new(Code::E0301, message, span, "exponents beyond 60"));
                return Value::Poison;
            };
            dimension = combined;
            if *op == ProductOp::Times {
                factors.push(q.formula);
                continue;
            }
            match q.formula {
                Formula::Constant(0.0) => {
                    self.report(
                        Diagnostic::new(Code::E0305, "division by zero", expr.span, "this is zero")
                            .expected("a divisor other than 0", "0"),
                    );
                    sound = false;
                }
                // Divided in one step, so that 1 / 3 is the nearest double to a third.
                Formula::Constant(divisor) => match factors.pop() {
                    Some(Formula::Constant(value)) => factors.push(Formula::Constant(value / divisor)),
                    other => {
                        factors.extend(other);
                        factors.push(Formula::Constant(1.0 / divisor));
                    }
                },
                other => factors.push(Formula::Reciprocal(Box::new(other))),
            }
        }
        match sound {
            true => self.finite(product(factors), dimension, span, "the product is too large"),
            false => Value::Poison,
        }
    }
}
