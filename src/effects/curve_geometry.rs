//! A curve that was built otherwise: bowed, with another radius, with another heading behind it, or with transitions.
//!
//! Where it is bowed, its rails lie off the centre line by y sin²(πd/l) over the curve's length l, whose curvature
//! differs by −y″, so more in the middle and less at its ends. Another radius or turn is another centre line, between
//! the same straights, which become longer or shorter ([`super::rebuilt`]); where a curve turns more, the next one
//! turns less. With transitions of length a, curvature comes and goes linearly over a around each of the curve's ends
//! (a clothoid to the first order in a/R; Esveld 2001), which shifts its middle inwards by a²/(24R).
//!
//! Signature: steering forces of one curve; with another heading those of the next one, too; and, as the way between
//! curves is another, joint_xi as carts pass.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, add_profile, rebuilt, sites};
use crate::base::trig;
use crate::chain_input::{CentreLinePiece, Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::CURVE_GEOMETRY,
    discrepancy: super::ASSUMED,
    fitted: &[
        StrengthSearch::alone(1e-3, 0.0),
        StrengthSearch::alone(0.02, 1e-3),
        StrengthSearch::alone(2e-3, 1.5e-4),
        StrengthSearch::alone(0.3, 0.0),
    ],
    sites: Sites::Listed(sites::each_curve),
    several: true,
    separated_by: Experiment::Runs,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let curves = sites::curves(simulation);
    let Some((_, from, to)) = curves.get(strengths.index("curve")).copied() else { return };
    let (offset, transition) = (strengths.of("offset"), strengths.of("transition"));
    let lap = simulation.track.centre_line().length;
    if offset != 0.0 {
        add_profile(&mut deviations.rails[0], lap, |s| {
            if !(from..to).contains(&s) {
                return 0.0;
            }
            let sin = trig::sin(trig::PI * (s - from) / (to - from));
            offset * sin * sin
        });
    }
    let pieces = rebuilt::between(&simulation.track, from, to);
    if transition > 0.0 {
        // Of a curve of several radii, the mean one; and no more than half of the curve at each end.
        let turn: f64 = simulation.track.elements[pieces.clone()].iter().map(|p| p.form().turn()).sum();
        let (length, curvature) = (transition.min(to - from), turn / (to - from));
        add_profile(&mut deviations.rails[0], lap, |s| {
            // From the nearer end of the curve, inside.
            let wrapped = |x: f64| x - lap * (x / lap).round();
            let inside = wrapped(s - 0.5 * (from + to)).abs();
            curvature * shifted(0.5 * (to - from) - inside, length)
        });
    }
    let (radius_more, heading) = (strengths.of("radius"), strengths.of("heading").to_degrees());
    if radius_more != 0.0 || heading != 0.0 {
        let next = curves.get((strengths.index("curve") + 1) % curves.len()).copied();
        let next = next.filter(|_| curves.len() > 1).map(|(_, a, b)| rebuilt::between(&simulation.track, a, b));
        for piece in &mut simulation.track.elements[pieces.clone()] {
            if let CentreLinePiece::Arc { radius, .. } | CentreLinePiece::Spiral { radius, .. } = piece {
                *radius = (*radius + radius_more).max(0.1);
            }
        }
        let mut changed = vec![pieces.clone()];
        if let Some(next) = next.filter(|_| heading != 0.0) {
            rebuilt::turn_more(&mut simulation.track.elements[pieces.clone()], heading);
            rebuilt::turn_more(&mut simulation.track.elements[next.clone()], -heading);
            changed.push(next);
        }
        rebuilt::close(&mut simulation.track, &changed);
    }
}

/// How far a transition of a length lies inwards of an arc of curvature 1, where so far inside its end.
fn shifted(inside: f64, length: f64) -> f64 {
    let along = (inside + 0.5 * length).clamp(0.0, length);
    let within = inside.clamp(0.0, 0.5 * length);
    // Where curvature grows linearly, less where the arc would be.
    along * along * along / (6.0 * length) - 0.5 * within * within
}
