//! The strip under the drawing: legend, scale bar with axes, title block; and the list of violated rows above it.

use crate::compiled::Compiled;
use crate::emit::paper::PaperPoint;
use crate::emit::plan::MarkKind;
use crate::solve::{Cut, Stage, Status};

use super::place::PaperBox;
use super::sheet::{PaperArea, Sheet, path, path_line, polygon, rectangle};
use super::symbol::{self, Spot};
use super::text::{self, Height};
use super::xml::XmlElement;
use crate::base::number::trimmed;

pub const TITLE_WIDTH: f64 = 180.0;
pub const SCALE_WIDTH: f64 = 56.0;
const ROW: f64 = 4.9;
/// Rows of the list of violations, mm.
const NOTE_ROW: f64 = 4.4;
const MOST_NOTES: usize = 16;

/// What a legend explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Key {
    Track,
    Climb,
    Joint,
    Change,
    Article,
    Unlisted,
    Vertex,
    FixedVertex,
    FixedSection,
    Dimension,
    Radius,
    Wall,
    Obstacle,
    Clearance,
    WallDistance,
    Datum,
    GridAxis,
    Mark(MarkKind),
    /// What equipment with a footprint covers.
    Footprint(MarkKind),
    Conveyor,
    /// Line of a stage, 0 for the written layout.
    Stage(usize),
}

/// A cell of the title block: what it says and how many of the five columns it takes.
pub struct TitleField {
    pub label: String,
    pub value: String,
    pub columns: usize,
    pub warn: bool,
}

pub fn field(label: impl Into<String>, value: impl Into<String>) -> TitleField {
    TitleField { label: label.into(), value: value.into(), columns: 1, warn: false }
}

/// Legend entries in columns.
pub fn legend(sheet: &Sheet, entries: &[(Key, String)]) -> XmlElement {
    let area = PaperArea {
        low: sheet.strip.low,
        high: PaperPoint::new(sheet.strip.high.x - TITLE_WIDTH - SCALE_WIDTH, sheet.strip.high.y),
    };
    let mut group = XmlElement::group("legend").with(rectangle(area.low, area.high, "rule"));
    let rows = ((area.height() - 4.0) / ROW).floor().max(1.0) as usize;
    let columns = entries.len().div_ceil(rows).max(1);
    let wide = (area.width() / columns as f64).min(90.0);
    let lines = entries.len().div_ceil(columns);
    for (i, (key, text)) in entries.iter().enumerate() {
        let (column, row) = (i / lines.max(1), i % lines.max(1));
        let at = area.low + PaperPoint::new(4.0 + wide * column as f64, 4.6 + ROW * row as f64);
        group.push(key_symbol(*key, at));
        let text = text::fitted(text, Height::H18, false, wide - 20.0);
        group.push(text::line(at + PaperPoint::new(15.0, Height::H18.capitals() / 2.0), text, Height::H18, ""));
    }
    group
}

