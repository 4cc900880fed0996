//! Reactions of the track's supports: every wheel and motor load is shared by the two supports beside it, as by a
//! simply supported span, and each support keeps the envelope of what it got.

use super::chain::Chain;
use super::state::PACK;
use crate::signal::SupportLoad;

/// Loads of a support: downwards, to the left, and in driving direction, N.
type Load = [f64; 3];

/// The supports of a track.
#[derive(Clone, Debug)]
pub struct Reactions {
    every: f64,
    /// One over that, 1/m.
    a_metre: f64,
    lap: f64,
    now: Vec<Load>,
    envelope: Vec<Option<(Load, Load)>>,
}

impl Reactions {
    /// Supports every so many metres from arc length 0; the last span is what remains.
    pub fn new(every: f64, lap: f64) -> Self {
        let count = ((lap / every) - 1e-9).ceil().max(1.0) as usize;
        Reactions { every, a_metre: 1.0 / every, lap, now: vec![[0.0; 3]; count], envelope: vec![None; count] }
    }

    /// Takes in the present loads.
    pub fn take(&mut self, chain: &Chain) {
        self.now.fill([0.0; 3]);
        let model = &chain.model;
        for cart in 0..model.carts {
            let loads = &chain.forces.loads[cart / PACK];
            let lane = cart % PACK;
            let (left, right, steering) = (loads.running[0][lane], loads.running[1][lane], loads.steering[lane]);
            let direction = chain.forces.speed[cart].signum();
            let rolling =
                model.running.resistance * (left.abs() + right.abs()) + model.steering.resistance * steering.abs();
            let thrust = chain.control.command * chain.forces.share[cart];
            self.put(chain.forces.station[cart], [left + right, steering, rolling * direction]);
            if thrust > 0.0 {
                self.put(chain.forces.station[cart] - 0.5 * model.cart.length, [0.0, 0.0, -thrust]);
            }
        }
        for (envelope, now) in self.envelope.iter_mut().zip(&self.now) {
            let (low, high) = envelope.get_or_insert((*now, *now));
            for k in 0..3 {
                low[k] = low[k].min(now[k]);
                high[k] = high[k].max(now[k]);
            }
        }
    }

    /// Shares a load at arc length `s` between the supports before and behind it.
    fn put(&mut self, s: f64, load: Load) {
        // Loads lie on the lap or just beside its ends.
        let s = if s < 0.0 {
            s + self.lap
        } else if s >= self.lap {
            s - self.lap
        } else {
            s
        };
        let count = self.now.len();
        let before = ((s * self.a_metre) as usize).min(count - 1);
        let begin = before as f64 * self.every;
        let span = if before + 1 == count { self.lap - begin } else { self.every };
        let share = ((s - begin) / span).clamp(0.0, 1.0);
        for (k, load) in load.into_iter().enumerate() {
            self.now[before][k] += load * (1.0 - share);
            self.now[(before + 1) % count][k] += load * share;
        }
    }

    /// The envelope of each support, in the order of arc length; none before the first load.
    pub fn envelopes(&self) -> Vec<SupportLoad> {
        let support = |(k, envelope): (usize, &Option<(Load, Load)>)| {
            let (low, high) = (*envelope)?;
            Some(SupportLoad {
                s: k as f64 * self.every,
                vertical: (low[0], high[0]),
                lateral: (low[1], high[1]),
                longitudinal: (low[2], high[2]),
            })
        };
        self.envelope.iter().enumerate().filter_map(support).collect()
    }

    /// Sum of all supports' present loads, N.
    #[cfg(test)]
    fn total(&self) -> Load {
        self.now.iter().fold([0.0; 3], |sum, load| [0, 1, 2].map(|k| sum[k] + load[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_shares_by_the_lever_rule_and_loses_nothing() {
        // Supports at 0, 2.5, 5.0 and 7.5 m; the last span has 1.5 m.
        let mut reactions = Reactions::new(2.5, 9.0);
        assert_eq!(reactions.now.len(), 4);
        reactions.put(3.0, [100.0, 10.0, 1.0]);
        assert_eq!(reactions.now[1], [80.0, 8.0, 0.8]);
        reactions.put(8.1, [100.0, 0.0, 0.0]);
        assert!((reactions.now[3][0] - 60.0).abs() < 1e-9 && (reactions.now[0][0] - 40.0).abs() < 1e-9);
        reactions.put(-0.5, [6.0, 0.0, 0.0]);
        assert!((reactions.total()[0] - 206.0).abs() < 1e-9);
    }

    #[test]
    fn a_lap_of_whole_spans_has_no_support_twice() {
        assert_eq!(Reactions::new(2.5, 10.0).now.len(), 4);
        assert_eq!(Reactions::new(2.5, 2.0).now.len(), 1);
    }
}
