//! What is written beside the track: dimensions, radii, names, articles. Every label has candidates; the greedy
//! choice of [`place`](super::place) keeps them off each other and off the track.

use crate::base::trig;
use crate::elements::{OrderedPiece, Part};
use crate::emit::paper::{PaperPoint, Projection};
use crate::emit::plan::{self, Climb, Mark, MarkKind, WallDistance};
use crate::geometry::{PieceKind, Point, Track};
use crate::model::{Layout, Obstacle};

use super::decimals::Decimals;
use super::obstacles::{self, ObstacleName};
use super::place::{LabelCandidate, PaperBox, TakenPaper, around};
use super::setting_out;
use super::sheet::{Sheet, path, path_line, reading_angle};
use super::symbol;
use super::text::{self, Height};
use super::track::{fixed_sections, is_fixed_radius, is_fixed_vertex, spot};
use super::xml::XmlElement;
use crate::base::number::fixed;

/// How far a label goes from what it names while there is room, mm.
const REACH: f64 = 24.0;
/// Room left and right of a text together, mm.
const PADDING: f64 = 1.6;
/// Cost from which a place is taken only when no other is free, not even far away: beside another piece, without a
/// leader.
const LAST: f64 = 1000.0;
/// Longest text of a label, mm; longer names are cut.
const LONGEST: f64 = 70.0;

/// A drawing's labels while they are placed.
pub struct Labels<'a> {
    sheet: &'a Sheet,
    track: &'a Track,
    layout: &'a Layout,
    field: TakenPaper,
    group: XmlElement,
    decimals: Decimals,
    /// Labels that found no place, each with where it belongs.
    pub omitted: Vec<String>,
}

impl<'a> Labels<'a> {
    pub fn new(sheet: &'a Sheet, track: &'a Track, layout: &'a Layout, field: TakenPaper, decimals: Decimals) -> Self {
        Labels { sheet, track, layout, field, group: XmlElement::group("labels"), decimals, omitted: Vec::new() }
    }

    pub fn finish(self) -> XmlElement {
        self.group
    }

    /// Places a text at one of its candidates or, where none is free, further away with a leader from an anchor.
    fn put(&mut self, text: &str, height: Height, class: &str, candidates: &[LabelCandidate], anchors: &[PaperPoint]) {
        let size = candidates.first().map_or(PaperPoint::default(), |candidate| candidate.text.half * 2.0);
        let (near, last): (Vec<LabelCandidate>, Vec<LabelCandidate>) = candidates.iter().partition(|c| c.cost < LAST);
        let place = self.field.place(&near).or_else(|| self.field.place_afar(anchors, size));
        let place = place.or_else(|| self.field.place(&last));
        let Some(chosen) = place else {
            self.omit(text, anchors.first().copied().unwrap_or_default());
            return;
        };
        if let Some((a, b)) = chosen.leader {
            self.group.push(path(&path_line(a, b), "leader"));
        }
        let class = format!("halo {class}");
        let angle = reading_angle(chosen.text.axis);
        self.group.push(text::centred(chosen.text.centre, angle, text, height, class.trim()));
    }

    /// Keeps a label without room for the list of those, with where it belongs.
    fn omit(&mut self, text: &str, anchor: PaperPoint) {
        let at = plan::from_origin(self.layout, self.sheet.floor(anchor));
        self.omitted.push(format!("{text} at ({}, {})", fixed(at.x, 1), fixed(at.y, 1)));
    }

    /// The name of an obstacle in which it has no room.
    pub fn obstacle(&mut self, obstacle: &Obstacle, name: &ObstacleName) {
        if let Some(inside) = name.inside {
            self.group.push(text::centred(inside.centre, 0.0, &name.text, Height::H25, ""));
            return;
        }
        let (candidates, anchors) = obstacles::beside(self.sheet, obstacle, name);
        self.put(&name.text, Height::H25, "", &candidates, &anchors);
    }

