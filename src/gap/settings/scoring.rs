//! How residuals become probabilities.

settings! {
    /// The residual of a run over its repeatability.
    Observations as "observations" {
        /// Common deviations of the nominal chain's laps that are told apart from each feature's own.
        modes: usize = 10, "–", Chosen("at most; only those that stand out of chance are taken");
        /// Variance of such a deviation over a feature's own, at least.
        mode_variance: f64 = 3.0, "–", Chosen("weaker ones are hardly told from chance by so few laps");
        /// How often what laps have in common and what each feature has of its own are found from each other.
        factor_rounds: usize = 3, "–", Chosen("each costs a decomposition of the laps");
    }
}

settings! {
    /// Log likelihoods, costs and priors.
    Likelihood as "likelihood" {
        /// Degrees of freedom that are believed of all runs together, at most.
        degrees_of_freedom: f64 = 60.0, "–", Chosen("an effect's equation is never that of the machine");
        /// What is left beyond so many times the repeatability is believed with fewer degrees of freedom.
        coarse: f64 = 2.0, "–", Chosen("above it equations differ, and no chance");
        /// Degrees of freedom beyond it.
        coarse_degrees_of_freedom: f64 = 24.0, "–", Chosen("an equation that misses much does so in few ways");
        /// How much runs have in common at most.
        most_in_common: f64 = 0.9, "–", Chosen("they differ in speed and tension");
        /// Mean square over that of replicate laps from which scores do not count.
        quiet: f64 = 1.25, "–", Chosen("as `selection.unsettled`; an equation that leaves more misses much");
        /// What it costs beside that a score is the best of a strength's whole range.
        score_cost: f64 = 2.0, "–", Chosen("about half the logarithm of a range of some hundred deviations");
        /// A pair is told where each of its effects has this probability.
        told: f64 = 0.5, "–", Chosen("likelier present than not");
        /// Weight of the priors in what is reported: a share of diagnoses of which the runs say no more than these.
        prior_weight: f64 = 0.055, "–", Measured("fits the 120 cases of challenge 10 best; the 120 of 14 and 15 were \
            held back (`python3 benches/gap/reliability.py`)");
        /// Prior of no gap.
        prior_none: f64 = 0.2, "–", Chosen("a guess before any case; sealed challenges, made later, have 15 % of \
            these");
        /// Prior of one effect of the library, shared among its effects.
        prior_one: f64 = 0.5, "–", Chosen("a guess before any case; in sealed challenges, made later, 55 % have one \
            of the machine \
            or of a sensor");
        /// Prior of two effects.
        prior_pair: f64 = 0.15, "–", Chosen("a guess before any case; sealed challenges, made later, have 15 % of \
            these");
        /// Factor on it for each further place of an effect.
        prior_place: f64 = 0.3, "–", Chosen("a guess: most often one place is off");
        /// Prior of something unknown.
        prior_unknown: f64 = 0.15, "–", Chosen("a guess before any case; sealed challenges, made later, have 15 % of \
            these");
        /// What the best effect of the library is thought to leave of a gap that is none of it.
        unknown_leaves: f64 = 0.5, "–", Chosen("an effect that closes half of a gross gap is believed a little sooner \
            (version a42c364)");
        /// What it is thought to leave at most beyond the repeatability, as a mean square.
        unknown_most: f64 = f64::INFINITY, "–", Chosen("the chain's equations miss the machine's by a share of the gap");
        /// Strengths that something unknown costs as many of.
        unknown_strengths: f64 = 2.0, "–", Chosen("one for its size and one for its place");
        /// How much runs have in common at least of what sits at places.
        placed: f64 = 0.5, "–", Chosen("it is at the same places in all runs, at other speeds");
        /// Share of what is unknown that has a pattern along the track.
        patterned: f64 = 0.5, "–", Chosen("the rest belongs to no place");
        /// Share of a gap that something unknown leaves at least when a pattern that differs by chance is fitted to it.
        pattern_leaves: f64 = 0.07, "–", Measured("carts of unequal length left 7 to 19 % of friction on one stretch \
            (version e6a2d91)");
        /// What it costs at most that a channel of a run is struck the wrong way round.
        wrong_impact: f64 = 6.0, "–", Chosen("an impact is seldom as simulated");
        /// What it costs at most in all.
        wrong_impacts: f64 = 12.0, "–", Chosen("two channels that are sure");
    }
}

settings! {
    /// Scores along signatures.
    Significance as "significance" {
        /// Degrees of freedom of a score.
        degrees_of_freedom: f64 = 8.0, "–", Chosen("its scatter is an estimate, and equations are not the machine's");
        /// Scatter of laps along a direction, as a share of what independent features would have, at least.
        least_scatter: f64 = 0.1, "–", Chosen("few laps may have hardly any along one direction by chance");
        /// Ratios that a sensor is accurate to, of its gain or of another channel's share.
        accuracy: f64 = 5e-4, "–", Derived("OIML R 60: a load cell of class C3 may be off by 0.7 · 1.5 of 3000 \
            intervals, \
            0.035 % of its range; somewhat more");
        /// What an effect's equation misses along another signature, as a share of what it does.
        missed: f64 = 0.02, "–", Chosen("beside a strong effect a weak one may be made by the strong one's equation");
        /// How far strengths of runs at other speeds and tensions may be apart, as a share.
        disagreement: f64 = 0.2, "–", Chosen("the equation is not that of the machine");
    }
}
