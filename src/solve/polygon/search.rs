//! The global search in phases: improving hit-and-run (Zabinsky et al. 1993) over the polytope of straights, each line
//! of which is searched as a whole.
//!
//! With turns and radii held, polygon action depends on the phases between curves alone, a sum of cosines that costs
//! microseconds; so a line through the polytope is looked at as densely as its waves ask for, and its best place found,
//! however many minima lie before it.

use super::polytope::Polytope;
use super::price::Price;
use crate::base::random::Random;
use crate::problem::Waves;
use nalgebra::DVector;

/// Independent searches, each from a random place.
const SEARCHES: usize = 16;
/// Lines a search and degree of freedom without a gain end it; lines it may have at most.
const IDLE: usize = 4;
const MOST: usize = 60;
/// Looks per cart length along a line; at least and at most so many.
const DENSITY: f64 = 12.0;
const LOOKS: (usize, usize) = (9, 96);
/// Halvings of the best look's neighbourhood.
const HALVINGS: usize = 14;
/// A straight that changes less along a line, m/m, keeps its pieces.
const LEVEL: f64 = 1e-6;
/// Steps of the walk to a random start, a degree of freedom.
const WALK: usize = 4;

/// A place of the polytope with its merit, m.
pub struct Found {
    pub z: DVector<f64>,
    pub merit: f64,
}

/// What is minimised: waves, and the price of the pieces where it counts.
#[derive(Clone, Copy)]
pub struct Merit<'a> {
    pub waves: &'a Waves,
    pub price: Option<&'a Price>,
}

impl Merit<'_> {
    /// From the lengths of the straights, m.
    fn of(self, straights: &DVector<f64>) -> f64 {
        let waves = self.waves;
        let price = self.price.map_or(0.0, |price| price.merit(straights.as_slice()));
        // Arcs are held: their length is a constant.
        waves.worth * waves.value(straights.as_slice()) + waves.length * straights.sum() + price
    }
}

/// The best place of each search, the best first, and how many places were looked at. Deterministic in `seed`.
pub fn search(polytope: &Polytope, merit: Merit, seed: u64) -> (Vec<Found>, usize) {
    let m = polytope.dimension();
    let base = Found { merit: merit.of(&polytope.straights(&DVector::zeros(m))), z: DVector::zeros(m) };
    if m == 0 {
        return (vec![base], 1);
    }
    let centre = polytope.centre();
    let mut random = Random::new(seed);
    let mut looks = 1;
    let mut all = vec![improve(polytope, merit, DVector::zeros(m), &mut random, &mut looks), base];
    for _ in 0..SEARCHES {
        let mut z = centre.clone();
        for _ in 0..WALK * m {
            let direction = any(m, &mut random);
            let (from, to) = polytope.chord(&z, &direction);
            if to.is_finite() && from.is_finite() {
                z += direction * (from + (to - from) * random.uniform());
            }
        }
        all.push(improve(polytope, merit, z, &mut random, &mut looks));
    }
    all.sort_by(|a, b| a.merit.total_cmp(&b.merit));
    (all, looks)
}

fn any(m: usize, random: &mut Random) -> DVector<f64> {
    DVector::from_fn(m, |_, _| random.normal())
}

/// Lines through the best place so far, now along a single straight, now anywhere.
fn improve(polytope: &Polytope, merit: Merit, z: DVector<f64>, random: &mut Random, looks: &mut usize) -> Found {
    let m = polytope.dimension();
    let n = merit.waves.curves.len();
    let mut best = Found { merit: merit.of(&polytope.straights(&z)), z };
    let mut idle = 0;
    for turn in 0..MOST * m {
        if idle > IDLE * m {
            break;
        }
        let direction = match turn % 2 {
            0 => polytope.towards((random.uniform() * n as f64) as usize % n),
            _ => any(m, random),
        };
        let before = best.merit;
        *looks += line(polytope, merit, &mut best, &direction);
        idle = if best.merit < before * (1.0 - 1e-6) { 0 } else { idle + 1 };
    }
    best
}

/// Moves to the best place of a line; how many places were looked at.
fn line(polytope: &Polytope, merit: Merit, best: &mut Found, direction: &DVector<f64>) -> usize {
    let (from, to) = polytope.chord(&best.z, direction);
    let slope = polytope.along(direction);
    let swing = slope.amax() * (to - from);
    if !(swing.is_finite() && swing > 1e-9) {
        return 0;
    }
    let here = polytope.straights(&best.z);
    let at = |t: f64| merit.of(&(&here + &slope * t));
    let looks = ((swing / merit.waves.pitch * DENSITY) as usize).clamp(LOOKS.0, LOOKS.1);
    let step = (to - from) / looks as f64;
    let (mut t, mut least) = (0.0, best.merit);
    let mut width = step;
    for k in 0..=looks {
        let place = from + step * k as f64;
        let value = at(place);
        if value < least {
            (t, least) = (place, value);
        }
    }
    for _ in 0..HALVINGS {
        width *= 0.5;
        for place in [t - width, t + width] {
            if place < from || place > to {
                continue;
            }
            let value = at(place);
            if value < least {
                (t, least) = (place, value);
            }
        }
    }
    let steps = merit.price.map_or_else(Vec::new, |price| at_steps(price, &here, &slope, (from, to)));
    for &place in &steps {
        let value = at(place);
        if value < least {
            (t, least) = (place, value);
        }
    }
    if least < best.merit {
        best.z += direction * t;
        best.merit = least;
    }
    looks + 1 + 2 * HALVINGS + steps.len()
}

/// Where along a line the pieces of a straight change their price: a price may be low at a single length alone.
fn at_steps(price: &Price, here: &DVector<f64>, slope: &DVector<f64>, (from, to): (f64, f64)) -> Vec<f64> {
    let each = here.iter().zip(slope.iter()).filter(|(_, slope)| slope.abs() > LEVEL).flat_map(|(here, slope)| {
        let (a, b) = (here + slope * from, here + slope * to);
        price.steps(a.min(b), a.max(b)).map(move |length| (length - here) / slope)
    });
    each.collect()
}
