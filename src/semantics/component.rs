//! A declaration with its arguments in.

use super::value::Value;
use crate::model::Interval;
use crate::source::Span;
use std::collections::BTreeMap;
use std::rc::Rc;

/// A declaration with its arguments in: every field that was written, checked.
#[derive(Clone, Debug)]
pub(super) struct Component {
    pub name: String,
    /// The declaration.
    pub span: Span,
    pub(super) fields: BTreeMap<&'static str, Filled>,
    /// Whether every required field is there and sound.
    pub complete: bool,
}

/// A field's value with its place; `None` is a mistake that has been reported.
#[derive(Clone, Debug)]
pub(super) struct Filled {
    pub(super) value: Option<FieldValue>,
    pub(super) span: Span,
}

#[derive(Clone, Debug)]
pub(super) enum FieldValue {
    Number(f64),
    Numbers(Vec<f64>),
    Interval(Interval),
    Text(String),
    Component(Rc<Component>),
    /// A stiffness: its dimension hangs on the exponent beside it, which `from` may change.
    Stiffness(Value),
}

impl Component {
    pub fn has(&self, path: &str) -> bool {
        self.fields.contains_key(path)
    }

    pub fn place(&self, path: &str) -> Span {
        self.fields.get(path).map_or(self.span, |f| f.span)
    }

    /// A stiffness as it was written, with its place.
    pub fn stiffness(&self, path: &str) -> Option<(&Value, Span)> {
        match self.fields.get(path)? {
            Filled { value: Some(FieldValue::Stiffness(value)), span } => Some((value, *span)),
            _ => None,
        }
    }

    fn value(&self, path: &str) -> Option<&FieldValue> {
        self.fields.get(path)?.value.as_ref()
    }

    pub fn number(&self, path: &str) -> Option<f64> {
        match self.value(path)? {
            FieldValue::Number(value) => Some(*value),
            FieldValue::Stiffness(Value::Quantity(quantity)) => quantity.as_constant(),
            _ => None,
        }
    }

    /// Also a tuple's numbers.
    pub fn numbers(&self, path: &str) -> Option<&[f64]> {
        if let FieldValue::Numbers(values) = self.value(path)? { Some(values) } else { None }
    }

    pub fn interval(&self, path: &str) -> Option<Interval> {
        if let FieldValue::Interval(value) = self.value(path)? { Some(*value) } else { None }
    }

    pub fn text(&self, path: &str) -> Option<&str> {
        if let FieldValue::Text(text) = self.value(path)? { Some(text) } else { None }
    }

    pub fn component(&self, path: &str) -> Option<&Rc<Component>> {
        if let FieldValue::Component(inner) = self.value(path)? { Some(inner) } else { None }
    }
}
