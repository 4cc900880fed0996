//! All candidates, the cheapest that does what is required, and what each requirement costs.

use super::candidate::{self, Candidate, Fitted, Requirement, Room};
use super::check::{self, Check};
use super::places;
use super::settings::{Settings, Tell, Told};
use super::simulated::{self, Simulated};
use super::tracks::{self, NoTrack, Track};
use crate::base::parallel;
use crate::base::stop::Stop;
use crate::capacity::{Mean, Sorter};
use crate::compiled::Compiled;
use crate::model::{Cart, Free, Layout, Motor, Motors, Sensor, TakeUp};
use crate::solve::Options;
use std::fmt;

/// Candidates, and tracks that they are on, at most.
const MOST: usize = 400_000;
const MOST_TRACKS: usize = 1000;
/// Runs in the dynamic model for each candidate that may be checked: of some only the sensor fails.
const TRIES: usize = 10;

/// There are more than can be looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TooMany {
    Candidates(usize),
    Tracks(usize),
}

impl fmt::Display for TooMany {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (count, what, most, done) = match self {
            TooMany::Candidates(count) => (count, "candidates", MOST, "looked at"),
            TooMany::Tracks(count) => (count, "tracks", MOST_TRACKS, "solved"),
        };
        write!(f, "{count} {what} are more than {most}, which are {done}: leave less free")
    }
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Chosen {
    pub layout: Layout,
    pub tracks: Vec<Track>,
    pub untracked: Vec<NoTrack>,
    pub fitted: Vec<Fitted>,
    /// Those with the fewest motors that do in closed form, and behind them those with more that were checked.
    pub candidates: Vec<Candidate>,
    /// How many of them have the fewest motors.
    pub worked_out: usize,
    /// Candidates that do what is required in closed form and have not failed a check, the least total first.
    pub order: Vec<usize>,
    /// How many did in closed form.
    pub feasible: usize,
    /// Sorters whose capacity was simulated, where one is required.
    pub simulated: Vec<Simulated>,
    /// Candidates that surely take too little in that simulation, in the order of `order`.
    pub short: Vec<usize>,
    /// Candidates that were checked in the dynamic model, with what was found, in the order of `order`.
    pub checked: Vec<(usize, Result<Check, String>)>,
    /// The first of `order` that passed its checks.
    pub winner: Option<usize>,
    /// What each requirement adds to the least total, EUR, before any check; `None` where there is none without it either.
    pub costs: Vec<(Requirement, Option<f64>)>,
}

/// Whether all candidates may be looked at, on so many tracks.
///
/// # Errors
/// [`TooMany`]
pub fn few_enough(layout: &Layout, tracks: usize) -> Result<(), TooMany> {
    let choice = &layout.choice;
    let count = [choice.carts.len(), choice.motors.len(), choice.speeds.len(), choice.radii.len()].map(|n| n.max(1));
    let numbers = choice.counts.iter().map(|free| free.counts.len());
    match count.into_iter().chain(numbers).fold(1, usize::saturating_mul) {
        count if count > MOST => Err(TooMany::Candidates(count)),
        _ if tracks > MOST_TRACKS => Err(TooMany::Tracks(tracks)),
        _ => Ok(()),
    }
}

/// Works out all candidates.
///
/// # Errors
/// [`TooMany`]
pub fn choose(layout: &Layout, settings: &Settings, told: Tell) -> Result<Chosen, TooMany> {
    few_enough(layout, tracks::asked(layout, false).len())?;
    let stop = settings.tracks_within.map_or(settings.options.stop, Stop::after);
    let of_tracks = Options { stop, ..settings.options };
    let (tracks, untracked) = tracks::tracks(layout, &of_tracks, told);
    let fitted = fitted(layout, &tracks, settings.options.threads);
    let candidates = candidates(layout, &tracks, &fitted, None);
    let order = ordered(&candidates);
    let cheapest = order.first().map(|k| candidates[*k].total);
    let costs = costs(layout, &tracks, &fitted, cheapest);
    let mut chosen = Chosen { untracked, costs, ..Chosen::of(layout, tracks, fitted, candidates, order) };
    chosen.check(settings, told);
    Ok(chosen)
}

