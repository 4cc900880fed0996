//! The rules by which a channel looks wrong.

use super::super::gaps::Gaps;
use super::super::measures::Statistics;
use super::super::position::Position;
use super::super::{Channel, Run};
use crate::base::number::{fixed, shortest, trimmed};
use crate::chain_input::Simulation;
use crate::geometry::Form;
use std::collections::BTreeMap;

/// Different values that the last digits of a constant may take.
pub const DEAD: usize = 5;
/// Samples in a row at an extreme value, from which on it is a limit.
pub const CLIPPED_ROW: usize = 5;
/// Samples in all at an extreme value, from which on it is a limit.
pub const CLIPPED: usize = 20;
/// Share by which wheels may turn slower or faster than the trigger has it.
pub const SLIP: f64 = 0.03;

/// What the values of one channel look like.
pub fn channel(channel: Channel, samples: &[f64]) -> Option<String> {
    let turns = Channel::WheelSpeedSteerLeft <= channel && channel <= Channel::WheelSpeedRunRight;
    if !channel.is_force() && !turns {
        return None;
    }
    // How often each value was recorded, in order; negative zero is zero.
    let mut sorted: Vec<f64> = samples.iter().filter(|x| !x.is_nan()).map(|x| x + 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    let counts = || sorted.chunk_by(|a, b| a == b).map(|same| (same[0], same.len()));
    if sorted.len() >= 100 && counts().take(DEAD + 1).count() <= DEAD {
        let unit = channel.unit();
        let (low, high) = (shortest(*sorted.first()?), shortest(*sorted.last()?));
        let stays = if low == high {
            format!("stays at {low} {unit}")
        } else {
            format!("only goes from {low} to {high} {unit}")
        };
        return Some(format!("{channel} looks dead: it {stays}"));
    }
    let ends = [counts().take(2).collect::<Vec<_>>(), counts().rev().take(2).collect()];
    ends.iter().find_map(|end| {
        let [(value, times), (_, beside)] = end[..] else { return None };
        let row = samples.chunk_by(|a, b| a == b).filter(|same| same[0] == value).map(<[f64]>::len).max()?;
        let limit = value != 0.0 && row >= CLIPPED_ROW && times >= CLIPPED && times > 3 * beside;
        limit.then(|| {
            let value = shortest(value);
            let unit = channel.unit();
            format!("{channel} looks clipped: it is at {value} {unit} in {times} samples, up to {row} in a row")
        })
    })
}

/// Whether a layout loads a wheel: curves press the steering wheel on their inner side.
pub fn loaded(channel: Channel, layout: &Simulation) -> bool {
    let side = match channel {
        Channel::SteerLeft => 1.0,
        Channel::SteerRight => -1.0,
        _ => return true,
    };
    layout.track.elements.iter().any(|piece| piece.form().turn() * side > 0.0)
}

/// What the mean forces of the joint look like.
pub fn joint(levels: &BTreeMap<Channel, Statistics>) -> Option<String> {
    let xi = levels.get(&Channel::JointXi)?.mean;
    [Channel::JointEta, Channel::JointZeta].into_iter().find_map(|other| {
        let pull = levels.get(&other)?.mean;
        (pull > 0.0 && xi < 0.25 * pull).then(|| {
            let (xi, pull) = (trimmed(xi, 1), trimmed(pull, 1));
            format!(
                "joint_xi and {other} look exchanged: their means are {xi} N and {pull} N, but a chain is under tension"
            )
        })
    })
}

/// Whether both ways to the speed agree.
pub fn speeds(trigger: Option<f64>, wheels: Option<f64>) -> Option<String> {
    let (trigger, wheels) = (trigger?, wheels?);
    ((wheels / trigger - 1.0).abs() > SLIP).then(|| {
        format!(
            "the trigger says {} m/s and the running wheels {} m/s: an edge was missed, or the wheels' radius or the \
             layout is another",
            fixed(trigger, 3),
            fixed(wheels, 3)
        )
    })
}

/// Whether laps took about the same time.
pub fn laps(place: &Position) -> Option<String> {
    let mut times: Vec<f64> = place.edges.windows(2).map(|w| w[1] - w[0]).collect();
    times.sort_by(f64::total_cmp);
    let (shortest, longest) = (times.first()?, times.last()?);
    (longest > &(1.5 * shortest)).then(|| {
        format!(
            "laps take from {} s to {} s by the trigger: it missed an edge, or rose twice",
            fixed(*shortest, 1),
            fixed(*longest, 1)
        )
    })
}

/// A pair of channels, and how to expect left − right of a sample from curvature (1/m) and tension (N).
struct Pair<'a> {
    left: Channel,
    right: Channel,
    expected: Box<dyn Fn(f64, f64) -> f64 + 'a>,
}

