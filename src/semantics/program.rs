//! Files and what they import: every module of a compilation, its names, and the names it sees.

use std::collections::{BTreeMap, BTreeSet};

use super::sink::Sink;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::{FileId, LoadError, Loader, SIZE_LIMIT, STDLIB, SourceMap, Span};
use crate::syntax::nearest;
use crate::syntax::{
    self,
    tree::{DeclarationKind, Item, Name, Tree, Use},
};

/// Most files that one compilation may read.
const MOST_FILES: usize = 500;

/// Names of different spaces do not meet: a catalogue and a sensor may both be called `standard`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Space {
    Component(DeclarationKind),
    Let,
    Layout,
}

impl Space {
    pub fn with_article(self) -> &'static str {
        match self {
            Space::Component(DeclarationKind::Catalog) => "a catalog",
            Space::Component(DeclarationKind::Cart) => "a cart",
            Space::Component(DeclarationKind::Wheel) => "a wheel",
            Space::Component(DeclarationKind::Joint) => "a joint",
            Space::Component(DeclarationKind::Motor) => "a motor",
            Space::Component(DeclarationKind::Controller) => "a controller",
            Space::Component(DeclarationKind::Sensor) => "a sensor",
            Space::Component(DeclarationKind::TakeUp) => "a take_up",
            Space::Component(DeclarationKind::Equipment) => "a kind of equipment",
            Space::Let => "a value",
            Space::Layout => "a layout",
        }
    }

    /// The word alone: `catalog`.
    pub fn word(self) -> &'static str {
        match self {
            Space::Component(kind) => kind.word(),
            _ => self.with_article().trim_start_matches("a "),
        }
    }
}

/// An item of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Symbol {
    pub module: usize,
    /// Index among the tree's items.
    pub item: usize,
}

/// A file with what it declares and what it sees.
#[derive(Debug)]
pub(super) struct Module {
    pub file: FileId,
    pub tree: Tree,
    /// The module of the standard library that it is.
    pub standard: Option<&'static str>,
    /// Whether some of it did not parse.
    pub flawed: bool,
    /// Its own items.
    pub own: BTreeMap<(Space, String), Symbol>,
    /// Imported items with the import that brought them.
    pub imported: BTreeMap<(Space, String), (Symbol, usize)>,
    /// Resolved imports.
    pub imports: Vec<Import>,
    /// Texts of items and statements that did not parse: a name in one of them is not unknown.
    pub bad: Vec<String>,
}

#[derive(Clone, Debug)]
pub(super) struct Import {
    pub span: Span,
    module: usize,
    /// A single item, or everything.
    item: Option<Name>,
    /// As written, for messages.
    pub shown: String,
}

impl Module {
    /// The item of that name which the module sees, with the import that brought it.
    pub fn find(&self, space: Space, name: &str) -> Option<(Symbol, Option<usize>)> {
        let key = (space, name.to_string());
        match self.own.get(&key) {
            Some(symbol) => Some((*symbol, None)),
            None => self.imported.get(&key).map(|(symbol, import)| (*symbol, Some(*import))),
        }
    }

    /// Names of one space that the module sees.
    pub fn names(&self, space: Space) -> impl Iterator<Item = &str> {
        let own = self.own.keys().filter(move |(s, _)| *s == space);
        own.chain(self.imported.keys().filter(move |(s, _)| *s == space)).map(|(_, name)| name.as_str())
    }

    /// Whether something that did not parse mentions the word.
    pub fn bad_mentions(&self, word: &str) -> bool {
        mentions(&self.bad, word)
    }
}

/// Whether one of the texts holds the word.
pub(super) fn mentions(texts: &[String], word: &str) -> bool {
    texts.iter().any(|text| text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|part| part == word))
}

/// All modules; the main file's comes first.
#[derive(Debug)]
pub(super) struct Program {
    pub modules: Vec<Module>,
    /// Standard modules that layouts fall back on.
    pub drives: Option<usize>,
    pub sensors: Option<usize>,
}

