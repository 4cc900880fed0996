//! `bom.xlsx`: the bill of all that is ordered as a workbook, with own article numbers where they are given, and the
//! track's pieces in driving order.

use super::{DrawError, OwnNumbers};
use crate::base::trig;
use crate::compiled::Compiled;
use crate::compiled::order::{self, OrderLine};
use crate::elements::BillLine;
use rust_xlsxwriter::{
    DocProperties, ExcelDateTime, Format, FormatAlign, FormatBorder, Formula, Workbook, Worksheet, XlsxError,
};

/// A row of the bill.
struct Row<'a> {
    group: &'static str,
    article: &'a str,
    description: &'a str,
    count: usize,
    unit_price: Option<f64>,
    price: Option<f64>,
    unit_mass: Option<f64>,
    mass: Option<f64>,
    note: &'static str,
}

impl<'a> Row<'a> {
    fn track(line: &'a BillLine) -> Self {
        Row {
            group: "track",
            article: &line.article,
            description: &line.description,
            count: line.count,
            unit_price: Some(line.unit_price),
            price: Some(line.price),
            unit_mass: Some(line.unit_mass),
            mass: Some(line.mass),
            note: if line.in_catalog { "" } else { "not in the catalogue: an estimate" },
        }
    }

    fn order(line: &'a OrderLine) -> Self {
        Row {
            group: line.group.name(),
            article: line.article.as_deref().unwrap_or_default(),
            description: &line.description,
            count: line.count,
            unit_price: line.unit_price,
            price: line.price(),
            unit_mass: line.unit_mass,
            mass: line.mass(),
            note: if line.unit_price.is_none() { "no price in the layout" } else { "" },
        }
    }
}

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

/// The cells' looks.
struct Looks {
    title: Format,
    heading: Format,
    money: Format,
    mass: Format,
    metres: Format,
    degrees: Format,
    total: [Format; 3],
}

impl Looks {
    fn new() -> Self {
        let total = Format::new().set_bold().set_border_top(FormatBorder::Thin);
        Looks {
            title: Format::new().set_bold().set_font_size(14),
            heading: Format::new()
                .set_bold()
                .set_text_wrap()
                .set_align(FormatAlign::Top)
                .set_border_bottom(FormatBorder::Thin),
            money: Format::new().set_num_format("#,##0.00"),
            mass: Format::new().set_num_format("#,##0.000"),
            metres: Format::new().set_num_format("0.0000"),
            degrees: Format::new().set_num_format("0.00"),
            total: [total.clone(), total.clone().set_num_format("#,##0.00"), total.set_num_format("#,##0.000")],
        }
    }
}

/// The workbook. It holds no dates: the same layout gives the same bytes.
///
/// # Errors
/// [`DrawError::Workbook`] with the writer's words: a text of more than 32,767 characters.
pub fn bill(compiled: &Compiled, own: &OwnNumbers) -> Result<Vec<u8>, DrawError> {
    written(compiled, own).map_err(|why| DrawError::Workbook(why.to_string()))
}

fn written(compiled: &Compiled, own: &OwnNumbers) -> Result<Vec<u8>, XlsxError> {
    let looks = Looks::new();
    let mut workbook = Workbook::new();
    let title = &compiled.layout.drawing.title;
    let undated = ExcelDateTime::from_ymd(1980, 1, 1)?;
    let properties = DocProperties::new().set_creation_datetime(&undated).set_title(&compiled.layout.name);
    workbook.set_properties(&properties.set_author(&title.author));
    bill_sheet(workbook.add_worksheet(), compiled, own, &looks)?;
    pieces_sheet(workbook.add_worksheet(), compiled, own, &looks)?;
    workbook.save_to_buffer()
}

/// Headings in a row, which stays in view, with the columns' widths.
fn head(sheet: &mut Worksheet, row: u32, columns: &[(&str, f64)], looks: &Looks) -> Result<(), XlsxError> {
    for (column, (name, width)) in (0..).zip(columns) {
        sheet.write_with_format(row, column, *name, &looks.heading)?.set_column_width(column, *width)?;
    }
    sheet.set_freeze_panes(row + 1, 0)?.set_repeat_rows(row, row)?.set_landscape().set_paper_size(9);
    sheet.set_print_fit_to_pages(1, 0);
    Ok(())
}

