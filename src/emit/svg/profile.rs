//! The height profile under the plan: height over arc length, with levels, slopes and vertices.

use super::decimals::needed;
use super::sheet::{PaperArea, Sheet, coordinates, path, path_line, rectangle};
use super::text::{self, Height};
use super::xml::XmlElement;
use crate::base::number::{fixed, trimmed};
use crate::base::trig;
use crate::compiled::Compiled;
use crate::emit::paper::PaperPoint;
use crate::geometry::Form;

/// Height of the profile on paper, mm.
const TALL: f64 = 44.0;
/// Room around the chart for its labels, mm: left, top, right, bottom.
const ROOM: (f64, f64, f64, f64) = (16.0, 13.0, 10.0, 8.0);
/// Least distance of labels under and over the chart, mm.
const APART: f64 = 13.0;
/// Points on a vertical curve.
const ROUND: usize = 8;

/// What the profile takes from the drawing area, mm; nothing where the track lies on one level.
pub fn height(compiled: &Compiled) -> f64 {
    if compiled.layout.is_flat() { 0.0 } else { TALL }
}

/// From arc length (m, from the layout's start) and height (m) to paper.
struct Chart {
    area: PaperArea,
    /// mm a metre of arc length and of height.
    along: f64,
    up: f64,
    /// Height of the base line, m.
    base: f64,
    length: f64,
}

impl Chart {
    fn new(sheet: &Sheet, length: f64, (low, high): (f64, f64)) -> Self {
        let (left, top, right, bottom) = ROOM;
        let area = PaperArea {
            low: sheet.profile.low + PaperPoint::new(left, top),
            high: sheet.profile.high - PaperPoint::new(right, bottom),
        };
        // From the floor, if that is not far below.
        let base = if low > 0.0 && low <= 2.0 * (high - low) { 0.0 } else { low };
        let along = area.width() / length;
        let most = area.height() / ((high - base) * along);
        let ratio = if most >= 1.0 { most.floor() } else { (100.0 * most).floor().max(1.0) / 100.0 };
        Chart { area, along, up: along * ratio, base, length }
    }

    fn at(&self, s: f64, z: f64) -> PaperPoint {
        PaperPoint::new(self.area.low.x + self.along * s, self.area.high.y - self.up * (z - self.base))
    }

    /// How much taller than long a metre is drawn.
    fn ratio(&self) -> f64 {
        self.up / self.along
    }
}

/// The profile of a layout with levels.
pub fn profile(sheet: &Sheet, compiled: &Compiled) -> XmlElement {
    let points = points(compiled);
    let heights = points.iter().map(|p| p.1);
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
    let chart = Chart::new(sheet, compiled.length(), (low, high));
    let mut group = XmlElement::group("profile").with(rectangle(sheet.profile.low, sheet.profile.high, "rule"));
    let ratio = trimmed(chart.ratio(), 2);
    let title = format!("height over arc length s, m; heights are drawn {ratio} times as large as lengths");
    group.push(text::line(sheet.profile.low + PaperPoint::new(4.0, 4.6), title, Height::H18, "quiet"));
    group.push(vertices(&chart, compiled));
    let line: Vec<String> = points.iter().map(|&(s, z)| coordinates(chart.at(s, z))).collect();
    let line = format!("M{}", line.join("L"));
    let (begin, end) = (chart.at(0.0, chart.base), chart.at(chart.length, chart.base));
    let floor = format!("L{}L{}Z", coordinates(end), coordinates(begin));
    group.push(path(&(line.clone() + &floor), "band"));
    group.push(levels(&chart, compiled));
    group.push(path(&line, "edge"));
    group.push(slopes(&chart, compiled));
    group.push(axis(&chart));
    group
}

/// Arc length from the layout's start and height, m: all around, from the start to the start.
fn points(compiled: &Compiled) -> Vec<(f64, f64)> {
    let (line, start) = (&compiled.space.line, compiled.start());
    let mut at = vec![0.0];
    for stretch in &line.stretches {
        let parts = if matches!(stretch.form, Form::Vertical { .. }) { ROUND } else { 1 };
        let part = |k: usize| compiled.round_trip(stretch.s + stretch.length * k as f64 / parts as f64 - start);
        at.extend((0..parts).map(part));
    }
    at.sort_by(f64::total_cmp);
    at.dedup_by(|b, a| *b - *a < 1e-9);
    let mut points: Vec<(f64, f64)> = at.into_iter().map(|s| (s, line.at(s + start).position.z)).collect();
    points.push((line.length, line.at(start).position.z));
    points
}

/// A line at the height of each level, and what it is.
fn levels(chart: &Chart, compiled: &Compiled) -> XmlElement {
    let mut group = XmlElement::group("levels");
    let mut heights: Vec<f64> = compiled.layout.levels.iter().map(|level| level.height).collect();
    let decimals = needed(heights.iter().copied(), 3);
    heights.push(chart.base);
    heights.sort_by(f64::total_cmp);
    let mut lowest = f64::INFINITY;
    for z in heights {
        let (left, right) = (chart.at(0.0, z), chart.at(chart.length, z));
        if lowest - left.y < 2.8 {
            continue;
        }
        lowest = left.y;
        if z > chart.base {
            group.push(path(&path_line(left, right), "tangent"));
        }
        let label = format!("{} m", fixed(z, decimals));
        let place = left - PaperPoint::new(2.0 + text::width(&label, Height::H18.size(), false), 0.0);
        group.push(path(&path_line(left - PaperPoint::new(1.2, 0.0), left), "dimension"));
        group.push(text::line(place + PaperPoint::new(0.0, Height::H18.capitals() / 2.0), label, Height::H18, ""));
    }
    group
}

