//! A diagnosis in words.

use super::diagnosis::{Amount, Bound, CheckedRun, Diagnosis, Finding, GapPlace, RunGap, Verdict, ranked};
use super::simulator::Axis;
use crate::base::number::{fixed, significant, trimmed};
use crate::effects::{self, Experiment, RandomEffect};

/// A share in per cent, two digits where it is small; no more than can be known near 0 and 1.
pub fn percent(share: f64) -> String {
    if !share.is_finite() {
        return "unknown".to_owned();
    }
    let value = 100.0 * share;
    match value {
        x if x > 0.0 && x < 0.1 => "under 0.1 %".to_owned(),
        x if x > 99.9 && x < 100.0 => "over 99.9 %".to_owned(),
        x if (10.0..99.0).contains(&x.abs()) || x.abs() >= 100.0 => format!("{} %", fixed(x, 0)),
        x => format!("{} %", trimmed(x, 1)),
    }
}

/// A probability in per cent: no measurement makes sure of anything.
pub fn probability(p: f64) -> String {
    percent(if p.is_finite() { p.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON) } else { p })
}

/// The verdict in a few sentences, each of which follows from the numbers of the report alone:
/// - something "explains the gap" where it leaves no run over the limit of repeatability and closes something on runs
///   left out;
/// - "there is a gap" where a run is over its limit, and only then closures are told;
/// - a strength at its bound, and effects that could not be simulated, are named.
pub fn summary(found: &Diagnosis) -> String {
    let lead = match found.verdict {
        Verdict::None => nothing(found),
        Verdict::Unknown => unknown(found),
        _ if found.named().is_empty() => unnamed(found),
        _ if found.explained() => format!("{} {}", explanation(found), closure(found)),
        _ if found.has_gap() => format!("{} {}", best(found), closure(found)),
        _ => small(found),
    };
    let more = [doubt(found), at_bounds(found), untested(found)];
    more.into_iter().filter(|text| !text.is_empty()).fold(lead, |all, text| all + " " + &text)
}

fn nothing(found: &Diagnosis) -> String {
    match worst(found, |run| run.before) {
        Some(run) if run.over() => format!(
            "No gap is established: run {} is off by {} times the repeatability, over its limit of {}, but that is \
             likelier chance \
             (probability of no gap {}) than any known effect.",
            run.run,
            times(run.before),
            times(run.replicate_high),
            probability(found.none_probability)
        ),
        _ => "There is no gap: these runs differ from the simulation no more than repeated measurements do. Weaker \
         effects than the \
              repeatability shows would need more or longer runs."
            .to_owned(),
    }
}

fn unknown(found: &Diagnosis) -> String {
    let p = probability(found.unknown_probability);
    let lead = if found.has_gap() {
        format!("There is a gap, and none of the known effects explains it (probability {p}).")
    } else {
        format!(
            "No run is over the limit of repeatability, but what is off looks less like chance or a known effect \
             than like something \
             else (probability {p})."
        )
    };
    match worst(found, |run| run.after).filter(|_| found.has_gap() && !found.shown.is_empty()) {
        Some(_) if by_chance(found) => {
            format!(
                "{lead} {} would close most of it, but patterns of that kind have nearly any shape.",
                names(&found.with())
            )
        }
        Some(run) if run.after > run.replicate_high => {
            format!("{lead} The best of them, {}, leaves {}.", names(&found.with()), left(run))
        }
        Some(_) => format!("{lead} The best of them is {}.", names(&found.with())),
        None => lead,
    }
}

/// A verdict of which no effect is sure to be there.
fn unnamed(found: &Diagnosis) -> String {
    let gap =
        if found.has_gap() { "There is a gap, but no" } else { "No run is over the limit of repeatability, and no" };
    format!("{gap} effect is sure to be there: all intervals hold 0.")
}

fn explanation(found: &Diagnosis) -> String {
    let named = found.named();
    match (&named[..], found.verdict) {
        ([one], Verdict::Sensor) => format!("A sensor explains the gap: {}, with {}.", names(&[one]), likely(one)),
        ([one], _) => format!("One effect explains the gap: {}, with {}.", names(&[one]), likely(one)),
        _ => format!("Two effects together explain the gap: {}.", each(&named)),
    }
}

fn best(found: &Diagnosis) -> String {
    let named = found.named();
    let what = if named.len() > 1 { format!("{} together are", each(&named)) } else { format!("{} is", each(&named)) };
    let lead = format!("There is a gap, and {what} the best of the known effects");
    match worst(found, |run| run.after) {
        Some(run) if run.after > run.replicate_high => format!("{lead}, but leaves {}{}.", left(run), mostly(found)),
        _ => format!("{lead}."),
    }
}

