//! The polygon action of a layout on a sheet: the plan with its straights as rough as they run, the matrix of starts
//! and straights, and the curves' first harmonics head to tail.

use crate::base::number::{fixed, trimmed};
use crate::emit::DrawError;
use crate::emit::paper::{self, PaperPoint, Projection};
use crate::emit::svg::sheet::{Extent, PaperArea, Sheet, TableSize, coordinates, path, path_line, rectangle};
use crate::emit::svg::strip::field;
use crate::emit::svg::text::Height;
use crate::emit::svg::xml::{XmlElement, number};
use crate::emit::svg::{Theme, root, strip, symbol, text};
use crate::geometry::{CentreLine, Point, bounds};
use crate::kinematics::polygon::{Course, CurvePhasor, Phasor, curve_phasor, superposed};
use crate::report::polygon::PolygonReport;

/// Width of the panel at the right, mm.
const PANEL: f64 = 172.0;
/// Its parts from the top: matrix, harmonics, words, mm.
const MATRIX: f64 = 96.0;
const HARMONICS: f64 = 66.0;
/// Straights whose names and values are written into the matrix.
const NAMED: usize = 16;
/// Distance of lines of words, mm.
const ROW: f64 = 3.7;

/// The picture of a report on the centre line that it was made from.
///
/// # Errors
/// [`DrawError::Extent`] when the sheet cannot show the track.
pub fn polygon(report: &PolygonReport, line: &CentreLine, theme: Theme) -> Result<String, DrawError> {
    let (low, high) = bounds(outline(line, 0.0, line.length).into_iter());
    let table = TableSize::default();
    let extent = Extent { low, high, length: line.length, sections: 1, band: 1.0, notes: 0.0, profile: 0.0, table };
    let (sheet, panel) = Sheet::beside(&extent, PANEL)?;
    let description = format!(
        "Polygon action of {}: plan, matrix of starting straights and straights, first harmonics of the curves.",
        report.layout
    );
    let mut svg = root(&sheet, theme, &format!("{}: polygon action", report.layout), &description);
    svg.push(sheet.frame());
    svg.push(plan(&sheet, report, line));
    let part = |from: f64, tall: f64| PaperArea {
        low: panel.low + PaperPoint::new(0.0, from),
        high: PaperPoint::new(panel.high.x, panel.low.y + from + tall),
    };
    svg.push(matrix(report, part(0.0, MATRIX)));
    svg.push(harmonics(report, line, part(MATRIX, HARMONICS)));
    svg.push(words(report, part(MATRIX + HARMONICS, panel.height() - MATRIX - HARMONICS)));
    svg.push(legend(&sheet, report));
    svg.push(strip::scale_bar(&sheet));
    svg.push(strip::title(&sheet, &report.layout, "polygon action", &fields(&sheet, report)));
    Ok(svg.document())
}

/// Points of the plan between two arc lengths (m): two a straight piece, one every few degrees of a bent one.
fn outline(line: &CentreLine, from: f64, to: f64) -> Vec<Point> {
    const STEP: f64 = 0.1;
    let mut points = Vec::new();
    for stretch in &line.stretches {
        let (begin, end) = ((from - stretch.s).max(0.0), (to - stretch.s).min(stretch.length));
        if begin >= end {
            continue;
        }
        let bends = stretch.form.turn().abs() * (end - begin) / stretch.length;
        let steps = (bends / STEP).ceil().clamp(1.0, 200.0) as usize;
        points.extend((0..=steps).map(|k| {
            let p = stretch.at(begin + (end - begin) * k as f64 / steps as f64).position;
            Point::new(p.x, p.y)
        }));
    }
    points
}

fn polyline(sheet: &Sheet, points: &[Point]) -> String {
    let mut data = String::new();
    for (k, p) in points.iter().enumerate() {
        data.push(if k == 0 { 'M' } else { 'L' });
        data += &coordinates(sheet.at(*p));
    }
    data
}

/// Opacity of a value among values up to `most`.
fn shade(value: f64, most: f64) -> f64 {
    if most > 0.0 { (0.08 + 0.92 * value / most).clamp(0.0, 1.0) } else { 0.08 }
}

