//! What a study says first: which result changes most with each parameter.

use super::unit;
use crate::base::number::{decimal, fixed, significant};
use crate::study::table::{Cells, Column};
use std::collections::{BTreeMap, BTreeSet};

/// Parameters that are told.
const TOLD: usize = 4;
/// Results that never exceed this are rounding errors, whatever their unit, and so are differences of such a share.
const NOTHING: f64 = 1e-6;
/// Changes of less than this share are not told.
const LEAST: f64 = 1e-3;
/// Results that are not told, by the last part of their names: the work or the precision of a search, which is not about
/// the layout, and least and largest values, of which `peak` is the one that counts.
const UNTOLD: [&str; 10] =
    ["min", "max", "nodes", "iterations", "starts", "gap", "closure_m", "closure_rad", "max_violation_m", "seed"];

/// How the mean of a result over tasks differs between values of a parameter.
struct Change<'a> {
    parameter: &'a Column,
    result: &'a Column,
    /// The values of the parameter with the least and the largest mean, in the parameter's order, and those means.
    ends: [(String, f64); 2],
    /// Largest over least mean, less one.
    share: f64,
}

/// A sentence for each parameter that changes something, the one that changes most first.
pub fn sentences(parameters: &[&Column], results: &[&Column]) -> Vec<String> {
    changes(parameters, results).iter().map(Change::words).collect()
}

/// The parameter and the result of the first sentence.
pub fn first<'a>(parameters: &[&'a Column], results: &[&'a Column]) -> Option<(&'a Column, &'a Column)> {
    changes(parameters, results).first().map(|change| (change.parameter, change.result))
}

/// Whether a column has two numbers that do not differ by rounding alone.
pub fn differs(column: &Column) -> bool {
    let Cells::Numbers(cells) = &column.cells else { return false };
    let known = || cells.iter().flatten().copied().filter(|x| x.is_finite());
    let (low, high) = (known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max));
    let size = low.abs().max(high.abs());
    size > NOTHING && high - low > NOTHING * size
}

/// How many values of a parameter a result was found at.
pub fn values(parameter: &Column, cells: &[Option<f64>]) -> usize {
    let found = (0..cells.len()).filter(|row| cells[*row].is_some_and(f64::is_finite));
    found.filter_map(|row| key(parameter, row)).collect::<BTreeSet<_>>().len()
}

