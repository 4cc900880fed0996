//! One choice of components: what it gives, and what of the requirements it falls short of.

use super::drive::{self, Chain, Thrust};
use super::places::{self, Stand};
use super::tracks::Track;
use crate::capacity::{Bound, Sorter, bound};
use crate::compiled::{Compiled, order};
use crate::kinematics::polygon::{Course, PolygonObjective, action};
use crate::kinematics::{Fit, fit};
use crate::model::{Article, Cart, Free, Layout, Motor, Motors, TakeUp};

/// What a choice has to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Requirement {
    /// `require capacity`
    Capacity,
    /// A whole number of carts on the track.
    Closes,
    /// `drive starts within`
    Starts,
    /// `drive stops within`
    Stops,
    /// `drive spare`
    Spare,
    /// `drive load`
    Load,
    /// A take-up that holds the chain's tension.
    Tension,
    /// Room for the motors.
    Room,
    /// As many motors as it needs, of those that the layout has.
    Motors,
}

/// How far a choice is from what is required.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortfall {
    pub requirement: Requirement,
    /// What it gives: items an hour, m left over, N of tension, or motors that there are or that there is room for.
    pub found: f64,
    /// What it would have to give.
    pub wanted: f64,
}

impl Shortfall {
    /// As a share of what is wanted; of what must be less, of itself.
    pub fn share(&self) -> f64 {
        (self.found - self.wanted).abs() / self.wanted.abs().max(f64::MIN_POSITIVE)
    }
}

/// A cart on a track: what all speeds and motors have in common.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Indices into tracks and carts.
    pub track: usize,
    pub cart: usize,
    /// `None` where no chain closes at all.
    pub fit: Option<Fit>,
    /// At any speed.
    pub sorter: Option<Sorter>,
    /// Of all but motors, and what of take-up and sensor is free, EUR.
    pub price: f64,
    /// Root mean square of ΔP over all straights and starts, m; `None` where the track has none.
    pub polygon_action: Option<f64>,
}

impl Fitted {
    pub fn new(index: (usize, usize), track: &Track, cart: &Cart, layout: &Layout) -> Self {
        let mut compiled = track.compiled.clone();
        compiled.layout.cart = cart.clone();
        compiled.layout.chain.tension = layout.tension_with(cart);
        compiled.layout.equipment.motors = Motors::Evenly { count: 0 };
        compiled.chain = fit(&compiled.space.line, cart.length);
        compiled.layout.choice = layout.choice.clone();
        if !layout.choice.take_ups.is_empty() {
            compiled.layout.take_up = None;
        }
        if !layout.choice.sensors.is_empty() {
            compiled.layout.sensor.article = Article::default();
        }
        let beside: f64 = order::lines(&compiled).iter().filter_map(order::OrderLine::price).sum();
        let rough = || {
            let course = Course::new(&compiled.space.line).ok()?;
            let value = action(&course, cart.length).ok()?.value(PolygonObjective::All);
            Some(root_mean_square(value, &course))
        };
        Fitted {
            track: index.0,
            cart: index.1,
            fit: compiled.chain,
            sorter: compiled.sorter(),
            price: compiled.bill.price + beside,
            polygon_action: rough(),
        }
    }
}

/// Of ΔP over all straights and starts, m, from the sum of its squares, m².
pub fn root_mean_square(squares: f64, course: &Course) -> f64 {
    (squares / (course.len() * course.len()) as f64).sqrt()
}

/// Where motors may stand on a track, of each kind of motor.
#[derive(Clone, Debug)]
pub struct Room {
    /// Empty where they stand evenly.
    pub stands: Vec<Stand>,
    /// Most motors.
    pub most: usize,
}

impl Room {
    pub fn new(compiled: &Compiled, motor: &Motor, on_straights: bool) -> Self {
        match on_straights {
            true => {
                let stands = places::stands(compiled, motor.length);
                Room { most: places::room(&stands, motor.length), stands }
            }
            false => Room { stands: Vec::new(), most: (compiled.length() / motor.length + 1e-9).floor() as usize },
        }
    }
}

/// A choice, worked out.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Indices into fitted carts and motors.
    pub fitted: usize,
    pub motor: usize,
    /// m/s
    pub speed: f64,
    /// How many motors it needs.
    pub motors: usize,
    /// Index into the take-ups that may be chosen, the cheapest that serves; 0 where none is free.
    pub take_up: usize,
    /// Index into the sensors that may be chosen; 0 where none is free.
    pub sensor: usize,
    pub thrust: Thrust,
    /// `None` where nothing comes or goes.
    pub capacity: Option<Bound>,
    /// EUR
    pub price: f64,
    /// Electrical, J a year; 0 where the layout does not say how long it runs.
    pub energy: f64,
    /// Price, and energy over the years that the layout says, EUR.
    pub total: f64,
    pub shortfalls: Vec<Shortfall>,
}

impl Candidate {
    pub fn is_feasible(&self) -> bool {
        self.shortfalls.is_empty()
    }

