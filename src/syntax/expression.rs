//! pest's pairs to expressions. The grammar gives a flat run of operands and operators; precedence is applied here,
//! and the spelling of numbers and units is judged.

use super::build::{Builder, take};
use super::tree::*;
use super::{MAX_DEPTH, Rule};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use pest::iterators::{Pair, Pairs};
use std::iter::Peekable;

type Parts<'i> = Peekable<Pairs<'i, Rule>>;

fn next_is(parts: &mut Parts, rule: Rule) -> bool {
    parts.peek().is_some_and(|part| part.as_rule() == rule)
}

/// Takes the next operator if it is one of those wanted.
fn next_op<T>(parts: &mut Parts, wanted: impl Fn(&str) -> Option<T>) -> Option<T> {
    let next = parts.peek().filter(|part| part.as_rule() == Rule::op)?;
    let op = wanted(next.as_str())?;
    parts.next();
    Some(op)
}

impl Builder<'_> {
    /// An `expr`, `value` or `weight`.
    pub fn expression(&mut self, pair: Pair<Rule>) -> Option<Expr> {
        let mut parts = pair.into_inner().peekable();
        let low = self.sum(&mut parts)?;
        let Some(next) = parts.next() else { return Some(low) };
        if next.as_rule() != Rule::dots {
            return None;
        }
        let high = self.sum(&mut parts)?;
        let mut step = None;
        if next_is(&mut parts, Rule::kw_step) {
            parts.next();
            step = Some(self.sum(&mut parts)?);
        }
        let span = low.span.to(step.as_ref().map_or(high.span, |step| step.span));
        let kind = ExprKind::Range { low: Box::new(low), high: Box::new(high), step: step.map(Box::new) };
        Some(Expr { kind, span })
    }

    fn sum(&mut self, parts: &mut Parts) -> Option<Expr> {
        let first = self.product(parts)?;
        let mut rest = Vec::new();
        while let Some(op) = next_op(parts, |sign| match sign {
            "+" => Some(SumOp::Plus),
            "-" => Some(SumOp::Minus),
            _ => None,
        }) {
            rest.push((op, self.product(parts)?));
        }
        let Some((_, last)) = rest.last() else { return Some(first) };
        let span = first.span.to(last.span);
        Some(Expr { kind: ExprKind::Sum { first: Box::new(first), rest }, span })
    }

    fn product(&mut self, parts: &mut Parts) -> Option<Expr> {
        let first = self.factor(parts)?;
        let mut rest = Vec::new();
        while let Some(op) = next_op(parts, |sign| match sign {
            "*" => Some(ProductOp::Times),
            "/" => Some(ProductOp::Divide),
            _ => None,
        }) {
            rest.push((op, self.factor(parts)?));
        }
        let Some((_, last)) = rest.last() else { return Some(first) };
        let span = first.span.to(last.span);
        Some(Expr { kind: ExprKind::Product { first: Box::new(first), rest }, span })
    }

    fn factor(&mut self, parts: &mut Parts) -> Option<Expr> {
        let mut signs = Vec::new();
        while next_is(parts, Rule::minus) {
            let sign = self.span_of(&parts.next()?);
            // More would nest the tree without bounds.
            if signs.len() < MAX_DEPTH {
                signs.push(sign);
            } else if signs.len() == MAX_DEPTH {
                let message = format!("more than {MAX_DEPTH} signs in a row");
                self.report.add(Diagnostic::new(Code::E0105, message, sign, "one too many"));
                signs.push(sign);
            }
        }
        let operand = parts.next()?;
        let mut expr = if operand.as_rule() == Rule::number {
            let unit = parts.next_if(|part| part.as_rule() == Rule::unit);
            self.quantity(&operand, unit)
        } else {
            self.operand(operand)?
        };
        for sign in signs.into_iter().rev() {
            let span = sign.to(expr.span);
            expr = Expr { kind: ExprKind::Negative(Box::new(expr)), span };
        }
        Some(expr)
    }

    fn operand(&mut self, pair: Pair<Rule>) -> Option<Expr> {
        let span = self.span_of(&pair);
        let kind = match pair.as_rule() {
            Rule::text => ExprKind::Text(self.unescape(&pair)),
            Rule::reference => self.name_or_call(pair, span)?,
            Rule::list => ExprKind::List(self.block(pair, 1, |builder, pair| match pair.as_rule() {
                Rule::expr => builder.expression(pair),
                _ => None,
            })),
            Rule::paren => {
                let mut parts = pair.into_inner();
                let first = self.expression(take(&mut parts, Rule::expr)?)?;
                let Some(second) = take(&mut parts, Rule::expr) else {
                    return Some(Expr { kind: ExprKind::Paren(Box::new(first)), span });
                };
                let mut elements = vec![first, self.expression(second)?];
                while let Some(next) = take(&mut parts, Rule::expr) {
                    elements.push(self.expression(next)?);
                }
                ExprKind::Tuple(elements)
            }
            _ => return None,
        };
        Some(Expr { kind, span })
    }

    fn name_or_call(&mut self, pair: Pair<Rule>, span: Span) -> Option<ExprKind> {
        let mut parts = pair.into_inner();
        let name = self.name(&take(&mut parts, Rule::name)?);
        if let Some(args) = take(&mut parts, Rule::args) {
            let args = self.args(args);
            return Some(ExprKind::Call { name, args });
        }
        let word = name.text.to_ascii_lowercase();
        if matches!(word.as_str(), "nan" | "inf" | "infinity") {
            let message = format!("`{}` is no number here", name.text);
            self.report.add(
                Diagnostic::new(Code::E0108, message, span, "every value is a finite number")
                    .help("leave the line out where nothing is to be limited"),
            );
        }
        Some(ExprKind::Name(name.text))
    }

    fn quantity(&mut self, number: &Pair<Rule>, unit: Option<Pair<Rule>>) -> Expr {
        let span = self.span_of(number);
        let digits = self.digits(number);
        let unit = unit.map(|unit| self.unit(&unit));
        let span = unit.as_ref().map_or(span, |unit| span.to(unit.span));
        Expr { kind: ExprKind::Number { digits, unit }, span }
    }

    /// The digits as written, or what they should have been.
    fn digits(&mut self, pair: &Pair<Rule>) -> String {
        let written = pair.as_str();
        let Some((meant, why)) = misspelt(written) else { return written.to_string() };
        let span = self.span_of(pair);
        let shown = shorten(written);
        let mut problem = Diagnostic::new(Code::E0108, format!("`{shown}` is not written as a number"), span, why);
        if let Some(meant) = &meant {
            problem = problem.fix(span, meant.clone());
        }
        self.report.add(problem);
        meant.unwrap_or_else(|| "0".to_string())
    }

    /// The unit as written; `m2`, `m²` and `N·m` are reported and read as what they mean.
    fn unit(&mut self, pair: &Pair<Rule>) -> Name {
        let written = pair.as_str();
        let span = self.span_of(pair);
        let mut meant = String::with_capacity(written.len());
        let mut before = ' ';
        for c in written.chars() {
            match c {
                '²' => meant.push_str("^2"),
                '³' => meant.push_str("^3"),
                '·' => meant.push('*'),
                '0'..='9' if before.is_alphabetic() => meant.extend(['^', c]),
                'μ' => meant.push('µ'),
                _ => meant.push(c),
            }
            before = c;
        }
        if meant.replace('µ', "μ") != written.replace('µ', "μ") {
            let message = format!("`{}` is not how a unit is written", shorten(written));
            self.report.add(
                Diagnostic::new(Code::E0110, message, span, format!("write `{}`", shorten(&meant)))
                    .help("powers are written `m^2`, products `N*m`, quotients `m/s`")
                    .fix(span, meant.clone()),
            );
        }
        Name { text: meant, span }
    }
}

