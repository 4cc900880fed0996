//! What can be told about a written layout without solving it.

mod building;
mod constraints;
mod crossing;
mod equipment;
mod fixed;
mod headings;
mod range;
pub mod sides;
mod vertices;

use crate::geometry::{Corner, Track};
use crate::model::{Catalog, Interval, Level, Objective, TOLERANCE};
use crate::semantics::layout::Geometry;
use crate::semantics::scope::Context;
use crate::source::{Span, Spanned};

/// What the checks go by, besides the geometry.
pub(in crate::semantics) struct Facts<'a> {
    pub levels: &'a [Level],
    /// `None` when the catalogue or the layout's limits have a mistake.
    pub limits: Option<Limits>,
    pub catalog: Option<&'a Catalog>,
    pub objective: Option<&'a Objective>,
}

/// What turns (absolute) and radii may be.
#[derive(Clone, Copy)]
pub(in crate::semantics) struct Limits {
    pub turns: Spanned<Interval>,
    pub radii: Spanned<Interval>,
}

impl Limits {
    pub fn new(turns: Option<Spanned<Interval>>, radii: Option<Spanned<Interval>>) -> Option<Self> {
        Some(Limits { turns: turns?, radii: radii? })
    }
}

impl Facts<'_> {
    /// What a message calls the place that limits come from.
    fn source_of(&self, limits: Span) -> &'static str {
        match self.catalog.is_some_and(|c| c.span == limits) {
            true => "the limits of this catalogue",
            false => "the limits",
        }
    }

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
        if !self.check_turns(vertices, &track) {
            return;
        }
        // A loop that crosses itself often comes from a wrong order, which bends every turn.
        let headroom = facts.catalog.map_or(0.0, |catalog| catalog.headroom);
        if track.pieces.iter().any(|piece| piece.length < -TOLERANCE) {
            let sharp: Vec<Corner> = corners.iter().map(|c| Corner { radius: 0.0, ..*c }).collect();
            if !self.check_crossings(vertices, &Track::new(&sharp), facts.levels, headroom) {
                return;
            }
        }
        if !self.check_fillets(vertices, &track) {
            return;
        }
        if self.check_crossings(vertices, &track, facts.levels, headroom)
            && let Some(limits) = facts.limits
        {
            self.check_limits(vertices, &track, limits, facts);
        }
        if let Some(building) = &geometry.building {
            self.check_building(vertices, &track, building);
        }
        sides::settle(&track, facts.levels.is_empty(), &mut geometry.obstacles);
        geometry.track = Some(track);
    }
}
