//! Curves that were built otherwise, written anew: other bows, and tangents in closed form.

use crate::base::trig;
use crate::benchmark::draw::{add, pick};
use crate::benchmark::source::{Source, chain, sign};
use crate::chain_input::{CentreLinePiece, Deviations, Simulation, Track};
use crate::effects::sites::curves;

/// An arc between two level straights.
#[derive(Clone, Copy)]
struct Corner {
    /// The straight before, the arc and the straight behind.
    pieces: [usize; 3],
    radius: f64,
    /// rad, left positive.
    turn: f64,
}

/// One curve, built otherwise in one of four ways; where its neighbours are no level straights, in one of two.
pub fn curve(nominal: &Simulation, lap: f64, state: &mut u64) -> Source {
    let curves = curves(nominal);
    let which = pick(state, curves.len());
    let (number, from, to) = curves.get(which).copied().unwrap_or((1, 0.0, lap));
    let way = sign(state);
    let own = corner(&nominal.track, from, to);
    let next = curves.get((which + 1) % curves.len().max(1));
    let next = next.and_then(|(_, from, to)| corner(&nominal.track, *from, *to));
    let mut source = match (pick(state, 4), own, next) {
        (0, Some(corner), _) => {
            let act = move |x: f64, sim: &mut Simulation, _: &mut Deviations| widen(&mut sim.track, corner, way * x);
            chain("curve_geometry", "radius", (0.01, 0.5), Box::new(act))
        }
        (1, Some(corner), Some(next)) if corner.pieces[2] == next.pieces[0] => {
            let act =
                move |x: f64, sim: &mut Simulation, _: &mut Deviations| turn(&mut sim.track, corner, next, way * x);
            chain("curve_geometry", "heading", (1e-3, 0.06), Box::new(act))
        }
        (2, Some(corner), _) => {
            let act = move |x: f64, _: &mut Simulation, d: &mut Deviations| {
                let half = 0.5 * (to - from);
                add(&mut d.rails[0], lap, |s| {
                    let off = s - 0.5 * (from + to);
                    let off = off - lap * (off / lap).round();
                    transition(half - off.abs(), x.min(2.0 * half)) / corner.radius * corner.turn.signum()
                });
            };
            chain("curve_geometry", "transition", (0.1, 2.0), Box::new(act))
        }
        // Off to a side by 16 u² (1 − u)² of what it is in the middle.
        _ => {
            let act = move |x: f64, _: &mut Simulation, d: &mut Deviations| {
                add(&mut d.rails[0], lap, |s| {
                    let u = ((s - from) / (to - from)).clamp(0.0, 1.0);
                    16.0 * way * x * u * u * (1.0 - u) * (1.0 - u)
                });
            };
            chain("curve_geometry", "offset", (1e-4, 0.035), Box::new(act))
        }
    };
    if source.strengths[0].0 != "transition" {
        source.strengths[0].1 = way;
    }
    source.fixed.insert("curve".to_owned(), number as f64);
    source.place = Some((from, to));
    source
}

/// The corner whose arc begins and ends there, where it is one.
fn corner(track: &Track, from: f64, to: f64) -> Option<Corner> {
    let n = track.elements.len();
    let mut s = 0.0;
    for (k, piece) in track.elements.iter().enumerate() {
        let (begin, end) = (s, s + piece.form().length());
        s = end;
        let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
        if let (true, CentreLinePiece::Arc { radius, turn_deg }) = (near(begin, from) && near(end, to), piece) {
            let pieces = [(k + n - 1) % n, k, (k + 1) % n];
            let level = |k: usize| matches!(track.elements[k], CentreLinePiece::Straight { slope: 0.0, .. });
            let corner = Corner { pieces, radius: *radius, turn: turn_deg.to_radians() };
            return (level(pieces[0]) && level(pieces[2])).then_some(corner);
        }
    }
    None
}

/// Of a corner's vertex from where its arc begins, m.
fn tangent(radius: f64, turn: f64) -> f64 {
    radius * trig::tan(0.5 * turn.abs())
}

fn lengthen(piece: &mut CentreLinePiece, by: f64) {
    if let CentreLinePiece::Straight { length, .. } = piece {
        *length += by;
    }
}

