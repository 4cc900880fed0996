//! Every cart a sensor cart: in a chain of equal carts each one passes the same places, so that a short simulation
//! shows what many laps of one cart would.

use super::chain::Chain;
use super::clock::Clock;
use super::model::Model;
use super::run::Method;
use super::settled::Settled;
use super::state::{PACK, PackRow, packs};
use super::trouble::Trouble;
use super::width::Width;
use crate::chain_input::{Deviations, Simulation, Unfit};
use crate::signal::FORCES;
use crate::signal::filter::Lowpass;
use crate::solve::Stop;
use pulp::{Simd, WithSimd};
use std::sync::Arc;

/// What to record of a whole chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnsemblePlan {
    /// Time before recording, s. The controller begins with the thrust that rolling resistance needs, so that the chain
    /// does not slow down first.
    pub settle: f64,
    /// Time of recording, s.
    pub duration: f64,
    /// Largest step, s, when it shall be less than what the joints' stiffness asks for.
    pub step: Option<f64>,
    pub method: Method,
    /// Arc length of the first cart's front joint at the start, m.
    pub front: f64,
    /// When to end with what was recorded so far.
    pub stop: Stop,
}

/// What one cart measured: forces behind the low-pass, sampled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CartRecord {
    /// Arc length on the track, m.
    pub station: Vec<f32>,
    /// Of the front joint along the track, m/s.
    pub speed: Vec<f32>,
    /// `steer_left`, `steer_right`, `run_left`, `run_right`, `joint_xi`, `joint_eta`, `joint_zeta`, N.
    pub forces: [Vec<f32>; FORCES],
}

/// What the carts of a chain measured.
#[derive(Clone, Debug)]
pub struct Ensemble {
    /// Samples a second, Hz.
    pub rate: f64,
    pub carts: Vec<CartRecord>,
    /// The chain at the end.
    pub settled: Settled,
    /// What ended the recording early.
    pub trouble: Option<Trouble>,
}

/// Columns of a cart's record: arc length, speed, forces.
const COLUMNS: usize = 2 + FORCES;

/// Forces of a record that are of the joint in front, which is the one behind the leader.
const OF_JOINT: std::ops::Range<usize> = 4..FORCES;

/// Samples that are gathered before they are sorted by cart: each cart's column then grows by whole lines of the cache,
/// and what is gathered of a hundred carts stays in it.
const BLOCK: usize = 64;

/// Simulates a chain that deviates from its input as it is told, from its start or one that has settled, and records
/// its carts.
///
/// # Errors
///
/// [`Unfit`] for an input that no chain can have.
pub fn run_ensemble(
    simulation: &Simulation,
    deviations: Deviations,
    ensemble: &EnsemblePlan,
    from: Option<&Settled>,
    width: Width,
) -> Result<Ensemble, Unfit> {
    let model = Arc::new(Model::new(simulation, deviations)?);
    let sensor = &simulation.sensor;
    let clock = Clock::new(
        ensemble.step.unwrap_or(f64::INFINITY).min(model.largest_step()),
        sensor.rate_hz,
        model.controller.period,
    );
    let lowpass = Lowpass::new(sensor.lowpass_hz, 1.0 / clock.step).ok_or_else(|| Unfit {
        place: "sensor.lowpass_hz".into(),
        why: format!("{} Hz must be below half the rate of steps, {:.0} Hz", sensor.lowpass_hz, 0.5 / clock.step),
    })?;
    let mut integrator = ensemble.method.integrator(clock.step, false);
    let mut chain = Chain::new(model.clone(), ensemble.front, width)?;
    match from {
        Some(settled) => settled.put(&mut chain)?,
        None => chain.control.integral = rolling_thrust(&model),
    }
    let settling = (ensemble.settle / clock.step).round() as u64;
    let samples = (ensemble.duration * sensor.rate_hz).round() as usize;
    let mut filters = Filters::new(&chain, lowpass);
    let mut log = Log::new(model.carts, samples);
    let mut trouble = None;
    let mut tick: u64 = 0;
    while log.samples < samples {
        if tick.is_multiple_of(clock.a_look) && ensemble.stop.now() {
            break;
        }
        if clock.controls(tick) {
            chain.sample_control();
        }
        if tick == settling {
            filters = Filters::new(&chain, lowpass);
        }
        if tick >= settling && clock.samples(tick - settling) {
            log.sample(&chain, &filters);
        }
        if let Err(too_fine) = integrator.advance(&mut chain, clock.step) {
            trouble = Some(Trouble::too_fine(&chain, too_fine));
            break;
        }
        tick += 1;
        // Without adding up rounding.
        chain.time = tick as f64 / clock.ticks_a_second;
        if chain.forces.trouble {
            trouble = Some(Trouble::of(&chain, clock.step));
            break;
        }
        if tick > settling {
            filters.step(&chain);
        }
    }
    Ok(Ensemble { rate: sensor.rate_hz, carts: log.finish(), settled: Settled::of(&chain), trouble })
}

