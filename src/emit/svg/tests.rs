//! Whole drawings, read back with another reader's text layout: well-formed, nothing cut off, no two texts over each
//! other, none over the track.

use std::path::PathBuf;

use resvg::usvg::{Group, Node, Text, Tree};

use super::place::PaperBox;
use super::*;
use crate::base::trig;
use crate::compiled::Compiled;
use crate::emit::paper::PaperPoint;
use crate::emit::plan::samples;
use crate::emit::{DrawError, drawing_files, png, stages_png, stages_svg};

fn drawings() -> Vec<(&'static str, Compiled)> {
    vec![
        ("rectangle", samples::rectangle()),
        ("ten_vertices", samples::ten_vertices()),
        ("crowded", samples::crowded()),
        ("failed", samples::failed()),
        ("large", samples::large(60, 20)),
        ("raised", samples::raised()),
        ("equipped", samples::equipped()),
    ]
}

/// Writes the drawings into the folder that `LSS_DRAWINGS` names, to be looked at.
#[test]
#[ignore = "writes files to look at"]
fn write_samples() {
    let folder = PathBuf::from(std::env::var("LSS_DRAWINGS").expect("LSS_DRAWINGS names a folder"));
    for (name, compiled) in drawings() {
        for (file, content) in drawing_files(&compiled).expect("drawn") {
            std::fs::write(folder.join(format!("{name}.{file}")), content).expect("written");
        }
    }
    let large = samples::large(200, 50);
    let begin = std::time::Instant::now();
    let files = (drawing(&large, Theme::Adaptive), crate::emit::dxf::drawing(&large).expect("drawn"));
    println!("200 vertices, 50 obstacles: {:?}, {} bytes", begin.elapsed(), files.1.len());
    std::fs::write(folder.join("200.svg"), files.0.expect("drawn")).expect("written");
    let (compiled, written) = samples::staged();
    std::fs::write(folder.join("stages.svg"), stages_svg(&compiled, &written).expect("drawn")).expect("written");
    std::fs::write(folder.join("stages.png"), stages_png(&compiled, &written).expect("drawn")).expect("written");
}

/// Every text but the watermark with its box in mm, as usvg lays it out.
fn texts(tree: &Tree) -> Vec<(String, PaperBox)> {
    fn walk(group: &Group, each: &mut impl FnMut(&Text)) {
        for node in group.children() {
            match node {
                Node::Group(group) => walk(group, each),
                Node::Text(text) => each(text),
                _ => {}
            }
        }
    }
    let mm = 25.4 / 96.0;
    let mut found = Vec::new();
    walk(tree.root(), &mut |text| {
        let words: String = text.chunks().iter().map(|chunk| chunk.text()).collect();
        if words == "NOT FEASIBLE" && text.bounding_box().height() > 15.0 {
            return;
        }
        let bounds = text.bounding_box();
        let at = |x: f32, y: f32| {
            let mut p = tiny_skia::Point::from_xy(x, y);
            text.abs_transform().map_point(&mut p);
            PaperPoint::new(f64::from(p.x) * mm, f64::from(p.y) * mm)
        };
        let (a, b) = (at(bounds.left(), bounds.top()), at(bounds.right(), bounds.top()));
        let c = at(bounds.left(), bounds.bottom());
        let axis = (b - a) * (1.0 / a.distance(b));
        let half = PaperPoint::new(a.distance(b) / 2.0, a.distance(c) / 2.0);
        found.push((words, PaperBox { centre: b.lerp(c, 0.5), half, axis }));
    });
    found
}

/// The sheet that a drawing is on: the one whose tables have as many lines as the drawing's.
fn sheet_of(compiled: &Compiled, svg: &str) -> Sheet {
    let listed = svg.split("class=\"tables\"").nth(1).and_then(|t| t.split("class=\"legend\"").next()).unwrap_or("");
    let (_, listed) = listed.split_once("labels without room").unwrap_or(("", ""));
    general::sheet(compiled, listed.matches("<text").count()).expect("fits")
}

fn light(compiled: &Compiled) -> String {
    drawing(compiled, Theme::Light).expect("drawn")
}

fn parse(svg: &str) -> Tree {
    png::parse(svg).expect("well-formed")
}

