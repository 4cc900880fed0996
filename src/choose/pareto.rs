//! Layouts that no other one beats in two or three measures: tracks that trade what a track decides, and on them whatever
//! components the layout leaves open.

use super::candidate::{Candidate, Requirement, root_mean_square, sensor_price};
use super::drive::{Resistance, Thrust};
use super::find::{self, Chosen, TooMany};
use super::refused::words;
use super::tracks::{self, Track};
use super::trade::{Measure, front};
use super::write::lines;
use crate::compiled::{Compiled, order};
use crate::kinematics::polygon::{Course, PolygonObjective, curve_phasor};
use crate::model::{Layout, Objective, Stands};
use crate::solve::polygon::least_action;
use crate::solve::{Certificate, Counted, End, Options, Tell};

/// One of them.
#[derive(Clone, Debug)]
pub struct Traded {
    /// With its components.
    pub compiled: Compiled,
    /// In the order of the measures.
    pub values: Vec<f64>,
    /// What its track is the best of, as far as is known; `certificate` is of that.
    pub objective: Objective,
    /// The end whose radii it keeps.
    pub radii: Option<End>,
    pub certificate: Option<Certificate>,
    /// Its components, in words, where the layout leaves some open.
    pub choice: Option<String>,
    /// The lines that say them.
    pub lines: Vec<String>,
}

/// How good the best layout in one measure is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best {
    pub value: f64,
    /// No layout on the grid has less; `None` where nothing is proven of this measure.
    pub bound: Option<f64>,
    /// What no layout with the curves of this one in their order has less of, to about 1 %, whatever straights lie between
    /// them: of smoothness only.
    pub same_curves: Option<f64>,
    /// Whether it is known to be the best without a bound: every component was looked at, and no track matters.
    pub proven: bool,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Pareto {
    pub measures: Vec<Measure>,
    /// By the first measure, the best first.
    pub layouts: Vec<Traded>,
    /// Of each measure; empty where there is no layout.
    pub ends: Vec<Best>,
    /// Tracks that were found, and layouts on them that do what is required.
    pub tracks: usize,
    pub candidates: usize,
    /// A measure that none of them has.
    pub lacking: Option<Measure>,
    /// Whether the time was up before all was done.
    pub cut: bool,
}

/// Trades these measures. Components that the layout leaves open with `choose` are chosen in closed form, and do what is
/// required in it; others are as written.
///
/// # Errors
/// [`TooMany`]
pub fn pareto(layout: &Layout, measures: &[Measure], options: &Options, watch: Tell) -> Result<Pareto, TooMany> {
    let open = layout.choice.is_open();
    let by_cart = open && measures.iter().any(|m| matches!(m, Measure::Price | Measure::Smoothness));
    let asked = tracks::asked(layout, by_cart).len();
    find::few_enough(layout, asked)?;
    let ends = ends(measures);
    // How many motors a track needs at least hangs on its length.
    let bounds_price = open && measures.contains(&Measure::Price) && !ends.contains(&End::Length);
    let alone: &[End] = if bounds_price { &[End::Length] } else { &[] };
    let tracks = tracks::traded(layout, (&ends, alone), by_cart, options, watch);
    let fitted = find::fitted(layout, &tracks, options.threads);
    let candidates = find::candidates(layout, &tracks, &fitted, None);
    // What only a choice has to do is not asked of components that are as written.
    let held = |requirement: Requirement| open || requirement == Requirement::Capacity;
    let serves = |c: &Candidate| c.shortfalls.iter().all(|s| !held(s.requirement));
    let order: Vec<usize> = (0..candidates.len()).filter(|k| serves(&candidates[*k])).collect();
    let chosen = Chosen::of(layout, tracks, fitted, candidates, order);
    let row = |k: &usize| Some((*k, measures.iter().map(|m| m.of(&chosen, *k)).collect::<Option<Vec<f64>>>()?));
    let rows: Vec<(usize, Vec<f64>)> = chosen.order.iter().filter_map(row).collect();
    let missing = |m: &&Measure| !chosen.order.is_empty() && chosen.order.iter().all(|k| m.of(&chosen, *k).is_none());
    // What stands where along the loop is then the same on every track, and so is what it takes.
    let settled = !layout.equipment.declared.iter().any(|d| matches!(d.stands, Stands::Free { .. }))
        && variants(&chosen) == asked
        && options.stop.cut().is_none();
    let best = |i: usize, measure: Measure| {
        let sign = if measure.is_gain() { -1.0 } else { 1.0 };
        let best = rows.iter().min_by(|a, b| (sign * a.1[i]).total_cmp(&(sign * b.1[i])));
        let most =
            || chosen.candidates.iter().filter_map(|c| Some(c.capacity.as_ref()?.throughput)).fold(0.0, f64::max);
        best.map(|(k, values)| Best {
            proven: measure == Measure::Capacity && settled && values[i] >= most(),
            value: values[i],
            bound: bound(&chosen, measure, asked, settled),
            same_curves: (measure == Measure::Smoothness).then(|| smoothest(&chosen, *k)).flatten(),
        })
    };
    let gains = measures.iter().map(|m| m.is_gain()).collect();
    let stepped = |values: &[f64]| values.iter().zip(measures).map(|(v, m)| (v / m.step()).round()).collect();
    // Of those that are alike, the first of all.
    let alike = front(rows.iter().enumerate().map(|(i, (_, values))| (i, stepped(values))).collect(), gains);
    let traded = |(i, _): &(usize, Vec<f64>)| {
        let (k, values) = &rows[*i];
        let candidate = &chosen.candidates[*k];
        let track: &Track = chosen.track(candidate);
        Some(Traded {
            compiled: chosen.built(candidate)?,
            values: values.clone(),
            objective: track.objective.clone(),
            radii: track.radii,
            certificate: track.compiled.stages.last().and_then(|stage| stage.certificate.clone()),
            choice: open.then(|| words(&chosen, candidate)),
            lines: if open {
                lines(&chosen, candidate)?.all().into_iter().map(str::to_owned).collect()
            } else {
                Vec::new()
            },
        })
    };
    Ok(Pareto {
        layouts: alike.iter().filter_map(traded).collect(),
        ends: measures.iter().enumerate().filter_map(|(i, m)| best(i, *m)).collect(),
        lacking: measures.iter().find(missing).copied(),
        cut: options.stop.cut().is_some(),
        measures: measures.to_vec(),
        tracks: chosen.tracks.len(),
        candidates: rows.len(),
    })
}

