//! Groups of a campaign's runs: those of one layout at one set point of speed and tension. Values of runs at different
//! set points are of different operating points, so that no median is taken over them.

use crate::base::number::{shortest, trimmed};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Runs of one layout at one set point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunGroup {
    /// The layout's file.
    pub layout: String,
    /// Set speed, m/s.
    pub speed: f64,
    /// Set tension, N.
    pub tension: f64,
    pub runs: Vec<String>,
}

/// Where a run was made.
#[derive(Clone, Debug, PartialEq)]
pub struct SetPoint {
    pub run: String,
    pub layout: String,
    pub speed: f64,
    pub tension: f64,
}

impl RunGroup {
    /// The groups by layout, speed and tension; runs in the order they come in.
    pub fn all(points: &[SetPoint]) -> Vec<RunGroup> {
        let mut groups: BTreeMap<(&str, u64, u64), RunGroup> = BTreeMap::new();
        for point in points {
            // Both are positive, so that their bits are in their order.
            let key = (point.layout.as_str(), point.speed.to_bits(), point.tension.to_bits());
            let none = || RunGroup {
                layout: point.layout.clone(),
                speed: point.speed,
                tension: point.tension,
                runs: Vec::new(),
            };
            groups.entry(key).or_insert_with(none).runs.push(point.run.clone());
        }
        groups.into_values().collect()
    }

    /// `2.05 m/s, 1000 N`
    pub fn set_point(&self) -> String {
        format!("{} m/s, {} N", trimmed(self.speed, 3), trimmed(self.tension, 1))
    }

    /// The layout's file without its folder, where no other layout is called the same.
    pub fn short<'a>(&self, all: impl IntoIterator<Item = &'a RunGroup>) -> String {
        let name = |layout: &str| Path::new(layout).file_name().map(|name| name.to_string_lossy().into_owned());
        let own = name(&self.layout);
        let same = |other: &RunGroup| other.layout != self.layout && name(&other.layout) == own;
        let alone = !all.into_iter().any(same);
        own.filter(|_| alone).unwrap_or_else(|| self.layout.clone())
    }

    /// As part of a file's name: `2.05mps-1000N`.
    pub fn file_part(&self) -> String {
        format!("{}mps-{}N", shortest(self.speed), shortest(self.tension))
    }

    pub fn has(&self, run: &str) -> bool {
        self.runs.iter().any(|own| own == run)
    }
}

/// Quantile of sorted values, linear between them; NaN of none.
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let at = q * sorted.len().saturating_sub(1) as f64;
    let (i, share) = (at.floor() as usize, at - at.floor());
    match (sorted.get(i), sorted.get(i + 1)) {
        (Some(a), Some(b)) => a + share * (b - a),
        (Some(a), None) => *a,
        _ => f64::NAN,
    }
}

/// Lower quartile, median and upper quartile.
pub fn quartiles(values: impl IntoIterator<Item = f64>) -> [f64; 3] {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|q| quantile(&sorted, q))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_lie_between_values() {
        let sorted = [1.0, 2.0, 3.0, 4.0];
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|q| quantile(&sorted, q)), [1.0, 1.75, 2.5, 4.0]);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn runs_of_other_layouts_speeds_and_tensions_are_other_groups() {
        let point = |run: &str, layout: &str, speed, tension| SetPoint {
            run: run.into(),
            layout: layout.into(),
            speed,
            tension,
        };
        let points = [
            point("a", "x.lss", 2.5, 500.0),
            point("b", "x.lss", 2.0, 500.0),
            point("c", "x.lss", 2.5, 500.0),
            point("d", "x.lss", 2.0, 900.0),
            point("e", "w.lss", 2.0, 500.0),
        ];
        let group = |layout: &str| RunGroup { layout: layout.into(), speed: 2.0, tension: 500.0, runs: Vec::new() };
        let all = [group("a/x.lss"), group("b/x.lss"), group("b/y.lss")];
        assert_eq!(all.each_ref().map(|group| group.short(&all)), ["a/x.lss", "b/x.lss", "y.lss"]);
        let told: Vec<(String, Vec<String>)> =
            RunGroup::all(&points).into_iter().map(|g| (format!("{} {}", g.layout, g.file_part()), g.runs)).collect();
        let expected = [
            ("w.lss 2mps-500N", vec!["e"]),
            ("x.lss 2mps-500N", vec!["b"]),
            ("x.lss 2mps-900N", vec!["d"]),
            ("x.lss 2.5mps-500N", vec!["a", "c"]),
        ];
        let told: Vec<(&str, Vec<&str>)> =
            told.iter().map(|(name, runs)| (name.as_str(), runs.iter().map(String::as_str).collect())).collect();
        assert_eq!(told, expected);
    }
}
