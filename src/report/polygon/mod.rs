//! `polygon.json` and what people read of it: the polygon action of a layout, straight by straight and curve by curve.

mod names;
mod page;
mod table;
mod verify;
mod verify_page;
mod words;

mod drawing;
#[cfg(test)]
mod tests;

pub use drawing::polygon as drawing;
pub use names::Names;
pub use page::page;
pub use table::{sweep_text, text};
pub use verify::{Case, Force, Verification, case_name, verify_text};
pub use verify_page::page as verify_page;

use crate::base::number::tidy;
use crate::base::trig;
use crate::geometry::{CentreLine, Form};
use crate::kinematics::polygon::{
    Action, Course, CurvePhasor, Phasor, PolygonObjective, Unsuited, action, by_chance, curve_phasor, straight_behind,
    superposed,
};
use crate::solve::polygon::least_action;
use schemars::JsonSchema;
use serde::Serialize;

/// The polygon action of a layout. Lengths of deviations are mm, peak to peak, and values sums of their squares, mm².
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(title = "lss polygon action")]
pub struct PolygonReport {
    /// The layout's name.
    pub layout: String,
    /// Distance between a cart's joints, m.
    pub cart_length_m: f64,
    /// Length of the centre line, m.
    pub track_length_m: f64,
    /// What `value` counts: `all`, `first_three` or `last`.
    pub objective: &'static str,
    /// Sum of the squares of what counts, mm².
    pub value: f64,
    /// What no layout with these curves in this order is below, whatever its straights, mm².
    pub lower_bound: f64,
    /// The value of each objective, mm².
    pub values: Values,
    /// The same of the first harmonics, mm².
    pub first_harmonic_values: Values,
    /// Straights in driving order; row and column k of the matrices.
    pub straights: Vec<Straight>,
    /// Curve k lies ahead of straight k.
    pub curves: Vec<CurveReport>,
    /// What cancels what, in words.
    pub notes: Vec<String>,
    /// ΔP of a straight (column) when the chain starts on another (row), mm.
    pub delta_p_mm: Vec<Vec<f64>>,
    /// Peak to peak of the first harmonic alone, mm.
    pub first_harmonic_mm: Vec<Vec<f64>>,
}

/// A value for each objective.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Values {
    /// Every straight from every start, mm².
    pub all: f64,
    /// Behind the first three curves from each start, mm².
    pub first_three: f64,
    /// Of the last cart, mm².
    pub last: f64,
}

/// A straight.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Straight {
    /// `P1..P2`
    pub name: String,
    /// Arc length where it begins, m.
    pub s_m: f64,
    /// m
    pub length_m: f64,
    /// Root mean square of ΔP over the starting straights, mm.
    pub rms_mm: f64,
    /// Largest ΔP, mm.
    pub worst_mm: f64,
    /// The start it is largest from.
    pub worst_from: String,
}

/// A curve.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CurveReport {
    /// The vertex, or where it is.
    pub name: String,
    /// Arc length where it begins, m.
    pub s_m: f64,
    /// m
    pub length_m: f64,
    /// Its length in carts: near a whole number its ends cancel each other.
    pub carts: f64,
    /// ΔP of the curve alone, mm.
    pub alone_mm: f64,
    /// ΔP at its most, when its ends add up: 0.0226 L³/R², mm; `null` where it is more than one arc.
    pub most_mm: Option<f64>,
    /// Phase of its first harmonic against that of the next curve behind it on the chain, deg in (−180, 180]: 180
    /// cancels.
    pub phase_to_next_deg: f64,
    /// Its share of the first harmonics' value: below 0 it cancels more than it adds.
    pub share: f64,
}

/// Peak to peak of a curve whose ends add up, in L³/R² (design: chain model).
const WHOLE_CURVE: f64 = 0.0226;