/// The symbol of a legend entry in 12 mm from `at` on.
fn key_symbol(key: Key, at: PaperPoint) -> XmlElement {
    let along = |x: f64, y: f64| at + PaperPoint::new(x, y);
    let line = |class: &str| path(&path_line(at, along(12.0, 0.0)), class);
    let middle = along(6.0, 0.0);
    let band = |half: f64| {
        let corners = [along(0.0, -half), along(12.0, -half), along(12.0, half), along(0.0, half)];
        let edges = path_line(corners[0], corners[1]) + &path_line(corners[3], corners[2]);
        XmlElement::group("key").with(path(&polygon(&corners), "band")).with(path(&edges, "edge"))
    };
    let tick = |reach: f64, class: &str| band(1.3).with(path(&path_line(along(6.0, -reach), along(6.0, reach)), class));
    let sample = |text: &str, height: Height, class: &str| text::centred(middle, 0.0, text, height, class);
    match key {
        Key::Track => band(1.6)
            .with(line("centre"))
            .with(path(&symbol::arrow(along(8.5, 0.0), PaperPoint::new(1.0, 0.0), 3.5, 1.6), "arrow")),
        Key::Climb => band(1.6).with(rectangle(along(0.0, -1.6), along(12.0, 1.6), "climb")),
        Key::Joint => tick(1.3, "joint"),
        Key::Change => tick(2.1, "change"),
        Key::Article => sample("3× A", Height::H18, "quiet"),
        Key::Unlisted => sample("3× A", Height::H18, "warn"),
        Key::Vertex => path(&symbol::cross(middle, 1.5), "vertex"),
        Key::FixedVertex => {
            let square = polygon(&PaperBox::upright(middle, 4.0, 4.0).corners());
            XmlElement::group("key").with(path(&symbol::cross(middle, 1.5), "vertex")).with(path(&square, "fixed"))
        }
        Key::FixedSection => {
            let edges = path_line(along(0.0, -1.3), along(12.0, -1.3)) + &path_line(along(0.0, 1.3), along(12.0, 1.3));
            XmlElement::group("key").with(path(&edges, "fixed"))
        }
        Key::Dimension => {
            let heads = symbol::arrow(along(12.0, 0.6), PaperPoint::new(1.0, 0.0), 2.5, 0.9)
                + &symbol::arrow(along(0.0, 0.6), PaperPoint::new(-1.0, 0.0), 2.5, 0.9);
            let lines = path_line(along(0.0, 0.6), along(12.0, 0.6))
                + &path_line(along(0.0, -1.0), along(0.0, 1.8))
                + &path_line(along(12.0, -1.0), along(12.0, 1.8));
            let text = text::centred(along(6.0, -1.2), 0.0, "1 ∠ 9°", Height::H18, "");
            XmlElement::group("key").with(path(&lines, "dimension")).with(path(&heads, "dimension-arrow")).with(text)
        }
        Key::Radius => sample("R1 9°", Height::H18, ""),
        Key::Wall => {
            let wall = polygon(&[along(0.0, 0.0), along(12.0, 0.0), along(12.0, -1.8), along(0.0, -1.8)]);
            XmlElement::group("key").with(path(&wall, "wall-hatch")).with(line("wall"))
        }
        Key::Obstacle => {
            let (low, high) = (along(0.0, -1.6), along(12.0, 1.6));
            let hatch = rectangle(low, high, "obstacle-hatch");
            XmlElement::group("key").with(hatch).with(rectangle(low, high, "obstacle"))
        }
        Key::WallDistance => {
            let wall = polygon(&[along(12.0, -1.6), along(12.0, 1.6), along(10.8, 1.6), along(10.8, -1.6)]);
            let lines = path_line(along(0.0, 0.0), along(10.8, 0.0));
            let heads = symbol::arrow(along(10.8, 0.0), PaperPoint::new(1.0, 0.0), 2.5, 0.9)
                + &symbol::arrow(at, PaperPoint::new(-1.0, 0.0), 2.5, 0.9);
            XmlElement::group("key")
                .with(path(&wall, "wall-hatch"))
                .with(path(&path_line(along(10.8, -1.6), along(10.8, 1.6)), "wall"))
                .with(path(&path_line(along(0.0, -1.6), along(0.0, 1.6)), "centre"))
                .with(path(&lines, "dimension"))
                .with(path(&heads, "dimension-arrow"))
        }
        Key::Datum => super::setting_out::datum_symbol(middle, 1.6),
        Key::GridAxis => XmlElement::group("key")
            .with(path(&path_line(at, along(8.6, 0.0)), "grid-axis"))
            .with(symbol::circle(along(10.3, 0.0), 1.7, "bubble"))
            .with(text::centred(along(10.3, 0.0), 0.0, "A", Height::H18, "")),
        Key::Clearance => line("clearance"),
        Key::Mark(MarkKind::Motor) => band(1.8).with(rectangle(along(3.0, -0.8), along(9.0, 0.8), "motor")),
        Key::Mark(kind) => {
            // Symbols that stand beside the band are lowered into the row's middle.
            let (drop, half) = match kind {
                MarkKind::Induction | MarkKind::Chute | MarkKind::Station => (1.9, 0.7),
                MarkKind::Photocell => (1.0, 0.2),
                MarkKind::Start => (0.0, 0.0),
                _ => (0.0, 0.7),
            };
            let (along_x, out) = (PaperPoint::new(1.0, 0.0), PaperPoint::new(0.0, -1.0));
            let spot = Spot { at: along(6.0, drop), along: along_x, out, half };
            let edges = path_line(along(0.0, drop - 0.7), along(12.0, drop - 0.7))
                + &path_line(along(0.0, drop + 0.7), along(12.0, drop + 0.7));
            XmlElement::group("key").with(path(&edges, "edge")).with(symbol::mark(kind, &spot, 10.0).0)
        }
        Key::Footprint(kind) => {
            let edges = path_line(along(0.0, 0.8), along(12.0, 0.8)) + &path_line(along(0.0, 2.2), along(12.0, 2.2));
            let outline = polygon(&[along(3.0, 0.8), along(9.0, 0.8), along(9.0, -2.2), along(3.0, -2.2)]);
            XmlElement::group("key").with(path(&edges, "edge")).with(super::track::footprint(kind, &outline))
        }
        Key::Conveyor => super::track::conveyor(along(0.0, 0.0), along(12.0, 0.0)),
        Key::Stage(i) => line(["stage-0", "stage-1", "stage-2", "stage-3"][i.min(3)]),
    }
}