/// Every cart on every track that it may be tried on.
pub fn fitted(layout: &Layout, tracks: &[Track], threads: usize) -> Vec<Fitted> {
    let carts = tracks::carts(layout);
    let pairs: Vec<(usize, usize)> = (0..tracks.len())
        .flat_map(|track| (0..carts.len()).map(move |cart| (track, cart)))
        .filter(|(track, cart)| tracks[*track].length.is_none_or(|length| carts[*cart].length == length))
        .collect();
    parallel::map(&pairs, threads, |pair| Fitted::new(*pair, &tracks[pair.0], carts[pair.1], layout))
}

/// Motors that may be chosen: the layout's own where it leaves none open.
pub fn motors(layout: &Layout) -> Vec<&Motor> {
    match layout.choice.motors.is_empty() {
        true => vec![&layout.drive.motor],
        false => layout.choice.motors.iter().map(|motor| &motor.item).collect(),
    }
}

/// Every candidate, in the order of tracks, carts, motors and speeds.
pub fn candidates(layout: &Layout, tracks: &[Track], fitted: &[Fitted], waived: Option<Requirement>) -> Vec<Candidate> {
    let (carts, motors) = (tracks::carts(layout), motors(layout));
    let own = [layout.speed.value];
    let speeds = if layout.choice.speeds.is_empty() { &own[..] } else { &layout.choice.speeds };
    let room = |track: &Track| {
        let of = |motor: &&Motor| Room::new(&track.compiled, motor, layout.choice.on_straights);
        motors.iter().map(of).collect::<Vec<_>>()
    };
    let rooms: Vec<Vec<Room>> = tracks.iter().map(room).collect();
    let mut all = Vec::new();
    for (f, on) in fitted.iter().enumerate() {
        for (m, kind) in motors.iter().enumerate() {
            let parts = (on, &tracks[on.track], carts[on.cart], *kind, &rooms[on.track][m]);
            all.extend(speeds.iter().map(|speed| Candidate::new((f, m), *speed, parts, layout, waived)));
        }
    }
    all
}

/// Those that do what is required, the least total first; of equal ones the first.
fn ordered(candidates: &[Candidate]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..candidates.len()).filter(|k| candidates[*k].is_feasible()).collect();
    order.sort_by(|a, b| candidates[*a].total.total_cmp(&candidates[*b].total).then(a.cmp(b)));
    order
}

fn costs(
    layout: &Layout,
    tracks: &[Track],
    fitted: &[Fitted],
    cheapest: Option<f64>,
) -> Vec<(Requirement, Option<f64>)> {
    let drive = &layout.choice.drive;
    let asked = [
        (Requirement::Capacity, layout.capacity.required.is_some()),
        (Requirement::Closes, true),
        (Requirement::Tension, !layout.choice.take_ups.is_empty() || layout.take_up.is_some()),
        (Requirement::Starts, drive.starts.is_some()),
        (Requirement::Stops, drive.stops.is_some()),
        (Requirement::Spare, drive.spare > 0),
        (Requirement::Load, drive.load > 0.0),
        (Requirement::Room, !layout.choice.motors.is_empty()),
        (Requirement::Motors, layout.choice.motors.is_empty()),
    ];
    let cost = |requirement: Requirement| {
        let all = candidates(layout, tracks, fitted, Some(requirement));
        let least = ordered(&all).first().map(|k| all[*k].total);
        (requirement, least.map(|least| cheapest.map_or(f64::INFINITY, |cheapest| cheapest - least)))
    };
    asked.into_iter().filter(|(_, asked)| *asked).map(|(requirement, _)| cost(requirement)).collect()
}

impl Chosen {
    /// Candidates on tracks, in an order, before any check.
    pub fn of(
        layout: &Layout,
        tracks: Vec<Track>,
        fitted: Vec<Fitted>,
        candidates: Vec<Candidate>,
        order: Vec<usize>,
    ) -> Self {
        Chosen {
            layout: layout.clone(),
            tracks,
            untracked: Vec::new(),
            fitted,
            worked_out: candidates.len(),
            candidates,
            feasible: order.len(),
            order,
            simulated: Vec::new(),
            short: Vec::new(),
            checked: Vec::new(),
            winner: None,
            costs: Vec::new(),
        }
    }

