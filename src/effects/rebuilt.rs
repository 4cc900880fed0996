//! A centre line of which a curve was built otherwise: straights near it become longer or shorter, so that it closes.

use crate::base::trig;
use crate::chain_input::{CentreLinePiece, Track};
use nalgebra::{Matrix2, Vector2};
use std::ops::Range;

/// How short a straight may become, m.
const SHORTEST: f64 = 0.02;

/// Sine of the angle between straights that can take up what is open between them.
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
pub fn turn_more(pieces: &mut [CentreLinePiece], degrees: f64) {
    let turn = |piece: &CentreLinePiece| piece.form().turn();
    let whole: f64 = pieces.iter().map(|p| turn(p).abs()).sum();
    for piece in pieces {
        let share = turn(piece).abs() / whole.max(1e-9);
        if let CentreLinePiece::Arc { turn_deg, .. } | CentreLinePiece::Spiral { turn_deg, .. } = piece {
            *turn_deg += degrees * share;
        }
    }
}

/// Closes a track whose curves there were changed: the level straights beside them become longer or shorter, by the
/// least squares of what they do, and further ones where those cannot. Where none can it stays open, which no chain
/// accepts.
pub fn close(track: &mut Track, changed: &[Range<usize>]) {
    let headings = headings(track);
    let n = track.elements.len();
    let away = |k: usize| {
        let from = |curve: &Range<usize>| ((k + n - curve.end % n) % n).min((curve.start + n - 1 - k) % n);
        changed.iter().map(from).min().unwrap_or(0)
    };
    let level = |k: &usize| matches!(track.elements[*k], CentreLinePiece::Straight { slope: 0.0, .. });
    let mut straights: Vec<usize> = (0..n).filter(level).collect();
    straights.sort_by_key(|k| (away(*k), *k));
    let end = open(track, &headings);
    let first = straights.iter().filter(|k| away(**k) == 0).count().max(2);
    for many in first..=straights.len() {
        let along: Vec<Vector2<f64>> = straights[..many].iter().map(|k| direction(headings[*k])).collect();
        let square: Matrix2<f64> = along.iter().map(|u| u * u.transpose()).sum();
        let Some(inverse) = square.try_inverse().filter(|_| square.determinant() > APART * APART) else { continue };
        let pull = inverse * -end;
        let more: Vec<f64> = along.iter().map(|u| u.dot(&pull)).collect();
        if straights.iter().zip(&more).all(|(k, more)| track.elements[*k].form().length() + more >= SHORTEST) {
            for (k, more) in straights.iter().zip(more) {
                if let CentreLinePiece::Straight { length, .. } = &mut track.elements[*k] {
                    *length += more;
                }
            }
            return;
        }
    }
}

fn direction(heading: f64) -> Vector2<f64> {
    Vector2::new(trig::cos(heading), trig::sin(heading))
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

/// From the track's begin to its end, in its plan, m.
fn open(track: &Track, headings: &[f64]) -> Vector2<f64> {
    let chord = |(piece, heading): (&CentreLinePiece, &f64)| {
        let form = piece.form();
        let half = 0.5 * form.turn();
        direction(heading + half) * if half == 0.0 { form.run() } else { form.run() * trig::sin(half) / half }
    };
    track.elements.iter().zip(headings).map(chord).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 20 m by 12 m with corners of 4 m, beginning in the middle of a long side.
    fn rectangle() -> Track {
        let straight = |length: f64| CentreLinePiece::Straight { length, slope: 0.0 };
        let corner = CentreLinePiece::Arc { radius: 4.0, turn_deg: 90.0 };
        let elements = [6.0, 4.0, 12.0, 4.0].map(straight).into_iter().flat_map(|s| [s, corner.clone()]);
        let elements: Vec<CentreLinePiece> = elements.chain([straight(6.0)]).collect();
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
        track.elements[1] = CentreLinePiece::Arc { radius: 4.3, turn_deg: 90.0 };
        close(&mut track, &[corner]);
        assert!((length(&track, 0) - 5.7).abs() < 1e-12 && (length(&track, 2) - 3.7).abs() < 1e-12);
        assert!(track.centre_line().closure.0 < 1e-12);
    }

    #[test]
    fn another_heading_is_taken_back_by_the_next_curve() {
        let mut track = rectangle();
        turn_more(&mut track.elements[1..2], 1.0);
        turn_more(&mut track.elements[3..4], -1.0);
        close(&mut track, &[1..2, 3..4]);
        let (gap, angle) = track.centre_line().closure;
        assert!(gap < 1e-12 && angle < 1e-12, "{gap} {angle}");
        // The short side turns about its middle, 6 m from the vertices, which move along the long ones by the law of
        // sines; tangents do the rest.
        let longer = [0, 2, 4].map(|k| length(&track, k) - length(&rectangle(), k));
        let degrees = |x: f64| x.to_radians();
        let moved = |turn: f64| 6.0 * trig::sin(degrees(1.0)) / trig::sin(degrees(turn));
        let tangent = |turn: f64| 4.0 * trig::tan(degrees(0.5 * turn)) - 4.0;
        let expected = [moved(91.0) - tangent(91.0), -moved(89.0) - tangent(89.0)];
        assert!(
            (longer[0] - expected[0]).abs() < 1e-3 && (longer[2] - expected[1]).abs() < 1e-3,
            "{longer:?} {expected:?}"
        );
        assert!((5..9).all(|k| track.elements[k] == rectangle().elements[k]));
    }

    #[test]
    fn where_no_straight_can_give_it_stays_open() {
        let mut track = rectangle();
        for piece in &mut track.elements {
            if let CentreLinePiece::Straight { slope, .. } = piece {
                *slope = 0.01;
            }
        }
        track.elements[1] = CentreLinePiece::Arc { radius: 5.0, turn_deg: 90.0 };
        let corner = 1..2;
        close(&mut track, &[corner]);
        assert!(track.centre_line().closure.0 > 0.9);
    }
}
