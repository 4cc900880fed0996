//! What a layout amounts to, beside its plan: length and proof, stages, chain, what holds it, bill, polygon action.

use super::known::Known;
use crate::base::number::{fixed, trimmed};
use crate::chain_input::Simulation;
use crate::compiled::Compiled;
use crate::emit::freedom::limit;
use crate::kinematics::polygon::PolygonObjective;
use crate::report::polygon::{Names, PolygonReport};
use crate::solve::{self, ActiveRow, Certificate, Stage, Status};
use crate::source::one_line;
use maud::{Markup, html};

/// Rows that are shown with their price at once.
const DEAREST: usize = 8;

/// The facts as HTML.
pub fn html(known: &Known, compiled: &Compiled) -> String {
    let body = html! {
        (numbers(compiled))
        (stages(known, compiled))
        (chain(compiled))
        (held(known, compiled))
        (bill(compiled))
        (polygon_action(compiled))
    };
    body.into_string()
}

fn numbers(compiled: &Compiled) -> Markup {
    let proof = compiled.stages.last().and_then(|stage| stage.certificate.as_ref()).map(Certificate::words);
    html! {
        section {
            dl.numbers {
                div { dt { "length" } dd { (fixed(compiled.length(), 3)) " m" } }
                div { dt { "price" } dd { (thousands(compiled.bill.price)) " EUR" } }
                div { dt { "elements" } dd { (compiled.bill.count) } }
                div { dt { "mass" } dd { (fixed(compiled.bill.mass, 0)) " kg" } }
                div { dt { "floor" } dd { (fixed(compiled.footprint, 1)) " m²" } }
            }
            @for line in proof.iter().flatten() { p.proof { (line) } }
            @if compiled.raised() { p.note { "The length is along the slope; stages count the plan." } }
        }
    }
}

