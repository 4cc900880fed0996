use super::*;
use crate::chain_input::Simulation;
use crate::compiled::fixture::compile;
use crate::model::{fixture, instances};

fn report(layout: crate::model::Layout, objective: PolygonObjective) -> PolygonReport {
    let compiled = compile(layout);
    let simulation = Simulation::new(&compiled);
    let line = simulation.track.centre_line();
    PolygonReport::new(&simulation.name, &line, simulation.chain.pitch_m, objective, &Names::of(&compiled))
        .expect("a report")
}

#[test]
fn shares_add_up() {
    for objective in PolygonObjective::EACH {
        let report = report(instances::thesis10(), objective);
        assert!((report.curves.iter().map(|c| c.share).sum::<f64>() - 1.0).abs() < 1e-9);
        assert_eq!(report.value, report.values.get(objective));
    }
}

#[test]
fn curves_are_their_vertices() {
    let report = report(fixture::rectangle(30.0, 20.0, 4.0), PolygonObjective::All);
    let names: Vec<&str> = report.curves.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["P2", "P3", "P4", "P1"]);
    let names: Vec<&str> = report.straights.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["P1..P2", "P2..P3", "P3..P4", "P4..P1"]);
}

#[test]
fn a_table_for_people() {
    insta::assert_snapshot!(text(&report(instances::thesis10(), PolygonObjective::All)));
}

#[test]
fn the_short_form_has_three_members() {
    let report = report(fixture::rectangle(30.0, 20.0, 4.0), PolygonObjective::Last);
    let short: serde_json::Value = serde_json::from_str(&report.short_json()).expect("JSON");
    let keys: Vec<&String> = short.as_object().expect("an object").keys().collect();
    assert_eq!(keys, ["delta_p_mm", "objective", "value"]);
    assert_eq!(short["objective"], "last");
    let sum: f64 = (0..4).map(|i| short["delta_p_mm"][i][i].as_f64().expect("a number")).map(|x| x * x).sum();
    assert!((short["value"].as_f64().expect("a number") - sum).abs() < 1e-9);
}
