//! A compiled layout for unit tests, without a solver.

use crate::compiled::Compiled;
use crate::geometry::Track;
use crate::model::{Layout, StraightPlace, fixture};
use crate::solve::{Stage, Status};

/// The layout as written.
pub fn compile(layout: Layout) -> Compiled {
    let stage = Stage {
        name: "written",
        corners: layout.corners(),
        length: Track::new(&layout.corners()).length,
        max_violation: 0.0,
        violations: Vec::new(),
        iterations: 0,
        starts: 1,
        seconds: 0.0,
        status: Status::AsWritten,
        cut: None,
        certificate: None,
        refuted: false,
    };
    Compiled::new(layout, vec![stage])
}

/// A place on the straight of a section.
pub fn on(section: usize, at: f64) -> StraightPlace {
    StraightPlace { section, at, span: fixture::span() }
}
