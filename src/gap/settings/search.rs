//! How effects are looked for: signatures, their relinearisation, fits, and which hypotheses are tried.

/// How many shares of a strength are thought of.
pub const SHARES: usize = 7;

use std::ops::{Range, RangeInclusive};

settings! {
    /// The screen: at which strengths signatures are taken.
    Screening as "screening" {
        /// A signature is taken where it is at least so many times the repeatability in the feature that it changes
        /// most.
        clear: f64 = 10.0, "–", Chosen("the simulation's own chance is then a tenth of it");
        /// What changes no feature by so much of its deviation changes nothing but for rounding.
        nothing: f64 = 1e-3, "–", Chosen("far below what a feature tells, far above rounding");
        /// How often another size is asked for at most.
        resizings: usize = 2, "–", Chosen("each costs a simulation of every strength of every effect");
        /// Each size is at most so many times the one before, or as small a part of it.
        resize_factor: f64 = 12.0, "–", Chosen("few effects are linear over more than an order of magnitude");
        /// Places of an effect that is tried at several strengths, at most.
        few_places: usize = 10, "–", Chosen("the cost is places times strengths");
        /// At how many strengths such an effect is tried.
        rungs: usize = 6, "–", Chosen("a fit that begins far off ends far off; the cost grows with them");
        /// Share of the squares that may be left where such a strength is taken.
        rung_left: f64 = 0.98, "–", Chosen("less than what chance explains is no reason to leave the first size");
        /// Share of the squares that is left at most where an effect explains so much that no large strengths of either
        /// sign are tried.
        explained: f64 = 0.1, "–", Chosen("a load on other carts may have nearly any shape, and explained half of what \
            another curve did");
        /// No larger strength is tried where so many times the squares are left.
        overshot: f64 = 3.0, "–", Chosen("beyond it an effect does far more than there is to explain");
        /// Mean square over that of replicate laps from which on signatures of all runs are taken only of what tells
        /// something in the run of which most is left.
        selects_from: f64 = 4.0, "–", Chosen("below it scores over all runs may see what one run does not");
        /// What tells something explains this share of the squares there.
        telling_share: f64 = 0.01, "–", Chosen("half of what is worth a relinearisation");
        /// Or it is there with so many deviations, whichever is more.
        telling_score: f64 = 4.0, "–", Chosen("of some hundred normal deviates the largest is seldom above it");
        /// In what is left of the run, then in what the best leaves there, and so on, so often.
        selections: usize = 4, "–", Chosen("twice as many as a hypothesis has members");
        /// Simulations that are asked for at once.
        batch: usize = 24, "–", Chosen("progress is told between them, and threads are busy within them");
    }
}

settings! {
    /// Relinearisation: where and how often signatures are taken again.
    Relinearisation as "relinearisation" {
        /// How often signatures are taken again.
        rounds: usize = 3, "–", Chosen("each costs simulations of every run");
        /// At how many effects a round is made.
        effects: usize = 4, "–", Chosen("each costs simulations at all places beside");
        /// Share of the gap that an effect must explain.
        worth: f64 = 0.02, "–", Chosen("less is no reason for simulations");
        /// Share of the gap that is left at most where an effect leads, so that others are looked for in what it
        /// leaves.
        leads: f64 = 0.5, "–", Chosen("it explains more than half of it");
        /// Pairs of which a member that strikes is tried with the other sign: those that are likeliest before.
        turned_pairs: usize = 2, "–", Chosen("each is one more re-fit");
        /// Signatures of sensors' effects that are taken again at most.
        sensors: usize = 24, "–", Chosen("they need no simulation, so more of them than of the machine's");
        /// Places of an effect at which strengths are looked for that are only beside its others, at most.
        beside_places: usize = 3, "–", Chosen("the fundamental and its harmonics may each explain most");
        /// Factor between the strength that fits and the one of the signature within which the signature is kept.
        near: Range<f64> = 0.6..1.6, "–", Chosen("effects of the machine are nearly linear so far");
        /// The same of a sensor's effect.
        near_sensor: Range<f64> = 0.9..1.1, "–", Chosen("what a shift does to a narrow channel's distribution is in \
            proportion to nothing");
    }
}

settings! {
    /// Fits of sensors' strengths by Gauss and Newton's steps on differences.
    SensorFits as "sensor_fits" {
        /// Steps at most.
        steps: usize = 8, "–", Chosen("they cost no simulation of the chain");
        /// Share of the squares that another step is worth.
        enough: f64 = 0.005, "–", Chosen("a quarter of what a re-fit asks for, as steps cost little");
        /// Differences are taken over so much of a strength.
        difference: f64 = 0.02, "–", Chosen("small against the distance in which a distribution saturates");
        /// Differences are taken over so much of a strength's trial at least.
        least_difference: f64 = 0.1, "–", Chosen("a strength of 0 has a slope, too");
    }
}

