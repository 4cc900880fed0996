//! `gap.html`: where a built system and its simulation part, what does it and how far adding it closes the gap, on one
//! page that opens offline.

mod bars;
mod map;
mod overlay;
mod shape;
mod style;
#[cfg(test)]
mod tests;
mod words;

use super::lap_track::LapTrack;
use super::plot::{Pictures, document, how};
use super::rows;
use crate::base::number::{decimal, trimmed};
use crate::base::words::list;
use crate::chain_input::Track;
use crate::gap::{Axis, Diagnosis, Finding, Overlay, Verdict, bound, draws};
use crate::signal::Channel;
use maud::{Markup, html};
use words::{amount, by_run, heading, percent, plain, probability};

/// Findings at least this probable are present, as the verdict has it.
const PRESENT: f64 = 0.5;

/// The page of a diagnosis; with a track, the gap is drawn on it. `title` names the campaign.
pub fn page(diagnosis: &Diagnosis, track: Option<&Track>, title: &str) -> String {
    let track =
        track.filter(|_| diagnosis.axis == Axis::Track).map(LapTrack::without_motors).filter(|t| t.line.length > 0.0);
    let (named, gap) = (diagnosis.named(), diagnosis.has_gap());
    let changed = !named.is_empty();
    let mut pictures = Pictures::new(title);
    pictures.data.plan = track.as_ref().and_then(|track| map::plan_of(diagnosis, track));
    let body = html! {
        p.kicker { "The gap between simulation and reality · " (title) }
        h1 { (headline(diagnosis, &named)) }
        p.lead { (diagnosis.summary) }
        h2 { "What this rests on" }
        figure { figcaption { b { "Probability" } " that each is present" } (bars::probabilities(diagnosis)) }
        @if changed {
            (strengths(&claims(diagnosis, &named)))
            (shape::shapes(&named, &mut pictures))
            @if gap {
                (bars::closed(diagnosis, &named))
                (closed_by_channel(diagnosis))
            }
        }
        @if !diagnosis.runs.is_empty() {
            figure {
                figcaption {
                    b { "Gap of each run" } ", mean square residual over that of repeated measurements: 1 is none"
                }
                (bars::runs(&diagnosis.runs, changed))
                @if let Some(draws) = draws(diagnosis) { p.note { (draws) } }
            }
        }
        (places(diagnosis, track.as_ref()))
        (overlays(diagnosis, &mut pictures))
        (groups(diagnosis))
        @if !diagnosis.next_experiment.is_empty() {
            h2 { "Next experiment" }
            p.next { (diagnosis.next_experiment) }
        }
        @if !diagnosis.lost.is_empty() {
            h2 { "What cannot be told, and why" }
            ul.lost { @for line in &diagnosis.lost { li { (line) } } }
        }
        (repeatability(diagnosis))
        (outside(diagnosis))
    };
    document(&format!("{title}: the gap"), &[style::STYLE, rows::RULES].concat(), &body, &pictures.data)
}

fn headline(diagnosis: &Diagnosis, named: &[&Finding]) -> String {
    let with_group = |finding: &&Finding| {
        let group = diagnosis.groups.iter().find(|g| g.name == finding.group && g.members.len() > 1);
        match group {
            Some(group) if finding.probability < PRESENT => {
                group.members.iter().map(|m| plain(m)).collect::<Vec<_>>().join(" or ")
            }
            _ => plain(&finding.name),
        }
    };
    let all = || heading(&list(&named.iter().map(with_group).collect::<Vec<_>>(), "and"));
    match (diagnosis.verdict, diagnosis.has_gap()) {
        (Verdict::None, false) => "No gap".to_owned(),
        (Verdict::None, true) => "No gap established".to_owned(),
        (Verdict::Unknown, true) => "A gap that no known effect explains".to_owned(),
        (Verdict::Unknown, false) => "Within repeatability, but not like any known effect".to_owned(),
        _ if named.is_empty() => "No effect is sure to be there".to_owned(),
        _ if diagnosis.explained() => all(),
        (_, true) => format!("{}: the best of the known effects", all()),
        (_, false) => format!(
            "Within repeatability, but like {}",
            plain(&list(&named.iter().map(with_group).collect::<Vec<_>>(), "and"))
        ),
    }
}

