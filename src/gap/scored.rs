//! A hypothesis with its score, term by term.

use super::hypothesis::Fitted;
use super::ids::{PerRun, RunId};
use super::observation::Observation;
use super::repeatability::Repeatability;
use crate::base::trig;
use nalgebra::{DMatrix, DVector};

/// What a log posterior is made of, in natural logarithms: `likelihood` − `strengths` + `prior` − `impacts` − `beyond`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// Log likelihood: of the mean square, or of what the score along the hypothesis' signature says, whichever is
    /// more; less `in_common`.
    pub likelihood: f64,
    /// What the likelihood has lost because residuals of the runs have more or less in common than such an effect's
    /// should.
    pub in_common: f64,
    /// What its strengths cost, ln(f)/2 each (Schwarz 1978).
    pub strengths: f64,
    /// Log prior, which effects share, and places of an effect.
    pub prior: f64,
    /// What it costs that impacts go the other way round than measured.
    pub impacts: f64,
    /// What speaks against it because signatures of other effects are seen in what it leaves.
    pub beyond: f64,
}

impl Terms {
    pub fn log_posterior(&self) -> f64 {
        self.likelihood - self.strengths + self.prior - self.impacts - self.beyond
    }
}

/// A hypothesis with its score.
pub struct Scored {
    pub fitted: Fitted,
    /// Before the repeatability that it makes itself, where it makes one.
    pub repeatability: Option<Repeatability>,
    /// Normalised mean-square residual: that of all runs over that of replicate laps.
    pub mean_square: f64,
    pub terms: Terms,
}

impl Scored {
    pub fn log_posterior(&self) -> f64 {
        self.terms.log_posterior()
    }

    /// What it is scored by: the nominal chain's, or that of the repeatability that it makes itself.
    pub fn observations<'a>(&'a self, nominal: &'a PerRun<Observation>) -> &'a PerRun<Observation> {
        self.repeatability.as_ref().map_or(nominal, |f| &f.observations)
    }

    /// Mean square of what is left of a run over that of replicate laps; a repeatability that the hypothesis raises
    /// counts as left.
    pub fn mean_square_of(&self, nominal: &PerRun<Observation>, run: RunId, residual: &DVector<f64>) -> f64 {
        let (own, nominal) = (&self.observations(nominal)[run], &nominal[run]);
        let raised = if self.repeatability.is_some() { trig::exp(own.raised(nominal)) } else { 1.0 };
        raised * own.mean_square(residual)
    }

    /// What is left of each run, projected.
    pub fn residuals(&self) -> &PerRun<DVector<f64>> {
        self.repeatability.as_ref().map_or(&self.fitted.residuals, |f| &f.residuals)
    }

    /// What one more of each strength changes.
    pub fn columns(&self) -> &[PerRun<DVector<f64>>] {
        self.repeatability.as_ref().map_or(&self.fitted.columns, |f| &f.columns)
    }

    pub fn covariance(&self) -> &DMatrix<f64> {
        self.repeatability.as_ref().map_or(&self.fitted.covariance, |f| &f.covariance)
    }
}

/// How a hypothesis came to its score, for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// Each effect with its place, if it has one; empty for no gap and for something unknown.
    pub effects: Vec<String>,
    /// Whether it was fitted by simulations; else its signatures tell.
    pub simulated: bool,
    pub mean_square: f64,
    pub terms: Terms,
}

/// The likeliest first.
pub fn sort(scored: &mut [Scored]) {
    scored.sort_by(|a, b| b.log_posterior().total_cmp(&a.log_posterior()));
}
