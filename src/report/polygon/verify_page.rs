//! `verify.html`: forces and spectra before and after, as figures 3.9 and 3.10 of the thesis show them.

use super::verify::{CHANNELS, Verification, spectrum};
use super::words::with_code;
use crate::base::number::{fixed, trimmed};
use crate::chain_input::Simulation;
use crate::report::lap;
use crate::report::lap_track::LapTrack;
use crate::report::plot::{
    Axis, Curve, Mark, Pictures, Plot, Rounded, document, extremes, how, middles, plan, plan_place, relative,
};
use crate::signal::position::position;
use crate::signal::{Channel, Run};
use maud::{Markup, html};

/// Part of the lap that is shown, s.
const SHOWN: f64 = 30.0;
/// Highest frequency shown, in cart passings.
const PASSINGS: f64 = 4.5;

/// Columns of the time that is shown, each with its least and largest value.
const COLUMNS: usize = 1000;

/// Colours of the cases in the style sheet: before, then the objectives.
const COLOURS: [&str; 4] = ["soft", "trace", "gap", "motor"];

/// The page: `laps` are the inputs and runs of the cases, in their order.
pub fn page(v: &Verification, laps: &[(&Simulation, &Run)]) -> String {
    let mut pictures = Pictures::new(&v.layout);
    let runs: Vec<&Run> = laps.iter().map(|lap| lap.1).collect();
    let best = v.cases.iter().position(|case| case.name == v.best).and_then(|k| laps.get(k));
    let along = best.map_or_else(|| html! {}, |(simulation, run)| on_track(v, simulation, run, &mut pictures));
    let body = html! {
        h1 { (v.layout) ": polygon action and forces" }
        p.lead { (with_code(&v.summary)) }
        @if pictures.data.plan.is_some() {
            p.note { "The plan shows the layout optimised for " code { (v.best) } ":" }
            (plan_place())
        }
        (how())
        @for (k, channel) in CHANNELS.into_iter().enumerate() {
            @if k == 0 { h2 { "Spectra" } }
            figure {
                figcaption { b { (channel.name()) } ", N/√Hz; dashed: cart passing and its double" }
                (pictures.add(spectra(v, &runs, channel)))
            }
        }
        h2 { "The lap's first " (trimmed(SHOWN, 0)) " s" }
        p.note { "Least and largest of every " (trimmed(1e3 * SHOWN / COLUMNS as f64, 1)) " ms, so that peaks stay." }
        @for channel in CHANNELS {
            figure {
                figcaption { b { (channel.name()) } ", N" }
                (pictures.add(traces(v, &runs, channel)))
            }
        }
        (along)
        (kinematic(v))
        (forces(v))
    };
    document(&format!("{}: polygon action and forces", v.layout), "", &body, &pictures.data)
}

/// The best layout's lap: its chain on the plan, and its forces along the track.
fn on_track(v: &Verification, simulation: &Simulation, run: &Run, pictures: &mut Pictures) -> Markup {
    let track = LapTrack::new(simulation);
    let lap = track.line.length;
    let Some(place) = position(run, lap) else { return html! {} };
    let stations: Vec<f64> = place.s.iter().map(|s| s.rem_euclid(lap)).collect();
    let drawn: Vec<(Channel, &Vec<f64>)> =
        CHANNELS.into_iter().filter_map(|channel| Some((channel, run.channels.get(&channel)?))).collect();
    let mut plan = plan(&track);
    plan.layers = drawn.iter().map(|(channel, _)| lap::curves::layer(*channel)).collect();
    pictures.data.plan = Some(plan);
    pictures.data.replay = Some(lap::curves::replay(simulation, run, &place));
    html! {
        h2 { "Along the track of " code { (v.best) } }
        @for (channel, samples) in drawn {
            figure {
                figcaption { b { (channel.name()) } ", N over m" }
                (pictures.add(lap::curves::along(&track, &stations, channel, samples)))
            }
        }
    }
}

/// Of each case a curve; only those of before and of the best are shown first.
fn curves<'a>(
    v: &'a Verification,
    runs: &'a [&Run],
    of: impl Fn(&Run) -> Vec<f64> + 'a,
) -> impl Iterator<Item = Curve> + 'a {
    v.cases.iter().zip(runs).enumerate().map(move |(k, (case, run))| {
        let curve = Curve::line(case.name.clone(), COLOURS[k % COLOURS.len()], of(run));
        curve.hidden(k > 0 && case.name != v.best)
    })
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

/// The first seconds of a channel.
fn traces(v: &Verification, runs: &[&Run], channel: Channel) -> Plot {
    let last = runs.iter().filter_map(|run| run.time.last()).fold(0.0, |a: f64, t| a.max(*t)).min(SHOWN);
    let x = middles(last, 2 * COLUMNS);
    let mut plot = Plot::new(format!("trace-{}", channel.name()), Axis::Time, "N", Rounded::to(x, 4));
    plot.curves.extend(curves(v, runs, move |run| {
        run.channels.get(&channel).map_or_else(Vec::new, |samples| extremes(&run.time, samples, last, COLUMNS))
    }));
    plot
}

fn spectra(v: &Verification, runs: &[&Run], channel: Channel) -> Plot {
    let passing = v.cases.iter().map(|case| case.passing_hz).fold(0.0, f64::max);
    let density = move |run: &Run| -> Vec<(f64, f64)> {
        let samples = run.channels.get(&channel).map_or(&[][..], Vec::as_slice);
        let found = spectrum(samples, run.rate());
        let shown = |(f, _): &(f64, f64)| *f >= 0.2 && *f <= PASSINGS * passing;
        found.points().filter(shown).map(|(f, p)| (f, p.sqrt())).collect()
    };
    // All laps are recorded by the same sensors: their lines are the same.
    let x = runs.first().map_or_else(Vec::new, |run| density(run).into_iter().map(|p| p.0).collect());
    let count = x.len();
    let mut plot = Plot::new(format!("spectrum-{}", channel.name()), Axis::LinearFrequency, "N/√Hz", Rounded::to(x, 3));
    plot.logarithmic = true;
    plot.curves.extend(curves(v, runs, |_| Vec::new()).zip(runs).map(|(curve, run)| {
        let mut y: Vec<f64> = density(run).into_iter().map(|p| p.1).collect();
        y.resize(count, f64::NAN);
        Curve { values: relative(y), ..curve }
    }));
    let mark = |k: f64, name: &str| Mark { x: (1e4 * k * passing).round() / 1e4, name: name.to_owned(), dotted: false };
    plot.marks = vec![mark(1.0, "cart"), mark(2.0, "2×")];
    plot
}
