//! Reports whose numbers are random, also such as no diagnosis makes, and what their sentences must agree with.

use super::diagnosis::{
    Amount, Bound, CheckedRun, Diagnosis, Extent, Finding, GapPlace, Group, Lost, Overlay, PredictiveCheck, RunGap,
    Unexplained, Verdict,
};
use super::simulator::Axis;
use super::words;
use crate::base::random::uniform;
use std::collections::BTreeMap;

/// Names that are in no other sentence.
const EFFECTS: [&str; 4] = ["qa_clearance", "qb_friction", "qc_gain", "qd_radiation"];

struct Random(u64);

impl Random {
    fn one(&mut self) -> f64 {
        uniform(&mut self.0)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.one() * n as f64) as usize % n
    }

    fn chance(&mut self, p: f64) -> bool {
        self.one() < p
    }

    fn some(&mut self, low: f64, high: f64) -> Option<f64> {
        let x = low + (high - low) * self.one();
        self.chance(0.7).then_some(x)
    }

    /// Now and then exactly 0 or 1, or next to them.
    fn share(&mut self) -> f64 {
        [0.0, 1.0, 0.9996, 0.0003, self.one(), self.one(), self.one()][self.below(7)]
    }

    fn run(&mut self, k: usize) -> RunGap {
        let replicate_high = 1.0 + 0.6 * self.one();
        // On either side of the limit.
        let mut square =
            |under: f64, most: f64| if self.chance(under) { replicate_high * self.one() } else { most * self.one() };
        let (before, after) = (square(0.4, 40.0), square(0.7, 25.0));
        RunGap { run: format!("run-{k}"), before, after, replicate: 1.0, replicate_high }
    }

    fn amount(&mut self) -> Amount {
        let value = 10.0 * self.one() - 3.0;
        let half = 6.0 * self.one();
        let at_bound = [None, None, Some(Bound::Lower), Some(Bound::Upper)][self.below(4)];
        Amount { value, low: value - half, high: value + half, unit: "N".into(), at_bound, by_run: BTreeMap::new() }
    }

    fn finding(&mut self, name: &str) -> Finding {
        let strength = if self.chance(0.9) { [("size".to_owned(), self.amount())].into() } else { BTreeMap::new() };
        let probability = self.share();
        Finding {
            name: name.into(),
            group: name.into(),
            probability,
            untested_probability: if self.chance(0.2) { probability } else { 0.0 },
            strength,
            gap_closed: self.some(-3.0, 1.0),
            gap_closed_placebo: self.some(-3.0, 1.0),
            place: if self.chance(0.3) { "somewhere".into() } else { String::new() },
            fixed: BTreeMap::new(),
            shape: None,
            elsewhere: Vec::new(),
        }
    }

    fn place(&mut self, axis: Axis, channel: &str) -> GapPlace {
        let from = 50.0 * self.one();
        let extent = Extent::new(axis, from, from + 10.0 * self.one());
        GapPlace { channel: channel.into(), extent, band: "track".into(), share: 0.4 * self.one() }
    }

    fn overlay(&mut self, channel: &str) -> Overlay {
        let mut numbers = |size: f64| (0..9).map(|_| size * self.one()).collect::<Vec<f64>>();
        Overlay {
            run: "run-0".into(),
            channel: channel.into(),
            band: "track".into(),
            unit: "N".into(),
            at: (0..9).map(f64::from).collect(),
            measured: numbers(9.0),
            before: numbers(9.0),
            after: numbers(9.0),
            repeatability: numbers(1.0),
        }
    }
}

/// One of as many reports as there are seeds.
pub fn report(seed: u64) -> Diagnosis {
    let mut random = Random(seed);
    let axis = [Axis::Track, Axis::Time][random.below(2)];
    let verdicts = [Verdict::Effect, Verdict::Pair, Verdict::Sensor, Verdict::None, Verdict::Unknown];
    let verdict = verdicts[random.below(5)];
    let effects: Vec<Finding> = EFFECTS.iter().map(|name| random.finding(name)).collect();
    let first = random.below(EFFECTS.len() - 1);
    let shown = &EFFECTS[first..=first + usize::from(verdict == Verdict::Pair)];
    let places: Vec<GapPlace> = ["a", "b", "a"].map(|channel| random.place(axis, channel)).into();
    let lost = |f: &Finding| Lost {
        effect: f.name.clone(),
        strength: [("size".to_owned(), 2.0)].into(),
        run: "run-0".into(),
        why: "the model ended".into(),
        ..Lost::default()
    };
    let mut found = Diagnosis {
        verdict,
        summary: String::new(),
        shown: shown.iter().map(|name| (*name).to_owned()).collect(),
        lost: effects.iter().filter(|f| f.untested()).map(lost).collect(),
        untested_probability: effects.iter().map(|f| f.untested_probability).sum(),
        effects,
        places: if random.chance(0.8) { places } else { Vec::new() },
        unknown_probability: random.share(),
        none_probability: random.share(),
        repeatability: [("a".to_owned(), 0.4)].into(),
        next_experiment: String::new(),
        groups: Vec::<Group>::new(),
        runs: (0..random.below(4)).map(|k| random.run(k)).collect(),
        gap_closed_black_box: random.some(-2.0, 1.0),
        gap_closed: random.some(-2.0, 1.0),
        unexplained: Unexplained {
            places: ["a", "b"].map(|channel| random.place(axis, channel)).into(),
            ..Unexplained::default()
        },
        predictive_check: None,
        noise: BTreeMap::new(),
        gap_closed_channels: [("a".to_owned(), random.one())].into(),
        overlays: vec![random.overlay("a")],
        axis,
        outside: None,
    };
    if random.chance(0.7) {
        let mut checked = |run: &RunGap| CheckedRun {
            run: run.run.clone(),
            draws: 19 + random.below(60),
            leave_as_much: [0, 1 + random.below(19)][random.below(2)],
        };
        let runs: Vec<CheckedRun> = found.runs.iter().map(&mut checked).collect();
        let passed = runs.iter().all(|run| run.leave_as_much > 0);
        found.predictive_check = Some(PredictiveCheck { passed, no_gap: runs.clone(), runs });
    }
    found.summary = words::summary(&found);
    found.next_experiment = words::next_experiment(&found);
    found
}

