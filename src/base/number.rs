//! The one way numbers are written: the same digits everywhere, and never a negative zero.

use crate::base::trig;

/// With a fixed number of decimals: `1.50`.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| matches!(b, b'0' | b'.')) => digits.to_owned(),
        _ => text,
    }
}

/// With at most this number of decimals, without zeros at the end: `1.5`.
pub fn trimmed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The fewest digits that read back as the same number, without an exponent: `0.1`.
pub fn shortest(value: f64) -> String {
    format!("{}", normal(value))
}

/// A length (m) in mm to a tenth, with its unit: `12.5 mm`.
pub fn tenths_of_mm(metres: f64) -> String {
    format!("{} mm", trimmed(1e3 * metres, 1))
}

/// With so many significant digits, in powers of ten where it is very small or large: `0.00123`, `1.2e-7`.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return shortest(value);
    }
    let power = trig::log10(value.abs()).floor();
    if (-4.0..6.0).contains(&power) {
        return trimmed(value, (digits as f64 - 1.0 - power).max(0.0) as usize);
    }
    let scaled = value / trig::pow(10.0, power);
    format!("{}e{power}", trimmed(scaled, digits - 1))
}

/// With so many significant digits as a person reads them: never in powers of ten, no more than nine decimals, and
/// `unknown` for what is no number.
pub fn decimal(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return "unknown".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = digits - 1 - trig::log10(value.abs()).floor() as i32;
    trimmed(value, decimals.clamp(0, 9) as usize)
}

/// Whether a count is one, which files leave out where it goes without saying.
pub fn is_one(count: &usize) -> bool {
    *count == 1
}

/// Rounds a computed quantity to 1e-12, which clears away the last bits' noise (12.000000000000002 m) and keeps far
/// more than any use needs. Large numbers, whose own resolution is coarser, stay as they are.
pub fn tidy(value: f64) -> f64 {
    const PARTS: f64 = 1e12;
    normal(if value.abs() < 1e3 { (value * PARTS).round() / PARTS } else { value })
}

/// Zero without a sign.
pub fn normal(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value }
}

/// What a number has beyond the whole one below it, in [0, 1): bit for bit `rem_euclid(1.0)`, without a division, and
/// without `floor`, which older processors have no instruction for. For what is smaller than 2⁶³.
pub fn fraction(x: f64) -> f64 {
    let beyond = x - x as i64 as f64;
    if beyond < 0.0 { beyond + 1.0 } else { beyond }
}

/// Round steps: 1, 2 or 5 times a power of ten, about `count` of them.
pub fn ticks(low: f64, high: f64, count: f64) -> Vec<f64> {
    let raw = (high - low) / count;
    if !(raw > 0.0 && raw.is_finite()) {
        return Vec::new();
    }
    let power = trig::pow(10.0, trig::log10(raw).floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= raw).unwrap_or(raw);
    let first = (low / step).ceil() as i64;
    (first..).map(|k| k as f64 * step).take_while(|t| *t <= high).take(50).collect()
}

/// Ticks in words: with as many decimals as the steps between them need, so that no two are the same.
pub fn tick_labels(ticks: &[f64]) -> Vec<String> {
    let step = ticks.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    let needed = |decimals: &usize| {
        let parts = step * trig::pow(10.0, *decimals as f64);
        parts > 0.5 && (parts - parts.round()).abs() < 1e-3
    };
    let decimals = if step.is_finite() { (0..15).find(needed).unwrap_or(15) } else { 4 };
    ticks.iter().map(|t| fixed(*t, decimals)).collect()
}

/// A time as a person says it: `0.4 s`, `40 s`, `3 min`, `2.5 h`.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 9.95 => format!("{} s", trimmed(s, 1)),
        s if s < 90.0 => format!("{} s", fixed(s, 0)),
        s if s < 5400.0 => format!("{} min", fixed(s / 60.0, 0)),
        s => format!("{} h", trimmed(s / 3600.0, 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_person_reads_no_powers_of_ten() {
        assert_eq!([decimal(1234.5, 3), decimal(0.012_34, 2), decimal(-0.0, 3)], ["1234", "0.012", "0"]);
    }

    #[test]
    fn ticks_differ_from_one_another_in_words_too() {
        for (low, high) in [(0.0, 1.0), (-0.2, 0.9), (2.01997, 2.02003), (0.0, 60.0), (-1e-5, 1e-5), (1000.0, 1003.0)] {
            let ticks = ticks(low, high, 6.0);
            let labels = tick_labels(&ticks);
            let mut different = labels.clone();
            different.dedup();
            assert!(ticks.len() > 2 && different == labels, "{labels:?}");
            for (label, tick) in labels.iter().zip(&ticks) {
                let read: f64 = label.parse().unwrap();
                assert!((read - tick).abs() < 1e-3 * (high - low), "{label} for {tick}");
            }
        }
        assert_eq!(tick_labels(&[0.0, 0.2, 0.4]), ["0.0", "0.2", "0.4"]);
        assert_eq!(tick_labels(&[0.0, 10.0]), ["0", "10"]);
        assert_eq!(tick_labels(&[0.5]), ["0.5000"]);
    }

    #[test]
    fn zeros_have_no_sign() {
        assert_eq!(fixed(-0.004, 2), "0.00");
        assert_eq!(fixed(-0.0, 0), "0");
        assert_eq!(trimmed(-0.0004, 3), "0");
        assert_eq!(shortest(-0.0), "0");
        assert!(tidy(-1e-14).is_sign_positive());
    }

    #[test]
    fn digits_are_kept_and_trimmed() {
        assert_eq!(fixed(-1.005, 1), "-1.0");
        assert_eq!(trimmed(1.500, 3), "1.5");
        assert_eq!(trimmed(2437.5124, 3), "2437.512");
        assert_eq!(trimmed(100.0, 0), "100");
        assert_eq!(shortest(0.1), "0.1");
        assert_eq!(shortest(4.0e7), "40000000");
        assert_eq!(shortest(1e-7), "0.0000001");
    }

    #[test]
    fn noise_is_cleared_and_large_numbers_stay() {
        assert_eq!(tidy(12.000000000000002), 12.0);
        assert_eq!(tidy(0.1 + 0.2), 0.3);
        assert_eq!(tidy(123_456_789.123_456_79), 123_456_789.123_456_79);
    }
}