/// A bar of a round length, and the axes.
pub fn scale_bar(sheet: &Sheet) -> XmlElement {
    let right = sheet.strip.high.x - TITLE_WIDTH;
    let area = PaperArea {
        low: PaperPoint::new(right - SCALE_WIDTH, sheet.strip.low.y),
        high: PaperPoint::new(right, sheet.strip.high.y),
    };
    let mut group = XmlElement::group("scale").with(rectangle(area.low, area.high, "rule"));
    group.push(symbol::axes(area.low + PaperPoint::new(8.0, 26.0)));
    // Five parts of 1, 2 or 5 times a power of ten, at most 42 mm in all.
    let most = 42.0 / 5.0 * sheet.scale / 1000.0;
    let mut decade = 1e-4;
    while decade * 10.0 <= most {
        decade *= 10.0;
    }
    let part = [5.0, 2.0, 1.0].into_iter().map(|k| k * decade).find(|part| *part <= most).unwrap_or(decade);
    let low = area.low + PaperPoint::new(6.0, 40.0);
    let mm = sheet.mm(part);
    for i in 0..5 {
        let from = low + PaperPoint::new(mm * f64::from(i), 0.0);
        group.push(rectangle(
            from,
            from + PaperPoint::new(mm, 1.6),
            if i % 2 == 0 { "rule dimension-arrow" } else { "rule" },
        ));
    }
    for i in [0, 1, 5] {
        let at = low + PaperPoint::new(mm * f64::from(i), -2.2);
        let unit = if i == 5 { " m" } else { "" };
        let value = trimmed(part * f64::from(i), 4) + unit;
        group.push(text::centred(at, 0.0, value, Height::H18, ""));
    }
    let note = PaperPoint::new((area.low.x + area.high.x) / 2.0, area.high.y - 7.0);
    group.push(text::centred(note, 0.0, format!("1 : {}", trimmed(sheet.scale, 1)), Height::H35, ""));
    group
}

/// Room for the subject in the title block, mm.
const SUBJECT: f64 = TITLE_WIDTH - 3.6;

