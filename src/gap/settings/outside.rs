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
        /// Windows before the noise is known; stretches that samples are reported by.
        first: usize = 100, "–", Chosen("between the least and the most");
        /// What the model swings by within a window counts from so many times the noise's variance: samples are compared
        /// then, as a mean would hide it.
        swings: f64 = 1.0, "–", Chosen("less is hidden by the noise, too");
        /// The same, as a share of all that the model moves.
        swings_share: f64 = 0.01, "–", Chosen("where a channel moves slowly, a straight line through a window misses \
            less");
        /// What is left swings within a window where it has so large a share of all that is left.
        left_swings_share: f64 = 0.1, "–", Chosen("a means' average hides a tenth of the misfit then");
        /// Samples that are compared at most; of more, every second or third is.
        most_samples: usize = 4000, "–", Chosen("memory and time grow with them; what is between tells little more");
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
        /// Of samples, what is slower than the run over this is no noise.
        slow: usize = 30, "–", Chosen("as in the correlation time of windows");
        /// Where second differences have less than so much of the variance, what is left may swing by a misfit, and
        /// hypotheses are looked for with what they have.
        smooth: f64 = 0.5, "–", Chosen("white noise has as much in both; the best hypothesis decides at last");
        /// Noise that is found anew by such a factor is taken for the whole diagnosis.
        anew: f64 = 1.2, "–", Chosen("what changes less turns no verdict");
        /// Factors by which accuracies are multiplied to see whether a verdict hangs on them.
        accuracies: [f64; 2] = [0.5, 2.0], "–", Chosen("an accuracy is hardly known better than by a factor of 2");
        /// Share of the repeatability's mean square that accuracies have at least where a verdict may hang on them.
        accuracy_share: f64 = 0.1, "–", Chosen("less changes a mean square by less than a tenth");
        /// How often it is found anew.
        rounds: usize = 3, "–", Chosen("the second time mostly changes less than that factor");
        /// Slow waves of which a model's inaccuracy is made, half waves over a run.
        waves: usize = 8, "–", Chosen("inaccuracy is slow against the windows");
    }
}

settings! {
    /// The model of the model's error, by which a misfit is told from noise.
    ModelError as "outside.model_error" {
        /// Lags of each function of a channel; the first are neighbours, and each further one is longer by a quarter.
        lags: usize = 16, "–", Chosen("the longest is 33 samples, the memory of a damped resonance that is sampled well");
        /// Stretches of which every other one is foretold by the rest.
        blocks: usize = 8, "–", Chosen("each holds many lags");
        /// Share of the squares that has to be foretold for it to be a misfit.
        foretold: f64 = 0.1, "–", Chosen("less hardly changes the noise");
        /// Samples for each unknown, or else nothing is foretold.
        samples_each: usize = 6, "–", Chosen("with fewer the fit is to noise");
    }
}

settings! {
    /// The nominal fit of a part.
    Fitting as "outside.fitting" {
        /// Difference that slopes are taken over, of a nuisance's range.
        difference: f64 = 1e-3, "–", Chosen("small against the range, large against a solver's tolerance");
        /// The same where a model's answers are random.
        random_difference: f64 = 0.05, "–", Chosen("what the nuisance changes has to stand out of what chance does");
        /// Deviation of a nuisance before the run, of its range.
        prior: f64 = 1.0, "–", Chosen("the range itself, so that it hardly counts");
        /// Steps below this are none, of a nuisance's range.
        converged: f64 = 1e-6, "–", Chosen("far below every interval");
        /// After a step below this, slopes are kept; so are the windows. Of a nuisance's range.
        small: f64 = 1e-2, "–", Chosen("slopes hardly change over it");
        /// Steps at most.
        steps: usize = 15, "–", Chosen("Gauss and Newton's method needs fewer where it converges");
        /// Steps of the nuisances with effects at most, beyond where slopes at the nominal model put them.
        along: usize = 6, "–", Chosen("each costs a simulation, and corrects the slopes");
        /// Share of the squares that such a step has to promise.
        along_enough: f64 = 0.05, "–", Chosen("less turns no comparison");
        /// Share of the squares that a step of the nominal fit to all runs together has to promise.
        enough: f64 = 1e-3, "–", Chosen("less moves no shared nuisance by its interval");
        /// Re-fits of hypotheses by simulation at most, in place of `refitting.rounds`.
        rounds: usize = 8, "–", Chosen("oscillations are farther from linear than means along a track");
        /// A fit of nuisances that leaves so many times the noise is tried from other starts, too.
        restart: f64 = 4.0, "–", Chosen("less is no sign of a fit that went astray");
        /// How far that has to be from where it began, of a nuisance's range.
        other_start: f64 = 0.05, "–", Chosen("nearer starts mostly end alike");
        /// Such starts at most: the nominal values, and where other runs are.
        starts: usize = 4, "–", Chosen("each costs a simulation, and the best of them a fit");
        /// A fit that leaves more than such a share of what a channel moves is tried on growing stretches of the run, too.
        astray: f64 = 0.1, "–", Chosen("what leaves less follows the oscillations, and is refined by steps");
        /// Those stretches, of the run.
        stretching: [f64; 4] = [0.0625, 0.125, 0.25, 0.5], "–", Chosen("a phase that fits over one is off by little \
            over its double");
        /// Stretches of a run by which a nuisance is looked at for drift.
        stretches: usize = 4, "–", Chosen("each still holds enough to tell a nuisance");
        /// Deviations by which a nuisance has to differ to be told.
        drift: f64 = 6.0, "–", Chosen("slopes are linear and the noise an estimate, so twice what chance needs");
        /// Share of itself by which it has to differ, too.
        drift_share: f64 = 0.1, "–", Chosen("less is within what runs of a machine differ by");
        /// Steps after which the repeatability stays as it is.
        settled: usize = 6, "–", Chosen("a cost that changes with each step has no least");
    }
}

settings! {
    /// Constants of the comparison that are others for programs outside.
    OutsideComparison as "outside.comparison" {
        /// In place of `likelihood.unknown_most`.
        unknown_most: f64 = 4.0, "–", Chosen("the model's own accuracy is counted, so that an equation which leaves \
            five times the \
            repeatability is no likelier than something unknown");
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