fn bill_sheet(sheet: &mut Worksheet, compiled: &Compiled, own: &OwnNumbers, looks: &Looks) -> Result<(), XlsxError> {
    sheet.set_name("Bill")?;
    let (layout, title) = (&compiled.layout, &compiled.layout.drawing.title);
    sheet.write_with_format(0, 0, &layout.name, &looks.title)?;
    let fields = [
        ("project", title.project.as_str()),
        ("drawing", &title.number),
        ("revision", &title.revision),
        ("date", &title.date),
        ("catalogue", &layout.catalog.name),
    ];
    let said: Vec<String> =
        fields.iter().filter(|(_, text)| !text.is_empty()).map(|(name, text)| format!("{name} {text}")).collect();
    sheet.write(1, 0, said.join(", "))?;
    if compiled.failed() {
        sheet.write(2, 0, "NOT FEASIBLE: this layout must not be ordered")?;
    }
    const HEAD: u32 = 3;
    head(sheet, HEAD, &BILL, looks)?;
    let lines = order::lines(compiled);
    let rows: Vec<Row> = compiled.bill.lines.iter().map(Row::track).chain(lines.iter().map(Row::order)).collect();
    let mut at = HEAD + 1;
    for row in &rows {
        sheet.write(at, 0, row.group)?.write(at, 1, row.article)?.write(at, 3, row.description)?;
        sheet.write(at, 2, own.of(row.article).unwrap_or_default())?;
        sheet.write(at, 4, row.count as f64)?.write(at, 9, row.note)?;
        // Products of the cells before, so that a count may be changed; with results, for readers that do not calculate.
        for (column, unit, all, look) in
            [(5, row.unit_price, row.price, &looks.money), (7, row.unit_mass, row.mass, &looks.mass)]
        {
            if let (Some(unit), Some(all)) = (unit, all) {
                let letter = if column == 5 { 'F' } else { 'H' };
                let product = Formula::new(format!("=E{row}*{letter}{row}", row = at + 1)).set_result(all.to_string());
                sheet.write_with_format(at, column, unit, look)?;
                sheet.write_formula_with_format(at, column + 1, product, look)?;
            }
        }
        at += 1;
    }
    let last = at - 1;
    sheet.autofilter(HEAD, 0, last, BILL.len() as u16 - 1)?;
    sheet.write_with_format(at, 3, "Sum of what has a price", &looks.total[0])?;
    let sums = [
        (6, 'G', rows.iter().filter_map(|r| r.price).sum::<f64>(), 100.0, &looks.total[1]),
        (8, 'I', rows.iter().filter_map(|r| r.mass).sum::<f64>(), 1000.0, &looks.total[2]),
    ];
    for (column, letter, sum, units, look) in sums {
        let sum = (sum * units).round() / units;
        let formula =
            Formula::new(format!("=SUM({letter}{}:{letter}{})", HEAD + 2, last + 1)).set_result(sum.to_string());
        sheet.write_formula_with_format(at, column, formula, look)?;
    }
    Ok(())
}