/// The subject of a project's drawing: of a project whose name is too long the beginning stays.
pub fn subject_of(project: &str, subject: &str) -> String {
    if project.is_empty() {
        return subject.to_owned();
    }
    let subject = format!(": {subject}");
    let room = SUBJECT - text::width(&subject, Height::H18.size(), false);
    text::fitted(project, Height::H18, false, room) + &subject
}

/// The title block: the layout's name over rows of fields.
pub fn title(sheet: &Sheet, name: &str, subject: &str, rows: &[Vec<TitleField>]) -> XmlElement {
    let low = PaperPoint::new(sheet.strip.high.x - TITLE_WIDTH, sheet.strip.low.y);
    let high = sheet.strip.high;
    let mut group = XmlElement::group("title-block").with(rectangle(low, high, "frame"));
    let head = 14.0;
    let label = |at: PaperPoint, text: &str| text::line(at + PaperPoint::new(1.8, 3.4), text, Height::H18, "quiet");
    group.push(label(low, &text::fitted(subject, Height::H18, false, SUBJECT)));
    let name = text::fitted(name, Height::H50, true, TITLE_WIDTH - 4.0);
    group.push(text::line(low + PaperPoint::new(1.8, 11.4), name, Height::H50, "bold"));
    let tall = (high.y - low.y - head) / rows.len().max(1) as f64;
    let wide = TITLE_WIDTH / 5.0;
    let mut rules = String::new();
    for (i, row) in rows.iter().enumerate() {
        let y = low.y + head + tall * i as f64;
        rules.push_str(&path_line(PaperPoint::new(low.x, y), PaperPoint::new(high.x, y)));
        let mut column = 0;
        for cell in row {
            let at = PaperPoint::new(low.x + wide * column as f64, y);
            if column > 0 {
                rules.push_str(&path_line(at, at + PaperPoint::new(0.0, tall)));
            }
            group.push(label(at, &cell.label));
            let value = text::fitted(&cell.value, Height::H25, cell.warn, wide * cell.columns as f64 - 3.6);
            let class = if cell.warn { "bold warn" } else { "" };
            if !value.is_empty() {
                group.push(text::line(at + PaperPoint::new(1.8, tall - 2.2), value, Height::H25, class));
            }
            column += cell.columns;
        }
    }
    group.push(path(&rules, "rule"));
    group
}

/// What the title block of a general-arrangement drawing says.
pub fn fields(sheet: &Sheet, compiled: &Compiled) -> Vec<Vec<TitleField>> {
    let layout = &compiled.layout;
    let title = &layout.drawing.title;
    let status = match compiled.stages.last().map(|stage| stage.status) {
        Some(Status::Infeasible) => "NOT FEASIBLE",
        Some(Status::Feasible) => "feasible, not converged",
        Some(Status::AsWritten) => "as written",
        Some(Status::Local | Status::BestFound | Status::Proven) => "optimised, feasible",
        None => "",
    };
    let fits = compiled.chain_fits();
    let status = match compiled.stages.last().map(|stage| stage.status) {
        Some(Status::Local | Status::BestFound | Status::Proven) if !fits => "optimised; chain does not fit",
        Some(Status::Feasible) if !fits => "not converged; chain does not fit",
        Some(Status::AsWritten) if !fits => "as written; chain does not fit",
        _ => status,
    };
    let status = match compiled.stages.last().and_then(|stage| stage.cut) {
        // What is longer does not fit into its field.
        Some(Cut::Time) if !fits => "cut: time; chain does not fit".to_owned(),
        Some(Cut::Time) => format!("{status}, cut: time"),
        None => status.to_owned(),
    };
    let status = TitleField { columns: 2, warn: compiled.failed() || !fits, ..field("status", status) };
    let (carts, left) = chain(compiled);
    let left = TitleField { columns: 2, warn: !fits, ..field("left over (take-up compensates)", left) };
    vec![
        vec![
            field("length of track", format!("{} m", trimmed(compiled.length(), 3))),
            field("elements", compiled.bill.count.to_string()),
            field("footprint", format!("{} m²", trimmed(compiled.footprint, 2))),
            field("width of band", format!("{} m", trimmed(layout.width.value, 3))),
            field("speed", format!("{} m/s", trimmed(layout.speed.value, 3))),
        ],
        vec![
            field("cart", layout.cart.name.clone()),
            field("cart length", format!("{} m", trimmed(layout.cart.length, 3))),
            field("catalogue", layout.catalog.name.clone()),
            field("price of elements", format!("{} EUR", trimmed(compiled.bill.price, 2))),
            field("mass of elements", format!("{} kg", trimmed(compiled.bill.mass, 1))),
        ],
        vec![field("carts", carts), left, status],
        vec![
            field("scale", format!("1 : {}", trimmed(sheet.scale, 1))),
            field("sheet", sheet.size),
            field("units", "m, degrees"),
            TitleField { columns: 2, ..field("drawing number", title.number.clone()) },
        ],
        vec![
            field("author", title.author.clone()),
            field("checked", title.checked.clone()),
            field("approved", title.approved.clone()),
            field("revision", title.revision.clone()),
            field("date of revision", title.date.clone()),
        ],
    ]
}

