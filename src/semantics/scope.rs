//! Where names are looked up: parameters, `let`s, and the geometry that a layout names.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use super::program::{Program, Space, Symbol, mentions};
use super::sink::Sink;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::semantics::component::Component;
use crate::source::{SourceMap, Span};
use crate::syntax::nearest;
use crate::syntax::tree::{Expr, Item, Let, Name};

/// Nesting of expressions and definitions that is followed.
pub(super) const DEPTH: usize = 160;
/// Candidates that are compared for "did you mean" in one run; afterwards messages do without.
const SUGGESTION_BUDGET: usize = 200_000;

/// What every step of a check shares.
pub(super) struct Context<'t> {
    pub sources: &'t SourceMap,
    pub program: &'t Program,
    pub sink: RefCell<Sink>,
    /// Lets of modules, evaluated once.
    globals: RefCell<BTreeMap<Symbol, Rc<Slot<'t>>>>,
    /// Imports that something was found through.
    pub used: RefCell<BTreeSet<(usize, usize)>>,
    /// Declarations without arguments, made once.
    pub components: RefCell<BTreeMap<Symbol, Option<Rc<Component>>>>,
    /// Declarations that are being made.
    pub instantiating: RefCell<Vec<Symbol>>,
    depth: Cell<usize>,
    /// Whether that has been said: it is said once.
    too_deep: Cell<bool>,
    suggestions: Cell<usize>,
    /// The first value of each `let`, by its name's place.
    pub values: RefCell<BTreeMap<Span, Value>>,
}

/// A `let` and its value once it is known.
#[derive(Debug)]
pub(super) struct Slot<'t> {
    pub name: &'t Name,
    pub expr: &'t Expr,
    pub state: RefCell<SlotState>,
}

#[derive(Clone, Debug)]
pub(super) enum SlotState {
    Unknown,
    /// Being evaluated: met again, it depends on itself.
    Busy,
    Known(Value),
}

/// A local name.
#[derive(Clone, Debug)]
pub(super) enum Local<'t> {
    Param(Value),
    Let(Rc<Slot<'t>>),
}

/// The names that an expression sees, besides the geometry.
#[derive(Debug)]
pub(super) struct Env<'t> {
    pub module: usize,
    pub locals: BTreeMap<&'t str, Local<'t>>,
    /// The layout that this one extends.
    pub outer: Option<Rc<Env<'t>>>,
}

impl<'t> Env<'t> {
    pub fn global(module: usize) -> Rc<Self> {
        Rc::new(Env { module, locals: BTreeMap::new(), outer: None })
    }

    /// The local of that name, and the environment that it belongs to.
    pub fn find<'e>(self: &'e Rc<Self>, name: &str) -> Option<(&'e Rc<Env<'t>>, &'e Local<'t>)> {
        let mut env = Some(self);
        while let Some(here) = env {
            if let Some(local) = here.locals.get(name) {
                return Some((here, local));
            }
            env = here.outer.as_ref();
        }
        None
    }

    fn names(&self) -> Vec<&'t str> {
        let mut names: Vec<&'t str> = self.locals.keys().copied().collect();
        if let Some(outer) = &self.outer {
            names.extend(outer.names());
        }
        names
    }
}

impl<'t> Slot<'t> {
    pub fn new(item: &'t Let) -> Rc<Self> {
        Rc::new(Slot { name: &item.name, expr: &item.value, state: RefCell::new(SlotState::Unknown) })
    }
}

/// The vertices and polygons that formulas may name.
#[derive(Debug, Default)]
pub(super) struct Named<'t> {
    pub vertices: BTreeMap<&'t str, usize>,
    /// In driving order.
    pub order: Vec<&'t str>,
    pub obstacles: BTreeMap<&'t str, usize>,
    pub building: bool,
    /// Texts of statements that did not parse.
    pub bad: Vec<String>,
    /// Whether vertices may be missing, so that neighbours are not known.
    pub incomplete: bool,
}

/// What an expression sees.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a, 't> {
    pub env: &'a Rc<Env<'t>>,
    pub geometry: Option<&'a Named<'t>>,
}

