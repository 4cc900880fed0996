//! The values of a sweep's parameters, and their products.

use crate::base::number::{shortest, tidy};
use crate::source::Span;

/// A parameter of a sweep with its values, one or several.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// `file`, `let.aisle`, `simulate.speed`, `simulate.set.cart.mass_kg`: the name of its column.
    pub key: String,
    /// Of the key.
    pub span: Span,
    pub values: Vec<AxisValue>,
}

/// A value as it is told to the verb, and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisValue {
    pub text: String,
    pub span: Span,
}

/// Axes that go together: of each row, which value of each axis. Groups follow the file's order; the last one varies
/// fastest.
pub fn rows<'a>(axes: &'a [Axis], groups: &'a [Vec<usize>]) -> impl Iterator<Item = Vec<&'a AxisValue>> + 'a {
    let count = count(axes, groups).unwrap_or(0);
    (0..count).map(move |row| {
        let mut left = row;
        let mut at = vec![0; axes.len()];
        for group in groups.iter().rev() {
            let size = group.first().map_or(1, |k| axes[*k].values.len()).max(1);
            group.iter().for_each(|k| at[*k] = left % size);
            left /= size;
        }
        axes.iter().zip(at).filter_map(|(axis, k)| axis.values.get(k)).collect()
    })
}

/// How many rows there are; `None` beyond what can be counted.
pub fn count(axes: &[Axis], groups: &[Vec<usize>]) -> Option<usize> {
    groups.iter().try_fold(1_usize, |all, group| all.checked_mul(group.first().map_or(1, |k| axes[*k].values.len())))
}

/// From a number to another in steps, the end among them where a step meets it.
pub fn stepped(from: f64, to: f64, step: f64, most: usize) -> Option<Vec<f64>> {
    const HIT: f64 = 1e-9;
    let steps = (to - from) / step;
    if !(steps.is_finite() && steps >= -HIT && steps < most as f64) {
        return None;
    }
    Some((0..=(steps + HIT).floor() as usize).map(|k| tidy(from + k as f64 * step)).collect())
}

/// So many numbers from one to another, at equal distances.
pub fn spread(from: f64, to: f64, count: usize) -> Vec<f64> {
    if count == 1 {
        return vec![from];
    }
    (0..count).map(|k| tidy(from + (to - from) * k as f64 / (count - 1) as f64)).collect()
}

/// A number with a unit behind it, as options and `let`s take it.
pub fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { shortest(value) } else { format!("{} {unit}", shortest(value)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::FileId;

    fn axis(key: &str, values: &[&str]) -> Axis {
        let span = Span::new(FileId(0), 0, 0);
        let values = values.iter().map(|text| AxisValue { text: (*text).to_owned(), span }).collect();
        Axis { key: key.to_owned(), span, values }
    }

    fn listed(axes: &[Axis], groups: &[Vec<usize>]) -> Vec<String> {
        rows(axes, groups).map(|row| row.iter().map(|v| v.text.as_str()).collect::<Vec<_>>().concat()).collect()
    }

    #[test]
    fn axes_multiply_and_those_of_a_group_go_together() {
        let axes = [axis("a", &["1", "2"]), axis("b", &["x"]), axis("c", &["u", "v", "w"]), axis("d", &["5", "6"])];
        let alone: Vec<Vec<usize>> = (0..4).map(|k| vec![k]).collect();
        assert_eq!(listed(&axes, &alone).len(), 12);
        assert_eq!(listed(&axes, &alone)[..3], ["1xu5", "1xu6", "1xv5"]);
        assert_eq!(listed(&axes, &[vec![0, 3], vec![1], vec![2]]), ["1xu5", "1xv5", "1xw5", "2xu6", "2xv6", "2xw6"]);
        assert_eq!(listed(&[], &[]), [""], "nothing varies: one task");
    }

    #[test]
    fn ranges_have_round_numbers_and_their_end() {
        assert_eq!(stepped(1.0, 1.3, 0.1, 100), Some(vec![1.0, 1.1, 1.2, 1.3]));
        assert_eq!(stepped(1.0, 1.35, 0.1, 100), Some(vec![1.0, 1.1, 1.2, 1.3]));
        assert_eq!(stepped(3.0, 1.0, -1.0, 100), Some(vec![3.0, 2.0, 1.0]));
        for (from, to, step) in [(1.0, 2.0, 0.0), (1.0, 2.0, -1.0), (0.0, 1e9, 1e-3), (0.0, f64::NAN, 1.0)] {
            assert_eq!(stepped(from, to, step, 1000), None, "{from} {to} {step}");
        }
        assert_eq!(spread(0.0, 0.3, 4), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(with_unit(0.1, "m/s"), "0.1 m/s");
    }
}
