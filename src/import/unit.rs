//! Units of length of drawings.

/// A drawing's unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    Millimetre,
    Centimetre,
    Decimetre,
    Metre,
    Kilometre,
    Micrometre,
    Inch,
    Foot,
    Yard,
    Mile,
    SurveyFoot,
}

const UNITS: [(Unit, &str, i64, f64); 11] = [
    (Unit::Millimetre, "mm", 4, 1e-3),
    (Unit::Centimetre, "cm", 5, 1e-2),
    (Unit::Decimetre, "dm", 14, 1e-1),
    (Unit::Metre, "m", 6, 1.0),
    (Unit::Kilometre, "km", 7, 1e3),
    (Unit::Micrometre, "um", 13, 1e-6),
    (Unit::Inch, "in", 1, 0.0254),
    (Unit::Foot, "ft", 2, 0.3048),
    (Unit::Yard, "yd", 10, 0.9144),
    (Unit::Mile, "mi", 3, 1609.344),
    (Unit::SurveyFoot, "us-ft", 21, 1200.0 / 3937.0),
];

impl Unit {
    /// By its symbol: `mm`, `m`, `in`.
    pub fn parse(text: &str) -> Result<Unit, String> {
        let found = UNITS.iter().find(|(_, symbol, ..)| symbol.eq_ignore_ascii_case(text.trim()));
        let symbols: Vec<&str> = UNITS.iter().map(|(_, symbol, ..)| *symbol).collect();
        found.map(|(unit, ..)| *unit).ok_or_else(|| format!("a drawing's unit is one of {}", symbols.join(", ")))
    }

    /// By its number in `$INSUNITS` (AutoCAD DXF Reference); `None` for a drawing without a unit and for units that no
    /// plan is drawn in.
    pub fn from_header(number: i64) -> Option<Unit> {
        UNITS.iter().find(|(_, _, code, _)| *code == number).map(|(unit, ..)| *unit)
    }

    fn row(self) -> (&'static str, f64) {
        UNITS.iter().find(|(unit, ..)| *unit == self).map_or(("m", 1.0), |(_, symbol, _, metres)| (*symbol, *metres))
    }

    pub fn symbol(self) -> &'static str {
        self.row().0
    }

    /// Its length, m.
    pub fn metres(self) -> f64 {
        self.row().1
    }
}
