//! The sidecar: what stands beside the data, in TOML.

use super::{Problem, RunError};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use toml::{Spanned, Value};

/// What is known about a run beside its samples. The values are nominal.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Sidecar {
    /// Path of a `.lss` or `simulation.json`, seen from the sidecar's folder.
    pub layout: String,
    /// Number of the cart that carries the sensors, from 1.
    pub sensor_cart: usize,
    /// m/s
    pub speed_setpoint: f64,
    /// Arc length of the photocell, m.
    pub trigger_position: f64,
    /// Corner of the second-order Butterworth low-pass before sampling, Hz.
    pub lowpass: f64,
    pub laps: usize,
    /// Free text and anything else: further keys, which are kept and mean nothing here.
    #[serde(flatten)]
    pub notes: BTreeMap<String, Value>,
}

impl Sidecar {
    /// The keys that every sidecar has, in the order they are written.
    pub const KEYS: [&str; 6] = ["layout", "sensor_cart", "speed_setpoint", "trigger_position", "lowpass", "laps"];

    /// Adds a line of free text. The names of [`Sidecar::KEYS`] are taken and change nothing.
    pub fn note(&mut self, key: &str, text: impl Into<Value>) {
        if !Sidecar::KEYS.contains(&key) {
            self.notes.insert(key.to_owned(), text.into());
        }
    }

    /// As TOML: the keys in their order, then the notes by name.
    pub fn write(&self) -> Vec<u8> {
        // Serialising fails for maps whose keys are no strings and for enums of several fields: there are none here.
        toml::to_string(self).unwrap_or_default().into_bytes()
    }

    /// Reads TOML; `file` is named in errors.
    ///
    /// # Errors
    ///
    /// [`Problem::Malformed`] for text that is no TOML, [`Problem::MissingKey`] and [`Problem::WrongValue`] with the key
    /// and its line.
    pub fn read(bytes: &[u8], file: &Path) -> Result<Sidecar, RunError> {
        let malformed = |why: String| RunError::new(file, Problem::Malformed(why));
        let text = std::str::from_utf8(bytes).map_err(|why| malformed(why.to_string()))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let line = |byte: usize| 1 + text.bytes().take(byte).filter(|&b| b == b'\n').count();
        let keys: BTreeMap<String, Spanned<Value>> = toml::from_str(text).map_err(|why| {
            let error = malformed(why.message().to_owned());
            match why.span() {
                Some(span) => error.row(line(span.start)),
                None => error,
            }
        })?;
        let mut reader = Reader { keys, file, line: &line };
        Ok(Sidecar {
            layout: reader.take("layout", "a path", |v| v.as_str().map(str::to_owned))?,
            sensor_cart: reader.take("sensor_cart", "a whole number from 1", |v| whole(v).filter(|&n| n > 0))?,
            speed_setpoint: reader.take("speed_setpoint", "a speed above 0", |v| number(v).filter(|&x| x > 0.0))?,
            trigger_position: reader.take("trigger_position", "a number", number)?,
            lowpass: reader.take("lowpass", "a frequency above 0", |v| number(v).filter(|&x| x > 0.0))?,
            laps: reader.take("laps", "a whole number", whole)?,
            notes: reader.keys.into_iter().map(|(key, value)| (key, value.into_inner())).collect(),
        })
    }
}

struct Reader<'a, L> {
    keys: BTreeMap<String, Spanned<Value>>,
    file: &'a Path,
    line: &'a L,
}

impl<L: Fn(usize) -> usize> Reader<'_, L> {
    fn take<T>(
        &mut self,
        key: &str,
        expected: &'static str,
        read: impl Fn(&Value) -> Option<T>,
    ) -> Result<T, RunError> {
        let error = |problem| RunError::new(self.file, problem).column(key);
        let value = self.keys.remove(key).ok_or_else(|| error(Problem::MissingKey))?;
        read(value.get_ref())
            .ok_or_else(|| error(Problem::WrongValue { expected }).row((self.line)(value.span().start)))
    }
}

fn number(value: &Value) -> Option<f64> {
    let number = match value {
        Value::Integer(n) => *n as f64,
        Value::Float(x) => *x,
        _ => return None,
    };
    number.is_finite().then_some(number)
}

fn whole(value: &Value) -> Option<usize> {
    value.as_integer().and_then(|n| usize::try_from(n).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    const WRITTEN: &str = r#"layout = "out/simulation.json"
sensor_cart = 1
speed_setpoint = 2.0
trigger_position = 0.25
lowpass = 100.0
laps = 1
comment = "after the new rails"

[building]
hall = 3
"#;

    fn read(text: &str) -> Result<Sidecar, String> {
        Sidecar::read(text.as_bytes(), Path::new("run-01.toml")).map_err(|e| e.to_string())
    }

    #[test]
    fn what_is_written_reads_back() {
        let sidecar = read(WRITTEN).expect("a sidecar");
        assert_eq!(sidecar.notes["comment"].as_str(), Some("after the new rails"));
        assert_eq!(String::from_utf8(sidecar.write()).expect("text"), WRITTEN);
        assert_eq!(read(&WRITTEN.replace("100.0", "100")), Ok(sidecar), "a whole number is a number");
    }

    #[test]
    fn mistakes_are_told_with_their_line() {
        let cases = [
            (
                WRITTEN.replace("lowpass = 100.0\n", ""),
                "run-01.toml, `lowpass`: the key is missing\n  help: add lowpass = HZ, the corner of the second-order low-pass before sampling",
            ),
            (
                WRITTEN.replace("= 2.0", "= \"2\""),
                "run-01.toml, row 3, `speed_setpoint`: the value is not a speed above 0\n  help: change the value",
            ),
            (
                WRITTEN.replace("= 1\nspeed", "= 0\nspeed"),
                "run-01.toml, row 2, `sensor_cart`: the value is not a whole number from 1\n  help: change the value",
            ),
            (
                WRITTEN.replace("laps = 1", "laps = nan"),
                "run-01.toml, row 6, `laps`: the value is not a whole number\n  help: change the value",
            ),
        ];
        for (text, expected) in cases {
            assert_eq!(read(&text), Err(expected.to_owned()));
        }
        let torn = read("layout = \"a\nlaps = 1").expect_err("no TOML");
        assert!(torn.starts_with("run-01.toml, row 1: is malformed: "), "{torn}");
    }
}
