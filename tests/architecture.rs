//! The plan of the house: rooms stand in an order, a room uses only rooms above it, and files of one folder do not need
//! each other in a circle. `docs/architecture.md` says why.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Attribute, ImplItem, Item, ItemImpl, ItemUse, Macro, Type, UseTree, Visibility};

/// From the top: a room may use those before it.
const ROOMS: [&str; 31] = [
    "base",
    "source",
    "diagnostic",
    "syntax",
    "geometry",
    "model",
    "semantics",
    "import",
    "elements",
    "placement",
    "problem",
    "kinematics",
    "capacity",
    "solve",
    "route",
    "compiled",
    "chain_input",
    "signal",
    "review",
    "dynamics",
    "effects",
    "choose",
    "identify",
    "gap",
    "benchmark",
    "study",
    "emit",
    "report",
    "editor",
    "preview",
    "cli",
];

/// A path of modules and items from the crate's root.
type Names = Vec<String>;

/// A file's module: what it uses, what it passes on, and the types whose inherent methods it has.
#[derive(Default)]
struct Module {
    used: BTreeSet<Names>,
    /// By the name under which it is passed on; `*` for everything.
    passed_on: Vec<(String, Names)>,
    /// By the name under which it is known in the file.
    imported: BTreeMap<String, Names>,
    defined: BTreeSet<String>,
    implemented: BTreeSet<String>,
}

type Modules = BTreeMap<Names, Module>;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Whether an item is compiled for tests only.
fn is_test(attributes: &[Attribute]) -> bool {
    attributes
        .iter()
        .any(|a| a.path().is_ident("cfg") && a.meta.require_list().is_ok_and(|l| l.tokens.to_string() == "test"))
}

fn names(path: &str) -> Names {
    path.split("::").map(|n| n.trim().to_owned()).collect()
}

/// Reads a file.
struct Reader<'a> {
    /// The file's module.
    own: &'a [String],
    module: Module,
    /// Files of modules that are compiled for tests only.
    tests: Vec<Names>,
}

impl Reader<'_> {
    /// A path from the crate's root, if it leads anywhere within the crate.
    fn absolute(&self, path: &[String]) -> Option<Names> {
        match path.first()?.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "self" => Some([self.own, &path[1..]].concat()),
            "super" => {
                let up = path.iter().take_while(|n| *n == "super").count();
                let depth = self.own.len().checked_sub(up)?;
                Some([&self.own[..depth], &path[up..]].concat())
            }
            _ => None,
        }
    }

    fn tree(&mut self, tree: &UseTree, before: &[String], passes_on: bool) {
        let with = |name: String| [before, &[name]].concat();
        let (name, known_as) = match tree {
            UseTree::Path(path) => return self.tree(&path.tree, &with(path.ident.to_string()), passes_on),
            UseTree::Group(group) => return group.items.iter().for_each(|tree| self.tree(tree, before, passes_on)),
            UseTree::Name(name) => (name.ident.to_string(), name.ident.to_string()),
            UseTree::Rename(rename) => (rename.ident.to_string(), rename.rename.to_string()),
            UseTree::Glob(_) => ("*".to_owned(), "*".to_owned()),
        };
        let path = if name == "self" { before.to_vec() } else { with(name) };
        // A module's own children need no prefix.
        let absolute = self.absolute(&path).or_else(|| passes_on.then(|| [self.own, &path].concat()));
        let Some(absolute) = absolute else { return };
        let known_as = if known_as == "self" { absolute.last().cloned().unwrap_or_default() } else { known_as };
        if passes_on {
            self.module.passed_on.push((known_as.clone(), absolute.clone()));
        }
        self.module.imported.insert(known_as, absolute.clone());
        self.module.used.insert(absolute);
    }

    fn path(&mut self, path: &str) {
        if let Some(absolute) = self.absolute(&names(path)) {
            self.module.used.insert(absolute);
        }
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        let (attributes, name) = match item {
            Item::Mod(item) => (&item.attrs, Some(&item.ident)),
            Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
            Item::Struct(item) => (&item.attrs, Some(&item.ident)),
            Item::Enum(item) => (&item.attrs, Some(&item.ident)),
            Item::Trait(item) => (&item.attrs, Some(&item.ident)),
            Item::Type(item) => (&item.attrs, Some(&item.ident)),
            Item::Const(item) => (&item.attrs, Some(&item.ident)),
            Item::Static(item) => (&item.attrs, Some(&item.ident)),
            Item::Impl(item) => (&item.attrs, None),
            Item::Use(item) => (&item.attrs, None),
            _ => return visit::visit_item(self, item),
        };
        if is_test(attributes) {
            if let Some(name) = name {
                self.tests.push([self.own, &[name.to_string()]].concat());
            }
            return;
        }
        self.module.defined.extend(name.map(ToString::to_string));
        visit::visit_item(self, item);
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let passes_on = !matches!(item.vis, Visibility::Inherited);
        self.tree(&item.tree, &[], passes_on);
    }

    fn visit_item_impl(&mut self, item: &'ast ItemImpl) {
        if let (None, Type::Path(of)) = (&item.trait_, &*item.self_ty)
            && item.items.iter().any(|i| matches!(i, ImplItem::Fn(f) if !is_test(&f.attrs)))
            && let Some(first) = of.path.segments.first()
        {
            self.module.implemented.insert(first.ident.to_string());
        }
        visit::visit_item_impl(self, item);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let written: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        self.path(&written.join("::"));
        visit::visit_path(self, path);
    }

    /// What stands in a macro is not parsed: paths are looked for in its words.
    fn visit_macro(&mut self, item: &'ast Macro) {
        let text = item.tokens.to_string().replace(" :: ", "::");
        for word in text.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')) {
            if word.starts_with("crate::") || word.starts_with("super::") {
                self.path(word.trim_end_matches(':'));
            }
        }
    }
}