    /// How far the centre line lies from a wall.
    pub fn wall(&mut self, wall: &WallDistance) {
        let least = if wall.least { " min" } else { "" };
        let text = format!("{}{least}", Decimals::text(wall.distance, self.decimals.wall));
        let half = self.sheet.mm(self.layout.width.value) / 2.0;
        let candidates = setting_out::wall_candidates(self.sheet, wall, half, extent(&text, Height::H25));
        let boxes: Vec<LabelCandidate> = candidates.iter().map(|(candidate, _)| *candidate).collect();
        let chosen = self.field.place(&boxes);
        let ends =
            chosen.and_then(|chosen| candidates.iter().find(|(c, _)| c.text == chosen.text && c.bar == chosen.bar));
        let (Some(chosen), Some((_, [from, to]))) = (chosen, ends) else {
            self.omit(&format!("{text} to the wall"), self.sheet.at(wall.track.0.lerp(wall.track.1, 0.5)));
            return;
        };
        let length = from.distance(*to);
        let along = (*to - *from) * (1.0 / length);
        self.group.push(path(&path_line(*from, *to), "dimension"));
        if length > 6.5 {
            let heads = symbol::arrow(*to, along, 2.5, 0.9) + &symbol::arrow(*from, -along, 2.5, 0.9);
            self.group.push(path(&heads, "dimension-arrow"));
        } else {
            // No room for arrows: strokes across the ends.
            let across = (along + along.across()) * 0.7;
            let strokes = path_line(*from - across, *from + across) + &path_line(*to - across, *to + across);
            self.group.push(path(&strokes, "rule"));
        }
        if let Some((a, b)) = chosen.leader {
            self.group.push(path(&path_line(a, b), "leader"));
        }
        let angle = reading_angle(chosen.text.axis);
        self.group.push(text::centred(chosen.text.centre, angle, &text, Height::H25, "halo"));
    }

    /// The length of a straight, as a dimension line where there is room for one, and its heading unless it lies
    /// along an axis.
    pub fn straight(&mut self, section: usize) {
        let piece = *self.track.straight(section);
        if piece.length.abs() < 1e-9 {
            return;
        }
        let degrees = piece.heading * 180.0 / trig::PI;
        let off_axis = (degrees / 90.0 - (degrees / 90.0).round()).abs() > 1e-7;
        let heading =
            if off_axis { format!(" ∠ {}°", Decimals::text(degrees, self.decimals.heading)) } else { String::new() };
        let text = format!("{}{heading}", Decimals::text(piece.length, self.decimals.length));
        let size = extent(&text, Height::H25);
        let (a, b) = (self.sheet.at(piece.begin), self.sheet.at(piece.end));
        let length = self.sheet.mm(piece.length);
        let along = Projection::direction(piece.heading);
        let half = self.sheet.mm(self.layout.width.value) / 2.0;
        let out = self.out(piece.heading);
        if length > size.x + 3.0 {
            let candidates = dimension_candidates(a, b, along, out, half, size);
            if let Some(chosen) = self.field.place(&candidates) {
                self.draw_dimension(&chosen, a, b, along, &text);
                return;
            }
        }
        let middle = a.lerp(b, 0.5);
        let mut candidates = Vec::new();
        for side in [out, -out] {
            let anchor = middle + side * half;
            candidates.extend(beside(anchor, along, side, size, 1.0));
            candidates.extend(around(anchor, side, size, 1.0, REACH));
        }
        self.put(&text, Height::H25, "", &candidates, &[middle + out * half, middle - out * half]);
    }

    fn draw_dimension(&mut self, chosen: &LabelCandidate, a: PaperPoint, b: PaperPoint, along: PaperPoint, text: &str) {
        let Some(line) = chosen.bar else { return };
        let across = line.centre - a.lerp(b, 0.5);
        let (from, to) = (a + across, b + across);
        let side = across * (1.0 / across.norm());
        let half = self.sheet.mm(self.layout.width.value) / 2.0;
        let extension = |p: PaperPoint, end: PaperPoint| path_line(p + side * (half + 1.0), end + side * 1.2);
        self.group.push(path(&(path_line(from, to) + &extension(a, from) + &extension(b, to)), "dimension"));
        let heads = symbol::arrow(to, along, 2.5, 0.9) + &symbol::arrow(from, -along, 2.5, 0.9);
        self.group.push(path(&heads, "dimension-arrow"));
        let place = &chosen.text;
        self.group.push(text::centred(place.centre, reading_angle(place.axis), text, Height::H25, "halo"));
    }

