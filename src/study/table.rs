//! One table of all that a study found: a row a task, in the plan's order, whatever order they were done in.

use super::place::{Place, State};
use super::plan::Plan;
use crate::base::number::shortest;
use crate::semantics::dimension::{Dimension, parse_unit, quantity};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A table with one type in each column.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The study's.
    pub name: String,
    pub columns: Vec<Column>,
    pub rows: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    pub name: String,
    pub role: Role,
    /// Of numbers with a dimension: the SI unit that they are in.
    pub unit: String,
    pub cells: Cells,
}

/// What a column is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Sweep, task, state, error.
    About,
    Parameter,
    Result,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    Numbers(Vec<Option<f64>>),
    Truths(Vec<Option<bool>>),
    Texts(Vec<Option<String>>),
}

impl Cells {
    /// A cell as CSV has it.
    pub fn text(&self, row: usize) -> String {
        match self {
            Cells::Numbers(cells) => cells.get(row).copied().flatten().map_or_else(String::new, shortest),
            Cells::Truths(cells) => cells.get(row).copied().flatten().map_or_else(String::new, |it| it.to_string()),
            Cells::Texts(cells) => cells.get(row).cloned().flatten().unwrap_or_default(),
        }
    }

    /// Puts values where there is nothing.
    fn fill(&mut self, values: &[Option<&Value>]) {
        fn put<T>(cells: &mut [Option<T>], values: &[Option<&Value>], of: impl Fn(&Value) -> Option<T>) {
            let empty = cells.iter_mut().zip(values).filter(|(cell, _)| cell.is_none());
            empty.for_each(|(cell, value)| *cell = value.and_then(&of));
        }
        match self {
            Cells::Numbers(cells) => put(cells, values, Value::as_f64),
            Cells::Truths(cells) => put(cells, values, Value::as_bool),
            Cells::Texts(cells) => put(cells, values, |value| value.as_str().map(str::to_owned)),
        }
    }

    /// Whether not all cells are the same.
    pub fn varies(&self) -> bool {
        match self {
            Cells::Numbers(cells) => cells.windows(2).any(|w| w[0] != w[1]),
            Cells::Truths(cells) => cells.windows(2).any(|w| w[0] != w[1]),
            Cells::Texts(cells) => cells.windows(2).any(|w| w[0] != w[1]),
        }
    }
}

impl Table {
    /// Of all tasks: also of those that failed, which have an error, and of those that are open, which have nothing.
    pub fn collect(plan: &Plan, place: &Place) -> Table {
        let mut about: [Vec<Option<String>>; 4] = Default::default();
        let mut found = Vec::new();
        for task in &plan.tasks {
            let values = place.found(&task.hash).map(|found| found.values);
            let failed = if values.is_some() { None } else { place.failed(&task.hash) };
            let state = match (&values, &failed) {
                (Some(_), _) => State::Done,
                (None, Some(_)) => State::Failed,
                // Whether somebody is at it is another question a moment later.
                (None, None) => State::Open,
            };
            about[0].push(Some(task.sweep.clone()));
            about[1].push(Some(task.hash.clone()));
            about[2].push(Some(state.name().to_owned()));
            about[3].push(failed.map(|failed| format!("{}: {}", failed.step, failed.line())));
            found.push(values.unwrap_or_default());
        }
        let [sweep, task, status, error] = about;
        let plain = |name: &str, cells| Column {
            name: name.to_owned(),
            role: Role::About,
            unit: String::new(),
            cells: Cells::Texts(cells),
        };
        let mut columns = vec![plain("sweep", sweep), plain("task", task), plain("status", status)];
        let mut keys: Vec<&str> = Vec::new();
        let mut known = BTreeSet::new();
        for (key, _) in plan.tasks.iter().flat_map(|task| &task.parameters) {
            if known.insert(key.as_str()) {
                keys.push(key);
            }
        }
        for key in keys {
            let cells: Vec<Option<&str>> = plan.tasks.iter().map(|task| task.parameter(key)).collect();
            let mut column = parameter(key, &cells);
            column.cells.fill(&found.iter().map(|values| values.get(key)).collect::<Vec<_>>());
            columns.push(column);
        }
        let names: BTreeSet<&String> = found.iter().flat_map(|values| values.keys()).collect();
        // A result that a parameter sets, such as the layout of a file, stands in its column.
        for name in names.into_iter().filter(|name| !known.contains(name.as_str())) {
            let cells: Vec<Option<&Value>> = found.iter().map(|values| values.get(name)).collect();
            let cells = result(&cells);
            columns.push(Column { name: name.clone(), role: Role::Result, unit: String::new(), cells });
        }
        columns.push(plain("error", error));
        Table { name: plan.name.clone(), columns, rows: plan.tasks.len() }
    }

