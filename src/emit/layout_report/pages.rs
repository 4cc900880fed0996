//! Pages of headings, words and tables on A4, as SVG; text goes on to the next page where one is full.

use crate::emit::paper::PaperPoint;
use crate::emit::svg::sheet::{path, path_line};
use crate::emit::svg::text::{self, Height};
use crate::emit::svg::{Theme, XmlElement, page, xml};

/// A4 upright, mm.
const WIDTH: f64 = 210.0;
const HEIGHT: f64 = 297.0;
/// Left edge, for holes; right, top and bottom edges, mm.
const LEFT: f64 = 20.0;
const RIGHT: f64 = WIDTH - 12.0;
const TOP: f64 = 16.0;
const BOTTOM: f64 = HEIGHT - 18.0;
/// Between base lines of text and of rows, mm.
const LINE: f64 = 5.2;
const ROW: f64 = 4.4;
/// Between two columns, mm.
const GAP: f64 = 2.5;

/// A column of a table.
pub struct Column {
    pub title: &'static str,
    /// Share of what the narrow columns leave, 0 for a column that is as wide as its widest cell.
    pub share: f64,
    /// Numbers end at the right.
    pub right: bool,
}

/// A column of words, which takes what is left.
pub fn words(title: &'static str) -> Column {
    Column { title, share: 1.0, right: false }
}

/// A column as wide as its cells.
pub fn narrow(title: &'static str) -> Column {
    Column { title, share: 0.0, right: false }
}

/// A column of numbers.
pub fn number(title: &'static str) -> Column {
    Column { title, share: 0.0, right: true }
}

/// Pages that are being written.
pub struct Pages {
    full: Vec<Vec<XmlElement>>,
    current: Vec<XmlElement>,
    /// Base line of what comes next, mm.
    y: f64,
}

impl Pages {
    pub fn new() -> Self {
        Pages { full: Vec::new(), current: Vec::new(), y: TOP + LINE }
    }

    /// The rest of the present page stays empty.
    pub fn turn(&mut self) {
        if !self.current.is_empty() {
            self.full.push(std::mem::take(&mut self.current));
        }
        self.y = TOP + LINE;
    }

    /// A new page where less than this is left, mm.
    fn room(&mut self, height: f64) {
        if self.y + height > BOTTOM {
            self.turn();
        }
    }

    fn put(&mut self, x: f64, words: impl Into<String>, height: Height, class: &str) {
        self.current.push(text::line(PaperPoint::new(x, self.y), words, height, class));
    }

    pub fn title(&mut self, words: &str) {
        self.room(12.0);
        self.y += 4.0;
        self.put(LEFT, text::fitted(words, Height::H50, true, RIGHT - LEFT), Height::H50, "bold");
        self.y += 9.0;
    }

    /// A heading, which stays with at least a few rows under it.
    pub fn heading(&mut self, words: &str) {
        self.room(30.0);
        self.y += if self.current.is_empty() { 0.0 } else { 4.0 };
        self.put(LEFT, text::fitted(words, Height::H35, true, RIGHT - LEFT), Height::H35, "bold");
        self.y += 7.0;
    }

    /// A paragraph, broken between words.
    pub fn words(&mut self, words: &str, class: &str) {
        for line in broken(words, RIGHT - LEFT, Height::H25) {
            self.room(LINE);
            self.put(LEFT, line, Height::H25, class);
            self.y += LINE;
        }
        self.y += 1.5;
    }

    /// Names with their values under one another.
    pub fn facts(&mut self, facts: &[(&str, String)]) {
        const NAMES: f64 = 52.0;
        for (name, value) in facts {
            for (k, line) in broken(value, RIGHT - LEFT - NAMES, Height::H25).into_iter().enumerate() {
                self.room(LINE);
                if k == 0 {
                    self.put(LEFT, *name, Height::H25, "quiet");
                }
                self.put(LEFT + NAMES, line, Height::H25, "");
                self.y += LINE;
            }
        }
        self.y += 1.5;
    }