    /// Radius and turn of a vertex' curve.
    pub fn curve(&mut self, vertex: usize, spiral: bool) {
        let fillet = self.track.fillets[vertex];
        let turn = Decimals::text(fillet.turn.abs() * 180.0 / trig::PI, self.decimals.turn);
        let fix = if is_fixed_radius(self.layout, vertex) { " fix" } else { "" };
        let what = if spiral { "spiral " } else { "" };
        let text = format!("{what}R{}{fix} {turn}°", Decimals::text(fillet.radius, self.decimals.radius));
        let size = extent(&text, Height::H25);
        let half = self.layout.width.value / 2.0;
        let outward = (self.track.corners[vertex].point - fillet.centre).heading();
        let (mut candidates, mut anchors) = (Vec::new(), Vec::new());
        // Inside the bend first: outside stand the vertex and its name.
        for (side, cost, shifts) in [(-1.0, 0.0, &[0.0, -0.25, 0.25][..]), (1.0, 2.0, &[0.0])] {
            for shift in shifts {
                let angle = outward + shift * fillet.turn;
                let reach = (fillet.radius + side * half).max(0.0);
                let anchor = self.sheet.at(fillet.centre + Point::unit(angle) * reach);
                let prefer = Projection::direction(angle) * side;
                if *shift == 0.0 {
                    anchors.push(anchor);
                }
                let near = if *shift == 0.0 && side < 0.0 { REACH } else { REACH / 3.0 };
                for mut candidate in around(anchor, prefer, size, 1.0, near) {
                    candidate.cost += cost + 2.0 * shift.abs();
                    candidates.push(candidate);
                }
            }
        }
        self.put(&text, Height::H25, "", &candidates, &anchors);
    }

    pub fn vertex(&mut self, vertex: usize) {
        let Some(item) = self.layout.vertices.get(vertex) else { return };
        let name = text::fitted(&item.name, Height::H25, true, LONGEST);
        let size =
            PaperPoint::new(text::width(&name, Height::H25.size(), true) + PADDING, extent(&name, Height::H25).y);
        let fillet = self.track.fillets[vertex];
        let out = self.track.corners[vertex].point - fillet.centre;
        let prefer = Projection::direction(out.heading());
        let anchor = self.sheet.at(self.track.corners[vertex].point);
        let candidates = around(anchor, prefer, size, 2.2, REACH);
        let class = if is_fixed_vertex(self.layout, vertex) { "bold fixed-text" } else { "bold" };
        self.put(&name, Height::H25, class, &candidates, &[anchor]);
    }

    pub fn mark(&mut self, mark: &Mark) {
        let Some(label) = &mark.label else { return };
        let (class, height) = match mark.kind {
            MarkKind::Start => ("bold", Height::H18),
            MarkKind::Photocell => ("photocell-text", Height::H18),
            MarkKind::Induction => ("induction-text", Height::H25),
            MarkKind::Chute => ("chute-text", Height::H25),
            MarkKind::Station => ("photocell-text", Height::H18),
            MarkKind::Motor | MarkKind::Support => ("motor-text", Height::H18),
        };
        let text = text::fitted(label, height, false, LONGEST);
        let bold = class == "bold";
        let size = PaperPoint::new(text::width(&text, height.size(), bold) + PADDING, extent(&text, height).y);
        let middle = Mark { s: mark.s + mark.length / 2.0, ..mark.clone() };
        let (point, heading) = self.track.at(middle.s);
        let spot = spot(self.sheet, self.track, &Mark { point, heading, ..middle }, self.layout.width.value);
        let (mut candidates, mut anchors) = (Vec::new(), Vec::new());
        for (side, cost) in [(1.0, 0.0), (-1.0, 1.5)] {
            let rise = match mark.kind {
                _ if !mark.covers.is_empty() => super::track::reach(self.sheet, mark, &spot),
                MarkKind::Induction => 4.8,
                MarkKind::Chute => 3.8,
                MarkKind::Start => 2.5,
                MarkKind::Photocell => 3.7,
                MarkKind::Station => 3.5,
                MarkKind::Motor | MarkKind::Support => 0.3,
            };
            // The symbol of these stands on one side only.
            if side < 0.0 && matches!(mark.kind, MarkKind::Induction | MarkKind::Chute | MarkKind::Station) {
                continue;
            }
            let anchor = spot.at + spot.out * (side * (spot.half + rise));
            anchors.push(anchor);
            for mut candidate in around(anchor, spot.out * side, size, 0.6, REACH) {
                candidate.cost += cost;
                candidates.push(candidate);
            }
        }
        self.put(&text, height, class, &candidates, &anchors);
    }

