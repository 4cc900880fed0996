//! Functions: arithmetic ones on any number, and those that ask the layout's geometry.

use super::dimension::Dimension;
use super::program::mentions;
use super::scope::{Context, Named, Scope};
use super::value::{Quantity, Value};
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Formula, Target};
use crate::source::Span;
use crate::syntax::tree::{Arg, Block, Expr, ExprKind, Name, Section};

/// Functions of numbers.
const ARITHMETIC: &[(&str, &str)] = &[
    ("abs", "abs(value)"),
    ("sqrt", "sqrt(value)"),
    ("min", "min(a, b, ...)"),
    ("max", "max(a, b, ...)"),
    ("sin", "sin(angle)"),
    ("cos", "cos(angle)"),
    ("tan", "tan(angle)"),
];

/// Functions of the layout's geometry.
const GEOMETRY: &[(&str, &str)] = &[
    ("length", "length(P1..P2) or length(straight(P1..P2))"),
    ("heading", "heading(P1..P2)"),
    ("angle", "angle(P1)"),
    ("radius", "radius(P1)"),
    ("x", "x(P1)"),
    ("y", "y(P1)"),
    ("distance", "distance(P1, P2) or distance(P1, obstacle)"),
];

/// A function that expressions may call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Function {
    pub name: &'static str,
    /// How it is called: `distance(P1, P2) or distance(P1, obstacle)`.
    pub usage: &'static str,
    /// Whether it asks the layout's geometry, which only `require` and `equal` may.
    pub geometric: bool,
}

/// Every function there is.
pub fn all() -> impl Iterator<Item = Function> {
    let of = |geometric| move |(name, usage): &(&'static str, &'static str)| Function { name, usage, geometric };
    ARITHMETIC.iter().map(of(false)).chain(GEOMETRY.iter().map(of(true)))
}

/// What a function of the geometry gives: `Ok(None)` is a mistake that has been reported, `Err` a wrong call, at a
/// place if one argument is to blame.
type Asked = Result<Option<(Formula, Dimension)>, Option<Span>>;

impl<'t> Context<'t> {
    pub fn call(&self, scope: Scope<'_, 't>, name: &'t Name, args: &'t Block<Arg>, span: Span) -> Value {
        let known = |table: &'static [(&'static str, &'static str)]| table.iter().find(|(n, _)| *n == name.text);
        let values: Vec<&'t Expr> = args.nodes.iter().map(|n| &n.value.value).collect();
        if let Some(named) = args.nodes.iter().find_map(|n| n.value.name.as_ref())
            && (known(ARITHMETIC).is_some() || known(GEOMETRY).is_some())
        {
            let message = format!("arguments of `{}` have no names", name.text);
            self.report(Diagnostic::new(Code::E0307, message, named.span, "a named argument"));
            return Value::Poison;
        }
        if let Some((_, usage)) = known(ARITHMETIC) {
            return self.arithmetic(scope, &name.text, &values, span, usage);
        }
        let Some((_, usage)) = known(GEOMETRY) else {
            let diagnostic =
                Diagnostic::new(Code::E0211, format!("there is no function `{}`", name.text), name.span, "not known");
            let all = ARITHMETIC.iter().chain(GEOMETRY).map(|(n, _)| *n);
            let listed = all.clone().collect::<Vec<_>>().join(", ");
            let diagnostic = diagnostic.expected(listed, format!("`{}`", name.text));
            self.report(self.with_nearest(diagnostic, name, all));
            return Value::Poison;
        };
        let Some(geometry) = scope.geometry else {
            self.report(
                Diagnostic::new(
                    Code::E0308,
                    format!("`{}` is not known here", name.text),
                    span,
                    "depends on the geometry",
                )
                .expected("a constant", "a formula over the layout's geometry")
                .help("formulas over the geometry belong in `require` and `equal`"),
            );
            return Value::Poison;
        };
        match self.geometric(geometry, &name.text, &values) {
            Ok(Some((formula, dimension))) => Value::Quantity(Quantity { formula, dimension }),
            Ok(None) => Value::Poison,
            Err(at) => {
                self.wrong_arguments(&name.text, at.unwrap_or(span), usage);
                Value::Poison
            }
        }
    }

