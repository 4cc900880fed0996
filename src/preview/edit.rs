//! The coordinates of a vertex in a text: where their digits stand, and the text with others in their place.

use crate::base::number::{fixed, trimmed};
use crate::base::trig;
use crate::geometry::Point;
use crate::semantics::dimension::parse_unit;
use crate::source::Span;
use crate::syntax::tree::{Expr, ExprKind, Item, Statement, Tree};
use std::ops::Range;

/// Coordinates are written to this, m, or finer where they were.
const RESOLUTION: f64 = 1e-3;

/// Decimals that are kept as they are written, at most.
const MOST_KEPT: usize = 6;

/// A number with a unit, as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Its digits with the sign before them, bytes of the text.
    digits: Range<usize>,
    decimals: usize,
    /// m of one of its unit.
    factor: f64,
}

impl Written {
    /// `None` of what is worked out by a formula.
    fn of(expr: &Expr) -> Option<Written> {
        let (number, negative) = match &expr.kind {
            ExprKind::Negative(inner) => (inner.as_ref(), true),
            _ => (expr, false),
        };
        let ExprKind::Number { digits, unit: Some(unit) } = &number.kind else { return None };
        let factor = parse_unit(&unit.text).ok()?.factor;
        let start = number.span.start as usize;
        let begin = if negative { expr.span.start as usize } else { start };
        let decimals = digits.split(['e', 'E']).next()?.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        Some(Written { digits: begin..start + digits.len(), decimals, factor })
    }

    /// A length (m) in its unit: with as many decimals as are written, and more down to a millimetre where they say
    /// something.
    fn text(&self, metres: f64) -> String {
        let needed = trig::log10(self.factor / RESOLUTION).ceil().max(0.0) as usize;
        let value = metres / self.factor;
        // With all the digits of a computed coordinate nobody says how exact the new one is to be.
        let written = if self.decimals > MOST_KEPT { 0 } else { self.decimals };
        let text = trimmed(value, needed.max(written));
        let has = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        if has < written { fixed(value, written) } else { text }
    }
}

/// Where the coordinates of a vertex are written, each unless a formula works it out.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinates {
    pub x: Option<Written>,
    pub y: Option<Written>,
}

/// The coordinates that stand at a place of a file, which is that of a vertex' point.
pub fn coordinates(tree: &Tree, point: Span) -> Option<Coordinates> {
    if tree.file != point.file {
        return None;
    }
    let layouts =
        tree.items.iter().filter_map(|item| if let Item::Layout(layout) = item { Some(layout) } else { None });
    let mut points = layouts.flat_map(|layout| layout.body.iter()).filter_map(|statement| match statement {
        Statement::Vertex { point, .. } => Some(point),
        _ => None,
    });
    let found = points.find(|own| own.span == point)?;
    Some(Coordinates { x: Written::of(&found.x), y: Written::of(&found.y) })
}

