//! The documents as readers meet them: links lead somewhere, the book has every page, and commands are ones that the
//! program takes.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use clap::Parser;
use lss::cli::Cli;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All documents, by their path from the root.
pub fn documents() -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    let mut folders: Vec<PathBuf> =
        ["docs", "editors", "src/diagnostic/pages", "benches", "examples"].map(PathBuf::from).to_vec();
    let mut files: Vec<PathBuf> =
        ["README.md", "SECURITY.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(PathBuf::from).to_vec();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root().join(&folder)).expect("a folder") {
            let entry = entry.expect("an entry");
            let path = folder.join(entry.file_name());
            if entry.file_type().expect("a kind").is_dir() {
                // What a package manager leaves there is not ours.
                if entry.file_name() != "node_modules" {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|e| e == "md") {
                files.push(path);
            }
        }
    }
    for file in files {
        let text = fs::read_to_string(root().join(&file)).expect("a document");
        found.insert(file, text);
    }
    found
}

/// The text outside of code: blocks between fences are left out, and spans between backticks.
fn prose(text: &str) -> String {
    let mut within = false;
    let mut prose = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            within = !within;
        } else if !within {
            let parts = line.split('`').enumerate().filter(|(i, _)| i % 2 == 0);
            prose.extend(parts.map(|(_, part)| part));
            prose.push('\n');
        }
    }
    prose
}

/// Targets of `[...](target)`.
fn links(text: &str) -> Vec<String> {
    let prose = prose(text);
    let mut found = Vec::new();
    for part in prose.split("](").skip(1) {
        if let Some((target, _)) = part.split_once(')') {
            found.push(target.to_owned());
        }
    }
    found
}

/// The anchors of a document's headings, as GitHub and mdBook make them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut within = false;
    let mut anchors = BTreeSet::new();
    for line in text.lines() {
        within ^= line.starts_with("```");
        if let (false, true, Some(words)) =
            (within, line.starts_with('#'), line.trim_start_matches('#').strip_prefix(' '))
        {
            let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
            anchors.insert(
                words.trim().to_lowercase().chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect(),
            );
        }
    }
    anchors
}

/// A path without `.` and `..`.
fn straight(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut path, part| {
        match part {
            Component::ParentDir => drop(path.pop()),
            Component::CurDir => {}
            part => path.push(part),
        }
        path
    })
}

