//! Motors on straights, so that the longest way from one to the next is as short as can be: the chain's tension rises by its
//! resistance over that way.
//!
//! Of the best places one is at the end of what a straight takes, else all could be moved on. From each such end the motors
//! are put as far on as the way allows; the way is found by bisection.

use crate::compiled::Compiled;
use crate::geometry::Form;
use crate::model::{PlaceRow, StraightPlace};
use crate::source::Span;

/// What of a straight takes motors' beginnings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Section of the layout.
    pub section: usize,
    /// Arc length of the straight's begin, m.
    pub s: f64,
    /// From there motors may begin up to so far on, m.
    pub room: f64,
}

/// Steps of the bisection.
const STEPS: usize = 60;
/// Places are rounded to it, m.
const ROUNDED: f64 = 1e-3;
const ALIKE: f64 = 1e-9;

/// Straights of a level section that take a motor of this length, m, by arc length.
pub fn stands(compiled: &Compiled, length: f64) -> Vec<Stand> {
    let level = |section: usize| {
        let own = compiled.space.legs.iter().filter(|leg| leg.vertex == section && !leg.curve);
        own.into_iter().all(|leg| matches!(leg.form, Form::Straight { slope: 0.0, .. }))
    };
    let stand = |section: usize| {
        let room = compiled.track.straight(section).length - length;
        let place = StraightPlace { section, at: 0.0, span: compiled.layout.span };
        let rounded = (room / ROUNDED + 1e-6).floor() * ROUNDED;
        (room >= 0.0 && level(section)).then(|| Stand { section, s: compiled.station(place).s, room: rounded })
    };
    let mut stands: Vec<Stand> = (0..compiled.layout.vertices.len()).filter_map(stand).collect();
    stands.sort_by(|a, b| a.s.total_cmp(&b.s));
    stands
}

/// How many motors of this length, m, stand on them at most.
pub fn room(stands: &[Stand], length: f64) -> usize {
    stands.iter().map(|stand| (stand.room / length + ALIKE).floor() as usize + 1).sum()
}

/// Places of so many motors of this length, m, on a lap, m: index of the stand and distance on it, m. `None` where they do
/// not fit.
pub fn place(stands: &[Stand], lap: f64, count: usize, length: f64) -> Option<Vec<(usize, f64)>> {
    if count == 0 {
        return Some(Vec::new());
    }
    if count > room(stands, length) {
        return None;
    }
    let attempt = |way: f64| (0..stands.len()).find_map(|k| from_end(stands, lap, k, (way, length), count));
    let (mut low, mut high) = (lap / count as f64 - ALIKE, lap);
    let mut best = attempt(high);
    for _ in 0..STEPS {
        let way = 0.5 * (low + high);
        match attempt(way) {
            Some(found) => (best, high) = (Some(found), way),
            None => low = way,
        }
    }
    let filled = best.and_then(|found| filled(stands, lap, found, count, length));
    Some(filled.unwrap_or_else(|| packed(stands, count, length)))
}

/// Arc length of a place, m.
fn station(stands: &[Stand], (stand, at): (usize, f64)) -> f64 {
    stands[stand].s + at
}

/// From the end of a stand on, each as far as `way` allows; at most `count`.
fn from_end(
    stands: &[Stand],
    lap: f64,
    first: usize,
    (way, length): (f64, f64),
    count: usize,
) -> Option<Vec<(usize, f64)>> {
    let start = stands[first].s + stands[first].room;
    let mut found = vec![(first, stands[first].room)];
    let mut at = start;
    while start + lap - at > way + ALIKE {
        if found.len() == count {
            return None;
        }
        let (least, most) = (at + length, (at + way).min(start + lap - length));
        // Stands behind the first one come first, then those before it, a lap on.
        let next = (1..=stands.len()).rev().find_map(|k| {
            let index = (first + k) % stands.len();
            let turn = if first + k >= stands.len() { lap } else { 0.0 };
            reach(&stands[index], turn, least, most).map(|place| (index, place))
        });
        let own = || reach(&stands[first], 0.0, least, most).map(|place| (first, place));
        let (index, place) = next.or_else(own)?;
        at = place;
        let begin = stands[index].s;
        let along = (place - begin).rem_euclid(lap);
        let along = if lap - along < 1e-6 { 0.0 } else { along };
        found.push((index, along.min(stands[index].room)));
    }
    Some(found)
}

