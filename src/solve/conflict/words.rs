//! What a conflict is called, and what its lines would have to give way by, in words.

use super::lines::LineKind;
use super::{Assumed, Conflict, Decides, Member, Pieces, Proof, Within};
use crate::base::number::trimmed;
use crate::base::trig::PI;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Side, Unit};
use crate::problem::LEVER;

/// An amount as a message says it.
#[derive(Clone, Debug)]
pub struct Stated {
    /// What the words say, m, angles by [`LEVER`].
    pub slack: f64,
    pub text: String,
}

/// What rounding may leave out because limits hold to more than that, in a thousandth of the unit.
const HELD: f64 = 0.01;

/// An amount rounded up to three decimals of its unit, and a thousandth more for each of `more`: `5.193 m`, `0.21 mm`,
/// `5°`.
pub fn stated(unit: Unit, slack: f64, more: u32) -> Stated {
    let (scale, name) = match unit {
        Unit::Metre if slack < 0.01 => (1e3, " mm"),
        Unit::Metre => (1.0, " m"),
        Unit::Radian => (180.0 / PI / LEVER, "°"),
        Unit::SquareMetre => (1.0, " m²"),
        Unit::One | Unit::Other => (1.0, ""),
    };
    let value = ((slack * scale * 1e3 - HELD).ceil().max(0.0) + f64::from(more)) / 1e3;
    Stated { slack: value / scale, text: format!("{}{name}", trimmed(value, 3)) }
}

/// The message of a conflict.
pub fn diagnostic(conflict: &Conflict) -> Diagnostic {
    let members = &conflict.members;
    let proven = matches!(conflict.proof, Proof::Bounds | Proof::Grid);
    let these = match members.len() {
        0 => "what the catalogue offers with these vertices".to_owned(),
        1 => "this line within what the catalogue offers".to_owned(),
        2 => "these two lines together".to_owned(),
        n => format!("these {n} lines together"),
    };
    let grid = if conflict.on_grid { " on the catalogue's grid" } else { "" };
    let message = match proven {
        true => format!("no layout{grid} meets {these}"),
        false => format!("no layout was found{grid} that meets {these}"),
    };
    // The user's last word is the place to look at first.
    let last = (0..members.len()).max_by_key(|&i| (members[i].kind, i));
    let (span, label) = match last {
        Some(last) => (members[last].span, label(&members[last], conflict.on_grid)),
        None => (conflict.span, "more turns or fewer are needed, or more room between them".to_owned()),
    };
    let mut diagnostic = Diagnostic::new(Code::E0601, message, span, label);
    for member in members {
        diagnostic = diagnostic.related(member.span, self::label(member, conflict.on_grid));
    }
    diagnostic.help(help(conflict))
}

/// What is said at a member's line.
fn label(member: &Member, on_grid: bool) -> String {
    let assumed = match &member.assumed {
        None => String::new(),
        Some(Assumed { side, by, .. }) => {
            let side = if *side == Side::Right { "right" } else { "left" };
            let by = match by {
                Decides::Pass => "as `pass` says",
                Decides::Written => "as the written vertices have it",
                Decides::Neither => "and no layout was found with it on the other side",
            };
            format!("taken to lie to the {side} of travel, {by}: ")
        }
    };
    let Some(relaxed) = &member.relaxed else {
        return assumed
            + match (&member.without, member.within) {
                (None, _) => "no layout was found without this line",
                (Some(_), _) if member.kind == LineKind::Obstacle => {
                    "no smaller clearance was found that would do: it has to be smaller, or elsewhere"
                }
                (Some(_), Within::Layout) => "no change of this line alone was found that would do",
                (Some(_), Within::Members) => {
                    "left out, it leaves a further conflict; how far it must give way was not found"
                }
            };
    };
    let by = &relaxed.text;
    let would_do = match member.kind {
        LineKind::Turns => format!("turns {by} beyond these limits"),
        LineKind::Radii => format!("radii {by} beyond these limits"),
        LineKind::Building => format!("walls {by} further out"),
        LineKind::Obstacle => format!("{by} closer"),
        LineKind::Room => match member.pieces.and_then(|pieces| left(pieces, relaxed.amount)) {
            Some(words) => format!("{words}, {by} less,"),
            None => format!("{by} less room"),
        },
        LineKind::Fix => format!("{by} off its written place"),
        LineKind::Require => match member.lower {
            Some(true) => format!("{by} less"),
            Some(false) => format!("{by} more"),
            None => format!("{by} off"),
        },
    };
    let whole = match member.within {
        Within::Layout => "",
        Within::Members => " for these lines alone",
    };
    let smaller = match &member.assumed {
        Some(assumed) if relaxed.amount > assumed.clearance => ", which is more than its clearance",
        _ => "",
    };
    let grid = match &member.on_grid {
        _ if on_grid => String::new(),
        Some(grid) if grid.text == *by => "; on the catalogue's grid, too".to_owned(),
        Some(grid) => format!("; on the catalogue's grid, {} would", grid.text),
        None => "; for the catalogue's grid it is not known".to_owned(),
    };
    format!("{assumed}{would_do} would do{whole}{smaller}{grid}")
}