/// `12 345`, with spaces that do not break.
fn thousands(value: f64) -> String {
    let digits = fixed(value, 0);
    let mut out = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) && out != "-" {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

fn stages(known: &Known, compiled: &Compiled) -> Markup {
    if compiled.stages.iter().all(|stage| stage.status == Status::AsWritten) {
        return html! {};
    }
    let written = crate::geometry::Track::new(&compiled.layout.corners()).length;
    let how = |stage: &Stage| match stage.status {
        Status::Infeasible => "not feasible",
        Status::Proven => "proven",
        Status::Local => "local optimum",
        Status::BestFound => "best found",
        Status::Feasible => "feasible",
        Status::AsWritten => "as written",
    };
    let last = compiled.stages.len() - 1;
    let name = |stage: &Stage| match stage.name.strip_prefix("stage") {
        Some("1") => "1 walls and constraints".to_owned(),
        Some("2") => "2 with obstacles".to_owned(),
        Some("3") => "3 on the catalogue's grid".to_owned(),
        _ => stage.name.to_owned(),
    };
    let swatch = |k: usize| match k {
        _ if k == last => "swatch last",
        0 => "swatch one",
        _ => "swatch two",
    };
    html! {
        section {
            h2 { "Stages" }
            table {
                @if known.layout.route.is_none() {
                    tr { td { i.swatch {} "as written" } td.number { (fixed(written, 3)) " m" } td {} }
                }
                @for (k, stage) in compiled.stages.iter().enumerate() { tr {
                    td { i class=(swatch(k)) {} (name(stage)) }
                    td.number { (fixed(stage.length, 3)) " m" }
                    td { (how(stage)) }
                } }
            }
        }
    }
}

fn chain(compiled: &Compiled) -> Markup {
    let take_up = 1e3 * compiled.layout.catalog.take_up;
    html! {
        section {
            h2 { "Chain" }
            @match compiled.chain {
                Some(fit) => {
                    p {
                        b { (fit.carts) " carts" } ", " (fixed(1e3 * fit.left_over, 1)) " mm left over "
                        @if compiled.chain_fits() {
                            span.good { "✓ within the take-up of " (trimmed(take_up, 1)) " mm" }
                        } @else {
                            span.bad { "✗ beyond the take-up of " (trimmed(take_up, 1)) " mm" }
                        }
                    }
                }
                None => p { span.bad { "✗ no chain of these carts closes on this track" } }
            }
        }
    }
}

/// The rows at their limits, those with a price first.
fn held(known: &Known, compiled: &Compiled) -> Markup {
    let is_continuous = |stage: &&Stage| matches!(stage.name, "stage1" | "stage2" | "written");
    let Some(stage) = compiled.stages.iter().rfind(is_continuous).filter(|_| !compiled.failed()) else {
        return html! {};
    };
    let freedom = solve::freedom(&compiled.layout, stage);
    let (dear, free): (Vec<&ActiveRow>, Vec<&ActiveRow>) =
        freedom.rows.iter().partition(|row| row.length_per_unit.is_some_and(|price| price.abs() >= 1e-6));
    let ways = match freedom.degrees {
        0 => "Nothing can move without leaving a limit".to_owned(),
        1 => "The layout can still move in one way".to_owned(),
        n => format!("The layout can still move in {n} independent ways"),
    };
    let of = if freedom.stage == "written" {
        "the written layout".to_owned()
    } else {
        freedom.stage.replace("stage", "the optimum of stage ")
    };
    // Spans of a route's layout are of a text that nobody wrote.
    let line = |row: &ActiveRow| if known.layout.route.is_some() { None } else { known.line(row.span) };
    let list = |rows: &[&ActiveRow]| {
        html! {
            ul.rows { @for row in rows { li {
                @if let Some(line) = line(row) { button.line data-line=(line) { "line " (line) } " " }
                (one_line(&row.row)) " " (limit(row)) @if row.unit == "rad" { "°" } @else { " m" } br;
                span.price { (row.words) }
            } } }
        }
    };
    html! {
        section {
            h2 { "What holds the track" }
            p.note { (ways) ", at " (of) ", " (fixed(freedom.length, 3)) " m." }
            (list(&dear[..dear.len().min(DEAREST)]))
            @if dear.len() > DEAREST {
                details { summary { (dear.len() - DEAREST) " more with a price" } (list(&dear[DEAREST..])) }
            }
            @if !free.is_empty() {
                details { summary { (free.len()) " at their limit without a price" } (list(&free)) }
            }
        }
    }
}

fn bill(compiled: &Compiled) -> Markup {
    let bill = &compiled.bill;
    html! {
        section {
            h2 { "Bill of elements" }
            div.scroll { table {
                thead { tr { th { "article" } th.number { "count" } th.number { "each, EUR" } th.number { "EUR" } } }
                tbody { @for line in &bill.lines { tr class=(if line.in_catalog { "" } else { "bad" }) {
                    td title=(line.description) { (line.article) }
                    td.number { (line.count) }
                    td.number { (fixed(line.unit_price, 2)) }
                    td.number { (fixed(line.price, 2)) }
                } } }
                tfoot { tr { td { "in all" } td.number { (bill.count) } td {} td.number { (fixed(bill.price, 2)) } } }
            } }
        }
    }
}

fn polygon_action(compiled: &Compiled) -> Markup {
    if compiled.failed() {
        return html! {};
    }
    let simulation = Simulation::new(compiled);
    let (line, names) = (simulation.track.centre_line(), Names::of(compiled));
    let pitch = simulation.chain.pitch_m;
    let report = PolygonReport::new(&simulation.name, &line, pitch, PolygonObjective::default(), &names);
    let body = match report {
        Err(why) => html! { p.note { (why) } },
        Ok(report) => {
            let most = report.straights.iter().map(|s| s.rms_mm).fold(0.0, f64::max);
            html! {
                p {
                    b { (fixed(report.value, 2)) " mm²" } " over all starts and straights; with these curves no less "
                    "than "
                    (fixed(report.lower_bound, 2)) " mm²"
                }
                div.scroll { table {
                    thead { tr { th { "straight" } th.number { "ΔP rms, mm" } th {} } }
                    tbody { @for straight in &report.straights { tr {
                        td { (straight.name) }
                        td.number { (fixed(straight.rms_mm, 2)) }
                        td { progress max=(fixed(most.max(1e-6), 6)) value=(fixed(straight.rms_mm, 6)) {} }
                    } } }
                } }
                @if !report.notes.is_empty() {
                    details {
                        summary { "Which curves cancel" }
                        ul { @for note in &report.notes { li { (note) } } }
                    }
                }
            }
        }
    };
    html! { section { h2 { "Polygon action" } (body) } }
}
