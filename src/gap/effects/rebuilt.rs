//! A centre line of which a curve was built otherwise: straights near it become longer or shorter, so that it closes.

use crate::emit::simulation::{Piece, Track};
use crate::geometry::trig;
use std::ops::Range;

/// How short a straight may become, m.
const SHORTEST: f64 = 0.02;

/// Sine of the angle between two straights that can take up what is open between them.
const APART: f64 = 0.1;

/// The pieces between two arc lengths.
pub fn between(track: &Track, from: f64, to: f64) -> Range<usize> {
    let mut s = 0.0;
    let middles = track.elements.iter().map(|piece| {
        let middle = s + 0.5 * piece.form().length();
        s += piece.form().length();
        middle
    });
    let inside: Vec<usize> = middles.enumerate().filter(|(_, s)| (from..to).contains(s)).map(|(k, _)| k).collect();
    inside.first().map_or(0..0, |first| *first..first + inside.len())
}

/// Lets a curve turn more to the left, each of its pieces in proportion.
pub fn turn_more(pieces: &mut [Piece], degrees: f64) {
    let turn = |piece: &Piece| piece.form().turn();
    let whole: f64 = pieces.iter().map(|p| turn(p).abs()).sum();
    for piece in pieces {
        let share = turn(piece).abs() / whole.max(1e-9);
        if let Piece::Arc { turn_deg, .. } | Piece::Spiral { turn_deg, .. } = piece {
            *turn_deg += degrees * share;
        }
    }
}

/// Closes a track whose pieces there were changed with the two level straights that are nearest to them and can. Where there are none it
/// stays open, which no chain accepts.
pub fn close(track: &mut Track, changed: Range<usize>) {
    let headings = headings(track);
    let n = track.elements.len();
    let away = |k: usize| {
        let ahead = (k + n - changed.end % n) % n;
        let behind = (changed.start + n - 1 - k) % n;
        ahead.min(behind)
    };
    let level = |k: &usize| matches!(track.elements[*k], Piece::Straight { slope: 0.0, .. });
    let mut straights: Vec<usize> = (0..n).filter(level).collect();
    straights.sort_by_key(|k| (away(*k), *k));
    let (x, y) = open(track, &headings);
    for (rank, a) in straights.iter().enumerate() {
        for b in &straights[..rank] {
            let direction = |k: usize| (trig::cos(headings[k]), trig::sin(headings[k]));
            let ((ax, ay), (bx, by)) = (direction(*a), direction(*b));
            let sine = ax * by - ay * bx;
            // So much more of each brings the end back to where it was: p a + q b = −(x, y).
            let (p, q) = ((y * bx - x * by) / sine, (x * ay - y * ax) / sine);
            let long = |k: usize, more: f64| track.elements[k].form().length() + more >= SHORTEST;
            if sine.abs() > APART && long(*a, p) && long(*b, q) {
                for (k, more) in [(*a, p), (*b, q)] {
                    if let Piece::Straight { length, .. } = &mut track.elements[k] {
                        *length += more;
                    }
                }
                return;
            }
        }
    }
}

/// Where each piece begins to head, rad.
fn headings(track: &Track) -> Vec<f64> {
    let mut heading = track.start[3];
    let begins = track.elements.iter().map(|piece| {
        let begin = heading;
        heading += piece.form().turn();
        begin
    });
    begins.collect()
}

/// From the track's begin to its end, in its plan.
fn open(track: &Track, headings: &[f64]) -> (f64, f64) {
    let mut way = (0.0, 0.0);
    for (piece, heading) in track.elements.iter().zip(headings) {
        let form = piece.form();
        let half = 0.5 * form.turn();
        let chord = if half == 0.0 { form.run() } else { form.run() * trig::sin(half) / half };
        way.0 += chord * trig::cos(heading + half);
        way.1 += chord * trig::sin(heading + half);
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 20 m by 12 m with corners of 4 m, beginning in the middle of a long side.
    fn rectangle() -> Track {
        let straight = |length: f64| Piece::Straight { length, slope: 0.0 };
        let corner = Piece::Arc { radius: 4.0, turn_deg: 90.0 };
        let elements = [6.0, 4.0, 12.0, 4.0].map(straight).into_iter().flat_map(|s| [s, corner.clone()]);
        let elements: Vec<Piece> = elements.chain([straight(6.0)]).collect();
        Track { name: "rectangle".into(), start: [10.0, 0.0, 0.0, 0.0], elements }
    }

    fn length(track: &Track, k: usize) -> f64 {
        track.elements[k].form().length()
    }

    #[test]
    fn another_radius_takes_its_tangents_from_the_straights_beside_it() {
        let mut track = rectangle();
        let corner = between(&track, 6.0, 6.0 + 2.0 * trig::PI);
        assert_eq!(corner, 1..2);
        track.elements[1] = Piece::Arc { radius: 4.3, turn_deg: 90.0 };
        close(&mut track, corner);
        assert!((length(&track, 0) - 5.7).abs() < 1e-12 && (length(&track, 2) - 3.7).abs() < 1e-12);
        assert!(track.centre_line().closure.0 < 1e-12);
    }

    #[test]
    fn another_heading_is_taken_back_by_the_next_curve() {
        let mut track = rectangle();
        turn_more(&mut track.elements[1..2], 1.0);
        turn_more(&mut track.elements[3..4], -1.0);
        close(&mut track, 1..2);
        let (gap, angle) = track.centre_line().closure;
        assert!(gap < 1e-12 && angle < 1e-12, "{gap} {angle}");
        // The short side leans by 1°; what it is out by, the long side behind or before it takes.
        let changed = (0..9).filter(|k| track.elements[*k] != rectangle().elements[*k]);
        assert_eq!(changed.collect::<Vec<_>>(), [0, 1, 2, 3]);
    }

    #[test]
    fn where_no_straight_can_give_it_stays_open() {
        let mut track = rectangle();
        for piece in &mut track.elements {
            if let Piece::Straight { slope, .. } = piece {
                *slope = 0.01;
            }
        }
        track.elements[1] = Piece::Arc { radius: 5.0, turn_deg: 90.0 };
        close(&mut track, 1..2);
        assert!(track.centre_line().closure.0 > 0.9);
    }
}
