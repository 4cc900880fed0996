//! The words that layouts are written in, with what messages say of them: fields, functions and units. They are read
//! from the tables that the checks go by.

use super::dimension::{self, Dimension, parse_unit};
use super::fields::{self, Bounds, Presence, Shape};
use super::value::shown;
use crate::syntax::tree::DeclarationKind;

pub use super::functions::{Function, all as functions};

/// A field of a declaration.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// With its groups: `curve.radii`.
    pub path: &'static str,
    /// In words: `a list or a range with a step, in m`.
    pub form: String,
    /// Unit that it is given in here, in SI; empty for a ratio, and where it has none.
    pub unit: &'static str,
    /// What values it may have: `more than 0 m`.
    pub bounds: Option<String>,
    /// Whether a declaration must have it.
    pub required: bool,
    /// The kind of declaration that it names.
    pub names: Option<DeclarationKind>,
    /// The words of which it is one; none where it is something else.
    pub words: &'static [&'static str],
    pub about: &'static str,
}

/// The fields of a kind of declaration.
pub fn fields(kind: DeclarationKind) -> impl Iterator<Item = Field> {
    fields::fields(kind).iter().map(|spec| {
        let (form, unit, bounds) = match spec.shape {
            Shape::Number(unit, bounds) => ("a number".to_owned(), unit, Some(bounds)),
            Shape::Numbers(unit, bounds) => ("a list, or a range with a step".to_owned(), unit, Some(bounds)),
            Shape::Interval(unit, bounds) => ("a range `low .. high`".to_owned(), unit, Some(bounds)),
            Shape::Tuple(unit, bounds, count) => (format!("a tuple of {count} numbers"), unit, Some(bounds)),
            Shape::Stiffness => ("a stiffness, in N/m to the power of the exponent".to_owned(), "", None),
            Shape::Word(words) => (format!("one of `{}`", words.join("`, `")), "", None),
            Shape::Text => ("a text in quotes".to_owned(), "", None),
            Shape::Reference(kind) => (format!("the name of a {}", kind.word()), "", None),
        };
        let unit_of = parse_unit(unit).ok();
        let dimension = unit_of.map_or(Dimension::NONE, |unit| unit.dimension);
        Field {
            path: spec.path,
            form: if unit.is_empty() { form } else { format!("{form}, in {}", dimension.unit().unwrap_or(unit)) },
            unit,
            bounds: bounds.map(|bounds| between(bounds, dimension)),
            required: spec.presence == Presence::Required,
            names: if let Shape::Reference(kind) = spec.shape { Some(kind) } else { None },
            words: if let Shape::Word(words) = spec.shape { words } else { &[] },
            about: spec.doc,
        }
    })
}

/// `more than 0 m, at most 1000 m`.
fn between(bounds: Bounds, dimension: Dimension) -> String {
    let low = format!("{} {}", if bounds.open { "more than" } else { "at least" }, shown(bounds.low, dimension));
    // A bound against numbers out of this world is none that a reader wants to know of.
    if bounds.high >= 1e12 { low } else { format!("{low}, at most {}", shown(bounds.high, dimension)) }
}

/// Units of one dimension, in the order of the table. Compounds such as `m/s` are among them where they are usual.
pub fn units_like(unit: &str) -> Vec<&'static str> {
    let Ok(wanted) = parse_unit(unit) else { return Vec::new() };
    units().filter(|symbol| parse_unit(symbol).is_ok_and(|unit| unit.dimension == wanted.dimension)).collect()
}

/// Every unit that is worth proposing: the symbols, and the usual compounds.
pub fn units() -> impl Iterator<Item = &'static str> {
    // Another spelling of a unit says nothing new.
    dimension::symbols().filter(|symbol| !matches!(*symbol, "µm" | "°")).chain(dimension::compounds())
}

/// What a unit measures: `length`, `speed`.
pub fn measures(unit: &str) -> Option<String> {
    let dimension = parse_unit(unit).ok()?.dimension;
    let named = dimension.with_article();
    Some(named.trim_start_matches("an ").trim_start_matches("a ").to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_say_what_they_hold() {
        let length = fields(DeclarationKind::Cart).find(|f| f.path == "length").unwrap();
        assert_eq!(length.form, "a number, in m");
        assert_eq!(length.bounds.as_deref(), Some("at least 0.05 m, at most 20 m"));
        let step = fields(DeclarationKind::Catalog).find(|f| f.path == "curve.angle_step").unwrap();
        assert_eq!(step.form, "a number, in deg");
        assert_eq!(
            fields(DeclarationKind::Cart).find(|f| f.path == "joint").unwrap().names,
            Some(DeclarationKind::Joint)
        );
    }

    #[test]
    fn units_of_a_dimension_are_found() {
        assert_eq!(units_like("m"), ["m", "mm", "cm", "km", "um"]);
        assert_eq!(units_like("m/s"), ["m/s", "mm/s", "km/h"]);
        assert_eq!(measures("m/s").as_deref(), Some("speed"));
        assert_eq!(measures("deg").as_deref(), Some("angle"));
        assert!(units_like("nonsense").is_empty());
    }
}
