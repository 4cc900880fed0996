//! Makes a challenge.

use super::key::{Case, CaseKind, Facts, Key, StrengthLevel};
use super::reality::{Changes, Reality, distances, measured};
use super::sources::{MACHINE, SENSORS, UNKNOWN, machine, sensor, unknown};
use super::tracks::{self, Planned};
use super::{CHALLENGE, KEY, seal};
use crate::base::random::mix;
use crate::base::{parallel, trig};
use crate::benchmark::draw::{draw_log, pick, shuffle};
use crate::benchmark::source::Source;
use crate::chain_input::Simulation;
use crate::dynamics::Method;
use crate::signal::{Campaign, Channel, Run, csv};
use crate::source::disk::{Files, WriteError, replace};
use crate::source::{root, shown};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Of a hundred cases.
const MIX: [(CaseKind, usize); 5] =
    [(CaseKind::One, 40), (CaseKind::Pair, 15), (CaseKind::None, 15), (CaseKind::Unknown, 15), (CaseKind::Sensor, 15)];
/// Of ten effects.
const LEVELS: [StrengthLevel; 10] = [
    StrengthLevel::Weak,
    StrengthLevel::Weak,
    StrengthLevel::Medium,
    StrengthLevel::Medium,
    StrengthLevel::Medium,
    StrengthLevel::Medium,
    StrengthLevel::Strong,
    StrengthLevel::Strong,
    StrengthLevel::Strong,
    StrengthLevel::Strong,
];
/// Of eight cases, the numbers of their tracks: the long ones take long.
const TRACKS: [usize; 8] = [0, 0, 1, 1, 2, 2, 3, 4];
/// Trials of a strength, and of a case that cannot be simulated.
const TRIALS: usize = 4;
const ATTEMPTS: u64 = 5;
/// Runs of a campaign.
const RUNS: usize = 3;

/// What to make.
#[derive(Clone, Debug)]
pub struct Order {
    pub cases: usize,
    pub seed: u64,
    /// All cases of one kind, rather than the mix.
    pub only: Option<CaseKind>,
    /// All cases on this layout, rather than on those of the library.
    pub layout: Option<Simulation>,
    pub threads: usize,
}

/// What a case is to be.
#[derive(Clone, Debug, PartialEq)]
struct Wish {
    name: String,
    kind: CaseKind,
    /// Numbers of its sources, each with a level.
    sources: Vec<(usize, StrengthLevel)>,
    track: usize,
    seed: u64,
    method: Method,
}

/// Makes a challenge in a folder that has none. `watch` is told how many cases are done. Returns the facts.
///
/// # Errors
///
/// In words, when files cannot be written or a case cannot be simulated.
pub fn generate(order: &Order, folder: &Path, watch: &(dyn Fn(usize) + Sync)) -> Result<Facts, String> {
    let written = |path: &Path, bytes: &[u8]| replace(path, bytes).map_err(|error| said(path, &error.reason));
    root::given_output(folder).map_err(|why| format!("{}: {why}", shown(folder)))?;
    if let Some(effect) = order.layout.as_ref().and_then(|layout| layout.effects.first()) {
        return Err(format!(
            "the layout has an effect, `{}`: leave it out, as a challenge puts in effects of its own",
            effect.name
        ));
    }
    if folder.join(CHALLENGE).exists() {
        return Err(format!("{} has a challenge already", shown(folder)));
    }
    fs::create_dir_all(folder).map_err(|why| said(folder, &why))?;
    let tracks = match &order.layout {
        Some(given) => vec![Planned::given(given.clone())],
        None => tracks::all()?,
    };
    let wishes = wishes(order);
    let done = AtomicUsize::new(0);
    let made = parallel::map(&wishes, order.threads, |wish| {
        let track = &tracks[wish.track % tracks.len()];
        let case = (0..ATTEMPTS).find_map(|attempt| make(wish, track, attempt));
        let case = case.ok_or_else(|| format!("{} cannot be simulated", wish.name))?;
        let (case, runs) = case;
        write_case(&folder.join(&wish.name), track, &runs).map_err(|error| said(&error.path, &error.reason))?;
        watch(done.fetch_add(1, Ordering::Relaxed) + 1);
        Ok(case)
    });
    let cases: Vec<Case> = made.into_iter().collect::<Result<_, String>>()?;
    let key = Key { seed: order.seed, cases };
    let bytes = serde_json::to_vec_pretty(&key).map_err(|why| why.to_string())?;
    let sealed = seal::seal(&bytes, order.seed);
    let mix = MIX.map(|(kind, share)| format!("{share} % {}", kind.name())).join(", ");
    let facts = Facts {
        key_sha256: sealed.hash,
        cases: key.cases.iter().map(|c| c.name.clone()).collect(),
        mix: order.only.map_or(mix, |kind| format!("all {}", kind.name())),
    };
    written(&folder.join(KEY), &sealed.bytes)?;
    let mut text = serde_json::to_vec_pretty(&facts).map_err(|why| why.to_string())?;
    text.push(b'\n');
    // Last, so that a challenge with it is whole.
    written(&folder.join(CHALLENGE), &text)?;
    Ok(facts)
}

