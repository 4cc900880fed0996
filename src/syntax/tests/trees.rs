//! What the tree says about chosen texts.

use super::*;
use crate::syntax::tree::*;

/// An expression in full parentheses.
fn expression(expr: &Expr) -> String {
    match &expr.kind {
        ExprKind::Number { digits, unit: None } => digits.clone(),
        ExprKind::Number { digits, unit: Some(unit) } => format!("{digits}_{}", unit.text),
        ExprKind::Text(text) => format!("{text:?}"),
        ExprKind::Name(name) => name.clone(),
        ExprKind::Call { name, args } => {
            let args: Vec<String> = args
                .iter()
                .map(|arg| match &arg.name {
                    Some(name) => format!("{}: {}", name.text, expression(&arg.value)),
                    None => expression(&arg.value),
                })
                .collect();
            format!("{}<{}>", name.text, args.join(", "))
        }
        ExprKind::Negative(operand) => format!("neg({})", expression(operand)),
        ExprKind::Sum { first, rest } => {
            let rest: Vec<String> = rest.iter().map(|(op, e)| format!("{op:?} {}", expression(e))).collect();
            format!("sum({} {})", expression(first), rest.join(" "))
        }
        ExprKind::Product { first, rest } => {
            let rest: Vec<String> = rest.iter().map(|(op, e)| format!("{op:?} {}", expression(e))).collect();
            format!("product({} {})", expression(first), rest.join(" "))
        }
        ExprKind::Paren(inner) => format!("({})", expression(inner)),
        ExprKind::List(elements) => format!("[{}]", elements.iter().map(expression).collect::<Vec<_>>().join(", ")),
        ExprKind::Tuple(elements) => {
            format!("tuple({})", elements.iter().map(expression).collect::<Vec<_>>().join(", "))
        }
        ExprKind::Range { low, high, step } => {
            let step = step.as_ref().map_or(String::new(), |step| format!(" by {}", expression(step)));
            format!("{{{} to {}{step}}}", expression(low), expression(high))
        }
    }
}

fn value(text: &str) -> String {
    let tree = clean(&format!("let a = {text}"));
    match tree.items.iter().next() {
        Some(Item::Let(line)) => expression(&line.value),
        other => panic!("{other:?}"),
    }
}

/// A part of the tree on one line, without spans and empty comments.
fn line(part: &impl std::fmt::Debug) -> String {
    let mut text = format!("{part:?}");
    while let Some(start) = text.find("Span {") {
        let end = text[start..].find('}').map_or(text.len(), |end| start + end + 1);
        let field = text[..start].trim_end_matches(|c: char| c.is_alphabetic() || c == '_' || c == ':' || c == ' ');
        let from = field.trim_end_matches(',').len();
        text.replace_range(from..end, "");
    }
    for empty in [
        ", beside: None",
        "above: [], ",
        "blank_before: false, ",
        ", tail: []",
        ", beside_open: None",
        ", multiline: false",
    ] {
        text = text.replace(empty, "");
    }
    text
}

#[test]
fn every_statement_has_its_tree() {
    let tree = clean(EVERYTHING);
    let mut lines = Vec::new();
    for item in tree.items.iter() {
        match item {
            Item::Layout(layout) => {
                lines.push(format!("layout {:?} {} {}", layout.name.text, line(&layout.params), line(&layout.from)));
                lines.extend(layout.body.iter().map(|statement| format!("  {}", line(statement))));
            }
            other => lines.push(line(other)),
        }
    }
    insta::assert_snapshot!(lines.join("\n"));
}

