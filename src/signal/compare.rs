//! Two runs side by side.
//!
//! Lateral motion of the chain is chaotic: after the first second or two, two simulations of the same lap agree in
//! their statistics only, and so do two measured laps. A difference at the same instant over a lap therefore measures
//! chaos as well as what is to be compared. [`Deviation`] says of each measure what two replicate runs of the same lap
//! differ by.

use super::filter::moving_mean;
use super::gaps::{Bridged, bridge};
use super::measures::{Statistics, rmsd, statistics};
use super::order::resample;
use super::position::{Position, position_from};
use super::rainflow::{damage_equivalent, rainflow};
use super::spectrum::{log_distance, welch};
use super::{Channel, Run};
use std::collections::BTreeMap;

/// Longest segment of the spectra, s: lines 0.1 Hz apart keep the passing of carts and the ring mode of the chain
/// asunder.
const SEGMENT: f64 = 10.0;

/// What the runs themselves do not tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Length of a lap, m. Without it, runs cannot be aligned.
    pub lap: Option<f64>,
    /// Distance between joints, m. Without it, there is no mean over two carts.
    pub pitch: Option<f64>,
    /// m, the slope of the S-N curve.
    pub exponent: f64,
}

/// How a channel of the other run differs from the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    pub reference: Statistics,
    pub other: Statistics,
    /// Root mean square of the difference at the same place of the track, lap by lap from each run's first sample, over
    /// the reference's range (max − min). Two replicate simulations of the same lap: 0.005 to 0.03.
    pub nrmsd: Option<f64>,
    /// The same of the moving means over two carts' passage, over the range of the reference before the mean was taken.
    /// What repeats with the carts cancels, and most of the chaos with it; curves, motors and ramps stay. Two replicate
    /// simulations: 0.000 to 0.003.
    pub nrmsd_two_carts: Option<f64>,
    /// Log-spectral distance, dB, of the power spectral densities up to the lower of the two low-passes. Chance alone
    /// leaves about 4.3 dB · √(2/n) for n segments that overlap by half: 1.5 dB for a lap of 100 s. Twice every force
    /// is 6 dB.
    pub spectral_distance: Option<f64>,
    /// Damage-equivalent load of the other over that of the reference, for the same distance travelled. Large cycles
    /// are few, so it scatters as the extremes do.
    pub damage_ratio: Option<f64>,
    /// Lost samples that were bridged before anything else, in the reference and in the other.
    pub filled: [usize; 2],
    /// Samples in longer gaps, which are left out.
    pub masked: [usize; 2],
}

/// Compares every channel that both runs have, but the trigger.
pub fn compare(reference: &Run, other: &Run, scale: &Scale) -> BTreeMap<Channel, Deviation> {
    compare_from(reference, reference.sidecar.trigger_position, other, scale)
}

/// The same with the reference's photocell at another place than its sidecar has it, m.
pub fn compare_from(
    reference: &Run,
    trigger_position: f64,
    other: &Run,
    scale: &Scale,
) -> BTreeMap<Channel, Deviation> {
    let sides =
        [Side::new(reference, trigger_position, scale), Side::new(other, other.sidecar.trigger_position, scale)];
    let grid = Grid::new(&sides, scale);
    let shared = reference.channels.keys().filter(|c| **c != Channel::Trigger && other.channels.contains_key(c));
    shared.filter_map(|&channel| Some((channel, deviation(channel, &sides, grid, scale)?))).collect()
}

/// One of the two runs.
struct Side<'a> {
    run: &'a Run,
    place: Option<Position>,
    /// m
    travelled: f64,
}

impl<'a> Side<'a> {
    fn new(run: &'a Run, trigger_position: f64, scale: &Scale) -> Self {
        let place = scale.lap.and_then(|lap| position_from(run, lap, trigger_position));
        let speed = place.as_ref().map_or(run.sidecar.speed_setpoint, |p| p.speed);
        Side { run, place, travelled: speed * run.duration() }
    }

    fn channel(&self, channel: Channel) -> Bridged {
        bridge(&self.run.time, self.run.channels.get(&channel).map_or(&[], Vec::as_slice))
    }
}

/// Places of the track at which runs are compared.
#[derive(Clone, Copy)]
struct Grid {
    places: usize,
    step: f64,
}

