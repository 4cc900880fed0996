//! Where equipment stands in two layouts: inductions, rows of chutes, scanners, gates and lifts.

use super::{TOLD, paired};
use crate::base::number::tidy;
use crate::base::trig;
use crate::compiled::Compiled;
use crate::model::{EquipmentKind, SCANNERS, StraightPlace};
use schemars::JsonSchema;
use serde::Serialize;

/// Equipment of one name that moved, changed, came or went.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EquipmentChange {
    /// As the layout calls it; `scanners` are those that a layout places without a name.
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub before: Option<Standing>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub after: Option<Standing>,
    /// How far the one of them that moved most did so, where both have as many, m.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub moved_m: Option<f64>,
}

/// How equipment of one name stands.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Standing {
    /// `induction`, `chute`, `scanner`, `gate` or `lift`.
    pub kind: &'static str,
    /// The declared kind, `chute_narrow`; absent where the layout places it without one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub of: Option<String>,
    /// The middle of each on the centre line, [x, y], m, in driving order.
    pub places_m: Vec<[f64; 2]>,
    /// The side of the track on which each stands, of travel: 1 left, -1 right, 0 both; absent without a declared kind.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub sides: Vec<i8>,
}

/// What stands elsewhere, in the order of the second.
pub fn changed(before: &Compiled, after: &Compiled) -> Vec<EquipmentChange> {
    paired(&standing(before), &standing(after))
        .into_iter()
        .filter_map(|(name, before, after)| {
            let moved_m = before.as_ref().zip(after.as_ref()).and_then(|(a, b)| farthest(a, b));
            let is_same = before.as_ref().zip(after.as_ref()).is_some_and(|(a, b)| {
                (a.kind, &a.of, &a.sides) == (b.kind, &b.of, &b.sides) && moved_m.is_some_and(|m| m < TOLD)
            });
            (!is_same).then_some(EquipmentChange { name, before, after, moved_m })
        })
        .collect()
}

/// m; `None` where one of them has more.
fn farthest(before: &Standing, after: &Standing) -> Option<f64> {
    let pairs = before.places_m.iter().zip(&after.places_m);
    let moved = pairs.map(|(a, b)| trig::hypot(a[0] - b[0], a[1] - b[1])).fold(0.0, f64::max);
    (before.places_m.len() == after.places_m.len()).then_some(tidy(moved))
}

fn standing(compiled: &Compiled) -> Vec<(String, Standing)> {
    let (layout, placed) = (&compiled.layout, &compiled.placement.placed);
    let equipment = &layout.equipment;
    let at = |place: StraightPlace| {
        let point = compiled.station(place).point;
        [tidy(point.x), tidy(point.y)]
    };
    let plain = |kind: EquipmentKind, places_m: Vec<[f64; 2]>| Standing {
        kind: kind.word(),
        of: None,
        places_m,
        sides: Vec::new(),
    };
    let own = |name: &str| equipment.declared.iter().all(|declared| declared.name != name);
    let mut all = Vec::new();
    for induction in equipment.inductions.iter().filter(|i| own(&i.name)) {
        all.push((induction.name.clone(), plain(EquipmentKind::Induction, vec![at(induction.place)])));
    }
    for chutes in equipment.chutes.iter().filter(|c| own(&c.name)) {
        let places = chutes.rows().flat_map(|row| row.places()).map(at).collect();
        all.push((chutes.name.clone(), plain(EquipmentKind::Chute, places)));
    }
    let scanners: Vec<_> = layout.own_scanners().map(at).collect();
    if !scanners.is_empty() {
        all.push((SCANNERS.to_owned(), plain(EquipmentKind::Scanner, scanners)));
    }
    for (i, declared) in equipment.declared.iter().enumerate() {
        let placed: Vec<_> = placed.iter().filter(|p| p.declared == i).collect();
        let places_m = placed.iter().map(|p| at(p.place)).collect();
        let sides = placed.iter().map(|p| p.sides.iter().map(|side| *side as i8).sum()).collect();
        let of = Some(declared.of.name.clone());
        all.push((declared.name.clone(), Standing { kind: declared.of.kind.word(), of, places_m, sides }));
    }
    all
}
