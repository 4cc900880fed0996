//! A field's value against its row of the table: kind, dimension and bounds.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::dimension::{Dimension, parse_unit};
use super::fields::{Bounds, FieldSpec, Shape, fields};
use super::program::Space;
use super::scope::{Context, Env, Scope};
use super::value::{Value, number, shown};
use crate::diagnostic::{Code, Diagnostic};
use crate::model::Interval;
use crate::semantics::component::{Component, FieldValue};
use crate::source::{Span, Spanned};
use crate::syntax::tree::{DeclarationKind, Expr, ExprKind, Item, Name};

impl<'t> Context<'t> {
    /// The value, if it is what the field holds; otherwise reported.
    pub fn field(&self, env: &Rc<Env<'t>>, spec: &FieldSpec, expr: &'t Expr) -> Option<FieldValue> {
        let scope = Scope { env, geometry: None };
        if let Shape::Reference(kind) = spec.shape {
            return self.reference_field(env, kind, expr).map(FieldValue::Component);
        }
        if let Shape::Word(words) = spec.shape {
            return self.word_field(spec, words, expr).map(|word| FieldValue::Text(word.to_owned()));
        }
        let value = self.evaluate(scope, expr);
        if value == Value::Poison {
            return None;
        }
        let wrong = |wanted: String| {
            self.report(
                Diagnostic::new(Code::E0304, format!("`{}` must be {wanted}", spec.path), expr.span, value.described())
                    .expected(wanted, value.described())
                    .help(spec.doc.to_string()),
            );
            None
        };
        let number =
            |value: &Spanned<Value>, unit: &str, bounds| self.bounded(&value.value, value.span, spec, unit, bounds);
        match (spec.shape, &value) {
            (Shape::Number(unit, bounds), _) => {
                self.bounded(&value, expr.span, spec, unit, bounds).map(FieldValue::Number)
            }
            (Shape::Stiffness, _) => Some(FieldValue::Stiffness(value)),
            (Shape::Text, Value::Text(text)) => Some(FieldValue::Text(text.clone())),
            (Shape::Text, _) => wrong("a text in quotes".into()),
            (Shape::Tuple(unit, bounds, count), Value::Tuple(items)) if items.len() == count => {
                items.iter().map(|v| number(v, unit, bounds)).collect::<Option<Vec<f64>>>().map(FieldValue::Numbers)
            }
            (Shape::Tuple(unit, _, count), _) => {
                wrong(format!("a tuple of {count}: `({})`", vec![format!("... {unit}"); count].join(", ")))
            }
            (Shape::Interval(unit, bounds), Value::Range(range)) if range.step.is_none() => {
                let (low, high) = (number(&range.low, unit, bounds), number(&range.high, unit, bounds));
                let (low, high) = (low?, high?);
                self.ordered(low, high, expr.span, dimension(unit))?;
                Some(FieldValue::Interval(Interval { low, high }))
            }
            (Shape::Interval(..), _) => wrong("a range: `low .. high`".into()),
            (Shape::Numbers(unit, bounds), Value::List(items)) => {
                let values: Option<Vec<f64>> = items.iter().map(|v| number(v, unit, bounds)).collect();
                values.map(|v| FieldValue::Numbers(ascending(v)))
            }
            (Shape::Numbers(unit, bounds), Value::Range(range)) => {
                let Some(step) = &range.step else { return wrong("a list, or a range with a step".into()) };
                let (low, high) = (number(&range.low, unit, bounds), number(&range.high, unit, bounds));
                let step_value = self.expect_constant(&step.value, step.span, dimension(unit), "the step");
                let (low, high, step_value) = (low?, high?, step_value?);
                self.ordered(low, high, expr.span, dimension(unit))?;
                self.steps(low, high, step_value, step.span, dimension(unit)).map(FieldValue::Numbers)
            }
            (Shape::Numbers(..), _) => wrong("a list, or a range with a step".into()),
            (Shape::Reference(_) | Shape::Word(_), _) => None,
        }
    }

