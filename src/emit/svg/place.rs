//! Label placement on paper: oriented boxes in a grid of cells, and a greedy choice among candidates.

use crate::geometry::{Point, bounds, trig};

/// What a box stands for, which decides who may cover it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Text and dimension lines: nothing covers them.
    Label,
    /// Symbols and the track's band: no label covers them.
    Solid,
    /// Thin lines: covered when nothing better is free.
    Line,
}

/// A rectangle, turned; mm on paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box {
    pub centre: Point,
    /// Half its size along and across the axis.
    pub half: Point,
    /// Unit vector.
    pub axis: Point,
}

impl Box {
    pub fn upright(centre: Point, width: f64, height: f64) -> Self {
        Box { centre, half: Point::new(width / 2.0, height / 2.0), axis: Point::new(1.0, 0.0) }
    }

    /// A line from `a` to `b` of this thickness.
    pub fn line(a: Point, b: Point, thickness: f64) -> Self {
        let length = a.distance(b);
        let axis = if length > 0.0 { (b - a) * (1.0 / length) } else { Point::new(1.0, 0.0) };
        Box { centre: a.lerp(b, 0.5), half: Point::new(length / 2.0, thickness / 2.0), axis }
    }

    pub fn corners(&self) -> [Point; 4] {
        let (u, v) = (self.axis * self.half.x, self.axis.left() * self.half.y);
        [self.centre + u + v, self.centre + u - v, self.centre - u - v, self.centre - u + v]
    }

    /// Separating axes of two rectangles.
    pub fn meets(&self, other: &Box) -> bool {
        let between = other.centre - self.centre;
        [self.axis, self.axis.left(), other.axis, other.axis.left()].into_iter().all(|axis| {
            let reach = |b: &Box| b.half.x * b.axis.dot(axis).abs() + b.half.y * b.axis.left().dot(axis).abs();
            between.dot(axis).abs() < reach(self) + reach(other)
        })
    }
}

/// Where a label may stand.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// What it covers; the first is the text.
    pub boxes: Vec<Box>,
    /// Its thin lines, which may cross others and symbols at a cost.
    pub lines: Vec<(Point, Point)>,
    /// A thin line to what it names.
    pub leader: Option<(Point, Point)>,
    /// Lower is better.
    pub cost: f64,
}

/// Taken places of a drawing area.
pub struct Field {
    low: Point,
    high: Point,
    columns: usize,
    cells: Vec<Vec<u32>>,
    boxes: Vec<(Box, Layer)>,
}

/// Edge of a cell, mm.
const CELL: f64 = 8.0;
/// Costs of a candidate's box on a line, of its thin lines across a line, and across symbols or the band.
const ON_LINE: f64 = 12.0;
const THIN_ON_LINE: f64 = 1.0;
const THIN_ON_SOLID: f64 = 6.0;

impl Field {
    pub fn new(low: Point, high: Point) -> Self {
        let count = |length: f64| (length / CELL).ceil().max(1.0) as usize;
        let (columns, rows) = (count(high.x - low.x), count(high.y - low.y));
        Field { low, high, columns, cells: vec![Vec::new(); columns * rows], boxes: Vec::new() }
    }

    pub fn add(&mut self, item: Box, layer: Layer) {
        let index = self.boxes.len() as u32;
        for cell in self.cells_of(&item) {
            self.cells[cell].push(index);
        }
        self.boxes.push((item, layer));
    }

    /// A line, in parts that are not much longer than a cell.
    pub fn add_line(&mut self, a: Point, b: Point, thickness: f64, layer: Layer) {
        let parts = (a.distance(b) / (2.0 * CELL)).ceil().clamp(1.0, 1000.0) as usize;
        for i in 0..parts {
            let at = |k: usize| a.lerp(b, k as f64 / parts as f64);
            self.add(Box::line(at(i), at(i + 1), thickness), layer);
        }
    }

