//! Candidates that no other one beats in two or three measures. All are looked at, so that the ends and everything between
//! them are exact for the tracks that there are.

use super::find::Chosen;
use clap::ValueEnum;
use schemars::JsonSchema;
use serde::Serialize;

/// What candidates are compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Of everything that has a price, EUR.
    Price,
    /// Of track, equipment and conveyors, EUR.
    Cost,
    /// Floor that the track's band covers, m².
    Footprint,
    /// Most items an hour.
    Capacity,
    /// Polygon action: root mean square of ΔP, mm. Less is smoother.
    Smoothness,
    /// kWh a year.
    Energy,
    /// Of the track, m.
    Length,
}

impl Measure {
    pub const ALL: [Measure; 7] = [
        Measure::Price,
        Measure::Cost,
        Measure::Footprint,
        Measure::Capacity,
        Measure::Smoothness,
        Measure::Energy,
        Measure::Length,
    ];

    /// Why these cannot be traded.
    pub fn wrong(measures: &[Measure]) -> Option<String> {
        let mut sorted = measures.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        match (measures.len(), sorted.len()) {
            (all, unlike) if all != unlike => Some("--pareto names a measure twice".to_owned()),
            (2 | 3, _) => None,
            (n, _) => Some(format!("--pareto takes two or three measures, such as price,capacity, and not {n}")),
        }
    }

    /// Name, unit, and decimals that it is shown with.
    pub fn words(self) -> (&'static str, &'static str, usize) {
        match self {
            Measure::Price => ("price", "EUR", 2),
            Measure::Cost => ("cost", "EUR", 2),
            Measure::Footprint => ("footprint", "m²", 2),
            Measure::Capacity => ("capacity", "items/h", 0),
            Measure::Smoothness => ("smoothness", "mm", 4),
            Measure::Energy => ("energy", "kWh/a", 0),
            Measure::Length => ("length", "m", 3),
        }
    }

    /// Values that differ by less are alike: prices by half a cent for each of some pieces, the others by what is shown
    /// of them.
    pub fn step(self) -> f64 {
        match self {
            Measure::Price | Measure::Cost => 0.5,
            Measure::Footprint | Measure::Smoothness => 1e-4,
            Measure::Capacity | Measure::Energy => 0.1,
            Measure::Length => 1e-5,
        }
    }

    /// Whether more is better.
    pub fn is_gain(self) -> bool {
        self == Measure::Capacity
    }

    /// Of a candidate; `None` where it has none.
    pub fn of(self, chosen: &Chosen, candidate: usize) -> Option<f64> {
        let c = &chosen.candidates[candidate];
        let compiled = &chosen.track(c).compiled;
        match self {
            Measure::Price => Some(c.price),
            Measure::Cost => Some(compiled.bill.price + compiled.placement.price()),
            Measure::Footprint => Some(compiled.footprint),
            Measure::Capacity => c.capacity.as_ref().map(|bound| bound.throughput),
            Measure::Smoothness => chosen.fitted[c.fitted].polygon_action.map(|x| x * 1e3),
            Measure::Energy => chosen.layout.choice.energy.map(|_| c.energy / 3.6e6),
            Measure::Length => Some(compiled.length()),
        }
    }
}

/// Those of the candidates that do what is required which no other one beats: none is as good in all measures and better in
/// one. Of equal ones the first is kept. By the first measure, the best first.
pub fn undominated(chosen: &Chosen, measures: &[Measure]) -> Vec<(usize, Vec<f64>)> {
    let row = |k: &usize| {
        let values: Option<Vec<f64>> = measures.iter().map(|m| m.of(chosen, *k)).collect();
        Some((*k, values?))
    };
    let rows: Vec<(usize, Vec<f64>)> = chosen.order.iter().filter_map(row).collect();
    front(rows, measures.iter().map(|m| m.is_gain()).collect())
}

/// The rows that no other one beats; `gains` says of which columns more is better.
pub(super) fn front(mut rows: Vec<(usize, Vec<f64>)>, gains: Vec<bool>) -> Vec<(usize, Vec<f64>)> {
    let cost = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(&gains).map(|(value, gain)| if *gain { -value } else { *value }).collect()
    };
    rows.sort_by(|a, b| {
        let (x, y) = (cost(&a.1), cost(&b.1));
        x.iter().zip(&y).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne()).unwrap_or(a.0.cmp(&b.0))
    });
    // Sorted so, a row is beaten by one before it or by none.
    let mut kept: Vec<(usize, Vec<f64>)> = Vec::new();
    for row in rows {
        let own = cost(&row.1);
        let beaten = kept.iter().any(|other| cost(&other.1).iter().zip(&own).all(|(a, b)| a <= b));
        if !beaten {
            kept.push(row);
        }
    }
    kept
}
