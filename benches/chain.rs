//! The chain's speed as ratios in one run: simulated seconds a wall second of each vector width, against rapier,
//! against the number of carts, and over threads; and what larger steps cost in accuracy.
//!
//! The rival: rapier (f64) moves the same carts, with the same forces set from outside before every step; they are
//! evaluated by the widest kernel of this program, so that rapier is only charged for its own part and the copying.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::chain_input::{CentreLinePiece, Simulation, Track};
use lss::dynamics::integrate::{Integrator, Verlet};
use lss::dynamics::{Chain, PACK, Plan, Width, parameters};
use lss::effects::{self, simulate, simulate_all};
use lss::signal::Channel;
use lss::signal::measures::{rmsd, statistics};
use rapier3d_f64::prelude::*;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

fn reference() -> Simulation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/reference/5-simulation.snap");
    let text = std::fs::read_to_string(path).expect("a snapshot");
    serde_json::from_str(text.splitn(3, "---\n").nth(2).expect("a body")).expect("a simulation input")
}

/// Simulated seconds a wall second, the chain settled.
fn ratio(chain: &mut Chain, integrator: &mut dyn Integrator, seconds: f64) -> f64 {
    let clock = Instant::now();
    for _ in 0..(seconds / 0.01) as usize {
        chain.sample_control();
        integrator.advance(chain, 0.01).expect("steps");
    }
    assert!(!chain.forces.trouble);
    seconds / clock.elapsed().as_secs_f64()
}

fn chain(simulation: &Simulation, width: Width) -> Chain {
    let model = Arc::new(effects::model(simulation).expect("fit"));
    let mut chain = Chain::new(model, 0.0, width).expect("closes");
    ratio(&mut chain, &mut Verlet::bounded(1e-3), 1.0);
    chain
}

/// The same carts as rigid bodies of rapier.
struct Rival {
    world: PhysicsWorld,
    handles: Vec<RigidBodyHandle>,
    chain: Chain,
}

impl Rival {
    fn new(chain: Chain, step: f64) -> Self {
        let mut world = PhysicsWorld { gravity: Vector::ZERO, ..PhysicsWorld::default() };
        world.integration_parameters.dt = step;
        // There are no constraints to iterate over.
        world.integration_parameters.num_solver_iterations = 1;
        let [ix, iy, iz] = chain.model.cart.inertia;
        let mut handles = Vec::new();
        for i in 0..chain.model.carts {
            let bodies = &chain.state.bodies[i / PACK];
            let row = |rows: &[[f64; PACK]; 3]| Vector::new(rows[0][i % PACK], rows[1][i % PACK], rows[2][i % PACK]);
            let [w, x, y, z] = bodies.attitude.map(|r| r[i % PACK]);
            let rotation = Rotation::from_xyzw(x, y, z, w);
            let mass = MassProperties::new(Vector::ZERO, chain.model.cart.mass, AngVector::new(ix, iy, iz));
            let mut body = RigidBodyBuilder::dynamic()
                .translation(row(&bodies.position))
                .linvel(row(&bodies.velocity))
                .angvel(rotation * row(&bodies.spin))
                .additional_mass_properties(mass)
                .gyroscopic_forces_enabled(true)
                .can_sleep(false)
                .build();
            body.set_rotation(rotation, true);
            handles.push(world.bodies.insert(body));
        }
        Rival { world, handles, chain }
    }

