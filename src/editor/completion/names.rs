//! Proposals of names: what is declared, imported, or in the standard library.

use super::Proposals;
use crate::editor::describe;
use crate::editor::workspace::Workspace;
use crate::model::effect_definitions::{EFFECTS, spelled};
use crate::semantics::names::{NameKind, Visible};
use crate::semantics::vocabulary;
use crate::semantics::{Checked, Home};
use crate::source::{self, FileId, STDLIB, Span};
use crate::syntax;
use crate::syntax::tree::{Block, DeclarationKind, Field, Item, Param, Tree};
use lsp_types::{CompletionItemKind, CompletionTextEdit, TextEdit};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::OnceLock;

/// What may be named at a place.
pub struct Known<'a> {
    pub checked: &'a Checked,
    pub offset: usize,
    pub workspace: &'a Workspace,
}

/// A declaration of the standard library.
struct Standard {
    module: &'static str,
    kind: DeclarationKind,
    name: String,
    about: String,
}

fn standard() -> &'static [Standard] {
    static ALL: OnceLock<Vec<Standard>> = OnceLock::new();
    ALL.get_or_init(|| {
        let of = |(module, text): &(&'static str, &'static str)| {
            let (tree, _) = syntax::parse(FileId(0), text);
            let module = *module;
            let nodes = tree.items.nodes.into_iter();
            nodes.filter_map(move |node| {
                let Item::Declaration(declaration) = node.value else { return None };
                let lines: Vec<&str> = node.above.iter().map(|c| c.trim_start_matches('/').trim()).collect();
                let (kind, name) = (declaration.kind, declaration.name.text);
                Some(Standard { module, kind, name, about: lines.join(" ") })
            })
        };
        STDLIB.iter().flat_map(of).collect()
    })
}

/// A declaration of equipment: its name, its kind where it says one, and what it is from.
struct Equipment {
    name: String,
    kind: Option<String>,
    from: Option<String>,
}

/// The declarations of equipment in a tree, whose text is that of spans.
fn equipment<'a>(tree: &Tree, text: &dyn Fn(Span) -> &'a str) -> Vec<Equipment> {
    let declarations = tree.items.iter().filter_map(|item| match item {
        Item::Declaration(declaration) if declaration.kind == DeclarationKind::Equipment => Some(declaration),
        _ => None,
    });
    let kind = |field: &Field| match field {
        Field::Value { name, value } if name.text == "kind" => Some(text(value.span).trim().to_owned()),
        _ => None,
    };
    declarations
        .map(|declaration| Equipment {
            name: declaration.name.text.clone(),
            kind: declaration.fields.iter().find_map(kind),
            from: declaration.from.as_ref().map(|from| from.name.text.clone()),
        })
        .collect()
}

/// The kind of equipment of a name, through what it is from; `None` where nothing says it.
fn kind_of<'a>(all: &'a [Equipment], name: &str) -> Option<&'a str> {
    // A declaration that is from itself ends somewhere.
    const DEEPEST: usize = 16;
    let mut name = name;
    for _ in 0..DEEPEST {
        let found = all.iter().find(|own| own.name == name)?;
        match (&found.kind, &found.from) {
            (Some(kind), _) => return Some(kind),
            (None, Some(from)) => name = from,
            (None, None) => return None,
        }
    }
    None
}

fn shown(kind: &NameKind) -> CompletionItemKind {
    match kind {
        NameKind::Value => CompletionItemKind::CONSTANT,
        NameKind::Parameter | NameKind::EffectArgument(_) => CompletionItemKind::PROPERTY,
        NameKind::Component(_) => CompletionItemKind::CLASS,
        NameKind::Layout | NameKind::Module => CompletionItemKind::MODULE,
        NameKind::Field(..) => CompletionItemKind::FIELD,
        NameKind::Function => CompletionItemKind::FUNCTION,
        NameKind::Effect => CompletionItemKind::EVENT,
        _ => CompletionItemKind::VARIABLE,
    }
}

