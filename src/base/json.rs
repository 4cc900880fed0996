//! JSON documents: fixed key order, one number formatter, a final newline; and their schemas.
//!
//! A member stands on a line of its own, so that differences between two builds read well, but a list of plain values
//! (`[4, 0]`) stays on one.

use std::io::{self, Write};

use super::number;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::ser::{Formatter, Serializer};

/// The document as text.
pub fn to_json<T: Serialize>(document: &T) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut bytes, Pretty::default());
    // Documents are plain structures with text keys, and a vector takes every byte: nothing can fail.
    let written = document.serialize(&mut serializer);
    debug_assert!(written.is_ok(), "{written:?}");
    bytes.push(b'\n');
    bytes
}

/// The JSON Schema of a document.
pub fn schema<T: JsonSchema>() -> Vec<u8> {
    to_json(&schemars::schema_for!(T))
}

#[derive(Default)]
struct Pretty {
    /// Lists and objects around the current place: whether everything in them stands on one line so far.
    open: Vec<bool>,
    /// A list's value is next: whether it is the first.
    value: Option<bool>,
}

impl Pretty {
    fn line<W: ?Sized + Write>(&self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b"\n")?;
        self.open.iter().try_for_each(|_| writer.write_all(b"  "))
    }

    /// Before a plain value.
    fn scalar<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        match (self.value.take(), self.open.last()) {
            (Some(false), Some(true)) => writer.write_all(b" "),
            (Some(_), Some(false)) => self.line(writer),
            _ => Ok(()),
        }
    }

    /// Before a list or an object; lists around it are then broken into lines.
    fn open<W: ?Sized + Write>(&mut self, writer: &mut W, bracket: &[u8]) -> io::Result<()> {
        if self.value.take().is_some() {
            if let Some(flat) = self.open.last_mut() {
                *flat = false;
            }
            self.line(writer)?;
        }
        self.open.push(true);
        writer.write_all(bracket)
    }

    fn close<W: ?Sized + Write>(&mut self, writer: &mut W, bracket: &[u8]) -> io::Result<()> {
        if self.open.pop() == Some(false) {
            self.line(writer)?;
        }
        writer.write_all(bracket)
    }
}

impl Formatter for Pretty {
    fn write_null<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.scalar(writer)?;
        writer.write_all(b"null")
    }

    fn write_bool<W: ?Sized + Write>(&mut self, writer: &mut W, value: bool) -> io::Result<()> {
        self.scalar(writer)?;
        write!(writer, "{value}")
    }

    fn write_i64<W: ?Sized + Write>(&mut self, writer: &mut W, value: i64) -> io::Result<()> {
        self.scalar(writer)?;
        write!(writer, "{value}")
    }

    fn write_u64<W: ?Sized + Write>(&mut self, writer: &mut W, value: u64) -> io::Result<()> {
        self.scalar(writer)?;
        write!(writer, "{value}")
    }

    fn write_f64<W: ?Sized + Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        self.scalar(writer)?;
        writer.write_all(number::shortest(value).as_bytes())
    }

    fn begin_string<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.scalar(writer)?;
        writer.write_all(b"\"")
    }

    fn begin_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.open(writer, b"[")
    }

    fn end_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.close(writer, b"]")
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        self.value = Some(first);
        if first { Ok(()) } else { writer.write_all(b",") }
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.open(writer, b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.close(writer, b"}")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        if let Some(flat) = self.open.last_mut() {
            *flat = false;
        }
        if !first {
            writer.write_all(b",")?;
        }
        self.line(writer)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    #[test]
    fn numbers_go_through_the_formatter() {
        let text = String::from_utf8(to_json(&(1.0, -0.0, 0.1, 4.0e7, f64::NAN))).unwrap();
        assert_eq!(text, "[1, 0, 0.1, 40000000, null]\n");
    }

    #[test]
    fn lists_of_plain_values_stay_on_one_line() {
        let value = json!({ "a": [1, "b", null], "c": [[1.5, -2], [true]], "d": [], "e": {}, "f": [1, {"g": 2}, 3] });
        let text = String::from_utf8(to_json(&value)).unwrap();
        insta::assert_snapshot!(text, @r#"
        {
          "a": [1, "b", null],
          "c": [
            [1.5, -2],
            [true]
          ],
          "d": [],
          "e": {},
          "f": [1,
            {
              "g": 2
            },
            3
          ]
        }
        "#);
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }
}
