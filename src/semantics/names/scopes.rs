//! The names of layouts and declarations: what each declares, and what it takes over from what it extends.

use super::{NameKind, Visible};
use crate::semantics::program::{Program, Space, Symbol};
use crate::source::Span;
use crate::syntax::tree::{Block, Item, LayoutDeclaration, Name, Param, Statement, StationWord};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Variants of variants that are followed.
const DEPTH: usize = 64;

/// A declaration and the first one that it replaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Declared {
    pub definition: Span,
    pub symbol: Span,
}

/// What a statement of a layout declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    Vertex,
    Obstacle,
    Section,
    Induction,
    Chutes,
    /// A scanner, a gate or a lift.
    Station,
}

impl From<Part> for NameKind {
    fn from(part: Part) -> Self {
        match part {
            Part::Vertex => NameKind::Vertex,
            Part::Obstacle => NameKind::Obstacle,
            Part::Section => NameKind::Section,
            Part::Induction => NameKind::Induction,
            Part::Chutes => NameKind::Chutes,
            Part::Station => NameKind::Station,
        }
    }
}

/// The names of a layout, a declaration, or of neither: those of a file.
#[derive(Debug, Default)]
pub struct Scope {
    pub module: usize,
    /// Parameters and `let`s.
    values: BTreeMap<String, (NameKind, Span)>,
    parts: BTreeMap<(Part, String), Declared>,
    /// In driving order.
    vertices: Vec<String>,
    /// What a layout extends.
    base: Option<Rc<Scope>>,
}

impl Scope {
    pub fn of_file(module: usize) -> Scope {
        Scope { module, ..Scope::default() }
    }

    /// What the parameters of a declaration make known within it.
    pub fn of_params(module: usize, params: &Block<Param>) -> Scope {
        let mut scope = Scope::of_file(module);
        for param in params.iter() {
            scope.values.entry(param.name.text.clone()).or_insert((NameKind::Parameter, param.name.span));
        }
        scope
    }

    fn of_layout(program: &Program, module: usize, layout: &LayoutDeclaration, depth: usize) -> Scope {
        let base = layout.from.as_ref().filter(|_| depth < DEPTH).and_then(|from| {
            let (symbol, _) = program.modules[module].find(Space::Layout, &from.name.text)?;
            let Item::Layout(base) = program.item(symbol) else { return None };
            Some(Scope::of_layout(program, symbol.module, base, depth + 1))
        });
        let mut scope = Scope::of_params(module, &layout.params);
        for statement in layout.body.iter() {
            if let Statement::Let(item) = statement {
                scope.values.entry(item.name.text.clone()).or_insert((NameKind::Value, item.name.span));
            }
            let Some((part, name)) = declared(statement) else { continue };
            let key = (part, name.text.clone());
            if scope.parts.contains_key(&key) {
                continue;
            }
            let replaced = base.as_ref().and_then(|base| base.part(part, &name.text));
            let symbol = replaced.map_or(name.span, |replaced| replaced.symbol);
            scope.parts.insert(key, Declared { definition: name.span, symbol });
            if part == Part::Vertex && replaced.is_none() {
                scope.vertices.push(name.text.clone());
            }
        }
        scope.base = base.map(Rc::new);
        scope
    }

    /// A parameter or `let` of the scope or of what it extends.
    pub fn value(&self, name: &str) -> Option<(NameKind, Span)> {
        self.values.get(name).cloned().or_else(|| self.base.as_ref()?.value(name))
    }

    pub fn part(&self, part: Part, name: &str) -> Option<Declared> {
        let own = self.parts.get(&(part, name.to_owned())).copied();
        own.or_else(|| self.base.as_ref()?.part(part, name))
    }

    /// All names of a layout, vertices first.
    pub fn visible(&self) -> Vec<Visible> {
        let mut all: BTreeMap<(NameKind, String), Span> = BTreeMap::new();
        let mut order: Vec<&str> = Vec::new();
        self.collect(&mut all, &mut order);
        let vertices = order.iter().filter_map(|name| {
            let declared = self.part(Part::Vertex, name)?;
            Some(Visible { name: (*name).to_owned(), kind: NameKind::Vertex, definition: declared.definition })
        });
        let rest = all.iter().filter(|((kind, _), _)| *kind != NameKind::Vertex).map(|((kind, name), span)| Visible {
            name: name.clone(),
            kind: kind.clone(),
            definition: *span,
        });
        vertices.chain(rest).collect()
    }

    /// What the base has comes first, and is replaced.
    fn collect<'s>(&'s self, all: &mut BTreeMap<(NameKind, String), Span>, order: &mut Vec<&'s str>) {
        if let Some(base) = &self.base {
            base.collect(all, order);
        }
        order.extend(self.vertices.iter().map(String::as_str));
        all.extend(self.values.iter().map(|(name, (kind, span))| ((kind.clone(), name.clone()), *span)));
        all.extend(self.parts.iter().map(|((part, name), d)| (((*part).into(), name.clone()), d.definition)));
    }
}

/// The scopes of all layouts.
pub fn of_layouts(program: &Program) -> BTreeMap<Symbol, Scope> {
    let mut scopes = BTreeMap::new();
    for (module, file) in program.modules.iter().enumerate() {
        for (item, node) in file.tree.items.nodes.iter().enumerate() {
            if let Item::Layout(layout) = &node.value {
                scopes.insert(Symbol { module, item }, Scope::of_layout(program, module, layout, 0));
            }
        }
    }
    scopes
}

/// The name that a statement declares for others.
pub fn declared(statement: &Statement) -> Option<(Part, &Name)> {
    match statement {
        Statement::Vertex { name, .. } => Some((Part::Vertex, name)),
        Statement::Obstacle { name, .. } => Some((Part::Obstacle, name)),
        Statement::Section(section) => Some((Part::Section, &section.name)),
        Statement::Induction { name, .. } => Some((Part::Induction, name)),
        Statement::Chutes { name, .. } => Some((Part::Chutes, name)),
        Statement::Equipped(equipped) => {
            let part = match equipped.word {
                StationWord::Induction => Part::Induction,
                StationWord::Chutes => Part::Chutes,
                StationWord::Scanner | StationWord::Gate | StationWord::Lift => Part::Station,
            };
            Some((part, &equipped.name))
        }
        _ => None,
    }
}
