//! Names for what is written of each layout of a campaign.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

/// A name for each layout, without an ending: its file's, or where several files are called the same, with the folders
/// in which they differ: `a-oval` of `a/oval.lss`. Neither a name nor one with the suffix is given twice, nor two that
/// differ only in case.
pub fn names<'a>(layouts: impl Iterator<Item = &'a Path>, suffix: &str) -> BTreeMap<PathBuf, String> {
    let mut paths: Vec<&Path> = Vec::new();
    layouts.for_each(|path| {
        if !paths.contains(&path) {
            paths.push(path);
        }
    });
    let mut names = BTreeMap::new();
    let mut taken = BTreeSet::new();
    for path in &paths {
        let twins: Vec<&Path> =
            paths.iter().filter(|p| stem(p).to_lowercase() == stem(path).to_lowercase()).copied().collect();
        let name = if twins.len() > 1 { apart(path, &twins) } else { stem(path) };
        let numbered = (2..).map(|k| format!("{name}-{k}"));
        let free =
            |name: &String| ["", suffix].iter().all(|end| !taken.contains(&format!("{name}{end}").to_lowercase()));
        let Some(name) = std::iter::once(name.clone()).chain(numbered).find(free) else { continue };
        taken.extend(["", suffix].map(|end| format!("{name}{end}").to_lowercase()));
        names.insert((*path).to_owned(), name);
    }
    names
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "layout".into(), |s| s.to_string_lossy().into_owned())
}

/// The folders below those that all have in common, and the name.
fn apart(path: &Path, all: &[&Path]) -> String {
    let common =
        (0..).take_while(|k| all.iter().all(|p| folders(p).get(*k).is_some_and(|f| Some(f) == folders(path).get(*k))));
    let own = folders(path).split_off(common.count());
    own.into_iter().chain([stem(path)]).collect::<Vec<_>>().join("-")
}

fn folders(path: &Path) -> Vec<String> {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut folders: Vec<String> = Vec::new();
    for part in path.parent().into_iter().flat_map(Path::components) {
        match part {
            Component::ParentDir => drop(folders.pop()),
            Component::Normal(name) => folders.push(name.to_string_lossy().into_owned()),
            _ => {}
        }
    }
    folders
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(layouts: &[&str]) -> Vec<String> {
        let names = names(layouts.iter().map(Path::new), "-fitted");
        layouts.iter().map(|l| names[Path::new(l)].clone()).collect()
    }

    #[test]
    fn layouts_of_one_name_are_kept_apart_by_their_folders() {
        assert_eq!(named(&["a/oval.lss", "b/hook.lss", "a/oval.lss"]), ["oval", "hook", "oval"]);
        assert_eq!(named(&["c/a/oval.lss", "c/b/oval.lss", "c/x.lss"]), ["a-oval", "b-oval", "x"]);
        assert_eq!(named(&["oval.lss", "b/oval.lss"]), ["oval", "b-oval"]);
        assert_eq!(named(&["a/Oval.lss", "b/oval.lss"]), ["a-Oval", "b-oval"]);
        assert_eq!(named(&["a/b-c/oval.lss", "a-b/c/oval.lss"]), ["a-b-c-oval", "a-b-c-oval-2"]);
        assert_eq!(named(&["a/oval.lss", "a/oval.json"]), ["oval", "oval-2"]);
        // A copy is not called like what is written of another.
        assert_eq!(named(&["oval.lss", "oval-fitted.lss"]), ["oval", "oval-fitted-2"]);
        assert_eq!(named(&["oval-fitted.lss", "oval.lss"]), ["oval-fitted", "oval-2"]);
    }
}
