//! Keys of a TOML file, taken one by one, with their lines.

use super::{DataProblem, RunError};
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::path::Path;
use toml::{Spanned, Value};

/// The keys of one table.
pub(super) type Table = BTreeMap<String, Spanned<Value>>;

/// A TOML file, and where its bytes stand in lines.
pub(super) struct Text<'a> {
    text: &'a str,
    file: &'a Path,
}

impl<'a> Text<'a> {
    /// UTF-8 with or without a byte order mark; `file` is named in errors.
    pub fn new(bytes: &'a [u8], file: &'a Path) -> Result<Self, RunError> {
        let text =
            std::str::from_utf8(bytes).map_err(|why| RunError::new(file, DataProblem::Malformed(why.to_string())))?;
        Ok(Text { text: text.strip_prefix('\u{feff}').unwrap_or(text), file })
    }

    /// The whole file as `T`.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, RunError> {
        toml::from_str(self.text).map_err(|why| {
            let error = RunError::new(self.file, DataProblem::Malformed(why.message().to_owned()));
            match why.span() {
                Some(span) => error.row(self.line(span.start)),
                None => error,
            }
        })
    }

    /// The line of a byte, from 1.
    pub fn line(&self, byte: usize) -> usize {
        1 + self.text.bytes().take(byte).filter(|&b| b == b'\n').count()
    }

    /// The keys of a table of this file.
    pub fn reader(&self, keys: Table) -> Reader<'_> {
        Reader { keys, text: self }
    }
}

/// Takes the keys of one table.
pub(super) struct Reader<'a> {
    keys: Table,
    text: &'a Text<'a>,
}

impl Reader<'_> {
    /// A key that has to be there.
    pub fn take<T>(
        &mut self,
        key: &str,
        expected: &'static str,
        read: impl Fn(&Value) -> Option<T>,
    ) -> Result<T, RunError> {
        self.optional(key, expected, read)?
            .ok_or_else(|| RunError::new(self.text.file, DataProblem::MissingKey).column(key))
    }

    /// A key that may be there.
    pub fn optional<T>(
        &mut self,
        key: &str,
        expected: &'static str,
        read: impl Fn(&Value) -> Option<T>,
    ) -> Result<Option<T>, RunError> {
        let Some(value) = self.keys.remove(key) else { return Ok(None) };
        if plain_number(value.get_ref()).is_some_and(|x| x.is_finite() && x.abs() > FARTHEST) {
            return Err(self.error(DataProblem::WrongValue { expected: "a number within ±1e12" }, key, &value));
        }
        match read(value.get_ref()) {
            Some(value) => Ok(Some(value)),
            None => Err(self.error(DataProblem::WrongValue { expected }, key, &value)),
        }
    }

    /// The line of a key, while it is not taken.
    pub fn line(&self, key: &str) -> Option<usize> {
        self.keys.get(key).map(|value| self.text.line(value.span().start))
    }

    /// The keys that are not taken.
    pub fn names(&self) -> Vec<String> {
        self.keys.keys().cloned().collect()
    }

    /// What was not taken.
    pub fn rest(self) -> BTreeMap<String, Value> {
        self.keys.into_iter().map(|(key, value)| (key, value.into_inner())).collect()
    }

    /// That nothing is left; `known` are the keys that there are.
    pub fn finish(self, known: &'static [&'static str]) -> Result<(), RunError> {
        match self.keys.iter().min_by_key(|(_, value)| value.span().start) {
            Some((key, value)) => Err(self.error(DataProblem::UnknownKey { known }, key, value)),
            None => Ok(()),
        }
    }

    fn error(&self, problem: DataProblem, key: &str, value: &Spanned<Value>) -> RunError {
        RunError::new(self.text.file, problem).column(key).row(self.text.line(value.span().start))
    }
}

/// Text that says something.
pub(super) fn text(value: &Value) -> Option<String> {
    value.as_str().filter(|text| !text.is_empty()).map(str::to_owned)
}

/// A finite number, written with or without a point.
pub(super) fn number(value: &Value) -> Option<f64> {
    plain_number(value).filter(|x| x.is_finite())
}

/// Beyond this no setting of a machine means anything.
const FARTHEST: f64 = 1e12;

fn plain_number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(n) => Some(*n as f64),
        Value::Float(x) => Some(*x),
        _ => None,
    }
}

/// A finite number above 0.
pub(super) fn positive(value: &Value) -> Option<f64> {
    number(value).filter(|&x| x > 0.0)
}

/// A whole number from 0.
pub(super) fn whole(value: &Value) -> Option<usize> {
    value.as_integer().and_then(|n| usize::try_from(n).ok())
}
