//! A workbook of plain tables as Office Open XML (ECMA-376), in a ZIP whose parts are stored as they are.
//!
//! Written by hand: libraries that write workbooks bring a compressor whose bytes depend on the processor, which then
//! packs every PNG and PDF of this program, too, and outputs are the same bytes everywhere.

use crate::base::number::shortest;
use std::fmt::Write as _;
use std::io::{Cursor, Write};
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// How a cell looks: an index into the formats of [`styles`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    Plain,
    Title,
    Heading,
    /// `1,234.50`
    Money,
    /// `1,234.500`
    Mass,
    /// `12.3400`
    Metres,
    /// `-7.50`
    Degrees,
    Total,
    TotalMoney,
    TotalMass,
}

/// What a cell holds.
enum Content {
    Text(String),
    Number(f64),
    /// A formula, and what it comes to, for readers that do not calculate.
    Formula(String, f64),
}

/// A table.
pub struct Sheet {
    name: &'static str,
    /// In characters.
    widths: Vec<f64>,
    /// By row, then by column.
    cells: Vec<Vec<(usize, Content, Look)>>,
    /// Row of the headings, from 0, which stays in view; rows that are filtered by them end here.
    head: usize,
    last: usize,
}

impl Sheet {
    /// With headings in a row, from 0, and the columns' widths in characters.
    pub fn new(name: &'static str, head: usize, columns: &[(&str, f64)]) -> Sheet {
        let widths = columns.iter().map(|(_, width)| *width).collect();
        let mut sheet = Sheet { name, widths, cells: Vec::new(), head, last: head };
        for (column, (heading, _)) in columns.iter().enumerate() {
            sheet.text(head, column, heading, Look::Heading);
        }
        sheet
    }

    fn put(&mut self, row: usize, column: usize, content: Content, look: Look) {
        if self.cells.len() <= row {
            self.cells.resize_with(row + 1, Vec::new);
        }
        self.cells[row].push((column, content, look));
    }

    /// Nothing where the text is empty.
    pub fn text(&mut self, row: usize, column: usize, text: &str, look: Look) {
        if !text.is_empty() {
            self.put(row, column, Content::Text(text.to_owned()), look);
        }
    }

    pub fn number(&mut self, row: usize, column: usize, value: f64, look: Look) {
        self.put(row, column, Content::Number(value), look);
    }

    pub fn formula(&mut self, row: usize, column: usize, formula: String, value: f64, look: Look) {
        self.put(row, column, Content::Formula(formula, value), look);
    }

    /// Rows from below the headings to this one are filtered by them.
    pub fn filter_to(&mut self, row: usize) {
        self.last = row;
    }

    fn xml(&self) -> String {
        let mut xml = format!("{HEAD}<worksheet xmlns=\"{MAIN}\"><sheetPr><pageSetUpPr fitToPage=\"1\"/></sheetPr>");
        let below = self.head + 1;
        let _ = write!(
            xml,
            "<sheetViews><sheetView workbookViewId=\"0\"><pane ySplit=\"{below}\" topLeftCell=\"A{}\" activePane=\"bottomLeft\" \
             state=\"frozen\"/></sheetView></sheetViews><cols>",
            below + 1
        );
        for (k, width) in self.widths.iter().enumerate() {
            let column = k + 1;
            let _ = write!(
                xml,
                "<col min=\"{column}\" max=\"{column}\" width=\"{}\" customWidth=\"1\"/>",
                shortest(*width)
            );
        }
        xml.push_str("</cols><sheetData>");
        for (row, cells) in self.cells.iter().enumerate().filter(|(_, cells)| !cells.is_empty()) {
            let _ = write!(xml, "<row r=\"{}\">", row + 1);
            let mut ordered: Vec<_> = cells.iter().collect();
            ordered.sort_by_key(|(column, ..)| *column);
            for (column, content, look) in ordered {
                let place = format!("r=\"{}{}\" s=\"{}\"", letter(*column), row + 1, *look as usize);
                let _ = match content {
                    Content::Text(text) => {
                        write!(
                            xml,
                            "<c {place} t=\"inlineStr\"><is><t xml:space=\"preserve\">{}</t></is></c>",
                            escaped(text)
                        )
                    }
                    Content::Number(value) => write!(xml, "<c {place}><v>{}</v></c>", shortest(*value)),
                    Content::Formula(formula, value) => {
                        write!(xml, "<c {place}><f>{}</f><v>{}</v></c>", escaped(formula), shortest(*value))
                    }
                };
            }
            xml.push_str("</row>");
        }
        let reach = format!("A{}:{}{}", below, letter(self.widths.len().saturating_sub(1)), self.last + 1);
        let _ = write!(
            xml,
            "</sheetData><autoFilter ref=\"{reach}\"/><pageSetup paperSize=\"9\" orientation=\"landscape\" fitToWidth=\"1\" \
             fitToHeight=\"0\"/></worksheet>"
        );
        xml
    }
}

