//! `after the last induction of each zone`: one piece of equipment for each zone of inductions and chutes.
//!
//! A zone is one or several inductions and the rows of chutes behind them: of each row, what comes before it without
//! another row between. What comes before what is told by `after` and `before`, and by places that the layout gives,
//! from its `start` on.

use super::draft::Draft;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Declared, Equipment, EquipmentKind, Stands, StraightPlace};
use crate::semantics::scope::Context;
use crate::source::Span;
use crate::syntax::tree::{After, EquippedPlace, Statement};
use std::collections::{BTreeMap, BTreeSet};

/// Names of inductions, and of the rows of chutes that their items go to first.
type Zone<'e> = (BTreeSet<&'e str>, Vec<&'e str>);

impl<'t> Context<'t> {
    /// Puts one piece for each zone in the place of what is asked for in each; `None` is a mistake. The loop has so many
    /// sections.
    pub(super) fn fill_zones(&self, draft: &Draft<'t>, equipment: &mut Equipment, sections: usize) -> Option<()> {
        let asked: BTreeMap<&str, Span> =
            draft.statements.iter().filter_map(|placed| asked(placed.statement)).collect();
        if asked.is_empty() {
            return Some(());
        }
        let known = equipment.clone();
        let zones = zones(&known, sections);
        let mut sound = true;
        let mut declared = Vec::new();
        for one in equipment.declared.drain(..) {
            let Some(span) = asked.get(one.name.as_str()) else {
                declared.push(one);
                continue;
            };
            match self.in_each(&one, *span, &zones, &known) {
                Some(pieces) => declared.extend(pieces),
                None => sound = false,
            }
        }
        equipment.declared = declared;
        sound.then_some(())
    }

    fn in_each(&self, one: &Declared, span: Span, zones: &[Zone], known: &Equipment) -> Option<Vec<Declared>> {
        let kind = one.of.kind;
        if matches!(kind, EquipmentKind::Induction | EquipmentKind::Chute) {
            let message = format!("`{}` is itself of a zone", one.name);
            self.report(
                Diagnostic::new(Code::E0502, message, span, "zones are told by inductions and chutes")
                    .help("say after what it comes: `after west`"),
            );
            return None;
        }
        if zones.is_empty() {
            let message = "no row of chutes comes after an induction, so that there are no zones";
            let help = "say which inductions a row comes after, with a line such as \
                        `chutes row of chute at least 20 anywhere after west`";
            self.report(Diagnostic::new(Code::E0214, message, span, "after which one?").help(help));
            return None;
        }
        let taken: BTreeSet<&str> = known.all_names().collect();
        let mut pieces = Vec::new();
        for (number, (inductions, rows)) in zones.iter().enumerate() {
            let mut piece = one.clone();
            if zones.len() > 1 {
                piece.name = format!("{}_{}", one.name, number + 1);
            }
            if zones.len() > 1 && taken.contains(piece.name.as_str()) {
                let message = format!("`{}` would be the name of two", piece.name);
                self.report(
                    Diagnostic::new(Code::E0212, message, one.span, "its pieces are numbered")
                        .help("give it or the other one another name"),
                );
                return None;
            }
            if let Stands::Free { on, after, before, .. } = &mut piece.stands {
                // Between what stands on one straight it stands there, too.
                if on.is_empty() {
                    on.extend(common_section(known, inductions.iter().chain(rows)));
                }
                after.extend(inductions.iter().map(|name| (*name).to_owned()));
                let more: Vec<String> = rows.iter().map(|name| (*name).to_owned()).collect();
                before.extend(more.into_iter().filter(|name| !known_before(one, name)));
            }
            pieces.push(piece);
        }
        Some(pieces)
    }
}

/// Whether it comes before another anyway.
fn known_before(one: &Declared, name: &str) -> bool {
    matches!(&one.stands, Stands::Free { before, .. } if before.iter().any(|known| known == name))
}

/// The section that all of these stand on, where the loop does not begin within it.
fn common_section<'e>(equipment: &Equipment, names: impl Iterator<Item = &'e &'e str>) -> Option<usize> {
    let mut found: Option<usize> = None;
    for name in names {
        let own = section_of(equipment, name)?;
        if found.is_some_and(|found| found != own) {
            return None;
        }
        found = Some(own);
    }
    let starts_within = |section: &usize| equipment.start.is_some_and(|s| s.section == *section && s.at > 0.0);
    found.filter(|section| !starts_within(section))
}