/// What is named, with all that these runs cannot tell it from where it does not stand out.
fn claims<'a>(diagnosis: &'a Diagnosis, named: &[&'a Finding]) -> Vec<&'a Finding> {
    let alike = |f: &&'a Finding| {
        let doubted = named.iter().any(|n| n.probability < PRESENT && n.group == f.group);
        doubted && diagnosis.groups.iter().any(|g| g.name == f.group && g.members.contains(&f.name))
    };
    let named_itself = |f: &&Finding| named.iter().any(|n| n.name == f.name && n.place == f.place);
    diagnosis.effects.iter().filter(|f| named_itself(f) || alike(f)).collect()
}

fn strengths(named: &[&Finding]) -> Markup {
    html! {
        div.scroll { table {
            thead {
                tr { th { "effect" } th { "where" } th { "strength" } th.number { "value" } th { "90 % interval" } }
            }
            tbody { @for finding in named {
                @for (n, at) in finding.places().enumerate() { @for (k, (name, strength)) in at.strength.iter().enumerate() {
                    @let (value, interval) = amount(strength);
                    tr {
                        td { @if n == 0 && k == 0 { (heading(&finding.name)) } }
                        td { @if k == 0 { @if at.place.is_empty() { "everywhere" } @else { (at.place) } } }
                        td { (plain(name)) } td.number { (value) @for run in by_run(strength) { br; (run) } }
                        td { (interval) @if strength.at_bound.is_some() { ", " b { (bound(strength)) } } }
                    }
                } }
                @if finding.strength.is_empty() {
                    tr { td { (heading(&finding.name)) } td { (finding.place) } td {} td {} td {} }
                }
            } }
        } }
    }
}

fn closed_by_channel(diagnosis: &Diagnosis) -> Markup {
    let mut channels: Vec<(&String, f64)> =
        diagnosis.gap_closed_channels.iter().filter(|(_, x)| x.is_finite()).map(|(c, x)| (c, *x)).collect();
    channels.sort_by(|a, b| b.1.total_cmp(&a.1));
    html! {
        @if !channels.is_empty() {
            p.note { "By channel: "
                @for (k, (channel, closed)) in channels.iter().enumerate() {
                    @if k > 0 { ", " } (channel) " " (percent(*closed))
                } "." }
        }
    }
}

fn places(diagnosis: &Diagnosis, track: Option<&LapTrack>) -> Markup {
    let some = diagnosis.places.iter().any(|p| p.share > 0.0);
    html! {
        @if some && !diagnosis.has_gap() {
            h2 { "Where what little there is lies" }
            p { "No more than repeated measurements differ by; shares are of that remainder." }
            (map::section(diagnosis, track))
        } @else if some {
            h2 { "Where the gap lies" }
            (map::section(diagnosis, track))
        }
    }
}

/// The channels with the largest shares of the gap, each measured against simulated and as a difference.
fn overlays(diagnosis: &Diagnosis, pictures: &mut Pictures) -> Markup {
    let shares = diagnosis.channels();
    let share = |o: &Overlay| shares.iter().find(|(channel, _)| *channel == o.channel).map(|(_, share)| *share);
    let charts: Vec<(bool, Markup)> = diagnosis
        .overlays
        .iter()
        .enumerate()
        .map(|(k, o)| (overlay::changed(o), overlay::chart(o, diagnosis.axis, share(o), k, pictures)))
        .collect();
    let drawn = charts.iter().any(|(_, chart)| !chart.0.is_empty());
    let changed = charts.iter().any(|(changed, _)| *changed);
    html! {
        @if drawn {
            h2 {
                @if changed {
                    "Before and after, in the channels that differ most"
                } @else {
                    "Measured and simulated, in the channels that differ most"
                }
            }
            (overlay::legend(changed))
            (how())
            @for (_, chart) in &charts { (chart) }
        }
    }
}

/// What cannot be told apart, of effects that may be present.
fn groups(diagnosis: &Diagnosis) -> Markup {
    let shown: Vec<_> = diagnosis.groups.iter().filter(|g| g.members.len() > 1).collect();
    html! {
        @if !shown.is_empty() {
            h2 { "Not told apart by these runs" }
            ul { @for group in shown {
                li { b { (list(&group.members.iter().map(|m| plain(m)).collect::<Vec<_>>(), "and")) }
                    @if !group.experiment.is_empty() { ": " (group.experiment) } }
            } }
        }
    }
}

