//! Group codes and values of a DXF R2000 file (AutoCAD 2000 DXF Reference), a line each, and the same bytes each time.

use std::fmt::Write;

use crate::geometry::Point;

/// Records as text, and the next handle.
pub struct Tags {
    pub out: String,
    pub next: u32,
}

impl Tags {
    pub fn new(next: u32) -> Self {
        Tags { out: String::new(), next }
    }

    pub fn text(&mut self, code: u16, value: &str) {
        let _ = write!(self.out, "{code:>3}\n{value}\n");
    }

    pub fn int(&mut self, code: u16, value: i64) {
        let _ = write!(self.out, "{code:>3}\n{value}\n");
    }

    pub fn real(&mut self, code: u16, value: f64) {
        // Twelve decimals keep a kilometre to the digits of a double; negative zero is zero.
        let text = format!("{:.12}", if value.abs() < 5e-13 { 0.0 } else { value });
        let short = text.trim_end_matches('0');
        let zero = if short.ends_with('.') { "0" } else { "" };
        let _ = write!(self.out, "{code:>3}\n{short}{zero}\n");
    }

    pub fn point(&mut self, code: u16, p: Point) {
        self.pair(code, p);
        self.real(code + 20, 0.0);
    }

    pub fn pair(&mut self, code: u16, p: Point) {
        self.real(code, p.x);
        self.real(code + 10, p.y);
    }

    pub fn handle(&mut self, code: u16, handle: u32) {
        let _ = write!(self.out, "{code:>3}\n{handle:X}\n");
    }

    pub fn fresh(&mut self) -> u32 {
        self.next += 1;
        self.next - 1
    }

    /// The head of an entity that belongs to a block, which may be a space of the drawing.
    pub fn entity(&mut self, kind: &str, owner: u32, paper: bool, layer: &str, class: &str) -> u32 {
        let handle = self.fresh();
        self.text(0, kind);
        self.handle(5, handle);
        self.handle(330, owner);
        self.text(100, "AcDbEntity");
        if paper {
            self.int(67, 1);
        }
        self.text(8, layer);
        if !class.is_empty() {
            self.text(100, class);
        }
        handle
    }

    pub fn section(&mut self, name: &str) {
        self.text(0, "SECTION");
        self.text(2, name);
    }

    pub fn end_section(&mut self) {
        self.text(0, "ENDSEC");
    }
}

/// Text as ASCII on one line. Degrees, diameters and signs have control codes, times and arrows plain letters; other
/// characters are written by their code point, and control characters left out.
pub fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars().filter(|c| !c.is_control()) {
        match c {
            // `%%` begins a control code and `\U+` a character.
            '%' => out.push_str("%%%"),
            '°' => out.push_str("%%d"),
            '±' => out.push_str("%%p"),
            '×' => out.push('x'),
            '→' => out.push_str("->"),
            '∠' => out.push('<'),
            '…' => out.push_str("..."),
            '\\' => out.push_str("\\U+005C"),
            ' '..='~' => out.push(c),
            c => {
                for unit in c.encode_utf16(&mut [0; 2]) {
                    let _ = write!(out, "\\U+{unit:04X}");
                }
            }
        }
    }
    out
}

/// A name of a block or layer: letters, digits and a few signs.
pub fn symbol(name: &str) -> String {
    let kept = |c: char| if c.is_ascii_alphanumeric() || "-_.$".contains(c) { c } else { '_' };
    let name: String = name.chars().map(kept).take(200).collect();
    if name.is_empty() { "_".to_owned() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_ascii_on_one_line() {
        assert_eq!(escape("R5 90°\n"), "R5 90%%d");
        assert_eq!(escape("south 9×, 14 %: 1 → 2"), "south 9x, 14 %%%: 1 -> 2");
        assert!(escape("a\\b 50 % 😀 m²").is_ascii());
        assert_eq!(symbol("X-VC 10/8°"), "X-VC_10_8_");
    }

    #[test]
    fn reals_are_short_and_never_minus_zero() {
        let mut tags = Tags::new(0);
        tags.real(40, -0.0);
        tags.real(40, -1e-14);
        tags.real(40, 2.5);
        assert_eq!(tags.out, " 40\n0.0\n 40\n0.0\n 40\n2.5\n");
    }
}