/// The only section that something may stand on.
fn section_of(equipment: &Equipment, name: &str) -> Option<usize> {
    let induction = equipment.inductions.iter().find(|induction| induction.name == name).map(|i| i.place.section);
    let row = || equipment.chutes.iter().find(|chutes| chutes.name == name).map(|chutes| chutes.row.place.section);
    let declared = || match &equipment.declared.iter().find(|declared| declared.name == name)?.stands {
        Stands::At(place) => Some(place.section),
        Stands::Row(row) => Some(row.place.section),
        Stands::Free { on, .. } => on.first().copied().filter(|_| on.len() == 1),
    };
    induction.or_else(row).or_else(declared)
}

/// The name of what a statement places in each zone, and where it says so.
fn asked(statement: &Statement) -> Option<(&str, Span)> {
    let Statement::Equipped(equipped) = statement else { return None };
    match &equipped.place {
        EquippedPlace::Free { after: After::EachZone(span), .. } => Some((&equipped.name.text, *span)),
        _ => None,
    }
}

/// In the order in which their first rows are written.
fn zones(equipment: &Equipment, sections: usize) -> Vec<Zone<'_>> {
    let earlier = earlier(equipment, sections);
    let before = |a: &str, b: &str| earlier.get(b).is_some_and(|all| all.contains(a));
    let (inductions, rows) = (equipment.names(EquipmentKind::Induction), equipment.names(EquipmentKind::Chute));
    let mut zones: Vec<Zone> = Vec::new();
    for row in &rows {
        let next = |induction: &&str| {
            before(induction, row) && !rows.iter().any(|other| before(induction, other) && before(other, row))
        };
        let own: BTreeSet<&str> = inductions.iter().copied().filter(next).collect();
        match zones.iter_mut().find(|(of, _)| *of == own) {
            Some((_, rows)) => rows.push(row),
            None if own.is_empty() => {}
            None => zones.push((own, vec![row])),
        }
    }
    zones
}

/// What comes before each piece or row, by name.
fn earlier(equipment: &Equipment, sections: usize) -> BTreeMap<&str, BTreeSet<&str>> {
    let mut earlier: BTreeMap<&str, BTreeSet<&str>> =
        equipment.all_names().map(|name| (name, BTreeSet::new())).collect();
    let mut add = |a: &'_ str, b: &'_ str| {
        let known = equipment.all_names().find(|name| *name == a).zip(equipment.all_names().find(|name| *name == b));
        if let Some((a, b)) = known {
            earlier.entry(b).or_default().insert(a);
        }
    };
    for declared in &equipment.declared {
        if let Stands::Free { after, before, .. } = &declared.stands {
            after.iter().for_each(|name| add(name, &declared.name));
            before.iter().for_each(|name| add(&declared.name, name));
        }
    }
    let given = given(equipment, sections);
    for (a, (_, end)) in &given {
        for (b, (begin, _)) in &given {
            if end < begin {
                add(a, b);
            }
        }
    }
    // What comes before that, too, until nothing is added.
    loop {
        let more: Vec<(&str, &str)> = earlier
            .iter()
            .flat_map(|(name, all)| all.iter().map(move |a| (*name, *a)))
            .flat_map(|(name, a)| earlier.get(a).into_iter().flatten().map(move |first| (name, *first)))
            .filter(|(name, first)| name != first && !earlier.get(name).is_some_and(|all| all.contains(first)))
            .collect();
        if more.is_empty() {
            return earlier;
        }
        for (name, first) in more {
            earlier.entry(name).or_default().insert(first);
        }
    }
}

/// How far along the loop something is: sections passed since the start's, and m along the straight.
type Along = (usize, f64);

/// Where what has places in the layout begins and ends.
fn given(equipment: &Equipment, sections: usize) -> Vec<(&str, (Along, Along))> {
    // Without vertices, as of a route or with a mistake in them, nothing is known of places.
    if sections == 0 {
        return Vec::new();
    }
    let start = equipment.start.map_or((0, 0.0), |start| (start.section, start.at));
    let along = |place: StraightPlace| match place.section == start.0 && place.at < start.1 {
        true => (sections, place.at),
        false => ((place.section + sections - start.0) % sections, place.at),
    };
    let range = |places: Vec<StraightPlace>| {
        let all: Vec<Along> = places.into_iter().map(along).collect();
        let (first, last) = (all.iter().copied(), all.iter().copied());
        let less = |a: &Along, b: &Along| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
        first.min_by(less).zip(last.max_by(less))
    };
    let inductions = equipment.inductions.iter().map(|induction| (induction.name.as_str(), vec![induction.place]));
    let rows = equipment
        .chutes
        .iter()
        .map(|chutes| (chutes.name.as_str(), chutes.rows().flat_map(|row| row.places().collect::<Vec<_>>()).collect()));
    let declared = equipment.declared.iter().map(|declared| (declared.name.as_str(), declared.given()));
    inductions.chain(rows).chain(declared).filter_map(|(name, places)| Some((name, range(places)?))).collect()
}
