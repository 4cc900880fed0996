//! Surfaces in metres, z up: boxes that follow the centre line, upright boxes, and walls of an outline.

use crate::base::trig;
use crate::geometry::{CentreLine, Form, Frame, Point};
use nalgebra::Vector3;

/// Triangles with a normal at each corner; corners are not shared, so that edges stay sharp.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub positions: Vec<Vector3<f64>>,
    pub normals: Vec<Vector3<f64>>,
}

/// A cross-section of a box along the centre line: how far it reaches to either side, and from where to where in height, m.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    pub half_width: f64,
    pub low: f64,
    pub high: f64,
}

/// Curves are cut into straight parts that turn by this at most, rad.
const FINEST: f64 = 2.5 * trig::PI / 180.0;

impl Mesh {
    /// A flat piece with its corners in order, seen from outside against the clock.
    fn quad(&mut self, [a, b, c, d]: [Vector3<f64>; 4]) {
        let normal = (b - a).cross(&(d - a));
        let normal = if normal.norm() > 0.0 { normal.normalize() } else { Vector3::z() };
        self.positions.extend([a, b, c, a, c, d]);
        self.normals.extend([normal; 6]);
    }

    /// A box along the centre line from arc length `begin` on, m, closed at both ends.
    pub fn along(line: &CentreLine, begin: f64, length: f64, section: Section) -> Mesh {
        let corners = |frame: &Frame| {
            let at = |side: f64, height: f64| frame.position + frame.normal * side + frame.up * height;
            let Section { half_width: half, low, high } = section;
            // Seen in driving direction: bottom left, bottom right, top right, top left.
            [at(half, low), at(-half, low), at(-half, high), at(half, high)]
        };
        let rings: Vec<[Vector3<f64>; 4]> =
            places(line, begin, length).into_iter().map(|s| corners(&line.at(s))).collect();
        let mut mesh = Mesh::default();
        for pair in rings.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            for k in 0..4 {
                let next = (k + 1) % 4;
                mesh.quad([a[k], b[k], b[next], a[next]]);
            }
        }
        if let (Some(first), Some(last)) = (rings.first(), rings.last()) {
            let [a, b, c, d] = *first;
            mesh.quad([a, b, c, d]);
            let [a, b, c, d] = *last;
            mesh.quad([b, a, d, c]);
        }
        mesh
    }

    /// A box that stands upright on its middle, with one side along `heading`, rad; sizes along, across and up, m.
    pub fn block(foot: Vector3<f64>, heading: f64, [along, across, up]: [f64; 3]) -> Mesh {
        let frame = Frame::new(foot, heading, 0.0);
        let at = |a: f64, b: f64, c: f64| {
            foot + frame.tangent * (a * along / 2.0) + frame.normal * (b * across / 2.0) + Vector3::z() * (c * up)
        };
        let mut mesh = Mesh::default();
        for [a, b, c, d] in [
            [(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)],
            [(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)],
            [(-1, -1, 0), (1, -1, 0), (1, -1, 1), (-1, -1, 1)],
            [(1, 1, 0), (-1, 1, 0), (-1, 1, 1), (1, 1, 1)],
            [(1, -1, 0), (1, 1, 0), (1, 1, 1), (1, -1, 1)],
            [(-1, 1, 0), (-1, -1, 0), (-1, -1, 1), (-1, 1, 1)],
        ] {
            mesh.quad([a, b, c, d].map(|(x, y, z)| at(f64::from(x), f64::from(y), f64::from(z))));
        }
        mesh
    }

    /// Walls over an outline from the floor up, m; their outsides are those of the outline.
    pub fn walls(outline: &[Point], height: f64) -> Mesh {
        let area: f64 = (0..outline.len()).map(|i| outline[i].cross(outline[(i + 1) % outline.len()])).sum();
        let mut points = outline.to_vec();
        if area < 0.0 {
            points.reverse();
        }
        let mut mesh = Mesh::default();
        for i in 0..points.len() {
            let (a, b) = (points[i], points[(i + 1) % points.len()]);
            let at = |p: Point, z: f64| Vector3::new(p.x, p.y, z);
            mesh.quad([at(a, 0.0), at(b, 0.0), at(b, height), at(a, height)]);
        }
        mesh
    }

    /// Volume that the surface encloses, m³ (divergence theorem).
    #[cfg(test)]
    pub fn volume(&self) -> f64 {
        self.positions.chunks_exact(3).map(|t| t[0].dot(&t[1].cross(&t[2])) / 6.0).sum()
    }
}

/// Arc lengths at which a stretch is cut: at its ends, where the centre line's pieces meet, and within its curves.
fn places(line: &CentreLine, begin: f64, length: f64) -> Vec<f64> {
    let whole = line.length;
    let mut places = vec![begin, begin + length];
    for stretch in &line.stretches {
        let (from, own) = (stretch.s, stretch.form.length());
        let bend = match stretch.form {
            Form::Straight { .. } => 0.0,
            Form::Arc { turn, .. } | Form::Spiral { turn, .. } => turn.abs(),
            Form::Vertical { .. } => {
                let (low, high) = stretch.form.inclination();
                (high - low).abs()
            }
        };
        let parts = (bend / FINEST - 1e-9).ceil().max(1.0) as usize;
        // A stretch may pass the end of the line.
        for round in [0.0, whole] {
            let cuts = (0..=parts).map(|k| from + round + own * k as f64 / parts as f64);
            places.extend(cuts.filter(|s| *s > begin + 1e-9 && *s < begin + length - 1e-9));
        }
    }
    places.sort_by(f64::total_cmp);
    places.dedup_by(|a, b| *a - *b < 1e-9);
    places
}
