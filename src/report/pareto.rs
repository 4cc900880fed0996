//! `pareto.html`: layouts that no other one found beats in two or three measures, and how they differ.

use super::plot::{Axis, Curve, Pictures, Plot, Rounded, document, how};
use crate::base::number::{decimal, fixed};
use crate::base::words::list;
use crate::choose::Measure;
use crate::emit::paper::{PaperPoint, Projection};
use crate::emit::pareto::{End, Pareto, Traded};
use crate::geometry::{Point, bounds};
use maud::{Markup, html};

/// Width and largest height of the picture of the layouts, px.
const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 520.0;
/// That lines may have.
const COLOURS: usize = 8;

/// The page of a layout's trade.
pub fn page(pareto: &Pareto) -> String {
    let mut pictures = Pictures::new(&pareto.layout);
    let title = pareto.title();
    let body = html! {
        p.kicker.note { (sentence(&title)) " · " (pareto.layout) }
        h1 { (headline(pareto)) }
        p.lead { (lead(pareto)) }
        @if pareto.layouts.len() > 1 {
            @for (x, y) in pairs(pareto.measures.len()) {
                figure {
                    figcaption { b { (sentence(name(pareto, y))) } (axes(pareto, x, y)) }
                    (pictures.add(curve(pareto, x, y)))
                }
            }
            (how())
        }
        @if !pareto.layouts.is_empty() {
            h2 { "The layouts over each other" }
            (plans(pareto))
            h2 { "The best in each measure" }
            ul { @for end in &pareto.ends { li { (end.words()) } } }
            h2 { "All layouts" }
            (table(pareto))
        }
    };
    document(&format!("{}: {title}", pareto.layout), RULES, &body, &pictures.data)
}

/// Which measure is drawn over which.
fn pairs(measures: usize) -> Vec<(usize, usize)> {
    (0..measures).flat_map(|x| (x + 1..measures).map(move |y| (x, y))).collect()
}

fn name(pareto: &Pareto, measure: usize) -> &'static str {
    pareto.measures[measure].words().0
}

/// What a picture has over what.
fn axes(pareto: &Pareto, x: usize, y: usize) -> String {
    let ((across, x_unit, _), (_, y_unit, _)) = (pareto.measures[x].words(), pareto.measures[y].words());
    let all = if pareto.measures.len() > 2 { "all" } else { "both" };
    format!(", {y_unit}, over {across}, {x_unit}: one dot a layout that no other one found beats in {all}")
}

fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

const RULES: &str = "
.hall { fill: none; stroke: var(--soft); stroke-width: 1.2; } .obstacle { fill: var(--band); stroke: var(--soft); }
.traded { fill: none; stroke-width: 2.2; } .traded.again { stroke-dasharray: 9 4; } .traded.once-more { stroke-dasharray: 2 4; }
.number-of { display: inline-block; width: 14px; height: 4px; margin-right: 5px; vertical-align: 3px; }
";

fn headline(pareto: &Pareto) -> String {
    match pareto.layouts.len() {
        0 => "No layout meets the constraints".to_owned(),
        1 => format!("One layout is the best found in {}", pareto.title().replace(" against ", " and ")),
        n => format!("{n} layouts that no other one beats in {}", pareto.title().replace(" against ", " and ")),
    }
}

/// From the best in the first measure to the best in the last, and what is not counted.
fn lead(pareto: &Pareto) -> String {
    let (Some(first), Some(last)) = (pareto.layouts.first(), pareto.layouts.last()) else { return String::new() };
    let told = |traded: &Traded| {
        let values = pareto.measures.iter().zip(&traded.values).map(|(m, value)| Pareto::shown(*m, *value));
        list(&values.collect::<Vec<_>>(), "and")
    };
    if pareto.layouts.len() == 1 {
        return format!("{}: of what was found there is nothing to trade.", told(first));
    }
    let mut out = match pareto.measures.len() {
        2 => format!("From {} to {}.", told(first), told(last)),
        _ => format!("Best {}.", pareto.ends.iter().map(End::words).collect::<Vec<_>>().join("; ")),
    };
    if let [Measure::Length, Measure::Cost] = pareto.measures[..] {
        let (metres, price) = (last.values[0] - first.values[0], first.values[1] - last.values[1]);
        out += &format!(
            " {} m less track cost {} EUR more, {} EUR a metre.",
            decimal(metres, 3),
            decimal(price, 4),
            decimal(price / metres.max(f64::MIN_POSITIVE), 3)
        );
    }
    if pareto.measures.contains(&Measure::Cost) && !pareto.measures.contains(&Measure::Price) {
        out += " The cost is that of track, equipment and conveyors: carts of a longer track are not counted.";
    }
    if pareto.layouts.iter().any(|traded| traded.choice.is_some()) {
        out += " Components are chosen in closed form: lss choose checks a choice in the dynamic model.";
    }
    out
}

