//! The problems as other solvers read them: the `.nl` files row by row through a reader of this test's own, then both
//! formats through IPOPT and HiGHS. Without Python, casadi or highspy the latter say that they were skipped.

#![allow(clippy::expect_used, clippy::unwrap_used)]

mod back;
mod brute;
mod nl;

use lss::model::Layout;
use lss::problem::{Evaluation, Problem, Scope, mps};
use lss::semantics::analyse;
use lss::solve::{self, Discretise, Options, Stage};
use lss::source::{Loader, SourceMap};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

fn layout(text: &str) -> Layout {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("main.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    assert!(!analysis.has_errors(), "{:?}", analysis.diagnostics);
    analysis.chosen().expect("one layout").expect("no mistakes").clone()
}

fn example(name: &str) -> Layout {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).with_extension("lss");
    layout(&std::fs::read_to_string(path).unwrap())
}

/// Stages 1 and 2.
fn continuous(layout: &Layout) -> Vec<Stage> {
    let nothing: Discretise = |_, _, solution, _, _, _| solution.clone().into();
    let mut stages = solve::solve_with(layout, &Options::default(), nothing, &|_| {});
    stages.truncate(2);
    stages
}

/// Formulas that no example has.
const FORMULAS: &str = "
use std.carts.tilt_tray
use std.tracks.thesis
layout formulas {
  catalog thesis
  cart tilt_tray(length: 1250 mm)
  speed 2 m/s
  width 1.2 m
  vertex P1 (4 m, 4 m) radius 4 m
  vertex P2 (46 m, 5 m) radius 4 m
  vertex P3 (46 m, 30 m) radius 4 m
  vertex P4 (25 m, 20 m) radius 3 m
  vertex P5 (5 m, 31 m) radius 4 m
  building [(0 m, 0 m), (50 m, 0 m), (50 m, 36 m), (0 m, 36 m)]
  obstacle pit [(20 m, 8 m), (24 m, 8 m), (22 m, 12 m)] clearance 0.4 m
  require min(radius(P1), length(P1..P2) / 8, distance(P1, P3)) >= 1 m
  require max(radius(P1), 2 * radius(P2) - 1 m) <= 20 m
  require abs(x(P3) - x(P2)) <= 7 m
  require sqrt(length(P2..P3) * length(straight(P2..P3))) >= 2 m
  require distance(P4, pit) >= 1 m
  require distance(P4, building) >= 1 m
  require heading(P4..P5) == 150 deg
  require abs(angle(P4)) >= 6 deg
  fix parallel, perpendicular straight(P1..P2)
  fix rotation P2..P3
  optimise length
}";

/// Values of rows by what they are called, each list ascending; unlike numbers of the file, names do not depend on its
/// order.
fn by_name(rows: impl Iterator<Item = (String, f64)>) -> BTreeMap<String, Vec<f64>> {
    let mut all: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (name, value) in rows {
        let plain = name.split('#').next().unwrap_or("").replace(' ', "_");
        all.entry(plain).or_default().push(value);
    }
    all.values_mut().for_each(|values| values.sort_by(f64::total_cmp));
    all
}

fn expected(problem: &Problem, here: &Evaluation) -> BTreeMap<String, Vec<f64>> {
    let label = |row: &lss::problem::RowValue| match row.key {
        lss::problem::RowKey::Listed(i) => problem.rows[i].label.clone(),
        key => problem.describe(key).0,
    };
    by_name(here.rows.iter().map(|row| (label(row), row.expansion.value)))
}

