//! Why no choice of components does what is required: what none reaches and by how much, or what they fall short of.

use super::candidate::{Candidate, Requirement, Room, Shortfall};
use super::find::Chosen;
use crate::base::number::{fixed, trimmed};
use crate::base::words::counted;
use crate::capacity::{Mean, limit_words, way_out};
use crate::compiled::Compiled;
use crate::diagnostic::{Code, Diagnostic};
use crate::solve;
use crate::source::Span;

/// What there is to say where nothing was chosen.
pub fn refused(chosen: &Chosen) -> Vec<Diagnostic> {
    if chosen.winner.is_some() {
        return Vec::new();
    }
    if chosen.tracks.is_empty() {
        let of = |no: &super::tracks::NoTrack| {
            let why = solve::diagnose(&no.layout, &no.stages);
            match why.is_empty() {
                true => {
                    let compiled = Compiled::new((*no.layout).clone(), no.stages.clone());
                    compiled.heights.iter().cloned().chain(compiled.without_room()).collect()
                }
                false => why,
            }
        };
        return chosen.untracked.first().map(of).unwrap_or_default();
    }
    if !chosen.checked.is_empty() {
        return vec![failed_checks(chosen)];
    }
    if !chosen.short.is_empty() {
        return short_in_simulation(chosen).into_iter().collect();
    }
    let kinds =
        [Requirement::Capacity, Requirement::Closes, Requirement::Tension, Requirement::Room, Requirement::Motors];
    let never: Vec<Requirement> =
        kinds.into_iter().filter(|kind| chosen.missed_by(*kind) == chosen.worked_out).collect();
    if never.is_empty() {
        return vec![together(chosen)];
    }
    never.into_iter().filter_map(|requirement| none_reaches(chosen, requirement)).collect()
}

/// Where a choice can be widened.
fn free(chosen: &Chosen) -> Span {
    chosen.layout.choice.statements.free.first().map_or(chosen.layout.span, |(_, span)| *span)
}

/// With what is free that the capacity depends on.
fn chosen_from(chosen: &Chosen, said: Diagnostic) -> Diagnostic {
    let free = chosen.layout.choice.statements.free.iter().filter(|(free, _)| free.changes_capacity());
    free.fold(said, |said, (_, span)| said.related(*span, "chosen from here"))
}

/// `cart tilt_tray 600 mm at 2 m/s with 12 × linear_motor`
pub fn words(chosen: &Chosen, candidate: &Candidate) -> String {
    let (cart, motor) = (chosen.cart(candidate), chosen.motor(candidate));
    let radius = chosen.track(candidate).radius;
    let take_up =
        chosen.take_up(candidate).map_or_else(String::new, |take_up| format!(", take-up {}", take_up.written));
    let sensor = chosen.sensor(candidate).map_or_else(String::new, |sensor| format!(", sensor {}", sensor.written));
    let numbers = chosen.numbers(candidate).into_iter().map(|(name, count)| format!(", {count} × {name}"));
    let motors = match candidate.motors {
        0 => String::new(),
        count => format!(" with {count} × {}", motor.name),
    };
    format!(
        "cart {} {} mm at {} m/s{motors}{}{take_up}{sensor}{}",
        cart.name,
        trimmed(cart.length * 1e3, 3),
        trimmed(candidate.speed, 4),
        numbers.collect::<String>(),
        radius.map_or_else(String::new, |radius| format!(", least radius {} m", trimmed(radius, 3)))
    )
}

/// The candidate that comes nearest to a requirement.
fn nearest(chosen: &Chosen, requirement: Requirement) -> Option<(&Candidate, Shortfall)> {
    let of = |c: &Candidate| c.shortfalls.iter().copied().find(|s| s.requirement == requirement);
    let all = chosen.candidates.iter().filter_map(|c| Some((c, of(c)?)));
    all.min_by(|a, b| {
        let others = |c: &Candidate| c.shortfalls.len();
        a.1.share().total_cmp(&b.1.share()).then(others(a.0).cmp(&others(b.0))).then(a.0.total.total_cmp(&b.0.total))
    })
}

