//! The nominal chain fitted to a run, and what its sensors reach.

use super::force_slope::profiles;
use super::impacts::{self, HighFrequencyPower};
use super::pass_times::PassTimes;
use super::{FittedRun, drift};
use crate::base::trig;
use crate::chain_input::{DeclaredEffect, Simulation};
use crate::dynamics::Width;
use crate::effects::{is_of_machine, stiffness_temperature};
use crate::gap::settings;
use crate::gap::simulator::Band;
use crate::identify::feature_spec::Samples;
use crate::identify::fit::{Landing, land};
use crate::identify::model::Coordinates;
use crate::identify::noise::Noise;
use crate::identify::study::Subject;
use crate::identify::{FitSettings, Measured, Model, Parameter};
use crate::signal::FORCES;

/// What the nominal model is made of. Effects of the machine that a layout has are part of it; those of sensors are left
/// out, as the diagnosis looks for them anyway.
pub(super) fn without_sensors_effects(simulation: &Simulation) -> Simulation {
    let mut simulation = simulation.clone();
    simulation.effects.retain(is_of_machine);
    simulation
}

/// Where the parameters of a run are known to be, and its sensors' noise.
#[derive(Clone, Copy)]
pub struct Known {
    pub at: Coordinates,
    noise: [Noise; FORCES],
}

impl Known {
    /// With so much correlated noise of those sensors that had more.
    pub fn quieter(&mut self, correlated: &[Noise; FORCES]) {
        for (own, less) in self.noise.iter_mut().zip(correlated) {
            if less.correlated_variance() < own.correlated_variance() {
                own.processes = less.processes;
            }
        }
    }
}

/// Fits the nominal model to a run, or takes it where its parameters are known to be.
pub fn fitted(
    subject: &Subject,
    fit: &FitSettings,
    settings: &settings::Chain,
    width: Width,
    known: Option<&Known>,
) -> Result<FittedRun, String> {
    let (measured, mut model) = ready(subject, width)?;
    let known = match known {
        Some(known) => Some(*known),
        None => match drift::taken_off(&measured, model.spec.places.lap) {
            Some(run) => {
                let found = land(&mut model, &run, None, fit)?.0;
                Some(Known { at: found.at, noise: found.noise })
            }
            None => None,
        },
    };
    let landing = match known {
        None => land(&mut model, &measured, None, fit)?.1,
        Some(known) => {
            let here = FitSettings { steps: 0, noise: Some(known.noise), numerics: true, ..*fit };
            land(&mut model, &measured, Some(known.at), &here)?.1
        }
    };
    Ok(of(model, landing, &measured, fit, settings))
}

/// Fits the nominal model with effects to a run, from where its parameters are known to be nearly.
pub fn fitted_with(
    subject: &Subject,
    fit: &FitSettings,
    settings: &settings::Chain,
    width: Width,
    effects: &[DeclaredEffect],
    near: Option<&Known>,
) -> Result<(FittedRun, Known), String> {
    let (measured, mut model) = ready(subject, width)?;
    let measured = drift::taken_off(&measured, model.spec.places.lap).unwrap_or(measured);
    let duration = measured.duration(model.spec.places.lap);
    model.simulation.effects.extend(stiffness_temperature::at_rest(effects, |warming| warming.mean_share(duration)));
    let (found, landing) = land(&mut model, &measured, near.map(|known| known.at), fit)?;
    Ok((of(model, landing, &measured, fit, settings), Known { at: found.at, noise: found.noise }))
}

/// A run made ready, and the nominal model with the features that a diagnosis compares.
pub(super) fn ready(subject: &Subject, width: Width) -> Result<(Measured, Model), String> {
    let lap = subject.simulation.track.centre_line().length;
    let measured = Measured::new(&subject.run, &subject.simulation, lap)?;
    let simulation = without_sensors_effects(&subject.simulation);
    let mut model = Model::new(&simulation, simulation.contact_law, &measured, width);
    let speed = measured.speed();
    let turning: Vec<f64> = orders(&simulation, speed).into_iter().map(|(hz, _)| hz).collect();
    model.spec.set_orders(&turning);
    model.spec.local = true;
    Ok((measured, model))
}

