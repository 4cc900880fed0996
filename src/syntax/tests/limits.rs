//! Hostile input: it has to end in a diagnostic, quickly and without a panic.

use super::*;
use crate::diagnostic::Code;
use crate::syntax::{MAX_BYTES, MAX_DEPTH, MAX_REPORTS};
use std::time::{Duration, Instant};

/// Generous, because tests run unoptimised and side by side; a quadratic step takes minutes on these inputs.
const SOON: Duration = Duration::from_secs(20);

fn quickly(text: &str) -> Vec<Diagnostic> {
    let start = Instant::now();
    let (tree, problems) = read(text);
    format(&tree, text);
    assert!(start.elapsed() < SOON, "took {:?}", start.elapsed());
    for problem in &problems {
        let length = problem.message.len() + problem.help.as_ref().map_or(0, String::len);
        assert!(length < 1000, "a message of {length} bytes");
    }
    problems
}

fn codes(problems: &[Diagnostic]) -> Vec<Code> {
    problems.iter().map(|problem| problem.code).collect()
}

#[test]
fn brackets_may_nest_to_the_limit_and_no_deeper() {
    for (open, close) in [("(", ")"), ("[", "]"), ("f(", ")"), ("-(", ")")] {
        let nested = |depth: usize| format!("let a = {}1{}", open.repeat(depth), close.repeat(depth));
        assert_eq!(codes(&quickly(&nested(MAX_DEPTH))), [], "{open}");
        assert_eq!(codes(&quickly(&nested(MAX_DEPTH + 1))), [Code::E0105], "{open}");
        assert_eq!(codes(&quickly(&nested(100_000))), [Code::E0105], "{open}");
        assert_eq!(codes(&quickly(&format!("let a = {}", open.repeat(100_000)))), [Code::E0105], "{open}");
    }
    let groups = format!("cart a {{ {} {}\n}}", "g {\n".repeat(MAX_DEPTH - 1), "}\n".repeat(MAX_DEPTH - 1));
    assert_eq!(codes(&quickly(&groups)), []);
}

#[test]
fn signs_do_not_nest_the_tree_without_bounds() {
    assert_eq!(codes(&quickly(&format!("let a = {}1", "-".repeat(MAX_DEPTH)))), []);
    assert_eq!(codes(&quickly(&format!("let a = {}1", "-".repeat(1_000_000)))), [Code::E0105]);
}

#[test]
fn a_file_of_more_than_the_limit_is_not_read() {
    assert_eq!(codes(&quickly(&"// x\n".repeat(MAX_BYTES / 5 + 1))), [Code::E0106]);
}

#[test]
fn megabytes_on_a_line_are_quick() {
    let points = "(1 m, 2 m), ".repeat(100_000);
    assert_eq!(codes(&quickly(&format!("layout a {{ building [{points}] }}"))), []);
    assert_eq!(codes(&quickly(&format!("let a = 1{}", " + 1 m".repeat(200_000)))), []);
    // And broken ones: at the end, in the middle, everywhere.
    assert_eq!(codes(&quickly(&format!("layout a {{ building [{points} 3] }}"))), [Code::E0101]);
    assert_eq!(codes(&quickly(&format!("layout a {{ building [{points} (1 m 2 m), {points}] }}"))), [Code::E0101]);
    assert_eq!(codes(&quickly(&"x".repeat(2_000_000))), [Code::E0102]);
    assert_eq!(codes(&quickly(&"1 ".repeat(1_000_000))), [Code::E0101]);
    assert_eq!(codes(&quickly(&format!("let a = {}", "9".repeat(2_000_000)))), [Code::E0108]);
    assert_eq!(codes(&quickly(&format!("let a = \"{}", "x".repeat(2_000_000)))), [Code::E0104]);
    assert_eq!(codes(&quickly(&format!("let a = 1 {}", "m*".repeat(1_000_000)))), [Code::E0101]);
}

#[test]
fn reports_are_capped() {
    for line in ["vertx P1\n", "speed\n", "speed (1\n", "speed )\n", "speed \"\n", "speed 1 m\0/s\n", "speed .5 m/s\n"]
    {
        let problems = quickly(&format!("layout a {{\n{}}}\n", line.repeat(20_000)));
        assert_eq!(problems.len(), MAX_REPORTS + 1, "{line}");
        assert_eq!(problems.last().map(|problem| problem.code), Some(Code::E0112));
    }
    let nothing = quickly(&"vertex P1 (1 m, 2 m)\n".repeat(10_000));
    assert_eq!(codes(&nothing), [Code::E0102], "statements without a layout are one mistake");
}

#[test]
fn characters_that_show_nothing_are_reported_and_skipped() {
    let text = "let a\u{A0}= 1 m\0\0\0\nlet b = 2\u{200B} m // \u{202E}note\nlet c = \"\u{7}\"\n";
    let problems = quickly(text);
    insta::assert_snapshot!(shown(text, &problems));
    let (tree, _) = read(text);
    assert_eq!(format(&tree, text), "let a = 1 m\nlet b = 2 m // note\nlet c = \"\"\n");
}

#[test]
fn a_byte_order_mark_and_both_line_ends_are_accepted() {
    let text = "\u{FEFF}// head\r\nlet a = 1 m // b\r\n\r\nlet c = \"d\"\r\n";
    // Lines end as most of the text do.
    assert_eq!(formatted(text), "// head\r\nlet a = 1 m // b\r\n\r\nlet c = \"d\"\r\n");
    assert_eq!(formatted("let a=1 m\r\nlet b = 2 m\nlet c = 3 m\n"), "let a = 1 m\nlet b = 2 m\nlet c = 3 m\n");
    assert_eq!(formatted(""), "");
    assert_eq!(formatted("\r\n\n"), "");
    assert_eq!(formatted("// only"), "// only\n");
}

#[test]
fn ten_thousand_lines_are_quick() {
    let mut text = String::from("layout big {\n");
    for i in 0..2_500 {
        text.push_str(&format!("  vertex P{i} ({i}.5 m, -3.25 m) radius 4 m // note\n"));
        text.push_str(&format!("  fix length, rotation P{i}..P{}\n", i + 1));
        text.push_str(&format!("  obstacle o{i} [(9 m, 4 m), (10 m, 4 m), (10 m, 5 m), (9 m, 5 m)] clearance 0.3 m\n"));
        text.push_str(&format!("  require length(P{i}..P{}) >= 18 m \"the wall\"\n", i + 1));
    }
    text.push_str("}\n");
    let start = Instant::now();
    assert_eq!(codes(&read(&text).1), []);
    println!("parsed in {:?}", start.elapsed());
    assert_eq!(codes(&quickly(&text)), []);
}
