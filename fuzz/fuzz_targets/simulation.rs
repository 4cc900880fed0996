//! Any bytes as an input of a simulation: what is read has a centre line, parameters, and a model or a reason why not.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lss::chain_input::Simulation;
use lss::dynamics::parameters;
use lss::effects;

fuzz_target!(|bytes: &[u8]| {
    match Simulation::read(bytes) {
        Ok(mut simulation) => {
            assert!(simulation.track.centre_line().length.is_finite());
            parameters::parameters(&simulation);
            if simulation.chain.carts < 1_000 && simulation.track.elements.len() < 100 {
                let _ = effects::model(&simulation).map_err(|why| why.to_string());
            }
            simulation.derive();
            assert!(simulation.chain.left_over_m.is_finite());
        }
        Err(why) => drop(why.to_string()),
    }
});