fn plan(sheet: &Sheet, report: &PolygonReport, line: &CentreLine) -> XmlElement {
    let mut group = XmlElement::group("plan");
    let whole = outline(line, 0.0, line.length);
    group.push(path(&(polyline(sheet, &whole) + "Z"), "rule"));
    let most = report.straights.iter().map(|s| s.rms_mm).fold(0.0, f64::max);
    for straight in &report.straights {
        // Around arc length 0 a straight is in two parts.
        let end = straight.s_m + straight.length_m;
        let parts = [(straight.s_m, end.min(line.length)), (0.0, end - line.length)];
        for (from, to) in parts.into_iter().filter(|(from, to)| to > from) {
            let style = format!("stroke-width:3.2;stroke-opacity:{}", number(shade(straight.rms_mm, most)));
            group.push(path(&polyline(sheet, &outline(line, from, to)), "stage-3").attr("style", style));
        }
    }
    for curve in &report.curves {
        let parts = [
            (curve.s_m, (curve.s_m + curve.length_m).min(line.length)),
            (0.0, curve.s_m + curve.length_m - line.length),
        ];
        for (from, to) in parts.into_iter().filter(|(from, to)| to > from) {
            group.push(path(&polyline(sheet, &outline(line, from, to)), "edge").attr("style", "stroke-width:1.2"));
        }
    }
    let middle = (sheet.drawing.low + sheet.drawing.high) * 0.5;
    for curve in &report.curves {
        let at = line.at(curve.s_m + curve.length_m / 2.0);
        let spot = sheet.at(Point::new(at.position.x, at.position.y));
        let normal = Projection::turned(Point::new(at.normal.x, at.normal.y));
        // Towards the outside of the bend, or of the plan where it is nearly straight.
        let turn: f64 = line.stretches[line.stretch_at(curve.s_m + curve.length_m / 2.0)].form.turn();
        let outward = if turn.abs() > 0.3 {
            normal * -turn.signum()
        } else if normal.dot(spot - middle) >= 0.0 {
            normal
        } else {
            -normal
        };
        let away = spot + outward * 8.0;
        let away = PaperPoint::new(away.x.max(sheet.drawing.low.x + 10.0), away.y);
        group.push(text::centred(away - PaperPoint::new(0.0, 1.7), 0.0, curve.name.clone(), Height::H25, "halo bold"));
        let share = format!("{} %", fixed(100.0 * curve.share, 0));
        group.push(text::centred(away + PaperPoint::new(0.0, 2.1), 0.0, share, Height::H18, "halo quiet"));
    }
    // Direction of travel on the longest straight.
    if let Some(longest) = report.straights.iter().max_by(|a, b| a.length_m.total_cmp(&b.length_m)) {
        let at = line.at(longest.s_m + longest.length_m / 2.0);
        let along = Projection::turned(Point::new(at.tangent.x, at.tangent.y));
        let tip = sheet.at(Point::new(at.position.x, at.position.y)) + along * 2.5;
        group.push(path(&symbol::arrow(tip, along, 5.0, 2.6), "arrow"));
    }
    group
}

fn heading(area: &PaperArea, title: &str, more: &str) -> XmlElement {
    let at = area.low + PaperPoint::new(4.0, 6.5);
    XmlElement::group("heading").with(text::line(at, title, Height::H25, "bold")).with(text::line(
        at + PaperPoint::new(0.0, 4.2),
        more,
        Height::H18,
        "quiet",
    ))
}

/// Rows are starts, columns straights; the darker the rougher.
fn matrix(report: &PolygonReport, area: PaperArea) -> XmlElement {
    let mut group = XmlElement::group("matrix").with(rectangle(area.low, area.high, "rule"));
    group.push(heading(&area, "ΔP, mm", "rows: where the chain starts; columns: where it is measured"));
    let n = report.delta_p_mm.len();
    let named = n <= NAMED;
    let names = report.straights.iter().map(|s| text::width(&s.name, Height::H18.size(), false)).fold(0.0, f64::max);
    let names = if named { names.min(26.0) + 2.0 } else { 2.0 };
    let from = area.low + PaperPoint::new(4.0 + names, 17.5);
    let wide = ((area.high.x - 5.0 - from.x) / n as f64).min(24.0);
    let tall = ((area.high.y - 4.0 - from.y) / n as f64).min(9.0);
    let most = report.delta_p_mm.iter().flatten().copied().fold(0.0, f64::max);
    for (i, row) in report.delta_p_mm.iter().enumerate() {
        let y = from.y + tall * i as f64;
        if named {
            let name = text::fitted(&report.straights[i].name, Height::H18, false, 26.0);
            let at = PaperPoint::new(area.low.x + 4.0, y + tall / 2.0 + Height::H18.capitals() / 2.0);
            group.push(text::line(at, name, Height::H18, ""));
            let top = PaperPoint::new(from.x + wide * (i as f64 + 0.5), from.y - 2.6);
            let name = text::fitted(&report.straights[i].name, Height::H18, false, wide + 1.0);
            group.push(text::centred(top, 0.0, name, Height::H18, ""));
        }
        for (j, value) in row.iter().enumerate() {
            let low = PaperPoint::new(from.x + wide * j as f64, y);
            let cell = rectangle(low, low + PaperPoint::new(wide - 0.3, tall - 0.3), "induction");
            group.push(cell.num("fill-opacity", 0.85 * shade(*value, most)));
            if named && tall > 3.4 {
                let middle = low + PaperPoint::new(wide / 2.0, tall / 2.0) - PaperPoint::new(0.15, 0.15);
                group.push(text::centred(middle, 0.0, fixed(*value, 2), Height::H18, ""));
            }
        }
    }
    group
}

