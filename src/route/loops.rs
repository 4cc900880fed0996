//! Loops of a round: a way from each section to the next, in the order of their length, as vertices.

use super::bound::Places;
use super::dubins::Pose;
use super::plane::{Plane, Strand};
use super::round::Round;
use super::ways::{Arc, Port, Tangents, Way};
use crate::base::trig;
use crate::geometry::{Corner, Point, Track, self_crossings};
use crate::model::Layout;
use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};

/// Ways from a section to the next that are tried.
const WAYS: usize = 8;
/// Choices of ways that are looked at in a round.
const CHOICES: usize = 3_000;
/// As many loops of a round are enough.
const FEW: usize = 2;
/// A turn below this is none where a way begins or ends, and about a corner, rad.
const NO_TURN: f64 = 0.017;
/// Least turn of two vertices that become one, and what it stays off a half turn, rad.
const MERGED: f64 = 0.04;
/// Straights, as multiples of the radius, after which a curve behind a section may begin.
const LEADS: [f64; 5] = [0.0, 0.5, 1.0, 2.0, 4.0];

/// A loop before it is optimised.
#[derive(Clone, Debug)]
pub struct Loop {
    pub corners: Vec<Corner>,
    /// For each section of the round, the vertex that its straight begins at.
    pub on: Vec<usize>,
}

impl Loop {
    /// The loop with one vertex for the vertices `i` and the next, where the lines before and behind them meet; `None`
    /// where a section lies between the two, or where the lines meet behind either of them.
    pub fn merged(&self, i: usize) -> Option<Loop> {
        let n = self.corners.len();
        let j = (i + 1) % n;
        if n < 4 || self.on.contains(&i) {
            return None;
        }
        let point = |k: usize| self.corners[k % n].point;
        let (before, behind) = (point(i + n - 1), point(i + 2));
        let (u, v) = (point(i) - before, behind - point(j));
        let turn = trig::atan2(u.cross(v), u.dot(v));
        if !(MERGED..trig::PI - MERGED).contains(&turn.abs()) {
            return None;
        }
        let meeting = before + u * ((behind - before).cross(v) / u.cross(v));
        if (meeting - before).dot(u) <= 0.0 || (behind - meeting).dot(v) <= 0.0 {
            return None;
        }
        let mut corners = self.corners.clone();
        corners[i] = Corner { point: meeting, radius: self.corners[i].radius.min(self.corners[j].radius) };
        corners.remove(j);
        let moved = |k: usize| {
            let k = if k == j { i } else { k };
            if k > j { k - 1 } else { k }
        };
        let on: Vec<usize> = self.on.iter().map(|&k| moved(k)).collect();
        let first = *on.first()?;
        corners.rotate_left(first);
        let on = on.into_iter().map(|k| (k + n - 1 - first) % (n - 1)).collect();
        Some(Loop { corners, on })
    }

    /// Whether two loops have the same vertices, to a centimetre.
    fn is_like(&self, other: &Loop) -> bool {
        self.corners.len() == other.corners.len()
            && self.corners.iter().zip(&other.corners).all(|(a, b)| a.point.distance(b.point) < 0.01)
    }
}

pub struct Maker<'a> {
    pub layout: &'a Layout,
    pub plane: &'a Plane,
    /// Smallest radius, m.
    pub radius: f64,
}