settings! {
    /// Which hypotheses are fitted and compared, and which are not worth it.
    Selection as "selection" {
        /// Hypotheses that are re-fitted.
        refitted: usize = 8, "–", Chosen("each costs simulations of every run in several rounds");
        /// Single effects among them at least.
        refitted_singles: usize = 4, "–", Chosen("pairs always fit better before they pay for their strengths");
        /// Candidates of which pairs are made.
        paired: usize = 12, "–", Chosen("pairs of them with all others are scored by signatures alone");
        /// Effects that differ by chance and are tried beside another one.
        random_beside: usize = 2, "–", Chosen("each costs laps at several strengths");
        /// Hypotheses that are held against a repeatability of their own at most.
        own_repeatabilities: usize = 5, "–", Chosen("each costs a simulation of every run over all carts");
        /// Share of the gap that such a hypothesis must explain.
        own_repeatability_worth: f64 = 0.05, "–", Chosen("less is no reason for these simulations");
        /// A score from which on something is looked for though the mean square is at the repeatability.
        significant: f64 = 4.0, "–", Chosen("of some hundred normal deviates the largest is seldom above it");
        /// Mean square over that of replicate laps from which on something is left to be looked for beside an effect.
        unsettled: f64 = 1.25, "–", Chosen("with 60 degrees of freedom, 1.4 deviations of a mean square above 1");
        /// Second effects that are fitted beside what the best one really leaves.
        seconds: usize = 3, "–", Chosen("each is one more re-fit");
        /// Factors on the strength of a pair's member from which the pair is fitted once more.
        pair_factors: [f64; 4] = [0.33, 3.0, 9.0, 27.0], "–", Chosen("a threshold is met within a factor of two of \
            one of them; each costs a simulation of every run");
        /// Places of an effect that are tried together at most.
        places: usize = 4, "–", Chosen("each further one is one more re-fit");
        /// Signs and shapes of a further place that are re-fitted beside the first at most.
        place_shapes: usize = 2, "–", Chosen("each is one more re-fit");
        /// How often all places of an effect are tried in other shapes at most, where several were found.
        reshapings: usize = 2, "–", Chosen("shapes of one place hang on those of the others; each costs simulations of \
            every shape of every place");
        /// Hypotheses that are held against what is seen beyond them.
        compared: usize = 40, "–", Chosen("each costs a score along every signature");
    }
}

settings! {
    /// Re-fits by simulation.
    Refitting as "refitting" {
        /// Simulations of each run at most.
        rounds: usize = 4, "–", Chosen("each costs a simulation of every run");
        /// Share of the squares that another simulation is worth.
        enough: f64 = 0.02, "–", Chosen("with 60 degrees of freedom it gains 0.6 of a log likelihood");
        /// What leaves so many times the squares that another hypothesis does is not followed.
        hopeless: f64 = 4.0, "–", Chosen("the rounds that are left do not come up with it");
        /// What leaves so many times the mean square that was foretold has nuisances that are not linear so far.
        astray: f64 = 3.0, "–", Chosen("far more than was foretold is not what signatures miss");
        /// A step that changes less than this share of what the effects do tells nothing of their slopes.
        short: f64 = 0.1, "–", Chosen("chaos drowns what short steps change");
    }
}

settings! {
    /// Steps of strengths by slopes taken where they are: of re-fitted hypotheses, which are worth another step as
    /// `refitting.enough` says, and of what runs are fitted with.
    GaussNewton as "gauss_newton" {
        /// Hypotheses that are fitted on at a time at most, each of other effects.
        hypotheses: usize = 3, "–", Chosen("each costs simulations of every run for every strength");
        /// Steps at most.
        steps: usize = 5, "–", Chosen("a strength that is a third of what fits is there in three");
        /// How far a strength steps at most, as a share of itself.
        far: f64 = 0.6, "–", Chosen("few effects are linear farther than that");
        /// How much less and more of a strength tells what it changes.
        share: f64 = 0.2, "–", Chosen("clear of chaos, and nearly linear");
    }
}

settings! {
    /// Effects that differ by chance, found by how laps scatter.
    RandomEffects as "random_effects" {
        /// Strengths that are simulated at first, from the trial on.
        rungs: usize = 4, "–", Chosen("with the factor between them, a range of 27");
        /// Each of these is so many times the one before.
        rung: f64 = 3.0, "–", Chosen("scatter, which grows with the square, then grows by about ten");
        /// Rounds of further strengths between these.
        further: usize = 3, "–", Chosen("halving a factor of 3 three times leaves 15 %, half of the deviation below");
        /// Shares of a simulated strength at which the scatter is thought of, by its square.
        shares: [f64; SHARES] = [0.57, 0.67, 0.8, 1.0, 1.25, 1.5, 1.75], "–", Chosen("about the square root of the \
            factor \
            between strengths on either side");
        /// Shares so near that the next strength is simulated there.
        near: RangeInclusive<f64> = 0.8..=1.25, "–", Chosen("farther ones are not believed, as swings of a late drive \
            are far from growing in \
            proportion");
        /// What scatter must explain at least, as a logarithm, for the effect to be fitted.
        worth: f64 = 0.1, "–", Chosen("what changes less does nothing");
        /// Deviation of the logarithm of a strength that is found by scatter.
        deviation: f64 = 0.3, "–", Chosen("strengths are simulated a factor of 1.25 and more apart");
        /// Carts whose laps are held beside each other over the runs.
        carts: usize = 16, "–", Chosen("some of the laps are enough for a mean correlation");
    }
}
