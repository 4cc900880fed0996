//! `choice.html`: the components that were chosen, what else there was, what requirements cost, and candidates that no other
//! one beats.

mod found;
mod table;

pub use found::Found;
pub use table::table;

use super::lap_track::LapTrack;
use super::plot::{Axis, Curve, Layer, LayerOf, Pictures, Plan, Plot, Rounded, document, how, plan, plan_place};
use crate::base::number::{fixed, trimmed};
use crate::base::words::counted;
use crate::chain_input::Simulation;
use crate::choose::refused::{limited, mean_words, words};
use crate::choose::{Candidate, Check, Chosen, Measure};
use maud::{Markup, html};

/// Dots of a picture, at most: each has a name, and a page stays small.
const DOTS: usize = 2000;
/// Rows of the table of the cheapest.
const ROWS: usize = 20;

/// Pieces of the lap that ways from motors are shown of.
const PIECES: usize = 400;

/// The page of a choice. `trade` has the candidates that no other one beats in `measures`.
pub fn page(chosen: &Chosen, measures: &[Measure], trade: Option<&[(usize, Vec<f64>)]>) -> String {
    let mut pictures = Pictures::new(&chosen.layout.name);
    let winner = chosen.winner.map(|k| &chosen.candidates[k]);
    let capacity = chosen.order.first().and_then(|k| Measure::Capacity.of(chosen, *k));
    pictures.data.plan = winner.and_then(|c| Some(ways(&Simulation::new(&chosen.built(c)?))));
    let body = html! {
        p.kicker.note { "Choice of components · " (chosen.layout.name) }
        h1 { (headline(chosen)) }
        p.lead { (lead(chosen)) }
        @if winner.is_some() { (plan_place()) }
        @if let Some(rows) = trade {
            h2 { "What no other choice beats" }
            (front(chosen, measures, rows, &mut pictures))
        } @else if capacity.is_some() && chosen.order.len() > 1 {
            figure {
                figcaption { b { "Total" } ", EUR over items an hour: one dot a choice that does what is required" }
                (pictures.add(cloud(chosen, (Measure::Capacity, None), &[])))
            }
        }
        (how())
        @if let Some(winner) = winner { h2 { "Thrust" } (thrust(chosen, winner)) }
        @if let Some((_, Ok(check))) = chosen.checked.iter().find(|(k, _)| Some(*k) == chosen.winner) {
            h2 { "In the dynamic model" }
            (checked(check))
        }
        h2 { "What requirements cost" }
        (costs(chosen))
        h2 { "The cheapest choices" }
        p.note { "By closed form, without those that failed a check. The choice above was checked, the others were not." }
        (cheapest(chosen))
        (failed(chosen))
    };
    document(&format!("{}: choice of components", chosen.layout.name), "", &body, &pictures.data)
}

/// The plan with the motors, coloured by how far the last motor is behind.
fn ways(simulation: &Simulation) -> Plan {
    let mut map = plan(&LapTrack::new(simulation));
    let lap = map.lap_m;
    let behind = |k: usize| {
        let s = (k as f64 + 0.5) * lap / PIECES as f64;
        simulation.motors.s_m.iter().map(|motor| (s - motor).rem_euclid(lap)).fold(lap, f64::min)
    };
    map.layers = vec![Layer {
        name: "way".to_owned(),
        label: "way from the last motor; motors are green beside the track".to_owned(),
        unit: "m".to_owned(),
        of: LayerOf::Amounts(Rounded::to((0..PIECES).map(behind).collect(), 2)),
    }];
    map
}

fn headline(chosen: &Chosen) -> String {
    match chosen.winner {
        None => "No choice does what is required".to_owned(),
        Some(k) => {
            let words = words(chosen, &chosen.candidates[k]);
            let mut letters = words.chars();
            letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
        }
    }
}

