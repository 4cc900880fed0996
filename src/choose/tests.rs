//! Closed forms by hand, every candidate against brute force, places and fronts against searches of another kind, and the
//! thrust against the dynamic model.

use super::candidate::Requirement;
use super::check::{pulled, rolled};
use super::drive::{Chain, GRAVITY, Lap};
use super::find::{Chosen, choose};
use super::places::{Stand, longest_way, place, room, rows};
use super::settings::Settings;
use super::trade::{Measure, front, undominated};
use super::write;
use crate::base::stop::Stop;
use crate::base::trig;
use crate::capacity::bound;
use crate::chain_input::Simulation;
use crate::compiled::fixture::{compile, on};
use crate::compiled::{Compiled, order};
use crate::dynamics::{Plan, Width};
use crate::effects;
use crate::geometry::{CentreLine, Form};
use crate::kinematics::fit;
use crate::model::{
    Article, Chutes, DriveDuty, EnergyUse, Fatigue, Free, Induction, Layout, Motors, PlaceRow, RequiredCapacity,
    TakeUp, fixture,
};
use crate::solve::Options;
use crate::source::Spanned;
use proptest::prelude::*;

fn near(found: f64, expected: f64, share: f64) {
    assert!((found / expected - 1.0).abs() < share, "{found} is not {expected}");
}

fn settings() -> Settings {
    Settings {
        options: Options { threads: 1, ..Options::default() },
        width: Width::used(),
        checks: 0,
        tracks_within: None,
    }
}

/// A rectangle as written, with an induction and chutes, and carts of five lengths, two motors and four speeds to choose
/// from.
fn open_layout() -> Layout {
    let mut layout = fixture::rectangle(30.0, 14.0, 4.0);
    layout.objective.terms.clear();
    layout.catalog.take_up = 0.7;
    layout.equipment.inductions = vec![Induction { name: "west".into(), place: on(0, 1.0) }];
    let row = PlaceRow { place: on(2, 1.0), every: 1.0, count: 10 };
    layout.equipment.chutes = vec![Chutes { name: "row".into(), row, more: Vec::new() }];
    let priced = |price: f64| Article { number: None, price: Some(price), mass: None };
    layout.cart.joint.article = priced(38.0);
    let cart = |k: usize| {
        let length = 0.6 + 0.15 * k as f64;
        let mut cart = layout.cart.clone();
        (cart.length, cart.mass) = (length, 16.0 + 20.0 * length);
        cart.article = priced(420.0 + 280.0 * length);
        Free { item: cart, written: format!("tray(length: {} mm)", (length * 1e3).round()) }
    };
    layout.choice.carts = (0..5).map(cart).collect();
    let motor = |name: &str, length: f64, force: f64, price: f64, efficiency: f64| {
        let mut motor = layout.drive.motor.clone();
        (motor.name, motor.length, motor.force) = (name.into(), length, force);
        (motor.article, motor.efficiency) = (priced(price), Some(efficiency));
        Free { item: motor, written: name.into() }
    };
    layout.choice.motors = vec![motor("small", 1.0, 300.0, 1500.0, 0.5), motor("large", 1.8, 700.0, 3100.0, 0.6)];
    layout.choice.speeds = vec![1.4, 1.7, 2.0, 2.3];
    let within = |time: f64| Some(Spanned::new(time, fixture::span()));
    layout.choice.drive = DriveDuty { load: 15.0, starts: within(12.0), stops: within(4.0), spare: 1 };
    layout.choice.energy = Some(EnergyUse { price: 0.22 / 3.6e6, running: 6000.0 * 3600.0, years: 8.0 });
    require(&mut layout, 6800.0);
    layout
}

fn require(layout: &mut Layout, least: f64) {
    layout.capacity.required = Some(RequiredCapacity { least: Spanned::new(least, fixture::span()), reason: None });
}

