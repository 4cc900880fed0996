//! What is declared beside a layout: values, carts, catalogues and other components.

use super::expression::{Arg, Expr};
use super::node::{Block, Name};
use crate::source::Span;

/// `let aisle = 2 * 1.2 m`.
#[derive(Clone, Debug)]
pub struct Let {
    pub name: Name,
    pub value: Expr,
}

/// What a declaration beside `layout` declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DeclarationKind {
    Catalog,
    Cart,
    Wheel,
    Joint,
    Motor,
    Controller,
    Sensor,
    TakeUp,
    Equipment,
}

/// `cart heavy(length: 1250 mm) from tilt_tray(length: length) { mass = 52 kg }`. With `from` the body may be absent.
#[derive(Clone, Debug)]
pub struct Declaration {
    pub kind: DeclarationKind,
    pub kind_span: Span,
    pub name: Name,
    pub params: Block<Param>,
    pub from: Option<Reference>,
    pub fields: Block<Field>,
    pub span: Span,
}

/// A parameter with its default, which also gives its dimension.
#[derive(Clone, Debug)]
pub struct Param {
    pub name: Name,
    pub default: Expr,
}

/// A declaration's name with arguments: `tilt_tray(length: 1250 mm)`.
#[derive(Clone, Debug)]
pub struct Reference {
    pub name: Name,
    pub args: Option<Block<Arg>>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Field {
    /// `mass = 52 kg`
    Value {
        name: Name,
        value: Expr,
    },
    /// `straight { ... }`
    Group {
        name: Name,
        fields: Block<Field>,
    },
    Bad,
}
