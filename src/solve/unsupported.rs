//! What the language has and `build` cannot yet do: nothing of it is silently ignored.

use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Track, self_crossings};
use crate::model::{EquipmentKind, Layout, Side};
use crate::solve::MOST_OPEN;
use crate::solve::budget::Budget;
use crate::solve::polygon::{Smooth, Traded};
use crate::source::Span;

/// One diagnostic for each part of a checked layout that cannot be built yet.
pub fn unsupported(layout: &Layout) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut say = |span: Span, what: &str, instead: &str| {
        let message = format!("{what} is checked, but not built yet");
        found.push(
            Diagnostic::new(Code::E0650, message, span, "not built yet")
                .help(format!("to build now, {instead}; `lss check` accepts it as it is")),
        );
    };
    let objective = &layout.objective;
    let written = objective.span.unwrap_or(layout.span);
    let smooth = Smooth::is_known(objective) || Traded::of(objective).is_some();
    if objective.within.is_some() && !smooth && Budget::of(objective).is_none() {
        say(
            written,
            "a goal within a budget of itself",
            "limit another goal, as `optimise polygon_action within length`",
        );
    }
    // Every combination of sides is solved.
    for obstacle in layout.obstacles.iter().filter(|o| o.side == Side::Either).skip(MOST_OPEN) {
        let what = format!("`pass {} either` beside {MOST_OPEN} others", obstacle.name);
        say(obstacle.pass.unwrap_or(obstacle.span), &what, "choose `left` or `right`");
    }
    if smooth && !layout.is_flat() {
        for level in &layout.levels {
            say(level.span, "polygon action on different heights", "write `optimise length`");
        }
    }
    // A loop that crosses itself has no inside, by which walls and obstacles lie on a side of it.
    let kept_clear = layout.obstacles.iter().map(|o| o.span).chain(layout.building.iter().map(|b| b.span)).min();
    if let (false, false, Some(span)) = (layout.objective.terms.is_empty(), layout.levels.is_empty(), kept_clear)
        && !self_crossings(&Track::new(&layout.corners())).is_empty()
    {
        let what = "optimising a loop that crosses itself around obstacles or within a building";
        say(span, what, "write `optimise nothing`: the layout is then built as written");
    }
    for declared in layout.equipment.declared.iter().filter(|_| !layout.is_flat()) {
        let help = match declared.of.kind {
            EquipmentKind::Gate | EquipmentKind::Lift => "leave it out: it stands on layouts of one height",
            _ => "leave the kind out, and give its place",
        };
        say(declared.span, "equipment of a declared kind on different heights", help);
    }
    found.sort_by_key(|d| d.label.span);
    found
}
