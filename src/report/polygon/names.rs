//! What straights and curves are called: by the layout's vertices where it is known, else by number.

use crate::base::number::fixed;
use crate::compiled::Compiled;
use crate::geometry::{CentreLine, Form, Point};
use crate::kinematics::polygon::{Bend, Course};

/// A fillet begins this near to where its curve does, m.
const NEAR: f64 = 1e-3;

/// Where each vertex' fillet begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Names {
    vertices: Vec<(String, Point)>,
}

impl Names {
    /// The layout's own.
    pub fn of(compiled: &Compiled) -> Self {
        let names = compiled.layout.vertices.iter().map(|v| v.name.clone());
        Names { vertices: names.zip(compiled.track.fillets.iter().map(|f| f.begin)).collect() }
    }

    /// Of the curves of a course on its centre line.
    pub fn curves(&self, line: &CentreLine, course: &Course) -> Vec<String> {
        let mut plain = 0;
        let mut name = |bend: &Bend| {
            let at = line.at(bend.s).position;
            let at = Point::new(at.x, at.y);
            let turns = bend.forms.iter().any(|f| f.turn() != 0.0);
            let vertex = self.vertices.iter().find(|(_, begin)| turns && begin.distance(at) < NEAR);
            match vertex {
                Some((name, _)) => name.clone(),
                None if self.vertices.is_empty() => {
                    plain += 1;
                    format!("C{plain}")
                }
                None => format!("{} at {} m", kind(bend), fixed(bend.s, 1)),
            }
        };
        course.curves.iter().map(&mut name).collect()
    }

    /// Of its straights, by the curves at both ends.
    pub fn straights(&self, course: &Course, curves: &[String]) -> Vec<String> {
        let n = course.len();
        let known = |name: &String| self.vertices.iter().any(|(v, _)| v == name);
        (0..n)
            .map(|k| match (&curves[(k + n - 1) % n], &curves[k]) {
                (from, to) if known(from) && known(to) => format!("{from}..{to}"),
                _ if self.vertices.is_empty() => format!("S{}", k + 1),
                _ => format!("s {} m", fixed(course.begins[k], 1)),
            })
            .collect()
    }
}

fn kind(bend: &Bend) -> &'static str {
    match bend.forms.first() {
        Some(Form::Vertical { .. }) => "slope",
        Some(Form::Spiral { .. }) => "spiral",
        _ => "curve",
    }
}
