//! Dimensions and units. Quantities are SI inside; a unit is a factor and a dimension.

use crate::base::number::tidy;
use std::fmt;

/// Exponents over length, mass, time, angle, currency and temperature, in steps of one half: a Hertzian contact has
/// a stiffness in N/m^1.5.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Dimension {
    halves: [i8; 6],
}

const SYMBOLS: [&str; 6] = ["m", "kg", "s", "rad", "EUR", "K"];

impl Dimension {
    pub const NONE: Dimension = Dimension { halves: [0; 6] };
    pub const LENGTH: Dimension = Dimension { halves: [2, 0, 0, 0, 0, 0] };
    pub const AREA: Dimension = Dimension { halves: [4, 0, 0, 0, 0, 0] };
    pub const MASS: Dimension = Dimension { halves: [0, 2, 0, 0, 0, 0] };
    pub const TIME: Dimension = Dimension { halves: [0, 0, 2, 0, 0, 0] };
    pub const ANGLE: Dimension = Dimension { halves: [0, 0, 0, 2, 0, 0] };
    pub const CURRENCY: Dimension = Dimension { halves: [0, 0, 0, 0, 2, 0] };
    pub const TEMPERATURE: Dimension = Dimension { halves: [0, 0, 0, 0, 0, 2] };
    pub const SPEED: Dimension = Dimension { halves: [2, 0, -2, 0, 0, 0] };
    pub const FORCE: Dimension = Dimension { halves: [2, 2, -4, 0, 0, 0] };
    pub const ENERGY: Dimension = Dimension { halves: [4, 2, -4, 0, 0, 0] };
    pub const POWER: Dimension = Dimension { halves: [4, 2, -6, 0, 0, 0] };
    pub const ENERGY_PRICE: Dimension = Dimension { halves: [-4, -2, 4, 0, 2, 0] };

    /// The product's dimension; `None` beyond exponents that mean anything.
    pub fn times(self, other: Dimension) -> Option<Dimension> {
        self.combine(other, i8::checked_add)
    }

    /// The quotient's dimension.
    pub fn over(self, other: Dimension) -> Option<Dimension> {
        self.combine(other, i8::checked_sub)
    }

    fn combine(self, other: Dimension, with: fn(i8, i8) -> Option<i8>) -> Option<Dimension> {
        let mut halves = [0; 6];
        for (i, half) in halves.iter_mut().enumerate() {
            *half = with(self.halves[i], other.halves[i])?;
        }
        Some(Dimension { halves })
    }

    /// The square root's dimension; `None` when it would need quarters.
    pub fn square_root(self) -> Option<Dimension> {
        self.halves.iter().all(|h| h % 2 == 0).then(|| Dimension { halves: self.halves.map(|h| h / 2) })
    }

    /// The dimension to a power given in halves (3 for ^1.5); `None` when it would need quarters.
    pub fn power(self, halves: i8) -> Option<Dimension> {
        let mut out = [0; 6];
        for (i, half) in out.iter_mut().enumerate() {
            let product = self.halves[i].checked_mul(halves)?;
            if product % 2 != 0 {
                return None;
            }
            *half = product / 2;
        }
        Some(Dimension { halves: out })
    }

    /// The unit that messages and examples use for it.
    pub fn unit(self) -> Option<&'static str> {
        KNOWN.iter().find(|(_, _, d)| *d == self).map(|(_, unit, _)| *unit).filter(|u| !u.is_empty())
    }

    /// `a length`, `an angle`, `a number without unit`, `a quantity in kg^2*m`.
    pub fn with_article(self) -> String {
        if self == Dimension::NONE {
            return "a number without unit".to_string();
        }
        match KNOWN.iter().find(|(_, _, d)| *d == self) {
            Some((name @ ("angle" | "acceleration" | "area" | "energy"), ..)) => format!("an {name}"),
            Some((name, ..)) => format!("a {name}"),
            None => format!("a quantity in {}", self.spelled()),
        }
    }

    /// Base units with their exponents: `kg*m^2/s^2`.
    pub fn spelled(self) -> String {
        let side = |sign: i8| {
            let mut parts: Vec<String> = Vec::new();
            for (half, symbol) in self.halves.iter().zip(SYMBOLS) {
                match half * sign {
                    2 => parts.push(symbol.to_string()),
                    h if h > 0 => parts.push(format!("{symbol}^{}", f64::from(h) / 2.0)),
                    _ => {}
                }
            }
            parts
        };
        let (above, below) = (side(1), side(-1));
        let above = if above.is_empty() { "1".to_string() } else { above.join("*") };
        below.iter().fold(above, |text, part| text + "/" + part)
    }
}

