//! A layout as its capacity sees it.

use super::Compiled;
use crate::capacity::Sorter;
use crate::capacity::sorter::{Chute, Induction, Items, Stops};
use crate::model::{self, Capacity};

impl Compiled {
    /// The sorter of a layout: a carrier a cart, inductions, scanners and chutes where they stand along the track, and what
    /// the layout says of its items. `None` without carts, inductions or chutes.
    pub fn sorter(&self) -> Option<Sorter> {
        let layout = &self.layout;
        let Capacity { scanners, feeds, storages, items, stops, .. } = &layout.capacity;
        let carriers = self.chain?.carts;
        let equipment = &layout.equipment;
        let induction = |(i, induction): (usize, &model::Induction)| {
            let feed = feeds.iter().find(|feed| feed.induction == i);
            Induction {
                name: induction.name.clone(),
                s: self.station(induction.place).s,
                demand: feed.and_then(|feed| feed.rate),
                most: feed.and_then(|feed| feed.most).unwrap_or(f64::INFINITY),
                efficiency: feed.map_or(1.0, |feed| feed.efficiency),
            }
        };
        let row = |(i, chutes): (usize, &model::Chutes)| {
            let storage = storages.iter().find(|storage| storage.chutes == i).map(|s| (s.count, s.every));
            let one = |(k, station): (usize, super::Station)| Chute {
                name: format!("{} {}", chutes.name, k + 1),
                s: station.s,
                share: 1.0,
                storage,
            };
            self.chutes(chutes).into_iter().enumerate().map(one).collect::<Vec<_>>()
        };
        let sorter = Sorter {
            carriers,
            // Carts that close the loop stand a little nearer or farther than their length.
            pitch: self.length() / carriers.max(1) as f64,
            speed: layout.speed.value,
            inductions: equipment.inductions.iter().enumerate().map(induction).collect(),
            chutes: equipment.chutes.iter().enumerate().flat_map(row).collect(),
            scanners: scanners.iter().map(|place| self.station(*place).s).collect(),
            items: Items { double: items.double, no_read: items.unread, most_laps: items.laps.unwrap_or(usize::MAX) },
            stops: stops.map(|s| Stops { between: s.every, duration: s.duration }),
        };
        (carriers > 0 && !sorter.inductions.is_empty() && !sorter.chutes.is_empty()).then_some(sorter)
    }
}
