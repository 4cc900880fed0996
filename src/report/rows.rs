//! Rows with a name, a mark on a common scale and a word behind it: bars, intervals, levels. They are of HTML, so that
//! they read as well on a narrow page.

use crate::base::number::fixed;
use maud::{Markup, Render, html};

/// Rules of the style sheet for rows.
pub const RULES: &str = "
.rows { --first: 240px; --last: 150px; font-size: 13px; position: relative; margin: 6px 0; }
.row-of { display: grid; grid-template-columns: var(--first) 1fr var(--last); column-gap: 10px; align-items: center; min-height: 24px; }
.row-name { text-align: right; overflow-wrap: anywhere; } .row-value { font-variant-numeric: tabular-nums; }
.row-scale { position: relative; height: 22px; border-left: 1px solid var(--line); border-right: 1px solid var(--line); }
.row-scale i { position: absolute; top: 4px; bottom: 4px; } .row-scale i.grid { width: 1px; top: 0; bottom: -2px; background: var(--line); }
.row-scale i.dot { width: 9px; height: 9px; top: 6px; margin-left: -5px; border-radius: 9px; box-sizing: border-box; }
.row-scale i.span { height: 2px; top: 10px; bottom: auto; }
.row-ticks { height: 16px; border: 0; color: var(--soft); font-size: 11px; }
.row-ticks span { position: absolute; transform: translateX(-50%); white-space: nowrap; }
.row-ticks span.first { transform: none; } .row-ticks span.last { transform: translateX(-100%); }
.row-scale i.bar { background: var(--trace); border-radius: 2px; } .row-scale i.replicate { background: var(--quiet); opacity: 0.4; }
.row-head { font-weight: 600; margin-top: 6px; }
@media (max-width: 700px) {
  .row-of { grid-template-columns: 1fr auto; row-gap: 0; margin-bottom: 4px; } .row-name { text-align: left; }
  .row-value { text-align: right; } .row-scale { grid-column: 1 / 3; grid-row: 2; }
}
";

/// A scale from left to right.
#[derive(Clone, Copy, Debug)]
pub struct RowScale {
    pub low: f64,
    pub high: f64,
}

impl RowScale {
    /// Where a value is, in percent of the width.
    pub fn at(self, value: f64) -> String {
        fixed((100.0 * (value - self.low) / (self.high - self.low)).clamp(0.0, 100.0), 2)
    }

    /// A mark at a value.
    pub fn dot(self, class: &str, value: f64) -> Markup {
        html! { i class=(format!("dot {class}")) style=(format!("left:{}%", self.at(value))) {} }
    }

    /// A stretch from a value to another, at least a pixel wide.
    pub fn span(self, class: &str, from: f64, to: f64) -> Markup {
        let (left, right) = (self.at(from.min(to)), self.at(from.max(to)));
        let width = fixed(right.parse::<f64>().unwrap_or(0.0) - left.parse::<f64>().unwrap_or(0.0), 2);
        html! { i class=(class) style=(format!("left:{left}%;width:max({width}%,1px)")) {} }
    }

    /// Lines of the grid.
    pub fn grid(self, ticks: &[f64]) -> Markup {
        html! { @for tick in ticks { i.grid style=(format!("left:{}%", self.at(*tick))) {} } }
    }

    /// Which way the number of a tick goes, so that it does not stand out of the scale: class in the style sheet.
    fn side(self, value: f64) -> &'static str {
        match (value - self.low) / (self.high - self.low) {
            share if share < 0.06 => "first",
            share if share > 0.94 => "last",
            _ => "inner",
        }
    }

    /// Numbers below the rows.
    pub fn ticks(self, ticks: &[(f64, String)]) -> Markup {
        html! {
            div.row-of {
                span.row-name {}
                span."row-scale row-ticks" { @for (value, label) in ticks {
                    span class=(self.side(*value)) style=(format!("left:{}%", self.at(*value))) { (label) }
                } }
                span.row-value {}
            }
        }
    }
}

/// A row: its name, marks and words.
pub fn row(class: &str, name: &impl Render, marks: &Markup, value: &impl Render) -> Markup {
    html! {
        div class=(format!("row-of {class}")) {
            span.row-name { (name) }
            span.row-scale { (marks) }
            span.row-value { (value) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_stand_at_their_share_of_the_width_and_never_beyond() {
        let scale = RowScale { low: 1.0, high: 3.0 };
        assert_eq!([scale.at(1.5), scale.at(-4.0), scale.at(9.0)], ["25.00", "0.00", "100.00"]);
        assert_eq!([1.0, 2.0, 2.95].map(|x| scale.side(x)), ["first", "inner", "last"]);
        assert!(scale.span("bar", 2.5, 2.0).into_string().contains("left:50.00%;width:max(25.00%,1px)"));
    }
}
