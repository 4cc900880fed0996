//! Label placement on paper: oriented boxes in a grid of cells, and a greedy choice among candidates.

use crate::base::trig;
use crate::emit::paper::{PaperPoint, bounds};

/// What a box stands for, which decides who may cover it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Text and dimension lines: nothing covers them.
    Label,
    /// Symbols and the track's band: no label covers them.
    Solid,
    /// Hatching: no label covers it.
    Hatch,
    /// Leaders: no label covers them, and no other leader crosses them.
    Leader,
    /// Thin lines: covered when nothing better is free.
    Line,
}

/// A rectangle, turned; mm on paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperBox {
    pub centre: PaperPoint,
    /// Half its size along and across the axis.
    pub half: PaperPoint,
    /// Unit vector.
    pub axis: PaperPoint,
}

impl PaperBox {
    pub fn upright(centre: PaperPoint, width: f64, height: f64) -> Self {
        PaperBox { centre, half: PaperPoint::new(width / 2.0, height / 2.0), axis: PaperPoint::new(1.0, 0.0) }
    }

    /// A line from `a` to `b` of this thickness.
    pub fn line(a: PaperPoint, b: PaperPoint, thickness: f64) -> Self {
        let length = (b - a).dot(b - a).sqrt();
        let axis = if length > 0.0 { (b - a) * (1.0 / length) } else { PaperPoint::new(1.0, 0.0) };
        PaperBox { centre: a.lerp(b, 0.5), half: PaperPoint::new(length / 2.0, thickness / 2.0), axis }
    }

    pub fn corners(&self) -> [PaperPoint; 4] {
        let (u, v) = (self.axis * self.half.x, self.axis.across() * self.half.y);
        [self.centre + u + v, self.centre + u - v, self.centre - u - v, self.centre - u + v]
    }

    /// Smallest and largest coordinates.
    fn bounds(&self) -> (PaperPoint, PaperPoint) {
        let (u, v) = (self.axis * self.half.x, self.axis.across() * self.half.y);
        let reach = PaperPoint::new(u.x.abs() + v.x.abs(), u.y.abs() + v.y.abs());
        (self.centre - reach, self.centre + reach)
    }

    /// Separating axes of two rectangles.
    pub fn meets(&self, other: &PaperBox) -> bool {
        let between = other.centre - self.centre;
        [self.axis, self.axis.across(), other.axis, other.axis.across()].into_iter().all(|axis| {
            let reach = |b: &PaperBox| b.half.x * b.axis.dot(axis).abs() + b.half.y * b.axis.across().dot(axis).abs();
            between.dot(axis).abs() < reach(self) + reach(other)
        })
    }
}

/// Where a label may stand.
#[derive(Clone, Copy, Debug)]
pub struct LabelCandidate {
    pub text: PaperBox,
    /// A line that is as much in the way as the text: a dimension line.
    pub bar: Option<PaperBox>,
    /// Its extension lines, which may cross other lines and symbols at a cost.
    pub extensions: Option<[(PaperPoint, PaperPoint); 2]>,
    /// A thin line to what it names, which may cross the same.
    pub leader: Option<(PaperPoint, PaperPoint)>,
    /// Lower is better.
    pub cost: f64,
}

impl LabelCandidate {
    pub fn text(text: PaperBox, cost: f64) -> Self {
        LabelCandidate { text, bar: None, extensions: None, leader: None, cost }
    }

    fn boxes(&self) -> impl Iterator<Item = PaperBox> + use<> {
        std::iter::once(self.text).chain(self.bar)
    }
}

/// Taken places of a drawing area.
pub struct TakenPaper {
    low: PaperPoint,
    high: PaperPoint,
    columns: usize,
    cells: Vec<Vec<u32>>,
    boxes: Vec<Taken>,
    /// How many things took places.
    things: u32,
    /// Square millimetres, row by row, whose middle lies under a symbol, the band or a label: a quick answer to
    /// most candidates.
    covered: Vec<bool>,
    /// Millimetres in a row.
    width: usize,
}

struct Taken {
    item: PaperBox,
    layer: Layer,
    /// What it is a part of.
    thing: u32,
    low: PaperPoint,
    high: PaperPoint,
}

/// A leader while it grows.
struct Leader {
    anchor: PaperPoint,
    direction: PaperPoint,
    end: PaperPoint,
    /// Of what it has crossed.
    cost: f64,
}