impl fmt::Display for Dimension {
    /// `length (m)`, `ratio`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match KNOWN.iter().find(|(_, _, d)| d == self) {
            Some((name, "", _)) => f.write_str(name),
            Some((name, unit, _)) => write!(f, "{name} ({unit})"),
            None => f.write_str(&self.spelled()),
        }
    }
}

/// Dimensions with a name of their own, and the unit to write them in.
const KNOWN: &[(&str, &str, Dimension)] = &[
    ("ratio", "", Dimension::NONE),
    ("length", "m", Dimension::LENGTH),
    ("area", "m^2", Dimension::AREA),
    ("mass", "kg", Dimension::MASS),
    ("time", "s", Dimension::TIME),
    ("angle", "deg", Dimension::ANGLE),
    ("price", "EUR", Dimension::CURRENCY),
    ("temperature", "°C", Dimension::TEMPERATURE),
    ("speed", "m/s", Dimension::SPEED),
    ("force", "N", Dimension::FORCE),
    ("acceleration", "m/s^2", Dimension { halves: [2, 0, -4, 0, 0, 0] }),
    ("frequency", "Hz", Dimension { halves: [0, 0, -2, 0, 0, 0] }),
    ("stiffness", "N/m", Dimension { halves: [0, 2, -4, 0, 0, 0] }),
    ("contact stiffness", "N/m^1.5", Dimension { halves: [-1, 2, -4, 0, 0, 0] }),
    ("contact stiffness", "N/m^2", Dimension { halves: [-2, 2, -4, 0, 0, 0] }),
    ("damping", "N*s/m", Dimension { halves: [0, 2, -2, 0, 0, 0] }),
    ("moment of inertia", "kg*m^2", Dimension { halves: [4, 2, 0, 0, 0, 0] }),
    ("energy", "J", Dimension::ENERGY),
    ("power", "W", Dimension::POWER),
    ("price of energy", "EUR/J", Dimension::ENERGY_PRICE),
    ("price per length", "EUR/m", Dimension { halves: [-2, 0, 0, 0, 2, 0] }),
    ("mass per length", "kg/m", Dimension { halves: [-2, 2, 0, 0, 0, 0] }),
];

/// What one of a unit is in SI: `value * factor + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    pub factor: f64,
    /// 273.15 for °C, otherwise 0.
    pub offset: f64,
    pub dimension: Dimension,
}

/// Symbols that units are composed of.
const UNITS: &[(&str, f64, Dimension)] = &[
    ("m", 1.0, Dimension::LENGTH),
    ("mm", 1e-3, Dimension::LENGTH),
    ("cm", 1e-2, Dimension::LENGTH),
    ("km", 1e3, Dimension::LENGTH),
    ("um", 1e-6, Dimension::LENGTH),
    ("µm", 1e-6, Dimension::LENGTH),
    ("deg", std::f64::consts::PI / 180.0, Dimension::ANGLE),
    ("°", std::f64::consts::PI / 180.0, Dimension::ANGLE),
    ("rad", 1.0, Dimension::ANGLE),
    ("mrad", 1e-3, Dimension::ANGLE),
    ("s", 1.0, Dimension::TIME),
    ("ms", 1e-3, Dimension::TIME),
    ("min", 60.0, Dimension::TIME),
    ("h", 3600.0, Dimension::TIME),
    ("kg", 1.0, Dimension::MASS),
    ("g", 1e-3, Dimension::MASS),
    ("t", 1e3, Dimension::MASS),
    ("N", 1.0, Dimension::FORCE),
    ("kN", 1e3, Dimension::FORCE),
    ("J", 1.0, Dimension::ENERGY),
    ("kWh", 3.6e6, Dimension::ENERGY),
    ("W", 1.0, Dimension::POWER),
    ("kW", 1e3, Dimension::POWER),
    ("EUR", 1.0, Dimension::CURRENCY),
    ("%", 1e-2, Dimension::NONE),
    ("Hz", 1.0, Dimension { halves: [0, 0, -2, 0, 0, 0] }),
    ("K", 1.0, Dimension::TEMPERATURE),
    ("°C", 1.0, Dimension::TEMPERATURE),
];

