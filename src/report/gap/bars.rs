//! Bars and levels: probabilities, how much of the gap is closed, the gap of each run.

use super::words::{heading, percent, probability};
use crate::base::number::decimal;
use crate::base::trig;
use crate::gap::{Diagnosis, Finding, RunGap};
use crate::report::rows::{RowScale, row};
use maud::{Markup, html};

/// Effects less probable than this are counted, not drawn, beyond the first few.
const LIKELY: f64 = 0.02;
const LEAST_ROWS: usize = 3;
const MOST_ROWS: usize = 8;

/// A bar of the chart: its class, name, share, and what stands behind the number.
struct Bar {
    class: &'static str,
    name: String,
    share: f64,
    note: String,
}

fn chart(bars: &[Bar], said: fn(f64) -> String) -> Markup {
    let scale = RowScale { low: 0.0, high: 1.0 };
    let mark = |bar: &Bar| {
        if bar.share.is_finite() {
            scale.span(bar.class, 0.0, bar.share)
        } else {
            html! {}
        }
    };
    let words = |bar: &Bar| html! { (said(bar.share)) span.quiet { (bar.note) } };
    html! {
        div.rows { @for bar in bars { (row("", &bar.name, &mark(bar), &words(bar))) } }
    }
}

/// Probabilities of the effects with those of none and unknown among them, the highest first.
pub fn probabilities(diagnosis: &Diagnosis) -> Markup {
    let likely = diagnosis.effects.iter().filter(|e| e.probability >= LIKELY).count().clamp(LEAST_ROWS, MOST_ROWS);
    let shown = likely.min(diagnosis.effects.len());
    let machine = |e: &Finding| if e.name.starts_with("sensor_") { "bar sensor" } else { "bar" };
    let simulated = |e: &Finding| if e.untested() { "  not simulated".to_owned() } else { String::new() };
    let mut bars: Vec<Bar> = diagnosis.effects[..shown]
        .iter()
        .map(|e| Bar { class: machine(e), name: heading(&e.name), share: e.probability, note: simulated(e) })
        .collect();
    let other = |name: &str, share: f64| Bar { class: "bar other", name: name.to_owned(), share, note: String::new() };
    bars.push(other("An effect not in the library", diagnosis.unknown_probability));
    bars.push(other("No gap", diagnosis.none_probability));
    bars.sort_by(|a, b| b.share.total_cmp(&a.share));
    let rest = &diagnosis.effects[shown..];
    let highest = rest.iter().map(|e| e.probability).fold(0.0, f64::max);
    html! {
        (chart(&bars, probability))
        @if !rest.is_empty() {
            p.note { (rest.len()) @if rest.len() == 1 { " more effect, " } @else { " more effects, each " }
                @if highest < 0.005 { "less than 0.5 %. " } @else { (probability(highest)) " or less. " }
                "Several effects can be present, so that the bars need not add to 100 %." }
        } @else {
            p.note { "Several effects can be present, so that the bars need not add to 100 %." }
        }
    }
}

/// What naming the cause is worth: the gap that the verdict closes beside those of a placebo and a black box.
pub fn closed(diagnosis: &Diagnosis, named: &[&Finding]) -> Markup {
    let placebo = named.iter().filter_map(|e| e.gap_closed_placebo).reduce(f64::max);
    let rows = [
        ("bar", "The named cause", diagnosis.gap_closed.or_else(|| named.first().and_then(|e| e.gap_closed))),
        ("bar other", "A placebo", placebo),
        ("bar other", "A black box", diagnosis.gap_closed_black_box),
    ];
    let bars: Vec<Bar> = rows
        .into_iter()
        .filter_map(|(class, name, share)| {
            let note = share.filter(|x| *x < 0.0).map_or("", |_| "  farther off than before").to_owned();
            Some(Bar { class, name: name.to_owned(), share: share?, note })
        })
        .collect();
    html! {
        @if !bars.is_empty() {
            figure {
                figcaption { b { "Gap closed" } ", on runs that took no part in the choice" }
                (chart(&bars, percent))
                p.note { "With all of it closed, what repeated measurements differ by is left. The placebo is the same \
                          effect with as many strengths, its places "
                    "permuted or its phase scrambled; the black box fits residuals and names nothing." }
            }
        }
    }
}

/// The gap of each run, before and after, on a logarithmic axis with what repeated measurements have.
pub fn runs(runs: &[RunGap], changed: bool) -> Markup {
    let all = runs
        .iter()
        .flat_map(|r| [r.before, r.after, r.replicate, r.replicate_high])
        .filter(|x| *x > 0.0 && x.is_finite());
    let (low, high) = all.fold((1.0_f64, 1.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    let (low, high) = (trig::log10(low) - 0.1, trig::log10(high) + 0.1);
    let scale = RowScale { low, high };
    let log = |value: f64| trig::log10(value.max(1e-12));
    let spans = match high - low {
        wide if wide > 2.5 => &[1.0][..],
        narrow if narrow < 0.6 => &[1.0, 1.2, 1.4, 1.6, 2.0, 3.0, 4.0, 6.0, 8.0],
        _ => &[1.0, 2.0, 5.0],
    };
    let decades = (low.floor() as i32..=high.ceil() as i32).map(|k| trig::pow(10.0, f64::from(k)));
    let marks: Vec<f64> = decades
        .flat_map(|d| spans.iter().map(move |m| m * d))
        .filter(|v| (low..=high).contains(&trig::log10(*v)))
        .collect();
    let lines: Vec<f64> = marks.iter().map(|m| log(*m)).collect();
    let levels = |run: &RunGap| {
        html! {
            @if run.replicate_high > 0.0 && run.replicate_high.is_finite() {
                (scale.span("replicate", low, log(run.replicate_high)))
            }
            (scale.grid(&lines))
            @if changed { (scale.span("span way", log(run.before), log(run.after))) }
            (scale.dot("before", log(run.before)))
            @if changed { (scale.dot("after", log(run.after))) }
        }
    };
    let words = |run: &RunGap| html! { (decimal(run.before, 3)) @if changed { " → " (decimal(run.after, 3)) } };
    html! {
        div.rows {
            @for run in runs { (row("", &run.run, &levels(run), &words(run))) }
            (scale.ticks(&marks.iter().map(|m| (log(*m), decimal(*m, 2))).collect::<Vec<_>>()))
        }
        p.legend.note {
            span { i.dot-before {} @if changed { "before" } @else { "the model as it is" } }
            @if changed { span { i.dot-after {} "with the named effect" } }
            span { i.dot-replicate {} "95 % of repeated measurements" }
        }
    }
}
