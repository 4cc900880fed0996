//! The drawing's origin, the building's axes, and coordinates along two sides of the plan (running dimensions, ISO 129).

use crate::base::trig;
use crate::emit::paper::PaperPoint;
use crate::emit::plan;
use crate::geometry::Point;
use crate::model::{Coordinate, Layout};

use super::decimals::Decimals;
use super::place::{LabelCandidate, Layer, PaperBox, TakenPaper, around};
use super::sheet::{Sheet, path, path_line, reading_angle};
use super::symbol;
use super::text::{self, Height};
use super::xml::XmlElement;

/// From the plan's outermost line to the running dimension, and from there to its numbers, mm.
const RUNNING: f64 = 3.0;
const NUMBERS: f64 = 2.2;
/// Least distance of neighbouring numbers, mm.
const APART: f64 = 3.3;
/// Places at each side of a wall's middle where its distance may stand.
const WALL_PLACES: usize = 14;
/// Radius of the circle around an axis' name, and how far it stands from the plan, mm.
const BUBBLE: f64 = 3.0;
const AXIS: f64 = 4.0;

/// Smallest and largest coordinates of the plan, m, and what has no room around it.
pub struct Frame {
    pub low: Point,
    pub high: Point,
    /// Numbers and names without room.
    pub omitted: Vec<String>,
}

impl Frame {
    /// Whether a point lies on the plan.
    fn shows(&self, p: Point) -> bool {
        let within = |value: f64, low: f64, high: f64| value >= low - 1e-9 && value <= high + 1e-9;
        within(p.x, self.low.x, self.high.x) && within(p.y, self.low.y, self.high.y)
    }
}

/// The origin's coordinates in the layout, in words.
pub fn origin_words(layout: &Layout) -> String {
    let origin = layout.drawing.origin;
    if origin == Point::default() {
        return "coordinates from the origin, m".to_owned();
    }
    let shown = |value: f64| crate::base::number::trimmed(value, 3);
    format!("coordinates, m; origin at ({}, {}) of the layout", shown(origin.x), shown(origin.y))
}

/// The symbol of the origin: a circle with two filled quarters.
pub fn datum_symbol(at: PaperPoint, radius: f64) -> XmlElement {
    let p = |x: f64, y: f64| super::sheet::coordinates(at + PaperPoint::new(x * radius, y * radius));
    let r = super::xml::number(radius);
    let quarter = |from: String, to: String| format!("M{}L{from}A{r} {r} 0 0 1 {to}Z", p(0.0, 0.0));
    let filled = quarter(p(0.0, -1.0), p(1.0, 0.0)) + &quarter(p(0.0, 1.0), p(-1.0, 0.0));
    XmlElement::group("datum")
        .with(symbol::circle(at, radius, "datum-ground"))
        .with(path(&filled, "dimension-arrow"))
        .with(symbol::circle(at, radius, "rule"))
}

/// The origin with its coordinates, where it lies on the plan.
pub fn datum(sheet: &Sheet, layout: &Layout, frame: &Frame, field: &mut TakenPaper) -> Option<XmlElement> {
    let origin = layout.drawing.origin;
    if !frame.shows(origin) {
        return None;
    }
    let at = sheet.at(origin);
    let mut group = datum_symbol(at, 1.8);
    field.add(PaperBox::upright(at, 4.0, 4.0), Layer::Solid);
    let words = "0, 0";
    let size = PaperPoint::new(text::width(words, Height::H25.size(), true) + 1.6, 1.24 * Height::H25.size());
    if let Some(chosen) = field.place(&around(at, PaperPoint::new(-0.8, 0.6), size, 2.4, 24.0)) {
        if let Some((a, b)) = chosen.leader {
            group.push(path(&path_line(a, b), "leader"));
        }
        group.push(text::centred(chosen.text.centre, 0.0, words, Height::H25, "halo bold"));
    }
    Some(group)
}