    pub fn cart(&self, candidate: &Candidate) -> &Cart {
        tracks::carts(&self.layout)[self.fitted[candidate.fitted].cart]
    }

    pub fn motor(&self, candidate: &Candidate) -> &Motor {
        motors(&self.layout)[candidate.motor]
    }

    /// The take-up that a candidate has, where it was free.
    pub fn take_up(&self, candidate: &Candidate) -> Option<&Free<TakeUp>> {
        self.layout.choice.take_ups.get(candidate.take_up)
    }

    /// The sensor that a candidate has, where it was free.
    pub fn sensor(&self, candidate: &Candidate) -> Option<&Free<Sensor>> {
        self.layout.choice.sensors.get(candidate.sensor)
    }

    /// Those that do what is required in closed form and are not known to fail a check, the least total first.
    pub fn cheapest(&self) -> impl Iterator<Item = usize> {
        self.order.iter().copied().filter(|k| self.falls_short(&self.candidates[*k]).is_none())
    }

    pub fn track(&self, candidate: &Candidate) -> &Track {
        &self.tracks[self.fitted[candidate.fitted].track]
    }

    /// Numbers of equipment that a candidate has where they are free, by name.
    pub fn numbers(&self, candidate: &Candidate) -> Vec<(&str, usize)> {
        let declared = &self.layout.equipment.declared;
        let free = self.layout.choice.counts.iter().zip(&self.track(candidate).counts);
        free.flat_map(|(free, count)| free.declared.iter().map(|k| (declared[*k].name.as_str(), *count))).collect()
    }

    /// How many candidates with the fewest motors fall short of a requirement.
    pub fn missed_by(&self, requirement: Requirement) -> usize {
        let falls = |c: &&Candidate| c.shortfalls.iter().any(|s| s.requirement == requirement);
        self.candidates[..self.worked_out].iter().filter(falls).count()
    }

    /// The sorter of a candidate.
    pub fn sorter(&self, candidate: &Candidate) -> Option<Sorter> {
        let sorter = self.fitted[candidate.fitted].sorter.as_ref()?;
        Some(Sorter { speed: candidate.speed, ..sorter.clone() })
    }

    /// What the simulation says that a candidate takes, items an hour, where it was simulated.
    pub fn takes(&self, candidate: &Candidate) -> Option<Mean> {
        let own = |s: &&Simulated| s.fitted == candidate.fitted && s.speed == candidate.speed;
        self.simulated.iter().find(own).map(|simulated| simulated.found)
    }

    /// Items an hour that a candidate takes and that are required of it, where it surely falls short in the simulation.
    pub fn falls_short(&self, candidate: &Candidate) -> Option<(Mean, f64)> {
        let required = self.layout.capacity.required.as_ref()?.least.value;
        self.takes(candidate).filter(|found| simulated::is_short(*found, required)).map(|found| (found, required))
    }

    /// The cheapest behind the winner that is not known to take too little.
    pub fn next_best(&self) -> Option<usize> {
        let place = self.order.iter().position(|k| Some(*k) == self.winner)?;
        let mut behind = self.order[place + 1..].iter().copied();
        behind.find(|k| self.falls_short(&self.candidates[*k]).is_none())
    }

    /// The layout that a candidate is, with its motors in their places. `None` where they do not fit.
    pub fn built(&self, candidate: &Candidate) -> Option<Compiled> {
        let on = &self.fitted[candidate.fitted];
        let track = &self.tracks[on.track];
        let mut compiled = track.compiled.clone();
        let layout = &mut compiled.layout;
        layout.cart = self.cart(candidate).clone();
        layout.chain.tension = self.layout.tension_with(&layout.cart);
        layout.drive.motor = self.motor(candidate).clone();
        layout.speed.value = candidate.speed;
        if let Some(take_up) = self.take_up(candidate) {
            layout.take_up = Some(take_up.item.clone());
        }
        if let Some(sensor) = self.sensor(candidate) {
            layout.sensor = sensor.item.clone();
        }
        if !self.layout.choice.motors.is_empty() {
            let length = layout.drive.motor.length;
            layout.equipment.motors = match self.layout.choice.on_straights {
                false => Motors::Evenly { count: candidate.motors },
                true => {
                    let stands = places::stands(&track.compiled, length);
                    let placed = places::place(&stands, track.lap.length, candidate.motors, length)?;
                    Motors::Rows(places::rows(&stands, &placed, length, self.layout.span))
                }
            };
        }
        compiled.chain = on.fit;
        Some(compiled)
    }

