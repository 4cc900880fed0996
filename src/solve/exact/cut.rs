//! What chords cut off of curves that lie within a cart of each other.
//!
//! A chain of chords of length c is shorter than its track by ½ ∬ κ(s) κ(t) K(|s − t|) ds dt, the mean over its phases, with
//! K(τ) = (c − τ)³/(6c²) (expansion of c Var(φ)/2 for a chord, φ being the heading along it). What of that two curves have
//! in common depends on the straight between them where it is shorter than c; what each has alone does not.

use crate::base::trig;
use crate::geometry::{Fillet, Track};

/// What the next terms of the expansion change by at most with the length of a straight, against (c/R)² and the slope of the
/// first one's scale, c²/(120 R²). Held by a test.
const BEYOND: f64 = 0.5;

/// How far the mean over phases may be from what curves cut off in the mean each by itself, m: a chain runs unevenly behind
/// one curve, by no more than what is missing at its ends, and so it is not at all phases alike on the next.
pub fn coupling(track: &Track, chord: f64) -> f64 {
    let uneven: f64 = track.fillets.iter().filter_map(curve).map(|own| own.0 * own.0 * power(chord, 3) / 120.0).sum();
    trig::PI / chord * uneven * uneven
}

/// By how much more and less curves may cut off than on a track, m, where its straights may have other lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leeway {
    pub more: f64,
    pub less: f64,
    /// The section whose straight matters most.
    pub section: Option<usize>,
}

/// A curve's curvature, 1/m, positive to the left, and its length, m.
type Curve = (f64, f64);

/// None where a vertex does not turn.
fn curve(fillet: &Fillet) -> Option<Curve> {
    (fillet.turn != 0.0).then(|| (fillet.turn.signum() / fillet.radius, (fillet.turn * fillet.radius).abs()))
}

fn power(value: f64, exponent: usize) -> f64 {
    (0..exponent).map(|_| value).product()
}

/// What is cut off of a curve by itself, m.
fn alone(chord: f64, (k, l): Curve) -> f64 {
    let beyond = chord - l.min(chord);
    let ends = power(chord, 3) / 120.0 - power(beyond, 5) / (120.0 * chord * chord);
    k * k * (l * chord * chord / 24.0 - ends)
}

/// What two curves have in common over a stretch of this length, m.
fn common(chord: f64, (k, l): Curve, (m, n): Curve, apart: f64) -> f64 {
    let part = |z: f64| power((chord - z).max(0.0), 5);
    k * m * (part(apart) - part(apart + l) - part(apart + n) + part(apart + l + n)) / (120.0 * chord * chord)
}

/// What is cut off of a track, m, by the expansion; and how far that may be off, as a share of how it changes.
pub fn cut(track: &Track, chord: f64) -> (f64, f64) {
    let n = track.fillets.len();
    let (mut all, mut steepest) = (0.0, 0.0f64);
    for i in 0..n {
        let Some(own) = curve(&track.fillets[i]) else { continue };
        all += alone(chord, own);
        steepest = steepest.max(chord * own.0.abs());
        let mut apart = 0.0;
        for j in (1..n).map(|k| (i + k) % n) {
            apart += track.straight((j + n - 1) % n).length.max(0.0);
            if apart >= chord {
                break;
            }
            if let Some(other) = curve(&track.fillets[j]) {
                all += common(chord, own, other, apart);
                apart += other.1;
            }
        }
    }
    (all, steepest * steepest)
}