impl Maker<'_> {
    /// The shortest loops of a round that do not cross themselves, at most so many.
    pub fn loops(&self, round: &Round, places: &Places, most: usize) -> Vec<Loop> {
        let n = round.sections.len();
        let ends: Vec<(Pose, Pose)> = round
            .sections
            .iter()
            .zip(places)
            .map(|(s, place)| {
                let direction = s.direction();
                let begin = Pose { point: s.from + direction * ((place.0 + place.1) / 2.0), direction };
                (begin, begin.ahead(s.length()))
            })
            .collect();
        let planes: Vec<Plane> = (0..n).map(|k| self.plane.with(&self.sections_beside(&ends, k))).collect();
        let ways: Vec<Vec<Way>> =
            (0..n).map(|k| self.between(&planes[k], ends[k].1, ends[(k + 1) % n].0, WAYS)).collect();
        let mut found: Vec<Loop> = Vec::new();
        let mut looked = 0;
        each_choice(&ways, |choice| {
            looked += 1;
            let chosen: Vec<&Way> = choice.iter().zip(&ways).map(|(&k, ways)| &ways[k]).collect();
            if let Some(made) = self.corners(round, &chosen) {
                found.push(made);
            }
            looked < CHOICES && found.len() < most
        });
        // Where shortest ways cross each other, each way keeps off those that were laid before.
        for first in 0..if n > 1 { 2 * n } else { 0 } {
            if found.len() >= FEW.min(most) {
                break;
            }
            let order = (0..n).map(|k| if first < n { (first + k) % n } else { (first - k) % n });
            let made = self.lay(round, &ends, &planes, order);
            found.extend(made.filter(|made| !found.iter().any(|f| f.is_like(made))));
        }
        found
    }

    /// Sections as strands that the way behind section `k` keeps off: its own two only where it does not begin or end.
    fn sections_beside(&self, ends: &[(Pose, Pose)], k: usize) -> Vec<Strand> {
        let width = self.layout.width.value;
        let (from, to) = (k, (k + 1) % ends.len());
        let strand = |(i, (begin, end)): (usize, &(Pose, Pose))| {
            let begin = if i == to { begin.ahead(2.0 * width) } else { *begin };
            let end = if i == from { end.ahead(-2.0 * width) } else { *end };
            let whole = (end.point - begin.point).dot(begin.direction) > 0.01;
            whole.then_some(Strand { begin: begin.point, end: end.point, distance: width })
        };
        ends.iter().enumerate().filter_map(strand).collect()
    }

    /// The loop that comes of laying ways one after another in some order, each the shortest that keeps off those
    /// before.
    fn lay(
        &self,
        round: &Round,
        ends: &[(Pose, Pose)],
        planes: &[Plane],
        order: impl Iterator<Item = usize>,
    ) -> Option<Loop> {
        let n = ends.len();
        let pair = |k: usize| (ends[k].1, ends[(k + 1) % n].0);
        let mut laid: Vec<Option<Way>> = vec![None; n];
        for k in order {
            let (from, to) = pair(k);
            let strands = (0..n).filter_map(|i| Some(self.strands(laid[i].as_ref()?, pair(i).0, pair(i).1)));
            let plane = planes[k].with(&strands.flatten().collect::<Vec<_>>());
            laid[k] = Some(self.between(&plane, from, to, 1).into_iter().next()?);
        }
        let ways: Vec<&Way> = laid.iter().flatten().collect();
        self.corners(round, &ways)
    }

    /// A way as strands, arcs as chords.
    fn strands(&self, way: &Way, from: Pose, to: Pose) -> Vec<Strand> {
        let mut points = vec![from.point];
        for arc in &way.arcs {
            let count = (arc.turn / 0.8).ceil().max(1.0) as usize;
            let heading = arc.from.heading();
            points.extend((0..=count).map(|k| {
                let turned = arc.hand * arc.turn * k as f64 / count as f64;
                arc.centre - Point::unit(heading + turned).left() * (arc.hand * arc.radius)
            }));
        }
        points.push(to.point);
        let distance = self.layout.width.value;
        let strand = |pair: &[Point]| Strand { begin: pair[0], end: pair[1], distance };
        points.windows(2).filter(|pair| pair[0].distance(pair[1]) > 0.01).map(strand).collect()
    }

    /// Ways from a pose to another, shortest first.
    fn between(&self, plane: &Plane, from: Pose, to: Pose, most: usize) -> Vec<Way> {
        let leads = |pose: Pose, ahead: f64| {
            let ports = LEADS.iter().flat_map(move |lead| {
                let by = lead * self.radius;
                [1.0, -1.0].map(|hand| (pose.ahead(ahead * by), hand, by))
            });
            ports
                .filter(|(at, _, by)| *by == 0.0 || plane.is_clear(pose.point, at.point))
                .map(|(at, hand, by)| Port::turn(at, hand, self.radius, by))
                .collect::<Vec<_>>()
        };
        let mut ways = Tangents::new(plane).ways(&leads(from, 1.0), &leads(to, -1.0), most);
        ways.extend(self.swings(plane, from, to));
        let along = to.point - from.point;
        let on_line = |p: Point| from.direction.cross(p).abs() < 1e-9;
        if on_line(along)
            && on_line(to.direction)
            && from.direction.dot(along) >= 0.0
            && from.direction.dot(to.direction) > 0.0
            && plane.is_clear(from.point, to.point)
        {
            ways.push(Way { length: along.norm(), arcs: Vec::new(), word: Vec::new() });
        }
        ways.sort_by(|a, b| a.length.total_cmp(&b.length).then(a.word.cmp(&b.word)));
        ways
    }

    /// Ways of three arcs, for poses that are too near for a straight between arcs (Dubins 1957).
    fn swings(&self, plane: &Plane, from: Pose, to: Pose) -> Vec<Way> {
        let r = self.radius;
        let mut ways = Vec::new();
        for hand in [1.0, -1.0] {
            let centre = |pose: Pose| pose.point + pose.direction.left() * (hand * r);
            let (a, b) = (centre(from), centre(to));
            let apart = a.distance(b);
            if !(1e-6..4.0 * r).contains(&apart) {
                continue;
            }
            let across = (b - a).left() * (libm::sqrt(4.0 * r * r - apart * apart / 4.0) / apart);
            for (side, middle) in [a.lerp(b, 0.5) + across, a.lerp(b, 0.5) - across].into_iter().enumerate() {
                // Directions of travel where the circles touch.
                let touching = |c: Point| {
                    let left = (middle - c) * (-hand / (2.0 * r));
                    Point::new(left.y, -left.x)
                };
                let (u, v) = (touching(a), touching(b));
                let arcs = [(a, hand, from.direction, u), (middle, -hand, u, v), (b, hand, v, to.direction)].map(
                    |(centre, hand, from, to)| {
                        let turn = (hand * trig::atan2(from.cross(to), from.dot(to))).rem_euclid(trig::TAU);
                        Arc { centre, radius: r, hand, from, turn: if turn > trig::TAU - 1e-6 { 0.0 } else { turn } }
                    },
                );
                let clear = |a: &Arc| plane.arc_is_clear(a.centre, a.radius, a.hand, a.from, a.turn);
                if arcs.iter().all(|a| a.turn < 1.8 * trig::PI && clear(a)) {
                    let length = arcs.iter().map(|a| r * a.turn).sum();
                    ways.push(Way { length, arcs: arcs.to_vec(), word: vec![hand as i64, -10 - side as i64] });
                }
            }
        }
        ways
    }

    /// The vertices of a loop, unless it crosses itself or passes an obstacle on the wrong side.
    fn corners(&self, round: &Round, ways: &[&Way]) -> Option<Loop> {
        let n = ways.len();
        // From the way that leads to the first section.
        let order: Vec<usize> = std::iter::once(n - 1).chain(0..n - 1).collect();
        let mut corners: Vec<Corner> = Vec::new();
        // By section: the vertex before it and the one behind it, by their numbers.
        let mut before = vec![None; n];
        let mut behind = vec![None; n];
        for way in order {
            let made = self.bends(&ways[way].arcs);
            if !made.is_empty() {
                behind[way] = Some(corners.len());
                before[(way + 1) % n] = Some(corners.len() + made.len() - 1);
            }
            corners.extend(made);
        }
        let count = corners.len();
        if count < 3 {
            return None;
        }
        let on: Vec<usize> = (0..n).map(|k| last_before(&before, k)).collect::<Option<_>>()?;
        for (k, section) in round.sections.iter().enumerate() {
            let direction = section.direction();
            for vertex in [before[k], behind[k]].into_iter().flatten() {
                let along = direction.dot(corners[vertex].point - section.from);
                corners[vertex].point = section.from + direction * along;
            }
        }
        // P1 is where the first section's straight begins.
        let first = on[0];
        corners.rotate_left(first);
        let on = on.into_iter().map(|v| (v + count - first) % count).collect();
        let sharp: Vec<Corner> = corners.iter().map(|c| Corner { radius: 0.0, ..*c }).collect();
        if (0..count).any(|i| corners[i].point.distance(corners[(i + 1) % count].point) < 1e-3) {
            return None;
        }
        let track = Track::new(&sharp);
        let turned: f64 = track.fillets.iter().map(|f| f.turn).sum();
        let around = (turned.abs() - trig::TAU).abs() < 1e-3;
        let bends = track.fillets.iter().all(|f| (0.01..3.0).contains(&f.turn.abs()));
        (around && bends && self_crossings(&track).is_empty()).then_some(Loop { corners, on })
    }

    /// The vertices of a way's arcs.
    fn bends(&self, arcs: &[Arc]) -> Vec<Corner> {
        let last = arcs.len().saturating_sub(1);
        let mut bends: Vec<(Arc, bool)> = Vec::new();
        for (k, arc) in arcs.iter().enumerate().filter(|(_, a)| a.turn >= NO_TURN) {
            let pinned = k == 0 || k == last;
            match bends.last_mut() {
                Some((before, held)) if before.hand == arc.hand && !(*held && pinned) && self.overlap(before, arc) => {
                    let turn = before.turn + arc.turn;
                    *before = if *held {
                        Arc { turn, ..*before }
                    } else if pinned {
                        // The turn of before is taken over: the circle is where the way ends.
                        Arc { turn, from: before.from, ..*arc }
                    } else {
                        let apart = before.centre.distance(arc.centre);
                        Arc {
                            centre: before.centre.lerp(arc.centre, 0.5),
                            radius: before.radius.max(arc.radius) + apart / 2.0,
                            turn,
                            ..*before
                        }
                    };
                    *held |= pinned;
                }
                _ => bends.push((*arc, pinned)),
            }
        }
        bends.iter().flat_map(|(arc, pinned)| self.split(arc, *pinned)).collect()
    }

    /// Whether curves of the smallest radius leave no room for each other where those of the corners do.
    fn overlap(&self, a: &Arc, b: &Arc) -> bool {
        let half = |arc: &Arc| trig::tan((arc.turn / 2.0).min(1.5));
        let end = |arc: &Arc, turned: f64| {
            let direction = Point::unit(arc.from.heading() + arc.hand * turned);
            arc.centre - direction.left() * (arc.hand * arc.radius)
        };
        let straight = end(a, a.turn).distance(end(b, 0.0));
        let short = |arc: &Arc| (self.radius - arc.radius).max(0.0) * half(arc);
        straight < short(a) + short(b)
    }

    /// A turn as vertices, none of which turns more than the limit. About a corner the curve touches its circle from
    /// outside; where a way begins or ends, its circle stays.
    fn split(&self, arc: &Arc, pinned: bool) -> Vec<Corner> {
        let most = self.layout.turns.value.high.min(0.95 * trig::PI);
        let count = ((arc.turn - 0.02) / most).ceil().max(1.0);
        let each = arc.turn / count;
        let radius = self.radius.max(if pinned { 0.0 } else { arc.radius }).min(self.layout.radii.value.high);
        let heading = arc.from.heading();
        let out = |turned: f64| Point::unit(heading + arc.hand * turned).left() * -arc.hand;
        let centre = if pinned { arc.centre } else { arc.centre - out(arc.turn / 2.0) * (radius - arc.radius) };
        let vertex = |k: usize| {
            let out = out(each * (k as f64 + 0.5));
            Corner { point: centre + out * (radius / trig::cos(each / 2.0)), radius }
        };
        (0..count as usize).map(vertex).collect()
    }
}