#[test]
fn thrust_by_hand() {
    let compiled = compile(fixture::rectangle(20.0, 10.0, 4.0));
    let lap = Lap::new(&compiled.space.line);
    let length = 28.0 + 8.0 * trig::PI;
    near(lap.length, length, 1e-12);
    near(lap.run, length, 1e-12);
    near(lap.turn, trig::TAU, 1e-12);
    assert_eq!(lap.rise, 0.0);
    let mut cart = compiled.layout.cart.clone();
    cart.drag = Some(0.03);
    let chain = Chain { cart: &cart, carts: 42, speed: 2.0, load: 9.0, tension: 500.0 };
    // 42 carts of 50 kg: 2100 kg.
    let resistance = chain.resistance(&lap);
    near(resistance.rolling, 0.015 * 2100.0 * 9.81, 1e-12);
    near(resistance.curves, 0.015 * (500.0 - 2100.0 / length * 4.0) * 2.0 * trig::PI, 1e-12);
    near(resistance.air, 42.0 * 0.03 * 4.0, 1e-12);
    assert_eq!(resistance.climbs, 0.0);
    let within = |time: f64| Some(Spanned::new(time, fixture::span()));
    let thrust = chain.thrust(&lap, &DriveDuty { load: 9.0, starts: within(7.0), stops: within(3.0), spare: 2 });
    near(thrust.starting.unwrap(), resistance.steady() + 600.0, 1e-12);
    near(thrust.stopping.unwrap(), 1400.0 - resistance.rolling, 1e-12);
    // 1091 N to stop: four motors of 300 N, or one of 1100 N, and two that are spare.
    assert_eq!((thrust.motors(300.0, 2), thrust.motors(1100.0, 2), thrust.motors(1090.0, 2)), (6, 3, 4));
    // Without times, steady running with a fifth of the thrust left to the controller.
    let thrust = chain.thrust(&lap, &DriveDuty::default());
    let most = thrust.resistance.most() / 0.8;
    assert_eq!((thrust.motors(most + 0.1, 0), thrust.motors(most - 0.1, 0)), (1, 2));
}

/// A climb through two vertical curves: 2 R (1 − cos α) + L sin α, and as much down.
#[test]
fn rises_are_counted_and_lift_the_load() {
    let up = [(0.0, 0.1), (0.1, 0.0), (0.0, -0.1), (-0.1, 0.0)];
    let vertical = |k: usize| Form::Vertical { radius: 10.0, slope_from: up[k].0, slope_to: up[k].1 };
    let forms = [
        vertical(0),
        Form::Straight { length: 8.0, slope: 0.1 },
        vertical(1),
        Form::Arc { radius: 5.0, turn: trig::PI },
        vertical(2),
        Form::Straight { length: 8.0, slope: -0.1 },
        vertical(3),
        Form::Arc { radius: 5.0, turn: trig::PI },
    ];
    let lap = Lap::new(&CentreLine::new([0.0; 4], &forms));
    let angle = trig::atan(0.1);
    near(lap.rise, 20.0 * (1.0 - trig::cos(angle)) + 8.0 * trig::sin(angle), 1e-9);
    near(lap.turn, trig::TAU, 1e-12);
    let cart = compile(fixture::rectangle(20.0, 10.0, 4.0)).layout.cart;
    let chain = Chain { cart: &cart, carts: 40, speed: 2.0, load: 12.0, tension: 500.0 };
    near(chain.resistance(&lap).climbs, 40.0 * 12.0 / lap.length * GRAVITY * lap.rise, 1e-12);
}

/// The dynamic model, which knows nothing of these closed forms, needs as much thrust.
#[test]
fn the_dynamic_model_needs_as_much_thrust() {
    // Two stand so far apart that a cart passes several segments between them.
    for count in [2, 8] {
        let mut layout = fixture::rectangle(30.0, 14.0, 4.0);
        layout.equipment.motors = Motors::Evenly { count };
        as_much_thrust(&compile(layout));
    }
}

fn as_much_thrust(compiled: &Compiled) {
    let chain = Chain {
        cart: &compiled.layout.cart,
        carts: compiled.chain.unwrap().carts,
        speed: 2.0,
        load: 0.0,
        tension: compiled.layout.chain.tension,
    };
    let expected = chain.resistance(&Lap::new(&compiled.space.line)).steady();
    let plan = Plan { laps: 2, ..Plan::default() };
    let outcome = effects::simulate(&Simulation::new(compiled), &plan, Width::used(), &mut |_| true).unwrap();
    near(outcome.mean_thrust, expected, 0.05);
}

