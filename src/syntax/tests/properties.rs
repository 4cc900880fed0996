//! Properties on damaged and recombined files.

use super::*;
use proptest::prelude::*;

const CORPUS: [&str; 3] = [EVERYTHING, TERMINAL, include_str!("corpus/mistakes.lss")];

/// One change of a text.
#[derive(Clone, Debug)]
enum Damage {
    Cut(prop::sample::Index, prop::sample::Index),
    Insert(prop::sample::Index, String),
    Truncate(prop::sample::Index),
    Append(usize),
    SwapLines(prop::sample::Index, prop::sample::Index),
}

fn damage() -> impl Strategy<Value = Damage> {
    let index = any::<prop::sample::Index>;
    let token = prop::sample::select(vec![
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        "\"",
        "\\",
        "//",
        "// c",
        "\n",
        "\r\n",
        "\r",
        ",",
        "..",
        ".",
        "=",
        "-",
        "+",
        "*",
        "/",
        "1e",
        "5 m",
        ".5",
        "0x",
        "%",
        "°",
        "²",
        "layout ",
        "use ",
        "vertex ",
        "fix ",
        "on ",
        "\0",
        "\u{FEFF}",
        "\u{A0}",
        "é",
        "→",
        "\u{202E}",
        "P1..P2",
        "(1 m, 2 m)",
    ]);
    prop_oneof![
        (index(), index()).prop_map(|(a, b)| Damage::Cut(a, b)),
        (index(), token).prop_map(|(at, token)| Damage::Insert(at, token.to_string())),
        (index(), ".{0,4}").prop_map(|(at, any)| Damage::Insert(at, any)),
        index().prop_map(Damage::Truncate),
        (0..CORPUS.len()).prop_map(Damage::Append),
        (index(), index()).prop_map(|(a, b)| Damage::SwapLines(a, b)),
    ]
}

