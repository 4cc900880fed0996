//! `verify.html`: forces and spectra before and after, as figures 3.9 and 3.10 of the thesis show them.

use super::verify::{CHANNELS, Verification, spectrum};
use crate::base::number::{fixed, trimmed};
use crate::base::trig;
use crate::report::lap::chart::{BELOW, HEIGHT, LEFT, Scale, TOP, WIDTH, coordinates, frame};
use crate::report::style::document;
use crate::signal::{Channel, Run};
use maud::{Markup, html};

/// Part of the lap that is shown, s.
const SHOWN: f64 = 30.0;
/// Highest frequency shown, in cart passings.
const PASSINGS: f64 = 4.5;

/// Rules beyond the house style sheet: the trace before, in grey.
const STYLE: &str = ".before { fill: none; stroke: var(--soft); stroke-width: 1; stroke-opacity: .75; } \
    .after { fill: none; stroke: var(--trace); stroke-width: 1.1; } \
    .legend i.b { background: var(--soft); } .legend i.a { background: var(--trace); }";

/// The page: `runs` are the laps of the cases, in their order.
pub fn page(v: &Verification, runs: &[&Run]) -> String {
    let body = html! {
        h1 { (v.layout) ": polygon action and forces" }
        p.lead { (v.summary) }
        (kinematic(v))
        (forces(v))
        @for (case, run) in v.cases.iter().zip(runs).skip(1) {
            h2 { "Before, and optimised for " code { (case.name) } }
            p.legend.note { span { i.b {} "before" } span { i.a {} (case.name) } }
            @if let Some(before) = runs.first() {
                @for channel in CHANNELS {
                    figure {
                        figcaption { b { (channel.name()) } ", N: " (trimmed(SHOWN, 0)) " s of the lap" }
                        (traces(before, run, channel))
                    }
                    figure {
                        figcaption { b { (channel.name()) } ", N/√Hz; dashed: cart passing and its double" }
                        (spectra(before, run, channel, case.passing_hz))
                    }
                }
            }
        }
    };
    document(&format!("{}: polygon action and forces", v.layout), STYLE, &body)
}

fn kinematic(v: &Verification) -> Markup {
    html! {
        h2 { "Polygon action" }
        div.scroll { table {
            thead { tr { th { "layout" } th { "length, m" } th { "carts" } th { "left over, mm" } th { "all, mm²" }
                th { "first_three, mm²" } th { "last, mm²" } th { "forces against before" } } }
            tbody { @for c in &v.cases { tr {
                td { (c.name) } td.number { (fixed(c.track_length_m, 3)) } td.number { (c.carts) }
                td.number { (fixed(1e3 * c.left_over_m, 1)) } td.number { (fixed(c.polygon_action.all, 2)) }
                td.number { (fixed(c.polygon_action.first_three, 2)) } td.number { (fixed(c.polygon_action.last, 2)) }
                td.number { (fixed(c.ratio, 3)) }
            } } }
        } }
        p.note { "Forces against before: mean ratio of the standard deviations of joint and steering forces." }
    }
}

fn forces(v: &Verification) -> Markup {
    html! {
        h2 { "Forces" }
        div.scroll { table {
            thead { tr { th { "channel" } th { "layout" } th { "mean, N" } th { "sd, N" } th { "min, N" }
                th { "max, N" } th { "at cart passing, N rms" } th { "damage-equivalent range, N" } } }
            tbody { @for channel in CHANNELS { @for c in &v.cases {
                @if let Some(f) = c.channels.get(channel.name()) { tr {
                td { (channel.name()) } td { (c.name) } td.number { (fixed(f.mean, 1)) } td.number { (fixed(f.sd, 1)) }
                td.number { (fixed(f.min, 1)) } td.number { (fixed(f.max, 1)) } td.number { (fixed(f.passing_rms, 2)) }
                td.number { @if let Some(d) = f.damage { (fixed(d, 2)) } }
            } } } } }
        } }
    }
}

/// What both runs show of a channel: samples of the first seconds.
fn shown(run: &Run, channel: Channel) -> Vec<(f64, f64)> {
    let Some(samples) = run.channels.get(&channel) else { return Vec::new() };
    run.time.iter().zip(samples).take_while(|(t, _)| **t <= SHOWN).map(|(t, x)| (*t, *x)).collect()
}

