//! Loops that fixed sections split into independent chains, each of which is searched alone.
//!
//! Between two sections whose vertices are both fixed the track is a chain of its own: its turns, radii and straights
//! meet the others' only in the length that remains of the fixed sections, and where strands come close. Both are
//! relaxed while a chain is searched, and checked of the whole; if they do not hold, the whole is searched.

use super::found::{Chain, Found};
use super::grid::Grid;
use super::row::{GridRow, Stated};
use super::search::{FEASIBLE, Setting, search as whole};
use crate::solve::exact::grid::track;
use crate::solve::exact::open::place;

/// Searches chain by chain where that is possible.
pub fn search(mut setting: Setting, stated: &Stated, incumbent: (Vec<f64>, f64), longest: f64) -> Found {
    let grid = setting.grid;
    let pins = pins(grid, stated);
    let Some(held) = place(grid, &incumbent.0).filter(|_| split(grid, stated)) else {
        return whole(&setting, Some(incumbent));
    };
    let n = grid.len();
    let (full, limits, tariff) =
        (setting.open.clone(), setting.limits.straights.clone(), setting.limits.tariff.clone());
    for &k in &pins {
        setting.limits.straights[k] = (-longest, longest);
        setting.limits.tariff.release(k, longest);
    }
    let released = setting.limits.tariff.clone();
    setting.coupled = Some(pins.iter().map(|&k| grid.vertex(k)).collect());
    let (effort, enclosing) = (setting.effort, setting.beside.enclosing.take());
    let value = setting.value;
    let mut best = (incumbent.0.clone(), value(&released, &incumbent.0));
    let (mut parts, mut nodes): (Vec<Chain>, usize) = (Vec::new(), 0);
    let mut held = held;
    for (i, &pin) in pins.iter().enumerate() {
        // Vertices pin + 1 ..= end turn, the sections between them are free.
        let end = pins.get(i + 1).copied().unwrap_or(pins[0] + n);
        let mut open = held.clone();
        let at = track(&best.0);
        setting.limits.tariff = released.clone();
        for k in (0..n).filter(|k| !pins.contains(k)) {
            let length = at.straight(grid.vertex(k)).length;
            setting.limits.straights[k] = (length, length);
            if !(pin + 1..end).any(|own| own % n == k) {
                setting.limits.tariff.hold(k, length);
            }
        }
        for k in pin + 1..=end {
            open.radii[k % n] = full.radii[k % n];
            if k < end {
                setting.limits.straights[k % n] = limits[k % n];
                if k % n != 0 {
                    open.headings[k % n] = full.headings[k % n].clone();
                }
            }
        }
        setting.limits.tariff.open(&mut open);
        setting.open = open;
        setting.effort.nodes = share(effort.nodes.saturating_sub(nodes), pins.len() - i);
        let found = whole(&setting, Some(best.clone()));
        nodes += found.nodes;
        parts.push(Chain { from: pin + 1, to: end, gap: (found.value - found.bound).max(0.0), nodes: found.nodes });
        if let Some(x) = found.variables {
            best = (x, found.value);
        }
        match place(grid, &best.0) {
            Some(place) => held = place,
            None => break,
        }
    }
    let bound = best.1 - parts.iter().map(|part| part.gap).sum::<f64>() - 1e-9;
    let at = setting.problem.evaluate(&best.0, 0.0);
    let sound = at.rows.iter().all(|r| r.violation() <= FEASIBLE) && setting.problem.crossings(&at.track).is_empty();
    if sound {
        return Found { variables: Some(best.0), value: best.1, bound, nodes, parts };
    }
    (setting.open, setting.limits.straights, setting.coupled, setting.effort) = (full, limits, None, effort);
    setting.beside.enclosing = enclosing;
    setting.limits.tariff = tariff;
    setting.effort.nodes = effort.nodes.saturating_sub(nodes);
    let mut found = whole(&setting, Some(incumbent));
    found.bound = found.bound.max(bound);
    found.nodes += nodes;
    found
}

/// Nodes of a chain, of those that are left for it and the others behind it: half of what would be theirs is kept for
/// them.
fn share(left: usize, chains: usize) -> usize {
    left - left / 2 * (chains - 1) / chains
}

/// Whether there is more than one chain.
pub fn split(grid: &Grid, stated: &Stated) -> bool {
    let pins = pins(grid, stated);
    pins.len() > 1 && !stated.partial && stated.rows[stated.closing..].iter().all(|r| one_chain(r, &pins))
}

/// Sections, by stage, whose heading and both vertices are known.
fn pins(grid: &Grid, stated: &Stated) -> Vec<usize> {
    let n = grid.len();
    let known = |k: usize| stated.fixed.iter().any(|f| f.0 == k);
    (0..n).filter(|&k| grid.headings[k].len() == 1 && known(k) && known((k + 1) % n)).collect()
}

/// Whether a row speaks of one chain only.
fn one_chain(row: &GridRow, pins: &[usize]) -> bool {
    // The chain that begins behind the last pin before a section (or a vertex).
    let section = |k: usize| pins.iter().rposition(|&p| p < k).unwrap_or(pins.len() - 1);
    let mut chains: Vec<usize> = Vec::new();
    let pinned = |k: &usize| pins.contains(k);
    let sections: Vec<usize> = row.straight.iter().chain(&row.length).map(|e| e.0).collect();
    if sections.iter().any(pinned) {
        return false;
    }
    chains.extend(sections.iter().map(|&k| section(k)));
    let vertices =
        row.radius.iter().map(|e| e.0).chain(row.into.iter().chain(&row.out).chain(&row.normal).map(|e| e.0));
    chains.extend(vertices.map(section));
    chains.extend(row.touch.iter().map(|t| section(t.from)));
    chains.extend(row.at.iter().filter(|e| !pins.contains(&e.0)).map(|e| section(e.0)));
    chains.dedup();
    chains.windows(2).all(|w| w[0] == w[1])
}
