//! Branch and bound: best bound first, over headings, radii and the ways past regions.

use super::alternative::{Alternative, Remedy};
use super::beside::Beside;
use super::closes::{Closes, Needed, Off};
use super::conveyors::{Conveyors, Missed};
use super::found::Found;
use super::grid::Grid;
use super::master::{Pool, relax};
use super::network::Limits;
use super::node::Node;
use super::row::GridRow;
use super::tariff::{Tariff, on_hull};
use super::told::Told;
use crate::geometry::{Corner, Point, Track};
use crate::model::TOLERANCE;
use crate::problem::measures::to_variables;
use crate::problem::{Function, Problem, RowKey};
use crate::solve::Stop;
use crate::solve::exact::choice::{Choice, ON_LIST};
use crate::solve::exact::closes::Polish;
use crate::solve::exact::open::Open;
use crate::solve::options::Effort;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// Values that differ by less are alike, m or as many units of price: a tenth of what rows hold to.
pub const ALIKE: f64 = 1e-7;
/// How exactly rows are met, m or rad.
pub const FEASIBLE: f64 = TOLERANCE;
/// Violations beyond this are looked at last, m.
const FAR: f64 = 3.0;
/// While headings are open, only what matters is branched on, m.
const EARLY: f64 = 1e-2;
/// The same for what a straight's pieces cost above the bound of them, in units of price.
const EARLY_STEP: f64 = 0.05;
/// Tangents that a node's loop is held inside of, at most: every relaxation grows with the cube of its rows.
const MOST_TANGENTS: usize = 24;

/// See [`Setting::value`].
pub type Value<'a> = dyn Fn(&Tariff, &[f64]) -> f64 + 'a;

/// What a search knows from outside.
pub struct Setting<'a> {
    pub problem: &'a Problem,
    pub grid: &'a Grid,
    pub limits: Limits,
    pub rows: Vec<GridRow>,
    pub conveyors: &'a Conveyors,
    pub beside: Beside<'a>,
    pub effort: Effort,
    /// When it ends early.
    pub stop: Stop,
    /// What is open at first.
    pub open: Open,
    /// Straights (by section) that couple what is searched with what is not: their limits, the track's own width and
    /// crossings are then left to whoever puts the parts together.
    pub coupled: Option<Vec<usize>>,
    /// Vertices whose position is known, by stage.
    pub fixed: Vec<(usize, Point)>,
    /// What a layout is worth in the tariff's units: its length, or the price of its pieces.
    pub value: &'a Value<'a>,
    /// A whole number of carts must close the loop.
    pub closes: Option<Closes<'a>>,
    /// Brings a layout on the grid to feasibility, with straights of at least so much in all if that is given (m);
    /// `None` where that fails.
    pub polish: &'a Polish<'a>,
    pub told: &'a Told<'a>,
}

impl Setting<'_> {
    /// What a mix misses of conveyors' lengths by more than so much, in units of price.
    fn missed(&self, node: &Node, mix: &[(Rc<Choice>, f64)], least: f64) -> Missed {
        self.conveyors.missed((self.grid, &self.fixed), node, mix, least)
    }
}

/// Searches from an incumbent, if there is one.
pub fn search(setting: &Setting, incumbent: Option<(Vec<f64>, f64)>) -> Found {
    let value = incumbent.as_ref().map_or(f64::INFINITY, |i| i.1);
    let root = Node {
        bound: f64::NEG_INFINITY,
        id: 0,
        open: setting.open.clone(),
        rows: setting.rows.clone(),
        decided: Vec::new(),
        pool: Pool::default(),
    };
    let mut search = Search {
        setting,
        best: incumbent.map(|i| i.0),
        value,
        heap: BinaryHeap::from([root]),
        ids: 0,
        left: f64::INFINITY,
    };
    let mut nodes = 0;
    while let Some(node) = search.heap.pop() {
        if node.bound >= search.cutoff() {
            search.left = search.left.min(node.bound);
            break;
        }
        // The first node's bound is known in any case.
        if nodes > 0 && (nodes >= setting.effort.nodes || setting.stop.now()) {
            search.left = search.left.min(node.bound);
            break;
        }
        nodes += 1;
        setting.told.node(search.value - node.bound.min(search.left));
        search.expand(node);
    }
    let bound = search.left.min(search.value);
    Found { bound, variables: search.best, value: search.value, nodes, parts: Vec::new() }
}