/// Holds the sentences of a text about a report to the report's numbers; what the text gets wrong is the error.
pub fn hold(text: &str, found: &Diagnosis) -> Result<(), String> {
    let text = text.replace("need not add to 100 %", "");
    let wrong = |what: &str| Err(format!("{what}\n{text}\n{found:#?}"));
    let over = found.runs.iter().any(|run| run.before > run.replicate_high);
    let left = found.runs.iter().any(|run| run.after > run.replicate_high);
    let sure = |f: &&Finding| f.strength.is_empty() || f.strength.values().any(|a| a.low > 0.0 || a.high < 0.0);
    let scored = !matches!(found.verdict, Verdict::None | Verdict::Unknown);
    let shown = found.effects.iter().filter(|f| scored && found.shown.contains(&f.name)).filter(sure);
    let named: Vec<&Finding> = shown.collect();
    let says = |words: &str| text.contains(words);
    if (says("There is a gap") || says("A gap that") || says("where the gap lies") || says("Where the gap lies"))
        && !over
    {
        return wrong("a gap where no run is over its limit");
    }
    if says("There is no gap") && (over || found.verdict != Verdict::None) {
        return wrong("no gap, but a run is over its limit or the verdict is another");
    }
    if (says("explains the gap") || says("explain the gap"))
        && !(over && !left && found.gap_closed > Some(0.0) && scored)
    {
        return wrong("explained, but a run is left over its limit, nothing is closed or nothing is named");
    }
    if (says("explains the gap") || says("explain the gap")) && named.is_empty() {
        return wrong("explained by nothing that is sure to be there");
    }
    if says("closes ") && says(" of the gap on") && !(over && found.gap_closed > Some(0.0)) {
        return wrong("closes where nothing could close");
    }
    if says("leaves ") && !left {
        return wrong("leaves something, but no run is over its limit");
    }
    let unseen = found.predictive_check.iter().flat_map(|check| &check.runs).any(|run| run.leave_as_much == 0);
    if says("not certain") != (unseen && !named.is_empty()) {
        return wrong("certain where no draw leaves as much, or uncertain where each run has one that does");
    }
    for finding in &named {
        if !says(&finding.name) && !says(&finding.name.replace('_', " ")) && !says(&capital(&finding.name)) {
            return wrong("does not name what the verdict names");
        }
        for amount in finding.strength.values().filter(|a| a.at_bound.is_some()) {
            let expected = if amount.at_bound == Some(Bound::Upper) { "upper bound" } else { "lower bound" };
            if !says(expected) {
                return wrong("a strength at its bound without a word");
            }
        }
    }
    for finding in found.effects.iter().filter(|f| f.untested_probability > 0.0) {
        if !says(&finding.name) && !says(&capital(&finding.name)) {
            return wrong("does not name what could not be simulated");
        }
        if !says("could not be simulated") {
            return wrong("does not say that something could not be simulated");
        }
    }
    let other = [" m;", " m,", " m\n", "metre"];
    if found.axis == Axis::Time && other.iter().any(|unit| says(unit)) {
        return wrong("seconds are called metres");
    }
    if says("100 %") && ![found.gap_closed, found.gap_closed_black_box].iter().flatten().any(|x| *x > 0.99) {
        let shares = found
            .effects
            .iter()
            .flat_map(|f| [Some(f.probability), Some(f.untested_probability), f.gap_closed, f.gap_closed_placebo]);
        let others = [Some(found.unknown_probability), Some(found.none_probability)];
        let channels = found.gap_closed_channels.values().map(|x| Some(*x));
        // What rounds to it is not said to be it.
        if !shares.chain(others).chain(channels).flatten().any(|x| x == 1.0 || x <= -0.995) {
            return wrong("100 % of something that is less");
        }
    }
    Ok(())
}

fn capital(name: &str) -> String {
    let text = name.replace('_', " ");
    text[..1].to_uppercase() + &text[1..]
}