fn position(text: &str, index: &prop::sample::Index) -> usize {
    let mut at = index.index(text.len() + 1);
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

fn apply(text: &mut String, damage: &Damage) {
    match damage {
        Damage::Cut(a, b) => {
            let start = position(text, a);
            let mut end = (start + b.index(12)).min(text.len());
            while !text.is_char_boundary(end) {
                end += 1;
            }
            text.replace_range(start..end, "");
        }
        Damage::Insert(at, token) => text.insert_str(position(text, at), token),
        Damage::Truncate(at) => text.truncate(position(text, at)),
        Damage::Append(which) => text.push_str(CORPUS[*which]),
        Damage::SwapLines(a, b) => {
            let mut lines: Vec<&str> = text.split('\n').collect();
            let (a, b) = (a.index(lines.len()), b.index(lines.len()));
            lines.swap(a, b);
            *text = lines.join("\n");
        }
    }
}

/// The comments of a text by an independent scan.
fn comments(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in text.lines() {
        let (mut quoted, mut escaped, mut before) = (false, false, ' ');
        for (at, c) in line.char_indices() {
            match c {
                _ if escaped => escaped = false,
                '\\' if quoted => escaped = true,
                '"' => quoted = !quoted,
                '/' if before == '/' && !quoted => {
                    found.push(line[at - 1..].trim_end().to_string());
                    break;
                }
                _ => {}
            }
            before = if quoted { ' ' } else { c };
        }
    }
    found
}

/// Formatting keeps the meaning and the comments, and does nothing the second time.
fn check_formatting(text: &str, tree: &Tree) {
    let once = format(tree, text);
    let (again, problems) = read(&once);
    assert!(problems.is_empty(), "{once}\n{}", shown(&once, &problems));
    assert_eq!(bare(tree), bare(&again), "the tree changed");
    assert_eq!(comments(text), comments(&once), "the comments changed");
    assert_eq!(once, format(&again, &once), "not idempotent");
    assert!(once.is_empty() || (once.ends_with('\n') && !once.ends_with("\n\n")));
    assert!(once.lines().all(|line| line.trim_end() == line) && !once.contains("\n\n\n"));
}

#[test]
fn formatting_the_corpus_keeps_everything() {
    for text in [EVERYTHING, TERMINAL] {
        check_formatting(text, &clean(text));
        let windows = text.replace('\n', "\r\n");
        // A checkout on Windows keeps how its lines end.
        assert_eq!(formatted(&windows), formatted(text).replace('\n', "\r\n"));
    }
}

#[test]
fn shipped_files_are_free_of_mistakes() {
    for folder in ["examples", "stdlib"] {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        for entry in std::fs::read_dir(folder).expect("a folder of the project") {
            let path = entry.expect("a readable folder").path();
            if path.extension().is_some_and(|extension| extension == "lss") {
                let text = std::fs::read_to_string(&path).expect("a readable file");
                if read(&text).1.is_empty() {
                    check_formatting(&text, &clean(&text));
                } else {
                    assert!(path.ends_with("examples/errors.lss"), "{}", path.display());
                }
            }
        }
    }
}

/// Layouts put together from lines of the corpus, at random places, with odd spacing.
fn shuffled() -> impl Strategy<Value = String> {
    let lines: Vec<String> = EVERYTHING
        .lines()
        .chain(TERMINAL.lines())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   ") && line.trim().len() > 1)
        .filter(|line| read(&format!("layout a {{\n{line}\n}}")).1.is_empty())
        .map(str::to_string)
        .collect();
    let line = prop_oneof![
        6 => (prop::sample::select(lines), "[ \t]{0,3}", prop::option::of(" ?// ?[a-z\"]{0,90}"))
            .prop_map(|(line, space, comment)| match comment {
                Some(comment) if !line.contains("//") => format!("{space}{line}{comment}"),
                _ => format!("{space}{line}"),
            }),
        1 => Just(String::new()),
        1 => "//[ -~]{0,20}",
        1 => list(),
    ];
    (prop::collection::vec(line, 0..12), prop::bool::ANY).prop_map(|(lines, crlf)| {
        let text = format!("layout a {{\n{}\n}}", lines.join("\n"));
        if crlf { text.replace('\n', "\r\n") } else { text }
    })
}

/// Nested lists with comments and line breaks wherever they may stand.
fn list() -> impl Strategy<Value = String> {
    let gap = || {
        prop_oneof![
            4 => Just(""), 2 => Just(" "), 1 => Just("\n"), 1 => Just("\n\n"),
            1 => Just(" // c\n"), 1 => Just("\n// d\n\n// e\n")
        ]
    };
    let leaf = prop_oneof![
        Just("1 m".to_string()),
        Just("\"// \\\" text\"".to_string()),
        "[a-z]{1,50}".prop_map(|name| format!("{name}_"))
    ];
    let nested = leaf.prop_recursive(4, 24, 6, move |inner| {
        (prop::collection::vec((gap(), inner), 0..6), gap(), prop::bool::ANY, prop::bool::ANY).prop_map(
            |(items, last, comma, call)| {
                let items: Vec<String> = items.into_iter().map(|(gap, item)| format!("{gap}{item}")).collect();
                let comma = if comma && !items.is_empty() { "," } else { "" };
                let (open, close) = if call { ("f(", ")") } else { ("[", "]") };
                format!("{open}{}{comma}{last}{close}", items.join(","))
            },
        )
    });
    nested.prop_map(|value| format!("let v = {value}"))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_never_panic(which in 0..CORPUS.len(), damages in prop::collection::vec(damage(), 1..12)) {
        let mut text = CORPUS[which].to_string();
        for damage in &damages {
            apply(&mut text, damage);
        }
        let (tree, problems) = read(&text);
        for problem in &problems {
            let labels = problem.related.iter().map(|label| label.span).chain([problem.label.span]);
            for span in labels.chain(problem.fix.as_ref().map(|fix| fix.span)) {
                prop_assert!(text.get(span.start as usize..span.end as usize).is_some(), "{problem:?}");
            }
        }
        if problems.is_empty() {
            check_formatting(&text, &tree);
        } else {
            format(&tree, &text);
        }
        let bad = format!("{tree:?}").contains("Bad");
        prop_assert!(!bad || !problems.is_empty(), "something did not parse and nothing was said");
    }

    #[test]
    fn formatting_keeps_everything(text in shuffled()) {
        check_formatting(&text, &clean(&text));
    }

    #[test]
    fn arbitrary_text_never_panics(text in "[ -~\n°²]{0,200}|\\PC{0,60}") {
        let (tree, _) = read(&text);
        format(&tree, &text);
    }
}
