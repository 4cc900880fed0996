//! The lines of a whole bill: the track's pieces, and what is ordered beside it.

use crate::compiled::Compiled;
use crate::compiled::order::{self, OrderLine};
use crate::elements::BillLine;

/// A line of the bill. Prices (EUR) and masses (kg) are of one and of all.
pub struct BillRow {
    pub group: &'static str,
    /// Empty where there is no article number.
    pub article: String,
    pub description: String,
    pub count: usize,
    pub unit_price: Option<f64>,
    pub price: Option<f64>,
    pub unit_mass: Option<f64>,
    pub mass: Option<f64>,
    pub note: &'static str,
}

impl BillRow {
    /// All lines of a layout.
    pub fn all(compiled: &Compiled) -> Vec<BillRow> {
        let beside = order::lines(compiled).into_iter().map(BillRow::beside);
        compiled.bill.lines.iter().map(BillRow::track).chain(beside).collect()
    }

    fn track(line: &BillLine) -> Self {
        BillRow {
            group: "track",
            article: line.article.clone(),
            description: line.description.clone(),
            count: line.count,
            unit_price: Some(line.unit_price),
            price: Some(line.price),
            unit_mass: Some(line.unit_mass),
            mass: Some(line.mass),
            note: if line.in_catalog { "" } else { "not in the catalogue: an estimate" },
        }
    }

    fn beside(line: OrderLine) -> Self {
        BillRow {
            group: line.group.name(),
            count: line.count,
            unit_price: line.unit_price,
            price: line.price(),
            unit_mass: line.unit_mass,
            mass: line.mass(),
            note: if line.unit_price.is_none() { "no price in the layout" } else { "" },
            article: line.article.unwrap_or_default(),
            description: line.description,
        }
    }

    /// Price (EUR, to the cent) and mass (kg, to the gram) of all that have one.
    pub fn sums(rows: &[BillRow]) -> (f64, f64) {
        let rounded = |value: f64, units: f64| (value * units).round() / units;
        let price = rows.iter().filter_map(|row| row.price).sum();
        let mass = rows.iter().filter_map(|row| row.mass).sum();
        (rounded(price, 100.0), rounded(mass, 1000.0))
    }
}
