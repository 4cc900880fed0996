//! A mixed-integer linear problem and the free MPS file of it.

use crate::base::number::shortest;
use std::collections::BTreeMap;
use std::fmt::Write;

const ROUNDING: f64 = 1e-12;

/// A variable.
#[derive(Clone, Debug)]
pub struct Column {
    pub name: String,
    pub low: f64,
    pub high: f64,
    pub integer: bool,
}

/// `low <= Σ k·column <= high`.
#[derive(Clone, Debug)]
pub struct LinearRow {
    pub name: String,
    pub terms: Sum,
    pub low: f64,
    pub high: f64,
}

/// Σ k·column, by the column's index.
pub type Sum = BTreeMap<usize, f64>;

/// Minimise `objective` within rows and bounds.
#[derive(Clone, Debug, Default)]
pub struct Milp {
    pub name: String,
    /// Lines for people at the head of the file.
    pub notes: Vec<String>,
    pub columns: Vec<Column>,
    pub rows: Vec<LinearRow>,
    pub objective: Sum,
}

impl Milp {
    pub fn column(&mut self, name: String, low: f64, high: f64, integer: bool) -> usize {
        self.columns.push(Column { name, low, high, integer });
        self.columns.len() - 1
    }

    /// Coefficients that are rounding, such as the cosine of a right angle, are left out.
    pub fn row(&mut self, name: String, mut terms: Sum, low: f64, high: f64) {
        terms.retain(|_, coefficient| coefficient.abs() > ROUNDING);
        self.rows.push(LinearRow { name, terms, low, high });
    }

    /// Free MPS: names without spaces, fields apart by spaces.
    pub fn mps(&self) -> String {
        let mut out = String::new();
        for note in &self.notes {
            let _ = writeln!(out, "* {note}");
        }
        let _ = write!(out, "NAME {}\nROWS\n N length\n", self.name);
        for row in &self.rows {
            let _ = writeln!(out, " {} {}", row.kind(), row.name);
        }
        self.write_columns(&mut out);
        out += "RHS\n";
        for row in &self.rows {
            let right = if row.kind() == 'L' { row.high } else { row.low };
            if right != 0.0 {
                let _ = writeln!(out, " RHS {} {}", row.name, shortest(right));
            }
        }
        out += "RANGES\n";
        for row in self.rows.iter().filter(|r| r.low < r.high && r.low.is_finite() && r.high.is_finite()) {
            let _ = writeln!(out, " RANGE {} {}", row.name, shortest(row.high - row.low));
        }
        out += "BOUNDS\n";
        self.columns.iter().for_each(|column| column.write_bounds(&mut out));
        out + "ENDATA\n"
    }

    fn write_columns(&self, out: &mut String) {
        let mut entries: Vec<Vec<(&str, f64)>> = vec![Vec::new(); self.columns.len()];
        self.objective.iter().for_each(|(&k, &c)| entries[k].push(("length", c)));
        for row in &self.rows {
            row.terms.iter().for_each(|(&k, &c)| entries[k].push((&row.name, c)));
        }
        *out += "COLUMNS\n";
        let mut integer = false;
        for (column, entries) in self.columns.iter().zip(entries) {
            if column.integer != integer {
                integer = column.integer;
                let _ = writeln!(out, " MARKER 'MARKER' {}", if integer { "'INTORG'" } else { "'INTEND'" });
            }
            // A column without entries is known by an empty one in the objective.
            let entries = if entries.is_empty() { vec![("length", 0.0)] } else { entries };
            for (row, coefficient) in entries {
                let _ = writeln!(out, " {} {row} {}", column.name, shortest(coefficient));
            }
        }
        if integer {
            *out += " MARKER 'MARKER' 'INTEND'\n";
        }
    }
}

impl LinearRow {
    fn kind(&self) -> char {
        match (self.low.is_finite(), self.high.is_finite()) {
            _ if self.low == self.high => 'E',
            (true, _) => 'G',
            (false, true) => 'L',
            (false, false) => 'N',
        }
    }
}

impl Column {
    fn write_bounds(&self, out: &mut String) {
        let name = &self.name;
        *out += &match (self.low.is_finite(), self.high.is_finite()) {
            _ if self.low == self.high => format!(" FX BOUND {name} {}\n", shortest(self.low)),
            (false, false) => format!(" FR BOUND {name}\n"),
            (false, true) => format!(" MI BOUND {name}\n UP BOUND {name} {}\n", shortest(self.high)),
            // An integer without an upper bound is a binary to some readers, so both bounds are said.
            (true, true) => {
                format!(" LO BOUND {name} {}\n UP BOUND {name} {}\n", shortest(self.low), shortest(self.high))
            }
            (true, false) if self.low != 0.0 => format!(" LO BOUND {name} {}\n", shortest(self.low)),
            (true, false) => String::new(),
        };
    }
}
