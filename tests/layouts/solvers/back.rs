//! What another solver finds, put back into the source with `optimise nothing`: it may miss limits by the tolerance that
//! `docs/solvers.md` states, and by no more.

use super::{continuous, example};
use lss::geometry::{Corner, Track};
use lss::model::TOLERANCE;
use lss::semantics::analyse;
use lss::solve::{self, Options};
use lss::source::{Loader, SourceMap};
use proptest::prelude::*;

/// `thesis10` with its vertices there, compiled as written.
pub fn written(corners: &[Corner]) -> String {
    let text = include_str!("../../../examples/thesis10.lss").replace("optimise length", "optimise nothing");
    let line =
        |line: &str| match line.trim().strip_prefix("vertex P").and_then(|rest| rest.split(' ').next()?.parse().ok()) {
            Some(i) => {
                let i: usize = i;
                let Corner { point, radius } = corners[i - 1];
                format!("  vertex P{i} ({:?} m, {:?} m) radius {radius:?} m", point.x, point.y)
            }
            None => line.to_owned(),
        };
    text.lines().map(line).collect::<Vec<_>>().join("\n") + "\n"
}

/// The codes of what checking and building say of limits: errors, and radii or turns beyond theirs.
pub fn told(text: &str) -> Vec<String> {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("back.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    let mut said = analysis.diagnostics.clone();
    if let Ok(Some(layout)) = analysis.chosen() {
        said.extend(solve::diagnose(layout, &solve::solve(layout, &Options::default(), &|_| {})));
    }
    said.into_iter().map(|d| d.code.as_str().to_owned()).collect()
}

/// Stage 2 of `thesis10`.
fn found() -> Vec<Corner> {
    continuous(&example("thesis10"))[1].corners.clone()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn a_result_within_the_tolerance_is_taken(shifts in prop::collection::vec(-0.2..0.2f64, 30)) {
        let mut corners = found();
        for (corner, shift) in corners.iter_mut().zip(shifts.chunks(3)) {
            corner.point.x += shift[0] * TOLERANCE;
            corner.point.y += shift[1] * TOLERANCE;
            corner.radius += shift[2] * TOLERANCE;
        }
        prop_assert_eq!(told(&written(&corners)), Vec::<String>::new());
    }
}

/// Each kind of limit missed by a little less than the tolerance, and by a little more.
#[test]
fn every_limit_has_the_same_tolerance() {
    let corners = found();
    let track = Track::new(&corners);
    let (section, straight) = (corners[1].point.distance(corners[2].point), track.straight(1).length);
    for (share, missed) in [(0.9, false), (1.1, true)] {
        let by = share * TOLERANCE;
        let expect = |text: &str, codes: &[&str]| {
            let codes: &[&str] = if missed { codes } else { &[] };
            assert_eq!(told(text), codes, "{text}");
        };
        // P3 turns by 90°, has the largest radius, and no straight behind it.
        assert!(track.straight(2).length.abs() < 1e-9 && (corners[2].radius - 8.0).abs() < 1e-9);
        let mut larger = corners.clone();
        larger[2].radius += by;
        expect(&written(&larger), &["E0404"]);
        let lines = |more: String| written(&corners).replace("  optimise", &format!("{more}\n  optimise"));
        let longer = section + by;
        expect(&lines(format!("  require length(P2..P3) >= {longer:?} m")), &["E0501"]);
        let heading = track.straight(3).heading - by;
        expect(&lines(format!("  require heading(P4..P5) <= {heading:?} rad")), &["E0501"]);
        let reach = straight + by;
        expect(&lines(format!("  induction west on P2..P3 at {reach:?} m")), &["E0409"]);
    }
}
