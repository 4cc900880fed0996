use super::*;
use crate::base::trig;
use crate::compiled::fixture::compile;
use crate::dynamics::{Ensemble, EnsemblePlan, Method, Width};
use crate::model::fixture;
use crate::solve::Stop;

/// A short track with two motors.
fn nominal() -> Simulation {
    let mut simulation = Simulation::new(&compile(fixture::rectangle(20.0, 12.0, 4.0)));
    simulation.motors.s_m = vec![3.0, 30.0];
    simulation
}

fn with(name: &str, strengths: &[(&str, f64)]) -> Simulation {
    let mut simulation = nominal();
    let strengths = strengths.iter().map(|(n, x)| ((*n).to_owned(), *x)).collect();
    simulation.effects.push(crate::chain_input::DeclaredEffect { name: name.to_owned(), strengths });
    simulation
}

fn ensemble_of(simulation: &Simulation) -> Ensemble {
    let plan =
        EnsemblePlan { settle: 6.0, duration: 3.0, step: None, method: Method::Verlet, front: 0.0, stop: Stop::NEVER };
    let ensemble = run_ensemble(simulation, &plan, None, Width::widest()).expect("a chain");
    assert!(ensemble.trouble.is_none());
    ensemble
}

fn mean(ensemble: &Ensemble, force: usize) -> f64 {
    let all = || ensemble.carts.iter().flat_map(|c| &c.forces[force]);
    all().map(|x| f64::from(*x)).sum::<f64>() / all().count() as f64
}

/// Samples of a made-up run: channel k is 100 k + sin t.
fn sensed(simulation: &Simulation) -> [Vec<f64>; FORCES] {
    let time: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
    let mut forces: [Vec<f64>; FORCES] =
        std::array::from_fn(|k| time.iter().map(|t| 100.0 * k as f64 + trig::sin(*t)).collect());
    let tops = std::array::from_fn(|k| 100.0 * k as f64 + 1.0);
    sense(simulation, &mut Sensed { time: &time, period: 0.01, forces: &mut forces, tops });
    forces
}

/// On a track whose curve is 30 mm wider or whose heading is another, a settled chain goes on as it ran: what its joints
/// carry changes by far less than the tension.
#[test]
fn a_settled_chain_goes_on_on_another_track() {
    let settled = ensemble_of(&nominal()).settled;
    let first = |simulation: &Simulation| -> Vec<f32> {
        let plan = EnsemblePlan {
            settle: 0.0,
            duration: 0.004,
            step: None,
            method: Method::Verlet,
            front: 0.0,
            stop: Stop::NEVER,
        };
        let ensemble = run_ensemble(simulation, &plan, Some(&settled), Width::widest()).expect("a chain");
        ensemble.carts.iter().map(|cart| cart.forces[4][0]).collect()
    };
    let plain = first(&nominal());
    for changed in [("radius", 0.03), ("heading", 0.005)] {
        let moved = first(&with("curve_geometry", &[("curve", 1.0), changed]));
        let apart: Vec<f32> = plain.iter().zip(&moved).map(|(a, b)| (a - b).abs()).collect();
        let most = apart.iter().copied().fold(0.0, f32::max);
        assert!(most > 0.0 && most < 150.0, "{changed:?}: {most} N, {apart:?}");
    }
}

#[test]
fn every_effect_of_the_chain_moves_what_carts_measure() {
    let plain = ensemble_of(&nominal());
    for effect in LIBRARY.into_iter().chain(AS_BUILT).filter(|e| !e.is_sensor()) {
        for (strength, fitted) in effect.strengths() {
            // At the first of the listed sites that has the strength.
            let listed = match effect.sites {
                Sites::Listed(listed) => listed(&nominal()),
                Sites::Suspected => Vec::new(),
            };
            let site = listed.into_iter().find(|site| (effect.has)(site, strength.name));
            let place = site.into_iter().flat_map(|site| site.fixed);
            let given: Vec<(&str, f64)> = place.chain([(strength.name, fitted.trial)]).collect();
            let moved = ensemble_of(&with(effect.name(), &given));
            assert!(
                plain.carts[0].forces != moved.carts[0].forces,
                "{} of {} does nothing",
                strength.name,
                effect.name()
            );
        }
        // Without strength it is the nominal chain, bit for bit where nothing else changes.
        let none = ensemble_of(&with(effect.name(), &[(effect.definition.strengths[0].name, 0.0)]));
        let near = (mean(&none, 4) - mean(&plain, 4)).abs() < 1e-2 * mean(&plain, 4).abs();
        assert!(near, "{}: {} and {}", effect.name(), mean(&none, 4), mean(&plain, 4));
    }
}

