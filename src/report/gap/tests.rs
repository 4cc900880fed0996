use super::*;
use crate::base::trig;
use crate::chain_input::CentreLinePiece;
use crate::gap::random_reports::{hold, report};
use crate::gap::{Amount, Extent, GapPlace, Group, Lost, Overlay, RunGap, Shape, Unexplained};
use serde_json::Value;
use std::collections::BTreeMap;

fn oval() -> Track {
    let straight = || CentreLinePiece::Straight { length: 30.0, slope: 0.0 };
    let arc = || CentreLinePiece::Arc { radius: 4.0, turn_deg: 180.0 };
    Track { name: "oval".into(), start: [0.0; 4], elements: vec![straight(), arc(), straight(), arc()] }
}

fn amount_of(value: f64, width: f64, unit: &str) -> Amount {
    Amount {
        value,
        low: value - width,
        high: value + width,
        unit: unit.into(),
        at_bound: None,
        by_run: BTreeMap::new(),
    }
}

fn finding(name: &str, probability: f64) -> Finding {
    Finding {
        name: name.into(),
        group: name.into(),
        probability,
        untested_probability: 0.0,
        strength: BTreeMap::new(),
        gap_closed: None,
        gap_closed_placebo: None,
        place: String::new(),
        fixed: BTreeMap::new(),
        shape: None,
        elsewhere: Vec::new(),
    }
}

#[test]
fn a_shape_is_drawn_with_its_band_and_one_of_nothing_is_not() {
    let shape = |size: f64, over: &str, unit: &str| Shape {
        of: "left steering wheel, radius".into(),
        over: over.into(),
        unit: unit.into(),
        at: vec![0.0, 3.0, 6.0],
        value: vec![0.0, -size, 0.0],
        low: vec![0.0, -2.0 * size, 0.0],
        high: vec![0.0, 0.0, 0.0],
    };
    let drawn_as = |shape: Shape| {
        let finding = Finding { shape: Some(shape), ..finding("wheel_out_of_round", 0.9) };
        let mut pictures = Pictures::default();
        (shape::shapes(&[&finding], &mut pictures).into_string(), pictures.data.plots)
    };
    let drawn = |size: f64| drawn_as(shape(size, "rad", "m"));
    let (page, plots) = drawn(1e-4);
    assert!(page.contains("left steering wheel, radius, µm") && page.contains("id=\"shape-0\""), "{page}");
    let plot = serde_json::to_value(&plots[0]).expect("JSON");
    assert_eq!((&plot["unit"], &plot["x_unit"]), (&"µm".into(), &"°".into()));
    assert_eq!(plot["curves"][1]["y"], serde_json::json!([0, -100, 0]));
    assert!(drawn(0.0).1.is_empty());
    // A share, along a motor.
    let plot = serde_json::to_value(&drawn_as(shape(0.25, "m", "")).1[0]).expect("JSON");
    assert_eq!((&plot["unit"], &plot["x_unit"]), (&"%".into(), &"m".into()));
    assert_eq!(plot["curves"][1]["y"], serde_json::json!([0, -25, 0]));
}

fn place(channel: &str, from_m: f64, to_m: f64, band: &str, share: f64) -> GapPlace {
    GapPlace { channel: channel.into(), extent: Extent::Track { from_m, to_m }, band: band.into(), share }
}

fn run(run: &str, before: f64, after: f64) -> RunGap {
    RunGap { run: run.into(), before, after, replicate: 1.0, replicate_high: 1.4 }
}

fn overlay(run: &str, channel: &str, unit: &str, from: f64) -> Overlay {
    let at: Vec<f64> = (0..40).map(|k| from + 0.25 * f64::from(k)).collect();
    let base: Vec<f64> = at.iter().map(|s| 120.0 + 40.0 * trig::sin(0.4 * s)).collect();
    let bump = |s: &f64| 25.0 * trig::exp(-(s - from - 5.0) * (s - from - 5.0));
    let mut measured: Vec<f64> = at.iter().zip(&base).map(|(s, b)| b + bump(s) + trig::sin(9.0 * s)).collect();
    measured[30] = f64::NAN;
    Overlay {
        run: run.into(),
        channel: channel.into(),
        band: "track".into(),
        unit: unit.into(),
        measured,
        after: at.iter().zip(&base).map(|(s, b)| b + 0.95 * bump(s)).collect(),
        before: base,
        repeatability: vec![2.0; at.len()],
        at,
    }
}

