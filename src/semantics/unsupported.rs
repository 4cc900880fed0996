//! What the language has and `build` cannot yet do: nothing of it is silently ignored.

use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Goal, Layout, Side};
use crate::solve::MOST_OPEN;
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
    if objective.within.is_some() {
        say(written, "a goal within a budget", "write `optimise length`");
    } else if objective.terms.len() > 1 {
        say(written, "a weighted sum of goals", "write `optimise length`");
    } else {
        match objective.terms.first() {
            Some((_, Goal::Cost)) => say(written, "`optimise cost`", "write `optimise length`"),
            Some((_, Goal::PolygonAction)) => say(written, "`optimise polygon_action`", "write `optimise length`"),
            Some((_, Goal::Length)) | None => {}
        }
    }
    // Every combination of sides is solved.
    for obstacle in layout.obstacles.iter().filter(|o| o.side == Side::Either).skip(MOST_OPEN) {
        let what = format!("`pass {} either` beside {MOST_OPEN} others", obstacle.name);
        say(obstacle.pass.unwrap_or(obstacle.span), &what, "choose `left` or `right`");
    }
    if !layout.objective.terms.is_empty() {
        for level in &layout.levels {
            say(
                level.span,
                "optimising a layout with levels",
                "write `optimise nothing`: the layout is then built as written",
            );
        }
    }
    found.sort_by_key(|d| d.label.span);
    found
}