/// A letter for each of the first 26 columns, which tables here do not exceed.
fn letter(column: usize) -> char {
    char::from(b'A' + (column % 26) as u8)
}

/// Without signs that mean something in XML, and without control characters, which it cannot have.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars().filter(|c| !c.is_control() || matches!(c, '\n' | '\t')) {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c => out.push(c),
        }
    }
    out
}

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n";
const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
const RELATIONS: &str = "http://schemas.openxmlformats.org/package/2006/relationships";
const DOCUMENT: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const TYPE: &str = "application/vnd.openxmlformats-officedocument.spreadsheetml";

/// Formats in the order of [`Look`].
fn styles() -> String {
    // Number formats of our own begin at 164; 2 is `0.00`, 4 is `#,##0.00`.
    let cell = |number: usize, font: usize, border: usize, wraps: bool| {
        let wrap = if wraps { "<alignment vertical=\"top\" wrapText=\"1\"/>" } else { "" };
        format!(
            "<xf numFmtId=\"{number}\" fontId=\"{font}\" fillId=\"0\" borderId=\"{border}\" xfId=\"0\" applyNumberFormat=\"1\" \
             applyFont=\"1\" applyBorder=\"1\">{wrap}</xf>"
        )
    };
    let cells = [
        cell(0, 0, 0, false),
        cell(0, 2, 0, false),
        cell(0, 1, 1, true),
        cell(4, 0, 0, false),
        cell(164, 0, 0, false),
        cell(165, 0, 0, false),
        cell(2, 0, 0, false),
        cell(0, 1, 2, false),
        cell(4, 1, 2, false),
        cell(164, 1, 2, false),
    ];
    let font = |size: usize, bold: &str| format!("<font>{bold}<sz val=\"{size}\"/><name val=\"Calibri\"/></font>");
    let border =
        |top: &str, bottom: &str| format!("<border><left/><right/><top{top}/><bottom{bottom}/><diagonal/></border>");
    let thin = " style=\"thin\"";
    format!(
        "{HEAD}<styleSheet xmlns=\"{MAIN}\"><numFmts count=\"2\"><numFmt numFmtId=\"164\" formatCode=\"#,##0.000\"/><numFmt \
         numFmtId=\"165\" formatCode=\"0.0000\"/></numFmts><fonts count=\"3\">{}{}{}</fonts><fills count=\"2\"><fill><patternFill \
         patternType=\"none\"/></fill><fill><patternFill patternType=\"gray125\"/></fill></fills><borders \
         count=\"3\">{}{}{}</borders><cellStyleXfs count=\"1\"><xf numFmtId=\"0\" fontId=\"0\" fillId=\"0\" \
         borderId=\"0\"/></cellStyleXfs><cellXfs count=\"{}\">{}</cellXfs></styleSheet>",
        font(11, ""),
        font(11, "<b/>"),
        font(14, "<b/>"),
        border("", ""),
        border("", thin),
        border(thin, ""),
        cells.len(),
        cells.concat()
    )
}

