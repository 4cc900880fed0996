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
            // What found no room is listed with its place.
            let text = text.split_once(" at (").map_or(text.as_str(), |(text, _)| text);
            let (count, article) = text.split_once("× ").unwrap_or(("1", text));
            if billed.contains_key(article) {
                *labelled.entry(article.to_owned()).or_default() += count.parse::<usize>().expect("a count");
            }
        }
        assert_eq!(labelled, billed, "{name}");
    }
}

#[test]
fn the_legend_shows_equipment_as_the_plan_has_it() {
    let legend = |name: &str| {
        let svg = drawing(&compiled(name), Theme::Light).expect("drawn");
        texts(svg.split_once("class=\"legend\"").expect("a legend").1)
    };
    let (with, without) = (legend("equipment"), legend("hub"));
    for kind in ["induction", "chute: row, count", "scanner, gate or lift"] {
        let covers = format!("{kind}, with its footprint");
        assert!(with.contains(&covers) && !with.iter().any(|text| text == kind), "{kind}: {with:#?}");
        assert!(!without.contains(&covers), "{without:#?}");
    }
    let conveyor = "conveyor, from where items come".to_owned();
    assert!(with.contains(&conveyor) && !without.contains(&conveyor));
    assert!(without.iter().any(|text| text == "induction"), "{without:#?}");
}

#[test]
fn ramps_levels_and_spirals_are_marked_in_the_plan() {
    let svg = drawing(&compiled("spiral"), Theme::Light).expect("drawn");
    let marks = texts(&svg);
    for mark in ["level 0.5 m", "level 2.0 m", "ramp down 14.00 %: 2.0 → 0.5 m", "spiral R4 90°"] {
        assert!(marks.iter().any(|text| text == mark), "{mark} in {marks:?}");
    }
    assert!(marks.iter().any(|text| text.starts_with("ramp with spiral up ")), "{marks:?}");
    let svg = drawing(&compiled("levels"), Theme::Light).expect("drawn");
    let marks = texts(&svg);
    for mark in ["level 2.6 m", "level 1.0 m", "ramp up 14 %: 1.0 → 2.6 m", "ramp down 10 %: 2.6 → 1.0 m"] {
        assert!(marks.iter().any(|text| text == mark), "{mark} in {marks:?}");
    }
    let svg = drawing(&compiled("written"), Theme::Light).expect("drawn");
    assert!(!texts(&svg).iter().any(|text| text.starts_with("ramp ") || text.starts_with("level ")));
}

/// A rectangle on paper, turned: middle, half its sides, unit vector along it.
struct TextBox {
    text: String,
    middle: (f64, f64),
    half: (f64, f64),
    along: (f64, f64),
}

impl TextBox {
    /// Points all over the box, inside of its edge by a hundredth of a millimetre.
    fn dots(&self) -> Vec<(f64, f64)> {
        let part = |k: usize, n: usize| 2.0 * k as f64 / n as f64 - 1.0;
        let columns = (2.0 * self.half.0 / 0.4).ceil() as usize;
        let mut dots = Vec::new();
        for i in 0..=columns {
            for j in 0..=8 {
                let (u, v) = (part(i, columns) * (self.half.0 - 0.01), part(j, 8) * (self.half.1 - 0.01));
                let (x, y) = self.along;
                dots.push((self.middle.0 + u * x - v * y, self.middle.1 + u * y + v * x));
            }
        }
        dots
    }

    fn holds(&self, (x, y): (f64, f64)) -> bool {
        let (dx, dy) = (x - self.middle.0, y - self.middle.1);
        let (ax, ay) = self.along;
        (dx * ax + dy * ay).abs() < self.half.0 && (dy * ax - dx * ay).abs() < self.half.1
    }
}

