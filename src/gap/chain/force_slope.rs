//! Which way an impact goes: a rail's step up presses a wheel first and throws it off then, a step down lets it fall
//! first and land then. Means over a cell and powers are nearly the same of both.
//!
//! A straight line is fitted to a force along the track where something strikes; by how much it rises, from the middle
//! to the end, is the impact's *force slope*. No model has an impact exactly as large as it is, but any has it that way
//! round, so the feature is asinh of the force slope over a scale, which is in proportion to small ones and hardly
//! grows with large ones (Burbidge, Magee and Robb 1988). It is no part of mean squares, which are blind to a few of a
//! thousand features: it speaks against what strikes the other way round.

use super::FittedRun;
use super::impacts::{self, RAILS, Suspect};
use crate::base::trig;
use crate::gap::settings;
use crate::gap::simulator::{Band, Frame, Label};
use crate::identify::feature_spec::Samples;
use crate::identify::model::samples;
use crate::signal::{Channel, FORCES};

/// An impact in one channel of a run.
#[derive(Clone, Debug)]
pub struct Impact {
    force: usize,
    /// Part of the lap in which the line begins.
    part: usize,
    /// ForceSlope of the nominal chain, N, and the scale, N.
    nominal: f64,
    scale: f64,
    /// ForceSlope that was measured, N; NaN where too little was.
    measured: f64,
}

/// Sums over samples of a force in a part of the lap: how many, u and u² where u is how far each is from the part's
/// middle in parts, the force and u times the force.
#[derive(Clone, Copy, Default)]
pub struct SlopeSums {
    count: f64,
    u: f64,
    square: f64,
    force: f64,
    moment: f64,
}

impl SlopeSums {
    /// A force, N, if it was measured, at a share of the part.
    fn sample(&mut self, share: f64, force: f32) {
        if force.is_finite() {
            let (u, x) = (share - 0.5, f64::from(force));
            self.add(&SlopeSums { count: 1.0, u, square: u * u, force: x, moment: u * x });
        }
    }

    fn add(&mut self, more: &SlopeSums) {
        self.count += more.count;
        self.u += more.u;
        self.square += more.square;
        self.force += more.force;
        self.moment += more.moment;
    }
}

/// Parts of a whole lap.
pub type Profile = Vec<SlopeSums>;

/// Sums of each force that was measured in the parts of a lap, m, its trigger at `trigger`, m.
pub fn profiles(measured: &Samples, (lap, parts): (f64, usize), trigger: f64) -> Vec<Profile> {
    let of = |force| {
        let mut profile = empty(parts);
        add(&mut profile, measured, force, lap, trigger);
        profile
    };
    (0..FORCES).map(of).collect()
}

fn empty(parts: usize) -> Profile {
    vec![SlopeSums::default(); parts]
}

fn add(profile: &mut Profile, samples: &Samples, force: usize, lap: f64, offset: f64) {
    let parts = profile.len();
    for (x, station) in samples.forces[force].iter().zip(samples.station) {
        let (part, share) = impacts::part_of(f64::from(*station) + offset, lap, parts);
        profile[part].sample(share, *x);
    }
}

/// A straight line through a force along the track.
struct Line {
    /// By how much it rises from its middle to its end, N.
    force_slope: f64,
    /// Its mean, N.
    mean: f64,
    /// Of how many samples.
    count: f64,
}

impl Line {
    /// By least squares over parts from one on; `None` where a part has no samples.
    fn new(profile: &Profile, from: usize, parts: usize) -> Option<Line> {
        let mut all = SlopeSums::default();
        for k in 0..parts {
            let own = profile[(from + k) % profile.len()];
            if own.count == 0.0 {
                return None;
            }
            let centre = k as f64 + 0.5 * (1.0 - parts as f64);
            all.add(&SlopeSums {
                u: centre * own.count + own.u,
                square: centre * centre * own.count + 2.0 * centre * own.u + own.square,
                moment: centre * own.force + own.moment,
                ..own
            });
        }
        let SlopeSums { count, u, square, force, moment } = all;
        let slope = (moment - u * force / count) / (square - u * u / count);
        Some(Line { force_slope: 0.5 * parts as f64 * slope, mean: force / count, count })
    }
}