fn pieces_sheet(sheet: &mut Worksheet, compiled: &Compiled, own: &OwnNumbers, looks: &Looks) -> Result<(), XlsxError> {
    sheet.set_name("In driving order")?;
    head(sheet, 0, &PIECES, looks)?;
    let origin = compiled.layout.drawing.origin;
    for (at, piece) in (1..).zip(&compiled.pieces) {
        let place = &piece.place;
        let begin = if compiled.raised() { compiled.space.from_plan(place.s) } else { place.s };
        let straight =
            matches!(piece.part, crate::elements::Part::Straight { .. } | crate::elements::Part::Vertical { .. });
        let name = if straight {
            compiled.layout.section_name(place.vertex)
        } else {
            format!("curve at {}", compiled.layout.vertices[place.vertex].name)
        };
        sheet.write(at, 0, at)?.write(at, 1, name)?.write(at, 4, &piece.article)?;
        sheet.write(at, 5, own.of(&piece.article).unwrap_or_default())?;
        for (column, metres) in [
            (2, compiled.round_trip(begin - compiled.start())),
            (3, piece.part.length()),
            (6, place.position.x - origin.x),
            (7, place.position.y - origin.y),
        ] {
            sheet.write_with_format(at, column, (metres * 1e6).round() / 1e6 + 0.0, &looks.metres)?;
        }
        let heading = (trig::wrap(place.heading).to_degrees() * 1e4).round() / 1e4 + 0.0;
        sheet.write_with_format(at, 8, heading, &looks.degrees)?;
    }
    sheet.autofilter(0, 0, compiled.pieces.len() as u32, PIECES.len() as u16 - 1)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::emit::own_numbers;
    use crate::emit::plan::samples;
    use crate::model::{Article, fixture};
    use calamine::{Data, Range, Reader, Xlsx};
    use std::io::Cursor;

    fn sheets(bytes: Vec<u8>) -> Vec<(String, Range<Data>)> {
        Xlsx::new(Cursor::new(bytes)).unwrap().worksheets()
    }

    fn number(range: &Range<Data>, row: usize, column: usize) -> f64 {
        match range.get((row, column)) {
            Some(Data::Float(value)) => *value,
            Some(Data::Int(value)) => *value as f64,
            other => panic!("{row} {column}: {other:?}"),
        }
    }

    #[test]
    fn another_reader_finds_lines_sums_and_own_numbers() {
        let mut layout = samples::ten_vertices().layout;
        layout.cart.article = Article { number: Some("TT".into()), price: Some(770.0), mass: None };
        layout.catalog.support = Article { number: Some("SU".into()), price: Some(145.5), mass: Some(17.0) };
        let compiled = compile(layout);
        let own = own_numbers(b"ST-3000;100.1\nTT-1250;200.7\n").unwrap();
        let bytes = bill(&compiled, &own).unwrap();
        assert_eq!(bytes, bill(&compiled, &own).unwrap());
        let sheets = sheets(bytes);
        let [(first, lines), (second, pieces)] = &sheets[..] else { panic!("{}", sheets.len()) };
        assert_eq!((first.as_str(), second.as_str()), ("Bill", "In driving order"));
        let text = |range: &Range<Data>, row: usize, column: usize| range.get((row, column)).unwrap().to_string();
        let order = order::lines(&compiled);
        let count = compiled.bill.lines.len() + order.len();
        let (mut price, mut mass) = (compiled.bill.price, compiled.bill.mass);
        for (k, line) in order.iter().enumerate() {
            let row = 4 + compiled.bill.lines.len() + k;
            assert_eq!(
                (text(lines, row, 0), text(lines, row, 3)),
                (line.group.name().into(), line.description.clone())
            );
            assert_eq!(number(lines, row, 4) as usize, line.count);
            if let Some(unit) = line.unit_price {
                assert!((number(lines, row, 6) - unit * line.count as f64).abs() < 0.005, "{line:?}");
            }
            price += line.price().unwrap_or(0.0);
            mass += line.mass().unwrap_or(0.0);
        }
        // Under the last line.
        assert!((number(lines, 4 + count, 6) - price).abs() < 0.006, "{price}");
        assert!((number(lines, 4 + count, 8) - mass).abs() < 6e-4, "{mass}");
        let own_of = |article: &str| {
            let row = (4..4 + count).find(|row| text(lines, *row, 1) == article).unwrap();
            text(lines, row, 2)
        };
        assert_eq!((own_of("ST-3000"), own_of("TT-1250"), own_of("SU")), ("100.1".into(), "200.7".into(), "".into()));
        assert_eq!(pieces.height() - 1, compiled.bill.count);
        let length: f64 = (1..pieces.height()).map(|row| number(pieces, row, 3)).sum();
        assert!((length - compiled.length()).abs() < 1e-3, "{length}");
    }

    #[test]
    fn what_must_not_be_ordered_says_so() {
        let sheets = sheets(bill(&samples::failed(), &OwnNumbers::default()).unwrap());
        assert!(sheets[0].1.get((2, 0)).unwrap().to_string().starts_with("NOT FEASIBLE"));
        let layout = compile(fixture::rectangle(20.0, 10.5, 4.0));
        let sheets = super::tests::sheets(bill(&layout, &OwnNumbers::default()).unwrap());
        assert_eq!(sheets[0].1.get((2, 0)), Some(&Data::Empty));
    }
}