fn changes<'a>(parameters: &[&'a Column], results: &[&'a Column]) -> Vec<Change<'a>> {
    let mut changes: Vec<Change> = parameters.iter().filter_map(|parameter| most(parameter, results)).collect();
    changes.retain(|change| change.share >= LEAST);
    changes.sort_by(|a, b| b.share.total_cmp(&a.share));
    changes.truncate(TOLD);
    changes
}

/// The result that a parameter changes most.
fn most<'a>(parameter: &'a Column, results: &[&'a Column]) -> Option<Change<'a>> {
    let changes = results.iter().filter_map(|result| change(parameter, result));
    changes.max_by(|a, b| a.share.total_cmp(&b.share))
}

fn change<'a>(parameter: &'a Column, result: &'a Column) -> Option<Change<'a>> {
    let Cells::Numbers(cells) = &result.cells else { return None };
    if result.name.rsplit('.').next().is_some_and(|last| UNTOLD.contains(&last)) {
        return None;
    }
    // By the parameter's value: where it stands, how it is told, the sum and the number of results.
    let mut groups: BTreeMap<(i64, String), (f64, f64)> = BTreeMap::new();
    for (row, value) in cells.iter().enumerate() {
        let (Some(value), Some(key)) = (value.filter(|x| x.is_finite()), key(parameter, row)) else { continue };
        let group = groups.entry(key).or_default();
        *group = (group.0 + value, group.1 + 1.0);
    }
    let means: Vec<(&str, f64)> = groups.iter().map(|((_, told), (sum, n))| (told.as_str(), sum / n)).collect();
    // How many times a result is another one says nothing where its sign changes, or where it is nothing.
    let size = |mean: f64| mean.abs();
    let is_telling = means.iter().all(|m| m.1 > 0.0) || means.iter().all(|m| m.1 < 0.0);
    if means.len() < 2 || !is_telling || means.iter().all(|m| size(m.1) < NOTHING) {
        return None;
    }
    let least = (0..means.len()).min_by(|a, b| size(means[*a].1).total_cmp(&size(means[*b].1)))?;
    let most = (0..means.len()).max_by(|a, b| size(means[*a].1).total_cmp(&size(means[*b].1)))?;
    let ends = [least.min(most), least.max(most)].map(|k| (means[k].0.to_owned(), means[k].1));
    Some(Change { parameter, result, ends, share: size(means[most].1) / size(means[least].1) - 1.0 })
}

/// Where a parameter's value stands among others, and how it is told.
fn key(parameter: &Column, row: usize) -> Option<(i64, String)> {
    match &parameter.cells {
        Cells::Numbers(cells) => {
            let value = cells.get(row).copied().flatten()?;
            let bits = value.to_bits() as i64;
            let order = if bits < 0 { i64::MIN.wrapping_sub(bits) } else { bits };
            Some((order, format!("{} {}", significant(value, 6), parameter.unit).trim().to_owned()))
        }
        other => Some((0, other.text(row))).filter(|(_, text)| !text.is_empty()),
    }
}

impl Change<'_> {
    /// `With simulate.speed, simulate.joint_xi.peak changes most: from 210 N at 1 m/s to 405 N at 2 m/s (+93 %).`
    fn words(&self) -> String {
        let [(from, was), (to, is)] = &self.ends;
        let unit = unit(self.result);
        let told = |value: f64| format!("{} {unit}", decimal(value, 4)).trim().to_owned();
        let share = 100.0 * (is.abs() / was.abs() - 1.0);
        let sign = if share < 0.0 { "−" } else { "+" };
        format!(
            "With {}, {} changes most: from {} at {from} to {} at {to} ({sign}{} %).",
            self.parameter.name,
            self.result.name,
            told(*was),
            told(*is),
            fixed(share.abs(), if share.abs() < 10.0 { 1 } else { 0 })
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::table::Role;

    fn numbers(name: &str, role: Role, unit: &str, cells: &[f64]) -> Column {
        let cells = Cells::Numbers(cells.iter().map(|x| Some(*x)).collect());
        Column { name: name.into(), role, unit: unit.into(), cells }
    }

    #[test]
    fn the_result_that_changes_most_is_told_of_each_parameter() {
        let speed = numbers("simulate.speed", Role::Parameter, "m/s", &[1.0, 1.0, 2.0, 2.0]);
        let texts = ["a.lss", "b.lss", "a.lss", "b.lss"].map(|text| Some(text.to_owned()));
        let cells = Cells::Texts(texts.into());
        let file = Column { name: "file".into(), role: Role::Parameter, unit: String::new(), cells };
        let results = [
            numbers("build.length_m", Role::Result, "", &[100.0, 110.0, 100.0, 110.0]),
            numbers("simulate.joint_xi.peak", Role::Result, "", &[200.0, 200.0, 390.0, 410.0]),
            // A search's work, rounding errors, and what has either sign tell nothing.
            numbers("build.certificate.nodes", Role::Result, "", &[1.0, 9000.0, 1.0, 1.0]),
            numbers("build.closure", Role::Result, "", &[1e-15, 9e-15, 1e-15, 1e-15]),
            numbers("build.chain.left_over_mm", Role::Result, "", &[-0.1, 9.0, 3.0, -20.0]),
        ];
        let results: Vec<&Column> = results.iter().collect();
        assert_eq!(
            sentences(&[&file, &speed], &results),
            [
                "With simulate.speed, simulate.joint_xi.peak changes most: from 200 N at 1 m/s to 400 N at 2 m/s (+100 %).",
                "With file, build.length_m changes most: from 100 m at a.lss to 110 m at b.lss (+10 %).",
            ]
        );
        assert!(sentences(&[&file], &[]).is_empty());
        let of = |cells: &[f64]| differs(&numbers("build.length_m", Role::Result, "m", cells));
        assert!(of(&[1.0, 1.001]) && of(&[-2.0, 2.0]) && of(&[0.0, 1e-3]));
        assert!(!of(&[90.119_103_7, 90.119_103_75]) && !of(&[4e-15, 1e-15]) && !of(&[3.0]) && !of(&[]));
    }
}
