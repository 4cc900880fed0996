//! Where something strikes a rail: the places at which a step is looked for.

use super::FittedRun;
use crate::base::number::fraction;
use crate::base::trig;
use crate::effects::rail_step;
use crate::effects::sites::Site;
use crate::gap::settings::Impacts;
use crate::gap::simulator::Frame;
use crate::identify::accumulator::Block;
use crate::identify::feature_spec::Samples;
use crate::identify::fit::Landing;
use crate::identify::model::samples;
use crate::identify::noise::Noise;
use crate::signal::FORCES;
use std::collections::BTreeMap;

/// The channels that each rail's wheels strike.
pub const RAILS: [&[usize]; 3] = [&[0, 1], &[2], &[3]];

/// How many parts of a length a lap has.
pub fn parts(lap: f64, length: f64) -> usize {
    (lap / length).ceil().max(1.0) as usize
}

/// The part of the lap that a place lies in, and how far from its beginning, as a share.
pub fn part_of(station: f64, lap: f64, parts: usize) -> (usize, f64) {
    let along = fraction(station / lap) * parts as f64;
    let part = (along as usize).min(parts - 1);
    (part, along - part as f64)
}

/// How much more high-frequency power than simulated parts of the lap have: of each, the logarithm of the squared
/// changes from sample to sample over those simulated; NaN where nothing was measured.
#[derive(Clone, Debug)]
pub struct HighFrequencyPower {
    parts: Vec<f64>,
    /// The same of finer parts, a whole number in each part.
    fine: Vec<f64>,
}

impl HighFrequencyPower {
    /// Of each channel. `measured` begins with its trigger at `trigger`, m, and has noise of its sensors. Where the
    /// simulation is quieter than a share of what it is on average, that share is what changes are compared with: next
    /// to nothing is a multiple of nothing.
    pub fn each(
        landing: &Landing,
        lap: f64,
        (measured, trigger): (&Samples, f64),
        noise: [Noise; FORCES],
        settings: &Impacts,
    ) -> Vec<HighFrequencyPower> {
        let share = parts(settings.part, settings.fine);
        let fine = parts(lap, settings.part) * share;
        let add = |sums: &mut [(f64, f64)], samples: &Samples, force: usize, offset: f64| {
            for (two, station) in samples.forces[force].windows(2).zip(samples.station.iter().skip(1)) {
                let change = f64::from(two[1]) - f64::from(two[0]);
                let part = part_of(f64::from(*station) + offset, lap, fine).0;
                if change.is_finite() {
                    sums[part] = sum(sums[part], &(1.0, change * change));
                }
            }
        };
        let of = |force: usize| {
            let (mut real, mut simulated) = (vec![(0.0, 0.0); fine], vec![(0.0, 0.0); fine]);
            add(&mut real, measured, force, trigger);
            landing.centre.ensemble.carts.iter().for_each(|cart| add(&mut simulated, &samples(cart), force, 0.0));
            let white = 2.0 * noise[force].white * noise[force].white;
            let (changes, power) = simulated.iter().fold((0.0, 0.0), sum);
            let least = settings.quiet * power / changes;
            let louder =
                |((n, x), (m, y)): (&(f64, f64), &(f64, f64))| trig::ln((x / n) / ((y / m).max(least) + white));
            let together = |sums: &[(f64, f64)]| -> Vec<(f64, f64)> {
                sums.chunks(share).map(|chunk| chunk.iter().fold((0.0, 0.0), sum)).collect()
            };
            HighFrequencyPower {
                parts: together(&real).iter().zip(&together(&simulated)).map(louder).collect(),
                fine: real.iter().zip(&simulated).map(louder).collect(),
            }
        };
        (0..FORCES).map(of).collect()
    }

