//! Equipment beyond the straight that it stands on.

use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::Track;
use crate::model::{Capacity, Equipment, Motors, PlaceRow, Ramp, StraightPlace, TOLERANCE};
use crate::semantics::scope::{Context, Named};
use crate::semantics::value::metres;

impl Context<'_> {
    pub fn check_equipment(
        &self,
        equipment: &Equipment,
        capacity: Option<&Capacity>,
        ramps: &[Ramp],
        track: &Track,
        named: &Named,
    ) {
        let scanners = capacity.iter().flat_map(|capacity| &capacity.scanners);
        for place in equipment.start.iter().chain(&equipment.photocell).chain(scanners) {
            self.check_reach(place, place.at, track, named);
        }
        for induction in &equipment.inductions {
            self.check_reach(&induction.place, induction.place.at, track, named);
        }
        let rows = match &equipment.motors {
            Motors::Rows(rows) => rows.as_slice(),
            Motors::Evenly { .. } => &[],
        };
        let last = |row: &PlaceRow| row.place.at + row.every * (row.count.max(1) - 1) as f64;
        for row in equipment.chutes.iter().flat_map(|c| c.rows()).chain(rows) {
            self.check_reach(&row.place, last(row), track, named);
        }
        for declared in &equipment.declared {
            // What is given is the middle of each.
            if let Some(place) = declared.given().last() {
                self.check_middle(place, 0.5 * declared.of.stretch, track, named);
            }
        }
        for ramp in ramps {
            if let Some(at) = ramp.from {
                self.check_reach(&StraightPlace { section: ramp.section, at, span: ramp.span }, at, track, named);
            }
        }
    }

    /// Whether the written straight reaches as far as the place (or the last of a row).
    fn check_reach(&self, place: &StraightPlace, reach: f64, track: &Track, named: &Named) {
        let length = track.straight(place.section).length;
        if reach > length + TOLERANCE {
            let expected = format!("at most {} from the tangent point where the straight begins", metres(length));
            self.beyond(place, reach, (expected, metres(reach)), named);
        }
    }

    /// Whether the written straight reaches as far as equipment with its middle at the place does.
    fn check_middle(&self, place: &StraightPlace, half: f64, track: &Track, named: &Named) {
        let length = track.straight(place.section).length;
        if place.at + half > length + TOLERANCE {
            let most = metres(length - half);
            let expected = format!("a middle at most {most} from the tangent point where the straight begins");
            self.beyond(place, place.at + half, (expected, metres(place.at)), named);
        }
    }

    fn beyond(&self, place: &StraightPlace, reach: f64, (expected, found): (String, String), named: &Named) {
        let n = named.order.len();
        let (a, b) = (named.order[place.section], named.order[(place.section + 1) % n]);
        let message = format!("this lies beyond the straight of `{a}..{b}`");
        let label = format!("reaches {}", metres(reach));
        self.report(Diagnostic::new(Code::E0409, message, place.span, label).expected(expected, found));
    }
}
