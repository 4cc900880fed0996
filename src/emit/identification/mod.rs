//! `identification.html`: what measured laps say of the model, in every law, on one page that stands on its own.

mod boxes;

use super::number::{fixed, trimmed};
use super::simulation::ContactLaw;
use super::style::document;
use crate::identify::study::{Estimate, Fitted};
use crate::identify::{Parameter, damping};
pub use boxes::quantile;
use boxes::{Group, boxes};
use clap::ValueEnum;
use maud::{Markup, html};

/// The page of a study: laws in the order they were fitted, each with its runs.
pub fn page(laws: &[(ContactLaw, &[Fitted])], shared: &[Parameter]) -> String {
    let runs = laws.first().map_or(0, |(_, fits)| fits.len());
    let body = html! {
        h1 { "Identification" }
        p.lead { (lead(laws, runs)) }
        @if laws.len() > 1 { (comparison(laws)) }
        h2 { "Objective" }
        p { "Root mean square of the residuals, each over the distance of two honest laps: 1 is as near as laps are to each other." }
        (boxes(&groups(laws, |f| Some(f.objective)), None, ""))
        h2 { "Restitution" }
        p { "One dot a run, box from the lower to the upper quartile with the median, whiskers to the farthest run within one and a half boxes. "
            "Dotted: the bounds of the fit. Restitution is what the law is asked for; damping χ (Kelvin-Voigt: ζ) is what the force has, and what "
            "a free impact achieves is given in the tables." }
        @for p in Parameter::RESTITUTIONS {
            figure {
                figcaption { b { (p.name()) } }
                (boxes(&groups(laws, |f| value(f, p)), Some(p.bounds(0.6)), ""))
            }
            @if laws.len() > 1 {
                figure {
                    figcaption { "damping of " (p.name()) }
                    (boxes(&groups(laws, |f| f.damping.get(p.name()).copied()), None, ""))
                }
            }
        }
        h2 { "Other parameters" }
        @for p in Parameter::ALL.into_iter().filter(|p| !p.is_restitution()) {
            figure {
                figcaption { b { (p.name()) } @if !p.unit().is_empty() { ", " (p.unit()) } @if shared.contains(&p) { ", shared by all runs" } }
                (boxes(&groups(laws, |f| value(f, p)), None, p.unit()))
            }
        }
        @if let Some((law, fits)) = laws.first() {
            h2 { "Runs, " (name(*law)) }
            @for fit in *fits { (run(fit)) }
        }
    };
    document("Identification", "", &body)
}

fn name(law: ContactLaw) -> String {
    law.to_possible_value().map_or_else(String::new, |v| v.get_name().replace('_', " "))
}

fn value(fit: &Fitted, p: Parameter) -> Option<f64> {
    fit.parameters.get(p.name()).filter(|e| e.fitted).map(|e| e.value)
}

fn groups(laws: &[(ContactLaw, &[Fitted])], of: impl Fn(&Fitted) -> Option<f64>) -> Vec<Group> {
    laws.iter().map(|(law, fits)| Group { name: name(*law), values: fits.iter().filter_map(&of).collect() }).collect()
}

fn lead(laws: &[(ContactLaw, &[Fitted])], runs: usize) -> String {
    let objective = |fits: &[Fitted]| quantile(&sorted(fits.iter().map(|f| f.objective)), 0.5);
    let first = laws.first().map_or_else(String::new, |(law, fits)| {
        format!("{} {}: median objective {}.", runs, if runs == 1 { "run" } else { "runs" }, fixed(objective(fits), 2))
            + &format!(" Law: {}.", name(*law))
    });
    let bounds: usize = laws
        .first()
        .map_or(0, |(_, fits)| fits.iter().flat_map(|f| f.parameters.values()).filter(|e| e.at_bound).count());
    if bounds > 0 { format!("{first} {bounds} values are at a bound.") } else { first }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// All laws on the same footing, and what that can show.
fn comparison(laws: &[(ContactLaw, &[Fitted])]) -> Markup {
    let spread = |fits: &[Fitted], p: Parameter| {
        let all = sorted(fits.iter().filter_map(|f| value(f, p)));
        quantile(&all, 0.75) - quantile(&all, 0.25)
    };
    html! {
        h2 { "Laws" }
        p { "At equal stiffness, exponent and approach speed all laws but Kelvin and Voigt's are one law in other coordinates: what χ one finds, "
            "another finds too, at another restitution. Their objectives can differ only where a restitution meets its bound, and the spread of "
            "restitution over runs says how a law stretches its scale, not how well it describes the contact. Runs that no bound stopped were therefore "
            "carried over through χ, and the others fitted anew from there." }
        div.scroll { table {
            thead { tr {
                th { "law" } th { "median objective" } th { "fitted anew" } th { "restitutions at a bound" }
                @for p in Parameter::RESTITUTIONS { th { "quartile range of " (p.name().trim_start_matches("restitution_").replace('_', " ")) } }
                th { "χ at e = 0.6" }
            } }
            tbody { @for (law, fits) in laws {
                tr {
                    td { (name(*law)) }
                    td.number { (fixed(quantile(&sorted(fits.iter().map(|f| f.objective)), 0.5), 3)) }
                    td.number { (fits.iter().filter(|f| f.carried_from.is_none()).count()) }
                    td.number { (fits.iter().flat_map(|f| Parameter::RESTITUTIONS.map(|p| f.parameters.get(p.name()))).flatten().filter(|e| e.at_bound).count()) }
                    @for p in Parameter::RESTITUTIONS { td.number { (fixed(spread(fits, p), 3)) } }
                    td.number { (fixed(damping(*law, 0.6), 3)) }
                }
            } }
        } }
    }
}

fn run(fit: &Fitted) -> Markup {
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
        p { "Objective " (fixed(fit.objective, 3)) ", " (fixed(fit.laps, 2)) " laps, " (fit.simulations) " simulations in " (fit.steps) " steps"
            @if fit.filled + fit.masked > 0 { "; lost samples: " (fit.filled) " bridged, " (fit.masked) " left out" } "." }
        div.scroll { table {
            thead { tr { th { "parameter" } th { "value" } th { "90 % interval" } th { "" } th { "damping" } th { "achieved" } th { "strongest correlation" } } }
            tbody { @for p in Parameter::ALL { @if let Some(e) = fit.parameters.get(p.name()) {
                tr {
                    td { (p.name()) }
                    td.number { (digits(e.value)) }
                    td { (interval(e)) " " (p.unit()) }
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
            p { "Farther from the model than twice the floor: "
                @for (k, (what, x)) in fit.misfits.iter().enumerate() { @if k > 0 { ", " } (what) " (" (fixed(*x, 1)) ")" } "." }
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