#[test]
fn every_candidate_is_what_building_it_gives() {
    let layout = open_layout();
    let chosen = choose(&layout, &settings(), &|_| ()).unwrap();
    assert_eq!((chosen.candidates.len(), chosen.tracks.len()), (5 * 2 * 4, 1));
    let length = chosen.tracks[0].compiled.length();
    for c in &chosen.candidates {
        let built = chosen.built(c).unwrap();
        let (cart, motor) = (&built.layout.cart, &built.layout.drive.motor);
        let beside: f64 = order::lines(&built).iter().filter_map(order::OrderLine::price).sum();
        assert!((c.price - built.bill.price - beside).abs() < 1e-6, "{} {beside}", c.price);
        let sorter = built.sorter().unwrap();
        let found = bound(&sorter, sorter.proportions().as_deref()).unwrap();
        near(c.capacity.as_ref().unwrap().throughput, found.throughput, 1e-12);
        // One zone: carriers that pass.
        let carts = fit(&built.space.line, cart.length).unwrap().carts;
        near(found.throughput, 3600.0 * c.speed * carts as f64 / length, 1e-9);
        // Thrust and energy by hand.
        let mass = carts as f64 * (cart.mass + 15.0);
        let rolling = 0.015 * mass * 9.81;
        let curves = 0.015 * (500.0 - mass / length * c.speed * c.speed).abs() * trig::TAU;
        let wanted = (rolling + curves + mass * c.speed / 12.0).max(mass * c.speed / 4.0 - rolling);
        let wanted = wanted.max((rolling + curves) / 0.8);
        assert!((c.motors - 1) as f64 * motor.force >= wanted && (c.motors - 2) as f64 * motor.force < wanted);
        near(c.energy, (rolling + curves) * c.speed * 6000.0 * 3600.0 / motor.efficiency.unwrap(), 1e-9);
        near(c.total, c.price + c.energy * 0.22 / 3.6e6 * 8.0, 1e-12);
        let fits = c.motors as f64 * motor.length <= length;
        let enough = found.throughput >= 6800.0;
        assert_eq!(c.is_feasible(), fits && enough, "{c:?}");
    }
}

/// The least total by looking through all of them, and what a requirement costs by leaving it out.
#[test]
fn the_winner_is_the_least_and_requirements_cost_what_they_add() {
    let layout = open_layout();
    let chosen = choose(&layout, &settings(), &|_| ()).unwrap();
    let least = |chosen: &Chosen| {
        let feasible = chosen.candidates.iter().filter(|c| c.shortfalls.is_empty());
        feasible.map(|c| c.total).fold(f64::INFINITY, f64::min)
    };
    let best = least(&chosen);
    assert_eq!(chosen.candidates[chosen.winner.unwrap()].total, best);
    for (requirement, cost) in &chosen.costs {
        let mut without = layout.clone();
        let drive = &mut without.choice.drive;
        match requirement {
            Requirement::Capacity => without.capacity.required = None,
            Requirement::Starts => drive.starts = None,
            Requirement::Stops => drive.stops = None,
            Requirement::Spare => drive.spare = 0,
            Requirement::Load => drive.load = 0.0,
            Requirement::Closes => without.catalog.take_up = 1e3,
            Requirement::Tension | Requirement::Room | Requirement::Motors => continue,
        }
        let other = least(&choose(&without, &settings(), &|_| ()).unwrap());
        assert!((cost.unwrap() - (best - other)).abs() < 1e-6, "{requirement:?}");
        assert!(cost.unwrap() >= 0.0);
    }
    let capacity = chosen.costs.iter().find(|(r, _)| *r == Requirement::Capacity).unwrap().1.unwrap();
    assert!(capacity > 0.0, "shorter or faster carts cost more");
}

