//! The chain against what is known of it: an independent implementation's converged values, closed forms, conservation
//! laws, and itself with other steps, integrators and vector widths (design: chain model, checks with a known answer).

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::chain_input::{CentreLinePiece, Simulation, Track};
use lss::dynamics::integrate::{CashKarp, Integrator, Verlet};
use lss::dynamics::{Chain, End, EnsemblePlan, Method, PACK, Plan, TroubleKind, Width, parameters};
use lss::effects::{self, run_ensemble, simulate, simulate_all};
use lss::signal::Channel;
use lss::solve::Stop;
use std::path::Path;
use std::sync::Arc;

/// An input as `lss build` writes it: those of the examples are snapshots of other tests.
fn input(example: &str) -> Simulation {
    let path = format!("tests/cases/{example}/5-simulation.snap");
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("a snapshot");
    let json = text.splitn(3, "---\n").nth(2).expect("a header and a body");
    serde_json::from_str(json).expect("a simulation input")
}

fn with(simulation: &Simulation, changes: &[(&str, f64)]) -> Simulation {
    let changes: Vec<(String, String)> = changes.iter().map(|(k, v)| ((*k).to_owned(), v.to_string())).collect();
    parameters::set(simulation, &changes).expect("parameters")
}

/// No losses: restitution 1 everywhere, no rolling resistance, motors off.
fn lossless(simulation: &Simulation) -> Simulation {
    with(
        simulation,
        &[
            ("steering_wheel.contact.restitution", 1.0),
            ("running_wheel.contact.restitution", 1.0),
            ("joint.axial.restitution", 1.0),
            ("joint.radial.restitution", 1.0),
            ("steering_wheel.rolling_resistance", 0.0),
            ("running_wheel.rolling_resistance", 0.0),
            ("motors.force_n", 0.0),
        ],
    )
}

/// The reference chain on a circle of `radius`, with as many carts as close there.
fn circle(radius: f64) -> Simulation {
    let mut simulation = input("reference");
    let elements = vec![CentreLinePiece::Arc { radius, turn_deg: 360.0 }];
    simulation.track = Track { name: "circle".into(), start: [0.0; 4], elements };
    simulation.motors.s_m.clear();
    with(&simulation, &[("cart.length_m", 1.25)])
}

fn chain(simulation: &Simulation, front: f64) -> Chain {
    Chain::new(Arc::new(effects::model(simulation).expect("fit")), front, Width::widest()).expect("closes")
}

/// Runs with the controller, in its periods.
fn run(chain: &mut Chain, integrator: &mut dyn Integrator, periods: usize, mut look: impl FnMut(&Chain)) {
    for _ in 0..periods {
        chain.sample_control();
        integrator.advance(chain, chain.model.controller.period).expect("steps");
        assert!(!chain.forces.trouble, "at {} s", chain.time);
        look(chain);
    }
}

/// The page's table, to two units of the last digit printed.
#[test]
fn converged_values_of_an_independent_implementation() {
    let mut chain = chain(&input("reference"), 10.0);
    assert_eq!(chain.model.carts, 171);
    assert!((chain.model.cart.length - 1.249_891_635).abs() < 2e-9, "{}", chain.model.cart.length);
    assert!((chain.closing_pitch - 1.250_006_210).abs() < 2e-9, "{}", chain.closing_pitch);
    // Time, mean tension, chain speed, command, joint_xi, joint_zeta and run_left of cart 1, and their last digits.
    let table = [
        (10, [402.500, 1.98628, 5.622, 305.64, -129.06, 201.807], [1e-3, 1e-5, 1e-3, 1e-2, 1e-2, 1e-3]),
        (30, [445.428, 1.95887, 17.723, 416.72, -127.91, 201.11], [1e-3, 1e-5, 1e-3, 1e-2, 1e-2, 1e-2]),
        (50, [383.180, 1.93608, 28.979, 305.40, -128.41, 201.09], [1e-3, 1e-5, 1e-3, 1e-2, 1e-2, 1e-2]),
        (100, [437.082, 1.89588, 53.683, 524.53, -128.20, 201.10], [1e-3, 1e-5, 1e-3, 1e-2, 1e-2, 1e-2]),
    ];
    let mut verlet = Verlet::new(0.05e-3);
    let mut period = 0;
    run(&mut chain, &mut verlet, 100, |chain| {
        period += 1;
        let Some((_, expected, digits)) = table.iter().find(|row| row.0 == period) else { return };
        let last = chain.model.carts - 1;
        let joint = &chain.forces.loads[last / PACK].joint;
        let got = [
            chain.forces.mean_tension(chain.model.carts),
            chain.control.speed,
            chain.control.command,
            -joint[0][last % PACK],
            -joint[2][last % PACK],
            chain.forces.loads[0].running[0][0],
        ];
        for ((got, expected), digit) in got.iter().zip(expected).zip(digits) {
            assert!((got - expected).abs() <= 2.0 * digit, "{} s: {got} {expected}", chain.time);
        }
    });
}

