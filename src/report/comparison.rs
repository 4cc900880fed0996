//! `compare.html`: run B against run A, channel by channel: how far they are apart, where on the track, at which
//! frequencies.

use super::lap_track::LapTrack;
use super::plot::{
    Axis, Curve, Layer, LayerOf, Pictures, Plot, Rounded, cells, document, how, plan, plan_place, relative,
};
use super::rows::{self, RowScale, row};
use crate::base::number::{decimal, fixed, tick_labels, ticks, trimmed};
use crate::base::words::list;
use crate::chain_input::Simulation;
use crate::signal::compare::Deviation;
use crate::signal::filter::moving_mean;
use crate::signal::spectrum::welch;
use crate::signal::{Channel, Run, position};
use maud::{Markup, html};
use std::collections::BTreeMap;

/// What two replicate simulations of a lap differ by at most, as shares of the range: in the mean over two carts, and as
/// sampled (see [`Deviation`]).
const REPLICATE_TWO_CARTS: f64 = 0.003;
const REPLICATE: f64 = 0.03;

/// Cells along the lap.
const CELLS: usize = 800;

/// Length of a spectrum's segment, s, and the frequencies shown, Hz.
const SEGMENT: f64 = 4.0;
const FROM_HZ: f64 = 0.25;
const TO_HZ: f64 = 120.0;