#[test]
fn an_element_that_is_higher_steps_both_running_rails() {
    let of = |rail: f64| {
        let step = with("rail_step", &[("height", 1e-3), ("at", 10.0), ("rail", rail)]);
        deviations_of(&step).expect("a track").1.rails
    };
    let (both, left, right) = (of(4.0), of(2.0), of(3.0));
    assert!(both[0].is_empty() && both[1] == left[1] && both[2] == right[2] && both[1] == both[2]);
}

/// The steepest slope of the left rail in a step, over height and length of its rise.
fn steepness(at: f64, height: f64, rise: f64, length: f64) -> f64 {
    let step = with("rail_step", &[("height", height), ("at", at), ("rail", 2.0), ("rise", rise)]);
    let (simulation, deviations) = deviations_of(&step).expect("a track");
    let line = simulation.track.centre_line();
    // The way lies in the middle between both rails.
    let left = |k: i32| 2.0 * deviations.way(&line, at + 1e-3 * f64::from(k)).z;
    let slope = |k: i32| (left(k + 1) - left(k)) / 1e-3;
    (-50..150).map(slope).fold(0.0, f64::max) * length / height
}

#[test]
fn a_step_is_as_steep_wherever_it_lies_and_no_steeper_than_its_wheel_climbs() {
    for at in [10.0, 10.001, 10.0025, 10.004, 10.0125, 10.019] {
        let found = steepness(at, 1e-3, 0.05, 0.05);
        assert!((0.95..1.15).contains(&found), "{at}: {found}");
    }
    let climbed = (2.0 * nominal().running_wheel.radius_m * 4e-3_f64).sqrt();
    let found = steepness(10.0, 4e-3, 1e-3, climbed);
    assert!((0.9..1.2).contains(&found), "{found}");
}

#[test]
fn a_track_that_is_built_off_has_the_tension_that_was_asked_for() {
    let plain = mean(&ensemble_of(&nominal()), 4);
    for (name, strength) in
        [("offset", -0.01), ("offset", 0.01), ("radius", 0.1), ("heading", 0.01), ("transition", 1.0)]
    {
        let built = mean(&ensemble_of(&with("curve_geometry", &[(name, strength), ("curve", 2.0)])), 4);
        assert!((built - plain).abs() < 5.0, "{name} {strength}: {built} N and {plain} N");
    }
}

#[test]
fn curves_are_built_as_their_strengths_say() {
    let track = |name: &str, strength: f64| {
        let (simulation, deviations) =
            deviations_of(&with("curve_geometry", &[(name, strength), ("curve", 2.0)])).expect("a track");
        (sites::curves(&simulation), simulation.track.centre_line(), deviations)
    };
    let (planned, line, _) = track("offset", 0.0);
    // An arc of 90° between the same straights: 2 − π/2 of the radius is saved.
    let (curves, longer, _) = track("radius", 0.1);
    let turn = |(_, from, to): (usize, f64, f64), radius: f64| ((to - from) / radius).to_degrees();
    assert!((turn(curves[1], 4.1) - 90.0).abs() < 1e-6 && (turn(curves[0], 4.0) - 90.0).abs() < 1e-6);
    assert!((line.length - longer.length - 0.1 * (2.0 - trig::PI / 2.0)).abs() < 1e-6);
    // What one curve turns more, the next one turns less.
    let (curves, turned, _) = track("heading", 0.01);
    let more = [1, 2].map(|k| turn(curves[k], 4.0) - turn(planned[k], 4.0));
    assert!((more[0] - 0.01_f64.to_degrees()).abs() < 1e-6 && (more[0] + more[1]).abs() < 1e-6, "{more:?}");
    assert!(turned.closure.0 < 1e-6);
    // A transition begins half its length before the curve, and shifts its middle by a²/24R inwards, to the left.
    let (curves, _, deviations) = track("transition", 1.2);
    let rail = &deviations.rails[0];
    let at = |s: f64| rail[(s / line.length * rail.len() as f64).round() as usize];
    let (_, from, to) = curves[1];
    let shift = 1.2_f64 * 1.2 / (24.0 * 4.0);
    assert!((at(0.5 * (from + to)) - shift).abs() < 1e-9 && (at(from + 0.7) - shift).abs() < 1e-9);
    assert!(at(from - 0.7) == 0.0 && (at(from) - 0.5 * shift).abs() < 1e-4 && (at(to) - 0.5 * shift).abs() < 1e-4);
}

