//! What a diagnosis cost, stage by stage.

use crate::identify::Effort;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Simulations, simulated time and wall time, as `lss gap diagnose --format json` prints them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Cost {
    pub simulations: u64,
    pub simulated_s: f64,
    pub wall_s: f64,
    /// By the name of the stage.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub by_stage: BTreeMap<&'static str, Cost>,
}

/// A diagnosis under way.
#[derive(Clone, Debug)]
pub struct Costs {
    stage: &'static str,
    begin: Effort,
    since: Instant,
    by_stage: BTreeMap<&'static str, Cost>,
}

impl Costs {
    /// Begins with a stage, before anything is simulated.
    pub fn new(stage: &'static str) -> Self {
        Costs { stage, begin: Effort::default(), since: Instant::now(), by_stage: BTreeMap::new() }
    }

    /// Another stage begins, when so much had been simulated in all; or the same goes on.
    pub fn enter(&mut self, stage: &'static str, effort: Effort) {
        if stage == self.stage {
            return;
        }
        self.close(effort);
        self.stage = stage;
    }

    fn close(&mut self, effort: Effort) {
        let spent = effort.since(self.begin);
        let cost = self.by_stage.entry(self.stage).or_default();
        cost.simulations += spent.simulations;
        cost.simulated_s += 1e-6 * spent.simulated as f64;
        cost.wall_s += self.since.elapsed().as_secs_f64();
        (self.begin, self.since) = (effort, Instant::now());
    }

    /// The whole, when so much had been simulated in all.
    pub fn finish(mut self, effort: Effort) -> Cost {
        self.close(effort);
        let sum = |of: fn(&Cost) -> f64| self.by_stage.values().map(of).sum::<f64>();
        Cost {
            simulations: self.by_stage.values().map(|cost| cost.simulations).sum(),
            simulated_s: sum(|cost| cost.simulated_s),
            wall_s: sum(|cost| cost.wall_s),
            by_stage: self.by_stage,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_that_comes_again_goes_on() {
        let effort = |simulations, seconds: u64| Effort { simulations, simulated: 1_000_000 * seconds };
        let mut costs = Costs::new("nominal_fits");
        costs.enter("screening", effort(10, 100));
        costs.enter("refits", effort(15, 120));
        costs.enter("screening", effort(16, 125));
        let cost = costs.finish(effort(20, 150));
        let each = |stage: &str| (cost.by_stage[stage].simulations, cost.by_stage[stage].simulated_s);
        assert_eq!((each("nominal_fits"), each("screening"), each("refits")), ((10, 100.0), (9, 45.0), (1, 5.0)));
        assert_eq!((cost.simulations, cost.simulated_s), (20, 150.0));
    }
}
