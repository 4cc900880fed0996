//! What a layout that comes too close to a region could do instead: alternatives of linear rows, one of which every
//! layout with the same headings meets.
//!
//! With headings chosen, a straight keeps its distance D from a point when the point lies D to the side, or before or
//! behind the straight: three half-planes. An arc whose inner side the point is on keeps it in a disc, R − |q − c| >=
//! D, which is convex and the intersection of its tangents' half-planes; one whose outer side the point is on keeps it
//! out of a disc, which is not, and is split into sectors: within an angle δ of a direction w, |q − c| >= R + D implies
//! w·(q − c) >= (R + D) cos δ. An arc that bulges towards an edge keeps n·(c − p) − R >= D, or its lowest point is not
//! over the edge.

use super::alternative::{About, Alternative, Decided, Remedy, StraightEnd, Way, What};
use super::apart::apart;
use super::enclosing::Enclosing;
use super::grid::Grid;
use super::row::{GridRow, Touch};
use crate::geometry::clearance::{Feature, NearPiece, Region, offset};
use crate::geometry::{Point, Track};
use crate::problem::{Keepout, Problem, RowKey};
use crate::solve::exact::choice::Choice;
use crate::solve::exact::open::Open;

/// Everything the alternatives depend on.
pub struct Beside<'a> {
    pub problem: &'a Problem,
    pub grid: &'a Grid,
    /// Known layouts, whose ways of having another strand in between are allowed.
    pub known: Vec<Track>,
    /// Of the whole loop; none where a chain is searched apart.
    pub enclosing: Option<Enclosing<'a>>,
}

