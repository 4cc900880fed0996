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
    let mut entries: Vec<(usize, usize, f64)> = Vec::new();
    for (r, row) in rows.iter().enumerate() {
        entries.extend(row.coefficients.iter().map(|(k, a)| (*k, r, *a)));
    }
    entries.extend((0..n).map(|k| (k, rows.len() + k, -1.0)));
    entries.sort_unstable_by_key(|(column, row, _)| (*column, *row));
    let mut starts = vec![0; n + 1];
    entries.iter().for_each(|(column, ..)| starts[column + 1] += 1);
    (0..n).for_each(|k| starts[k + 1] += starts[k]);
    let (indices, values) = entries.iter().map(|(_, row, value)| (*row, *value)).unzip();
    let count = rows.len() + n;
    let a = CscMatrix::new(count, n, starts, indices, values);
    let b: Vec<f64> = rows.iter().map(|row| row.most).chain(std::iter::repeat_n(0.0, n)).collect();
    let linear: Vec<f64> = objective.iter().map(|c| -c).collect();
    let settings = DefaultSettings::<f64> {
        verbose: false,
        tol_gap_abs: 1e-10,
        tol_gap_rel: 1e-10,
        tol_feas: 1e-10,
        presolve_enable: false,
        direct_solve_method: "qdldl".into(),
        ..Default::default()
    };
    let none = CscMatrix::new(n, n, vec![0; n + 1], Vec::new(), Vec::new());
    let mut solver =
        DefaultSolver::new(&none, &linear, &a, &b, &[SupportedConeT::NonnegativeConeT(count)], settings).ok()?;
    solver.solve();
    let usable = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    usable.then(|| solver.solution.x.iter().map(|x| x.max(0.0)).collect())
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
