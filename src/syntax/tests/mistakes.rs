//! Messages about broken files.

use super::*;
use crate::diagnostic::Code;

fn messages(text: &str) -> String {
    shown(text, &read(text).1)
}

/// The one mistake of a line of a layout.
fn one(line: &str) -> String {
    let text = format!("layout a {{\n{line}\n}}\n");
    let problems = read(&text).1;
    let message = shown(&text, &problems);
    assert_eq!(problems.len(), 1, "{line}: {message}");
    message
}

#[test]
fn one_run_reports_every_mistake() {
    insta::assert_snapshot!(messages(include_str!("corpus/mistakes.lss")));
}

#[test]
fn an_unclosed_brace_points_at_its_opener() {
    let text = "layout a {\n  speed 1 m/s\n\nlayout b {\n  cart c(length: 3 m\n  speed\n}\n";
    insta::assert_snapshot!(messages(text));
}

#[test]
fn the_rest_of_a_file_is_read_after_a_forgotten_bracket() {
    for broken in [
        "speed (1 m/s",
        "building [(0 m, 0 m), (1 m, 1 m)",
        "building [\n (0 m, 0 m),\n (1 m, 1 m),",
        "cart c(\n a: 1,",
    ] {
        let text = format!("layout a {{\n  {broken}\n  width 2 m\n  fix\n  width 3 m\n}}\n");
        let (tree, problems) = read(&text);
        let codes: Vec<Code> = problems.iter().map(|problem| problem.code).collect();
        assert_eq!(codes, [Code::E0103, Code::E0101], "{}", shown(&text, &problems));
        let written = format(&tree, &text);
        assert!(written.contains("  width 2 m\n") && written.contains("  width 3 m\n"), "{written}");
    }
}

/// One word of several that could have stood there is not put before it.
#[test]
fn a_choice_of_what_cannot_be_chosen_names_what_can() {
    let message = one("choose wheel x");
    assert!(message.contains("`motor`, `radii`, `sensor`, `speed` or `take_up`, found `wheel`"), "{message}");
}

/// What stands freely is as many as `at least` says; a capacity is of an hour.
#[test]
fn what_equipment_and_capacity_take_is_told() {
    let chutes = |rest: &str| one(&format!("chutes row_a of chute {rest}"));
    assert!(chutes("anywhere").contains("say how many: `at least 10 anywhere`"), "{}", chutes("anywhere"));
    assert!(chutes("at least 4 at most 10 anywhere").contains("leave `at most` out"));
    for line in ["require capacity <= 500 per hour", "require capacity >= 100 per min"] {
        assert!(one(line).contains("`require capacity >= 7000 per hour`"), "{}", one(line));
    }
    // One mistake with its fix, not a row of them.
    assert!(chutes("at most 10 anywhere").contains("did you mean `least`?"), "{}", chutes("at most 10 anywhere"));
    assert!(chutes("at least 4 at most 10 anywhere").contains("`choose count row_a 8 .. 16 step 4`"));
}

#[test]
fn fixes_lead_to_a_clean_file() {
    for line in [
        "vertx P1 (1 m, 2 m)",
        "Vertex P1 (1 m, 2 m)",
        "vertex P1 (1 m 2 m)",
        "vertex P1 (1 m, 2 m) 4 m",
        "vertex P1 (1 m, 2 m) raduis 4 m",
        "vertex P1 (1 m, 2 m",
        "vertex P1 (1 m, 2 m))",
        "speed 2 m/s;",
        "speed .5 m/s",
        "speed 5. m/s",
        "speed 2 m2/s",
        "speed 3 N·m",
        "fix lenght P1..P2",
        "fix length P1-P2",
        "fix length P1 P2",
        "start on P1..P2 3 m",
        "start no P1..P2 at 3 m",
        "motors 13 evnly",
        "optimise lenght",
        "optimise 2 * lenght",
        "pass c leftt",
        "let a 3 m",
        "let a := 3 m",
        "cart c(length = 3 m)",
        "require x(P1) = 2 m",
        "require x(P1) => 2 m",
        "require x(P1) >= 2 m \"why",
        "width 3 × 2 m",
        "width 3 – 2 m",
        "building [(0 m, 0 m)\n(1 m, 1 m)]",
        "building [(0 m, 0 m) (1 m, 1 m)]",
        "chain closes wihtin 3 mm",
        "mirror P1, P2 abuot x = 3 m",
    ] {
        let mut text = format!("layout a {{\n{line}\n}}\n");
        let problems = read(&text).1;
        let [problem] = &problems[..] else { panic!("{line}: {}", shown(&text, &problems)) };
        let Some(fix) = &problem.fix else { panic!("no fix: {}", shown(&text, &problems)) };
        text.replace_range(fix.span.start as usize..fix.span.end as usize, &fix.replacement);
        clean(&text);
    }
}

#[test]
fn numbers_and_words_that_are_none() {
    for number in ["NaN", "inf", "1e999", "0x1F", "1e", "1e+", ".5", "5."] {
        assert!(one(&format!("width {number} m")).contains("E0108") || number.starts_with(char::is_alphabetic));
        assert!(one(&format!("width {number}")).contains("E0108"), "{number}");
    }
    assert!(messages("let a = \"\\n\"").contains("E0111"));
}

#[test]
fn what_was_expected_is_said_in_the_words_of_the_line() {
    for (line, expected) in [
        ("vertex P1 (1 m, 2 m) radius", "a length such as `4 m`"),
        ("vertex P1", "a point such as `(28 m, 1.5 m)`"),
        ("vertex", "a name such as `P1`"),
        ("speed", "a speed such as `2 m/s`"),
        ("turns 5 deg ..", "an angle such as `5 deg`"),
        ("chutes r on P7..P8 from 2 m every 1 m count", "a count such as `12`"),
        ("chain tension", "a force such as `500 N`"),
        ("fix length,", "`length`, `rotation`, `parallel`, `perpendicular` or `all`"),
        ("level", "a section such as `P4..P5`"),
        ("pass c", "`left`, `right` or `either`"),
        ("require 3 m", "one of `<`, `<=`, `==`, `>=`, `>`"),
        ("building", "a list of points such as"),
        ("mirror P1, P2 about", "`x` or `y`"),
        ("optimise", "`length`, `cost`, `total_price`, `polygon_action` or `nothing`"),
        ("ramp P1..P2 slope", "a ratio such as `0.14`"),
        ("effect", "a name such as"),
        ("effect a b", "the end of the line"),
        ("motors", "a count such as `12`"),
        ("chain", "`closes` or `tension`"),
    ] {
        let message = one(line);
        assert!(message.contains(&format!("expected {expected}")), "{line}: {message}");
    }
}
