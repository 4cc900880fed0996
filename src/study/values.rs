//! What each verb found, as named numbers, truths and texts: the columns of the table.
//!
//! Names begin with the verb's. Times that a step took are left out, as they differ from run to run.

use super::place::Values;
use super::verb::Verb;
use crate::base::number::tidy;
use crate::base::trig;
use crate::source::input::JSON_LIMIT;
use crate::source::root;
use serde_json::Value;
use std::path::Path;

/// Members of results that say how long something took, or how much work it was.
const TIMES: [&str; 5] = ["seconds", "wall_s", "evaluations", "steps", "cost"];

/// What a step found: from what it printed, and from the files in its folder.
///
/// # Errors
///
/// In words, where it left something else than it should.
pub fn values(verb: Verb, printed: &str, folder: &Path) -> Result<Values, String> {
    match verb {
        Verb::Build => Ok(build(&parsed(printed)?)),
        Verb::Simulate => Ok(simulate(&parsed(printed)?)),
        Verb::Identify => identify(printed, &file(folder, "identification.json")?),
        Verb::Diagnose => Ok(diagnose(&file(folder, "gap.json")?)),
        Verb::Challenge => {
            let mut out = Values::new();
            flatten("challenge", &file(folder, "score.json")?, &mut out);
            Ok(out)
        }
    }
}

fn parsed(text: &str) -> Result<Value, String> {
    serde_json::from_str(text).map_err(|why| format!("the verb printed no result: {why}"))
}

fn file(folder: &Path, name: &str) -> Result<Value, String> {
    let bytes = root::read_given(&folder.join(name), JSON_LIMIT).map_err(|why| format!("{name}: {why}"))?;
    serde_json::from_slice(&bytes).map_err(|why| format!("{name}: {why}"))
}

/// Members of objects within objects, with dots between; lists are left out.
fn flatten(name: &str, value: &Value, out: &mut Values) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields.iter().filter(|(key, _)| !TIMES.contains(&key.as_str())) {
                flatten(&format!("{name}.{key}"), value, out);
            }
        }
        Value::Array(_) | Value::Null => {}
        plain => {
            out.insert(name.to_owned(), plain.clone());
        }
    }
}

fn number(value: &Value, pointer: &str) -> Option<f64> {
    value.pointer(pointer).and_then(Value::as_f64)
}

fn put(out: &mut Values, name: &str, value: Option<f64>) {
    if let Some(value) = value.filter(|x| x.is_finite()) {
        out.insert(name.to_owned(), Value::from(tidy(value)));
    }
}

/// The summary without its stages, and without the names of files and folders, which differ with where a study is done.
fn build(summary: &Value) -> Values {
    let mut out = Values::new();
    flatten("build", summary, &mut out);
    out.remove("build.file");
    out.remove("build.output");
    out
}

/// The summary, and each channel's largest amount and root mean square beside its moments.
fn simulate(summary: &Value) -> Values {
    let mut out = Values::new();
    let channels = summary.get("channels").cloned().unwrap_or_default();
    let mut rest = summary.clone();
    rest.as_object_mut().map(|members| members.remove("channels"));
    flatten("simulate", &rest, &mut out);
    flatten("simulate", &channels, &mut out);
    for (channel, of) in channels.as_object().into_iter().flatten() {
        let [mean, sd, min, max] = ["/mean", "/sd", "/min", "/max"].map(|at| number(of, at));
        let name = format!("simulate.{channel}");
        put(&mut out, &format!("{name}.peak"), min.zip(max).map(|(a, b)| a.abs().max(b.abs())));
        put(&mut out, &format!("{name}.rms"), mean.zip(sd).map(|(a, b)| trig::hypot(a, b)));
    }
    out
}

/// Of one run its parameters with their intervals; of several, those that they share so, and of the others the spread
/// over the runs. Laws beside the first have their name in between.
fn identify(printed: &str, study: &Value) -> Result<Values, String> {
    let mut out = Values::new();
    let laws = printed.lines().map(parsed).collect::<Result<Vec<Value>, _>>()?;
    for law in &laws {
        let name = law.get("law").and_then(Value::as_str).unwrap_or_default();
        let prefix = if laws.len() == 1 { "identify".to_owned() } else { format!("identify.{name}") };
        put(&mut out, &format!("{prefix}.objective"), number(law, "/objective"));
        let runs: Vec<&Value> =
            law.get("runs").and_then(Value::as_object).map(|r| r.values().collect()).unwrap_or_default();
        put(&mut out, &format!("{prefix}.runs"), Some(runs.len() as f64));
        if let [run] = runs.as_slice() {
            estimates(&mut out, &prefix, run.get("parameters"));
        } else {
            estimates(&mut out, &prefix, law.get("shared"));
            let groups = study.pointer(&format!("/laws/{name}/groups")).and_then(Value::as_array);
            // Groups are by set point, which no statistic mixes: of several only the first would be told.
            if let Some([group]) = groups.map(Vec::as_slice) {
                for (p, spread) in group.get("parameters").and_then(Value::as_object).into_iter().flatten() {
                    for of in ["median", "lower_quartile", "upper_quartile"] {
                        put(&mut out, &format!("{prefix}.{p}.{of}"), number(spread, &format!("/{of}")));
                    }
                }
            }
        }
    }
    Ok(out)
}