#[test]
fn items_on_all_carts_weigh_on_the_running_wheels() {
    let share = 0.2;
    let mass = share * nominal().cart.mass_kg;
    let (plain, loaded) =
        (ensemble_of(&nominal()), ensemble_of(&with("load_distribution", &[("mass", mass), ("on_sensor", 1.0)])));
    let weight = |f: &Ensemble| mean(f, 2) + mean(f, 3);
    let ratio = weight(&loaded) / weight(&plain);
    assert!((ratio - 1.0 - share).abs() < 0.01, "{ratio}");
}

#[test]
fn constants_follow_their_equations() {
    let (stiff, _) = deviations_of(&with("stiffness_temperature", &[("change", -0.25)])).expect("built");
    let plain = nominal();
    assert_eq!(stiff.joint.axial.stiffness_n_per_m_n, 0.75 * plain.joint.axial.stiffness_n_per_m_n);
    let compliance = 3e-7;
    let (bent, _) = deviations_of(&with("cart_bending", &[("compliance", compliance)])).expect("built");
    if plain.joint.radial.exponent == 1.0 {
        let series = 1.0 / (1.0 / plain.joint.radial.stiffness_n_per_m_n + compliance);
        assert!((bent.joint.radial.stiffness_n_per_m_n / series - 1.0).abs() < 1e-12);
    }
    let (_, weak) = deviations_of(&with("motor_imbalance", &[("loss", 0.4), ("motor", 2.0)])).expect("built");
    assert_eq!((weak.factor(0, 0.1), weak.factor(1, 0.1)), (1.0, 0.6));
    let (_, rippling) = deviations_of(&with("motor_ripple", &[("ratio", 0.1), ("wavelength", 0.4)])).expect("built");
    assert!((rippling.factor(0, 0.1) - 1.1).abs() < 1e-12);
    let (_, uneven) = deviations_of(&with("pitch_wear", &[("deviation", 1e-4)])).expect("built");
    assert!(uneven.pitch.iter().all(|x| x.abs() <= 1e-4) && uneven.pitch.iter().any(|x| x.abs() > 5e-5));
}

/// Bit for bit, so that a layout with one sine does what it did before there were harmonics.
#[test]
fn a_ripple_without_harmonics_is_one_sine() {
    let given = [("ratio", 0.17), ("wavelength", 0.23), ("phase", 0.9)];
    let (_, one) = deviations_of(&with("motor_ripple", &given)).expect("built");
    let (_, second) =
        deviations_of(&with("motor_ripple", &[("twice", 0.17), ("wavelength", 0.46), ("twice_phase", 0.9)]))
            .expect("built");
    for k in 0..500 {
        let ahead = 0.004 * f64::from(k);
        assert_eq!(one.factor(0, ahead), 1.0 * (1.0 + 0.17 * trig::sin(trig::TAU * ahead / 0.23 + 0.9)));
        // A second harmonic alone is the fundamental of half the pitch.
        assert!((second.factor(0, ahead) - one.factor(0, ahead)).abs() < 1e-12, "{ahead}");
    }
    let three = [("ratio", 0.1), ("twice", 0.06), ("thrice", 0.03), ("wavelength", 0.4), ("thrice_phase", trig::PI)];
    let (_, rippling) = deviations_of(&with("motor_ripple", &three)).expect("built");
    // Over an eighth of the pitch the sines are √½, 1 and √½, the last of which is turned round.
    assert!((rippling.factor(0, 0.05) - (1.0 + 0.07 * 0.5_f64.sqrt() + 0.06)).abs() < 1e-12);
    let mean = (0..1000).map(|k| rippling.factor(0, 0.4 * f64::from(k) / 1000.0)).sum::<f64>() / 1000.0;
    assert!((mean - 1.0).abs() < 1e-12, "{mean}");
}

