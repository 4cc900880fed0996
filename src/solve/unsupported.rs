//! What the language has and `build` cannot yet do: nothing of it is silently ignored.

use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Track, self_crossings};
use crate::model::{Goal, Layout, Side};
use crate::solve::MOST_OPEN;
use crate::solve::budget::Budget;
use crate::solve::polygon::Smooth;
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
    let smooth = Smooth::is_known(objective);
    let wants = |goal: Goal| objective.terms.iter().any(|(_, g)| *g == goal);
    if smooth || Budget::of(objective).is_some() {
        // Polygon action, alone, within a budget of length or summed with it; length and cost within each other's.
    } else if objective.within.is_some() {
        let instead = "write `optimise polygon_action within length`, or limit `length` and `cost` by each other";
        say(written, "this goal within a budget", instead);
    } else if wants(Goal::Cost) && wants(Goal::PolygonAction) {
        say(written, "this weighted sum of goals", "sum `length` with either of the others");
    }
    // Every combination of sides is solved, but for polygon action.
    let open = if smooth { 0 } else { MOST_OPEN };
    for obstacle in layout.obstacles.iter().filter(|o| o.side == Side::Either).skip(open) {
        let what = match smooth {
            true => format!("`pass {} either` under `polygon_action`", obstacle.name),
            false => format!("`pass {} either` beside {MOST_OPEN} others", obstacle.name),
        };
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
    found.sort_by_key(|d| d.label.span);
    found
}
