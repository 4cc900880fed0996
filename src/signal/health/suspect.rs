//! The rules by which a channel looks wrong.

use super::super::Channel;
use super::super::measures::Statistics;
use super::super::position::Position;
use crate::base::number::{fixed, shortest, trimmed};
use crate::base::words::counted;
use crate::chain_input::Simulation;
use std::collections::BTreeMap;

/// Different values that the last digits of a constant may take.
pub const DEAD: usize = 3;
/// Samples in a row at an extreme value, from which on it is a limit.
pub const CLIPPED_ROW: usize = 5;
/// Samples in all at an extreme value, from which on it is a limit.
pub const CLIPPED: usize = 20;
/// Share by which wheels may turn slower or faster than the trigger has it.
pub const SLIP: f64 = 0.03;
/// A mean that is less than so many deviations pulls nowhere.
const NO_PULL: f64 = 0.03;

/// What a channel recorded, in order; negative zero is zero. `None` of channels that may stay at one value.
pub fn sorted(channel: Channel, samples: &[f64]) -> Option<Vec<f64>> {
    let turns = Channel::WheelSpeedSteerLeft <= channel && channel <= Channel::WheelSpeedRunRight;
    if !channel.is_force() && !turns {
        return None;
    }
    let mut sorted: Vec<f64> = samples.iter().filter(|x| !x.is_nan()).map(|x| x + 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    Some(sorted)
}

/// Values in order, with how often each was recorded.
fn counts(sorted: &[f64]) -> impl DoubleEndedIterator<Item = (f64, usize)> {
    sorted.chunk_by(|a, b| a == b).map(|same| (same[0], same.len()))
}

/// Whether a channel stays at the last digits of a constant.
pub fn dead(channel: Channel, sorted: &[f64]) -> Option<String> {
    if sorted.len() < 100 || counts(sorted).take(DEAD + 1).count() > DEAD {
        return None;
    }
    let unit = channel.unit();
    let (low, high) = (shortest(*sorted.first()?), shortest(*sorted.last()?));
    let stays =
        if low == high { format!("stays at {low} {unit}") } else { format!("only goes from {low} to {high} {unit}") };
    Some(format!("{channel} looks dead: it {stays}"))
}

/// Whether a channel comes to the end of its range.
pub fn clipped(channel: Channel, sorted: &[f64], samples: &[f64]) -> Option<String> {
    let ends = [counts(sorted).take(2).collect::<Vec<_>>(), counts(sorted).rev().take(2).collect()];
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
        let level = levels.get(&other)?;
        let pull = level.mean;
        // One that was set to zero pulls nowhere.
        (pull > NO_PULL * level.sd && xi < 0.25 * pull).then(|| {
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
    if place.others > 0 {
        let edges = counted(place.others, "edge");
        return Some(format!(
            "the trigger has {edges} beside those that are a lap apart: something else passes the photocell"
        ));
    }
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
