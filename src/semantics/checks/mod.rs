//! What can be told about a written layout without solving it.

mod building;
mod constraints;
mod crossing;
mod equipment;
mod range;
mod sides;
mod vertices;

use super::layout::Geometry;
use super::scope::Context;
use crate::geometry::{Corner, Track};
use crate::model::{Catalog, Interval, Level, Objective};
use crate::source::Spanned;

/// What the checks go by, besides the geometry.
pub(super) struct Facts<'a> {
    pub levels: &'a [Level],
    pub turns: Spanned<Interval>,
    pub radii: Spanned<Interval>,
    pub catalog: Option<&'a Catalog>,
    pub objective: Option<&'a Objective>,
}

impl Facts<'_> {
    /// Whether the layout is compiled as written.
    pub fn as_written(&self) -> bool {
        self.objective.is_some_and(|o| o.terms.is_empty())
    }
}

impl<'t> Context<'t> {
    /// Checks the loop, and fills in its track and on which side of it each obstacle lies.
    pub fn check_geometry(&self, geometry: &mut Geometry<'t>, facts: &Facts) {
        let Some(vertices) = &geometry.vertices else { return };
        if !self.check_neighbours(vertices) {
            return;
        }
        let corners: Vec<Corner> = vertices.iter().map(|v| Corner { point: v.point, radius: v.radius.value }).collect();
        let track = Track::new(&corners);
        if !self.check_turns(vertices, &track, facts) {
            return;
        }
        self.check_radii(vertices, facts);
        if !self.check_fillets(vertices, &track) {
            return;
        }
        self.check_crossings(vertices, &track, facts.levels);
        if let Some(building) = &geometry.building {
            self.check_building(vertices, &track, building);
        }
        sides::settle(&track, &mut geometry.obstacles);
        geometry.track = Some(track);
    }
}
