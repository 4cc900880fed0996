//! What is said to a model outside, and what it answers: one JSON object a line. `docs/outside-models.md` describes it
//! for those who write models.

use super::Error;
use crate::gap::{Candidate, Candidates, PerRun, Strength};
use crate::signal::columns::FARTHEST;
use crate::source::steers;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A question.
#[derive(Serialize)]
#[serde(tag = "request", rename_all = "snake_case")]
pub(super) enum Question<'a> {
    Describe,
    Simulate { run: RunAsked<'a>, nuisances: BTreeMap<&'a str, f64>, effects: Vec<EffectAsked<'a>> },
}

/// A run, or a part of one.
#[derive(Serialize)]
pub(super) struct RunAsked<'a> {
    pub name: &'a str,
    /// Absolute path.
    pub file: &'a str,
    /// First and last time that is compared, s.
    pub from: f64,
    pub to: f64,
    /// Numbers of the campaign's entry.
    pub settings: &'a BTreeMap<String, f64>,
}

/// An effect to be added.
#[derive(Serialize)]
pub(super) struct EffectAsked<'a> {
    pub name: &'a str,
    #[serde(skip_serializing_if = "str::is_empty")]
    pub place: &'a str,
    pub strengths: BTreeMap<&'a str, f64>,
}

impl Question<'_> {
    pub fn line(&self) -> String {
        // Maps of text to finite numbers always serialise.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// What a model is made of.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Description {
    pub nuisances: Vec<Nuisance>,
    pub effects: Candidates,
    /// Of some channels, how closely the model is believed to follow, in their units.
    pub accuracy: BTreeMap<String, f64>,
}

