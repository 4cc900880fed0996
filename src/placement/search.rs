//! The cheapest places where equipment of different straights may be in each other's way as well: branch and bound on top
//! of [`super::along`], which leaves that out.
//!
//! Two that meet each other stand at begins p and q. There is a box P × Q around (p, q) in which they meet wherever they
//! stand, as the pairs of begins at which two rectangles overlap are a convex set. In every layout, the one is not in P or
//! the other is not in Q.

use super::along::cheapest;
use super::frontier::Put;
use super::program::{Along, Free};
use super::task::{Block, Cause, Task, without};

/// Most nodes of the search.
const MOST_NODES: usize = 1000;

/// What was found.
#[derive(Clone, Debug)]
pub struct Found {
    pub along: Along,
    /// No places of everything cost less on this track, EUR.
    pub bound: f64,
    pub nodes: usize,
}

struct Node {
    shut: Vec<(usize, usize, Block)>,
    along: Along,
    /// The cost at least, EUR.
    bound: f64,
}

pub fn search(task: &Task) -> Found {
    let mut nodes = 1;
    let mut open = vec![node(task, Vec::new())];
    let mut best: Option<Along> = None;
    loop {
        let order = |a: &usize, b: &usize| {
            let (a, b): (&Node, &Node) = (&open[*a], &open[*b]);
            a.along.lacking().cmp(&b.along.lacking()).then(a.bound.total_cmp(&b.bound))
        };
        // Among those alike the last one, which is the deepest.
        let next = (0..open.len()).rev().min_by(order).unwrap_or(0);
        let Node { shut, along, bound } = open.swap_remove(next);
        // What was found is the best if nothing that is open lacks less, or is cheaper.
        if let Some(best) = best.take_if(|best| worth(best) <= (along.lacking(), bound)) {
            return Found { bound: bound.min(best.cost), along: best, nodes };
        }
        let Some((a, b)) = meeting(task, &along.puts) else {
            return Found { bound: bound.min(along.cost), along, nodes };
        };
        let lacking = along.lacking();
        let sorted = sorted_out(task, along);
        if best.as_ref().is_none_or(|best| worth(&sorted) < worth(best)) {
            best = Some(sorted);
        }
        if nodes >= MOST_NODES
            && let Some(mut along) = best.take()
        {
            along.whole &= along.lacking() == lacking;
            return Found { bound: bound.min(along.cost), along, nodes };
        }
        for block in boxed(task, a, b) {
            let mut shut = shut.clone();
            shut.push(block);
            open.push(node(task, shut));
            nodes += 1;
        }
    }
}

/// Fewer that are lacking, and then the cheaper.
fn worth(along: &Along) -> (usize, f64) {
    (along.lacking(), along.cost)
}

fn node(task: &Task, shut: Vec<(usize, usize, Block)>) -> Node {
    let free: Free = task
        .groups
        .iter()
        .enumerate()
        .map(|(g, group)| {
            let of = |(r, room): (usize, &super::task::Room)| {
                let own: Vec<Block> = shut.iter().filter(|s| (s.0, s.1) == (g, r)).map(|s| s.2).collect();
                if own.is_empty() {
                    room.free.clone()
                } else {
                    without(room.reach, &[own, room.blocks.clone()].concat())
                }
            };
            group.rooms.iter().enumerate().map(of).collect()
        })
        .collect();
    let (along, least) = cheapest(task, &free);
    let bound = least.unwrap_or_else(|| apart(task, &free));
    Node { shut, along, bound }
}

/// What conveyors cost at least if nothing were in anything's way, EUR.
fn apart(task: &Task, free: &Free) -> f64 {
    let least = |(g, group): (usize, &super::task::Group)| {
        let all = group.rooms.iter().enumerate().flat_map(|(r, room)| {
            let nearest = task.nearest(group, room).unwrap_or(0.0);
            free[g][r].iter().map(move |(low, high)| task.price(group, room, nearest.clamp(*low, *high)))
        });
        let least = all.fold(f64::INFINITY, f64::min);
        if least.is_finite() { group.count as f64 * least } else { 0.0 }
    };
    task.groups.iter().enumerate().map(least).sum()
}

