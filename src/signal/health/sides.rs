//! Whether left and right differ as curves make them, and where on the track they do so best.

use super::super::gaps::Gaps;
use super::super::position::Position;
use super::super::{Channel, Run};
use crate::base::number::fixed;
use crate::chain_input::Simulation;
use crate::geometry::{CentreLine, Form};

/// A pair of channels, and how to expect left − right of a sample from curvature (1/m) and tension (N).
struct Pair<'a> {
    left: Channel,
    right: Channel,
    expected: Box<dyn Fn(f64, f64) -> f64 + 'a>,
}

/// Slope and correlation of a regression at which a pair is exchanged, and the slope below which it follows no curve.
const EXCHANGED: (f64, f64) = (-0.5, -0.2);
const FOLLOWS: f64 = 0.2;

/// Cells that places are tried in, m, and how many there may be; how far off a place is told, m; and by how much more the
/// curves have to be followed there, as a correlation.
const CELL: f64 = 0.25;
const CELLS: f64 = 2000.0;
const OFF: f64 = 1.5;
const CLEARLY: (f64, f64) = (0.7, 0.1);

/// Whether left and right are what curves make of them, of channels that are usable; without `joint_xi` with the layout's
/// tension. Beside the sentences, where the trigger seems to be, m, if not where the sidecar has it.
pub fn sides(
    run: &Run,
    usable: &dyn Fn(Channel) -> bool,
    place: &Position,
    speed: f64,
    layout: &Simulation,
) -> (Vec<String>, Option<f64>) {
    let line = layout.track.centre_line();
    if line.stretches.is_empty() {
        return (Vec::new(), None);
    }
    let stretch = |sample| place.on_track(sample).map_or(usize::MAX, |s| line.stretch_at(s));
    // Of each sample the stretch; more than these bits hold are in none.
    let stretches: Vec<u32> =
        (0..place.s.len()).map(|sample| u32::try_from(stretch(sample)).unwrap_or(u32::MAX)).collect();
    let gaps = |channel: Channel| {
        let samples = run.channels.get(&channel).filter(|_| usable(channel));
        samples.map(|samples| Gaps::new(&run.time, samples))
    };
    let tension = gaps(Channel::JointXi);
    let tensions = || -> Box<dyn Iterator<Item = f64>> {
        match &tension {
            Some(xi) => Box::new(xi.iter()),
            None => Box::new(std::iter::repeat(layout.chain.tension_n)),
        }
    };
    let (mut said, mut trigger) = (Vec::new(), None);
    for pair in pairs(speed, layout) {
        let (Some(left), Some(right)) = (gaps(pair.left), gaps(pair.right)) else { continue };
        let samples = stretches.iter().zip(left.iter().zip(right.iter())).zip(tensions());
        let points = samples.filter_map(|((stretch, (left, right)), tension)| {
            Some(((pair.expected)(curvature(&line, *stretch as usize)?, tension), left - right))
        });
        let found = regression(points.filter(|(x, y)| x.is_finite() && y.is_finite()));
        let Some((slope, correlation)) = found else { continue };
        let (names, steers) = ((pair.left, pair.right), pair.left == Channel::SteerLeft);
        let differences = || left.iter().zip(right.iter()).map(|(left, right)| left - right);
        let moved = steers.then(|| elsewhere(run, place, &line, differences())).flatten();
        if slope < EXCHANGED.0 && correlation < EXCHANGED.1 {
            said.push(format!("{} and {} look exchanged: in curves the wrong one is the larger", names.0, names.1));
        } else if steers && moved.is_none() && slope.abs() < FOLLOWS {
            let check = "check layout and trigger_position";
            said.push(format!("{} and {} do not follow the curves: {check}", names.0, names.1));
        }
        if let Some(place) = moved {
            let (found, planned) = (fixed(place, 1), fixed(run.sidecar.trigger_position, 1));
            said.push(format!(
                "steer_left and steer_right follow the curves with trigger_position {found} m, not with {planned} m: check \
                 it, and that the layout begins where the track does"
            ));
            trigger = Some(place);
        }
    }
    (said, trigger)
}

/// Curvature of a stretch, 1/m, left positive; none of one that rises or falls.
fn curvature(line: &CentreLine, stretch: usize) -> Option<f64> {
    match line.stretches.get(stretch)?.form {
        Form::Arc { radius, turn } | Form::Spiral { radius, turn, .. } => Some(turn.signum() / radius),
        Form::Straight { .. } => Some(0.0),
        Form::Vertical { .. } => None,
    }
}

/// Whether the steering wheels' differences, sample by sample, follow the curves clearly better with another place of the
/// trigger, m; the nearest of those that are as good.
fn elsewhere(run: &Run, place: &Position, line: &CentreLine, differences: impl Iterator<Item = f64>) -> Option<f64> {
    let count = (line.length / CELL).round().clamp(1.0, CELLS) as usize;
    let mut cells = vec![(0.0, 0_u32); count];
    for (sample, difference) in differences.enumerate().filter(|(_, x)| x.is_finite()) {
        let Some(s) = place.on_track(sample) else { continue };
        let cell = &mut cells[((s / line.length * count as f64) as usize).min(count - 1)];
        *cell = (cell.0 + difference, cell.1 + 1);
    }
    let middle = |k: usize| (k as f64 + 0.5) * line.length / count as f64;
    let expected: Vec<Option<f64>> = (0..count).map(|k| curvature(line, line.stretch_at(middle(k)))).collect();
    // What was recorded at a cell, seen `shift` cells further on.
    let correlation = |shift: usize| {
        let points = cells.iter().enumerate().filter(|(_, cell)| cell.1 > 0);
        let points = points.filter_map(|(k, (sum, n))| Some((expected[(k + shift) % count]?, sum / f64::from(*n))));
        regression(points).map_or(f64::NAN, |found| found.1)
    };
    let all: Vec<f64> = (0..count).map(correlation).collect();
    let best = all.iter().copied().filter(|x| x.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    let off = |shift: usize| {
        let cells = if 2 * shift > count { shift as f64 - count as f64 } else { shift as f64 };
        cells * line.length / count as f64
    };
    let near = (0..count).filter(|k| all[*k] > best - 0.02).min_by(|a, b| off(*a).abs().total_cmp(&off(*b).abs()))?;
    let further = off(near);
    let clearly = further.abs() > OFF && best > CLEARLY.0 && best > all[0] + CLEARLY.1;
    clearly.then(|| (run.sidecar.trigger_position + further).rem_euclid(line.length))
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

/// Slope and correlation of values over others, each about its mean. `None` where the others are all the same.
fn regression(points: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64)> {
    let (mut n, mut means, mut sums) = (0.0, (0.0, 0.0), (0.0, 0.0, 0.0));
    for (x, y) in points {
        n += 1.0;
        let (dx, dy): (f64, f64) = (x - means.0, y - means.1);
        means = (means.0 + dx / n, means.1 + dy / n);
        let (rx, ry) = (x - means.0, y - means.1);
        sums = (sums.0 + dx * rx, sums.1 + dx * ry, sums.2 + dy * ry);
    }
    let (xx, xy, yy) = sums;
    (xx > 0.0).then(|| (xy / xx, if yy > 0.0 { xy / (xx * yy).sqrt() } else { 0.0 }))
}