#[test]
fn stiffness_comes_up_in_a_run() {
    let channel = |simulation: &Simulation, laps: usize| {
        let plan = crate::dynamics::Plan { settle: 8.0, laps, ..Default::default() };
        let outcome = simulate(simulation, &plan, Width::widest(), &mut |_| true).expect("a chain");
        outcome.run.channels[&crate::signal::Channel::FORCES[4]].clone()
    };
    let (change, after) = (-0.6, 4.0);
    let soft = |after: f64| with("stiffness_temperature", &[("change", change), ("after", after)]);
    let [plain, warm, constant] = [nominal(), soft(after), soft(0.0)].map(|simulation| channel(&simulation, 1));
    assert_eq!(warm[0], plain[0]);
    // Polygon action is in proportion to the stiffness. Straights and curves are as at the end in the lap's last quarter.
    let swings = |force: &[f64]| {
        let end = &force[3 * force.len() / 4..];
        let mean = end.iter().sum::<f64>() / end.len() as f64;
        (end.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / end.len() as f64).sqrt()
    };
    let [plain, warm, constant] = [plain, warm, constant].map(|force| swings(&force));
    assert!((warm / constant - 1.0).abs() < 0.15 && plain / constant > 1.4, "{plain} {warm} {constant}");
    let evened = stiffness_temperature::at_rest(&soft(after).effects, |warming| warming.share(after));
    let expected = change * (1.0 - trig::exp(-1.0));
    assert_eq!(evened, with("stiffness_temperature", &[("change", expected)]).effects);
}

#[test]
fn sensors_say_what_their_equations_say() {
    let plain = sensed(&nominal());
    let gained = sensed(&with("sensor_gain", &[("gain", 0.1), ("channel", 5.0)]));
    assert!(gained[4].iter().zip(&plain[4]).all(|(a, b)| (a - 1.1 * b).abs() < 1e-12));
    assert_eq!(gained[3], plain[3]);
    let drifting = sensed(&with("sensor_bias_drift", &[("offset", 2.0), ("drift", 3.0), ("channel", 1.0)]));
    assert!((drifting[0][100] - plain[0][100] - 2.0 - 3.0).abs() < 1e-12, "at 1 s");
    let other = sensed(&with("sensor_crosstalk", &[("ratio", 0.1), ("first", 4.0), ("second", 2.0)]));
    assert!((other[1][7] - plain[1][7] - 0.1 * plain[3][7]).abs() < 1e-12);
    let late = sensed(&with("sensor_lag", &[("delay", 0.055), ("channel", 3.0)]));
    assert!((late[2][150] - 200.0 - trig::sin(1.5 - 0.055)).abs() < 2e-5, "{}", late[2][150]);
    // Lags in a row: n times the phase and the attenuation of one.
    for order in [1, 2, 4] {
        let given = [("delay", 0.15), ("channel", 3.0), ("order", f64::from(order))];
        let smoothed = sensed(&with("sensor_lag", &given));
        let one = 0.15 / f64::from(order);
        let phase = f64::from(order) * trig::atan2(one, 1.0);
        let size = (0..order).map(|_| 1.0 / (1.0 + one * one).sqrt()).product::<f64>();
        let off = smoothed[2][190] - 200.0 - size * trig::sin(1.9 - phase);
        // Each takes the force as straight between samples, which is h²/12 less of a sine.
        assert!(off.abs() < 1e-5 * f64::from(order), "{order}: {off}");
    }
    let clipped = sensed(&with("sensor_clipping", &[("loss", 0.5), ("channel", 2.0)]));
    assert!(clipped[1].iter().all(|x| (x - 50.5).abs() < 1e-12));
    let swapped = sensed(&with("sensor_swapped", &[("share", 1.0), ("first", 1.0), ("second", 6.0)]));
    assert_eq!((&swapped[0], &swapped[5]), (&plain[5], &plain[0]));
}

#[test]
fn what_there_is_not_is_refused_with_a_way_out() {
    for (name, strengths, place, why) in [
        ("gremlins", &[][..], "effects.0.name", "there is no effect `gremlins`; the nearest first, there are "),
        (
            "wheel_slip",
            &[],
            "effects.0.name",
            "there is no effect `wheel_slip`; the nearest first, there are wheel_sliding",
        ),
        ("joint_clearance", &[("gaps", 1e-4)], "effects.0.strengths.gaps", "`joint_clearance` has gap"),
        ("joint_clearance", &[("gap", -1.0)], "effects.0.strengths.gap", "-1 must be between 0 and 0.002 m"),
        ("sensor_gain", &[("channel", f64::NAN)], "effects.0.strengths.channel", "`sensor_gain` has gain, channel"),
    ] {
        let refused = deviations_of(&with(name, strengths)).expect_err("refused");
        assert_eq!(refused.place, place);
        assert!(refused.why.starts_with(why), "{}", refused.why);
    }
}

