//! The thesis' three stages (§3.3): shortest under user constraints and building, then with obstacles, then on the
//! catalogue's grid.

use super::options::{Discretise, Effort, Options, Progress, Solver, Tell};
use super::sqp::{self, Solution, SqpSettings, Watch};
use super::violations::{as_written, off_grid, stage};
use super::{Stage, Status, complex, conflict, exact, hopping};
use crate::model::{Layout, Side};
use crate::problem::{Problem, Scope, perturbed};
use crate::solve::certificate::Certificate;
use std::time::Instant;

/// Solves a layout for length or cost; the last stage returned is the result. A stage that finds no feasible layout is
/// the last.
pub(super) fn solve_in_stages(layout: &Layout, options: &Options, discretise: Discretise, watch: Tell) -> Vec<Stage> {
    let mut stages = ways(layout, options, discretise, watch);
    if let Some(last) = stages.last_mut() {
        last.cut = options.stop.cut();
        if let (Status::Local | Status::Feasible, Some(certificate)) = (last.status, &last.certificate) {
            last.status = if certificate.proven { Status::Proven } else { Status::BestFound };
        }
    }
    stages
}

/// A solve for each way past the obstacles whose side is open.
fn ways(layout: &Layout, options: &Options, discretise: Discretise, watch: Tell) -> Vec<Stage> {
    let open: Vec<usize> = (0..layout.obstacles.len()).filter(|&i| layout.obstacles[i].side == Side::Either).collect();
    if open.is_empty() || layout.objective.terms.is_empty() {
        return one_way(layout, options, discretise, watch);
    }
    let count = 1u32 << open.len().min(MOST_OPEN);
    let options = &options.of_all();
    let mut ways: Vec<Vec<Stage>> = Vec::new();
    for way in 0..count {
        if ways.iter().any(|stages| ended_well(stages)) && options.stop.now() {
            break;
        }
        let mut layout = layout.clone();
        for (bit, &i) in open.iter().enumerate() {
            let right = bit < MOST_OPEN && way >> bit & 1 == 1;
            layout.obstacles[i].side = if right { Side::Right } else { Side::Left };
        }
        ways.push(one_way(&layout, options, discretise, watch));
    }
    let whole = ways.len() == count as usize;
    let mut best = best_of(ways);
    if let Some(certificate) = best.last_mut().and_then(|stage| stage.certificate.as_mut()).filter(|_| !whole) {
        certificate.know_nothing();
    }
    best
}

/// Whether a solve came to a layout on the grid.
fn ended_well(stages: &[Stage]) -> bool {
    stages.last().is_some_and(|last| last.name == "stage3" && last.status != Status::Infeasible)
}

/// Obstacles whose side is tried both ways; `unsupported` refuses more.
pub const MOST_OPEN: usize = 6;

/// The best of several solves, with what all of them prove together.
fn best_of(ways: Vec<Vec<Stage>>) -> Vec<Stage> {
    let last = |stages: &Vec<Stage>| -> (bool, bool, f64) {
        let Some(last) = stages.last() else { return (true, true, f64::INFINITY) };
        let failed = last.status == Status::Infeasible;
        let value = last.certificate.as_ref().map_or(last.length, |c| c.value);
        (failed, last.name != "stage3", if failed { last.max_violation } else { value })
    };
    let certificates: Vec<Certificate> = ways.iter().filter_map(|stages| stages.last()?.certificate.clone()).collect();
    // A way that ended before stage 3 was not proven to have no layout.
    let all = certificates.len() == ways.len();
    let refuted = ways.iter().all(|stages| stages.last().is_some_and(|last| last.refuted));
    let order = |a: &Vec<Stage>, b: &Vec<Stage>| {
        let (a, b) = (last(a), last(b));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    };
    let Some(mut best) = ways.into_iter().min_by(order) else { return Vec::new() };
    if let Some(last) = best.last_mut() {
        last.refuted = refuted;
    }
    if let Some(certificate) = best.last_mut().and_then(|stage| stage.certificate.as_mut()) {
        certificate.combine(&certificates);
        if !all {
            // That is believed, not proven.
            certificate.assumed.push("no layout passes on a side for which the continuous stages found none".into());
            certificate.proven = false;
        }
    }
    best
}

