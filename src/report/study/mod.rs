//! The page of a study: which result changes most, every result against every parameter in small pictures, and the table.

mod lead;

use crate::base::number::{fixed, significant, tick_labels, ticks};
use crate::report::style::document;
use crate::signal::Channel;
use crate::study::State;
use crate::study::table::{Cells, Column, Role, Table};
use maud::{Markup, html};
use std::collections::{BTreeMap, BTreeSet};

/// Rows of the table that are shown; the files have all.
const ROWS: usize = 1000;
/// Columns of results that are shown in the table, and pictures against a parameter.
const COLUMNS: usize = 40;
const PICTURES: usize = 60;
/// Rows up to which each has a point in pictures; of more, the least, the largest and the mean are drawn.
const POINTS: usize = 400;

/// Size of a picture, px, and its margins.
const WIDTH: f64 = 320.0;
const HEIGHT: f64 = 215.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 20.0;
const BELOW: f64 = 40.0;

/// Rules beyond the house style sheet.
const STYLE: &str = ".small { display: grid; grid-template-columns: repeat(auto-fill, minmax(280px, 1fr)); gap: 8px 20px; } \
    figure.first { max-width: 420px; margin: 8px 0; } .small figure { margin: 4px 0; } .small figcaption { overflow-wrap: anywhere; } \
    .dot { fill: var(--trace); fill-opacity: .55; } .range { stroke: var(--fill); stroke-width: 3; } \
    tr.failed td, tr.open td { color: var(--soft); } ";

/// The page of a table.
pub fn page(table: &Table) -> String {
    let varying = |role: Role| table.columns.iter().filter(move |c| c.role == role && c.cells.varies());
    let parameters: Vec<&Column> = varying(Role::Parameter).collect();
    let all: Vec<&Column> = varying(Role::Result).collect();
    // What a layout costs that must not be built is no result to compare.
    let infeasible = infeasible(table);
    let comparable: Vec<Column> = all.iter().map(|column| without(column, &infeasible)).collect();
    let results: Vec<&Column> = comparable.iter().filter(|column| lead::differs(column)).collect();
    let states: Vec<String> = table.states().collect();
    let count = |state: State| states.iter().filter(|name| *name == state.name()).count();
    let counts: Vec<String> = [State::Done, State::Failed, State::Open]
        .into_iter()
        .filter(|state| count(*state) > 0)
        .map(|state| format!("{} {}", count(state), state.name()))
        .collect();
    let mut rules = STYLE.to_owned();
    for k in 0..parameters.len() {
        rules += &format!(".views > #by-{k}:checked ~ .by-{k} {{ display: block; }} ");
    }
    let body = html! {
        h1 { (table.name) }
        p.lead { (table.rows) @if table.rows == 1 { " task: " } @else { " tasks: " } (counts.join(", ")) "." }
        @if !infeasible.is_empty() {
            p {
                b {
                    (infeasible.len()) " of the layouts " @if infeasible.len() == 1 { "is" } @else { "are" }
                    " not feasible and must not be built."
                }
                " What is said and drawn here leaves " @if infeasible.len() == 1 { "it" } @else { "them" }
                " out; the table of tasks has all."
            }
        }
        @for sentence in lead::sentences(&parameters, &results) { p { (sentence) } }
        @if let Some((parameter, result)) = lead::first(&parameters, &results) {
            @if let Cells::Numbers(cells) = &result.cells {
                figure.first {
                    figcaption { b { (result.name) } " against " (parameter.name) }
                    (picture(parameter, cells, unit(result)))
                }
            }
        }
        @if !parameters.is_empty() && !results.is_empty() { (pictures(&parameters, &results)) }
        (rows(table, &parameters, &all, &states))
        (constant(table))
    };
    document(&table.name, &rules, &body)
}

/// Rows whose layout misses a constraint.
fn infeasible(table: &Table) -> BTreeSet<usize> {
    let told = table.columns.iter().filter(|c| c.role == Role::Result && c.name.ends_with(".feasible"));
    let missed = |column: &Column| match &column.cells {
        Cells::Truths(cells) => (0..cells.len()).filter(|row| cells[*row] == Some(false)).collect::<Vec<_>>(),
        _ => Vec::new(),
    };
    told.flat_map(missed).collect()
}

/// A column of results with nothing in some rows.
fn without(column: &Column, rows: &BTreeSet<usize>) -> Column {
    fn emptied<T>(cells: &mut [Option<T>], rows: &BTreeSet<usize>) {
        rows.iter().for_each(|row| cells[*row] = None);
    }
    let mut column = column.clone();
    match &mut column.cells {
        Cells::Numbers(cells) => emptied(cells, rows),
        Cells::Truths(cells) => emptied(cells, rows),
        Cells::Texts(cells) => emptied(cells, rows),
    }
    column
}

