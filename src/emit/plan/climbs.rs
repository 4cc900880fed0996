//! Where the track climbs and where it lies level, in the plan.

use crate::base::number::fixed;
use crate::compiled::Compiled;
use crate::geometry::{Form, Stretch};

/// A part of the track that climbs, or that lies at one height.
#[derive(Clone, Debug, PartialEq)]
pub struct Climb {
    /// Arc length of the plan where it begins, from vertex 0's outgoing tangent point, m.
    pub s: f64,
    /// In the plan, m.
    pub run: f64,
    /// Where a label belongs: the middle of a climb, of the longest straight of a level, as `s`.
    pub middle: f64,
    /// Heights at both ends, m.
    pub from: f64,
    pub to: f64,
    /// Rise over run, of the part between the vertical curves; 0 where level.
    pub slope: f64,
    /// Whether it leads through curves, which are then spirals.
    pub spiral: bool,
}

impl Climb {
    pub fn is_level(&self) -> bool {
        self.slope == 0.0
    }

    /// `ramp up 14 %: 1.0 → 2.6 m`, `level 1.0 m`, with so many decimals of slopes and heights.
    pub fn text(&self, slopes: usize, heights: usize) -> String {
        if self.is_level() {
            return format!("level {} m", fixed(self.from, heights));
        }
        let what = if self.spiral { "ramp with spiral" } else { "ramp" };
        let way = if self.slope > 0.0 { "up" } else { "down" };
        let percent = fixed(100.0 * self.slope.abs(), slopes);
        format!("{what} {way} {percent} %: {} → {} m", fixed(self.from, heights), fixed(self.to, heights))
    }
}

/// Climbs and levels in driving order; none where the layout has no levels.
pub fn climbs(compiled: &Compiled) -> Vec<Climb> {
    if !compiled.raised() {
        return Vec::new();
    }
    let mut parts: Vec<Climb> = Vec::new();
    let mut last = None;
    // Of the longest straight of each part, m.
    let mut longest: Vec<f64> = Vec::new();
    let mut s = compiled.space.plan_begin();
    for stretch in &compiled.space.line.stretches {
        let (sign, slope) = way(&stretch.form);
        let (to, run) = (stretch.at(stretch.length).position.z, stretch.form.run());
        let spiral = matches!(stretch.form, Form::Spiral { .. });
        match parts.last_mut().filter(|_| last == Some(sign)) {
            Some(part) => {
                part.run += run;
                part.to = to;
                part.spiral |= spiral;
                if slope.abs() > part.slope.abs() {
                    part.slope = slope;
                }
            }
            None => {
                let from = stretch.begin.position.z;
                longest.push(0.0);
                parts.push(Climb { s, run, middle: s + run / 2.0, from, to, slope, spiral });
            }
        }
        if let (Some(part), Some(longest)) = (parts.last_mut(), longest.last_mut()) {
            if sign != 0 {
                part.middle = part.s + part.run / 2.0;
            } else if is_straight(stretch) && run > *longest {
                (*longest, part.middle) = (run, s + run / 2.0);
            }
        }
        last = Some(sign);
        s += run;
    }
    // The loop closes: a level that the list's end cuts is one.
    if let [first, .., end] = parts.as_mut_slice()
        && first.is_level()
        && end.is_level()
    {
        (first.s, first.run) = (end.s, first.run + end.run);
        if longest.last() > longest.first() {
            first.middle = end.middle;
        }
        parts.pop();
    }
    parts
}

fn is_straight(stretch: &Stretch) -> bool {
    matches!(stretch.form, Form::Straight { .. })
}

/// Whether a form leads up (1), down (-1) or neither, and the slope that it has throughout.
fn way(form: &Form) -> (i8, f64) {
    let sign = |slope: f64| if slope == 0.0 { 0 } else { slope.signum() as i8 };
    match *form {
        Form::Straight { slope, .. } => (sign(slope), slope),
        Form::Arc { .. } => (0, 0.0),
        Form::Vertical { slope_from, slope_to, .. } => {
            // The steeper end says which climb a vertical curve belongs to; it has that slope where it is all there is.
            let slope = if slope_to.abs() > slope_from.abs() { slope_to } else { slope_from };
            (sign(slope), slope)
        }
        Form::Spiral { radius, turn, rise } => {
            let slope = rise / (radius * turn.abs());
            (sign(slope), slope)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::plan::samples;

    #[test]
    fn parts_follow_each_other_around_the_loop() {
        let compiled = samples::raised();
        let parts = climbs(&compiled);
        let run: f64 = parts.iter().map(|part| part.run).sum();
        assert!((run - compiled.track.length).abs() < 1e-6, "{run} {}", compiled.track.length);
        for (i, part) in parts.iter().enumerate() {
            let next = &parts[(i + 1) % parts.len()];
            assert!((part.to - next.from).abs() < 1e-9, "{part:?} {next:?}");
            assert!(!(part.is_level() && next.is_level()), "{part:?} {next:?}");
            assert_eq!(part.slope > 0.0, part.to > part.from + 1e-9, "{part:?}");
            assert!((part.middle - part.s).rem_euclid(compiled.track.length) <= part.run, "{part:?}");
        }
    }
}
