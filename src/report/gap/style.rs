//! What this page has beyond the sheet that all pages share. `--gap` marks what is off, `--trace` what names it.

pub const STYLE: &str = "
.kicker { color: var(--soft); font-size: 13px; margin: 0 0 2px; } h3 { font-size: 15px; margin: 20px 0 4px; }
.next { border-left: 3px solid var(--trace); padding: 2px 0 2px 14px; margin: 8px 0; max-width: 80ch; }
.lead, .lost, main > p { max-width: 90ch; }
.quiet { color: var(--soft); }
.bar { background: var(--trace); border-radius: 2px; } .bar.sensor { background: var(--spiral); outline: 1px solid var(--trace); } \
.bar.other { background: var(--quiet); }
.row-scale i.gap-fill { background: var(--gap); top: 2px; bottom: 2px; } .strip .row-scale { background: var(--band); } \
.strip .row-ticks { background: none; } .strip .parts .row-scale { height: 9px; background: none; border: 0; }
.row-of.parts { min-height: 10px; } .strip .parts i.part { top: 0; bottom: 0; } .part.curve { background: var(--curve); } \
.part.climb { background: var(--climb); } .part.spiral { background: var(--spiral); }
.gap-ramp { display: inline-block; width: 160px; height: 10px; border: 1px solid var(--line); background: linear-gradient(to right, transparent, \
color-mix(in srgb, var(--gap) 35%, transparent) 12.5%, color-mix(in srgb, var(--gap) 50%, transparent) 25%, \
color-mix(in srgb, var(--gap) 71%, transparent) 50%, var(--gap)); }
span.badge { display: inline-block; min-width: 17px; border-radius: 9px; background: var(--ink); color: var(--paper); \
font-size: 11px;
  font-weight: 700; line-height: 17px; text-align: center; }
th.number { text-align: right; } table.heat td, table.heat th { padding: 3px 10px; } \
table.heat td:first-child, table.heat th:first-child { padding-left: 0; }
.sum td { font-weight: 600; }
.row-scale i.replicate { background: var(--quiet); opacity: 0.35; } .row-scale i.way { background: var(--soft); height: 1px; }
.dot.before { background: var(--paper); border: 2px solid var(--gap); } .dot.after { background: var(--trace); }
.difference { margin: 2px 0 0 52px; }
.legend i.line-measured, .legend i.line-before, .legend i.line-after { height: 0; vertical-align: 4px; border: 0; \
border-top: 2px solid var(--ink); }
.legend i.line-before { border-top: 2px dashed var(--gap); } .legend i.line-after { border-color: var(--trace); }
.legend i.line-repeatability, .legend i.dot-replicate { background: var(--quiet); opacity: 0.6; }
.legend i.dot-before, .legend i.dot-after { width: 8px; height: 8px; border-radius: 6px; border: 2px solid var(--gap); }
.legend i.dot-after { background: var(--trace); border-color: var(--trace); }
";
