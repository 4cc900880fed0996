//! `bom.xlsx`: the bill of all that is ordered as a workbook, with own article numbers where they are given, and the
//! track's pieces in driving order.

mod workbook;

use super::bill_row::BillRow;
use super::{DrawError, OwnNumbers};
use crate::base::trig;
use crate::compiled::Compiled;
use crate::elements::Part;
use workbook::{Look, Sheet};

/// Headings of the bill, with the columns' widths in characters.
const BILL: [(&str, f64); 10] = [
    ("Group", 10.0),
    ("Article", 18.0),
    ("Own number", 18.0),
    ("Description", 44.0),
    ("Count", 8.0),
    ("Unit price, EUR", 15.0),
    ("Price, EUR", 14.0),
    ("Unit mass, kg", 14.0),
    ("Mass, kg", 12.0),
    ("Note", 32.0),
];

/// Headings of the pieces in driving order.
const PIECES: [(&str, f64); 9] = [
    ("No.", 6.0),
    ("Section or curve", 20.0),
    ("s, m", 11.0),
    ("Length, m", 11.0),
    ("Article", 18.0),
    ("Own number", 18.0),
    ("x, m", 11.0),
    ("y, m", 11.0),
    ("Heading, deg", 13.0),
];

/// The workbook. It holds no dates: the same layout gives the same bytes.
///
/// # Errors
/// [`DrawError::Workbook`] with the archive's words.
pub fn bill(compiled: &Compiled, own: &OwnNumbers) -> Result<Vec<u8>, DrawError> {
    let sheets = [bill_sheet(compiled, own), pieces_sheet(compiled, own)];
    let author = &compiled.layout.drawing.title.author;
    workbook::file(&sheets, &compiled.layout.name, author).map_err(|why| DrawError::Workbook(why.to_string()))
}

/// Row of the bill's headings, from 0.
const HEAD: usize = 3;

fn bill_sheet(compiled: &Compiled, own: &OwnNumbers) -> Sheet {
    let mut sheet = Sheet::new("Bill", HEAD, &BILL);
    let (layout, title) = (&compiled.layout, &compiled.layout.drawing.title);
    sheet.text(0, 0, &layout.name, Look::Title);
    let fields = [
        ("project", title.project.as_str()),
        ("drawing", &title.number),
        ("revision", &title.revision),
        ("date", &title.date),
        ("catalogue", &layout.catalog.name),
    ];
    let said: Vec<String> =
        fields.iter().filter(|(_, text)| !text.is_empty()).map(|(name, text)| format!("{name} {text}")).collect();
    sheet.text(1, 0, &said.join(", "), Look::Plain);
    if compiled.failed() {
        sheet.text(2, 0, "NOT FEASIBLE: this layout must not be ordered", Look::Title);
    }
    let rows = BillRow::all(compiled);
    for (at, row) in (HEAD + 1..).zip(&rows) {
        let number = own.of(&row.article).unwrap_or_default();
        for (column, text) in [(0, row.group), (1, &row.article), (2, number), (3, &row.description), (9, row.note)] {
            sheet.text(at, column, text, Look::Plain);
        }
        sheet.number(at, 4, row.count as f64, Look::Plain);
        // Products of the cells before, so that a count may be changed.
        for (column, unit, all, look) in
            [(5, row.unit_price, row.price, Look::Money), (7, row.unit_mass, row.mass, Look::Mass)]
        {
            if let (Some(unit), Some(all)) = (unit, all) {
                let letter = if column == 5 { 'F' } else { 'H' };
                sheet.number(at, column, unit, look);
                sheet.formula(at, column + 1, format!("E{row}*{letter}{row}", row = at + 1), all, look);
            }
        }
    }
    let last = HEAD + rows.len();
    sheet.filter_to(last);
    sheet.text(last + 1, 3, "Sum of what has a price", Look::Total);
    let (price, mass) = BillRow::sums(&rows);
    for (column, letter, sum, look) in [(6, 'G', price, Look::TotalMoney), (8, 'I', mass, Look::TotalMass)] {
        sheet.formula(last + 1, column, format!("SUM({letter}{}:{letter}{})", HEAD + 2, last + 1), sum, look);
    }
    sheet
}