#[test]
fn names_are_unique_and_sites_are_known() {
    let mut names: Vec<&str> = LIBRARY.iter().map(|e| e.name()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), LIBRARY.len());
    for effect in LIBRARY {
        assert!(named(effect.name()).is_some());
        let places = effect.definition.places;
        let listed = match effect.sites {
            Sites::Listed(listed) => listed(&nominal()),
            Sites::Suspected => Vec::new(),
        };
        for site in listed {
            assert!(site.fixed.iter().all(|(n, _)| places.iter().any(|p| p.name == *n)), "{}", effect.name());
        }
        assert_eq!(effect.fitted.len(), effect.definition.strengths.len(), "{}", effect.name());
        let with_nothing = |s: &StrengthDefinition| s.low <= 0.0 || effect.name() == "sensor_swapped";
        assert!(effect.strengths().all(|(s, fitted)| with_nothing(s) && fitted.trial <= s.high), "{}", effect.name());
    }
}

#[test]
fn a_chain_is_not_made_of_an_input_whose_effects_are_forgotten() {
    let input = with("joint_clearance", &[("gap", 1e-4)]);
    let Err(refused) = crate::dynamics::Model::new(&input, Deviations::default()) else { panic!("not refused") };
    assert_eq!(refused.place, "effects");
    assert!(model(&input).is_ok());
}

#[test]
fn every_effect_that_a_layout_may_name_stands_in_the_library() {
    let of = |effects: &[&Effect]| effects.iter().map(|e| e.name()).collect::<Vec<_>>();
    let defined = |effects: &[&EffectDefinition]| effects.iter().map(|e| e.name).collect::<Vec<_>>();
    assert_eq!(of(&LIBRARY), defined(&effect_definitions::EFFECTS));
    assert_eq!(of(&AS_BUILT), defined(&effect_definitions::AS_BUILT));
}

#[test]
fn rails_are_as_wavy_as_they_say() {
    let (_, deviations) = deviations_of(&with("rail_waviness", &[("amplitude", 2e-5), ("draw", 3.0)])).expect("built");
    for rail in &deviations.rails {
        let square = rail.iter().map(|x| x * x).sum::<f64>() / rail.len() as f64;
        assert!((square.sqrt() / 2e-5 - 1.0).abs() < 0.2, "{}", square.sqrt());
    }
    let (_, other) = deviations_of(&with("rail_waviness", &[("amplitude", 2e-5), ("draw", 4.0)])).expect("built");
    assert!(other.rails != deviations.rails && deviations.rails[0] != deviations.rails[1]);
}

#[test]
fn a_track_sags_as_its_spans_are_held() {
    let span = |shape: f64| {
        let (plain, deviations) =
            deviations_of(&with("track_flexibility", &[("compliance", 1e-6), ("span", 4.0), ("shape", shape)]))
                .expect("built");
        let rail = &deviations.rails[1];
        let lap = plain.track.centre_line().length;
        let length = lap / (lap / 4.0).round();
        let at = |share: f64| rail[(share * length / lap * rail.len() as f64).round() as usize];
        let most = 1e-6 * plain.cart.mass_kg * plain.gravity_m_s2;
        [0.0, 0.25, 0.5].map(|share| -at(share) / most)
    };
    let near = |found: [f64; 3], wanted: [f64; 3]| {
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 0.02), "{found:?} {wanted:?}");
    };
    near(span(0.0), [0.0, 0.5, 1.0]);
    near(span(1.0), [0.0, 0.5_f64.sqrt(), 1.0]);
}

#[test]
fn only_the_carts_beside_the_sensors_that_are_said_carry_items() {
    let beside = [(0.0, false, false), (2.0, true, false), (3.0, false, true), (4.0, true, true)];
    let own_too = [(5.0, false, false), (6.0, true, false), (7.0, false, true), (8.0, true, true)];
    for (on, before, after) in beside.into_iter().chain(own_too) {
        for sensor in [1, 2, nominal().chain.carts] {
            let mut simulation = with("load_distribution", &[("mass", 1.0), ("on_sensor", on)]);
            simulation.sensor.cart = sensor;
            let load = deviations_of(&simulation).expect("built").1.load;
            let (n, own) = (load.len(), sensor - 1);
            let loaded = |k: usize| load[k % n] > 0.0;
            let found = (loaded(own + n - 1), loaded(own), loaded(own + 1));
            assert_eq!(found, (before, on > 4.0, after), "{on} {sensor}");
        }
    }
}

