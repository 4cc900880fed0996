//! Whether a whole number of carts fits a closed centre line.

use super::closing;
use crate::geometry::{CentreLine, Form, PieceKind, Track};

/// The whole number of carts that fits best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    pub carts: usize,
    /// What the chain lacks to close, N (p − ℓ) with p the pitch at which N carts close and ℓ their length, m; negative when the
    /// chain has to be compressed. The mean over phases of the chain.
    pub left_over: f64,
}

/// Phases that the pitch is averaged over.
const PHASES: usize = 8;

/// Fits carts of this length, m. `None` where no chain closes.
pub fn fit(line: &CentreLine, length: f64) -> Option<Fit> {
    if length.is_nan() || length <= 0.0 {
        return None;
    }
    // Chords cut corners: the whole number is that of the centre line, or one or two below it.
    let most = (line.length / length).round() as usize;
    let of = |carts: usize| {
        let first = closing(line, carts, 0.0).ok()?.pitch;
        let phase = |k: usize| Some(closing(line, carts, first * k as f64 / PHASES as f64).ok()?.pitch);
        let pitches: Option<Vec<f64>> = (0..PHASES).map(phase).collect();
        let pitch = pitches?.iter().sum::<f64>() / PHASES as f64;
        Some(Fit { carts, left_over: carts as f64 * (pitch - length) })
    };
    let near = (most.saturating_sub(2)..=most).filter_map(of);
    near.min_by(|a, b| a.left_over.abs().total_cmp(&b.left_over.abs()))
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
    use crate::geometry::{Corner, Point, trig};

    /// A stadium of straights s and half circles R (two quarter turns each) is closed by N carts when 2 s + 2πR less what their
    /// chords cut off is N ℓ (design, chain model: θL²/(24R) − L³/(120R²) a bend, whose next term is 1 % of that).
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
}
