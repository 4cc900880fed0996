//! The sidecar: what stands beside the data, in TOML.

use super::keys::{self, Reader, Text};
use super::mapping::Mapping;
use super::{Channel, DataProblem, RunError};
use crate::source::{InputError, Root, SIZE_LIMIT};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::path::Path;
use std::path::PathBuf;
use toml::Value;

/// What is known about a run beside its samples. The values are nominal.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Sidecar {
    /// Path of a `.lss` or `simulation.json`, seen from the sidecar's folder.
    pub layout: String,
    /// Number of the cart that carries the sensors, from 1.
    pub sensor_cart: usize,
    /// m/s
    pub speed_setpoint: f64,
    /// Tension that the chain was set to, N; the layout's where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tension_setpoint: Option<f64>,
    /// Arc length of the photocell, m.
    pub trigger_position: f64,
    /// Corner of the second-order Butterworth low-pass before sampling, Hz.
    pub lowpass: f64,
    pub laps: usize,
    /// Forces that were set to zero while a load was on their sensors.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "names")]
    pub zeroed: Vec<Channel>,
    /// Free text and anything else: further keys, which are kept and mean nothing here.
    #[serde(flatten)]
    pub notes: BTreeMap<String, Value>,
}

/// What a campaign says of the recorder of all its runs, where a run's sidecar does not say it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SidecarDefaults {
    /// As `columns` of a sidecar.
    columns: Option<toml::Table>,
    /// As `zeroed` of a sidecar.
    zeroed: Option<Vec<Channel>>,
}

impl SidecarDefaults {
    /// Its keys, as of a sidecar.
    pub(super) const KEYS: [&str; 2] = ["columns", "zeroed"];

    /// Takes them from a table; `file` is named in errors.
    ///
    /// # Errors
    ///
    /// [`DataProblem::WrongValue`]
    pub(super) fn take(reader: &mut Reader, file: &Path) -> Result<SidecarDefaults, RunError> {
        let columns = reader.optional("columns", "a table headed by [columns]", |value| value.as_table().cloned())?;
        let zeroed = reader.optional("zeroed", "a list of forces such as [\"joint_xi\"]", forces)?;
        let defaults = SidecarDefaults { columns, zeroed };
        defaults.mapping(file).map(|_| defaults)
    }

    fn mapping(&self, file: &Path) -> Result<Mapping, RunError> {
        Mapping::new(self.columns.as_ref().unwrap_or(&toml::Table::new()))
            .map_err(|name| RunError::new(file, DataProblem::WrongValue { expected: Mapping::ENTRY }).column(&name))
    }
}

impl Sidecar {
    /// The keys that every sidecar has, in the order they are written.
    pub const KEYS: [&str; 6] = ["layout", "sensor_cart", "speed_setpoint", "trigger_position", "lowpass", "laps"];

    /// Adds a line of free text. The names of the other keys are taken and change nothing.
    pub fn note(&mut self, key: &str, text: impl Into<Value>) {
        let taken = Sidecar::KEYS.contains(&key) || SidecarDefaults::KEYS.contains(&key) || key == "tension_setpoint";
        if !taken {
            self.notes.insert(key.to_owned(), text.into());
        }
    }

    /// As TOML: the keys in their order, then the notes by name.
    pub fn write(&self) -> Vec<u8> {
        // Serialising fails for maps whose keys are no strings and for enums of several fields: there are none here.
        toml::to_string(self).unwrap_or_default().into_bytes()
    }

    /// Reads the sidecar of a data file, which has to lie within the root, and what it says of the file's columns. What it
    /// does not say of its recorder, the campaign's may.
    ///
    /// # Errors
    ///
    /// [`DataProblem::MissingSidecar`] of the data file; of the sidecar, [`DataProblem::Unreadable`],
    /// [`DataProblem::OutsideRoot`], [`DataProblem::TooLarge`] and those of [`Sidecar::read`].
    pub fn beside(data: &Path, root: &Root, defaults: &SidecarDefaults) -> Result<(Sidecar, Mapping), RunError> {
        let file = sidecar_path(data);
        match root.read(&file, SIZE_LIMIT) {
            Ok(bytes) => Sidecar::read_mapped(&bytes, &file, defaults),
            Err(InputError::Missing(_)) => {
                Err(RunError::new(data, DataProblem::MissingSidecar { path: file, keys: &Sidecar::KEYS }))
            }
            Err(why) => Err(RunError::unreadable(&file, why)),
        }
    }