    fn step(&mut self) {
        let cart = self.chain.model.cart;
        for (i, handle) in self.handles.iter().enumerate() {
            let body = &self.world.bodies[*handle];
            let (p, v, q) = (body.translation(), body.linvel(), *body.rotation());
            let spin = q.inverse() * body.angvel();
            let bodies = &mut self.chain.state.bodies[i / PACK];
            for (k, (p, (v, s))) in
                [p.x, p.y, p.z].into_iter().zip([v.x, v.y, v.z].into_iter().zip([spin.x, spin.y, spin.z])).enumerate()
            {
                bodies.position[k][i % PACK] = p;
                bodies.velocity[k][i % PACK] = v;
                bodies.spin[k][i % PACK] = s;
            }
            for (k, value) in [q.w, q.x, q.y, q.z].into_iter().enumerate() {
                bodies.attitude[k][i % PACK] = value;
            }
        }
        self.chain.evaluate(true);
        for (i, handle) in self.handles.iter().enumerate() {
            let body = &mut self.world.bodies[*handle];
            let a = &self.chain.accelerations[i / PACK];
            let linear = a.linear.map(|r| r[i % PACK]);
            let spin = self.chain.state.bodies[i / PACK].spin.map(|r| r[i % PACK]);
            // Without the gyroscopic part, which rapier adds itself.
            let torque = [0, 1, 2].map(|k| {
                let (j, l) = ((k + 1) % 3, (k + 2) % 3);
                let gyroscopic = (cart.inertia[l] - cart.inertia[j]) * spin[j] * spin[l];
                cart.inertia[k] * a.angular[k][i % PACK] + gyroscopic
            });
            let rotation = *body.rotation();
            body.reset_forces(true);
            body.reset_torques(true);
            body.add_force(Vector::new(linear[0], linear[1], linear[2]) * cart.mass, true);
            body.add_torque(rotation * Vector::new(torque[0], torque[1], torque[2]), true);
        }
        self.world.step();
    }

    /// Simulated seconds a wall second, and the change of the mean speed along the track, m/s.
    fn ratio(&mut self, seconds: f64) -> f64 {
        let step = self.world.integration_parameters.dt;
        let steps = (seconds / step).round() as usize;
        let clock = Instant::now();
        for k in 0..steps {
            if k % ((0.01 / step).round() as usize) == 0 {
                self.chain.sample_control();
            }
            self.step();
        }
        let ratio = seconds / clock.elapsed().as_secs_f64();
        assert!(!self.chain.forces.trouble, "the rival's chain broke");
        ratio
    }
}

/// The middle of three.
fn median(mut values: [f64; 3]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[1]
}

fn speed() {
    let simulation = reference();
    println!("reference track, 171 carts, one thread; simulated s a wall s, median of 3 taken in turn");
    let mut rows: Vec<(String, Box<dyn FnMut() -> f64>)> = Vec::new();
    for width in Width::all() {
        for (step, name) in [(1e-3, "1 ms (the default)"), (0.5e-3, "0.5 ms")] {
            let mut chain = chain(&simulation, width);
            let mut verlet = Verlet::bounded(step);
            rows.push((format!("{width}, Verlet at {name}"), Box::new(move || ratio(&mut chain, &mut verlet, 4.0))));
        }
    }
    let mut rival = Rival::new(chain(&simulation, Width::widest()), 0.5e-3);
    rows.push(("rapier, forces from outside, 0.5 ms".into(), Box::new(move || rival.ratio(1.0))));
    let mut times = vec![[0.0; 3]; rows.len()];
    for turn in 0..3 {
        for ((_, run), times) in rows.iter_mut().zip(&mut times) {
            times[turn] = run();
        }
    }
    let last = median(*times.last().expect("rows"));
    for ((name, _), times) in rows.iter().zip(&times) {
        println!("  {name:<40} {:>8.1}   {:>6.2} x rapier", median(*times), median(*times) / last);
    }
}

/// A stadium that so many carts close on.
fn stadium(carts: usize) -> Simulation {
    let mut simulation = reference();
    let radius: f64 = 3.0;
    let straight = (carts as f64 * 1.2501 - std::f64::consts::TAU * radius) / 2.0;
    let half =
        [CentreLinePiece::Straight { length: straight, slope: 0.0 }, CentreLinePiece::Arc { radius, turn_deg: 180.0 }];
    let elements = [half.clone(), half].concat();
    simulation.track = Track { name: "stadium".into(), start: [0.0; 4], elements };
    let lap = 2.0 * straight + std::f64::consts::TAU * radius;
    simulation.motors.s_m = (0..carts / 13 + 1).map(|k| k as f64 * lap / (carts / 13 + 1) as f64).collect();
    simulation.chain.carts = carts;
    simulation
}

fn size() {
    println!("carts against cost, widest vectors, Verlet at 1 ms or shorter where joints need it");
    for carts in [20, 50, 100, 200, 500, 1000, 2000] {
        let mut chain = chain(&stadium(carts), Width::widest());
        let before = chain.evaluations;
        let seconds = (200.0 / carts as f64).clamp(0.5, 4.0);
        let ratio = ratio(&mut chain, &mut Verlet::bounded(1e-3), seconds);
        let evaluations = (chain.evaluations - before) as f64;
        let each = seconds / ratio / evaluations / carts as f64 * 1e9;
        println!("  {carts:>5} carts {ratio:>9.1} simulated s a wall s, {each:>6.1} ns a cart and evaluation");
    }
}

