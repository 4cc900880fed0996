//! Checks of answers, intervals, and what a report has.

settings! {
    /// Checks of what a model answers.
    Checks as "checks" {
        /// Share of the features of a run that an answer may leave out.
        may_lack: f64 = 0.05, "–", Chosen("a delay moves a series past its last window");
        /// How many kept answers are asked again before any is used.
        asked_again: usize = 4, "–", Chosen("they are spread over all that is kept, and cost little of what it saves");
        /// Laps of a model without which it is not held against them.
        draws: usize = 19, "–", Derived("a run of the right model leaves more than all of n laps once in n + 1 times, \
            5 % here");
    }
}

settings! {
    /// Intervals of strengths.
    Intervals as "intervals" {
        /// Share of what is left of the gap, as an amplitude, that is believed to be the effect's own.
        missed: f64 = 0.5, "–", Chosen("what an equation misses of its own pattern may be as much of its strength");
    }
}

settings! {
    /// What a report has.
    Reporting as "reporting" {
        /// Cosine of two signatures from which on their effects are not told apart.
        parallel: f64 = 0.92, "–", Chosen("23 degrees between them");
        /// Unless their log posteriors differ by this much.
        apart: f64 = 3.0, "–", Derived("ln 20: strong evidence (Kass and Raftery 1995)");
        /// Logarithm of how much less likely an effect with all its strengths may be that they are told together.
        whole: f64 = 3.0, "–", Chosen("as `reporting.apart`, a factor of 20");
        /// Logarithm of how much less likely an effect at a place beside may be that was really fitted, for it to be
        /// told instead.
        fitted: f64 = 1.0, "–", Chosen("a factor of 2.7, not worth more than a bare mention (Kass and Raftery 1995)");
        /// Parts of the gap that are told.
        places: usize = 24, "–", Chosen("what a reader looks at");
        /// Channels that are drawn.
        drawn: usize = 4, "–", Chosen("they fit on a page");
        /// Hypotheses whose scores are explained.
        explained: usize = 12, "–", Chosen("they fit on a screen");
    }
}