/// Two runs and what is known of them.
pub struct Compared<'a> {
    pub names: [&'a str; 2],
    pub runs: [&'a Run; 2],
    pub channels: &'a BTreeMap<Channel, Deviation>,
    /// m
    pub lap: Option<f64>,
    pub pitch: Option<f64>,
    /// The layout of the runs, where it is known; its lap is `lap` then.
    pub simulation: Option<&'a Simulation>,
}

/// A channel's means along the lap.
struct Along {
    x: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
    a: Vec<f64>,
    b: Vec<f64>,
    /// B less A, of the mean over two carts where the pitch is known.
    apart: Vec<f64>,
}

/// The page.
pub fn page(of: &Compared) -> String {
    let mut pictures = Pictures::new(&format!("{} against {}", of.names[1], of.names[0]));
    let along: BTreeMap<Channel, Along> =
        of.channels.keys().filter_map(|channel| Some((*channel, along(of, *channel)?))).collect();
    let track = of.simulation.map(LapTrack::new).filter(|_| !along.is_empty());
    if let Some(track) = &track {
        let mut plan = plan(track);
        plan.layers = along.iter().filter(|(c, _)| c.is_force()).map(|(c, along)| layer(*c, along)).collect();
        plan.shown = (0..plan.layers.len())
            .max_by(|a, b| {
                let share =
                    |k: usize| of.channels.iter().filter(|(c, _)| c.is_force()).nth(k).map_or(0.0, |c| apart(c.1));
                share(*a).total_cmp(&share(*b)).then(b.cmp(a))
            })
            .unwrap_or(0);
        pictures.data.plan = (!plan.layers.is_empty()).then_some(plan);
    }
    let body = html! {
        p.kicker.note { "A is " (of.names[0]) ", B is " (of.names[1]) }
        h1 { "B against A" }
        p.lead { (lead(of)) }
        @if of.lap.is_some() { (shares(of)) }
        @if pictures.data.plan.is_some() { (plan_place()) }
        (how())
        @if !along.is_empty() {
            h2 { "Along the track" }
            p.note { "Means of all laps in each " (CELLS) "th of the lap; the band is from the least to the largest value of A." }
            @for (channel, along) in &along {
                figure {
                    figcaption { b { (channel.name()) } ", " (channel.unit()) " over m: " (channel.label()) }
                    (pictures.add(both(*channel, along)))
                    (pictures.add(difference(of, *channel, along)))
                }
            }
        }
        h2 { "Spectra" }
        p { "Amplitude spectral density by Welch's method (1967), Hann windows of " (trimmed(SEGMENT, 1)) " s with half overlap." }
        @for channel in of.channels.keys() {
            figure {
                figcaption { b { (channel.name()) } ", " (channel.unit()) "/√Hz over Hz" }
                (pictures.add(spectra(of, *channel)))
            }
        }
        h2 { "Measures" }
        (table(of))
    };
    document(&pictures.data.name.clone(), rows::RULES, &body, &pictures.data)
}

/// Share of the range that tells most, of those that are known.
fn apart(of: &Deviation) -> f64 {
    of.nrmsd_two_carts.or(of.nrmsd).unwrap_or(0.0)
}

/// What two replicate simulations may have of the same.
fn limit(of: &Deviation) -> f64 {
    if of.nrmsd_two_carts.is_some() { REPLICATE_TWO_CARTS } else { REPLICATE }
}

fn percent(share: f64) -> String {
    format!("{} %", decimal(100.0 * share, 2))
}

/// The answer in words.
fn lead(of: &Compared) -> String {
    let placed = of.channels.values().any(|d| d.nrmsd.is_some());
    if !placed {
        return "Places cannot be compared, as the length of a lap is not known or a trigger never rises: only levels and \
                spectra follow."
            .to_owned();
    }
    let mut beyond: Vec<(&Channel, &Deviation)> = of.channels.iter().filter(|(_, d)| apart(d) > limit(d)).collect();
    beyond.sort_by(|a, b| apart(b.1).total_cmp(&apart(a.1)));
    let all = of.channels.len();
    let Some((first, most)) = beyond.first() else {
        return format!("None of {all} channels differs by more than two replicate simulations of a lap do.");
    };
    let named: Vec<String> =
        beyond.iter().take(4).map(|(c, d)| format!("{} ({})", c.name(), percent(apart(d)))).collect();
    let more = if beyond.len() > 4 { format!(" and {} more", beyond.len() - 4) } else { String::new() };
    let named = if more.is_empty() { list(&named, "and") } else { named.join(", ") + &more };
    let verb = if beyond.len() == 1 { "differs" } else { "differ" };
    format!(
        "{} of {all} channels {verb} by more than two replicate simulations of a lap do, as shares of the range of A: {named}. \
         Of {}, B has a mean of {} {unit} instead of {} {unit} and a standard deviation of {} {unit} instead of {} {unit}.",
        beyond.len(),
        first.name(),
        decimal(most.other.mean, 4),
        decimal(most.reference.mean, 4),
        decimal(most.other.sd, 3),
        decimal(most.reference.sd, 3),
        unit = first.unit(),
    )
}

/// How far each channel is off, as bars.
fn shares(of: &Compared) -> Markup {
    let most = of.channels.values().map(apart).fold(0.0, f64::max).max(2.0 * REPLICATE_TWO_CARTS);
    let scale = RowScale { low: 0.0, high: 1.05 * most };
    let at = ticks(0.0, 105.0 * most, 6.0);
    let numbers: Vec<(f64, String)> =
        at.iter().map(|t| t / 100.0).zip(tick_labels(&at).into_iter().map(|t| t + " %")).collect();
    let lines: Vec<f64> = numbers.iter().map(|(t, _)| *t).collect();
    let marks = |d: &Deviation| {
        html! {
            (scale.span("replicate", 0.0, limit(d)))
            (scale.grid(&lines))
            (scale.span("bar", 0.0, apart(d)))
        }
    };
    html! {
        figure {
            figcaption { b { "Difference at the same place" } ", root mean square over the range of A"
                @if of.pitch.is_some() { ", of the mean over two carts" } "; grey: what two replicate simulations differ by at most" }
            div.rows { @for (channel, d) in of.channels {
                @if d.nrmsd.is_some() { (row("", &channel.name(), &marks(d), &percent(apart(d)))) }
            }
                (scale.ticks(&numbers))
            }
        }
    }
}

fn along(of: &Compared, channel: Channel) -> Option<Along> {
    let lap = of.lap?;
    let each = |run: &Run| {
        let place = position::position(run, lap)?;
        let stations: Vec<f64> = place.s.iter().map(|s| s.rem_euclid(lap)).collect();
        Some(cells(&stations, run.channels.get(&channel)?, lap, CELLS))
    };
    let (a, b) = (each(of.runs[0])?, each(of.runs[1])?);
    let less: Vec<f64> = b.mean.iter().zip(&a.mean).map(|(b, a)| b - a).collect();
    let apart = match of.pitch {
        Some(pitch) => around(&less, 2.0 * pitch / lap * CELLS as f64),
        None => less,
    };
    Some(Along { x: a.x, low: a.low, high: a.high, a: a.mean, b: b.mean, apart })
}

/// The moving mean of values around a lap.
fn around(values: &[f64], width: f64) -> Vec<f64> {
    let reach = (width.ceil() as usize).min(values.len());
    let ends = [&values[values.len() - reach..], values, &values[..reach]].concat();
    moving_mean(&ends, width)[reach..reach + values.len()].to_vec()
}

fn layer(channel: Channel, along: &Along) -> Layer {
    Layer {
        name: channel.name().to_owned(),
        label: format!("Difference of B from A, {}", channel.label()),
        unit: channel.unit().to_owned(),
        of: LayerOf::Amounts(Rounded::new(along.apart.iter().map(|x| x.abs()).collect())),
    }
}

fn both(channel: Channel, along: &Along) -> Plot {
    let x = Rounded::to(along.x.clone(), 2);
    let mut plot = Plot::new(format!("along-{}", channel.name()), Axis::Track, channel.unit(), x);
    plot.curves.push(Curve::band("A, least to largest", "quiet", along.low.clone(), along.high.clone()));
    plot.curves.push(Curve::line("A", "ink", along.a.clone()));
    plot.curves.push(Curve::line("B", "other", along.b.clone()));
    plot
}

fn difference(of: &Compared, channel: Channel, along: &Along) -> Plot {
    let x = Rounded::to(along.x.clone(), 2);
    let mut plot = Plot::new(format!("apart-{}", channel.name()), Axis::Track, channel.unit(), x);
    plot.height = 110;
    let name = if of.pitch.is_some() { "B − A, mean over two carts" } else { "B − A" };
    plot.curves.push(Curve::line(name, "gap", along.apart.clone()));
    plot
}

fn spectra(of: &Compared, channel: Channel) -> Plot {
    let density = |run: &Run| -> Vec<(f64, f64)> {
        let samples = run.channels.get(&channel).map_or(&[][..], Vec::as_slice);
        let rate = run.rate();
        let found = welch(samples, rate, (SEGMENT * rate).round() as usize);
        found.points().filter(|(f, _)| (FROM_HZ..=TO_HZ).contains(f)).map(|(f, p)| (f, p.sqrt())).collect()
    };
    let (a, b) = (density(of.runs[0]), density(of.runs[1]));
    let x: Vec<f64> = a.iter().map(|p| p.0).collect();
    let unit = format!("{}/√Hz", channel.unit());
    let mut plot = Plot::new(format!("spectrum-{}", channel.name()), Axis::Frequency, unit, Rounded::to(x.clone(), 3));
    plot.logarithmic = true;
    let on = |points: &[(f64, f64)]| x.iter().map(|f| at(points, *f)).collect::<Vec<f64>>();
    plot.curves.push(Curve { values: relative(on(&a)), ..Curve::line("A", "ink", Vec::new()) });
    plot.curves.push(Curve { values: relative(on(&b)), ..Curve::line("B", "other", Vec::new()) });
    plot
}

/// Straight between the points, which are in the order of x; NaN beyond them.
fn at(points: &[(f64, f64)], x: f64) -> f64 {
    let next = points.partition_point(|p| p.0 < x);
    match (next.checked_sub(1).and_then(|k| points.get(k)), points.get(next)) {
        (_, Some(p)) if p.0 == x => p.1,
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0),
        _ => f64::NAN,
    }
}

