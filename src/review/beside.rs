//! What is ordered beside the track: carts, joints, motors, sensors, supports, equipment and conveyors.

use crate::compiled::Compiled;
use crate::compiled::order::{self, OrderLine};
use schemars::JsonSchema;
use serde::Serialize;

/// Differences of prices from here on are told, EUR.
const TOLD: f64 = 0.005;

/// A component on both orders.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BesideChange {
    /// `chain`, `drive`, `sensors`, `supports` or `stations`.
    pub group: &'static str,
    /// Article number; absent where its declaration has none.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub article: Option<String>,
    pub description: String,
    pub before: usize,
    pub after: usize,
    /// What all of them cost, EUR; absent where there are some and their declaration has no price.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub before_eur: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub after_eur: Option<f64>,
}

impl BesideChange {
    fn is_changed(&self) -> bool {
        let priced = match (self.before_eur, self.after_eur) {
            (Some(before), Some(after)) => (after - before).abs() >= TOLD,
            (before, after) => before.is_some() != after.is_some(),
        };
        self.before != self.after || priced
    }
}

/// What there are more or fewer of, or what has another price, by group in the order of bills.
pub fn changed(before: &Compiled, after: &Compiled) -> Vec<BesideChange> {
    let [before, after] = [before, after].map(order::lines);
    let is_same =
        |a: &OrderLine, b: &OrderLine| (a.group, &a.article, &a.description) == (b.group, &b.article, &b.description);
    let gone = before.iter().filter(|own| !after.iter().any(|line| is_same(line, own)));
    let mut all: Vec<&OrderLine> = after.iter().chain(gone).collect();
    // What went stands behind what is there, group by group.
    all.sort_by_key(|line| line.group);
    let of = |lines: &[OrderLine], own: &OrderLine| {
        let found = lines.iter().find(|line| is_same(line, own));
        found.map_or((0, Some(0.0)), |line| (line.count, line.price()))
    };
    let change = |line: &&OrderLine| {
        let ((was, was_eur), (is, is_eur)) = (of(&before, line), of(&after, line));
        BesideChange {
            group: line.group.name(),
            article: line.article.clone(),
            description: line.description.clone(),
            before: was,
            after: is,
            before_eur: was_eur,
            after_eur: is_eur,
        }
    };
    all.iter().map(change).filter(BesideChange::is_changed).collect()
}