/// A text with a vertex at another place (m). Nothing differs but the digits of those coordinates that are written as
/// numbers, and that change.
pub fn moved(text: &str, at: &Coordinates, from: Point, to: Point) -> String {
    let mut out = text.to_owned();
    let mut places: Vec<(&Written, f64, f64)> = Vec::new();
    places.extend(at.x.iter().map(|x| (x, from.x, to.x)));
    places.extend(at.y.iter().map(|y| (y, from.y, to.y)));
    // From behind, so that places before stay where they are.
    places.sort_by_key(|(written, ..)| std::cmp::Reverse(written.digits.start));
    for (written, from, to) in places {
        let digits = written.text(to);
        if digits != written.text(from) && out.get(written.digits.clone()).is_some() {
            out.replace_range(written.digits.clone(), &digits);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Layout;
    use crate::semantics::{Checked, Study};
    use crate::source::Overlay;
    use proptest::prelude::*;
    use std::path::Path;
    use std::sync::Arc;

    fn checked(text: &str) -> Study {
        let overlay: Overlay = [("drag.lss".into(), text.to_owned())].into();
        Checked::new(Path::new("drag.lss"), &Arc::new(overlay)).study.expect("a study")
    }

    fn layout(study: &Study) -> &Layout {
        study.analysis.layouts.first().unwrap_or_else(|| panic!("{:?}", study.analysis.diagnostics))
    }

    /// A layout whose second vertex stands at these words.
    fn text(x: &str, y: &str) -> String {
        format!(
            "// A hall
use std.carts.tilt_tray
use std.tracks.standard
let far = 30 m

layout hall {{
  catalog standard
  cart tilt_tray
  speed 2 m/s
  width 1.2 m
  vertex P1 (-30 m, -10 m) radius 3 m
  vertex   P2 ({x} ,   {y})   radius 4 m // the corner
  vertex P3 (30 m, 20 m)
  vertex P4 (-30 m, 20 m)
  optimise nothing
}}
"
        )
    }

    /// The text with the vertex elsewhere, and where the vertex then is.
    fn after(before: &str, to: Point) -> (String, Point) {
        let study = checked(before);
        let vertex = &layout(&study).vertices[1];
        let at = coordinates(&study.files[0].tree, vertex.point_span).expect("coordinates");
        let text = moved(before, &at, vertex.point, to);
        let again = checked(&text);
        let point = layout(&again).vertices[1].point;
        (text, point)
    }

    #[test]
    fn units_decimals_and_signs_stay_as_they_are_written() {
        for ([x, y], to, [new_x, new_y]) in [
            (["30 m", "0 m"], (31.25, -0.5), ["31.25 m", "-0.5 m"]),
            (["30.0 m", "0.00 m"], (31.0, 2.0), ["31.0 m", "2.00 m"]),
            (["30000 mm", "-5 cm"], (31.25, 0.125), ["31250 mm", "12.5 cm"]),
            (["- 3 m", "0m"], (-2.0, 1.0), ["-2 m", "1m"]),
            (["-3 m", "0m"], (2.0, 1.0), ["2 m", "1m"]),
            (["3e1 m", "0 m"], (30.0, 1.0), ["3e1 m", "1 m"]),
            (["3e1 m", "0 m"], (31.0, 0.0), ["31 m", "0 m"]),
            // A formula stays.
            (["far", "0 m"], (31.0, 1.0), ["far", "1 m"]),
            (["far - 1 m", "(2 m)"], (31.0, 1.0), ["far - 1 m", "(2 m)"]),
            // Finer than a millimetre only where it was written so.
            (["30 m", "0.00000 m"], (29.123_456, 0.123_456), ["29.123 m", "0.12346 m"]),
            (["7.792036732051 m", "0.0000000 m"], (11.4, 1.25), ["11.4 m", "1.25 m"]),
        ] {
            let (found, _) = after(&text(x, y), Point::new(to.0, to.1));
            assert_eq!(found, text(new_x, new_y));
        }
    }

    #[test]
    fn vertices_of_other_layouts_are_found_where_they_are_written() {
        let base = text("30 m", "0 m");
        let both = format!("{base}\nlayout other from hall {{ vertex P3 (31 m, 20 m) radius 3 m }}\n");
        let study = checked(&both);
        let other = study.analysis.layouts.iter().find(|l| l.name == "other").expect("the variant");
        let at = coordinates(&study.files[0].tree, other.vertices[1].point_span).expect("of the base");
        assert_eq!(moved(&both, &at, Point::new(30.0, 0.0), Point::new(29.0, 0.0)), both.replace("(30 m ,", "(29 m ,"));
        let own = coordinates(&study.files[0].tree, other.vertices[2].point_span).expect("its own");
        let moved = moved(&both, &own, Point::new(31.0, 20.0), Point::new(31.0, 19.0));
        assert_eq!(moved, both.replace("(31 m, 20 m)", "(31 m, 19 m)"));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

        /// Whatever is written: two numbers change and nothing else, and reading them gives the new place.
        #[test]
        fn only_two_numbers_change_and_read_back(
            x in -40.0..60.0_f64,
            y in -40.0..10.0_f64,
            units in [0..3_usize, 0..3_usize],
            decimals in [0..5_usize, 0..5_usize],
            to in (20.0..60.0_f64, -40.0..-1.0_f64),
        ) {
            let names = ["mm", "cm", "m"];
            let scale = [1e-3, 1e-2, 1.0];
            let word = |value: f64, k: usize| {
                format!("{:.*} {}", decimals[k], value / scale[units[k]], names[units[k]])
            };
            let before = text(&word(x, 0), &word(y, 1));
            // A vertex that makes no loop with its neighbours is no vertex that could be dragged.
            let study = checked(&before);
            prop_assume!(!study.analysis.has_errors());
            let to = Point::new(to.0, to.1);
            let (found, point) = after(&before, to);
            let (head, tail) = before.split_at(before.find("P2 (").unwrap() + 4);
            prop_assert!(found.starts_with(head));
            let inside = &found[head.len()..];
            let (new, rest) = inside.split_at(inside.find(')').unwrap());
            prop_assert_eq!(rest, &tail[tail.find(')').unwrap()..]);
            let parts: Vec<&str> = new.split(" ,   ").collect();
            prop_assert_eq!(parts.len(), 2);
            for (k, (part, wanted)) in parts.iter().zip([to.x, to.y]).enumerate() {
                let (digits, unit) = part.split_once(' ').unwrap();
                prop_assert_eq!(unit, names[units[k]]);
                prop_assert!((digits.parse::<f64>().unwrap() * scale[units[k]] - wanted).abs() <= 0.5e-3 + 1e-12);
            }
            prop_assert!(point.distance(to) < 1e-3);
        }
    }
}
