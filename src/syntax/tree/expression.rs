//! Expressions, and arguments of calls.

use super::node::{Block, Name};
use crate::source::Span;

/// An argument; calls of functions have unnamed ones.
#[derive(Clone, Debug)]
pub struct Arg {
    pub name: Option<Name>,
    pub value: Expr,
}

/// An expression. Sums and products are flat, so that a long one does not nest.
#[derive(Clone, Debug)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum ExprKind {
    /// The digits as written, and the unit as written.
    Number {
        digits: String,
        unit: Option<Name>,
    },
    Text(String),
    Name(String),
    /// `length(P4..P5)`, `straight(P4..P5)`, `tilt_tray(length: 1250 mm)`
    Call {
        name: Name,
        args: Block<Arg>,
    },
    Negative(Box<Expr>),
    Sum {
        first: Box<Expr>,
        rest: Vec<(SumOp, Expr)>,
    },
    Product {
        first: Box<Expr>,
        rest: Vec<(ProductOp, Expr)>,
    },
    Paren(Box<Expr>),
    /// `[3 m, 4 m]`
    List(Block<Expr>),
    /// `(1 m, 2 m)`
    Tuple(Vec<Expr>),
    /// `P4..P5`, `3 m .. 8 m`, `500 mm .. 1250 mm step 50 mm`
    Range {
        low: Box<Expr>,
        high: Box<Expr>,
        step: Option<Box<Expr>>,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SumOp {
    Plus,
    Minus,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProductOp {
    Times,
    Divide,
}
