//! Whether a layout takes as many items an hour as it is asked to.

use super::bound::{Bound, bound};
use super::flow::Limit;
use super::sorter::Sorter;
use crate::base::number::fixed;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::RequiredCapacity;

/// What limits a sorter, in words.
pub fn limit_words(sorter: &Sorter, limit: Limit) -> String {
    match limit {
        Limit::Stretch(i) => format!(
            "carriers behind induction {}, of which {} pass an hour",
            sorter.inductions[i].name,
            fixed(sorter.carriers_per_hour(), 0)
        ),
        Limit::Induction(i) => {
            let induction = &sorter.inductions[i];
            let works = induction.fails.as_ref().map_or_else(String::new, |fails| {
                format!(", as it works {} % of the time", fixed(100.0 * fails.available(), 1))
            });
            format!("induction {}, which takes {} an hour{works}", induction.name, fixed(sorter.most_of(induction), 0))
        }
        Limit::Chute(i) => {
            let chute = &sorter.chutes[i];
            let hourly = fixed(sorter.most_into(chute).unwrap_or(f64::INFINITY), 0);
            match &sorter.waves {
                None => format!("chute {}, from which {hourly} an hour are taken away", chute.name),
                Some(_) => format!("chute {}, which takes {hourly} an hour until the next wave empties it", chute.name),
            }
        }
    }
}

/// How the closed form's number is told.
pub fn most_words(sorter: &Sorter, bound: &Bound) -> &'static str {
    if bound.is_strict(sorter) { "at most" } else { "about" }
}

/// The error where by the closed form a layout's sorter, if it is one, does not reach what is required.
pub fn reached(sorter: Option<&Sorter>, required: &RequiredCapacity) -> Option<Diagnostic> {
    let (least, span) = (required.least.value, required.least.span);
    let asked = format!("at least {} items an hour", fixed(least, 0));
    let why = required.reason.as_ref().map_or_else(String::new, |reason| format!(" ({reason})"));
    let message = format!("the sorter does not reach the capacity that it has to have{why}");
    let Some(sorter) = sorter else {
        return Some(
            Diagnostic::new(Code::E0604, message, span, "no items can come and go")
                .expected(asked, "no carts, no induction, or no chutes")
                .help("place an `induction` and `chutes`, and carts that close the loop"),
        );
    };
    let found = bound(sorter, sorter.proportions().as_deref())?;
    if found.throughput >= least {
        return None;
    }
    let most = fixed(found.throughput, 0);
    let of = if sorter.proportions().is_some() { " in the proportions in which they come" } else { "" };
    let label = format!("{} {most} an hour{of}", if found.is_strict(sorter) { "no more than" } else { "about" });
    let diagnostic = Diagnostic::new(Code::E0604, message, span, label).expected(
        asked,
        format!("{} {most}{of}, limited by {}", most_words(sorter, &found), limit_words(sorter, found.limit)),
    );
    let speed = sorter.speed * least / found.throughput;
    Some(diagnostic.help(format!("{}{}", way_out(found.limit, speed), next_limit(sorter, &found, speed, least))))
}

/// What holds a sorter back at that speed, m/s, if it then still takes less than it has to.
fn next_limit(sorter: &Sorter, found: &Bound, speed: f64, least: f64) -> String {
    let faster = Sorter { speed, ..sorter.clone() };
    match bound(&faster, faster.proportions().as_deref()) {
        Some(next) if matches!(found.limit, Limit::Stretch(_)) && next.throughput < least * (1.0 - 1e-9) => format!(
            "; with carriers enough it takes {} an hour, limited by {}",
            fixed(next.throughput, 0),
            limit_words(&faster, next.limit)
        ),
        _ => String::new(),
    }
}

/// What to do about what limits a sorter; carriers are enough at `speed`, m/s.
pub fn way_out(limit: Limit, speed: f64) -> String {
    match limit {
        Limit::Stretch(_) => format!(
            "at {} m/s carriers are enough; or take shorter carts, or place an induction behind chutes, so that carriers \
             are used more than once in a lap",
            fixed((speed * 100.0).ceil() / 100.0, 2)
        ),
        Limit::Induction(_) => "let it take more with `feed ... up to`, or place another induction".to_owned(),
        Limit::Chute(_) => {
            "take items away faster with `storage ... every`, let chutes hold more, or place more of them".to_owned()
        }
    }
}
