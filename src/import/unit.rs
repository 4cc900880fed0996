//! Units of length of drawings.

/// A drawing's unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
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

const UNITS: [(LengthUnit, &str, i64, f64); 11] = [
    (LengthUnit::Millimetre, "mm", 4, 1e-3),
    (LengthUnit::Centimetre, "cm", 5, 1e-2),
    (LengthUnit::Decimetre, "dm", 14, 1e-1),
    (LengthUnit::Metre, "m", 6, 1.0),
    (LengthUnit::Kilometre, "km", 7, 1e3),
    (LengthUnit::Micrometre, "um", 13, 1e-6),
    (LengthUnit::Inch, "in", 1, 0.0254),
    (LengthUnit::Foot, "ft", 2, 0.3048),
    (LengthUnit::Yard, "yd", 10, 0.9144),
    (LengthUnit::Mile, "mi", 3, 1609.344),
    (LengthUnit::SurveyFoot, "us-ft", 21, 1200.0 / 3937.0),
];

impl LengthUnit {
    /// By its symbol: `mm`, `m`, `in`.
    pub fn parse(text: &str) -> Result<LengthUnit, String> {
        let found = UNITS.iter().find(|(_, symbol, ..)| symbol.eq_ignore_ascii_case(text.trim()));
        let symbols: Vec<&str> = UNITS.iter().map(|(_, symbol, ..)| *symbol).collect();
        found.map(|(unit, ..)| *unit).ok_or_else(|| format!("a drawing's unit is one of {}", symbols.join(", ")))
    }

    /// By its number in `$INSUNITS` (AutoCAD DXF Reference); `None` for a drawing without a unit and for units that no
    /// plan is drawn in.
    pub fn from_header(number: i64) -> Option<LengthUnit> {
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