impl PolygonReport {
    /// Of carts of length `pitch` (m) on a centre line.
    ///
    /// # Errors
    /// [`Unsuited`] where the track has no straight or no curve, or a cart does not fit.
    pub fn new(
        layout: &str,
        line: &CentreLine,
        pitch: f64,
        objective: PolygonObjective,
        names: &Names,
    ) -> Result<Self, Unsuited> {
        let course = Course::new(line)?;
        let n = course.len();
        let action = action(&course, pitch)?;
        let phasors: Vec<CurvePhasor> = (0..n).map(|k| curve_phasor(&course, k, pitch)).collect::<Result<_, _>>()?;
        let alone: Vec<f64> = phasors.iter().map(|p| p.delta_p).collect();
        let parts = superposed(&course, &phasors, pitch);
        let curve_names = names.curves(line, &course);
        let straight_names = names.straights(&course, &curve_names);
        let shares = shares(&parts, objective);
        let curve = |k: usize| {
            // Seen from the straight ahead, this curve and the next behind it are the first and second.
            let seen = &parts[(k + 1) % n];
            let [own, next] = [0, 1].map(|m| seen.get(m).copied().unwrap_or(seen[0]));
            CurveReport {
                name: curve_names[k].clone(),
                s_m: tidy(course.curves[k].s),
                length_m: tidy(course.curves[k].length()),
                carts: tidy(course.curves[k].length() / pitch),
                alone_mm: tidy(1e3 * phasors[k].delta_p),
                most_mm: most(&course.curves[k].forms, pitch).map(|x| tidy(1e3 * x)),
                phase_to_next_deg: tidy(angle(next, own) * 180.0 / trig::PI),
                share: tidy(shares[k]),
            }
        };
        let curves: Vec<CurveReport> = (0..n).map(curve).collect();
        let matrix = |of: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
            (0..n).map(|i| (0..n).map(|j| tidy(1e3 * of(i, j))).collect()).collect()
        };
        let delta_p_mm = matrix(&|i, j| action.delta_p[i][j]);
        let straights: Vec<Straight> = (0..n).map(|j| straight(&course, &straight_names, &delta_p_mm, j)).collect();
        let notes = words::notes(&curves, &straights, &parts, &action, objective);
        Ok(PolygonReport {
            layout: layout.to_owned(),
            cart_length_m: tidy(pitch),
            track_length_m: tidy(line.length),
            objective: objective.name(),
            value: square_mm(action.value(objective)),
            lower_bound: square_mm(least_action(&alone, objective).unwrap_or(0.0)),
            values: Values::of(|o| action.value(o)),
            first_harmonic_values: Values::of(|o| action.smooth(o)),
            straights,
            curves,
            notes,
            first_harmonic_mm: matrix(&|i, j| 2.0 * action.first[i][j].norm_sqr().sqrt()),
            delta_p_mm,
        })
    }

    /// `{"objective","value","delta_p_mm"}` on one line.
    pub fn short_json(&self) -> String {
        #[derive(Serialize)]
        struct Short<'a> {
            objective: &'a str,
            value: f64,
            delta_p_mm: &'a [Vec<f64>],
        }
        let short = Short { objective: self.objective, value: self.value, delta_p_mm: &self.delta_p_mm };
        serde_json::to_string(&short).unwrap_or_default() + "\n"
    }
}

impl Values {
    fn of(value: impl Fn(PolygonObjective) -> f64) -> Self {
        let [all, first_three, last] = PolygonObjective::EACH.map(|o| square_mm(value(o)));
        Values { all, first_three, last }
    }

    /// That of one objective, mm².
    pub fn get(&self, objective: PolygonObjective) -> f64 {
        match objective {
            PolygonObjective::All => self.all,
            PolygonObjective::FirstThree => self.first_three,
            PolygonObjective::Last => self.last,
        }
    }
}

/// m² as mm².
fn square_mm(value: f64) -> f64 {
    tidy(1e6 * value)
}