/// That no lap of the model with what is named shows what is left.
fn doubt(found: &Diagnosis) -> String {
    let Some(run) = found.in_doubt() else { return String::new() };
    let with = if found.named().len() > 1 { "them" } else { "it" };
    let draws = if found.axis == Axis::Time { "repetitions" } else { "laps" };
    format!(
        "That is not certain: none of {} {draws} of the model with {with} is as far off as run {}, so something else is \
         off, too, or the machine follows another equation.",
        run.draws, run.run
    )
}

/// How many draws of the models are as far off as each run: with the shown effects, and as it is. `None` where too few
/// are known.
pub fn draws(found: &Diagnosis) -> Option<String> {
    let check = found.predictive_check.as_ref().filter(|check| !check.runs.is_empty())?;
    let draws = if found.axis == Axis::Time { "repetitions" } else { "laps" };
    let each = |runs: &[CheckedRun]| {
        let each: Vec<String> = runs.iter().map(|run| format!("{} of {}", run.leave_as_much, run.draws)).collect();
        each.join(", ")
    };
    let mut out = format!("As far off as the runs, in this order, {draws} of the model are: {}", each(&check.no_gap));
    if !found.shown.is_empty() {
        out += &format!("; with the effects {}", each(&check.runs));
    }
    Some(out + ".")
}

/// In which channel most of what is left lies.
fn mostly(found: &Diagnosis) -> String {
    match ranked(&found.unexplained.places).first() {
        Some((channel, share)) if *share > 0.0 => format!(", most of it in {channel}"),
        _ => String::new(),
    }
}

fn small(found: &Diagnosis) -> String {
    format!(
        "No run is over the limit of repeatability, but together they differ along the signature of {}. That is too \
         little to say how far \
         adding it closes anything.",
        each(&found.named())
    )
}

/// What the named effects close; only where there is a gap.
fn closure(found: &Diagnosis) -> String {
    let it = if found.named().len() > 1 { "them" } else { "it" };
    match (found.gap_closed, found.gap_closed_black_box) {
        (Some(x), _) if x <= 0.0 => format!("Adding {it} closes nothing on runs left out."),
        (Some(x), Some(b)) if b > 0.0 => format!(
            "Adding {it} closes {} of the gap on runs left out; a black box that names nothing closes {}.",
            percent(x),
            percent(b)
        ),
        (Some(x), _) => format!("Adding {it} closes {} of the gap on runs left out.", percent(x)),
        (None, _) if found.runs.len() < 2 => {
            "With a single run nothing could be left out, so how far the gap closes elsewhere is not known.".to_owned()
        }
        (None, _) => "The gap is too small to tell how far it closes on runs left out.".to_owned(),
    }
}

/// Strengths of what is named that are as large as they may be declared.
fn at_bounds(found: &Diagnosis) -> String {
    let mut out = Vec::new();
    for finding in found.named() {
        for (name, amount) in finding.places().flat_map(|at| at.strength) {
            if amount.at_bound.is_some() {
                out.push(format!("The {name} of {} is {}: the truth may lie beyond.", finding.name, bound(amount)));
            }
        }
    }
    out.join(" ")
}

/// `at its upper bound, 10 N`; empty where it is not.
pub fn bound(amount: &Amount) -> String {
    let value = format!("{} {}", significant(amount.value, 3), amount.unit);
    match amount.at_bound {
        None => String::new(),
        Some(Bound::Upper) => format!("at its upper bound, {}", value.trim_end()),
        Some(Bound::Lower) => format!("at its lower bound, {}", value.trim_end()),
    }
}

/// What could not be simulated.
fn untested(found: &Diagnosis) -> String {
    let each = found
        .untested()
        .into_iter()
        .map(|f| format!("{} (probability {})", f.name, probability(f.untested_probability)));
    let each: Vec<String> = each.collect();
    match each.len() {
        0 => String::new(),
        1 => format!("Not ruled out, as it could not be simulated: {}.", each.join(", ")),
        _ => format!("Not ruled out, as they could not be simulated: {}.", each.join(", ")),
    }
}

/// The run that is farthest over its limit.
fn worst(found: &Diagnosis, of: impl Fn(&RunGap) -> f64) -> Option<&RunGap> {
    let over = |run: &RunGap| of(run) / run.replicate_high.max(1e-9);
    found.runs.iter().filter(|run| of(run).is_finite()).max_by(|a, b| over(a).total_cmp(&over(b)))
}

fn left(run: &RunGap) -> String {
    format!(
        "{} times the repeatability in run {}, over its limit of {}",
        times(run.after),
        run.run,
        times(run.replicate_high)
    )
}

/// A mean square over that of repeated measurements: near the limit to the third decimal, as it is held beside that.
fn times(x: f64) -> String {
    match x {
        _ if !x.is_finite() => "unknown".to_owned(),
        _ if x.abs() < 2.0 => trimmed(x, 3),
        _ => significant(x, 3),
    }
}

