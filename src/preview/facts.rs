//! What a layout amounts to, beside its plan: length and proof, stages, chain, what holds it, bill, polygon action.

use super::forces::Forces;
use super::known::Known;
use crate::base::number::{fixed, trimmed};
use crate::chain_input::Simulation;
use crate::compiled::Compiled;
use crate::compiled::order;
use crate::emit::freedom::limit;
use crate::kinematics::polygon::PolygonObjective;
use crate::report::polygon::{Names, PolygonReport};
use crate::solve::{self, ActiveRow, Certificate, Stage, Status};
use crate::source::one_line;
use maud::{Markup, html};

/// Rows that are shown with their price at once.
const DEAREST: usize = 8;

/// The facts as HTML; `forces` are those that the plan tells.
pub fn html(known: &Known, compiled: &Compiled, forces: Option<&Forces>) -> String {
    let silent = forces.and_then(|forces| forces.places(compiled).err());
    let body = html! {
        (numbers(compiled))
        @if let Some(why) = silent { p.note { "No forces: " (why) "." } }
        (stages(known, compiled))
        (chain(compiled))
        (capacity(compiled))
        (held(known, compiled))
        (bill(compiled))
        (polygon_action(compiled))
    };
    body.into_string()
}

fn numbers(compiled: &Compiled) -> Markup {
    let proof = compiled.stages.last().and_then(|stage| stage.certificate.as_ref()).map(Certificate::words);
    let (placement, equipped) = (&compiled.placement, !compiled.layout.equipment.declared.is_empty());
    let missing: usize = placement.missing.iter().map(|(_, count)| count).sum();
    html! {
        section {
            dl.numbers {
                div { dt { "length" } dd { (fixed(compiled.length(), 3)) " m" } }
                div {
                    dt { @if equipped || compiled.layout.objective.total_price { "price of the track" } @else { "price" } }
                    dd { (thousands(compiled.bill.price)) " EUR" }
                }
                div { dt { "elements" } dd { (compiled.bill.count) } }
                div { dt { "mass" } dd { (fixed(compiled.bill.mass, 0)) " kg" } }
                div { dt { "floor" } dd { (fixed(compiled.footprint, 1)) " m²" } }
                @if compiled.layout.objective.total_price {
                    div { dt { "price of all that is ordered" } dd { (thousands(order::total(compiled).all)) " EUR" } }
                }
                @if equipped {
                    div { dt { "pieces of equipment" } dd { (placement.placed.len()) } }
                    div { dt { "price of equipment" } dd { (thousands(placement.equipment)) " EUR" } }
                    div { dt { "price of conveyors" } dd { (thousands(placement.conveyors)) " EUR" } }
                    div { dt { "sum of the three" } dd { (thousands(compiled.price_with_equipment())) " EUR" } }
                }
            }
            @if missing > 0 { p { span.bad { "✗ no room for " (missing) " more of the equipment" } } }
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
    let take_up = 1e3 * compiled.layout.take_up_travel();
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

/// What the layout takes in closed form, where it is a sorter, against what it is asked to.
fn capacity(compiled: &Compiled) -> Markup {
    let Some(takes) = compiled.takes() else { return html! {} };
    html! {
        section {
            h2 { "Capacity" }
            p {
                b { (takes.words) }
                @if let Some(required) = takes.required {
                    @let asked = format!("the {} an hour that it has to reach", fixed(required, 0));
                    @if takes.is_enough() { " " span.good { "✓ as much as " (asked) } } @else {
                        " " span.bad { "✗ less than " (asked) }
                    }
                }
            }
            p.note { "In closed form, limited by " (one_line(&takes.limit)) ". " code { "lss capacity" } " simulates it." }
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
    let list = |rows: &[&ActiveRow]| {
        html! {
            ul.rows { @for row in rows { li {
                @if let Some(line) = known.line(row.span) { button.line data-line=(line) { "line " (line) } " " }
                (one_line(&row.row)) " " (limit(row)) br;
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
    let (beside, total) = (order::lines(compiled), order::total(compiled));
    let unpriced = total.unpriced.len();
    let euros = |price: Option<f64>| price.map_or_else(|| "–".to_owned(), |price| fixed(price, 2));
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
        @if !beside.is_empty() { section {
            h2 { "Ordered beside the track" }
            div.scroll { table {
                thead { tr { th { "component" } th.number { "count" } th.number { "EUR" } } }
                tbody { @for line in &beside { tr {
                    td title=(line.article.as_deref().unwrap_or("no article number")) { (one_line(&line.description)) }
                    td.number { (line.count) }
                    td.number title=(format!("{} EUR each", euros(line.unit_price))) { (euros(line.price())) }
                } } }
                tfoot {
                    tr { td { "in all" } td {} td.number { (fixed(total.all - total.elements, 2)) } }
                    tr { td { "with the track" } td {} td.number { (fixed(total.all, 2)) } }
                }
            } }
            @if unpriced > 0 {
                p.note {
                    @if unpriced == 1 { "One line has no price" } @else { (unpriced) " lines have no price" }
                    (if unpriced == 1 { " and is not in the sums." } else { " and are not in the sums." })
                }
            }
        } }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::{compile, on};
    use crate::model::fixture::{anywhere, equipment_type, rectangle};
    use crate::model::{Article, Chutes, EquipmentKind, EquipmentSide, EquipmentType, Induction, PlaceRow};
    use crate::model::{RequiredCapacity, fixture};
    use crate::source::Spanned;

    #[test]
    fn equipment_is_counted_priced_and_billed() {
        let plain = compile(rectangle(40.0, 20.0, 4.0));
        assert!(!numbers(&plain).into_string().contains("equipment") && capacity(&plain).into_string().is_empty());
        let mut layout = rectangle(40.0, 20.0, 4.0);
        (layout.obstacles, layout.building) = (Vec::new(), None);
        let of = equipment_type(EquipmentKind::Chute, 1.5, 2.0, EquipmentSide::Outer);
        let of = EquipmentType { article: Article { price: Some(1234.0), ..Article::default() }, ..of };
        layout.equipment.declared = vec![anywhere("row_a", of, 5)];
        let compiled = compile(layout);
        let found = numbers(&compiled).into_string();
        assert!(found.contains("<dt>pieces of equipment</dt><dd>5</dd>"), "{found}");
        assert!(found.contains("6\u{202f}170 EUR"), "{found}");
        assert!(found.contains(&thousands(compiled.bill.price + 6170.0)), "{found}");
        let found = bill(&compiled).into_string();
        assert!(found.contains("of row_a") && found.contains("6170.00") && found.contains("motor "), "{found}");
    }

    #[test]
    fn capacity_is_held_against_what_is_required() {
        let mut layout = rectangle(40.0, 20.0, 4.0);
        layout.equipment.inductions = vec![Induction { name: "west".into(), place: on(0, 1.0) }];
        let row = PlaceRow { place: on(0, 5.0), every: 1.5, count: 4 };
        layout.equipment.chutes = vec![Chutes { name: "row_a".into(), row, more: Vec::new() }];
        for (least, told) in [(10.0, "✓ as much as the 10"), (1e6, "✗ less than the 1000000")] {
            layout.capacity.required =
                Some(RequiredCapacity { least: Spanned::new(least, fixture::span()), reason: None });
            let compiled = compile(layout.clone());
            let found = capacity(&compiled).into_string();
            assert!(found.contains(told) && found.contains("behind induction west"), "{found}");
        }
    }
}