/// Solves with the side of every obstacle chosen.
fn one_way(layout: &Layout, options: &Options, discretise: Discretise, watch: Tell) -> Vec<Stage> {
    let full = Problem::new(layout, Scope::Obstacles);
    if layout.objective.terms.is_empty() {
        return vec![as_written(&full)];
    }
    let settings = SqpSettings { stop: options.stop, ..SqpSettings::default() };
    let run = |stage: &'static str, problem: &Problem, start: &[f64]| {
        let tell: Watch = &|iteration, length, max_violation| {
            watch(Progress::Iteration { stage, iteration, length, max_violation });
        };
        match options.solver {
            Solver::Sqp => sqp::minimise(problem, start, &settings, tell),
            Solver::Complex => complex::minimise(problem, start, &settings, tell),
        }
    };
    let walls = Problem::new(layout, Scope::Building);
    let start = match options.perturb {
        Some((sigma, seed)) => perturbed(layout, &walls, sigma, seed),
        None => walls.start.clone(),
    };
    let mut stages = Vec::new();

    let clock = Instant::now();
    let first = run("stage1", &walls, &start);
    let first = again(layout, options, (Scope::Building, &settings), first, &|start| run("stage1", &walls, start));
    stages.push(stage("stage1", &walls, &first, &settings, clock));
    if stages[0].status == Status::Infeasible {
        return stages;
    }

    // From stage 1's result and from the written layout: either start alone fails on some layouts.
    let clock = Instant::now();
    let starts = [first.variables.as_slice(), start.as_slice()];
    let [near, far] =
        in_parallel(options.threads, || run("stage2", &full, starts[0]), || run("stage2", &full, starts[1]));
    let iterations = near.iterations + far.iterations;
    let mut second = if rank(&far, &settings) < rank(&near, &settings) { far } else { near };
    second.iterations = iterations;
    let second = again(layout, options, (Scope::Obstacles, &settings), second, &|start| run("stage2", &full, start));
    stages.push(stage("stage2", &full, &second, &settings, clock));
    if stages[1].status == Status::Infeasible {
        return stages;
    }

    let clock = Instant::now();
    let (length, max_violation) = (second.length, second.max_violation);
    watch(Progress::Iteration { stage: "stage3", iteration: 0, length, max_violation });
    let mut third = discretise(layout, &full, &second, &settings, &options.effort, watch);
    let mut starts = 1;
    let enough =
        third.fits(settings.feasibility) && exact::suffices(layout, &full, &third.solution.variables, &options.effort);
    if third.is_open() && !enough && !options.stop.now() && options.solver == Solver::Sqp {
        // Only what is shorter than the layout on the grid leads to a shorter one there.
        let known = if third.fits(settings.feasibility) { third.solution.length } else { f64::INFINITY };
        let asked = (known, settings.feasibility, options.threads);
        let again = |start: &[f64]| run("stage2", &full, start);
        let through = |start: &[f64]| again(&run("stage1", &walls, start).variables);
        let others = hopping::other_optima(layout, &full, &second, asked, [&again, &through]);
        let effort = Effort { nodes: options.effort.nodes / (1 + others.len()), ..options.effort };
        starts += hopping::hops(&full);
        for other in others {
            third = third.or(discretise(layout, &full, &other, &settings, &effort, watch), settings.feasibility);
        }
    }
    if let Some(certificate) = third.certificate.as_mut().filter(|c| options.effort.class && !c.proven) {
        let bound = exact::of_class(layout, &full, &third.solution.variables);
        bound.iter().for_each(|(bound, class)| certificate.raise(*bound, class));
    }
    let mut last = stage("stage3", &full, &third.solution, &settings, clock);
    last.starts = starts;
    last.certificate = third.certificate;
    last.refuted = third.refuted;
    let mut off = third.refused;
    off.extend(off_grid(layout, &full, &third.solution.variables, settings.feasibility));
    if !off.is_empty() {
        last.status = Status::Infeasible;
        last.max_violation = off.iter().map(|v| v.amount).fold(last.max_violation, f64::max);
        last.violations.extend(off);
    }
    // What a later stage found is a layout of the earlier ones, too: none of them stays longer.
    let mut shorter = (last.status != Status::Infeasible).then_some(third.solution);
    for (k, problem, mut best) in [(1, &full, second), (0, &walls, first)] {
        if let Some(start) = shorter.filter(|s| s.length < best.length - SHORTER) {
            let clock = Instant::now();
            let name = stages[k].name;
            let mut found = run(name, problem, &start.variables);
            found.iterations += best.iterations;
            if rank(&found, &settings) < rank(&best, &settings) {
                let seconds = stages[k].seconds;
                stages[k] = stage(name, problem, &found, &settings, clock);
                stages[k].seconds += seconds;
                best = found;
            }
        }
        shorter = Some(best);
    }
    stages.push(last);
    stages
}

