//! Which part of each cart's plate lies over linear motors (design: chain model, linear motors).

use super::lanes::Lane;
use super::state::{PACK, PackRow};
use pulp::{Simd, WithSimd};

/// Length of motors from arc length 0 on, in motor lengths: a line on each piece of the lap.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    pieces: Vec<Piece>,
    /// Of the whole lap.
    pub total: f64,
    /// m
    lap: f64,
}

/// From one begin or end of a motor to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Piece {
    /// m
    from: f64,
    to: f64,
    /// Motor lengths up to `from`, and a metre.
    base: f64,
    slope: f64,
}

/// The piece of each cart's front joint, by pack.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OverMotors {
    from: PackRow,
    to: PackRow,
    base: PackRow,
    slope: PackRow,
}

/// A share of a plate over a motor below which it is rounding.
pub const LEAST_SHARE: f64 = 1e-9;

impl Coverage {
    /// Of motors that begin at some arc lengths, of one length, on a lap, m.
    pub fn new(begins: &[f64], length: f64, lap: f64) -> Self {
        // Where the number of motors that cover a point changes, and by how many.
        let mut changes: Vec<(f64, f64)> = vec![(0.0, 0.0), (lap, 0.0)];
        for begin in begins {
            // A motor longer than the lap covers it several times.
            let turns = (length / lap).floor();
            let end = begin + length - turns * lap;
            changes.extend([(0.0, turns), (*begin, 1.0)]);
            if end > lap {
                changes.extend([(0.0, 1.0), (end - lap, -1.0)]);
            } else {
                changes.push((end, -1.0));
            }
        }
        changes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut pieces, mut base, mut count) = (Vec::new(), 0.0, 0.0);
        for pair in changes.windows(2) {
            let ((from, change), (to, _)) = (pair[0], pair[1]);
            count += change;
            let slope = count / length;
            if to > from {
                pieces.push(Piece { from, to, base, slope });
                base += slope * (to - from);
            }
        }
        Coverage { pieces, total: base, lap }
    }

    fn piece(&self, station: f64) -> Piece {
        let s = if station.is_finite() { station.clamp(0.0, self.lap) } else { 0.0 };
        let k = self.pieces.partition_point(|piece| piece.to < s);
        self.pieces.get(k).copied().unwrap_or_default()
    }
}

/// Motor lengths up to several stations.
#[inline(always)]
pub fn covered<S: Simd>(simd: S, coverage: &Coverage, over: &mut OverMotors, part: usize, station: Lane<S>) -> Lane<S> {
    let mut from = Lane::of(simd, &over.from, part);
    let (mut base, mut slope) = (Lane::of(simd, &over.base, part), Lane::of(simd, &over.slope, part));
    if station.less(from).or(Lane::of(simd, &over.to, part).less(station)).any() {
        simd.vectorize(NextPieces { coverage, over, part, station });
        from = Lane::of(simd, &over.from, part);
        (base, slope) = (Lane::of(simd, &over.base, part), Lane::of(simd, &over.slope, part));
    }
    slope.mul_add(station - from, base)
}

/// Finds the pieces of stations that have left theirs.
struct NextPieces<'a, S: Simd> {
    coverage: &'a Coverage,
    over: &'a mut OverMotors,
    part: usize,
    station: Lane<S>,
}

impl<S: Simd> WithSimd for NextPieces<'_, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) {
        let mut station = [0.0; PACK];
        self.station.store(&mut station);
        for (lane, station) in station.into_iter().enumerate().take(S::F64_LANES) {
            let place = self.part * S::F64_LANES + lane;
            let piece = self.coverage.piece(station);
            self.over.from[place] = piece.from;
            self.over.to[place] = piece.to;
            self.over.base[place] = piece.base;
            self.over.slope[place] = piece.slope;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motors_that_overlap_or_cross_the_begin_of_the_lap_are_counted() {
        let coverage = Coverage::new(&[2.0, 2.5, 9.5], 1.0, 10.0);
        let at = |s: f64| {
            let piece = coverage.piece(s);
            piece.base + piece.slope * (s - piece.from)
        };
        assert!((coverage.total - 3.0).abs() < 1e-12);
        for (s, expected) in [(0.0, 0.0), (0.25, 0.25), (1.0, 0.5), (2.5, 1.0), (3.0, 2.0), (9.5, 2.5), (10.0, 3.0)] {
            assert!((at(s) - expected).abs() < 1e-12, "{s}: {}", at(s));
        }
    }
}
