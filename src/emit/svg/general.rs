//! The general-arrangement drawing.

use crate::compiled::Compiled;
use crate::emit::DrawError;
use crate::emit::paper::PaperPoint;
use crate::emit::plan::{self, Climb, Mark, MarkKind, PointGroup, WallDistance};
use crate::model::ConstraintKind;
use crate::solve::Stage;

use super::decimals::Decimals;
use super::labels::{self, Labelled, Labels};
use super::place::TakenPaper;
use super::setting_out::{self, Frame};
use super::sheet::{Extent, Sheet};
use super::strip::{self, Key};
use super::tables::Tables;
use super::xml::XmlElement;
use super::{Theme, extent, obstacles, profile, root, track};
use crate::base::number::trimmed;

/// How often the sheet is laid out anew to make room for the list of labels without room.
const ATTEMPTS: usize = 4;

/// The layout on its sheet: building, obstacles, track, equipment, dimensions, coordinates, legend and title block.
///
/// # Errors
/// [`DrawError::Extent`] when no standard sheet and scale can show the layout.
pub fn drawing(compiled: &Compiled, theme: Theme) -> Result<String, DrawError> {
    let drawn = Drawn::new(compiled);
    let mut reserved = 0;
    let mut attempt = drawn.on_sheet(theme, reserved)?;
    for _ in 1..ATTEMPTS {
        if attempt.1 <= reserved {
            break;
        }
        // A smaller scale may leave more labels without room.
        reserved = attempt.1;
        attempt = drawn.on_sheet(theme, reserved)?;
    }
    Ok(attempt.0)
}

/// A sheet without its drawing: frame, title block, tables.
pub struct Furniture {
    pub sheet: Sheet,
    pub elements: Vec<XmlElement>,
}

/// What stands around the drawing, where nothing of the plan needs a list of labels.
///
/// # Errors
/// As [`drawing`].
pub fn furniture(compiled: &Compiled) -> Result<Furniture, DrawError> {
    let drawn = Drawn::new(compiled);
    let sheet = drawn.sheet(0)?;
    let elements = vec![sheet.frame(), drawn.tables(&[]).draw(&sheet, &drawn.origin()), drawn.title(&sheet)];
    Ok(Furniture { sheet, elements })
}

/// The sheet of a general-arrangement drawing that lists this many labels without room.
#[cfg(test)]
pub fn sheet(compiled: &Compiled, listed: usize) -> Result<Sheet, DrawError> {
    Drawn::new(compiled).sheet(listed)
}

/// What is drawn, worked out once.
struct Drawn<'a> {
    compiled: &'a Compiled,
    failed: Option<&'a Stage>,
    marks: Vec<Mark>,
    climbs: Vec<Climb>,
    walls: Vec<WallDistance>,
    points: Vec<PointGroup>,
    decimals: Decimals,
}

impl<'a> Drawn<'a> {
    fn new(compiled: &'a Compiled) -> Self {
        let (climbs, walls) = (plan::climbs(compiled), plan::wall_distances(compiled));
        let points = plan::points(compiled);
        Drawn {
            compiled,
            failed: compiled.stages.last().filter(|_| compiled.failed()),
            marks: plan::marks(compiled),
            decimals: Decimals::new(compiled, &climbs, &walls, &points),
            climbs,
            walls,
            points,
        }
    }

    fn sheet(&self, reserved: usize) -> Result<Sheet, DrawError> {
        let tables = self.tables(&vec![String::new(); reserved]);
        Sheet::choose(&Extent { table: tables.size(), ..self.extent() })
    }

    fn tables(&self, listed: &[String]) -> Tables {
        Tables::new(&self.points, self.decimals, listed)
    }

    fn origin(&self) -> String {
        setting_out::origin_words(&self.compiled.layout)
    }

    fn title(&self, sheet: &Sheet) -> XmlElement {
        let layout = &self.compiled.layout;
        let subject = strip::subject_of(&layout.drawing.title.project, "general arrangement of the track");
        strip::title(sheet, &layout.name, &subject, &strip::fields(sheet, self.compiled))
    }

