//! `polygon.html`: how much the chain leads and lags on each straight, to be asked: on the plan, along the track from
//! every start, over the length of the carts, as a matrix.

use super::words::with_code;
use super::{PRODUCT_LINE, PolygonReport, Straight, rms, summary};
use crate::base::number::{fixed, trimmed};
use crate::chain_input::Simulation;
use crate::geometry::CentreLine;
use crate::kinematics::polygon::PolygonObjective;
use crate::report::lap_track::LapTrack;
use crate::report::plot::{
    Axis, Curve, Layer, LayerOf, Mark, Pictures, Plot, Rounded, document, how, plan, plan_place,
};
use maud::{Markup, html};

/// Pieces that the plan is coloured in.
const PIECES: usize = 600;
/// Starts up to which each has a curve of its own.
const STARTS: usize = 16;
/// Between two lengths of carts that are tried, mm.
const STEP: usize = 10;

const RULES: &str = "
.matrix td, .matrix th { padding: 3px 8px; text-align: right; border: none; }
.matrix td { background: color-mix(in srgb, var(--rough) calc(1% * var(--share)), transparent); }
:root { --rough: #e0813a; }
";

/// The page of a report on the input that it was made from.
pub fn page(report: &PolygonReport, simulation: &Simulation, objective: PolygonObjective) -> String {
    let mut pictures = Pictures::new(&report.layout);
    let track = LapTrack::new(simulation);
    let mut plan = plan(&track);
    plan.layers.push(Layer {
        name: "rms".to_owned(),
        label: "ΔP on straights, root mean square over all starts".to_owned(),
        unit: "mm".to_owned(),
        of: LayerOf::Amounts(Rounded::new(pieces(report))),
    });
    pictures.data.plan = Some(plan);
    let n = report.curves.len();
    let title = format!("{}: polygon action", report.layout);
    let body = html! {
        h1 { (title) }
        p.lead { @if let Some(roughest) = report.notes.first() { (roughest) } }
        p.note {
            "Carts of " (trimmed(report.cart_length_m, 3)) " m on " (fixed(report.track_length_m, 3)) " m with " (n) " curves. "
            code { (report.objective) } ": " (fixed(report.value, 2)) " mm², " (fixed(rms(report.value, objective, n), 2))
            " mm in the mean; with these curves no straights give less than " (fixed(report.lower_bound, 2)) " mm². "
            "ΔP: peak to peak of a joint's lead and lag while the first joint moves by one cart (thesis §3.4)."
        }
        (plan_place())
        (how())
        figure {
            figcaption { b { "ΔP along the track" } ", mm over m; names below turn starts on and off" }
            (pictures.add(along(report)))
        }
        figure {
            figcaption { b { "Other carts on this track" } ", mm in the mean of what " code { (report.objective) } " counts, over the carts' length in mm" }
            (pictures.add(lengths(report, &track.line, objective)))
        }
        h2 { "What cancels what" }
        ul { @for note in report.notes.iter().skip(1) { li { (with_code(note)) } } }
        (curves(report))
        (matrix(report))
    };
    document(&title, RULES, &body, &pictures.data)
}

/// Parts of a straight on the lap: two where it runs on over its end.
fn parts(straight: &Straight, lap: f64) -> impl Iterator<Item = (f64, f64)> {
    let end = straight.s_m + straight.length_m;
    [(straight.s_m, end.min(lap)), (0.0, end - lap)].into_iter().filter(|(from, to)| to > from)
}

/// Root mean square of ΔP in even pieces of the lap, mm; 0 in curves.
fn pieces(report: &PolygonReport) -> Vec<f64> {
    let lap = report.track_length_m;
    let mut pieces = vec![0.0; PIECES];
    for straight in &report.straights {
        for (from, to) in parts(straight, lap) {
            let of = |s: f64| (s / lap * PIECES as f64).round() as usize;
            let (from, to) = (of(from).min(PIECES - 1), of(to));
            pieces[from..to.max(from + 1).min(PIECES)].fill(straight.rms_mm);
        }
    }
    pieces
}

/// What each straight has, from all starts together and from each.
fn along(report: &PolygonReport) -> Plot {
    let lap = report.track_length_m;
    let mut places: Vec<(f64, f64, usize)> = report
        .straights
        .iter()
        .enumerate()
        .flat_map(|(j, straight)| parts(straight, lap).map(move |(from, to)| (from, to, j)))
        .collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let over = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
        places.iter().flat_map(|(_, _, j)| [value(*j), value(*j), f64::NAN]).collect()
    };
    let x = places.iter().flat_map(|(from, to, _)| [*from, *to, *to]).collect();
    let mut plot = Plot::new("along", Axis::Track, "mm", Rounded::to(x, 3));
    let least = |j: usize| report.delta_p_mm.iter().map(|row| row[j]).fold(f64::INFINITY, f64::min);
    let band = Curve::band("least to largest", "fill", over(&least), over(&|j| report.straights[j].worst_mm));
    plot.curves.push(band);
    plot.curves.push(Curve::line("root mean square", "trace", over(&|j| report.straights[j].rms_mm)));
    if report.straights.len() <= STARTS {
        for (row, start) in report.delta_p_mm.iter().zip(&report.straights) {
            let curve = Curve::line(format!("from {}", start.name), "ink", over(&|j| row[j]));
            plot.curves.push(curve.dashed().hidden(true));
        }
    }
    plot
}