impl<'t> Context<'t> {
    pub fn new(sources: &'t SourceMap, program: &'t Program, sink: Sink) -> Self {
        Context {
            sources,
            program,
            sink: RefCell::new(sink),
            globals: RefCell::default(),
            used: RefCell::default(),
            components: RefCell::default(),
            instantiating: RefCell::default(),
            depth: Cell::new(0),
            too_deep: Cell::new(false),
            suggestions: Cell::new(SUGGESTION_BUDGET),
            values: RefCell::default(),
        }
    }

    pub fn report(&self, diagnostic: Diagnostic) {
        self.sink.borrow_mut().push(diagnostic);
    }

    /// Runs one level deeper; `None` (reported) when that is too deep.
    pub fn deeper<T>(&self, span: Span, run: impl FnOnce() -> T) -> Option<T> {
        if self.depth.get() >= DEPTH {
            if !self.too_deep.replace(true) {
                let message = "definitions nest too deeply";
                self.report(
                    Diagnostic::new(Code::E0309, message, span, "not followed any further")
                        .expected(format!("at most {DEPTH} levels"), "more")
                        .help("write values before the lines that use them"),
                );
            }
            return None;
        }
        self.depth.set(self.depth.get() + 1);
        let result = run();
        self.depth.set(self.depth.get() - 1);
        Some(result)
    }

    /// The nearest of some names, as long as looking stays cheap.
    pub fn suggest<'a>(&self, wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
        let left = self.suggestions.get();
        let mut count = 0;
        let found = nearest(wanted, candidates.into_iter().take(left).inspect(|_| count += 1));
        self.suggestions.set(left - count.min(left));
        found
    }

    /// Adds "did you mean" to a diagnostic about an unknown name.
    pub fn with_nearest<'a>(
        &self,
        diagnostic: Diagnostic,
        wanted: &Name,
        candidates: impl IntoIterator<Item = &'a str>,
    ) -> Diagnostic {
        match self.suggest(&wanted.text, candidates) {
            Some(near) => diagnostic.help(format!("did you mean `{near}`?")).fix(wanted.span, near),
            None => diagnostic,
        }
    }

    /// The item of that name that a module sees; marks the import as used.
    pub fn find(&self, module: usize, space: Space, name: &str) -> Option<Symbol> {
        let (symbol, import) = self.program.modules[module].find(space, name)?;
        if let Some(import) = import {
            self.used.borrow_mut().insert((module, import));
        }
        Some(symbol)
    }

    /// A module's `let`.
    pub fn global(&self, symbol: Symbol) -> Option<Rc<Slot<'t>>> {
        let Item::Let(item) = self.program.item(symbol) else { return None };
        Some(self.globals.borrow_mut().entry(symbol).or_insert_with(|| Slot::new(item)).clone())
    }

    /// Reports a name that is neither a parameter nor a `let`.
    pub fn unknown_value(&self, scope: Scope<'_, 't>, name: &str, span: Span) {
        let module = &self.program.modules[scope.env.module];
        let bad_here = scope.geometry.is_some_and(|g| mentions(&g.bad, name));
        if bad_here || module.bad_mentions(name) {
            return;
        }
        let mut diagnostic =
            Diagnostic::new(Code::E0206, format!("there is no value `{name}`"), span, "not known here");
        let vertex = scope.geometry.is_some_and(|g| g.vertices.contains_key(name));
        if vertex {
            diagnostic = diagnostic
                .help(format!("`{name}` is a vertex: `x({name})`, `y({name})` and `radius({name})` are values"));
        } else if name == "capacity" {
            diagnostic = diagnostic.help("a capacity is so many items an hour: `require capacity >= 7000 per hour`");
        } else if let Some(unit) = super::dimension::symbols().find(|u| *u == name) {
            diagnostic = diagnostic.help(format!("a unit follows its number: `1 {unit}`"));
        } else {
            let wanted = Name { text: name.to_string(), span };
            let names = scope.env.names();
            diagnostic = self.with_nearest(diagnostic, &wanted, names.into_iter().chain(module.names(Space::Let)));
        }
        self.report(diagnostic);
    }
}