fn traces(before: &Run, after: &Run, channel: Channel) -> Markup {
    let both = [shown(before, channel), shown(after, channel)];
    let values = || both.iter().flatten().map(|p| p.1).filter(|x| x.is_finite());
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    let last = both.iter().flatten().map(|p| p.0).fold(0.0, f64::max);
    if !(low.is_finite() && high.is_finite() && last > 0.0) {
        return html! {};
    }
    let scale = Scale::new(0.0, last, low, high);
    let both = both.map(|points| thinned(&points, last));
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
            (frame(&scale, "s"))
            @for (points, class) in both.iter().zip(["before", "after"]) {
                path class=(class) d=(line(points, &scale)) {}
            }
        }
    }
}

/// Least and largest of each of a thousand columns, in the order of time.
fn thinned(points: &[(f64, f64)], last: f64) -> Vec<(f64, f64)> {
    const COLUMNS: f64 = 1000.0;
    let column = |p: &(f64, f64)| (p.0 / last * COLUMNS) as usize;
    let mut out = Vec::new();
    for group in points.chunk_by(|a, b| column(a) == column(b)) {
        let least = group.iter().min_by(|a, b| a.1.total_cmp(&b.1)).copied();
        let most = group.iter().max_by(|a, b| a.1.total_cmp(&b.1)).copied();
        let mut both: Vec<(f64, f64)> = least.into_iter().chain(most).collect();
        both.sort_by(|a, b| a.0.total_cmp(&b.0));
        both.dedup();
        out.extend(both);
    }
    out
}

fn spectra(before: &Run, after: &Run, channel: Channel, passing: f64) -> Markup {
    let density = |run: &Run| -> Vec<(f64, f64)> {
        let samples = run.channels.get(&channel).map_or(&[][..], Vec::as_slice);
        let found = spectrum(samples, run.rate());
        found
            .points()
            .filter(|(f, _)| *f >= 0.2 && *f <= PASSINGS * passing)
            .map(|(f, p)| (f, p.max(1e-12).sqrt()))
            .collect()
    };
    let both = [density(before), density(after)];
    let high = both.iter().flatten().map(|p| p.1).fold(0.0, f64::max);
    if !(high.is_finite() && high > 0.0) {
        return html! {};
    }
    // Three decades below the largest.
    let decades = |p: &(f64, f64)| (p.0, trig::log10(p.1.max(1e-3 * high)));
    let both = both.map(|points| points.iter().map(decades).collect::<Vec<_>>());
    let scale = Scale::new(0.0, PASSINGS * passing, trig::log10(1e-3 * high), trig::log10(high));
    let (first, last) = ((trig::log10(1e-3 * high)).ceil() as i32, trig::log10(high).floor() as i32);
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
            @for k in first..=last {
                @let y = fixed(scale.y(f64::from(k)), 1);
                line.axis x1=(LEFT) x2=(WIDTH - 8.0) y1=(y) y2=(y) {}
                text.tick x=(LEFT - 6.0) y=(fixed(scale.y(f64::from(k)) + 4.0, 1)) text-anchor="end" {
                    (trimmed(trig::pow(10.0, f64::from(k)), 4))
                }
            }
            @for f in 0..=(PASSINGS * passing) as i32 {
                text.tick x=(fixed(scale.x(f64::from(f)), 1)) y=(HEIGHT - 6.0) text-anchor="middle" { (f) " Hz" }
            }
            @for k in 1..=2 {
                @let x = fixed(scale.x(f64::from(k) * passing), 1);
                line.mark x1=(x) x2=(x) y1=(TOP) y2=(HEIGHT - BELOW) {}
            }
            @for (points, class) in both.iter().zip(["before", "after"]) {
                path class=(class) d=(line(points, &scale)) {}
            }
        }
    }
}

fn line(points: &[(f64, f64)], scale: &Scale) -> String {
    let at = |p: &(f64, f64)| coordinates(scale.at(p.0, p.1));
    format!("M{}", points.iter().filter(|p| p.1.is_finite()).map(at).collect::<Vec<_>>().join("L"))
}