/// What of a fit the diagnosis needs.
fn of(model: Model, landing: Landing, measured: &Measured, fit: &FitSettings, settings: &settings::Chain) -> FittedRun {
    let lap = model.spec.places.lap;
    let samples = measured.samples();
    let trigger = landing.at[Parameter::TriggerPosition.index()];
    let speed = trig::exp(landing.at[Parameter::Speed.index()]);
    let parts = impacts::parts(lap, settings.impacts.part);
    FittedRun {
        laps: measured.laps,
        pass_times: PassTimes::new(&samples, measured.rate, (lap, speed, trigger)),
        tops: [0.0; FORCES],
        highs: highs(&landing, &samples, settings.ensembles.top_samples),
        high_frequency_power: HighFrequencyPower::each(
            &landing,
            lap,
            (&samples, trigger),
            *model.spec.noise(),
            &settings.impacts,
        ),
        profiles: profiles(&samples, (lap, parts), trigger),
        impacts: Vec::new(),
        settings: settings.clone(),
        measured: std::array::from_fn(|k| measured.has(k)),
        drifts: drift::rates(&samples, lap, measured.rate),
        orders: orders(&model.simulation, measured.speed()).into_iter().map(|(_, band)| band).collect(),
        seed: fit.seed.wrapping_add(77),
        model,
        landing,
    }
}

/// Of each channel the force that so many samples of a run exceed, measured and simulated.
fn highs(landing: &Landing, measured: &Samples, samples: usize) -> [(f64, f64); FORCES] {
    let high = |mut all: Vec<f32>, rank: usize| {
        all.retain(|x| x.is_finite());
        let rank = rank.min(all.len().saturating_sub(1));
        if all.is_empty() { 0.0 } else { f64::from(*all.select_nth_unstable_by(rank, |a, b| b.total_cmp(a)).1) }
    };
    std::array::from_fn(|k| {
        let run = measured.forces[k].to_vec();
        let ensemble: Vec<f32> = landing.centre.ensemble.carts.iter().flat_map(|c| &c.forces[k]).copied().collect();
        let rank = samples * ensemble.len() / run.len().max(1);
        (high(run, samples), high(ensemble, rank))
    })
}

/// The largest forces of channels that do not clip, so that at the loss which the runs have on average each ends where
/// it was measured to: an amplifier's end is one force, whatever a run's largest.
pub fn set_tops(runs: &mut [FittedRun]) {
    for k in 0..FORCES {
        let known: Vec<(f64, f64)> = runs.iter().map(|r| r.highs[k]).filter(|(m, s)| *m > 0.0 && *s > 0.0).collect();
        let mean = known.iter().map(|(m, s)| 1.0 - m / s).sum::<f64>() / known.len().max(1) as f64;
        let loss = mean.clamp(0.0, 0.9);
        for run in runs.iter_mut() {
            let (measured, simulated) = run.highs[k];
            run.tops[k] = if measured > 0.0 { measured / (1.0 - loss) } else { simulated };
        }
    }
}

/// Orders of wheels, once to six times a turn, and of motors' ripple, Hz, with what each is of.
fn orders(simulation: &Simulation, speed: f64) -> Vec<(f64, Band)> {
    let radii = [simulation.steering_wheel.radius_m, simulation.running_wheel.radius_m];
    let turning =
        radii.into_iter().flat_map(|radius| (1..=6).map(move |n| f64::from(n) * speed / (trig::TAU * radius)));
    let ripple = [0.5, 0.2, 0.1, 0.05].map(|share| speed / (share * simulation.motors.length_m));
    let all = turning.map(|hz| (hz, Band::Wheel)).chain(ripple.map(|hz| (hz, Band::Motor)));
    all.filter(|(hz, _)| *hz < 0.4 * simulation.sensor.rate_hz).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::model::fixture;

    #[test]
    fn an_order_is_of_what_turns_so_fast() {
        let mut simulation = Simulation::new(&compile(fixture::rectangle(20.0, 12.0, 4.0)));
        let of = |simulation: &Simulation, band: Band| {
            let all = orders(simulation, 2.0).into_iter().filter(move |(_, own)| *own == band);
            all.map(|(hz, _)| hz).collect::<Vec<f64>>()
        };
        simulation.sensor.rate_hz = 1e6;
        assert_eq!((of(&simulation, Band::Wheel).len(), of(&simulation, Band::Motor).len()), (12, 4));
        // What is too fast for the sensors is left out, of wheels too.
        let third = 3.0 * 2.0 / (trig::TAU * simulation.steering_wheel.radius_m);
        simulation.sensor.rate_hz = third / 0.39;
        let wheels = of(&simulation, Band::Wheel);
        assert!(wheels.len() < 12 && wheels.iter().all(|hz| *hz < third / 0.39 * 0.4), "{wheels:?}");
        let motors = of(&simulation, Band::Motor);
        let length = simulation.motors.length_m;
        assert!(!motors.is_empty() && (motors[0] - 2.0 / (0.5 * length)).abs() < 1e-12, "{motors:?}");
    }
}
