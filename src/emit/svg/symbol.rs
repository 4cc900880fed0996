//! Symbols of what stands on the track, alike on the drawing and in its legend.

use crate::base::trig;
use crate::emit::paper::PaperPoint;
use crate::emit::plan::MarkKind;

use super::place::PaperBox;
use super::sheet::{path, path_line, polygon};
use super::xml::XmlElement;

/// A place on the centre line, on paper.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    pub at: PaperPoint,
    /// Unit vector of travel.
    pub along: PaperPoint,
    /// Unit vector out of the loop.
    pub out: PaperPoint,
    /// Half the band's width, mm.
    pub half: f64,
}

impl Spot {
    fn point(&self, along: f64, out: f64) -> PaperPoint {
        self.at + self.along * along + self.out * out
    }

    fn rectangle(&self, along: f64, from: f64, to: f64) -> [PaperPoint; 4] {
        [self.point(-along, from), self.point(along, from), self.point(along, to), self.point(-along, to)]
    }

    fn taken(&self, along: f64, from: f64, to: f64) -> PaperBox {
        PaperBox {
            centre: self.point(0.0, (from + to) / 2.0),
            half: PaperPoint::new(along, (to - from).abs() / 2.0),
            axis: self.along,
        }
    }
}

/// A symbol and the paper it takes. Motors lie along the track and are drawn with it.
pub fn mark(kind: MarkKind, spot: &Spot, pitch: f64) -> (XmlElement, PaperBox) {
    let h = spot.half;
    match kind {
        MarkKind::Start => {
            let line = path_line(spot.point(0.0, -h - 2.5), spot.point(0.0, h + 2.5));
            (path(&line, "start"), spot.taken(0.6, -h - 2.5, h + 2.5))
        }
        MarkKind::Photocell => {
            let beam = path_line(spot.point(0.0, -h - 1.5), spot.point(0.0, h + 1.5));
            let eye = spot.point(0.0, h + 2.5);
            let mut group = XmlElement::group("photocell-mark").with(path(&beam, "photocell"));
            group.push(circle(eye, 1.0, "photocell"));
            group.push(path(&path_line(spot.point(-0.8, -h - 1.5), spot.point(0.8, -h - 1.5)), "photocell"));
            (group, spot.taken(1.2, -h - 1.7, h + 3.7))
        }
        MarkKind::Induction => {
            let points = [spot.point(0.0, h + 0.5), spot.point(1.8, h + 4.5), spot.point(-1.8, h + 4.5)];
            (path(&polygon(&points), "induction"), spot.taken(2.0, h, h + 4.8))
        }
        MarkKind::Chute => {
            let half = (0.35 * pitch).clamp(0.5, 1.5);
            let points = [
                spot.point(-half, h),
                spot.point(half, h),
                spot.point(0.6 * half, h + 3.5),
                spot.point(-0.6 * half, h + 3.5),
            ];
            (path(&polygon(&points), "chute"), spot.taken(half + 0.2, h, h + 3.8))
        }
        MarkKind::Station => {
            let points = spot.rectangle(1.5, h + 0.3, h + 3.3);
            (path(&polygon(&points), "photocell"), spot.taken(1.7, h, h + 3.5))
        }
        MarkKind::Motor => {
            let points = spot.rectangle(2.5, -0.45 * h, 0.45 * h);
            (path(&polygon(&points), "motor"), spot.taken(2.5, -0.45 * h, 0.45 * h))
        }
        MarkKind::Support => {
            let squares = [-h, h].map(|out| polygon(&spot.rectangle(0.55, out - 0.55, out + 0.55))).concat();
            (path(&squares, "support"), spot.taken(0.8, -h - 0.8, h + 0.8))
        }
    }
}

pub fn circle(centre: PaperPoint, radius: f64, class: &str) -> XmlElement {
    XmlElement::new("circle").attr("class", class).num("cx", centre.x).num("cy", centre.y).num("r", radius)
}

/// A filled arrow head with its tip at `tip`.
pub fn arrow(tip: PaperPoint, along: PaperPoint, length: f64, width: f64) -> String {
    let base = tip - along * length;
    let across = along.across() * (width / 2.0);
    polygon(&[tip, base + across, base - across])
}

/// A vertex: an upright cross.
pub fn cross(at: PaperPoint, half: f64) -> String {
    path_line(at - PaperPoint::new(half, 0.0), at + PaperPoint::new(half, 0.0))
        + &path_line(at - PaperPoint::new(0.0, half), at + PaperPoint::new(0.0, half))
}

/// The directions of x and y on the floor.
pub fn axes(at: PaperPoint) -> XmlElement {
    let (x, y) = (at + PaperPoint::new(12.0, 0.0), at - PaperPoint::new(0.0, 12.0));
    let mut group = XmlElement::group("axes");
    group.push(path(&(path_line(at, x) + &path_line(at, y)), "rule"));
    let tips = arrow(x, PaperPoint::unit(0.0), 2.5, 1.4) + &arrow(y, PaperPoint::unit(-trig::FRAC_PI_2), 2.5, 1.4);
    group.push(path(&tips, "dimension-arrow"));
    let height = super::text::Height::H25;
    group.push(super::text::centred(x + PaperPoint::new(2.2, 0.0), 0.0, "x", height, ""));
    group.push(super::text::centred(y - PaperPoint::new(0.0, 2.6), 0.0, "y", height, ""));
    group.push(circle(at, 0.5, "dimension-arrow"));
    group
}