/// The row with the largest value: where the chain starts there.
fn roughest(report: &PolygonReport) -> usize {
    let square = |row: &Vec<f64>| row.iter().map(|x| x * x).sum::<f64>();
    (0..report.delta_p_mm.len())
        .max_by(|a, b| square(&report.delta_p_mm[*a]).total_cmp(&square(&report.delta_p_mm[*b])))
        .unwrap_or(0)
}

/// The curves' first harmonics, one at the head of the other: from the middle to each head is what the straight behind
/// it has.
fn harmonics(report: &PolygonReport, line: &CentreLine, area: PaperArea) -> XmlElement {
    let mut group = XmlElement::group("harmonics").with(rectangle(area.low, area.high, "rule"));
    let start = roughest(report);
    let from = report.straights.get(start).map_or("", |s| &s.name);
    let more = "head to tail; from the ring's middle to a head: ΔP of the straight behind it";
    group.push(heading(&area, &format!("Curves behind a start on {from}"), more));
    let pitch = report.cart_length_m;
    let Ok(course) = Course::new(line) else { return group };
    let phasors: Result<Vec<CurvePhasor>, _> = (0..course.len()).map(|k| curve_phasor(&course, k, pitch)).collect();
    let Ok(phasors) = phasors else { return group };
    let parts = superposed(&course, &phasors, pitch).swap_remove(start);
    let mut at = Phasor::default();
    let heads: Vec<PaperPoint> = std::iter::once(PaperPoint::default())
        .chain(parts.iter().map(|part| {
            at += part;
            PaperPoint::new(2e3 * at.re, -2e3 * at.im)
        }))
        .collect();
    let (low, high) = paper::bounds(heads.iter().copied());
    let span = high - low;
    let room = PaperArea { low: area.low + PaperPoint::new(12.0, 15.5), high: area.high - PaperPoint::new(22.0, 6.0) };
    let scale = (room.width() / span.x.max(1e-9)).min(room.height() / span.y.max(1e-9)).min(40.0);
    let place = |p: PaperPoint| (room.low + room.high) * 0.5 + (p - (low + high) * 0.5) * scale;
    let zero = place(PaperPoint::default());
    for (k, pair) in heads.windows(2).enumerate() {
        let (tail, head) = (place(pair[0]), place(pair[1]));
        let length = tail.distance(head);
        if length < 1e-9 {
            continue;
        }
        let along = (head - tail) * (1.0 / length);
        group.push(path(&path_line(tail, head), "edge"));
        group.push(path(&symbol::arrow(head, along, length.min(2.4), length.min(1.4)), "motor"));
        let name = &report.curves[(start + report.curves.len() - k - 1) % report.curves.len()].name;
        let side = if along.across().y > 0.0 { -along.across() } else { along.across() };
        let name = text::fitted(name, Height::H18, false, 20.0);
        let offset = if k % 2 == 0 { 2.2 } else { -2.2 };
        group.push(text::centred((tail + head) * 0.5 + side * offset, 0.0, name, Height::H18, "halo"));
    }
    group.push(symbol::circle(zero, 1.1, "start"));
    // A bar of a round length.
    let bar = [2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01].into_iter().find(|mm| mm * scale <= 30.0).unwrap_or(0.01);
    let end = PaperPoint::new(area.high.x - 6.0, area.high.y - 4.0);
    let begin = end - PaperPoint::new(bar * scale, 0.0);
    let ends = [begin, end].map(|p| path_line(p - PaperPoint::new(0.0, 1.0), p + PaperPoint::new(0.0, 1.0)));
    group.push(path(&(path_line(begin, end) + &ends.concat()), "rule"));
    let middle = (begin + end) * 0.5 - PaperPoint::new(0.0, 2.6);
    group.push(text::centred(middle, 0.0, format!("{} mm", trimmed(bar, 2)), Height::H18, ""));
    group
}

fn words(report: &PolygonReport, area: PaperArea) -> XmlElement {
    let mut group = XmlElement::group("words").with(rectangle(area.low, area.high, "rule"));
    let wide = area.width() - 8.0;
    let mut at = area.low + PaperPoint::new(4.0, 5.4);
    let last = area.high.y - 2.0;
    for note in &report.notes {
        for line in broken(note, wide) {
            if at.y > last {
                return group;
            }
            group.push(text::line(at, line, Height::H18, ""));
            at.y += ROW;
        }
        at.y += 0.9;
    }
    group
}