    /// Words beside the fixed sections.
    pub fn fixes(&mut self) {
        for (section, text) in fixed_sections(self.layout) {
            let piece = *self.track.straight(section);
            let at = piece.at(piece.length.max(0.0) / 2.0).0;
            self.beside_track(at, piece.heading, &text, "fixed-text", true);
        }
    }

    /// Slope and heights of a climb, or the height of a level.
    pub fn climb(&mut self, climb: &Climb) {
        let (at, heading) = self.track.at(climb.middle.rem_euclid(self.track.length));
        self.beside_track(
            at,
            heading,
            &climb.text(self.decimals.slope, self.decimals.height),
            "climb-text",
            !climb.spiral,
        );
    }

    /// One label for each run of like pieces, on turns or elsewhere: how many of which article. The bill counts the
    /// same pieces.
    pub fn runs(&mut self, pieces: &[OrderedPiece], turns: bool) {
        let n = pieces.len();
        // Begin where an article begins, so that no run is cut at the end of the list.
        let first = (0..n).find(|&i| !same_run(&pieces[(i + n - 1) % n], &pieces[i])).unwrap_or(0);
        let mut i = 0;
        while i < n {
            let head = &pieces[(first + i) % n];
            let mut count = 1;
            while i + count < n && same_run(head, &pieces[(first + i + count) % n]) {
                count += 1;
            }
            i += count;
            if head.turns() != turns {
                continue;
            }
            let run: f64 = (0..count).map(|k| pieces[(first + i - count + k) % n].place.run).sum();
            let (at, heading) = self.track.at((head.place.s + run / 2.0).rem_euclid(self.track.length));
            let text = if count == 1 { head.article.clone() } else { format!("{count}× {}", head.article) };
            let class = if head.in_catalog { "quiet" } else { "warn" };
            let text = text::fitted(&text, Height::H18, false, LONGEST);
            self.beside_track(at, heading, &text, class, !turns);
        }
    }

    /// A small text near a place of the track, along it where that is straight.
    fn beside_track(&mut self, at: Point, heading: f64, text: &str, class: &str, straight: bool) {
        let height = Height::H18;
        let size = extent(text, height);
        let half = self.sheet.mm(self.layout.width.value) / 2.0;
        let (along, out) = (Projection::direction(heading), self.out(heading));
        let (mut candidates, mut anchors) = (Vec::new(), Vec::new());
        // Inside the loop first: dimensions stand outside.
        for (side, cost) in [(-out, 0.0), (out, 0.5)] {
            let anchor = self.sheet.at(at) + side * half;
            anchors.push(anchor);
            let turned = if straight { beside(anchor, along, side, size, 0.8) } else { Vec::new() };
            let all = turned.into_iter().chain(around(anchor, side, size, 1.0, REACH));
            candidates.extend(all.map(|candidate| LabelCandidate { cost: candidate.cost + cost, ..candidate }));
        }
        self.put(text, height, class, &candidates, &anchors);
    }

    /// Unit vector on paper out of the loop, across this heading.
    fn out(&self, heading: f64) -> PaperPoint {
        Projection::direction(heading - plan::winding(self.track) * trig::FRAC_PI_2)
    }
}

fn same_run(a: &OrderedPiece, b: &OrderedPiece) -> bool {
    a.article == b.article && a.place.vertex == b.place.vertex && a.turns() == b.turns()
}

/// Width and height of a label's box, mm.
fn extent(text: &str, height: Height) -> PaperPoint {
    PaperPoint::new(text::width(text, height.size(), false) + PADDING, 1.24 * height.size())
}