fn straight(course: &Course, names: &[String], delta_p_mm: &[Vec<f64>], j: usize) -> Straight {
    let column = || delta_p_mm.iter().map(|row| row[j]);
    let (from, worst) = column().enumerate().fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
    let mean_square = column().map(|x| x * x).sum::<f64>() / delta_p_mm.len() as f64;
    Straight {
        name: names[j].clone(),
        s_m: tidy(course.begins[j]),
        length_m: tidy(course.straights[j].0),
        rms_mm: tidy(mean_square.sqrt()),
        worst_mm: worst,
        worst_from: names[from].clone(),
    }
}

/// Share of each curve in Σ 4|H|² of what counts, H being the sum of the parts before it: the projection of its part on
/// H. They add up to 1.
fn shares(parts: &[Vec<Phasor>], objective: PolygonObjective) -> Vec<f64> {
    let n = parts.len();
    let mut shares = vec![0.0; n];
    let mut whole = 0.0;
    for (i, parts) in parts.iter().enumerate() {
        let mut sum = Phasor::default();
        for m in 0..n {
            sum += parts[m];
            if !objective.counts(m + 1, n) {
                continue;
            }
            whole += sum.norm_sqr();
            for (earlier, part) in parts[..=m].iter().enumerate() {
                shares[straight_behind(i, earlier + 1, n)] += part.re * sum.re + part.im * sum.im;
            }
        }
    }
    shares.iter().map(|s| if whole > 0.0 { s / whole } else { 0.0 }).collect()
}

/// ΔP of an arc whose ends add up, m.
fn most(forms: &[Form], pitch: f64) -> Option<f64> {
    let radius = |form: &Form| if let Form::Arc { radius, .. } = form { Some(*radius) } else { None };
    let first = radius(forms.first()?)?;
    forms.iter().all(|f| radius(f).is_some()).then(|| WHOLE_CURVE * pitch * pitch * pitch / (first * first))
}

/// Angle from one phasor to another, rad in (−π, π]; 0 where either has no size.
fn angle(to: Phasor, from: Phasor) -> f64 {
    let between = to * from.conj();
    if between.norm_sqr() == 0.0 { 0.0 } else { trig::atan2(between.im, between.re) }
}

/// Lengths of the product line's carts, mm (thesis §1.2).
pub const PRODUCT_LINE: std::ops::RangeInclusive<u32> = 500..=1250;

/// Value of each cart length that is tried.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Sweep {
    /// The layout's name.
    pub layout: String,
    /// What was varied: `cart.length`.
    pub parameter: String,
    /// `all`, `first_three` or `last`.
    pub objective: &'static str,
    /// In ascending order.
    pub points: Vec<SweepPoint>,
}

/// A cart length with what it gives.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SweepPoint {
    /// m
    pub cart_length_m: f64,
    /// Number of carts that comes nearest to closing.
    pub carts: usize,
    /// What the chain lacks to the centre line, m.
    pub left_over_m: f64,
    /// The objective, mm²; `null` where a cart does not fit the curves.
    pub value: Option<f64>,
    /// Root mean square of the ΔP that count, mm.
    pub rms_mm: Option<f64>,
    /// Root mean square of ΔP over what the same curves would have if none cancelled another: below 1 they cancel.
    pub against_chance: Option<f64>,
}

/// Root mean square of what an objective counts among n straights, mm.
pub fn rms(value: f64, objective: PolygonObjective, n: usize) -> f64 {
    let counted = (1..=n).filter(|m| objective.counts(*m, n)).count() * n;
    (value / counted.max(1) as f64).sqrt()
}

/// The two summaries that a sweep needs.
pub fn summary(line: &CentreLine, pitch: f64, objective: PolygonObjective) -> Result<(Action, f64), Unsuited> {
    let course = Course::new(line)?;
    let action = action(&course, pitch)?;
    let curves: Vec<CurvePhasor> =
        (0..course.len()).map(|k| curve_phasor(&course, k, pitch)).collect::<Result<_, _>>()?;
    Ok((action, by_chance(&curves, objective)))
}