    /// Reads TOML; `file` is named in errors.
    ///
    /// # Errors
    ///
    /// [`DataProblem::Malformed`] for text that is no TOML, [`DataProblem::MissingKey`] and [`DataProblem::WrongValue`]
    /// with the key and its line.
    pub fn read(bytes: &[u8], file: &Path) -> Result<Sidecar, RunError> {
        Sidecar::read_mapped(bytes, file, &SidecarDefaults::default()).map(|(sidecar, _)| sidecar)
    }

    fn read_mapped(bytes: &[u8], file: &Path, defaults: &SidecarDefaults) -> Result<(Sidecar, Mapping), RunError> {
        let text = Text::new(bytes, file)?;
        let mut reader = text.reader(text.parse()?);
        let own = SidecarDefaults::take(&mut reader, file)?;
        let mapping = if own.columns.is_some() { &own } else { defaults }.mapping(file)?;
        let sidecar = Sidecar {
            layout: reader.take("layout", "a path", keys::text)?,
            sensor_cart: reader.take("sensor_cart", "a whole number from 1", |v| keys::whole(v).filter(|&n| n > 0))?,
            speed_setpoint: reader.take("speed_setpoint", "a speed above 0", keys::positive)?,
            tension_setpoint: reader.optional("tension_setpoint", "a force in N", keys::number)?,
            trigger_position: reader.take("trigger_position", "a number", keys::number)?,
            lowpass: reader.take("lowpass", "a frequency above 0", keys::positive)?,
            laps: reader.take("laps", "a whole number", keys::whole)?,
            zeroed: own.zeroed.or_else(|| defaults.zeroed.clone()).unwrap_or_default(),
            notes: reader.rest(),
        };
        Ok((sidecar, mapping))
    }
}

fn names<S: Serializer>(channels: &[Channel], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(channels.iter().map(|channel| channel.name()))
}

/// A list of channels that are forces.
fn forces(value: &Value) -> Option<Vec<Channel>> {
    let force = |value: &Value| value.as_str().and_then(Channel::from_name).filter(|c| Channel::FORCES.contains(c));
    value.as_array()?.iter().map(force).collect()
}

/// The sidecar beside a data file: `run-01.toml` for `run-01.csv`.
pub fn sidecar_path(data: &Path) -> PathBuf {
    data.with_extension("toml")
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
    fn the_tension_that_was_set_may_be_told() {
        let text = WRITTEN.replace("trigger_position", "tension_setpoint = 400.0\ntrigger_position");
        let sidecar = read(&text).expect("a sidecar");
        assert_eq!(sidecar.tension_setpoint, Some(400.0));
        assert_eq!(String::from_utf8(sidecar.write()).expect("text"), text);
        assert_eq!(read(WRITTEN).expect("a sidecar").tension_setpoint, None);
        assert!(read(&text.replace("400.0", "\"400 N\"")).is_err());
    }

    #[test]
    fn forces_that_were_set_to_zero_are_named() {
        let text = WRITTEN.replace("laps = 1\n", "laps = 1\nzeroed = [\"joint_xi\", \"run_left\"]\n");
        let sidecar = read(&text).expect("a sidecar");
        assert_eq!(sidecar.zeroed, [Channel::JointXi, Channel::RunLeft]);
        assert_eq!(String::from_utf8(sidecar.write()).expect("text"), text);
    }

    #[test]
    fn mistakes_are_told_with_their_line() {
        let cases = [
            (
                WRITTEN.replace("laps = 1\n", "laps = 1\nzeroed = [\"trigger\"]\n"),
                "run-01.toml, row 7, `zeroed`: the value is not a list of forces such as [\"joint_xi\"]\n  \
                 help: change the value",
            ),
            (
                WRITTEN.replace("lowpass = 100.0\n", ""),
                "run-01.toml, `lowpass`: the key is missing\n  \
                 help: add lowpass = HZ, the corner of the second-order low-pass before sampling",
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
                WRITTEN.replace("lowpass = 100.0", "lowpass = 1e308"),
                "run-01.toml, row 5, `lowpass`: the value is not a number within ±1e12\n  help: change the value",
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
