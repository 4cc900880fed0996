//! What an expression means.

use super::dimension::Dimension;
use crate::model::Formula;
use crate::source::Spanned;

/// A value, or the mark of a mistake that has been reported.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// Already reported: whatever is computed from it says nothing more.
    Poison,
    Quantity(Quantity),
    Text(String),
    List(Vec<Spanned<Value>>),
    Tuple(Vec<Spanned<Value>>),
    Range(Box<RangeValue>),
}

/// A number with its dimension: a constant, or a formula over the layout's geometry.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Quantity {
    pub formula: Formula,
    pub dimension: Dimension,
}

/// `low .. high` or `low .. high step s`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RangeValue {
    pub low: Spanned<Value>,
    pub high: Spanned<Value>,
    pub step: Option<Spanned<Value>>,
}

impl Value {
    pub fn constant(value: f64, dimension: Dimension) -> Value {
        Value::Quantity(Quantity { formula: Formula::Constant(value), dimension })
    }

    /// It as messages show it, if it is one constant, a text, or several of them.
    pub fn text(&self) -> Option<String> {
        let all = |items: &[Spanned<Value>]| -> Option<String> {
            let shown: Option<Vec<String>> = items.iter().take(9).map(|item| item.value.text()).collect();
            let more = if items.len() > 9 { ", …" } else { "" };
            Some(shown?.join(", ") + more)
        };
        match self {
            Value::Poison => None,
            Value::Quantity(quantity) => Some(shown(quantity.as_constant()?, quantity.dimension)),
            Value::Text(text) => Some(format!("\"{text}\"")),
            Value::List(items) => Some(format!("[{}]", all(items)?)),
            Value::Tuple(items) => Some(format!("({})", all(items)?)),
            Value::Range(range) => {
                let ends = format!("{} .. {}", range.low.value.text()?, range.high.value.text()?);
                match &range.step {
                    Some(step) => Some(format!("{ends} step {}", step.value.text()?)),
                    None => Some(ends),
                }
            }
        }
    }

    /// What a message calls it.
    pub fn described(&self) -> String {
        match self {
            Value::Poison => "a mistake".into(),
            Value::Quantity(q) => q.dimension.with_article(),
            Value::Text(_) => "a text".into(),
            Value::List(_) => "a list".into(),
            Value::Tuple(_) => "a tuple".into(),
            Value::Range(_) => "a range".into(),
        }
    }
}

impl Quantity {
    pub fn as_constant(&self) -> Option<f64> {
        match self.formula {
            Formula::Constant(value) => Some(value),
            _ => None,
        }
    }
}

/// Sum with constants folded; flat.
pub(super) fn sum(terms: Vec<Formula>) -> Formula {
    let flat = |term| if let Formula::Sum(inner) = term { inner } else { vec![term] };
    fold(terms.into_iter().flat_map(flat).collect(), 0.0, |a, b| a + b, Formula::Sum)
}

/// Product with constants folded; flat.
pub(super) fn product(factors: Vec<Formula>) -> Formula {
    let flat = |factor| if let Formula::Product(inner) = factor { inner } else { vec![factor] };
    fold(factors.into_iter().flat_map(flat).collect(), 1.0, |a, b| a * b, Formula::Product)
}

/// Constants go together into one, which stands last; an identity is left out.
fn fold(
    parts: Vec<Formula>,
    identity: f64,
    with: fn(f64, f64) -> f64,
    variant: fn(Vec<Formula>) -> Formula,
) -> Formula {
    let mut constant = identity;
    let mut rest = Vec::new();
    for part in parts {
        match part {
            Formula::Constant(value) => constant = with(constant, value),
            other => rest.push(other),
        }
    }
    if rest.is_empty() {
        return Formula::Constant(constant);
    }
    if constant != identity {
        rest.push(Formula::Constant(constant));
    }
    match rest.pop() {
        Some(only) if rest.is_empty() => only,
        Some(last) => {
            rest.push(last);
            variant(rest)
        }
        None => Formula::Constant(constant),
    }
}

pub(super) fn negative(formula: Formula) -> Formula {
    match formula {
        Formula::Constant(value) => Formula::Constant(-value),
        Formula::Negative(inner) => *inner,
        other => Formula::Negative(Box::new(other)),
    }
}

/// A number as messages show it: six significant digits, no trailing zeros, no negative zero.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { format!("{value}") };
    }
    let magnitude = libm::floor(libm::log10(value.abs())) as i32;
    if !(-6..15).contains(&magnitude) {
        return format!("{value:.5e}");
    }
    let text = format!("{value:.*}", (5 - magnitude).max(0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

/// A quantity as messages show it, in the unit that its dimension is usually written in.
pub(super) fn shown(value: f64, dimension: Dimension) -> String {
    if dimension == Dimension::ANGLE {
        return format!("{} deg", number(value.to_degrees()));
    }
    if dimension == Dimension::TEMPERATURE {
        return format!("{} °C", number(value - 273.15));
    }
    if dimension == Dimension::TIME {
        return time(value);
    }
    match dimension.unit() {
        Some(unit) => format!("{} {unit}", number(value)),
        None if dimension == Dimension::NONE => number(value),
        None => format!("{} {}", number(value), dimension.spelled()),
    }
}

/// In hours or minutes where that is a number of at most two decimals, as a person would write it.
fn time(seconds: f64) -> String {
    let in_unit = |length: f64| {
        let value = seconds / length;
        (value.abs() >= 1.0 && (value * 100.0 - (value * 100.0).round()).abs() < 1e-9).then_some(value)
    };
    match (in_unit(3600.0), in_unit(60.0)) {
        (Some(hours), _) => format!("{} h", number(hours)),
        (None, Some(minutes)) => format!("{} min", number(minutes)),
        _ => format!("{} s", number(seconds)),
    }
}

pub(super) fn metres(value: f64) -> String {
    shown(value, Dimension::LENGTH)
}

pub(super) fn degrees(value: f64) -> String {
    shown(value, Dimension::ANGLE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_in_the_unit_that_is_short() {
        let told = |seconds: f64| shown(seconds, Dimension::TIME);
        let times = [0.0, 54.0, 120.0, 90.0, 9000.0 * 3600.0, 31_622_400.0, 3601.0, -7200.0];
        assert_eq!(times.map(told), ["0 s", "54 s", "2 min", "1.5 min", "9000 h", "8784 h", "3601 s", "-2 h"]);
    }

    #[test]
    fn numbers_are_short_and_plain() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (12.0, "12"),
            (1.25, "1.25"),
            (0.1 + 0.2, "0.3"),
            (1234567.0, "1234567"),
            (-0.0005, "-0.0005"),
            (1e30, "1.00000e30"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(shown(std::f64::consts::FRAC_PI_2, Dimension::ANGLE), "90 deg");
    }
}
