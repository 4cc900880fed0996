//! Track and equipment together: branch and bound over how long straights have to be for what stands on them, and on which
//! section a fed piece of equipment stands.
//!
//! The track is solved with rows that every placement needs ([`placement::needs`]), its equipment placed on it, exactly.
//!
//! - Where some of it finds no place for want of length: n of a kind that has to stand on k straights, which hold fewer,
//!   stand only on a track of which one of them holds one more than now ([`placement::next`]). Each of these is a node with
//!   the row of that, and together they are all layouts.
//! - Where lengths would do and obstacles, walls or other equipment are in the way, longer straights are only tried: the
//!   node's own bound stays.
//! - Under `cost`, what is compared is the price of the whole: track, equipment and conveyors. The track's own search counts
//!   a conveyor to a section at the least that it is there ([`exact::Conveyors`]).
//!
//! Each node is solved with the certificate of its track, and the least bound of what is left holds for all. The written
//! layout counts among what is found, and what a longer straight made room for is tried with shorter ones ([`shorter`]).

mod moved;
mod shorter;

use super::options::{Effort, Options, Tell};
use super::violations::off_grid;
use super::{Certificate, Counted, Stage, Status, exact, goals, report};
use crate::geometry::Track;
use crate::model::{
    Constraint, ConstraintKind, Declared, EquipmentSide, Formula, Goal, Layout, Objective, Stands, Target, Unit,
};
use crate::placement::{self, Placement};
use crate::problem::measures::to_variables;
use crate::problem::{Problem, Scope};
use crate::solve::conflict::Proof;
use moved::meets_all;
use shorter::Halved;

/// Most tracks that are solved, beside the first.
const MOST_TRACKS: usize = 240;
/// Of the nodes of the first track's search, each other one has this part; all others together have so many times as many.
const PART: usize = 4;
const OTHERS: usize = 2;
/// Of so many straights at most two are made longer at once, the second by a share of what the first is.
const MOST_PAIRED: usize = 6;
const SHARES: [f64; 3] = [0.25, 0.5, 0.75];
/// Sections are chosen until what conveyors leave open is this part of the value.
const FINE: f64 = 2e-4;
/// What two values differ by at least, m or EUR.
const BETTER: f64 = 1e-9;

/// Solves a layout in stages; the last one returned is the result. Equipment that is placed freely has its part in which
/// track that is. A layout without vertices has no stages: `route::find` gives it vertices.
pub fn solve(layout: &Layout, options: &Options, watch: Tell) -> Vec<Stage> {
    if !counts(layout) || layout.vertices.is_empty() || !is_known(&layout.objective) {
        return goals::solve(layout, options, watch);
    }
    Search::new(layout, options, watch).run()
}

/// Whether equipment has its part in which track is the best: where some is placed freely, and where a price counts and a
/// conveyor to a given place is as long as the track lets it be.
pub fn counts(layout: &Layout) -> bool {
    let costs = layout.objective.weight(Goal::Cost).is_some();
    layout
        .equipment
        .declared
        .iter()
        .any(|d| matches!(d.stands, Stands::Free { .. }) || (costs && d.priced_from().is_some()))
}

/// Length, cost and their sum; other goals place equipment on the track that they find.
fn is_known(objective: &Objective) -> bool {
    let known = |goal: &Goal| matches!(goal, Goal::Length | Goal::Cost);
    !objective.terms.is_empty() && objective.within.is_none() && objective.terms.iter().all(|(_, goal)| known(goal))
}

/// Least lengths of straights; the section of each conveyor; whether the node is complete.
type Seen = (Vec<(usize, f64)>, Vec<Option<usize>>, bool);

/// Some of the layouts, with what is known of all of them.
#[derive(Clone, Debug)]
struct Node {
    /// Least lengths of straights, m.
    straights: Vec<(usize, f64)>,
    /// The section that each fed piece of equipment stands on, where that is chosen.
    fed: Vec<Option<usize>>,
    bound: f64,
    /// Whether the layouts of its parent are all among its siblings' and its own; else it is only tried.
    complete: bool,
    /// Where the length of a straight is halved.
    halved: Option<Halved>,
}

/// One piece of equipment each, placed freely, and the price of a metre of its conveyor, EUR.
fn fed(layout: &Layout) -> Vec<(usize, f64)> {
    let one = |(index, d): (usize, &Declared)| {
        let single = matches!(d.stands, Stands::Free { count: 1, .. });
        (single && d.priced_from().is_some()).then_some((index, d.of.conveyor))
    };
    layout.equipment.declared.iter().enumerate().filter_map(one).collect()
}