#[test]
fn every_link_leads_somewhere() {
    let documents = documents();
    let mut wrong = Vec::new();
    // The book's summary counts from the root, where `.ci/book` puts it.
    for (file, text) in documents.iter().filter(|(file, _)| !file.starts_with("docs/book")) {
        for link in links(text) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            let (path, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target =
                if path.is_empty() { file.clone() } else { straight(&file.parent().expect("a folder").join(path)) };
            if !root().join(&target).exists() {
                wrong.push(format!("{}: {link}", file.display()));
            } else if !anchor.is_empty()
                && let Some(text) = documents.get(&target)
                && !anchors(text).contains(anchor)
            {
                wrong.push(format!("{}: {link} (no such heading)", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_book_has_every_page_once() {
    let summary = fs::read_to_string(root().join("docs/book/SUMMARY.md")).expect("the summary");
    let listed: Vec<PathBuf> = links(&summary).into_iter().map(PathBuf::from).collect();
    let unique: BTreeSet<&PathBuf> = listed.iter().collect();
    assert_eq!(unique.len(), listed.len(), "a page is listed twice");
    let pages = documents().into_keys().filter(|path| {
        !path.starts_with("examples") && !path.starts_with("docs/book") && !path.starts_with("editors/vscode")
    });
    let pages: BTreeSet<PathBuf> = pages.collect();
    let missing: Vec<&PathBuf> = pages.iter().filter(|page| !unique.contains(page)).collect();
    let gone: Vec<&&PathBuf> = unique.iter().filter(|page| !pages.contains(**page)).collect();
    assert!(missing.is_empty() && gone.is_empty(), "docs/book/SUMMARY.md lacks {missing:?}, and has {gone:?}");
}

/// The blocks of a shell, as they stand.
pub fn blocks(text: &str) -> Vec<String> {
    let mut blocks = Vec::new();
    // The block that is open, where it is one of a shell.
    let mut open: Option<Option<String>> = None;
    for line in text.lines() {
        match (line.trim().strip_prefix("```"), &mut open) {
            (Some(_), Some(block)) => {
                blocks.extend(block.take());
                open = None;
            }
            (Some(language), None) => {
                open = Some(matches!(language, "sh" | "bash" | "console").then(String::new));
            }
            (None, Some(Some(block))) => {
                *block += line;
                block.push('\n');
            }
            (None, _) => {}
        }
    }
    blocks
}

/// Commands of a shell, without comments, with lines that go on joined.
fn commands(text: &str) -> Vec<String> {
    let joined = |block: String| block.replace("\\\n", "");
    let lines = |block: String| block.lines().map(|line| line.trim().to_owned()).collect::<Vec<_>>();
    blocks(text).into_iter().map(joined).flat_map(lines).collect()
}

/// Words of each `lss` in a command, up to what redirects or pipes it.
fn calls(command: &str) -> Vec<Vec<String>> {
    let command = command.split(" #").next().unwrap_or_default();
    let mut words: Vec<String> = Vec::new();
    let mut quote = None;
    let mut word = String::new();
    for c in command.chars().chain([' ']) {
        match quote {
            Some(q) if c == q => quote = None,
            None if c == '\'' || c == '"' => quote = Some(c),
            None if c.is_whitespace() => {
                if !word.is_empty() {
                    words.push(std::mem::take(&mut word));
                }
            }
            _ => word.push(c),
        }
    }
    let ends = |word: &String| matches!(word.as_str(), "|" | "||" | "&&" | ";" | "&") || word.starts_with(['>', '<']);
    let mut calls = Vec::new();
    for part in words.split(ends) {
        let named = |word: &String| word == "lss" || word.ends_with("/lss");
        let cargo = part.windows(2).position(|w| w[0] == "--").filter(|_| part.first().is_some_and(|w| w == "cargo"));
        let begin = match cargo {
            Some(_) if part.get(1).is_some_and(|w| w == "run") => part.iter().position(|w| w == "--"),
            _ => part.iter().position(named),
        };
        if let Some(begin) = begin {
            calls.push(std::iter::once("lss".to_owned()).chain(part[begin + 1..].iter().cloned()).collect());
        }
    }
    calls
}

#[test]
fn every_command_is_one_that_the_program_takes() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for (file, text) in documents() {
        // What was run then, by the version of then.
        if file.starts_with("benches") || file.starts_with("CHANGELOG.md") {
            continue;
        }
        for call in commands(&text).iter().flat_map(|command| calls(command)) {
            // The program as another one's argument, a synopsis, and words that stand for others.
            if call.len() == 1 || call.iter().any(|word| word.contains('[') || word == "...") {
                continue;
            }
            count += 1;
            if let Err(why) = Cli::try_parse_from(&call)
                && !matches!(why.kind(), clap::error::ErrorKind::DisplayHelp | clap::error::ErrorKind::DisplayVersion)
            {
                wrong.push(format!(
                    "{}: {}: {}",
                    file.display(),
                    call.join(" "),
                    why.to_string().lines().next().unwrap()
                ));
            }
            let named = call.iter().filter(|word| word.starts_with("examples/"));
            wrong.extend(
                named.filter(|word| !root().join(word).exists()).map(|word| format!("{}: no {word}", file.display())),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count > 30, "only {count} commands were found");
}

#[test]
fn what_reads_documents_reads_them() {
    let text = "# A *b* `c`\n```sh\nlss check a.lss \\\n  --root .  # why\nX=1 lss diff a b |\n  cat\n```\n[x](y.md#z) `[n](o)`\n";
    assert_eq!(links(text), ["y.md#z"]);
    let calls: Vec<String> = commands(text).iter().flat_map(|c| calls(c)).map(|c| c.join(" ")).collect();
    assert_eq!(calls, ["lss check a.lss --root .", "lss diff a b"]);
    assert!(anchors("## The *bill*, as `x`: y\n").contains("the-bill-as-x-y"));
}