/// The controller's integral at which the motors hold rolling resistance, m.
fn rolling_thrust(model: &Model) -> f64 {
    let weight = model.carts as f64 * model.cart.mass * model.gravity;
    let command = (model.running.resistance * weight / model.motors.s.len().max(1) as f64).min(model.motors.force);
    if model.controller.integral > 0.0 { command / model.controller.integral } else { 0.0 }
}

/// The low-passes of all carts: forces on wheels, and of the joint behind.
struct Filters {
    lowpass: Lowpass,
    packs: Vec<Pack>,
}

#[derive(Clone, Copy, Default)]
struct Pack {
    /// Memory of the filter.
    delay: [[PackRow; 2]; FORCES],
    out: [PackRow; FORCES],
}

impl Filters {
    /// At rest at the present forces.
    fn new(chain: &Chain, lowpass: Lowpass) -> Self {
        let mut filters = Filters { lowpass, packs: vec![Pack::default(); chain.forces.loads.len()] };
        for (pack, loads) in filters.packs.iter_mut().zip(&chain.forces.loads) {
            let now = rows(loads);
            for (k, row) in now.iter().enumerate() {
                for (lane, x) in row.iter().enumerate() {
                    let mut filter = lowpass;
                    filter.reset_to(*x);
                    [pack.delay[k][0][lane], pack.delay[k][1][lane]] = filter.delay();
                }
                pack.out[k] = *row;
            }
        }
        filters
    }

    fn step(&mut self, chain: &Chain) {
        chain.width.run(Step { lowpass: self.lowpass, packs: &mut self.packs, loads: &chain.forces.loads });
    }
}

/// Forces of a pack in the order of a record, those of the joint being of the one behind, on the follower.
#[inline(always)]
fn rows(loads: &super::state::Loads) -> [PackRow; FORCES] {
    let positive = |x: f64| if x > 0.0 { x } else { 0.0 };
    let [xi, eta, zeta] = loads.joint.map(|row| row.map(|x| -x));
    let [left, right] = loads.running.map(|row| row.map(f64::abs));
    [loads.steering.map(positive), loads.steering.map(|x| positive(-x)), left, right, xi, eta, zeta]
}

struct Step<'a> {
    lowpass: Lowpass,
    packs: &'a mut [Pack],
    loads: &'a [super::state::Loads],
}

impl WithSimd for Step<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (pack, loads) in self.packs.iter_mut().zip(self.loads) {
            for ((now, delay), out) in rows(loads).iter().zip(&mut pack.delay).zip(&mut pack.out) {
                let [first, second] = delay;
                for (((x, y), z1), z2) in now.iter().zip(out).zip(first).zip(second) {
                    *y = self.lowpass.pass(*x, z1, z2);
                }
            }
        }
    }
}

/// Samples, gathered in blocks and then sorted by cart and column.
struct Log {
    records: Vec<CartRecord>,
    /// Of each pack and column, the samples of the block.
    block: Vec<[[[f32; PACK]; BLOCK]; COLUMNS]>,
    gathered: usize,
    samples: usize,
}

impl Log {
    fn new(carts: usize, samples: usize) -> Self {
        let column = || Vec::with_capacity(samples);
        let record = || CartRecord { station: column(), speed: column(), forces: std::array::from_fn(|_| column()) };
        Log {
            records: (0..carts).map(|_| record()).collect(),
            block: vec![[[[0.0; PACK]; BLOCK]; COLUMNS]; packs(carts)],
            gathered: 0,
            samples: 0,
        }
    }

    fn sample(&mut self, chain: &Chain, filters: &Filters) {
        let at = self.gathered;
        let forces = &chain.forces;
        let places = forces.station.chunks_exact(PACK).zip(forces.speed.chunks_exact(PACK));
        for ((block, own), (station, speed)) in self.block.iter_mut().zip(&filters.packs).zip(places) {
            let rows = [station, speed].into_iter().chain(own.out.iter().map(PackRow::as_slice));
            for (column, row) in block.iter_mut().zip(rows) {
                for (to, x) in column[at].iter_mut().zip(row) {
                    *to = *x as f32;
                }
            }
        }
        self.samples += 1;
        self.gathered += 1;
        if self.gathered == BLOCK {
            self.sort();
        }
    }

    fn sort(&mut self) {
        let carts = self.records.len();
        for cart in 0..carts {
            let (block, lane) = (&self.block[cart / PACK], cart % PACK);
            let column = |k: usize| {
                let mut one = [0.0; BLOCK];
                one.iter_mut().zip(&block[k]).for_each(|(to, row)| *to = row[lane]);
                one
            };
            let record = &mut self.records[cart];
            record.station.extend_from_slice(&column(0)[..self.gathered]);
            record.speed.extend_from_slice(&column(1)[..self.gathered]);
            for k in 0..OF_JOINT.start {
                record.forces[k].extend_from_slice(&column(2 + k)[..self.gathered]);
            }
            let follower = &mut self.records[if cart + 1 == carts { 0 } else { cart + 1 }];
            for k in OF_JOINT {
                follower.forces[k].extend_from_slice(&column(2 + k)[..self.gathered]);
            }
        }
        self.gathered = 0;
    }

    fn finish(mut self) -> Vec<CartRecord> {
        self.sort();
        self.records
    }
}
