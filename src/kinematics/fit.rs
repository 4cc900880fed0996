//! Whether a whole number of carts fits a closed centre line.

use super::closing;
use crate::geometry::{CentreLine, Form, PieceKind, Track};

/// The whole number of carts that fits best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    pub carts: usize,
    /// What the chain lacks to close, N (p − ℓ) with p the pitch at which N carts close and ℓ their length, m; negative
    /// when the chain has to be compressed. The mean over phases of the chain.
    pub left_over: f64,
}

/// Phases that the pitch is averaged over.
const PHASES: usize = 8;

impl Fit {
    /// Whether a take-up of this length, m, compensates what is left over. What exceeds it by less than a solver leaves
    /// does not.
    pub fn is_within(&self, take_up: f64) -> bool {
        self.left_over.abs() <= take_up + TOLERANCE
    }
}

/// Left-overs are told apart from this on, m.
const TOLERANCE: f64 = 1e-5;

/// Fits carts of this length, m. `None` where no chain closes.
pub fn fit(line: &CentreLine, length: f64) -> Option<Fit> {
    if length.is_nan() || length <= 0.0 {
        return None;
    }
    let of = |carts: usize| Some(Fit { carts, left_over: left_over(line, carts, length)? });
    // Chords cut corners: where there are many, by several carts.
    let most = (line.length / length).round() as usize;
    let mut best = (most.saturating_sub(2)..=most).rev().find_map(of)?;
    loop {
        // The next one on the side of what is left over at least.
        let whole = (best.left_over / length).round();
        let more = if whole == 0.0 { best.left_over.signum() } else { whole };
        match of(best.carts.saturating_add_signed(more as isize)) {
            Some(next) if next.left_over.abs() < best.left_over.abs() => best = next,
            _ => return Some(best),
        }
    }
}

/// What so many carts of this length, m, lack to close, as [`Fit::left_over`]. `None` where they do not close at all.
pub fn left_over(line: &CentreLine, carts: usize, length: f64) -> Option<f64> {
    let first = closing(line, carts, 0.0).ok()?.pitch;
    let phase = |k: usize| Some(closing(line, carts, first * k as f64 / PHASES as f64).ok()?.pitch);
    let pitches: Option<Vec<f64>> = (0..PHASES).map(phase).collect();
    let pitch = pitches?.iter().sum::<f64>() / PHASES as f64;
    Some(carts as f64 * (pitch - length))
}

/// Of several lengths of cart, m, the one nearest to `length` of which a whole number fits within the take-up, m. Where
/// none does, the one that leaves the least over, if that is less than `length` leaves.
pub fn better_length(line: &CentreLine, length: f64, offered: &[f64], take_up: f64) -> Option<(f64, Fit)> {
    let left = fit(line, length).map_or(f64::INFINITY, |fit| fit.left_over.abs());
    let others = offered.iter().copied().filter(|l| (l - length).abs() > 1e-9);
    let fits: Vec<(f64, Fit)> = others.filter_map(|l| Some((l, fit(line, l)?))).collect();
    let away = |l: f64| (l - length).abs();
    let within = fits.iter().filter(|(_, fit)| fit.is_within(take_up));
    let least = fits.iter().filter(|(_, fit)| fit.left_over.abs() < left - TOLERANCE);
    within
        .min_by(|a, b| away(a.0).total_cmp(&away(b.0)))
        .or_else(|| least.min_by(|a, b| a.1.left_over.abs().total_cmp(&b.1.left_over.abs())))
        .copied()
}

/// The level centre line of a track.
pub fn level(track: &Track) -> CentreLine {
    let forms: Vec<Form> = track
        .pieces
        .iter()
        .map(|p| match p.kind {
            PieceKind::Straight => Form::Straight { length: p.length.max(0.0), slope: 0.0 },
            PieceKind::Arc { radius, turn, .. } => Form::Arc { radius, turn },
        })
        .collect();
    let begin = &track.pieces[0];
    CentreLine::new([begin.begin.x, begin.begin.y, 0.0, begin.heading], &forms)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig;
    use crate::geometry::{Corner, Point};

    /// A stadium of straights s and half circles R (two quarter turns each) is closed by N carts when 2 s + 2πR less
    /// what their chords cut off is N ℓ (design, chain model: θL²/(24R) − L³/(120R²) a bend, whose next term is 1 % of
    /// that).
    #[test]
    fn what_is_left_over_is_length_less_chords_less_carts() {
        let corner = |x, y| Corner { point: Point::new(x, y), radius: 5.0 };
        for extra in [0.0, 0.3, 0.61] {
            let track = Track::new(&[
                corner(0.0, 0.0),
                corner(40.0 + extra, 0.0),
                corner(40.0 + extra, 10.0),
                corner(0.0, 10.0),
            ]);
            let fit = fit(&level(&track), 1.25).unwrap();
            let square = 1.25f64 * 1.25;
            let excess = 2.0 * (trig::PI * square / (24.0 * 5.0) - square * 1.25 / (120.0 * 25.0));
            let expected = track.length - excess - fit.carts as f64 * 1.25;
            assert!((fit.left_over - expected).abs() < 2e-3, "{} {expected}", fit.left_over);
            assert!(fit.left_over.abs() <= 0.63);
        }
    }

    /// A track of very many curves, whose chords cut off several carts, and one that is very long.
    #[test]
    fn no_other_number_of_carts_leaves_less() {
        let corner = |x, y| Corner { point: Point::new(x, y), radius: 3.0 };
        let teeth = (0..40).flat_map(|k| {
            let x = 14.0 * f64::from(k);
            [corner(x, 8.0), corner(x, 20.0), corner(x + 7.0, 20.0), corner(x + 7.0, 8.0)]
        });
        let mut comb: Vec<Corner> = teeth.collect();
        comb.extend([corner(570.0, 8.0), corner(570.0, 0.0), corner(-10.0, 0.0), corner(-10.0, 8.0)]);
        let long = [corner(0.0, 0.0), corner(1990.3, 0.0), corner(1990.3, 10.0), corner(0.0, 10.0)];
        for corners in [&comb[..], &long] {
            let line = level(&Track::new(corners));
            let found = fit(&line, 1.25).unwrap();
            assert!(found.left_over.abs() <= 0.63, "{found:?}");
            for carts in [found.carts - 1, found.carts + 1] {
                assert!(left_over(&line, carts, 1.25).unwrap().abs() >= found.left_over.abs());
            }
        }
    }

    #[test]
    fn another_length_is_the_nearest_that_fits_or_the_one_that_leaves_least() {
        let corner = |x, y| Corner { point: Point::new(x, y), radius: 5.0 };
        let track = Track::new(&[corner(0.0, 0.0), corner(40.3, 0.0), corner(40.3, 10.0), corner(0.0, 10.0)]);
        let line = level(&track);
        let offered: Vec<f64> = (10..=25).map(|k| 0.05 * f64::from(k)).collect();
        let left = |l: f64| fit(&line, l).unwrap().left_over.abs();
        let (length, found) = better_length(&line, 1.25, &offered, 0.1).unwrap();
        assert!(found.is_within(0.1) && (found.left_over.abs() - left(length)).abs() < 1e-12);
        assert!(offered.iter().all(|&l| l <= length || l > 1.2 || left(l) > 0.1), "{length}");
        let (length, found) = better_length(&line, 1.25, &offered, 0.0).unwrap();
        assert!(offered.iter().all(|&l| left(l) >= found.left_over.abs() - 1e-12), "{length}");
        assert!(better_length(&line, 1.25, &[1.25], 0.0).is_none());
    }
}