/// Of a model outside: errors of samples, nuisances, the verdict by accuracy, and remarks.
fn outside(diagnosis: &Diagnosis) -> Markup {
    let Some(own) = &diagnosis.outside else { return html! {} };
    html! {
        @if !own.sample_error.is_empty() {
            h2 { "Error of samples" }
            div.scroll { table {
                thead { tr { th { "channel" } th.number { "before" } th.number { "after" } th.number { "noise" } th { "unit" }
                    th { "compared" } } }
                tbody { @for (channel, error) in &own.sample_error { tr {
                    td { (channel) } td.number { (decimal(error.before, 3)) } td.number { (decimal(error.after, 3)) }
                    td.number { (decimal(error.noise, 3)) } td { (error.unit) } td { (error.compared) }
                } } }
            } }
            p.note { "Measured less simulated, root mean square over all samples, with the nuisances fitted." }
        }
        @if own.nuisances.values().any(|each| !each.is_empty()) {
            h2 { "Nuisances as fitted" }
            div.scroll { table {
                thead { tr { th { "run" } th { "nuisance" } th.number { "value" } th { "90 % interval" } } }
                tbody { @for (run, each) in &own.nuisances { @for (k, (name, x)) in each.iter().enumerate() {
                    @let (value, interval) = amount(x);
                    tr { td { @if k == 0 { (run) } } td { (plain(name)) } td.number { (value) }
                        td { (interval) @if x.at_bound.is_some() { ", " b { (bound(x)) } } } }
                } } }
            } }
        }
        @if !own.by_accuracy.is_empty() {
            h2 { "The verdict by the model's accuracy" }
            div.scroll { table {
                thead { tr { th { "accuracy" } th { "effects" } th.number { "no gap" } th.number { "none of these" } } }
                tbody { @for row in &own.by_accuracy { tr {
                    td { @for (k, (c, x)) in row.accuracy.iter().enumerate() { @if k > 0 { ", " } (c) " " (decimal(*x, 2)) } }
                    td { @for (k, (name, p)) in row.effects.iter().enumerate() {
                        @if k > 0 { ", " } (plain(name)) " " (probability(*p)) } }
                    td.number { (probability(row.none_probability)) } td.number { (probability(row.unknown_probability)) }
                } } }
            } }
        }
        @for remark in &own.remarks { p.note { (remark) } }
    }
}

fn repeatability(diagnosis: &Diagnosis) -> Markup {
    let own = |channel: &str| diagnosis.outside.as_ref()?.sample_error.get(channel);
    let unit = |channel: &str| {
        let of_overlay = diagnosis.overlays.iter().find(|o| o.channel == channel).map(|o| o.unit.as_str());
        let declared = own(channel).map(|error| error.unit.as_str());
        declared.or(of_overlay).unwrap_or_else(|| Channel::unit_of(channel)).to_owned()
    };
    let samples = diagnosis.repeatability.keys().any(|c| own(c).is_some_and(|error| error.compared == "samples"));
    html! {
        @if !diagnosis.repeatability.is_empty() {
            h2 { "Repeatability" }
            p { @if diagnosis.axis == Axis::Track {
                    "Two laps of the same system are this far apart by chaos alone (root mean square of their two-cart \
                     means). "
                } @else if samples {
                    "The same measured again would be this far apart (root mean square of samples). "
                } @else {
                    "The same measured again would be this far apart (root mean square of the means over windows). "
                } "It counts as no gap: "
                @for (k, (channel, x)) in diagnosis.repeatability.iter().enumerate() {
                    @if k > 0 { ", " } (channel) " " (decimal(*x, 3)) " " (unit(channel))
                } "." }
        }
        @if !diagnosis.runs.is_empty() {
            @let high = diagnosis.runs.iter().map(|r| r.replicate_high).filter(|x| x.is_finite()).fold(0.0, f64::max);
            @if high > 0.0 {
                p.note { "95 % of repeated measurements stay under " (trimmed(high, 2)) " times its mean square." }
            }
        }
    }
}