impl Known<'_> {
    fn visible(&self) -> &[Visible] {
        let study = self.checked.study.as_ref();
        study.and_then(|s| s.names.files.get(&self.checked.main)).map_or(&[], Vec::as_slice)
    }

    fn local(&self) -> &[Visible] {
        let study = self.checked.study.as_ref();
        study.and_then(|s| s.names.layout_at(self.checked.main, self.offset as u32)).map_or(&[], |l| &l.names)
    }

    fn propose(&self, out: &mut Proposals, name: &Visible) {
        let value = self.checked.study.as_ref().and_then(|s| s.values.get(&name.definition));
        let detail = value.cloned().unwrap_or_else(|| name.kind.word().to_owned());
        let about = describe::name(self.checked, &name.kind, &name.name, Some(name.definition));
        out.push(&name.name, shown(&name.kind), &detail, Some(about));
    }

    /// Vertices and the like of the layout around.
    pub fn parts(&self, out: &mut Proposals, kinds: &[NameKind]) {
        for name in self.local().iter().filter(|name| kinds.contains(&name.kind)) {
            self.propose(out, name);
        }
    }

    /// Declarations of a kind; those of the standard library that are not imported come with their import.
    pub fn named(&self, out: &mut Proposals, kind: &NameKind) {
        self.named_where(out, kind, &|_| true);
    }

    /// Declarations of equipment of a kind: `chute`.
    pub fn equipment(&self, out: &mut Proposals, kind: &str) {
        let kinds = self.kinds();
        self.named_where(out, &NameKind::Component(DeclarationKind::Equipment), &|name| {
            kind_of(&kinds, name).is_none_or(|found| found == kind)
        });
    }

    /// What declarations of equipment say of their kind. Those of the text come before those of the standard library.
    fn kinds(&self) -> Vec<Equipment> {
        let own = self.checked.study.iter().flat_map(|study| &study.files).map(|file| &file.tree);
        let own = own.flat_map(|tree| equipment(tree, &|span| self.checked.sources.text(span)));
        let own: Vec<Equipment> = own.collect();
        let library = STDLIB.iter().flat_map(|(_, text)| {
            let (tree, _) = syntax::parse(FileId(0), text);
            equipment(&tree, &|span| text.get(span.start as usize..span.end as usize).unwrap_or_default())
        });
        own.into_iter().chain(library).collect()
    }

    fn named_where(&self, out: &mut Proposals, kind: &NameKind, is_meant: &dyn Fn(&str) -> bool) {
        let mut seen = BTreeSet::new();
        for name in self.visible().iter().filter(|name| name.kind == *kind && is_meant(&name.name)) {
            seen.insert(name.name.as_str());
            self.propose(out, name);
        }
        let NameKind::Component(kind) = kind else { return };
        let Some(import) = self.checked.tree(self.checked.main).map(|tree| tree.import_place()) else { return };
        let lines = self.workspace.lines_of(self.checked, self.checked.main);
        for item in standard().iter().filter(|item| item.kind == *kind && is_meant(&item.name)) {
            if seen.contains(item.name.as_str()) {
                continue;
            }
            let path = format!("std.{}.{}", item.module, item.name);
            let edit = TextEdit::new(lines.of_span(import.span), import.text(&path));
            let detail = format!("use {path}");
            let proposal = out.push(&item.name, CompletionItemKind::CLASS, &detail, Some(item.about.clone()));
            proposal.additional_text_edits = Some(vec![edit]);
        }
    }

    /// `let`s, parameters and functions.
    pub fn values(&self, out: &mut Proposals, geometric: bool) {
        let mut seen = BTreeSet::new();
        let params = self.params_around();
        for name in self.local().iter().chain(&params).chain(self.visible()) {
            let value = matches!(name.kind, NameKind::Value | NameKind::Parameter);
            if value && seen.insert(name.name.as_str()) {
                self.propose(out, name);
            }
        }
        for function in vocabulary::functions().filter(|f| geometric || !f.geometric) {
            self.function(out, function.name);
        }
    }

    /// The parameters of the declaration around.
    fn params_around(&self) -> Vec<Visible> {
        let nodes = self.checked.tree(self.checked.main).map_or(&[][..], |tree| &tree.items.nodes);
        let node = nodes.iter().find(|n| (n.span.start..=n.span.end).contains(&(self.offset as u32)));
        let params = node.and_then(|node| if let Item::Declaration(d) = &node.value { Some(&d.params) } else { None });
        let all = params.iter().flat_map(|params| params.iter());
        let visible =
            |p: &Param| Visible { name: p.name.text.clone(), kind: NameKind::Parameter, definition: p.name.span };
        all.map(visible).collect()
    }

    pub fn function(&self, out: &mut Proposals, name: &str) {
        let about = describe::function(name);
        out.snippet(name, CompletionItemKind::FUNCTION, "", Some(about), &format!("{name}($1)"));
    }

    /// What a declaration's arguments are called.
    pub fn parameters(&self, out: &mut Proposals, kind: &NameKind, of: &str) {
        let Some(found) = self.visible().iter().find(|name| name.kind == *kind && name.name == of) else { return };
        let nodes = self.checked.tree(found.definition.file).map_or(&[][..], |tree| &tree.items.nodes);
        let params: Option<&Block<Param>> = nodes.iter().find_map(|node| match &node.value {
            Item::Declaration(d) if d.name.span == found.definition => Some(&d.params),
            Item::Layout(layout) if layout.name.span == found.definition => Some(&layout.params),
            _ => None,
        });
        for param in params.iter().flat_map(|params| params.iter()) {
            let default = self.checked.sources.text(param.default.span);
            let (name, detail) = (&param.name.text, format!("{default} when not given"));
            let snippet = format!("{name}: ${{1:{}}}", crate::editor::words::escaped(default));
            out.snippet(name, CompletionItemKind::PROPERTY, &detail, None, &snippet);
        }
    }

    pub fn effects(&self, out: &mut Proposals) {
        for effect in EFFECTS {
            let first = effect.strengths.first().map_or_else(String::new, |strength| {
                let unit = spelled(strength.unit);
                let unit = if unit.is_empty() { unit } else { format!(" {unit}") };
                format!("({}: $1{unit})", strength.name)
            });
            let snippet = format!("{}{first}", effect.name);
            let about = describe::effect(effect.name);
            out.snippet(effect.name, CompletionItemKind::EVENT, effect.about, Some(about), &snippet);
        }
    }

    pub fn effect_arguments(&self, out: &mut Proposals, effect: &str) {
        for (name, about) in describe::effect_arguments(effect) {
            out.snippet(name, CompletionItemKind::PROPERTY, &about, None, &format!("{name}: "));
        }
    }

    /// The fields that a declaration may have, those that it needs first.
    pub fn fields(&self, out: &mut Proposals, kind: DeclarationKind, prefix: &str) {
        let mut seen = BTreeSet::new();
        let all: Vec<_> = vocabulary::fields(kind).filter(|f| f.path.starts_with(prefix)).collect();
        let (required, optional): (Vec<_>, Vec<_>) = all.into_iter().partition(|f| f.required);
        for field in required.into_iter().chain(optional) {
            let rest = &field.path[prefix.len()..];
            match rest.split_once('.') {
                Some((group, _)) => {
                    if seen.insert(group.to_owned()) {
                        let about = describe::field(kind, &format!("{prefix}{group}"));
                        let snippet = format!("{group} {{\n  $0\n}}");
                        out.snippet(group, CompletionItemKind::STRUCT, "fields", Some(about), &snippet);
                    }
                }
                None => {
                    let about = describe::field(kind, field.path);
                    let detail = if field.unit.is_empty() { field.form.clone() } else { format!("in {}", field.unit) };
                    let unit = if field.unit.is_empty() { String::new() } else { format!(" {}", field.unit) };
                    let value = match field.form.as_str() {
                        form if form.starts_with("a number") => format!("${{1:1}}{unit}"),
                        form if form.starts_with("a text") => "\"$1\"".to_owned(),
                        _ => "$1".to_owned(),
                    };
                    let snippet = format!("{rest} = {value}");
                    out.snippet(rest, CompletionItemKind::FIELD, &detail, Some(about), &snippet);
                }
            }
        }
    }

    /// Behind `use`.
    pub fn library(&self, out: &mut Proposals, path: &str) {
        if path.is_empty() {
            out.push("std", CompletionItemKind::MODULE, "the standard library", None);
        } else if path == "std." {
            for (module, _) in STDLIB {
                out.push(module, CompletionItemKind::MODULE, "", Some(describe::module(module)));
            }
        } else if let Some(module) = path.strip_prefix("std.").and_then(|rest| rest.strip_suffix('.')) {
            for item in standard().iter().filter(|item| item.module == module) {
                out.push(&item.name, CompletionItemKind::CLASS, item.kind.word(), Some(item.about.clone()));
            }
        }
    }

    /// Files of the project in the quotes of a `use`.
    pub fn files(&self, out: &mut Proposals, place: &Path, quoted: &str) {
        let Some(folder) = place.parent().filter(|folder| folder.is_absolute()) else { return };
        let lines = self.workspace.lines_of(self.checked, self.checked.main);
        out.range = lines.range(self.offset - quoted.len(), self.offset);
        let open = self.workspace.places();
        let mut all: BTreeSet<&Path> = open.iter().map(|p| p.as_path()).filter(|p| p.is_absolute()).collect();
        let listed = source::layouts(folder);
        all.extend(listed.iter().map(|p| p.as_path()));
        for file in all.into_iter().filter(|file| *file != place) {
            let Some(path) = relative(folder, file) else { continue };
            let known = self.checked.file_at(file).and_then(|id| self.checked.home(id));
            let detail = if matches!(known, Some(Home::Disk(_))) { "imported" } else { "" };
            let range = out.range;
            let item = out.push(&path, CompletionItemKind::FILE, detail, None);
            item.text_edit = Some(CompletionTextEdit::Edit(TextEdit::new(range, path.clone())));
        }
    }
}

/// The path of a file as one of this folder names it, with `/` on every platform.
fn relative(folder: &Path, file: &Path) -> Option<String> {
    let common = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().count() - common;
    let down: Option<Vec<&str>> = file.components().skip(common).map(|c| c.as_os_str().to_str()).collect();
    Some("../".repeat(up) + &down?.join("/"))
}