/// Behind the last cart a pack holds idle places, which no motor pushes.
#[test]
fn places_behind_the_last_cart_rest() {
    let simulation = input("reference");
    // The first cart passes a motor's begin, so that it has more motors behind it than where it started.
    let begin = chain(&simulation, 0.0).model.motors.s[0];
    let mut chain = chain(&simulation, begin - 0.1);
    let used = chain.model.carts % PACK;
    assert!(used > 0);
    let idle = |chain: &Chain| {
        chain.state.bodies.last().map(|last| last.position.map(|row| row[used..].to_vec())).expect("a pack")
    };
    let before = idle(&chain);
    run(&mut chain, &mut Verlet::new(0.5e-3), 100, |_| {});
    assert_eq!(idle(&chain), before);
}

/// The same bits with one number at a time and with the widest vectors, on every kind of piece.
#[test]
fn every_width_computes_the_same_bits() {
    for name in ["reference", "levels", "spiral"] {
        let model = Arc::new(effects::model(&input(name)).expect("fit"));
        let run = |width: Width| {
            let mut chain = Chain::new(model.clone(), 3.0, width).expect("closes");
            run(&mut chain, &mut Verlet::new(0.5e-3), 60, |_| {});
            chain
        };
        let widths = Width::all();
        let first = run(widths[0]);
        for width in &widths[1..] {
            let other = run(*width);
            assert!(first.state == other.state, "{name}: {width} differs from {}", widths[0]);
            assert!(first.memory == other.memory && first.accelerations == other.accelerations, "{name}: {width}");
        }
    }
}

/// Energy of an elastic chain drifts with the square of the step: about 1e-6 of the kinetic energy at 0.25 ms.
#[test]
fn energy_is_conserved_to_second_order() {
    let simulation = lossless(&input("reference"));
    let drift = |step: f64| {
        let mut chain = chain(&simulation, 0.0);
        let energy = |chain: &Chain| chain.kinetic_energy() + chain.potential_energy();
        let (begin, kinetic) = (energy(&chain), chain.kinetic_energy());
        let mut worst: f64 = 0.0;
        run(&mut chain, &mut Verlet::new(step), 40, |chain| worst = worst.max((energy(chain) - begin).abs()));
        worst / kinetic
    };
    let (coarse, fine) = (drift(0.5e-3), drift(0.25e-3));
    assert!(fine < 3e-6, "{fine}");
    assert!((2.5..6.5).contains(&(coarse / fine)), "{coarse} {fine}");
}