#[test]
fn what_none_reaches_is_said() {
    let mut layout = open_layout();
    require(&mut layout, 20_000.0);
    let chosen = choose(&layout, &settings(), &|_| ()).unwrap();
    assert_eq!(chosen.winner, None);
    let said = super::refused(&chosen);
    let most = chosen.candidates.iter().map(|c| c.capacity.as_ref().unwrap().throughput).fold(0.0, f64::max);
    assert_eq!(said.len(), 1);
    assert_eq!(said[0].code.as_str(), "E0605");
    let found = said[0].found.as_ref().unwrap();
    assert!(found.contains(&format!("at most {most:.0}")) && found.contains("600 mm at 2.3 m/s"), "{found}");
    // Too little time to stop: no room for so many motors.
    let mut layout = open_layout();
    layout.choice.drive.stops = Some(Spanned::new(0.05, fixture::span()));
    let said = super::refused(&choose(&layout, &settings(), &|_| ()).unwrap());
    assert!(said[0].message.contains("room for the motors"), "{}", said[0].message);
}

/// The layout's own motors are too few: that is no matter of room.
#[test]
fn too_few_motors_are_told_as_that() {
    let mut layout = open_layout();
    layout.choice.motors.clear();
    layout.equipment.motors = Motors::Evenly { count: 2 };
    let chosen = choose(&layout, &settings(), &|_| ()).unwrap();
    assert_eq!(chosen.winner, None);
    let said = super::refused(&chosen);
    assert_eq!(said[0].message, "none of 20 choices has the motors that it needs");
    assert_eq!(said[0].label.text, "the layout has 2 motors");
    let needed = chosen.candidates.iter().map(|c| c.shortfalls.last().unwrap().wanted).fold(f64::INFINITY, f64::min);
    let help = said[0].help.clone().unwrap();
    assert!(help.starts_with(&format!("write `motors {needed} evenly`, or leave motors free")), "{help}");
    // Written so, they are enough.
    layout.equipment.motors = Motors::Evenly { count: needed as usize };
    let chosen = choose(&layout, &settings(), &|_| ()).unwrap();
    assert!(chosen.missed_by(Requirement::Motors) < chosen.worked_out);
}

/// Two zones: the closed form is reached by no simulation, so that of what it allows the cheapest takes too little.
#[test]
fn what_takes_too_little_in_the_simulation_is_not_chosen() {
    let mut layout = open_layout();
    layout.equipment.inductions.push(Induction { name: "north".into(), place: on(2, 14.0) });
    let row = PlaceRow { place: on(3, 0.5), every: 1.0, count: 5 };
    layout.equipment.chutes.push(Chutes { name: "row_north".into(), row, more: Vec::new() });
    // Each row lies behind one induction and before the other, so that carriers are used more than once in a lap. The
    // closed form does not know that an item on two carriers needs two free ones side by side.
    layout.capacity.items.double = 0.3;
    let closed = choose(&layout, &settings(), &|_| ()).unwrap();
    let cheapest = closed.candidates[closed.order[0]].capacity.clone().unwrap().throughput;
    require(&mut layout, 0.995 * cheapest);
    let chosen = choose(&layout, &Settings { checks: 5, ..settings() }, &|_| ()).unwrap();
    let winner = &chosen.candidates[chosen.winner.unwrap()];
    assert!(!chosen.short.is_empty(), "{:?}", chosen.simulated);
    for short in &chosen.short {
        let (found, required) = chosen.falls_short(&chosen.candidates[*short]).unwrap();
        assert!(found.value + found.half_width < required);
        assert!(chosen.candidates[*short].total <= winner.total);
    }
    assert!(chosen.falls_short(winner).is_none() && chosen.takes(winner).is_some());
    // The other motor does not make the same cart at the same speed take more.
    let next = &chosen.candidates[chosen.next_best().unwrap()];
    assert!(chosen.falls_short(next).is_none() && next.total >= winner.total);
    // So much is built: the same sorter, simulated by itself.
    let built = chosen.built(winner).unwrap().sorter().unwrap();
    let alone = super::simulated::simulate(&built, 0.0, 1, Stop::NEVER);
    near(alone.value, chosen.takes(winner).unwrap().value, 1e-9);
    // What no choice takes is told.
    let most = closed.candidates.iter().map(|c| c.capacity.as_ref().unwrap().throughput).fold(0.0, f64::max);
    require(&mut layout, 0.995 * most);
    let chosen = choose(&layout, &Settings { checks: 5, ..settings() }, &|_| ()).unwrap();
    assert_eq!(chosen.winner, None);
    let said = super::refused(&chosen);
    assert!(said[0].message.contains("items an hour that are required"), "{}", said[0].message);
    assert!(said[0].label.text.starts_with("simulated, "), "{}", said[0].label.text);
}