/// With a larger radius between the same straights, which lose as much as the tangents win.
fn widen(track: &mut Track, Corner { pieces: [before, arc, behind], radius, turn }: Corner, more: f64) {
    let lost = tangent(more, turn);
    track.elements[arc] = CentreLinePiece::Arc { radius: radius + more, turn_deg: turn.to_degrees() };
    lengthen(&mut track.elements[before], -lost);
    lengthen(&mut track.elements[behind], -lost);
}

/// With the straight between two corners turned about the middle between their vertices, which move along the straights
/// before and behind.
fn turn(track: &mut Track, one: Corner, other: Corner, more: f64) {
    let between = track.elements[one.pieces[2]].form().length();
    let half = 0.5 * (between + tangent(one.radius, one.turn) + tangent(other.radius, other.turn));
    let (a, b) = (one.turn + more, other.turn - more);
    // By the law of sines, in the triangles of the middle, a vertex as planned and the same as built.
    let moved = |turn: f64| half * trig::sin(more) / trig::sin(turn);
    let reach = |planned: f64, built: f64| half * trig::sin(planned) / trig::sin(built);
    let less = |corner: Corner, built: f64| tangent(corner.radius, corner.turn) - tangent(corner.radius, built);
    lengthen(&mut track.elements[one.pieces[0]], moved(a) + less(one, a));
    lengthen(&mut track.elements[other.pieces[2]], less(other, b) - moved(b));
    let whole = reach(one.turn, a) + reach(other.turn, b);
    let straight = whole - tangent(one.radius, a) - tangent(other.radius, b);
    lengthen(&mut track.elements[one.pieces[2]], straight - between);
    for (corner, turn) in [(one, a), (other, b)] {
        track.elements[corner.pieces[1]] = CentreLinePiece::Arc { radius: corner.radius, turn_deg: turn.to_degrees() };
    }
}

/// How far inwards of an arc of radius 1 a curve lies, so far inside its end, whose curvature grows linearly over a.
fn transition(inside: f64, a: f64) -> f64 {
    let from = inside + 0.5 * a;
    if from <= 0.0 {
        0.0
    } else if inside < 0.0 {
        from * from * from / (6.0 * a)
    } else if from < a {
        let to = a - from;
        // As seen from the arc, it comes down to its shift the same way as it left the straight.
        a * a / 24.0 - to * to * to / (6.0 * a)
    } else {
        a * a / 24.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::model::fixture;

    #[test]
    fn tracks_close_whatever_is_built_otherwise() {
        let nominal = Simulation::new(&compile(fixture::rectangle(20.0, 12.0, 4.0)));
        let lap = nominal.track.centre_line().length;
        let mut met = std::collections::BTreeSet::new();
        for seed in 0..60 {
            let source = curve(&nominal, lap, &mut (seed + 1));
            let crate::benchmark::source::Change::Chain(act) = &source.change else { panic!("of the chain") };
            let (mut built, mut deviations) = (nominal.clone(), Deviations::default());
            act(source.range.1, &mut built, &mut deviations);
            let (gap, angle) = built.track.centre_line().closure;
            assert!(gap < 1e-6 && angle < 1e-9, "{:?}: {gap} m, {angle} rad", source.strengths);
            let rails = deviations.rails[0].iter().any(|x| *x != 0.0);
            assert!(rails != (built.track != nominal.track), "{:?}", source.strengths);
            met.insert(source.strengths[0].0);
        }
        assert_eq!(met.into_iter().collect::<Vec<_>>(), ["heading", "offset", "radius", "transition"]);
    }

    #[test]
    fn a_transition_goes_over_into_the_arc_without_a_kink() {
        let a = 1.4;
        for (x, y) in [(-0.7, 0.0), (0.0, a * a / 48.0), (0.7, a * a / 24.0)] {
            let near = |d: f64| (transition(x + d, a) - y).abs();
            assert!(near(0.0) < 1e-12 && near(1e-4) < 1e-4 && near(-1e-4) < 1e-4);
        }
        let slope = |x: f64| (transition(x + 1e-5, a) - transition(x - 1e-5, a)) / 2e-5;
        assert!(slope(0.69).abs() < 1e-3 && slope(-0.69).abs() < 1e-3 && (slope(0.0) - a / 8.0).abs() < 1e-5);
    }
}
