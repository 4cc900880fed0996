//! A sensor that says late what it felt, F(t − T), or by as many lags of the first order in a row as `order` says, as
//! filters of amplifiers have them, late by T together: each T/n · dF/dt + F = G (Franklin, Powell and Emami-Naeini
//! 2010).
//!
//! Signature: the channel's pattern along the track is moved by v T, and with an order smoothed over as much, no other
//! channel's.

use super::sites::Site;
use super::{Act, Effect, Experiment, Sensed, Sites, StrengthSearch, Strengths, sites};
use crate::base::trig;
use crate::chain_input::Simulation;
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::SENSOR_LAG,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(0.02, 0.0)],
    sites: Sites::Listed(channels),
    separated_by: Experiment::Sensors,
    act: Act::Sensor(act),
    ..Effect::PLAIN
};

/// Orders that are looked for beside a pure delay.
const ORDERS: [usize; 2] = [1, 2];

/// More lags in a row than this are nearly a pure delay.
const MOST: usize = 16;

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    let Some(force) = sensed.forces.get_mut(strengths.index("channel")) else { return };
    let late = strengths.of("delay") / sensed.period;
    match strengths.of("order").clamp(0.0, MOST as f64) as usize {
        0 => delay(force, late),
        order => (0..order).for_each(|_| lag(force, late / order as f64)),
    }
}

/// Moved on by so many samples.
fn delay(force: &mut [f64], late: f64) {
    let (whole, share) = (late as usize, late - late.floor());
    let now = force.to_vec();
    // Before it began, the sensor is thought to have said the same.
    let at = |k: usize| now[k.min(now.len() - 1)];
    for (k, x) in force.iter_mut().enumerate() {
        *x = (1.0 - share) * at(k.saturating_sub(whole)) + share * at(k.saturating_sub(whole + 1));
    }
}

/// A lag of the first order with a time constant of so many samples, exact for a force that is straight between two of
/// them.
fn lag(force: &mut [f64], late: f64) {
    let late = late.max(1e-9);
    let keep = trig::exp(-1.0 / late);
    let new = 1.0 - late * (1.0 - keep);
    let mut last = force.first().copied().unwrap_or(0.0);
    let mut said = last;
    for x in force {
        said = keep * said + (1.0 - keep - new) * last + new * *x;
        (last, *x) = (*x, said);
    }
}

/// Each channel, with a pure delay and with lags in a row.
fn channels(simulation: &Simulation) -> Vec<Site> {
    let each = sites::channels(simulation).into_iter();
    each.flat_map(|site| {
        let with = |order: usize| Site {
            words: format!("{}, smoothed by a filter of order {order}", site.words),
            fixed: [&site.fixed[..], &[("order", order as f64)]].concat(),
        };
        let smooth = ORDERS.map(with);
        [site].into_iter().chain(smooth)
    })
    .collect()
}