/// Edge of a cell, mm.
const CELL: f64 = 8.0;
/// Costs of a candidate's box on a line, of its thin lines across a line, and across symbols or the band.
const ON_LINE: f64 = 12.0;
const THIN_ON_LINE: f64 = 1.0;
const THIN_ON_SOLID: f64 = 6.0;

impl TakenPaper {
    pub fn new(low: PaperPoint, high: PaperPoint) -> Self {
        let count = |length: f64| (length / CELL).ceil().max(1.0) as usize;
        let (columns, rows) = (count(high.x - low.x), count(high.y - low.y));
        let millimetres = |length: f64| length.ceil().max(1.0) as usize;
        let (width, height) = (millimetres(high.x - low.x), millimetres(high.y - low.y));
        let (cells, covered) = (vec![Vec::new(); columns * rows], vec![false; width * height]);
        TakenPaper { low, high, columns, cells, boxes: Vec::new(), things: 0, covered, width }
    }

    pub fn add(&mut self, item: PaperBox, layer: Layer) {
        self.things += 1;
        self.add_part(item, layer);
    }

    /// The inside of a closed outline, in strips of a millimetre.
    pub fn add_area(&mut self, outline: &[PaperPoint], layer: Layer) {
        const TALL: f64 = 1.0;
        let (low, high) = bounds(outline.iter().copied());
        let (low, high) = (low.y.max(self.low.y), high.y.min(self.high.y));
        self.things += 1;
        let mut y = low;
        while y < high {
            let tall = TALL.min(high - y);
            // A strip reaches as far as the outline does anywhere in it.
            let mut spans: Vec<(f64, f64)> = Vec::new();
            for at in [y + 1e-9, y + tall / 2.0, y + tall - 1e-9] {
                let mut cuts: Vec<f64> = (0..outline.len())
                    .filter_map(|i| {
                        let (a, b) = (outline[i], outline[(i + 1) % outline.len()]);
                        ((a.y > at) != (b.y > at)).then(|| a.x + (at - a.y) / (b.y - a.y) * (b.x - a.x))
                    })
                    .collect();
                cuts.sort_by(f64::total_cmp);
                spans.extend(cuts.chunks_exact(2).map(|pair| (pair[0], pair[1])));
            }
            for (from, to) in spans {
                let centre = PaperPoint::new((from + to) / 2.0, y + tall / 2.0);
                self.add_part(PaperBox::upright(centre, to - from, tall), layer);
            }
            y += tall;
        }
    }

    fn add_part(&mut self, item: PaperBox, layer: Layer) {
        let index = self.boxes.len() as u32;
        for cell in self.cells_of(&item) {
            self.cells[cell].push(index);
        }
        if !matches!(layer, Layer::Line | Layer::Leader) {
            self.cover(&item);
        }
        let (low, high) = item.bounds();
        self.boxes.push(Taken { item, layer, thing: self.things, low, high });
    }

    fn cover(&mut self, item: &PaperBox) {
        let (low, high) = item.bounds();
        let rows = self.covered.len() / self.width;
        let range = |from: f64, to: f64, count: usize| {
            (from.floor().max(0.0) as usize).min(count)..(to.ceil().max(0.0) as usize).min(count)
        };
        for row in range(low.y - self.low.y, high.y - self.low.y, rows) {
            for column in range(low.x - self.low.x, high.x - self.low.x, self.width) {
                let middle = self.low + PaperPoint::new(column as f64 + 0.5, row as f64 + 0.5) - item.centre;
                if middle.dot(item.axis).abs() < item.half.x && middle.dot(item.axis.across()).abs() < item.half.y {
                    self.covered[row * self.width + column] = true;
                }
            }
        }
    }

    /// Whether a place along the box's axis is covered. A box that is at least 1.5 mm wide contains the middles of
    /// the square millimetres there; nothing is said of narrower ones.
    fn is_covered(&self, item: &PaperBox) -> bool {
        // Half a diagonal of a square millimetre.
        const INSET: f64 = 0.75;
        let reach = item.half.x - INSET;
        if reach < 0.0 || item.half.y < INSET {
            return false;
        }
        [0.0, -1.0, 1.0, -0.5, 0.5, -0.25, 0.25, -0.75, 0.75].into_iter().any(|k| {
            let p = item.centre + item.axis * (k * reach) - self.low;
            p.x >= 0.0
                && p.y >= 0.0
                && p.x < self.width as f64
                && self.covered.get(p.y as usize * self.width + p.x as usize).is_some_and(|covered| *covered)
        })
    }

