//! Runs as Parquet: a column of doubles for time and for each channel, NaN for a lost sample.

use super::columns::{Columns, Names, Pick};
use super::mapping::Mapping;
use super::{DataProblem, Run, RunError, columns, digits};
use ::parquet::basic::{Compression, Encoding, Repetition, Type as Physical};
use ::parquet::column::page::{Page, PageMetadata, PageReader};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use ::parquet::data_type::{DataType, DoubleType};
use ::parquet::errors::ParquetError;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::Type;
use bytes::Bytes;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::{Arc, Once};

/// The data file: one row group, snappy, the same bytes for the same run. Samples are rounded as [`super::csv::write`]
/// does, so that a run says the same in both formats.
///
/// # Errors
///
/// What the encoder says, which for the columns of a run is nothing.
pub fn write(run: &Run) -> Result<Vec<u8>, ParquetError> {
    let names = std::iter::once("time").chain(run.channels.keys().map(|c| c.name()));
    let field = |name| {
        Type::primitive_type_builder(name, Physical::DOUBLE).with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = names.map(field).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("run").with_fields(fields).build()?);
    let properties =
        WriterProperties::builder().set_created_by("lss".to_owned()).set_compression(Compression::SNAPPY).build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    let rounded = run.channels.iter().map(|(&c, samples)| samples.iter().map(|&x| digits::round(c, x)).collect());
    for column in std::iter::once(run.time.clone()).chain(rounded) {
        if let Some(mut writer) = group.next_column()? {
            writer.typed::<DoubleType>().write_batch(&column, None, None)?;
            writer.close()?;
        }
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

/// Reads a data file; `file` is named in errors. Columns may be of any type of number or of truth values, and optional:
/// null is a lost sample.
///
/// # Errors
///
/// The first of what [`DataProblem`] lists, with its row and column.
pub fn read<R: ChunkReader + 'static>(data: R, file: &Path) -> Result<Columns, RunError> {
    read_mapped(data, file, &Mapping::default())
}

/// The same with columns as a sidecar says.
///
/// # Errors
///
/// As [`read`].
pub fn read_mapped<R: ChunkReader + 'static>(data: R, file: &Path, mapping: &Mapping) -> Result<Columns, RunError> {
    let is_time = |name: &str| mapping.is_time(name, &["time"]);
    let mut columns = picked(data, file, &Names { is_time: &is_time, pick: &|name, taken| mapping.pick(name, taken) })?;
    mapping.scale(&mut columns);
    columns::check_trigger(&columns.1, file, 1)?;
    Ok(columns)
}

/// Reads a data file whose columns are another machine's.
///
/// # Errors
///
/// As [`read`], and what `pick` says.
pub fn read_as<C: columns::Column, R: ChunkReader + 'static>(
    data: R,
    file: &Path,
    pick: Pick<C>,
) -> Result<Columns<C>, RunError> {
    picked(data, file, &Names { is_time: &|name| name == "time", pick })
}

fn picked<C: columns::Column, R: ChunkReader + 'static>(
    data: R,
    file: &Path,
    names: &Names<C>,
) -> Result<Columns<C>, RunError> {
    let torn =
        || RunError::new(file, DataProblem::Malformed("the decoder stopped at bytes that make no sense".to_owned()));
    quietly(|| decode(data, file, names)).unwrap_or_else(|| Err(torn()))
}

thread_local! {
    /// Whether a panic of this thread is told by an error.
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// What `work` returns, or nothing where it panics: the decoder asserts what a torn file need not hold.
fn quietly<T>(work: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |what| {
            if !QUIET.get() {
                before(what);
            }
        }));
    });
    QUIET.set(true);
    let done = panic::catch_unwind(AssertUnwindSafe(work));
    QUIET.set(false);
    done.ok()
}