fn none_reaches(chosen: &Chosen, requirement: Requirement) -> Option<Diagnostic> {
    let (candidate, short) = nearest(chosen, requirement)?;
    let layout = &chosen.layout;
    let (count, near) = (chosen.candidates.len(), words(chosen, candidate));
    // What it does not do, of one choice and of several.
    let none = |not: &str, does: &str, what: &str| match count {
        1 => format!("the choice does not {not} {what}"),
        _ => format!("none of {count} choices {does} {what}"),
    };
    let diagnostic = |message: String, span: Span, label: String| Diagnostic::new(Code::E0605, message, span, label);
    Some(match requirement {
        Requirement::Capacity => {
            let required = layout.capacity.required.as_ref()?;
            let why = required.reason.as_ref().map_or_else(String::new, |reason| format!(" ({reason})"));
            let message = none("reach", "reaches", &format!("the capacity that is required{why}"));
            let percent = fixed(100.0 * short.share(), 1);
            let label = format!("at most {} an hour, {percent} % less", fixed(short.found, 0));
            let limit = limited(chosen, candidate).map_or_else(String::new, |limit| format!(", limited by {limit}"));
            let said = diagnostic(message, required.least.span, label).expected(
                format!("at least {} items an hour", fixed(short.wanted, 0)),
                format!("at most {}, with {near}{limit}", fixed(short.found, 0)),
            );
            let said = chosen_from(chosen, said);
            let speed = candidate.speed * short.wanted / short.found.max(f64::MIN_POSITIVE);
            said.help(match candidate.capacity.as_ref().filter(|_| short.found > 0.0) {
                Some(bound) => way_out(bound.limit, speed),
                None => "place an `induction` and `chutes`, and carts that close the loop".to_owned(),
            })
        }
        Requirement::Closes => {
            let span = layout.chain.closes_within.as_ref().map_or_else(|| free(chosen), |within| within.span);
            let (found, wanted) = (fixed(short.found * 1e3, 1), fixed(short.wanted * 1e3, 1));
            diagnostic(none("close", "closes", "the chain"), span, format!("{found} mm left over at the least"))
                .expected(format!("at most {wanted} mm left over"), format!("{found} mm, with {near}"))
                .help(format!(
                    "`chain closes within` lets the track adapt to each cart; or {} of more `travel`",
                    if layout.choice.take_ups.is_empty() { "take a take-up" } else { "leave a take-up free" }
                ))
        }
        Requirement::Tension => {
            let (found, wanted) = (fixed(short.found, 0), fixed(short.wanted, 0));
            let label = format!("the strongest that may be chosen holds {found} N");
            diagnostic("no take-up holds the chain's tension".to_owned(), free(chosen), label)
                .expected(format!("a take-up that holds {wanted} N"), format!("{found} N, with {near}"))
                .help("leave a stronger take-up free, or take less `chain tension`")
        }
        Requirement::Motors => {
            let statements = &layout.choice.statements;
            let span = statements.places.first().copied().unwrap_or(layout.span);
            let (found, wanted) = (short.found as usize, short.wanted as usize);
            let label = match found {
                0 => "the layout has no motors".to_owned(),
                _ => format!("the layout has {}", counted(found, "motor")),
            };
            let room = Room::new(&chosen.track(candidate).compiled, chosen.motor(candidate), false).most;
            let evenly = format!("write `motors {wanted} evenly`, or ");
            let drive = &layout.choice.drive;
            let said = diagnostic(none("have", "has", "the motors that it needs"), span, label)
                .expected(counted(wanted, "motor"), format!("{found}, with {near}"))
                .help(format!(
                    "{}leave motors free with `choose motor {}`",
                    if wanted <= room { evenly.as_str() } else { "" },
                    chosen.motor(candidate).name
                ));
            let times = [&drive.starts, &drive.stops];
            times.into_iter().flatten().fold(said, |d, time| d.related(time.span, "asks for so much thrust"))
        }
        _ => {
            let statements = &layout.choice.statements;
            let first = statements.free.first().map(|(_, span)| span);
            let span = first.or(statements.places.first()).copied().unwrap_or(layout.span);
            let drive = &layout.choice.drive;
            let related = [&drive.starts, &drive.stops];
            let places = if layout.choice.on_straights { "the straights have" } else { "the track has" };
            let label = format!("{places} room for {} at most", short.found);
            let said = diagnostic(none("have", "has", "room for the motors that it needs"), span, label)
                .expected(counted(short.wanted as usize, "motor"), format!("{}, with {near}", short.found))
                .help("leave stronger motors or lower speeds free, or give the drive more time");
            related.into_iter().flatten().fold(said, |d, time| d.related(time.span, "asks for so much thrust"))
        }
    })
}