    /// `side = outer`
    fn word_field(&self, spec: &FieldSpec, words: &[&'static str], expr: &Expr) -> Option<&'static str> {
        let written = if let ExprKind::Name(text) = &expr.kind { Some(text) } else { None };
        let found = written.and_then(|text| words.iter().find(|word| *word == text));
        if found.is_none() {
            let listed = words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ");
            let shown = written.map_or_else(|| "something else".to_owned(), |text| format!("`{text}`"));
            let message = format!("`{}` must be one of {listed}", spec.path);
            let diagnostic = Diagnostic::new(Code::E0304, message, expr.span, shown.clone()).expected(listed, shown);
            self.report(match written {
                Some(text) => {
                    self.with_nearest(diagnostic, &Name { text: text.clone(), span: expr.span }, words.iter().copied())
                }
                None => diagnostic,
            });
        }
        found.copied()
    }

    /// `steering = NAME` or `steering = NAME(radius: 50 mm)`.
    fn reference_field(&self, env: &Rc<Env<'t>>, kind: DeclarationKind, expr: &'t Expr) -> Option<Rc<Component>> {
        let (name, args) = match &expr.kind {
            ExprKind::Name(text) => (Name { text: text.clone(), span: expr.span }, None),
            ExprKind::Call { name, args } => (name.clone(), Some(args)),
            _ => {
                let wanted = Space::Component(kind).with_article();
                self.report(
                    Diagnostic::new(Code::E0304, format!("this must name {wanted}"), expr.span, "not a name")
                        .expected(format!("the name of {wanted}"), "something else"),
                );
                return None;
            }
        };
        let symbol = self.resolve(env.module, Space::Component(kind), &name)?;
        let Item::Declaration(declaration) = self.program.item(symbol) else { return None };
        let args = match args {
            Some(args) => self.arguments(env, &name, args),
            None => BTreeMap::new(),
        };
        let made = self.instantiate(symbol, declaration, args, name.span)?;
        made.complete.then_some(made)
    }

    /// A constant within its bounds.
    fn bounded(&self, value: &Value, span: Span, spec: &FieldSpec, unit: &str, bounds: Bounds) -> Option<f64> {
        let name = spec.path.rsplit('.').next().unwrap_or(spec.path);
        let value = self.expect_constant(value, span, dimension(unit), &format!("`{name}`"))?;
        self.within(value, span, &format!("`{name}`"), dimension(unit), bounds)
    }

    /// The value, if it lies within bounds; otherwise reported.
    pub fn within(&self, value: f64, span: Span, what: &str, dimension: Dimension, bounds: Bounds) -> Option<f64> {
        if bounds.contains(value) {
            return Some(value);
        }
        let expected = if value <= bounds.low {
            format!("{} {}", if bounds.open { "more than" } else { "at least" }, shown(bounds.low, dimension))
        } else {
            format!("at most {}", shown(bounds.high, dimension))
        };
        let found = shown(value, dimension);
        self.report(
            Diagnostic::new(Code::E0306, format!("{what} is out of range"), span, found.clone())
                .expected(expected, found),
        );
        None
    }

    /// Reports a range whose ends are the wrong way round.
    pub fn ordered(&self, low: f64, high: f64, span: Span, dimension: Dimension) -> Option<()> {
        if low <= high {
            return Some(());
        }
        let mut diagnostic =
            Diagnostic::new(Code::E0311, "the range is upside down", span, "its low end is above its high end")
                .expected("`low .. high`", format!("{} .. {}", shown(low, dimension), shown(high, dimension)));
        if let Some((a, b)) = self.sources.text(span).split_once("..")
            && !b.contains("step")
        {
            diagnostic = diagnostic.fix(span, format!("{} .. {}", b.trim(), a.trim()));
        }
        self.report(diagnostic);
        None
    }

    /// `low .. high step s` as a list.
    fn steps(&self, low: f64, high: f64, step: f64, span: Span, dimension: Dimension) -> Option<Vec<f64>> {
        let count = (high - low) / step;
        if !(step > 0.0 && count <= 10_000.0) {
            self.report(
                Diagnostic::new(Code::E0306, "the step is out of range", span, shown(step, dimension))
                    .expected("a positive step that makes at most 10000 values", shown(step, dimension)),
            );
            return None;
        }
        // Rounded to the nanometre: 0.5 + 3 * 0.05 must be the 0.65 that a user writes.
        let value = |i: usize| ((low + i as f64 * step) * 1e9).round() / 1e9;
        let count = (count + 1e-9).floor() as usize;
        Some(
            (0..=count)
                .map(|i| {
                    if i == 0 {
                        low
                    } else if (low + i as f64 * step - high).abs() < 1e-9 {
                        high
                    } else {
                        value(i)
                    }
                })
                .collect(),
        )
    }

    /// Gives each stiffness its dimension, N/m to the power of the exponent beside it.
    pub fn check_stiffness(&self, kind: DeclarationKind, component: &Component, within: Span) -> bool {
        let mut sound = true;
        for spec in fields(kind).iter().filter(|f| f.shape == Shape::Stiffness) {
            let Some((value, span)) = component.stiffness(spec.path) else { continue };
            let exponent_path = spec.path.replace("stiffness", "exponent");
            let Some(exponent) = component.number(&exponent_path) else { continue };
            if (exponent * 2.0).fract() != 0.0 {
                let place = component.place(&exponent_path);
                self.report(
                    Diagnostic::new(Code::E0306, "`exponent` is not a multiple of 0.5", place, number(exponent))
                        .expected("1, 1.5 or 2", number(exponent)),
                );
                sound = false;
                continue;
            }
            let Some(per_length) = Dimension::LENGTH.power((exponent * 2.0) as i8) else { continue };
            let Some(dimension) = Dimension::FORCE.over(per_length) else { continue };
            let what = format!("`stiffness` with an exponent of {}", number(exponent));
            let inherited = span.file != within.file || span.start < within.start || span.end > within.end;
            let checked = match value {
                Value::Quantity(q) if inherited && q.dimension != dimension => {
                    let diagnostic = self.wrong_dimension(q, component.place(&exponent_path), dimension, &what);
                    self.report(diagnostic.related(span, "the stiffness").help("write `stiffness` beside `exponent`"));
                    None
                }
                _ => self
                    .expect_constant(value, span, dimension, &what)
                    .and_then(|k| self.within(k, span, "`stiffness`", dimension, Bounds::above(0.0, 1e15))),
            };
            sound &= checked.is_some();
        }
        sound
    }
}

fn dimension(unit: &str) -> Dimension {
    parse_unit(unit).map_or(Dimension::NONE, |u| u.dimension)
}

fn ascending(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