fn decode<C: columns::Column, R: ChunkReader + 'static>(
    data: R,
    file: &Path,
    named: &Names<C>,
) -> Result<Columns<C>, RunError> {
    let error = |problem| RunError::new(file, problem);
    let malformed = |why: ParquetError| error(DataProblem::Malformed(why.to_string()));
    let reader = SerializedFileReader::new(Ended(data)).map_err(malformed)?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let mut names = schema.columns().iter().map(|c| c.path().string());
    if !names.next().as_deref().is_some_and(named.is_time) {
        return Err(error(DataProblem::NoTime));
    }
    if schema.columns().iter().any(|c| c.max_rep_level() > 0) {
        return Err(error(DataProblem::Malformed("a column holds lists".to_owned())));
    }
    let mut channels: Vec<C> = Vec::new();
    // The columns that are taken, by their place in the file.
    let mut taken = vec![0];
    for (i, name) in names.enumerate() {
        let channel = (named.pick)(&name, &channels).map_err(|problem| error(problem).column(&name))?;
        taken.extend(channel.is_some().then_some(i + 1));
        channels.extend(channel);
    }
    // The reader takes for granted what a torn file need not hold.
    let chunks = reader.metadata().row_groups().iter().flat_map(|g| g.columns());
    let backwards = |x: Option<i64>| x.is_some_and(|x| x < 0);
    for chunk in chunks {
        let (begin, size) = (chunk.data_page_offset(), chunk.compressed_size());
        if backwards(Some(begin)) || backwards(chunk.dictionary_page_offset()) || size < 0 {
            return Err(error(DataProblem::Malformed("a column begins before the file".to_owned())));
        }
    }
    // A column that repeats one value takes some bytes, however long it is.
    let groups = reader.metadata().row_groups().iter().map(|g| g.num_rows().max(0)).fold(0, i64::saturating_add);
    let rows = usize::try_from(groups).unwrap_or(usize::MAX);
    columns::room(rows, 1 + channels.len(), columns::MOST_NUMBERS).map_err(error)?;
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); 1 + channels.len()];
    for g in 0..reader.num_row_groups() {
        let group = reader.get_row_group(g).map_err(malformed)?;
        for (k, (column, &i)) in columns.iter_mut().zip(&taken).enumerate() {
            let name = k.checked_sub(1).and_then(|k| channels.get(k)).map_or_else(|| "time".to_owned(), C::to_string);
            let pages = group.get_column_page_reader(i).map_err(malformed)?;
            let pages = Box::new(Checked { pages, has_dictionary: false });
            let read = match get_column_reader(schema.column(i), pages) {
                ColumnReader::DoubleColumnReader(r) => append(r, column, rows, |x| x),
                ColumnReader::FloatColumnReader(r) => append(r, column, rows, f64::from),
                ColumnReader::Int32ColumnReader(r) => append(r, column, rows, f64::from),
                ColumnReader::Int64ColumnReader(r) => append(r, column, rows, |x| x as f64),
                ColumnReader::BoolColumnReader(r) => append(r, column, rows, |x| f64::from(u8::from(x))),
                _ => return Err(error(DataProblem::NotANumber("a column of text".to_owned())).column(&name)),
            };
            read.map_err(|why| malformed(why).column(&name))?;
        }
    }
    columns.iter_mut().for_each(Vec::shrink_to_fit);
    let mut columns = columns.into_iter();
    let time = columns.next().unwrap_or_default();
    let channels: BTreeMap<_, _> = channels.into_iter().zip(columns).collect();
    columns::check(&time, &channels, file, 1)?;
    Ok((time, channels))
}

/// Data whose end is an error to read beyond. The decoder passes over fields that it does not know, and takes an end
/// for bytes passed over: a length of 2³¹ in a torn header would keep it busy for minutes.
struct Ended<R>(R);

impl<R: Length> Length for Ended<R> {
    fn len(&self) -> u64 {
        self.0.len()
    }
}

impl<R: ChunkReader> ChunkReader for Ended<R> {
    type T = Ended<R::T>;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        self.0.get_read(start).map(Ended)
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        self.0.get_bytes(start, length)
    }
}

impl<R: Read> Read for Ended<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self.0.read(bytes)? {
            0 if !bytes.is_empty() => Err(io::ErrorKind::UnexpectedEof.into()),
            size => Ok(size),
        }
    }
}

/// Pages of a column, of which each that is coded by a dictionary has one, and that as long as it says: the decoder
/// takes both for granted.
struct Checked {
    pages: Box<dyn PageReader>,
    has_dictionary: bool,
}