impl Grid {
    /// As fine as the finer of the two runs' samples. `None` when a run cannot be placed on a lap.
    fn new(sides: &[Side; 2], scale: &Scale) -> Option<Grid> {
        const MOST: f64 = 1e6;
        let lap = scale.lap?;
        let mut places: f64 = 1.0;
        for side in sides {
            side.place.as_ref()?;
            places = places.max((lap * side.run.time.len() as f64 / side.travelled).ceil());
        }
        let places = places.min(MOST);
        // A lap shorter than two samples is no lap.
        (places >= 2.0).then_some(Grid { places: places as usize, step: lap / places })
    }

    /// A channel at the places of the grid, lap after lap; a lap begins where the run does, and what it lacks is NaN.
    /// With a pitch, the moving mean over two carts.
    fn laps(&self, side: &Side, samples: &[f64], pitch: Option<f64>) -> Vec<f64> {
        let Some(place) = &side.place else { return Vec::new() };
        let mut on_grid = resample(&place.s, samples, self.step);
        if let Some(pitch) = pitch {
            on_grid.samples = moving_mean(&on_grid.samples, 2.0 * pitch / self.step);
        }
        let mut laps = vec![f64::NAN; on_grid.samples.len().div_ceil(self.places) * self.places];
        let first = on_grid.first.rem_euclid(self.places as i64) as usize;
        for (i, x) in on_grid.samples.into_iter().enumerate() {
            laps[i / self.places * self.places + (first + i) % self.places] = x;
        }
        laps
    }
}

fn deviation(channel: Channel, sides: &[Side; 2], grid: Option<Grid>, scale: &Scale) -> Option<Deviation> {
    let bridged = sides.each_ref().map(|side| side.channel(channel));
    let [a, b] = bridged.each_ref().map(|b| b.samples.as_slice());
    let (reference, other) = (statistics(a)?, statistics(b)?);
    let range = reference.max - reference.min;
    let apart = |pitch| {
        let grid = grid.filter(|_| range > 0.0)?;
        rmsd(&grid.laps(&sides[0], a, pitch), &grid.laps(&sides[1], b, pitch)).map(|d| d / range)
    };
    Some(Deviation {
        reference,
        other,
        nrmsd: apart(None),
        nrmsd_two_carts: scale.pitch.and_then(|pitch| apart(Some(pitch))),
        spectral_distance: spectral_distance(sides, [a, b]),
        damage_ratio: damage_ratio(sides, [a, b], scale.exponent),
        filled: bridged.each_ref().map(|b| b.filled),
        masked: bridged.each_ref().map(|b| b.masked.iter().filter(|m| **m).count()),
    })
}

fn spectral_distance(sides: &[Side; 2], samples: [&[f64]; 2]) -> Option<f64> {
    let shorter = sides[0].run.duration().min(sides[1].run.duration());
    let segment = SEGMENT.min(shorter / 4.0);
    let density = |side: &Side, x: &[f64]| welch(x, side.run.rate(), (segment * side.run.rate()).round() as usize);
    let (p, q) = (density(&sides[0], samples[0]), density(&sides[1], samples[1]));
    let lowpass = sides[0].run.sidecar.lowpass.min(sides[1].run.sidecar.lowpass);
    // The first line holds what is left of the mean.
    let found = log_distance(&p, &q, 1.5 * p.step, lowpass)?;
    // Fourier transforms may differ between processors in their last bits.
    Some((found * 1e6).round() / 1e6)
}

fn damage_ratio(sides: &[Side; 2], samples: [&[f64]; 2], exponent: f64) -> Option<f64> {
    let load = |side: &Side, x: &[f64]| damage_equivalent(&rainflow(x), exponent, side.travelled);
    let (p, q) = (load(&sides[0], samples[0])?, load(&sides[1], samples[1])?);
    (p > 0.0).then(|| q / p)
}

#[cfg(test)]
mod tests {
    use super::super::Sidecar;
    use super::*;
    use crate::base::trig::{TAU, log10, sin};

    const LAP: f64 = 50.0;
    const PITCH: f64 = 1.25;
    const SCALE: Scale = Scale { lap: Some(LAP), pitch: Some(PITCH), exponent: 3.0 };

