//! The plan as a small picture beside words: track, obstacles and equipment, without dimensions.

use crate::compiled::Compiled;
use crate::emit::DrawError;
use crate::emit::paper::PaperPoint;
use crate::emit::plan::{self, MarkKind};

use super::decimals::Decimals;
use super::labels::Labels;
use super::obstacles;
use super::place::TakenPaper;
use super::sheet::Sheet;
use super::xml::XmlElement;
use super::{extent, track};

/// Left free around the plan, mm.
const MARGIN: f64 = 2.0;

/// The plan within so much room, and its width and height, mm. Its upper left corner is the origin.
///
/// # Errors
/// [`DrawError::Extent`] where there is nothing that could be drawn.
pub fn overview(compiled: &Compiled, room: PaperPoint) -> Result<(XmlElement, PaperPoint), DrawError> {
    let (layout, line) = (&compiled.layout, &compiled.track);
    let sheet = Sheet::around(&extent(layout, &[line], 0.0, 0.0), room, MARGIN)?;
    let size = PaperPoint::new(sheet.width, sheet.height);
    let mut field = TakenPaper::new(PaperPoint::default(), size);
    track::occupy(&sheet, line, layout, &mut field);
    let names = obstacles::names(&sheet, layout, &mut field);
    let mut marks = plan::marks(compiled);
    // Of these are too many for their symbols to be told apart.
    marks.retain(|mark| !matches!(mark.kind, MarkKind::Support | MarkKind::Motor));
    let mut group = XmlElement::group("overview")
        .with(track::building(&sheet, layout))
        .with(obstacles::draw(&sheet, layout, &names))
        .with(track::band(&sheet, line, layout.width.value))
        .with(track::centre(&sheet, line))
        .with(track::equipment(&sheet, line, layout, &marks, &mut field))
        .with(track::arrows(&sheet, line, &marks));
    let mut labels = Labels::new(&sheet, line, layout, field, Decimals::new(compiled, &[], &[], &[]));
    layout.obstacles.iter().zip(&names).for_each(|(obstacle, name)| labels.obstacle(obstacle, name));
    group.push(labels.finish());
    Ok((group, size))
}