fn threads() {
    let plan = Plan { settle: 0.0, ..Plan::default() };
    let inputs: Vec<(Simulation, Plan)> = (0..4).map(|_| (reference(), plan.clone())).collect();
    println!("four laps at once");
    for threads in [1, 2] {
        let clock = Instant::now();
        let done = simulate_all(&inputs, Width::widest(), threads);
        assert!(done.iter().all(Result::is_ok));
        println!("  {threads} threads: {:.2} s", clock.elapsed().as_secs_f64());
    }
}

/// NRMSD of the first two seconds, before chaos, and differences of a lap's mean and deviation, in % of the lap's
/// range.
fn accuracy() {
    println!("steps against a run at 0.1 ms, no settling: worst channel, % of its range over the lap");
    let simulation = reference();
    let run = |step: f64| {
        let plan = Plan { settle: 0.0, step: Some(step), ..Plan::default() };
        simulate(&simulation, &plan, Width::widest(), &mut |_| true).expect("fit").run
    };
    let exact = run(0.1e-3);
    for step in [0.2e-3, 0.25e-3, 0.5e-3, 1e-3] {
        let other = run(step);
        let mut worst = [(0.0, Channel::JointXi); 3];
        for channel in Channel::ALL.into_iter().filter(|c| c.is_force()) {
            let (a, b) = (&exact.channels[&channel], &other.channels[&channel]);
            let (Some(x), Some(y)) = (statistics(a), statistics(b)) else { continue };
            let range = x.max - x.min;
            let pointwise = rmsd(&a[..1000], &b[..1000]).unwrap_or(f64::NAN);
            for (worst, value) in worst.iter_mut().zip([pointwise, (y.mean - x.mean).abs(), (y.sd - x.sd).abs()]) {
                if 100.0 * value / range > worst.0 {
                    *worst = (100.0 * value / range, channel);
                }
            }
        }
        let [p, m, s] = worst;
        println!(
            "  {:.2} ms: first 2 s {:.2} % ({}), mean of the lap {:.2} %, sd of the lap {:.2} %",
            step * 1e3,
            p.0,
            p.1.name(),
            m.0,
            s.0
        );
    }
}

/// What two replicate simulations of one lap differ by: equal but for the step.
fn floor() {
    println!("chaos: a lap after 10 s of settling, 0.25 ms against 0.2 ms, NRMSD in %, raw and of the two-cart mean");
    let simulation = reference();
    let run = |step: f64| {
        let plan = Plan { settle: 10.0, step: Some(step), ..Plan::default() };
        simulate(&simulation, &plan, Width::widest(), &mut |_| true).expect("fit").run
    };
    let (a, b) = (run(0.2e-3), run(0.25e-3));
    let window = 2.0 * 1.25 / 2.0 * 500.0;
    for channel in Channel::ALL.into_iter().filter(|c| c.is_force()) {
        let (x, y) = (&a.channels[&channel], &b.channels[&channel]);
        let Some(s) = statistics(x) else { continue };
        let n = x.len().min(y.len());
        let mean = |x: &[f64]| lss::signal::filter::moving_mean(x, window);
        let smooth = |x: &[f64]| mean(x).into_iter().filter(|v| v.is_finite()).collect::<Vec<f64>>();
        let (p, q) = (smooth(&x[..n]), smooth(&y[..n]));
        let percent = |d: Option<f64>| 100.0 * d.unwrap_or(f64::NAN) / (s.max - s.min);
        println!("  {:<12} {:>6.2} {:>6.2}", channel.name(), percent(rmsd(&x[..n], &y[..n])), percent(rmsd(&p, &q)));
    }
}

fn main() {
    // `cargo test --benches` and clippy only want to see it start.
    if std::env::args().any(|a| a == "--test") {
        return;
    }
    // Every parameter is set by name, as users do.
    assert!(parameters::parameters(&reference()).len() > 60);
    speed();
    size();
    threads();
    accuracy();
    floor();
}