fn pieces_sheet(compiled: &Compiled, own: &OwnNumbers) -> Sheet {
    let mut sheet = Sheet::new("In driving order", 0, &PIECES);
    let origin = compiled.layout.drawing.origin;
    for (at, piece) in (1..).zip(&compiled.pieces) {
        let place = &piece.place;
        let straight = matches!(piece.part, Part::Straight { .. } | Part::Vertical { .. });
        let name = if straight {
            compiled.layout.section_name(place.vertex)
        } else {
            format!("curve at {}", compiled.layout.vertices[place.vertex].name)
        };
        sheet.number(at, 0, at as f64, Look::Plain);
        let number = own.of(&piece.article).unwrap_or_default();
        for (column, text) in [(1, name.as_str()), (4, &piece.article), (5, number)] {
            sheet.text(at, column, text, Look::Plain);
        }
        for (column, metres) in [
            (2, compiled.past_start(place.s)),
            (3, piece.part.length()),
            (6, place.position.x - origin.x),
            (7, place.position.y - origin.y),
        ] {
            sheet.number(at, column, (metres * 1e6).round() / 1e6 + 0.0, Look::Metres);
        }
        let heading = (trig::wrap(place.heading).to_degrees() * 1e4).round() / 1e4 + 0.0;
        sheet.number(at, 8, heading, Look::Degrees);
    }
    sheet.filter_to(compiled.pieces.len());
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::compiled::order;
    use crate::emit::own_numbers;
    use crate::emit::plan::samples;
    use crate::model::{Article, fixture};
    use serde_json::Value;
    use std::io::Write;
    use std::process::{Command, Stdio};

    /// Reads a workbook from standard input and prints its sheets as JSON: cells as formulas, and as values.
    const SCRIPT: &str = r#"
import io, json, sys
data = sys.stdin.buffer.read()
try:
    import openpyxl
except ImportError:
    print("missing"); sys.exit(0)
read = lambda values: openpyxl.load_workbook(io.BytesIO(data), data_only=values)
cells = lambda book: {s.title: [list(row) for row in s.iter_rows(values_only=True)] for s in book.worksheets}
book = read(False)
print(json.dumps({"formulas": cells(book), "values": cells(read(True)), "title": book.properties.title,
    "frozen": book["Bill"].freeze_panes, "filter": book["Bill"].auto_filter.ref, "format": book["Bill"]["F5"].number_format}))
"#;

    /// What another reader finds; `None`, and a word of it, where there is none.
    fn read(bytes: &[u8]) -> Option<Value> {
        let child = Command::new("python3").args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let Ok(mut child) = child else {
            println!("skipped: python3 is not there");
            return None;
        };
        child.stdin.take().unwrap().write_all(bytes).unwrap();
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        if text.starts_with("missing") {
            println!("skipped: openpyxl is not there");
            return None;
        }
        Some(serde_json::from_str(&text).unwrap())
    }

    #[test]
    fn another_reader_finds_lines_sums_and_own_numbers() {
        let mut layout = samples::ten_vertices().layout;
        layout.name = "hall <1> & \"2\"".into();
        layout.cart.article = Article { number: Some("TT".into()), price: Some(770.0), mass: None };
        layout.catalog.support = Article { number: Some("SU".into()), price: Some(145.5), mass: Some(17.0) };
        let compiled = compile(layout);
        let own = own_numbers(b"ST-3000;100.1\nTT-1250;200.7\n").unwrap();
        let bytes = bill(&compiled, &own).unwrap();
        assert_eq!(bytes, bill(&compiled, &own).unwrap());
        let Some(found) = read(&bytes) else { return };
        assert_eq!(found["title"], compiled.layout.name.as_str());
        let (lines, pieces) = (&found["values"]["Bill"], &found["values"]["In driving order"]);
        assert_eq!(lines[0][0], compiled.layout.name.as_str());
        let order = order::lines(&compiled);
        let count = compiled.bill.lines.len() + order.len();
        assert_eq!((&found["frozen"], &found["filter"]), (&"A5".into(), &format!("A4:J{}", 4 + count).into()));
        assert_eq!(found["format"], "#,##0.00");
        let (mut price, mut mass) = (compiled.bill.price, compiled.bill.mass);
        for (k, line) in order.iter().enumerate() {
            let row = 4 + compiled.bill.lines.len() + k;
            assert_eq!(lines[row][0], line.group.name());
            assert_eq!(lines[row][3], line.description.as_str());
            assert_eq!(lines[row][4].as_f64(), Some(line.count as f64));
            if let Some(unit) = line.unit_price {
                assert!((lines[row][6].as_f64().unwrap() - unit * line.count as f64).abs() < 0.005, "{line:?}");
                assert_eq!(found["formulas"]["Bill"][row][6], format!("=E{n}*F{n}", n = row + 1));
            }
            price += line.price().unwrap_or(0.0);
            mass += line.mass().unwrap_or(0.0);
        }
        // Under the last line.
        assert!((lines[4 + count][6].as_f64().unwrap() - price).abs() < 0.006, "{price}");
        assert!((lines[4 + count][8].as_f64().unwrap() - mass).abs() < 6e-4, "{mass}");
        assert_eq!(found["formulas"]["Bill"][4 + count][6], format!("=SUM(G5:G{})", 4 + count));
        let own_of = |article: &str| {
            let row = (4..4 + count).find(|row| lines[*row][1] == article).unwrap();
            lines[row][2].clone()
        };
        assert_eq!((own_of("ST-3000"), own_of("TT-1250")), ("100.1".into(), "200.7".into()));
        assert_eq!(own_of("SU"), Value::Null);
        let pieces = pieces.as_array().unwrap();
        assert_eq!(pieces.len() - 1, compiled.bill.count);
        let length: f64 = pieces[1..].iter().map(|row| row[3].as_f64().unwrap()).sum();
        assert!((length - compiled.length()).abs() < 1e-3, "{length}");
    }

    #[test]
    fn what_must_not_be_ordered_says_so() {
        for (compiled, warns) in [(samples::failed(), true), (compile(fixture::rectangle(20.0, 10.5, 4.0)), false)] {
            let Some(found) = read(&bill(&compiled, &OwnNumbers::default()).unwrap()) else { return };
            let warning = found["values"]["Bill"][2][0].as_str().unwrap_or_default();
            assert_eq!(warning.starts_with("NOT FEASIBLE"), warns, "{warning}");
        }
    }
}