impl Beside<'_> {
    /// What to do about a clearance row; `None` for what has no linear alternatives.
    pub fn remedy(
        &self,
        key: RowKey,
        choice: &Choice,
        open: &Open,
        track: &Track,
        decided: &[Decided],
    ) -> Option<Remedy> {
        let (k, feature, part) = match key {
            RowKey::Clearance(k, feature, part) => (k, feature, part),
            RowKey::Listed(row) => {
                return apart(self.problem, self.grid, row, track, decided).map(Remedy::Split);
            }
            RowKey::Own(..) | RowKey::Gap(..) => return None,
        };
        let n = self.grid.len();
        let keepout = &self.problem.keepouts[k];
        let settled = |stage: usize| open.headings[stage].len() == 1;
        match (feature, part) {
            (Feature::Corner(corner), NearPiece::Straight(i)) => {
                let stage = self.grid.stage(i);
                if !settled(stage) {
                    let heading = f64::from(choice.headings[stage]);
                    let whole = self.convex(keepout, corner, stage, heading, open);
                    return whole.or(Some(Remedy::Settle(stage)));
                }
                Some(Remedy::Split(self.straight(k, corner, i, choice, decided, open)))
            }
            (_, NearPiece::Arc(v)) => {
                let stage = self.grid.stage(v);
                let before = (stage + n - 1) % n;
                if let (Feature::Corner(corner), false) = (feature, settled(before) && settled(stage)) {
                    let arc = Arc { grid: self.grid, stage, choice };
                    let q = keepout.region.polygon.points()[corner];
                    let from = q - track.fillets[v].centre;
                    let turned = if stage == 0 { n } else { stage };
                    let (a, b) = (choice.headings[turned - 1], choice.headings[turned]);
                    let heading = f64::from(a) + f64::from(b - a) * arc.fraction(from).clamp(0.0, 1.0);
                    let whole = [stage, before]
                        .into_iter()
                        .filter_map(|k| self.convex(keepout, corner, k, heading, open))
                        .min_by_key(|r| matches!(r, Remedy::Halve(..)));
                    if whole.is_some() {
                        return whole;
                    }
                }
                if let Some(open) = [before, stage].into_iter().find(|&s| !settled(s)) {
                    return Some(Remedy::Settle(open));
                }
                let arc = Arc { grid: self.grid, stage, choice };
                match feature {
                    Feature::Corner(corner) => self.corner(&arc, k, corner, track, decided, open).map(Remedy::Split),
                    Feature::Edge(edge) => edge_rows(&arc, keepout, edge).map(Remedy::Split),
                }
            }
            (Feature::Edge(_), NearPiece::Straight(_)) => None,
        }
    }

    /// What to do while headings are still open, about a corner that a mean of several layouts comes too close to.
    pub fn early(&self, key: RowKey, open: &Open, track: &Track, decided: &[Decided]) -> Option<Remedy> {
        if let RowKey::Listed(row) = key {
            return apart(self.problem, self.grid, row, track, decided).map(Remedy::Split);
        }
        let RowKey::Clearance(k, Feature::Corner(corner), part) = key else { return None };
        let (grid, keepout) = (self.grid, &self.problem.keepouts[k]);
        let (stages, direction) = match part {
            NearPiece::Straight(i) => (vec![grid.stage(i)], track.straight(i).end - track.straight(i).begin),
            NearPiece::Arc(v) => {
                let stage = grid.stage(v);
                let from = keepout.region.polygon.points()[corner] - track.fillets[v].centre;
                (vec![stage, (stage + grid.len() - 1) % grid.len()], from.left() * f64::from(grid.signs[stage]))
            }
        };
        let near = |stage: usize| {
            let among = &open.headings[stage];
            let middle = f64::from(among[0] + among[among.len() - 1]) / 2.0;
            let circle = f64::from(grid.circle);
            let steps = (direction.heading() - grid.origin) / grid.step;
            steps - ((steps - middle) / circle).round() * circle
        };
        let inside = self.enclosing.and_then(|e| e.inside(keepout, corner, near(stages[0]), open));
        if let Some(inside) = inside {
            return Some(Remedy::Split(vec![inside]));
        }
        let found = stages.into_iter().filter_map(|stage| self.convex(keepout, corner, stage, near(stage), open));
        found.min_by_key(|r| matches!(r, Remedy::Halve(..)))
    }

    /// A corner on the inner side of the two arcs at a section's ends, whatever headings are chosen: the track between
    /// is convex, so the corner lies a distance D inside its tangent of this heading, or before where the first arc
    /// begins, or behind where the second ends.
    fn convex(&self, keepout: &Keepout, corner: usize, stage: usize, heading: f64, open: &Open) -> Option<Remedy> {
        let (grid, n) = (self.grid, self.grid.len());
        let sign = grid.signs[stage];
        let side = f64::from(sign);
        let next = stage + 1;
        if stage == 0 || next >= n || grid.signs[next] != sign || keepout.region.lies != side {
            return None;
        }
        let quarter = f64::from(grid.circle) / 4.0;
        // The heading is reached between the sections before and after, within a quarter turn of both.
        for (k, ahead) in [(stage - 1, -1.0), (next, 1.0)] {
            let off = |h: &i32| side * ahead * (f64::from(*h) - heading);
            if open.headings[k].iter().any(|h| off(h) > quarter) {
                return None;
            }
            if open.headings[k].iter().any(|h| off(h) < 0.0) {
                if open.headings[k].iter().all(|h| off(h) < 0.0) {
                    return None;
                }
                let rising = side * ahead > 0.0;
                let above = if rising { heading.ceil() } else { heading.floor() + 1.0 };
                return Some(Remedy::Halve(k, above as i32));
            }
        }
        let q = keepout.region.polygon.points()[corner];
        let u = Point::unit(grid.origin + heading * grid.step);
        let g = u.left() * -side;
        let row = Alternative::row;
        let touch = vec![Touch { from: stage, to: next, heading, normal: u.left(), pull: g }];
        let low = keepout.distance + g.dot(q);
        let inside = row(GridRow { at: vec![(stage, g)], touch, low, ..GridRow::default() });
        Some(Remedy::Split(vec![
            inside,
            row(GridRow { at: vec![(stage, u)], into: vec![(stage, -u)], low: u.dot(q), ..GridRow::default() }),
            row(GridRow { at: vec![(next, -u)], out: vec![(next, -u)], low: -u.dot(q), ..GridRow::default() }),
        ]))
    }

    fn straight(
        &self,
        k: usize,
        corner: usize,
        i: usize,
        choice: &Choice,
        known: &[Decided],
        open: &Open,
    ) -> Vec<Alternative> {
        let keepout = &self.problem.keepouts[k];
        let (n, stage) = (self.grid.len(), self.grid.stage(i));
        let next = (stage + 1) % n;
        let q = keepout.region.polygon.points()[corner];
        let u = self.grid.unit(choice.headings[stage]);
        let side = u.left() * keepout.region.lies;
        let at = |k: usize, g: Point| vec![(k, g)];
        let row = Alternative::row;
        let mut out =
            vec![row(GridRow { at: at(stage, -side), low: keepout.distance - side.dot(q), ..GridRow::default() })];
        let sign = self.grid.signs[stage];
        let bent = self.grid.signs[next] == sign && keepout.region.lies == f64::from(sign);
        let heading = f64::from(choice.headings[stage]);
        let must = || self.enclosing?.inside(keepout, corner, heading, open);
        if let Some(inside) = bent.then(must).flatten() {
            return vec![inside];
        }
        let rows = [
            GridRow { at: at(stage, u), out: at(stage, u), low: u.dot(q), ..GridRow::default() },
            GridRow { at: at(next, -u), into: at(next, u), low: -u.dot(q), ..GridRow::default() },
        ];
        out.extend(past(k, corner, [StraightEnd::Begin(stage), StraightEnd::End(stage)], rows, known));
        if self.known.iter().any(|t| beyond(t, 2 * i, q, &keepout.region, keepout.distance)) {
            out.push(row(GridRow { at: at(stage, side), low: keepout.distance + side.dot(q), ..GridRow::default() }));
        }
        out
    }

    fn corner(
        &self,
        arc: &Arc,
        keepout: usize,
        corner: usize,
        track: &Track,
        decided: &[Decided],
        open: &Open,
    ) -> Option<Vec<Alternative>> {
        let rules = &self.problem.keepouts[keepout];
        let q = rules.region.polygon.points()[corner];
        let stage = arc.stage;
        let fillet = &track.fillets[arc.grid.vertex(stage)];
        let from = q - fillet.centre;
        if from.norm() < 1e-9 {
            return None;
        }
        let w = from * (1.0 / from.norm());
        let about = About::Corner { keepout, corner };
        let decide = |way| Some(Decided { about, what: What::Arc(stage, way) });
        let inner = || Alternative { decided: decide(Way::Inner), ..Alternative::row(arc.inner(w, q, rules.distance)) };
        let outer = |a: f64, b: f64| Alternative {
            rows: arc.outer(a, b, q, rules.distance),
            headings: Vec::new(),
            decided: decide(Way::Outer(a, b)),
        };
        let way = |d: &Decided| match d.what {
            What::Arc(at, way) if (d.about, at) == (about, stage) => Some(way),
            _ => None,
        };
        match decided.iter().find_map(way) {
            Some(Way::Inner) => return Some(vec![inner()]),
            Some(Way::Outer(a, b)) => {
                let here = arc.fraction(w);
                let middle = if here > a + 0.1 * (b - a) && here < b - 0.1 * (b - a) { here } else { (a + b) / 2.0 };
                return (b - a > 1e-6).then(|| vec![outer(a, middle), outer(middle, b)]);
            }
            None => {}
        }
        let turned = if stage == 0 { arc.grid.len() } else { stage };
        let (a, b) = (arc.choice.headings[turned - 1], arc.choice.headings[turned]);
        let heading = f64::from(a) + f64::from(b - a) * arc.fraction(w);
        let sign = f64::from(arc.grid.signs[stage]);
        if let Some(inside) =
            self.enclosing.filter(|_| rules.region.lies == sign).and_then(|e| e.inside(rules, corner, heading, open))
        {
            return Some(vec![inside]);
        }
        let before = (stage + arc.grid.len() - 1) % arc.grid.len();
        let joints = [StraightEnd::End(before), StraightEnd::Begin(stage)];
        let mut out: Vec<Alternative> = past(keepout, corner, joints, arc.elsewhere(q), decided).collect();
        let is_inner = rules.region.lies == f64::from(arc.grid.signs[stage]);
        let index = (2 * arc.grid.vertex(stage) + 2 * arc.grid.len() - 1) % (2 * arc.grid.len());
        let other = self.known.iter().any(|t| beyond(t, index, q, &rules.region, rules.distance));
        if is_inner || other {
            out.push(inner());
        }
        if !is_inner || other {
            out.push(outer(0.0, 1.0));
        }
        Some(out)
    }
}

