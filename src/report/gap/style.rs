//! What this page has beyond the sheet that all pages share. `--gap` marks what is off, `--trace` what names it.

pub const STYLE: &str = "
:root { --gap: #c24e00; --quiet: #aab3bf; } \
@media (prefers-color-scheme: dark) { :root { --gap: #ff9c54; --quiet: #566170; } }
.kicker { color: var(--soft); font-size: 13px; margin: 0 0 2px; } h3 { font-size: 15px; margin: 20px 0 4px; }
.next { border-left: 3px solid var(--trace); padding: 2px 0 2px 14px; margin: 8px 0; max-width: 80ch; }
.lead, .lost, main > p { max-width: 90ch; }
.name, .value { fill: var(--ink); font-size: 12px; } .quiet { fill: var(--soft); color: var(--soft); }
.bar { fill: var(--trace); } .bar.sensor { fill: var(--spiral); stroke: var(--trace); } \
.bar.other { fill: var(--quiet); }
.track { fill: none; stroke: var(--band); stroke-width: 9; stroke-linejoin: round; }
.gap { fill: none; stroke: var(--gap); stroke-width: 9; } .gap-fill { fill: var(--gap); shape-rendering: crispEdges; } \
.row { fill: var(--band); }
circle.badge { fill: var(--ink); } .badge-text { fill: var(--paper); font-weight: 700; }
span.badge { display: inline-block; min-width: 17px; border-radius: 9px; background: var(--ink); color: var(--paper); \
font-size: 11px;
  font-weight: 700; line-height: 17px; text-align: center; }
th.number { text-align: right; } table.heat td, table.heat th { padding: 3px 10px; } \
table.heat td:first-child, table.heat th:first-child { padding-left: 0; }
.sum td { font-weight: 600; } .measured { fill: none; stroke: var(--ink); stroke-width: 1.4; }
.before { fill: none; stroke: var(--gap); stroke-width: 1.6; stroke-dasharray: 5 3; } \
.after { fill: none; stroke: var(--trace); stroke-width: 1.6; }
.repeatability { fill: var(--quiet); fill-opacity: 0.4; } .replicate { fill: var(--quiet); fill-opacity: 0.35; }
circle.before { fill: var(--paper); stroke-dasharray: none; stroke-width: 2; } \
circle.after { fill: var(--trace); stroke: none; }
.difference { margin: 2px 0 0 52px; } .way { stroke: var(--soft); stroke-width: 1; }
.legend i.line-measured, .legend i.line-before, .legend i.line-after { height: 0; vertical-align: 4px; border: 0; \
border-top: 2px solid var(--ink); }
.legend i.line-before { border-top: 2px dashed var(--gap); } .legend i.line-after { border-color: var(--trace); }
.legend i.line-repeatability, .legend i.dot-replicate { background: var(--quiet); opacity: 0.6; }
.legend i.dot-before, .legend i.dot-after { width: 8px; height: 8px; border-radius: 6px; border: 2px solid var(--gap); }
.legend i.dot-after { background: var(--trace); border-color: var(--trace); }
";
