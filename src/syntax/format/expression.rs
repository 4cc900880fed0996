//! Expressions as text.

use super::Writer;
use crate::syntax::tree::*;

impl Writer<'_> {
    pub fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Number { digits, unit } => {
                self.push(digits);
                if let Some(unit) = unit {
                    self.push(" ");
                    self.push(&unit.text);
                }
            }
            ExprKind::Text(text) => self.text(text),
            ExprKind::Name(name) => self.push(name),
            ExprKind::Call { name, args } => {
                self.push(&name.text);
                self.args(args, true);
            }
            ExprKind::Negative(operand) => {
                self.push("-");
                self.expr(operand);
            }
            ExprKind::Sum { first, rest } => {
                self.expr(first);
                for (op, operand) in rest {
                    self.push(if *op == SumOp::Plus { " + " } else { " - " });
                    self.expr(operand);
                }
            }
            ExprKind::Product { first, rest } => {
                self.expr(first);
                for (op, operand) in rest {
                    self.push(if *op == ProductOp::Times { " * " } else { " / " });
                    self.expr(operand);
                }
            }
            ExprKind::Paren(inner) => {
                self.push("(");
                self.expr(inner);
                self.push(")");
            }
            ExprKind::List(elements) => self.list("[", elements, "]", false, |writer, element, _| writer.expr(element)),
            ExprKind::Tuple(elements) => {
                self.push("(");
                for (index, element) in elements.iter().enumerate() {
                    self.push(if index > 0 { ", " } else { "" });
                    self.expr(element);
                }
                self.push(")");
            }
            ExprKind::Range { low, high, step } => {
                // Names read as a section, `P4..P5`; values as a range, `3 m .. 8 m`.
                let section = matches!((&low.kind, &high.kind), (ExprKind::Name(_), ExprKind::Name(_)));
                self.expr(low);
                self.push(if section { ".." } else { " .. " });
                self.expr(high);
                if let Some(step) = step {
                    self.push(" step ");
                    self.expr(step);
                }
            }
        }
    }
}
