//! An order of free equipment in which a sorter takes as many items an hour as it is asked to: chutes between inductions,
//! so that carriers are used more than once in a lap. It is tried on the same track before it is told.

use super::Compiled;
use crate::base::number::fixed;
use crate::base::words::list;
use crate::capacity::{Limit, bound};
use crate::model::{EquipmentKind, Layout, Stands};
use crate::placement;

impl Compiled {
    /// What to write so that rows of chutes that stand freely come between the inductions, where that alone is enough for
    /// the capacity that is required.
    pub(super) fn enough_in_order(&self, least: f64) -> Option<String> {
        let sorter = self.sorter()?;
        let found = bound(&sorter, sorter.proportions().as_deref())?;
        if !matches!(found.limit, Limit::Stretch(_)) {
            return None;
        }
        let (layout, words) = self.in_order()?;
        let takes = self.placed_again(layout)?.sorter().and_then(|s| bound(&s, s.proportions().as_deref()))?.throughput;
        (takes >= least)
            .then(|| format!("write {}: in this order it takes at most {}", list(&words, "and"), fixed(takes, 0)))
    }

    /// The layout with rows of chutes between the inductions, as many behind each, and what was added to each row.
    fn in_order(&self) -> Option<(Layout, Vec<String>)> {
        let mut layout = self.layout.clone();
        let mut inductions: Vec<(f64, String)> =
            layout.equipment.inductions.iter().map(|i| (self.station(i.place).s, i.name.clone())).collect();
        inductions.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Several of one name stand beside each other.
        inductions.dedup_by(|a, b| a.1 == b.1);
        let is_row =
            |d: &crate::model::Declared| d.of.kind == EquipmentKind::Chute && matches!(d.stands, Stands::Free { .. });
        let rows: Vec<usize> =
            (0..layout.equipment.declared.len()).filter(|i| is_row(&layout.equipment.declared[*i])).collect();
        let (zones, count) = (inductions.len(), rows.len());
        // Every induction needs a row behind it.
        if zones < 2 || count < zones || count != layout.equipment.chutes.len() {
            return None;
        }
        let mut words = Vec::new();
        for (k, row) in rows.into_iter().enumerate() {
            let zone = k * zones / count;
            let (own, next) = (&inductions[zone].1, inductions.get(zone + 1).map(|(_, name)| name));
            let declared = &mut layout.equipment.declared[row];
            let Stands::Free { after, before, .. } = &mut declared.stands else { continue };
            let mut added = String::new();
            let mut add = |names: &mut Vec<String>, name: &String, word: &str| {
                if !names.contains(name) {
                    names.push(name.clone());
                    added += &format!(" {word} {name}");
                }
            };
            add(after, own, "after");
            if let Some(next) = next {
                add(before, next, "before");
            }
            if !added.is_empty() {
                words.push(format!("`chutes {} ...{added}`", declared.name));
            }
        }
        (!words.is_empty()).then_some((layout, words))
    }

    /// A changed layout on the same track, where everything has room on it.
    fn placed_again(&self, layout: Layout) -> Option<Compiled> {
        let placement = placement::place(&layout, &self.track);
        placement.is_whole().then(|| {
            let mut again = Compiled { layout, ..self.clone() };
            placement::fill_in(&mut again.layout, &placement);
            again.placement = placement;
            again
        })
    }
}
