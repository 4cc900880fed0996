//! A comparison as text and as Markdown.

use super::{BesideChange, Change, ChannelChange, Comparison, EquipmentChange, Line, Moments, Quantity};
use super::{IN_ALL, PRICED, Standing, Straight};
use crate::base::number::{self, trimmed};
use crate::solve::Status;
use std::fmt::Write;

/// Most rows of a list that are shown; JSON has all of them.
const MOST: usize = 40;

/// A table: its title, the heads of its columns, and rows of as many cells.
struct Table {
    title: &'static str,
    heads: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl Comparison {
    /// For people at a terminal.
    pub fn text(&self) -> String {
        let mut out = format!("{}\n", self.title());
        let _ = writeln!(out, "  {}", self.answer());
        for table in self.tables() {
            let widths: Vec<usize> = (0..table.heads.len())
                .map(|k| {
                    table.rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0).max(table.heads[k].len())
                })
                .collect();
            let line = |cells: &mut dyn Iterator<Item = &str>| -> String {
                let cells = cells.zip(&widths).enumerate().map(|(k, (cell, width))| {
                    let pad = " ".repeat(width - cell.chars().count());
                    if k == 0 { format!("{cell}{pad}") } else { format!("{pad}{cell}") }
                });
                cells.collect::<Vec<_>>().join("  ")
            };
            let _ = writeln!(out, "\n{}", table.title);
            let _ = writeln!(out, "  {}", line(&mut table.heads.iter().copied()).trim_end());
            for row in table.rows.iter().take(MOST) {
                let _ = writeln!(out, "  {}", line(&mut row.iter().map(String::as_str)).trim_end());
            }
            out += &more(table.rows.len(), "  ");
        }
        if !self.lines.is_empty() {
            out += "\nwritten\n";
            for line in self.lines.iter().take(MOST) {
                let _ = writeln!(out, "  {}", line.shown());
            }
            out += &more(self.lines.len(), "  ");
        }
        out
    }

    /// For a pull request.
    pub fn markdown(&self) -> String {
        let mut out = format!("### {}\n\n{}\n", escaped(&self.title()), escaped(&self.answer()));
        for table in self.tables() {
            let _ = writeln!(out, "\n**{}**\n", table.title);
            let _ = writeln!(out, "| {} |", table.heads.join(" | "));
            let _ = writeln!(out, "|---|{}", "--:|".repeat(table.heads.len() - 1));
            for row in table.rows.iter().take(MOST) {
                let cells: Vec<String> = row.iter().map(|cell| escaped(cell)).collect();
                let _ = writeln!(out, "| {} |", cells.join(" | "));
            }
            out += &more(table.rows.len(), "\n");
        }
        if !self.lines.is_empty() {
            out += "\n**written**\n\n```diff\n";
            for line in self.lines.iter().take(MOST) {
                let _ = writeln!(out, "{}", line.shown().replace("```", "'''"));
            }
            out += "```\n";
            out += &more(self.lines.len(), "\n");
        }
        out
    }

    fn title(&self) -> String {
        let (before, after) = (&self.before, &self.after);
        let name = if before.layout == after.layout {
            after.layout.clone()
        } else {
            format!("{} and {}", before.layout, after.layout)
        };
        format!("{name}: {} → {}", before.source, after.source)
    }

    /// In a sentence.
    fn answer(&self) -> String {
        let failed = |status: Status| status == Status::Infeasible;
        let mut parts = Vec::new();
        match (failed(self.before.status), failed(self.after.status)) {
            (false, true) => parts.push("NOT FEASIBLE any more".to_owned()),
            (true, false) => parts.push("feasible now".to_owned()),
            (true, true) => parts.push("NOT FEASIBLE, before and after".to_owned()),
            (false, false) => {}
        }
        if self.is_built_alike() {
            parts.push(if self.is_same() { "nothing changed" } else { "what is built is the same" }.to_owned());
            parts.extend(self.known_otherwise());
            return parts.join("; ");
        }
        for quantity in self.quantities.iter().filter(|q| ["length", IN_ALL, PRICED, "carts"].contains(&q.name)) {
            if let (Some(before), Some(after), true) = (quantity.before, quantity.after, quantity.is_changed()) {
                let share = if before == 0.0 { String::new() } else { percent(after / before - 1.0) };
                let by = quantity.signed(after - before);
                parts.push(format!("{} {by}{share}", quantity.name).trim_end().to_owned());
            }
        }
        let moved = self.vertices.iter().filter(|vertex| vertex.is_moved()).count();
        if moved > 0 {
            parts.push(format!("{moved} {} moved", if moved == 1 { "vertex" } else { "vertices" }));
        }
        if parts.is_empty() && !self.is_billed_alike() {
            let what =
                if self.bill.is_empty() { "what is ordered beside the track changed" } else { "the bill changed" };
            parts.push(what.to_owned());
        }
        if parts.is_empty() && !self.equipment.is_empty() {
            parts.push("equipment moved".to_owned());
        }
        if parts.is_empty() {
            parts.extend(self.known_otherwise());
        }
        if parts.is_empty() {
            parts.push("small changes".to_owned());
        }
        parts.join("; ")
    }