fn lead(chosen: &Chosen) -> String {
    let proven = chosen.tracks.iter().filter(|track| track.proven).count();
    let all = format!(
        "Of {} on {}, all worked out, {} {} what is required; {proven} of the tracks {} proven best for the layout's objective.",
        counted(chosen.worked_out, "candidate"),
        counted(chosen.tracks.len(), "track"),
        chosen.feasible,
        if chosen.feasible == 1 { "does" } else { "do" },
        if proven == 1 { "is" } else { "are" }
    );
    let Some(winner) = chosen.winner.map(|k| &chosen.candidates[k]) else { return all };
    let mut text = format!("{} EUR", fixed(winner.price, 2));
    if let Some(energy) = &chosen.layout.choice.energy {
        text += &format!(
            " and {} kWh a year, {} EUR over {} years",
            fixed(winner.energy / 3.6e6, 0),
            fixed(winner.total, 0),
            trimmed(energy.years, 2)
        );
    }
    if let (Some(bound), Some(limit)) = (&winner.capacity, limited(chosen, winner)) {
        text += &format!("; at most {} items an hour, limited by {limit}", fixed(bound.throughput, 0));
    }
    if let Some(simulated) = chosen.takes(winner) {
        text += &format!("; simulated, {} with items at every induction at any time", mean_words(simulated));
    }
    let failed = found::failed(chosen).len();
    if failed > 0 {
        text += &format!("; {failed} cheaper ones failed their check");
    }
    format!("{text}. {all}")
}

