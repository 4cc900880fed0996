//! The style sheet that all pages share, and the document of one without pictures to be asked.

use maud::{DOCTYPE, Markup, PreEscaped, html};

pub const STYLE: &str = "
:root { color-scheme: light dark; --ink: #1c2330; --soft: #5b6675; --line: #d6dbe2; --paper: #ffffff; --band: #e8edf4;
  --curve: #dfe8f5; --climb: #f3e7d3; --spiral: #e9def2; --motor: #2f7d4f; --trace: #1f5fae; --fill: #9dbde6; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e8ee; --soft: #9aa5b4; --line: #3a424e; --paper: #14181e; \
--band: #222a35;
  --curve: #22304a; --climb: #40341f; --spiral: #372a45; --motor: #5fbf85; --trace: #7fb2f0; --fill: #2f4f7c; } }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.45 system-ui, sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 24px; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 18px; margin: 32px 0 8px; }
.lead { font-size: 16px; margin: 0 0 8px; } .note, figcaption { color: var(--soft); font-size: 13px; }
figcaption b { color: var(--ink); } figure { margin: 12px 0; }
svg { display: block; width: 100%; height: auto; font: 11px system-ui, sans-serif; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; } .scroll { overflow-x: auto; }
th, td { padding: 3px 12px 3px 0; text-align: left; border-bottom: 1px solid var(--line); white-space: nowrap; }
td.wraps { white-space: normal; min-width: 220px; } th { font-weight: 600; color: var(--soft); } td.number { text-align: right; }
.axis { stroke: var(--line); } .tick { fill: var(--soft); } \
.trace { fill: none; stroke: var(--trace); stroke-width: 1; }
.fill { fill: var(--fill); stroke: none; } .curve { fill: var(--curve); } .climb { fill: var(--climb); }
.spiral { fill: var(--spiral); } .motor { fill: var(--motor); } .mark { stroke: var(--soft); stroke-dasharray: 5 3; }
.dotted { stroke: var(--soft); stroke-dasharray: 1 3; } .legend span { margin-right: 16px; }
.legend i { display: inline-block; width: 14px; height: 10px; margin-right: 5px; border: 1px solid var(--line); }
.views > input { position: absolute; opacity: 0; } \
.views > label { display: inline-block; padding: 3px 10px; margin: 0 4px 6px 0;
  border: 1px solid var(--line); border-radius: 4px; cursor: pointer; font-size: 13px; }
.views > input:focus-visible + label { outline: 2px solid var(--trace); } \
.views > input:checked + label { background: var(--band); font-weight: 600; }
.views > .view { display: none; } .number-label { fill: var(--soft); }
@media print { main { max-width: none; padding: 0; } figure { break-inside: avoid; } }
";

/// An HTML document in the house style with `rules` of its own behind it.
pub fn document(title: &str, rules: &str, body: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(rules)) }
            }
            body { main { (body) } }
        }
    }
    .into_string()
}
