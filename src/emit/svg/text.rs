//! Text: sizes, and how wide a line of DejaVu Sans is, so that labels can be placed without a font engine.

use crate::emit::paper::PaperPoint;

use super::xml::XmlElement;

/// Advance widths of U+0020 to U+007E, 2048 units an em.
#[rustfmt::skip]
const REGULAR: [u16; 95] = [
    651, 821, 942, 1716, 1303, 1946, 1597, 563, 799, 799, 1024, 1716, 651, 739, 651, 690, 1303, 1303, 1303, 1303,
    1303, 1303, 1303, 1303, 1303, 1303, 690, 690, 1716, 1716, 1716, 1087, 2048, 1401, 1405, 1430, 1577, 1294, 1178,
    1587, 1540, 604, 604, 1343, 1141, 1767, 1532, 1612, 1235, 1612, 1423, 1300, 1251, 1499, 1401, 2025, 1403, 1251,
    1403, 799, 690, 799, 1716, 1024, 1024, 1255, 1300, 1126, 1300, 1260, 721, 1300, 1298, 569, 569, 1186, 569, 1995,
    1298, 1253, 1300, 1300, 842, 1067, 803, 1298, 1212, 1675, 1212, 1212, 1075, 1303, 690, 1303, 1716,
];
#[rustfmt::skip]
const BOLD: [u16; 95] = [
    713, 934, 1067, 1716, 1425, 2052, 1786, 627, 936, 936, 1071, 1716, 778, 850, 778, 748, 1425, 1425, 1425, 1425,
    1425, 1425, 1425, 1425, 1425, 1425, 819, 819, 1716, 1716, 1716, 1188, 2048, 1585, 1561, 1503, 1700, 1399, 1399,
    1681, 1714, 762, 762, 1587, 1305, 2038, 1714, 1741, 1501, 1741, 1577, 1475, 1397, 1663, 1585, 2259, 1579, 1483,
    1485, 936, 748, 936, 1716, 1024, 1024, 1382, 1466, 1214, 1466, 1389, 891, 1466, 1458, 702, 702, 1362, 702, 2134,
    1458, 1407, 1466, 1466, 1010, 1219, 979, 1458, 1335, 1892, 1321, 1335, 1192, 1458, 748, 1458, 1716,
];
/// No other character of the embedded subset is wider (regular, bold).
const WIDEST: [u16; 2] = [2100, 2280];

/// Nominal heights of ISO 3098: of capitals, in tenths of a mm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Height {
    H18,
    H25,
    H35,
    H50,
}

impl Height {
    /// Font size, mm: capitals of DejaVu Sans are 0.729 em high.
    pub fn size(self) -> f64 {
        match self {
            Height::H18 => 2.5,
            Height::H25 => 3.4,
            Height::H35 => 4.8,
            Height::H50 => 6.8,
        }
    }

    pub fn capitals(self) -> f64 {
        0.729 * self.size()
    }

    fn class(self) -> &'static str {
        match self {
            Height::H18 => "h18",
            Height::H25 => "h25",
            Height::H35 => "h35",
            Height::H50 => "h50",
        }
    }
}

/// Width of a line at this font size.
pub fn width(text: &str, size: f64, bold: bool) -> f64 {
    let (table, widest) = if bold { (&BOLD, WIDEST[1]) } else { (&REGULAR, WIDEST[0]) };
    let units: u64 = text
        .chars()
        .map(|c| {
            let index = (c as usize).wrapping_sub(0x20);
            u64::from(table.get(index).copied().unwrap_or(match c {
                '°' => 1024,
                '²' => 821,
                '…' => 2048,
                '×' => 1716,
                '∠' => 1836,
                _ => widest,
            }))
        })
        .sum();
    units as f64 / 2048.0 * size
}

/// The longest beginning of the text that fits, marked when it is not the whole.
pub fn fitted(text: &str, height: Height, bold: bool, room: f64) -> String {
    if width(text, height.size(), bold) <= room {
        return text.to_owned();
    }
    let mut short = String::new();
    for c in text.chars() {
        short.push(c);
        if width(&short, height.size(), bold) + height.size() > room {
            short.pop();
            break;
        }
    }
    short.push('…');
    short
}

/// A line of text that begins at `at` (its base line). `class` adds to the height's.
pub fn line(at: PaperPoint, text: impl Into<String>, height: Height, class: &str) -> XmlElement {
    let class = if class.is_empty() { height.class().to_owned() } else { format!("{} {class}", height.class()) };
    XmlElement::new("text").attr("class", class).num("x", at.x).num("y", at.y).text(text)
}

/// A line of text centred on `centre`, turned by `angle` degrees (clockwise on paper).
pub fn centred(centre: PaperPoint, angle: f64, text: impl Into<String>, height: Height, class: &str) -> XmlElement {
    let base = centre + PaperPoint::new(0.0, height.capitals() / 2.0);
    let element = line(base, text, height, &format!("middle {class}"));
    if angle == 0.0 {
        return element;
    }
    let [a, x, y] = [angle, centre.x, centre.y].map(super::xml::number);
    element.attr("transform", format!("rotate({a} {x} {y})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_text_is_cut_to_the_room() {
        assert_eq!(fitted("short", Height::H25, false, 30.0), "short");
        let cut = fitted(&"terminal_three_west ".repeat(5), Height::H25, false, 30.0);
        assert!(cut.ends_with('…') && width(&cut, 3.4, false) <= 30.0, "{cut}");
    }
}