/// The objective over the length of carts.
fn lengths(report: &PolygonReport, line: &CentreLine, objective: PolygonObjective) -> Plot {
    let tried = || PRODUCT_LINE.step_by(STEP).map(f64::from);
    let of = |mm: f64| {
        let found = summary(line, 1e-3 * mm, objective).ok();
        found.map_or(f64::NAN, |(action, _)| rms(1e6 * action.value(objective), objective, action.delta_p.len()))
    };
    let mut plot = Plot::new("lengths", Axis::Own, "mm", Rounded::to(tried().collect(), 0));
    plot.curves.push(Curve::line("root mean square", "trace", tried().map(of).collect()));
    plot.marks.push(Mark { x: 1e3 * report.cart_length_m, name: "as planned".to_owned(), dotted: false });
    plot
}

fn curves(report: &PolygonReport) -> Markup {
    html! {
        h2 { "Curves" }
        div.scroll { table {
            thead { tr { th { "curve" } th { "length, m" } th { "carts" } th { "alone, mm" } th { "at most, mm" }
                th { "phase to the next, deg" } th { "share" } } }
            tbody { @for c in &report.curves { tr {
                td { (c.name) } td.number { (fixed(c.length_m, 3)) } td.number { (fixed(c.carts, 3)) }
                td.number { (fixed(c.alone_mm, 3)) } td.number { (c.most_mm.map_or("–".to_owned(), |x| fixed(x, 3))) }
                td.number { (fixed(c.phase_to_next_deg, 0)) } td.number { (fixed(100.0 * c.share, 0)) " %" }
            } } }
        } }
        p.note { "Near a whole number of carts a curve's ends cancel. A phase of 180° to the next curve cancels, 0° adds up. "
            "A share below 0 cancels more than it adds." }
    }
}

/// Rows are starts, columns straights; the darker the rougher.
fn matrix(report: &PolygonReport) -> Markup {
    let most = report.delta_p_mm.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
    html! {
        h2 { "ΔP, mm" }
        p.note { "Rows: where the chain starts; columns: where it is measured." }
        div.scroll { table.matrix {
            thead { tr { th {} @for straight in &report.straights { th { (straight.name) } } } }
            tbody { @for (straight, row) in report.straights.iter().zip(&report.delta_p_mm) { tr {
                th { (straight.name) }
                @for value in row { td style=(format!("--share: {}", fixed(100.0 * value / most, 0))) { (fixed(*value, 2)) } }
            } } }
        } }
    }
}
