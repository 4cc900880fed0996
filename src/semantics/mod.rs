//! Tree to model: names and imports, dimensions, fields, and the checks of the written layout.
//!
//! 1. `program` loads the files that the main one imports and resolves their names,
//! 2. `evaluate` and `functions` give expressions values with [`dimension`]s,
//! 3. `declaration` and `field_value` check catalogues, carts and the like against the tables in `fields`,
//! 4. `layout` turns a layout's statements into [`model::Layout`],
//! 5. `checks` looks at the written geometry and constraints.
//!
//! Every stage reports what it can tell and poisons what it cannot, so that one run says every independent mistake
//! once.

mod arguments;
mod checked;
mod component;
mod components;
mod declaration;
pub mod dimension;
mod evaluate;
mod field_value;
mod fields;
mod functions;
pub mod given;
mod layout;
pub mod names;
mod program;
mod scope;
mod sink;
mod value;
pub mod vocabulary;

use crate::diagnostic::{Code, Diagnostic};
use crate::model::Layout;
use crate::source::{FileId, LoadError, Loader, SourceMap, Span};
use crate::syntax::tree::{Item, LayoutDeclaration, Name, Tree};
pub use checked::{Checked, Home};
pub use layout::settle_sides;
use names::Names;
use program::{Program, Symbol};
use scope::{Context, Env};
use sink::Sink;
use std::collections::BTreeMap;

/// Everything that is known about a file after checking it.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// By file and place.
    pub diagnostics: Vec<Diagnostic>,
    /// The main file's layouts without mistakes, in the order in which they are written.
    pub layouts: Vec<Layout>,
    /// What [`Analysis::chosen`] says when it cannot tell which layout is meant.
    unclear: Option<Diagnostic>,
    /// Name of the layout that is meant.
    wanted: Option<String>,
}

impl Analysis {
    /// Whether any diagnostic is an error.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(Diagnostic::is_error)
    }

    /// The layout to build: the one asked for, or the only one of the file. `Err` when the file has none or several;
    /// `Ok(None)` when it has mistakes.
    pub fn chosen(&self) -> Result<Option<&Layout>, Box<Diagnostic>> {
        match &self.unclear {
            Some(diagnostic) => Err(Box::new(diagnostic.clone())),
            None => Ok(self.layouts.iter().find(|l| Some(&l.name) == self.wanted.as_ref())),
        }
    }
}

/// Checks a file and what it imports. `layout` names the one to build, if the user did; one that does not exist is a
/// diagnostic.
pub fn analyse(sources: &mut SourceMap, loader: &mut Loader, main: FileId, layout: Option<&str>) -> Analysis {
    let mut sink = Sink::default();
    let program = Program::load(sources, loader, main, &mut sink);
    check(sources, &program, sink, layout).0
}

/// A checked file and what it imports, for who asks for more than what is wrong with them.
#[derive(Debug)]
pub struct Study {
    pub analysis: Analysis,
    /// The main file's first.
    pub files: Vec<StudiedFile>,
    pub names: Names,
    /// Of each `let` its name's place and its value, as messages show it, in the unit that its dimension is usually
    /// written in. Formulas over the geometry and what holds a mistake have none.
    pub values: BTreeMap<Span, String>,
}

/// A file of a [`Study`].
#[derive(Debug)]
pub struct StudiedFile {
    pub tree: Tree,
    /// The module of the standard library that it is.
    pub standard: Option<&'static str>,
}

/// Checks a file as [`analyse`] does, and keeps the trees, names and values.
pub fn study(sources: &mut SourceMap, loader: &mut Loader, main: FileId) -> Study {
    let mut sink = Sink::default();
    let program = Program::load(sources, loader, main, &mut sink);
    let (analysis, values) = check(sources, &program, sink, None);
    let names = Names::of(&program);
    let files = program.modules.into_iter().map(|m| StudiedFile { tree: m.tree, standard: m.standard });
    Study { analysis, files: files.collect(), names, values }
}

fn check(
    sources: &SourceMap,
    program: &Program,
    sink: Sink,
    layout: Option<&str>,
) -> (Analysis, BTreeMap<Span, String>) {
    let context = Context::new(sources, program, sink);
    context.check_items();
    let layouts = context.layouts();
    context.unused_imports();
    let (wanted, unclear) = context.choose(layout);
    if let (Some(diagnostic), Some(_)) = (&unclear, layout) {
        context.report(diagnostic.clone());
    }
    let values = context.values.into_inner();
    let shown = values.into_iter().filter_map(|(span, value)| Some((span, value.text()?))).collect();
    (Analysis { diagnostics: context.sink.into_inner().into_sorted(), layouts, unclear, wanted }, shown)
}