    /// Which figures changed.
    fn known_otherwise(&self) -> Option<String> {
        let names: Vec<&str> = self.quantities.iter().filter(|q| q.is_changed()).map(|q| q.name).collect();
        (!names.is_empty()).then(|| format!("{} changed", names.join(", ")))
    }

    fn tables(&self) -> Vec<Table> {
        let quantities = self.quantities.iter().filter(|q| q.is_changed());
        let rows = quantities.map(|q| {
            let difference = q.before.zip(q.after).map_or_else(String::new, |(a, b)| q.signed(b - a));
            vec![q.name.to_owned(), q.shown(q.before), q.shown(q.after), difference]
        });
        let measured =
            Table { title: "measured", heads: vec!["", "before", "after", "difference"], rows: rows.collect() };
        let at = |m: Option<[f64; 3]>| match m {
            Some([x, y, radius]) => {
                [format!("({}, {}) m", fixed(x, 3), fixed(y, 3)), format!("{} m", fixed(radius, 3))]
            }
            None => ["–".to_owned(), "–".to_owned()],
        };
        let vertices = self.vertices.iter().map(|v| {
            let moved = v.before_m.zip(v.after_m).map_or_else(String::new, |(a, b)| {
                format!("{} m", fixed(crate::base::trig::hypot(a[0] - b[0], a[1] - b[1]), 3))
            });
            let ([before, radius], [after, other]) = (at(v.before_m), at(v.after_m));
            let radii = if radius == other { radius } else { format!("{radius} → {other}") };
            vec![v.name.clone(), before, after, moved, radii]
        });
        let heads = vec!["vertex", "before", "after", "moved by", "radius"];
        let vertices = Table { title: "vertices, as built", heads, rows: vertices.collect() };
        let straight = |s: Option<Straight>| {
            s.map_or_else(|| "–".to_owned(), |s| format!("{} m at {}°", fixed(s.length_m, 3), fixed(s.heading_deg, 2)))
        };
        let sections = self.sections.iter().map(|s| {
            let longer = s.before.zip(s.after).map(|(a, b)| b.length_m - a.length_m).filter(|by| by.abs() >= 5e-4);
            let longer = longer.map_or_else(String::new, |by| format!("{}{} m", sign(by), fixed(by.abs(), 3)));
            vec![s.name.clone(), straight(s.before), straight(s.after), longer]
        });
        let heads = vec!["straight", "before", "after", "longer by"];
        let sections = Table { title: "straights, as built", heads, rows: sections.collect() };
        let bill = self.bill.iter().map(|a| {
            let (count, price) = (a.after as i64 - a.before as i64, a.after_eur - a.before_eur);
            vec![
                a.description.clone(),
                a.article.clone(),
                a.before.to_string(),
                a.after.to_string(),
                format!("{count:+}"),
                format!("{}{} EUR", sign(price), fixed(price.abs(), 2)),
            ]
        });
        let heads = vec!["element", "article", "before", "after", "difference", "price"];
        let bill = Table { title: "bill of elements", heads, rows: bill.collect() };
        let heads = vec!["component", "article", "before", "after", "difference", "price"];
        let rows = self.beside.iter().map(BesideChange::cells).collect();
        let beside = Table { title: "ordered beside the track", heads, rows };
        let heads = vec!["equipment", "before", "after", "moved by"];
        let rows = self.equipment.iter().map(EquipmentChange::cells).collect();
        let equipment = Table { title: "equipment, as placed", heads, rows };
        let heads = vec!["channel", "mean", "standard deviation", "peak"];
        let rows = self.forces.iter().flat_map(|forces| &forces.channels).map(ChannelChange::cells).collect();
        let forces = Table { title: "runs, before → after", heads, rows };
        [measured, forces, bill, beside, equipment, sections, vertices]
            .into_iter()
            .filter(|table| !table.rows.is_empty())
            .collect()
    }
}