/// What walls ask, as constraints.
fn walls(layout: &Layout) -> Vec<Constraint> {
    let problem = Problem::new(layout, Scope::Building);
    let held = |section: usize| problem.holds_heading(section);
    let constraint = |wall: placement::Wall| {
        let term = |factor: f64, of: Formula| Formula::Product(vec![Formula::Constant(factor), of]);
        let (x, y) = (term(wall.pull.x, Formula::X(wall.vertex)), term(wall.pull.y, Formula::Y(wall.vertex)));
        let formula = Formula::Sum(vec![x, y]);
        let kind = ConstraintKind::Require { formula, low: wall.low, high: f64::INFINITY, unit: Unit::Metre };
        Constraint { kind, reason: None, span: layout.equipment.declared[wall.declared].span }
    };
    placement::walls(layout, &Track::new(&layout.corners()), &held).into_iter().map(constraint).collect()
}

fn is_infeasible(stages: &[Stage]) -> bool {
    stages.last().is_none_or(|last| last.certificate.is_none() || last.status == Status::Infeasible)
}

/// A track with its equipment.
struct Whole {
    stages: Vec<Stage>,
    lacking: usize,
    /// m or EUR
    value: f64,
}

struct Search<'a> {
    layout: &'a Layout,
    options: &'a Options,
    watch: Tell<'a>,
    written: Track,
    /// What is fed, one piece each, and the price of a metre of its conveyor, EUR; none where only length counts.
    fed: Vec<(usize, f64)>,
    /// What walls ask of a track that a conveyor draws towards them.
    walls: Vec<Constraint>,
    best: Option<Whole>,
    /// No layout of the nodes that were left is better.
    closed: f64,
    nodes: usize,
    /// Places that tracks were moved to.
    moves: usize,
}

impl<'a> Search<'a> {
    fn new(layout: &'a Layout, options: &'a Options, watch: Tell<'a>) -> Self {
        let costs = layout.objective.terms.iter().any(|(_, goal)| *goal == Goal::Cost);
        Search {
            layout,
            options,
            watch,
            written: Track::new(&layout.corners()),
            fed: if costs { fed(layout) } else { Vec::new() },
            walls: if costs { walls(layout) } else { Vec::new() },
            best: None,
            closed: f64::INFINITY,
            nodes: 0,
            moves: 0,
        }
    }

    fn run(mut self) -> Vec<Stage> {
        let fed = self.fed.iter().map(|(declared, _)| self.only_section(*declared)).collect();
        let root = Node { straights: Vec::new(), fed, bound: 0.0, complete: true, halved: None };
        let mut open = vec![root];
        // The same layouts need no second node, unless the first one was only tried.
        let mut seen: Vec<Seen> = Vec::new();
        let (mut tracks, mut first) = (0, 0);
        let mut counted = Counted::Length;
        let mut assumed: Vec<String> = Vec::new();
        while let Some(next) = take(&mut open) {
            if self.best.as_ref().is_some_and(|b| b.lacking == 0 && next.bound >= b.value - BETTER) {
                continue;
            }
            let others = (OTHERS * first).max(1000);
            let spent = tracks > 0 && self.nodes - first >= others && self.nodes > self.options.effort.nodes;
            if tracks > MOST_TRACKS || spent || (tracks > 0 && self.options.stop.now()) {
                self.close(&next, next.bound);
                continue;
            }
            let (mut layout, mut stages) = self.track(&next, tracks);
            if tracks == 0 && !self.walls.is_empty() && is_infeasible(&stages) {
                // What is in the way of what is told of a track without them.
                self.walls.clear();
                (layout, stages) = self.track(&next, tracks);
            }
            tracks += 1;
            let Some(last) = stages.last() else { return stages };
            let Some(certificate) = last.certificate.clone().filter(|_| last.status != Status::Infeasible) else {
                if tracks == 1 {
                    return stages;
                }
                // The proof takes longer than the track.
                if next.complete && !is_refuted(&layout, &stages) {
                    self.close(&next, next.bound);
                }
                continue;
            };
            self.nodes += certificate.nodes;
            counted = certificate.counted;
            if tracks == 1 {
                first = self.nodes;
                self.keep_written(&stages, &certificate);
                self.keep_shortest(&certificate);
            }
            for words in &certificate.assumed {
                if !assumed.contains(words) {
                    assumed.push(words.clone());
                }
            }
            let track = Track::new(&last.corners);
            let mut placement = placement::place(&layout, &track);
            let mut next = next;
            // What the track's search counted of them; nothing under length.
            let conveyors = exact::Conveyors::new(&layout, &self.written);
            next.bound = next.bound.max(self.bound(&layout, &conveyors, counted, certificate.lower_bound));
            let mut longer = (Vec::new(), true);
            if !placement.is_whole() {
                longer = self.longer(&next, &track, &placement);
                if !longer.1
                    && let Some((corners, roomy)) = self.moved(&last.corners)
                    && let Some(last) = stages.last_mut()
                {
                    (last.corners, placement) = (corners, roomy);
                }
            }
            let lacking: usize = placement.missing.iter().map(|(_, n)| n).sum();
            // What it is worth without its conveyors.
            let own = certificate.value - conveyors.price(&track);
            self.keep(stages, (counted, own), &placement, lacking);
            let least = self.best.as_ref().filter(|best| best.lacking == 0).map_or(f64::INFINITY, |best| best.value);
            open.extend(next.shorter(lacking == 0, least));
            if lacking == 0 {
                open.extend(self.split(&next, &placement));
                continue;
            }
            let (children, complete) = longer;
            if !complete {
                self.close(&next, next.bound);
            }
            for child in children {
                let child = Node { complete: child.complete && next.complete, ..child };
                let same = |s: &Seen| s.0 == child.straights && s.1 == child.fed && (s.2 || !child.complete);
                if !seen.iter().any(same) {
                    seen.push((child.straights.clone(), child.fed.clone(), child.complete));
                    open.push(child);
                }
            }
        }
        self.finish(counted, assumed)
    }

