//! What a whole number of carts leaves over on a solved layout, where that is more than the take-up compensates.

use crate::base::number::tenths_of_mm;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{CentreLine, Point, Track};
use crate::kinematics::{Fit, better_length};
use crate::model::{ConstraintKind, FixKind, Layout};

/// The warning that the chain does not fit, with what would make it fit.
pub fn left_over(layout: &Layout, track: &Track, line: &CentreLine, found: Option<Fit>) -> Option<Diagnostic> {
    let take_up = layout.take_up_travel();
    if found.is_some_and(|fit| fit.is_within(take_up)) {
        return None;
    }
    let pitch = layout.cart.length;
    let (message, label, left) = match found {
        Some(Fit { carts, left_over }) => {
            let (size, too) = (tenths_of_mm(left_over.abs()), if left_over > 0.0 { "long" } else { "short" });
            (
                format!("the chain does not fit: {carts} carts leave {} over", tenths_of_mm(left_over)),
                format!("for {carts} carts of {}, the track is {size} too {too}", tenths_of_mm(pitch)),
                format!("{} left over", tenths_of_mm(left_over)),
            )
        }
        None => {
            let label = format!("carts of {}", tenths_of_mm(pitch));
            ("no chain of these carts closes on this track".to_owned(), label, "no chain that closes".to_owned())
        }
    };
    let help = match (close(layout, track, found), other(layout, line)) {
        (Some(close), Some(other)) => format!("{close}, or {other}"),
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => "give a section some freedom, so that the track can be lengthened".to_owned(),
    };
    let whose = match &layout.take_up {
        Some(own) => format!("`{}`", own.name),
        None => format!("of catalogue `{}`", layout.catalog.name),
    };
    let expected = format!("at most {}, which the take-up {whose} compensates", tenths_of_mm(take_up));
    Some(Diagnostic::new(Code::W0712, message, layout.cart.span, label).expected(expected, left).help(help))
}

/// How this track could get a length that closes.
fn close(layout: &Layout, track: &Track, found: Option<Fit>) -> Option<String> {
    let closes = format!("`chain closes within {}`", tenths_of_mm(layout.take_up_travel()));
    if layout.objective.terms.is_empty() {
        return lengthen(layout, track, found?.left_over);
    }
    Some(format!("write {closes}: the compiler then looks for a track that does"))
}

/// Two sections, and by how much to change them.
pub(super) fn lengthen(layout: &Layout, track: &Track, left_over: f64) -> Option<String> {
    let pitch = layout.cart.length;
    let (longer, shorter) =
        if left_over > 0.0 { (pitch - left_over, left_over) } else { (-left_over, pitch + left_over) };
    let [a, b] = opposite(layout, track)?.map(|section| layout.section_name(section));
    Some(format!(
        "lengthen {a} and {b} by {} each, or shorten both by {}",
        tenths_of_mm(0.5 * longer),
        tenths_of_mm(0.5 * shorter)
    ))
}

/// More carts than this are not tried with other lengths: each of them would have to be closed anew.
const MOST_CARTS: f64 = 5000.0;

/// Another cart of the product line that fits better.
fn other(layout: &Layout, line: &CentreLine) -> Option<String> {
    let cart = &layout.cart;
    let shortest = cart.lengths.iter().copied().fold(cart.length, f64::min);
    if line.length > MOST_CARTS * shortest {
        return None;
    }
    let (length, fit) = better_length(line, cart.length, &cart.lengths, layout.take_up_travel())?;
    Some(format!(
        "take carts of {}: {} of them leave {} over on this track",
        tenths_of_mm(length),
        fit.carts,
        tenths_of_mm(fit.left_over)
    ))
}

/// The two sections whose lengths may change and that run against each other most nearly, the longer ones of like
/// pairs.
pub(super) fn opposite(layout: &Layout, track: &Track) -> Option<[usize; 2]> {
    let held = |i: usize| {
        layout.constraints.iter().any(|c| match &c.kind {
            ConstraintKind::FixSection { target, kinds } => target.from == i && kinds.contains(&FixKind::Length),
            _ => false,
        })
    };
    let n = track.corners.len();
    let along = |i: usize| Point::unit(track.straight(i).heading);
    let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| [a, b])).filter(|p| !p.iter().any(|&i| held(i)));
    let order = |p: &[usize; 2]| {
        let against = (1e6 * along(p[0]).dot(along(p[1]))).round();
        (against, -track.straight(p[0]).length - track.straight(p[1]).length)
    };
    pairs.min_by(|a, b| order(a).0.total_cmp(&order(b).0).then(order(a).1.total_cmp(&order(b).1)))
}