    fn extent(&self) -> Extent {
        let (notes, tall) = (strip::notes_height(self.failed), profile::height(self.compiled));
        extent(&self.compiled.layout, &[&self.compiled.track], notes, tall)
    }

    /// The drawing on a sheet with this many lines for labels without room, and how many labels found none.
    fn on_sheet(&self, theme: Theme, reserved: usize) -> Result<(String, usize), DrawError> {
        let (compiled, layout, line) = (self.compiled, &self.compiled.layout, &self.compiled.track);
        let (marks, climbs, pieces) = (&self.marks, &self.climbs, &compiled.pieces);
        let sheet = self.sheet(reserved)?;
        let Extent { low, high, .. } = self.extent();
        let mut frame = Frame { low, high, omitted: Vec::new() };

        let inside = PaperPoint::new(3.0, 3.0);
        let mut field = TakenPaper::new(sheet.drawing.low + inside, sheet.drawing.high - inside);
        track::occupy(&sheet, line, layout, &mut field);
        let ordinates = setting_out::ordinates(&sheet, layout, self.decimals.coordinate, &mut frame, &mut field);
        let axes = setting_out::axes(&sheet, layout, &mut frame, &mut field);
        let equipment = track::equipment(&sheet, line, layout, marks, &mut field);
        let vertices = track::vertices(&sheet, line, layout, &mut field);
        let names = obstacles::names(&sheet, layout, &mut field);
        let datum = setting_out::datum(&sheet, layout, &frame, &mut field);
        let legend = entries(self, datum.is_some());

        let mut svg = root(&sheet, theme, &layout.name, &self.description(&sheet));
        svg.push(sheet.frame());
        if self.failed.is_some() {
            svg.push(watermark(&sheet));
        }
        svg.push(track::building(&sheet, layout));
        svg.push(obstacles::draw(&sheet, layout, &names));
        svg.push(axes);
        svg.push(track::band(&sheet, line, layout.width.value));
        if climbs.iter().any(|climb| !climb.is_level()) {
            svg.push(track::climbs(&sheet, line, layout.width.value, climbs));
        }
        svg.push(track::joints(&sheet, pieces, layout.width.value));
        svg.push(track::fixed(&sheet, line, layout));
        svg.push(track::centre(&sheet, line));
        svg.push(equipment);
        svg.push(track::arrows(&sheet, line, marks));
        svg.push(vertices);
        svg.push(ordinates);
        datum.into_iter().for_each(|datum| svg.push(datum));

        let mut labels = Labels::new(&sheet, line, layout, field, self.decimals);
        let labelled = Labelled { pieces, marks, climbs, walls: &self.walls, obstacles: &names };
        labels::all(&mut labels, &labelled);
        let mut omitted = frame.omitted;
        omitted.append(&mut labels.omitted);
        svg.push(labels.finish());
        svg.push(self.tables(&omitted).draw(&sheet, &self.origin()));
        if !layout.is_flat() {
            svg.push(profile::profile(&sheet, compiled));
        }
        if let Some(stage) = self.failed {
            svg.push(strip::notes(&sheet, stage));
        }
        svg.push(strip::legend(&sheet, &legend));
        svg.push(strip::scale_bar(&sheet));
        svg.push(self.title(&sheet));
        Ok((svg.document(), omitted.len()))
    }

    fn description(&self, sheet: &Sheet) -> String {
        let (compiled, layout) = (self.compiled, &self.compiled.layout);
        format!(
            "General arrangement of {}: {} m of track in {} elements through {} vertices, band {} m wide, scale 1:{}.{}",
            layout.name,
            trimmed(compiled.length(), 3),
            compiled.bill.count,
            compiled.track.corners.len(),
            trimmed(layout.width.value, 3),
            trimmed(sheet.scale, 1),
            if self.failed.is_some() { " Not feasible." } else { "" }
        )
    }
}