/// Every text as usvg lays it out with the font of the drawings, mm.
fn boxes(svg: &str) -> Vec<TextBox> {
    use resvg::usvg::{Group, Node, Options, Tree, fontdb::Database};
    fn walk(group: &Group, found: &mut Vec<TextBox>) {
        for node in group.children() {
            match node {
                Node::Group(group) => walk(group, found),
                Node::Text(text) => {
                    let mm = 25.4 / 96.0;
                    let bounds = text.bounding_box();
                    let at = |x: f32, y: f32| {
                        let mut p = tiny_skia::Point::from_xy(x, y);
                        text.abs_transform().map_point(&mut p);
                        (f64::from(p.x) * mm, f64::from(p.y) * mm)
                    };
                    let (a, b) = (at(bounds.left(), bounds.top()), at(bounds.right(), bounds.top()));
                    let c = at(bounds.left(), bounds.bottom());
                    let distance =
                        |p: (f64, f64), q: (f64, f64)| ((q.0 - p.0) * (q.0 - p.0) + (q.1 - p.1) * (q.1 - p.1)).sqrt();
                    let (wide, tall) = (distance(a, b), distance(a, c));
                    found.push(TextBox {
                        text: text.chunks().iter().map(|chunk| chunk.text()).collect(),
                        middle: ((b.0 + c.0) / 2.0, (b.1 + c.1) / 2.0),
                        half: (wide / 2.0, tall / 2.0),
                        along: ((b.0 - a.0) / wide, (b.1 - a.1) / wide),
                    });
                }
                _ => {}
            }
        }
    }
    let mut fonts = Database::new();
    fonts.load_font_data(include_bytes!("../../src/emit/fonts/DejaVuSans-subset.ttf").to_vec());
    fonts.load_font_data(include_bytes!("../../src/emit/fonts/DejaVuSans-Bold-subset.ttf").to_vec());
    let options = Options { fontdb: std::sync::Arc::new(fonts), ..Options::default() };
    let tree = Tree::from_str(svg, &options).expect("well-formed");
    let mut found = Vec::new();
    walk(tree.root(), &mut found);
    found
}

/// Data of the paths of a class.
fn paths<'a>(svg: &'a str, class: &'a str) -> impl Iterator<Item = &'a str> {
    let mark = format!("<path class=\"{class}\" d=\"");
    svg.match_indices(&mark)
        .map(|(at, mark)| svg[at + mark.len()..].split('"').next().expect("closed"))
        .collect::<Vec<_>>()
        .into_iter()
}

/// Rings of straight lines: `M1 2L3 4L5 6Z`.
fn rings(data: &str) -> Vec<Vec<(f64, f64)>> {
    let point = |text: &str| {
        let (x, y) = text.split_once(' ').expect("two coordinates");
        (x.parse().expect("a number"), y.parse().expect("a number"))
    };
    let rings = data.split('M').filter(|ring| !ring.is_empty());
    rings.map(|ring| ring.trim_end_matches('Z').split('L').map(point).collect()).collect()
}

/// Even-odd rule over all rings.
fn covers(rings: &[Vec<(f64, f64)>], (x, y): (f64, f64)) -> bool {
    let mut inside = false;
    for ring in rings {
        for i in 0..ring.len() {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            if (a.1 > y) != (b.1 > y) && x < a.0 + (y - a.1) / (b.1 - a.1) * (b.0 - a.0) {
                inside = !inside;
            }
        }
    }
    inside
}

