//! Scanners, feeds, storages, items, stops, and the capacity that is asked for.

use super::draft::{Draft, Placed};
use super::vertices::Geometry;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Capacity, Equipment, EquipmentKind, Feed, Items, RequiredCapacity, Stops, Storage};
use crate::semantics::dimension::Dimension;
use crate::semantics::fields::Bounds;
use crate::semantics::program::mentions;
use crate::semantics::scope::Context;
use crate::source::Spanned;
use crate::syntax::tree::{Expr, Name, Statement};

/// Items an hour.
const RATE: Bounds = Bounds::above(0.0, 1e6);
/// A share that may be nothing, and one that may be all.
const SHARE: Bounds = Bounds::between(0.0, 0.99);
const USED: Bounds = Bounds::above(0.0, 1.0);
/// s
const TIME: Bounds = Bounds::above(0.0, 1e7);

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
        sound.then_some(capacity)
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
            Statement::Feed { induction, rate: comes, most, efficiency } => {
                let names = equipment.names(EquipmentKind::Induction).into_iter();
                let index = self.named(draft, "induction", induction, names);
                let rate_of = rate(comes, "the number of items an hour");
                let most = rate(most, "the most items an hour");
                let efficiency = share(efficiency, "the efficiency", USED, 1.0);
                let (rate, most, efficiency, span) = (rate_of?, most?, efficiency?, placed.span);
                capacity.feeds.push(Feed { induction: index?, rate, most, efficiency, span });
            }
            Statement::Storage { chutes, count, every } => {
                let names = equipment.names(EquipmentKind::Chute).into_iter();
                let index = self.named(draft, "row of chutes", chutes, names);
                let count = self.count(&placed.env, count, "the number of items", 1);
                let every = number(every, "the time for an item", Dimension::TIME, TIME);
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
            Statement::RequireCapacity { least, reason } => {
                let value = number(least, "the capacity", Dimension::NONE, RATE)?;
                let least = Spanned::new(value, placed.span);
                capacity.required = Some(RequiredCapacity { least, reason: reason.clone() });
            }
            _ => {}
        }
        Some(())
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
            let diagnostic = Diagnostic::new(Code::E0218, message, name.span, format!("not a {what}"));
            self.report(self.with_nearest(diagnostic, name, names));
        }
        found
    }
}