impl BesideChange {
    fn cells(&self) -> Vec<String> {
        let price = match (self.before_eur, self.after_eur) {
            (Some(before), Some(after)) => {
                format!("{}{} EUR", sign(after - before), fixed((after - before).abs(), 2))
            }
            _ => "–".to_owned(),
        };
        vec![
            self.description.clone(),
            self.article.clone().unwrap_or_default(),
            self.before.to_string(),
            self.after.to_string(),
            format!("{:+}", self.after as i64 - self.before as i64),
            price,
        ]
    }
}

impl EquipmentChange {
    fn cells(&self) -> Vec<String> {
        let standing = |s: &Option<Standing>| s.as_ref().map_or_else(|| "–".to_owned(), Standing::shown);
        let moved = self.moved_m.map_or_else(String::new, |by| {
            let one = self.after.as_ref().is_some_and(|s| s.places_m.len() == 1);
            format!("{}{} m", if one { "" } else { "up to " }, fixed(by, 3))
        });
        vec![self.name.clone(), standing(&self.before), standing(&self.after), moved]
    }
}

impl Standing {
    /// `induction at (3.000, 8.500) m`, `40 chute_narrow, from (3.000, 8.500) m`
    fn shown(&self) -> String {
        let count = self.places_m.len();
        let several = if count == 1 { "" } else { "s" };
        let what = self.of.clone().unwrap_or_else(|| format!("{}{several}", self.kind));
        match self.places_m.as_slice() {
            [] => format!("no {what}"),
            [[x, y]] => format!("{what} at ({}, {}) m", fixed(*x, 3), fixed(*y, 3)),
            [[x, y], ..] => format!("{count} {what}, from ({}, {}) m", fixed(*x, 3), fixed(*y, 3)),
        }
    }
}

impl ChannelChange {
    fn cells(&self) -> Vec<String> {
        // Two decimals for forces of hundreds, more for angles of thousandths.
        let size = [self.before, self.after].into_iter().flatten().map(|m| m.peak.abs()).fold(0.0, f64::max);
        let decimals =
            [(10.0, 2), (0.1, 4)].into_iter().find(|(from, _)| size >= *from || size == 0.0).map_or(6, |d| d.1);
        let cell = |of: fn(&Moments) -> f64| {
            let [before, after] = [&self.before, &self.after].map(|m| m.as_ref().map(of));
            let shown = |x: Option<f64>| x.map_or_else(|| "–".to_owned(), |x| fixed(x, decimals));
            format!("{} → {} {}", shown(before), shown(after), self.unit)
        };
        vec![self.channel.to_owned(), cell(|m| m.mean), cell(|m| m.sd), cell(|m| m.peak)]
    }
}

impl Line {
    /// As a diff shows it.
    fn shown(&self) -> String {
        let sign = match self.change {
            Change::Removed => '-',
            Change::Added => '+',
        };
        let within = if self.within.is_empty() { String::new() } else { format!("{}: ", self.within) };
        format!("{sign} {within}{}", self.text)
    }
}

impl Quantity {
    fn shown(&self, value: Option<f64>) -> String {
        value.map_or_else(|| "–".to_owned(), |value| self.with_unit(fixed(value, self.decimals)))
    }

    fn signed(&self, difference: f64) -> String {
        // A small difference has as many decimals as it takes to see it.
        let is_seen = |digits: &usize| fixed(difference.abs(), *digits).contains(|c| ('1'..='9').contains(&c));
        let digits = (self.decimals..9).find(is_seen).unwrap_or(9);
        self.with_unit(format!("{}{}", sign(difference), fixed(difference.abs(), digits)))
    }

    fn with_unit(&self, number: String) -> String {
        format!("{number} {}", self.unit).trim_end().to_owned()
    }
}

fn sign(value: f64) -> &'static str {
    if value < 0.0 { "−" } else { "+" }
}

fn percent(share: f64) -> String {
    format!(" ({}{} %)", sign(share), trimmed(100.0 * share.abs(), 2))
}

/// With so many decimals, and a minus sign that is as wide as a plus.
fn fixed(value: f64, decimals: usize) -> String {
    number::fixed(value, decimals).replace('-', "−")
}

fn more(count: usize, before: &str) -> String {
    if count > MOST { format!("{before}and {} more\n", count - MOST) } else { String::new() }
}

/// Text that Markdown shows as it is.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if matches!(c, '\\' | '|' | '*' | '_' | '`' | '<' | '[' | ']' | '#' | '@') {
            out.push('\\');
        }
        out.push(c);
    }
    out
}