fn distance_to_ring(ring: &[(f64, f64)], (x, y): (f64, f64)) -> f64 {
    let of = |i: usize| {
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let t = (((x - a.0) * dx + (y - a.1) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        let (px, py) = (a.0 + t * dx - x, a.1 + t * dy - y);
        (px * px + py * py).sqrt()
    };
    (0..ring.len()).map(of).fold(f64::INFINITY, f64::min)
}

#[test]
fn no_label_is_on_hatching_or_another_label_and_no_leaders_cross() {
    let (mut leaders, mut hatched) = (0, 0);
    for name in EXAMPLES {
        let svg = drawing(&compiled(name), Theme::Light).expect("drawn");
        let texts = boxes(&svg);
        let obstacles: Vec<_> = paths(&svg, "obstacle-hatch").map(rings).collect();
        // The legend has a wall, too, as a line.
        let walls: Vec<_> = paths(&svg, "wall").map(rings).filter(|rings| rings[0].len() > 2).collect();
        hatched += obstacles.len();
        for (i, item) in texts.iter().enumerate() {
            for dot in item.dots() {
                assert!(obstacles.iter().all(|rings| !covers(rings, dot)), "{name}: `{}` on an obstacle", item.text);
                for rings in &walls {
                    let on = !covers(rings, dot) && distance_to_ring(&rings[0], dot) < 1.8;
                    assert!(!on, "{name}: `{}` on a wall", item.text);
                }
                for other in &texts[..i] {
                    assert!(!other.holds(dot), "{name}: `{}` over `{}`", item.text, other.text);
                }
            }
        }
        let lines: Vec<_> = paths(&svg, "leader").map(|data| rings(data).remove(0)).collect();
        leaders += lines.len();
        let side = |p: (f64, f64), q: (f64, f64), r: (f64, f64)| (q.0 - p.0) * (r.1 - p.1) - (q.1 - p.1) * (r.0 - p.0);
        for (i, a) in lines.iter().enumerate() {
            for b in &lines[..i] {
                let beside = |k: fn((f64, f64)) -> f64| {
                    let ends = |line: &[(f64, f64)]| {
                        let (p, q) = (k(line[0]), k(line[1]));
                        (p.min(q), p.max(q))
                    };
                    ends(a).0 > ends(b).1 || ends(b).0 > ends(a).1
                };
                let apart = beside(|p| p.0)
                    || beside(|p| p.1)
                    || side(a[0], a[1], b[0]) * side(a[0], a[1], b[1]) > 0.0
                    || side(b[0], b[1], a[0]) * side(b[0], b[1], a[1]) > 0.0;
                assert!(apart, "{name}: {a:?} and {b:?}");
            }
            for item in &texts {
                let at = |k: usize| {
                    (a[0].0 + (a[1].0 - a[0].0) * k as f64 / 200.0, a[0].1 + (a[1].1 - a[0].1) * k as f64 / 200.0)
                };
                let through = (0..=200).filter(|k| item.holds(at(*k))).count();
                assert!(through == 0, "{name}: a leader through `{}`", item.text);
            }
        }
    }
    assert!(leaders > 50 && hatched > 8, "{leaders} leaders, {hatched} hatched areas");
}

/// Every text that is a number of its kind has as many decimals as the others.
#[test]
fn numbers_of_one_kind_have_the_same_decimals() {
    for name in EXAMPLES {
        let svg = drawing(&compiled(name), Theme::Light).expect("drawn");
        let plan = svg.split("class=\"legend\"").next().expect("before the legend");
        let decimals = |text: &str| {
            text.split_once('.').map_or(0, |(_, digits)| digits.chars().take_while(char::is_ascii_digit).count())
        };
        let mut kinds: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for text in texts(plan) {
            let number = |text: &str| {
                text.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit()) && !text.contains('×')
            };
            if let Some((radius, turn)) =
                text.trim_start_matches("spiral ").strip_prefix('R').and_then(|t| t.split_once(' '))
            {
                kinds.entry("radius").or_default().push(decimals(radius));
                kinds.entry("turn").or_default().push(decimals(turn.trim_start_matches("fix ")));
            } else if let Some((_, heading)) = text.split_once(" ∠ ") {
                kinds.entry("heading").or_default().push(decimals(heading));
            } else if let Some(height) = text.strip_prefix("level ") {
                kinds.entry("height").or_default().push(decimals(height));
            } else if text.ends_with(" %") && number(&text) {
                kinds.entry("slope in the profile").or_default().push(decimals(&text));
            }
        }
        for (kind, found) in kinds {
            assert!(found.iter().all(|count| *count == found[0]), "{name}: {kind} {found:?}");
        }
    }
}