    /// Checks candidates in their order until one passes, its capacity first, which takes less time. One that fails in the
    /// dynamic model may pass with another motor, which is then a candidate of its own.
    fn check(&mut self, settings: &Settings, told: Tell) {
        let years = self.layout.choice.energy.map(|energy| (energy.running, energy.years));
        while let Some(k) = self.order.first().copied() {
            if settings.checks == 0 {
                self.winner = Some(k);
                return;
            }
            if self.checks() >= settings.checks || self.checked.len() >= TRIES * settings.checks {
                return;
            }
            if !self.simulate(k, settings, told) {
                return;
            }
            if self.falls_short(&self.candidates[k]).is_some() {
                self.short.push(k);
                self.order.remove(0);
                continue;
            }
            told(Told::Check);
            let found = match self.built(&self.candidates[k]) {
                Some(compiled) => check::check(&compiled, &self.layout.choice.drive, years, settings),
                None => Err("its motors do not fit on the straights".to_owned()),
            };
            let passed = found.as_ref().is_ok_and(Check::passes);
            let measured = found.as_ref().ok().and_then(Check::beyond_range);
            let alone = found.as_ref().is_ok_and(Check::is_but_for_range);
            self.checked.push((k, found));
            if passed {
                self.winner = Some(k);
                return;
            }
            self.order.remove(0);
            self.add(k, usize::from(!alone), measured);
        }
    }

    /// Candidates that were checked, but for those whose sensor alone failed.
    fn checks(&self) -> usize {
        let but_for_range = |found: &Result<Check, String>| {
            found.as_ref().is_ok_and(|check| check.is_but_for_range() && !check.passes())
        };
        self.checked.iter().filter(|(_, found)| !but_for_range(found)).count()
    }

    /// Simulates a candidate's sorter, where a capacity is required, unless that is done. `false` where no more are simulated.
    fn simulate(&mut self, k: usize, settings: &Settings, told: Tell) -> bool {
        let candidate = &self.candidates[k];
        let Some(required) = self.layout.capacity.required.as_ref().map(|required| required.least.value) else {
            return true;
        };
        if self.takes(candidate).is_some() {
            return true;
        }
        let Some(sorter) = self.sorter(candidate) else { return true };
        if self.simulated.len() == simulated::MOST {
            return false;
        }
        told(Told::Capacity);
        let found = simulated::simulate(&sorter, required, settings.options.threads, settings.options.stop);
        if settings.options.stop.now() {
            return false;
        }
        self.simulated.push(Simulated { fitted: candidate.fitted, speed: candidate.speed, found });
        true
    }

    /// Adds a candidate with more motors than another, where there is room for them, and with a sensor for what was measured,
    /// N, where the other's was too little.
    fn add(&mut self, than: usize, motors: usize, measured: Option<f64>) {
        let mut more = self.candidates[than].clone();
        let motor = self.motor(&more);
        let room = Room::new(&self.track(&more).compiled, motor, self.layout.choice.on_straights);
        if motors > 0 && (self.layout.choice.motors.is_empty() || more.motors + motors > room.most) {
            return;
        }
        let mut added = motors as f64 * motor.article.cost();
        if let Some(force) = measured {
            let Some(sensor) = candidate::cheapest_sensor(&self.layout, force) else { return };
            added += candidate::sensor_price(&self.layout, sensor) - candidate::sensor_price(&self.layout, more.sensor);
            more.sensor = sensor;
        }
        more.motors += motors;
        more.price += added;
        more.total += added;
        let index = self.candidates.len();
        let at = self.order.partition_point(|k| self.candidates[*k].total <= more.total);
        self.order.insert(at, index);
        self.candidates.push(more);
    }
}