    /// The mean over the runs that know a part, of the loudest of some forces. What does not change at all is no louder
    /// than simulated.
    fn of_runs(runs: &[FittedRun], forces: &[usize]) -> HighFrequencyPower {
        let in_all = |of: fn(&HighFrequencyPower) -> &Vec<f64>| -> Vec<f64> {
            let mean = |part: usize, force: usize| {
                let known = runs.iter().map(|run| of(&run.high_frequency_power[force])[part]).filter(|x| !x.is_nan());
                let known: Vec<f64> = known.map(|x| if x.is_finite() { x } else { 0.0 }).collect();
                known.iter().sum::<f64>() / known.len().max(1) as f64
            };
            let loudest = |part: usize| forces.iter().map(|force| mean(part, *force)).fold(f64::MIN, f64::max);
            let parts = runs.first().and_then(|run| run.high_frequency_power.first()).map_or(0, |own| of(own).len());
            (0..parts).map(loudest).collect()
        };
        HighFrequencyPower { parts: in_all(|own| &own.parts), fine: in_all(|own| &own.fine) }
    }
}

fn sum(a: (f64, f64), b: &(f64, f64)) -> (f64, f64) {
    (a.0 + b.0, a.1 + b.1)
}

/// Where a step of a rail may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suspect {
    /// Counted from 0, as in [`RAILS`], or [`rail_step::BOTH`].
    pub rail: usize,
    /// Along the lap, m.
    pub at: f64,
    /// Whether an impact is seen there; else a cell begins there that is off.
    pub struck: bool,
}

impl Suspect {
    pub fn site(&self) -> Site {
        rail_step::site(self.at, self.rail, rail_step::RISE, rail_step::BACK)
    }
}

/// Where steps of the rails may be: where each rail is struck hardest, which is seen beside whatever else is wrong with
/// its channels, and in the cells in which these are worst; and of both running rails, where both are suspect.
pub fn suspects(frames: &[Frame], runs: &[FittedRun]) -> Vec<Suspect> {
    let Some(first) = runs.first() else { return Vec::new() };
    let (places, settings) = (&first.model.spec.places, &first.settings.impacts);
    let cell = places.lap / places.cells as f64;
    let mut all = Vec::new();
    for (rail, forces) in RAILS.into_iter().enumerate() {
        let power = HighFrequencyPower::of_runs(runs, forces);
        let struck = |from: f64, length: f64| struck(&power, settings, places.lap, from, length);
        let hardest = struck(0.0, places.lap).map(|at| Suspect { rail, at, struck: true });
        let mut found: Vec<Suspect> = hardest.into_iter().collect();
        let most = found.len() + settings.cells;
        for from in worst(frames, runs, forces) {
            let impact = struck(from, cell);
            let at = impact.unwrap_or(from);
            if found.len() < most && found.iter().all(|other| (at - other.at).abs() > 0.25 * cell) {
                found.push(Suspect { rail, at, struck: impact.is_some() });
            }
        }
        all.extend(found);
    }
    let both = both(&all, 0.5 * cell);
    all.into_iter().chain(both).collect()
}

/// Where both running rails are suspect, no farther apart than so, m: an element that is higher than the next one is so
/// for both.
fn both(all: &[Suspect], apart: f64) -> Vec<Suspect> {
    let of = |rail: usize| all.iter().filter(move |s| s.rail == rail);
    let mut found: Vec<Suspect> = Vec::new();
    for (left, right) in of(1).flat_map(|left| of(2).map(move |right| (left, right))) {
        if (left.at - right.at).abs() <= apart {
            let surer = if right.struck && !left.struck { right } else { left };
            let suspect = Suspect { rail: rail_step::BOTH, ..*surer };
            if !found.contains(&suspect) {
                found.push(suspect);
            }
        }
    }
    found
}

/// Where cells begin, those in which channels are worst first, m.
fn worst(frames: &[Frame], runs: &[FittedRun], forces: &[usize]) -> Vec<f64> {
    let mut cells: BTreeMap<i64, f64> = BTreeMap::new();
    for (frame, run) in frames.iter().zip(runs) {
        let residual = frame.residual(&frame.nominal);
        for (k, block) in run.landing.blocks.iter().enumerate().filter(|(k, _)| residual[*k].is_finite()) {
            if let Block::Mean(force) | Block::Local(force) = block
                && forces.contains(force)
            {
                let own = cells.entry(frame.labels[k].from).or_default();
                *own += residual[k] * residual[k] / frame.laps.variance[k];
            }
        }
    }
    let mut cells: Vec<(i64, f64)> = cells.into_iter().collect();
    cells.sort_by(|a, b| b.1.total_cmp(&a.1));
    cells.into_iter().map(|(at, _)| at as f64 / 1e3).collect()
}