impl Program {
    /// Reads and parses the main file's imports, and theirs.
    pub fn load(sources: &mut SourceMap, loader: &mut Loader, main: FileId, sink: &mut Sink) -> Program {
        let mut reading = Reading { sources, loader, sink, modules: Vec::new(), of_file: BTreeMap::new() };
        reading.module(main);
        let mut next = 0;
        while next < reading.modules.len() {
            reading.imports(next);
            next += 1;
        }
        let standard = ["drives", "sensors"].map(|name| {
            let file = reading.loader.standard(reading.sources, name)?;
            Some(reading.module(file))
        });
        let mut modules = reading.modules;
        report_cycles(&modules, sink);
        for i in 0..modules.len() {
            let imported = see(&modules, i, sink);
            modules[i].imported = imported;
        }
        let [drives, sensors] = standard;
        Program { modules, drives, sensors }
    }

    pub fn item(&self, symbol: Symbol) -> &Item {
        &self.modules[symbol.module].tree.items.nodes[symbol.item].value
    }
}

struct Reading<'a> {
    sources: &'a mut SourceMap,
    loader: &'a mut Loader,
    sink: &'a mut Sink,
    modules: Vec<Module>,
    of_file: BTreeMap<FileId, usize>,
}

impl Reading<'_> {
    /// The file's module, parsed when it is new.
    fn module(&mut self, file: FileId) -> usize {
        if let Some(known) = self.of_file.get(&file) {
            return *known;
        }
        let (tree, diagnostics) = syntax::parse(file, &self.sources.file(file).text);
        let flawed = !diagnostics.is_empty();
        diagnostics.into_iter().for_each(|d| self.sink.push(d));
        let index = self.modules.len();
        let own = own_names(&tree, index, self.sink);
        let bad_spans = tree.items.nodes.iter().filter(|n| matches!(n.value, Item::Bad)).map(|n| n.span);
        let bad = bad_spans.map(|span| self.sources.text(span).to_string()).collect();
        self.modules.push(Module {
            file,
            tree,
            flawed,
            standard: self.loader.standard_module(file),
            own,
            imported: BTreeMap::new(),
            imports: Vec::new(),
            bad,
        });
        self.of_file.insert(file, index);
        index
    }

    fn imports(&mut self, module: usize) {
        let file = self.modules[module].file;
        let uses: Vec<Use> = self.modules[module]
            .tree
            .items
            .nodes
            .iter()
            .filter_map(|n| if let Item::Use(item) = &n.value { Some(item.clone()) } else { None })
            .collect();
        for item in uses {
            let import = match item {
                Use::Std { path, span } => self.standard(&path, span),
                Use::File { path, span } => self.relative(file, &path, span),
            };
            self.modules[module].imports.extend(import);
        }
    }

    fn standard(&mut self, path: &[Name], span: Span) -> Option<Import> {
        let shown = path.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(".");
        let unknown = |at: Span, message: String| Diagnostic::new(Code::E0205, message, at, "not there");
        let modules = || STDLIB.iter().map(|(name, _)| *name);
        let (first, module, item) = match path {
            [first, module] => (first, module, None),
            [first, module, item] => (first, module, Some(item)),
            _ => {
                self.sink.push(
                    unknown(span, format!("`{shown}` is no import"))
                        .expected("`std.MODULE` or `std.MODULE.ITEM`", format!("`{shown}`")),
                );
                return None;
            }
        };
        if first.text != "std" {
            self.sink.push(
                unknown(first.span, format!("`{}` is not a library", first.text))
                    .expected("`std`, or the path of a file in quotes", format!("`{}`", first.text)),
            );
            return None;
        }
        let Some(file) = self.loader.standard(self.sources, &module.text) else {
            let mut diagnostic = unknown(module.span, format!("the standard library has no `{}`", module.text))
                .expected(
                    modules().map(|m| format!("`{m}`")).collect::<Vec<_>>().join(", "),
                    format!("`{}`", module.text),
                );
            if let Some(near) = nearest(&module.text, modules()) {
                diagnostic = diagnostic.fix(module.span, near);
            }
            self.sink.push(diagnostic);
            return None;
        };
        let index = self.module(file);
        if let Some(item) = item {
            let names: BTreeSet<&str> = self.modules[index].own.keys().map(|(_, name)| name.as_str()).collect();
            if !names.contains(item.text.as_str()) {
                let message = format!("`std.{}` has no `{}`", module.text, item.text);
                let listed: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
                let mut diagnostic =
                    unknown(item.span, message).expected(listed.join(", "), format!("`{}`", item.text));
                if let Some(near) = nearest(&item.text, names.iter().copied()) {
                    diagnostic = diagnostic.fix(item.span, near);
                }
                self.sink.push(diagnostic);
                return None;
            }
        }
        Some(Import { span, module: index, item: item.cloned(), shown })
    }

    fn relative(&mut self, importer: FileId, path: &str, span: Span) -> Option<Import> {
        if self.modules.len() >= MOST_FILES {
            let message = format!("more than {MOST_FILES} files are imported");
            self.sink.push(Diagnostic::new(Code::E0309, message, span, "the import that is one too many"));
            return None;
        }
        match self.loader.import(self.sources, importer, path) {
            Ok(file) => {
                let module = self.module(file);
                Some(Import { span, module, item: None, shown: format!("\"{path}\"") })
            }
            Err(error) => {
                self.sink.push(load_diagnostic(self.sources, error, path, span));
                None
            }
        }
    }
}