    /// Of each row, its state's name.
    pub fn states(&self) -> impl Iterator<Item = String> + '_ {
        let states = self.columns.iter().find(|column| column.role == Role::About && column.name == "status");
        states.into_iter().flat_map(|column| (0..self.rows).map(|row| column.cells.text(row)))
    }

    /// With a line of names, commas, and nothing where there is nothing.
    pub fn csv(&self) -> Vec<u8> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        // Writing into memory does not fail.
        let _ = writer.write_record(self.columns.iter().map(|column| column.name.as_str()));
        for row in 0..self.rows {
            let _ = writer.write_record(self.columns.iter().map(|column| column.cells.text(row)));
        }
        writer.into_inner().unwrap_or_default()
    }

    /// One row group, snappy, every column optional: doubles, truths, or UTF-8.
    ///
    /// # Errors
    ///
    /// What the encoder says, which for these columns is nothing.
    pub fn parquet(&self) -> Result<Vec<u8>, ParquetError> {
        let fields = self.columns.iter().map(field).collect::<Result<_, _>>()?;
        let schema = Arc::new(Type::group_type_builder("study").with_fields(fields).build()?);
        let properties =
            WriterProperties::builder().set_created_by("lss".to_owned()).set_compression(Compression::SNAPPY).build();
        let mut bytes = Vec::new();
        let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
        let mut group = writer.next_row_group()?;
        for column in &self.columns {
            match &column.cells {
                Cells::Numbers(cells) => put::<DoubleType>(&mut group, cells)?,
                Cells::Truths(cells) => put::<BoolType>(&mut group, cells)?,
                Cells::Texts(cells) => {
                    let cells: Vec<Option<ByteArray>> =
                        cells.iter().map(|cell| cell.as_deref().map(ByteArray::from)).collect();
                    put::<ByteArrayType>(&mut group, &cells)?;
                }
            }
        }
        group.close()?;
        writer.close()?;
        Ok(bytes)
    }
}