/// Whether left and right are what curves make of them; `tension` is the channel that measures it.
pub fn sides(run: &Run, tension: Option<Channel>, place: &Position, speed: f64, layout: &Simulation) -> Vec<String> {
    let line = layout.track.centre_line();
    if line.stretches.is_empty() {
        return Vec::new();
    }
    let curvature = |stretch: usize| match line.stretches.get(stretch)?.form {
        Form::Arc { radius, turn } | Form::Spiral { radius, turn, .. } => Some(turn.signum() / radius),
        Form::Straight { .. } | Form::Vertical { .. } => None,
    };
    let stretch = |sample| place.on_track(sample).map_or(usize::MAX, |s| line.stretch_at(s));
    // Of each sample the stretch; more than these bits hold are in none.
    let stretches: Vec<u32> =
        (0..place.s.len()).map(|sample| u32::try_from(stretch(sample)).unwrap_or(u32::MAX)).collect();
    let gaps = |channel: Channel| run.channels.get(&channel).map(|samples| Gaps::new(&run.time, samples));
    let tension = tension.and_then(gaps);
    pairs(speed, layout)
        .iter()
        .filter_map(|pair| {
            let (left, right) = (gaps(pair.left)?, gaps(pair.right)?);
            let tensions: Box<dyn Iterator<Item = f64>> = match &tension {
                Some(xi) => Box::new(xi.iter()),
                None => Box::new(std::iter::repeat(layout.chain.tension_n)),
            };
            let samples = stretches.iter().zip(left.iter().zip(right.iter())).zip(tensions);
            let points = samples.filter_map(|((stretch, (left, right)), tension)| {
                Some(((pair.expected)(curvature(*stretch as usize)?, tension), left - right))
            });
            let (slope, correlation) = regression(points.filter(|(x, y)| x.is_finite() && y.is_finite()))?;
            let (left, right) = (pair.left, pair.right);
            if slope < -0.5 && correlation < -0.2 {
                Some(format!("{left} and {right} look exchanged: in curves the wrong one is the larger"))
            } else if left == Channel::SteerLeft && slope.abs() < 0.2 {
                Some(format!("{left} and {right} do not follow the curves: check layout and trigger_position"))
            } else {
                None
            }
        })
        .collect()
}

fn pairs(speed: f64, layout: &Simulation) -> [Pair<'_>; 4] {
    let (cart, steering, running) = (&layout.cart, &layout.steering_wheel, &layout.running_wheel);
    let (length, mass) = (cart.length_m, cart.mass_kg);
    let thrust = move |tension: f64| tension - mass / length * speed * speed;
    let slower = move |b: f64, radius: f64| move |curvature: f64, _: f64| -2.0 * b * speed * curvature / radius;
    [
        Pair {
            left: Channel::SteerLeft,
            right: Channel::SteerRight,
            expected: Box::new(move |curvature, tension| thrust(tension) * length * curvature),
        },
        Pair {
            left: Channel::RunLeft,
            right: Channel::RunRight,
            expected: Box::new(move |curvature, tension| {
                let roll =
                    steering.height_m * thrust(tension) * length - cart.centre_of_mass_m[1] * mass * speed * speed;
                roll * curvature / running.half_spacing_m
            }),
        },
        Pair {
            left: Channel::WheelSpeedSteerLeft,
            right: Channel::WheelSpeedSteerRight,
            expected: Box::new(slower(steering.half_spacing_m, steering.radius_m)),
        },
        Pair {
            left: Channel::WheelSpeedRunLeft,
            right: Channel::WheelSpeedRunRight,
            expected: Box::new(slower(running.half_spacing_m, running.radius_m)),
        },
    ]
}

/// Slope through the origin, Σxy/Σx², and correlation about it, Σxy/√(Σx² Σy²).
fn regression(points: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64)> {
    let (xx, xy, yy) = points.fold((0.0, 0.0, 0.0), |(xx, xy, yy), (x, y)| (xx + x * x, xy + x * y, yy + y * y));
    (xx > 0.0).then(|| (xy / xx, if yy > 0.0 { xy / (xx * yy).sqrt() } else { 0.0 }))
}