fn table(of: &Compared) -> Markup {
    let share = |x: Option<f64>| x.map_or_else(|| "–".to_owned(), percent);
    html! {
        div.scroll { table {
            thead { tr { th { "channel" } th { "unit" } th { "mean of A" } th { "mean of B" } th { "sd of A" } th { "sd of B" }
                th { "NRMSD" } th { "two carts" } th { "spectrum, dB" } th { "damage, B over A" } } }
            tbody { @for (channel, d) in of.channels { tr {
                td { (channel.name()) } td { (channel.unit()) }
                td.number { (decimal(d.reference.mean, 4)) } td.number { (decimal(d.other.mean, 4)) }
                td.number { (decimal(d.reference.sd, 4)) } td.number { (decimal(d.other.sd, 4)) }
                td.number { (share(d.nrmsd)) } td.number { (share(d.nrmsd_two_carts)) }
                td.number { (d.spectral_distance.map_or_else(|| "–".to_owned(), |x| fixed(x, 1))) }
                td.number { (d.damage_ratio.map_or_else(|| "–".to_owned(), |x| fixed(x, 3))) }
            } } }
        } }
        p.note { "NRMSD: root mean square of B less A at the same place, over the range of A, and the same of the mean over two carts." }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_around_the_lap_has_no_ends() {
        let values: Vec<f64> = (0..8).map(f64::from).collect();
        let found = around(&values, 3.0);
        assert!((found[0] - 8.0 / 3.0).abs() < 1e-12 && (found[7] - 13.0 / 3.0).abs() < 1e-12, "{found:?}");
        assert!((found[3] - 3.0).abs() < 1e-12);
    }

    #[test]
    fn spectra_of_other_lines_are_read_off_between_them() {
        let points = [(1.0, 2.0), (2.0, 4.0)];
        assert_eq!([at(&points, 1.0), at(&points, 1.5), at(&points, 2.0)], [2.0, 3.0, 4.0]);
        assert!(at(&points, 2.5).is_nan() && at(&points, 0.5).is_nan());
    }
}