fn likely(finding: &Finding) -> String {
    format!("probability {}", probability(finding.probability))
}

fn named(finding: &Finding) -> String {
    let places: Vec<&str> = finding.places().map(|at| at.place).collect();
    if finding.place.is_empty() { finding.name.clone() } else { format!("{} ({})", finding.name, places.join("; ")) }
}

fn names(findings: &[&Finding]) -> String {
    findings.iter().map(|f| named(f)).collect::<Vec<_>>().join(" and ")
}

/// Each with its probability.
fn each(findings: &[&Finding]) -> String {
    findings.iter().map(|f| format!("{} ({})", named(f), likely(f))).collect::<Vec<_>>().join(" and ")
}

/// What to measure next.
pub fn next_experiment(found: &Diagnosis) -> String {
    if let [first, ..] = &found.untested()[..] {
        return format!("Let the model simulate {}, and diagnose again: without it no cause is sure.", first.name);
    }
    if let Some(group) = found.groups.first() {
        return group.experiment.clone();
    }
    match found.verdict {
        Verdict::None => "None is needed; more or longer runs would show weaker effects.".into(),
        _ if by_chance(found) => {
            "A run with the sensors on another cart: what carts differ by goes along with them, what the track does \
             stays at its place."
                .into()
        }
        Verdict::Unknown => found.places.first().map_or_else(|| "More or longer runs.".into(), |p| look(p, found.axis)),
        _ if found.runs.len() < 2 => match found.axis {
            Axis::Track => "A second run at another speed and tension, to confirm the cause on data left out.".into(),
            Axis::Time => "A second run under other conditions, to confirm the cause on data left out.".into(),
        },
        _ => "Fix the cause, or add the effect to the model, and measure one more run to confirm.".into(),
    }
}

/// Where to look at the machine.
fn look(place: &GapPlace, axis: Axis) -> String {
    let (from, to) = place.extent.ends();
    let ends = format!("{} between {} and {} {}", place.channel, fixed(from, 1), fixed(to, 1), axis.unit());
    match axis {
        Axis::Track => {
            format!("Look at the machine where the gap is largest: {ends}; then measure there at two speeds.")
        }
        Axis::Time => format!(
            "Look at what happens when the gap is largest: {ends}; then measure it again under other conditions."
        ),
    }
}

/// Whether what carts differ by was named or would close most of the gap: its pattern along the track has nearly any
/// shape.
fn by_chance(found: &Diagnosis) -> bool {
    if found.axis == Axis::Time {
        return false;
    }
    let by_cart = |e: &Finding| {
        effects::named(&e.name)
            .and_then(|effect| effect.random)
            .is_some_and(|(random, _)| random == RandomEffect::ByCart)
    };
    let named = !found.named().is_empty();
    let closes = |e: &Finding| e.gap_closed.is_some_and(|closed| closed > 0.5);
    found.runs.len() > 1 && found.with().first().is_some_and(|e| by_cart(e) && (named || closes(e)))
}

/// What would separate effects that these runs do not.
pub fn separate(members: &[String], axis: Axis) -> String {
    let list = members.join(", ");
    if axis == Axis::Time {
        return format!(
            "These runs cannot separate {list}; runs under other conditions (larger, slower, with another load), in which \
             one of them does more and the other does not, would."
        );
    }
    let separates = |member: &String| effects::named(member).map(|effect| effect.separated_by);
    let how = members.iter().filter_map(separates).min().unwrap_or(Experiment::Runs).words();
    format!("These runs cannot separate {list}; {how}, would.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::random_reports::{hold, report};

    #[test]
    fn every_sentence_agrees_with_its_numbers() {
        let mut met = [0; 5];
        for seed in 0..4000 {
            let found = report(seed);
            hold(&found.summary, &found).unwrap_or_else(|wrong| panic!("{seed}: {wrong}"));
            hold(&found.next_experiment, &Diagnosis { effects: Vec::new(), shown: Vec::new(), ..found.clone() })
                .unwrap_or_else(|wrong| panic!("{seed}: {wrong}"));
            let kinds =
                ["explain the gap", "explains the gap", "There is a gap, and", "No run is over", "There is no gap"];
            kinds.iter().zip(&mut met).for_each(|(kind, met)| *met += usize::from(found.summary.contains(kind)));
        }
        // Every kind of sentence was there.
        assert!(met.iter().all(|n| *n > 5), "{met:?}");
    }

    #[test]
    fn shares_claim_no_certainty_that_is_not_there() {
        let said: Vec<String> = [0.0, 0.000_4, 0.034_2, 0.5, 0.995, 0.999_6, 1.0, -0.25].map(percent).into();
        assert_eq!(said, ["0 %", "under 0.1 %", "3.4 %", "50 %", "99.5 %", "over 99.9 %", "100 %", "-25 %"]);
    }
}
