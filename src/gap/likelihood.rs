//! From mean squares to probabilities.
//!
//! With s the mean square residual of a hypothesis over that of replicate laps and f their degrees of freedom, −f/2 ln
//! s is the log likelihood with an unknown scale (Seber and Wild 2003). The scale is unknown indeed: an effect's
//! equation is never that of the machine. So f is bounded, the more so far above the repeatability, where only the
//! equations differ and no chance; and each strength costs ln(f)/2 (Schwarz 1978); each of several places of an effect
//! shares its prior. Where a hypothesis leaves no more than the repeatability, its signature's score
//! (`significance.rs`) counts if it says more than the mean square does. What strikes a rail the other way round than
//! measured costs beside, as mean squares do not see it.

use super::settings::Likelihood;
use crate::base::trig;

impl Likelihood {
    /// Log likelihood of a mean square over that of replicate laps.
    pub fn log_likelihood(&self, mean_square: f64, degrees_of_freedom: f64) -> f64 {
        // Less than replicate laps have speaks for nothing.
        let near = degrees_of_freedom * trig::ln(mean_square.clamp(0.9, self.coarse));
        -0.5 * (near
            + degrees_of_freedom.min(self.coarse_degrees_of_freedom) * trig::ln((mean_square / self.coarse).max(1.0)))
    }

    /// How far scores count where a mean square is left: fully at the repeatability, not at all where so much is left
    /// that the equation misses much.
    pub fn counts(&self, mean_square: f64) -> f64 {
        ((self.quiet - mean_square) / (self.quiet - 1.0)).clamp(0.0, 1.0)
    }

    /// What is lost where residuals of runs have so much in common and should have so much: half the divergence of
    /// normal distributions with these correlations for each degree of freedom of a run (Kullback 1959).
    pub fn in_common(&self, seen: f64, expected: f64, runs: usize, degrees_of_freedom: f64) -> f64 {
        let n = runs as f64;
        // All runs together, and what is left of each of the others.
        let own = |c: f64| {
            let c = c.clamp(0.0, self.most_in_common);
            [(1.0, 1.0 + (n - 1.0) * c), (n - 1.0, 1.0 - c)]
        };
        let each = own(seen).into_iter().zip(own(expected)).map(|((count, seen), (_, expected))| {
            let ratio = seen / expected;
            count * (ratio - 1.0 - trig::ln(ratio))
        });
        0.5 * each.sum::<f64>() * degrees_of_freedom.min(self.coarse_degrees_of_freedom) / n.max(1.0)
    }

    /// What it costs that a channel is struck the other way round than measured, each of which is in deviations.
    pub fn wrong_way(&self, measured: f64, simulated: f64) -> f64 {
        let sure = measured.abs().min(simulated.abs());
        // With the larger one as far off the other way, the logarithm of normal densities' ratio.
        if measured * simulated < 0.0 { (2.0 * sure * sure).min(self.wrong_impact) } else { 0.0 }
    }

    /// The mean square that an unknown effect would leave.
    pub fn unknown(&self, mean_square: f64, degrees_of_freedom: f64) -> f64 {
        let left = (self.unknown_leaves * (mean_square - 1.0).max(0.0)).min(self.unknown_most);
        self.log_likelihood(1.0 + left, degrees_of_freedom) - cost(self.unknown_strengths, degrees_of_freedom)
    }

    /// Probabilities as they are reported: of some diagnoses the runs say no more than the priors did, whatever the
    /// likelihoods are, as no hypothesis is what the machine does: a linear pool of both (Stone 1961) that is right as
    /// often as it says (Dawid 1982). Both sum to 1.
    pub fn calibrated(&self, posterior: &[f64], prior: &[f64]) -> Vec<f64> {
        posterior.iter().zip(prior).map(|(after, before)| after + self.prior_weight * (before - after)).collect()
    }