struct Search<'a> {
    setting: &'a Setting<'a>,
    best: Option<Vec<f64>>,
    value: f64,
    heap: BinaryHeap<Node>,
    ids: usize,
    /// Least bound of all that was put aside: proven to be no better, or not decidable.
    left: f64,
}

impl Search<'_> {
    /// Nothing that costs so much is looked at.
    fn cutoff(&self) -> f64 {
        self.value - ALIKE.max(self.setting.effort.gap * self.value.min(1e12))
    }

    fn expand(&mut self, mut node: Node) {
        let grid = self.setting.grid;
        node.pool.renew(grid, &self.setting.limits.tariff, &node.open, &node.rows);
        let cutoff = self.cutoff();
        // Dearer than any relief.
        let mut dear = self.setting.limits.reliefs.iter().fold(50.0f64, |dear, price| dear.max(10.0 * price));
        let relaxed = loop {
            let limits = &self.setting.limits;
            let Some(relaxed) = relax(grid, limits, &node.open, &node.rows, &mut node.pool, cutoff, dear) else {
                return;
            };
            node.bound = node.bound.max(relaxed.bound);
            if node.bound >= cutoff {
                self.left = self.left.min(node.bound);
                return;
            }
            let missed = self.setting.missed(&node, relaxed.mix.as_deref().unwrap_or_default(), EARLY);
            if !missed.rows.is_empty() {
                node.rows.extend(missed.rows);
                node.pool.renew(grid, &self.setting.limits.tariff, &node.open, &node.rows);
                continue;
            }
            // Rows that no mix meets, though being short of them is cheaper than the cutoff.
            if relaxed.mix.is_some() || !node.open.settled() || dear > 1e7 {
                break relaxed;
            }
            dear *= 100.0;
        };
        let (before, settled) = (node.open.count(), node.open.settled());
        let remains = node.open.drop_from(&relaxed.through, cutoff);
        if node.open.count() < before {
            // What was dropped costs at least the cutoff.
            self.left = self.left.min(cutoff);
        }
        if !remains {
            return;
        }
        let Some(mix) = relaxed.mix else {
            let widest = (0..=grid.len()).max_by_key(|&k| node.open.headings[k].len()).unwrap_or(0);
            let count = node.open.headings[widest].len();
            if count < 2 && settled {
                self.undecided(&node);
            } else if count < 2 {
                // What was dropped leaves one heading each: rows that are not met may cost more now.
                self.push(&node, |_| ());
            } else {
                let middle = node.open.headings[widest][count / 2];
                self.halve(node, widest, middle);
            }
            return;
        };
        let mean = |k: usize| mix.iter().map(|(c, w)| f64::from(c.headings[k]) * w).sum::<f64>();
        let spread = |k: usize| {
            let mean = mean(k);
            let off = |c: &Choice| f64::from(c.headings[k]) - mean;
            mix.iter().map(|(c, w)| w * off(c) * off(c)).sum::<f64>()
        };
        let widest = (0..grid.len()).map(|k| (k, spread(k))).fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
        if widest.1 > 1e-9 {
            let straight = |k: usize| mix.iter().map(|(c, w)| c.straights[k] * w).sum::<f64>();
            let straights: Vec<f64> = (0..grid.len()).map(straight).collect();
            if let Some(step) = self.dearest(&node.open, &straights, EARLY_STEP) {
                self.part_cells(&node, step);
                return;
            }
            if self.split_early(&node, &mix) {
                return;
            }
            let above = mean(widest.0).floor() as i32 + 1;
            self.halve(node, widest.0, above);
            return;
        }
        let choice = Choice::blend(&mix);
        self.settle(node, choice);
    }

    /// Branches on a corner that the mean of a mix comes too close to, if that excludes the mix.
    fn split_early(&mut self, node: &Node, mix: &[(Rc<Choice>, f64)]) -> bool {
        let grid = self.setting.grid;
        let places: Vec<Vec<Point>> = mix.iter().map(|(c, _)| c.vertices(grid)).collect();
        let total: f64 = mix.iter().map(|m| m.1).sum();
        let corner = |v: usize| {
            let k = grid.stage(v);
            let point = places.iter().zip(mix).fold(Point::default(), |sum, (p, m)| sum + p[k] * (m.1 / total));
            let radius = mix.iter().map(|(c, w)| c.radii[k] * w / total).sum();
            Corner { point, radius }
        };
        let corners: Vec<Corner> = (0..grid.len()).map(corner).collect();
        let at = self.setting.problem.evaluate(&to_variables(&corners), 0.0);
        let mut close: Vec<(RowKey, f64)> =
            at.rows.iter().map(|r| (r.key, r.violation())).filter(|v| v.1 > EARLY).collect();
        // What is closest first: far on the wrong side lies what some other strand is beside.
        let far = |v: &(RowKey, f64)| v.1 > FAR;
        close.sort_by(|a, b| far(a).cmp(&far(b)).then(b.1.total_cmp(&a.1)).then(a.0.cmp(&b.0)));
        let value =
            |row: &GridRow| places.iter().zip(mix).map(|(p, (c, w))| w / total * c.value(grid, row, p)).sum::<f64>();
        if let Some(alternatives) = self.enclose(node, &value) {
            self.branch(node, alternatives);
            return true;
        }
        for (key, _) in close {
            let Some(Remedy::Split(alternatives)) =
                self.setting.beside.early(key, &node.open, &at.track, &node.decided)
            else {
                continue;
            };
            if alternatives.iter().all(|a| a.rows.iter().any(|row| value(row) < row.low - EARLY)) {
                self.branch(node, alternatives);
                return true;
            }
        }
        false
    }

    /// Where a relaxed loop misses most of what it goes around.
    fn enclose(&self, node: &Node, value: &dyn Fn(&GridRow) -> f64) -> Option<Vec<Alternative>> {
        let known = node.rows.iter().filter(|row| !row.touch.is_empty()).count();
        let enclosing = self.setting.beside.enclosing.filter(|_| known < MOST_TANGENTS)?;
        enclosing.enclose(&node.open, value, EARLY)
    }

    fn branch(&mut self, node: &Node, alternatives: Vec<Alternative>) {
        let fixed = &self.setting.fixed;
        for alternative in alternatives {
            self.push(node, |c| {
                for (k, least, most) in &alternative.headings {
                    c.open.headings[*k].retain(|h| (*least..=*most).contains(&f64::from(*h)));
                }
                c.rows.extend(alternative.rows.into_iter().map(|mut row| {
                    row.low -= row.anchor(fixed);
                    row
                }));
                if let Some(decided) = alternative.decided {
                    c.decided.retain(|d| !decided.replaces(d));
                    c.decided.push(decided);
                }
            });
        }
    }

    /// A node that can be branched no further keeps its bound.
    fn undecided(&mut self, node: &Node) {
        self.left = self.left.min(node.bound);
    }

    fn push(&mut self, node: &Node, change: impl FnOnce(&mut Node)) {
        self.ids += 1;
        let mut child = Node {
            bound: node.bound,
            id: self.ids,
            open: node.open.clone(),
            rows: node.rows.clone(),
            decided: node.decided.clone(),
            pool: node.pool.clone(),
        };
        change(&mut child);
        if child.open.headings.iter().all(|h| !h.is_empty()) {
            self.heap.push(child);
        }
    }

    /// Headings below `above`, and the others.
    fn halve(&mut self, node: Node, k: usize, above: i32) {
        self.push(&node, |c| c.open.headings[k].retain(|&h| h < above));
        self.push(&node, |c| c.open.headings[k].retain(|&h| h >= above));
    }

    /// One heading, those below and those above.
    fn single_out(&mut self, node: Node, k: usize, heading: i32) {
        self.push(&node, |c| c.open.headings[k].retain(|&h| h < heading));
        self.push(&node, |c| c.open.headings[k].retain(|&h| h > heading));
        self.push(&node, |c| c.open.headings[k].retain(|&h| h == heading));
    }

    /// The straight whose pieces cost most above the hull of what is open, and the cell it lies in.
    fn dearest(&self, open: &Open, straights: &[f64], above: f64) -> Option<(usize, usize)> {
        let mut worst = (above, None);
        for (k, cells) in self.setting.limits.tariff.cells.iter().enumerate() {
            let cell = cells.cell(straights[k], open.cells[k]);
            let off = cells.price(cell) - on_hull(&open.hulls[k], straights[k]);
            if open.cells[k].0 < open.cells[k].1 && off > worst.0 {
                worst = (off, Some((k, cell)));
            }
        }
        worst.1
    }

    /// A straight in one of its cells, and in those before and behind it.
    fn part_cells(&mut self, node: &Node, (k, cell): (usize, usize)) {
        let (from, to) = node.open.cells[k];
        for (from, to) in [(from, cell.wrapping_sub(1)), (cell, cell), (cell + 1, to)] {
            if from > to || to == usize::MAX {
                continue;
            }
            let mut open = node.open.clone();
            if open.restrict(&self.setting.limits.tariff, k, (from, to)) {
                self.push(node, |c| c.open = open);
            }
        }
    }

    /// Straights of at least `least` in all, and of at most `most`, m.
    fn part_lengths(&mut self, node: &Node, least: f64, most: f64) {
        for (sign, low) in [(1.0, least), (-1.0, -most)] {
            let straight = (0..self.setting.grid.len()).map(|k| (k, sign)).collect();
            let low = low - 0.1 * FEASIBLE;
            self.push(node, |c| c.rows.push(GridRow { straight, low, ..GridRow::default() }));
        }
    }

    /// By how much longer and by how much shorter straights have to be in all for the chain to close, m, with turns and
    /// radii chosen. Where that is not known well enough a straight is parted, or the node keeps its bound; nothing is
    /// returned then.
    fn apart(&mut self, node: &Node, track: &Track, choice: &Choice, off: Off) -> Option<(f64, f64)> {
        let (grid, closes) = (self.setting.grid, self.setting.closes?);
        let within = node.straights(&self.setting.limits.straights);
        let by_section: Vec<(f64, f64)> = (0..grid.len()).map(|i| within[grid.stage(i)]).collect();
        let (section, (low, high)) = match closes.needed(track, off, &by_section) {
            Needed::Lengths { longer, shorter } => return Some((longer, shorter)),
            Needed::Unknown => {
                self.undecided(node);
                return None;
            }
            Needed::Parted { section, within } => (section, within),
        };
        // At the layout at hand, near which the least lies, unless that leaves nearly all of it whole.
        let (k, margin) = (grid.stage(section), 0.1 * (high - low));
        let at = choice.straights[k];
        let at = if at - low < margin || high - at < margin { 0.5 * (low + high) } else { at };
        for (sign, low) in [(1.0, at), (-1.0, -at)] {
            self.push(node, |c| c.rows.push(GridRow { straight: vec![(k, sign)], low, ..GridRow::default() }));
        }
        None
    }

    /// The relaxation is a layout: accept it, or branch on what it lacks.
    fn settle(&mut self, node: Node, choice: Choice) {
        let (grid, problem) = (self.setting.grid, self.setting.problem);
        let vertices = choice.vertices(grid);
        let value = |row: &GridRow| choice.value(grid, row, &vertices);
        if let Some(alternatives) = self.enclose(&node, &value) {
            return self.branch(&node, alternatives);
        }
        let missed = self.setting.missed(&node, &[(Rc::new(choice.clone()), 1.0)], 0.1 * ALIKE);
        if !missed.rows.is_empty() {
            return self.push(&node, |c| c.rows.extend(missed.rows));
        }
        let x = choice.variables(grid);
        let at = problem.evaluate(&x, 0.0);
        let mut violated: Vec<(RowKey, f64)> = at
            .rows
            .iter()
            .map(|r| (r.key, r.violation()))
            .filter(|v| v.1 > FEASIBLE && !self.left_to_others(v.0))
            .collect();
        // What is closest first: far on the wrong side lies what some other strand is beside.
        let far = |v: &(RowKey, f64)| v.1 > FAR;
        violated.sort_by(|a, b| far(a).cmp(&far(b)).then(b.1.total_cmp(&a.1)).then(a.0.cmp(&b.0)));
        for &(key, _) in &violated {
            let remedy = self.setting.beside.remedy(key, &choice, &node.open, &at.track, &node.decided);
            match remedy {
                Some(Remedy::Halve(k, above)) => return self.halve(node, k, above),
                Some(Remedy::Settle(k)) => return self.single_out(node, k, choice.headings[k]),
                Some(Remedy::Split(alternatives)) if self.leads_on(&choice, &alternatives) => {
                    self.branch(&node, alternatives);
                    return;
                }
                _ => {}
            }
        }
        let off = |k: usize| {
            let r = choice.radii[k];
            grid.radii[k].iter().map(|l| (l - r).abs()).fold(f64::INFINITY, f64::min)
        };
        let farthest = (0..grid.len()).map(|k| (k, off(k))).fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
        if farthest.1 > ON_LIST {
            let (k, r) = (farthest.0, choice.radii[farthest.0]);
            let above = grid.radii[k].partition_point(|l| *l < r);
            self.push(&node, |c| c.open.radii[k].1 = above - 1);
            self.push(&node, |c| c.open.radii[k].0 = above);
            return;
        }
        let crosses = || self.setting.coupled.is_none() && !problem.crossings(&at.track).is_empty();
        let clean = violated.is_empty() && !crosses();
        let off = self.setting.closes.map_or(Some(Off::default()), |c| c.off(&at.track)).filter(|_| clean);
        let lack = off.map(|off| off.longer);
        let total = || (0..grid.len()).map(|k| at.track.straight(k).length).sum::<f64>();
        let counted = !self.setting.limits.tariff.cells.is_empty();
        let better = match lack {
            Some(0.0) => Some(x),
            // Longer by what the chain lacks, if that can be shorter than the best.
            Some(lack) if node.bound + lack < self.value => {
                self.setting.closes.and_then(|c| c.stretch(&x, self.setting.polish))
            }
            Some(_) => None,
            None => (self.setting.polish)(&x, None).and_then(|x| match self.setting.closes {
                Some(closes) => closes.stretch(&x, self.setting.polish),
                None => Some(x),
            }),
        };
        if let Some(x) = better {
            let value = (self.setting.value)(&self.setting.limits.tariff, &x);
            if value < self.value {
                self.value = value;
                self.best = Some(x);
            }
        }
        let settled = || node.open.settled() && node.open.radii.iter().all(|(from, to)| from == to);
        if let Some(off) = off.filter(|off| counted && off.longer > 0.0 && settled()) {
            // What closes is longer or shorter than this, and either may cost less.
            if let Some((longer, shorter)) = self.apart(&node, &at.track, &choice, off) {
                self.part_lengths(&node, total() + longer, total() - shorter);
            }
            return;
        }
        if counted && clean && node.bound < self.cutoff() {
            // The pieces of some straight cost more than their bound.
            if let Some(step) = self.dearest(&node.open, &choice.straights, 1e-9) {
                return self.part_cells(&node, step);
            }
        }
        if lack == Some(0.0) && !(counted && clean && node.bound < self.cutoff()) {
            // Nothing with these rows is shorter than the relaxation, which this is.
            self.left = self.left.min(node.bound);
            return;
        }
        if let Some(k) = missed.open {
            return self.single_out(node, k, choice.headings[k]);
        }
        // Something that no row here says: other headings and radii remain, then this choice alone.
        if let Some(k) = (0..grid.len()).find(|&k| node.open.headings[k].len() > 1) {
            return self.single_out(node, k, choice.headings[k]);
        }
        if let Some(k) = (0..grid.len()).find(|&k| node.open.radii[k].0 < node.open.radii[k].1) {
            let place = grid.radii[k].partition_point(|l| *l < choice.radii[k] - ON_LIST);
            let (low, high) = node.open.radii[k];
            if place > low {
                self.push(&node, |c| c.open.radii[k] = (low, place - 1));
            }
            if place < high {
                self.push(&node, |c| c.open.radii[k] = (place + 1, high));
            }
            self.push(&node, |c| c.open.radii[k] = (place, place));
            return;
        }
        // What closes at another length has other straights; what costs more than its bound may have any.
        if let Some(off) = off.filter(|_| !counted) {
            if let Some((longer, _)) = self.apart(&node, &at.track, &choice, off) {
                let straight = (0..grid.len()).map(|k| (k, 1.0)).collect();
                let low = total() + longer - 0.1 * FEASIBLE;
                self.push(&node, |c| c.rows.push(GridRow { straight, low, ..GridRow::default() }));
            }
            return;
        }
        self.undecided(&node);
    }

    fn left_to_others(&self, key: RowKey) -> bool {
        let Some(coupled) = &self.setting.coupled else { return false };
        match key {
            RowKey::Own(..) => true,
            RowKey::Listed(i) => {
                matches!(self.setting.problem.rows[i].function, Function::Straight(s) if coupled.contains(&s))
            }
            RowKey::Clearance(..) | RowKey::Gap(..) => false,
        }
    }

    /// Whether every alternative excludes the layout at hand.
    fn leads_on(&self, choice: &Choice, alternatives: &[Alternative]) -> bool {
        let grid = self.setting.grid;
        let vertices = choice.vertices(grid);
        let excluded = |row: &GridRow| choice.value(grid, row, &vertices) < row.low - 0.1 * FEASIBLE;
        alternatives.iter().all(|a| a.rows.iter().any(excluded))
    }
}