/// Before the first joint of a piece and behind the second, but where the opposite was decided.
fn past(
    keepout: usize,
    corner: usize,
    joints: [StraightEnd; 2],
    rows: [GridRow; 2],
    known: &[Decided],
) -> impl Iterator<Item = Alternative> {
    let about = About::Corner { keepout, corner };
    let decided = |joint: StraightEnd, before: bool| Decided { about, what: What::Before(joint, before) };
    let both =
        [(decided(joints[0], true), decided(joints[0], false)), (decided(joints[1], false), decided(joints[1], true))];
    both.into_iter()
        .zip(rows)
        .filter(|((_, opposite), _)| !known.contains(opposite))
        .map(|((decided, _), row)| Alternative { decided: Some(decided), ..Alternative::row(row) })
}

/// Whether a known layout has a corner beside this piece, on the side where it should not be.
fn beyond(track: &Track, piece: usize, q: Point, region: &Region, distance: f64) -> bool {
    offset(track, piece, q).is_some_and(|(_, offset)| offset * region.lies <= -distance + 1e-6)
}

/// The arc at a vertex stage whose headings are chosen.
struct Arc<'a> {
    grid: &'a Grid,
    stage: usize,
    choice: &'a Choice,
}

impl Arc<'_> {
    /// Headings before and after, rad.
    fn turn(&self) -> (f64, f64) {
        let at = if self.stage == 0 { self.grid.len() } else { self.stage };
        (self.grid.angle(self.choice.headings[at - 1]), self.grid.angle(self.choice.headings[at]))
    }

    fn heading(&self, fraction: f64) -> f64 {
        let (a, b) = self.turn();
        a + (b - a) * fraction
    }

    /// From the centre to the point of the arc where the track has this heading.
    fn outward(&self, heading: f64) -> Point {
        Point::unit(heading).left() * -f64::from(self.grid.signs[self.stage])
    }

    /// The fraction of the turn at which the arc lies in this direction from its centre.
    fn fraction(&self, w: Point) -> f64 {
        let (a, b) = self.turn();
        let heading = (w.left() * f64::from(self.grid.signs[self.stage])).heading();
        crate::base::trig::wrap(heading - a) / (b - a)
    }

    fn centre(&self, g: Point, radius: f64, low: f64) -> GridRow {
        let mut row = GridRow { radius: vec![(self.stage, radius)], low, ..GridRow::default() };
        row.centre(self.grid, self.stage, g);
        row
    }

    /// R − w·(q − c) >= D
    fn inner(&self, w: Point, q: Point, distance: f64) -> GridRow {
        self.centre(w, 1.0, distance + w.dot(q))
    }

    /// The sector between two fractions, and w·(q − c) >= (R + D) cos δ in it.
    fn outer(&self, a: f64, b: f64, q: Point, distance: f64) -> Vec<GridRow> {
        let (begin, end) = (self.heading(a), self.heading(b));
        let cosine = crate::base::trig::cos((end - begin) / 2.0);
        let w = self.outward((begin + end) / 2.0);
        let (u, v) = (Point::unit(begin), Point::unit(end));
        vec![
            self.centre(-w, -cosine, distance * cosine - w.dot(q)),
            self.centre(-u, 0.0, -u.dot(q)),
            self.centre(v, 0.0, v.dot(q)),
        ]
    }

    /// The point lies before the arc or after it.
    fn elsewhere(&self, q: Point) -> [GridRow; 2] {
        let (begin, end) = self.turn();
        let (u, v) = (Point::unit(begin), Point::unit(end));
        [self.centre(u, 0.0, u.dot(q)), self.centre(-v, 0.0, -v.dot(q))]
    }
}

