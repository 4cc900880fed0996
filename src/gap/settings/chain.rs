//! The chain of carts as a model.

settings! {
    /// Simulations in which all carts have sensors.
    Ensembles as "chain.ensembles" {
        /// Steps of a run's nominal fit.
        nominal_steps: usize = 3, "–", Chosen("enough to get nuisances near, as the diagnosis moves them along");
        /// Carts that pass each place in a simulation with effects.
        passes: f64 = 24.0, "–", Chosen("chaos moves their mean by a fifth of what it moves a lap");
        /// The same in one that only takes a signature.
        signature_passes: f64 = 10.0, "–", Chosen("a signature is taken where it is large");
        /// Time that one for a signature settles before it is recorded.
        signature_settle: f64 = 5.0, "s", Chosen("it begins from the settled nominal chain");
        /// How often a simulation that does not come to its end is made again with half the step.
        halvings: usize = 2, "–", Chosen("an impact may ask for shorter steps than the chain does");
        /// Chains as built that are drawn.
        as_built_draws: usize = 4, "–", Chosen("each costs a simulation of every run");
        /// Carts whose records a sensor's effect is put into.
        sensor_carts: usize = 14, "–", Chosen("what chaos does to them is the same with and without it");
        /// Samples of a run above what counts as its largest force.
        top_samples: usize = 5, "–", Chosen("noise does not make it then");
        /// Deviation of the logarithm of the floor of approach speeds, a nuisance here.
        approach_floor_deviation: f64 = 1.0, "–", Chosen("it is known to a factor of about e");
        /// Deviation of a feature that is no more than rounding.
        rounding: f64 = 1e-9, "N, shares or logarithms", Chosen("far below every noise");
        /// Runs are fitted again with what was named where that leaves so much, over the limit of repeated measurements.
        left_anew: f64 = 1.0, "–", Chosen("what is within its limit leaves nothing to be found");
        /// How often runs are then fitted with what was named at most, its strengths moved along.
        together: usize = 3, "–", Chosen("the second step of strengths is a fifth of the first");
        /// A shorter step ends it.
        together_near: f64 = 0.05, "–", Chosen("far below what a strength is known to");
        /// How often one of their places gets another shape at most.
        reshaped: usize = 3, "–", Chosen("most often one shape is wrong; each costs a simulation of a run for every \
            shape of every place");
        /// Shapes that are fitted with the parameters of the run of which most is left.
        shapes_fitted: usize = 4, "–", Chosen("both signs of two shapes; each costs a fit of a run");
        /// A shape leaves less by this share of the mean square at least, in that run and over all.
        shape_worth: f64 = 0.1, "–", Chosen("what fits of a run with other chance differ by");
        /// Shapes that leave so much more in that run than the one that leaves least are fitted to all runs.
        shape_tie: f64 = 0.15, "–", Chosen("both signs of a step may leave as much in one run");
        /// Other shapes do so many times as much at most as the one that was found.
        shape_grows: f64 = 3.0, "–", Chosen("a wrong shape may have a third of the height");
        /// The likeliest effects that are looked for again once the runs are fitted with what was named.
        offered_anew: usize = 10, "–", Chosen("twice as many as are ever likely");
        /// Fewer laps tell nothing of how they differ.
        least_laps: usize = 6, "–", Chosen("with five degrees of freedom a variance has a deviation of 63 %");
        /// More laps are not kept.
        most_laps: usize = 128, "–", Chosen("a covariance of more costs time and tells little more");
        /// Others are loaded until so many laps are known, where few carts are like the one with the sensors.
        loaded_laps: usize = 12, "–", Chosen("twice the least");
        /// How often others are loaded at most, with the first time.
        loadings: usize = 4, "–", Chosen("each costs a simulation");
    }
}

settings! {
    /// Where something strikes a rail.
    Impacts as "chain.impacts" {
        /// Cells of each rail in which steps are looked for.
        cells: usize = 2, "–", Chosen("each is one more candidate with places beside");
        /// Length of a part of the lap.
        part: f64 = 0.1, "m", Chosen("about how far an impact rings");
        /// Length of a part in which the beginning of an impact is looked for.
        fine: f64 = 0.01, "m", Chosen("as long as a sharp step is; two samples at 2 m/s and 400 Hz");
        /// An impact is where changes have so many times the power that is simulated.
        power: f64 = 3.0, "–", Chosen("what stands out of the scatter of parts");
        /// Changes are compared with no less than this share of the power that is simulated over the lap.
        quiet: f64 = 0.1, "–", Chosen("where a simulation is as good as silent, anything is many times as loud");
        /// An impact begins where changes have this part of the strongest ones' power.
        rings: f64 = 30.0, "–", Chosen("it rings longer than that; what is weaker is another one");
    }
}

settings! {
    /// The slope of a force along an impact.
    ForceSlopes as "chain.force_slopes" {
        /// Over how many parts of the lap the line is laid, of which the impact begins in the second.
        parts: usize = 5, "–", Chosen("half a metre has an impact and the landing after it");
        /// The scale of slopes has as many deviations of carts and of noise.
        deviations: f64 = 3.0, "–", Chosen("smaller slopes tell no sign");
        /// It has this share of the mean force.
        of_mean: f64 = 0.003, "–", Chosen("a rise of so little of the force is no impact");
        /// It has this share of the slope that is simulated without the impact.
        of_nominal: f64 = 0.3, "–", Chosen("the nominal chain's own slope is known no better");
        /// Deviation of asinh of the slope over the scale.
        deviation: f64 = 0.6, "–", Chosen("an impact may be half as large again as simulated, or half as large");
    }
}
