//! Wheels and joints that soften as they warm: every stiffness is K (1 + change), and the damping of a contact in
//! proportion (Ferry 1980: polymers' moduli fall with temperature). With a time constant, `after`, a run begins with K
//! and comes to K (1 + change (1 − exp(−t/after))): the temperature of a body that warms evenly follows such a law of the
//! first order (Incropera, DeWitt, Bergman and Lavine 2007, lumped capacitance), and a modulus is linear in a small
//! change of it.
//!
//! Signature: fluctuation at the carts' passing, less in stiff channels than in soft ones; while it warms, less where a
//! run begins than where it ends.

use super::sites::Site;
use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths};
use crate::chain_input::{DeclaredEffect, Deviations, Simulation, Warming};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::STIFFNESS_TEMPERATURE,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(0.1, 0.01)],
    sites: Sites::Listed(times),
    separated_by: Experiment::Tension,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

/// Time constants that are looked for beside 0, in times of a lap: from one that is over soon to one with which stiffness
/// goes nearly linearly with time.
const AFTER: [f64; 4] = [0.25, 0.5, 1.0, 2.0];

fn times(simulation: &Simulation) -> Vec<Site> {
    let lap = simulation.track.centre_line().length / simulation.chain.speed_m_s;
    let warming = |laps: f64| {
        let after = (laps * lap).round().max(1.0);
        let words = format!("coming up in a run, with a time constant of {after:.0} s");
        Site { words, fixed: vec![("after", after)] }
    };
    let constant = Site { words: String::new(), fixed: Vec::new() };
    [constant].into_iter().chain(AFTER.map(warming)).collect()
}

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let (change, after) = (strengths.of("change"), strengths.of("after"));
    if after > 0.0 {
        deviations.warming = Warming { change, after };
        return;
    }
    let factor = 1.0 + change;
    for contact in [
        &mut simulation.joint.axial,
        &mut simulation.joint.radial,
        &mut simulation.steering_wheel.contact,
        &mut simulation.running_wheel.contact,
    ] {
        contact.stiffness_n_per_m_n *= factor;
    }
}

/// How stiffness comes up in a run, where an effect says that it does.
pub fn warming(effect: &DeclaredEffect) -> Option<Warming> {
    let after = effect.strengths.get("after").copied().filter(|after| *after > 0.0 && effect.name == EFFECT.name())?;
    Some(Warming { change: effect.strengths.get("change").copied().unwrap_or(0.0), after })
}

/// Effects with a stiffness that does not change in a run, but has a share of what its change comes to: for chains whose
/// carts are laps, which no time of a run belongs to.
pub fn at_rest(effects: &[DeclaredEffect], share: impl Fn(Warming) -> f64) -> Vec<DeclaredEffect> {
    let one = |effect: &DeclaredEffect| {
        let mut effect = effect.clone();
        if let Some(warming) = warming(&effect) {
            effect.strengths.remove("after");
            effect.strengths.insert("change".to_owned(), warming.change * share(warming));
        }
        effect
    };
    effects.iter().map(one).collect()
}
