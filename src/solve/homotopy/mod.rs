//! No loop that can be moved from a given one without passing over an obstacle is shorter than this.
//!
//! The shortest closed line of such a class of loops is taut: a polygon whose corners are corners of obstacles
//! ([`taut`]; of paths, Hershberger and Snoeyink 1994). A track keeps a distance from them and turns with a radius, so it
//! is longer, and [`turning`] says by how much at least. Turns and radii of the catalogue, and limits of straights, are
//! not in this bound: it holds of any curve that is nowhere tighter than the smallest radius. Sections of known heading take
//! part ([`held`]): the bound is then one of loops that have them.

mod held;
mod taut;
#[cfg(test)]
mod tests;
mod turning;
mod word;

use crate::base::trig;
use crate::geometry::{PieceKind, Point, Track};
use crate::problem::{Keepout, Problem};

pub use held::{End, Held, Place, Range, Turn};

/// How far corners are taken into their regions, m, so that no three lie on a line: what is kept at a distance from
/// the region is so from a point of it, too.
const INWARD: f64 = 1e-6;
/// How far the line may be from the track where an arc is cut into chords, as a share of the least distance.
const CHORD: f64 = 0.1;

/// What the bound takes for granted, in words.
pub const CLASS: &str = "the loop can be moved from the built one without passing over an obstacle";
/// The same where sections take part.
pub const CLASS_WITH_SECTIONS: &str = "the loop can be moved from the built one without passing over an obstacle, and \
                                       without sections of fixed heading leaving where they may be";

/// A point of an obstacle, and how far the centre line stays away from it, m.
#[derive(Clone, Copy, Debug)]
struct Peg {
    at: Point,
    distance: f64,
}

/// A lower bound for the length, m, of all loops of the class of `track`, with curves of at least `radius` (m); a track that
/// climbs is no shorter than its plan. Some sections, in driving order, are known. None where nothing holds a loop up, or
/// rounding leaves the class in doubt.
pub fn shortest(problem: &Problem, track: &Track, radius: f64, sections: &[Held]) -> Option<f64> {
    let pegs: Vec<Peg> = problem.keepouts.iter().flat_map(pegs).collect();
    if sections.iter().any(|held| pegs.iter().any(|peg| held.may_hold(peg.at))) {
        return None;
    }
    let least = pegs.iter().map(|peg| peg.distance).fold(f64::INFINITY, f64::min);
    let (line, begins) = (least > 10.0 * INWARD && least.is_finite()).then(|| line(track, CHORD * least))?;
    bound(&pegs, (&line, &begins), track, (radius, sections)).filter(|bound| bound.is_finite())
}

/// The bound of the class of a line, whose pieces begin at these places.
fn bound(
    pegs: &[Peg],
    (line, begins): (&[Point], &[usize]),
    track: &Track,
    (radius, sections): (f64, &[Held]),
) -> Option<f64> {
    let points: Vec<Point> = pegs.iter().map(|peg| peg.at).collect();
    // A section's straight is followed by an arc.
    let ends = |held: &Held| [begins[2 * held.section], begins[2 * held.section + 1]];
    let kept: Vec<usize> = sections.iter().flat_map(ends).collect();
    let taut = taut::pulled(line, &kept, &points)?;
    let same = word::parts(line, &kept, &points) == word::parts(&taut.beside(), &taut.kept(), &points);
    same.then(|| turning::longest_bound(&taut, pegs, radius, (track, sections)))
}

/// The corners that can hold a line: where less than a half turn of the region lies between its edges.
fn pegs(keepout: &Keepout) -> Vec<Peg> {
    let polygon = &keepout.region.polygon;
    let (points, n) = (polygon.points(), polygon.points().len());
    let holds = |&i: &usize| polygon.is_convex_at(i) != keepout.region.outside;
    (0..n)
        .filter(holds)
        .map(|i| {
            let at = points[i];
            let [to, from] = [points[(i + 1) % n] - at, points[(i + n - 1) % n] - at].map(|d| d * (1.0 / d.norm()));
            let middle = to + from;
            // Multiples of the golden section are all different, and so are shares of this.
            let share = 1.0 + (0.618_033_988_75 * (i as f64 + at.x + 3.0 * at.y)).rem_euclid(1.0);
            Peg { at: at + middle * (INWARD * share / middle.norm()), distance: keepout.distance }
        })
        .collect()
}

/// The track as a closed line of chords that are no farther from it than `far`, m, and where each of its pieces begins.
fn line(track: &Track, far: f64) -> (Vec<Point>, Vec<usize>) {
    let (mut line, mut begins) = (Vec::new(), Vec::new());
    for piece in &track.pieces {
        begins.push(line.len());
        match piece.kind {
            PieceKind::Straight => line.push(piece.at(0.0).0),
            PieceKind::Arc { radius, turn, .. } => {
                let step = 2.0 * trig::acos((1.0 - far / radius).max(0.0)).max(1e-3);
                let parts = (turn.abs() / step).ceil().max(1.0) as usize;
                line.extend((0..parts).map(|i| piece.at(piece.length * i as f64 / parts as f64).0));
            }
        }
    }
    (line, begins)
}
