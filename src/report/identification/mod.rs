//! `identification.html`: what measured laps say of the model, in every law, on one page that opens offline.

mod along;
mod intervals;
mod laws;

use crate::base::number::{fixed, trimmed};
use crate::chain_input::{ContactLaw, Track};
use crate::identify::Parameter;
use crate::identify::groups::{RunGroup, quartiles};
use crate::identify::lack_of_fit::{Warning, warning};
use crate::identify::study::{Estimate, RunFit};
use crate::report::lap_track::LapTrack;
use crate::report::plot::{PageData, Pictures, document, how, plan, plan_place};
use crate::report::rows;
use clap::ValueEnum;
use intervals::{Band, IntervalRow, intervals};
use maud::{Markup, html};
use std::collections::BTreeSet;

/// Runs up to this many have their pictures open; of more, those that the model does not fit.
const OPEN: usize = 3;

/// The page of a study: laws in the order they were fitted, each with its runs; `groups` are the runs by set point.
/// `track` is that of all runs, where they have one.
pub fn page(
    laws: &[(ContactLaw, &[RunFit])],
    shared: &[Parameter],
    groups: &[RunGroup],
    track: Option<&Track>,
) -> String {
    let Some((law, fits)) = laws.first() else {
        return document("Identification", "", &html! {}, &PageData::default());
    };
    let mut pictures = Pictures::new("Identification");
    pictures.data.plan = track.map(|track| plan(&LapTrack::without_motors(track)));
    let of = |group: &RunGroup| fits.iter().filter(|fit| group.has(&fit.run)).collect::<Vec<&RunFit>>();
    let bands: Vec<(&RunGroup, Vec<&RunFit>)> =
        groups.iter().map(|group| (group, of(group))).filter(|(_, fits)| !fits.is_empty()).collect();
    let limits: Vec<f64> = fits.iter().map(|fit| fit.goodness.limit.objective).collect();
    let limit = limits.iter().copied().fold(f64::INFINITY, f64::min);
    let body = html! {
        h1 { "Identification" }
        p.lead { (lead(*law, fits)) }
        h2 { "Objective" }
        p { "Root mean square of the residuals, each over the deviation of replicate laps: 1 is as near as two laps \
             are to each other. Dotted: 1, and the "
            (if limits.len() > 1 { "least" } else { "" }) " limit that repeatability allows." }
        (intervals(&objectives(&bands), &[1.0, limit]))
        @for warning in fits.iter().filter_map(warning) { (told(&warning)) }
        @if laws.len() > 1 { (laws::comparison(laws, groups)) }
        h2 { "Parameters, " (name(*law)) }
        p { "A dot and a bar a run: the estimate and its 90 % interval. Hollow: not fitted by this run. Shaded, where \
             a set point has three "
            "runs or more: from the lower to the upper quartile of its runs, with their median. No set points are \
             mixed. Dotted: the bounds of a restitution." }
        @for p in Parameter::ALL {
            figure {
                figcaption {
                    b { (p.name()) } @if !p.unit().is_empty() { ", " (p.unit()) }
                    @if shared.contains(&p) { ", shared by all runs" }
                }
                (parameter(&estimates(&bands, p), p))
            }
        }
        h2 { "Measured against simulated" }
        p { "Means of each force over cells of two carts' length along the track." }
        (along::legend())
        (how())
        @if track.is_some() { (plan_place()) }
        @let pictured = pictured(fits);
        @for (k, fit) in fits.iter().enumerate().filter(|(k, _)| pictured.contains(k)) {
            (means(k, fit, fits.len(), &mut pictures))
        }
        @if pictured.len() < fits.len() {
            p.note { (fits.len() - pictured.len()) " runs have no pictures here, so that the page stays small: those that fit best. \
                      The means of all runs are in the law's JSON." }
        }
        h2 { "Runs" }
        @for fit in *fits { (run(fit)) }
    };
    document("Identification", &[rows::RULES, intervals::RULES, along::RULES].concat(), &body, &pictures.data)
}

fn name(law: ContactLaw) -> String {
    law.to_possible_value().map_or_else(String::new, |v| v.get_name().replace('_', " "))
}

