//! Equipment of a declared kind: where it is given, and where it is free.

use super::draft::{Draft, Placed};
use super::vertices::Geometry;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Declared, Equipment, EquipmentKind, EquipmentType, Stands};
use crate::semantics::components;
use crate::semantics::program::mentions;
use crate::semantics::scope::Context;
use crate::syntax::tree::{DeclarationKind, EquippedExpr, EquippedPlace, Name, Statement, StationWord};
use std::collections::BTreeSet;

/// Most pieces of equipment that stand freely.
const MOST: usize = 400;

impl<'t> Context<'t> {
    /// What one statement places; `None` is a mistake.
    pub(super) fn equipped(
        &self,
        placed: &Placed<'t>,
        geometry: &Geometry<'t>,
        equipped: &'t EquippedExpr,
    ) -> Option<Declared> {
        let of = self.kind_of(placed, equipped);
        let stands = match &equipped.place {
            EquippedPlace::At(place) => self.along(placed, geometry, place).map(Stands::At),
            EquippedPlace::Row(row) => self.row_of(placed, geometry, row).map(Stands::Row),
            EquippedPlace::Free { least, on, after, before, .. } => {
                let count = match least {
                    None => Some(1),
                    Some(least) => self.count(&placed.env, least, "the number", 1),
                };
                let sections: Vec<_> = on.iter().map(|section| self.section(&geometry.named, section)).collect();
                let on = sections.into_iter().collect::<Option<Vec<usize>>>();
                let names = |names: &[Name]| names.iter().map(|name| name.text.clone()).collect();
                let (after, before) = (names(after.names()), names(before));
                count.zip(on).map(|(count, on)| Stands::Free { count, on, after, before })
            }
        };
        let fed = match &equipped.fed {
            None => Some(None),
            Some(point) => self.point(placed, point).map(Some),
        };
        let (of, stands, fed) = (of?, stands?, fed?);
        if let Stands::Free { count, .. } = &stands
            && *count > MOST
        {
            let message = format!("{count} are more than can be placed freely");
            self.report(
                Diagnostic::new(Code::E0306, message, placed.span, "too many")
                    .expected(format!("at most {MOST}"), count.to_string())
                    .help("give the places of some: `on P1..P2 from 2 m every 1.25 m count 12`"),
            );
            return None;
        }
        Some(Declared { name: equipped.name.text.clone(), of, stands, fed, span: placed.span })
    }

    /// The kind of equipment that a statement names, which has to be what the statement's word says.
    fn kind_of(&self, placed: &Placed<'t>, equipped: &'t EquippedExpr) -> Option<EquipmentType> {
        let component = self.component(&placed.env, DeclarationKind::Equipment, &equipped.of)?;
        let of = component.complete.then(|| components::equipment(&component))??;
        let wanted = match equipped.word {
            StationWord::Induction => EquipmentKind::Induction,
            StationWord::Chutes => EquipmentKind::Chute,
            StationWord::Scanner => EquipmentKind::Scanner,
            StationWord::Gate => EquipmentKind::Gate,
            StationWord::Lift => EquipmentKind::Lift,
        };
        if of.kind != wanted {
            let (wanted, found) = (wanted.word(), of.kind.word());
            let message = format!("`{}` is not a kind of {wanted}", of.name);
            self.report(
                Diagnostic::new(Code::E0304, message, equipped.of.span, format!("a kind of {found}"))
                    .expected(format!("a kind of equipment with `kind = {wanted}`"), format!("`kind = {found}`"))
                    .related(component.place("kind"), "declared here"),
            );
            return None;
        }
        Some(of)
    }

    /// Names in `after` and `before` have to stand along the track, and their order has to be possible.
    pub(super) fn check_order(&self, draft: &Draft<'t>, equipment: &Equipment) -> Option<()> {
        let all: Vec<&str> = equipment.all_names().collect();
        let mut sound = true;
        for placed in &draft.statements {
            let Statement::Equipped(equipped) = placed.statement else { continue };
            let EquippedPlace::Free { after, before, .. } = &equipped.place else { continue };
            for name in after.names().iter().chain(before) {
                if !all.contains(&name.text.as_str()) && draft.base_known && !mentions(&draft.bad, &name.text) {
                    let message = format!("nothing along the track is called `{}`", name.text);
                    let diagnostic = Diagnostic::new(Code::E0218, message, name.span, "not known here");
                    self.report(self.with_nearest(diagnostic, name, all.iter().copied()));
                    sound = false;
                }
            }
        }
        sound.then_some(())?;
        let mut order: BTreeSet<(&str, &str)> = BTreeSet::new();
        for declared in &equipment.declared {
            let Stands::Free { after, before, .. } = &declared.stands else { continue };
            order.extend(after.iter().map(|name| (name.as_str(), declared.name.as_str())));
            order.extend(before.iter().map(|name| (declared.name.as_str(), name.as_str())));
        }
        // What nothing has to come before is taken away until nothing is left, or only circles.
        let mut left: BTreeSet<&str> = all.iter().copied().collect();
        while let Some(first) = left.iter().copied().find(|b| !order.iter().any(|(a, c)| c == b && left.contains(a))) {
            left.remove(first);
        }
        let Some(of_circle) = equipment.declared.iter().find(|d| left.contains(d.name.as_str())) else {
            return Some(());
        };
        // Something has to come before each of what is left, so that the way back comes round.
        let before = |name: &str| order.iter().find(|(a, b)| *b == name && left.contains(a)).map(|(a, _)| *a);
        let mut way = vec![of_circle.name.as_str()];
        while let Some(next) = before(way[way.len() - 1]) {
            if let Some(from) = way.iter().position(|name| *name == next) {
                way.drain(..from);
                break;
            }
            way.push(next);
        }
        let of = |name: &str| equipment.declared.iter().find(|d| d.name == name);
        let after = |i: usize| format!("`{}` has to come after `{}`", way[i], way[(i + 1) % way.len()]);
        let known: Vec<(&Declared, String)> = (0..way.len()).filter_map(|i| Some((of(way[i])?, after(i)))).collect();
        let (first, words) = known.first()?;
        let message = format!("`{}` would have to come before itself", first.name);
        let diagnostic = Diagnostic::new(Code::E0502, message, first.span, words);
        let said = known.iter().fold(diagnostic, |said, (declared, words)| said.related(declared.span, words));
        self.report(said.help("leave out one of `after` and `before`"));
        None
    }
}