/// The error at a fixed time falls with the square of the step.
#[test]
fn verlet_is_of_second_order() {
    let simulation = input("reference");
    let at = |step: f64| {
        let mut chain = chain(&simulation, 0.0);
        run(&mut chain, &mut Verlet::new(step), 5, |_| {});
        let bodies = chain.state.bodies;
        move |i: usize| bodies[i / PACK].position.map(|row| row[i % PACK])
    };
    let exact = at(0.02e-3);
    let error = |step: f64| {
        let other = at(step);
        let square = |i: usize| -> f64 { other(i).iter().zip(exact(i)).map(|(a, b)| (a - b) * (a - b)).sum() };
        (0..171).map(square).sum::<f64>().sqrt()
    };
    let (coarse, fine) = (error(0.4e-3), error(0.2e-3));
    assert!((3.0..5.5).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn cash_karp_agrees_with_fine_verlet() {
    let simulation = input("levels");
    let position = |integrator: &mut dyn Integrator| {
        let mut chain = chain(&simulation, 0.0);
        run(&mut chain, integrator, 10, |_| {});
        chain.state.bodies.iter().flat_map(|b| b.position.as_flattened().to_vec()).collect::<Vec<f64>>()
    };
    let (adaptive, fine) = (position(&mut CashKarp::new(1e-6)), position(&mut Verlet::new(0.02e-3)));
    let worst = adaptive.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 2e-7, "{worst}");
}

/// Joints only: a chain in free fall keeps its horizontal momentum and its angular momentum about the vertical.
#[test]
fn joints_conserve_momentum() {
    let changes =
        [("steering_wheel.contact.stiffness_n_per_m_n", 1e-9), ("running_wheel.contact.stiffness_n_per_m_n", 1e-9)];
    let mut chain = chain(&with(&lossless(&input("reference")), &changes), 0.0);
    let moments = |chain: &Chain| {
        let (mut linear, mut angular) = ([0.0; 3], 0.0);
        for i in 0..chain.model.carts {
            let bodies = &chain.state.bodies[i / PACK];
            let [x, y, _] = bodies.position.map(|row| row[i % PACK]);
            let v = bodies.velocity.map(|row| row[i % PACK]);
            let [w, i0, j, k] = bodies.attitude.map(|row| row[i % PACK]);
            let spin = bodies.spin.map(|row| row[i % PACK]);
            let momentum: Vec<f64> = (0..3).map(|k| spin[k] * chain.model.cart.inertia[k]).collect();
            // The third row of the rotation matrix.
            let vertical = [2.0 * (i0 * k - w * j), 2.0 * (j * k + w * i0), 1.0 - 2.0 * (i0 * i0 + j * j)];
            let own: f64 = vertical.iter().zip(&momentum).map(|(r, l)| r * l).sum();
            for k in 0..3 {
                linear[k] += chain.model.cart.mass * v[k];
            }
            angular += chain.model.cart.mass * (x * v[1] - y * v[0]) + own;
        }
        (linear, angular)
    };
    let (linear, angular) = moments(&chain);
    let mut verlet = Verlet::new(0.1e-3);
    for _ in 0..5 {
        verlet.advance(&mut chain, 0.01).expect("steps");
    }
    let (after, turned) = moments(&chain);
    let mass = 171.0 * 41.0;
    assert!((after[0] - linear[0]).abs() < 1e-6 && (after[1] - linear[1]).abs() < 1e-6, "{linear:?} {after:?}");
    assert!((after[2] - linear[2] + mass * 9.81 * 0.05).abs() < 1e-6 * mass, "{after:?}");
    // The predictor leaves an error of second order.
    assert!((turned - angular).abs() < 1e-6 * angular.abs(), "{angular} {turned}");
}

/// On a circle every cart is steered with (T − μv²) L/R; it changes side at T = μv².
#[test]
fn steering_in_a_long_curve_is_the_closed_form() {
    let radius = 12.0;
    for speed in [2.0, 4.5] {
        let simulation = with(
            &circle(radius),
            &[
                ("chain.speed_m_s", speed),
                ("steering_wheel.rolling_resistance", 0.0),
                ("running_wheel.rolling_resistance", 0.0),
            ],
        );
        let mut chain = chain(&simulation, 0.0);
        let carts = chain.model.carts;
        let (mut steering, mut tension, mut count) = (0.0, 0.0, 0.0);
        let mut period = 0;
        run(&mut chain, &mut Verlet::bounded(0.5e-3), 500, |chain| {
            period += 1;
            if period > 300 {
                count += 1.0;
                tension += chain.forces.mean_tension(carts);
                steering +=
                    (0..carts).map(|i| chain.forces.loads[i / PACK].steering[i % PACK]).sum::<f64>() / carts as f64;
            }
        });
        let (steering, tension) = (steering / count, tension / count);
        let line_mass = 41.0 / chain.model.pitch;
        let expected = (tension - line_mass * speed * speed) * chain.model.pitch / radius;
        // A left curve pulls the chain inwards, onto the left wheel, while tension prevails.
        assert!(
            (steering - expected).abs() < 0.02 * expected.abs() + 0.3,
            "{speed}: {steering} {expected}, {tension} N"
        );
        assert_eq!(steering > 0.0, tension > line_mass * speed * speed, "{speed}");
    }
}

/// Long waves travel at L√(K/m) = 390 m/s: the ring's first mode on 214 m has 1.82 Hz.
#[test]
fn waves_travel_at_the_closed_form() {
    let mut chain = chain(&lossless(&circle(214.0 / std::f64::consts::TAU)), 0.0);
    let carts = chain.model.carts;
    let phase = |i: usize| std::f64::consts::TAU * i as f64 / carts as f64;
    for i in 0..carts {
        let bodies = &mut chain.state.bodies[i / PACK];
        let v = bodies.velocity.map(|row| row[i % PACK]);
        let factor = 1.0 + 0.01 * libm::cos(phase(i));
        for (row, v) in bodies.velocity.iter_mut().zip(v) {
            row[i % PACK] = v * factor;
        }
        bodies.spin[2][i % PACK] *= factor;
    }
    chain.evaluate(true);
    let mean = |chain: &Chain| -> f64 { (0..carts).map(|i| chain.forces.speed[i] * libm::cos(phase(i))).sum::<f64>() };
    let mut verlet = Verlet::new(0.25e-3);
    let mut crossings = Vec::new();
    let mut before = (0.0, mean(&chain));
    for _ in 0..110 {
        verlet.advance(&mut chain, 0.01).expect("steps");
        let now = (chain.time, mean(&chain));
        if before.1 * now.1 < 0.0 {
            crossings.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
        }
        before = now;
    }
    // Half a period apart; carts ride with the chain, so that nothing is shifted.
    let periods: Vec<f64> = crossings.windows(2).map(|w| 2.0 * (w[1] - w[0])).collect();
    let period = periods.iter().sum::<f64>() / periods.len() as f64;
    let speed = chain.model.pitch * (4e6f64 / 41.0).sqrt();
    assert!((speed - 390.0).abs() < 1.0);
    // On the circle the steering wheels give way by (L/R)²/k a cart, which adds 1.3 % to the joints' compliance.
    assert!((0.0..0.015).contains(&(period * speed / 214.0 - 1.0)), "{period} {crossings:?}");
}

/// Over a rise Δh the tension grows by μ g Δh.
#[test]
fn tension_grows_with_height() {
    let mut chain = chain(&lossless(&input("levels")), 0.0);
    let carts = chain.model.carts;
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    run(&mut chain, &mut Verlet::bounded(0.5e-3), 400, |chain| {
        for i in 0..carts {
            let z = chain.state.bodies[i / PACK].position[2][i % PACK] - chain.model.cart.centre[1];
            let tension = -chain.forces.loads[i / PACK].joint[0][i % PACK];
            for (k, level) in [1.0, 2.6].into_iter().enumerate() {
                if (z - level).abs() < 0.01 {
                    sums[k] += tension;
                    counts[k] += 1.0;
                }
            }
        }
    });
    let step = sums[1] / counts[1] - sums[0] / counts[0];
    let expected = 41.0 / chain.model.pitch * 9.81 * 1.6;
    assert!((step - expected).abs() < 0.03 * expected, "{step} {expected}");
}

/// In steady running the motors' thrust is the rolling resistance, about 1.1 kN.
#[test]
fn thrust_is_rolling_resistance() {
    let mut chain = chain(&input("reference"), 0.0);
    let carts = chain.model.carts;
    let (mut thrust, mut drag, mut momentum, mut count, mut period) = (0.0, 0.0, [0.0; 2], 0.0, 0);
    run(&mut chain, &mut Verlet::bounded(1e-3), 3000, |chain| {
        period += 1;
        if period <= 2000 {
            momentum[0] = chain.forces.mean_speed(carts);
            return;
        }
        momentum[1] = chain.forces.mean_speed(carts);
        count += 1.0;
        thrust += chain.control.command * chain.forces.share[..carts].iter().sum::<f64>();
        drag += (0..carts)
            .map(|i| {
                let (loads, lane) = (&chain.forces.loads[i / PACK], i % PACK);
                0.015 * (loads.steering[lane].abs() + loads.running[0][lane].abs() + loads.running[1][lane].abs())
            })
            .sum::<f64>();
    });
    let (thrust, drag) = (thrust / count, drag / count);
    // What is left over still speeds the chain up.
    let speeding = 171.0 * 41.0 * (momentum[1] - momentum[0]) / (count * 0.01);
    assert!((thrust - drag - speeding).abs() < 0.01 * drag, "{thrust} {drag} {speeding}");
    assert!((1050.0..1150.0).contains(&drag), "{drag}");
}

/// A lap of an example's small chain is recorded whole, with the trigger once, and the supports carry its weight.
#[test]
fn a_lap_is_recorded_with_its_reactions() {
    let simulation = with(&input("smallest"), &[("supports_every_m", 2.5), ("chain.tension_n", 300.0)]);
    let plan = Plan { settle: 2.0, supports: true, ..Plan::default() };
    let outcome = simulate(&simulation, &plan, Width::widest(), &mut |_| true).expect("fit");
    assert_eq!(outcome.end, End::Complete);
    let trigger = &outcome.run.channels[&lss::signal::Channel::Trigger];
    assert_eq!(outcome.run.channels.len(), 15);
    let rises = trigger.windows(2).filter(|w| w[0] < 0.5 && w[1] > 0.5).count();
    assert!(rises == 1 || trigger[0] == 1.0, "{rises}");
    let lap = outcome.track / simulation.chain.speed_m_s;
    assert!((outcome.run.duration() / lap - 1.0).abs() < 0.2, "{} {lap}", outcome.run.duration());
    assert_eq!(outcome.supports.len(), (outcome.track / 2.5).ceil() as usize);
    let (low, high) = outcome.supports.iter().fold((0.0, 0.0), |(l, h), s| (l + s.vertical.0, h + s.vertical.1));
    let weight = outcome.carts as f64 * 41.0 * 9.81;
    assert!(low < weight && weight < high, "{low} {weight} {high}");
}

#[test]
fn trouble_says_when_which_cart_and_where() {
    let simulation = with(&input("reference"), &[("chain.tension_n", 2000.0)]);
    let plan = Plan { settle: 0.0, step: Some(2e-3), ..Plan::default() };
    let outcome = simulate(&simulation, &plan, Width::widest(), &mut |_| true).expect("fit");
    let End::Trouble(trouble) = outcome.end else { panic!("{:?}", outcome.end) };
    assert!(matches!(trouble.kind, TroubleKind::Broken | TroubleKind::OffRail | TroubleKind::NotANumber));
    assert!(trouble.advice().contains("--step"), "{}", trouble.advice());
    assert!((1..=171).contains(&trouble.cart) && trouble.time > 0.0);
    assert_eq!(outcome.run.time.len(), outcome.run.channels[&lss::signal::Channel::JointXi].len());
}

#[test]
fn an_interrupted_run_keeps_what_it_has() {
    let plan = Plan { settle: 0.1, ..Plan::default() };
    let watch = &mut |p: lss::dynamics::Progress| p.time < 0.5;
    let outcome = simulate(&input("smallest"), &plan, Width::widest(), watch).expect("fit");
    assert_eq!(outcome.end, End::Interrupted);
    assert!((0.3..0.6).contains(&outcome.run.duration()), "{}", outcome.run.duration());
}

#[test]
fn many_at_once_are_as_one_by_one() {
    let plan = Plan { settle: 0.2, ..Plan::default() };
    let inputs: Vec<(Simulation, Plan)> = [200.0, 300.0, 400.0]
        .map(|tension| (with(&input("smallest"), &[("chain.tension_n", tension)]), plan.clone()))
        .to_vec();
    let all = simulate_all(&inputs, Width::widest(), 3);
    for ((simulation, plan), together) in inputs.iter().zip(&all) {
        let alone = simulate(simulation, plan, Width::widest(), &mut |_| true).expect("fit");
        assert_eq!(alone.run, together.as_ref().expect("fit").run);
    }
}

#[test]
fn numbers_that_no_chain_can_have_are_refused() {
    let cases = [
        ("cart.mass_kg", 0.0),
        ("joint.axial.restitution", 0.0),
        ("sensor.cart", 1e5),
        ("chain.carts", 2.0),
        ("track.elements.0.length", -1.0),
        ("controller.period_s", 0.0),
        ("sensor.lowpass_hz", 1e5),
        ("chain.speed_m_s", 0.0),
        ("chain.speed_m_s", 1e-6),
    ];
    for (name, value) in cases {
        let changed = parameters::set(&input("smallest"), &[(name.into(), value.to_string())]).expect("a name");
        let refused = simulate(&changed, &Plan::default(), Width::widest(), &mut |_| false);
        assert!(refused.is_err(), "{name} = {value}");
    }
    let unknown = parameters::set(&input("smallest"), &[("cart.mas_kg".into(), "1".into())]).unwrap_err();
    assert!(unknown.why.contains("cart.mass_kg"), "{unknown}");
}

/// Without the integral part an ensemble starts as a simulation does, and its carts measure what a sensor cart does.
#[test]
fn every_cart_of_a_survey_is_a_sensor_cart() {
    let simulation = with(&input("levels"), &[("controller.integral_n_per_m", 0.0)]);
    let plan =
        EnsemblePlan { settle: 0.2, duration: 0.8, step: None, method: Method::Verlet, front: 0.4, stop: Stop::NEVER };
    let ensemble = run_ensemble(&simulation, &plan, None, Width::widest()).expect("fit");
    assert_eq!((ensemble.carts.len(), ensemble.trouble), (120, None));
    for cart in [1, 2, 77] {
        let own = with(&simulation, &[("sensor.cart", f64::from(cart))]);
        let plan = Plan { settle: 0.2, front: 0.4, ..Plan::default() };
        let run = simulate(&own, &plan, Width::widest(), &mut |p| p.time < 1.2).expect("fit").run;
        let record = &ensemble.carts[cart as usize - 1];
        for (channel, force) in Channel::FORCES.iter().zip(&record.forces) {
            assert_eq!(force.len(), 400);
            let expected: Vec<f32> = run.channels[channel][..400].iter().map(|x| *x as f32).collect();
            assert_eq!(force, &expected, "{} of cart {cart}", channel.name());
        }
    }
    // From where it ended, at another speed, it goes on without a jolt.
    let faster = with(&simulation, &[("chain.speed_m_s", 2.02)]);
    let on = run_ensemble(
        &faster,
        &EnsemblePlan { settle: 0.0, duration: 0.5, ..plan },
        Some(&ensemble.settled),
        Width::widest(),
    );
    let speeds = on.expect("fit").carts.into_iter().flat_map(|cart| cart.speed);
    assert!(speeds.into_iter().all(|v| (1.85..2.15).contains(&v)));
}

/// A joint breaks at 20 mm of F = K δⁿ, whatever n: what stops a run and what names the cart are one law.
#[test]
fn a_joint_breaks_at_one_elongation_whatever_its_exponent() {
    for exponent in [1.0, 1.5] {
        let plain = with(&input("reference"), &[("joint.axial.exponent", exponent)]);
        let stiffness = plain.joint.axial.stiffness_n_per_m_n;
        let at = |elongation: f64| stiffness * lss::base::trig::pow(elongation, exponent);
        for (elongation, breaks) in [(0.012, false), (0.032, true)] {
            let chain = chain(&with(&plain, &[("chain.tension_n", at(elongation))]), 10.0);
            let named = (0..chain.model.carts).any(|i| chain.forces.troubled(&chain.model, i).is_some());
            assert_eq!((chain.forces.trouble, named), (breaks, breaks), "n = {exponent}, {elongation} m");
        }
    }
}
