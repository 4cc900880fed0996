//! Scanners, feeds, storages, items, stops, and the capacity that is asked for.

use super::draft::{Draft, Placed};
use super::vertices::Geometry;
use crate::base::number::shortest;
use crate::base::words::with_article;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{
    Capacity, Declared, Equipment, EquipmentKind, Failure, FailureOf, Feed, Items, RequiredCapacity, SCANNERS, Stops,
    Storage, Wave, Waves,
};
use crate::semantics::dimension::Dimension;
use crate::semantics::fields::Bounds;
use crate::semantics::program::{mentions, repeated};
use crate::semantics::scope::Context;
use crate::source::{Span, Spanned};
use crate::syntax::tree::{Expr, Name, Statement};

/// Items an hour.
const RATE: Bounds = Bounds::above(0.0, 1e6);
/// A share that may be nothing, and one that may be all.
const SHARE: Bounds = Bounds::between(0.0, 0.99);
const USED: Bounds = Bounds::above(0.0, 1.0);
/// s
const TIME: Bounds = Bounds::above(0.0, 1e7);
/// Failures and repairs below a second are none.
const REPAIR: Bounds = Bounds::between(1.0, 1e9);
const WAVE: Bounds = Bounds::between(60.0, 1e7);
/// Of a wave's items, in relation to each other.
const PART: Bounds = Bounds::between(0.0, 1e6);
const SPREAD: Bounds = Bounds::between(0.0, 3.0);

impl<'t> Context<'t> {
    /// What is said of capacity, unless something of it has a mistake.
    pub(super) fn capacity(
        &self,
        draft: &Draft<'t>,
        geometry: &Geometry<'t>,
        equipment: &Equipment,
    ) -> Option<Capacity> {
        let mut capacity = Capacity::default();
        let mut sound = true;
        for placed in &draft.statements {
            sound &= self.say(draft, placed, geometry, equipment, &mut capacity).is_some();
        }
        (sound && self.emptied(draft, equipment, &capacity) && self.lead_somewhere(equipment, &capacity))
            .then_some(capacity)
    }

    /// Whether what is said of waves goes with the rest.
    fn emptied(&self, draft: &Draft<'t>, equipment: &Equipment, capacity: &Capacity) -> bool {
        if capacity.waves.is_some() || !draft.base_known || mentions(&draft.bad, "waves") {
            return true;
        }
        let missing = |message: String, span: Span, label: &str| {
            let help = "say how long a wave is, with a line such as `waves every 30 min changeover 2 min`";
            self.report(Diagnostic::new(Code::E0214, message, span, label).help(help));
            false
        };
        if let Some(wave) = capacity.each_wave.first() {
            return missing(format!("the wave `{}` has no length", wave.name), wave.span, "needs `waves`");
        }
        if let Some(storage) = capacity.storages.iter().find(|storage| storage.every.is_none()) {
            let names = equipment.names(EquipmentKind::Chute);
            let name = names.get(storage.chutes).copied().unwrap_or_default();
            let message = format!("nothing is ever taken from the chutes `{name}`");
            return missing(message, storage.span, "needs `every`, or `waves`");
        }
        true
    }

    /// Whether every wave has chutes for the items of every induction.
    fn lead_somewhere(&self, equipment: &Equipment, capacity: &Capacity) -> bool {
        let takes = |shares: &[(usize, f64)], row: usize| shares.iter().any(|(of, share)| *of == row && *share > 0.0);
        let mut sound = true;
        for feed in capacity.feeds.iter().filter(|feed| !feed.shares.is_empty()) {
            let goes_on =
                |wave: &&Wave| !feed.shares.iter().any(|(row, share)| *share > 0.0 && takes(&wave.shares, *row));
            let Some(wave) = capacity.each_wave.iter().find(goes_on) else { continue };
            let induction = equipment.names(EquipmentKind::Induction).get(feed.induction).copied().unwrap_or_default();
            let message = format!("items of the induction `{induction}` go nowhere in the wave `{}`", wave.name);
            let diagnostic = Diagnostic::new(Code::E0306, message, feed.span, "goes to none of the wave's rows");
            let help = "let the induction feed a row that the wave goes to, or let the wave go to one of its rows";
            self.report(diagnostic.related(wave.span, "this wave").help(help));
            sound = false;
        }
        sound
    }

