//! What comes, what is stored, and what stops and fails.

use super::{Printer, metres, number, quoted, unit};
use crate::model::*;
use std::fmt::Write;

impl Printer {
    pub(super) fn capacity(&mut self, layout: &Layout) {
        let names = |section: usize| layout.section_name(section);
        let Capacity { scanners, feeds, storages, items, stops, failures, waves, each_wave, required } =
            &layout.capacity;
        let declared = &layout.equipment.declared;
        for place in scanners.iter().filter(|place| declared.iter().all(|d| d.span != place.span)) {
            self.line(format!("scanner on {} at {}", names(place.section), metres(place.at)));
        }
        for feed in feeds {
            let mut text = format!("feed {}", layout.equipment.names(EquipmentKind::Induction)[feed.induction]);
            if let Some(rate) = feed.rate {
                let _ = write!(text, " {} per hour", number(rate));
            }
            if let Some(most) = feed.most {
                let _ = write!(text, " up to {} per hour", number(most));
            }
            let _ = write!(text, " efficiency {}", number(feed.efficiency));
            self.line(text + &row_shares(layout, &feed.shares));
        }
        for storage in storages {
            let name = layout.equipment.names(EquipmentKind::Chute)[storage.chutes];
            let every = storage.every.map_or_else(String::new, |every| format!(" every {}", unit(every, "s")));
            self.line(format!("storage {name} {}{every}", storage.count));
        }
        if *items != Items::default() {
            let laps = items.laps.map_or_else(String::new, |laps| format!(" laps {laps}"));
            self.line(format!("items{laps} double {} unread {}", number(items.double), number(items.unread)));
        }
        if let Some(stops) = stops {
            self.line(format!("stops every {} for {}", unit(stops.every, "s"), unit(stops.duration, "s")));
        }
        for failure in failures {
            let name = match failure.of {
                FailureOf::Induction(i) => layout.equipment.names(EquipmentKind::Induction)[i],
                FailureOf::Chutes(i) => layout.equipment.names(EquipmentKind::Chute)[i],
                FailureOf::Scanners => SCANNERS,
            };
            self.line(format!("fails {name} every {} for {}", unit(failure.every, "s"), unit(failure.duration, "s")));
        }
        if let Some(Waves { every, changeover, spread, .. }) = waves {
            let (every, changeover) = (unit(*every, "s"), unit(*changeover, "s"));
            self.line(format!("waves every {every} changeover {changeover} spread {}", number(*spread)));
        }
        for wave in each_wave {
            self.line(format!("wave {}{}", wave.name, row_shares(layout, &wave.shares)));
        }
        if let Some(required) = required {
            let reason = required.reason.as_ref().map_or_else(String::new, |why| format!(" {}", quoted(why)));
            self.line(format!("require capacity >= {} per hour{reason}", number(required.least.value)));
        }
    }
}

/// Rows of chutes with their shares, if there are any.
fn row_shares(layout: &Layout, shares: &[(usize, f64)]) -> String {
    let names = layout.equipment.names(EquipmentKind::Chute);
    let share = |(row, share): &(usize, f64)| format!("{} {}", names[*row], number(*share));
    let shares: Vec<String> = shares.iter().map(share).collect();
    if shares.is_empty() { String::new() } else { format!(" to {}", shares.join(", ")) }
}