/// How many carts the chain has, and what they leave over beside what the take-up compensates.
fn chain(compiled: &Compiled) -> (String, String) {
    let millimetres = |metres: f64| trimmed(1e3 * metres, 1);
    let take_up = millimetres(compiled.layout.take_up_travel());
    match compiled.chain {
        Some(fit) => (fit.carts.to_string(), format!("{} mm ({take_up} mm)", millimetres(fit.left_over))),
        None => ("none".to_owned(), "no chain closes".to_owned()),
    }
}

/// Height that the list of violated rows needs, mm.
pub fn notes_height(stage: Option<&Stage>) -> f64 {
    stage.map_or(0.0, |stage| 10.0 + NOTE_ROW * lines(stage).div_ceil(2) as f64)
}

fn lines(stage: &Stage) -> usize {
    stage.violations.len().min(MOST_NOTES) + usize::from(stage.violations.len() > MOST_NOTES)
}

/// The rows that a failed stage violates, in two columns.
pub fn notes(sheet: &Sheet, stage: &Stage) -> XmlElement {
    let area = &sheet.notes;
    let inside = PaperPoint::new(0.6, 0.6);
    let mut group = XmlElement::group("violations").with(rectangle(area.low + inside, area.high - inside, "warn-box"));
    let count = stage.violations.len();
    let rows = if count == 1 { "1 row is".to_owned() } else { format!("{count} rows are") };
    let head = format!("NOT FEASIBLE: {rows} violated, by at most {}", amount(stage.max_violation, "m"));
    group.push(text::line(area.low + PaperPoint::new(4.0, 6.2), head, Height::H25, "bold warn"));
    let lines = lines(stage);
    let tall = lines.div_ceil(2).max(1);
    let wide = area.width() / 2.0;
    for i in 0..lines {
        let text = match stage.violations.get(i) {
            Some(violation) if i < MOST_NOTES => {
                format!("{}: {}", violation.row, amount(violation.amount, violation.unit))
            }
            _ => format!("and {} more", count - MOST_NOTES),
        };
        let at = area.low + PaperPoint::new(4.0 + wide * (i / tall) as f64, 11.0 + NOTE_ROW * (i % tall) as f64);
        group.push(text::line(at, text::fitted(&text, Height::H18, false, wide - 8.0), Height::H18, ""));
    }
    group
}

/// A violation as a reader says it: angles in degrees.
fn amount(value: f64, unit: &str) -> String {
    match unit {
        "rad" => format!("{}°", trimmed(value * 180.0 / std::f64::consts::PI, 4)),
        unit => format!("{} {unit}", trimmed(value, 6)),
    }
}
