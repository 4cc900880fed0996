//! Names, numbers and units as the page writes them.

use crate::base::number::{fixed, trimmed};
use crate::base::trig;
use crate::gap::{Amount, Axis};
pub use crate::gap::{percent, probability};

/// `joint_clearance` as `joint clearance`.
pub fn plain(name: &str) -> String {
    name.replace('_', " ")
}

/// With a capital.
pub fn heading(name: &str) -> String {
    let text = plain(name);
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A metre, second or compliance in the multiple that needs no zeros: factor and unit.
fn multiple(unit: &str, size: f64) -> (f64, String) {
    const PREFIXES: [(f64, &str); 3] = [(1e3, "m"), (1e6, "µ"), (1e9, "n")];
    if !(["m", "s", "m/N", "rad"].contains(&unit) && size > 0.0 && size < 0.1) {
        return (1.0, unit.to_owned());
    }
    let fits = PREFIXES.into_iter().find(|(factor, _)| size * factor >= 0.1).unwrap_or((1e9, "n"));
    (fits.0, format!("{}{unit}", fits.1))
}

/// Value, and its interval, in a common multiple of the unit, with as many decimals as the interval's width earns.
pub fn amount(amount: &Amount) -> (String, String) {
    let size = amount.value.abs().max(amount.high.abs()).max(amount.low.abs());
    let (factor, unit) = multiple(&amount.unit, size);
    let width = (amount.high - amount.low).abs() * factor;
    let needed = if width > 0.0 && width.is_finite() { width } else { 0.1 * size * factor };
    let decimals = if needed > 0.0 { (1.0 - trig::log10(needed).floor()).clamp(0.0, 6.0) as usize } else { 2 };
    let number = |x: f64| if x.is_finite() { fixed(x * factor, decimals) } else { "unknown".to_owned() };
    let space = if unit.is_empty() { "" } else { " " };
    let value = format!("{}{space}{unit}", number(amount.value));
    (value, format!("{} … {}{space}{unit}", number(amount.low), number(amount.high)))
}

/// What each run has of a strength, where they differ: `1.04 N/s in run-02`.
pub fn by_run(strength: &Amount) -> Vec<String> {
    let of = |(run, x): (&String, &f64)| {
        let own = Amount { value: *x, ..strength.clone() };
        format!("{} in {run}", amount(&own).0)
    };
    strength.by_run.iter().map(of).collect()
}

/// A stretch of the axis: `12.5 … 15 m`.
pub fn stretch(from: f64, to: f64, axis: Axis) -> String {
    format!("{} … {} {}", trimmed(from, 1), trimmed(to, 1), axis.unit())
}

/// What a band tells of, as a column's head and in words.
pub fn band(name: &str, axis: Axis) -> &'static str {
    match name {
        "track" if axis == Axis::Time => "",
        "track" => "means that belong to a place",
        "fluctuation" => "how much a channel fluctuates at a place",
        "distribution" => "how often it is low or high",
        "cart" => "power around the passing of carts",
        "wheel" => "power at orders of the wheels",
        "motor" => "power at orders of the motors",
        "drift" => "slow changes in time",
        _ => "",
    }
}

/// The scale of a kind of deviation of a channel with a unit: powers and fluctuations are logarithms.
pub fn scale_of(band: &str, unit: &str) -> String {
    match band {
        "distribution" => "share of the time".to_owned(),
        "fluctuation" | "cart" | "wheel" | "motor" if !unit.is_empty() => format!("ln({unit})"),
        "fluctuation" | "cart" | "wheel" | "motor" => "logarithm".to_owned(),
        _ => unit.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: f64, low: f64, high: f64, unit: &str) -> String {
        let by_run = std::collections::BTreeMap::new();
        let (value, interval) = amount(&Amount { value, low, high, unit: unit.to_owned(), at_bound: None, by_run });
        format!("{value} ({interval})")
    }

    #[test]
    fn strengths_are_written_in_the_multiple_of_their_unit() {
        assert_eq!(of(0.000_812_3, 0.000_75, 0.000_88, "m"), "0.81 mm (0.75 … 0.88 mm)");
        assert_eq!(of(1.3e-7, 1.1e-7, 1.6e-7, "m/N"), "0.130 µm/N (0.110 … 0.160 µm/N)");
        assert_eq!(of(0.18, 0.16, 0.2, ""), "0.180 (0.160 … 0.200)");
        assert_eq!(of(123.4, 101.0, 140.2, "N"), "123 N (101 … 140 N)");
        assert_eq!(of(0.05, 0.05, 0.05, "s"), "50.0 ms (50.0 … 50.0 ms)");
        assert_eq!(of(0.0, 0.0, 0.0, "m"), "0.00 m (0.00 … 0.00 m)");
        assert_eq!(of(1.0, f64::NEG_INFINITY, f64::NAN, "N"), "1 N (unknown … unknown N)");
    }

    #[test]
    fn a_heading_is_in_words() {
        assert_eq!(heading("joint_clearance"), "Joint clearance");
    }
}
