//! The drawing of every example beside its bill: the same articles, as many of each; and what climbs says so.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::compiled::Compiled;
use lss::emit::svg::{Theme, drawing};
use lss::semantics::analyse;
use lss::solve::{Options, solve};
use lss::source::{Loader, SourceMap};
use std::collections::BTreeMap;
use std::path::Path;

/// Every example but the ones in which something is wrong on purpose.
const EXAMPLES: [&str; 9] =
    ["constraints", "even", "hub", "levels", "reference", "smallest", "spiral", "thesis10", "written"];

fn compiled(name: &str) -> Compiled {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(format!("{name}.lss"));
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::open(&mut sources, &path).expect("an example");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    let layout = analysis.chosen().expect("one layout").expect("no mistakes").clone();
    // Two of them take long to prove, which changes nothing here.
    let mut options = Options::default();
    options.effort.nodes = 50;
    Compiled::new(layout.clone(), solve(&layout, &options, &|_| {}))
}

/// What each text element of a drawing says.
fn texts(svg: &str) -> Vec<String> {
    let parts = svg.split("<text").skip(1).filter_map(|part| part.split_once('>')?.1.split_once("</text>"));
    parts.map(|(text, _)| text.to_owned()).collect()
}

#[test]
fn labels_count_what_the_bill_counts() {
    for name in EXAMPLES {
        let compiled = compiled(name);
        let svg = drawing(&compiled, Theme::Light).expect("drawn");
        let mut billed: BTreeMap<String, usize> = BTreeMap::new();
        for line in &compiled.bill.lines {
            *billed.entry(line.article.clone()).or_default() += line.count;
        }
        let mut labelled: BTreeMap<String, usize> = BTreeMap::new();
        for text in texts(&svg) {
            let (count, article) = text.split_once("× ").unwrap_or(("1", &text));
            if billed.contains_key(article) {
                *labelled.entry(article.to_owned()).or_default() += count.parse::<usize>().expect("a count");
            }
        }
        assert_eq!(labelled, billed, "{name}");
    }
}

#[test]
fn ramps_levels_and_spirals_are_marked_in_the_plan() {
    let svg = drawing(&compiled("spiral"), Theme::Light).expect("drawn");
    let marks = texts(&svg);
    for mark in ["level 0.5 m", "level 2 m", "ramp down 14 %: 2 → 0.5 m", "spiral R4 90°"] {
        assert!(marks.iter().any(|text| text == mark), "{mark} in {marks:?}");
    }
    assert!(marks.iter().any(|text| text.starts_with("ramp with spiral up ")), "{marks:?}");
    let svg = drawing(&compiled("levels"), Theme::Light).expect("drawn");
    let marks = texts(&svg);
    for mark in ["level 2.6 m", "level 1 m", "ramp up 14 %: 1 → 2.6 m", "ramp down 10 %: 2.6 → 1 m"] {
        assert!(marks.iter().any(|text| text == mark), "{mark} in {marks:?}");
    }
    let svg = drawing(&compiled("written"), Theme::Light).expect("drawn");
    assert!(!texts(&svg).iter().any(|text| text.starts_with("ramp ") || text.starts_with("level ")));
}
