//! A solved layout with everything that its readers need worked out once.

mod findings;
#[cfg(test)]
pub(crate) mod fixture;
pub mod order;
mod ordered;
mod solved;
mod sorter;
mod station;
mod takes;

use order::Group;
pub use solved::solved;
pub use station::Station;
pub use takes::Takes;

use crate::diagnostic::Diagnostic;
use crate::elements::{self, Bill, OrderedPiece, Sequence, Space};
use crate::geometry::clearance::Region;
use crate::geometry::{Hand, Outline, Track};
use crate::kinematics::{Fit, fit};
use crate::model::{Layout, Side};
use crate::placement::{self, Placement};
use crate::solve::{self, Counted, Stage, Status};

/// How the track's band meets an obstacle, or the building's outside.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ContactArea {
    /// The obstacle's name, or `building`.
    pub name: String,
    /// Overlap of the region (without clearance) with what lies within the left and right track side (thesis
    /// §3.3.1), m².
    pub area_left: f64,
    pub area_right: f64,
    /// Signed distance from the band's edge to the region, m; negative when they overlap.
    pub clearance: f64,
    /// What the layout asks for, m.
    pub required: f64,
}

/// A layout after solving: what every writer reads.
#[derive(Clone, Debug)]
pub struct Compiled {
    pub layout: Layout,
    /// The centre line that is drawn and ordered (the last stage's, or the best found when a solve failed).
    pub track: Track,
    /// The written layout is not among them; the last one is what `track` shows. At least one.
    pub stages: Vec<Stage>,
    pub sequence: Sequence,
    /// The centre line in space; level at height 0 where the layout has no levels.
    pub space: Space,
    /// What of the layout's heights cannot be built, or not from the catalogue.
    pub heights: Vec<Diagnostic>,
    /// What the bill counts, in driving order.
    pub pieces: Vec<OrderedPiece>,
    pub bill: Bill,
    /// The whole number of carts that fits best, and what it leaves over; `None` where no chain closes.
    pub chain: Option<Fit>,
    /// Contact areas and clearances per obstacle, in the order of `layout.obstacles`, then the building.
    pub contacts: Vec<ContactArea>,
    /// Floor covered by the track's band, m².
    pub footprint: f64,
    /// Where equipment of a declared kind stands.
    pub placement: Placement,
}

impl Compiled {
    /// Covers the last stage's layout with elements and measures it. Without a stage, the written layout.
    pub fn new(mut layout: Layout, stages: Vec<Stage>) -> Self {
        let corners = stages.last().map_or_else(|| layout.corners(), |s| s.corners.clone());
        let track = Track::new(&corners);
        let placement = placement::place(&layout, &track);
        placement::fill_in(&mut layout, &placement);
        let sequence = elements::sequence(&track, &layout);
        let (space, mut heights) = Space::new(&layout, &sequence);
        let pieces = elements::pieces(&sequence, &space, &layout);
        heights.extend(elements::climbs_lacking(&pieces, &layout));
        let mut compiled = Compiled {
            bill: elements::bill(&pieces, &layout),
            chain: fit(&space.line, layout.cart.length),
            contacts: contacts(&layout, &track),
            footprint: track.footprint(layout.width.value),
            placement,
            pieces,
            sequence,
            space,
            heights,
            track,
            stages,
            layout,
        };
        compiled.prove_total_price();
        compiled
    }

    /// What is proven of track, equipment and metres, as it is of all that is ordered.
    fn prove_total_price(&mut self) {
        if !self.layout.objective.total_price {
            return;
        }
        let (total, more) = (order::total(self).all, self.beyond_cost(self.layout.most_cut_by_chords()));
        let certificate = self.stages.last_mut().and_then(|stage| stage.certificate.as_mut());
        if let Some(certificate) = certificate.filter(|c| c.counted != Counted::Length && !c.in_all) {
            certificate.in_total(total, more);
        }
    }

    /// How much more any layout of these components is ordered for than its cost and metres count, at least, EUR. Its
    /// chain has a whole number of carts, and is so much shorter than its track, m, at most, as carts are chords.
    pub fn beyond_cost(&self, cut: f64) -> f64 {
        let layout = &self.layout;
        let total = order::total(self);
        let same = total.groups.iter().filter(|(group, _)| matches!(group, Group::Drive | Group::Sensors));
        let equipment = if solve::counts_equipment(layout) { 0.0 } else { self.placement.equipment };
        let chain = layout.price_of_a_pitch() / layout.cart.length * (layout.most_left_over() + cut);
        // Prices are rounded to the cent line by line.
        let lines = self.bill.lines.len() + self.bill.count;
        same.map(|(_, price)| price).sum::<f64>() + equipment - chain - 0.005 * lines as f64
    }

    /// Whether the layout has heights: arc length then counts along the slope.
    pub fn raised(&self) -> bool {
        !self.layout.levels.is_empty()
    }

    /// Length of the centre line, m.
    pub fn length(&self) -> f64 {
        if self.raised() { self.space.line.length } else { self.track.length }
    }

    /// Whether a whole number of carts closes within the take-up's travel.
    pub fn chain_fits(&self) -> bool {
        self.chain.is_some_and(|fit| fit.is_within(self.layout.take_up_travel()))
    }

    /// How the solve ended, in words that go on with how long it took.
    pub fn state(&self) -> &'static str {
        let last = self.stages.last();
        match last.map(|stage| stage.status) {
            None | Some(Status::AsWritten) => "as written, which nothing optimises",
            Some(Status::Infeasible) => "NOT FEASIBLE, this is the best layout found",
            Some(Status::Proven) => "proven to be the best on the catalogue's grid",
            Some(_) if last.is_some_and(|stage| stage.cut.is_some()) => "the best found in the time that it had",
            Some(Status::Local) => "a local optimum",
            Some(Status::BestFound) => "the best found",
            Some(Status::Feasible) => "feasible",
        }
    }

    /// Whether the last stage failed: drawings then carry a watermark and the rows that are violated.
    pub fn failed(&self) -> bool {
        self.stages.last().is_some_and(|s| s.status == Status::Infeasible)
    }
}

fn contacts(layout: &Layout, track: &Track) -> Vec<ContactArea> {
    let half = layout.width.value / 2.0;
    let sides = [Hand::Left, Hand::Right].map(|hand| Outline::side(track, half, hand));
    let clearance = |region: Region| region.distance(track) - half;
    let obstacle = |o: &crate::model::Obstacle| {
        let lies = if o.side == Side::Right { Hand::Right } else { Hand::Left };
        let [area_left, area_right] = [0, 1].map(|k| sides[k].contact(&o.polygon, lies));
        let region = Region { polygon: o.polygon.clone(), outside: false, lies: lies.sign() };
        ContactArea { name: o.name.clone(), area_left, area_right, clearance: clearance(region), required: o.clearance }
    };
    let building = |b: &crate::model::Building| {
        let [area_left, area_right] = [0, 1].map(|k| sides[k].area_outside(&b.polygon));
        let lies = if sides[0].orientation() < 0 { 1.0 } else { -1.0 };
        let region = Region { polygon: b.polygon.clone(), outside: true, lies };
        ContactArea {
            name: "building".into(),
            area_left,
            area_right,
            clearance: clearance(region),
            required: b.clearance,
        }
    };
    layout.obstacles.iter().map(obstacle).chain(layout.building.iter().map(building)).collect()
}
