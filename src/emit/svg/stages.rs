//! The written layout and the stages' results over each other, as the figures of thesis §3.3 show them.

use crate::compiled::Compiled;
use crate::emit::paper::{PaperPoint, Projection};
use crate::emit::{DrawError, plan};
use crate::geometry::{Corner, Track};
use crate::model::Layout;
use crate::solve::Status;

use super::obstacles;
use super::place::{TakenPaper, around};
use super::sheet::{Sheet, path, reading_angle};
use super::strip::{self, Key, field};
use super::text::{self, Height};
use super::xml::XmlElement;
use super::{Theme, extent, root, symbol, track};
use crate::base::number::trimmed;

/// Centre lines of the written layout and of every stage.
///
/// # Errors
/// [`DrawError::Extent`] when no standard sheet and scale can show the layouts.
pub fn stages(compiled: &Compiled, written: &[Corner], theme: Theme) -> Result<String, DrawError> {
    let layout = &compiled.layout;
    let lines: Vec<(String, Track)> = std::iter::once(("start".to_owned(), Track::new(written)))
        .chain(compiled.stages.iter().filter(|stage| stage.status != Status::AsWritten).map(|stage| {
            let failed = if stage.status == Status::Infeasible { ", not feasible" } else { "" };
            let name =
                stage.name.strip_prefix("stage").map_or(stage.name.to_owned(), |number| format!("stage {number}"));
            (name + failed, Track::new(&stage.corners))
        }))
        .collect();
    let words = Words {
        title: format!("{}: stages", layout.name),
        description: format!("Centre lines of {} before and after each stage of the optimisation.", layout.name),
        subject: format!("stages of the optimisation, {}", lengths(layout.is_flat())),
    };
    let lines: Vec<Line> = (0..).zip(lines).map(|(i, (name, track))| Line { name, track, style: i.min(3) }).collect();
    over_each_other(layout, &lines, &words, theme)
}

/// Centre lines of two layouts, each with its name; building and obstacles are the second one's.
///
/// # Errors
/// As [`stages`].
pub fn change(names: (&str, &str), (before, after): (&Compiled, &Compiled), theme: Theme) -> Result<String, DrawError> {
    let layout = &after.layout;
    let line = |name: &str, compiled: &Compiled, style: usize| {
        let failed = if compiled.failed() { ", not feasible" } else { "" };
        Line { name: format!("{name}{failed}"), track: compiled.track.clone(), style }
    };
    // As a stage before all others, and as the last one.
    let lines = [line(names.0, before, 0), line(names.1, after, 3)];
    let words = Words {
        title: format!("{}: change", layout.name),
        description: format!("Centre lines of {} before and after a change.", layout.name),
        subject: format!("before and after, {}", lengths(before.layout.is_flat() && layout.is_flat())),
    };
    over_each_other(layout, &lines, &words, theme)
}

/// What lengths are of: a stage knows the plan of a track that climbs.
fn lengths(flat: bool) -> &'static str {
    if flat { "lengths of the centre line" } else { "lengths of the plan" }
}

/// A track among others.
struct Line {
    name: String,
    track: Track,
    /// Of the four that stages have.
    style: usize,
}

/// What a drawing of several tracks is called.
struct Words {
    title: String,
    description: String,
    subject: String,
}

/// Centre lines over each other, the last one with names of its vertices.
fn over_each_other(layout: &Layout, lines: &[Line], words: &Words, theme: Theme) -> Result<String, DrawError> {
    let tracks: Vec<&Track> = lines.iter().map(|line| &line.track).collect();
    let sheet = Sheet::choose(&extent(layout, &tracks, 0.0, 0.0))?;
    let mut svg = root(&sheet, theme, &words.title, &words.description);
    svg.push(sheet.frame());
    let inside = PaperPoint::new(6.0, 6.0);
    let mut area = TakenPaper::new(sheet.drawing.low + inside, sheet.drawing.high - inside);
    let titles = obstacles::names(&sheet, layout, &mut area);
    svg.push(track::building(&sheet, layout));
    svg.push(obstacles::draw(&sheet, layout, &titles));
    let mut group = XmlElement::group("stages");
    for Line { track: line, style, .. } in lines {
        let class = format!("stage-{style}");
        group.push(path(&(track::curves(&sheet, &plan::side(line, 0.0)) + "Z"), &class));
        let crosses: String = line.corners.iter().map(|c| symbol::cross(sheet.at(c.point), 1.0)).collect();
        group.push(path(&crosses, &class).attr("style", "stroke-width:.3;stroke-dasharray:none"));
        track::occupy(&sheet, line, layout, &mut area);
    }
    svg.push(group);
    let mut names = XmlElement::group("labels");
    for (obstacle, title) in layout.obstacles.iter().zip(&titles) {
        let place = title.inside.or_else(|| area.place(&obstacles::beside(&sheet, obstacle, title).0).map(|c| c.text));
        if let Some(place) = place {
            names.push(text::centred(place.centre, 0.0, &title.text, Height::H25, "halo"));
        }
    }
    if let Some(Line { track: last, .. }) = lines.last() {
        for (vertex, (corner, fillet)) in layout.vertices.iter().zip(last.corners.iter().zip(&last.fillets)) {
            let prefer = Projection::direction((corner.point - fillet.centre).heading());
            let name = text::fitted(&vertex.name, Height::H25, false, 70.0);
            name_at(&mut names, &mut area, sheet.at(corner.point), prefer, &name);
        }
    }
    svg.push(names);
    let mut entries: Vec<(Key, String)> = lines
        .iter()
        .map(|line| (Key::Stage(line.style), format!("{}: {} m", line.name, trimmed(line.track.length, 3))))
        .collect();
    if layout.building.is_some() {
        entries.push((Key::Wall, "wall".to_owned()));
    }
    if !layout.obstacles.is_empty() {
        entries.push((Key::Obstacle, "obstacle".to_owned()));
    }
    svg.push(strip::legend(&sheet, &entries));
    svg.push(strip::scale_bar(&sheet));
    let mut rows = vec![vec![
        field("scale", format!("1 : {}", trimmed(sheet.scale, 1))),
        field("sheet", sheet.size),
        field("units", "m, degrees"),
        field("width of band", format!("{} m", trimmed(layout.width.value, 3))),
        field("vertices", layout.vertices.len().to_string()),
    ]];
    let lengths = lines.iter().map(|line| strip::TitleField {
        warn: line.name.ends_with("not feasible"),
        ..field(line.name.clone(), format!("{} m", trimmed(line.track.length, 3)))
    });
    rows.push(lengths.take(5).collect());
    svg.push(strip::title(&sheet, &layout.name, &words.subject, &rows));
    Ok(svg.document())
}

fn name_at(group: &mut XmlElement, area: &mut TakenPaper, at: PaperPoint, prefer: PaperPoint, name: &str) {
    let size = PaperPoint::new(text::width(name, Height::H25.size(), true) + 0.8, 1.24 * Height::H25.size());
    if let Some(chosen) = area.place(&around(at, prefer, size, 1.6, 60.0)) {
        if let Some((a, b)) = chosen.leader {
            group.push(path(&super::sheet::path_line(a, b), "leader"));
        }
        let place = &chosen.text;
        group.push(text::centred(place.centre, reading_angle(place.axis), name, Height::H25, "halo bold"));
    }
}