    /// A line, in parts that are not much longer than a cell.
    pub fn add_line(&mut self, a: PaperPoint, b: PaperPoint, thickness: f64, layer: Layer) {
        let parts = (a.distance(b) / (2.0 * CELL)).ceil().clamp(1.0, 1000.0) as usize;
        for i in 0..parts {
            let at = |k: usize| a.lerp(b, k as f64 / parts as f64);
            self.add(PaperBox::line(at(i), at(i + 1), thickness), layer);
        }
    }

    /// Takes the cheapest free candidate; among equals the first.
    pub fn place(&mut self, candidates: &[LabelCandidate]) -> Option<LabelCandidate> {
        let mut order: Vec<&LabelCandidate> = candidates.iter().collect();
        order.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let mut best: Option<(f64, LabelCandidate)> = None;
        for candidate in order {
            let most = best.map_or(f64::INFINITY, |(cost, _)| cost);
            if candidate.cost >= most {
                break;
            }
            if let Some(extra) = self.extra_cost(candidate)
                && candidate.cost + extra < most
            {
                best = Some((candidate.cost + extra, *candidate));
            }
        }
        best.map(|(_, chosen)| self.take(chosen))
    }

    /// An upright text of this size with a leader from one of the anchors, as near as it finds room.
    pub fn place_afar(&mut self, anchors: &[PaperPoint], size: PaperPoint) -> Option<LabelCandidate> {
        const FARTHEST: f64 = 60.0;
        let directions = directions::<40>();
        // Leaders grow ring by ring; one that a label blocks stays blocked further out.
        let mut open: Vec<Leader> = anchors
            .iter()
            .flat_map(|anchor| {
                directions.map(|direction| Leader { anchor: *anchor, direction, end: *anchor, cost: 0.0 })
            })
            .collect();
        let mut best: Option<(f64, LabelCandidate)> = None;
        let mut distance = 4.0;
        while distance < FARTHEST && best.is_none_or(|(cost, _)| distance < cost) {
            open.retain_mut(|leader| {
                let end = leader.anchor + leader.direction * distance;
                let Some(crossed) = self.crossed(leader.end, end, true) else { return false };
                (leader.end, leader.cost) = (end, leader.cost + crossed);
                let half = PaperPoint::new(leader.direction.x * size.x / 2.0, leader.direction.y * size.y / 2.0);
                let text = LabelCandidate::text(PaperBox::upright(end + half, size.x, size.y), distance + leader.cost);
                let least = best.map_or(f64::INFINITY, |(cost, _)| cost);
                if text.cost < least
                    && let Some(extra) = self.extra_cost(&text)
                    && text.cost + extra < least
                {
                    let near = entry(leader.anchor, end, &text.text);
                    best = Some((text.cost + extra, LabelCandidate { leader: Some((leader.anchor, near)), ..text }));
                }
                text.cost < least
            });
            distance *= 1.35;
        }
        best.map(|(_, chosen)| self.take(chosen))
    }

    fn take(&mut self, chosen: LabelCandidate) -> LabelCandidate {
        for item in chosen.boxes() {
            self.add(item, Layer::Label);
        }
        for (a, b) in chosen.extensions.into_iter().flatten() {
            self.add_line(a, b, 0.3, Layer::Line);
        }
        if let Some((a, b)) = chosen.leader {
            self.add_line(a, b, 0.3, Layer::Leader);
        }
        chosen
    }

    fn extra_cost(&self, candidate: &LabelCandidate) -> Option<f64> {
        let mut cost = 0.0;
        for item in candidate.boxes() {
            if !self.within(&item) || self.is_covered(&item) {
                return None;
            }
            cost += ON_LINE * self.under(&item, |layer| layer != Layer::Line)?.len() as f64;
        }
        for (a, b) in candidate.extensions.into_iter().flatten() {
            cost += self.crossed(a, b, false)?;
        }
        if let Some((a, b)) = candidate.leader {
            cost += self.crossed(a, b, true)?;
        }
        Some(cost)
    }

    /// What a thin line costs by all it crosses; `None` when that is a label or, of a leader, another leader.
    fn crossed(&self, a: PaperPoint, b: PaperPoint, leader: bool) -> Option<f64> {
        let forbids = |layer| layer == Layer::Label || leader && layer == Layer::Leader;
        let layers = self.under(&PaperBox::line(a, b, 0.3), forbids)?;
        Some(layers.into_iter().map(|layer| if layer == Layer::Line { THIN_ON_LINE } else { THIN_ON_SOLID }).sum())
    }