fn field(column: &Column) -> Result<TypePtr, ParquetError> {
    let (physical, logical) = match column.cells {
        Cells::Numbers(_) => (Physical::DOUBLE, None),
        Cells::Truths(_) => (Physical::BOOLEAN, None),
        Cells::Texts(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
    };
    let field = Type::primitive_type_builder(&column.name, physical);
    field.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build().map(Arc::new)
}

/// Writes a column: which cells there are, and their values.
fn put<T: DataType>(
    group: &mut SerializedRowGroupWriter<&mut Vec<u8>>,
    cells: &[Option<T::T>],
) -> Result<(), ParquetError> {
    let there: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    let values: Vec<T::T> = cells.iter().flatten().cloned().collect();
    if let Some(mut writer) = group.next_column()? {
        writer.typed::<T>().write_batch(&values, Some(&there), None)?;
        writer.close()?;
    }
    Ok(())
}

/// A parameter's column: numbers in SI units where all values are numbers of one dimension, else what was written.
fn parameter(key: &str, cells: &[Option<&str>]) -> Column {
    let numbers: Option<Vec<Option<(f64, Dimension)>>> =
        cells.iter().map(|cell| cell.map_or(Some(None), |text| quantity(text).map(Some))).collect();
    let mut unit = String::new();
    let texts = || Cells::Texts(cells.iter().map(|cell| cell.map(str::to_owned)).collect());
    let cells = match numbers {
        Some(numbers) => {
            let mut dimensions: Vec<Dimension> = numbers.iter().flatten().map(|(_, d)| *d).collect();
            dimensions.dedup();
            if dimensions.len() == 1 {
                unit = si(dimensions[0]);
                Cells::Numbers(numbers.into_iter().map(|cell| cell.map(|(x, _)| x)).collect())
            } else {
                texts()
            }
        }
        None if cells.iter().flatten().all(|text| ["true", "false"].contains(text)) => {
            Cells::Truths(cells.iter().map(|cell| cell.map(|text| text == "true")).collect())
        }
        None => texts(),
    };
    Column { name: key.to_owned(), role: Role::Parameter, unit, cells }
}

/// The SI unit of a dimension.
fn si(dimension: Dimension) -> String {
    if dimension == Dimension::NONE {
        return String::new();
    }
    let usual = dimension.unit().filter(|unit| parse_unit(unit).is_ok_and(|u| u.factor == 1.0 && u.offset == 0.0));
    usual.map_or_else(|| dimension.spelled(), str::to_owned)
}

/// A result's column. Values of several types are told as texts.
fn result(cells: &[Option<&Value>]) -> Cells {
    let all = |is: &dyn Fn(&Value) -> bool| cells.iter().flatten().all(|value| is(value));
    if all(&Value::is_number) {
        Cells::Numbers(cells.iter().map(|cell| cell.and_then(Value::as_f64)).collect())
    } else if all(&Value::is_boolean) {
        Cells::Truths(cells.iter().map(|cell| cell.and_then(Value::as_bool)).collect())
    } else {
        let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        Cells::Texts(cells.iter().map(|cell| cell.map(text)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::plan::Task;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;
    use std::collections::BTreeMap;
    use std::path::PathBuf;

    #[test]
    fn numbers_with_units_are_told_in_si() {
        for (text, value, unit) in [
            ("1.5 m/s", 1.5, "m/s"),
            ("1250mm", 1.25, "m"),
            ("-3e2 N", -300.0, "N"),
            ("7", 7.0, ""),
            ("20 °C", 293.15, "K"),
            ("180 deg", std::f64::consts::PI, "rad"),
        ] {
            let (x, dimension) = quantity(text).unwrap();
            assert!((x - value).abs() < 1e-9, "{text}: {x}");
            assert_eq!(si(dimension), unit, "{text}");
        }
        for text in ["", "m", "2 * 3 m", "1.5 furlongs", "flores", "1e999", "--3"] {
            assert_eq!(quantity(text), None, "{text}");
        }
    }

    fn task(hash: &str, parameters: &[(&str, &str)]) -> Task {
        let parameters = parameters.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        Task { hash: hash.into(), sweep: "s".into(), parameters, steps: vec![], contents: vec![], keep: true }
    }

    fn table() -> (tempfile::TempDir, Table) {
        let folder = tempfile::tempdir().unwrap();
        let place = Place::new(folder.path(), false).unwrap();
        let hashes = ["aaaaaaaaaaaaaaaa", "bbbbbbbbbbbbbbbb", "cccccccccccccccc"];
        let tasks = vec![
            task(hashes[0], &[("file", "a.lss"), ("simulate.speed", "1 m/s"), ("build.pdf", "true")]),
            task(hashes[1], &[("file", "a.lss"), ("simulate.speed", "500 mm/s"), ("let.n", "2 * 3")]),
            task(hashes[2], &[("file", "b, \"c\".lss"), ("build.layout", "b")]),
        ];
        let plan = Plan { name: "x".into(), folder: PathBuf::new(), contents: BTreeMap::new(), tasks };
        for (hash, x) in [(hashes[1], 2.0), (hashes[0], 1.0)] {
            std::fs::create_dir_all(place.task(hash)).unwrap();
            let values = [
                ("build.length_m", Value::from(x)),
                ("build.feasible", Value::from(true)),
                ("build.layout", Value::from("a")),
            ];
            let values = values.map(|(name, value)| (name.to_owned(), value));
            place.keep(hash, &values.into(), x).unwrap();
        }
        let table = Table::collect(&plan, &place);
        (folder, table)
    }

    #[test]
    fn a_table_has_a_row_a_task_and_a_column_a_name() {
        let (_folder, table) = table();
        insta::assert_snapshot!(String::from_utf8(table.csv()).unwrap(), @r#"
        sweep,task,status,file,simulate.speed,build.pdf,let.n,build.layout,build.feasible,build.length_m,error
        s,aaaaaaaaaaaaaaaa,done,a.lss,1,true,,a,true,1,
        s,bbbbbbbbbbbbbbbb,done,a.lss,0.5,,2 * 3,a,true,2,
        s,cccccccccccccccc,open,"b, ""c"".lss",,,,b,,,
        "#);
        let names: BTreeSet<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names.len(), table.columns.len(), "readers of Parquet find columns by their names");
    }

    #[test]
    fn parquet_holds_what_csv_does() {
        let (_folder, table) = table();
        let bytes = table.parquet().unwrap();
        assert_eq!(bytes, table.parquet().unwrap());
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 3);
        for (k, row) in rows.iter().enumerate() {
            let cells: Vec<(String, String)> = row
                .get_column_iter()
                .map(|(name, cell)| {
                    let text = match cell {
                        Field::Null => String::new(),
                        Field::Str(text) => text.clone(),
                        Field::Double(x) => shortest(*x),
                        other => other.to_string(),
                    };
                    (name.clone(), text)
                })
                .collect();
            let expected: Vec<(String, String)> =
                table.columns.iter().map(|column| (column.name.clone(), column.cells.text(k))).collect();
            assert_eq!(cells, expected);
        }
    }
}