#[test]
fn every_row_has_the_same_value_in_the_file() {
    let mut clearances = 0;
    for layout in [layout(FORMULAS), example("thesis10"), example("constraints"), example("hub"), example("smallest")] {
        for scope in [Scope::Building, Scope::Obstacles] {
            let problem = Problem::new(&layout, scope);
            let starts = (1..=6).map(|seed| lss::problem::perturbed(&layout, &problem, 0.4, seed));
            for x in starts.chain([problem.start.clone()]) {
                let files = lss::problem::nl::write(&problem, &x, &x);
                let nl = nl::Nl::read(&files.model);
                assert_eq!(nl.start, x);
                let (values, objective) = nl.evaluate(&nl.start);
                let names: Vec<&str> = files.rows.lines().collect();
                assert_eq!(names.len(), values.len() + 1);
                assert_eq!(files.columns.lines().count(), x.len());
                let here = problem.evaluate(&x, 3.0);
                clearances += here.rows.iter().filter(|row| !row.key.is_listed()).count();
                assert!((objective - here.length).abs() < 1e-9);
                let read = by_name(names.iter().map(|n| n.to_string()).zip(values));
                let expected = expected(&problem, &here);
                assert_eq!(read.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
                for (name, values) in &expected {
                    for (a, b) in values.iter().zip(&read[name]) {
                        assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{} {name}: {a} {b}", layout.name);
                    }
                }
                let limits = |low: f64, high: f64| format!("{low} {high}");
                let mut file: Vec<String> = nl.constraint_limits.iter().map(|l| limits(l.0, l.1)).collect();
                let mut ours: Vec<String> = here.rows.iter().map(|r| limits(r.low, r.high)).collect();
                file.sort();
                ours.sort();
                assert_eq!(file, ours);
                let bounds = problem.bounds.iter().map(|b| (b.low, b.high));
                assert!(bounds.eq(nl.variable_limits.iter().copied()));
            }
        }
    }
    assert!(clearances > 80, "{clearances}");
}

/// What a script prints; `None` where Python or a package it needs is missing.
fn python(script: &str, arguments: &[&Path]) -> Option<Vec<String>> {
    let output = Command::new("python3").args(["-c", script]).args(arguments).output().ok()?;
    let lines: Vec<String> = String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let missing = lines.first().is_some_and(|line| line == "missing");
    if missing {
        println!("skipped: {}", lines[1]);
    }
    (!missing).then_some(lines)
}

/// Solves `stem.nl` by IPOPT from the start in the file: status, optimum, then each row and variable with its
/// multiplier.
const IPOPT: &str = r#"
import sys
try:
    import casadi
except ImportError:
    print("missing"); print("casadi is not there"); sys.exit(0)
stem = sys.argv[1]
nl = casadi.NlpBuilder()
nl.import_nl(stem + ".nl")
problem = {"x": casadi.veccat(*nl.x), "f": nl.f, "g": casadi.veccat(*nl.g)}
options = {"print_time": 0, "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-10}}
solver = casadi.nlpsol("solver", "ipopt", problem, options)
found = solver(x0=nl.x_init, lbx=nl.x_lb, ubx=nl.x_ub, lbg=nl.g_lb, ubg=nl.g_ub)
print(solver.stats()["return_status"])
print(repr(float(found["f"])))
for kind, multipliers in ((".row", found["lam_g"]), (".col", found["lam_x"])):
    for name, value in zip(open(stem + kind).read().split(), multipliers.full().ravel()):
        print(name, repr(float(value)))
for value in found["x"].full().ravel():
    print("=", repr(float(value)))
"#;

#[test]
fn ipopt_finds_the_same_optimum_and_active_rows() {
    let layout = example("thesis10");
    let stages = continuous(&layout);
    let compiled = lss::compiled::Compiled::new(layout.clone(), stages.clone());
    let folder = tempfile::tempdir().unwrap();
    let files: lss::emit::Files = lss::emit::outside::nl_files(&compiled).into_iter().collect();
    files.write(folder.path()).unwrap();
    for (stage, best) in stages.iter().zip([157.19840, 159.24619]) {
        let Some(lines) = python(IPOPT, &[&folder.path().join(stage.name)]) else { return };
        assert_eq!(lines[0], "Solve_Succeeded");
        let length: f64 = lines[1].parse().unwrap();
        assert!((length - best).abs() < 1e-5 && (length - stage.length).abs() < 1e-5, "{length} {}", stage.length);
        let x: Vec<f64> = lines.iter().filter_map(|line| line.strip_prefix("= ")?.parse().ok()).collect();
        if stage.name == "stage2" {
            assert_eq!(back::told(&back::written(&lss::problem::measures::to_corners(&x))), Vec::<String>::new());
        }
        let priced = |(_, price): &(String, f64)| price.abs() > 1e-3;
        let theirs: BTreeMap<String, f64> = lines[2..]
            .iter()
            .filter(|line| !line.starts_with("= "))
            .map(|line| line.split_once(' ').unwrap())
            .map(|(name, price)| (name.to_owned(), -price.parse::<f64>().unwrap()))
            .filter(priced)
            .collect();
        let ours: BTreeMap<String, f64> = solve::freedom(&layout, stage)
            .rows
            .into_iter()
            .filter_map(|row| Some((row.row.replace(' ', "_"), row.length_per_unit?)))
            .filter(priced)
            .collect();
        assert_eq!(theirs.keys().collect::<Vec<_>>(), ours.keys().collect::<Vec<_>>(), "{}", stage.name);
        for (name, price) in &ours {
            assert!((price - theirs[name]).abs() < 1e-3 * (1.0 + price.abs()), "{name}: {price} {}", theirs[name]);
        }
    }
}

/// Solves an MPS file by HiGHS: status, optimum.
const HIGHS: &str = r#"
import sys
try:
    import highspy
except ImportError:
    print("missing"); print("highspy is not there"); sys.exit(0)
solver = highspy.Highs()
solver.setOptionValue("output_flag", False)
solver.setOptionValue("mip_rel_gap", 1e-9)
solver.setOptionValue("threads", 1)
assert solver.readModel(sys.argv[1]) == highspy.HighsStatus.kOk
solver.run()
print("status", solver.modelStatusToString(solver.getModelStatus()))
print("objective", repr(solver.getInfo().objective_function_value))
"#;

/// A loop with one fixed section on a coarse grid, which can be searched in full.
const COARSE: &str = "
use std.carts.tilt_tray
use std.tracks.thesis
catalog coarse from thesis {
  straight { shortest = 0.3 m }
  curve {
    angle_step = 15 deg
    radii = [3 m, 5 m]
    turns = 15 deg .. 120 deg
  }
}
layout loop {
  catalog coarse
  cart tilt_tray(length: 1250 mm)
  speed 2 m/s
  width 1.2 m
  vertex P1 (0 m, 0 m) radius 3 m
  vertex P2 (30 m, 0 m) radius 3 m
  vertex P3 (34 m, 16 m) radius 3 m
  vertex P4 (4 m, 17 m) radius 3 m
  fix all P1..P2
  require length(straight(P2..P3)) >= 4 m
  require y(P3) >= 14.2 m
  require radius(P2) + radius(P4) >= 8 m
  optimise length
}";

/// Status and optimum of the discrete stage by HiGHS.
fn highs(layout: &Layout, longest: f64) -> Option<f64> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stage3.mps");
    std::fs::write(&path, mps::write(layout, &Problem::new(layout, Scope::Building), longest)).unwrap();
    let lines = python(HIGHS, &[&path])?;
    // Some versions print a banner in spite of the option.
    let said = |name: &str| lines.iter().find_map(|line| line.strip_prefix(name)).map(str::trim);
    assert_eq!(said("status "), Some("Optimal"), "{lines:?}");
    Some(said("objective ").unwrap().parse().unwrap())
}

#[test]
fn highs_finds_the_optimum_of_a_full_search() {
    let layout = layout(COARSE);
    let best = brute::shortest();
    assert!((best - 59.548667).abs() < 1e-6, "{best}");
    let Some(length) = highs(&layout, 200.0) else { return };
    assert!((length - best).abs() < 1e-6, "HiGHS {length}, full search {best}");
    // No building and no obstacle: stage 3 solves the same problem.
    let stages = solve::solve(&layout, &Options::default(), &|_| {});
    assert!(stages[2].length >= length - 1e-6, "{} {length}", stages[2].length);
}

#[test]
fn highs_proves_the_reference_instance_without_obstacles() {
    let Some(length) = highs(&example("thesis10"), 159.67) else { return };
    assert!((length - 157.177024).abs() < 1e-5, "{length}");
}