/// The file of these sheets, with a title and an author. It holds no dates.
///
/// # Errors
///
/// The archive's, which a vector in memory does not make.
pub fn file(sheets: &[Sheet], title: &str, author: &str) -> ZipResult<Vec<u8>> {
    let numbers = || 1..=sheets.len();
    let overrides: String = numbers()
        .map(|k| format!("<Override PartName=\"/xl/worksheets/sheet{k}.xml\" ContentType=\"{TYPE}.worksheet+xml\"/>"))
        .collect();
    let listed: String = sheets
        .iter()
        .enumerate()
        .map(|(k, sheet)| {
            format!("<sheet name=\"{}\" sheetId=\"{n}\" r:id=\"rId{n}\"/>", escaped(sheet.name), n = k + 1)
        })
        .collect();
    let relations: String = numbers()
        .map(|k| {
            format!("<Relationship Id=\"rId{k}\" Type=\"{DOCUMENT}/worksheet\" Target=\"worksheets/sheet{k}.xml\"/>")
        })
        .collect();
    let styles_id = sheets.len() + 1;
    let mut parts = vec![
        (
            "[Content_Types].xml".to_owned(),
            format!(
                "{HEAD}<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"><Default Extension=\"rels\" \
                 ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Default Extension=\"xml\" \
                 ContentType=\"application/xml\"/><Override PartName=\"/xl/workbook.xml\" ContentType=\"{TYPE}.sheet.main+xml\"/><Override \
                 PartName=\"/xl/styles.xml\" ContentType=\"{TYPE}.styles+xml\"/><Override PartName=\"/docProps/core.xml\" \
                 ContentType=\"application/vnd.openxmlformats-package.core-properties+xml\"/>{overrides}</Types>"
            ),
        ),
        (
            "_rels/.rels".to_owned(),
            format!(
                "{HEAD}<Relationships xmlns=\"{RELATIONS}\"><Relationship Id=\"rId1\" Type=\"{DOCUMENT}/officeDocument\" \
                 Target=\"xl/workbook.xml\"/><Relationship Id=\"rId2\" \
                 Type=\"http://schemas.openxmlformats.org/package/2006/relationships/metadata/core-properties\" \
                 Target=\"docProps/core.xml\"/></Relationships>"
            ),
        ),
        (
            "docProps/core.xml".to_owned(),
            format!(
                "{HEAD}<cp:coreProperties xmlns:cp=\"http://schemas.openxmlformats.org/package/2006/metadata/core-properties\" \
                 xmlns:dc=\"http://purl.org/dc/elements/1.1/\"><dc:title>{}</dc:title><dc:creator>{}</dc:creator></cp:coreProperties>",
                escaped(title),
                escaped(author)
            ),
        ),
        (
            "xl/workbook.xml".to_owned(),
            format!("{HEAD}<workbook xmlns=\"{MAIN}\" xmlns:r=\"{DOCUMENT}\"><sheets>{listed}</sheets></workbook>"),
        ),
        (
            "xl/_rels/workbook.xml.rels".to_owned(),
            format!(
                "{HEAD}<Relationships xmlns=\"{RELATIONS}\">{relations}<Relationship Id=\"rId{styles_id}\" Type=\"{DOCUMENT}/styles\" \
                 Target=\"styles.xml\"/></Relationships>"
            ),
        ),
        ("xl/styles.xml".to_owned(), styles()),
    ];
    parts.extend(sheets.iter().enumerate().map(|(k, s)| (format!("xl/worksheets/sheet{}.xml", k + 1), s.xml())));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default());
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in parts {
        archive.start_file(name, options)?;
        archive.write_all(text.as_bytes())?;
    }
    Ok(archive.finish()?.into_inner())
}