#[test]
fn expressions_have_the_usual_precedence() {
    for (text, meaning) in [
        ("1 + 2 * 3", "sum(1 Plus product(2 Times 3))"),
        ("(1 + 2) * 3", "product((sum(1 Plus 2)) Times 3)"),
        ("1 - 2 - 3", "sum(1 Minus 2 Minus 3)"),
        ("8 / 2 / 2", "product(8 Divide 2 Divide 2)"),
        ("-a * -b", "product(neg(a) Times neg(b))"),
        ("- - 2 m", "neg(neg(2_m))"),
        ("2m/s", "2_m/s"),
        ("2 m/s", "2_m/s"),
        ("2 m / s", "product(2_m Divide s)"),
        ("2 m*2", "product(2_m Times 2)"),
        ("4 kg*m^2", "4_kg*m^2"),
        ("5 N/m^1.5", "5_N/m^1.5"),
        ("3 s^-1", "3_s^-1"),
        ("0.5 %", "0.5_%"),
        ("20 °C", "20_°C"),
        ("1e-3 m", "1e-3_m"),
        ("4.0e7", "4.0e7"),
        ("2eur", "2_eur"),
        ("1_000", "1_000"),
        ("1..2", "{1 to 2}"),
        ("1 m..2 m step 5 mm", "{1_m to 2_m by 5_mm}"),
        ("1+1..2*2", "{sum(1 Plus 1) to product(2 Times 2)}"),
        ("[P1..P2, (1, 2), \"a\\\"b\"]", "[{P1 to P2}, tuple(1, 2), \"a\\\"b\"]"),
        ("f(x, y: 2 m,)", "f<x, y: 2_m>"),
        ("f()", "f<>"),
        ("radius(radius)", "radius<radius>"),
        ("1 // m", "1"),
    ] {
        assert_eq!(value(text), meaning, "{text}");
    }
}

#[test]
fn keywords_are_names_where_names_stand() {
    let text = "layout layout(from: 1) from from(from: from) {\n  vertex vertex (x, y) radius radius\n  fix radius\n  \
                fix radius length\n  fix all all..length\n  fix all\n  pass left left\n  \
                induction on on on..at at at\n  \
                let let = let\n  ramp from..slope from from slope slope radius radius\n  motors evenly evenly\n}\n";
    assert_eq!(formatted(text), text);
    let tree = clean(text);
    let Some(Item::Layout(layout)) = tree.items.iter().next() else { panic!() };
    let statements: Vec<&Statement> = layout.body.iter().collect();
    assert!(matches!(statements[1], Statement::FixVertex { vertex } if vertex.text == "radius"));
    assert!(matches!(statements[2], Statement::FixRadius { vertex } if vertex.text == "length"));
    assert!(matches!(statements[3], Statement::FixSection { target, .. } if target.section.to.text == "length"));
    assert!(matches!(statements[4], Statement::FixVertex { vertex } if vertex.text == "all"));
}

#[test]
fn spans_cover_what_was_written() {
    let tree = clean(EVERYTHING);
    let text = |span: crate::source::Span| &EVERYTHING[span.start as usize..span.end as usize];
    let Some(Item::Layout(layout)) = tree.items.iter().find(|item| matches!(item, Item::Layout(_))) else { panic!() };
    assert_eq!(text(layout.name.span), "terminal_3");
    assert!(text(layout.span).starts_with("layout terminal_3(") && text(layout.span).ends_with('}'));
    for node in &layout.body.nodes {
        match &node.value {
            Statement::Vertex { name, point, .. } if name.text == "P1" => {
                assert_eq!(text(node.span), "vertex P1 (2.0 m, 1.5 m) radius 4 m");
                assert_eq!(text(point.span), "(2.0 m, 1.5 m)");
                assert_eq!(text(point.y.span), "1.5 m");
                assert_eq!(node.above.len(), 3);
            }
            Statement::Ramp { section, slope: Some(slope), .. } => {
                assert_eq!((text(section.span), text(slope.span)), ("P3..P4", "0.14"));
            }
            Statement::FixSection { target, kinds } if target.straight => {
                assert_eq!(text(target.span), "straight(P4..P5)");
                assert_eq!(text(kinds[1].1), "rotation");
            }
            Statement::Speed(_) => assert_eq!(node.beside.as_deref(), Some("// beside a statement")),
            _ => {}
        }
    }
    assert_eq!(layout.body.tail, ["// tail of the layout"]);
    assert_eq!(tree.items.tail, ["// tail of the file"]);
}

#[test]
fn a_mended_line_keeps_the_spans_of_what_was_written() {
    let text = "layout a {\n  vertx P1 (1 m 25 m) raduis 3 m\n}\n";
    let (tree, problems) = read(text);
    assert_eq!(problems.len(), 3);
    let Some(Item::Layout(layout)) = tree.items.iter().next() else { panic!() };
    let Some(Statement::Vertex { name, point, radius: Some(radius) }) = layout.body.iter().next() else { panic!() };
    let written = |span: crate::source::Span| &text[span.start as usize..span.end as usize];
    assert_eq!(written(name.span), "P1");
    assert_eq!(written(point.span), "(1 m 25 m)");
    assert_eq!(written(point.y.span), "25 m");
    assert_eq!(written(radius.span), "3 m");
}