    /// Works out a choice, all requirements but `waived` held.
    pub fn new(
        (fitted, motor): (usize, usize),
        speed: f64,
        (on, track, cart, kind, room): (&Fitted, &Track, &Cart, &Motor, &Room),
        layout: &Layout,
        waived: Option<Requirement>,
    ) -> Self {
        let holds = |requirement: Requirement| waived != Some(requirement);
        let mut duty = layout.choice.drive.clone();
        duty.starts = duty.starts.filter(|_| holds(Requirement::Starts));
        duty.stops = duty.stops.filter(|_| holds(Requirement::Stops));
        duty.spare = if holds(Requirement::Spare) { duty.spare } else { 0 };
        duty.load = if holds(Requirement::Load) { duty.load } else { 0.0 };
        let carts = on.fit.map_or(0, |fit| fit.carts);
        let tension = layout.tension_with(cart);
        let chain = Chain { cart, carts, speed, load: duty.load, tension };
        let thrust = chain.thrust(&track.lap, &duty);
        let motors = match layout.choice.motors.is_empty() {
            // Those that the layout has.
            true => track.compiled.motors().len(),
            false => thrust.motors(kind.force, duty.spare),
        };
        let needed = thrust.motors(kind.force, duty.spare);
        let capacity = on.sorter.as_ref().and_then(|sorter| {
            let sorter = Sorter { speed, ..sorter.clone() };
            bound(&sorter, sorter.proportions().as_deref())
        });
        let mut shortfalls = Vec::new();
        let mut short = |requirement, found, wanted| shortfalls.push(Shortfall { requirement, found, wanted });
        if let Some(required) = layout.capacity.required.as_ref().filter(|_| holds(Requirement::Capacity)) {
            let found = capacity.as_ref().map_or(0.0, |bound| bound.throughput);
            if found < required.least.value {
                short(Requirement::Capacity, found, required.least.value);
            }
        }
        let take_up = take_up(layout, tension, |candidate| {
            let closes = !holds(Requirement::Closes) || on.fit.is_some_and(|fit| fit.is_within(candidate.travel));
            closes && (!holds(Requirement::Tension) || candidate.holds(tension))
        });
        let chosen = layout.choice.take_ups.get(take_up).map(|free| &free.item);
        let own = chosen.or(layout.take_up.as_ref());
        if let Some(weak) = own.filter(|own| holds(Requirement::Tension) && !own.holds(tension)) {
            short(Requirement::Tension, weak.force.unwrap_or(f64::INFINITY), tension);
        }
        if holds(Requirement::Closes) {
            let travel = chosen.map_or(layout.take_up_travel(), |chosen| chosen.travel);
            let most = layout.chain.closes_within.as_ref().map_or(travel, |within| within.value.min(travel));
            match on.fit {
                Some(fit) if fit.is_within(most) => {}
                Some(fit) => short(Requirement::Closes, fit.left_over.abs(), most),
                None => short(Requirement::Closes, f64::INFINITY, most),
            }
        }
        let (most, why) = match layout.choice.motors.is_empty() {
            true => (motors, Requirement::Motors),
            false => (room.most, Requirement::Room),
        };
        if holds(why) && needed > most {
            short(why, most as f64, needed as f64);
        }
        let sensor = cheapest_sensor(layout, 0.0).unwrap_or(0);
        let beside = chosen.map_or(0.0, |chosen| chosen.article.cost()) + sensor_price(layout, sensor);
        let price = on.price + kind.article.cost() * motors as f64 + beside;
        let price = (price * 100.0).round() / 100.0;
        let (mut energy, mut total) = (0.0, price);
        if let Some(used) = &layout.choice.energy {
            energy = drive::energy(&thrust.resistance, speed, used.running, kind.efficiency);
            total += energy * used.price * used.years;
        }
        Candidate { fitted, motor, speed, motors, take_up, sensor, thrust, capacity, price, energy, total, shortfalls }
    }
}

/// The cheapest of the free take-ups that serves; where none does, of those that hold the chain's tension the one of the
/// longest travel, and where none holds it the strongest. The first of equal ones.
fn take_up(layout: &Layout, tension: f64, serves: impl Fn(&TakeUp) -> bool) -> usize {
    let all: &[Free<TakeUp>] = &layout.choice.take_ups;
    let price = |k: &usize| all[*k].item.article.cost();
    let serving = (0..all.len()).filter(|k| serves(&all[*k].item));
    serving.min_by(|a, b| price(a).total_cmp(&price(b))).unwrap_or_else(|| {
        let holding = (0..all.len()).filter(|k| all[*k].item.holds(tension));
        let longest = holding.rev().max_by(|a, b| all[*a].item.travel.total_cmp(&all[*b].item.travel));
        let force = |k: &usize| all[*k].item.force.unwrap_or(f64::INFINITY);
        let strongest = || (0..all.len()).rev().max_by(|a, b| force(a).total_cmp(&force(b)));
        longest.or_else(strongest).unwrap_or(0)
    })
}

/// The cheapest of the free sensors that measures a force, N; the first of equal ones. `None` where there is none.
pub(super) fn cheapest_sensor(layout: &Layout, force: f64) -> Option<usize> {
    let all = &layout.choice.sensors;
    let measures = |k: &usize| all[*k].item.range.is_none_or(|range| force <= range);
    let price = |k: &usize| all[*k].item.article.cost();
    (0..all.len()).filter(measures).min_by(|a, b| price(a).total_cmp(&price(b)))
}

/// What a free sensor costs, EUR; nothing where the layout has no photocell, and so nothing that is measured.
pub(super) fn sensor_price(layout: &Layout, sensor: usize) -> f64 {
    let ordered = layout.choice.sensors.get(sensor).filter(|_| layout.equipment.photocell.is_some());
    ordered.map_or(0.0, |free| free.item.article.cost())
}