/// A rail step at a place.
fn placed() -> Diagnosis {
    let mut step = finding("rail_step", 0.963);
    step.strength = [("height".to_owned(), amount_of(0.000_82, 0.000_07, "m"))].into();
    step.place = "at 41.2 m, left rail".into();
    step.gap_closed = Some(0.93);
    step.gap_closed_placebo = Some(0.11);
    let others = [("track_flexibility", 0.071), ("wheel_out_of_round", 0.022), ("sensor_gain", 0.004)];
    Diagnosis {
        verdict: Verdict::Effect,
        summary: "A rail step of 0.82 mm at 41.2 m on the left rail explains the gap with a probability of 96 %. \
                  Adding it closes 93 % of \
                  the gap on a run that took no part in the choice, where a placebo closes 11 %."
            .into(),
        shown: vec!["rail_step".into()],
        untested_probability: 0.0,
        effects: [step].into_iter().chain(others.map(|(name, p)| finding(name, p))).collect(),
        places: vec![
            place("steer_left", 40.0, 42.5, "track", 0.46),
            place("steer_left", 40.0, 42.5, "fluctuation", 0.17),
            place("joint_eta", 40.0, 45.0, "track", 0.12),
            place("run_left", 37.5, 45.0, "distribution", 0.08),
            place("steer_right", 0.0, 85.1, "cart", 0.06),
            place("fork_left", 12.5, 15.0, "track", 0.04),
        ],
        unknown_probability: 0.031,
        none_probability: 0.000_02,
        repeatability: [("steer_left", 0.712), ("joint_eta", 1.25), ("joint_xi", 11.3)]
            .map(|(channel, value)| (channel.to_owned(), value))
            .into(),
        next_experiment: "A second lap at 2.4 m/s would halve the interval of the height.".into(),
        groups: Vec::new(),
        runs: vec![run("run-01", 18.2, 1.31), run("run-02", 23.9, 1.22), run("run-03", 9.7, 1.08)],
        gap_closed_black_box: Some(0.41),
        gap_closed: Some(0.93),
        unexplained: Unexplained::default(),
        predictive_check: None,
        noise: BTreeMap::new(),
        gap_closed_channels: [("steer_left".to_owned(), 0.95), ("joint_eta".to_owned(), 0.71)].into(),
        lost: vec![Lost::data("run-02 lost 3 % of steer_right, so that nothing is known of it from 60 m to 64 m.")],
        overlays: vec![overlay("run-02", "steer_left", "N", 36.0), overlay("run-02", "joint_eta", "N", 36.0)],
        axis: Axis::Track,
        outside: None,
    }
}

/// Two effects that the runs cannot tell apart, with a sensor not far.
fn grouped() -> Diagnosis {
    let mut friction = finding("joint_friction", 0.48);
    let mut clearance = finding("joint_clearance", 0.45);
    friction.group = "joint".into();
    clearance.group = "joint".into();
    friction.strength = [("moment".to_owned(), amount_of(12.0, 9.0, "N m"))].into();
    Diagnosis {
        verdict: Verdict::Effect,
        summary:
            "Joint friction or joint clearance is present; these runs cannot tell which. Either closes 60 % of the gap."
                .into(),
        shown: vec!["joint_friction".into()],
        effects: vec![friction, clearance, finding("sensor_lag", 0.12)],
        groups: vec![Group {
            name: "joint".into(),
            members: vec!["joint_friction".into(), "joint_clearance".into()],
            experiment: "a run at half the tension, where clearance opens and friction does not change".into(),
        }],
        next_experiment: String::new(),
        lost: Vec::new(),
        ..placed()
    }
}

fn nothing() -> Diagnosis {
    Diagnosis {
        verdict: Verdict::None,
        summary: "Measured and simulated laps differ by no more than two replicate laps do. No effect is needed."
            .into(),
        shown: Vec::new(),
        untested_probability: 0.0,
        effects: [("rail_step", 0.013), ("sensor_gain", 0.011), ("motor_ripple", 0.009), ("pitch_wear", 0.004)]
            .map(|(name, p)| finding(name, p))
            .into(),
        places: Vec::new(),
        unknown_probability: 0.012,
        none_probability: 0.962,
        repeatability: BTreeMap::new(),
        next_experiment: String::new(),
        groups: Vec::new(),
        runs: vec![run("run-01", 1.02, 1.02), run("run-02", 0.97, 0.97)],
        gap_closed_black_box: None,
        gap_closed: None,
        unexplained: Unexplained::default(),
        predictive_check: None,
        noise: BTreeMap::new(),
        gap_closed_channels: BTreeMap::new(),
        lost: Vec::new(),
        overlays: Vec::new(),
        axis: Axis::Track,
        outside: None,
    }
}

fn unknown() -> Diagnosis {
    Diagnosis {
        verdict: Verdict::Unknown,
        summary: "The gap is real, and nothing in the library explains it. The nearest closes 12 % of it.".into(),
        unknown_probability: 0.91,
        none_probability: 0.0,
        effects: vec![finding("speed_drag", 0.07)],
        gap_closed: None,
        ..placed()
    }
}

/// A drive outside the chain, with seconds for places.
fn outside() -> Diagnosis {
    let mut coulomb = finding("coulomb", 0.995);
    coulomb.strength = [("force".to_owned(), amount_of(20.4, 0.6, "N"))].into();
    coulomb.gap_closed = Some(0.88);
    Diagnosis {
        summary: "Coulomb friction of 20.4 N explains the gap. It closes 88 % of it.".into(),
        shown: vec!["coulomb".into()],
        effects: vec![coulomb, finding("stribeck", 0.2), finding("quadratic", 0.01)],
        places: [(2.0, 3.0, 0.5), (5.0, 6.5, 0.3)]
            .map(|(from_s, to_s, share)| GapPlace {
                extent: Extent::Time { from_s, to_s },
                ..place("force", 0.0, 0.0, "track", share)
            })
            .into(),
        overlays: vec![overlay("test", "force", "N", 1.0)],
        repeatability: [("force".to_owned(), 0.4)].into(),
        axis: Axis::Time,
        outside: None,
        ..placed()
    }
}

