//! What a bad fit is told with: how bad it is, which features it leaves, and where on the track.

use super::goodness::Stretch;
use super::parameter::Parameter;
use super::study::RunFit;
use crate::base::number::{fixed, trimmed};
use crate::base::words::list;
use serde::Serialize;

/// Kinds of features that are named, at most.
const KINDS: usize = 4;

/// A warning about a run's fit. The sentences have no full stop.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    pub run: String,
    /// `the model does not fit: …`, or that values are at their bounds.
    pub message: String,
    /// Which features are off.
    pub what: Option<String>,
    /// Where on the track.
    #[serde(rename = "where")]
    pub place: Option<String>,
    /// What to do.
    pub help: String,
}

const DIAGNOSE: &str =
    "`lss gap diagnose` asks which effect the model lacks; until then the fitted values are not those of the machine";

/// What is wrong with a fit; `None` where the model fits and no value is at a bound.
pub fn warning(fit: &RunFit) -> Option<Warning> {
    let bounds = at_bounds(fit);
    let held = (!bounds.is_empty()).then(|| {
        let at = if bounds.len() == 1 { "is at its bound" } else { "are at their bounds" };
        format!("{} {at}", list(&bounds, "and"))
    });
    if fit.fits() {
        return held.map(|held| Warning {
            run: fit.run.clone(),
            message: format!("{held}: the run asks for more than the bound allows, or says too little"),
            what: None,
            place: None,
            help: "check the layout's nominal value, or hold it with --free; `lss gap diagnose` asks which effect \
                   would explain it"
                .to_owned(),
        });
    }
    let limit = &fit.goodness.limit;
    let more = held.map_or_else(String::new, |held| format!("; {held}"));
    Some(Warning {
        run: fit.run.clone(),
        message: format!(
            "the model does not fit: the objective is {}, repeatability allows {}{more}",
            fixed(fit.objective, 2),
            fixed(limit.objective, 2)
        ),
        what: what(fit),
        place: place(&fit.goodness.stretches),
        help: DIAGNOSE.to_owned(),
    })
}

/// Fitted parameters at a bound.
pub fn at_bounds(fit: &RunFit) -> Vec<&'static str> {
    let held = |p: &Parameter| fit.parameters.get(p.name()).is_some_and(|e| e.at_bound && e.fitted);
    Parameter::ALL.into_iter().filter(held).map(Parameter::name).collect()
}

/// Kinds of features that are off, the worst first.
fn what(fit: &RunFit) -> Option<String> {
    let mut all: Vec<(&String, &f64)> = fit.misfits.iter().collect();
    all.sort_by(|a, b| b.1.total_cmp(a.1));
    let named: Vec<String> = all
        .iter()
        .take(KINDS)
        .map(|(kind, size)| format!("{kind} ({} times the repeatability)", trimmed(**size, 1)))
        .collect();
    let more = all.len().saturating_sub(KINDS);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    (!named.is_empty()).then(|| named.join("; ") + &more)
}

/// Stretches of the track, by channel.
fn place(stretches: &[Stretch]) -> Option<String> {
    let one = |s: &Stretch| {
        format!(
            "{} of {} from {} to {} m ({} deviations)",
            s.feature,
            s.channel,
            trimmed(s.from_m, 1),
            trimmed(s.to_m, 1),
            trimmed(s.deviations, 1)
        )
    };
    (!stretches.is_empty()).then(|| stretches.iter().map(one).collect::<Vec<_>>().join("; "))
}

impl Warning {
    /// Lines after the run's name: the message, what and where below it, and the way out.
    pub fn lines(&self) -> String {
        let line = |name: &str, text: &Option<String>| {
            text.as_ref().map_or_else(String::new, |text| format!("\n  {name}: {text}"))
        };
        format!("{}{}{}\n  help: {}", self.message, line("what", &self.what), line("where", &self.place), self.help)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain_input::ContactLaw;
    use crate::identify::goodness::{Goodness, Limit};
    use crate::identify::study::Estimate;
    use std::collections::BTreeMap;

    fn fit(objective: f64, held: &[&str]) -> RunFit {
        let estimate = |p: Parameter| {
            let at_bound = held.contains(&p.name());
            (p.name().to_owned(), Estimate { value: 0.5, low: 0.4, high: 0.6, at_bound, fitted: true })
        };
        let limit = Limit { objective: 1.7, degrees_of_freedom: 90.0 };
        let stretch =
            Stretch { channel: "joint_xi".into(), feature: "mean".into(), from_m: 12.5, to_m: 17.5, deviations: 23.0 };
        let none = BTreeMap::new;
        RunFit {
            run: "run-01".into(),
            law: ContactLaw::default(),
            key: String::new(),
            carried_from: None,
            objective,
            parameters: Parameter::ALL.into_iter().map(estimate).collect(),
            damping: none(),
            achieved: none(),
            nrmsd: none(),
            nrmsd_two_carts: none(),
            identifiability: Vec::new(),
            misfits: [("spectrum of run_left".to_owned(), 3.0), ("means along the track of joint_xi".to_owned(), 12.0)]
                .into(),
            goodness: Goodness { limit, stretches: vec![stretch], lap_m: 50.0, profiles: BTreeMap::new() },
            noise: none(),
            correlated_noise: BTreeMap::new(),
            hum: BTreeMap::new(),
            laps: 1.0,
            filled: 0,
            masked: 0,
            unsteady_s: 0.0,
            steps: 1,
            simulations: 1,
            coordinates: Vec::new(),
            covariance: Vec::new(),
            information: Vec::new(),
            pull: Vec::new(),
        }
    }

    #[test]
    fn a_bad_fit_and_values_at_bounds_are_told_and_a_good_fit_is_not() {
        assert_eq!(warning(&fit(1.6, &[])), None);
        let told = warning(&fit(1.6, &["k_p"])).expect("a warning").lines();
        assert!(told.starts_with("k_p is at its bound: the run asks for more"), "{told}");
        let told = warning(&fit(10.9, &["speed", "tension"])).expect("a warning").lines();
        let expected = "the model does not fit: the objective is 10.90, repeatability allows 1.70; speed and tension \
                        are at their bounds
  what: means along the track of joint_xi (12 times the repeatability); spectrum of run_left (3 times the repeatability)
  where: mean of joint_xi from 12.5 to 17.5 m (23 deviations)
  help: `lss gap diagnose` asks which effect the model lacks";
        assert!(told.starts_with(expected), "{told}");
    }
}
