//! Declared kinds of equipment, and what stands along the track of them.

use super::{Printer, metres, number, point, section_text, unit};
use crate::model::{Declared, EquipmentKind, EquipmentType, Layout, PlaceRow, Stands, StraightPlace};

/// Every kind that a layout uses, under a name of its own.
fn kinds(layout: &Layout) -> Vec<(String, &EquipmentType)> {
    let mut kinds: Vec<(String, &EquipmentType)> = Vec::new();
    for of in layout.equipment.declared.iter().map(|declared| &declared.of) {
        if kinds.iter().any(|(_, known)| *known == of) {
            continue;
        }
        let like = kinds.iter().filter(|(_, known)| known.name == of.name).count();
        let name = if like == 0 { of.name.clone() } else { format!("{}_{}", of.name, like + 1) };
        kinds.push((name, of));
    }
    kinds
}

impl Printer {
    /// The declarations.
    pub fn kinds(&mut self, layout: &Layout) {
        for (name, of) in kinds(layout) {
            self.block(format!("equipment {name}"), |out| {
                out.field("kind", of.kind.word());
                out.field("stretch", metres(of.stretch));
                out.field("depth", metres(of.depth));
                out.field("side", of.side.word());
                out.field("from_curve", metres(of.from_curve));
                out.field("aisle", metres(of.aisle));
                out.field("service", metres(of.service));
                out.field("conveyor", unit(of.conveyor, "EUR/m"));
                out.article(&of.article);
            });
            self.text.push('\n');
        }
    }

    /// The statements.
    pub fn declared(&mut self, layout: &Layout) {
        let kinds = kinds(layout);
        for declared in &layout.equipment.declared {
            let of = kinds.iter().find(|(_, kind)| **kind == declared.of).map_or("", |(name, _)| name);
            self.line(statement(layout, declared, of));
        }
    }
}

fn statement(layout: &Layout, declared: &Declared, of: &str) -> String {
    let names: Vec<&str> = layout.vertices.iter().map(|v| v.name.as_str()).collect();
    let word = if declared.of.kind == EquipmentKind::Chute { "chutes" } else { declared.of.kind.word() };
    let stands = match &declared.stands {
        Stands::At(StraightPlace { section, at, .. }) => {
            format!("on {} at {}", section_text(*section, &names), metres(*at))
        }
        Stands::Row(PlaceRow { place, every, count }) => {
            let section = section_text(place.section, &names);
            format!("on {section} from {} every {} count {count}", metres(place.at), metres(*every))
        }
        Stands::Free { count, on, after, before } => {
            let least = match declared.of.kind == EquipmentKind::Chute || *count > 1 {
                true => format!("at least {} ", number(*count as f64)),
                false => String::new(),
            };
            let sections: Vec<String> = on.iter().map(|section| section_text(*section, &names)).collect();
            let on = if on.is_empty() { "anywhere".to_owned() } else { format!("on {}", sections.join(", ")) };
            format!("{least}{on}{}{}", list_of(" after ", after), list_of(" before ", before))
        }
    };
    let fed = declared.fed.map_or_else(String::new, |p| format!(" fed from {}", point(p)));
    format!("{word} {} of {of} {stands}{fed}", declared.name)
}

/// ` after west, east`; nothing without names.
fn list_of(word: &str, names: &[String]) -> String {
    if names.is_empty() { String::new() } else { format!("{word}{}", names.join(", ")) }
}