    /// Whether no page is full yet.
    pub fn is_one(&self) -> bool {
        self.full.is_empty()
    }

    /// The room that is left on this page for a picture, mm.
    pub fn room_left(&self) -> PaperPoint {
        PaperPoint::new(RIGHT - LEFT, BOTTOM - self.y)
    }

    /// A picture of a size, mm, in the middle of the page; its upper left corner is the origin.
    pub fn picture(&mut self, picture: XmlElement, size: PaperPoint) {
        let (x, y) = (LEFT + 0.5 * (RIGHT - LEFT - size.x), self.y - 0.7 * LINE);
        let moved = format!("translate({} {})", xml::number(x), xml::number(y));
        self.current.push(picture.attr("transform", moved));
        self.y += size.y + 2.0;
    }

    /// A table, whose head stands on every page that it reaches. Columns of words are broken to fit.
    pub fn table(&mut self, columns: &[Column], rows: &[Vec<String>]) {
        let edges = edges(columns, rows);
        self.head(columns, &edges);
        for row in rows {
            let lines = |((cell, column), (low, high)): ((&String, &Column), &(f64, f64))| match column.share > 0.0 {
                true => broken(cell, high - low, Height::H18),
                false => vec![cell.clone()],
            };
            let cells: Vec<Vec<String>> = row.iter().zip(columns).zip(&edges).map(lines).collect();
            let height = cells.iter().map(Vec::len).max().unwrap_or(1);
            if self.y + ROW * height as f64 > BOTTOM {
                self.turn();
                self.head(columns, &edges);
            }
            for k in 0..height {
                for ((lines, column), edge) in cells.iter().zip(columns).zip(&edges) {
                    if let Some(line) = lines.get(k) {
                        self.cell(line, column.right, *edge, "");
                    }
                }
                self.y += if k + 1 < height { 0.8 * ROW } else { ROW };
            }
        }
        self.y += 2.0;
    }

    fn head(&mut self, columns: &[Column], edges: &[(f64, f64)]) {
        self.room(3.0 * ROW);
        for (column, edge) in columns.iter().zip(edges) {
            self.cell(column.title, column.right, *edge, "bold");
        }
        let y = self.y + 1.2;
        self.current.push(path(&path_line(PaperPoint::new(LEFT, y), PaperPoint::new(RIGHT, y)), "rule"));
        self.y += ROW + 1.2;
    }

    fn cell(&mut self, words: &str, right: bool, (low, high): (f64, f64), class: &str) {
        let words = text::fitted(words, Height::H18, class == "bold", high - low);
        let wide = text::width(&words, Height::H18.size(), class == "bold");
        let x = if right { high - wide } else { low };
        self.put(x, words, Height::H18, class);
    }

    /// The pages as SVG, each with its number, what it belongs to, and of how many it is; `inserted` pages stand behind
    /// the first `before` ones.
    pub fn finish(mut self, title: &str, foot: &str, (before, inserted): (usize, usize)) -> Vec<String> {
        self.turn();
        let count = self.full.len() + inserted;
        let drawn = |(i, elements): (usize, Vec<XmlElement>)| {
            let number = if i < before { i + 1 } else { i + 1 + inserted };
            let mut svg = page((WIDTH, HEIGHT), Theme::Light, title, foot);
            svg.push(XmlElement::new("rect").attr("class", "ground").num("width", WIDTH).num("height", HEIGHT));
            elements.into_iter().for_each(|element| svg.push(element));
            let last = format!("{number} / {count}");
            let wide = text::width(&last, Height::H18.size(), false);
            let y = HEIGHT - 10.0;
            let room = RIGHT - LEFT - wide - GAP;
            let foot = text::fitted(foot, Height::H18, false, room);
            svg.push(text::line(PaperPoint::new(LEFT, y), foot, Height::H18, "quiet"));
            svg.push(text::line(PaperPoint::new(RIGHT - wide, y), last, Height::H18, "quiet"));
            svg.document()
        };
        self.full.into_iter().enumerate().map(drawn).collect()
    }
}