    fn close(&mut self, node: &Node, bound: f64) {
        if node.complete {
            self.closed = self.closed.min(bound);
        }
    }

    /// The section of equipment that may stand on one only.
    fn only_section(&self, declared: usize) -> Option<usize> {
        match self.sections(declared)[..] {
            [section] => Some(section),
            _ => None,
        }
    }

    fn sections(&self, declared: usize) -> Vec<usize> {
        match &self.layout.equipment.declared[declared].stands {
            Stands::Free { on, .. } if !on.is_empty() => on.clone(),
            _ => (0..self.layout.vertices.len()).collect(),
        }
    }

    /// No layout of a node is better than its track's bound with the conveyors that it counts, its equipment's price and
    /// that of other conveyors at their least. `layout` is the node's.
    fn bound(&self, layout: &Layout, conveyors: &exact::Conveyors, counted: Counted, track: f64) -> f64 {
        if counted == Counted::Length {
            return track;
        }
        let declared = &layout.equipment.declared;
        let equipment: f64 = declared.iter().map(|d| d.count() as f64 * d.of.article.price.unwrap_or(0.0)).sum();
        let known: Vec<usize> = conveyors.declared().collect();
        let least = placement::least_conveyors(layout, &self.written);
        let others = (0..declared.len()).filter(|i| !known.contains(i));
        let other: f64 = others.map(|i| declared[i].count() as f64 * declared[i].of.conveyor * least[i]).sum();
        (track + equipment + other) * (1.0 - 4.0 * f64::EPSILON)
    }

    fn track(&self, node: &Node, tracks: usize) -> (Layout, Vec<Stage>) {
        let mut layout = self.layout.clone();
        layout.constraints.extend(self.walls.iter().cloned());
        layout.constraints.extend(node.straights.iter().map(|&(from, low)| {
            let formula = Formula::Length(Target { from, straight: true });
            let kind = ConstraintKind::Require { formula, low, high: f64::INFINITY, unit: Unit::Metre };
            Constraint { kind, reason: None, span: layout.span }
        }));
        for ((declared, _), section) in self.fed.iter().zip(&node.fed) {
            let stands = &mut layout.equipment.declared[*declared].stands;
            if let (Stands::Free { on, .. }, Some(section)) = (stands, section) {
                *on = vec![*section];
            }
        }
        let effort = self.options.effort;
        let nodes = if tracks == 0 { effort.nodes } else { effort.nodes / PART };
        let options = Options { effort: Effort { nodes, class: false, ..effort }, ..*self.options };
        let stages = goals::solve(&layout, &options, self.watch);
        (layout, stages)
    }

