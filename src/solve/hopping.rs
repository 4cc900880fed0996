//! Basin hopping (Wales and Doye 1997): a local optimum is left by normal noise on what is free, and the stage is solved
//! again from there. How many hops there are depends on the layout's size alone, so the answer is the same on any
//! machine.

use super::discrete::LARGE;
use super::sqp::Solution;
use crate::base::parallel;
use crate::model::Layout;
use crate::problem::{Problem, moved};

/// Hops times vertices: a hop costs about in proportion to vertices, and a layout of 20 of them takes 24.
const HOPS_BY_VERTICES: usize = 480;
/// Most hops: what 24 do not find, twice as many hardly do.
const MOST: usize = 24;
/// Deviations of the noise in turn, m: within a basin, to the next, and across a hall.
const FAR: [f64; 4] = [0.3, 1.0, 2.0, 4.0];
/// Ends that are this much alike in length are one, m.
const ALIKE: f64 = 1e-6;
/// Ends that are kept.
const KEPT: usize = 3;

/// How many hops a layout takes.
pub fn hops(problem: &Problem) -> usize {
    match problem.vertices.len() {
        // Rounding one end takes longer than all else.
        vertices if vertices > LARGE => 0,
        vertices => (HOPS_BY_VERTICES / vertices.max(1)).clamp(1, MOST),
    }
}

/// From a start to a local optimum.
type Run<'a> = dyn Fn(&[f64]) -> Solution + Sync + 'a;

/// Other local optima, the shortest first, of those that are shorter than `longest` (m); `from` is not among them. Every
/// other hop begins from the written layout and goes `through` the stage before, too, whose optima may lie anywhere. Of
/// the rest, the second half begins from the shortest end of the first.
pub fn other_optima(
    layout: &Layout,
    problem: &Problem,
    from: &Solution,
    (longest, feasible, threads): (f64, f64, usize),
    [run, through]: [&Run; 2],
) -> Vec<Solution> {
    let seeds: Vec<u64> = (1..=hops(problem) as u64).collect();
    let mut found: Vec<Solution> = Vec::new();
    for half in seeds.chunks(seeds.len().div_ceil(2).max(1)) {
        let best = found.first().unwrap_or(from);
        let ends = parallel::map(half, threads, |seed| {
            let far = FAR[(*seed / 2) as usize % FAR.len()];
            let (from, run) = if seed % 2 == 0 { (&best.variables, run) } else { (&problem.start, through) };
            moved(layout, problem, from, far, *seed).map(|start| run(&start))
        });
        found.extend(ends.into_iter().flatten());
        found.retain(|end| end.max_violation <= feasible && end.length < longest - ALIKE);
        found.retain(|end| (end.length - from.length).abs() > ALIKE);
        found.sort_by(|a, b| a.length.total_cmp(&b.length));
    }
    found.dedup_by(|a, b| (a.length - b.length).abs() < ALIKE);
    found.truncate(KEPT);
    found
}