/// Left and right edge of each column, mm.
fn edges(columns: &[Column], rows: &[Vec<String>]) -> Vec<(f64, f64)> {
    let size = Height::H18.size();
    let widest = |k: usize, column: &Column| {
        let cells = rows.iter().filter_map(|row| row.get(k)).map(|cell| text::width(cell, size, false));
        // A little more, as the widths of letters are rounded.
        cells.fold(text::width(column.title, size, true), f64::max) + 0.3
    };
    let own: Vec<f64> = columns
        .iter()
        .enumerate()
        .map(|(k, column)| if column.share > 0.0 { 0.0 } else { widest(k, column) })
        .collect();
    let shares: f64 = columns.iter().map(|column| column.share).sum();
    let left = RIGHT - LEFT - own.iter().sum::<f64>() - GAP * columns.len().saturating_sub(1) as f64;
    let mut x = LEFT;
    let mut edges = Vec::new();
    for (column, own) in columns.iter().zip(&own) {
        let wide = if column.share > 0.0 { left.max(20.0) * column.share / shares } else { *own };
        edges.push((x, x + wide));
        x += wide + GAP;
    }
    edges
}

/// Lines of a text that fit into a width, mm; a word that does not fit alone goes on in the next line.
fn broken(words: &str, room: f64, height: Height) -> Vec<String> {
    let fits = |line: &str| text::width(line, height.size(), false) <= room;
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in words.split_whitespace() {
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if fits(&longer) {
            line = longer;
            continue;
        }
        if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        for letter in word.chars() {
            line.push(letter);
            if !fits(&line) && line.chars().count() > 1 {
                line.pop();
                lines.push(std::mem::replace(&mut line, letter.to_string()));
            }
        }
    }
    lines.push(line);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_tables_go_on_with_their_head() {
        let mut pages = Pages::new();
        let rows: Vec<Vec<String>> = (0..150).map(|i| vec![format!("row {i}"), format!("{}.5", 10 * i)]).collect();
        pages.table(&[words("name"), number("value")], &rows);
        let written = pages.finish("title", "foot", (1, 1));
        assert_eq!(written.len(), 3);
        for (svg, count) in written.iter().zip(["1 / 4", "3 / 4", "4 / 4"]) {
            assert!(svg.contains(">name<") && svg.contains(">value<") && svg.contains(count), "{count}");
        }
        let all = written.concat();
        assert!((0..150).all(|i| all.contains(&format!(">row {i}<"))));
    }

    #[test]
    fn words_are_broken_to_fit() {
        let text = "a loop of ten vertices that is proven to be the shortest of its kind, whatever else ".repeat(4);
        let lines = broken(&text, 100.0, Height::H25);
        assert!(lines.len() > 3 && lines.iter().all(|l| text::width(l, Height::H25.size(), false) <= 100.0));
        assert_eq!(lines.join(" "), text.trim());
        assert_eq!(broken("", 100.0, Height::H25), [""]);
        let lines = broken(&format!("a {} z", "m".repeat(120)), 100.0, Height::H25);
        assert!(lines.iter().all(|l| text::width(l, Height::H25.size(), false) <= 100.0), "{lines:?}");
        assert_eq!(lines.concat().matches('m').count(), 120);
        // In a table, too: nothing of a long reason is left out.
        let mut pages = Pages::new();
        pages.table(&[words("line"), number("is")], &[vec![text.clone(), "1".to_owned()]]);
        let written = pages.finish("title", "foot", (1, 0)).concat();
        assert!(!written.contains('…') && written.matches("whatever else").count() == 4, "{written}");
    }
}