/// The farthest place of a stand between two arc lengths, m.
fn reach(stand: &Stand, turn: f64, least: f64, most: f64) -> Option<f64> {
    let (low, high) = (stand.s + turn, stand.s + turn + stand.room);
    let place = high.min(most);
    (place >= low - ALIKE && place >= least - ALIKE).then_some(place.max(low))
}

/// Motors that are left over are put into the middle of the longest ways.
fn filled(
    stands: &[Stand],
    lap: f64,
    mut found: Vec<(usize, f64)>,
    count: usize,
    length: f64,
) -> Option<Vec<(usize, f64)>> {
    while found.len() < count {
        let mut all: Vec<f64> = found.iter().map(|place| station(stands, *place).rem_euclid(lap)).collect();
        all.sort_by(f64::total_cmp);
        let way = |k: usize| if k + 1 < all.len() { all[k + 1] - all[k] } else { all[0] + lap - all[k] };
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|a, b| way(*b).total_cmp(&way(*a)));
        let between = |k: &usize| {
            let (from, to) = (all[*k] + length, all[*k] + way(*k) - length);
            let middle = all[*k] + 0.5 * way(*k);
            let choices = (0..stands.len()).flat_map(|index| [0.0, lap].map(|turn| (index, turn)));
            let near = choices.filter_map(|(index, turn)| {
                let stand = &stands[index];
                let (low, high) = ((stand.s + turn).max(from), (stand.s + turn + stand.room).min(to));
                (low <= high + ALIKE).then(|| (index, middle.clamp(low, high.max(low)), turn))
            });
            near.min_by(|a, b| (a.1 - middle).abs().total_cmp(&(b.1 - middle).abs()))
        };
        let (index, place, turn) = order.iter().find_map(between)?;
        found.push((index, (place - turn - stands[index].s).clamp(0.0, stands[index].room)));
    }
    Some(found)
}

/// As close as they stand, thinned out evenly.
fn packed(stands: &[Stand], count: usize, length: f64) -> Vec<(usize, f64)> {
    let of = |(index, stand): (usize, &Stand)| {
        let fit = (stand.room / length + ALIKE).floor() as usize;
        (0..=fit).map(|k| (index, (k as f64 * length).min(stand.room))).collect::<Vec<_>>()
    };
    let all: Vec<(usize, f64)> = stands.iter().enumerate().flat_map(of).collect();
    (0..count).map(|k| all[k * all.len() / count]).collect()
}

/// The same as rows of equal distances, places in whole mm.
pub fn rows(stands: &[Stand], places: &[(usize, f64)], length: f64, span: Span) -> Vec<PlaceRow> {
    let mut ordered: Vec<(usize, i64)> =
        places.iter().map(|(stand, at)| (*stand, (at / ROUNDED + 1e-6).floor() as i64)).collect();
    ordered.sort_unstable();
    let mut rows: Vec<PlaceRow> = Vec::new();
    let mut k = 0;
    while k < ordered.len() {
        let (stand, at) = ordered[k];
        let next = |i: usize| ordered.get(i).filter(|(other, _)| *other == stand).map(|(_, at)| *at);
        let every = next(k + 1).map(|second| second - at);
        let mut count = 1;
        while let Some(every) = every
            && next(k + count) == Some(at + every * count as i64)
        {
            count += 1;
        }
        let place = StraightPlace { section: stands[stand].section, at: at as f64 * ROUNDED, span };
        let alone = (length / ROUNDED).ceil() * ROUNDED;
        let every = if count > 1 { every.map_or(alone, |every| every as f64 * ROUNDED) } else { alone };
        rows.push(PlaceRow { place, every, count });
        k += count;
    }
    rows
}

/// The longest way from one motor to the next on a lap, m.
pub fn longest_way(stands: &[Stand], lap: f64, places: &[(usize, f64)]) -> f64 {
    let mut all: Vec<f64> = places.iter().map(|place| station(stands, *place).rem_euclid(lap)).collect();
    all.sort_by(f64::total_cmp);
    let last = all.first().zip(all.last()).map_or(lap, |(first, last)| first + lap - last);
    all.windows(2).map(|w| w[1] - w[0]).fold(last, f64::max)
}
