//! Stiffness that changes while a run goes on. Contacts are damped in proportion to their stiffness, Kelvin-Voigt's
//! linear damper by its equation; the take-up keeps the tension, so that the free length of the carts follows.

use super::chain::Chain;
use super::law::Damped;
use super::model::{BROKEN, Model};
use crate::base::trig;
use crate::chain_input::Warming;
use std::sync::Arc;

/// A chain before its stiffness changes.
pub struct Cold {
    warming: Warming,
    /// Steering wheels, running wheels, joints along and across the chain.
    contacts: [Damped; 4],
    /// Free length of the carts, and the stretch of a joint at the tension T₀, m.
    length: f64,
    stretch: f64,
}

impl Cold {
    /// `None` where nothing changes.
    pub fn new(model: &Model) -> Option<Cold> {
        let warming = model.deviations.warming;
        let contacts = [model.steering.contact, model.running.contact, model.axial, model.radial];
        let stretch = stretch(model, &model.axial);
        (warming.change != 0.0).then_some(Cold { warming, contacts, length: model.cart.length, stretch })
    }

    /// The chain as it is so many seconds after its record began.
    pub fn warm(&self, chain: &mut Chain, time: f64) {
        let factor = 1.0 + self.warming.change * self.warming.share(time);
        let [steering, running, axial, radial] = self.contacts.map(|cold| cold.stiffer(factor));
        let model = Arc::make_mut(&mut chain.model);
        (model.steering.contact, model.running.contact) = (steering, running);
        (model.axial, model.radial) = (axial, radial);
        model.breaking = axial.at_rest(BROKEN);
        model.cart.length = self.length + self.stretch - stretch(model, &axial);
    }
}

/// How far the tension T₀ stretches a joint, less than 0 of one that is pushed, m.
fn stretch(model: &Model, axial: &Damped) -> f64 {
    let size = trig::pow(model.tension.abs() / axial.stiffness, 1.0 / axial.exponent);
    if model.tension < 0.0 { -size } else { size }
}

impl Damped {
    /// With so many times the stiffness. The tangent at a load goes with its n-th root, and Kelvin-Voigt's damper with
    /// the root of that.
    fn stiffer(self, factor: f64) -> Damped {
        let viscosity = self.viscosity * trig::pow(factor, 0.5 / self.exponent);
        Damped { stiffness: self.stiffness * factor, viscosity, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain_input::{ContactLaw, Deviations, Simulation};
    use crate::compiled::fixture::compile;
    use crate::dynamics::Width;
    use crate::model::fixture;

    #[test]
    fn a_chain_comes_to_the_constants_of_one_that_is_as_stiff_from_the_beginning() {
        let (change, after) = (-0.3, 20.0);
        for (law, tension) in [(ContactLaw::KelvinVoigt, 500.0), (ContactLaw::HuntCrossley, -40.0)] {
            let mut input = Simulation::new(&compile(fixture::rectangle(20.0, 12.0, 4.0)));
            (input.contact_law, input.chain.tension_n, input.joint.axial.exponent) = (law, tension, 1.2);
            let deviations = Deviations { warming: Warming { change, after }, ..Deviations::default() };
            let model = Model::new(&input, deviations).expect("a model");
            let cold = Cold::new(&model).expect("it warms");
            let mut chain = Chain::new(Arc::new(model), 0.0, Width::widest()).expect("a chain");
            for time in [0.0, 7.0, 1e4] {
                cold.warm(&mut chain, time);
                let factor = 1.0 + change * (1.0 - trig::exp(-time / after));
                let mut other = input.clone();
                for contact in [
                    &mut other.joint.axial,
                    &mut other.joint.radial,
                    &mut other.steering_wheel.contact,
                    &mut other.running_wheel.contact,
                ] {
                    contact.stiffness_n_per_m_n *= factor;
                }
                let expected = Model::new(&other, Deviations::default()).expect("a model");
                let of = |model: &Model| {
                    let contacts = [model.steering.contact, model.running.contact, model.axial, model.radial];
                    let constants = contacts.into_iter().flat_map(|c| [c.stiffness, c.viscosity, c.factor]);
                    constants.chain([model.cart.length, model.breaking]).collect::<Vec<f64>>()
                };
                for (own, expected) in of(&chain.model).into_iter().zip(of(&expected)) {
                    assert!((own - expected).abs() <= 1e-12 * expected.abs(), "{time}: {own} for {expected}");
                }
            }
        }
    }

    #[test]
    fn a_chain_that_does_not_warm_is_left_alone() {
        let input = Simulation::new(&compile(fixture::rectangle(20.0, 12.0, 4.0)));
        assert!(Cold::new(&Model::new(&input, Deviations::default()).expect("a model")).is_none());
    }
}
