//! The JSON Schema of a `study.toml`, for editors that check TOML by one. It is made from the table of options.

use super::verb::{OptionKind, Verb};
use serde_json::{Map, Value, json};

/// The schema.
pub fn schema() -> Value {
    let mut sweep = Map::new();
    let about = |text: &str, of: Value| {
        let mut of = of;
        of["description"] = Value::from(text);
        of
    };
    let verbs: Vec<&str> = Verb::ALL.into_iter().map(Verb::name).collect();
    let step = json!({ "enum": verbs });
    sweep
        .insert("name".into(), about("Its name in the table of results.", json!({ "type": "string", "minLength": 1 })));
    sweep.insert(
        "steps".into(),
        about(
            "What is done for each task, in turn.",
            json!({ "anyOf": [step, { "type": "array", "items": step, "minItems": 1, "uniqueItems": true }] }),
        ),
    );
    let parameter = json!({ "$ref": "#/$defs/parameter" });
    sweep.insert(
        "file".into(),
        about("Layouts, or campaigns of runs; seen from the study's folder.", parameter.clone()),
    );
    sweep.insert(
        "zip".into(),
        about(
            "Parameters that go together: file, let.NAME, VERB.OPTION.",
            json!({ "type": "array", "items": { "type": "array", "items": { "type": "string" } } }),
        ),
    );
    sweep.insert("keep".into(), about("Whether outputs stay beside the results.", json!({ "type": "boolean" })));
    let table = json!({ "$ref": "#/$defs/table" });
    sweep.insert("let".into(), about("Values for the layout's `let`s.", table.clone()));
    for verb in Verb::ALL {
        let options: Map<String, Value> = verb
            .options()
            .iter()
            .map(|option| {
                let kind = if option.kind == OptionKind::Table { table.clone() } else { parameter.clone() };
                (option.key.to_owned(), kind)
            })
            .collect();
        let text = format!("Options of `lss {}`.", verb.words().join(" "));
        let of = json!({ "type": "object", "properties": options, "additionalProperties": false });
        sweep.insert(verb.name().into(), about(&text, of));
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "study.toml",
        "description": "Tasks of lss that differ in their parameters.",
        "type": "object",
        "properties": {
            "name": { "description": "Title of the page of results.", "type": "string", "minLength": 1 },
            "sweep": {
                "type": "array",
                "minItems": 1,
                "items": { "type": "object", "properties": sweep, "required": ["steps"], "additionalProperties": false },
            },
        },
        "required": ["sweep"],
        "additionalProperties": false,
        "$defs": {
            "value": { "type": ["string", "number", "boolean"] },
            "range": {
                "type": "object",
                "properties": {
                    "from": { "type": "number" },
                    "to": { "type": "number" },
                    "step": { "type": "number" },
                    "count": { "type": "integer", "minimum": 1 },
                    "unit": { "type": "string" },
                },
                "required": ["from", "to"],
                "oneOf": [{ "required": ["step"] }, { "required": ["count"] }],
                "additionalProperties": false,
            },
            "parameter": {
                "description": "A value, a list of values, or a range.",
                "anyOf": [
                    { "$ref": "#/$defs/value" },
                    { "type": "array", "items": { "$ref": "#/$defs/value" }, "minItems": 1 },
                    { "$ref": "#/$defs/range" },
                ],
            },
            "table": {
                "type": "object",
                "additionalProperties": { "anyOf": [{ "$ref": "#/$defs/parameter" }, { "$ref": "#/$defs/table" }] },
            },
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_takes_studies_and_refuses_others() {
        let validator = jsonschema::validator_for(&schema()).unwrap();
        let read = |text: &str| serde_json::to_value(toml::from_str::<toml::Value>(text).unwrap()).unwrap();
        let example = include_str!("../../examples/study/study.toml");
        let errors: Vec<String> = validator.iter_errors(&read(example)).map(|e| e.to_string()).collect();
        assert!(errors.is_empty(), "{errors:?}");
        for line in ["build.sed = 3", "build.seed = []", "build.seed = {from = 1}", "steps = \"biuld\"", "colour = 1"] {
            let text =
                format!("[[sweep]]\n{}{line}\n", if line.starts_with("steps") { "" } else { "steps = \"build\"\n" });
            assert!(!validator.is_valid(&read(&text)), "{line}");
        }
        assert!(validator.is_valid(&read("[[sweep]]\nsteps = \"simulate\"\nsimulate.set.cart.mass_kg = [40, 50]\n")));
    }
}