/// The first two that meet.
fn meeting(task: &Task, puts: &[Put]) -> Option<(Put, Put)> {
    let at = |put: &Put| {
        let group = &task.groups[put.group];
        task.footprint(group, &group.rooms[put.room], put.begin)
    };
    let footprints: Vec<_> = puts.iter().map(at).collect();
    (0..puts.len()).find_map(|j| (0..j).find(|&i| footprints[i].meets(&footprints[j])).map(|i| (puts[i], puts[j])))
}

/// Two blocks of which one holds in every layout: about the begins of two that meet.
fn boxed(task: &Task, a: Put, b: Put) -> [(usize, usize, Block); 2] {
    let meet = |p: f64, q: f64| {
        let (ga, gb) = (&task.groups[a.group], &task.groups[b.group]);
        let (fa, fb) = (task.footprint(ga, &ga.rooms[a.room], p), task.footprint(gb, &gb.rooms[b.room], q));
        // Each of the two ways to meet, of each pair of sides, is convex by itself.
        let mut ways = Vec::new();
        for (x, y) in [(&fa.covers, &fb.room), (&fa.room, &fb.covers)] {
            for x in x {
                ways.extend(y.iter().map(|y| super::footprint::overlap(x, y)));
            }
        }
        ways
    };
    let way = meet(a.begin, b.begin).iter().position(|met| *met).unwrap_or(0);
    let meets = |p: f64, q: f64| meet(p, q).get(way).copied().unwrap_or(false);
    // How far each may move alone.
    let far = |f: &dyn Fn(f64) -> bool| {
        let (mut good, mut bad) = (0.0f64, 64.0f64);
        while bad - good > 1e-7 {
            let middle = 0.5 * (good + bad);
            if f(middle) { good = middle } else { bad = middle }
        }
        good
    };
    let (p, q) = (a.begin, b.begin);
    // What stands as early as it can gains nothing from a box that reaches back.
    let early = |put: Put| task.nearest(&task.groups[put.group], &task.groups[put.group].rooms[put.room]).is_none();
    let reach = |put: Put| task.groups[put.group].rooms[put.room].reach;
    let back = |put: Put, far: f64| if early(put) { 0.0 } else { far.min((put.begin - reach(put).0).max(0.0)) };
    let on = |put: Put, far: f64| far.min((reach(put).1 - put.begin).max(0.0));
    let (back_p, on_p) = (back(a, far(&|d| meets(p - d, q))), on(a, far(&|d| meets(p + d, q))));
    let (back_q, on_q) = (back(b, far(&|d| meets(p, q - d))), on(b, far(&|d| meets(p, q + d))));
    // The largest of the boxes about (p, q) of this shape in which they always meet: all that are smaller are in it.
    let corners = |scale: f64| ((p - scale * back_p, q - scale * back_q), (p + scale * on_p, q + scale * on_q));
    let holds = |scale: f64| {
        let ((p0, q0), (p1, q1)) = corners(scale);
        meets(p0, q0) && meets(p0, q1) && meets(p1, q0) && meets(p1, q1)
    };
    let mut scale = if holds(1.0) { 1.0 } else { 0.0 };
    let mut step = if scale < 1.0 { 0.5 } else { 0.0 };
    while step > 1e-8 {
        if holds(scale + step) {
            scale += step;
        }
        step *= 0.5;
    }
    let (low, high) = corners(scale);
    // Blocks are open: the begins themselves have to lie within.
    let block = |low: f64, high: f64| Block { low: low - 1e-6, high: high + 1e-6, cause: Cause::Building };
    [(a.group, a.room, block(low.0, high.0)), (b.group, b.room, block(low.1, high.1))]
}

/// Without what meets something that was placed before it.
fn sorted_out(task: &Task, mut along: Along) -> Along {
    while let Some((_, b)) = meeting(task, &along.puts) {
        along.puts.retain(|put| *put != b);
        along.missing[b.group] += 1;
    }
    along.cost = along.puts.iter().map(|put| put.price(task)).sum();
    along
}