impl Impact {
    /// Blows at suspects' places as a fitted run has them.
    pub fn all(suspects: &[Suspect], run: &FittedRun) -> Vec<Impact> {
        // Both running rails are suspect where each of them is.
        let struck = suspects.iter().filter(|s| s.struck && s.rail < RAILS.len());
        let places = struck.flat_map(|s| RAILS[s.rail].iter().map(move |f| (s.at, *f)));
        places.map(|(at, force)| Impact::new(run, at, force)).collect()
    }

    fn new(run: &FittedRun, at: f64, force: usize) -> Impact {
        let lap = run.model.spec.places.lap;
        let (parts, settings) = (run.parts(), &run.settings.force_slopes);
        let part = (impacts::part_of(at, lap, parts).0 + parts - 1) % parts;
        let mut all = empty(parts);
        let mut force_slopes = Vec::new();
        for cart in &run.landing.centre.ensemble.carts {
            let mut own = empty(parts);
            add(&mut own, &samples(cart), force, lap, 0.0);
            force_slopes.extend(Line::new(&own, part, settings.parts).map(|line| line.force_slope));
            all.iter_mut().zip(&own).for_each(|(all, own)| all.add(own));
        }
        let nominal =
            Line::new(&all, part, settings.parts).unwrap_or(Line { force_slope: f64::NAN, mean: f64::NAN, count: 0.0 });
        let squares = force_slopes.iter().map(|t| (t - nominal.force_slope) * (t - nominal.force_slope)).sum::<f64>();
        let carts = (squares / force_slopes.len().max(1) as f64).sqrt();
        let measured = Line::new(&run.profiles[force], part, settings.parts);
        // A line's rise to its end has three times the variance of its mean.
        let own = run.model.spec.noise()[force];
        let half = 0.5 * settings.parts as f64 * lap / parts as f64 / run.model.simulation.chain.speed_m_s;
        let of = |line: &Line| {
            let correlated: f64 = own.correlated().map(|o| o.variance * (1.0 - trig::exp(-half / o.time))).sum();
            trig::hypot(own.white * (3.0 / line.count).sqrt(), correlated.sqrt())
        };
        let noise = measured.as_ref().map_or(0.0, of);
        let else_known = settings.of_mean * nominal.mean.abs() + settings.of_nominal * nominal.force_slope.abs();
        Impact {
            force,
            part,
            nominal: nominal.force_slope,
            scale: settings.deviations * trig::hypot(carts, noise) + else_known,
            measured: measured.map_or(f64::NAN, |line| line.force_slope),
        }
    }

    /// In deviations; 0 where the force slope is that of the nominal chain.
    fn feature(&self, force_slope: f64, settings: &settings::ForceSlopes) -> f64 {
        trig::asinh((force_slope - self.nominal) / self.scale.max(1e-9)) / settings.deviation
    }
}

/// ForceSlopes of carts as their sensors have them.
pub struct ForceSlopes<'a> {
    impacts: &'a [Impact],
    settings: &'a settings::ForceSlopes,
    lap: f64,
    /// Of each part of the lap, the forces whose lines lie over it.
    lines: Vec<[bool; FORCES]>,
    sums: Vec<Profile>,
}