/// What appears on the drawing, in the legend's order.
fn entries(drawn: &Drawn, datum: bool) -> Vec<(Key, String)> {
    let (layout, pieces) = (&drawn.compiled.layout, &drawn.compiled.pieces);
    let (marks, climbs) = (&drawn.marks, &drawn.climbs);
    let mut entries = vec![(Key::Track, "band, centre line, direction of travel".to_owned())];
    let mut add = |shown: bool, key: Key, text: &str| {
        if shown {
            entries.push((key, text.to_owned()));
        }
    };
    let n = pieces.len();
    let changes = (0..n).filter(|&i| pieces[i].article != pieces[(i + n - 1) % n].article).count();
    let climbing = climbs.iter().any(|climb| !climb.is_level());
    add(climbing, Key::Climb, "ramp: slope in driving direction, heights");
    add(changes < n, Key::Joint, "joint of like elements");
    add(changes > 0, Key::Change, "joint where the article changes");
    add(pieces.iter().any(|p| p.in_catalog), Key::Article, "elements: count × article");
    add(pieces.iter().any(|p| !p.in_catalog), Key::Unlisted, "elements that the catalogue lacks");
    add(true, Key::Vertex, "vertex");
    let dimension = if climbing { "straight: length in the plan ∠ heading" } else { "straight: length ∠ heading" };
    add(true, Key::Dimension, dimension);
    add(true, Key::Radius, "curve: radius, turn");
    add(!drawn.walls.is_empty(), Key::WallDistance, "centre line to wall; min: the least");
    let fixes = |kind: fn(&ConstraintKind) -> bool| layout.constraints.iter().any(|c| kind(&c.kind));
    add(
        fixes(|k| matches!(k, ConstraintKind::FixSection { .. } | ConstraintKind::Holds { .. })),
        Key::FixedSection,
        "section with fixed values",
    );
    add(fixes(|k| matches!(k, ConstraintKind::FixVertex { .. })), Key::FixedVertex, "fixed vertex");
    add(layout.building.is_some(), Key::Wall, "wall");
    add(!layout.obstacles.is_empty(), Key::Obstacle, "obstacle");
    let clearance = layout.obstacles.iter().map(|o| o.clearance).chain(layout.building.iter().map(|b| b.clearance));
    add(clearance.fold(0.0, f64::max) > 0.0, Key::Clearance, "clearance");
    add(datum, Key::Datum, "origin of coordinates");
    add(!layout.drawing.axes.is_empty(), Key::GridAxis, "axis of the building");
    let any = |kind: MarkKind| marks.iter().any(|mark| mark.kind == kind);
    add(any(MarkKind::Start), Key::Mark(MarkKind::Start), "start of arc length s");
    add(any(MarkKind::Photocell), Key::Mark(MarkKind::Photocell), "photocell");
    let of =
        |kind: MarkKind, covers: bool| marks.iter().any(|mark| mark.kind == kind && mark.covers.is_empty() != covers);
    for (kind, text) in [
        (MarkKind::Induction, "induction"),
        (MarkKind::Chute, "chute: row, count"),
        (MarkKind::Station, "scanner, gate or lift"),
    ] {
        add(of(kind, false), Key::Mark(kind), text);
        add(of(kind, true), Key::Footprint(kind), &format!("{text}, with its footprint"));
    }
    add(marks.iter().any(|mark| mark.conveyor.is_some()), Key::Conveyor, "conveyor, from where items come");
    let motors = marks.iter().filter(|mark| mark.kind == MarkKind::Motor).count();
    add(motors > 0, Key::Mark(MarkKind::Motor), &format!("motor ({motors})"));
    let every = layout.equipment.supports.map_or(0.0, |every| every.value);
    add(any(MarkKind::Support), Key::Mark(MarkKind::Support), &format!("support, every {} m", trimmed(every, 3)));
    entries
}

fn watermark(sheet: &Sheet) -> XmlElement {
    let middle = (sheet.drawing.low + sheet.drawing.high) * 0.5;
    let size = sheet.drawing.width() / 10.0;
    XmlElement::new("text")
        .attr("class", "watermark")
        .num("font-size", size)
        .num("x", middle.x)
        .num("y", middle.y + 0.36 * size)
        .attr("transform", format!("rotate(-16 {} {})", super::number(middle.x), super::number(middle.y)))
        .text("NOT FEASIBLE")
}