    fn wrong_arguments(&self, name: &str, span: Span, usage: &str) {
        self.report(
            Diagnostic::new(
                Code::E0307,
                format!("`{name}` is called in a way it does not know"),
                span,
                "these arguments",
            )
            .expected(format!("`{}`", usage.replace(" or ", "` or `")), format!("`{}`", clip(self.sources.text(span)))),
        );
    }

    fn arithmetic(&self, scope: Scope<'_, 't>, name: &str, args: &[&'t Expr], span: Span, usage: &str) -> Value {
        let wanted = if matches!(name, "min" | "max") { args.len() >= 2 } else { args.len() == 1 };
        if !wanted {
            self.wrong_arguments(name, span, usage);
            return Value::Poison;
        }
        let mut quantities = Vec::new();
        for arg in args {
            quantities.push(self.quantity(scope, arg));
        }
        let Some(quantities) = quantities.into_iter().collect::<Option<Vec<Quantity>>>() else { return Value::Poison };
        let Some(first) = quantities.first().cloned() else { return Value::Poison };
        match name {
            "min" | "max" => {
                for (q, arg) in quantities.iter().zip(args).skip(1) {
                    if q.dimension != first.dimension {
                        let what = format!("every argument of `{name}`");
                        let diagnostic = self.wrong_dimension(q, arg.span, first.dimension, &what);
                        self.report(diagnostic.related(args[0].span, first.dimension.with_article()));
                        return Value::Poison;
                    }
                }
                let constants: Option<Vec<f64>> = quantities.iter().map(Quantity::as_constant).collect();
                let formulas = quantities.into_iter().map(|q| q.formula).collect();
                let formula = match (constants, name) {
                    (Some(values), "min") => Formula::Constant(values.into_iter().fold(f64::INFINITY, f64::min)),
                    (Some(values), _) => Formula::Constant(values.into_iter().fold(f64::NEG_INFINITY, f64::max)),
                    (None, "min") => Formula::Smallest(formulas),
                    (None, _) => Formula::Largest(formulas),
                };
                Value::Quantity(Quantity { formula, dimension: first.dimension })
            }
            "abs" => {
                let formula = match first.formula {
                    Formula::Constant(value) => Formula::Constant(value.abs()),
                    other => Formula::Absolute(Box::new(other)),
                };
                Value::Quantity(Quantity { formula, ..first })
            }
            "sqrt" => self.square_root(first, args[0].span),
            _ => {
                let value = Value::Quantity(first);
                let what = format!("the argument of `{name}`");
                let Some(angle) = self.expect_constant(&value, args[0].span, Dimension::ANGLE, &what) else {
                    return Value::Poison;
                };
                let result = match name {
                    "sin" => trig::sin(angle),
                    "cos" => trig::cos(angle),
                    _ => trig::tan(angle),
                };
                self.finite(Formula::Constant(result), Dimension::NONE, span, "the result is no number")
            }
        }
    }

    fn square_root(&self, of: Quantity, span: Span) -> Value {
        let Some(dimension) = of.dimension.square_root() else {
            self.report(
                Diagnostic::new(
                    Code::E0301,
                    "this has no square root with a dimension",
                    span,
                    of.dimension.with_article(),
                )
                .expected("a square, such as an area", of.dimension.to_string()),
            );
            return Value::Poison;
        };
        match of.formula {
            Formula::Constant(value) if value < 0.0 => {
                self.report(
                    Diagnostic::new(Code::E0305, "the square root of a negative number", span, "negative")
                        .expected("a number of at least 0", super::value::shown(value, of.dimension)),
                );
                Value::Poison
            }
            Formula::Constant(value) => Value::constant(libm::sqrt(value), dimension),
            other => Value::Quantity(Quantity { formula: Formula::SquareRoot(Box::new(other)), dimension }),
        }
    }

    /// A function of the geometry.
    fn geometric(&self, geometry: &Named<'t>, name: &str, args: &[&'t Expr]) -> Asked {
        match (name, args) {
            ("length", [target]) => {
                let (section, straight) = as_target(target).ok_or(Some(target.span))?;
                let from = self.section(geometry, &section);
                Ok(from.map(|from| (Formula::Length(Target { from, straight }), Dimension::LENGTH)))
            }
            ("heading", [target]) => {
                let (section, _) = as_target(target).ok_or(Some(target.span))?;
                Ok(self.section(geometry, &section).map(|from| (Formula::Heading(from), Dimension::ANGLE)))
            }
            ("angle" | "radius" | "x" | "y", [arg]) => {
                let vertex = as_name(arg).ok_or(Some(arg.span))?;
                let formula: fn(usize) -> Formula = match name {
                    "angle" => Formula::Angle,
                    "radius" => Formula::Radius,
                    "x" => Formula::X,
                    _ => Formula::Y,
                };
                let dimension = if name == "angle" { Dimension::ANGLE } else { Dimension::LENGTH };
                Ok(self.vertex(geometry, &vertex).map(|v| (formula(v), dimension)))
            }
            ("distance", [a, b]) => {
                let (a, b) = (as_name(a).ok_or(Some(a.span))?, as_name(b).ok_or(Some(b.span))?);
                let Some(from) = self.vertex(geometry, &a) else { return Ok(None) };
                let formula = if let Some(obstacle) = geometry.obstacles.get(b.text.as_str()) {
                    Some(Formula::DistanceObstacle(from, *obstacle))
                } else if b.text == "building" && geometry.building {
                    Some(Formula::DistanceBuilding(from))
                } else {
                    self.vertex(geometry, &b).map(|to| Formula::DistanceVertices(from, to))
                };
                Ok(formula.map(|f| (f, Dimension::LENGTH)))
            }
            _ => Err(None),
        }
    }