fn estimates(out: &mut Values, prefix: &str, parameters: Option<&Value>) {
    for (p, estimate) in parameters.and_then(Value::as_object).into_iter().flatten() {
        if estimate.get("fitted").and_then(Value::as_bool) == Some(false) {
            continue;
        }
        for of in ["value", "low", "high"] {
            put(out, &format!("{prefix}.{p}.{of}"), number(estimate, &format!("/{of}")));
        }
        if let Some(at_bound) = estimate.get("at_bound").filter(|v| v.is_boolean()) {
            out.insert(format!("{prefix}.{p}.at_bound"), at_bound.clone());
        }
    }
}

/// The verdict, the likeliest effect with its strengths, and what each effect's probability is.
fn diagnose(found: &Value) -> Values {
    let mut out = Values::new();
    for name in ["verdict", "unknown_probability", "none_probability", "untested_probability", "gap_closed"] {
        if let Some(value) = found.get(name).filter(|v| v.is_number() || v.is_string()) {
            out.insert(format!("diagnose.{name}"), value.clone());
        }
    }
    let effects = found.get("effects").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    for effect in effects {
        if let Some(name) = effect.get("name").and_then(Value::as_str) {
            put(&mut out, &format!("diagnose.probability.{name}"), number(effect, "/probability"));
        }
    }
    if let Some(first) = effects.first() {
        out.insert("diagnose.first".to_owned(), first.get("name").cloned().unwrap_or_default());
        put(&mut out, "diagnose.first.probability", number(first, "/probability"));
        for (strength, amount) in first.get("strength").and_then(Value::as_object).into_iter().flatten() {
            for of in ["value", "low", "high"] {
                put(&mut out, &format!("diagnose.first.{strength}.{of}"), number(amount, &format!("/{of}")));
            }
        }
    }
    let runs = found.get("runs").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    for of in ["before", "after"] {
        let each: Vec<f64> = runs.iter().filter_map(|run| number(run, &format!("/{of}"))).collect();
        let mean = (!each.is_empty()).then(|| each.iter().sum::<f64>() / each.len() as f64);
        put(&mut out, &format!("diagnose.{of}"), mean);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_channel_has_its_peak_and_its_root_mean_square() {
        let summary = json!({"carts": 3, "wall_s": 1.5, "channels": {"joint_xi": {"mean": 3.0, "sd": 4.0, "min": -9.0, "max": 7.0}}});
        let found = values(Verb::Simulate, &summary.to_string(), Path::new(".")).unwrap();
        assert_eq!(found["simulate.joint_xi.peak"], 9.0);
        assert_eq!(found["simulate.joint_xi.rms"], 5.0);
        assert_eq!(found["simulate.carts"], 3);
        assert!(!found.contains_key("simulate.wall_s"), "no times");
    }

    #[test]
    fn a_build_tells_nothing_of_where_it_was_done() {
        let summary = json!({"file": "a.lss", "output": "x/tasks/1/build", "layout": "a", "length_m": 40.0});
        let found = values(Verb::Build, &summary.to_string(), Path::new(".")).unwrap();
        assert_eq!(found.keys().map(String::as_str).collect::<Vec<_>>(), ["build.layout", "build.length_m"]);
    }

    #[test]
    fn one_run_has_intervals_and_several_have_spreads() {
        let estimate = json!({"value": 2.0, "low": 1.0, "high": 3.0, "at_bound": false, "fitted": true});
        let held = json!({"value": 2.0, "low": 2.0, "high": 2.0, "at_bound": false, "fitted": false});
        let run = json!({"parameters": {"speed": estimate, "tension": held}});
        let one = json!({"law": "flores", "objective": 1.1, "shared": {}, "runs": {"a": run}});
        let found = identify(&one.to_string(), &json!({})).unwrap();
        assert_eq!(found["identify.speed.high"], 3.0);
        assert!(!found.keys().any(|k| k.contains("tension")), "what was not fitted is not told as found");
        let two =
            json!({"law": "flores", "objective": 1.1, "shared": {"speed": estimate}, "runs": {"a": run, "b": run}});
        let study = json!({"laws": {"flores": {"groups": [{"parameters": {"tension": {"median": 5.0}}}]}}});
        let found = identify(&two.to_string(), &study).unwrap();
        assert_eq!((&found["identify.speed.low"], &found["identify.tension.median"]), (&json!(1.0), &json!(5.0)));
        let both = identify(&format!("{one}\n{}", one.to_string().replace("flores", "lee_wang")), &json!({})).unwrap();
        assert!(both.contains_key("identify.lee_wang.speed.value"));
    }

    #[test]
    fn a_diagnosis_tells_its_verdict_and_the_first_effect() {
        let found = diagnose(&json!({
            "verdict": "effect", "none_probability": 0.1, "gap_closed": null,
            "effects": [{"name": "rail_step", "probability": 0.8, "strength": {"height": {"value": 1e-3, "low": 9e-4, "high": 1.1e-3}}},
                {"name": "joint_clearance", "probability": 0.1}],
            "runs": [{"before": 4.0, "after": 1.0}, {"before": 6.0, "after": 2.0}],
        }));
        assert_eq!(found["diagnose.first"], "rail_step");
        assert_eq!(found["diagnose.first.height.low"], 9e-4);
        assert_eq!(found["diagnose.probability.joint_clearance"], 0.1);
        assert_eq!((&found["diagnose.before"], &found["diagnose.after"]), (&json!(5.0), &json!(1.5)));
        assert!(!found.contains_key("diagnose.gap_closed"));
    }
}