fn with_unit(column: &Column) -> String {
    let unit = unit(column);
    if unit.is_empty() { column.name.clone() } else { format!("{}, {unit}", column.name) }
}

/// The unit of a column: its own, else that of the channel in its name, else the one that its name ends with.
fn unit(column: &Column) -> &str {
    const ENDS: [(&str, &str); 13] = [
        ("_m2", "m²"),
        ("_mm", "mm"),
        ("_kg", "kg"),
        ("_eur", "EUR"),
        ("_rad", "rad"),
        ("_deg", "°"),
        ("_hz", "Hz"),
        ("_db", "dB"),
        ("_m", "m"),
        ("_n", "N"),
        ("_N", "N"),
        ("_s", "s"),
        ("_h", "h"),
    ];
    if !column.unit.is_empty() {
        return &column.unit;
    }
    let channel = column.name.split('.').find_map(Channel::from_name).map(Channel::unit);
    let end = || ENDS.iter().find(|(end, _)| column.name.ends_with(end)).map(|(_, unit)| *unit);
    channel.or_else(end).unwrap_or_default()
}

fn pictures(parameters: &[&Column], results: &[&Column]) -> Markup {
    // A result at one value of a parameter says nothing of it.
    let drawn = |parameter: &Column| -> Vec<(&Column, &[Option<f64>])> {
        let numbers = results.iter().filter_map(|column| match &column.cells {
            Cells::Numbers(cells) => Some((*column, cells.as_slice())),
            _ => None,
        });
        numbers.filter(|(_, cells)| lead::values(parameter, cells) > 1).collect()
    };
    let views: Vec<_> = parameters.iter().map(|parameter| (parameter, drawn(parameter))).collect();
    let views: Vec<_> = views.into_iter().filter(|(_, drawn)| !drawn.is_empty()).collect();
    if views.is_empty() {
        return html! {};
    }
    html! {
        h2 { "Results against parameters" }
        p.note { "The line goes through the means of the tasks with one value of the parameter; bars reach from the least to the largest of them." }
        div.views {
            @for (k, (parameter, _)) in views.iter().enumerate() {
                input type="radio" name="by" id=(format!("by-{k}")) checked[k == 0];
                label for=(format!("by-{k}")) { "against " (parameter.name) }
            }
            @for (k, (parameter, drawn)) in views.iter().enumerate() {
                div class=(format!("view by-{k}")) {
                    div.small {
                        @for (column, cells) in drawn.iter().take(PICTURES) {
                            figure {
                                figcaption { b { (column.name) } }
                                (picture(parameter, cells, unit(column)))
                            }
                        }
                    }
                    @if drawn.len() > PICTURES {
                        p.note { (drawn.len() - PICTURES) " more results vary; study.csv and study.parquet have them." }
                    }
                }
            }
        }
    }
}

/// Places of a parameter's values along a picture, and what stands under them.
struct Across {
    /// Of each row.
    at: Vec<Option<f64>>,
    low: f64,
    high: f64,
    labels: Vec<(f64, String)>,
}

impl Across {
    fn new(parameter: &Column) -> Across {
        if let Cells::Numbers(cells) = &parameter.cells {
            let low = cells.iter().flatten().copied().fold(f64::INFINITY, f64::min);
            let high = cells.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
            let ticks = ticks(low, high, 5.0);
            let labels = ticks.iter().copied().zip(tick_labels(&ticks)).collect();
            return Across { at: cells.clone(), low, high, labels };
        }
        // Texts stand in the order in which they come.
        let mut order: Vec<String> = Vec::new();
        let rows = match &parameter.cells {
            Cells::Numbers(_) => 0,
            Cells::Truths(cells) => cells.len(),
            Cells::Texts(cells) => cells.len(),
        };
        let at = (0..rows)
            .map(|row| {
                let text = parameter.cells.text(row);
                if text.is_empty() {
                    return None;
                }
                let k = order.iter().position(|known| *known == text).unwrap_or(order.len());
                if k == order.len() {
                    order.push(text);
                }
                Some(k as f64)
            })
            .collect();
        /// Characters that fit under a picture, over all labels.
        const FIT: usize = 44;
        let each = (FIT / order.len().max(1)).max(3);
        let every = order.len().div_ceil(10).max(1);
        let labels = order.iter().enumerate().filter(|(k, _)| k % every == 0);
        let labels = labels.map(|(k, text)| (k as f64, shortened(text, each * every))).collect();
        Across { at, low: -0.5, high: order.len() as f64 - 0.5, labels }
    }
}

/// The end of a text, where names of files differ.
fn shortened(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        text.to_owned()
    } else {
        format!("…{}", text.chars().skip(count + 1 - most).collect::<String>())
    }
}