    /// A node whose track has room for everything: by the section of the most expensive conveyor of which that is open. Its
    /// bound closes it where nothing is left to split.
    fn split(&mut self, node: &Node, placement: &Placement) -> Vec<Node> {
        let fine = FINE * self.best.as_ref().map_or(node.bound, |best| best.value);
        let price = |i: usize| {
            let (declared, price) = self.fed[i];
            let placed = placement.placed.iter().find(|placed| placed.declared == declared);
            placed.and_then(|placed| placed.conveyor).unwrap_or(0.0) * price
        };
        let open = (0..self.fed.len()).filter(|i| node.fed[*i].is_none() && price(*i) > fine);
        let Some(i) = open.max_by(|a, b| price(*a).total_cmp(&price(*b)).then(b.cmp(a))) else {
            self.close(node, node.bound);
            return Vec::new();
        };
        let on = |section: usize| {
            let mut fed = node.fed.clone();
            fed[i] = Some(section);
            Node { fed, halved: None, ..node.clone() }
        };
        self.sections(self.fed[i].0).into_iter().map(on).collect()
    }

    /// Takes a track with its equipment if it is better than what is known.
    /// `own` is what it is worth without its equipment and conveyors.
    fn keep(&mut self, mut stages: Vec<Stage>, (counted, own): (Counted, f64), placement: &Placement, lacking: usize) {
        // Whatever section was chosen here, the result is placed anew on all of them.
        let corners = stages.last().map_or_else(|| self.layout.corners(), |last| last.corners.clone());
        let free = placement::place(self.layout, &Track::new(&corners));
        let placement = if free.is_whole() && free.price() < placement.price() { &free } else { placement };
        let price = |p: &Placement| if counted == Counted::Length { 0.0 } else { p.price() };
        let mut value = own + price(placement);
        if counted != Counted::Length
            && lacking == 0
            && let Some((corners, cheaper)) = stages.last().and_then(|last| self.shifted(&last.corners, placement))
        {
            value += price(&cheaper) - price(placement);
            if let Some(last) = stages.last_mut() {
                last.corners = corners;
            }
        }
        let better = match &self.best {
            None => true,
            Some(best) => lacking < best.lacking || (lacking == best.lacking && value < best.value - BETTER),
        };
        if better {
            self.best = Some(Whole { stages, lacking, value });
        }
    }

    /// Takes the shortest layout with room for everything, where it is a price that counts: a first one to be better than.
    fn keep_shortest(&mut self, certificate: &Certificate) {
        let Counted::Price { metre } = certificate.counted else { return };
        let span = self.layout.objective.span;
        let objective = Objective { terms: vec![(1.0, Goal::Length)], span, ..Objective::default() };
        let layout = Layout { objective, ..self.layout.clone() };
        let effort = Effort { nodes: self.options.effort.nodes / PART, class: false, ..self.options.effort };
        let options = Options { effort, ..*self.options };
        let stages = Search::new(&layout, &options, self.watch).run();
        let Some(last) = stages.last().filter(|last| last.status != Status::Infeasible) else { return };
        let track = Track::new(&last.corners);
        let (placement, value) = (placement::place(self.layout, &track), exact::worth(self.layout, &track, metre));
        if placement.is_whole() && value.is_finite() {
            self.keep(stages, (certificate.counted, value), &placement, 0);
        }
    }

    /// Takes the written layout if it meets every row, is of the catalogue, closes as asked and has room for everything.
    fn keep_written(&mut self, stages: &[Stage], certificate: &Certificate) {
        let problem = Problem::new(self.layout, Scope::Obstacles);
        let corners = self.layout.corners();
        let of_catalogue = off_grid(self.layout, &problem, &to_variables(&corners), 1e-6).is_empty();
        let closes = exact::Closes::new(self.layout).is_none_or(|c| c.lack(&self.written) == Some(0.0));
        if !of_catalogue || !closes || !meets_all(&problem, &corners) {
            return;
        }
        let placement = placement::place(self.layout, &self.written);
        let value = match certificate.counted {
            Counted::Length => self.written.length,
            Counted::Price { metre } => exact::worth(self.layout, &self.written, metre),
        };
        if !placement.is_whole() || !value.is_finite() {
            return;
        }
        let mut stages = stages.to_vec();
        if let Some(last) = stages.last_mut() {
            let rows = problem.evaluate(&to_variables(&corners), 0.0).rows;
            last.max_violation = rows.iter().map(|row| row.violation()).fold(0.0, f64::max);
            (last.corners, last.length, last.violations) = (corners, self.written.length, Vec::new());
        }
        self.keep(stages, (certificate.counted, value), &placement, 0);
    }