/// Estimates over the runs, or the values at which it was held.
fn parameter(bands: &[Band], p: Parameter) -> Markup {
    let rows = || bands.iter().flat_map(|band| &band.rows);
    if rows().any(|row| row.interval.is_some()) {
        return intervals(bands, &bounds(p));
    }
    let mut held: Vec<f64> = rows().map(|row| row.value).collect();
    held.sort_by(f64::total_cmp);
    held.dedup();
    let held: Vec<String> = held.into_iter().map(digits).collect();
    html! { p.note { "Not fitted by any run: held at " (held.join(", ")) " " (p.unit()) } }
}

fn bounds(p: Parameter) -> Vec<f64> {
    if p.is_restitution() { [p.bounds(0.6).0, p.bounds(0.6).1].to_vec() } else { Vec::new() }
}

/// A heading for a set point, where there are several.
fn heading(groups: &[(&RunGroup, Vec<&RunFit>)], group: &RunGroup) -> String {
    let others = groups.iter().map(|(other, _)| *other);
    if groups.len() > 1 { format!("{}, {}", group.short(others), group.set_point()) } else { String::new() }
}

fn objectives(groups: &[(&RunGroup, Vec<&RunFit>)]) -> Vec<Band> {
    let row = |fit: &&RunFit| IntervalRow {
        name: fit.run.clone(),
        value: fit.objective,
        interval: None,
        note: format!("{}, limit {}", fixed(fit.objective, 2), fixed(fit.goodness.limit.objective, 2)),
        hollow: false,
        warned: !fit.fits(),
    };
    let band = |(group, fits): &(&RunGroup, Vec<&RunFit>)| Band {
        name: heading(groups, group),
        quartiles: quartiles(fits.iter().map(|fit| fit.objective)),
        rows: fits.iter().map(row).collect(),
    };
    groups.iter().map(band).collect()
}

fn estimates(groups: &[(&RunGroup, Vec<&RunFit>)], p: Parameter) -> Vec<Band> {
    let row = |fit: &&RunFit| {
        let e = fit.parameters.get(p.name())?;
        let held = e.at_bound && e.fitted;
        Some(IntervalRow {
            name: fit.run.clone(),
            value: e.value,
            interval: e.fitted.then_some((e.low, e.high)),
            note: format!("{} ({}){}", digits(e.value), interval(e), if held { ", at its bound" } else { "" }),
            hollow: !e.fitted,
            warned: held,
        })
    };
    let band = |(group, fits): &(&RunGroup, Vec<&RunFit>)| {
        let values = fits.iter().filter_map(|fit| fit.parameters.get(p.name())).map(|e| e.value);
        Band { name: heading(groups, group), quartiles: quartiles(values), rows: fits.iter().filter_map(row).collect() }
    };
    groups.iter().map(band).collect()
}

fn lead(law: ContactLaw, fits: &[RunFit]) -> String {
    let runs = fits.len();
    let bad = fits.iter().filter(|fit| !fit.fits()).count();
    let held: usize = fits.iter().map(|fit| crate::identify::lack_of_fit::at_bounds(fit).len()).sum();
    let verdict = match (bad, runs) {
        (0, 1) => "the model fits it as well as repeatability allows".to_owned(),
        (0, _) => "the model fits all of them as well as repeatability allows".to_owned(),
        (_, 1) => "the model does not fit it".to_owned(),
        (bad, _) => format!("the model does not fit {bad} of them"),
    };
    let at = match held {
        0 => String::new(),
        1 => " 1 value is at a bound.".to_owned(),
        n => format!(" {n} values are at a bound."),
    };
    format!("{runs} {}, law {}: {verdict}.{at}", if runs == 1 { "run" } else { "runs" }, name(law))
}

/// A warning with what, where and the way out.
fn told(warning: &Warning) -> Markup {
    html! {
        div.warning {
            p { b { (warning.run) ": " } (warning.message) "." }
            @if let Some(what) = &warning.what { p { "What: " (what) "." } }
            @if let Some(place) = &warning.place { p { "Where: " (place) "." } }
            p.note { (warning.help) "." }
        }
    }
}

/// Numbers that the curves along the track may have together.
const NUMBERS: usize = 120_000;