/// What limits a candidate's capacity, in words.
pub fn limited(chosen: &Chosen, candidate: &Candidate) -> Option<String> {
    Some(limit_words(&chosen.sorter(candidate)?, candidate.capacity.as_ref()?.limit))
}

/// `7454 ± 11`
pub fn mean_words(mean: Mean) -> String {
    format!("{} ± {}", fixed(mean.value, 0), fixed(mean.half_width, 0))
}

/// `simulated, 7454 ± 11 items an hour of 7500`
pub fn simulated_words((found, required): (Mean, f64)) -> String {
    format!("simulated, {} items an hour of {}", mean_words(found), fixed(required, 0))
}

/// By the closed form there is enough, but none takes it.
fn short_in_simulation(chosen: &Chosen) -> Option<Diagnostic> {
    let required = chosen.layout.capacity.required.as_ref()?;
    let of = |k: &usize| Some((chosen.takes(&chosen.candidates[*k])?, &chosen.candidates[*k]));
    let (found, near) = chosen.short.iter().filter_map(of).max_by(|a, b| a.0.value.total_cmp(&b.0.value))?;
    let message = match (chosen.short.len(), chosen.order.is_empty()) {
        (1, true) => "the choice does not take the items an hour that are required".to_owned(),
        (n, true) => format!("none of {n} choices takes the items an hour that are required"),
        (n, false) => format!("none of the {n} cheapest choices takes the items an hour that are required"),
    };
    let percent = fixed(100.0 * (1.0 - found.value / required.least.value), 1);
    let label = format!("simulated, {} an hour, {percent} % less", mean_words(found));
    let said = Diagnostic::new(Code::E0605, message, required.least.span, label).expected(
        format!("at least {} items an hour", fixed(required.least.value, 0)),
        format!("{} at the most, with {}", simulated_words((found, required.least.value)), words(chosen, near)),
    );
    let said = chosen_from(chosen, said);
    let speed = near.speed * required.least.value / found.value.max(f64::MIN_POSITIVE);
    Some(match near.capacity.as_ref().filter(|_| found.value > 0.0) {
        Some(bound) => said.help(way_out(bound.limit, speed)),
        None => said,
    })
}

/// Each requirement is met by some candidate, all of them by none.
fn together(chosen: &Chosen) -> Diagnostic {
    let kinds = [
        (Requirement::Capacity, "do not reach the capacity"),
        (Requirement::Closes, "do not close the chain"),
        (Requirement::Tension, "have no take-up that holds the chain's tension"),
        (Requirement::Room, "have no room for their motors"),
        (Requirement::Motors, "need more motors than the layout has"),
    ];
    let told: Vec<String> = kinds
        .into_iter()
        .map(|(kind, what)| (chosen.missed_by(kind), what))
        .filter(|(n, _)| *n > 0)
        .map(|(n, what)| format!("{n} {what}"))
        .collect();
    let message = format!("none of {} choices does all that is required", chosen.candidates.len());
    let farthest = |c: &Candidate| c.shortfalls.iter().map(Shortfall::share).fold(0.0, f64::max);
    let near =
        chosen.candidates.iter().min_by(|a, b| farthest(a).total_cmp(&farthest(b)).then(a.total.total_cmp(&b.total)));
    let said = Diagnostic::new(Code::E0605, message, free(chosen), "too little to choose from")
        .expected("a choice that does everything", told.join(", "));
    let shown = |c: &Candidate| {
        let each = c.shortfalls.iter().map(short_words);
        format!("nearest is {}: {}", words(chosen, c), each.collect::<Vec<_>>().join("; "))
    };
    match near {
        Some(near) => said.help(shown(near)),
        None => said,
    }
}

