//! What runs can tell of the parameters, and what they cannot, in words.

use super::parameter::{COUNT, Parameter};
use super::posterior::correlations;
use crate::base::number::{fixed, trimmed};
use crate::base::words::list;
use nalgebra::DMatrix;

/// Share of the prior's deviation above which a run has said almost nothing.
const NOTHING: f64 = 0.8;

/// Correlation above which two parameters are hardly told apart.
const TOGETHER: f64 = 0.9;

/// Deviation of the floor of approach speeds believed before, as the logarithm of a factor.
const FLOOR_PRIOR: f64 = 0.5;

/// What a run's information means. `information` is in coordinates divided by `reach`, the floor of approach speeds
/// last; `prior` the deviations believed before, in the same.
pub fn identifiability(
    information: &DMatrix<f64>,
    prior: &[f64; COUNT],
    reach_of_floor: f64,
    free: &[bool; COUNT],
) -> Vec<String> {
    let mut said = Vec::new();
    let open: Vec<Parameter> = Parameter::ALL.into_iter().filter(|p| free[p.index()]).collect();
    let posterior = |with_floor: bool| {
        let n = open.len() + usize::from(with_floor);
        let index = |i: usize| open.get(i).map_or(COUNT, |p| p.index());
        let deviation = |i: usize| open.get(i).map_or(FLOOR_PRIOR / reach_of_floor, |p| prior[p.index()]);
        let precision = DMatrix::from_fn(n, n, |i, j| {
            let own = if i == j { 1.0 / (deviation(i) * deviation(i)) } else { 0.0 };
            information[(index(i), index(j))] + own
        });
        precision.cholesky().map(|c| c.inverse())
    };
    let (Some(known), Some(unknown)) = (posterior(false), posterior(true)) else { return said };
    let share: Vec<f64> = open.iter().enumerate().map(|(i, p)| known[(i, i)].sqrt() / prior[p.index()]).collect();
    let silent: Vec<&str> = (0..open.len()).filter(|i| share[*i] > NOTHING).map(|i| open[i].name()).collect();
    if !silent.is_empty() {
        said.push(format!(
            "the run says almost nothing of {}: what is given is what was believed before",
            list(&silent, "and")
        ));
    }
    let together = correlations(&known);
    for i in 0..open.len() {
        for j in 0..i {
            let r = together[(i, j)];
            if r.abs() > TOGETHER && share[i] < NOTHING && share[j] < NOTHING {
                let how = if r > 0.0 { "rise together" } else { "make up for each other" };
                said.push(format!("{} and {} {how} (correlation {})", open[j].name(), open[i].name(), fixed(r, 2)));
            }
        }
    }
    for (i, p) in open.iter().enumerate() {
        let wider = (unknown[(i, i)] / known[(i, i)]).sqrt();
        if wider > 1.5 && share[i] < NOTHING {
            said.push(format!(
                "{} is told apart from the floor of approach speeds only because that is taken as known: otherwise its \
                 interval would be {} times as wide",
                p.name(),
                trimmed(wider, 1)
            ));
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_company_and_the_floor_are_said() {
        let mut information = DMatrix::zeros(COUNT + 1, COUNT + 1);
        let mut put = |i: usize, j: usize, x: f64| {
            information[(i, j)] = x;
            information[(j, i)] = x;
        };
        (0..COUNT).for_each(|k| put(k, k, 100.0));
        put(9, 9, 0.01);
        put(0, 1, 99.0);
        // Steering moves as the floor does.
        put(COUNT, COUNT, 100.0);
        put(2, COUNT, 99.9);
        let said = identifiability(&information, &[2.0; COUNT], 0.35, &[true; COUNT]);
        assert_eq!(said.len(), 3, "{said:?}");
        assert!(said[0].contains("almost nothing of k_i"));
        assert!(said[1].starts_with(
            "restitution_joint_axial and restitution_joint_radial make up for each other (correlation -0.9"
        ));
        assert!(said[2].starts_with("restitution_steering is told apart from the floor"));
    }
}