/// How many pieces there is about room for where their straights may be shorter by so many metres.
fn left(pieces: Pieces, metres: f64) -> Option<String> {
    let fewer = (metres / pieces.pitch - 1e-6).ceil().max(1.0) as usize;
    let left = pieces.count.checked_sub(fewer).filter(|left| *left > 0)?;
    Some(format!("room for about {left} of {}", pieces.count))
}

fn help(conflict: &Conflict) -> String {
    let mut said: Vec<String> = Vec::new();
    said.push(match &conflict.proof {
        Proof::Bounds => "this is proven, for turns that go the way they are written and as often around".to_owned(),
        Proof::Grid => {
            "this is proven by the search over the catalogue's grid, for turns that go the way they are written \
                        and as often around"
                .to_owned()
        }
        Proof::GridOfAll => {
            "that the whole layout has none on the grid is proven; for these lines alone none was found, \
                             which is no proof"
                .to_owned()
        }
        Proof::NotFound if conflict.starts == 0 => "the search ended early, which is no proof of anything".to_owned(),
        Proof::NotFound if conflict.on_grid => {
            "no layout was found on the grid from the continuous one; that is no proof that there is none".to_owned()
        }
        Proof::NotFound => {
            format!("no layout was found from {} starts; that is no proof that there is none", conflict.starts)
        }
    });
    said.extend(alternatives(conflict));
    if let Some(together) = conflict.together.as_ref().filter(|_| conflict.members.len() > 1) {
        said.push(format!("all of them together would have to give way by {} each", together.text));
    }
    let amounts = conflict.members.iter().any(|m| m.relaxed.is_some());
    if amounts && !conflict.on_grid {
        said.push(
            "amounts are enough, not proven to be the least, and are for any turn and radius where the grid is not named"
                .to_owned(),
        );
    }
    for assumed in conflict.members.iter().filter_map(|m| m.assumed.as_ref()).filter(|a| a.by != Decides::Neither) {
        let (name, other) = (&assumed.name, if assumed.side == Side::Right { "left" } else { "right" });
        said.push(format!(
            "`pass {name} {other}` takes `{name}` to lie on the other side, `pass {name} either` tries both"
        ));
    }
    said.push("the best layout found is written, marked NOT FEASIBLE".to_owned());
    said.join("\n")
}

/// What holds without a member.
fn alternatives(conflict: &Conflict) -> Option<String> {
    let members = &conflict.members;
    let whole = |m: &Member| m.without.is_some() && m.within == Within::Layout;
    let known = |m: &Member| m.without.is_some();
    match members.len() {
        0 => None,
        1 if members.iter().all(whole) => Some("without it a layout was found that meets all other lines".to_owned()),
        _ if members.iter().all(whole) => {
            Some("without any one of them a layout was found that meets all other lines".to_owned())
        }
        _ if members.iter().all(known) => {
            let others = "without any one of them a layout was found that meets the others";
            let more = match members.iter().any(whole) {
                true => "the layout has a further conflict: what would do for these lines alone does not settle that",
                false => "the layout has a further conflict, so no change of a single line settles all of it",
            };
            Some(format!("{others}\n{more}"))
        }
        _ => {
            Some("fewer of them may be in conflict already: not for every one a layout was found without it".to_owned())
        }
    }
}