impl<'a> ForceSlopes<'a> {
    pub fn new(run: &'a FittedRun) -> ForceSlopes<'a> {
        let (lap, parts, settings) = (run.model.spec.places.lap, run.parts(), &run.settings.force_slopes);
        let mut lines = vec![[false; FORCES]; parts];
        for impact in &run.impacts {
            (0..settings.parts).for_each(|k| lines[(impact.part + k) % parts][impact.force] = true);
        }
        ForceSlopes { impacts: &run.impacts, settings, lap, lines, sums: vec![empty(parts); FORCES] }
    }

    /// Adds a cart's samples, moved along the track by `offset`, m.
    pub fn add(&mut self, samples: &Samples, offset: f64) {
        for (k, station) in samples.station.iter().enumerate() {
            let (part, share) = impacts::part_of(f64::from(*station) + offset, self.lap, self.lines.len());
            let lines = self.lines[part];
            if lines == [false; FORCES] {
                continue;
            }
            for force in (0..FORCES).filter(|force| lines[*force]) {
                if let Some(x) = samples.forces[force].get(k) {
                    self.sums[force][part].sample(share, *x);
                }
            }
        }
    }

    /// A feature of each impact; NaN where nothing was seen.
    pub fn features(&self) -> impl Iterator<Item = f64> {
        let of = |impact: &Impact| {
            let line = Line::new(&self.sums[impact.force], impact.part, self.settings.parts);
            line.map_or(f64::NAN, |line| impact.feature(line.force_slope, self.settings))
        };
        self.impacts.iter().map(of)
    }
}

/// Adds impacts to a run as the diagnosis sees it, behind its other features.
pub fn extend(frame: &mut Frame, run: &FittedRun) {
    let (lap, count) = (run.model.spec.places.lap, run.impacts.len());
    let length = lap / run.parts() as f64;
    let mm = |x: f64| (1e3 * x.min(lap)).round() as i64;
    for (k, impact) in run.impacts.iter().enumerate() {
        let index = run.impacts[..k].iter().filter(|other| other.force == impact.force).count();
        let from = impact.part as f64 * length;
        let channel = Channel::FORCES[impact.force].name().to_owned();
        let (from, to) = (mm(from), mm(from + run.settings.force_slopes.parts as f64 * length));
        frame.labels.push(Label { channel, band: Band::Impact, index, from, to });
        frame.measured.push(impact.feature(impact.measured, &run.settings.force_slopes));
    }
    let padded = |list: &mut Vec<f64>, with: f64| list.extend(vec![with; count]);
    padded(&mut frame.nominal, 0.0);
    padded(&mut frame.laps.variance, 1.0);
    frame.discrepancies.iter_mut().chain(&mut frame.laps.scatter).for_each(|list| padded(list, 0.0));
    let rows = frame.slopes.nrows();
    frame.slopes.resize_vertically_mut(rows + count, 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run of 20 m at 2 m/s and 500 Hz on 100 N, with an impact at 5 m that first adds `up`, N, and takes it back
    /// then.
    fn impact(up: f32) -> (Vec<f32>, Vec<f32>) {
        let station: Vec<f32> = (0..5000_i16).map(|k| 0.004 * f32::from(k) + 0.001).collect();
        let force = |s: &f32| match s - 5.0 {
            past if (0.0..0.1).contains(&past) => 100.0 + up,
            past if (0.1..0.2).contains(&past) => 100.0 - up,
            _ => 100.0,
        };
        let forces = station.iter().map(force).collect();
        (station, forces)
    }

    fn force_slope(up: f32, offset: f64) -> f64 {
        let (station, force) = impact(up);
        let mut forces: [&[f32]; FORCES] = [&[]; FORCES];
        forces[2] = &force;
        let samples = Samples { station: &station, speed: &[], forces, coverage: None };
        let profile = &profiles(&samples, (20.0, 200), offset)[2];
        Line::new(profile, 49, 5).map_or(f64::NAN, |line| line.force_slope)
    }

    #[test]
    fn up_and_down_tilt_the_other_way_round() {
        // From the middle of 0.5 m to its end u is 1, and each part 0.4: with f = 40 and −40 N over u in turn, ∫ u f
        // du/∫ u² du = −40·0.4²/(2/3) = −9.6 N.
        assert!((force_slope(40.0, 0.0) + 9.6).abs() < 0.2, "{}", force_slope(40.0, 0.0));
        assert!((force_slope(-40.0, 0.0) - 9.6).abs() < 0.2, "{}", force_slope(-40.0, 0.0));
        assert!(force_slope(0.0, 0.0).abs() < 1e-9);
        // What comes and goes again force slopes as much wherever it is.
        for offset in [-0.08, 0.04, 0.15] {
            assert!((force_slope(40.0, offset) + 9.6).abs() < 0.2, "{}", force_slope(40.0, offset));
        }
    }

    #[test]
    fn a_part_that_nothing_was_heard_of_has_no_tilt() {
        let part = |force: f64| SlopeSums { count: 2.0, square: 0.08, force: 2.0 * force, ..SlopeSums::default() };
        let even = vec![part(3.0); 8];
        assert!(
            Line::new(&even, 0, 5)
                .is_some_and(|line| line.force_slope.abs() < 1e-12 && (line.mean - 3.0).abs() < 1e-12)
        );
        let rising: Vec<SlopeSums> = (0..8).map(|k| part(f64::from(k))).collect();
        assert!(Line::new(&rising, 2, 5).is_some_and(|line| line.force_slope > 2.4 && (line.mean - 4.0).abs() < 1e-12));
        let mut lost = even;
        lost[2] = SlopeSums::default();
        assert!(Line::new(&lost, 0, 5).is_none());
        assert!(Line::new(&lost, 7, 5).is_none(), "the lap is a circle");
        assert!(Line::new(&lost, 3, 5).is_some());
    }
}