/// The message for a file that could not be read; `span` is what asked for it.
fn load_diagnostic(sources: &SourceMap, error: LoadError, path: &str, span: Span) -> Diagnostic {
    match error {
        LoadError::Unreadable(reason) => {
            Diagnostic::new(Code::E0202, format!("cannot read `{path}`"), span, "imported here")
                .expected("a file, relative to the folder of this one", reason)
        }
        LoadError::OutsideRoot(root) => {
            Diagnostic::new(Code::E0203, format!("`{path}` leaves the project"), span, "leads outside")
                .expected(format!("a file inside {root}"), "one outside it")
                .help(
                    "the project root is the nearest folder upwards with an `lss.toml` or `.git`, else the file's own \
                     folder: an empty `lss.toml` further up widens it, and `--root DIR` says another",
                )
        }
        LoadError::TooLarge(bytes) => too_large(bytes, path, span),
        LoadError::NotUtf8 { file, byte } => not_utf8(sources, file, byte).related(span, "imported here"),
    }
}

/// The message for a main file that is there but is no source text. An unreadable one is not a matter of its text.
pub(super) fn main_diagnostic(sources: &mut SourceMap, error: &LoadError, path: &str) -> Option<Diagnostic> {
    match error {
        LoadError::NotUtf8 { file, byte } => Some(not_utf8(sources, *file, *byte)),
        LoadError::TooLarge(bytes) => {
            let file = sources.add(path, "");
            Some(too_large(*bytes, path, Span::new(file, 0, 0)))
        }
        LoadError::Unreadable(_) | LoadError::OutsideRoot(_) => None,
    }
}

fn too_large(bytes: u64, path: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0106, format!("`{path}` is too large"), span, "not read")
        .expected(format!("at most {} MiB", SIZE_LIMIT >> 20), format!("{:.1} MiB", bytes as f64 / (1 << 20) as f64))
}

fn not_utf8(sources: &SourceMap, file: FileId, byte: usize) -> Diagnostic {
    let source = sources.file(file);
    let end = byte + source.text[byte..].chars().next().map_or(0, char::len_utf8);
    Diagnostic::new(
        Code::E0201,
        format!("`{}` is not UTF-8 text", source.name),
        Span::new(file, byte, end),
        format!("byte {byte} of the file (counted from 0)"),
    )
    .expected("UTF-8", "a byte that cannot stand there")
    .help("save the file as UTF-8 in your editor")
}

