//! Files of the program itself that an editor can show: the standard library, and the pages of diagnostics. They are
//! written into the user's cache, into a folder for each version of their texts.

use super::place;
use crate::base::digest::sha256;
use crate::diagnostic::Code;
use crate::source::{STDLIB, disk};
use lsp_types::Uri;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The file of a module of the standard library.
pub fn module(name: &str) -> Option<Uri> {
    let (_, text) = STDLIB.iter().find(|(module, _)| *module == name)?;
    file("std", &format!("{name}.lss"), text)
}

/// The page of a code.
pub fn page(code: Code) -> Option<Uri> {
    file("codes", &format!("{}.md", code.as_str()), code.page())
}

/// Whether a place is one of these files: nobody changes them.
pub fn holds(place: &Path) -> bool {
    folder().is_some_and(|folder| place.starts_with(folder))
}

fn file(kind: &str, name: &str, text: &str) -> Option<Uri> {
    let folder = folder()?.join(kind);
    let path = folder.join(name);
    if fs::read(&path).ok().as_deref() != Some(text.as_bytes()) {
        fs::create_dir_all(&folder).ok()?;
        disk::replace(&path, text.as_bytes()).ok()?;
    }
    place::to_uri(&path)
}

fn folder() -> Option<&'static Path> {
    static FOLDER: OnceLock<Option<PathBuf>> = OnceLock::new();
    let made = || {
        let folder = cache()?.join("lss").join(version());
        fs::create_dir_all(&folder).ok()?;
        folder.canonicalize().ok()
    };
    FOLDER.get_or_init(made).as_deref()
}

/// Where a user's programs keep what they can make again.
fn cache() -> Option<PathBuf> {
    let of = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let below = if cfg!(target_os = "macos") { "Library/Caches" } else { ".cache" };
    of("XDG_CACHE_HOME").or_else(|| of("LOCALAPPDATA")).or_else(|| Some(of("HOME")?.join(below)))
}

/// Differs wherever a text does.
fn version() -> String {
    let mut all = String::new();
    STDLIB.iter().for_each(|(_, text)| all += text);
    Code::ALL.iter().for_each(|code| all += code.page());
    sha256(all.as_bytes()).chars().take(16).collect()
}