/// Whether two tracks are of the same components and numbers.
fn is_same(a: &Track, b: &Track) -> bool {
    (a.radius, a.length, a.left_over) == (b.radius, b.length, b.left_over) && a.counts == b.counts
}

/// How many of what was asked for have a track.
fn variants(chosen: &Chosen) -> usize {
    let mut seen: Vec<&Track> = Vec::new();
    for track in &chosen.tracks {
        if !seen.iter().any(|other| is_same(other, track)) {
            seen.push(track);
        }
    }
    seen.len()
}

/// What tracks have to be best in.
fn ends(measures: &[Measure]) -> Vec<End> {
    let end = |measure: &Measure| match measure {
        Measure::Price => Some(End::TotalPrice),
        Measure::Cost => Some(End::Cost),
        // The floor of a band and what a chain takes to run grow with the length.
        Measure::Footprint | Measure::Energy | Measure::Length => Some(End::Length),
        Measure::Smoothness => Some(End::PolygonAction),
        Measure::Capacity => None,
    };
    let mut ends: Vec<End> = Vec::new();
    for end in measures.iter().filter_map(end) {
        if !ends.contains(&end) {
            ends.push(end);
        }
    }
    // A track there has to be.
    if ends.is_empty() {
        ends.push(End::TotalPrice);
    }
    ends
}

/// What no layout on the grid has less of, as far as is proven: the least of what is proven of each track that is asked
/// for. `settled`: whether what a sorter takes is the same on every track.
fn bound(chosen: &Chosen, measure: Measure, asked: usize, settled: bool) -> Option<f64> {
    let is_end = |c: &Certificate| match measure {
        Measure::Length | Measure::Footprint | Measure::Energy => c.counted == Counted::Length,
        Measure::Cost => c.counted == (Counted::Price { metre: 0.0 }) && !c.in_all,
        Measure::Price => c.in_all,
        Measure::Capacity | Measure::Smoothness => false,
    };
    let of = |(index, track): (usize, &Track)| {
        let least = proven(track, &is_end)?;
        match measure {
            Measure::Footprint => Some(least * chosen.layout.width.value),
            Measure::Energy => least_energy(chosen, index, least, settled),
            Measure::Price if chosen.layout.choice.is_open() => least_price(chosen, index, least, settled),
            _ => Some(least),
        }
    };
    let bounds: Vec<f64> = chosen.tracks.iter().enumerate().filter_map(of).collect();
    bounds.iter().copied().reduce(f64::min).filter(|_| bounds.len() == asked)
}

/// The least root mean square of ΔP that the curves of a candidate leave, mm.
fn smoothest(chosen: &Chosen, candidate: usize) -> Option<f64> {
    let candidate = &chosen.candidates[candidate];
    let course = Course::new(&chosen.track(candidate).compiled.space.line).ok()?;
    let pitch = chosen.cart(candidate).length;
    let alone = |k: usize| Some(curve_phasor(&course, k, pitch).ok()?.delta_p);
    let alone: Vec<f64> = (0..course.len()).map(alone).collect::<Option<_>>()?;
    let all = least_action(&alone, PolygonObjective::All)?;
    Some(1e3 * root_mean_square(all, &course))
}