    /// What patterns by chance that leave so much of a gap say too much for something unknown, which leaves its share
    /// beyond the repeatability.
    pub fn strange(&self, gap: f64, left: f64, degrees_of_freedom: f64) -> f64 {
        let least = 1.0 + self.pattern_leaves * (gap - 1.0).max(0.0);
        let left = left.max(1.0);
        self.log_likelihood(left, degrees_of_freedom) - self.log_likelihood(left.max(least), degrees_of_freedom)
    }
}

/// What a strength costs.
pub fn cost(strengths: f64, degrees_of_freedom: f64) -> f64 {
    0.5 * strengths * trig::ln(degrees_of_freedom.max(2.0))
}

/// Probabilities from logarithms of weights.
pub fn normalised(logs: &[f64]) -> Vec<f64> {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let each: Vec<f64> = logs.iter().map(|x| trig::exp(x - most)).collect();
    let sum: f64 = each.iter().sum();
    each.into_iter().map(|x| x / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blow_the_other_way_round_costs_where_both_are_sure() {
        let settings = Likelihood::default();
        assert_eq!(settings.wrong_way(3.0, 2.0), 0.0);
        assert_eq!(settings.wrong_way(-3.0, 0.0), 0.0);
        assert!(settings.wrong_way(-3.0, 0.1) < 0.1);
        assert_eq!(settings.wrong_way(-1.5, 1.0), 2.0);
        assert_eq!(settings.wrong_way(-9.0, 9.0), settings.wrong_impact);
        assert!(settings.wrong_way(f64::NAN, 1.0) == 0.0);
    }

    #[test]
    fn what_is_certain_is_reported_as_often_as_certain_diagnoses_are_right() {
        let settings = Likelihood::default();
        let reported = settings.calibrated(&[1.0, 0.0, 0.0], &[0.5, 0.3, 0.2]);
        assert!((reported[0] - (1.0 - 0.5 * settings.prior_weight)).abs() < 1e-12);
        assert!((reported[1] - 0.3 * settings.prior_weight).abs() < 1e-12);
        assert!((reported.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        // What the runs say nothing of is as likely as before.
        assert_eq!(settings.calibrated(&[0.25, 0.75], &[0.25, 0.75]), [0.25, 0.75]);
    }

    #[test]
    fn something_unknown_is_thought_to_leave_its_share_of_a_gap() {
        let settings = Likelihood::default();
        // A gap of 11 leaves 1.7 at least; what leaves more pays nothing, and what leaves less than the repeatability
        // no more than the repeatability.
        assert!((settings.strange(11.0, 1.0, 60.0) - 30.0 * trig::ln(1.7)).abs() < 1e-12);
        assert_eq!(settings.strange(11.0, 0.5, 60.0), settings.strange(11.0, 1.0, 60.0));
        assert_eq!(settings.strange(11.0, 1.8, 60.0), 0.0);
        assert_eq!(settings.strange(1.0, 0.9, 60.0), 0.0);
    }

    #[test]
    fn what_runs_should_have_in_common_is_held_against_what_they_have() {
        let settings = Likelihood::default();
        let lost = |seen: f64, expected: f64| settings.in_common(seen, expected, 3, 60.0);
        assert!(lost(0.0, 0.0).abs() < 1e-12 && lost(0.7, 0.7).abs() < 1e-12);
        // −½ ln det of the correlation's matrix, where nothing should be in common: det = (1 − c)² (1 + 2 c).
        let determinant = 0.2_f64 * 0.2 * 2.6;
        assert!((lost(0.8, 0.0) + 0.5 * trig::ln(determinant) * settings.coarse_degrees_of_freedom / 3.0).abs() < 1e-9);
        assert!(lost(0.0, 0.7) > lost(0.4, 0.7) && lost(0.4, 0.7) > 0.0);
        assert_eq!(settings.in_common(0.5, 0.0, 1, 60.0), 0.0);
    }
}
