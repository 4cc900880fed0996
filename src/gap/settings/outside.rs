//! Other programs as models.

use crate::identify::repeatability::MEANS_AGREE;

settings! {
    /// Windows in time.
    Windows as "outside.windows" {
        /// Windows of a part at most.
        most: f64 = 150.0, "–", Chosen("features beyond them cost time and tell little more");
        /// Windows of a part at least, when the noise remembers long.
        least: f64 = 60.0, "–", Chosen("fewer do not tell where a gap lies");
        /// Correlation times of the noise in a window.
        correlation_times: f64 = 5.0, "–", Chosen("with an exponential autocorrelation, neighbouring means correlate \
            by 0.12");
        /// Samples that a window holds at least.
        samples: usize = 4, "–", Chosen("its halves have a mean of two");
        /// Windows without which nothing can be scored.
        needed: usize = 8, "–", Chosen("a block of noise is as long");
        /// Windows before the noise is known.
        first: usize = 100, "–", Chosen("between the least and the most");
    }
}

settings! {
    /// Noise and inaccuracy.
    Noise as "outside.noise" {
        /// What independent programs and sensors agree to at best, of the range of a channel's means.
        agreement: f64 = MEANS_AGREE, "–", Chosen("as in identification");
        /// Samples of the repeatability.
        samples: usize = 64, "–", Chosen("about as many as a chain has carts, each of which is a replicate lap");
        /// Windows that are drawn together.
        block: usize = 8, "–", Chosen("what noise remembers stays (Künsch 1989)");
        /// Beyond so many deviations a window has a noise of its own.
        own: f64 = 3.0, "–", Chosen("a normal deviate is beyond in 0.3 % of the windows; a channel's jump is");
        /// Slow waves of which a model's inaccuracy is made, half waves over a run.
        waves: usize = 8, "–", Chosen("inaccuracy is slow against the windows");
    }
}

settings! {
    /// The nominal fit of a part.
    Fitting as "outside.fitting" {
        /// Difference that slopes are taken over, of a nuisance's range.
        difference: f64 = 1e-3, "–", Chosen("small against the range, large against a solver's tolerance");
        /// Deviation of a nuisance before the run, of its range.
        prior: f64 = 1.0, "–", Chosen("the range itself, so that it hardly counts");
        /// Steps below this are none, of a nuisance's range.
        converged: f64 = 1e-6, "–", Chosen("far below every interval");
        /// After a step below this, slopes are kept; so are the windows. Of a nuisance's range.
        small: f64 = 1e-2, "–", Chosen("slopes hardly change over it");
        /// Steps at most.
        steps: usize = 15, "–", Chosen("Gauss and Newton's method needs fewer where it converges");
        /// Steps after which the repeatability stays as it is.
        settled: usize = 6, "–", Chosen("a cost that changes with each step has no least");
    }
}

settings! {
    /// Processes of a program.
    Processes as "outside.processes" {
        /// What a process is given to end by itself once its input has ended.
        patience: f64 = 0.5, "s", Chosen("what ends by itself mostly does within it, and a diagnosis hardly waits");
        /// A program that was lost so often is not started again.
        most_failures: usize = 20, "–", Chosen("what fails so often fails always");
    }
}
