//! The one rule of how many digits a sample keeps, in every format.

use super::Channel;
use crate::base::number::normal;

/// Rounds a sample to seven significant digits and to no finer than a millionth of its unit.
///
/// A force transducer resolves five digits at best; and what a low-pass rings down to (1e-30 N) is nothing. Lost
/// samples (NaN) stay lost.
pub fn round(channel: Channel, value: f64) -> f64 {
    if channel == Channel::Trigger { value } else { normal(rounded(value)) }
}

fn rounded(value: f64) -> f64 {
    let size = value.abs();
    // Both factors are exact, so the quotient is the double nearest to the decimal number.
    let mut parts = 1e6;
    let mut reach = 10.0;
    while size >= reach && parts > 1.0 {
        parts /= 10.0;
        reach *= 10.0;
    }
    if size < reach {
        return (value * parts).round() / parts;
    }
    let mut unit = 1.0;
    while size >= reach && unit < 1e15 {
        unit *= 10.0;
        reach *= 10.0;
    }
    if size < reach { (value / unit).round() * unit } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seven_digits_and_no_finer_than_a_millionth() {
        let cases = [
            (123.456_789_12, 123.4568),
            (-9.999_999_96, -10.0),
            (1.234_567_89, 1.234568),
            (0.000_123_456, 0.000123),
            (-1e-30, 0.0),
            (12_345_678.9, 12_345_680.0),
            (9_999_999.4, 9_999_999.0),
            (1.234_567_89e12, 1.234568e12),
            (1e300, 1e300),
        ];
        for (value, expected) in cases {
            let found = round(Channel::JointXi, value);
            assert_eq!(found.to_bits(), f64::to_bits(expected), "{value}: {found}");
            assert_eq!(round(Channel::JointXi, found), found, "rounding twice changes nothing");
        }
        assert!(round(Channel::JointXi, f64::NAN).is_nan());
        assert!(round(Channel::JointXi, f64::INFINITY).is_infinite());
    }
}
