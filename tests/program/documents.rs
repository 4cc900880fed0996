//! Tables in documents that are made from the program. `UPDATE_DOCS=1 cargo test --test program documents::` writes them anew.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::base::number::shortest;
use lss::gap::settings::{Setting, Settings};
use lss::model::effect_definitions::{EFFECTS, EffectDefinition, PlaceKind};
use std::fs;
use std::path::Path;

/// `gap`, 0 to 0.002 m: play from end to end
fn strengths(effect: &EffectDefinition) -> String {
    let all = effect.strengths.iter().map(|s| {
        let bounds = format!("{} to {} {}", shortest(s.low), shortest(s.high), s.unit);
        format!("`{}`, {}: {}", s.name, bounds.trim_end(), s.about)
    });
    all.collect::<Vec<_>>().join("; ")
}

/// `at` m: arc length
fn places(effect: &EffectDefinition) -> String {
    let all = effect.places.iter().map(|p| {
        let name = format!("`{}`", p.name);
        let kind = match p.kind {
            PlaceKind::Length => " m",
            PlaceKind::Time => " s",
            PlaceKind::ForceChannel => ", a force channel",
            PlaceKind::Number => "",
        };
        let about = if p.about.is_empty() { String::new() } else { format!(": {}", p.about) };
        let default =
            if p.kind == PlaceKind::ForceChannel { String::new() } else { format!(" ({})", shortest(p.default)) };
        format!("{name}{kind}{about}{default}")
    });
    all.collect::<Vec<_>>().join("; ")
}

#[test]
fn the_table_of_effects_is_the_library() {
    let mut table =
        "| effect | what it is | strengths | where, and what it is when not given |\n|---|---|---|---|\n".to_owned();
    for effect in EFFECTS {
        table += &format!("| `{}` | {} | {} | {} |\n", effect.name, effect.about, strengths(effect), places(effect));
    }
    hold("docs/gap-reference.md", "effects", &table);
}

#[test]
fn the_table_of_constants_is_that_of_the_diagnosis() {
    let mut table =
        "| constant | value | unit | what it does | origin | from where, or why |\n|---|---|---|---|---|---|\n"
            .to_owned();
    for Setting { group, name, value, unit, about, origin } in Settings::default().table() {
        let (kind, why) = (origin.name(), origin.why());
        table += &format!("| `{group}.{name}` | {value} | {unit} | {about} | {kind} | {why} |\n");
    }
    hold("docs/gap-settings.md", "settings", &table);
}

/// That what stands between the marks of a name is this.
fn hold(file: &str, name: &str, expected: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let text = fs::read_to_string(&path).expect("the document");
    let (begin, end) =
        (format!("<!-- {name}: made by a test from the program -->\n"), format!("<!-- end of {name} -->"));
    let (before, rest) = text.split_once(&begin).expect("a mark");
    let (found, after) = rest.split_once(&end).expect("a second mark");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, [before, &begin, expected, &end, after].concat()).expect("written");
        return;
    }
    assert!(found == expected, "{file} is out of date: UPDATE_DOCS=1 cargo test --test program documents::");
}
