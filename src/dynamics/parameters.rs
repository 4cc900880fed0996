//! Every number of a simulation input by name, as `--set` takes it: the path of its place in `simulation.json`, with
//! dots.

use crate::chain_input::Simulation;
use crate::kinematics::closing;
use crate::syntax::nearest;
use serde_json::Value;
use std::fmt;

/// Parts of `simulation.json` that follow from others: setting them would change nothing.
const DERIVED: [&str; 4] = ["chain.pitch_m", "chain.track_length_m", "chain.chord_excess_m", "chain.left_over_m"];

/// A name that cannot be set, or a value it cannot have.
#[derive(Clone, Debug, PartialEq)]
pub struct Unset {
    pub name: String,
    pub why: String,
}

impl fmt::Display for Unset {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.name, self.why)
    }
}

impl std::error::Error for Unset {}

/// Name and value of every number, and of the contact law, in the order of the file.
pub fn parameters(simulation: &Simulation) -> Vec<(String, String)> {
    let mut out = Vec::new();
    if let Ok(value) = serde_json::to_value(simulation) {
        leaves(&value, String::new(), &mut out);
    }
    out.retain(|(name, _)| !DERIVED.contains(&name.as_str()));
    out
}

fn leaves(value: &Value, path: String, out: &mut Vec<(String, String)>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Number(number) => out.push((path, number.to_string())),
        Value::String(text) if path == "contact_law" => out.push((path, text.clone())),
        Value::Object(fields) => fields.iter().for_each(|(key, value)| leaves(value, below(key), out)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(k, value)| leaves(value, below(&k.to_string()), out));
        }
        _ => {}
    }
}

/// Sets parameters, in turn. With another cart length or track and no number of carts set, the chain gets as many as
/// close nearest to that length.
///
/// # Errors
///
/// The first name that is unknown, with the nearest one, or the first value that does not fit.
pub fn set(simulation: &Simulation, changes: &[(String, String)]) -> Result<Simulation, Unset> {
    let mut changed = simulation.clone();
    for (name, value) in changes {
        changed = set_one(&changed, name, value)?;
    }
    let touches = |part: &str| changes.iter().any(|(name, _)| name.starts_with(part));
    if (touches("cart.length_m") || touches("track.")) && !touches("chain.carts") {
        changed.chain.carts = carts(&changed);
    }
    if touches("cart.length_m") || touches("track.") || touches("chain.carts") {
        changed.derive();
    }
    Ok(changed)
}

fn set_one(simulation: &Simulation, name: &str, text: &str) -> Result<Simulation, Unset> {
    let refuse = |why: String| Unset { name: name.to_owned(), why };
    if DERIVED.contains(&name) {
        return Err(refuse("follows from the track, the cart's length and the number of carts; set those".into()));
    }
    let mut root = serde_json::to_value(simulation).map_err(|why| refuse(why.to_string()))?;
    let pointer = format!("/{}", name.replace('.', "/"));
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let value = match root.pointer(&pointer) {
        Some(Value::Number(old)) => {
            let wrong = || refuse(format!("`{text}` is not a number in SI units"));
            if old.is_u64() && !old.is_f64() && text.trim().parse::<u64>().is_ok() {
                Value::from(text.trim().parse::<u64>().map_err(|_| wrong())?)
            } else {
                Value::from(number(text).ok_or_else(wrong)?)
            }
        }
        Some(Value::Null) if name == "supports_every_m" => {
            Value::from(number(text).ok_or_else(|| refuse(format!("`{text}` is not a number of metres")))?)
        }
        Some(Value::String(_)) if name == "contact_law" => Value::from(text),
        _ => {
            let all = parameters(simulation);
            let near = nearest(name, all.iter().map(|(name, _)| name.as_str()));
            let hint = near.map_or_else(String::new, |near| format!(", did you mean `{near}`?"));
            return Err(refuse(format!("there is no such parameter{hint}")));
        }
    };
    if let Some(place) = root.pointer_mut(&pointer) {
        *place = value;
    }
    serde_json::from_value(root).map_err(|why| refuse(why.to_string()))
}

/// The whole number of carts whose closing pitch comes nearest to the cart's length.
fn carts(simulation: &Simulation) -> usize {
    let line = simulation.track.centre_line();
    let length = simulation.cart.length_m;
    let near = (line.length / length).round();
    if !(3.0..=100_000.0).contains(&near) {
        return simulation.chain.carts;
    }
    let near = near as usize;
    let off = |n: &usize| closing(&line, *n, 0.0).map_or(f64::INFINITY, |c| (c.pitch - length).abs());
    (near.saturating_sub(2)..=near + 2).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(near)
}