fn picture(parameter: &Column, cells: &[Option<f64>], unit: &str) -> Markup {
    let across = Across::new(parameter);
    let points: Vec<(f64, f64)> =
        across.at.iter().zip(cells).filter_map(|(x, y)| Some(((*x)?, (*y)?))).filter(|p| p.1.is_finite()).collect();
    let low = points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
    if points.is_empty() {
        return html! { p.note { "no task has both" } };
    }
    let pad = if high > low { 0.06 * (high - low) } else { 0.5 * low.abs().max(1.0) };
    let (bottom, top) = (low - pad, high + pad);
    let wide = (across.high - across.low).max(f64::MIN_POSITIVE);
    let x = |v: f64| {
        if across.high > across.low {
            LEFT + 6.0 + (WIDTH - LEFT - RIGHT - 12.0) * (v - across.low) / wide
        } else {
            (LEFT + WIDTH - RIGHT) / 2.0
        }
    };
    let y = |v: f64| HEIGHT - BELOW - (HEIGHT - TOP - BELOW) * (v - bottom) / (top - bottom);
    // Least, largest, sum and number at each place; places are told apart by their bits, in order.
    let mut groups: BTreeMap<i64, (f64, f64, f64, f64, f64)> = BTreeMap::new();
    for (at, value) in &points {
        let bits = at.to_bits() as i64;
        let key = if bits < 0 { i64::MIN.wrapping_sub(bits) } else { bits };
        let group = groups.entry(key).or_insert((*at, *value, *value, 0.0, 0.0));
        *group = (*at, group.1.min(*value), group.2.max(*value), group.3 + value, group.4 + 1.0);
    }
    let means: Vec<String> =
        groups.values().map(|g| format!("{},{}", fixed(x(g.0), 1), fixed(y(g.3 / g.4), 1))).collect();
    let marks = ticks(bottom, top, 5.0);
    let is_number = matches!(parameter.cells, Cells::Numbers(_));
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
            @for (mark, label) in marks.iter().zip(tick_labels(&marks)) {
                line.axis x1=(LEFT) x2=(WIDTH - RIGHT) y1=(fixed(y(*mark), 1)) y2=(fixed(y(*mark), 1)) {}
                text.tick x=(LEFT - 5.0) y=(fixed(y(*mark) + 4.0, 1)) text-anchor="end" { (label) }
            }
            @for (at, label) in &across.labels {
                text.tick x=(fixed(x(*at), 1)) y=(HEIGHT - 24.0) text-anchor="middle" { (label) }
            }
            text.tick x=(LEFT - 5.0) y=(TOP - 8.0) text-anchor="end" { (unit) }
            text.tick x=((LEFT + WIDTH - RIGHT) / 2.0) y=(HEIGHT - 6.0) text-anchor="middle" {
                (shortened(&with_unit(parameter), 44))
            }
            @for g in groups.values().filter(|g| g.2 > g.1) {
                line.range x1=(fixed(x(g.0), 1)) x2=(fixed(x(g.0), 1)) y1=(fixed(y(g.1), 1)) y2=(fixed(y(g.2), 1)) {}
            }
            @if is_number && means.len() > 1 { path.trace d=(format!("M{}", means.join("L"))) {} }
            @if points.len() <= POINTS {
                @for (at, value) in &points { circle.dot cx=(fixed(x(*at), 1)) cy=(fixed(y(*value), 1)) r="2.5" {} }
            }
        }
    }
}

fn cell(column: &Column, row: usize) -> Markup {
    match &column.cells {
        Cells::Numbers(cells) => html! {
            td.number { @if let Some(x) = cells.get(row).copied().flatten() { (significant(x, 6)) } }
        },
        _ => html! { td { (column.cells.text(row)) } },
    }
}

fn rows(table: &Table, parameters: &[&Column], results: &[&Column], states: &[String]) -> Markup {
    let about = |name: &str| table.columns.iter().find(|c| c.role == Role::About && c.name == name);
    let mut columns: Vec<&Column> = Vec::new();
    columns.extend(about("sweep").filter(|column| column.cells.varies()));
    columns.extend(about("task"));
    columns.extend(about("status").filter(|column| column.cells.varies()));
    columns.extend(parameters);
    columns.extend(results.iter().take(COLUMNS));
    columns.extend(about("error").filter(|column| column.cells.varies()));
    html! {
        h2 { "Tasks" }
        @if results.len() > COLUMNS || table.rows > ROWS {
            p.note {
                @if table.rows > ROWS { "The first " (ROWS) " of " (table.rows) " tasks. " }
                @if results.len() > COLUMNS { (COLUMNS) " of " (results.len()) " results that vary. " }
                "study.csv and study.parquet have all of it."
            }
        }
        div.scroll { table {
            thead { tr { @for column in &columns { th { (with_unit(column)) } } } }
            tbody { @for row in 0..table.rows.min(ROWS) {
                tr class=(states.get(row).map_or("", String::as_str)) { @for column in &columns { (cell(column, row)) } }
            } }
        } }
    }
}

