//! Columns that a recorder names and scales in its own way: the sidecar says which channel each is.
//!
//! ```toml
//! [columns]
//! "Zeit [ms]" = { channel = "time", factor = 0.001 }
//! "Zug vorn [kN]" = { channel = "joint_xi", factor = -1000 }
//! "LI 1" = { channel = "trigger", factor = -1, offset = 1 }
//! Status = false
//! ```

use super::columns;
use super::columns::Columns;
use super::{Channel, DataProblem};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use toml::{Table, Value};

/// Which channels the columns of a data file are. Without an entry a column is what its name says.
#[derive(Debug, Default)]
pub struct Mapping {
    columns: BTreeMap<String, Mapped>,
    /// Columns of the file that have an entry.
    seen: RefCell<BTreeSet<String>>,
}

#[derive(Clone, Copy, Debug)]
struct Mapped {
    to: To,
    /// A sample is factor · x + offset, in SI units.
    factor: f64,
    offset: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum To {
    Time,
    Channel(Channel),
    /// It is passed over.
    Nothing,
}

impl Mapped {
    fn new(value: &Value) -> Option<Mapped> {
        let to = |name: &str| match name {
            "time" => Some(To::Time),
            _ => Channel::from_name(name).map(To::Channel),
        };
        let plain = |to| Mapped { to, factor: 1.0, offset: 0.0 };
        match value {
            Value::Boolean(false) => Some(plain(To::Nothing)),
            Value::String(name) => Some(plain(to(name)?)),
            Value::Table(table) => {
                let number = |key: &str, absent: f64| table.get(key).map_or(Some(absent), super::keys::number);
                let known = |key: &String| ["channel", "factor", "offset"].contains(&key.as_str());
                let (factor, offset) = (number("factor", 1.0)?, number("offset", 0.0)?);
                let to = to(table.get("channel")?.as_str()?)?;
                (factor != 0.0 && table.keys().all(known)).then_some(Mapped { to, factor, offset })
            }
            _ => None,
        }
    }
}

impl Mapping {
    /// What an entry says.
    pub const ENTRY: &str = "a channel such as \"joint_xi\", { channel = \"joint_xi\", factor = 1000 }, or false";

    /// From a table by columns' names.
    ///
    /// # Errors
    ///
    /// The name of an entry that says no channel.
    pub fn new(table: &Table) -> Result<Mapping, String> {
        let each =
            table.iter().map(|(name, value)| Ok((name.clone(), Mapped::new(value).ok_or_else(|| name.clone())?)));
        Ok(Mapping { columns: each.collect::<Result<_, String>>()?, seen: RefCell::default() })
    }

    fn of(&self, name: &str) -> Option<Mapped> {
        let found = self.columns.get(name).copied();
        if found.is_some() {
            self.seen.borrow_mut().insert(name.to_owned());
        }
        found
    }

    /// Whether a column is the time; without an entry if its name is one of these.
    pub fn is_time(&self, name: &str, called: &[&str]) -> bool {
        self.of(name).map_or(called.contains(&name), |mapped| mapped.to == To::Time)
    }

    /// Whether the sidecar says what a column is, so that its unit is not asked for.
    pub fn says(&self, name: &str) -> bool {
        self.columns.contains_key(name)
    }

    /// The channel of a column that is not the time, which is not among those taken; `None` for one that is passed over.
    ///
    /// # Errors
    ///
    /// [`DataProblem::UnknownColumn`], [`DataProblem::DuplicateColumn`]
    pub fn pick(&self, name: &str, taken: &[Channel]) -> Result<Option<Channel>, DataProblem> {
        match self.of(name).map(|mapped| mapped.to) {
            None => columns::channel(name, taken).map(Some),
            Some(To::Nothing) => Ok(None),
            Some(To::Channel(channel)) if !taken.contains(&channel) => Ok(Some(channel)),
            Some(To::Channel(_) | To::Time) => Err(DataProblem::DuplicateColumn),
        }
    }

