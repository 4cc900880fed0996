//! Load cycles and the damage they do: rainflow counting and damage-equivalent loads.

use crate::base::trig::pow;

/// A counted cycle, or half of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// Peak less valley.
    pub range: f64,
    /// Midway between them.
    pub mean: f64,
    /// 1, or 0.5 for half a cycle.
    pub count: f64,
}

/// Peaks and valleys, with the first and the last sample. Lost samples are passed over.
pub fn reversals(x: &[f64]) -> Vec<f64> {
    let mut out: Vec<f64> = Vec::new();
    for &x in x.iter().filter(|x| !x.is_nan()) {
        match out[..] {
            [.., last] if last == x => {}
            // Going on the same way, the last was no reversal.
            [.., before, last] if (last > before) == (x > last) => {
                out.pop();
                out.push(x);
            }
            _ => out.push(x),
        }
    }
    out
}

/// Rainflow counting of a history, not assumed to repeat: ASTM E1049-85 (2017), §5.4.4, in the order of the standard.
pub fn rainflow(x: &[f64]) -> Vec<Cycle> {
    let mut cycles = Vec::new();
    let cycle = |a: f64, b: f64, count| Cycle { range: (b - a).abs(), mean: 0.5 * (a + b), count };
    let mut stack: Vec<f64> = Vec::new();
    for point in reversals(x) {
        stack.push(point);
        while let [.., a, b, c] = stack[..] {
            // Y = |b − a| is the range before X = |c − b|.
            if (c - b).abs() < (b - a).abs() {
                break;
            }
            if stack.len() == 3 {
                // Y contains the starting point: half a cycle, and the start moves on.
                cycles.push(cycle(a, b, 0.5));
                stack.remove(0);
            } else {
                cycles.push(cycle(a, b, 1.0));
                stack.truncate(stack.len() - 3);
                stack.push(c);
            }
        }
    }
    cycles.extend(stack.windows(2).map(|w| cycle(w[0], w[1], 0.5)));
    cycles
}

/// Counts per distinct range, smallest first, as the standard tabulates them.
pub fn by_range(cycles: &[Cycle]) -> Vec<(f64, f64)> {
    let mut sorted: Vec<(f64, f64)> = cycles.iter().map(|c| (c.range, c.count)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    sorted.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    sorted
}

/// Damage-equivalent load: the range of `reference` equal cycles that do the damage of the counted ones after Palmgren
/// (1924) and Miner (1945) with an S-N curve of slope `exponent`, (Σ nᵢ Sᵢᵐ / N_ref)^(1/m). S is the range and its mean
/// counts for nothing. m is about 3 for welds, 5 for aluminium, 10 for polymers. `None` unless m and N_ref are above 0.
pub fn damage_equivalent(cycles: &[Cycle], exponent: f64, reference: f64) -> Option<f64> {
    if !(exponent > 0.0 && reference > 0.0) {
        return None;
    }
    // In parts of the largest, so that no power overflows.
    let largest = cycles.iter().map(|c| c.range).fold(0.0, f64::max);
    if largest == 0.0 {
        return Some(0.0);
    }
    let damage: f64 = cycles.iter().map(|c| c.count * pow(c.range / largest, exponent)).sum();
    Some(largest * pow(damage / reference, 1.0 / exponent))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ASTM E1049-85, figure 6.
    const STANDARD: [f64; 9] = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];

    #[test]
    fn the_example_of_the_standard() {
        let cycles = rainflow(&STANDARD);
        assert_eq!(by_range(&cycles), [(3.0, 0.5), (4.0, 1.5), (6.0, 0.5), (8.0, 1.0), (9.0, 0.5)]);
        let whole: Vec<_> = cycles.iter().filter(|c| c.count == 1.0).collect();
        assert_eq!(whole, [&Cycle { range: 4.0, mean: 1.0, count: 1.0 }], "E-F");
    }

    #[test]
    fn only_reversals_count() {
        let between = [-2.0, -2.0, f64::NAN, 0.0, 1.0, 0.5, -3.0, 5.0, 5.0, 2.0, -1.0, 3.0, -4.0, f64::NAN, 4.0, -2.0];
        assert_eq!(reversals(&between), STANDARD);
        assert_eq!(rainflow(&between), rainflow(&STANDARD));
        for nothing in [&[][..], &[f64::NAN], &[3.0], &[3.0, 3.0]] {
            assert!(rainflow(nothing).is_empty());
        }
    }

    #[test]
    fn every_reversal_is_half_a_cycle() {
        // Whatever the history, each stretch between reversals is half of one cycle.
        let history: Vec<f64> = (0..500_u32).map(|i| f64::from(i.wrapping_mul(2_654_435_761) >> 20)).collect();
        let counted: f64 = rainflow(&history).iter().map(|c| c.count).sum();
        assert_eq!(counted, (reversals(&history).len() - 1) as f64 / 2.0);
    }

    #[test]
    fn equal_cycles_are_their_own_equivalent() {
        let saw: Vec<f64> = (0..2001).map(|i| f64::from(i % 2) * 7.0).collect();
        let cycles = rainflow(&saw);
        for exponent in [1.0, 3.0, 10.0] {
            let load = damage_equivalent(&cycles, exponent, 1000.0).expect("a load");
            assert!((load - 7.0).abs() < 1e-12, "{load}");
        }
        // ½·3³ + 1.5·4³ + ½·6³ + 8³ + ½·9³ = 1094.
        let load = damage_equivalent(&rainflow(&STANDARD), 3.0, 1.0).expect("a load");
        assert!((load * load * load - 1094.0).abs() < 1e-9, "{}", load * load * load);
        assert_eq!(damage_equivalent(&[], 3.0, 1.0), Some(0.0));
        assert_eq!(damage_equivalent(&cycles, 0.0, 1.0), None);
    }
}