/// The last vertex before a section; where it is on the line of the section before it, that one's.
fn last_before(before: &[Option<usize>], section: usize) -> Option<usize> {
    let n = before.len();
    (0..n).find_map(|back| before[(section + n - back) % n])
}

/// A choice of ways with the sum of their lengths.
struct Choice {
    length: f64,
    ways: Vec<usize>,
}

impl PartialEq for Choice {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Choice {}

impl Ord for Choice {
    fn cmp(&self, other: &Self) -> Ordering {
        other.length.total_cmp(&self.length).then_with(|| other.ways.cmp(&self.ways))
    }
}

impl PartialOrd for Choice {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Calls for each choice of one way a section, by the sum of their lengths, until told to stop.
fn each_choice(ways: &[Vec<Way>], mut look: impl FnMut(&[usize]) -> bool) {
    if ways.iter().any(Vec::is_empty) {
        return;
    }
    let length = |choice: &[usize]| choice.iter().zip(ways).map(|(&k, ways)| ways[k].length).sum::<f64>();
    let first = vec![0; ways.len()];
    let mut seen = BTreeSet::from([first.clone()]);
    let mut heap = BinaryHeap::from([Choice { length: length(&first), ways: first }]);
    while let Some(choice) = heap.pop() {
        if !look(&choice.ways) {
            return;
        }
        for k in 0..ways.len() {
            let mut next = choice.ways.clone();
            next[k] += 1;
            if next[k] < ways[k].len() && seen.insert(next.clone()) {
                heap.push(Choice { length: length(&next), ways: next });
            }
        }
    }
}