/// Every unit symbol, for suggestions.
pub fn symbols() -> impl Iterator<Item = &'static str> {
    UNITS.iter().map(|(symbol, ..)| *symbol)
}

/// Products and quotients of symbols that are usual: those that dimensions are written in, and what speeds are read off
/// in.
pub fn compounds() -> impl Iterator<Item = &'static str> {
    let usual = KNOWN.iter().map(|(_, unit, _)| *unit).filter(|unit| unit.contains(['/', '*', '^']));
    usual.chain(["mm/s", "km/h", "EUR/kWh"])
}

/// Other spellings that people use.
const ALIASES: &[(&str, &str)] = &[
    ("metre", "m"),
    ("metres", "m"),
    ("meter", "m"),
    ("meters", "m"),
    ("micron", "um"),
    ("microns", "um"),
    ("μm", "µm"), // The Greek letter for the micro sign.
    ("mps", "m/s"),
    ("kph", "km/h"),
    ("kmh", "km/h"),
    ("sec", "s"),
    ("hr", "h"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("euro", "EUR"),
    ("€", "EUR"),
    ("C", "°C"),
    ("percent", "%"),
];

/// The symbol that was probably meant by an unknown one.
pub fn meant(symbol: &str) -> Option<&'static str> {
    let same = symbols().find(|s| s.eq_ignore_ascii_case(symbol));
    same.or_else(|| ALIASES.iter().find(|(alias, _)| alias.eq_ignore_ascii_case(symbol)).map(|(_, unit)| *unit))
}

/// A number with a unit, in SI: `1.5 m/s`, `90deg`, `3`; `None` where it is none, or not finite.
pub fn quantity(text: &str) -> Option<(f64, Dimension)> {
    let text = text.trim();
    let is_number = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let mut end = text.find(|c: char| !is_number(c)).unwrap_or(text.len());
    // An exponent, where digits follow.
    let tail = &text[end..];
    if let Some(rest) = tail.strip_prefix(['e', 'E']) {
        let digits = rest.strip_prefix(['+', '-']).unwrap_or(rest);
        let count = digits.bytes().take_while(u8::is_ascii_digit).count();
        if count > 0 {
            end += 1 + (rest.len() - digits.len()) + count;
        }
    }
    let value: f64 = text[..end].parse().ok().filter(|x: &f64| x.is_finite())?;
    match text[end..].trim() {
        "" => Some((value, Dimension::NONE)),
        unit => parse_unit(unit).ok().map(|unit| (tidy(value * unit.factor + unit.offset), unit.dimension)),
    }
}

/// Why a unit cannot be understood.
#[derive(Clone, Debug, PartialEq)]
pub enum UnitError {
    /// No such symbol.
    Unknown(String),
    /// Exponents must be multiples of one half, and products must stay sensible.
    Exponent(String),
}

/// Reads `m/s^2`, `kg*m^2`, `N/m^1.5`.
pub fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    if text == "°C" {
        return Ok(Unit { factor: 1.0, offset: 273.15, dimension: Dimension::TEMPERATURE });
    }
    let mut unit = Unit { factor: 1.0, offset: 0.0, dimension: Dimension::NONE };
    let mut rest = text.trim();
    let mut divide = false;
    loop {
        let end = rest.find(['*', '/', '·']).unwrap_or(rest.len());
        let (factor, dimension) = parse_power(rest[..end].trim())?;
        let combined = if divide { unit.dimension.over(dimension) } else { unit.dimension.times(dimension) };
        unit.dimension = combined.ok_or_else(|| UnitError::Exponent(text.to_string()))?;
        unit.factor = if divide { unit.factor / factor } else { unit.factor * factor };
        let Some(operator) = rest[end..].chars().next() else { return Ok(unit) };
        divide = operator == '/';
        rest = &rest[end + operator.len_utf8()..];
    }
}