/// Text along the track, beside it, shifted by up to a text's length either way. Places further than a few millimetres
/// get a leader from the anchor.
fn beside(anchor: PaperPoint, along: PaperPoint, side: PaperPoint, size: PaperPoint, gap: f64) -> Vec<LabelCandidate> {
    let mut candidates = Vec::new();
    for row in 0..3 {
        for shift in [0.0, 0.25, -0.25, 0.5, -0.5, 0.8, -0.8] {
            let across = gap + size.y * (0.5 + f64::from(row));
            let centre = anchor + side * across + along * (shift * size.x);
            let item = PaperBox { centre, half: size * 0.5, axis: along };
            // The nearest point of the text.
            let aside = (-shift * size.x).clamp(-size.x / 2.0, size.x / 2.0);
            let near = centre + along * aside - side * (size.y / 2.0);
            let leader = (near.distance(anchor) > gap + 2.5).then_some((anchor, near));
            let cost = 2.0 * shift.abs() + 4.0 * f64::from(row);
            if leader.is_some() {
                candidates.push(LabelCandidate { leader, ..LabelCandidate::text(item, cost + 3.0) });
            }
            candidates.push(LabelCandidate::text(item, if leader.is_some() { cost + LAST } else { cost }));
        }
    }
    candidates
}

/// Dimension lines parallel to a straight: text above the line, the line with its arrows, two extension lines.
fn dimension_candidates(
    a: PaperPoint,
    b: PaperPoint,
    along: PaperPoint,
    out: PaperPoint,
    half: f64,
    size: PaperPoint,
) -> Vec<LabelCandidate> {
    let angle = reading_angle(along) * trig::PI / 180.0;
    // Above the line as the text reads.
    let up = PaperPoint::new(trig::sin(angle), -trig::cos(angle));
    let mut candidates = Vec::new();
    for (side, side_cost) in [(out, 0.0), (-out, 1.0)] {
        for step in 0..6 {
            let offset = 6.5 + 4.5 * f64::from(step);
            let across = side * (half + offset);
            let line = PaperBox::line(a + across, b + across, 1.0);
            for shift in [0.0, 0.3, -0.3] {
                let room = (line.half.x - size.x / 2.0 - 2.5).max(0.0);
                let centre = line.centre + up * (size.y / 2.0 + 0.2) + along * (shift * 2.0 * room);
                let text = PaperBox { centre, half: size * 0.5, axis: along };
                let cost = side_cost + 3.0 * f64::from(step) + shift.abs();
                let extension = |p: PaperPoint| (p + side * (half + 1.0), p + across + side * 1.2);
                let extensions = Some([extension(a), extension(b)]);
                candidates.push(LabelCandidate { text, bar: Some(line), extensions, leader: None, cost });
            }
        }
    }
    candidates
}

/// What labels are for.
pub struct Labelled<'a> {
    pub pieces: &'a [OrderedPiece],
    pub marks: &'a [Mark],
    pub climbs: &'a [Climb],
    pub walls: &'a [WallDistance],
    pub obstacles: &'a [ObstacleName],
}

/// Every label of a drawing, the most wanted first.
pub fn all(labels: &mut Labels, labelled: &Labelled) {
    let Labelled { pieces, marks, climbs, walls, obstacles } = *labelled;
    let layout = labels.layout;
    for (obstacle, name) in layout.obstacles.iter().zip(obstacles) {
        labels.obstacle(obstacle, name);
    }
    walls.iter().for_each(|wall| labels.wall(wall));
    for mark in marks.iter().filter(|mark| !matches!(mark.kind, MarkKind::Motor)) {
        labels.mark(mark);
    }
    climbs.iter().for_each(|climb| labels.climb(climb));
    let n = labels.track.corners.len();
    (0..n).for_each(|i| labels.straight(i));
    let curved = |piece: &&crate::geometry::Piece| matches!(piece.kind, PieceKind::Arc { .. }) && piece.length > 1e-9;
    let vertices: Vec<usize> = labels.track.pieces.iter().filter(curved).map(|piece| piece.vertex).collect();
    let spiral = |i: usize| pieces.iter().any(|p| p.place.vertex == i && matches!(p.part, Part::Spiral { .. }));
    vertices.into_iter().for_each(|i| labels.curve(i, spiral(i)));
    (0..n).for_each(|i| labels.vertex(i));
    // Curves are short: their articles have less choice than those of the straights.
    labels.runs(pieces, true);
    labels.fixes();
    for mark in marks.iter().filter(|mark| mark.kind == MarkKind::Motor) {
        labels.mark(mark);
    }
    labels.runs(pieces, false);
}