/// All modules that are files, without tests.
fn modules() -> Modules {
    let mut files = Vec::new();
    sources(&root().join("src"), &mut files);
    let (mut all, mut tests) = (Modules::new(), BTreeSet::new());
    for file in files {
        let relative = file.strip_prefix(root().join("src")).expect("below").with_extension("");
        let mut own: Names = relative.iter().map(|n| n.to_string_lossy().into_owned()).collect();
        if own.last().is_some_and(|n| ["mod", "lib", "main"].contains(&n.as_str())) {
            own.pop();
        }
        if file.ends_with("main.rs") {
            continue;
        }
        let syntax = syn::parse_file(&fs::read_to_string(&file).expect("text")).expect("Rust");
        let mut reader = Reader { own: &own, module: Module::default(), tests: Vec::new() };
        reader.visit_file(&syntax);
        tests.extend(reader.tests);
        let module = reader.module;
        all.insert(own, module);
    }
    all.retain(|own, _| !tests.iter().any(|test| own.starts_with(test)));
    all
}

/// The file in which what a path names is defined.
fn home(all: &Modules, path: &[String], depth: usize) -> Option<Names> {
    let at = (0..=path.len()).rev().find(|&k| all.contains_key(&path[..k]))?;
    let (file, rest) = path.split_at(at);
    let Some(name) = rest.first() else { return Some(file.to_vec()) };
    let module = &all[file];
    if depth < 8 && !module.defined.contains(name) {
        let passed = module.passed_on.iter().find(|(known_as, _)| known_as == name);
        if let Some((_, on)) = passed {
            return home(all, &[on.as_slice(), &rest[1..]].concat(), depth + 1);
        }
        for (_, on) in module.passed_on.iter().filter(|(known_as, _)| known_as == "*") {
            let target = &on[..on.len() - 1];
            if all.get(target).is_some_and(|m| m.defined.contains(name)) {
                return Some(target.to_vec());
            }
        }
    }
    Some(file.to_vec())
}

/// From each file to those that it uses.
fn uses(all: &Modules) -> BTreeMap<&Names, BTreeSet<Names>> {
    all.iter()
        .map(|(own, module)| {
            let homes = module.used.iter().filter_map(|path| {
                let path = if path.last().is_some_and(|n| n == "*") { &path[..path.len() - 1] } else { path };
                home(all, path, 0)
            });
            (own, homes.filter(|to| to != own).collect())
        })
        .collect()
}

fn place(room: &str) -> usize {
    ROOMS.iter().position(|r| *r == room).unwrap_or_else(|| panic!("`{room}` has no place in the order of rooms"))
}

#[test]
fn a_room_uses_only_rooms_above_it() {
    let all = modules();
    let mut wrong = Vec::new();
    for (own, homes) in uses(&all) {
        let Some(room) = own.first() else { continue };
        for to in homes.iter().filter_map(|to| to.first().map(|other| (other, to))).filter(|(other, _)| *other != room)
        {
            if place(to.0) > place(room) {
                wrong.push(format!("{} uses {}", own.join("::"), to.1.join("::")));
            }
        }
    }
    assert!(wrong.is_empty(), "these look down:\n{}", wrong.join("\n"));
}