/// Where each vertex is, as long as there is room for its name.
fn vertices(chart: &Chart, compiled: &Compiled) -> XmlElement {
    let mut group = XmlElement::group("profile-vertices");
    let n = compiled.layout.vertices.len();
    let mut spans: Vec<Option<(f64, f64)>> = vec![None; n];
    let mut s = 0.0;
    for leg in &compiled.space.legs {
        let end = s + leg.form.length();
        if leg.curve {
            let span = spans[leg.vertex].get_or_insert((s, end));
            span.1 = end;
        }
        s = end;
    }
    let middle = |(i, span): (usize, &Option<(f64, f64)>)| {
        span.map(|(a, b)| (compiled.round_trip((a + b) / 2.0 - compiled.start()), i))
    };
    let mut places: Vec<(f64, usize)> = spans.iter().enumerate().filter_map(middle).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut free = f64::NEG_INFINITY;
    for (s, i) in places {
        let foot = chart.at(s, chart.base);
        let top = PaperPoint::new(foot.x, chart.area.low.y - 1.6);
        group.push(path(&path_line(foot, top), "tangent"));
        let name = text::fitted(&compiled.layout.vertices[i].name, Height::H18, false, 20.0);
        let half = text::width(&name, Height::H18.size(), false) / 2.0;
        if foot.x - half > free + 1.0 {
            group.push(text::centred(top - PaperPoint::new(0.0, 1.8), 0.0, name, Height::H18, ""));
            free = foot.x + half;
        }
    }
    group
}

/// The slope of each climb beside its middle.
fn slopes(chart: &Chart, compiled: &Compiled) -> XmlElement {
    let mut group = XmlElement::group("slopes");
    let mut climbs: Vec<(f64, f64, f64)> = Vec::new();
    for stretch in &compiled.space.line.stretches {
        let slope = match stretch.form {
            Form::Straight { slope, .. } => slope,
            Form::Spiral { radius, turn, rise } => rise / (radius * turn.abs()),
            Form::Arc { .. } | Form::Vertical { .. } => 0.0,
        };
        match climbs.last_mut() {
            _ if slope == 0.0 => {}
            // One climb through straights and spirals.
            Some((_, end, same)) if (*end - stretch.s).abs() < 1e-9 && (*same - slope).abs() < 1e-9 => {
                *end += stretch.length;
            }
            _ => climbs.push((stretch.s, stretch.s + stretch.length, slope)),
        }
    }
    let middle = |climb: &(f64, f64, f64)| compiled.round_trip((climb.0 + climb.1) / 2.0 - compiled.start());
    climbs.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
    let decimals = needed(climbs.iter().map(|climb| 100.0 * climb.2), 2);
    let mut free = f64::NEG_INFINITY;
    for (from, to, slope) in climbs {
        let s = middle(&(from, to, slope));
        let z = compiled.space.line.at((from + to) / 2.0).position.z;
        let label = format!("{} %", fixed(100.0 * slope, decimals));
        let wide = text::width(&label, Height::H18.size(), false);
        // To the right of the line: under it where it rises, over it where it falls.
        let steep = chart.ratio() * slope.abs();
        let aside = 1.2 * trig::hypot(1.0, steep) / steep.max(0.2);
        let tall = Height::H18.capitals();
        let at = chart.at(s, z) + PaperPoint::new(aside, if slope > 0.0 { tall } else { 0.0 });
        let at =
            PaperPoint::new(at.x.min(chart.area.high.x - wide), at.y.clamp(chart.area.low.y, chart.area.high.y - 0.8));
        if at.x > free + 1.0 {
            group.push(text::line(at, label, Height::H18, "halo"));
            free = at.x + wide;
        }
    }
    group
}

/// The base line with marks at round arc lengths and at the end.
fn axis(chart: &Chart) -> XmlElement {
    let mut group = XmlElement::group("axis");
    let mut step = 1.0;
    for factor in [2.0, 2.5, 2.0].into_iter().cycle() {
        if step * chart.along >= APART || step > chart.length {
            break;
        }
        step *= factor;
    }
    let (begin, end) = (chart.at(0.0, chart.base), chart.at(chart.length, chart.base));
    let mut rules = path_line(begin, end);
    let mut label = |s: f64, text: String, class: &str| {
        let at = chart.at(s, chart.base);
        rules += &path_line(at, at + PaperPoint::new(0.0, 1.2));
        group.push(text::centred(at + PaperPoint::new(0.0, 3.6), 0.0, text, Height::H18, class));
    };
    let mut s = 0.0;
    while (chart.length - s) * chart.along >= APART {
        label(s, trimmed(s, 3), "");
        s += step;
    }
    label(chart.length, format!("{} m", fixed(chart.length, 3)), "");
    group.push(path(&rules, "rule"));
    group
}
