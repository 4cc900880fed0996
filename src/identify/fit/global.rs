//! The global stage: what would fool a local one is found roughly first (noise, trigger, tension).

use super::Fitter;
use crate::dynamics::Fleet;
use crate::geometry::trig;
use crate::identify::floor::Floor;
use crate::identify::local::Centre;
use crate::identify::model::{Coordinates, Model};
use crate::identify::parameter::Parameter;
use crate::identify::summary::{FORCES, Summary};

impl Fitter<'_> {
    /// Finds the sensors' noise: what is measured above the low-pass and not simulated there.
    pub(super) fn listen(&self, model: &mut Model, fleet: &Fleet) {
        let simulated = model.answer(fleet, 0.0, 0).summary;
        let mut measured = Summary::new(&model.recipe);
        measured.add(&model.recipe, &self.measured.samples(), 0.0, None);
        let ((a, share), (b, _)) = (measured.high_power(&model.recipe), simulated.high_power(&model.recipe));
        for k in 0..FORCES {
            let variance = if share > 0.0 { (a[k] - b[k]).max(0.0) / share } else { 0.0 };
            model.recipe.noise[k] = variance.sqrt() as f32;
        }
    }

    /// The global stage for the trigger: where the means along the track fit best, whatever their level.
    pub(super) fn place(&self, model: &Model, at: &mut Coordinates, centre: &Centre, floor: &Floor) {
        let k = Parameter::TriggerPosition.index();
        if !self.settings.free[k] {
            return;
        }
        let places = &model.recipe.places;
        let samples = self.measured.samples();
        let apart = |trigger: f64| {
            let mut summary = Summary::new(&model.recipe);
            summary.add_places(&model.recipe, &samples, trigger);
            let features = summary.features(1.0);
            let mut sum = 0.0;
            for force in 0..FORCES {
                let rows = force * places.cells..(force + 1) * places.cells;
                let difference: Vec<f64> = rows
                    .map(|i| (features[i] - centre.answer.features[i]) / floor.deviation[i])
                    .filter(|x| x.is_finite())
                    .collect();
                let mean = difference.iter().sum::<f64>() / difference.len().max(1) as f64;
                sum += difference.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            }
            sum
        };
        let (low, high) = model.range(Parameter::TriggerPosition);
        let mut best = (at[k], apart(at[k]));
        for reach in [high - low, 0.4, 0.08] {
            let from = best.0;
            for i in -20..=20 {
                let trigger = (from + 0.5 * reach * f64::from(i) / 20.0).clamp(low, high);
                let cost = apart(trigger);
                if cost < best.1 {
                    best = (trigger, cost);
                }
            }
        }
        at[k] = best.0;
    }

    /// The global stage for the tension: in proportion to the joint's mean force. Whether it moved much.
    pub(super) fn tighten(&self, model: &Model, at: &mut Coordinates, centre: &Centre) -> bool {
        let k = Parameter::Tension.index();
        let mut measured = Summary::new(&model.recipe);
        measured.add_places(&model.recipe, &self.measured.samples(), 0.0);
        let (Some(found), Some(simulated)) = (measured.mean(4), centre.answer.summary.mean(4)) else { return false };
        if !self.settings.free[k] || found <= 0.0 || simulated <= 0.0 {
            return false;
        }
        let step = trig::ln(found / simulated).clamp(-1.0, 1.0);
        let (low, high) = model.range(Parameter::Tension);
        at[k] = (at[k] + step).clamp(low, high);
        step.abs() > 0.02
    }
}
