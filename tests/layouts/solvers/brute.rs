//! The coarse loop of this test by full search: every heading and radius, and for each the straights at a vertex of
//! what is left. Nothing of the crate is used.

/// 15°
const STEP: f64 = std::f64::consts::PI / 12.0;
const RADII: [f64; 2] = [3.0, 5.0];
const TURNS: std::ops::RangeInclusive<i32> = 1..=8;

/// Length of the shortest loop: P1 (0, 0), P2 (30, 0), left turns only, straights of at least 0.3 m.
pub fn shortest() -> f64 {
    let mut best = f64::INFINITY;
    for second in TURNS {
        for third in TURNS {
            for fourth in TURNS {
                let first = 24 - second - third - fourth;
                if !TURNS.contains(&first) {
                    continue;
                }
                for choice in 0..16 {
                    let radius = |k: usize| RADII[choice >> k & 1];
                    let turns = [first, second, third, fourth];
                    if radius(1) + radius(3) >= 8.0 {
                        best = best.min(loop_with(turns, [radius(0), radius(1), radius(2), radius(3)]));
                    }
                }
            }
        }
    }
    best
}

/// The least length with these turns (in steps) and radii at P1..P4.
fn loop_with(turns: [i32; 4], radii: [f64; 4]) -> f64 {
    let tangent: Vec<f64> = (0..4).map(|i| radii[i] * libm::tan(f64::from(turns[i]) * STEP / 2.0)).collect();
    let arcs: f64 = (0..4).map(|i| radii[i] * f64::from(turns[i]) * STEP - 2.0 * tangent[i]).sum();
    if 30.0 - tangent[0] - tangent[1] < 0.3 {
        return f64::INFINITY;
    }
    // Sections P2..P3, P3..P4, P4..P1 close the loop: two equations for three lengths, so one of them, or y(P3), is
    // at its limit.
    let headings = [turns[1], turns[1] + turns[2], turns[1] + turns[2] + turns[3]].map(|h| f64::from(h) * STEP);
    let direction = headings.map(|h| (libm::cos(h), libm::sin(h)));
    let least = [tangent[1] + tangent[2] + 4.0, tangent[2] + tangent[3] + 0.3, tangent[3] + tangent[0] + 0.3];
    let mut best = f64::INFINITY;
    let high_enough = 14.2 / direction[0].1;
    for (held, value) in [(0, least[0]), (1, least[1]), (2, least[2]), (0, high_enough)] {
        let (a, b) = ((held + 1) % 3, (held + 2) % 3);
        let right = (-30.0 - value * direction[held].0, -value * direction[held].1);
        let det = direction[a].0 * direction[b].1 - direction[a].1 * direction[b].0;
        if det.abs() < 1e-9 || !value.is_finite() {
            continue;
        }
        let mut lengths = [0.0; 3];
        lengths[held] = value;
        lengths[a] = (right.0 * direction[b].1 - right.1 * direction[b].0) / det;
        lengths[b] = (direction[a].0 * right.1 - direction[a].1 * right.0) / det;
        let fits = (0..3).all(|i| lengths[i] >= least[i] - 1e-9) && lengths[0] * direction[0].1 >= 14.2 - 1e-9;
        if fits {
            best = best.min(30.0 + lengths.iter().sum::<f64>() + arcs);
        }
    }
    best
}
