//! How long the conveyor to a piece of equipment is at least, wherever its section lies: to the nearest point of its outer
//! edge's line between what has to stand before it and behind it on the section, or to its place where that is given. That is
//! convex in the section's ends, and where nothing else is in the way it is the length.

use super::needs::{is_split, parts, sides};
use super::sequence::{Part, least_length};
use crate::geometry::{Point, Track};
use crate::model::{Declared, Layout, Stands};

/// Where on a section the middle of equipment may stand, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Along {
    /// So far from the beginning of its straight.
    At(f64),
    /// Least distances from the beginning and from the end of the straight.
    Between { before: f64, behind: f64 },
}

/// Equipment that may stand on one section only, and whose conveyor costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Nearest {
    /// Index among what the layout declares.
    pub declared: usize,
    pub section: usize,
    /// Where its conveyor begins.
    pub from: Point,
    /// Of a metre of all its conveyors, EUR.
    pub price: f64,
    pub along: Along,
    /// Where its outer edge lies, m to the left of the section: between these, of two sides that it may stand on.
    pub across: (f64, f64),
}

/// What a section is to a conveyor: from where it begins to the nearest point, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// Along the section and to its left.
    pub along: f64,
    pub left: f64,
}

impl Way {
    pub fn length(self) -> f64 {
        (self.along * self.along + self.left * self.left).sqrt()
    }
}

/// A half-space that holds where a conveyor may end, E: |E − F| >= `pull`·V + `low`, with V the beginning or the end of the
/// straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    pub pull: Point,
    pub of_end: bool,
    pub low: f64,
}

/// All of a layout; the written track says which way it turns.
pub fn nearest(layout: &Layout, written: &Track) -> Vec<Nearest> {
    let declared = &layout.equipment.declared;
    let only = |d: &Declared| match &d.stands {
        Stands::Free { on, .. } => matches!(on[..], [_]).then(|| on[0]),
        Stands::At(_) | Stands::Row(_) => None,
    };
    let all = |(index, own): (usize, &Declared)| -> Vec<Nearest> {
        let Some(from) = own.priced_from() else { return Vec::new() };
        let edge = layout.width.value / 2.0 + own.of.depth;
        let (left, right) = sides(&own.of, written);
        let across = (
            if right > 0.0 || left == 0.0 { -edge } else { edge },
            if left > 0.0 || right == 0.0 { edge } else { -edge },
        );
        let near = |section: usize, pieces: usize, along: Along| {
            let price = pieces as f64 * own.of.conveyor;
            Nearest { declared: index, section, from, price, along, across }
        };
        match only(own) {
            Some(section) => {
                let members = |side: usize| -> Vec<&Declared> {
                    let beside = |d: &&Declared| {
                        let (left, right) = sides(&d.of, written);
                        only(d) == Some(section) && [left, right][side] > 0.0
                    };
                    declared.iter().filter(beside).collect()
                };
                let sides: Vec<Vec<&Declared>> = (0..2).map(members).collect();
                vec![near(section, own.count(), between(own, &sides, is_split(layout, section)))]
            }
            None => own.given().iter().map(|place| near(place.section, 1, Along::At(place.at))).collect(),
        }
    };
    declared.iter().enumerate().flat_map(all).collect()
}

/// What has to stand before equipment and behind it, of what stands on either side of its section.
fn between(own: &Declared, sides: &[Vec<&Declared>], split: bool) -> Along {
    let inset = own.of.from_curve + 0.5 * own.of.stretch;
    let (mut before, mut behind) = (inset, inset);
    for members in sides {
        let Some(place) = members.iter().position(|d| d.name == own.name) else { continue };
        let mut standing = parts(members, split);
        // The first of several has others of it behind, and not before.
        standing[place].count = 1;
        before = before.max(least_before(&standing, place) - inset);
        behind = behind.max(least_before(&reversed(&standing), place) - inset);
    }
    Along::Between { before, behind }
}

/// The least length of a straight for a part and all that has to stand before it, m.
fn least_before(parts: &[Part], own: usize) -> f64 {
    let mut before = vec![false; parts.len()];
    let mut open = vec![own];
    while let Some(part) = open.pop() {
        for &earlier in &parts[part].behind {
            if earlier != own && !before[earlier] {
                before[earlier] = true;
                open.push(earlier);
            }
        }
    }
    let kept: Vec<usize> = (0..parts.len()).filter(|part| before[*part] || *part == own).collect();
    let place = |part: usize| kept.iter().position(|other| *other == part);
    let part = |part: &usize| {
        let behind = match *part == own {
            true => (0..kept.len()).filter(|k| kept[*k] != own).collect(),
            false => parts[*part].behind.iter().filter_map(|k| place(*k)).collect(),
        };
        Part { behind, ..parts[*part].clone() }
    };
    least_length(&kept.iter().map(part).collect::<Vec<_>>())
}

