//! What there is to say of a solved layout, beyond what checking said of the written one.

use super::Compiled;
use crate::diagnostic::Diagnostic;
use crate::{capacity, elements, placement, solve};

impl Compiled {
    /// Adds to what was said before: why no layout meets the constraints, and [what is built](Self::tell_of_result).
    pub fn tell(&self, said: &mut Vec<Diagnostic>) {
        said.extend(solve::diagnose(&self.layout, &self.stages));
        self.tell_of_result(said);
    }

    /// Adds what there is to say of chain, capacity, heights and elements. Where heights cannot be built, they are the last
    /// that is said.
    pub fn tell_of_result(&self, said: &mut Vec<Diagnostic>) {
        if !self.failed() {
            let unclosed = solve::unclosed(&self.layout, &self.track, &self.space.line);
            said.extend(unclosed.or_else(|| self.loose()));
            // What lacks its place has no capacity either.
            match self.placement.is_whole() {
                true => {
                    said.extend(self.without_room().into_iter().chain(self.short_of_capacity()));
                    said.extend(placement::conveyors(&self.layout, &self.track, &self.placement));
                }
                false => said.extend(self.without_room()),
            }
        }
        said.extend(self.heights.iter().cloned());
        // Nobody orders a layout that is not feasible.
        if self.failed() || self.heights.iter().any(Diagnostic::is_error) {
            return;
        }
        // What checking said about a written value need not be said again about its element.
        let new = |d: &Diagnostic| !said.iter().any(|s| s.label.span == d.label.span && !s.is_error());
        let lacking: Vec<Diagnostic> =
            elements::lacking(&self.sequence, &self.layout).into_iter().filter(new).collect();
        said.extend(lacking);
    }

    /// The warning where the chain leaves more over than the take-up compensates.
    pub fn loose(&self) -> Option<Diagnostic> {
        solve::left_over(&self.layout, &self.track, &self.space.line, self.chain)
    }

    /// The errors of equipment that finds no room.
    pub fn without_room(&self) -> Vec<Diagnostic> {
        placement::findings(&self.layout, &self.track)
    }

    /// The error where the sorter does not reach the capacity that the layout requires.
    pub fn short_of_capacity(&self) -> Option<Diagnostic> {
        let required = self.layout.capacity.required.as_ref()?;
        let mut said = capacity::reached(self.sorter().as_ref(), required)?;
        if let (Some(help), Some(order)) = (&mut said.help, self.enough_in_order(required.least.value)) {
            *help = format!("{help}; or {order}");
        }
        Some(said)
    }
}
