//! Where the sensor cart is on the track: from the trigger, as nothing on the cart measures it.

use super::{Channel, Run};

/// Track position over a run's samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Position {
    /// Arc length travelled, m: the trigger's position at its first edge, one lap more at every further edge. It does
    /// not start anew with a lap; see [`Position::on_track`].
    pub s: Vec<f64>,
    /// Times of the trigger's rising edges that are a lap apart, s.
    pub edges: Vec<f64>,
    /// How many it has beside these.
    pub others: usize,
    /// Mean speed from the first to the last edge; with a single edge, the nominal speed of the sidecar. m/s
    pub speed: f64,
    lap: f64,
}

impl Position {
    /// Arc length on the track of a sample, from 0 up to the lap's length.
    pub fn on_track(&self, sample: usize) -> Option<f64> {
        self.s.get(sample).map(|s| s.rem_euclid(self.lap))
    }

    /// Laps, whole and in part, that the run covers from its first sample to the end of its last.
    pub fn laps(&self) -> f64 {
        match self.s[..] {
            [first, .., last] => (last - first) / self.lap * self.s.len() as f64 / (self.s.len() - 1) as f64,
            _ => 0.0,
        }
    }
}

/// Position on the track over time: at a rising edge of the trigger the front joint is at the photocell
/// (`trigger_position`); linear in time between two edges, which are a lap apart; before the first and after the last
/// edge at the mean speed. An edge is midway between the last 0 and the first 1. Where the photocell sees something else,
/// too, those edges count that are a lap apart. `None` without an edge, or for a lap that has no length.
pub fn position(run: &Run, lap_length: f64) -> Option<Position> {
    position_from(run, lap_length, run.sidecar.trigger_position)
}

/// The same with the photocell at another place than the sidecar has it, m.
pub fn position_from(run: &Run, lap_length: f64, trigger_position: f64) -> Option<Position> {
    let all = edges(run);
    let edges = a_lap_apart(&all, lap_length / run.sidecar.speed_setpoint);
    let others = all.len() - edges.len();
    let (&first, &last) = (edges.first()?, edges.last()?);
    let laps = (edges.len() - 1) as f64;
    let speed = if laps > 0.0 { laps * lap_length / (last - first) } else { run.sidecar.speed_setpoint };
    if !(lap_length > 0.0 && lap_length.is_finite() && speed > 0.0) {
        return None;
    }
    let mut lap = 0;
    let s = run.time.iter().map(|&t| {
        while edges.get(lap + 1).is_some_and(|&next| next <= t) {
            lap += 1;
        }
        let begin = edges[lap];
        let travelled = match edges.get(lap + 1) {
            Some(next) if t >= begin => lap_length * (t - begin) / (next - begin),
            _ => speed * (t - begin),
        };
        trigger_position + lap as f64 * lap_length + travelled
    });
    let s = s.collect();
    Some(Position { s, speed, lap: lap_length, edges, others })
}

/// How far the time of a lap may be off the planned one, and laps off each other, where edges are chosen.
const OFF: f64 = 0.25;
const ALIKE: f64 = 0.02;
/// Of more edges none are chosen.
const MOST_EDGES: usize = 200;

/// Of edges some of which follow each other sooner than in a lap of about so long, s, the most that are a lap
/// apart; of equally many those that come first.
fn a_lap_apart(edges: &[f64], planned: f64) -> Vec<f64> {
    let times = || edges.windows(2).map(|pair| pair[1] - pair[0]);
    let (shortest, longest) = (times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max));
    let sooner = shortest < (1.0 - OFF) * planned && shortest < (1.0 - OFF) * longest;
    if !sooner || edges.len() > MOST_EDGES {
        return edges.to_vec();
    }
    let from = |first: usize, lap: f64| {
        let mut kept = vec![edges[first]];
        for &edge in &edges[first + 1..] {
            if ((edge - kept[kept.len() - 1]) / lap - 1.0).abs() < ALIKE {
                kept.push(edge);
            }
        }
        kept
    };
    let mut best: Vec<f64> = Vec::new();
    for (first, &begin) in edges.iter().enumerate() {
        for lap in edges[first + 1..].iter().map(|end| end - begin).filter(|lap| (lap / planned - 1.0).abs() < OFF) {
            let kept = from(first, lap);
            if kept.len() > best.len() {
                best = kept;
            }
        }
    }
    if best.is_empty() { edges.to_vec() } else { best }
}

/// Mean time of a lap between the first and the last of two or more edges, s.
pub fn lap_time(run: &Run) -> Option<f64> {
    let edges = edges(run);
    match edges[..] {
        [first, .., last] => Some((last - first) / (edges.len() - 1) as f64),
        _ => None,
    }
}

/// An edge so soon after another, s, is the photocell's bounce, as no lap is that short.
const BOUNCE: f64 = 0.5;

