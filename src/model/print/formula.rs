//! Formulas as text. The model's constants are bare SI numbers: their units follow from what stands around them.

use super::{Formula, Layout, Unit, degrees, metres, number, section_text, target_text, unit};

/// Exponents of length and angle, in halves.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Dimension {
    pub length: i32,
    pub angle: i32,
}

pub(super) const NONE: Dimension = Dimension { length: 0, angle: 0 };
pub(super) const LENGTH: Dimension = Dimension { length: 2, angle: 0 };
pub(super) const ANGLE: Dimension = Dimension { length: 0, angle: 2 };

impl Dimension {
    /// Of a formula that is shown in a unit.
    pub fn of(unit: Unit, formula: &Formula) -> Self {
        match unit {
            Unit::Metre => LENGTH,
            Unit::Radian => ANGLE,
            Unit::SquareMetre => Dimension { length: 4, angle: 0 },
            Unit::One => NONE,
            Unit::Other => dimension(formula).unwrap_or(NONE),
        }
    }

    fn plus(self, other: Dimension) -> Self {
        Dimension { length: self.length + other.length, angle: self.angle + other.angle }
    }

    fn times(self, factor: i32) -> Self {
        Dimension { length: self.length * factor, angle: self.angle * factor }
    }
}

/// The dimension of a formula, as far as its geometry tells; constants in products count as plain numbers.
pub(super) fn dimension(formula: &Formula) -> Option<Dimension> {
    match formula {
        Formula::Constant(_) => None,
        Formula::Heading(_) | Formula::Angle(_) => Some(ANGLE),
        Formula::Sum(items) | Formula::Smallest(items) | Formula::Largest(items) => items.iter().find_map(dimension),
        Formula::Product(factors) => Some(factors.iter().filter_map(dimension).fold(NONE, Dimension::plus)),
        Formula::Negative(of) | Formula::Absolute(of) => dimension(of),
        Formula::Reciprocal(of) => dimension(of).map(|d| d.times(-1)),
        Formula::SquareRoot(of) => dimension(of).map(|d| Dimension { length: d.length / 2, angle: d.angle / 2 }),
        _ => Some(LENGTH),
    }
}

/// A constant with its unit.
pub(super) fn constant(value: f64, dimension: Dimension) -> String {
    let power = |symbol: &str, halves: i32| match halves {
        0 => None,
        2 => Some(symbol.to_string()),
        halves => Some(format!("{symbol}^{}", f64::from(halves) / 2.0)),
    };
    match dimension {
        NONE => number(value),
        LENGTH => metres(value),
        ANGLE => degrees(value),
        Dimension { length, angle } => {
            let parts: Vec<String> = [power("m", length), power("rad", angle)].into_iter().flatten().collect();
            unit(value, &parts.join("*"))
        }
    }
}

/// A formula of a known dimension in the language.
pub(super) fn text(formula: &Formula, wanted: Dimension, layout: &Layout, names: &[&str]) -> String {
    let alike = |f: &Formula| text(f, wanted, layout, names);
    let all = |items: &[Formula]| items.iter().map(alike).collect::<Vec<_>>().join(", ");
    match formula {
        Formula::Constant(value) => constant(*value, wanted),
        Formula::X(i) => format!("x({})", names[*i]),
        Formula::Y(i) => format!("y({})", names[*i]),
        Formula::Radius(i) => format!("radius({})", names[*i]),
        Formula::Length(target) => format!("length({})", target_text(*target, names)),
        Formula::Heading(i) => format!("heading({})", section_text(*i, names)),
        Formula::Angle(i) => format!("angle({})", names[*i]),
        Formula::DistanceVertices(a, b) => format!("distance({}, {})", names[*a], names[*b]),
        Formula::DistanceObstacle(i, o) => format!("distance({}, {})", names[*i], layout.obstacles[*o].name),
        Formula::DistanceBuilding(i) => format!("distance({}, building)", names[*i]),
        Formula::Sum(terms) => terms.iter().enumerate().fold(String::new(), |text, (i, term)| match (i, term) {
            (0, term) => alike(term),
            (_, Formula::Negative(term)) => match **term {
                Formula::Sum(_) => format!("{text} - ({})", alike(term)),
                _ => format!("{text} - {}", alike(term)),
            },
            (_, Formula::Constant(value)) if *value < 0.0 => format!("{text} - {}", constant(-value, wanted)),
            (_, term) => format!("{text} + {}", alike(term)),
        }),
        Formula::Product(factors) => {
            // What the geometry does not account for is the constant's.
            let rest = factors.iter().filter_map(dimension).fold(NONE, Dimension::plus);
            let own = wanted.plus(rest.times(-1));
            factors.iter().enumerate().fold(String::new(), |text, (i, factor)| match (i, factor) {
                (_, Formula::Constant(value)) => format!("{text} * {}", constant(*value, own)),
                (0, Formula::Reciprocal(of)) => format!("1 / {}", operand(of, layout, names)),
                (0, factor) => operand(factor, layout, names),
                (_, Formula::Reciprocal(of)) => format!("{text} / {}", operand(of, layout, names)),
                (_, factor) => format!("{text} * {}", operand(factor, layout, names)),
            })
        }
        Formula::Negative(of) => match **of {
            Formula::Sum(_) => format!("-({})", alike(of)),
            _ => format!("-{}", alike(of)),
        },
        Formula::Reciprocal(of) => format!("1 / {}", operand(of, layout, names)),
        Formula::Absolute(of) => format!("abs({})", alike(of)),
        Formula::SquareRoot(of) => format!("sqrt({})", text(of, wanted.times(2), layout, names)),
        Formula::Smallest(items) => format!("min({})", all(items)),
        Formula::Largest(items) => format!("max({})", all(items)),
    }
}

/// A factor or divisor, in parentheses where it would otherwise come apart.
fn operand(formula: &Formula, layout: &Layout, names: &[&str]) -> String {
    let text = text(formula, dimension(formula).unwrap_or(NONE), layout, names);
    match formula {
        Formula::Sum(_) | Formula::Product(_) | Formula::Negative(_) => format!("({text})"),
        _ => text,
    }
}
