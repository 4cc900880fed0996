//! Channels that no machine like this one gives: in another unit, of the other sign, or set to zero under load.
//!
//! **What is expected**, in the mean of a lap: running wheels carry their cart, m g/2 each; the leader holds the front joint
//! of a cart whose centre of mass is ξ_c from it with m g ξ_c/L, and the follower its rear joint with as much the other way
//! (balance of moments about the running wheels, which are at the front joint: design, chain model); and a chain is under
//! tension. A sensor's gain, a sensor's offset and an item on the cart move a mean, too, so only what is near to a unit, to the
//! opposite or to zero is told, and of the running wheels what both show.

use super::super::Channel;
use super::super::measures::Statistics;
use crate::base::number::significant;
use crate::base::words::list;
use crate::chain_input::Simulation;
use std::collections::BTreeMap;

/// What a newton is in other units, with the factor within which a mean is near to it.
const UNITS: [(&str, f64, f64); 3] = [("kN", 1e-3, 1.6), ("kgf", 0.101_971_6, 1.2), ("lbf", 0.224_808_9, 1.15)];
/// Tension may be set otherwise than planned: so near to a thousandth it is in kN.
const TENSION: f64 = 5.0;
/// Shares of what is expected that are its opposite, and those that are zero.
const OPPOSITE: std::ops::RangeInclusive<f64> = -1.6..=-0.6;
const ZERO: f64 = 0.03;

/// Channels that cannot be compared with the layout.
#[derive(Clone, Debug, PartialEq)]
pub struct Implausible {
    pub channels: Vec<Channel>,
    /// What they look like, with a way out.
    pub why: String,
    /// Whether they were only set to zero, so that deviations from their mean can be compared.
    pub zeroed: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Look {
    Unit(&'static str),
    Opposite,
    Zeroed,
}

impl Look {
    /// Of a mean as a share of what is expected.
    fn of(share: f64) -> Option<Look> {
        let near = |(_, unit, factor): &&(_, f64, f64)| share > unit / factor && share < unit * factor;
        match UNITS.iter().find(near) {
            Some((name, ..)) => Some(Look::Unit(name)),
            None if OPPOSITE.contains(&share) => Some(Look::Opposite),
            None => (share.abs() < ZERO).then_some(Look::Zeroed),
        }
    }

    /// With a way out, of one or several channels.
    fn words(self, one: bool) -> String {
        let look = if one { "looks" } else { "look" };
        match self {
            Look::Unit(unit) => {
                format!("{look} like {unit}: forces are in N; say so with a `factor` under `[columns]` in the sidecar")
            }
            Look::Opposite => {
                format!("{look} reversed: change the sign with `factor = -1` under `[columns]` in the sidecar")
            }
            Look::Zeroed => format!("{look} set to zero under load: their means say nothing"),
        }
    }
}

/// What is expected in the mean of a lap, N.
#[derive(Clone, Copy, Debug)]
pub struct Expected {
    /// A cart's, which its running wheels carry.
    pub weight: f64,
    /// What the front joint of a cart holds.
    pub hangs: f64,
    /// As planned.
    pub tension: f64,
}

impl Expected {
    pub fn of(layout: &Simulation) -> Self {
        let cart = &layout.cart;
        let weight = cart.mass_kg * layout.gravity_m_s2;
        let hangs = weight * cart.centre_of_mass_m[0] / cart.length_m;
        Expected { weight, hangs, tension: layout.chain.tension_n }
    }
}

/// Channels whose means no machine like the layout's has, in their order.
pub fn implausible(levels: &BTreeMap<Channel, Statistics>, expected: &Expected) -> Vec<Implausible> {
    let Expected { weight, hangs, tension: planned } = *expected;
    let mean = |channel: Channel| levels.get(&channel).map(|level| level.mean);
    let look = |channel: Channel, expected: f64| mean(channel).and_then(|mean| Look::of(mean / expected));
    let [left, right] = [Channel::RunLeft, Channel::RunRight].map(|wheel| look(wheel, 0.5 * weight));
    let wheels = left.filter(|left| right == Some(*left));
    let forces = Channel::FORCES.into_iter().filter(|channel| levels.contains_key(channel));
    let of = |channel: Channel| match channel {
        Channel::RunLeft | Channel::RunRight => wheels,
        // Who records one force in another unit does so with all.
        _ if matches!(wheels, Some(Look::Unit(_))) => wheels,
        Channel::JointXi => tension(levels.get(&channel)?, planned),
        // A wheel pushes and never pulls.
        Channel::SteerLeft | Channel::SteerRight => levels
            .get(&channel)
            .is_some_and(|level| is_zero(level) && (level.min < -0.5 * level.sd || wheels == Some(Look::Zeroed)))
            .then_some(Look::Zeroed),
        // Hardly any force is sideways in the mean, so that the others have to tell.
        Channel::JointEta => wheels.filter(|look| *look == Look::Zeroed && levels.get(&channel).is_some_and(is_zero)),
        Channel::JointZeta if hangs.abs() > 0.05 * weight => look(channel, hangs),
        _ => None,
    };
    let mut looks: Vec<(Look, Vec<Channel>)> = Vec::new();
    for (channel, look) in forces.filter_map(|channel| Some((channel, of(channel)?))) {
        match looks.iter_mut().find(|(other, _)| *other == look) {
            Some((_, channels)) => channels.push(channel),
            None => looks.push((look, vec![channel])),
        }
    }
    let why = |look: Look, channels: &[Channel]| {
        let names: Vec<&str> = channels.iter().map(|channel| channel.name()).collect();
        let expected = |channel: Channel| match channel {
            Channel::RunLeft | Channel::RunRight => {
                Some(format!("half a cart weighs {} N", significant(0.5 * weight, 3)))
            }
            Channel::JointZeta => Some(format!("a cart's joint carries {} N", significant(hangs, 3))),
            Channel::JointXi => Some("a chain is under tension".to_owned()),
            _ => None,
        };
        let first = channels.iter().find_map(|channel| Some((*channel, mean(*channel)?, expected(*channel)?)));
        let of = first.map_or_else(String::new, |(channel, mean, expected)| {
            format!(" (the mean of {channel} is {} N, where {expected})", significant(mean, 3))
        });
        format!("{} {}{of}", list(&names, "and"), look.words(names.len() == 1))
    };
    let told = |(look, channels): (Look, Vec<Channel>)| Implausible {
        why: why(look, &channels),
        channels,
        zeroed: look == Look::Zeroed,
    };
    looks.into_iter().map(told).collect()
}

/// Whether a mean is none beside its swings.
fn is_zero(level: &Statistics) -> bool {
    level.mean.abs() < ZERO * level.sd
}

/// Of what measures the tension, which may be set to another than the layout's.
fn tension(level: &Statistics, planned: f64) -> Option<Look> {
    let share = level.mean / planned;
    let (kilo, thousandth, _) = UNITS[0];
    if is_zero(level) {
        Some(Look::Zeroed)
    } else if share > thousandth / TENSION && share < thousandth * TENSION {
        Some(Look::Unit(kilo))
    } else {
        // A chain that is pushed is under a small pressure at most.
        (share < -0.2).then_some(Look::Opposite)
    }
}