    /// Nodes with longer straights, and whether all layouts of the node with room for everything are among them.
    fn longer(&self, node: &Node, track: &Track, placement: &Placement) -> (Vec<Node>, bool) {
        let longer = |section: usize, low: f64, complete: bool| {
            let mut straights: Vec<(usize, f64)> =
                node.straights.iter().copied().filter(|(s, _)| *s != section).collect();
            straights.push((section, low));
            straights.sort_by_key(|a| a.0);
            Node { straights, complete, halved: None, ..node.clone() }
        };
        let declared = |i: usize| &self.layout.equipment.declared[i];
        for &(i, _) in &placement.missing {
            let of = &declared(i).of;
            let sides = if of.side == EquipmentSide::Either { 2 } else { 1 };
            let next = |s: &usize| (*s, placement::next(of, track.straight(*s).length));
            let held: Vec<(usize, (usize, f64))> = self.sections(i).iter().map(next).collect();
            let room: usize = held.iter().map(|(_, (count, _))| sides * count).sum();
            if room < declared(i).count() {
                return (held.into_iter().map(|(s, (_, low))| longer(s, low, true)).collect(), true);
            }
        }
        let mut tried = Vec::new();
        for &(i, lacking) in &placement.missing {
            let of = &declared(i).of;
            let more = lacking as f64 * (of.stretch + of.service);
            let sections = self.sections(i);
            let length = |s: usize| track.straight(s).length.max(0.0);
            for &s in &sections {
                let from = [(s, length(s))];
                tried.push(longer(s, length(s) + more, false).halving(&from));
                // Where nothing stands yet, all of it with its distances from curves.
                tried.push(longer(s, length(s).max(more + 2.0 * of.from_curve), false).halving(&from));
            }
            // All of it on one, and a share on another.
            let few = node.straights.is_empty() && sections.len() <= MOST_PAIRED;
            let pairs = sections.iter().flat_map(|s| sections.iter().map(move |t| (*s, *t)));
            for (s, t) in pairs.filter(|(s, t)| few && s != t) {
                for share in SHARES {
                    let mut both = longer(s, length(s) + more, false);
                    both.straights.push((t, length(t) + share * more));
                    both.straights.sort_by_key(|a| a.0);
                    tried.push(both.halving(&[(s, length(s)), (t, length(t))]));
                }
            }
        }
        (tried, false)
    }

    fn finish(self, counted: Counted, mut assumed: Vec<String>) -> Vec<Stage> {
        let Some(Whole { mut stages, lacking, value }) = self.best else { return Vec::new() };
        let Some(last) = stages.last_mut() else { return stages };
        if lacking > 0 {
            // What is proven of the track is not proven of a layout with all of its equipment.
            if last.status == Status::Proven {
                last.status = Status::BestFound;
            }
            if let Some(certificate) = &mut last.certificate {
                certificate.proven = false;
                certificate.assumed.push("equipment that finds no room is left out".to_owned());
            }
            return stages;
        }
        let (seconds, held) = last.certificate.as_ref().map_or((0.0, 0.0), |c| (c.seconds, c.held));
        assumed.push(match counted {
            // The price of all that is ordered is counted when the layout is compiled.
            Counted::Price { .. } if !self.layout.objective.total_price => {
                "the price is that of track, equipment and conveyors".to_owned()
            }
            Counted::Length | Counted::Price { .. } => "equipment has room on the track".to_owned(),
        });
        let certificate = Certificate::new(counted, value, self.closed.min(value), self.nodes, assumed).held_to(held);
        if matches!(last.status, Status::Proven | Status::BestFound | Status::Local) {
            last.status = if certificate.proven { Status::Proven } else { Status::BestFound };
        }
        last.certificate = Some(Certificate { seconds, ..certificate });
        stages
    }
}

/// Whether it is proven that there is no such layout.
fn is_refuted(layout: &Layout, stages: &[Stage]) -> bool {
    let proven = |proof: Proof| matches!(proof, Proof::Bounds | Proof::Grid | Proof::GridOfAll);
    stages.last().is_some_and(|last| last.refuted)
        || report::conflicts(layout, stages).iter().any(|conflict| proven(conflict.proof))
}

/// The node with the least bound, the first of those alike; halved straights come before, and what is only tried last.
fn take(open: &mut Vec<Node>) -> Option<Node> {
    let order = |a: &usize, b: &usize| {
        let (a, b) = (&open[*a], &open[*b]);
        let halved = b.is_halved().cmp(&a.is_halved());
        halved
            .then(b.complete.cmp(&a.complete))
            .then(a.bound.total_cmp(&b.bound))
            .then(a.straights.len().cmp(&b.straights.len()))
    };
    let best = (0..open.len()).min_by(order)?;
    Some(open.remove(best))
}