#[test]
fn no_text_is_cut_off_or_over_another() {
    let (compiled, written) = samples::staged();
    let mut all: Vec<(&str, String)> = drawings().iter().map(|(name, compiled)| (*name, light(compiled))).collect();
    all.push(("stages", stages(&compiled, &written, Theme::Light).expect("drawn")));
    for (name, svg) in all {
        let tree = parse(&svg);
        let mm = 25.4 / 96.0;
        let (width, height) = (f64::from(tree.size().width()) * mm, f64::from(tree.size().height()) * mm);
        let found = texts(&tree);
        assert!(found.len() > 20, "{name}");
        for (i, (text, item)) in found.iter().enumerate() {
            for p in item.corners() {
                assert!(p.x > 5.0 && p.y > 4.9 && p.x < width - 4.9 && p.y < height - 4.9, "{name}: {text} at {p:?}");
            }
            for (other, taken) in &found[..i] {
                assert!(!item.meets(taken), "{name}: `{text}` over `{other}` at {:?}", item.centre);
            }
        }
    }
}

#[test]
fn no_text_is_over_the_track() {
    for (name, compiled) in drawings() {
        let svg = light(&compiled);
        let sheet = sheet_of(&compiled, &svg);
        let half = compiled.layout.width.value / 2.0;
        let found = texts(&parse(&svg));
        let steps = (compiled.track.length / 0.25) as usize;
        for i in 0..steps {
            let (p, heading) = compiled.track.at(i as f64 * 0.25);
            for across in [-1.0, -0.5, 0.0, 0.5, 1.0] {
                let at = sheet.at(p + Point::unit(heading).left() * (across * half));
                let dot = PaperBox::upright(at, 0.01, 0.01);
                for (text, item) in &found {
                    assert!(!item.meets(&dot), "{name}: `{text}` over the band at {p:?}");
                }
            }
        }
    }
}

#[test]
fn widths_of_text_agree_with_the_font() {
    for (text, item) in texts(&parse(&light(&samples::crowded()))) {
        let sizes =
            [text::Height::H18, text::Height::H25, text::Height::H35, text::Height::H50].map(text::Height::size);
        let near = |bold| sizes.iter().any(|size| (text::width(&text, *size, bold) - 2.0 * item.half.x).abs() < 0.05);
        assert!(near(false) || near(true), "{text}: {}", 2.0 * item.half.x);
    }
}

#[test]
fn every_vertex_straight_and_curve_is_labelled() {
    let compiled = samples::ten_vertices();
    let svg = light(&compiled);
    for vertex in &compiled.layout.vertices {
        assert!(svg.contains(&format!(">{}</text>", vertex.name)), "{}", vertex.name);
    }
    for text in [
        ">30.263<",
        ">13.424 ∠ 15.00°<",
        ">R5 84.22°<",
        ">R4 82.43°<",
        ">fix length, rotation<",
        ">row_a 18×<",
        ">M13<",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!svg.contains("found no room"));
    assert!(!light(&samples::crowded()).contains("found no room"));
}

#[test]
fn the_drawing_is_not_mirrored() {
    let svg = light(&samples::rectangle());
    let found = texts(&parse(&svg));
    let at = |name: &str| found.iter().find(|(text, _)| text == name).map(|(_, item)| item.centre).expect("labelled");
    // P1 lower left, counter-clockwise.
    assert!(at("P1").x < at("P2").x && at("P1").y > at("P4").y && at("P3").y < at("P2").y);
}

#[test]
fn the_legend_lists_only_what_appears() {
    let rectangle = light(&samples::rectangle());
    for absent in
        ["obstacle<", "wall<", "clearance<", "photocell<", "induction<", ">chute", "support,", "fixed v", "lacks"]
    {
        assert!(!rectangle.contains(absent), "{absent}");
    }
    let crowded = light(&samples::crowded());
    for present in ["obstacle<", "wall<", "clearance<", ">induction<", ">chute: row, count<", "support, every 1 m<"] {
        assert!(crowded.contains(present), "{present}");
    }
}

#[test]
fn a_failed_layout_says_so_and_why() {
    let svg = light(&samples::failed());
    for text in [
        "watermark\"",
        "3 rows are violated, by at most 0.613 m",
        "clearance of O2",
        "at most 90°: 0.7047°",
        "&quot;the",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!light(&samples::ten_vertices()).contains("NOT FEASIBLE"));
}

