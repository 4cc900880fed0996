//! JSON Schemas of the documents, committed in `docs/schemas/`.

use crate::base::json;
use crate::chain_input::Simulation;
use crate::emit::bom::Bom;
use crate::emit::layout::LayoutFile;
use crate::emit::pareto::Pareto;
use crate::gap::Diagnosis;
use crate::report::capacity;
use crate::report::choice;
use crate::report::polygon::{PolygonReport, Verification};
use crate::review::Comparison;
use crate::study;

/// Names and contents of `docs/schemas/`.
pub fn schemas() -> [(&'static str, Vec<u8>); 11] {
    [
        ("layout.schema.json", json::schema::<LayoutFile>()),
        ("simulation.schema.json", json::schema::<Simulation>()),
        ("bom.schema.json", json::schema::<Bom>()),
        ("pareto.schema.json", json::schema::<Pareto>()),
        ("polygon.schema.json", json::schema::<PolygonReport>()),
        ("verify.schema.json", json::schema::<Verification>()),
        ("capacity.schema.json", json::schema::<capacity::Found>()),
        ("choice.schema.json", json::schema::<choice::Found>()),
        ("change.schema.json", json::schema::<Comparison>()),
        ("study.schema.json", json::to_json(&study::schema())),
        ("gap.schema.json", json::schema::<Diagnosis>()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::emit::{OwnNumbers, data_files};
    use crate::model::fixture;
    use serde_json::Value;
    use std::path::Path;

    /// `UPDATE_SCHEMAS=1 cargo test schemas` writes them anew.
    #[test]
    fn committed_schemas_are_up_to_date() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/schemas");
        for (name, schema) in schemas() {
            let path = folder.join(name);
            if std::env::var_os("UPDATE_SCHEMAS").is_some() {
                std::fs::write(&path, &schema).unwrap();
            }
            let committed = std::fs::read(&path).unwrap_or_default();
            assert!(committed == schema, "{name} is out of date: run UPDATE_SCHEMAS=1 cargo test schemas");
        }
    }

    #[test]
    fn emitted_files_are_valid_and_end_with_a_newline() {
        let mut special = fixture::rectangle(20.0, 10.0, 4.0);
        special.vertices[1].radius.value = 4.2;
        for layout in [fixture::rectangle(20.3, 10.0, 4.0), special] {
            let files = data_files(&compile(layout), &OwnNumbers::default());
            let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
            assert_eq!(names, ["layout.json", "simulation.json", "bom.csv", "bom.json"]);
            for (name, schema) in schemas() {
                // Of `lss polygon`, `lss study`, `lss capacity`, `lss choose`, `lss gap`, `lss diff` and `--emit pareto`, not of every build.
                let Some((_, content)) = files.iter().find(|(n, _)| *n == name.replace(".schema", "")) else {
                    continue;
                };
                let validator = jsonschema::validator_for(&serde_json::from_slice(&schema).unwrap()).unwrap();
                let document: Value = serde_json::from_slice(content).unwrap();
                let errors: Vec<String> = validator.iter_errors(&document).map(|e| e.to_string()).collect();
                assert!(errors.is_empty(), "{name}: {errors:?}");
                assert!(content.ends_with(b"}\n"));
                // A schema that takes everything would not be one.
                assert!(!validator.is_valid(&serde_json::json!({ "name": 1 })));
            }
        }
    }

    #[test]
    fn a_change_is_valid() {
        let schema = json::schema::<Comparison>();
        let validator = jsonschema::validator_for(&serde_json::from_slice(&schema).unwrap()).unwrap();
        let mut layout = fixture::rectangle(22.0, 12.0, 4.0);
        layout.equipment.motors = crate::model::Motors::Evenly { count: 6 };
        let (before, after) = (compile(fixture::rectangle(20.0, 12.0, 4.0)), compile(layout));
        let found = Comparison::new(("a", &before), ("b", &after));
        assert!(!found.bill.is_empty() && !found.beside.is_empty() && !found.lines.is_empty());
        let document: Value = serde_json::from_slice(&json::to_json(&found)).unwrap();
        let errors: Vec<String> = validator.iter_errors(&document).map(|e| e.to_string()).collect();
        assert!(errors.is_empty(), "{errors:?}\n{document}");
        assert!(!validator.is_valid(&serde_json::json!({ "before": 1 })));
    }

    #[test]
    fn a_diagnosis_is_valid_and_its_places_name_their_unit() {
        let [.., (_, schema)] = schemas();
        let validator = jsonschema::validator_for(&serde_json::from_slice(&schema).unwrap()).unwrap();
        for seed in 0..200 {
            let found = crate::gap::random_reports::report(seed);
            let document: Value = serde_json::from_slice(&json::to_json(&found)).unwrap();
            let errors: Vec<String> = validator.iter_errors(&document).map(|e| e.to_string()).collect();
            assert!(errors.is_empty(), "{errors:?}\n{document}");
            assert_eq!(serde_json::from_value::<Diagnosis>(document.clone()).unwrap(), found);
            let has = |name: &str| document["where"].as_array().unwrap().iter().all(|p| p.get(name).is_some());
            let time = document["axis"] == "s";
            assert!(if time { has("from_s") && has("to_s") } else { has("from_m") && has("to_m") });
            if !found.places.is_empty() {
                assert!(!has(if time { "from_m" } else { "from_s" }));
            }
        }
        assert!(!validator.is_valid(&serde_json::json!({ "verdict": "effect" })));
    }
}