/// Where an impact begins that is strongest in a cell of the lap, m; none where nothing strikes.
fn struck(power: &HighFrequencyPower, settings: &Impacts, lap: f64, from: f64, cell: f64) -> Option<f64> {
    let HighFrequencyPower { parts, fine } = power;
    let centre = |part: usize| (part as f64 + 0.5) * lap / parts.len() as f64;
    let part = begins(parts, settings, |part| (from..from + cell).contains(&centre(part)))?;
    let share = fine.len() / parts.len();
    Some(onset(fine, settings, part * share, share) as f64 * lap / fine.len() as f64)
}

/// The fine part in which an impact begins that does so in a part, or half a part before it: the first of them that
/// is loud, as an impact's force is quiet again wherever it turns. `from` is the part's first fine part, of `share`.
fn onset(fine: &[f64], settings: &Impacts, from: usize, share: usize) -> usize {
    let near = || (0..share + share / 2).map(|k| (fine.len() + from + k - share / 2) % fine.len());
    let loudest = near().map(|part| fine[part]).fold(f64::MIN, f64::max);
    let loud = trig::ln(settings.power).max(loudest - trig::ln(settings.rings));
    near().find(|part| fine[*part] > loud).unwrap_or(from + share / 2)
}

/// The part of the lap in which the strongest impact inside begins, by the logarithm of how high-frequency power each is.
fn begins(high_power: &[f64], settings: &Impacts, inside: impl Fn(usize) -> bool) -> Option<usize> {
    let parts = high_power.len();
    let peak = (0..parts).filter(|part| inside(*part)).max_by(|a, b| high_power[*a].total_cmp(&high_power[*b]))?;
    let strikes =
        |part: &usize| high_power[*part] > trig::ln(settings.power).max(high_power[peak] - trig::ln(settings.rings));
    (0..parts / 2).map(|k| (peak + parts - k) % parts).take_while(strikes).last()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_running_rails_are_suspect_where_each_of_them_is() {
        let suspect = |rail, at, struck| Suspect { rail, at, struck };
        let each = [
            suspect(0, 7.0, true),
            suspect(1, 30.0, false),
            suspect(1, 8.0, true),
            suspect(2, 30.2, true),
            suspect(2, 12.0, true),
        ];
        assert_eq!(both(&each, 0.5), [suspect(rail_step::BOTH, 30.2, true)]);
    }

    #[test]
    fn an_impact_begins_where_it_is_first_loud() {
        let settings = Impacts::default();
        let mut fine = vec![0.2; 200];
        fine[96..104].copy_from_slice(&[0.9, 0.4, 6.0, 1.0, 8.0, 0.5, 7.0, 2.0]);
        assert_eq!(onset(&fine, &settings, 100, 10), 98, "a little before its part, though quiet in between");
        fine[98] = 4.0;
        assert_eq!(onset(&fine, &settings, 100, 10), 100, "what is a thirtieth as loud is not it");
        // The lap is a circle.
        fine[197..].fill(9.0);
        assert_eq!(onset(&fine, &settings, 0, 10), 197);
        assert_eq!(onset(&[0.2; 200], &settings, 100, 10), 105, "nothing loud: the middle of the part");
    }

    #[test]
    fn an_impact_begins_before_it_is_strongest_and_rings_after() {
        let settings = Impacts::default();
        let mut high_power = vec![0.3; 100];
        // A wheel that is thrown up lands later, and harder.
        high_power[98..].fill(3.0);
        high_power[..5].copy_from_slice(&[3.5, 5.0, 3.0, 2.0, 1.0]);
        // A weaker one, far off, that the first drowns.
        high_power[50] = 1.5;
        assert_eq!(begins(&high_power, &settings, |part| part < 10), Some(98));
        assert_eq!(begins(&high_power, &settings, |part| (45..55).contains(&part)), Some(50));
        assert_eq!(begins(&high_power, &settings, |part| (20..40).contains(&part)), None);
        high_power[97] = 1.2;
        assert_eq!(
            begins(&high_power, &settings, |part| part < 10),
            Some(98),
            "what is a thirtieth as strong is another impact"
        );
    }
}