/// An arc that bulges towards an edge. On the arc's inner side the region's corners say more.
fn edge_rows(arc: &Arc, keepout: &Keepout, edge: usize) -> Option<Vec<Alternative>> {
    let region = &keepout.region;
    if region.lies == f64::from(arc.grid.signs[arc.stage]) {
        return None;
    }
    let e = region.edge(edge);
    let along = (e.end - e.begin) * (1.0 / e.begin.distance(e.end));
    let (low, high) = region.range(edge);
    let foot = along.dot(e.begin);
    let before = arc.centre(e.normal, -1.0, keepout.distance + e.normal.dot(e.begin));
    if region.encloses(edge) {
        return Some(vec![Alternative::row(before)]);
    }
    let mut rows = vec![before, arc.centre(-along, 0.0, -(foot + low)), arc.centre(along, 0.0, foot + high)];
    // Beyond the forbidden part, where that ends.
    if let Some(depth) = depth(region, edge, along, foot + low, foot + high) {
        rows.push(arc.centre(-e.normal, 1.0, depth - e.normal.dot(e.begin)));
    }
    Some(rows.into_iter().map(Alternative::row).collect())
}

/// How far behind an edge, over this range, the outline comes first, m.
fn depth(region: &Region, edge: usize, along: Point, low: f64, high: f64) -> Option<f64> {
    let e = region.edge(edge);
    let mut least: Option<f64> = None;
    for (i, (a, b)) in region.polygon.edges().enumerate() {
        if i == edge {
            continue;
        }
        let (s, t) = (along.dot(a), along.dot(b));
        let (begin, end) = (s.min(t).max(low), s.max(t).min(high));
        if begin >= end {
            continue;
        }
        for at in [begin, end] {
            let p = a.lerp(b, (at - s) / (t - s));
            let behind = -e.normal.dot(p - e.begin);
            if behind > -1e-9 {
                least = Some(least.map_or(behind, |d: f64| d.min(behind)).max(0.0));
            }
        }
    }
    least
}