/// What a tree declares; a repeated name is reported and the first one stays.
fn own_names(tree: &Tree, module: usize, sink: &mut Sink) -> BTreeMap<(Space, String), Symbol> {
    let mut own: BTreeMap<(Space, String), Symbol> = BTreeMap::new();
    for (item, node) in tree.items.nodes.iter().enumerate() {
        let Some((space, name)) = named(&node.value) else { continue };
        match own.get(&(space, name.text.clone())) {
            None => {
                own.insert((space, name.text.clone()), Symbol { module, item });
            }
            Some(first) => {
                let first = named(&tree.items.nodes[first.item].value).map_or(name.span, |(_, n)| n.span);
                sink.push(repeated(space.word(), name, first));
            }
        }
    }
    own
}

/// An item's space and name.
pub(super) fn named(item: &Item) -> Option<(Space, &Name)> {
    match item {
        Item::Let(item) => Some((Space::Let, &item.name)),
        Item::Declaration(item) => Some((Space::Component(item.kind), &item.name)),
        Item::Layout(item) => Some((Space::Layout, &item.name)),
        Item::Use(_) | Item::Bad => None,
    }
}

pub(super) fn repeated(what: &str, name: &Name, first: Span) -> Diagnostic {
    Diagnostic::new(Code::E0212, format!("the {what} `{}` is declared twice", name.text), name.span, "declared again")
        .related(first, "first declared here")
        .help("rename one of the two")
}

/// What a module's imports bring.
fn see(modules: &[Module], of: usize, sink: &mut Sink) -> BTreeMap<(Space, String), (Symbol, usize)> {
    let mut seen: BTreeMap<(Space, String), (Symbol, usize)> = BTreeMap::new();
    let module = &modules[of];
    for (index, import) in module.imports.iter().enumerate() {
        for (key, symbol) in &modules[import.module].own {
            if import.item.as_ref().is_some_and(|item| item.text != key.1) {
                continue;
            }
            let clash = |span: Span, what: &str| {
                Diagnostic::new(
                    Code::E0212,
                    format!("{} brings a second {} `{}`", import.shown, key.0.word(), key.1),
                    import.span,
                    "imported again",
                )
                .related(span, what.to_string())
                .help("rename one of the two, or import single items instead of everything")
            };
            // An import of everything yields to the file's own names, a single item does not.
            if let Some(own) = module.own.get(key) {
                if import.item.is_some() {
                    let span = named(&module.tree.items.nodes[own.item].value).map_or(import.span, |(_, n)| n.span);
                    sink.push(clash(span, "declared here"));
                }
                continue;
            }
            match seen.get(key) {
                Some((first, _)) if first == symbol => {}
                Some((_, first)) => sink.push(clash(module.imports[*first].span, "first imported here")),
                None => {
                    seen.insert(key.clone(), (*symbol, index));
                }
            }
        }
    }
    seen
}

/// Reports each import that closes a cycle, with the imports that lead there.
fn report_cycles(modules: &[Module], sink: &mut Sink) {
    // Depth first without recursion: a path of (module, next import to follow).
    let mut done = vec![false; modules.len()];
    for root in 0..modules.len() {
        let mut path: Vec<(usize, usize)> = if done[root] { Vec::new() } else { vec![(root, 0)] };
        while let Some((module, next)) = path.last_mut() {
            let Some(import) = modules[*module].imports.get(*next) else {
                done[*module] = true;
                path.pop();
                continue;
            };
            *next += 1;
            if let Some(at) = path.iter().position(|(m, _)| *m == import.module) {
                let message = match path.len() - at {
                    1 => format!("{} imports itself", import.shown),
                    _ => format!("{} closes a cycle of imports", import.shown),
                };
                let mut diagnostic = Diagnostic::new(Code::E0204, message, import.span, "leads back");
                for (module, next) in &path[at..path.len() - 1] {
                    diagnostic = diagnostic.related(modules[*module].imports[*next - 1].span, "which imports");
                }
                sink.push(diagnostic.help("move what both files need into a third one that imports neither"));
            } else if !done[import.module] {
                path.push((import.module, 0));
            }
        }
    }
}
