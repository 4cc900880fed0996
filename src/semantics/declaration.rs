//! Declarations to components: parameters, `from`, and fields checked against their table.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::dimension::{Dimension, parse_unit};
use super::fields::{Bounds, FieldSpec, Presence, Shape, fields};
use super::program::{Space, Symbol, repeated};
use super::scope::{Context, Env, Local, Scope};
use super::value::{Value, number, shown};
use crate::diagnostic::{Code, Diagnostic};
use crate::model::Interval;
use crate::source::{Span, Spanned};
use crate::syntax::tree::{Arg, Block, Declaration, Expr, ExprKind, Field, Item, Kind, Name, Param, Reference};

/// Arguments by name: value, the name as written, and the value's place.
pub(super) type Arguments<'t> = BTreeMap<&'t str, (Value, &'t Name, Span)>;

/// A declaration with its arguments in: every field that was written, checked.
#[derive(Clone, Debug)]
pub(super) struct Component {
    pub name: String,
    /// The declaration.
    pub span: Span,
    fields: BTreeMap<&'static str, Filled>,
    /// Whether every required field is there and sound.
    pub complete: bool,
}

/// A field's value with its place; `None` is a mistake that has been reported.
#[derive(Clone, Debug)]
struct Filled {
    value: Option<FieldValue>,
    span: Span,
}

#[derive(Clone, Debug)]
enum FieldValue {
    Number(f64),
    Numbers(Vec<f64>),
    Interval(Interval),
    Text(String),
    Component(Rc<Component>),
    /// A stiffness: its dimension hangs on the exponent beside it, which `from` may change.
    Stiffness(Value),
}

impl Component {
    pub fn has(&self, path: &str) -> bool {
        self.fields.contains_key(path)
    }

    pub fn place(&self, path: &str) -> Span {
        self.fields.get(path).map_or(self.span, |f| f.span)
    }

    fn value(&self, path: &str) -> Option<&FieldValue> {
        self.fields.get(path)?.value.as_ref()
    }

    pub fn number(&self, path: &str) -> Option<f64> {
        match self.value(path)? {
            FieldValue::Number(value) => Some(*value),
            FieldValue::Stiffness(Value::Quantity(quantity)) => quantity.as_constant(),
            _ => None,
        }
    }

    /// Also a tuple's numbers.
    pub fn numbers(&self, path: &str) -> Option<&[f64]> {
        if let FieldValue::Numbers(values) = self.value(path)? { Some(values) } else { None }
    }

    pub fn interval(&self, path: &str) -> Option<Interval> {
        if let FieldValue::Interval(value) = self.value(path)? { Some(*value) } else { None }
    }

    pub fn text(&self, path: &str) -> Option<&str> {
        if let FieldValue::Text(text) = self.value(path)? { Some(text) } else { None }
    }

    pub fn component(&self, path: &str) -> Option<&Rc<Component>> {
        if let FieldValue::Component(inner) = self.value(path)? { Some(inner) } else { None }
    }
}

impl<'t> Context<'t> {
    /// The component that a reference names, with its arguments. `None` when it is unknown or calls itself.
    pub fn component(&self, env: &Rc<Env<'t>>, kind: Kind, reference: &'t Reference) -> Option<Rc<Component>> {
        let symbol = self.resolve(env.module, Space::Component(kind), &reference.name)?;
        let Item::Declaration(declaration) = self.program.item(symbol) else { return None };
        let args = match &reference.args {
            Some(block) => self.arguments(env, &reference.name, block),
            None => BTreeMap::new(),
        };
        self.instantiate(symbol, declaration, args, reference.name.span)
    }

    /// The item that a name stands for; an unknown one is reported.
    pub fn resolve(&self, module: usize, space: Space, name: &Name) -> Option<Symbol> {
        if let Some(symbol) = self.find(module, space, &name.text) {
            return Some(symbol);
        }
        let seen = &self.program.modules[module];
        if seen.bad_mentions(&name.text) {
            return None;
        }
        let diagnostic = Diagnostic::new(
            Code::E0206,
            format!("there is no {} `{}`", space.word(), name.text),
            name.span,
            "not known here",
        );
        let kinds = [Kind::Catalog, Kind::Cart, Kind::Wheel, Kind::Joint, Kind::Motor, Kind::Controller, Kind::Sensor];
        let mut spaces = kinds.map(Space::Component).into_iter().chain([Space::Let, Space::Layout]);
        let diagnostic = match spaces.find(|other| seen.find(*other, &name.text).is_some()) {
            Some(other) => diagnostic.expected(space.with_article(), other.with_article()).help(format!(
                "`{}` is {}",
                name.text,
                other.with_article()
            )),
            None => match self.suggest(&name.text, seen.names(space)) {
                Some(near) => diagnostic.help(format!("did you mean `{near}`?")).fix(name.span, near),
                None => match standard_home(space, &name.text) {
                    Some(home) => {
                        diagnostic.help(format!("the standard library has it: `use std.{home}.{}`", name.text))
                    }
                    None => diagnostic,
                },
            },
        };
        self.report(diagnostic);
        None
    }

    /// The declaration with its defaults, for checks of what nobody uses yet.
    pub fn with_defaults(&self, symbol: Symbol, declaration: &'t Declaration) -> Option<Rc<Component>> {
        self.instantiate(symbol, declaration, BTreeMap::new(), declaration.name.span)
    }

    /// Arguments by name; unnamed and repeated ones are reported.
    pub fn arguments(&self, env: &Rc<Env<'t>>, owner: &Name, block: &'t Block<Arg>) -> Arguments<'t> {
        let mut args: Arguments<'t> = BTreeMap::new();
        for node in &block.nodes {
            let arg = &node.value;
            let value = self.evaluate(Scope { env, geometry: None }, &arg.value);
            let Some(name) = &arg.name else {
                let message = format!("arguments of `{}` need names", owner.text);
                self.report(
                    Diagnostic::new(Code::E0307, message, arg.value.span, "an argument without a name")
                        .expected("`name: value`", "a value alone"),
                );
                continue;
            };
            match args.get(name.text.as_str()) {
                Some((_, first, _)) => self.report(repeated("argument", name, first.span)),
                None => {
                    args.insert(&name.text, (value, name, arg.value.span));
                }
            }
        }
        args
    }

    /// The environment that binds parameters to arguments or defaults; unknown arguments are reported.
    pub fn bind(
        &self,
        module: usize,
        params: &'t Block<Param>,
        mut args: Arguments<'t>,
        owner: &Name,
    ) -> BTreeMap<&'t str, Local<'t>> {
        let global = Env::global(module);
        let mut locals: BTreeMap<&'t str, Local<'t>> = BTreeMap::new();
        let mut first: BTreeMap<&'t str, &'t Name> = BTreeMap::new();
        for node in &params.nodes {
            let param = &node.value;
            if let Some(earlier) = first.insert(&param.name.text, &param.name) {
                self.report(repeated("parameter", &param.name, earlier.span));
                continue;
            }
            let default = self.evaluate(Scope { env: &global, geometry: None }, &param.default);
            let value = match (args.remove(param.name.text.as_str()), &default) {
                (None, _) => default,
                (Some((value, ..)), Value::Poison) => value,
                (Some((Value::Quantity(given), _, span)), Value::Quantity(wanted)) => {
                    match given.dimension == wanted.dimension {
                        true => Value::Quantity(given),
                        false => {
                            let what = format!("`{}`", param.name.text);
                            let diagnostic = self.wrong_dimension(&given, span, wanted.dimension, &what);
                            self.report(diagnostic.related(param.default.span, "its default"));
                            Value::Poison
                        }
                    }
                }
                (Some((value, _, span)), wanted) => {
                    let same = std::mem::discriminant(&value) == std::mem::discriminant(wanted);
                    if !same && value != Value::Poison {
                        let message = format!("`{}` must be {}", param.name.text, wanted.described());
                        self.report(
                            Diagnostic::new(Code::E0304, message, span, value.described())
                                .expected(wanted.described(), value.described())
                                .related(param.default.span, "its default"),
                        );
                    }
                    if same { value } else { Value::Poison }
                }
            };
            locals.insert(&param.name.text, Local::Param(value));
        }
        for (_, name, _) in args.values() {
            let known: Vec<&str> = locals.keys().copied().collect();
            let message = format!("`{}` has no parameter `{}`", owner.text, name.text);
            let diagnostic = Diagnostic::new(Code::E0210, message, name.span, "not a parameter");
            let listed = match known.is_empty() {
                true => "no arguments".to_string(),
                false => known.iter().map(|k| format!("`{k}`")).collect::<Vec<_>>().join(", "),
            };
            let diagnostic =
                diagnostic.expected(listed, format!("`{}`", name.text)).related(owner.span, "declared here");
            self.report(self.with_nearest(diagnostic, name, known));
        }
        locals
    }

    fn instantiate(
        &self,
        symbol: Symbol,
        declaration: &'t Declaration,
        args: Arguments<'t>,
        used_at: Span,
    ) -> Option<Rc<Component>> {
        if self.instantiating.borrow().contains(&symbol) {
            self.report(
                Diagnostic::new(
                    Code::E0216,
                    format!("`{}` extends itself", declaration.name.text),
                    used_at,
                    "needed to declare itself",
                )
                .related(declaration.name.span, "declared here")
                .help("extend another declaration, or write all fields"),
            );
            return None;
        }
        let plain = args.is_empty();
        if plain && let Some(known) = self.components.borrow().get(&symbol) {
            return known.clone();
        }
        self.instantiating.borrow_mut().push(symbol);
        let made = self.deeper(used_at, || self.fill(symbol, declaration, args)).flatten();
        self.instantiating.borrow_mut().pop();
        if plain {
            self.components.borrow_mut().insert(symbol, made.clone());
        }
        made
    }

    fn fill(&self, symbol: Symbol, declaration: &'t Declaration, args: Arguments<'t>) -> Option<Rc<Component>> {
        let locals = self.bind(symbol.module, &declaration.params, args, &declaration.name);
        let env = Rc::new(Env { module: symbol.module, locals, outer: None });
        let kind = declaration.kind;
        let mut sound = true;
        let mut component = Component {
            name: declaration.name.text.clone(),
            span: declaration.name.span,
            fields: BTreeMap::new(),
            complete: false,
        };
        if let Some(from) = &declaration.from {
            match self.component(&env, kind, from) {
                Some(base) => {
                    sound = base.complete;
                    component.fields = base.fields.clone();
                }
                // The base has been reported: what it would have brought is not missing.
                None => sound = false,
            }
        }
        let base_known = declaration.from.is_none() || sound;
        sound &= self.fill_block(&env, kind, "", &declaration.fields, &mut component);
        sound &= self.check_stiffness(kind, &component, declaration.span);
        sound &= component.fields.values().all(|f| f.value.is_some());
        if base_known {
            sound &= self.check_missing(kind, declaration, &component);
        }
        component.complete = sound;
        Some(Rc::new(component))
    }

    /// Fills in the fields of a block; says whether all of them parsed.
    fn fill_block(
        &self,
        env: &Rc<Env<'t>>,
        kind: Kind,
        prefix: &str,
        block: &'t Block<Field>,
        component: &mut Component,
    ) -> bool {
        let mut sound = true;
        let mut first: BTreeMap<&'t str, Span> = BTreeMap::new();
        for node in &block.nodes {
            let (Field::Value { name, .. } | Field::Group { name, .. }) = &node.value else {
                sound = false;
                continue;
            };
            if let Some(earlier) = first.insert(&name.text, name.span) {
                self.report(repeated("field", name, earlier));
                sound = false;
                continue;
            }
            let path = format!("{prefix}{}", name.text);
            let group = format!("{path}.");
            match &node.value {
                Field::Group { fields: inner, .. } if fields(kind).iter().any(|f| f.path.starts_with(&group)) => {
                    sound &= self.fill_block(env, kind, &group, inner, component);
                }
                Field::Value { value, .. } => match fields(kind).iter().find(|f| f.path == path) {
                    Some(spec) => {
                        let filled = self.field(env, spec, value);
                        component.fields.insert(spec.path, Filled { value: filled, span: value.span });
                    }
                    None => {
                        self.unknown_field(kind, prefix, name, &group);
                        sound = false;
                    }
                },
                _ => {
                    self.unknown_field(kind, prefix, name, &group);
                    sound = false;
                }
            }
        }
        sound
    }

    fn unknown_field(&self, kind: Kind, prefix: &str, name: &Name, group: &str) {
        let known = || -> Vec<&'static str> {
            let inside = fields(kind).iter().filter_map(|f| f.path.strip_prefix(prefix));
            let mut names: Vec<&'static str> = inside.map(|p| p.split('.').next().unwrap_or(p)).collect();
            names.dedup();
            names
        };
        let owner = Space::Component(kind).with_article();
        let owner = match prefix.trim_end_matches('.') {
            "" => owner.to_string(),
            group => format!("`{group}` of {owner}"),
        };
        let is_group = fields(kind).iter().any(|f| f.path.starts_with(group));
        let is_value = fields(kind).iter().any(|f| f.path == format!("{prefix}{}", name.text));
        let message = format!("{owner} has no field `{}`", name.text);
        let diagnostic = Diagnostic::new(Code::E0209, message, name.span, "not a field");
        self.report(match (is_group, is_value) {
            (true, _) => Diagnostic { message: format!("`{}` is a group of fields", name.text), ..diagnostic }
                .expected(format!("`{} {{ ... }}`", name.text), "a single value"),
            (_, true) => Diagnostic { message: format!("`{}` is a single field", name.text), ..diagnostic }
                .expected(format!("`{} = value`", name.text), "a group"),
            _ => {
                let listed = known().iter().map(|k| format!("`{k}`")).collect::<Vec<_>>().join(", ");
                self.with_nearest(diagnostic.expected(listed, format!("`{}`", name.text)), name, known())
            }
        });
    }

    fn field(&self, env: &Rc<Env<'t>>, spec: &FieldSpec, expr: &'t Expr) -> Option<FieldValue> {
        let scope = Scope { env, geometry: None };
        if let Shape::Reference(kind) = spec.shape {
            return self.reference_field(env, kind, expr).map(FieldValue::Component);
        }
        let value = self.evaluate(scope, expr);
        if value == Value::Poison {
            return None;
        }
        let wrong = |wanted: String| {
            self.report(
                Diagnostic::new(Code::E0304, format!("`{}` must be {wanted}", spec.path), expr.span, value.described())
                    .expected(wanted, value.described())
                    .help(spec.doc.to_string()),
            );
            None
        };
        let number =
            |value: &Spanned<Value>, unit: &str, bounds| self.bounded(&value.value, value.span, spec, unit, bounds);
        match (spec.shape, &value) {
            (Shape::Number(unit, bounds), _) => {
                self.bounded(&value, expr.span, spec, unit, bounds).map(FieldValue::Number)
            }
            (Shape::Stiffness, _) => Some(FieldValue::Stiffness(value)),
            (Shape::Text, Value::Text(text)) => Some(FieldValue::Text(text.clone())),
            (Shape::Text, _) => wrong("a text in quotes".into()),
            (Shape::Tuple(unit, bounds, count), Value::Tuple(items)) if items.len() == count => {
                items.iter().map(|v| number(v, unit, bounds)).collect::<Option<Vec<f64>>>().map(FieldValue::Numbers)
            }
            (Shape::Tuple(unit, _, count), _) => {
                wrong(format!("a tuple of {count}: `({})`", vec![format!("... {unit}"); count].join(", ")))
            }
            (Shape::Interval(unit, bounds), Value::Range(range)) if range.step.is_none() => {
                let (low, high) = (number(&range.low, unit, bounds), number(&range.high, unit, bounds));
                let (low, high) = (low?, high?);
                self.ordered(low, high, expr.span, dimension(unit))?;
                Some(FieldValue::Interval(Interval { low, high }))
            }
            (Shape::Interval(..), _) => wrong("a range: `low .. high`".into()),
            (Shape::Numbers(unit, bounds), Value::List(items)) => {
                let values: Option<Vec<f64>> = items.iter().map(|v| number(v, unit, bounds)).collect();
                values.map(|v| FieldValue::Numbers(ascending(v)))
            }
            (Shape::Numbers(unit, bounds), Value::Range(range)) => {
                let Some(step) = &range.step else { return wrong("a list, or a range with a step".into()) };
                let (low, high) = (number(&range.low, unit, bounds), number(&range.high, unit, bounds));
                let step_value = self.expect_constant(&step.value, step.span, dimension(unit), "the step");
                let (low, high, step_value) = (low?, high?, step_value?);
                self.ordered(low, high, expr.span, dimension(unit))?;
                self.steps(low, high, step_value, step.span, dimension(unit)).map(FieldValue::Numbers)
            }
            (Shape::Numbers(..), _) => wrong("a list, or a range with a step".into()),
            (Shape::Reference(_), _) => None,
        }
    }

    /// `steering = NAME` or `steering = NAME(radius: 50 mm)`.
    fn reference_field(&self, env: &Rc<Env<'t>>, kind: Kind, expr: &'t Expr) -> Option<Rc<Component>> {
        let (name, args) = match &expr.kind {
            ExprKind::Name(text) => (Name { text: text.clone(), span: expr.span }, None),
            ExprKind::Call { name, args } => (name.clone(), Some(args)),
            _ => {
                let wanted = Space::Component(kind).with_article();
                self.report(
                    Diagnostic::new(Code::E0304, format!("this must name {wanted}"), expr.span, "not a name")
                        .expected(format!("the name of {wanted}"), "something else"),
                );
                return None;
            }
        };
        let symbol = self.resolve(env.module, Space::Component(kind), &name)?;
        let Item::Declaration(declaration) = self.program.item(symbol) else { return None };
        let args = match args {
            Some(args) => self.arguments(env, &name, args),
            None => BTreeMap::new(),
        };
        let made = self.instantiate(symbol, declaration, args, name.span)?;
        made.complete.then_some(made)
    }

    /// A constant within its bounds.
    fn bounded(&self, value: &Value, span: Span, spec: &FieldSpec, unit: &str, bounds: Bounds) -> Option<f64> {
        let name = spec.path.rsplit('.').next().unwrap_or(spec.path);
        let value = self.expect_constant(value, span, dimension(unit), &format!("`{name}`"))?;
        self.within(value, span, &format!("`{name}`"), dimension(unit), bounds)
    }

    /// The value, if it lies within bounds; otherwise reported.
    pub fn within(&self, value: f64, span: Span, what: &str, dimension: Dimension, bounds: Bounds) -> Option<f64> {
        if bounds.contains(value) {
            return Some(value);
        }
        let expected = if value <= bounds.low {
            format!("{} {}", if bounds.open { "more than" } else { "at least" }, shown(bounds.low, dimension))
        } else {
            format!("at most {}", shown(bounds.high, dimension))
        };
        let found = shown(value, dimension);
        self.report(
            Diagnostic::new(Code::E0306, format!("{what} is out of range"), span, found.clone())
                .expected(expected, found),
        );
        None
    }

    /// Reports a range whose ends are the wrong way round.
    pub fn ordered(&self, low: f64, high: f64, span: Span, dimension: Dimension) -> Option<()> {
        if low <= high {
            return Some(());
        }
        let mut diagnostic =
            Diagnostic::new(Code::E0311, "the range is upside down", span, "its low end is above its high end")
                .expected("`low .. high`", format!("{} .. {}", shown(low, dimension), shown(high, dimension)));
        if let Some((a, b)) = self.sources.text(span).split_once("..")
            && !b.contains("step")
        {
            diagnostic = diagnostic.fix(span, format!("{} .. {}", b.trim(), a.trim()));
        }
        self.report(diagnostic);
        None
    }

    /// `low .. high step s` as a list.
    fn steps(&self, low: f64, high: f64, step: f64, span: Span, dimension: Dimension) -> Option<Vec<f64>> {
        let count = (high - low) / step;
        if !(step > 0.0 && count <= 10_000.0) {
            self.report(
                Diagnostic::new(Code::E0306, "the step is out of range", span, shown(step, dimension))
                    .expected("a positive step that makes at most 10000 values", shown(step, dimension)),
            );
            return None;
        }
        // Rounded to the nanometre: 0.5 + 3 * 0.05 must be the 0.65 that a user writes.
        let value = |i: usize| ((low + i as f64 * step) * 1e9).round() / 1e9;
        let count = (count + 1e-9).floor() as usize;
        Some(
            (0..=count)
                .map(|i| {
                    if i == 0 {
                        low
                    } else if (low + i as f64 * step - high).abs() < 1e-9 {
                        high
                    } else {
                        value(i)
                    }
                })
                .collect(),
        )
    }

    /// Gives each stiffness its dimension, N/m to the power of the exponent beside it.
    fn check_stiffness(&self, kind: Kind, component: &Component, within: Span) -> bool {
        let mut sound = true;
        for spec in fields(kind).iter().filter(|f| f.shape == Shape::Stiffness) {
            let Some(Filled { value: Some(FieldValue::Stiffness(value)), span }) =
                component.fields.get(spec.path).cloned()
            else {
                continue;
            };
            let exponent_path = spec.path.replace("stiffness", "exponent");
            let Some(exponent) = component.number(&exponent_path) else { continue };
            if (exponent * 2.0).fract() != 0.0 {
                let place = component.place(&exponent_path);
                self.report(
                    Diagnostic::new(Code::E0306, "`exponent` is not a multiple of 0.5", place, number(exponent))
                        .expected("1, 1.5 or 2", number(exponent)),
                );
                sound = false;
                continue;
            }
            let Some(per_length) = Dimension::LENGTH.power((exponent * 2.0) as i8) else { continue };
            let Some(dimension) = Dimension::FORCE.over(per_length) else { continue };
            let what = format!("`stiffness` with an exponent of {}", number(exponent));
            let inherited = span.file != within.file || span.start < within.start || span.end > within.end;
            let checked = match &value {
                Value::Quantity(q) if inherited && q.dimension != dimension => {
                    let diagnostic = self.wrong_dimension(q, component.place(&exponent_path), dimension, &what);
                    self.report(diagnostic.related(span, "the stiffness").help("write `stiffness` beside `exponent`"));
                    None
                }
                _ => self
                    .expect_constant(&value, span, dimension, &what)
                    .and_then(|k| self.within(k, span, "`stiffness`", dimension, Bounds::above(0.0, 1e15))),
            };
            sound &= checked.is_some();
        }
        sound
    }

    /// Reports the fields that are missing, all in one message.
    fn check_missing(&self, kind: Kind, declaration: &Declaration, component: &Component) -> bool {
        if declaration.fields.nodes.iter().any(|n| matches!(n.value, Field::Bad)) {
            return false;
        }
        let begun = |path: &str| {
            let group = path.split('.').next().unwrap_or(path);
            component.fields.keys().any(|k| k.split('.').next() == Some(group))
        };
        let missing: Vec<&FieldSpec> = fields(kind)
            .iter()
            .filter(|f| !component.has(f.path))
            .filter(|f| f.presence == Presence::Required || (f.presence == Presence::InGroup && begun(f.path)))
            .collect();
        let Some(first) = missing.first() else { return true };
        let what = match missing.len() {
            1 => format!("the field `{}` is missing", first.path),
            n => format!("{n} fields are missing"),
        };
        let listed: Vec<String> = missing.iter().map(|f| format!("`{}` ({})", f.path, f.doc)).collect();
        let shown = listed.len().min(6);
        let more = if listed.len() > shown { format!(" and {} more", listed.len() - shown) } else { String::new() };
        let name = &declaration.name;
        self.report(
            Diagnostic::new(Code::E0215, what, name.span, format!("in this {}", Space::Component(kind).word()))
                .expected(format!("{}{more}", listed[..shown].join(", ")), "nothing")
                .help("or extend a declaration that has the rest, with `from`"),
        );
        false
    }
}

fn dimension(unit: &str) -> Dimension {
    parse_unit(unit).map_or(Dimension::NONE, |u| u.dimension)
}

fn ascending(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The standard module that declares an item of that kind and name.
fn standard_home(space: Space, name: &str) -> Option<&'static str> {
    let Space::Component(_) = space else { return None };
    let line = format!("{} {name}", space.word());
    crate::source::STDLIB.iter().find_map(|(module, text)| {
        let declares = |l: &str| l.strip_prefix(&line).is_some_and(|rest| rest.starts_with([' ', '(']));
        text.lines().any(declares).then_some(*module)
    })
}
