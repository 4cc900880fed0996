//! What only drawings read: origin, grid axes, title block.

use std::collections::BTreeMap;

use super::draft::{Draft, Placed};
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Coordinate, DrawingSettings, GridAxis};
use crate::semantics::dimension::Dimension;
use crate::semantics::fields::{Bounds, COORDINATE};
use crate::semantics::scope::Context;
use crate::source::Span;
use crate::syntax::tree::{Axis, Expr, Statement, TextExpr, TitleField};

/// Most axes of a layout.
const MOST_AXES: usize = 500;
/// Letters of axes that are counted on: without I and O, which are taken for digits (as in ISO 5457).
const LETTERS: &[u8] = b"ABCDEFGHJKLMNPQRSTUVWXYZ";

impl<'t> Context<'t> {
    /// Origin, axes and title block, unless something of them has a mistake.
    pub(super) fn drawing(&self, draft: &Draft<'t>) -> Option<DrawingSettings> {
        let mut drawing = DrawingSettings::default();
        let mut names: BTreeMap<String, Span> = BTreeMap::new();
        let mut sound = true;
        for placed in &draft.statements {
            let done = match placed.statement {
                Statement::DrawingOrigin(point) => self.point(placed, point).map(|at| drawing.origin = at),
                Statement::DrawingField { field, text } => self.title_text(text).map(|text| {
                    let title = &mut drawing.title;
                    *match field {
                        TitleField::Project => &mut title.project,
                        TitleField::Number => &mut title.number,
                        TitleField::Revision => &mut title.revision,
                        TitleField::Date => &mut title.date,
                        TitleField::Author => &mut title.author,
                        TitleField::Checked => &mut title.checked,
                        TitleField::Approved => &mut title.approved,
                    } = text;
                }),
                Statement::GridAxis { .. } => self.grid_axes(placed, &mut names, &mut drawing.axes),
                _ => Some(()),
            };
            sound &= done.is_some();
        }
        sound.then_some(drawing)
    }

    fn title_text(&self, text: &TextExpr) -> Option<String> {
        if text.text.trim().is_empty() {
            self.report(
                Diagnostic::new(Code::E0306, "the text is empty", text.span, "says nothing")
                    .expected("a text", "none")
                    .help("leave the line out to leave the field of the title block empty"),
            );
            return None;
        }
        Some(text.text.clone())
    }

    /// The axes of one statement, counted on from its name.
    fn grid_axes(
        &self,
        placed: &Placed<'t>,
        names: &mut BTreeMap<String, Span>,
        axes: &mut Vec<GridAxis>,
    ) -> Option<()> {
        let Statement::GridAxis { name, axis, at, row } = placed.statement else { return Some(()) };
        let first = self.title_text(name);
        let length = |expr: &'t Expr, what: &str, bounds| {
            self.bounded_constant(&placed.env, expr, Dimension::LENGTH, what, bounds).map(|v| v.value)
        };
        let at = length(at, "the axis' coordinate", COORDINATE);
        let (every, count) = match row {
            Some((every, count)) => (
                length(every, "the distance between two axes", Bounds::above(0.0, 1e5)),
                self.count(&placed.env, count, "the number of axes", 1),
            ),
            None => (Some(0.0), Some(1)),
        };
        let (mut name_here, at, every, count) = (first?, at?, every?, count?);
        for i in 0..count {
            if axes.len() == MOST_AXES {
                self.report(
                    Diagnostic::new(Code::E0309, "there are too many axes", placed.span, "too many with this line")
                        .expected(format!("at most {MOST_AXES}"), "more"),
                );
                return None;
            }
            if let Some(earlier) = names.insert(name_here.clone(), name.span) {
                self.report(
                    Diagnostic::new(
                        Code::E0212,
                        format!("the axis `{name_here}` is declared twice"),
                        name.span,
                        if i == 0 { "declared again" } else { "counts on to it" },
                    )
                    .related(earlier, "first declared here")
                    .help("rename one of the two"),
                );
                return None;
            }
            axes.push(GridAxis {
                name: name_here.clone(),
                coordinate: if *axis == Axis::X { Coordinate::X } else { Coordinate::Y },
                // -0 m would print as such.
                at: at + every * i as f64 + 0.0,
                span: placed.span,
            });
            if i + 1 < count {
                let Some(next) = following(&name_here) else {
                    self.report(
                        Diagnostic::new(
                            Code::E0306,
                            format!("no name follows `{name_here}`"),
                            name.span,
                            "cannot be counted on",
                        )
                        .expected("a name that ends with a digit or a capital letter", format!("`{}`", name.text))
                        .help("write each axis with its own name, such as `axis \"N\'\" y = 12 m`"),
                    );
                    return None;
                };
                name_here = next;
            }
        }
        Some(())
    }
}

/// The name after this one: `9` to `10`, `A9` to `A10`, `H` to `J`, `Z` to `AA`. `None` where it ends with neither a digit
/// nor a capital letter of the row.
fn following(name: &str) -> Option<String> {
    let digits = name.len() - name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    if digits > 0 {
        let (stem, number) = name.split_at(name.len() - digits);
        let next = number.parse::<u64>().ok()?.checked_add(1)?;
        return Some(format!("{stem}{next:0digits$}"));
    }
    let letters = name.len() - name.trim_end_matches(|c: char| c.is_ascii_uppercase()).len();
    let (stem, mut row) = (&name[..name.len() - letters], name.as_bytes()[name.len() - letters..].to_vec());
    if row.is_empty() || row.iter().any(|letter| !LETTERS.contains(letter)) {
        return None;
    }
    for letter in row.iter_mut().rev() {
        let place = LETTERS.iter().position(|l| l == letter)?;
        if let Some(next) = LETTERS.get(place + 1) {
            *letter = *next;
            return Some(stem.to_owned() + std::str::from_utf8(&row).ok()?);
        }
        *letter = LETTERS[0];
    }
    row.insert(0, LETTERS[0]);
    Some(stem.to_owned() + std::str::from_utf8(&row).ok()?)
}

#[cfg(test)]
mod tests {
    use super::following;

    #[test]
    fn axes_are_counted_on_as_on_plans() {
        for (name, next) in [("1", "2"), ("9", "10"), ("09", "10"), ("A1", "A2"), ("H", "J"), ("N", "P"), ("Z", "AA")] {
            assert_eq!(following(name).as_deref(), Some(next));
        }
        assert_eq!(following("AZ").as_deref(), Some("BA"));
        for name in ["north", "N'", "I", "é", "99999999999999999999"] {
            assert_eq!(following(name), None, "{name}");
        }
    }
}
