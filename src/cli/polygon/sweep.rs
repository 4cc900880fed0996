//! `lss polygon FILE --sweep cart.length`: the product line's carts on one track.

use super::{Polygon, Subject};
use crate::base::json;
use crate::base::number::tidy;
use crate::cli::{Outcome, OutputFormat, could_not, report};
use crate::emit::Files;
use crate::geometry::CentreLine;
use crate::kinematics::closing;
use crate::kinematics::polygon::{Course, PolygonObjective};
use crate::report::polygon::{PRODUCT_LINE, Sweep, SweepPoint, rms, summary, sweep_text};

const STEP: usize = 50;
/// Phases that a closing pitch is averaged over (design: chain model).
const PHASES: usize = 16;

impl Polygon {
    pub(super) fn sweep(&self, subject: &Subject) -> Outcome {
        // Where no cart fits at all, that is an error as without a sweep.
        if let Err(why) = Course::new(&subject.line) {
            return self.unsuited(why);
        }
        let point = |mm: u32| point(&subject.line, f64::from(mm) / 1e3, self.objective);
        let sweep = Sweep {
            layout: subject.name.clone(),
            parameter: "cart.length".to_owned(),
            objective: self.objective.name(),
            points: PRODUCT_LINE.step_by(STEP).map(point).collect(),
        };
        if let Some(folder) = &self.output {
            let mut files = Files::default();
            files.push("polygon-sweep.json", json::to_json(&sweep));
            if let Err(error) = files.write(folder) {
                return could_not("write", &error.path, &error.reason);
            }
        }
        report::print(&match self.format {
            OutputFormat::Json => serde_json::to_string(&sweep).unwrap_or_default() + "\n",
            OutputFormat::Text => sweep_text(&sweep) + &report::written_to(self.output.as_deref()),
        });
        Outcome::Clean
    }
}

fn point(line: &CentreLine, pitch: f64, objective: PolygonObjective) -> SweepPoint {
    let (carts, left_over) = carts(line, pitch);
    let found = summary(line, pitch, objective).ok();
    let value = found.as_ref().map(|(action, _)| action.value(objective));
    SweepPoint {
        cart_length_m: pitch,
        carts,
        left_over_m: tidy(left_over),
        value: value.map(|v| tidy(1e6 * v)),
        rms_mm: found.as_ref().map(|(a, _)| tidy(rms(1e6 * a.value(objective), objective, a.delta_p.len()))),
        against_chance: found.map(|(a, chance)| tidy((a.value(objective) / chance).sqrt())),
    }
}

/// How many carts come nearest to closing, and what they lack, m.
fn carts(line: &CentreLine, pitch: f64) -> (usize, f64) {
    let near = (line.length / pitch).round().max(3.0) as usize;
    let lacks = |carts: usize| -> Option<f64> {
        let pitches: Option<Vec<f64>> =
            (0..PHASES).map(|k| closing(line, carts, pitch * k as f64 / PHASES as f64).ok().map(|c| c.pitch)).collect();
        let mean = pitches?.iter().sum::<f64>() / PHASES as f64;
        Some((mean - pitch) * carts as f64)
    };
    let all = near.saturating_sub(1)..=near;
    let best = all.filter_map(|n| lacks(n).map(|x| (n, x))).min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    best.unwrap_or((near, line.length - pitch * near as f64))
}