/// What is wrong with a number, and how it should be written if that can be told.
fn misspelt(written: &str) -> Option<(Option<String>, &'static str)> {
    if written.starts_with("0x") || written.starts_with("0X") {
        let value = u32::from_str_radix(&written[2..], 16).ok();
        return Some((value.map(|value| value.to_string()), "numbers are decimal"));
    }
    if written.starts_with('.') {
        let meant = format!("0{written}");
        let meant = misspelt(&meant).map_or(Some(meant), |(further, _)| further);
        return Some((meant, "a digit comes before the point"));
    }
    let (mantissa, exponent) = match written.find(['e', 'E']) {
        Some(at) => (&written[..at], Some(&written[at + 1..])),
        None => (written, None),
    };
    if exponent.is_some_and(|exponent| !exponent.contains(|c: char| c.is_ascii_digit())) {
        let meant = mantissa.to_string();
        let meant = misspelt(&meant).map_or(Some(meant), |(further, _)| further);
        return Some((meant, "the exponent has no digits"));
    }
    if let Some((whole, fraction)) = mantissa.split_once('.')
        && !fraction.starts_with(|c: char| c.is_ascii_digit())
    {
        let rest = exponent.map_or(String::new(), |exponent| format!("e{exponent}"));
        return Some((Some(format!("{whole}.0{fraction}{rest}")), "a digit comes after the point"));
    }
    let plain: String = written.chars().filter(|c| *c != '_').collect();
    match plain.parse::<f64>() {
        Ok(value) if value.is_finite() => None,
        _ => Some((None, "too large for a number")),
    }
}

fn shorten(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((at, _)) => format!("{}…", &text[..at]),
        None => text.to_string(),
    }
}
