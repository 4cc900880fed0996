//! The layouts of a project: every file `*.lss` below its root, for who looks for all that names something.

use super::Root;
use std::fs;
use std::path::{Path, PathBuf};

/// Most files, and most folders, that are listed.
const MOST: usize = 2_000;
/// Folders of tools, which hold no layouts of the project itself.
const SKIPPED: [&str; 2] = ["node_modules", "target"];

/// The layouts within a root that is marked or given, in order of their paths; only those in the folder itself where
/// nothing marks one. Links are not followed, nor are hidden folders looked into.
pub fn layouts(folder: &Path) -> Vec<PathBuf> {
    let root = Root::of_layout(folder);
    let marked = root.is_marked();
    let mut found = Vec::new();
    let mut folders: Vec<PathBuf> = root.folders().map(Path::to_owned).collect();
    let mut looked_into = 0;
    while let Some(folder) = folders.pop() {
        looked_into += 1;
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for entry in entries.flatten() {
            let Ok(kind) = entry.file_type() else { continue };
            let (path, name) = (entry.path(), entry.file_name());
            let name = name.to_string_lossy();
            if kind.is_dir() && marked && !name.starts_with('.') && !SKIPPED.contains(&&*name) {
                folders.push(path);
            } else if kind.is_file() && path.extension().is_some_and(|e| e == "lss") {
                found.push(path);
            }
        }
        if looked_into >= MOST || found.len() >= MOST {
            break;
        }
    }
    found.sort_unstable();
    found.truncate(MOST);
    found
}

/// The layouts in a folder itself, in order of their names, as that folder is named.
pub fn layouts_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().take(MOST).map(|entry| entry.path());
    let mut found: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "lss")).collect();
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_of_a_marked_project_are_found_in_its_folders() {
        let at = tempfile::tempdir().unwrap();
        for name in ["p/lss.toml", "p/b.lss", "p/a/c.lss", "p/.git/d.lss", "p/target/e.lss", "p/f.txt", "g.lss"] {
            let path = at.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        let names = |folder: &str| -> Vec<String> {
            let all = layouts(&at.path().join(folder));
            all.iter().map(|p| p.file_name().unwrap().to_string_lossy().into_owned()).collect()
        };
        assert_eq!(names("p/a"), ["c.lss", "b.lss"]);
        // Without a mark, the folder alone.
        fs::remove_file(at.path().join("p/lss.toml")).unwrap();
        fs::remove_dir_all(at.path().join("p/.git")).unwrap();
        assert_eq!(names("p"), ["b.lss"]);
    }
}
