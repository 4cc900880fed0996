//! A compiled layout for unit tests, without a solver.

use super::{Compiled, Contact};
use crate::elements;
use crate::geometry::Track;
use crate::model::{Layout, Place, fixture};
use crate::solve::{Stage, Status};

/// The layout as written, with a contact made up for each obstacle.
pub fn compile(layout: Layout) -> Compiled {
    let track = Track::new(&layout.corners());
    let sequence = elements::sequence(&track, &layout);
    let stage = Stage {
        name: "written",
        corners: layout.corners(),
        length: track.length,
        max_violation: 0.0,
        violations: Vec::new(),
        iterations: 0,
        seconds: 0.0,
        status: Status::AsWritten,
    };
    let contacts = layout
        .obstacles
        .iter()
        .map(|o| Contact {
            name: o.name.clone(),
            area_left: 0.0,
            area_right: 0.25,
            clearance: -0.5,
            required: o.clearance,
        })
        .collect();
    Compiled {
        bill: elements::bill(&sequence, &layout),
        footprint: track.footprint(layout.width.value),
        stages: vec![stage],
        sequence,
        contacts,
        track,
        layout,
    }
}

/// A place on the straight of a section.
pub fn on(section: usize, at: f64) -> Place {
    Place { section, at, span: fixture::span() }
}