fn take_up(name: &str, travel: f64, force: f64, price: f64) -> TakeUp {
    let article = Article { number: None, price: Some(price), mass: None };
    TakeUp { name: name.into(), travel, force: Some(force), article }
}

/// Against choosing with each take-up given: the least of these is what is chosen where all are free.
#[test]
fn the_take_up_is_the_one_that_costs_least_in_all() {
    // The chain is at 500 N: the first two do not hold it, and to the third few carts close.
    let all = [
        take_up("weak", 0.7, 499.0, 10.0),
        take_up("weak_and_long", 1.0, 100.0, 20.0),
        take_up("short", 0.05, 500.0, 100.0),
        take_up("longer", 0.3, 800.0, 160.0),
        take_up("long", 0.7, 800.0, 4000.0),
    ];
    let least = |layout: &Layout| {
        let chosen = choose(layout, &settings(), &|_| ()).unwrap();
        chosen.winner.map_or(f64::INFINITY, |k| chosen.candidates[k].total)
    };
    let mut winners = Vec::new();
    // What is left over may be anything, or the track closes for each cart.
    for closes in [None, Some(0.25)] {
        let mut layout = open_layout();
        layout.chain.closes_within = closes.map(|within| Spanned::new(within, fixture::span()));
        if closes.is_some() {
            layout.objective = fixture::rectangle(30.0, 14.0, 4.0).objective;
        }
        let given = all.iter().skip(2).map(|one| {
            let mut with = layout.clone();
            with.take_up = Some(one.clone());
            // A track that closes within more than the take-up gives is none of it.
            if let Some(within) = &mut with.chain.closes_within {
                within.value = within.value.min(one.travel);
            }
            least(&with)
        });
        let expected = given.fold(f64::INFINITY, f64::min);
        layout.choice.take_ups = all.iter().map(|one| Free { item: one.clone(), written: one.name.clone() }).collect();
        let chosen = choose(&layout, &settings(), &|_| ()).unwrap();
        let winner = &chosen.candidates[chosen.winner.unwrap()];
        assert!((winner.total - expected).abs() < 1e-6, "{closes:?}: {} for {expected}", winner.total);
        let named = &chosen.take_up(winner).unwrap().item;
        let left = chosen.fitted[winner.fitted].fit.unwrap().left_over.abs();
        assert!(left <= named.travel + 1e-6 && named.force.unwrap() >= 500.0, "{left} m with {}", named.name);
        // It is ordered, with its price, and said.
        let built = chosen.built(winner).unwrap();
        let ordered = order::lines(&built);
        let line = ordered.iter().find(|line| line.description.starts_with("take-up ")).unwrap();
        assert_eq!(line.price(), named.article.price);
        let said = write::lines(&chosen, winner).unwrap().all().join("\n");
        assert!(said.contains(&format!("take_up {}", named.name)), "{said}");
        winners.push(named.name.clone());
    }
    assert!(winners.iter().all(|name| name.as_str() != "long"), "{winners:?}");

    let mut layout = open_layout();
    layout.choice.take_ups = all[..2].iter().map(|one| Free { item: one.clone(), written: one.name.clone() }).collect();
    let said = super::refused(&choose(&layout, &settings(), &|_| ()).unwrap());
    assert_eq!(said[0].message, "no take-up holds the chain's tension");
    assert_eq!(said[0].label.text, "the strongest that may be chosen holds 499 N");
}

