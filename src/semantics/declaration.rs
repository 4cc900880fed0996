//! Declarations to components: parameters, `from`, and fields checked against their table.

use crate::semantics::component::{Component, Filled};
use std::collections::BTreeMap;
use std::rc::Rc;

use super::arguments::Arguments;
use super::fields::{FieldSpec, Presence, fields};
use super::program::{Space, Symbol, repeated};
use super::scope::{Context, Env};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::tree::{Block, Declaration, DeclarationKind, Field, Item, Name, Reference};

impl<'t> Context<'t> {
    /// The component that a reference names, with its arguments. `None` when it is unknown or calls itself.
    pub fn component(
        &self,
        env: &Rc<Env<'t>>,
        kind: DeclarationKind,
        reference: &'t Reference,
    ) -> Option<Rc<Component>> {
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
        let mut spaces = DeclarationKind::ALL.map(Space::Component).into_iter().chain([Space::Let, Space::Layout]);
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
                        let path = format!("std.{home}.{}", name.text);
                        let import = seen.tree.import_place();
                        diagnostic
                            .help(format!("the standard library has it: `use {path}`"))
                            .fix(import.span, import.text(&path))
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

    /// The declaration with arguments; made once when there are none.
    pub fn instantiate(
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
        kind: DeclarationKind,
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

    fn unknown_field(&self, kind: DeclarationKind, prefix: &str, name: &Name, group: &str) {
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

    /// Reports the fields that are missing, all in one message.
    fn check_missing(&self, kind: DeclarationKind, declaration: &Declaration, component: &Component) -> bool {
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

/// The standard module that declares an item of that kind and name.
fn standard_home(space: Space, name: &str) -> Option<&'static str> {
    let Space::Component(_) = space else { return None };
    let line = format!("{} {name}", space.word());
    crate::source::STDLIB.iter().find_map(|(module, text)| {
        let declares = |l: &str| l.strip_prefix(&line).is_some_and(|rest| rest.starts_with([' ', '(']));
        text.lines().any(declares).then_some(*module)
    })
}