    /// Adds what one statement says; `None` is a mistake.
    fn say(
        &self,
        draft: &Draft<'t>,
        placed: &Placed<'t>,
        geometry: &Geometry<'t>,
        equipment: &Equipment,
        capacity: &mut Capacity,
    ) -> Option<()> {
        let number = |expr: &'t Expr, what: &str, dimension, bounds| {
            self.bounded_constant(&placed.env, expr, dimension, what, bounds).map(|v| v.value)
        };
        let rate = |expr: &'t Option<Expr>, what: &str| match expr {
            None => Some(None),
            Some(expr) => number(expr, what, Dimension::NONE, RATE).map(Some),
        };
        let share = |expr: &'t Option<Expr>, what: &str, bounds, absent: f64| match expr {
            None => Some(absent),
            Some(expr) => number(expr, what, Dimension::NONE, bounds),
        };
        match placed.statement {
            Statement::Scanner(place) => capacity.scanners.push(self.along(placed, geometry, place)?),
            Statement::Feed { induction, rate: comes, most, efficiency, shares } => {
                let names = equipment.names(EquipmentKind::Induction).into_iter();
                let index = self.named(draft, "induction", induction, names);
                let rate_of = rate(comes, "the number of items an hour");
                let most = rate(most, "the most items an hour");
                let efficiency = share(efficiency, "the efficiency", USED, 1.0);
                let shares = self.row_shares(draft, placed, equipment, shares, "an induction");
                let (rate, most, efficiency, span) = (rate_of?, most?, efficiency?, placed.span);
                let declared = equipment.declared.iter().find(|declared| declared.name == induction.text);
                let count = declared.map_or(1, Declared::count) as f64;
                let all = most.map(|most| most * count);
                // How many there are is another question where it can be chosen.
                let chosen = |placed: &Placed| match placed.statement {
                    Statement::ChooseCount { equipment, .. } => equipment.iter().any(|n| n.text == induction.text),
                    _ => false,
                };
                let fixed = !draft.statements.iter().any(chosen);
                if let Some((comes, most)) = rate.zip(all).filter(|(comes, most)| fixed && comes > most) {
                    let message = format!("more items come to the induction `{}` than it takes", induction.text);
                    let label = format!("{} an hour come, of which it takes {}", shortest(comes), shortest(most));
                    let help = "raise `up to`, or let fewer come: what it does not take waits in front of it";
                    self.report(Diagnostic::new(Code::W0714, message, span, label).help(help));
                }
                capacity.feeds.push(Feed { induction: index?, rate, most, efficiency, shares: shares?, span });
            }
            Statement::Storage { chutes, count, every } => {
                let names = equipment.names(EquipmentKind::Chute).into_iter();
                let index = self.named(draft, "row of chutes", chutes, names);
                let count = self.count(&placed.env, count, "the number of items", 1);
                let every = match every {
                    None => Some(None),
                    Some(every) => number(every, "the time for an item", Dimension::TIME, TIME).map(Some),
                };
                let (chutes, count, every, span) = (index?, count?, every?, placed.span);
                capacity.storages.push(Storage { chutes, count, every, span });
            }
            Statement::Items { laps, double, unread } => {
                let laps = match laps {
                    None => Some(None),
                    Some(laps) => self.count(&placed.env, laps, "the number of laps", 1).map(Some),
                };
                let double = share(double, "the share of items on two carriers", Bounds::between(0.0, 1.0), 0.0);
                let unread = share(unread, "the share of readings that fail", SHARE, 0.0);
                capacity.items = Items { laps: laps?, double: double?, unread: unread? };
            }
            Statement::Stops { every, duration } => {
                let every = number(every, "the time between two stops", Dimension::TIME, TIME);
                let duration = number(duration, "the duration of a stop", Dimension::TIME, TIME);
                capacity.stops = Some(Stops { every: every?, duration: duration? });
            }
            Statement::Fails { equipment: name, every, duration } => {
                let of = self.failing(draft, name, equipment);
                let every = number(every, "the time between two failures", Dimension::TIME, REPAIR);
                let duration = number(duration, "the time of a repair", Dimension::TIME, REPAIR);
                let (of, every, duration, span) = (of?, every?, duration?, placed.span);
                capacity.failures.push(Failure { of, every, duration, span });
            }
            Statement::Waves { every, changeover, spread } => {
                let length = number(every, "the length of a wave", Dimension::TIME, WAVE);
                let spread = share(spread, "the spread of shares", SPREAD, 0.0);
                let changeover = match changeover {
                    None => Some(0.0),
                    Some(expr) => {
                        // Chutes that are closed all the time take nothing.
                        let most = Bounds::between(0.0, 0.9 * length?);
                        number(expr, "the time of a changeover", Dimension::TIME, most)
                    }
                };
                let (every, changeover, spread, span) = (length?, changeover?, spread?, placed.span);
                capacity.waves = Some(Waves { every, changeover, spread, span });
            }
            Statement::Wave { name, shares } => {
                let shares = self.row_shares(draft, placed, equipment, shares, "a wave")?;
                capacity.each_wave.push(Wave { name: name.text.clone(), shares, span: name.span });
            }
            Statement::RequireCapacity { least, reason } => {
                let value = number(least, "the capacity", Dimension::NONE, RATE)?;
                let least = Spanned::new(value, placed.span);
                capacity.required = Some(RequiredCapacity { least, reason: reason.clone() });
            }
            _ => {}
        }
        Some(())
    }

    /// What fails: the induction or the row of chutes of that name, or all scanners.
    fn failing(&self, draft: &Draft<'t>, name: &Name, equipment: &Equipment) -> Option<FailureOf> {
        let (inductions, chutes) = (equipment.names(EquipmentKind::Induction), equipment.names(EquipmentKind::Chute));
        let of = |names: &[&str]| names.iter().position(|known| *known == name.text);
        let scanners = draft.has_scanner().then_some(SCANNERS);
        let known = [
            of(&inductions).map(|i| ("an induction", FailureOf::Induction(i))),
            of(&chutes).map(|i| ("a row of chutes", FailureOf::Chutes(i))),
            scanners.filter(|all| name.text == *all).map(|_| ("what all scanners are called", FailureOf::Scanners)),
        ];
        let mut known = known.into_iter().flatten();
        match (known.next(), known.next()) {
            (Some((first, _)), Some((second, _))) => {
                let message = format!("`{}` is {first} and {second}", name.text);
                let diagnostic = Diagnostic::new(Code::E0218, message, name.span, "which of them fails?");
                self.report(diagnostic.help("give one of them another name"));
                None
            }
            (Some((_, of)), None) => Some(of),
            (None, _) if name.text == SCANNERS && draft.base_known && !mentions(&draft.bad, "scanner") => {
                let diagnostic = Diagnostic::new(Code::E0218, "there is no scanner", name.span, "nothing that fails");
                self.report(
                    diagnostic.help("say where items are read, with a line such as `scanner on P1..P2 at 6 m`"),
                );
                None
            }
            (None, _) => {
                // A word that is near to it is told, even where there is no scanner yet.
                let scanners = (name.text != SCANNERS).then_some(SCANNERS);
                let names = inductions.into_iter().chain(chutes).chain(scanners);
                self.named(draft, "induction or row of chutes", name, names).map(FailureOf::Induction)
            }
        }
    }

    /// Rows and their shares of the items of a wave or an induction.
    fn row_shares(
        &self,
        draft: &Draft<'t>,
        placed: &Placed<'t>,
        equipment: &Equipment,
        shares: &'t [(Name, Expr)],
        of: &str,
    ) -> Option<Vec<(usize, f64)>> {
        let names = equipment.names(EquipmentKind::Chute).into_iter();
        let mut found: Vec<Option<(usize, f64)>> = Vec::new();
        for (k, (row, share)) in shares.iter().enumerate() {
            if let Some((first, _)) = shares[..k].iter().find(|(first, _)| first.text == row.text) {
                self.report(repeated("share of", row, first.span));
                found.push(None);
                continue;
            }
            let index = self.named(draft, "row of chutes", row, names.clone());
            let share = self.bounded_constant(&placed.env, share, Dimension::NONE, "the share of a row", PART);
            found.push(index.zip(share.map(|share| share.value)));
        }
        let found = found.into_iter().collect::<Option<Vec<(usize, f64)>>>()?;
        if !found.is_empty() && found.iter().all(|(_, share)| *share == 0.0) {
            let message = format!("the items of {of} go nowhere");
            let diagnostic = Diagnostic::new(Code::E0306, message, placed.span, "all shares are 0");
            self.report(diagnostic.help("give a row of chutes a share above 0"));
            return None;
        }
        Some(found)
    }

    /// Index of a name among those of its kind.
    fn named<'n>(
        &self,
        draft: &Draft<'t>,
        what: &str,
        name: &Name,
        names: impl Iterator<Item = &'n str> + Clone,
    ) -> Option<usize> {
        let found = names.clone().position(|known| known == name.text);
        if found.is_none() && draft.base_known && !mentions(&draft.bad, &name.text) {
            let message = format!("there is no {what} `{}`", name.text);
            let diagnostic = Diagnostic::new(Code::E0218, message, name.span, format!("not {}", with_article(what)));
            self.report(self.with_nearest(diagnostic, name, names));
        }
        found
    }
}
