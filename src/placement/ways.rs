//! What would make room for equipment that finds none. Each way out is tried before it is told.

use super::footprint::Line;
use super::place;
use super::task::{Cause, Group, Room, Task};
use crate::base::number::trimmed;
use crate::geometry::clearance::Region;
use crate::geometry::{Corner, Point, Polygon, Track};
use crate::model::{ConstraintKind, Declared, EquipmentSide, FixKind, Layout, Side, Stands, TOLERANCE};

/// Amounts of across and along are told to this, m.
const STEP: f64 = 0.01;
/// Longer straights that are tried, as multiples of what the missing pieces take by themselves.
const LONGER: [f64; 3] = [1.0, 1.5, 2.0];

/// A declaration of which some find no place.
pub struct Lacking<'a> {
    pub layout: &'a Layout,
    pub track: &'a Track,
    pub task: &'a Task,
    pub group: &'a Group,
    /// How many of it find no place.
    pub count: usize,
    /// Of all declarations: index and how many find no place.
    pub missing: &'a [(usize, usize)],
}

impl Lacking<'_> {
    /// Changes, of which each is enough alone. `causes` is what is in the way.
    pub fn ways(&self, causes: &[Cause]) -> Vec<String> {
        let mut ways = Vec::new();
        let obstacles = causes.iter().filter_map(|c| if let Cause::Obstacle(i) = c { Some(*i) } else { None });
        let moved = obstacles.filter_map(|i| Some((i, self.moved(i)?)));
        if let Some((i, by)) = moved.min_by(|a, b| a.1.total_cmp(&b.1)) {
            ways.push(format!("move `{}` {} m away from the track", self.layout.obstacles[i].name, up(by)));
        }
        ways.extend(self.elsewhere());
        ways.extend(self.shallower(causes));
        ways.extend(self.shorter());
        let left = self.group.count - self.count;
        let fewer = |d: &mut Declared| {
            if let Stands::Free { count, .. } = &mut d.stands {
                *count = left;
            }
        };
        if left > 0 && self.fits(&fewer) {
            ways.push(format!("ask for {} fewer", self.count));
        }
        ways.extend(self.longer());
        ways
    }

    /// Whether all of the declaration finds a place on a track, and no more of the others lack theirs than before.
    fn is_enough(&self, changed: &Layout, track: &Track) -> bool {
        let before = |i: usize| self.missing.iter().find(|(of, _)| *of == i).map_or(0, |(_, n)| *n);
        let found = place(changed, track).missing;
        found.iter().all(|(i, n)| *i != self.group.declared && *n <= before(*i))
    }

    /// Whether a change of the declaration is enough.
    fn fits(&self, change: &dyn Fn(&mut Declared)) -> bool {
        let mut changed = self.layout.clone();
        change(&mut changed.equipment.declared[self.group.declared]);
        self.is_enough(&changed, self.track)
    }

    /// How far an obstacle has to be moved away from one of the straights, m, if that is enough, keeps it within the
    /// building, and leaves the track its clearance.
    fn moved(&self, obstacle: usize) -> Option<f64> {
        let own = &self.layout.obstacles[obstacle];
        let blocked = |room: &&Room| room.blocks.iter().any(|b| b.cause == Cause::Obstacle(obstacle));
        let shift = |room: &Room| {
            let line: &Line = &self.task.lines[self.task.stretches[room.stretch].section];
            let side = *room.sides.first()?;
            let far = self.task.half + self.group.of.depth + self.group.of.aisle;
            let near = own.polygon.points().iter().map(|p| side * line.local(*p).y).fold(f64::INFINITY, f64::min);
            (near < far).then(|| (far - near, line.along.left() * side))
        };
        let mut tried: Vec<(f64, Point)> = self.group.rooms.iter().filter(blocked).filter_map(shift).collect();
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let within = |polygon: &Polygon| {
            let building = self.layout.building.as_ref().map(|building| &building.polygon);
            let inside = |of: &Polygon| polygon.points().iter().all(|p| holds(of, *p));
            building.is_none_or(inside)
        };
        tried.into_iter().find_map(|(by, out)| {
            let points = own.polygon.points().iter().map(|p| *p + out * by).collect();
            let mut changed = self.layout.clone();
            changed.obstacles[obstacle].polygon = Polygon::new(points).ok()?;
            let stays = !within(&own.polygon) || within(&changed.obstacles[obstacle].polygon);
            (stays && self.is_clear(&changed, obstacle, self.track) && self.is_enough(&changed, self.track))
                .then_some(by)
        })
    }

    /// Whether a track keeps its distance from an obstacle.
    fn is_clear(&self, layout: &Layout, obstacle: usize, track: &Track) -> bool {
        let own = &layout.obstacles[obstacle];
        let lies = if own.side == Side::Right { -1.0 } else { 1.0 };
        let region = Region { polygon: own.polygon.clone(), outside: false, lies };
        region.distance(track) >= self.task.half + own.clearance - TOLERANCE
    }

    /// Other places of the declaration.
    fn elsewhere(&self) -> Vec<String> {
        let declared = &self.layout.equipment.declared[self.group.declared];
        let mut ways = Vec::new();
        if let Stands::Free { on, after, before, .. } = &declared.stands {
            let anywhere = |d: &mut Declared| {
                if let Stands::Free { on, .. } = &mut d.stands {
                    on.clear();
                }
            };
            if !on.is_empty() && self.fits(&anywhere) {
                ways.push("let it stand `anywhere`".to_owned());
            }
            let unordered = |d: &mut Declared| {
                if let Stands::Free { after, before, .. } = &mut d.stands {
                    after.clear();
                    before.clear();
                }
            };
            if !(after.is_empty() && before.is_empty()) && self.fits(&unordered) {
                ways.push("leave out `after` and `before`".to_owned());
            }
        }
        let side = declared.of.side;
        let either = |d: &mut Declared| d.of.side = EquipmentSide::Either;
        if !matches!(side, EquipmentSide::Either | EquipmentSide::Both) && self.fits(&either) {
            ways.push("let it stand on either side, with `side = either`".to_owned());
        }
        ways
    }

    /// The least that its depth would have to be less.
    fn shallower(&self, causes: &[Cause]) -> Option<String> {
        if causes.is_empty() {
            return None;
        }
        let of = &self.group.of;
        let less = least(of.depth, &|less| self.fits(&|d: &mut Declared| d.of.depth -= less))?;
        let across = of.depth + of.aisle;
        let aisle = less <= of.aisle && self.fits(&|d: &mut Declared| d.of.aisle -= less);
        Some(format!(
            "take {} m off its depth{} (it needs {} m across, {} m are free)",
            trimmed(less, 2),
            if aisle { " or its aisle" } else { "" },
            trimmed(across, 2),
            trimmed(across - less, 2)
        ))
    }

    /// By how much each piece has to be shorter along the track, where that is enough.
    fn shorter(&self) -> Option<String> {
        let of = &self.group.of;
        let less = least(of.stretch, &|less| self.fits(&|d: &mut Declared| d.of.stretch -= less))?;
        let each = if self.group.count > 1 { " of each" } else { "" };
        Some(format!(
            "take {} m off the stretch{each} (it has {} m, {} m are free)",
            trimmed(less, 2),
            trimmed(of.stretch, 2),
            trimmed(of.stretch - less, 2)
        ))
    }

    /// The straight that is long enough with the fewest metres more, where the track then still keeps its clearances.
    fn longer(&self) -> Option<String> {
        let of = &self.group.of;
        let on = match &self.layout.equipment.declared[self.group.declared].stands {
            Stands::Free { on, .. } => on.clone(),
            _ => Vec::new(),
        };
        let alone = self.count as f64 * (of.stretch + of.service);
        let all = 0..self.task.lines.len();
        let sections = all.filter(|section| on.is_empty() || on.contains(section));
        let least = |section: usize| {
            // One that is too short for a single piece first has to become as long.
            let short = of.stretch + 2.0 * of.from_curve - self.task.lines[section].length;
            let enough = |steps: u32| {
                let by = f64::from(steps) * STEP;
                self.stretched(section, by).into_iter().any(|track| self.is_enough(self.layout, &track))
            };
            let steps = |times: f64| (((times * alone + short.max(0.0)) / STEP) - 1e-6).ceil() as u32;
            let mut steps = LONGER.into_iter().map(steps).find(|steps| enough(*steps))?;
            // Pieces that stand closer, or gaps that one just does not fill, take less.
            let mut less = 0;
            while steps - less > 1 {
                let middle = less + (steps - less) / 2;
                if enough(middle) { steps = middle } else { less = middle }
            }
            Some(f64::from(steps) * STEP)
        };
        let found = sections.filter_map(|section| Some((self.is_fixed(section), least(section)?, section)));
        let (fixed, by, section) = found.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))?;
        let beside = if fixed { " (its length is fixed)" } else { "" };
        Some(format!("make {} {} m longer{beside}", self.layout.section_name(section), trimmed(by, 2)))
    }

    /// Whether a section's length is fixed, or both its ends are.
    fn is_fixed(&self, section: usize) -> bool {
        let is = |wanted: &dyn Fn(&ConstraintKind) -> bool| self.layout.constraints.iter().any(|c| wanted(&c.kind));
        let end = |v: usize| is(&|kind| matches!(kind, ConstraintKind::FixVertex { vertex } if *vertex == v));
        let length = |kind: &ConstraintKind| match kind {
            ConstraintKind::FixSection { target, kinds } => target.from == section && kinds.contains(&FixKind::Length),
            _ => false,
        };
        is(&length) || (end(section) && end(self.layout.next(section)))
    }

    /// The track with everything beyond a straight's middle moved on, and with everything before it moved back, where
    /// it keeps its clearances.
    fn stretched(&self, section: usize, by: f64) -> Vec<Track> {
        let line = &self.task.lines[section];
        let moved = |forward: bool| {
            let corner = |corner: &Corner| {
                let beyond = line.local(corner.point).x > 0.5 * line.length;
                let step = match (forward, beyond) {
                    (true, true) => by,
                    (false, false) => -by,
                    _ => 0.0,
                };
                Corner { point: corner.point + line.along * step, ..*corner }
            };
            Track::new(&self.track.corners.iter().map(corner).collect::<Vec<_>>())
        };
        [true, false].map(moved).into_iter().filter(|track| self.keeps_clear(track)).collect()
    }

    fn keeps_clear(&self, track: &Track) -> bool {
        let turned: f64 = track.fillets.iter().map(|fillet| fillet.turn).sum();
        let within = self.layout.building.as_ref().is_none_or(|building| {
            // The outer side of a loop that turns left is on its right.
            let lies = if turned < 0.0 { 1.0 } else { -1.0 };
            let region = Region { polygon: building.polygon.clone(), outside: true, lies };
            let inside = track.pieces.iter().all(|piece| holds(&building.polygon, piece.begin));
            inside && region.distance(track) >= self.task.half + building.clearance - TOLERANCE
        });
        within && (0..self.layout.obstacles.len()).all(|obstacle| self.is_clear(self.layout, obstacle, track))
    }
}

/// Whether a point is in a polygon or on its outline.
fn holds(polygon: &Polygon, p: Point) -> bool {
    polygon.contains(p) || polygon.distance_to_outline(p) <= TOLERANCE
}

/// The least amount in steps, m, that is enough to take off a measure, m, and leaves some of it.
fn least(measure: f64, enough: &dyn Fn(f64) -> bool) -> Option<f64> {
    let off = |steps: u32| f64::from(steps) * STEP;
    // Not enough with `short`, enough with `steps`.
    let (mut short, mut steps) = (0, ((measure / STEP).ceil() as u32).saturating_sub(1));
    if steps == 0 || !enough(off(steps)) {
        return None;
    }
    while steps - short > 1 {
        let middle = short + (steps - short) / 2;
        if enough(off(middle)) { steps = middle } else { short = middle }
    }
    Some(off(steps))
}

/// To the centimetre, upwards.
pub fn up(metres: f64) -> String {
    trimmed((metres * 100.0 - 1e-4).ceil() / 100.0, 2)
}