fn said(path: &Path, why: &io::Error) -> String {
    format!("{}: {why}", shown(path))
}

/// The cases: kinds, effects and levels in their shares, in an order by chance.
fn wishes(order: &Order) -> Vec<Wish> {
    let mut state = order.seed ^ 0x6c73_7362_6c69_6e64;
    let mut kinds = Vec::new();
    for (kind, share) in MIX {
        let count = match order.only {
            Some(only) => {
                if only == kind {
                    order.cases
                } else {
                    0
                }
            }
            None => (order.cases * share + 50) / 100,
        };
        kinds.extend(vec![kind; count]);
    }
    // Rounding leaves one over or under.
    kinds.resize(order.cases, CaseKind::One);
    shuffle(&mut kinds, &mut state);
    let mut effects = Deck::new(MACHINE);
    let mut sensors = Deck::new(SENSORS);
    let mut unknowns = Deck::new(UNKNOWN);
    let mut levels: BTreeMap<CaseKind, Deck> = BTreeMap::new();
    let mut places = Deck::new(TRACKS.len());
    let digits = order.cases.to_string().len().max(3);
    kinds
        .into_iter()
        .enumerate()
        .map(|(k, kind)| {
            let mut of = |deck: &mut Deck, state: &mut u64| {
                let level = levels.entry(kind).or_insert_with(|| Deck::new(LEVELS.len())).draw(state);
                (deck.draw(state), LEVELS[level])
            };
            let sources = match kind {
                CaseKind::None => Vec::new(),
                CaseKind::One => vec![of(&mut effects, &mut state)],
                CaseKind::Sensor => vec![of(&mut sensors, &mut state)],
                CaseKind::Unknown => vec![of(&mut unknowns, &mut state)],
                CaseKind::Pair => {
                    let first = of(&mut effects, &mut state);
                    let mut second = of(&mut effects, &mut state);
                    if second.0 == first.0 {
                        second.0 = (first.0 + 1 + pick(&mut state, MACHINE - 1)) % MACHINE;
                    }
                    vec![first, second]
                }
            };
            Wish {
                name: format!("case-{:0digits$}", k + 1),
                kind,
                sources,
                track: TRACKS[places.draw(&mut state)],
                seed: mix(&mut state),
                method: if k % 5 == 4 { Method::CashKarp } else { Method::Verlet },
            }
        })
        .collect()
}

/// Numbers in an order by chance, all of them before any comes again.
struct Deck {
    of: usize,
    left: Vec<usize>,
}

impl Deck {
    fn new(of: usize) -> Self {
        Deck { of, left: Vec::new() }
    }

    fn draw(&mut self, state: &mut u64) -> usize {
        if self.left.is_empty() {
            self.left = (0..self.of).collect();
            shuffle(&mut self.left, state);
        }
        self.left.pop().unwrap_or(0)
    }
}

/// A run as it goes into a campaign.
struct Recorded {
    name: String,
    run: Run,
    /// As it was set, N.
    tension: f64,
}