    fn within(&self, item: &PaperBox) -> bool {
        let (low, high) = item.bounds();
        low.x >= self.low.x && low.y >= self.low.y && high.x <= self.high.x && high.y <= self.high.y
    }

    /// Layers of the boxes that this one meets; `None` as soon as one of them forbids it.
    fn under(&self, item: &PaperBox, forbids: impl Fn(Layer) -> bool) -> Option<Vec<Layer>> {
        let (low, high) = item.bounds();
        let mut met: Vec<(u32, Layer)> = Vec::new();
        for cell in self.cells_of(item) {
            for &index in &self.cells[cell] {
                let taken = &self.boxes[index as usize];
                let apart =
                    taken.low.x > high.x || taken.high.x < low.x || taken.low.y > high.y || taken.high.y < low.y;
                // A thing of several parts, or in several cells, counts once.
                let found = (taken.thing, taken.layer);
                if !apart && item.meets(&taken.item) && !met.contains(&found) {
                    if forbids(taken.layer) {
                        return None;
                    }
                    met.push(found);
                }
            }
        }
        Some(met.into_iter().map(|(_, layer)| layer).collect())
    }

    fn cells_of(&self, item: &PaperBox) -> impl Iterator<Item = usize> + use<> {
        let (low, high) = item.bounds();
        let rows = self.cells.len() / self.columns;
        let index =
            |x: f64, origin: f64, count: usize| (((x - origin) / CELL).floor().max(0.0) as usize).min(count - 1);
        let columns = self.columns;
        let (left, right) = (index(low.x, self.low.x, columns), index(high.x, self.low.x, columns));
        let (top, bottom) = (index(low.y, self.low.y, rows), index(high.y, self.low.y, rows));
        (top..=bottom).flat_map(move |row| (left..=right).map(move |column| row * columns + column))
    }
}

/// Where the way from `from` to `to`, which lies in the upright box, comes into it.
fn entry(from: PaperPoint, to: PaperPoint, item: &PaperBox) -> PaperPoint {
    let (low, high) = item.bounds();
    let along = |from: f64, way: f64, low: f64, high: f64| match way {
        _ if way > 0.0 => (low - from) / way,
        _ if way < 0.0 => (high - from) / way,
        _ => 0.0,
    };
    let way = to - from;
    let t = along(from.x, way.x, low.x, high.x).max(along(from.y, way.y, low.y, high.y));
    from.lerp(to, t.clamp(0.0, 1.0))
}

/// Unit vectors in `N` directions.
fn directions<const N: usize>() -> [PaperPoint; N] {
    std::array::from_fn(|k| PaperPoint::unit(trig::TAU * k as f64 / N as f64))
}