/// By Coulomb's friction μ m g at a height h below the joints, wheels 2 b apart differ by μ m g h/b wherever a cart is a
/// chord: in the curves and for its own length behind them.
#[test]
fn wheels_that_slide_below_the_joints_tilt_the_cart() {
    const FRICTION: f64 = 0.05;
    let tilt = |height: f64| {
        let of = |friction: f64| {
            let mut simulation = with("wheel_sliding", &[("friction", friction), ("held", 1.0)]);
            simulation.running_wheel.height_m = height;
            let ensemble = ensemble_of(&simulation);
            mean(&ensemble, 2) - mean(&ensemble, 3)
        };
        of(FRICTION) - of(0.0)
    };
    let nominal = nominal();
    let line = nominal.track.centre_line();
    let curves = sites::curves(&nominal);
    let turning: f64 = curves.iter().map(|(_, from, to)| to - from + nominal.cart.length_m).sum::<f64>() / line.length;
    let weight = nominal.cart.mass_kg * nominal.gravity_m_s2;
    for height in [0.0, 0.08, 0.16] {
        let expected = FRICTION * weight * height / nominal.running_wheel.half_spacing_m * turning;
        let found = tilt(height);
        assert!((found - expected).abs() < 0.1 * expected + 0.1, "{height} m: {found} N for {expected} N");
    }
}

/// A chain under tension T that weighs m/l pulls into curves with (T − m v²/l)/R times its length, whatever the guides; where
/// they give way it goes a shorter way, and the tension falls.
#[test]
fn guides_that_give_way_slacken_the_chain_and_carry_what_it_pulls() {
    let of = |guides: f64| {
        let ensemble = ensemble_of(&with("track_flexibility", &[("guides", guides), ("span", 2.0)]));
        let nominal = nominal();
        let (cart, speed) = (&nominal.cart, nominal.chain.speed_m_s);
        let pull = mean(&ensemble, 4) - cart.mass_kg / cart.length_m * speed * speed;
        ((mean(&ensemble, 0) - mean(&ensemble, 1)) / pull, pull)
    };
    let [stiff, soft, softer] = [0.0, 1e-6, 4e-6].map(of);
    for given in [soft, softer] {
        assert!((given.0 / stiff.0 - 1.0).abs() < 0.02, "{stiff:?} {soft:?} {softer:?}");
    }
    assert!(soft.1 < 0.97 * stiff.1 && softer.1 < 0.9 * soft.1, "{stiff:?} {soft:?} {softer:?}");
}

#[test]
fn wheels_of_one_side_and_of_some_carts_are_worn_alone() {
    let deviations = |given: &[(&str, f64)]| deviations_of(&with("wheel_out_of_round", given)).expect("built").1;
    let left = deviations(&[("amplitude", 1e-4), ("wheel", 4.0)]);
    let all: Vec<f64> = (0..40).map(|k| left.steered(1e-3, 0, 0.01 * f64::from(k), 0.04).0).collect();
    // A larger wheel meets its rail sooner, as if the rail were nearer; the other wheel is round.
    assert!(all.iter().any(|x| *x < -0.9e-4) && all.iter().all(|x| x.abs() < 1.01e-4));
    assert_eq!(left.steered(-1e-3, 0, 0.1, 0.04), (0.0, 0.0));
    let some = deviations(&[("amplitude", 1e-4), ("wheel", 2.0), ("every", 3.0)]);
    let sensor = nominal().sensor.cart - 1;
    for cart in 0..9 {
        let worn = (0..40).any(|k| some.offset(1, cart, 0.01 * f64::from(k), 60.0, 0.06).0 != 0.0);
        assert_eq!(worn, cart.abs_diff(sensor).is_multiple_of(3), "{cart}");
    }
    // Of two worn wheels each has its own carts.
    let mut two = with("wheel_out_of_round", &[("amplitude", 1e-4), ("wheel", 2.0), ("every", 3.0)]);
    two.effects.extend(with("wheel_out_of_round", &[("amplitude", 1e-4), ("wheel", 3.0)]).effects);
    let two = deviations_of(&two).expect("built").1;
    let beside = |wheel: usize| two.offset(wheel, sensor + 1, 0.1, 60.0, 0.06).0;
    assert!(beside(1) == 0.0 && beside(2) != 0.0);
    // Waves twice a turn repeat after half a turn.
    let wavy = deviations(&[("amplitude", 0.0), ("twice", 1e-4), ("wheel", 3.0)]);
    let half = trig::PI * 0.06;
    let [a, b] = [0.05, 0.05 + half].map(|s| wavy.offset(2, 0, s, 60.0, 0.06).0);
    assert!((a - b).abs() < 1e-7 && a != 0.0, "{a} {b}");
}