#[test]
fn names_of_any_kind_stay_on_the_sheet() {
    let mut compiled = samples::crowded();
    compiled.layout.name = "<script>alert(1)</script> & \"friends\" ".repeat(12);
    compiled.layout.cart.name = "längster Wagen ".repeat(20);
    compiled.layout.vertices[0].name = "vertex_".repeat(40);
    compiled.layout.obstacles[0].name = "柱".repeat(60);
    compiled.layout.equipment.inductions[0].name = "\u{0}\u{1b}[31m".to_owned();
    let svg = light(&compiled);
    assert!(!svg.contains("<script"));
    let tree = parse(&svg);
    let width = f64::from(tree.size().width()) * 25.4 / 96.0;
    for (text, item) in texts(&tree) {
        assert!(item.corners().iter().all(|p| p.x > 0.0 && p.x < width), "{text}");
    }
}

#[test]
fn themes_differ_in_style_only() {
    let compiled = samples::crowded();
    let adaptive = drawing(&compiled, Theme::Adaptive).expect("drawn");
    assert!(adaptive.contains("@media(prefers-color-scheme:dark)"));
    let body = |svg: &str| svg.split("</style>").nth(1).map(str::to_owned);
    assert_eq!(body(&adaptive), body(&light(&compiled)));
}

#[test]
fn the_same_layout_gives_the_same_bytes() {
    let compiled = samples::crowded();
    let files = drawing_files(&compiled).expect("drawn");
    assert_eq!(
        files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        ["drawing.svg", "drawing.png", "drawing.dxf"]
    );
    assert_eq!(files, drawing_files(&compiled.clone()).expect("drawn"));
    let raster = tiny_skia::Pixmap::decode_png(&files[1].1).expect("PNG");
    assert_eq!(raster.width(), 2400);
    let inked = raster.pixels().iter().filter(|p| p.red() < 128).count();
    assert!(raster.pixels().iter().all(|p| p.alpha() == 255) && inked > 20_000, "{inked}");
}

#[test]
fn coordinates_beyond_any_sheet_are_an_error() {
    let mut compiled = samples::rectangle();
    compiled.track.corners[1].point.x = f64::NAN;
    assert_eq!(drawing_files(&compiled), Err(DrawError::Extent));
    compiled.track.corners[1].point.x = 1e12;
    assert_eq!(drawing_files(&compiled), Err(DrawError::Extent));
}

#[test]
fn overlapping_fillets_and_tight_radii_are_drawn() {
    let corners = [(0.0, 0.0, 6.0), (10.0, 0.0, 6.0), (10.0, 8.0, 0.3), (0.0, 8.0, 6.0)];
    let layout = crate::model::fixture::loop_through("overlap", &corners);
    let svg = light(&crate::compiled::fixture::compile(layout));
    assert!(svg.contains(">-2.0<") && !svg.contains("NaN"), "{svg}");
}

#[test]
fn stages_are_told_apart_and_their_lengths_given() {
    let (compiled, written) = samples::staged();
    let svg = stages(&compiled, &written, Theme::Adaptive).expect("drawn");
    for (i, stage) in compiled.stages.iter().enumerate() {
        let length = crate::base::number::trimmed(stage.length, 3);
        assert!(svg.contains(&format!(">stage {}: {length} m<", i + 1)));
        assert!(svg.contains(&format!("class=\"stage-{}\"", i + 1)));
    }
    let turns: f64 = Track::new(&written).fillets.iter().map(|f| f.turn).sum();
    assert!((turns - trig::TAU).abs() < 1e-9);
}

/// Levels at their height above the floor, slopes, vertices and arc lengths; nothing of it where the track is level.
#[test]
fn a_raised_track_has_a_height_profile() {
    assert!(!light(&samples::rectangle()).contains("class=\"profile\""));
    let svg = light(&samples::raised());
    let (_, profile) = svg.split_once("class=\"profile\"").expect("a profile");
    let (profile, _) = profile.split_once("class=\"legend\"").expect("a legend after it");
    let labels: Vec<&str> = profile.split("</text>").filter_map(|t| t.rsplit('>').next()).collect();
    insta::assert_snapshot!(labels[..labels.len() - 1].join(" | "));
    // The highest and the lowest line stand apart by the rise, in the profile's own scale.
    let heights: Vec<f64> = texts(&parse(&svg))
        .iter()
        .filter(|(text, _)| ["0.0 m", "1.0 m", "2.2 m"].contains(&text.as_str()))
        .map(|(_, item)| item.centre.y)
        .collect();
    let [floor, low, high] = heights[..] else { panic!("{heights:?}") };
    assert!(((floor - low) / (floor - high) - 1.0 / 2.2).abs() < 0.02, "{heights:?}");
}

#[test]
fn the_rectangle_is_drawn_as_reviewed() {
    insta::assert_snapshot!(drawing(&samples::rectangle(), Theme::Adaptive).expect("drawn"));
}
