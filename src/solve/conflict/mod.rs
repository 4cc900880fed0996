//! Why no layout meets the constraints, and which of them say nothing: answers in lines of source.
//!
//! Everything here is local: a set of lines is in conflict when the solver finds no layout that meets it from any of a
//! few starts, and a line follows from others when it cannot break it from any of them.

mod implied;
mod lines;
mod search;
mod words;

pub use implied::implied;

use crate::diagnostic::{Code, Diagnostic};
use crate::model::Layout;
use crate::problem::measures::to_variables;
use crate::problem::{Problem, Scope};
use crate::solve::Stage;
use lines::Lines;
use search::Search;

/// The lines that no layout meets together, each with what it would have to give way by; `None` where they are not found.
pub fn conflict(layout: &Layout, failed: &Stage) -> Option<Diagnostic> {
    let scope = if failed.name == "stage1" { Scope::Building } else { Scope::Obstacles };
    let problem = Problem::new(layout, scope);
    let lines = Lines::new(layout, &problem);
    let conflict = Search::new(layout, &problem, &lines, &to_variables(&failed.corners)).conflict()?;
    let mut said: Vec<_> = conflict
        .set
        .iter()
        .zip(&conflict.alone)
        .map(|(&i, alone)| (lines.list[i].span, words::alone(layout, &lines, &lines.list[i], *alone)))
        .collect();
    // The user's last word is the place to look at first.
    let (span, label) = said.last().cloned()?;
    said.sort_by_key(|(span, _)| (span.file.0, span.start));
    let message = match said.len() {
        1 => "no layout meets this line within what the catalogue offers".to_owned(),
        2 => "no layout meets these two lines together".to_owned(),
        n => format!("no layout meets these {n} lines together"),
    };
    let mut diagnostic = Diagnostic::new(Code::E0601, message, span, label);
    for (span, label) in &said {
        diagnostic = diagnostic.related(*span, label.clone());
    }
    let help = match said.len() {
        1 => "change it; the best layout found is written, marked NOT FEASIBLE".to_owned(),
        _ => format!(
            "{}; all of them together would have to give way by {} each. The best layout found is written, marked NOT \
             FEASIBLE",
            match conflict.confirmed {
                true => "without any one of them the others hold, within what the catalogue offers",
                false => "fewer of them may be in conflict already: the search ended before that was known",
            },
            words::metres(conflict.apart)
        ),
    };
    Some(diagnostic.help(help))
}