/// A stage begins once more from a result of a later one that is shorter by more than this, m.
const SHORTER: f64 = 1e-6;

/// A stage that found no layout, once more from where a wider search finds one. The complex method ends as it ends.
fn again(
    layout: &Layout,
    options: &Options,
    (scope, settings): (Scope, &SqpSettings),
    ended: Solution,
    run: &dyn Fn(&[f64]) -> Solution,
) -> Solution {
    if ended.max_violation <= settings.feasibility || options.solver == Solver::Complex {
        return ended;
    }
    let Some(start) = conflict::another_start(layout, scope, &ended.variables) else { return ended };
    let mut other = run(&start);
    other.iterations += ended.iterations;
    if rank(&other, settings) < rank(&ended, settings) { other } else { ended }
}

/// Feasible solutions by length, after them the others by violation.
fn rank(s: &Solution, settings: &SqpSettings) -> (bool, f64) {
    let feasible = s.max_violation <= settings.feasibility;
    (!feasible, if feasible { s.length } else { s.max_violation })
}

fn in_parallel<T: Send>(threads: usize, a: impl FnOnce() -> T + Send, b: impl FnOnce() -> T) -> [T; 2] {
    if threads < 2 {
        return [a(), b()];
    }
    std::thread::scope(|scope| {
        let first = scope.spawn(a);
        let second = b();
        match first.join() {
            Ok(first) => [first, second],
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Track;
    use crate::geometry::{Point, clearance::lateral_offset};
    use crate::model::instances::{horseshoe, thesis10};
    use crate::solve::{Effort, solve, solve_with};

    fn quiet(_: Progress) {}

    #[test]
    fn thesis10_reaches_the_best_known_lengths() {
        let stages = solve(&thesis10(), &Options::default(), &quiet);
        for (stage, best, tolerance) in
            [(&stages[0], 157.19840, 1e-5), (&stages[1], 159.24619, 1e-5), (&stages[2], 159.67, 0.0)]
        {
            assert!(stage.length <= best + tolerance, "{} {}", stage.name, stage.length);
            assert!(stage.max_violation <= 1e-6, "{} {:?}", stage.name, stage.violations);
        }
        assert!(stages[0].length >= 157.19840 - 1e-5 && stages[1].length >= 159.24619 - 1e-5);
    }

    #[test]
    fn thesis10_is_reached_from_rough_starts() {
        let layout = thesis10();
        let mut reached = [0; 2];
        for seed in 1..=20 {
            let options = Options { perturb: Some((1.5, seed)), ..Options::default() };
            let nothing: Discretise = |_, _, s, _, _, _| s.clone().into();
            let stages = solve_with(&layout, &options, nothing, &quiet);
            for (k, best) in [157.19840, 159.24619].into_iter().enumerate() {
                let good = |s: &Stage| (s.length - best).abs() < 1e-5 && s.max_violation <= 1e-6;
                reached[k] += usize::from(stages.get(k).is_some_and(good));
            }
        }
        assert!(reached[0] >= 19 && reached[1] >= 19, "{reached:?} of 20");
    }

    /// Feasibility by dense sampling of the centre line, which shares no code with the rows.
    #[test]
    fn the_result_keeps_its_distance() {
        let layout = thesis10();
        let stages = solve(&layout, &Options::default(), &quiet);
        for stage in &stages[1..] {
            let track = Track::new(&stage.corners);
            let half = layout.width.value / 2.0;
            let points: Vec<Point> = (0..50_000).map(|i| track.at(track.length * f64::from(i) / 50_000.0).0).collect();
            for obstacle in &layout.obstacles {
                let near =
                    points.iter().map(|&p| obstacle.polygon.distance_to_outline(p)).fold(f64::INFINITY, f64::min);
                assert!(near >= half - 1e-6, "{} passes {} at {near}", stage.name, obstacle.name);
                let side = lateral_offset(&track, obstacle.polygon.points()[0]).unwrap();
                assert_eq!(side > 0.0, obstacle.side == crate::model::Side::Left, "{}", obstacle.name);
            }
            let walls = &layout.building.as_ref().unwrap().polygon;
            let near = points.iter().map(|&p| walls.distance_to_outline(p)).fold(f64::INFINITY, f64::min);
            assert!(near >= half - 1e-6 && points.iter().all(|&p| walls.contains(p)), "{near}");
        }
    }

    #[test]
    fn stage_3_is_on_the_grid() {
        let layout = thesis10();
        let stages = solve(&layout, &Options::default(), &quiet);
        for fillet in Track::new(&stages[2].corners).fillets {
            let steps = fillet.turn.to_degrees() / 2.5;
            assert!((steps - steps.round()).abs() < 1e-7 && (fillet.radius - fillet.radius.round()).abs() < 1e-9);
        }
    }

    /// Both strands of a horseshoe shrink around what stands in its mouth; the band must not end up on itself.
    #[test]
    fn strands_keep_the_width_between_them() {
        let layout = horseshoe();
        // The best of stage 3 takes thousands of nodes; any will do here.
        let effort = Effort { nodes: 50, ..Effort::default() };
        let stages = solve(&layout, &Options { effort, ..Options::default() }, &quiet);
        for (stage, status) in stages.iter().zip([Status::Local, Status::Local, Status::BestFound]) {
            assert_eq!(stage.status, status, "{} {:?}", stage.name, stage.violations);
        }
        let track = Track::new(&stages[1].corners);
        let nearest = crate::geometry::band_overlaps(&track, 3.0).iter().map(|o| o.2).fold(f64::INFINITY, f64::min);
        assert!((nearest - layout.width.value).abs() < 1e-6, "{nearest}");
    }

    #[test]
    fn equipment_keeps_its_straight() {
        use crate::model::{Chutes, PlaceRow, StraightPlace, fixture::span};
        let mut layout = crate::model::fixture::rectangle(40.0, 20.0, 4.0);
        let place = StraightPlace { section: 2, at: 1.0, span: span() };
        let row = PlaceRow { place, every: 1.25, count: 9 };
        layout.equipment.chutes = vec![Chutes { name: "row_a".into(), row, more: Vec::new() }];
        let stages = solve(&layout, &Options::default(), &quiet);
        let track = Track::new(&stages[2].corners);
        assert_eq!(stages[2].status, Status::Proven);
        assert!((track.straight(2).length - 11.0).abs() < 1e-6, "{}", track.straight(2).length);
    }

    #[test]
    fn threads_do_not_change_the_result() {
        let run = |threads| solve(&thesis10(), &Options { threads, ..Options::default() }, &quiet);
        for (a, b) in run(1).iter().zip(&run(2)) {
            assert_eq!((&a.corners, a.iterations), (&b.corners, b.iterations));
        }
    }

    #[test]
    fn the_complex_method_shortens_the_track_too() {
        let options = Options { solver: Solver::Complex, ..Options::default() };
        let nothing: Discretise = |_, _, s, _, _, _| s.clone().into();
        let stages = solve_with(&thesis10(), &options, nothing, &quiet);
        println!(
            "{:?}",
            stages.iter().map(|s| (s.length, s.max_violation, s.iterations, s.seconds)).collect::<Vec<_>>()
        );
        assert!(stages[0].length < 200.0);
    }
}