/// Dots of all candidates that do what is required over a measure: their totals, or another measure. Some are named.
fn cloud(chosen: &Chosen, (x, y): (Measure, Option<Measure>), front: &[usize]) -> Plot {
    let value = |k: usize| match y {
        None => Some(chosen.candidates[k].total),
        Some(measure) => measure.of(chosen, k),
    };
    let point = |k: usize| Some((x.of(chosen, k)?, value(k)?, k));
    let step = chosen.order.len().div_ceil(DOTS).max(1);
    let kept = chosen
        .order
        .iter()
        .enumerate()
        .filter(|(i, k)| i % step == 0 || front.contains(k) || chosen.winner == Some(**k));
    let mut points: Vec<(f64, f64, usize)> = kept.filter_map(|(_, k)| point(*k)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let only = |which: &dyn Fn(usize) -> bool| -> Vec<f64> {
        points.iter().map(|(_, y, k)| if which(*k) { *y } else { f64::NAN }).collect()
    };
    let unit = y.map_or("EUR", |measure| measure.words().1);
    let id = y.map_or("total", |measure| measure.words().0);
    let mut plot = Plot::new(id, Axis::Own, unit, Rounded::to(points.iter().map(|(x, ..)| *x).collect(), 4));
    plot.x_unit = x.words().1.to_owned();
    plot.height = 340;
    let names = points.iter().map(|(.., k)| words(chosen, &chosen.candidates[*k])).collect();
    plot.curves.push(Curve::dots("choices", "soft", only(&|_| true)).named(names));
    if !front.is_empty() {
        plot.curves.push(Curve::dots("beaten by none", "trace", only(&|k| front.contains(&k))));
    }
    plot.curves.push(Curve::dots("chosen", "c1", only(&|k| chosen.winner == Some(k))));
    plot
}

fn front(chosen: &Chosen, measures: &[Measure], rows: &[(usize, Vec<f64>)], pictures: &mut Pictures) -> Markup {
    let [first, others @ ..] = measures else { return html! {} };
    let kept: Vec<usize> = rows.iter().map(|(k, _)| *k).collect();
    html! {
        p { (rows.len()) " choices, exact for the tracks that there are: a choice is left out only where another one is at least as good in "
            (measures.iter().map(|m| m.words().0).collect::<Vec<_>>().join(", ")) "." }
        @for other in others {
            figure {
                figcaption { b { (capital(other.words().0)) } ", " (other.words().1) " over " (first.words().0) ", " (first.words().1) }
                (pictures.add(cloud(chosen, (*first, Some(*other)), &kept)))
            }
        }
        div.scroll { table {
            thead { tr { @for m in measures { th { (m.words().0) ", " (m.words().1) } } th { "choice" } } }
            tbody { @for (k, values) in rows { tr {
                @for (value, m) in values.iter().zip(measures) { td.number { (fixed(*value, m.words().2)) } }
                td { (words(chosen, &chosen.candidates[*k])) }
            } } }
        } }
    }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn thrust(chosen: &Chosen, c: &Candidate) -> Markup {
    let duty = &chosen.layout.choice.drive;
    let resistance = &c.thrust.resistance;
    let available = c.motors.saturating_sub(duty.spare) as f64 * chosen.motor(c).force;
    let mut rows = vec![
        ("rolling".to_owned(), resistance.rolling),
        ("curves".to_owned(), resistance.curves),
        ("air".to_owned(), resistance.air),
        ("climbs, at the worst".to_owned(), resistance.climbs),
    ];
    for (force, time, what) in [(c.thrust.starting, &duty.starts, "start"), (c.thrust.stopping, &duty.stops, "stop")] {
        if let (Some(force), Some(time)) = (force, time) {
            rows.push((format!("all, to {what} in {} s", trimmed(time.value, 3)), force));
        }
    }
    rows.push((format!("what {} motors give, {} of them spare", c.motors, duty.spare), available));
    html! {
        div.scroll { table {
            thead { tr { th { "" } th { "N" } } }
            tbody { @for (what, force) in rows { tr { td { (what) } td.number { (fixed(force, 0)) } } } }
        } }
    }
}

fn checked(check: &Check) -> Markup {
    html! {
        p { "Two laps, each cart loaded: " (fixed(check.thrust, 0)) " N of thrust at " (fixed(check.speed, 3)) " m/s"
            @if let Some(speed) = check.spare_speed { "; " (fixed(speed, 3)) " m/s with the spare motors out of order" } "." }
        div.scroll { table {
            thead { tr { th { "part" } th { "largest force, N" } th { "rated, N" } th { "lives, years" } } }
            tbody { @for part in &check.carried { tr {
                td { (part.part) } td.number { (fixed(part.peak, 0)) }
                td.number { @if let Some(rated) = part.rated { (fixed(rated, 0)) } @else { "not declared" } }
                td.number { @match part.life { None => "no S-N curve", Some(life) if life > 1000.0 => "over 1000", Some(life) => (trimmed(life, 1)) } }
            } }
            @if let Some((peak, range)) = check.measured { tr {
                td { "load cell" } td.number { (fixed(peak, 0)) } td.number { (fixed(range, 0)) " measured" } td.number { "–" }
            } } }
        } }
    }
}

fn costs(chosen: &Chosen) -> Markup {
    html! {
        p.note { "How much less the least total would be without it, the others held." }
        div.scroll { table {
            thead { tr { th { "requirement" } th { "missed by" } th { "costs, EUR" } } }
            tbody { @for (requirement, cost) in &chosen.costs { tr {
                td { (found::name(*requirement)) } td.number { (chosen.missed_by(*requirement)) }
                td.number { @match cost { Some(cost) if cost.is_finite() => (fixed(*cost, 2)), Some(_) => "everything fails with it", None => "–" } }
            } } }
        } }
    }
}

fn cheapest(chosen: &Chosen) -> Markup {
    html! {
        div.scroll { table {
            thead { tr {
                th { "choice" } th { "carts" } th { "items/h" } th { "simulated" } th { "price, EUR" } th { "kWh/a" } th { "total, EUR" }
            } }
            tbody { @for k in chosen.cheapest().take(ROWS) { @let c = &chosen.candidates[k]; tr {
                td.wraps { (words(chosen, c)) }
                td.number { (chosen.fitted[c.fitted].fit.map_or(0, |fit| fit.carts)) }
                td.number { @if let Some(bound) = &c.capacity { (fixed(bound.throughput, 0)) } @else { "–" } }
                td.number { @if let Some(simulated) = chosen.takes(c) { (mean_words(simulated)) } @else { "–" } }
                td.number { (fixed(c.price, 2)) } td.number { (fixed(c.energy / 3.6e6, 0)) } td.number { (fixed(c.total, 2)) }
            } } }
        } }
    }
}

/// Candidates that are cheaper than the winner, but failed a check.
fn failed(chosen: &Chosen) -> Markup {
    let failed = found::failed(chosen);
    html! {
        @if !failed.is_empty() {
            h2 { "What failed its checks" }
            div.scroll { table {
                thead { tr { th { "choice" } th { "why" } } }
                tbody { @for (choice, why) in failed.iter().take(ROWS) { tr { td.wraps { (choice) } td.wraps { (why) } } } }
            } }
            @if failed.len() > ROWS { p.note { "and " (failed.len() - ROWS) " more" } }
        }
    }
}
