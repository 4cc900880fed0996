//! Obstacles: hatched areas whose hatching is interrupted for their names.

use crate::emit::paper::PaperPoint;
use crate::emit::plan;
use crate::geometry::Point;
use crate::model::{Layout, Obstacle};

use super::place::{LabelCandidate, Layer, PaperBox, TakenPaper, around};
use super::sheet::{Sheet, path, polygon};
use super::text::{self, Height};
use super::track::curves;
use super::xml::XmlElement;

/// Longest name, mm; longer ones are cut.
const LONGEST: f64 = 70.0;
/// Room around a name in the hatching, mm.
const ROOM: f64 = 0.8;
/// Places across an obstacle at which its name is tried.
const TRIED: usize = 5;

/// An obstacle's name, and where it stands in the hatching when it has room there.
pub struct ObstacleName {
    pub text: String,
    /// Width and height of the text's box, mm.
    pub size: PaperPoint,
    pub inside: Option<PaperBox>,
}

/// Places the names that have room in their obstacles, and takes the paper that is hatched: of obstacles and walls.
pub fn names(sheet: &Sheet, layout: &Layout, field: &mut TakenPaper) -> Vec<ObstacleName> {
    let outlines: Vec<Vec<PaperPoint>> = layout.obstacles.iter().map(|o| outline(sheet, o)).collect();
    let mut names: Vec<ObstacleName> = Vec::new();
    for (i, obstacle) in layout.obstacles.iter().enumerate() {
        let text = text::fitted(&obstacle.name, Height::H25, false, LONGEST);
        let size = PaperPoint::new(text::width(&text, Height::H25.size(), false) + 1.6, 1.24 * Height::H25.size());
        let free = |item: &PaperBox| {
            let item = PaperBox { half: item.half + PaperPoint::new(ROOM, ROOM), ..*item };
            let (inside, clear) = (is_within(&item, sheet, obstacle), |outline: &Vec<PaperPoint>| {
                edges(outline).all(|edge| !item.meets(&edge))
            });
            inside
                && outlines.iter().enumerate().all(|(j, other)| {
                    clear(other) && (i == j || !layout.obstacles[j].polygon.contains(sheet.floor(item.centre)))
                })
        };
        let candidates: Vec<LabelCandidate> =
            places(sheet, obstacle, size).into_iter().filter(|candidate| free(&candidate.text)).collect();
        let inside = field.place(&candidates).map(|chosen| chosen.text);
        names.push(ObstacleName { text, size, inside });
    }
    for outline in &outlines {
        field.add_area(outline, Layer::Hatch);
    }
    names
}

/// Places in the obstacle, its middle first.
fn places(sheet: &Sheet, obstacle: &Obstacle, size: PaperPoint) -> Vec<LabelCandidate> {
    let (low, high) = obstacle.polygon.bounds();
    let mut candidates = Vec::new();
    for row in 0..TRIED {
        for column in 0..TRIED {
            let at = |k: usize| (k as f64 + 1.0) / (TRIED as f64 + 1.0);
            let p = Point::new(low.x + (high.x - low.x) * at(column), low.y + (high.y - low.y) * at(row));
            let aside = (at(row) - 0.5).abs() + (at(column) - 0.5).abs();
            candidates.push(LabelCandidate::text(PaperBox::upright(sheet.at(p), size.x, size.y), aside));
        }
    }
    candidates
}

fn is_within(item: &PaperBox, sheet: &Sheet, obstacle: &Obstacle) -> bool {
    item.corners().iter().all(|p| obstacle.polygon.contains(sheet.floor(*p)))
}

fn outline(sheet: &Sheet, obstacle: &Obstacle) -> Vec<PaperPoint> {
    obstacle.polygon.points().iter().map(|p| sheet.at(*p)).collect()
}

fn edges(outline: &[PaperPoint]) -> impl Iterator<Item = PaperBox> + '_ {
    (0..outline.len()).map(|i| PaperBox::line(outline[i], outline[(i + 1) % outline.len()], 0.1))
}

/// The obstacles with their clearances.
pub fn draw(sheet: &Sheet, layout: &Layout, names: &[ObstacleName]) -> XmlElement {
    let mut group = XmlElement::group("obstacles");
    for (obstacle, name) in layout.obstacles.iter().zip(names) {
        let outline = polygon(&outline(sheet, obstacle));
        let hole = name.inside.map_or(String::new(), |item| polygon(&item.corners()));
        group.push(path(&(outline.clone() + &hole), "obstacle-hatch"));
        group.push(path(&outline, "obstacle"));
        let clear = plan::outset(&obstacle.polygon, obstacle.clearance);
        if !clear.is_empty() {
            group.push(path(&curves(sheet, &clear), "clearance"));
        }
    }
    group
}

/// Places around an obstacle for a name that has no room in it, and points on its outline from which leaders may start.
pub fn beside(sheet: &Sheet, obstacle: &Obstacle, name: &ObstacleName) -> (Vec<LabelCandidate>, Vec<PaperPoint>) {
    let outline = outline(sheet, obstacle);
    let middle = outline.iter().fold(PaperPoint::default(), |sum, p| sum + *p) * (1.0 / outline.len() as f64);
    let (mut candidates, mut anchors) = (Vec::new(), Vec::new());
    for i in 0..outline.len() {
        let (a, b) = (outline[i], outline[(i + 1) % outline.len()]);
        let anchor = a.lerp(b, 0.5);
        let out = anchor - middle;
        let prefer = if out.norm() > 1e-9 { out * (1.0 / out.norm()) } else { PaperPoint::new(0.0, -1.0) };
        candidates.extend(around(anchor, prefer, name.size, 1.0, 12.0));
        anchors.push(anchor);
        if i == 40 {
            break;
        }
    }
    (candidates, anchors)
}