/// Axes of the building across the plan, with their names in circles at the top and at the right.
pub fn axes(sheet: &Sheet, layout: &Layout, frame: &mut Frame, field: &mut TakenPaper) -> XmlElement {
    let mut group = XmlElement::group("grid-axes");
    let (low, high) = (sheet.at(frame.low), sheet.at(frame.high));
    let mut lines = String::new();
    for coordinate in [Coordinate::X, Coordinate::Y] {
        let mut axes: Vec<_> = layout.drawing.axes.iter().filter(|axis| axis.coordinate == coordinate).collect();
        axes.sort_by(|a, b| a.at.total_cmp(&b.at));
        // Ends of the last circles in the near and in the far row.
        let mut ends = [f64::NEG_INFINITY; 2];
        for axis in axes {
            let upright = coordinate == Coordinate::X;
            let at = sheet.at(Point::new(axis.at, axis.at));
            let place = if upright { at.x } else { -at.y };
            let shown = if upright {
                axis.at >= frame.low.x - 1e-9 && axis.at <= frame.high.x + 1e-9
            } else {
                axis.at >= frame.low.y - 1e-9 && axis.at <= frame.high.y + 1e-9
            };
            let value =
                Decimals::text(axis.at - if upright { layout.drawing.origin.x } else { layout.drawing.origin.y }, 3);
            let row = ends.iter().position(|end| place - BUBBLE >= *end);
            let (Some(row), true) = (row, shown) else {
                let way = if upright { "x" } else { "y" };
                frame.omitted.push(format!("axis {}: {way} = {value}", axis.name));
                continue;
            };
            ends[row] = place + BUBBLE + 0.5;
            let out = AXIS + row as f64 * (2.0 * BUBBLE + 0.5);
            let (from, to, along) = if upright {
                (PaperPoint::new(at.x, low.y + 1.0), PaperPoint::new(at.x, high.y - out), PaperPoint::new(0.0, -1.0))
            } else {
                (PaperPoint::new(low.x - 1.0, at.y), PaperPoint::new(high.x + out, at.y), PaperPoint::new(1.0, 0.0))
            };
            lines += &path_line(from, to);
            field.add_line(from, to, 0.3, Layer::Line);
            let centre = to + along * BUBBLE;
            group.push(symbol::circle(centre, BUBBLE, "bubble"));
            let height = if axis.name.chars().count() > 2 { Height::H18 } else { Height::H25 };
            let name = text::fitted(&axis.name, height, false, 2.0 * BUBBLE - 0.6);
            group.push(text::centred(centre, 0.0, name, height, ""));
            field.add(PaperBox::upright(centre, 2.0 * BUBBLE + 0.4, 2.0 * BUBBLE + 0.4), Layer::Label);
        }
    }
    if !lines.is_empty() {
        group.push(path(&lines, "grid-axis"));
    }
    group
}

/// Coordinates of the building's corners and of its axes, from the origin: x under the plan, y at its left.
pub fn ordinates(
    sheet: &Sheet,
    layout: &Layout,
    decimals: usize,
    frame: &mut Frame,
    field: &mut TakenPaper,
) -> XmlElement {
    let mut group = XmlElement::group("ordinates");
    for coordinate in [Coordinate::X, Coordinate::Y] {
        running(sheet, layout, coordinate, decimals, frame, field, &mut group);
    }
    group
}

fn running(
    sheet: &Sheet,
    layout: &Layout,
    coordinate: Coordinate,
    decimals: usize,
    frame: &mut Frame,
    field: &mut TakenPaper,
    group: &mut XmlElement,
) {
    let upright = coordinate == Coordinate::X;
    let origin = if upright { layout.drawing.origin.x } else { layout.drawing.origin.y };
    let (low, high) = if upright { (frame.low.x, frame.high.x) } else { (frame.low.y, frame.high.y) };
    let corner = sheet.at(frame.low);
    // Along the running dimension and away from the plan.
    let (along, out) = if upright {
        (PaperPoint::new(1.0, 0.0), PaperPoint::new(0.0, 1.0))
    } else {
        (PaperPoint::new(0.0, -1.0), PaperPoint::new(-1.0, 0.0))
    };
    let line = corner + out * RUNNING;
    let way = |value: f64| sheet.mm(value - low);
    let values: Vec<f64> = plan::ordinates(layout, coordinate);
    let (shown, beyond): (Vec<f64>, Vec<f64>) =
        values.into_iter().partition(|value| *value >= low - 1e-9 && *value <= high + 1e-9);
    let name = if upright { "x" } else { "y" };
    let words = |value: f64| Decimals::text(value - origin, decimals);
    let most = (way(high) / APART).floor() as usize + 1;
    let (shown, crowded) = shown.split_at(shown.len().min(most));
    let unseen = beyond.iter().filter(|value| **value != origin).chain(crowded);
    frame.omitted.extend(unseen.map(|value| format!("{name} = {}", words(*value))));
    let (Some(first), Some(last)) = (shown.first(), shown.last()) else { return };
    let mut rules = path_line(line + along * way(*first), line + along * way(*last));
    let places = spread(&shown.iter().map(|value| way(*value)).collect::<Vec<_>>());
    for (value, place) in shown.iter().zip(places) {
        let at = line + along * way(*value);
        let number = line + along * place + out * NUMBERS;
        rules += &path_line(at - out * 0.8, at + out * 0.8);
        rules += &path_line(at + out * 0.8, number - out * 0.4);
        if *value == origin {
            group.push(symbol::circle(at, 0.9, "datum-ground"));
            group.push(symbol::circle(at, 0.9, "dimension"));
        }
        let words = words(*value);
        let wide = text::width(&words, Height::H18.size(), false);
        let centre = number + out * (wide / 2.0);
        let angle = if upright { reading_angle(PaperPoint::unit(-trig::FRAC_PI_2)) } else { 0.0 };
        group.push(text::centred(centre, angle, words, Height::H18, ""));
        let item =
            PaperBox { centre, half: PaperPoint::new(wide / 2.0 + 0.3, 1.24 * Height::H18.size() / 2.0), axis: out };
        field.add(item, Layer::Label);
    }
    let bar = PaperBox::line(line + along * way(*first), line + along * way(*last), 2.2);
    field.add(bar, Layer::Label);
    group.push(path(&rules, "dimension"));
}