/// One symbol with its exponent: its factor in SI and its dimension.
fn parse_power(text: &str) -> Result<(f64, Dimension), UnitError> {
    let (symbol, exponent) = text.split_once('^').map_or((text, None), |(s, e)| (s.trim(), Some(e.trim())));
    let Some((_, factor, dimension)) = UNITS.iter().find(|(s, ..)| *s == symbol) else {
        return Err(UnitError::Unknown(symbol.to_string()));
    };
    let Some(exponent) = exponent else { return Ok((*factor, *dimension)) };
    let wrong = || UnitError::Exponent(text.to_string());
    let halves = exponent.parse::<f64>().map_err(|_| wrong())? * 2.0;
    if halves.fract() != 0.0 || !(1.0..=12.0).contains(&halves.abs()) {
        return Err(wrong());
    }
    let dimension = dimension.power(halves as i8).ok_or_else(wrong)?;
    Ok((libm::pow(*factor, halves / 2.0), dimension))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each unit with its value in SI, worked out by hand, and its dimension as spelled in base units.
    const CASES: &[(&str, f64, &str)] = &[
        ("mm", 0.001, "m"),
        ("cm", 0.01, "m"),
        ("km", 1000.0, "m"),
        ("um", 1e-6, "m"),
        ("µm", 1e-6, "m"),
        ("mrad", 0.001, "rad"),
        ("ms", 0.001, "s"),
        ("min", 60.0, "s"),
        ("h", 3600.0, "s"),
        ("g", 0.001, "kg"),
        ("t", 1000.0, "kg"),
        ("kN", 1000.0, "m*kg/s^2"),
        ("kWh", 3.6e6, "m^2*kg/s^2"),
        ("kW", 1000.0, "m^2*kg/s^3"),
        ("EUR/kWh", 1.0 / 3.6e6, "s^2*EUR/m^2/kg"),
        ("m/s", 1.0, "m/s"),
        ("mm/s", 0.001, "m/s"),
        ("km/h", 1000.0 / 3600.0, "m/s"),
        ("m/s^2", 1.0, "m/s^2"),
        ("N/m", 1.0, "kg/s^2"),
        ("N/mm", 1000.0, "kg/s^2"),
        ("N/m^1.5", 1.0, "kg/m^0.5/s^2"),
        ("N*s/m", 1.0, "kg/s"),
        ("kg*m^2", 1.0, "m^2*kg"),
        ("mm^2", 1e-6, "m^2"),
        ("EUR/m", 1.0, "EUR/m"),
        ("%", 0.01, "1"),
        ("Hz", 1.0, "1/s"),
        ("K", 1.0, "K"),
        ("deg/s", 0.017453292519943295, "rad/s"),
    ];

    #[test]
    fn units_have_their_values() {
        for (text, factor, spelled) in CASES {
            let unit = parse_unit(text).unwrap();
            assert!((unit.factor / factor - 1.0).abs() < 1e-15, "{text}: {}", unit.factor);
            assert_eq!(unit.dimension.spelled(), *spelled, "{text}");
        }
        assert_eq!(parse_unit("°C").unwrap().offset, 273.15);
    }

    #[test]
    fn preferred_units_parse_to_their_dimension() {
        for (name, unit, dimension) in KNOWN.iter().filter(|k| !k.1.is_empty()) {
            assert_eq!(parse_unit(unit).unwrap().dimension, *dimension, "{name}");
        }
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "metre", "m^", "m^0", "m^0.3", "m^99", "m//s", "N/m^1e400", "m^NaN"] {
            assert!(parse_unit(text).is_err(), "{text}");
        }
        let long = ["m^6"; 30].join("*");
        assert!(matches!(parse_unit(&long), Err(UnitError::Exponent(_))));
    }

    #[test]
    fn roots_and_powers() {
        assert_eq!(Dimension::AREA.square_root(), Some(Dimension::LENGTH));
        assert_eq!(Dimension::LENGTH.power(4), Some(Dimension::AREA));
        let root = Dimension::LENGTH.square_root().unwrap();
        assert_eq!(root.square_root(), None, "quarters do not exist");
    }
}
