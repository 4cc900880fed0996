//! The formatter on chosen files; `properties` has it on arbitrary ones.

use super::*;

#[test]
fn everything_is_laid_out_in_one_way() {
    insta::assert_snapshot!(formatted(EVERYTHING));
}

#[test]
fn columns_become_single_spaces() {
    insta::assert_snapshot!(formatted(TERMINAL));
}

#[test]
fn wide_lists_are_spread_and_narrow_ones_stay() {
    let points: Vec<String> = (0..9).map(|i| format!("({i}.25 m, 1{i}.75 m)")).collect();
    let text = format!(
        "layout a(first: 1 m,\nsecond: 2 m) {{\n  obstacle wide [{}]\n  obstacle chosen [\n(1 m, 2 m), (2 m, 3 m)]\n  \
         obstacle narrow [(1 m, 2 m), ]\n  require length(P1..P2) + length(P2..P3) + length(P3..P4) + length(P4..P5) + \
         length(P5..P6) + length(P6..P7) >= 1 m\n}}\n",
        points.join(", ")
    );
    insta::assert_snapshot!(formatted(&text));
}

#[test]
fn lines_that_did_not_parse_are_taken_over() {
    let text = "layout a {\n  speed    2 m/s\n  vertex  1 (  2 m) // why\n  width 1m\n}\n";
    let (tree, _) = read(text);
    assert_eq!(format(&tree, text), "layout a {\n  speed 2 m/s\n  vertex  1 (  2 m) // why\n  width 1 m\n}\n");
}

#[test]
fn blank_lines_are_kept_but_never_two_and_never_at_an_edge() {
    let text = "\n\n// a\n\n\n\n// b\n\nlet c = 1\n\n\nlayout d {\n\n  speed 1 m/s\n\n\n  // e\n\n}\n\n\n";
    assert_eq!(formatted(text), "// a\n\n// b\n\nlet c = 1\n\nlayout d {\n  speed 1 m/s\n\n  // e\n}\n");
    assert_eq!(formatted("layout a { // b\n\n\n  // c\n\n}"), "layout a { // b\n  // c\n}\n");
    assert_eq!(formatted("layout a\n\n{\n}\nlayout b from a\n\n\n{ }"), "layout a {}\nlayout b from a {}\n");
}