    /// Scales what was read.
    pub fn scale(&self, (time, channels): &mut Columns) {
        for mapped in self.columns.values().filter(|mapped| mapped.factor != 1.0 || mapped.offset != 0.0) {
            let samples = match mapped.to {
                To::Time => Some(&mut *time),
                To::Channel(channel) => channels.get_mut(&channel),
                To::Nothing => None,
            };
            samples.into_iter().flatten().for_each(|x| *x = mapped.factor * *x + mapped.offset);
        }
    }

    /// An entry whose column the file lacks.
    pub fn unused(&self) -> Option<String> {
        let seen = self.seen.borrow();
        self.columns.keys().find(|name| !seen.contains(*name)).cloned()
    }
}

#[cfg(test)]
mod tests {
    use crate::signal::{Channel, Run};
    use std::fs;

    const SIDECAR: &str =
        "layout = \"a.lss\"\nsensor_cart = 1\nspeed_setpoint = 2\ntrigger_position = 0\nlowpass = 1\nlaps = 1\n";

    fn read(data: &str, columns: &str) -> Result<Run, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("run.csv");
        fs::write(&file, data).expect("data");
        fs::write(folder.path().join("run.toml"), format!("{SIDECAR}{columns}")).expect("a sidecar");
        Run::read(&file).map_err(|error| error.to_string().replace(&format!("{}/", folder.path().display()), ""))
    }

    const DATA: &str =
        "Zeit [ms],Zug [kN],LI 1,Status,run_left\n0,-1.5,24,ok,200\n100,-1.25,0,ok,201\n200,,24,warn,202\n";
    const COLUMNS: &str = "[columns]\n\"Zeit [ms]\" = { channel = \"time\", factor = 0.001 }\n\
        \"Zug [kN]\" = { channel = \"joint_xi\", factor = -1000 }\n\
        \"LI 1\" = { channel = \"trigger\", factor = -0.041666666666666664, offset = 1 }\nStatus = false\n";

    #[test]
    fn columns_are_what_the_sidecar_says() {
        let run = read(DATA, COLUMNS).expect("a run");
        assert_eq!(run.time, [0.0, 0.1, 0.2]);
        let joint = &run.channels[&Channel::JointXi];
        assert!(joint[..2] == [1500.0, 1250.0] && joint[2].is_nan());
        assert_eq!(run.channels[&Channel::Trigger], [0.0, 1.0, 0.0]);
        assert_eq!(run.channels[&Channel::RunLeft], [200.0, 201.0, 202.0]);
        assert_eq!(run.channels.len(), 3);
    }

    #[test]
    fn mistakes_in_them_are_told() {
        let cases = [
            (COLUMNS.replace("Status = false\n", ""), "run.csv, row 1, `Status`: there is no such column"),
            (COLUMNS.replace("Zug", "Zugkraft"), "run.csv, row 1, `Zug [kN]`: there is no such column"),
            (format!("{COLUMNS}Spannung = \"joint_eta\"\n"), "run.csv, `Spannung`: the sidecar says what this is"),
            (COLUMNS.replace("joint_xi", "joint_x"), "run.toml, `Zug [kN]`: the value is not a channel such as"),
            (
                COLUMNS.replace("factor = -1000", "factor = 0"),
                "run.toml, `Zug [kN]`: the value is not a channel such as",
            ),
            (
                COLUMNS.replace("factor = -1000", "scale = -1"),
                "run.toml, `Zug [kN]`: the value is not a channel such as",
            ),
            (COLUMNS.replace("joint_xi", "run_left"), "run.csv, row 1, `run_left`: the column is there twice"),
            (COLUMNS.replace("joint_xi", "time"), "run.csv, row 1, `Zug [kN]`: the column is there twice"),
            (COLUMNS.replace("-0.041666666666666664", "-1"), "run.csv, row 2, `trigger`:"),
            ("columns = 3\n".to_owned(), "run.toml, row 7, `columns`: the value is not a table headed by [columns]"),
        ];
        for (columns, expected) in cases {
            let told = read(DATA, &columns).expect_err(expected);
            assert!(told.starts_with(expected), "{told}");
        }
        assert!(read(DATA, "").expect_err("no time").starts_with("run.csv, row 1: the first column is not `time`"));
    }
}