/// Places in the same order, as near to these as `APART` allows.
fn spread(wanted: &[f64]) -> Vec<f64> {
    // Runs of neighbours that touch: begin, and how many.
    let mut runs: Vec<(f64, usize, f64)> = Vec::new();
    for place in wanted {
        runs.push((*place, 1, *place));
        while let [.., (begin, count, sum), (next, more, add)] = runs.as_slice() {
            if begin + *count as f64 * APART <= *next {
                break;
            }
            let (count, sum, more, add) = (*count, *sum, *more, *add);
            // Of the wanted places less their offsets in the run: the mean is nearest to all of them.
            let joined = (sum + add - more as f64 * count as f64 * APART, count + more);
            runs.truncate(runs.len() - 2);
            runs.push((joined.0 / joined.1 as f64, joined.1, joined.0));
        }
    }
    runs.into_iter().flat_map(|(begin, count, _)| (0..count).map(move |k| begin + k as f64 * APART)).collect()
}

/// A distance from a wall while it is placed: its number with a dimension line from the centre line to the wall.
pub fn wall_candidates(
    sheet: &Sheet,
    wall: &plan::WallDistance,
    half: f64,
    size: PaperPoint,
) -> Vec<(LabelCandidate, [PaperPoint; 2])> {
    let mut candidates = Vec::new();
    // From the middle outwards.
    for step in 0..=2 * WALL_PLACES {
        let aside = step.div_ceil(2) as f64 / (2 * WALL_PLACES) as f64;
        let (cost, t) = (4.0 * aside, if step % 2 == 0 { 0.5 + aside } else { 0.5 - aside });
        let (from, to) = (sheet.at(wall.track.0.lerp(wall.track.1, t)), sheet.at(wall.wall.0.lerp(wall.wall.1, t)));
        let length = from.distance(to);
        if length < 1e-6 {
            continue;
        }
        let along = (to - from) * (1.0 / length);
        let edge = from + along * half.min(length);
        let open = edge.distance(to);
        let bar = (open > 1.6).then(|| PaperBox::line(edge + along * 0.4, to - along * 0.6, 0.8));
        let extensions = Some([(from, edge), (edge, edge)]);
        let middle = edge.lerp(to, 0.5);
        let mut add = |text: PaperBox, leader, cost: f64| {
            let candidate = LabelCandidate { text, bar, extensions, leader, cost };
            candidates.push((candidate, [from, to]));
        };
        if open > size.x + 1.0 {
            let angle = reading_angle(along) * trig::PI / 180.0;
            let up = PaperPoint::new(trig::sin(angle), -trig::cos(angle));
            for side in [1.0, -1.0] {
                let centre = middle + up * (side * (size.y / 2.0 + 0.5));
                add(PaperBox { centre, half: size * 0.5, axis: along }, None, cost + 0.2 * (1.0 - side));
            }
        }
        for candidate in around(middle, along.across(), size, 1.2, 16.0) {
            add(candidate.text, candidate.leader, cost + 2.0 + candidate.cost);
        }
    }
    candidates
}

#[cfg(test)]
mod tests {
    use super::{APART, spread};

    #[test]
    fn crowded_numbers_move_apart_and_stay_in_order() {
        assert_eq!(spread(&[0.0, 10.0, 20.0]), [0.0, 10.0, 20.0]);
        let placed = spread(&[0.0, 10.0, 10.1, 10.2, 30.0]);
        assert!((placed[2] - 10.1).abs() < 1e-9 && (placed[1] - (10.1 - APART)).abs() < 1e-9, "{placed:?}");
        let placed = spread(&[0.0, 1.0, 2.0, 3.0, 4.0, 4.5]);
        assert!(placed.windows(2).all(|pair| pair[1] - pair[0] > APART - 1e-9), "{placed:?}");
        assert!(spread(&[]).is_empty());
    }
}
