//! Where along a straight something stands beside it.

use super::footprint::{Line, TOUCH};
use crate::base::trig;
use crate::geometry::{Piece, PieceKind, Point};

/// The stretches of a straight, m along it, beside which a closed outline covers part of the strip from `near` to `far`, m
/// to the left. `outside`: what lies outside of the outline counts, not what lies within. Exact for any simple polygon:
/// between two of the events below, an edge neither begins, ends, nor crosses a side of the strip.
pub fn shadow(points: &[Point], line: &Line, strip: (f64, f64), reach: (f64, f64), outside: bool) -> Vec<(f64, f64)> {
    let (near, far) = (strip.0.min(strip.1) + TOUCH, strip.0.max(strip.1) - TOUCH);
    if near >= far || reach.0 >= reach.1 {
        return Vec::new();
    }
    let local: Vec<Point> = points.iter().map(|p| line.local(*p)).collect();
    let n = local.len();
    let edges: Vec<(Point, Point)> = (0..n).map(|i| (local[i], local[(i + 1) % n])).collect();
    let mut events = vec![reach.0, reach.1];
    for (a, b) in &edges {
        events.push(a.x);
        for level in [near, far] {
            if (a.y - level) * (b.y - level) < 0.0 {
                events.push(a.x + (b.x - a.x) * (level - a.y) / (b.y - a.y));
            }
        }
    }
    events.retain(|x| *x >= reach.0 && *x <= reach.1);
    events.sort_by(f64::total_cmp);
    let mut found: Vec<(f64, f64)> = Vec::new();
    for pair in events.windows(2) {
        if pair[1] - pair[0] <= 1e-9 {
            continue;
        }
        let x = 0.5 * (pair[0] + pair[1]);
        let crossing =
            |(a, b): &(Point, Point)| ((a.x > x) != (b.x > x)).then(|| a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x));
        let mut heights: Vec<f64> = edges.iter().filter_map(crossing).collect();
        heights.sort_by(f64::total_cmp);
        let inside: f64 = heights.chunks_exact(2).map(|p| (p[1].min(far) - p[0].max(near)).max(0.0)).sum();
        let covered = if outside { far - near - inside } else { inside };
        if covered > 1e-9 {
            match found.last_mut() {
                Some(last) if pair[0] - last.1 <= 1e-9 => last.1 = pair[1],
                _ => found.push((pair[0], pair[1])),
            }
        }
    }
    found
}

/// The area that the band of a piece of the track covers, as a polygon: of an arc a little more than that, by chords of its
/// inner edge and tangents of its outer one, each over at most a degree.
pub fn band(piece: &Piece, half: f64) -> Vec<Point> {
    match piece.kind {
        PieceKind::Straight => {
            let line = Line::of(piece);
            vec![line.at(0.0, -half), line.at(line.length, -half), line.at(line.length, half), line.at(0.0, half)]
        }
        PieceKind::Arc { centre, radius, turn } => {
            let parts = (turn.abs().to_degrees().ceil()).max(1.0);
            let step = turn / parts;
            let first = (piece.begin - centre).heading();
            let at = |angle: f64, r: f64| centre + Point::unit(first + angle) * r;
            let outer = radius + half;
            let inner = (radius - half).max(0.0);
            let mut points = vec![at(0.0, outer)];
            let corner = outer / trig::cos(0.5 * step);
            points.extend((0..parts as usize).map(|i| at((i as f64 + 0.5) * step, corner)));
            points.push(at(turn, outer));
            points.extend((0..=parts as usize).rev().map(|i| at(i as f64 * step, inner)));
            points
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;

    fn line() -> Line {
        Line { begin: Point::new(0.0, 0.0), along: Point::new(1.0, 0.0), length: 20.0 }
    }

    #[test]
    fn a_triangle_counts_only_where_it_reaches_into_the_strip() {
        let triangle = [Point::new(5.0, 4.0), Point::new(9.0, 4.0), Point::new(7.0, 0.0)];
        let found = shadow(&triangle, &line(), (1.0, 2.0), (0.0, 20.0), false);
        // At a height of 2 m it is 2 m wide.
        assert_eq!(found.len(), 1);
        assert!((found[0].0 - 6.0).abs() < 1e-5 && (found[0].1 - 8.0).abs() < 1e-5, "{found:?}");
    }

    /// Against points of the strip at random: what the shadow says of a place holds for all points above it.
    #[test]
    fn shadows_agree_with_points() {
        let mut rng = Random::new(7);
        let mut within = |low: f64, high: f64| low + (high - low) * rng.uniform();
        for _ in 0..200 {
            let (x, y) = (within(2.0, 18.0), within(-4.0, 4.0));
            let points: Vec<Point> = (0..6)
                .map(|i| Point::new(x, y) + Point::unit(f64::from(i) * std::f64::consts::TAU / 6.0) * within(0.3, 3.0))
                .collect();
            let polygon = crate::geometry::Polygon::new(points.clone());
            let Ok(polygon) = polygon else { continue };
            for outside in [false, true] {
                let found = shadow(polygon.points(), &line(), (0.5, 2.0), (0.0, 20.0), outside);
                for i in 0..400 {
                    let u = f64::from(i) * 0.05 + 0.013;
                    let any = (0..300).any(|j| {
                        let p = Point::new(u, 0.5 + 1.5 * (f64::from(j) + 0.5) / 300.0);
                        polygon.contains(p) != outside
                    });
                    let told = found.iter().any(|(a, b)| *a < u && u < *b);
                    let near = found.iter().any(|(a, b)| (a - u).abs() < 0.02 || (b - u).abs() < 0.02);
                    assert!(any == told || near, "{u} {outside} {found:?}");
                }
            }
        }
    }
}