fn curve(pareto: &Pareto, x: usize, y: usize) -> Plot {
    let mut points: Vec<(f64, f64)> = pareto.layouts.iter().map(|t| (t.values[x], t.values[y])).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let (across, values): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    let ((across_name, x_unit, _), (name, y_unit, _)) = (pareto.measures[x].words(), pareto.measures[y].words());
    let mut plot = Plot::new(format!("{name}-over-{across_name}"), Axis::Own, y_unit, Rounded::to(across, 5));
    plot.x_unit = x_unit.to_owned();
    plot.height = 300;
    // Of three measures, layouts between the ends of two need not lie on a line.
    if pareto.measures.len() == 2 {
        plot.curves.push(Curve::line("between them", "soft", values.clone()).dashed());
    }
    plot.curves.push(Curve::dots("layouts", "trace", values));
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
                i.number-of style=(format!("background: var(--c{})", k % COLOURS)) {}
                (k + 1) ": " (short(pareto, traded))
            }
        } }
        svg viewBox=(format!("0 0 {width} {height}")) style=(format!("max-width: {width}px")) role="img" {
            @for (k, outline) in pareto.hall.iter().enumerate().filter(|(_, outline)| !outline.is_empty()) {
                path class=(if k == 0 { "hall" } else { "obstacle" }) d=(path(outline)) {}
            }
            @for (k, traded) in pareto.layouts.iter().enumerate() {
                path class=(stroke(k)) id=(format!("layout-{k}")) hidden[!shown(k)]
                    style=(format!("stroke: var(--c{})", k % COLOURS)) d=(path(&traded.outline)) {}
            }
        }
        p.note { "A name turns a layout on and off." }
    }
}

/// A layout's line: the same colour again is dashed.
fn stroke(layout: usize) -> &'static str {
    ["traded", "traded again", "traded once-more"][layout / COLOURS % 3]
}

/// Its first two values.
fn short(pareto: &Pareto, traded: &Traded) -> String {
    let value = |(measure, value): (&Measure, &f64)| {
        let (_, unit, decimals) = measure.words();
        format!("{} {unit}", fixed(*value, decimals.min(3)))
    };
    pareto.measures.iter().zip(&traded.values).take(2).map(value).collect::<Vec<_>>().join(", ")
}

fn table(pareto: &Pareto) -> Markup {
    let chosen = pareto.layouts.iter().any(|traded| traded.choice.is_some());
    let beside = |measure: Measure| !pareto.measures.contains(&measure);
    html! {
        div.scroll { table {
            thead { tr {
                th {}
                @for (name, unit, _) in pareto.measures.iter().map(|m| m.words()) { th { (name) ", " (unit) } }
                @if beside(Measure::Length) { th { "length, m" } }
                th { "elements" } th { "optimise" } th { "how good" }
                @if chosen { th { "components" } }
            } }
            tbody { @for (k, t) in pareto.layouts.iter().enumerate() { tr {
                td.number { (k + 1) }
                @for (m, value) in pareto.measures.iter().zip(&t.values) {
                    td.number { (Pareto::shown(*m, *value).split(' ').next().unwrap_or_default()) }
                }
                @if beside(Measure::Length) { td.number { (fixed(t.length_m, 5)) } }
                td.number { (t.element_count) }
                td { (t.words().0) }
                td { (t.words().1) }
                @if let Some(choice) = &t.choice { td { (choice) } }
            } } }
        } }
    }
}