/// The message for a main file that exists but holds no text that could be checked: not UTF-8, or too large. `None`
/// when it could not be read at all, which is no matter of its contents.
pub fn unreadable(sources: &mut SourceMap, error: &LoadError, path: &str) -> Option<Diagnostic> {
    program::main_diagnostic(sources, error, path)
}

impl<'t> Context<'t> {
    /// Lets and declarations of the user's files, whether or not a layout uses them.
    fn check_items(&self) {
        for (module, file) in self.program.modules.iter().enumerate().filter(|(_, m)| m.standard.is_none()) {
            for (item, node) in file.tree.items.nodes.iter().enumerate() {
                let symbol = Symbol { module, item };
                match &node.value {
                    Item::Let(_) => {
                        if let Some(slot) = self.global(symbol) {
                            self.slot(&Env::global(module), &slot, slot.name.span);
                        }
                    }
                    Item::Declaration(declaration) => {
                        self.with_defaults(symbol, declaration);
                    }
                    Item::Layout(_) | Item::Use(_) | Item::Bad => {}
                }
            }
        }
    }

    /// The main file's layouts with their symbols.
    fn declared(&self) -> impl Iterator<Item = (Symbol, &'t LayoutDeclaration)> {
        let nodes = &self.program.modules[0].tree.items.nodes;
        nodes.iter().enumerate().filter_map(|(item, node)| match &node.value {
            Item::Layout(layout) => Some((Symbol { module: 0, item }, layout)),
            _ => None,
        })
    }

    fn layouts(&self) -> Vec<Layout> {
        self.declared().filter_map(|(symbol, layout)| self.layout(symbol, layout)).collect()
    }

    fn unused_imports(&self) {
        let used = self.used.borrow();
        // What another file imports is for all who use that file: this one may have replaced it.
        let Some(module) = self.program.modules.first() else { return };
        // What did not parse may well use the import.
        if module.flawed {
            return;
        }
        for (number, import) in module.imports.iter().enumerate() {
            if !used.contains(&(0, number)) {
                let message = format!("{} is imported, but not used", import.shown);
                self.report(Diagnostic::new(Code::W0701, message, import.span, "not used").fix(import.span, ""));
            }
        }
    }

    /// The name of the layout that is meant, or why that is not clear.
    fn choose(&self, asked: Option<&str>) -> (Option<String>, Option<Diagnostic>) {
        let names: Vec<&'t Name> = self.declared().map(|(_, layout)| &layout.name).collect();
        let file = self.program.modules[0].file;
        let listed = names.iter().map(|n| format!("`{}`", n.text)).collect::<Vec<_>>().join(", ");
        match (asked, &names[..]) {
            (Some(name), _) if names.iter().any(|n| n.text == name) => (Some(name.to_string()), None),
            (Some(name), []) => (None, Some(none_at_all(file).expected(format!("a layout `{name}`"), "none"))),
            (Some(name), [first, ..]) => {
                let message = format!("there is no layout `{name}` in this file");
                let diagnostic = Diagnostic::new(Code::E0217, message, first.span, "the first layout of the file")
                    .expected(listed, format!("`{name}`"));
                let near = self.suggest(name, names.iter().map(|n| n.text.as_str()));
                (
                    None,
                    Some(match near {
                        Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
                        None => diagnostic,
                    }),
                )
            }
            (None, [only]) => (Some(only.text.clone()), None),
            (None, []) => (None, Some(none_at_all(file).expected("a layout", "none"))),
            (None, [first, rest @ ..]) => {
                let message = format!("the file has {} layouts", names.len());
                let mut diagnostic = Diagnostic::new(Code::E0217, message, first.span, "this one?");
                for name in rest {
                    diagnostic = diagnostic.related(name.span, "or this one?");
                }
                (
                    None,
                    Some(
                        diagnostic
                            .expected(format!("one of {listed}"), "no choice")
                            .help("choose with `--layout NAME`"),
                    ),
                )
            }
        }
    }
}

fn none_at_all(file: FileId) -> Diagnostic {
    Diagnostic::new(Code::E0217, "the file has no layout", Span::new(file, 0, 0), "nothing to build")
        .help("a layout is a block `layout name { ... }`; files without one are imported by others")
}
