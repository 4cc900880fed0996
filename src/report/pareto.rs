//! `pareto.html`: what a shorter track costs, and how the layouts differ that no other one found beats.

use super::plot::{Axis, Curve, Pictures, Plot, Rounded, document, how};
use crate::base::number::{decimal, fixed};
use crate::emit::paper::{PaperPoint, Projection};
use crate::emit::pareto::{Pareto, Traded};
use crate::geometry::{Point, bounds};
use maud::{Markup, html};

/// Width and largest height of the picture of the layouts, px.
const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 520.0;

/// The page of a layout's trade.
pub fn page(pareto: &Pareto) -> String {
    let mut pictures = Pictures::new(&pareto.layout);
    let body = html! {
        p.kicker.note { "Length against cost · " (pareto.layout) }
        h1 { (headline(pareto)) }
        p.lead { (lead(pareto)) }
        @if pareto.layouts.len() > 1 {
            figure {
                figcaption { b { "Price" } ", EUR over the track's length, m: one dot a layout that no other one found beats in both" }
                (pictures.add(curve(pareto)))
            }
            (how())
        }
        @if !pareto.layouts.is_empty() {
            h2 { "The layouts over each other" }
            (plans(pareto))
            h2 { "All layouts" }
            (table(pareto))
        }
    };
    document(&format!("{}: length against cost", pareto.layout), RULES, &body, &pictures.data)
}

const RULES: &str = "
.hall { fill: none; stroke: var(--soft); stroke-width: 1.2; } .obstacle { fill: var(--band); stroke: var(--soft); }
.traded { fill: none; stroke-width: 2.2; } .number-of { display: inline-block; width: 14px; height: 4px; margin-right: 5px; vertical-align: 3px; }
";

fn headline(pareto: &Pareto) -> String {
    match pareto.layouts.len() {
        0 => "No layout meets the constraints".to_owned(),
        1 => "The shortest layout that was found is the cheapest".to_owned(),
        n => format!("{n} layouts from the shortest to the cheapest"),
    }
}

/// The ends, and what a metre less costs at most.
fn lead(pareto: &Pareto) -> String {
    let (Some(short), Some(cheap)) = (pareto.layouts.first(), pareto.layouts.last()) else { return String::new() };
    if pareto.layouts.len() == 1 {
        return format!(
            "{} m for {} EUR: of what was found there is nothing to trade.",
            fixed(short.length_m, 3),
            fixed(short.price_eur, 2)
        );
    }
    let (metres, price) = (cheap.length_m - short.length_m, short.price_eur - cheap.price_eur);
    format!(
        "From {} m for {} EUR to {} m for {} EUR: {} m less track cost {} EUR more, {} EUR a metre. Prices are those of the \
         track's pieces: carts of the longer track are not counted.",
        fixed(short.length_m, 3),
        fixed(short.price_eur, 2),
        fixed(cheap.length_m, 3),
        fixed(cheap.price_eur, 2),
        decimal(metres, 3),
        decimal(price, 4),
        if metres > 0.0 { decimal(price / metres, 3) } else { "–".to_owned() },
    )
}

fn curve(pareto: &Pareto) -> Plot {
    let of = |what: fn(&Traded) -> f64| pareto.layouts.iter().map(what).collect::<Vec<f64>>();
    let mut plot = Plot::new("price", Axis::Own, "EUR", Rounded::to(of(|t| t.length_m), 5));
    plot.x_unit = "m".to_owned();
    plot.height = 300;
    plot.curves.push(Curve::line("between them", "soft", of(|t| t.price_eur)).dashed());
    plot.curves.push(Curve::dots("layouts", "trace", of(|t| t.price_eur)));
    plot
}

fn plans(pareto: &Pareto) -> Markup {
    let outlines = || pareto.layouts.iter().map(|t| &t.outline).chain(&pareto.hall);
    let (low, high) = bounds(outlines().flatten().copied());
    let span = high - low;
    let scale = (WIDTH / span.x.max(1e-3)).min(HEIGHT / span.y.max(1e-3));
    let projection = Projection { floor: Point::new(low.x, high.y), paper: PaperPoint::new(8.0, 8.0), scale };
    let path = |points: &[Point]| {
        let at = |p: &Point| {
            let p = projection.at(*p);
            format!("{} {}", fixed(p.x, 1), fixed(p.y, 1))
        };
        format!("M{}Z", points.iter().map(at).collect::<Vec<_>>().join("L"))
    };
    let (width, height) = (fixed(span.x * scale + 16.0, 0), fixed(span.y * scale + 16.0, 0));
    let last = pareto.layouts.len() - 1;
    let shown = |k: usize| k == 0 || k == last;
    html! {
        div.channels role="group" aria-label="layouts" { @for (k, traded) in pareto.layouts.iter().enumerate() {
            button type="button" aria-pressed=(shown(k)) data-shows=(format!("layout-{k}")) {
                i.number-of style=(format!("background: var(--c{})", k % 8)) {}
                (k + 1) ": " (fixed(traded.length_m, 2)) " m, " (fixed(traded.price_eur, 0)) " EUR"
            }
        } }
        svg viewBox=(format!("0 0 {width} {height}")) style=(format!("max-width: {width}px")) role="img" {
            @for (k, outline) in pareto.hall.iter().enumerate().filter(|(_, outline)| !outline.is_empty()) {
                path class=(if k == 0 { "hall" } else { "obstacle" }) d=(path(outline)) {}
            }
            @for (k, traded) in pareto.layouts.iter().enumerate() {
                path.traded id=(format!("layout-{k}")) hidden[!shown(k)] style=(format!("stroke: var(--c{})", k % 8))
                    d=(path(&traded.outline)) {}
            }
        }
        p.note { "A name turns a layout on and off." }
    }
}

fn table(pareto: &Pareto) -> Markup {
    html! {
        div.scroll { table {
            thead { tr { th {} th { "length, m" } th { "price, EUR" } th { "elements" } th { "a metre counts, EUR" } th { "best then" } } }
            tbody { @for (k, t) in pareto.layouts.iter().enumerate() { tr {
                td.number { (k + 1) } td.number { (fixed(t.length_m, 5)) } td.number { (fixed(t.price_eur, 2)) }
                td.number { (t.element_count) }
                td.number { @if let Some(metre) = t.eur_per_metre { (fixed(metre, 2)) } @else { "all" } }
                td { @if t.proven { "proven" } @else { "to " (fixed(100.0 * t.gap, 3)) " %" } }
            } } }
        } }
    }
}