/// Upright places around `anchor`, nearest and towards `prefer` first, up to `reach` mm away. Places further than a
/// few millimetres get a leader from the anchor.
pub fn around(anchor: PaperPoint, prefer: PaperPoint, size: PaperPoint, gap: f64, reach: f64) -> Vec<LabelCandidate> {
    let directions = directions::<16>();
    let mut candidates = Vec::new();
    let mut distance = gap;
    while distance <= reach {
        for direction in directions {
            let half = PaperPoint::new(direction.x * size.x / 2.0, direction.y * size.y / 2.0);
            let centre = anchor + direction * distance + half;
            let text = PaperBox::upright(centre, size.x, size.y);
            let leader = (distance > gap + 2.5).then(|| {
                let (low, high) = text.bounds();
                (anchor, PaperPoint::new(anchor.x.clamp(low.x, high.x), anchor.y.clamp(low.y, high.y)))
            });
            let turn = 1.0 - direction.dot(prefer);
            let cost = distance - gap + 3.0 * turn + if leader.is_some() { 3.0 } else { 0.0 };
            candidates.push(LabelCandidate { leader, ..LabelCandidate::text(text, cost) });
        }
        distance += if distance < gap + 4.0 { 1.0 } else { 4.0 };
    }
    candidates
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_boxes_meet_only_when_they_touch() {
        let a = PaperBox::upright(PaperPoint::new(0.0, 0.0), 10.0, 2.0);
        let b = PaperBox::line(PaperPoint::new(4.0, 4.0), PaperPoint::new(8.0, 0.5), 0.5);
        assert!(!a.meets(&b) && !b.meets(&a));
        assert!(a.meets(&PaperBox::line(PaperPoint::new(0.0, 4.0), PaperPoint::new(6.0, -2.0), 0.5)));
    }

    #[test]
    fn crowded_labels_move_aside() {
        let mut field = TakenPaper::new(PaperPoint::new(-30.0, -30.0), PaperPoint::new(60.0, 30.0));
        field.add_line(PaperPoint::new(0.0, 0.0), PaperPoint::new(33.0, 0.0), 1.0, Layer::Solid);
        let mut placed: Vec<PaperBox> = Vec::new();
        for k in 0..12 {
            // Wider than the way to the next anchor.
            let anchor = PaperPoint::new(3.0 * f64::from(k), 1.0);
            let candidates = around(anchor, PaperPoint::new(0.0, 1.0), PaperPoint::new(8.0, 3.0), 1.0, 60.0);
            let chosen = field.place(&candidates).expect("room");
            assert!(placed.iter().all(|other| !other.meets(&chosen.text)));
            placed.push(chosen.text);
        }
        assert!(placed[0].centre.distance(PaperPoint::new(0.0, 3.5)) < 1e-9, "nearest and preferred first");
    }

    #[test]
    fn what_is_covered_is_met() {
        let mut field = TakenPaper::new(PaperPoint::new(-5.0, 3.0), PaperPoint::new(95.0, 83.0));
        let turned = |k: usize, half: PaperPoint| PaperBox {
            centre: PaperPoint::new((k * 37 % 90) as f64, 5.0 + (k * 53 % 76) as f64),
            half,
            axis: PaperPoint::unit(k as f64),
        };
        for k in 0..30 {
            field.add(turned(k, PaperPoint::new(6.0, 1.2)), Layer::Solid);
        }
        let mut covered = 0;
        for k in 100..1100 {
            let item = turned(k, PaperPoint::new(4.0, 1.5));
            if field.is_covered(&item) {
                covered += 1;
                assert!(field.boxes.iter().any(|taken| taken.item.meets(&item)), "{item:?}");
            }
        }
        assert!(covered > 100, "{covered}");
    }

    #[test]
    fn leaders_do_not_cross_and_hatching_stays_free() {
        let p = PaperPoint::new;
        let mut field = TakenPaper::new(p(-40.0, -40.0), p(40.0, 40.0));
        // A triangle, whose slanted side runs through the strips.
        let hatched = [p(-20.0, -10.0), p(20.0, -10.0), p(0.0, 25.0)];
        field.add_area(&hatched, Layer::Hatch);
        let mut chosen = Vec::new();
        for k in 0..14 {
            let anchor = p(-13.0 + 2.0 * f64::from(k), -4.0);
            chosen.extend(field.place_afar(&[anchor], p(9.0, 3.0)));
        }
        assert!(chosen.len() > 8, "{}", chosen.len());
        let inside =
            |q: PaperPoint| (0..3).all(|i| (hatched[(i + 1) % 3] - hatched[i]).across().dot(q - hatched[i]) > 1e-6);
        for (i, label) in chosen.iter().enumerate() {
            for k in 0..200 {
                let (u, v) = (f64::from(k % 20) / 10.0 - 0.95, f64::from(k / 20) / 5.0 - 0.9);
                let at = label.text.centre + p(u * label.text.half.x, v * label.text.half.y);
                assert!(!inside(at), "{at:?}");
            }
            // Leaders end at their own text.
            if let Some((a, b)) = label.leader {
                assert!(!label.text.meets(&PaperBox::line(a, a.lerp(b, 0.99), 0.0)), "{label:?}");
            }
            let line = |label: &LabelCandidate| label.leader.map(|(a, b)| PaperBox::line(a, b, 0.1));
            for other in &chosen[..i] {
                if let (Some(a), Some(b)) = (line(label), line(other)) {
                    assert!(!a.meets(&b), "{a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn nothing_is_placed_where_nothing_is_free() {
        let mut field = TakenPaper::new(PaperPoint::new(0.0, 0.0), PaperPoint::new(10.0, 10.0));
        field.add(PaperBox::upright(PaperPoint::new(5.0, 5.0), 9.0, 9.0), Layer::Label);
        assert!(
            field
                .place(&around(
                    PaperPoint::new(5.0, 5.0),
                    PaperPoint::new(1.0, 0.0),
                    PaperPoint::new(3.0, 2.0),
                    1.0,
                    50.0
                ))
                .is_none()
        );
    }
}