/// What a track's certificate says, if it is such a one.
fn proven(track: &Track, is_such: &dyn Fn(&Certificate) -> bool) -> Option<f64> {
    let certificate = track.compiled.stages.last()?.certificate.as_ref()?;
    (certificate.budget.is_none() && is_such(certificate)).then_some(certificate.lower_bound)
}

/// What the components that may be tried on a track, and do what is required whatever the track, cost at least on any
/// track, EUR, where none is cheaper than `least` with those that are written. Fewer carts need fewer motors: as many fewer
/// as the shortest track has. `None` where carts of this length have several prices, and on different heights.
fn least_price(chosen: &Chosen, index: usize, least: f64, settled: bool) -> Option<f64> {
    let track = &chosen.tracks[index];
    let layout = &track.compiled.layout;
    let shortest = chosen.tracks.iter().filter(|other| is_same(other, track));
    let shortest = shortest.filter_map(|other| proven(other, &|c| c.counted == Counted::Length)).next()?;
    let fitted: Vec<usize> = (0..chosen.fitted.len()).filter(|f| chosen.fitted[*f].track == index).collect();
    let [fitted] = fitted[..] else { return None };
    let on = &chosen.fitted[fitted];
    if !layout.levels.is_empty() {
        return None;
    }
    let own = order::total(&track.compiled).all - on.price;
    let cheapest = |prices: &mut dyn Iterator<Item = f64>| prices.reduce(f64::min).unwrap_or(0.0);
    let choice = &chosen.layout.choice;
    let sensors = 0..choice.sensors.len();
    let beside = cheapest(&mut choice.take_ups.iter().map(|free| free.item.article.cost()))
        + cheapest(&mut sensors.map(|k| sensor_price(&chosen.layout, k)));
    let carts = fewest_carts(layout, shortest) / on.fit?.carts as f64;
    let share = carts.min(1.0);
    let motors = |c: &Candidate| {
        if choice.motors.is_empty() {
            return c.motors;
        }
        let resistance = &c.thrust.resistance;
        let straight =
            Resistance { rolling: share * resistance.rolling, air: share * resistance.air, curves: 0.0, climbs: 0.0 };
        let thrust = Thrust {
            resistance: straight,
            starting: c.thrust.starting.map(|all| share * (all - resistance.curves)),
            stopping: c.thrust.stopping.map(|all| share * all),
        };
        thrust.motors(chosen.motor(c).force, choice.drive.spare)
    };
    let all = chosen.candidates.iter().filter(|c| c.fitted == fitted && may_serve(c, settled));
    let price = |c: &Candidate| least - own + beside + motors(c) as f64 * chosen.motor(c).article.cost();
    // Where none serves, none of these tracks counts.
    Some(all.map(price).reduce(f64::min).unwrap_or(f64::INFINITY))
}

/// Whether components may do what is required on any track: what a sorter takes is the same on all where it is settled.
fn may_serve(candidate: &Candidate, settled: bool) -> bool {
    !settled || candidate.shortfalls.iter().all(|s| s.requirement != Requirement::Capacity)
}

/// The fewest carts on a track of this length or more, m.
fn fewest_carts(layout: &Layout, length: f64) -> f64 {
    let chain = length - layout.most_cut_by_chords() - layout.most_left_over();
    (chain / layout.cart.length - 1e-9).ceil().max(0.0)
}

/// What the components that may be tried on a track take in a year at least, kWh, on any track of this length or more, m:
/// so many carts roll and are driven through the air; what curves add is left out. `None` on different heights.
fn least_energy(chosen: &Chosen, index: usize, length: f64, settled: bool) -> Option<f64> {
    let track = &chosen.tracks[index];
    if !track.compiled.layout.levels.is_empty() {
        return None;
    }
    let least = |c: &Candidate| {
        let layout = Layout { cart: chosen.cart(c).clone(), ..track.compiled.layout.clone() };
        let carts = fewest_carts(&layout, length) / chosen.fitted[c.fitted].fit?.carts as f64;
        let resistance = &c.thrust.resistance;
        let share = (resistance.rolling + resistance.air) / resistance.steady() * carts.min(1.0);
        Some(c.energy / 3.6e6 * share)
    };
    let own = chosen.candidates.iter().filter(|c| chosen.fitted[c.fitted].track == index);
    Some(own.filter(|c| may_serve(c, settled)).filter_map(least).reduce(f64::min).unwrap_or(f64::INFINITY))
}