/// Parts as they stand against the driving direction.
fn reversed(parts: &[Part]) -> Vec<Part> {
    let follows = |own: usize| (0..parts.len()).filter(|k| parts[*k].behind.contains(&own)).collect();
    parts.iter().enumerate().map(|(own, part)| Part { behind: follows(own), ..part.clone() }).collect()
}

impl Nearest {
    /// From where the conveyor begins to the nearest point where it may end.
    pub fn way(&self, begin: Point, heading: Point, length: f64) -> Way {
        let from = self.from - begin;
        let (along, left) = (from.dot(heading), from.dot(heading.left()));
        let along = match self.along {
            Along::At(at) => at - along,
            Along::Between { before, behind } => {
                let (ahead, back) = ((before - along).max(0.0), (along - length + behind).max(0.0));
                if ahead >= back { ahead } else { -back }
            }
        };
        Way { along, left: left.clamp(self.across.0, self.across.1) - left }
    }

    /// Length of one conveyor at least, m.
    pub fn least(&self, track: &Track) -> f64 {
        let straight = track.straight(self.section);
        self.way(straight.begin, Point::unit(straight.heading), straight.length).length()
    }

    /// What touches the places where the conveyor may end at the nearest point, which lies this way: it holds wherever a
    /// section of this heading lies. `None` where the conveyor has no length.
    pub fn half_space(&self, way: Way, heading: Point) -> Option<HalfSpace> {
        let length = way.length();
        if length <= 0.0 {
            return None;
        }
        let (along, left) = (way.along / length, way.left / length);
        let pull = heading * along + heading.left() * left;
        let across = (left * self.across.0).min(left * self.across.1);
        let (of_end, inset) = match self.along {
            Along::At(at) => (false, along * at),
            Along::Between { behind, .. } if along < 0.0 => (true, -along * behind),
            Along::Between { before, .. } => (false, along * before),
        };
        Some(HalfSpace { pull, of_end, low: inset + across - pull.dot(self.from) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;

    fn drawn(random: &mut Random) -> Nearest {
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let right = between(-4.0, 0.0);
        Nearest {
            declared: 0,
            section: 0,
            from: Point::new(between(-20.0, 20.0), between(-20.0, 20.0)),
            price: 1.0,
            along: match between(0.0, 4.0) < 1.0 {
                true => Along::At(between(0.0, 4.0)),
                false => Along::Between { before: between(0.5, 3.0), behind: between(0.5, 3.0) },
            },
            across: (right, if between(0.0, 2.0) < 1.0 { right } else { -right }),
        }
    }

    /// Against all places on a section, one by one.
    #[test]
    fn the_least_is_that_of_all_places() {
        let mut random = Random::new(11);
        for _ in 0..200 {
            let near = drawn(&mut random);
            let heading = Point::unit(6.3 * random.uniform());
            let begin = Point::new(10.0 * random.uniform(), 10.0 * random.uniform());
            let length = 6.0 + 12.0 * random.uniform();
            let places = (0..=2000).flat_map(|k| {
                let at = match near.along {
                    Along::At(at) => at,
                    Along::Between { before, behind } => before + (length - before - behind) * f64::from(k) / 2000.0,
                };
                [near.across.0, near.across.1].map(|left| begin + heading * at + heading.left() * left)
            });
            let found = near.way(begin, heading, length).length();
            // Of two sides the conveyor may end between them, as far as is counted.
            let (least, between) =
                (places.map(|p| p.distance(near.from)).fold(f64::INFINITY, f64::min), near.across.1 - near.across.0);
            assert!(found <= least + 1e-9, "{near:?}: {found} {least}");
            assert!(between > 0.0 || (found - least).abs() < 0.01, "{near:?}: {found} {least}");
        }
    }

    #[test]
    fn half_spaces_hold_wherever_a_section_lies_and_touch_where_they_were_taken() {
        let mut random = Random::new(5);
        for _ in 0..200 {
            let near = drawn(&mut random);
            let heading = Point::unit(6.3 * random.uniform());
            let mut section = || {
                let begin = Point::new(30.0 * random.uniform() - 15.0, 30.0 * random.uniform() - 15.0);
                (begin, 6.0 + 12.0 * random.uniform())
            };
            let (begin, length) = section();
            let Some(half) = near.half_space(near.way(begin, heading, length), heading) else { continue };
            let says = |(begin, length): (Point, f64)| {
                half.low + half.pull.dot(if half.of_end { begin + heading * length } else { begin })
            };
            assert!((says((begin, length)) - near.way(begin, heading, length).length()).abs() < 1e-9, "{near:?}");
            for _ in 0..50 {
                let (begin, length) = section();
                let least = near.way(begin, heading, length).length();
                assert!(says((begin, length)) <= least + 1e-9, "{near:?}: {half:?} {begin:?} {length} {least}");
            }
        }
    }
}
