//! Static tests of a joint as CSV: `direction,deformation,force`, in metres and newtons.

use crate::signal::DataPlace;
use crate::signal::csv::line;
use crate::source::one_line;
use crate::syntax::nearest;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// Which way a joint was pulled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Direction {
    /// Along the chain.
    Axial,
    /// Across it.
    Radial,
}

impl Direction {
    pub const fn name(self) -> &'static str {
        match self {
            Direction::Axial => "axial",
            Direction::Radial => "radial",
        }
    }
}

/// What was measured in one direction, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// m
    pub deformation: Vec<f64>,
    /// N
    pub force: Vec<f64>,
}

/// Why a file is no static test.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    pub place: DataPlace,
    pub what: String,
    pub help: String,
}

/// Beyond this no number of a test means anything, m or N.
const FARTHEST: f64 = 1e12;

const COLUMNS: [&str; 3] = ["direction", "deformation", "force"];

/// Reads a test; `file` is named in mistakes. The columns may stand in any order; without `direction` all points are of
/// the one that is given.
///
/// # Errors
///
/// The first [`Mistake`], with its row (the line) and column.
pub fn read(bytes: &[u8], file: &Path, given: Option<Direction>) -> Result<BTreeMap<Direction, Points>, Mistake> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let at = |row: usize, column: Option<&str>, what: &str, help: &str| Mistake {
        place: DataPlace { file: file.to_owned(), row: Some(row), column: column.map(str::to_owned) },
        what: what.to_owned(),
        help: help.to_owned(),
    };
    let mut reader =
        ::csv::ReaderBuilder::new().flexible(true).has_headers(false).trim(::csv::Trim::All).from_reader(bytes);
    let mut record = ::csv::StringRecord::new();
    let mut next = |record: &mut ::csv::StringRecord| {
        reader.read_record(record).map_err(|why| {
            let row = why.position().map_or(1, |p| p.line() as usize);
            at(row, None, "this is not text in UTF-8", "write the file again as CSV in UTF-8")
        })
    };
    let header = if next(&mut record)? { record.iter().map(str::to_owned).collect() } else { Vec::new() };
    for (i, name) in header.iter().enumerate() {
        if !COLUMNS.contains(&name.as_str()) {
            let help = match nearest(name, COLUMNS) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("columns are {}, separated by commas", COLUMNS.join(", ")),
            };
            return Err(at(1, Some(name), "there is no such column", &help));
        }
        if header[..i].contains(name) {
            return Err(at(1, Some(name), "the column is there twice", "keep one of the two"));
        }
    }
    let place = |name: &str| header.iter().position(|h| h == name);
    let missing =
        |name| at(1, Some(name), "the column is missing", "begin with the header direction,deformation,force");
    let deformation = place("deformation").ok_or_else(|| missing("deformation"))?;
    let force = place("force").ok_or_else(|| missing("force"))?;
    let direction = place("direction");
    if direction.is_none() && given.is_none() {
        let help = "add it with axial or radial in every row, or tell the one direction by --direction";
        return Err(at(1, Some("direction"), "the column is missing", help));
    }
    let mut test: BTreeMap<Direction, Points> = BTreeMap::new();
    while next(&mut record)? {
        let row = record.position().map_or(0, |p| line(bytes, p));
        if record.len() != header.len() {
            let what = format!("{} fields where the header has {}", record.len(), header.len());
            return Err(at(row, None, &what, "give every row a field for every column"));
        }
        let number = |column: usize, name| {
            let text = record.get(column).unwrap_or_default();
            let help =
                if text.contains(',') { "write decimals with a point" } else { "write a finite number, in m and N" };
            let wrong = || at(row, Some(name), &format!("`{}` is not a number", one_line(text)), help);
            text.parse::<f64>().ok().filter(|x| x.abs() <= FARTHEST).ok_or_else(wrong)
        };
        let (d, f) = (number(deformation, "deformation")?, number(force, "force")?);
        if d < 0.0 {
            let help = "give magnitudes: K dⁿ pulls or pushes back by the same law";
            return Err(at(row, Some("deformation"), &format!("{d} m is below zero"), help));
        }
        let direction = match direction.and_then(|i| record.get(i)) {
            Some("axial") => Some(Direction::Axial),
            Some("radial") => Some(Direction::Radial),
            Some(other) => {
                let what = format!("`{other}` is no direction");
                return Err(at(row, Some("direction"), &what, "directions are axial and radial"));
            }
            None => given,
        };
        // --direction picks one when the column has both.
        if let Some(direction) = direction.filter(|d| given.is_none_or(|g| g == *d)) {
            let points = test.entry(direction).or_default();
            points.deformation.push(d);
            points.force.push(f);
        }
    }
    if test.is_empty() {
        return Err(at(1, None, "there are no points", "write a row for every point of the test"));
    }
    Ok(test)
}

/// `test.csv, row 3, `force`: `x` is not a number`, and below it the way out.
impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}\n  help: {}", self.place, self.what, self.help)
    }
}

impl std::error::Error for Mistake {}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, given: Option<Direction>) -> Result<BTreeMap<Direction, Points>, String> {
        super::read(text.as_bytes(), Path::new("test.csv"), given).map_err(|e| e.to_string())
    }

    #[test]
    fn columns_stand_in_any_order_and_the_direction_may_be_given() {
        let both = "force,direction,deformation\n1,axial,0.1\n\n2,radial,0.2\n3,axial,0.3\n";
        let found = read(both, None).expect("a test");
        assert_eq!(found[&Direction::Axial], Points { deformation: vec![0.1, 0.3], force: vec![1.0, 3.0] });
        assert_eq!(found[&Direction::Radial], Points { deformation: vec![0.2], force: vec![2.0] });
        assert_eq!(read(both, Some(Direction::Radial)).expect("a test").len(), 1);
        let one = read("deformation,force\r\n0.1,1\r\n", Some(Direction::Radial)).expect("a test");
        assert_eq!(one[&Direction::Radial].force, [1.0]);
    }

    #[test]
    fn mistakes_are_told_with_row_column_and_a_way_out() {
        let cases = [
            ("", "test.csv, row 1, `deformation`: the column is missing\n  help: begin with the header"),
            (
                "direction,deformation,forse\n",
                "test.csv, row 1, `forse`: there is no such column\n  help: did you mean `force`?",
            ),
            ("force,force\n", "test.csv, row 1, `force`: the column is there twice"),
            ("deformation,force\n1,2\n", "test.csv, row 1, `direction`: the column is missing\n  help: add it"),
            (
                "direction,deformation,force\naxial,0.1,1\n\naxial,x,1\n",
                "test.csv, row 4, `deformation`: `x` is not a number",
            ),
            (
                "direction,deformation,force\naxial,\"0,1\",1\n",
                "test.csv, row 2, `deformation`: `0,1` is not a number\n  help: write decimals with a point",
            ),
            ("direction,deformation,force\naxial,0.1,inf\n", "test.csv, row 2, `force`: `inf` is not a number"),
            ("direction,deformation,force\naxial,-0.1,1\n", "test.csv, row 2, `deformation`: -0.1 m is below zero"),
            ("direction,deformation,force\nacross,0.1,1\n", "test.csv, row 2, `direction`: `across` is no direction"),
            ("direction,deformation,force\naxial,0.1\n", "test.csv, row 2: 2 fields where the header has 3"),
            ("direction,deformation,force\n", "test.csv, row 1: there are no points"),
        ];
        for (text, expected) in cases {
            let told = read(text, None).expect_err("a mistake");
            assert!(told.starts_with(expected), "{told}\n{expected}");
        }
    }
}
