//! The class of a closed line among points: which rays from the points it crosses, in which order and way, without what
//! it takes back. Two lines of the same word can be moved into each other without passing over a point.

use crate::geometry::Point;

/// Heading of all rays, rad: no edge of a drawing has it.
const RAYS: f64 = 1.234_567;

/// A ray that is crossed, and whether to the left as seen along the ray.
type Crossing = (usize, bool);

/// The word of a closed line in the form that all lines of its class share: without neighbours that cancel each other, and
/// begun at the place where it comes first in the order of its letters.
pub fn cyclic(line: &[Point], points: &[Point]) -> Vec<Crossing> {
    let closed: Vec<Point> = line.iter().chain(line.first()).copied().collect();
    let word = between(&closed, points);
    let half = word.len() / 2;
    let ends = (0..half).take_while(|&i| cancel(word[i], word[word.len() - 1 - i])).count();
    let kept = &word[ends..word.len() - ends];
    let turned = |from: usize| [&kept[from..], &kept[..from]].concat();
    (0..kept.len()).map(turned).min().unwrap_or_default()
}

/// The word of a line from its first point to its last, which all lines between these share that can be moved into each
/// other.
pub fn between(line: &[Point], points: &[Point]) -> Vec<Crossing> {
    let ray = Point::unit(RAYS);
    let mut word: Vec<Crossing> = Vec::new();
    for (&a, &b) in line.iter().zip(line.iter().skip(1)) {
        let mut crossed: Vec<(f64, Crossing)> = Vec::new();
        for (k, &p) in points.iter().enumerate() {
            let [from, to] = [a, b].map(|q| ray.cross(q - p));
            if (from > 0.0) != (to > 0.0) {
                let t = from / (from - to);
                if ray.dot(a.lerp(b, t) - p) > 0.0 {
                    crossed.push((t, (k, to > 0.0)));
                }
            }
        }
        crossed.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, crossing) in crossed {
            match word.last() {
                Some(&last) if cancel(last, crossing) => drop(word.pop()),
                _ => word.push(crossing),
            }
        }
    }
    word
}

/// The words between points of a closed line, by their places on it, ascending; of the whole line where there are none.
pub fn parts(line: &[Point], at: &[usize], points: &[Point]) -> Vec<Vec<Crossing>> {
    let Some(&first) = at.first() else { return vec![cyclic(line, points)] };
    let n = line.len();
    let ends = at.iter().copied().chain([first + n]);
    let pairs = ends.clone().zip(ends.skip(1));
    pairs.map(|(a, b)| between(&(a..=b).map(|k| line[k % n]).collect::<Vec<_>>(), points)).collect()
}

fn cancel(a: Crossing, b: Crossing) -> bool {
    a.0 == b.0 && a.1 != b.1
}