fn all() -> [(&'static str, Diagnosis); 5] {
    [
        ("placed", placed()),
        ("grouped", grouped()),
        ("nothing", nothing()),
        ("unknown", unknown()),
        ("outside", outside()),
    ]
}

/// The page as far as words and pictures stand in it, without scripts.
fn written(page: &str) -> &str {
    page.split("<noscript").next().unwrap_or_default()
}

/// What its pictures show.
fn data(page: &str) -> Value {
    let block = page.split("id=\"page-data\">").nth(1).and_then(|rest| rest.split("</script>").next());
    serde_json::from_str(block.expect("a block")).expect("JSON")
}

/// Text of the page, a line an element.
fn text(page: &str) -> String {
    let body = page.split("<body>").nth(1).and_then(|body| body.split("<noscript").next()).unwrap_or_default();
    let words = body.split('>').filter_map(|part| part.split('<').next()).map(str::trim).filter(|t| !t.is_empty());
    words.collect::<Vec<_>>().join("\n").replace("&amp;", "&")
}

#[test]
fn a_page_reads_from_the_verdict_to_the_floor() {
    let page = page(&placed(), Some(&oval()), "hall 3");
    insta::assert_snapshot!(text(&page));
}

#[test]
fn nothing_is_promised_that_a_diagnosis_does_not_have() {
    for (name, diagnosis) in all() {
        let page = page(&diagnosis, Some(&oval()), name);
        assert!(!written(&page).contains("NaN") && !written(&page).contains("inf"), "{name}");
        assert_eq!(page.contains("Next experiment"), !diagnosis.next_experiment.is_empty(), "{name}");
        assert_eq!(
            page.contains("id=\"plan\"") && data(&page)["plan"].is_object(),
            diagnosis.axis == Axis::Track && !diagnosis.places.is_empty(),
            "{name}"
        );
        assert_eq!(page.contains("Not told apart"), !diagnosis.groups.is_empty(), "{name}");
        assert_eq!(
            page.contains("90 % interval"),
            !matches!(diagnosis.verdict, Verdict::None | Verdict::Unknown),
            "{name}"
        );
        assert_eq!(page, super::page(&diagnosis, Some(&oval()), name));
    }
}

#[test]
fn a_group_is_the_headline_where_no_member_stands_out() {
    let diagnosis = grouped();
    assert_eq!(headline(&diagnosis, &diagnosis.named()), "Joint friction or joint clearance");
    assert_eq!(headline(&nothing(), &[]), "No gap");
}

#[test]
fn broken_numbers_break_no_page() {
    let mut diagnosis = placed();
    diagnosis.places.push(place("x<y", f64::NAN, f64::INFINITY, "odd", f64::NAN));
    diagnosis.runs.push(run("r", f64::NAN, 0.0));
    diagnosis.effects[0].probability = f64::NAN;
    diagnosis.effects.clear();
    let page = page(&diagnosis, None, "<b>");
    assert!(page.contains("&lt;b&gt;") && !written(&page).contains("NaN"));
}

#[test]
fn every_sentence_of_the_page_agrees_with_its_numbers() {
    for seed in 0..600 {
        let diagnosis = report(seed);
        let page = page(&diagnosis, None, "random");
        hold(&text(&page), &diagnosis).unwrap_or_else(|wrong| panic!("{seed}: {wrong}"));
    }
}

#[test]
fn a_picture_shows_the_difference_beside_both() {
    let page = page(&placed(), Some(&oval()), "hall 3");
    let data = data(&page);
    let plots = data["plots"].as_array().expect("plots");
    let with = |name: &str| {
        let has = |plot: &&Value| plot["curves"].as_array().is_some_and(|all| all.iter().any(|c| c["name"] == name));
        plots.iter().filter(has).count()
    };
    // Measured against simulated, and the difference, of each of two channels; one curve of what was measured in each.
    assert_eq!((with("repeatability"), with("measured")), (4, 2));
    // What was lost is lost in the picture; the difference is what the curves above it differ by.
    let y = |plot: usize, name: &str| {
        let curves = plots[plot]["curves"].as_array().expect("curves");
        curves.iter().find(|c| c["name"] == name).expect(name)["y"].clone()
    };
    assert_eq!(y(0, "measured")[30], Value::Null);
    let number = |values: &Value, k: usize| values[k].as_f64().expect("a number");
    for k in [3, 20, 39] {
        let less = number(&y(0, "measured"), k) - number(&y(0, "before"), k);
        assert!((number(&y(1, "before"), k) - less).abs() < 0.02, "{k}: {less}");
    }
    assert!(text(&page).contains("63 % of the gap"), "the share of the table stands at the picture");
}