/// With turns and radii of this track and straights between these lengths, m, by section. The expansion holds within the
/// square of the chord's length over the radius, which is added.
pub fn leeway(track: &Track, chord: f64, straights: &[(f64, f64)]) -> Leeway {
    let n = track.fillets.len();
    let (mut found, mut most) = (Leeway::default(), 0.0);
    for i in 0..n {
        let Some(own) = curve(&track.fillets[i]) else { continue };
        let (mut now, mut least, mut largest) = (0.0, 0.0, 0.0);
        let mut between: Vec<usize> = Vec::new();
        for j in (1..n).map(|k| (i + k) % n) {
            let section = (j + n - 1) % n;
            let at = track.straight(section).length.max(0.0);
            now += at;
            least += straights[section].0.max(0.0).min(at);
            largest += straights[section].1.max(at);
            between.push(section);
            if least >= chord {
                break;
            }
            let Some(other) = curve(&track.fillets[j]) else { continue };
            let of = |apart: f64| common(chord, own, other, apart);
            let steep = chord * own.0.abs().max(other.0.abs());
            let sure = 1.0 + steep * steep;
            let scale = chord * chord * (own.0 * other.0).abs() / 120.0;
            let beyond = BEYOND * steep * steep * scale * (largest.min(chord) - least).max(0.0);
            let more = sure * (of(least).max(of(largest)) - of(now)).max(0.0) + beyond;
            let less = sure * (of(now) - of(least).min(of(largest))).max(0.0) + beyond;
            (found.more, found.less) = (found.more + more, found.less + less);
            if more + less > most {
                most = more + less;
                let width = |s: &usize| straights[*s].1.min(chord) - straights[*s].0;
                found.section = between.iter().copied().max_by(|a, b| width(a).total_cmp(&width(b)));
            }
            (now, least, largest) = (now + other.1, least + other.1, largest + other.1);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Corner, Point};
    use crate::kinematics::{fit, level};

    /// A loop with two curves of these radii that lie so far apart, the same way or to either side, and which is so much
    /// longer on straights that are long.
    fn loop_of(apart: f64, (first, second): (f64, f64), same: bool, longer: f64) -> Track {
        let corner = |x: f64, y: f64, radius: f64| Corner { point: Point::new(x, y), radius };
        let across = first + second + apart;
        match same {
            true => Track::new(&[
                corner(0.0, 0.0, 3.0),
                corner(40.0 + longer, 0.0, first),
                corner(40.0 + longer, across, second),
                corner(20.0, across, 3.0),
                corner(20.0, across + 9.0, 3.0),
                corner(0.0, across + 9.0, 3.0),
            ]),
            false => Track::new(&[
                corner(0.0, 0.0, 3.0),
                corner(40.0 + longer, 0.0, 3.0),
                corner(40.0 + longer, 10.0, 3.0),
                corner(20.0, 10.0, first),
                corner(20.0, 10.0 + across, second),
                corner(0.0, 10.0 + across, 3.0),
            ]),
        }
    }

    /// The same, closed by chords of exactly this length: of another, more or less is cut off.
    fn track(apart: f64, radii: (f64, f64), same: bool, chord: f64) -> Track {
        let mut longer = 0.0;
        for _ in 0..4 {
            let at = loop_of(apart, radii, same, longer);
            longer -= 0.5 * fit(&level(&at), chord).unwrap().left_over;
        }
        loop_of(apart, radii, same, longer)
    }

    fn measured(track: &Track, chord: f64) -> f64 {
        let fit = fit(&level(track), chord).unwrap();
        track.length - fit.carts as f64 * chord - fit.left_over
    }

    /// What is cut off changes with the straight as it may, and does change.
    #[test]
    fn curves_near_each_other_cut_off_more_or_less() {
        for (chord, radii) in [(1.0, (3.0, 3.0)), (1.25, (4.0, 3.0)), (0.6, (3.0, 5.0)), (1.2, (2.0, 2.5))] {
            for same in [true, false] {
                let lengths: Vec<f64> = (0..9).map(|k| 0.2 * f64::from(k) * chord).collect();
                let tracks: Vec<Track> = lengths.iter().map(|apart| track(*apart, radii, same, chord)).collect();
                let cuts: Vec<f64> = tracks.iter().map(|track| measured(track, chord)).collect();
                let section = if same { 1 } else { 3 };
                for (own, track) in tracks.iter().enumerate() {
                    for other in 0..tracks.len() {
                        let mut straights: Vec<(f64, f64)> =
                            (0..6).map(|i| (track.straight(i).length, track.straight(i).length)).collect();
                        let (a, b) = (lengths[own], lengths[other]);
                        straights[section] = (a.min(b), a.max(b));
                        let leeway = leeway(track, chord, &straights);
                        let more = cuts[other] - cuts[own];
                        let unsure = coupling(track, chord);
                        assert!(
                            more <= leeway.more + unsure && -more <= leeway.less + unsure,
                            "{chord} {same} {a} {b}: {more} {leeway:?}"
                        );
                        if own != other && leeway.more + leeway.less > 1e-9 {
                            assert_eq!(leeway.section, Some(section));
                        }
                    }
                }
                for (track, measured) in tracks.iter().zip(&cuts) {
                    let (expanded, share) = cut(track, chord);
                    assert!((expanded - measured).abs() < share * measured, "{chord} {same}: {expanded} {measured}");
                }
                let (touching, apart) = (cuts[0], cuts[8]);
                let steep = chord * chord * chord / (120.0 * radii.0 * radii.1);
                assert!(
                    ((touching - apart).abs() - steep).abs() < 0.25 * steep,
                    "{chord} {same}: {touching} {apart} {steep}"
                );
                assert_eq!(touching > apart, same);
            }
        }
    }
}