/// A folder's own `mod.rs` may hold what its files share, so a file may use the modules that it stands in.
#[test]
fn files_of_a_folder_do_not_need_each_other_in_a_circle() {
    let all = modules();
    // In each folder, from one of its files or folders to another.
    let mut beside: BTreeMap<Names, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for (own, homes) in uses(&all) {
        for to in homes {
            let common = own.iter().zip(&to).take_while(|(a, b)| a == b).count();
            if let (Some(a), Some(b)) = (own.get(common), to.get(common)) {
                let folder = beside.entry(own[..common].to_vec()).or_default();
                folder.entry(a.clone()).or_default().insert(b.clone());
            }
        }
    }
    let mut circles = Vec::new();
    for (folder, mut graph) in beside {
        // Who needs nobody that is left is in no circle.
        loop {
            let left: BTreeSet<String> = graph.keys().cloned().collect();
            let before = left.len();
            graph.values_mut().for_each(|needs| needs.retain(|n| left.contains(n)));
            graph.retain(|_, needs| !needs.is_empty());
            if graph.len() == before {
                break;
            }
        }
        circles.extend(graph.iter().map(|(a, needs)| format!("in `{}`: {a} needs {needs:?}", folder.join("::"))));
    }
    assert!(circles.is_empty(), "circles:\n{}", circles.join("\n"));
}

#[test]
fn methods_of_a_type_stand_in_its_room() {
    let all = modules();
    let mut wrong = Vec::new();
    for (own, module) in &all {
        for name in module.implemented.iter().filter(|name| !module.defined.contains(*name)) {
            let to = module.imported.get(name).and_then(|path| home(&all, path, 0));
            if let Some(to) = to.filter(|to| to.first() != own.first()) {
                wrong.push(format!("{}: impl {name} of {}", own.join("::"), to.join("::")));
            }
        }
    }
    assert!(wrong.is_empty(), "these belong elsewhere:\n{}", wrong.join("\n"));
}

/// What a reader is told of the order.
#[test]
fn the_crate_and_its_documents_list_the_rooms_in_this_order() {
    let lib = fs::read_to_string(root().join("src/lib.rs")).expect("lib.rs");
    let mut declared: Vec<&str> = lib.lines().filter_map(|l| l.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    declared.sort_by_key(|room| place(room));
    assert_eq!(declared, ROOMS);
    let in_order = |text: &str, marked: &dyn Fn(&str) -> String, what: &str| {
        let places: Vec<usize> = ROOMS
            .iter()
            .map(|room| text.find(&marked(room)).unwrap_or_else(|| panic!("{what} does not list {room}")))
            .collect();
        assert!(places.is_sorted(), "{what} has another order");
    };
    in_order(&lib, &|room| format!("- [`{room}`]"), "lib.rs");
    let document = fs::read_to_string(root().join("docs/architecture.md")).expect("docs/architecture.md");
    in_order(&document, &|room| format!("| `{room}/` |"), "docs/architecture.md");
}

/// A file that no program of tests names would never run.
#[test]
fn every_file_of_tests_is_a_module_of_its_program() {
    let tests = root().join("tests");
    for entry in fs::read_dir(&tests).expect("a folder") {
        let main = entry.expect("an entry").path().join("main.rs");
        let Ok(text) = fs::read_to_string(&main) else { continue };
        let mut files = Vec::new();
        sources(main.parent().expect("a folder"), &mut files);
        for file in files.iter().filter(|file| **file != main) {
            let parent = file.parent().expect("a folder");
            let module = if file.ends_with("mod.rs") { parent } else { file };
            let name = module.file_stem().expect("a name").to_string_lossy();
            // A folder of modules has a `mod.rs` that names them.
            let beside = parent.join("mod.rs");
            let text = match fs::read_to_string(&beside) {
                Ok(text) if beside != *file => text,
                _ => text.clone(),
            };
            assert!(text.lines().any(|line| line == format!("mod {name};")), "{} is not run", file.display());
        }
    }
}

/// `cargo remove` takes settings away of packages that are no dependency by name, which slowed the program down unseen.
#[test]
fn what_users_wait_for_is_optimised() {
    let text = fs::read_to_string(root().join("Cargo.toml")).expect("Cargo.toml");
    let profiles: toml::Table = toml::from_str(&text).expect("TOML");
    let level = |profile: &str, package: &str| {
        profiles["profile"].get(profile)?.get("package")?.get(package)?.get("opt-level")?.as_integer()
    };
    let least = [("release", "lss", 2), ("dist", "lss", 3), ("bench", "lss", 3)];
    let used = ["release", "dev"].into_iter().flat_map(|p| ["clarabel", "csv-core", "rustfft"].map(|of| (p, of, 3)));
    for (profile, package, least) in least.into_iter().chain(used) {
        assert!(level(profile, package) >= Some(least), "Cargo.toml: {package} in the profile {profile}");
    }
}
