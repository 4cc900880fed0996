//! How long a straight is at least for what has to stand on one side of it, one behind another.
//!
//! Two neighbours have the larger of their services between them, and the first and the last keep their distances from the
//! curves. Which order is the shortest is found by dynamic programming over how much of each declaration stands already and
//! what stands last, as the orders that declarations ask for allow.

/// Equipment of one declaration that stands on a side of a straight.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    pub count: usize,
    /// m
    pub stretch: f64,
    pub service: f64,
    pub from_curve: f64,
    /// Parts that stand before it as a whole.
    pub behind: Vec<usize>,
}

/// States of the dynamic programme, at most; where there are more, what holds for any order is taken.
const MOST_STATES: usize = 200_000;

/// The least length, m; 0 where nothing stands there. Orders that contradict each other count for nothing.
pub fn least_length(parts: &[Part]) -> f64 {
    let stretches: f64 = parts.iter().map(|part| part.count as f64 * part.stretch).sum();
    if parts.iter().all(|part| part.count == 0) {
        return 0.0;
    }
    let counts = parts.iter().fold(1usize, |all, part| all.saturating_mul(part.count + 1));
    let rooms = match counts.saturating_mul(parts.len()) {
        states if states <= MOST_STATES => Some(between(parts)).filter(|rooms| rooms.is_finite()),
        _ => None,
    };
    stretches + rooms.unwrap_or_else(|| of_any_order(parts))
}

/// The room between them and to curves in any order: of a path, the sum of the larger ends of its edges is no less than
/// all but the least.
fn of_any_order(parts: &[Part]) -> f64 {
    let standing = || parts.iter().filter(|part| part.count > 0);
    let least = |of: fn(&Part) -> f64| standing().map(of).fold(f64::INFINITY, f64::min);
    let services: f64 = standing().map(|part| part.count as f64 * part.service).sum();
    services - least(|part| part.service) + 2.0 * least(|part| part.from_curve)
}

/// The room between them and to curves in the best order.
fn between(parts: &[Part]) -> f64 {
    let n = parts.len();
    // What of each part stands is a number in mixed radix.
    let mut places = Vec::with_capacity(n);
    let mut all = 1;
    for part in parts {
        places.push(all);
        all *= part.count + 1;
    }
    let standing = |state: usize, part: usize| state / places[part] % (parts[part].count + 1);
    let may_follow = |state: usize, part: usize| {
        let own = &parts[part];
        standing(state, part) < own.count && own.behind.iter().all(|k| standing(state, *k) == parts[*k].count)
    };
    let mut least = vec![f64::INFINITY; all * n];
    for part in (0..n).filter(|part| may_follow(0, *part)) {
        least[places[part] * n + part] = parts[part].from_curve;
    }
    for state in 1..all {
        for last in 0..n {
            let so_far = least[state * n + last];
            if so_far.is_infinite() {
                continue;
            }
            for next in (0..n).filter(|next| may_follow(state, *next)) {
                let with = so_far + parts[last].service.max(parts[next].service);
                let then = &mut least[(state + places[next]) * n + next];
                *then = then.min(with);
            }
        }
    }
    (0..n).map(|last| least[(all - 1) * n + last] + parts[last].from_curve).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;

    /// Every order of all pieces, one by one.
    fn every_order(parts: &[Part], standing: &mut Vec<usize>) -> f64 {
        let of = |part: usize| standing.iter().filter(|other| **other == part).count();
        let next: Vec<usize> = (0..parts.len())
            .filter(|part| of(*part) < parts[*part].count)
            .filter(|part| parts[*part].behind.iter().all(|k| of(*k) == parts[*k].count))
            .collect();
        let all: usize = parts.iter().map(|part| part.count).sum();
        if standing.len() == all {
            let rooms: f64 = standing.windows(2).map(|pair| parts[pair[0]].service.max(parts[pair[1]].service)).sum();
            let stretches: f64 = standing.iter().map(|part| parts[*part].stretch).sum();
            let ends = [standing.first(), standing.last()].into_iter().flatten().map(|part| parts[*part].from_curve);
            return stretches + rooms + ends.sum::<f64>();
        }
        let mut best = f64::INFINITY;
        for part in next {
            standing.push(part);
            best = best.min(every_order(parts, standing));
            standing.pop();
        }
        best
    }

    fn drawn(random: &mut Random, parts: usize) -> Vec<Part> {
        let mut tenths = |most: f64| 0.1 * (random.uniform() * most).floor();
        (0..parts)
            .map(|k| Part {
                count: 1 + (10.0 * tenths(3.0)).round() as usize,
                stretch: 0.5 + tenths(30.0),
                service: tenths(8.0),
                from_curve: tenths(12.0),
                behind: (0..k).filter(|_| tenths(30.0) < 1.0).collect(),
            })
            .collect()
    }

    #[test]
    fn no_order_is_shorter() {
        let mut random = Random::new(7);
        for case in 0..200 {
            let parts = drawn(&mut random, 1 + case % 3);
            let (found, best) = (least_length(&parts), every_order(&parts, &mut Vec::new()));
            assert!((found - best).abs() < 1e-9, "{parts:?}: {found} {best}");
            let stretches: f64 = parts.iter().map(|part| part.count as f64 * part.stretch).sum();
            assert!(stretches + of_any_order(&parts) <= best + 1e-9, "{parts:?}");
        }
    }

    #[test]
    fn orders_that_contradict_each_other_count_for_nothing() {
        let part = |behind: usize| Part { count: 1, stretch: 1.0, service: 0.2, from_curve: 0.5, behind: vec![behind] };
        assert!((least_length(&[part(1), part(0)]) - 3.2).abs() < 1e-12);
        assert!(least_length(&[]).abs() < 1e-12);
    }

    #[test]
    fn many_declarations_take_what_holds_in_any_order() {
        let part = |service: f64| Part { count: 30, stretch: 1.0, service, from_curve: 0.5, behind: Vec::new() };
        let parts: Vec<Part> = (0..5).map(|k| part(0.1 * f64::from(k))).collect();
        // 150 of 1 m, 30 of each service but one of the least, and two ends.
        assert!((least_length(&parts) - (150.0 + 30.0 * (0.1 + 0.2 + 0.3 + 0.4) + 1.0)).abs() < 1e-9);
    }
}
