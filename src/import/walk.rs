//! Loose lines and arcs in any order and direction, joined into loops.

use super::Options;
use super::shapes::Drawn;
use crate::base::number::{significant, trimmed};
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Curve, Point};

/// Pieces of one layer: the walk looks at every pair of ends.
const MOST: usize = 10_000;
/// Places that one message shows.
const SHOWN: usize = 12;
/// What a bend of one radian counts against a distance of one tolerance when several pieces begin where one ends.
const BEND: f64 = 4.0;

/// A closed chain in driving order; each piece ends where the next one begins, but for gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    pub pieces: Vec<Drawn>,
    /// Pieces that were drawn twice or that are too short to matter.
    pub dropped: usize,
}

/// The same curve driven the other way.
pub fn reversed(curve: &Curve) -> Curve {
    match *curve {
        Curve::Segment { begin, end } => Curve::Segment { begin: end, end: begin },
        Curve::Arc { begin, end, centre, radius, start, sweep } => {
            Curve::Arc { begin: end, end: begin, centre, radius, start: start + sweep, sweep: -sweep }
        }
    }
}

/// Headings where a curve begins and where it ends, rad.
pub fn headings(curve: &Curve) -> (f64, f64) {
    match *curve {
        Curve::Segment { begin, end } => {
            let heading = (end - begin).heading();
            (heading, heading)
        }
        Curve::Arc { start, sweep, .. } => {
            let quarter = sweep.signum() * trig::FRAC_PI_2;
            (trig::wrap(start + quarter), trig::wrap(start + sweep + quarter))
        }
    }
}

/// A chain as it was walked.
struct Walk {
    /// Pieces and whether they are driven as drawn.
    steps: Vec<(usize, bool)>,
    /// Jumps wider than the tolerance: pieces (the last one back to the first) and width, m.
    jumps: Vec<(usize, usize, f64)>,
    closed: bool,
}

/// Follows the pieces from `first` on, each to the piece that goes on best. With `jump`, wider gaps are jumped.
fn follow(pieces: &[Drawn], used: &mut [bool], first: usize, tolerance: f64, jump: bool) -> Walk {
    let mut chain = Walk { steps: vec![(first, true)], jumps: Vec::new(), closed: false };
    used[first] = true;
    let origin = pieces[first].curve.begin();
    let out = headings(&pieces[first].curve).0;
    let (mut end, mut heading) = (pieces[first].curve.end(), headings(&pieces[first].curve).1);
    let mut last = first;
    loop {
        let cost = |at: Point, to: f64| end.distance(at) / tolerance + BEND * trig::wrap(to - heading).abs();
        let mut best: Option<(f64, usize, bool)> = None;
        let mut nearest: Option<(f64, usize, bool)> = None;
        for (i, piece) in pieces.iter().enumerate().filter(|(i, _)| !used[*i]) {
            for (at, forward) in [(piece.curve.begin(), true), (piece.curve.end(), false)] {
                let distance = end.distance(at);
                if nearest.is_none_or(|n| distance < n.0) {
                    nearest = Some((distance, i, forward));
                }
                if distance <= tolerance {
                    let (begin, finish) = headings(&piece.curve);
                    let cost = cost(at, if forward { begin } else { finish + trig::PI });
                    if best.is_none_or(|b| cost < b.0) {
                        best = Some((cost, i, forward));
                    }
                }
            }
        }
        let home = end.distance(origin);
        let closes = home <= tolerance && best.is_none_or(|b| cost(origin, out) <= b.0);
        let next = match (best, nearest) {
            _ if closes => None,
            (Some((_, i, forward)), _) => Some((i, forward)),
            (None, Some((distance, i, forward))) if jump && distance < home => {
                chain.jumps.push((last, i, distance));
                Some((i, forward))
            }
            _ => None,
        };
        let Some((i, forward)) = next else {
            chain.closed = closes;
            if !closes {
                chain.jumps.push((last, first, home));
            }
            return chain;
        };
        used[i] = true;
        chain.steps.push((i, forward));
        let (from, to) = headings(&pieces[i].curve);
        (end, heading) = match forward {
            true => (pieces[i].curve.end(), to),
            false => (pieces[i].curve.begin(), from + trig::PI),
        };
        last = i;
    }
}

fn oriented(pieces: &[Drawn], steps: &[(usize, bool)]) -> Vec<Drawn> {
    let turn = |&(i, forward): &(usize, bool)| {
        let piece = pieces[i];
        if forward { piece } else { Drawn { curve: reversed(&piece.curve), ..piece } }
    };
    steps.iter().map(turn).collect()
}

/// All closed chains of the pieces, and the first piece of each open one. Pieces beyond [`MOST`] count as open.
pub fn loops(pieces: &[Drawn], tolerance: f64) -> (Vec<Vec<Drawn>>, Vec<Drawn>) {
    let (pieces, beyond) = pieces.split_at(pieces.len().min(MOST));
    let mut used = vec![false; pieces.len()];
    let (mut closed, mut open) = (Vec::new(), Vec::new());
    for first in 0..pieces.len() {
        if !used[first] {
            let chain = follow(pieces, &mut used, first, tolerance, false);
            match chain.closed {
                true => closed.push(oriented(pieces, &chain.steps)),
                false => open.push(pieces[first]),
            }
        }
    }
    open.extend(beyond);
    (closed, open)
}