/// A case with its runs; `None` when something in it cannot be simulated.
fn make(wish: &Wish, track: &Planned, attempt: u64) -> Option<(Case, Vec<Recorded>)> {
    let mut state = wish.seed.wrapping_add(attempt.wrapping_mul(0x9e37_79b9));
    let nominal = &track.simulation;
    let reality = Reality::new(nominal, wish.method, &mut state);
    let sources: Vec<(Source, StrengthLevel)> = wish
        .sources
        .iter()
        .map(|(which, level)| {
            let source = match wish.kind {
                CaseKind::Sensor => sensor(*which, &mut state),
                CaseKind::Unknown => unknown(*which, nominal, &mut state),
                _ => machine(*which, nominal, &mut state),
            };
            (source, *level)
        })
        .collect();
    // As they would be measured, so that what no sensor tells is not over the repeatability.
    let noise = mix(&mut { state });
    let sketch = |changes: Option<&Changes<'_>>, front: f64| {
        let run = reality.sketch(changes, front)?;
        let mut state = noise.wrapping_add((1e3 * front) as u64 + u64::from(changes.is_some()));
        Some(measured(run, reality.planned.first()?, track.file, &mut state))
    };
    let mut without: Option<(Run, BTreeMap<Channel, f64>)> = None;
    if !sources.is_empty() {
        let (one, other) = (sketch(None, 0.0)?, sketch(None, 0.63)?);
        let repeatability = distances(&one, &other, nominal);
        without = Some((one, repeatability));
    }
    let mut strengths = Vec::new();
    for (source, level) in &sources {
        let (without, repeatability) = without.as_ref()?;
        let over = |strength: f64| {
            let run = sketch(Some(&vec![(&source.change, strength)]), 0.0)?;
            Some(ratios(&distances(without, &run, nominal), repeatability).fold(0.0, f64::max))
        };
        strengths.push(calibrated(source.range, wanted(*level, &mut state), over)?);
    }
    let changes: Changes<'_> = sources.iter().zip(&strengths).map(|((s, _), (x, _))| (&s.change, *x)).collect();
    let mut runs = Vec::new();
    let mut first = None;
    for (k, planned) in reality.planned.iter().enumerate().take(RUNS) {
        let run = measured(reality.record(k, Some(&changes))?, planned, track.file, &mut state);
        if k == 0 {
            first = Some(run.clone());
        }
        runs.push(Recorded { name: format!("run-{:02}", k + 1), run, tension: planned.chain.tension_n });
    }
    let oracle = match (&without, wish.kind.nameable()) {
        (Some((without, repeatability)), true) => {
            oracle(&first?, without, &sketch(Some(&changes), 0.0)?, repeatability, track)
        }
        _ => None,
    };
    // Of a pair, the weaker one is what is hard to find.
    let weakest = strengths.iter().map(|s| s.1).reduce(f64::min);
    let case = Case {
        name: wish.name.clone(),
        kind: wish.kind,
        truth: sources.iter().zip(&strengths).map(|((source, _), (x, _))| source.truth(*x)).collect(),
        strength_over_floor: weakest.unwrap_or(0.0),
        level: weakest.map(StrengthLevel::of),
        oracle,
        about: format!("{}, {:?}", track.file, wish.method),
    };
    Some((case, runs))
}

/// Strength over the repeatability that a level asks for.
fn wanted(level: StrengthLevel, state: &mut u64) -> f64 {
    match level {
        StrengthLevel::Weak => draw_log(state, 1.5, 3.0),
        StrengthLevel::Medium => draw_log(state, 3.0, 10.0),
        StrengthLevel::Strong => draw_log(state, 10.0, 40.0),
    }
}

/// Distances over the repeatability's, channel by channel.
fn ratios<'a>(
    distances: &'a BTreeMap<Channel, f64>,
    repeatability: &'a BTreeMap<Channel, f64>,
) -> impl Iterator<Item = f64> + 'a {
    distances.iter().filter_map(|(c, x)| Some(x / repeatability.get(c).filter(|f| **f > 0.0)?))
}

/// The strength within `range` at which an effect is so far over the repeatability, and how far it really is there. An
/// effect that never gets so far has its largest, and one that cannot be simulated any more the last that could.
fn calibrated(range: (f64, f64), wanted: f64, over: impl Fn(f64) -> Option<f64>) -> Option<(f64, f64)> {
    // What is beside the repeatability: distances add by their squares.
    let beside = |ratio: f64| (ratio * ratio - 1.0).max(0.01).sqrt();
    let (mut low, mut high) = range;
    let mut strength = (low * high).sqrt();
    let mut best: Option<(f64, f64)> = None;
    for _ in 0..TRIALS {
        let Some(ratio) = over(strength) else {
            high = strength;
            strength = (low * 0.5 * strength).sqrt().max(low);
            continue;
        };
        let off = |r: f64| (trig::ln(r.max(1e-3)) - trig::ln(wanted)).abs();
        if best.is_none_or(|(_, r)| off(ratio) < off(r)) {
            best = Some((strength, ratio));
        }
        if off(ratio) < 0.12 || range.0 == range.1 {
            break;
        }
        if ratio < wanted {
            low = strength
        } else {
            high = strength
        }
        // In proportion, and no farther than the bounds found so far.
        let next = (strength * beside(wanted) / beside(ratio)).clamp(range.0, range.1);
        strength = if next <= low || next >= high { (low * high).sqrt() } else { next };
        if low >= range.1 * 0.999 {
            break;
        }
        // Hardly anything is seen: all that a built system may have.
        if ratio < 1.3 && wanted > 3.0 {
            strength = (high * strength).sqrt();
        }
    }
    best
}

