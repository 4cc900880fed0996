//! The tables beside the drawing: coordinates of what is set out, and the labels that found no room.

use crate::emit::paper::PaperPoint;
use crate::emit::plan::PointGroup;

use super::decimals::Decimals;
use super::sheet::{Sheet, TABLE_LINE, TableSize, path, path_line, rectangle, table_lines};
use super::text::{self, Height};
use super::xml::XmlElement;

/// Room between cells, and at both sides of a column, mm.
const GAP: f64 = 2.4;
const SIDE: f64 = 3.0;
/// Longest name, mm; longer ones are cut.
const LONGEST: f64 = 34.0;
/// Widest column, mm: as much as a label without room needs.
const LEAST: f64 = 56.0;

/// A line of the tables.
enum Line {
    /// Title of a group; the head of its columns.
    Title(String),
    Head(Vec<String>),
    /// A name and numbers.
    Row(Vec<String>),
    /// Words all across.
    Words(String),
}

/// What stands beside the drawing.
pub struct Tables {
    lines: Vec<Line>,
    /// Width of each cell, mm.
    cells: Vec<f64>,
}

impl Tables {
    /// Points by group, and `spare` lines for labels without room on the plan (with a line that says so).
    pub fn new(groups: &[PointGroup], decimals: Decimals, spare: &[String]) -> Self {
        let mut lines = Vec::new();
        let raised = groups.iter().flat_map(|group| &group.points).any(|p| p.z.is_some());
        for group in groups {
            if !lines.is_empty() {
                lines.push(Line::Words(String::new()));
            }
            lines.push(Line::Title(group.title.to_owned()));
            let along = group.points.iter().any(|p| p.s.is_some());
            let mut head = vec![String::new(), "x".to_owned(), "y".to_owned()];
            if along {
                head.push("s".to_owned());
                head.extend(raised.then(|| "height".to_owned()));
            }
            lines.push(Line::Head(head));
            for point in &group.points {
                let number = |value: f64| Decimals::text(value, decimals.coordinate);
                let mut row = vec![text::fitted(&point.name, Height::H18, false, LONGEST)];
                row.extend([point.at.x, point.at.y].map(number));
                row.extend(point.s.map(number));
                row.extend(point.z.map(|z| Decimals::text(z, 3)));
                lines.push(Line::Row(row));
            }
        }
        if !spare.is_empty() {
            lines.push(Line::Words(String::new()));
            lines.push(Line::Title("labels without room on the plan".to_owned()));
            lines.extend(spare.iter().map(|label| Line::Words(label.clone())));
        }
        let mut cells: Vec<f64> = Vec::new();
        for line in &lines {
            let (Line::Row(texts) | Line::Head(texts)) = line else { continue };
            cells.resize(cells.len().max(texts.len()), 0.0);
            for (cell, words) in cells.iter_mut().zip(texts) {
                *cell = cell.max(text::width(words, Height::H18.size(), false));
            }
        }
        Tables { lines, cells }
    }

    /// What a sheet has to hold.
    pub fn size(&self) -> TableSize {
        TableSize { lines: self.lines.len() + usize::from(!self.lines.is_empty()), width: self.width() }
    }

    fn width(&self) -> f64 {
        let cells: f64 = self.cells.iter().map(|cell| cell + GAP).sum::<f64>() - GAP;
        (cells + 2.0 * SIDE).max(LEAST)
    }

    pub fn draw(&self, sheet: &Sheet, origin: &str) -> XmlElement {
        let mut group = XmlElement::group("tables");
        let area = &sheet.tables;
        if area.width() < 1.0 {
            return group;
        }
        group.push(rectangle(area.low, area.high, "rule"));
        let tall = table_lines(area.height());
        let columns = (area.width() / self.width()).round().max(1.0) as usize;
        let head = text::fitted(origin, Height::H18, true, area.width() - 2.0 * SIDE);
        let mut rules = String::new();
        let base = |column: usize, row: usize| {
            area.low + PaperPoint::new(SIDE + self.width() * column as f64, 6.2 + TABLE_LINE * row as f64)
        };
        group.push(text::line(base(0, 0), head, Height::H18, "bold"));
        // The first line is the head's.
        let room = (tall * columns).saturating_sub(1);
        let mut left: &[Line] = &self.lines;
        if left.len() > room {
            left = &left[..room.saturating_sub(1)];
        }
        let hidden = self.lines.len() - left.len();
        for (i, line) in left.iter().enumerate() {
            let at = base((i + 1) / tall, (i + 1) % tall);
            match line {
                Line::Title(words) => {
                    let words = text::fitted(words, Height::H18, true, self.width() - 2.0 * SIDE);
                    group.push(text::line(at, words, Height::H18, "bold"));
                    let foot = at + PaperPoint::new(0.0, 0.9);
                    rules += &path_line(foot, foot + PaperPoint::new(self.width() - 2.0 * SIDE, 0.0));
                }
                Line::Head(texts) => self.cells(&mut group, at, texts, "quiet"),
                Line::Row(texts) => self.cells(&mut group, at, texts, ""),
                Line::Words(words) if words.is_empty() => {}
                Line::Words(words) => {
                    let words = text::fitted(words, Height::H18, false, self.width() - 2.0 * SIDE);
                    group.push(text::line(at, words, Height::H18, ""));
                }
            }
        }
        if hidden > 0 {
            let words = format!("and {hidden} more lines without room");
            group.push(text::line(base(room / tall, room % tall), words, Height::H18, "warn"));
        }
        if !rules.is_empty() {
            group.push(path(&rules, "rule"));
        }
        group
    }

    /// Names at the left of their cells, numbers at the right.
    fn cells(&self, group: &mut XmlElement, at: PaperPoint, texts: &[String], class: &str) {
        let mut x = at.x;
        for (i, (words, wide)) in texts.iter().zip(&self.cells).enumerate() {
            let indent = if i == 0 { 0.0 } else { wide - text::width(words, Height::H18.size(), false) };
            if !words.is_empty() {
                group.push(text::line(PaperPoint::new(x + indent, at.y), words.clone(), Height::H18, class));
            }
            x += wide + GAP;
        }
    }
}