/// The cheapest sensor first; where its load cells do not reach, the cheapest that do, with the same chain and drive.
#[test]
fn a_sensor_measures_what_the_winner_simulates() {
    let mut layout = open_layout();
    layout.equipment.photocell = Some(on(0, 1.0));
    let sensor = |name: &str, range: Option<f64>, price: f64| {
        let mut sensor = layout.sensor.clone();
        (sensor.name, sensor.range) = (name.into(), range);
        sensor.article = Article { number: None, price: Some(price), mass: None };
        Free { item: sensor, written: name.into() }
    };
    layout.choice.sensors =
        vec![sensor("dear", None, 900.0), sensor("weak", Some(20.0), 100.0), sensor("fit", Some(1e5), 300.0)];
    let closed = choose(&layout, &settings(), &|_| ()).unwrap();
    let first = &closed.candidates[closed.winner.unwrap()];
    assert_eq!(closed.sensor(first).unwrap().written, "weak");
    let chosen = choose(&layout, &Settings { checks: 2, ..settings() }, &|_| ()).unwrap();
    let winner = &chosen.candidates[chosen.winner.unwrap()];
    assert_eq!(chosen.sensor(winner).unwrap().written, "fit");
    assert_eq!((winner.fitted, winner.motor, winner.motors), (first.fitted, first.motor, first.motors));
    assert!((winner.price - first.price - 200.0).abs() < 1e-6 && (winner.total - first.total - 200.0).abs() < 1e-6);
    let failed = chosen.checked[0].1.as_ref().unwrap();
    let told = super::refused::failures(failed);
    assert!(told.len() == 1 && told[0].starts_with("a load cell measures "), "{told:?}");
    let (peak, range) = chosen.checked[1].1.as_ref().unwrap().measured.unwrap();
    assert!(peak > 20.0 && range == 1e5, "{peak} of {range}");
    // What is measured is the largest of all force channels of the built layout's run.
    let mut built = chosen.built(winner).unwrap();
    built.layout.cart.mass += layout.choice.drive.load;
    let plan = Plan { laps: 2, ..Plan::default() };
    let run = effects::simulate(&Simulation::new(&built), &plan, Width::used(), &mut |_| true).unwrap().run;
    let forces = run.channels.iter().filter(|(channel, _)| channel.unit() == "N");
    let largest = forces.flat_map(|(_, values)| values).fold(0.0_f64, |most, value| most.max(value.abs()));
    assert!(peak >= largest - 1e-9, "{peak} is less than {largest}");
}

#[test]
fn motors_stand_on_straights_where_they_may() {
    let mut layout = open_layout();
    layout.choice.on_straights = true;
    let chosen = choose(&layout, &settings(), &|_| ()).unwrap();
    let winner = &chosen.candidates[chosen.winner.unwrap()];
    let built = chosen.built(winner).unwrap();
    let Motors::Rows(rows) = &built.layout.equipment.motors else { panic!("rows") };
    assert_eq!(rows.iter().map(|row| row.count).sum::<usize>(), winner.motors);
    let length = built.layout.drive.motor.length;
    for row in rows {
        let last = row.place.at + row.every * (row.count - 1) as f64 + length;
        assert!(row.place.at >= 0.0 && last <= built.track.straight(row.place.section).length + 1e-9);
    }
    let lines = write::lines(&chosen, winner).unwrap();
    assert!(lines.places.iter().all(|line| line.starts_with("motors on P")), "{lines:?}");
    assert!(lines.cart.starts_with("cart tray(length: "), "{lines:?}");
}

#[test]
fn damage_by_hand() {
    let fatigue = Fatigue { range: 1000.0, cycles: 1e6, exponent: 5.0 };
    // Ten cycles of 500 N that repeat: ten whole ones, each 2⁻⁵ of a millionth.
    let saw: Vec<f64> = (0..20).map(|k| if k % 2 == 0 { 700.0 } else { 200.0 }).collect();
    near(pulled(Some(&saw), &fatigue), 10.0 / 32.0 / 1e6, 1e-9);
    assert_eq!(pulled(None, &fatigue), 0.0);
    // Two laps of 10 π m on a wheel of 50 mm: 200 revolutions under 500 N.
    near(rolled(Some(&vec![500.0; 9]), &fatigue, 10.0 * trig::PI, 0.05), 200.0 / 32.0 / 1e6, 1e-9);
}