/// The one loop that the centre line's pieces make, in driving order from the first piece of the drawing.
pub fn centre_line(pieces: Vec<Drawn>, options: &Options, said: &mut Vec<Diagnostic>) -> Option<Ring> {
    let tolerance = options.tolerance;
    if let Some(beyond) = pieces.get(MOST) {
        said.push(
            Diagnostic::new(Code::E0309, "the centre line has too many pieces", beyond.span, "no further")
                .expected(format!("at most {MOST} lines and arcs"), format!("{}", pieces.len())),
        );
        return None;
    }
    let before = pieces.len();
    let pieces = once(pieces, tolerance);
    let mut used = vec![false; pieces.len()];
    let chain = follow(&pieces, &mut used, 0, tolerance, true);
    let mut dropped = before - pieces.len();
    let mut strays = Vec::new();
    for (piece, _) in pieces.iter().zip(&used).filter(|(_, used)| !**used) {
        if piece.curve.length() <= tolerance { dropped += 1 } else { strays.push(piece) }
    }
    if !chain.jumps.is_empty() {
        said.push(open(&pieces, &chain.jumps, tolerance));
    }
    if let Some(first) = strays.first() {
        let message = match strays.len() {
            1 => "a piece of the centre line is no part of the loop".to_string(),
            count => format!("{count} pieces of the centre line are no part of the loop"),
        };
        let mut diagnostic = Diagnostic::new(Code::E0804, message, first.span, place(first.curve.begin()))
            .related(pieces[0].span, "the loop begins here")
            .expected("one loop", "pieces beside it")
            .help("put other lines on another layer, and each loop on a layer of its own");
        for stray in strays.iter().skip(1).take(SHOWN) {
            diagnostic = diagnostic.related(stray.span, place(stray.curve.begin()));
        }
        said.push(diagnostic);
    }
    if !chain.jumps.is_empty() || !strays.is_empty() {
        return None;
    }
    let mut ring = oriented(&pieces, &chain.steps);
    if backwards(&pieces, &chain.steps) != options.reverse {
        ring.iter_mut().for_each(|piece| piece.curve = reversed(&piece.curve));
        ring.reverse();
        // The loop still begins with the drawing's first piece.
        ring.rotate_right(1);
    }
    Some(Ring { pieces: ring, dropped })
}

/// Leaves out what is drawn twice.
fn once(pieces: Vec<Drawn>, tolerance: f64) -> Vec<Drawn> {
    let middle = |c: &Curve| c.at(c.length() / 2.0);
    let mut kept: Vec<Drawn> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let c = &piece.curve;
        let near = tolerance.min(c.length() / 4.0);
        let same = |other: &Drawn| {
            let o = &other.curve;
            let forth = o.begin().distance(c.begin()).max(o.end().distance(c.end()));
            let back = o.begin().distance(c.end()).max(o.end().distance(c.begin()));
            forth.min(back) <= near && middle(o).distance(middle(c)) <= near
        };
        if !kept.iter().any(same) {
            kept.push(piece);
        }
    }
    kept
}

/// Whether the walk runs against the drawing: against the order of its pieces, and against the direction of its lines.
/// Both count as far as they are consistent, the order a little more.
fn backwards(pieces: &[Drawn], steps: &[(usize, bool)]) -> bool {
    let n = steps.len();
    let mut place = vec![0; pieces.len()];
    steps.iter().enumerate().for_each(|(k, &(i, _))| place[i] = k);
    let mut order = 0.0;
    if n > 2 {
        for (k, &(i, _)) in steps.iter().enumerate() {
            if i + 1 < pieces.len() {
                let ahead = (place[i + 1] + n - k) % n;
                order += if ahead == 1 {
                    1.0
                } else if ahead == n - 1 {
                    -1.0
                } else {
                    0.0
                };
            }
        }
        order /= (n - 1) as f64;
    }
    let (mut net, mut all) = (0.0, 0.0);
    for &(i, forward) in steps.iter().filter(|(i, _)| pieces[*i].directed) {
        let length = pieces[i].curve.length();
        net += if forward { length } else { -length };
        all += length;
    }
    1.01 * order + if all > 0.0 { net / all } else { 0.0 } < 0.0
}

fn open(pieces: &[Drawn], jumps: &[(usize, usize, f64)], tolerance: f64) -> Diagnostic {
    let widest = jumps.iter().fold(0.0, |widest: f64, jump| widest.max(jump.2));
    let message = match jumps.len() {
        1 => format!("the centre line has a gap of {}", metres(widest)),
        count => format!("the centre line has {count} gaps, the widest of {}", metres(widest)),
    };
    let (from, to, _) = jumps[0];
    let mut diagnostic = Diagnostic::new(Code::E0804, message, pieces[from].span, "no piece goes on from here")
        .related(pieces[to].span, format!("the next one, {} away", metres(jumps[0].2)));
    for (from, _, width) in jumps.iter().skip(1).take(SHOWN) {
        diagnostic = diagnostic.related(pieces[*from].span, format!("a gap of {} after this", metres(*width)));
    }
    let rounded = (widest * 1e3).ceil();
    let help = match widest < 0.5 {
        true => format!("close it in the drawing, or allow it: `--tolerance {rounded}mm`"),
        false => "draw what is missing, and put what does not belong to the loop on another layer".to_string(),
    };
    diagnostic.expected("a closed loop", format!("ends that are more than {} apart", metres(tolerance))).help(help)
}

/// `1 gap`, `3 gaps`.
pub fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

pub fn metres(length: f64) -> String {
    if length < 0.1 { format!("{} mm", significant(length * 1e3, 3)) } else { format!("{} m", trimmed(length, 3)) }
}

pub fn place(p: Point) -> String {
    format!("at ({} m, {} m)", trimmed(p.x, 3), trimmed(p.y, 3))
}