/// What is the same in all tasks.
fn constant(table: &Table) -> Markup {
    let same: Vec<&Column> = table
        .columns
        .iter()
        .filter(|c| c.role != Role::About && !c.cells.varies() && !c.cells.text(0).is_empty())
        .collect();
    html! {
        @if !same.is_empty() && table.rows > 0 {
            h2 { "The same in all tasks" }
            details { summary.note { (same.len()) " columns" }
                table { tbody { @for column in &same { tr { td { (with_unit(column)) } (cell(column, 0)) } } } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, role: Role, cells: Cells) -> Column {
        Column { name: name.into(), role, unit: String::new(), cells }
    }

    fn table() -> Table {
        let texts =
            |all: &[&str]| Cells::Texts(all.iter().map(|t| Some((*t).to_owned()).filter(|t| !t.is_empty())).collect());
        Table {
            name: "speeds <b>".into(),
            rows: 4,
            columns: vec![
                column("sweep", Role::About, texts(&["a", "a", "a", "a"])),
                column("task", Role::About, texts(&["1", "2", "3", "4"])),
                column("status", Role::About, texts(&["done", "done", "done", "failed"])),
                column("file", Role::Parameter, texts(&["a.lss", "a.lss", "b.lss", "b.lss"])),
                column(
                    "simulate.speed",
                    Role::Parameter,
                    Cells::Numbers(vec![Some(-1.0), Some(2.0), Some(2.0), Some(3.0)]),
                ),
                column("build.carts", Role::Result, Cells::Numbers(vec![Some(3.0), Some(3.0), Some(3.0), Some(3.0)])),
                column("x.peak", Role::Result, Cells::Numbers(vec![Some(10.0), Some(20.0), Some(30.0), None])),
                column("error", Role::About, texts(&["", "", "", "it broke"])),
            ],
        }
    }

    #[test]
    fn every_result_that_varies_is_drawn_against_every_parameter_that_does() {
        let page = page(&table());
        assert_eq!(page.matches("<svg").count(), 3, "one result, two parameters, and first of all what changes most");
        assert!(page.contains("4 tasks: 3 done, 1 failed") && page.contains("it broke"));
        assert!(page.contains("speeds &lt;b&gt;") && !page.contains("speeds <b>"));
        // Three points, and a bar where two tasks share a speed: from 20 to 30.
        let by_speed = page.rsplit("<svg").next().unwrap();
        assert_eq!((by_speed.matches("class=\"dot\"").count(), by_speed.matches("class=\"range\"").count()), (3, 1));
        assert!(page.contains("The same in all tasks") && page.contains("build.carts"));
    }

    #[test]
    fn what_must_not_be_built_is_told_and_not_compared() {
        let mut table = table();
        let truths = [Some(true), Some(true), Some(false), None];
        table.columns.push(column("build.feasible", Role::Result, Cells::Truths(truths.into())));
        let page = page(&table);
        assert!(page.contains("1 of the layouts is not feasible"), "{page}");
        // The third task had the most; its row of the table still has it.
        assert!(page.contains("x.peak changes most: from 10 at -1 to 20 at 2"), "{page}");
        assert!(page.contains("<td class=\"number\">30</td>"), "{page}");
    }

    #[test]
    fn places_go_from_left_to_right_also_below_zero() {
        let table = table();
        let Cells::Numbers(cells) = &table.columns[6].cells else { panic!() };
        let svg = picture(&table.columns[4], cells, "N").into_string();
        assert!(svg.contains(">N<") && svg.contains(">simulate.speed<"), "{svg}");
        let path = svg.split("d=\"M").nth(1).unwrap().split('"').next().unwrap();
        let xs: Vec<f64> = path.split('L').map(|p| p.split(',').next().unwrap().parse().unwrap()).collect();
        assert!(xs.len() == 2 && xs[0] < xs[1], "{path}");
    }

    #[test]
    fn units_are_those_of_columns_channels_and_names() {
        let of = |name: &str, own: &str| {
            let column = Column { unit: own.into(), ..column(name, Role::Result, Cells::Numbers(Vec::new())) };
            unit(&column).to_owned()
        };
        assert_eq!(of("simulate.speed", "m/s"), "m/s");
        assert_eq!(of("simulate.fork_left.sd", ""), "rad");
        assert_eq!(of("build.chain.left_over_mm", ""), "mm");
        assert_eq!(of("build.footprint_m2", ""), "m²");
        assert_eq!(of("build.carts", ""), "");
    }

    #[test]
    fn long_names_keep_their_ends() {
        assert_eq!(shortened("layouts/hall/west.lss", 9), "…west.lss");
        assert_eq!(shortened("a.lss", 9), "a.lss");
    }
}