#[test]
fn what_no_other_beats_is_among_all() {
    let chosen = choose(&open_layout(), &settings(), &|_| ()).unwrap();
    let rows = undominated(&chosen, &[Measure::Price, Measure::Capacity]);
    let value = |k: usize, m: Measure| m.of(&chosen, k).unwrap();
    let least = chosen.order.iter().map(|k| value(*k, Measure::Price)).fold(f64::INFINITY, f64::min);
    let most = chosen.order.iter().map(|k| value(*k, Measure::Capacity)).fold(0.0, f64::max);
    assert_eq!((rows[0].1[0], rows.last().unwrap().1[1]), (least, most));
    assert!(rows.len() > 2);
}

proptest! {
    /// Against the definition, pair by pair.
    #[test]
    fn fronts_are_what_the_definition_says(values in prop::collection::vec(prop::array::uniform3(0u8..6), 1..40)) {
        let gains = vec![false, true, false];
        let rows: Vec<(usize, Vec<f64>)> =
            values.iter().enumerate().map(|(k, v)| (k, v.iter().map(|x| f64::from(*x)).collect())).collect();
        let cost = |k: usize| [rows[k].1[0], -rows[k].1[1], rows[k].1[2]];
        let beats = |a: usize, b: usize| {
            let (x, y) = (cost(a), cost(b));
            x.iter().zip(&y).all(|(x, y)| x <= y) && (x != y || a < b)
        };
        let mut expected: Vec<usize> =
            (0..rows.len()).filter(|b| !(0..rows.len()).any(|a| a != *b && beats(a, *b))).collect();
        let mut found: Vec<usize> = front(rows.clone(), gains).into_iter().map(|(k, _)| k).collect();
        expected.sort_unstable();
        found.sort_unstable();
        prop_assert_eq!(found, expected);
    }

    /// No choice of places on a grid has a shorter longest way.
    #[test]
    fn places_are_as_even_as_can_be(
        parts in prop::collection::vec((1u8..8, 1u8..8), 2..4),
        count in 1usize..5,
    ) {
        let length = 1.0;
        let (mut s, mut stands) = (0.0, Vec::new());
        for (section, (straight, gap)) in parts.iter().enumerate() {
            stands.push(Stand { section, s, room: f64::from(*straight) - length });
            s += f64::from(*straight) + f64::from(*gap);
        }
        let lap = s;
        let placed = place(&stands, lap, count, length);
        prop_assert_eq!(placed.is_some(), count <= room(&stands, length));
        let Some(placed) = placed else { return Ok(()) };
        prop_assert_eq!(placed.len(), count);
        for (stand, at) in &placed {
            prop_assert!(*at >= 0.0 && *at <= stands[*stand].room + 1e-9);
        }
        let mut all: Vec<f64> = placed.iter().map(|(stand, at)| stands[*stand].s + at).collect();
        all.sort_by(f64::total_cmp);
        prop_assert!(all.windows(2).all(|w| w[1] - w[0] >= length - 1e-6), "{:?}", all);
        let made: usize = rows(&stands, &placed, length, fixture::span()).iter().map(|row| row.count).sum();
        prop_assert_eq!(made, count);
        // All places on a grid of half a metre.
        let grid: Vec<(usize, f64)> = stands
            .iter()
            .enumerate()
            .flat_map(|(k, stand)| (0..=(stand.room * 2.0) as usize).map(move |i| (k, 0.5 * i as f64)))
            .collect();
        let mut best = f64::INFINITY;
        let mut chosen: Vec<usize> = (0..count).collect();
        if count <= grid.len() {
            loop {
                let these: Vec<(usize, f64)> = chosen.iter().map(|k| grid[*k]).collect();
                let at: Vec<f64> = these.iter().map(|(k, x)| stands[*k].s + x).collect();
                let around = at[0] + lap - at[count - 1];
                if at.windows(2).all(|w| w[1] - w[0] >= length - 1e-9) && (count == 1 || around >= length - 1e-9) {
                    best = best.min(longest_way(&stands, lap, &these));
                }
                let Some(k) = (0..count).rev().find(|k| chosen[*k] < grid.len() - count + k) else { break };
                chosen[k] += 1;
                for i in k + 1..count {
                    chosen[i] = chosen[i - 1] + 1;
                }
            }
        }
        prop_assert!(longest_way(&stands, lap, &placed) <= best + 1e-6, "{} {best}", longest_way(&stands, lap, &placed));
    }
}
