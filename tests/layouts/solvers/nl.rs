//! A reader of `.nl` files that shares nothing with the writer: the text form as Gay (2005) describes it.

use std::collections::BTreeMap;

/// An expression in prefix form.
enum Expression {
    Number(f64),
    Variable(usize),
    Apply(u32, Vec<Expression>),
}

/// Constraints are `low <= body + linear <= high`.
#[derive(Default)]
pub struct Nl {
    header: Vec<Vec<usize>>,
    defined: Vec<Expression>,
    bodies: BTreeMap<usize, Expression>,
    linear: BTreeMap<usize, Vec<(usize, f64)>>,
    objective: Option<Expression>,
    columns: Vec<usize>,
    pub start: Vec<f64>,
    pub constraint_limits: Vec<(f64, f64)>,
    pub variable_limits: Vec<(f64, f64)>,
}

impl Nl {
    pub fn read(text: &str) -> Nl {
        let mut lines = text.lines();
        let mut nl = Nl::default();
        assert!(lines.next().is_some_and(|line| line.starts_with("g3 ")));
        for line in lines.by_ref().take(9) {
            let plain = line.split('#').next().unwrap_or("");
            nl.header.push(plain.split_whitespace().map(|word| word.parse().unwrap()).collect());
        }
        let (variables, constraints) = (nl.header[0][0], nl.header[0][1]);
        while let Some(line) = lines.next() {
            let (kind, rest) = line.split_at(1);
            let numbers: Vec<usize> = rest.split_whitespace().map(|word| word.parse().unwrap()).collect();
            match kind {
                "V" => {
                    assert_eq!(numbers, [variables + nl.defined.len(), 0, 0]);
                    let body = expression(&mut lines);
                    nl.defined.push(body);
                }
                "C" => assert!(nl.bodies.insert(numbers[0], expression(&mut lines)).is_none()),
                "O" => nl.objective = Some(expression(&mut lines)),
                "x" => nl.start = pairs(&mut lines, numbers[0]).into_iter().map(|(_, value)| value).collect(),
                "r" => nl.constraint_limits = (0..constraints).map(|_| limits(lines.next().unwrap())).collect(),
                "b" => nl.variable_limits = (0..variables).map(|_| limits(lines.next().unwrap())).collect(),
                "k" => nl.columns = (0..numbers[0]).map(|_| lines.next().unwrap().parse().unwrap()).collect(),
                "J" => assert!(nl.linear.insert(numbers[0], pairs(&mut lines, numbers[1])).is_none()),
                "G" => assert!(pairs(&mut lines, numbers[1]).iter().all(|(_, k)| *k == 0.0)),
                other => panic!("unknown segment {other}"),
            }
        }
        nl.check_counts();
        nl
    }

    /// Every count of the header against what is in the file.
    fn check_counts(&self) {
        let h = &self.header;
        let entries: usize = self.linear.values().map(Vec::len).sum();
        assert_eq!(h[6][0], entries);
        let mut columns = vec![0; h[0][0]];
        self.linear.values().flatten().for_each(|(k, _)| columns[*k] += 1);
        let cumulative: Vec<usize> = columns
            .iter()
            .scan(0, |sum, count| {
                *sum += count;
                Some(*sum)
            })
            .take(h[0][0] - 1)
            .collect();
        assert_eq!(self.columns, cumulative);
        let equations = self.constraint_limits.iter().filter(|(low, high)| low == high).count();
        let ranges = self.constraint_limits.iter().filter(|(low, high)| low < high && (high - low).is_finite()).count();
        assert_eq!(h[0][2..], [1, ranges, equations]);
        // Nonlinear constraints come first, and only they have a body.
        let nonlinear = self.bodies.values().take_while(|body| !matches!(body, Expression::Number(0.0))).count();
        assert_eq!(h[1], [nonlinear, 1]);
        assert!(self.bodies.values().skip(nonlinear).all(|body| matches!(body, Expression::Number(0.0))));
        assert_eq!(h[8].iter().sum::<usize>(), self.defined.len());
    }

    /// Values of the constraints, and of the objective.
    pub fn evaluate(&self, x: &[f64]) -> (Vec<f64>, f64) {
        let mut values = x.to_vec();
        for body in &self.defined {
            let value = body.value(&values);
            values.push(value);
        }
        let row = |(i, body): (&usize, &Expression)| {
            let linear = self.linear.get(i).into_iter().flatten();
            body.value(&values) + linear.map(|(k, c)| c * x[*k]).sum::<f64>()
        };
        (self.bodies.iter().map(row).collect(), self.objective.as_ref().unwrap().value(&values))
    }
}

impl Expression {
    fn value(&self, x: &[f64]) -> f64 {
        let Expression::Apply(operator, parts) = self else {
            return match self {
                Expression::Variable(k) => x[*k],
                Expression::Number(value) => *value,
                Expression::Apply(..) => unreachable!(),
            };
        };
        let v: Vec<f64> = parts.iter().map(|part| part.value(x)).collect();
        match operator {
            0 => v[0] + v[1],
            1 => v[0] - v[1],
            2 => v[0] * v[1],
            3 => v[0] / v[1],
            11 => v.into_iter().fold(f64::INFINITY, f64::min),
            12 => v.into_iter().fold(f64::NEG_INFINITY, f64::max),
            15 => v[0].abs(),
            16 => -v[0],
            38 => libm::tan(v[0]),
            39 => v[0].sqrt(),
            48 => libm::atan2(v[0], v[1]),
            54 => v.into_iter().sum(),
            other => panic!("unknown operator {other}"),
        }
    }
}

fn expression<'a>(lines: &mut impl Iterator<Item = &'a str>) -> Expression {
    let (kind, rest) = lines.next().unwrap().split_at(1);
    match kind {
        "n" => Expression::Number(rest.parse().unwrap()),
        "v" => Expression::Variable(rest.parse().unwrap()),
        "o" => {
            let operator = rest.parse().unwrap();
            let count = match operator {
                0..=3 | 48 => 2,
                15 | 16 | 38 | 39 => 1,
                _ => lines.next().unwrap().parse().unwrap(),
            };
            Expression::Apply(operator, (0..count).map(|_| expression(lines)).collect())
        }
        other => panic!("unknown expression {other}"),
    }
}

fn pairs<'a>(lines: &mut impl Iterator<Item = &'a str>, count: usize) -> Vec<(usize, f64)> {
    let pair = |line: &str| {
        let (index, value) = line.split_once(' ').unwrap();
        (index.parse().unwrap(), value.parse().unwrap())
    };
    (0..count).map(|_| pair(lines.next().unwrap())).collect()
}

fn limits(line: &str) -> (f64, f64) {
    let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
    match numbers[..] {
        [0.0, low, high] => (low, high),
        [1.0, high] => (f64::NEG_INFINITY, high),
        [2.0, low] => (low, f64::INFINITY),
        [3.0] => (f64::NEG_INFINITY, f64::INFINITY),
        [4.0, value] => (value, value),
        _ => panic!("unknown limits {line}"),
    }
}