    /// Index of a vertex; an unknown one is reported.
    pub fn vertex(&self, geometry: &Named<'t>, name: &Name) -> Option<usize> {
        let found = geometry.vertices.get(name.text.as_str()).copied();
        if found.is_none() && !mentions(&geometry.bad, &name.text) {
            let diagnostic =
                Diagnostic::new(Code::E0207, format!("there is no vertex `{}`", name.text), name.span, "not a vertex");
            self.report(self.with_nearest(diagnostic, name, geometry.order.iter().copied()));
        }
        found
    }

    /// Index of the first vertex of a section; vertices that are not neighbours in driving order are reported.
    pub fn section(&self, geometry: &Named<'t>, section: &Section) -> Option<usize> {
        let (from, to) = (self.vertex(geometry, &section.from), self.vertex(geometry, &section.to));
        let (from, to) = (from?, to?);
        let n = geometry.order.len();
        if (from + 1) % n == to || geometry.incomplete {
            return Some(from);
        }
        let (a, b) = (&section.from.text, &section.to.text);
        let (before, after) = (geometry.order[(from + n - 1) % n], geometry.order[(from + 1) % n]);
        let diagnostic = if (to + 1) % n == from {
            Diagnostic::new(
                Code::E0403,
                format!("the section runs from `{b}` to `{a}`"),
                section.span,
                "against driving order",
            )
            .expected(format!("`{b}..{a}`"), format!("`{a}..{b}`"))
            .fix(section.span, format!("{b}..{a}"))
        } else {
            Diagnostic::new(Code::E0403, format!("`{a}` and `{b}` are not neighbours"), section.span, "not a section")
                .expected("two vertices that follow each other in driving order", format!("`{a}..{b}`"))
                .help(format!(
                    "`{a}` lies between `{before}` and `{after}`: its sections are `{before}..{a}` and `{a}..{after}`"
                ))
        };
        self.report(diagnostic);
        None
    }
}

fn as_name(expr: &Expr) -> Option<Name> {
    match &expr.kind {
        ExprKind::Name(text) => Some(Name { text: text.clone(), span: expr.span }),
        ExprKind::Paren(inner) => as_name(inner),
        _ => None,
    }
}

/// `P4..P5` or `straight(P4..P5)`.
fn as_target(expr: &Expr) -> Option<(Section, bool)> {
    match &expr.kind {
        ExprKind::Range { low, high, step: None } => {
            Some((Section { from: as_name(low)?, to: as_name(high)?, span: expr.span }, false))
        }
        ExprKind::Call { name, args } if name.text == "straight" => match &args.nodes[..] {
            [only] if only.value.name.is_none() => as_target(&only.value.value).map(|(section, _)| (section, true)),
            _ => None,
        },
        _ => None,
    }
}

/// The beginning of a text that may be long.
pub(super) fn clip(text: &str) -> String {
    let line = text.lines().next().unwrap_or("");
    match line.char_indices().nth(60) {
        Some((at, _)) => format!("{}…", &line[..at]),
        None if line.len() < text.len() => format!("{line} …"),
        None => line.to_string(),
    }
}