/// The runs that have pictures: those that the model fits worst, as far as the page has room, but one at least.
fn pictured(fits: &[RunFit]) -> BTreeSet<usize> {
    let off = |k: &usize| fits[*k].objective / fits[*k].goodness.limit.objective;
    let mut order: Vec<usize> = (0..fits.len()).collect();
    order.sort_by(|a, b| off(b).total_cmp(&off(a)).then(a.cmp(b)));
    let mut left = NUMBERS;
    let room = |k: &usize| {
        let own: usize = fits[*k].goodness.profiles.values().map(|p| 4 * p.simulated.len()).sum();
        let some = left >= own || left == NUMBERS;
        left = left.saturating_sub(own);
        some
    };
    order.into_iter().take_while(room).collect()
}

/// Means along the track of all channels.
fn means(number: usize, fit: &RunFit, runs: usize, pictures: &mut Pictures) -> Markup {
    html! {
        details open[runs <= OPEN || !fit.fits()] {
            summary { b { (fit.run) } ", objective " (fixed(fit.objective, 2)) }
            @for (channel, profile) in &fit.goodness.profiles {
                (along::along(number, channel, profile, &fit.goodness, pictures))
            }
        }
    }
}

fn run(fit: &RunFit) -> Markup {
    let correlations = fit.correlations();
    let worst = |p: Parameter| {
        let others = Parameter::ALL.into_iter().filter(|q| *q != p);
        others
            .map(|q| (q, correlations[(p.index(), q.index())]))
            .filter(|(_, r)| r.abs() > 0.3)
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    };
    html! {
        h3 { (fit.run) }
        p { "Objective " (fixed(fit.objective, 3)) " (limit " (fixed(fit.goodness.limit.objective, 3)) ", "
            (trimmed(fit.goodness.limit.degrees_of_freedom, 0)) " effective degrees of freedom), " (fixed(fit.laps, 2))
            " laps, "
            (fit.simulations) " simulations in " (fit.steps) " steps"
            @if fit.filled + fit.masked > 0 {
                "; lost samples: " (fit.filled) " bridged, " (fit.masked) " left out"
            }
            @if fit.unsteady_s > 0.0 {
                "; " (fixed(fit.unsteady_s, 1)) " s left out, as the chain's speed changed"
            } "." }
        div.scroll { table {
            thead {
                tr {
                    th { "parameter" } th { "value" } th { "90 % interval" } th { "" } th { "damping" }
                    th { "achieved" } th { "strongest correlation" }
                }
            }
            tbody { @for p in Parameter::ALL { @if let Some(e) = fit.parameters.get(p.name()) {
                tr {
                    td { (p.name()) }
                    td.number { (digits(e.value)) }
                    td { (interval(e)) @if e.fitted { " " (p.unit()) } }
                    td { @if e.at_bound { "at its bound" } }
                    td.number { @if let Some(x) = fit.damping.get(p.name()) { (fixed(*x, 3)) } }
                    td.number { @if let Some(x) = fit.achieved.get(p.name()) { (fixed(*x, 3)) } }
                    td { @if let Some((q, r)) = worst(p) { (fixed(r, 2)) " with " (q.name()) } }
                }
            } } }
        } }
        @if !fit.nrmsd.is_empty() {
            p { "NRMSD of a simulated lap, two-cart means in brackets: "
                @for (k, (channel, x)) in fit.nrmsd.iter().enumerate() {
                    @if k > 0 { ", " } (channel) " " (fixed(100.0 * x, 1)) " %"
                    @if let Some(y) = fit.nrmsd_two_carts.get(channel) { " (" (fixed(100.0 * y, 2)) ")" }
                } "." }
        }
        @if !fit.identifiability.is_empty() { ul { @for line in &fit.identifiability { li { (line) } } } }
        @if !fit.misfits.is_empty() {
            p { "Farther from the model than twice the repeatability: "
                @for (k, (what, x)) in fit.misfits.iter().enumerate() {
                    @if k > 0 { ", " } (what) " (" (fixed(*x, 1)) ")"
                } "." }
        }
    }
}

fn interval(e: &Estimate) -> String {
    if e.fitted { format!("{} … {}", digits(e.low), digits(e.high)) } else { "not fitted".to_owned() }
}

/// Four significant digits or so.
pub fn digits(value: f64) -> String {
    let size = value.abs();
    trimmed(
        value,
        if size >= 100.0 {
            1
        } else if size >= 1.0 {
            4
        } else {
            5
        },
    )
}
