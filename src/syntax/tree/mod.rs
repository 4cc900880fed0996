//! The syntax tree: what was written, with every comment and every span, and no meaning yet.
//!
//! Lists that may span lines (statements in a block, polygon points, arguments) hold [`Node`]s, which carry the
//! comments around an item; comments can stand nowhere else, so the formatter keeps them all.

mod declaration;
mod expression;
mod node;
mod place;
mod statement;

pub use declaration::{Declaration, DeclarationKind, Field, Let, Param, Reference};
pub use expression::{Arg, Expr, ExprKind, ProductOp, SumOp};
pub use node::{Block, Name, Node, TextExpr};
pub use place::{
    After, EquippedExpr, EquippedPlace, PlaceExpr, PlacedSection, PointExpr, RowExpr, Section, StationWord, Target,
};
pub use statement::{Axis, FixKind, Goal, ObjectiveExpr, Relation, SideWord, Statement, TitleField};

use crate::source::{FileId, Span};

/// A whole file.
#[derive(Clone, Debug)]
pub struct Tree {
    pub file: FileId,
    pub items: Block<Item>,
}

#[derive(Clone, Debug)]
pub enum Item {
    Use(Use),
    Let(Let),
    Declaration(Declaration),
    Layout(LayoutDeclaration),
    /// A statement that did not parse; already reported. The formatter refuses a file with one.
    Bad,
}

/// `use std.tracks.standard` (the path as written, with `std`) or `use "../shared/carts.lss"`.
#[derive(Clone, Debug)]
pub enum Use {
    Std { path: Vec<Name>, span: Span },
    File { path: String, span: Span },
}

/// `layout west_b from west_a { ... }`. With `from` the body may be absent.
#[derive(Clone, Debug)]
pub struct LayoutDeclaration {
    pub name: Name,
    pub params: Block<Param>,
    pub from: Option<Reference>,
    pub body: Block<Statement>,
    pub span: Span,
}