impl Iterator for Checked {
    type Item = Result<Page, ParquetError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for Checked {
    fn get_next_page(&mut self) -> Result<Option<Page>, ParquetError> {
        let page = self.pages.get_next_page()?;
        match &page {
            // The decoder makes room for as many as the header says.
            Some(Page::DictionaryPage { buf, num_values, .. }) if *num_values as usize > buf.len() => {
                return Err(ParquetError::General("a dictionary has less than its header says".to_owned()));
            }
            Some(Page::DictionaryPage { .. }) => self.has_dictionary = true,
            #[allow(deprecated)]
            Some(page)
                if !self.has_dictionary
                    && matches!(page.encoding(), Encoding::RLE_DICTIONARY | Encoding::PLAIN_DICTIONARY) =>
            {
                return Err(ParquetError::General("a page lacks its dictionary".to_owned()));
            }
            _ => {}
        }
        Ok(page)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>, ParquetError> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<(), ParquetError> {
        self.pages.skip_next_page()
    }
}

/// Reads a column of a row group to its end. The file says how many `rows` there are of all groups; no more are read.
fn append<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    column: &mut Vec<f64>,
    rows: usize,
    number: impl Fn(T::T) -> f64,
) -> Result<(), ParquetError> {
    const BATCH: usize = 8192;
    let (mut values, mut levels) = (Vec::with_capacity(BATCH), Vec::with_capacity(BATCH));
    loop {
        values.clear();
        levels.clear();
        let (records, _, _) = reader.read_records(BATCH, Some(&mut levels), None, &mut values)?;
        if records == 0 {
            return Ok(());
        }
        if column.len() + records > rows {
            return Err(ParquetError::General("a column has more rows than the file".to_owned()));
        }
        // Grown by doubling, it would take up to twice what it holds.
        if column.capacity() < column.len() + records {
            column.reserve_exact((rows - column.len()).min(column.len().max(BATCH)).max(records));
        }
        let mut numbers = values.drain(..).map(&number);
        if levels.is_empty() {
            column.extend(numbers);
        } else {
            column.extend(levels.iter().map(|&l| if l > 0 { numbers.next().unwrap_or(f64::NAN) } else { f64::NAN }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Channel, csv};
    use super::*;
    use std::io::Write;

    fn run() -> Run {
        let mut run = Run { time: (0..20_000).map(|i| f64::from(i) / 500.0).collect(), ..Run::default() };
        let force = |i: usize| 400.0 + crate::base::trig::sin(i as f64 / 7.0) * 99.123_456_789;
        run.channels.insert(Channel::JointXi, (0..20_000).map(force).collect());
        run.channels.insert(Channel::Trigger, (0..20_000).map(|i| f64::from(u8::from(i % 500 < 25))).collect());
        run.channels.entry(Channel::JointXi).and_modify(|x| x[7] = f64::NAN);
        run
    }

    fn back(bytes: &[u8]) -> Result<Columns, RunError> {
        let mut file = tempfile::tempfile().expect("a file");
        file.write_all(bytes).expect("written");
        read(file, Path::new("run.parquet"))
    }

    #[test]
    fn both_formats_say_the_same_and_write_the_same_bytes() {
        let run = run();
        let bytes = write(&run).expect("columns");
        assert_eq!(bytes, write(&run).expect("columns"));
        let (time, channels) = back(&bytes).expect("a run");
        let (csv_time, csv_channels) = csv::read(&csv::write(&run), Path::new("run.csv")).expect("a run");
        assert_eq!(time, csv_time);
        let bits = |c: &BTreeMap<Channel, Vec<f64>>| -> Vec<u64> {
            c.values().flatten().map(|x| if x.is_nan() { 1 } else { x.to_bits() }).collect()
        };
        assert_eq!(bits(&channels), bits(&csv_channels));
    }

    #[test]
    fn columns_are_what_a_sidecar_says() {
        let bytes = write(&run()).expect("columns");
        let table = "time = { channel = \"time\", factor = 0.001 }\njoint_xi = { channel = \"joint_eta\", offset = 5 }\nother = false";
        let mapping = Mapping::new(&toml::from_str(table).expect("a table")).expect("channels");
        let mut file = tempfile::tempfile().expect("a file");
        file.write_all(&bytes).expect("written");
        let (time, channels) = read_mapped(file, Path::new("run.parquet"), &mapping).expect("a run");
        let (plain_time, plain) = back(&bytes).expect("a run");
        assert_eq!(time[100], 0.001 * plain_time[100]);
        assert_eq!(channels[&Channel::JointEta][100], plain[&Channel::JointXi][100] + 5.0);
        assert!(!channels.contains_key(&Channel::JointXi));
        assert_eq!(mapping.unused().as_deref(), Some("other"));
    }

    /// Columns as other writers have them: several row groups, optional, of smaller types.
    #[test]
    fn what_others_write_is_read() {
        use ::parquet::data_type::{BoolType, FloatType, Int64Type};
        use ::parquet::schema::parser::parse_message_type;
        let schema = "message schema { required int64 time; optional float joint_xi; required boolean trigger; }";
        let schema = Arc::new(parse_message_type(schema).expect("a schema"));
        let mut bytes = Vec::new();
        let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::default()).expect("a writer");
        for times in [[0, 1], [2, 3]] {
            let mut group = writer.next_row_group().expect("a group");
            let mut column = group.next_column().expect("a column").expect("time");
            column.typed::<Int64Type>().write_batch(&times, None, None).expect("written");
            column.close().expect("closed");
            let mut column = group.next_column().expect("a column").expect("joint_xi");
            column.typed::<FloatType>().write_batch(&[2.5], Some(&[0, 1]), None).expect("written");
            column.close().expect("closed");
            let mut column = group.next_column().expect("a column").expect("trigger");
            column.typed::<BoolType>().write_batch(&[false, true], None, None).expect("written");
            column.close().expect("closed");
            group.close().expect("closed");
        }
        writer.close().expect("closed");
        let (time, channels) = back(&bytes).expect("a run");
        assert_eq!(time, [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(channels[&Channel::Trigger], [0.0, 1.0, 0.0, 1.0]);
        let joint = &channels[&Channel::JointXi];
        assert!(joint[0].is_nan() && joint[2].is_nan() && joint[1] == 2.5 && joint[3] == 2.5);
    }

    #[test]
    fn columns_are_told_apart_by_name() {
        use ::parquet::schema::parser::parse_message_type;
        let cases = [
            ("required double joint_xi;", "run.parquet: the first column is not `time`"),
            ("required double time; required double joint_x;", "run.parquet, `joint_x`: there is no such column"),
            ("required double time; repeated double joint_xi;", "run.parquet: is malformed: a column holds lists"),
            ("required double time; required double run_left;", "run.parquet: there are fewer than two samples"),
        ];
        for (columns, expected) in cases {
            let schema = Arc::new(parse_message_type(&format!("message schema {{ {columns} }}")).expect("a schema"));
            let mut bytes = Vec::new();
            let writer = SerializedFileWriter::new(&mut bytes, schema, Arc::default()).expect("a writer");
            writer.close().expect("closed");
            let told = back(&bytes).expect_err("a mistake").to_string();
            assert!(told.starts_with(expected), "{told}");
        }
    }

    #[test]
    fn torn_and_foreign_files_are_refused() {
        let bytes = write(&run()).expect("columns");
        for length in [0, 3, 4, 100, bytes.len() / 2, bytes.len() - 1] {
            let error = back(&bytes[..length]).expect_err("torn");
            assert!(matches!(error.problem, DataProblem::Malformed(_)), "{error}");
        }
        assert!(matches!(back(b"time,joint_xi\n0,1\n").expect_err("CSV").problem, DataProblem::Malformed(_)));
    }

    /// Any byte may be wrong: that ends in an error or in other numbers, never in a panic.
    #[test]
    fn a_wrong_byte_is_no_panic() {
        let mut run = run();
        run.time.truncate(40);
        run.channels.values_mut().for_each(|c| c.truncate(40));
        let bytes = write(&run).expect("columns");
        for i in 0..bytes.len() {
            let mut bytes = bytes.clone();
            bytes[i] ^= 0x55;
            let _ = back(&bytes);
        }
    }
}