/// A parameter that is fitted to each run and explains nothing.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Nuisance {
    pub name: String,
    #[serde(default)]
    pub unit: String,
    pub nominal: f64,
    pub low: f64,
    pub high: f64,
    /// Whether all runs have the same value.
    #[serde(default)]
    pub shared: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Described {
    #[serde(default)]
    nuisances: Vec<Nuisance>,
    effects: Vec<DescribedEffect>,
    #[serde(default)]
    accuracy: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DescribedEffect {
    name: String,
    #[serde(default)]
    place: String,
    strengths: Vec<StrengthSaid>,
    #[serde(default)]
    sensor: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StrengthSaid {
    name: String,
    #[serde(default)]
    unit: String,
    trial: f64,
    low: f64,
    high: f64,
}

/// What was simulated; NaN is not known.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Series {
    /// s, increasing.
    pub time: Vec<f64>,
    /// In the order of the channels asked for.
    pub channels: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Simulated {
    time: Vec<f64>,
    channels: BTreeMap<String, Vec<Option<f64>>>,
}

/// Reads a line as `T`, unless it says `{"error": "..."}`.
fn read<T: for<'a> Deserialize<'a>>(line: &str, request: &'static str) -> Result<T, Error> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Refusal {
        error: String,
    }
    match serde_json::from_str::<T>(line) {
        Ok(answer) => Ok(answer),
        Err(why) => Err(match serde_json::from_str::<Refusal>(line) {
            Ok(refusal) => Error::Refused(refusal.error),
            Err(_) if why.is_data() && line.trim_start().starts_with('{') => {
                Error::Answer { request, line: line.to_owned(), why: why.to_string() }
            }
            Err(_) => Error::NotJson { line: around(line, why.column()), why: why.to_string() },
        }),
    }
}

/// A line from shortly before its column on, which is counted in bytes.
fn around(line: &str, column: usize) -> String {
    const BEFORE: usize = 60;
    match line.char_indices().map(|(i, _)| i).find(|i| i + BEFORE >= column) {
        Some(from) if from > 0 => format!("...{}", &line[from..]),
        _ => line.to_owned(),
    }
}

/// Reads the answer to `describe`.
pub(super) fn description(line: &str) -> Result<Description, Error> {
    let Described { nuisances, effects, accuracy } = read(line, "describe")?;
    let wrong = |why: String| Err(Error::Answer { request: "describe", line: line.to_owned(), why });
    let strengths = effects.iter().flat_map(|e| &e.strengths);
    let texts = nuisances.iter().map(|n| &n.name).chain(effects.iter().flat_map(|e| [&e.name, &e.place]));
    if let Some(text) = texts.chain(strengths.flat_map(|s| [&s.name, &s.unit])).find(|t| t.contains(steers)) {
        return wrong(format!("`{text}` holds a control character"));
    }
    let numbers = nuisances.iter().flat_map(|n| [n.nominal, n.low, n.high]).chain(accuracy.values().copied());
    let strengths = effects.iter().flat_map(|e| &e.strengths).flat_map(|s| [s.trial, s.low, s.high]);
    if let Some(x) = numbers.chain(strengths).find(|x| x.abs() > FARTHEST) {
        return wrong(format!("{x:e} is beyond ±{FARTHEST:e}"));
    }
    let mut names = BTreeSet::new();
    for n in &nuisances {
        if n.name.is_empty() || !names.insert(n.name.as_str()) {
            return wrong(format!("a nuisance needs a name of its own, not `{}`", n.name));
        }
        if !(n.low < n.high && n.low <= n.nominal && n.nominal <= n.high) {
            return wrong(format!("the nuisance `{}` needs low < high and a nominal value between them", n.name));
        }
    }
    if effects.is_empty() {
        return wrong("there are no effects to choose from".to_owned());
    }
    let mut names = BTreeSet::new();
    for e in &effects {
        if e.name.is_empty() || !names.insert((&e.name, &e.place)) {
            return wrong(format!("an effect needs a name of its own, or another place, not `{}` again", e.name));
        }
        if e.strengths.is_empty() {
            return wrong(format!("the effect `{}` has no strengths", e.name));
        }
        let mut own = BTreeSet::new();
        for s in &e.strengths {
            if s.name.is_empty() || !own.insert(&s.name) {
                return wrong(format!("a strength of `{}` needs a name of its own, not `{}`", e.name, s.name));
            }
            if !(s.low <= 0.0 && 0.0 <= s.high && s.low <= s.trial && s.trial <= s.high && s.trial != 0.0) {
                let of = format!("`{}` of `{}`", s.name, e.name);
                return wrong(format!(
                    "the strength {of} needs low <= 0 <= high and a trial between them that is not 0"
                ));
            }
        }
    }
    if let Some((channel, x)) = accuracy.iter().find(|(_, x)| **x < 0.0) {
        return wrong(format!("the accuracy of `{channel}` is {x}, but has to be 0 or more"));
    }
    let strength = |s: StrengthSaid| Strength {
        name: s.name,
        unit: s.unit,
        trial: s.trial,
        as_built: 0.0,
        beside: false,
        low: s.low,
        high: s.high,
        shares: PerRun::default(),
    };
    let candidate = |e: DescribedEffect| Candidate {
        effect: e.name,
        place: e.place,
        fixed: Vec::new(),
        strengths: e.strengths.into_iter().map(strength).collect(),
        sensor: e.sensor,
        random_effect: None,
        discrepancy: 0.0,
        several: false,
        alternative_to: None,
    };
    Ok(Description { nuisances, effects: effects.into_iter().map(candidate).collect(), accuracy })
}

/// Reads the answer to `simulate`: all `channels`, over times that hold `from` and `to`.
pub(super) fn series(line: &str, channels: &[String], from: f64, to: f64) -> Result<Series, Error> {
    let Simulated { time, channels: mut said } = read(line, "simulate")?;
    let wrong = |why: String| Err(Error::Answer { request: "simulate", line: line.to_owned(), why });
    if let Some(i) = time.windows(2).position(|w| w[0] >= w[1]) {
        return wrong(format!("time has to increase, but {} s comes before {} s", time[i], time[i + 1]));
    }
    let slack = 1e-9 * (1.0 + from.abs().max(to.abs()));
    match (time.first(), time.last()) {
        (Some(first), Some(last)) if *first <= from + slack && *last >= to - slack => {}
        (Some(first), Some(last)) => {
            return wrong(format!("it covers {first} s to {last} s, but {from} s to {to} s were asked for"));
        }
        _ => return wrong("there are no samples".to_owned()),
    }
    let far = |x: &f64| x.abs() > FARTHEST;
    if let Some(t) = time.iter().find(|t| far(t)) {
        return wrong(format!("time holds {t:e}, which is beyond ±{FARTHEST:e}"));
    }
    let mut all = Vec::with_capacity(channels.len());
    for name in channels {
        if let Some(x) = said.get(name).and_then(|x| x.iter().flatten().find(|x| far(x))) {
            return wrong(format!("`{name}` holds {x:e}, which is beyond ±{FARTHEST:e}"));
        }
        match said.remove(name) {
            Some(x) if x.len() == time.len() => all.push(x.into_iter().map(|x| x.unwrap_or(f64::NAN)).collect()),
            Some(x) => return wrong(format!("`{name}` has {} samples where time has {}", x.len(), time.len())),
            None => return wrong(format!("the channel `{name}` is missing")),
        }
    }
    Ok(Series { time, channels: all })
}

impl Series {
    /// On other times, which increase too, by straight lines. What lies beyond the ends by rounding has the ends'
    /// values.
    pub fn at(&self, times: &[f64]) -> Vec<Vec<f64>> {
        let last = self.time.len().saturating_sub(1);
        let mut i = 0;
        let places: Vec<(usize, f64)> = times
            .iter()
            .map(|&t| {
                while i + 1 < last && self.time[i + 1] <= t {
                    i += 1;
                }
                let width = self.time.get(i + 1).map_or(1.0, |next| next - self.time[i]);
                (i, ((t - self.time[i]) / width).clamp(0.0, 1.0))
            })
            .collect();
        let value = |x: &[f64], (i, share): (usize, f64)| match share {
            0.0 => x[i],
            1.0 => x[last.min(i + 1)],
            _ => x[i] + share * (x[last.min(i + 1)] - x[i]),
        };
        self.channels.iter().map(|x| places.iter().map(|&p| value(x, p)).collect()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"{"nuisances": [{"name": "m", "unit": "kg", "nominal": 2, "low": 1, "high": 3}],
        "effects": [{"name": "drag", "strengths": [{"name": "c", "trial": 0.1, "low": 0, "high": 1}]}]}"#;

    #[test]
    fn a_description_is_read_and_its_mistakes_are_told() {
        let good = description(GOOD).expect("good");
        assert_eq!((good.effects.first().unwrap().effect.as_str(), good.nuisances[0].nominal), ("drag", 2.0));
        let cases = [
            ("\"nominal\": 2", "\"nominal\": 4", "needs low < high and a nominal value between"),
            ("\"low\": 0", "\"low\": 0.05", "low <= 0 <= high"),
            ("\"trial\": 0.1", "\"trial\": 0", "a trial between them that is not 0"),
            ("\"high\": 3", "\"hihg\": 3", "unknown field `hihg`, expected one of"),
            ("\"trial\": 0.1", "\"trial\": NaN", "which is no answer: expected value at line"),
            ("\"drag\"", "\"\"", "an effect needs a name of its own"),
            ("\"high\": 1}", "\"high\": 1e308}", "1e308 is beyond ±1e30"),
            ("\"drag\"", "\"\\u001b[2J\"", "holds a control character"),
        ];
        for (from, to, expected) in cases {
            let told = description(&GOOD.replace(from, to)).expect_err(to).to_string();
            assert!(told.contains(expected), "{told}\n{expected}");
        }
        assert_eq!(description(r#"{"error": "no licence"}"#), Err(Error::Refused("no licence".to_owned())));
    }

    #[test]
    fn a_simulation_is_read_and_its_mistakes_are_told() {
        let read = |line: &str| series(line, &["x".to_owned()], 0.0, 2.0);
        let good = read(r#"{"time": [0, 1, 2], "channels": {"x": [1, null, 3], "more": [0, 0, 0]}}"#).expect("good");
        assert!(good.channels[0][1].is_nan());
        let line = read(r#"{"time": [-1, 1, 3], "channels": {"x": [1, 3, 7]}}"#).expect("good");
        assert_eq!(line.at(&[0.0, 1.0, 2.0]), [[2.0, 3.0, 5.0]]);
        let cases = [
            (r#"{"time": [0, 1], "channels": {"x": [1, 2]}}"#, "covers 0 s to 1 s, but 0 s to 2 s were asked for"),
            (r#"{"time": [0, 2, 2], "channels": {"x": [1, 2, 3]}}"#, "2 s comes before 2 s"),
            (r#"{"time": [0, 2], "channels": {"x": [1]}}"#, "`x` has 1 samples where time has 2"),
            (r#"{"time": [0, 2], "channels": {"x": [1, -1e308]}}"#, "`x` holds -1e308, which is beyond ±1e30"),
            (r#"{"time": [0, 1e300], "channels": {"x": [1, 2]}}"#, "time holds 1e300"),
            (r#"{"time": [0, 2], "channels": {"y": [1, 2]}}"#, "the channel `x` is missing"),
            (r#"{"time": [], "channels": {"x": []}}"#, "there are no samples"),
            (r#"{"time": [0, 2]}"#, "missing field `channels`"),
            ("hello", "the model said `hello`, which is no answer"),
            ("[1]", "which is no answer"),
        ];
        for (line, expected) in cases {
            let told = read(line).expect_err(line).to_string();
            assert!(told.contains(expected), "{told}\n{expected}");
        }
    }
}