    /// `laps` at `speed` from `start`, with forces that depend on the place alone: one bump a lap, and the passing of
    /// carts with a phase of its own.
    fn run(speed: f64, start: f64, laps: f64, phase: f64, gain: f64) -> Run {
        let count = (laps * LAP / speed * 500.0).round() as usize;
        let time: Vec<f64> = (0..count).map(|i| i as f64 / 500.0).collect();
        let place = |t: &f64| start + speed * t;
        let bump = |s: f64| if (20.0..30.0).contains(&s.rem_euclid(LAP)) { 100.0 } else { 0.0 };
        let force = |t: &f64| gain * (bump(place(t)) + 5.0 * sin(TAU * place(t) / PITCH + phase));
        let trigger = |t: &f64| f64::from(u8::from((place(t) - 10.0).rem_euclid(LAP) < 0.1));
        let channels = [
            (Channel::JointXi, time.iter().map(force).collect()),
            (Channel::Trigger, time.iter().map(trigger).collect()),
        ];
        let sidecar =
            Sidecar { speed_setpoint: speed, trigger_position: 10.0, lowpass: 100.0, laps: 1, ..Sidecar::default() };
        Run { time, channels: channels.into(), sidecar }
    }

    fn joint(a: &Run, b: &Run) -> Deviation {
        let found = compare(a, b, &SCALE);
        assert_eq!(found.len(), 1, "the trigger is not compared");
        found[&Channel::JointXi].clone()
    }

    #[test]
    fn a_run_is_no_different_from_itself() {
        let a = run(2.0, 0.0, 2.0, 0.0, 1.0);
        let found = joint(&a, &a);
        assert_eq!(found.reference, found.other);
        let measures = [found.nrmsd, found.nrmsd_two_carts, found.spectral_distance];
        assert_eq!(measures, [Some(0.0); 3]);
        assert_eq!(found.damage_ratio, Some(1.0));
    }

    #[test]
    fn places_are_compared_wherever_and_however_fast_a_run_went() {
        let a = run(2.0, 0.0, 1.0, 0.0, 1.0);
        for b in [run(2.0, 37.0, 1.0, 0.0, 1.0), run(1.7, 3.0, 1.2, 0.0, 1.0)] {
            // The photocell is off by half a sample at most, which shifts the passing of carts a little.
            let found = joint(&a, &b);
            assert!(found.nrmsd.expect("placed") < 0.02, "{:?}", found.nrmsd);
        }
        let off = run(2.0, 0.0, 1.0, 0.0, 1.1);
        let found = joint(&a, &off);
        assert!((found.damage_ratio.expect("cycles") - 1.1).abs() < 1e-9);
        assert!((found.spectral_distance.expect("lines") - 20.0 * log10(1.1)).abs() < 1e-5);
    }

    #[test]
    fn what_repeats_with_the_carts_cancels_in_the_mean_over_two() {
        let (a, b) = (run(2.0, 0.0, 1.0, 0.0, 1.0), run(2.0, 0.0, 1.0, TAU / 2.0, 1.0));
        let found = joint(&a, &b);
        // The difference is a sine of 10 N on a range of 110 N.
        assert!((found.nrmsd.expect("placed") - 10.0 / 2.0_f64.sqrt() / 110.0).abs() < 1e-3, "{:?}", found.nrmsd);
        assert!(found.nrmsd_two_carts.expect("placed") < 1e-4, "{:?}", found.nrmsd_two_carts);
    }

    #[test]
    fn what_cannot_be_told_is_not() {
        let a = run(2.0, 0.0, 1.0, 0.0, 1.0);
        let mut b = a.clone();
        b.channels.remove(&Channel::Trigger);
        let found = joint(&a, &b);
        assert_eq!((found.nrmsd, found.nrmsd_two_carts), (None, None));
        assert!(found.spectral_distance.is_some() && found.damage_ratio.is_some());
        b.channels.entry(Channel::JointXi).and_modify(|x| x.fill(3.0));
        let found = joint(&b, &a);
        assert_eq!((found.nrmsd, found.damage_ratio, found.spectral_distance), (None, None, None));
        b.channels.entry(Channel::JointXi).and_modify(|x| x.fill(f64::NAN));
        assert!(compare(&a, &b, &SCALE).is_empty());
        let mut c = a.clone();
        c.channels.entry(Channel::JointXi).and_modify(|x| {
            x[100..105].fill(f64::NAN);
            x[300..400].fill(f64::NAN);
        });
        let found = joint(&a, &c);
        assert_eq!((found.filled, found.masked), ([0, 5], [0, 100]));
    }
}