/// Times of the trigger's rising edges, midway between a 0 and the next 1, lost samples and bounces aside, s.
pub fn edges(run: &Run) -> Vec<f64> {
    let mut edges = Vec::new();
    let mut low = None;
    for (&t, &x) in run.time.iter().zip(run.channels.get(&Channel::Trigger).into_iter().flatten()) {
        if x == 0.0 {
            low = Some(t);
        } else if x == 1.0
            && let Some(before) = low.take()
        {
            let edge = 0.5 * (before + t);
            if edges.last().is_none_or(|last| edge - last > BOUNCE) {
                edges.push(edge);
            }
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::super::Sidecar;
    use super::*;

    /// 12 s at 10 Hz, the trigger on for a second after each of the edges.
    fn run(edges: &[f64]) -> Run {
        let time: Vec<f64> = (0..120).map(|i| f64::from(i) / 10.0).collect();
        let on = |t: f64| edges.iter().any(|e| t > *e && t < e + 1.0);
        let trigger = time.iter().map(|&t| f64::from(u8::from(on(t)))).collect();
        let sidecar = Sidecar { speed_setpoint: 2.0, trigger_position: 3.0, ..Sidecar::default() };
        Run { time, channels: [(Channel::Trigger, trigger)].into(), sidecar }
    }

    #[test]
    fn laps_are_linear_between_edges_and_go_on_at_the_mean_speed() {
        let place = position(&run(&[2.05, 6.05, 11.05]), 9.0).expect("edges");
        assert!((place.speed - 2.0).abs() < 1e-12, "18 m in 9 s");
        let expected = [(0.0, 3.0 - 4.1), (2.05, 3.0), (4.05, 7.5), (6.05, 12.0), (8.55, 16.5), (11.05, 21.0)];
        for (t, s) in expected {
            let i = (t * 10.0 + 0.5) as usize;
            let speed = if t < 2.0 { 2.0 } else { 9.0 / if t < 6.0 { 4.0 } else { 5.0 } };
            let s = s + speed * (place_time(i) - t);
            assert!((place.s[i] - s).abs() < 0.06, "at {t} s: {}, not {s}", place.s[i]);
        }
        assert_eq!(lap_time(&run(&[2.05, 6.05, 11.05])), Some(4.5));
        assert!((place.on_track(0).expect("sample") - (9.0 + 3.0 - 4.1)).abs() < 1e-9);
    }

    #[test]
    fn a_bounce_is_no_lap() {
        let mut bouncing = run(&[2.05, 6.05]);
        let trigger = bouncing.channels.get_mut(&Channel::Trigger).expect("a trigger");
        trigger[22] = 0.0;
        assert_eq!(edges(&bouncing), edges(&run(&[2.05, 6.05])));
    }

    #[test]
    fn edges_beside_those_of_laps_do_not_count() {
        let chosen = |edges: &[f64], planned: f64| a_lap_apart(edges, planned);
        // Something else that passes the photocell once a lap, and once at all.
        assert_eq!(chosen(&[1.0, 4.0, 11.0, 14.0, 21.05, 24.0], 10.4), [1.0, 11.0, 21.05]);
        assert_eq!(chosen(&[3.0, 5.0, 15.0, 25.0], 10.0), [5.0, 15.0, 25.0]);
        // A lap with a stop is long, and a chain that runs faster than planned has short ones.
        for edges in [[1.0, 11.0, 41.0, 51.0], [1.0, 8.0, 15.0, 22.0]] {
            assert_eq!(chosen(&edges, 10.0), edges);
        }
        assert_eq!(chosen(&[1.0, 4.0], 10.0), [1.0, 4.0], "no two are a lap apart");
        let place = position(&run(&[2.05, 3.55, 6.05, 7.55, 10.05]), 8.0).expect("edges");
        assert_eq!((place.edges.len(), place.others, place.speed), (3, 2, 2.0));
    }

    fn place_time(i: usize) -> f64 {
        i as f64 / 10.0
    }

    #[test]
    fn one_edge_needs_the_nominal_speed_and_none_tells_nothing() {
        let place = position(&run(&[2.05]), 50.0).expect("an edge");
        assert_eq!((place.edges.len(), place.speed), (1, 2.0));
        assert_eq!(lap_time(&run(&[2.05])), None);
        assert!((place.s[119] - (3.0 + 2.0 * (11.9 - 2.05))).abs() < 1e-9);
        assert_eq!(position(&run(&[]), 50.0), None);
        assert_eq!(position(&run(&[2.05]), 0.0), None);
        assert_eq!(position(&Run::default(), 50.0), None);
        // On from the first sample: the edge was before the run.
        assert_eq!(position(&run(&[-0.5]), 50.0), None);
    }
}