/// `7402 items an hour of 7500`
pub fn short_words(short: &Shortfall) -> String {
    match short.requirement {
        Requirement::Capacity => format!("{} items an hour of {}", fixed(short.found, 0), fixed(short.wanted, 0)),
        Requirement::Closes => {
            format!("{} mm left over, at most {} mm", fixed(short.found * 1e3, 1), fixed(short.wanted * 1e3, 1))
        }
        Requirement::Tension => {
            format!("the take-up holds {} N of {} N", fixed(short.found, 0), fixed(short.wanted, 0))
        }
        Requirement::Motors => format!("{} of {}", counted(short.found as usize, "motor"), short.wanted),
        _ => format!("room for {} of {}", counted(short.found as usize, "motor"), short.wanted),
    }
}

fn failed_checks(chosen: &Chosen) -> Diagnostic {
    let message = match chosen.checked.len() {
        1 => "the choice does not pass its check in the dynamic model".to_owned(),
        n => format!("none of the {n} cheapest choices passes its check in the dynamic model"),
    };
    let alone = chosen.checked.iter().all(|(_, found)| found.as_ref().is_ok_and(super::Check::is_but_for_range));
    let measured = chosen.checked.iter().filter_map(|(_, found)| found.as_ref().ok()?.beyond_range());
    let least = measured.fold(f64::INFINITY, f64::min);
    if alone && least.is_finite() {
        let message = "no sensor that may be chosen measures what the sensor cart carries";
        let label = format!("a load cell measures {} N at least", fixed(least, 0));
        return Diagnostic::new(Code::E0605, message, free(chosen), label)
            .help(format!("leave a sensor with a `range` of {} N or more free", fixed(least.ceil(), 0)));
    }
    let said = Diagnostic::new(Code::E0605, message, free(chosen), "checked with forces and fatigue");
    let of = |(k, found): &(usize, Result<super::Check, String>)| {
        let why = match found {
            Err(why) => why.clone(),
            Ok(check) => failures(check).join("; "),
        };
        format!("{}: {why}", words(chosen, &chosen.candidates[*k]))
    };
    match chosen.checked.first() {
        Some(first) => said
            .expected("forces within what joints and wheels carry, and speed kept", of(first))
            .help("take stronger joints or wheels, more motors or less speed; `--checks` looks at more choices"),
        None => said,
    }
}

/// What of a check failed, in words.
pub fn failures(check: &super::Check) -> Vec<String> {
    let mut told = Vec::new();
    for part in &check.carried {
        if let Some(rated) = part.rated.filter(|rated| part.peak > *rated) {
            told.push(format!("{} carries {} N of {} N", part.part, fixed(part.peak, 0), fixed(rated, 0)));
        }
        if let Some((life, years)) = part.life.zip(check.years).filter(|(life, years)| life < years) {
            told.push(format!("{} lives {} years of {}", part.part, trimmed(life, 2), trimmed(years, 2)));
        }
    }
    if let Some((peak, range)) = check.beyond_range().and(check.measured) {
        told.push(format!("a load cell measures {} N of {} N", fixed(peak, 0), fixed(range, 0)));
    }
    let slow = |speed: f64| speed < 0.98 * check.wanted_speed;
    if slow(check.speed) || check.spare_speed.is_some_and(slow) {
        let speed = check.spare_speed.unwrap_or(check.speed).min(check.speed);
        told.push(format!("it runs {} m/s of {}", fixed(speed, 2), fixed(check.wanted_speed, 2)));
    }
    told
}
