//! A layout as its capacity sees it.

use super::Compiled;
use crate::capacity::Sorter;
use crate::capacity::sorter::{Chute, Failures, Induction, Items, Scanner, Stops, Wave, Waves};
use crate::model::{self, Capacity, EquipmentKind, FailureOf, SCANNERS};

impl Compiled {
    /// The sorter of a layout: a carrier a cart, inductions, scanners and chutes where they stand along the track, and what
    /// the layout says of its items. `None` without carts, inductions or chutes.
    pub fn sorter(&self) -> Option<Sorter> {
        let layout = &self.layout;
        let Capacity { scanners, feeds, storages, items, stops, failures, .. } = &layout.capacity;
        let carriers = self.chain?.carts;
        let equipment = &layout.equipment;
        // What waves say is of whole rows already.
        let waves_say = !layout.capacity.each_wave.is_empty();
        let fails = |of: FailureOf, name: &str| {
            let found = failures.iter().find(|failure| failure.of == of)?;
            Some(Failures { name: name.to_owned(), between: found.every, duration: found.duration })
        };
        let names = equipment.names(EquipmentKind::Induction);
        let induction = |(k, induction): (usize, &model::Induction)| {
            let i = names.iter().position(|name| *name == induction.name).unwrap_or(k);
            let feed = feeds.iter().find(|feed| feed.induction == i);
            // What comes is shared by those of one name.
            let count = equipment.inductions.iter().filter(|other| other.name == induction.name).count();
            Induction {
                name: equipment.induction_name(k),
                s: self.station(induction.place).s,
                demand: feed.and_then(|feed| feed.rate).map(|rate| rate / count as f64),
                most: feed.and_then(|feed| feed.most).unwrap_or(f64::INFINITY),
                efficiency: feed.map_or(1.0, |feed| feed.efficiency),
                to: feed.filter(|feed| !feed.shares.is_empty()).map(|feed| self.of_rows(&feed.shares, !waves_say)),
                fails: fails(FailureOf::Induction(i), &induction.name),
            }
        };
        let row = |(i, chutes): (usize, &model::Chutes)| {
            let storage = storages.iter().find(|storage| storage.chutes == i);
            let storage = storage.map(|s| (s.count, s.every.unwrap_or(f64::INFINITY)));
            let one = |(k, station): (usize, super::Station)| Chute {
                name: format!("{} {}", chutes.name, k + 1),
                s: station.s,
                share: 1.0,
                storage,
                fails: fails(FailureOf::Chutes(i), &chutes.name),
            };
            self.chutes(chutes).into_iter().enumerate().map(one).collect::<Vec<_>>()
        };
        let scanner = |s: f64| Scanner { s, fails: fails(FailureOf::Scanners, SCANNERS) };
        let sorter = Sorter {
            carriers,
            // Carts that close the loop stand a little nearer or farther than their length.
            pitch: self.length() / carriers.max(1) as f64,
            speed: layout.speed.value,
            inductions: equipment.inductions.iter().enumerate().map(induction).collect(),
            chutes: equipment.chutes.iter().enumerate().flat_map(row).collect(),
            scanners: scanners.iter().map(|place| scanner(self.station(*place).s)).collect(),
            items: Items { double: items.double, no_read: items.unread, most_laps: items.laps.unwrap_or(usize::MAX) },
            stops: stops.map(|s| Stops { between: s.every, duration: s.duration }),
            waves: self.waves(),
        };
        (carriers > 0 && !sorter.inductions.is_empty() && !sorter.chutes.is_empty()).then_some(sorter)
    }

    /// Shares of rows, one a chute: that of its row, or its part of it if the row's share is of all its chutes together.
    fn of_rows(&self, shares: &[(usize, f64)], together: bool) -> Vec<f64> {
        let of_row = |(i, row): (usize, &model::Chutes)| {
            let said = shares.iter().find(|(of, _)| *of == i).map_or(0.0, |(_, share)| *share);
            let count = row.count();
            std::iter::repeat_n(if together { said / count.max(1) as f64 } else { said }, count)
        };
        self.layout.equipment.chutes.iter().enumerate().flat_map(of_row).collect()
    }

    fn waves(&self) -> Option<Waves> {
        let Capacity { waves, each_wave, .. } = &self.layout.capacity;
        let wave = |wave: &model::Wave| Wave { name: wave.name.clone(), shares: self.of_rows(&wave.shares, true) };
        waves.map(|w| Waves {
            every: w.every,
            changeover: w.changeover,
            spread: w.spread,
            each: each_wave.iter().map(wave).collect(),
        })
    }
}