    /// Takes the cheapest free candidate; among equals the first.
    pub fn place(&mut self, candidates: &[Candidate]) -> Option<Candidate> {
        let mut order: Vec<&Candidate> = candidates.iter().collect();
        order.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let mut best: Option<(f64, &Candidate)> = None;
        for candidate in order {
            if best.is_some_and(|(cost, _)| cost <= candidate.cost) {
                break;
            }
            if let Some(extra) = self.extra_cost(candidate) {
                let cost = candidate.cost + extra;
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, candidate));
                }
            }
        }
        let chosen = best?.1.clone();
        for item in &chosen.boxes {
            self.add(*item, Layer::Label);
        }
        for &(a, b) in chosen.lines.iter().chain(&chosen.leader) {
            self.add_line(a, b, 0.3, Layer::Line);
        }
        Some(chosen)
    }

    fn extra_cost(&self, candidate: &Candidate) -> Option<f64> {
        let mut cost = 0.0;
        for item in &candidate.boxes {
            if !self.within(item) {
                return None;
            }
            for layer in self.under(item) {
                match layer {
                    Layer::Label | Layer::Solid => return None,
                    Layer::Line => cost += ON_LINE,
                }
            }
        }
        for &(a, b) in candidate.lines.iter().chain(&candidate.leader) {
            for layer in self.under(&Box::line(a, b, 0.3)) {
                match layer {
                    Layer::Label => return None,
                    Layer::Solid => cost += THIN_ON_SOLID,
                    Layer::Line => cost += THIN_ON_LINE,
                }
            }
        }
        Some(cost)
    }

    fn within(&self, item: &Box) -> bool {
        item.corners()
            .iter()
            .all(|p| p.x >= self.low.x && p.x <= self.high.x && p.y >= self.low.y && p.y <= self.high.y)
    }

    /// Layers of the boxes that this one meets.
    fn under<'a>(&'a self, item: &'a Box) -> impl Iterator<Item = Layer> + 'a {
        let mut near: Vec<u32> = self.cells_of(item).flat_map(|cell| self.cells[cell].iter().copied()).collect();
        near.sort_unstable();
        near.dedup();
        near.into_iter()
            .map(|index| self.boxes[index as usize])
            .filter(|(other, _)| item.meets(other))
            .map(|(_, layer)| layer)
    }

    fn cells_of(&self, item: &Box) -> impl Iterator<Item = usize> + use<> {
        let (low, high) = bounds(item.corners().into_iter());
        let rows = self.cells.len() / self.columns;
        let index =
            |x: f64, origin: f64, count: usize| (((x - origin) / CELL).floor().max(0.0) as usize).min(count - 1);
        let columns = self.columns;
        let (left, right) = (index(low.x, self.low.x, columns), index(high.x, self.low.x, columns));
        let (top, bottom) = (index(low.y, self.low.y, rows), index(high.y, self.low.y, rows));
        (top..=bottom).flat_map(move |row| (left..=right).map(move |column| row * columns + column))
    }
}

/// Upright places around `anchor`, nearest and towards `prefer` first, up to `reach` mm away. Places further than a
/// few millimetres get a leader from the anchor.
pub fn around(anchor: Point, prefer: Point, size: Point, gap: f64, reach: f64) -> Vec<Candidate> {
    const DIRECTIONS: usize = 16;
    let mut candidates = Vec::new();
    let mut distance = gap;
    while distance <= reach {
        for k in 0..DIRECTIONS {
            let direction = Point::unit(trig::TAU * k as f64 / DIRECTIONS as f64);
            // From the anchor to the box's near side, then half the box on.
            let half = (size.x / 2.0 * direction.x.abs()).max(size.y / 2.0 * direction.y.abs());
            let centre =
                anchor + direction * distance + Point::new(direction.x * size.x / 2.0, direction.y * size.y / 2.0);
            let turn = 1.0 - direction.dot(prefer);
            let leader = (distance > gap + 2.5).then(|| {
                let end = Point::new(
                    anchor.x.clamp(centre.x - size.x / 2.0, centre.x + size.x / 2.0),
                    anchor.y.clamp(centre.y - size.y / 2.0, centre.y + size.y / 2.0),
                );
                (anchor, end)
            });
            let cost = distance - gap + 3.0 * turn + 0.02 * half + if leader.is_some() { 3.0 } else { 0.0 };
            candidates.push(Candidate {
                boxes: vec![Box::upright(centre, size.x, size.y)],
                lines: Vec::new(),
                leader,
                cost,
            });
        }
        distance += if distance < gap + 4.0 { 1.0 } else { 3.0 };
    }
    candidates
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_boxes_meet_only_when_they_touch() {
        let a = Box::upright(Point::new(0.0, 0.0), 10.0, 2.0);
        let b = Box::line(Point::new(4.0, 4.0), Point::new(8.0, 0.5), 0.5);
        assert!(!a.meets(&b) && !b.meets(&a));
        assert!(a.meets(&Box::line(Point::new(0.0, 4.0), Point::new(6.0, -2.0), 0.5)));
    }

    #[test]
    fn crowded_labels_move_aside() {
        let mut field = Field::new(Point::new(-30.0, -30.0), Point::new(60.0, 30.0));
        field.add_line(Point::new(0.0, 0.0), Point::new(33.0, 0.0), 1.0, Layer::Solid);
        let mut placed: Vec<Box> = Vec::new();
        for k in 0..12 {
            // Wider than the way to the next anchor.
            let anchor = Point::new(3.0 * f64::from(k), 1.0);
            let candidates = around(anchor, Point::new(0.0, 1.0), Point::new(8.0, 3.0), 1.0, 60.0);
            let chosen = field.place(&candidates).expect("room");
            assert!(placed.iter().all(|other| !other.meets(&chosen.boxes[0])));
            placed.push(chosen.boxes[0]);
        }
        assert!(placed[0].centre.distance(Point::new(0.0, 3.5)) < 1e-9, "nearest and preferred first");
    }

    #[test]
    fn nothing_is_placed_where_nothing_is_free() {
        let mut field = Field::new(Point::new(0.0, 0.0), Point::new(10.0, 10.0));
        field.add(Box::upright(Point::new(5.0, 5.0), 9.0, 9.0), Layer::Label);
        assert!(
            field.place(&around(Point::new(5.0, 5.0), Point::new(1.0, 0.0), Point::new(3.0, 2.0), 1.0, 50.0)).is_none()
        );
    }
}
