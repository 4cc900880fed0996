//! Linear programs that are small and solved whole, by Clarabel's interior-point method.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// A row: the sum of `coefficients` (variable, factor) is at most `most`.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub coefficients: Vec<(usize, f64)>,
    pub most: f64,
}

/// Variables of 0 or more with the largest objective, to a relative 1e-9; of several that are as good, the middle of them.
/// `None` where the rows contradict each other, do not bound the objective, or the numerics fail.
pub fn maximise(objective: &[f64], rows: &[Row]) -> Option<Vec<f64>> {
    let n = objective.len();
    let count = rows.len() + n;
    let (mut at, mut of, mut factors) = (Vec::new(), Vec::new(), Vec::new());
    let mut push = |row: usize, variable: usize, factor: f64| {
        at.push(row);
        of.push(variable);
        factors.push(factor);
    };
    for (r, row) in rows.iter().enumerate() {
        row.coefficients.iter().for_each(|(k, a)| push(r, *k, *a));
    }
    (0..n).for_each(|k| push(rows.len() + k, k, -1.0));
    let a = CscMatrix::new_from_triplets(count, n, at, of, factors);
    let b: Vec<f64> = rows.iter().map(|row| row.most).chain(std::iter::repeat_n(0.0, n)).collect();
    let linear: Vec<f64> = objective.iter().map(|c| -c).collect();
    let cones = [SupportedConeT::NonnegativeConeT(count)];
    let mut solver = DefaultSolver::new(&CscMatrix::zeros((n, n)), &linear, &a, &b, &cones, settings()).ok()?;
    solver.solve();
    let usable = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    usable.then(|| solver.solution.x.iter().map(|x| x.max(0.0)).collect())
}

/// Clarabel as it is used here: to 1e-10, on one thread, with nothing removed before.
pub fn settings() -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-10,
        tol_gap_rel: 1e-10,
        tol_feas: 1e-10,
        presolve_enable: false,
        direct_solve_method: "qdldl".into(),
        ..Default::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(coefficients: &[f64], most: f64) -> Row {
        Row { coefficients: coefficients.iter().copied().enumerate().collect(), most }
    }

    #[test]
    fn a_program_by_hand() {
        // Dantzig (1963): the corner (2, 6) of x <= 4, 2 y <= 12, 3 x + 2 y <= 18.
        let rows = [row(&[1.0, 0.0], 4.0), row(&[0.0, 2.0], 12.0), row(&[3.0, 2.0], 18.0)];
        let x = maximise(&[3.0, 5.0], &rows).unwrap();
        assert!((x[0] - 2.0).abs() < 1e-7 && (x[1] - 6.0).abs() < 1e-7, "{x:?}");
    }

    #[test]
    fn of_equals_it_takes_the_middle() {
        let x = maximise(&[1.0, 1.0], &[row(&[1.0, 1.0], 2.0)]).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-6 && (x[1] - 1.0).abs() < 1e-6, "{x:?}");
    }

    #[test]
    fn what_has_no_end_or_no_answer_is_none() {
        assert_eq!(maximise(&[1.0], &[]), None);
        assert_eq!(maximise(&[1.0], &[row(&[1.0], -1.0)]), None);
    }
}