/// Lines of a note that fit.
fn broken(note: &str, wide: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in note.split(' ') {
        let line = lines.last().map_or("", |l| l.as_str());
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        match lines.last_mut() {
            Some(last) if last.is_empty() || text::width(&longer, Height::H18.size(), false) <= wide => *last = longer,
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn legend(sheet: &Sheet, report: &PolygonReport) -> XmlElement {
    let low = sheet.strip.low;
    let right = sheet.strip.high.x - strip::TITLE_WIDTH - strip::SCALE_WIDTH;
    let mut group =
        XmlElement::group("legend").with(rectangle(low, PaperPoint::new(right, sheet.strip.high.y), "rule"));
    let most = report.straights.iter().map(|s| s.rms_mm).fold(0.0, f64::max);
    let at = |row: f64| low + PaperPoint::new(5.0, 7.0 + 6.4 * row);
    let caption = |row: f64, words: &str| {
        text::line(at(row) + PaperPoint::new(17.0, Height::H18.capitals() / 2.0), words, Height::H18, "")
    };
    for k in 0..6 {
        let from = at(0.0) + PaperPoint::new(2.2 * f64::from(k), -1.6);
        let opacity = shade(f64::from(k), 5.0);
        group.push(rectangle(from, from + PaperPoint::new(2.2, 3.2), "induction").num("fill-opacity", opacity));
    }
    group.push(caption(0.0, &format!("straights by rms of ΔP over all starts, to {} mm", fixed(most, 2))));
    let curve = path_line(at(1.0), at(1.0) + PaperPoint::new(13.2, 0.0));
    group.push(path(&curve, "edge").attr("style", "stroke-width:1.2"));
    group.push(caption(1.0, &format!("curves: name, share of `{}`", report.objective)));
    group.push(path(&symbol::arrow(at(2.0) + PaperPoint::new(9.0, 0.0), PaperPoint::new(1.0, 0.0), 5.0, 2.6), "arrow"));
    group.push(caption(2.0, "direction of travel"));
    let head = at(3.0) + PaperPoint::new(11.0, 0.0);
    group.push(path(&path_line(at(3.0) + PaperPoint::new(2.0, 0.0), head), "edge"));
    group.push(path(&symbol::arrow(head, PaperPoint::new(1.0, 0.0), 2.4, 1.4), "motor"));
    group.push(caption(3.0, "first harmonic of a curve: size and phase"));
    group.push(text::line(at(4.6), "ΔP: peak to peak of a joint's lead and lag while", Height::H18, "quiet"));
    group.push(text::line(at(5.2), "the first joint moves by one cart (thesis §3.4)", Height::H18, "quiet"));
    group
}

fn fields(sheet: &Sheet, report: &PolygonReport) -> Vec<Vec<strip::TitleField>> {
    let square = |x: f64| format!("{} mm²", fixed(x, 2));
    let v = &report.values;
    vec![
        vec![
            field("length of track", format!("{} m", trimmed(report.track_length_m, 3))),
            field("cart", format!("{} m", trimmed(report.cart_length_m, 3))),
            field("curves", report.curves.len().to_string()),
            field("objective", report.objective),
            field("value", square(report.value)),
        ],
        vec![field("all", square(v.all)), field("first three", square(v.first_three)), field("last", square(v.last))],
        vec![
            field("scale", format!("1 : {}", trimmed(sheet.scale, 1))),
            field("sheet", sheet.size),
            field("units", "mm"),
        ],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig;
    use crate::chain_input::Simulation;
    use crate::compiled::Compiled;
    use crate::compiled::fixture::compile;
    use crate::emit::png;
    use crate::geometry::Form;
    use crate::kinematics::polygon::PolygonObjective;
    use crate::model::instances;
    use crate::report::polygon::Names;

    fn drawn(compiled: &Compiled, theme: Theme) -> String {
        let simulation = Simulation::new(compiled);
        let line = simulation.track.centre_line();
        let names = Names::of(compiled);
        let report =
            PolygonReport::new(&simulation.name, &line, 1.25, PolygonObjective::All, &names).expect("a report");
        polygon(&report, &line, theme).expect("drawn")
    }

    #[test]
    fn the_picture_is_what_it_was() {
        insta::assert_snapshot!(drawn(&compile(instances::thesis10()), Theme::Adaptive));
    }

    #[test]
    fn it_renders() {
        let bytes = png::render(&drawn(&compile(instances::horseshoe()), Theme::Light)).expect("rendered");
        assert!(bytes.starts_with(b"\x89PNG"));
    }

    #[test]
    fn an_outline_follows_the_arc() {
        let line = CentreLine::new([0.0; 4], &[Form::Arc { radius: 2.0, turn: trig::TAU }]);
        assert!(outline(&line, 0.0, line.length).iter().all(|p| (p.distance(Point::new(0.0, 2.0)) - 2.0).abs() < 1e-9));
    }
}