/// Gap that the true effects close: distances in units of the repeatability, mean square over the channels.
fn oracle(
    measured: &Run,
    without: &Run,
    with: &Run,
    repeatability: &BTreeMap<Channel, f64>,
    track: &Planned,
) -> Option<f64> {
    let gap = |model: &Run| {
        let all: Vec<f64> =
            ratios(&distances(model, measured, &track.simulation), repeatability).map(|x| x * x).collect();
        all.iter().sum::<f64>() / all.len().max(1) as f64
    };
    let (before, after) = (gap(without), gap(with));
    (before > 2.0).then(|| 1.0 - (after - 1.0) / (before - 1.0))
}

fn write_case(folder: &Path, track: &Planned, runs: &[Recorded]) -> Result<(), WriteError> {
    let mut files = Files::default();
    files.push(track.file, track.text.as_slice());
    let mut list = format!("layout = \"{}\"\n", track.file);
    for Recorded { name, run, tension } in runs {
        files.push(format!("{name}.csv"), csv::write(run));
        files.push(format!("{name}.toml"), run.sidecar.write());
        let speed = run.sidecar.speed_setpoint;
        let _ = write!(list, "\n[[run]]\nfile = \"{name}.csv\"\nspeed = {speed:?}\ntension = {tension:?}\n");
    }
    files.push(Campaign::FILE, list);
    files.write(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(cases: usize) -> Order {
        Order { cases, seed: 4, only: None, layout: None, threads: 2 }
    }

    #[test]
    fn the_mix_is_kept_and_every_effect_comes() {
        let found = wishes(&order(120));
        let count = |kind: CaseKind| found.iter().filter(|w| w.kind == kind).count();
        assert_eq!(MIX.map(|(kind, _)| count(kind)), [48, 18, 18, 18, 18]);
        let machine: Vec<usize> = found
            .iter()
            .filter(|w| w.kind == CaseKind::One || w.kind == CaseKind::Pair)
            .flat_map(|w| w.sources.iter().map(|s| s.0))
            .collect();
        assert!((0..MACHINE).all(|k| machine.iter().filter(|m| **m == k).count() >= 4));
        let ones: Vec<StrengthLevel> =
            found.iter().filter(|w| w.kind == CaseKind::One).map(|w| w.sources[0].1).collect();
        assert!(ones.iter().filter(|l| **l == StrengthLevel::Weak).count().abs_diff(9) <= 1);
        assert!(found.iter().filter(|w| w.kind == CaseKind::Pair).all(|w| w.sources[0].0 != w.sources[1].0));
        assert_eq!(wishes(&order(120)), found);
        assert_ne!(wishes(&Order { seed: 5, ..order(120) }), found);
        let none = wishes(&Order { only: Some(CaseKind::None), ..order(60) });
        assert!(none.len() == 60 && none.iter().all(|w| w.kind == CaseKind::None));
    }

    #[test]
    fn strengths_are_found_where_they_can_be() {
        // Over the repeatability as √(1 + (x/2)²).
        let over = |x: f64| Some((1.0 + 0.25 * x * x).sqrt());
        let (x, ratio) = calibrated((0.01, 1e4), 5.0, over).unwrap();
        assert!((trig::ln(ratio / 5.0)).abs() < 0.12 && (x - 9.8).abs() < 1.5, "{x} {ratio}");
        // What never shows is told as it is.
        let (x, ratio) = calibrated((0.01, 0.5), 20.0, over).unwrap();
        assert!(x > 0.1 && ratio < 1.1, "{x} {ratio}");
        // Beyond 3, nothing can be simulated.
        let (x, _) = calibrated((0.01, 1e3), 30.0, |x| if x > 3.0 { None } else { over(x) }).unwrap();
        assert!(x <= 3.0);
    }
}
