//! Runs as CSV: a header, a row a sample, an empty field for a lost one.

use super::columns::{Columns, Names, Pick};
use super::mapping::Mapping;
use super::{Channel, DataProblem, Run, RunError, columns, digits};
use crate::base::number::shortest;
use crate::source::InputError;
use std::io::{BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

/// The data file. Time keeps every digit; other samples are rounded to seven significant digits and to no finer than a
/// millionth of their unit, and written with the fewest digits that read back the same.
pub fn write(run: &Run) -> Vec<u8> {
    let mut text = String::with_capacity(run.time.len() * (8 + 9 * run.channels.len()));
    text.push_str("time");
    for channel in run.channels.keys() {
        text.push(',');
        text.push_str(channel.name());
    }
    text.push('\n');
    for (i, &time) in run.time.iter().enumerate() {
        text.push_str(&shortest(time));
        for (&channel, samples) in &run.channels {
            text.push(',');
            match samples.get(i) {
                Some(x) if x.is_finite() => text.push_str(&shortest(digits::round(channel, *x))),
                _ => {}
            }
        }
        text.push('\n');
    }
    text.into_bytes()
}

/// Reads a data file; `file` is named in errors.
///
/// # Errors
///
/// The first of what [`DataProblem`] lists, with its row and column.
pub fn read(bytes: &[u8], file: &Path) -> Result<Columns, RunError> {
    read_mapped(Cursor::new(bytes), file, &Mapping::default())
}

/// The same of a file or whatever can be read twice, where a mistake is looked up when there is one, with columns as a
/// sidecar says.
///
/// # Errors
///
/// As [`read`].
pub fn read_mapped(source: impl Read + Seek, file: &Path, mapping: &Mapping) -> Result<Columns, RunError> {
    let mut source = BufReader::with_capacity(BUFFER, source);
    let is_time = |name: &str| mapping.is_time(name, &["time"]);
    let pick = |name: &str, taken: &[Channel]| mapping.pick(name, taken);
    let mut columns = table(&mut source, file, &Names { is_time: &is_time, pick: &pick }, columns::MOST_NUMBERS)?;
    mapping.scale(&mut columns);
    columns::check_trigger(&columns.1, file, 0).map_err(|error| on_line(error, &mut source))?;
    Ok(columns)
}

/// Reads a data file whose columns are another machine's.
///
/// # Errors
///
/// As [`read`], and what `pick` says.
pub fn read_as<C: columns::Column>(
    source: impl Read + Seek,
    file: &Path,
    pick: Pick<C>,
) -> Result<Columns<C>, RunError> {
    table(
        &mut BufReader::with_capacity(BUFFER, source),
        file,
        &Names { is_time: &|name| name == "time", pick },
        columns::MOST_NUMBERS,
    )
}

/// Bytes that are read at a time.
const BUFFER: usize = 1 << 20;

fn parser<R: Read>(source: R) -> ::csv::Reader<R> {
    ::csv::ReaderBuilder::new().flexible(true).has_headers(false).buffer_capacity(BUFFER).from_reader(source)
}

/// Where the text begins, behind a byte order mark.
fn begin<R: Read + Seek>(source: &mut BufReader<R>) -> std::io::Result<()> {
    source.rewind()?;
    if source.fill_buf()?.starts_with(MARK) {
        source.consume(MARK.len());
    }
    Ok(())
}

const MARK: &[u8] = b"\xef\xbb\xbf";

/// The columns that are picked. The text is read piece by piece and never held.
fn table<C: columns::Column, R: Read + Seek>(
    source: &mut BufReader<R>,
    file: &Path,
    names: &Names<C>,
    most: usize,
) -> Result<Columns<C>, RunError> {
    let error = |problem| RunError::new(file, problem);
    let unreadable = |why: std::io::Error| RunError::unreadable(file, InputError::from(why));
    begin(source).map_err(unreadable)?;
    let mut reader = parser(&mut *source);
    let mut record = ::csv::StringRecord::new();
    if !next(&mut reader, &mut record, file)? {
        return Err(error(DataProblem::NoTime));
    }
    let width = record.len();
    let (header, taken) = header(&record, file, names)?;
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); 1 + header.len()];
    let mut samples = 0;
    let wrong = loop {
        if !next(&mut reader, &mut record, file)? {
            break None;
        }
        if record.len() != width {
            break Some(error(DataProblem::Length { expected: width, found: record.len() }));
        }
        if let Err(problem) = columns::room(samples + 1, columns.len(), most) {
            break Some(error(problem));
        }
        let fields = record.iter().zip(&taken).filter(|(_, taken)| **taken).map(|(text, _)| text.trim());
        let mut mistake = None;
        for (i, (text, column)) in fields.zip(&mut columns).enumerate() {
            match sample(text) {
                Some(x) => column.push(x),
                None => mistake = mistake.or(Some((i, text))),
            }
        }
        if let Some((i, text)) = mistake {
            let name = i.checked_sub(1).and_then(|i| header.get(i)).map_or_else(|| "time".into(), C::to_string);
            break Some(error(DataProblem::NotANumber(text.to_owned())).column(&name));
        }
        samples += 1;
    };
    drop(reader);
    if let Some(error) = wrong {
        return Err(on_line(error.row(samples), source));
    }
    columns.iter_mut().for_each(Vec::shrink_to_fit);
    let mut columns = columns.into_iter();
    let time = columns.next().unwrap_or_default();
    let channels = header.into_iter().zip(columns).collect();
    columns::check(&time, &channels, file, 0).map_err(|error| on_line(error, source))?;
    Ok((time, channels))
}

/// The next record; `false` at the end.
fn next<R: Read>(
    reader: &mut ::csv::Reader<R>,
    record: &mut ::csv::StringRecord,
    file: &Path,
) -> Result<bool, RunError> {
    reader.read_record(record).map_err(|why| {
        let row = why.position().map(|p| p.line() as usize);
        let problem = match why.kind() {
            ::csv::ErrorKind::Utf8 { .. } => DataProblem::Malformed("this is not text in UTF-8".to_owned()),
            ::csv::ErrorKind::Io(why) => DataProblem::Unreadable(why.to_string()),
            _ => DataProblem::Malformed(why.to_string()),
        };
        row.into_iter().fold(RunError::new(file, problem), RunError::row)
    })
}

/// An error whose row is the number of a sample, from 0, with the sample's line instead. Fields may hold line breaks,
/// and empty lines are passed over, so the source is gone through again.
fn on_line<R: Read + Seek>(mut error: RunError, source: &mut BufReader<R>) -> RunError {
    error.place.row = error.place.row.and_then(|sample| line_of(source, sample));
    error
}

/// The line on which a sample begins, from 0 behind the header.
fn line_of<R: Read + Seek>(source: &mut BufReader<R>, sample: usize) -> Option<usize> {
    begin(source).ok()?;
    let mark = source.stream_position().ok()?;
    let mut reader = parser(&mut *source);
    let mut record = ::csv::ByteRecord::new();
    for _ in 0..sample + 2 {
        if !reader.read_byte_record(&mut record).ok()? {
            return None;
        }
    }
    drop(reader);
    let position = record.position()?;
    source.seek(SeekFrom::Start(mark + position.byte())).ok()?;
    let ends = source.bytes().map_while(Result::ok).take_while(|b| matches!(b, b'\r' | b'\n'));
    Some(position.line() as usize + ends.filter(|b| *b == b'\n').count())
}

/// The line on which a record begins: its position is where the one before ended, and empty lines are passed over.
pub(crate) fn line(bytes: &[u8], position: &::csv::Position) -> usize {
    let rest = bytes.get(position.byte() as usize..).unwrap_or_default();
    let empty = rest.iter().take_while(|b| matches!(b, b'\r' | b'\n')).filter(|&&b| b == b'\n').count();
    position.line() as usize + empty
}

/// The channels behind `time`, and of each column whether it is taken.
fn header<C: Ord>(
    record: &::csv::StringRecord,
    file: &Path,
    names: &Names<C>,
) -> Result<(Vec<C>, Vec<bool>), RunError> {
    let error = |problem| RunError::new(file, problem).row(1);
    if !record.get(0).map(str::trim).is_some_and(names.is_time) {
        return Err(error(DataProblem::NoTime));
    }
    let mut channels = Vec::with_capacity(record.len());
    let mut taken = vec![true];
    for name in record.iter().skip(1).map(str::trim) {
        let channel = (names.pick)(name, &channels).map_err(|problem| error(problem).column(name))?;
        taken.push(channel.is_some());
        channels.extend(channel);
    }
    Ok((channels, taken))
}

/// A number, or NaN for an empty field.
fn sample(text: &str) -> Option<f64> {
    if text.is_empty() { Some(f64::NAN) } else { text.parse().ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &[u8]) -> String {
        read(text, Path::new("run.csv")).expect_err("a mistake").to_string()
    }

    #[test]
    fn what_is_written_reads_back_and_writes_the_same() {
        let mut run = Run { time: vec![0.0, 0.1 + 0.2, 1.0], ..Run::default() };
        run.channels.insert(Channel::Trigger, vec![0.0, 1.0, f64::NAN]);
        run.channels.insert(Channel::SteerLeft, vec![-0.0, 123.456_789, 1e-20]);
        run.channels.insert(Channel::JointXi, vec![f64::NAN, -2.5, 1e9]);
        let text = write(&run);
        let expected =
            "time,steer_left,joint_xi,trigger\n0,0,,0\n0.30000000000000004,123.4568,-2.5,1\n1,0,1000000000,\n";
        assert_eq!(String::from_utf8_lossy(&text), expected);
        let (time, channels) = read(&text, Path::new("run.csv")).expect("a run");
        assert_eq!(time, run.time);
        assert!(channels[&Channel::JointXi][0].is_nan());
        assert_eq!(write(&Run { time, channels, ..Run::default() }), text);
    }

    #[test]
    fn beyond_the_limit_the_way_out_is_told() {
        let text = b"time,joint_xi\n0,1\n1,2\n\n2,3\n";
        let pick = |name: &str, taken: &[Channel]| columns::channel(name, taken).map(Some);
        let within = |most| {
            table(
                &mut BufReader::new(Cursor::new(text)),
                Path::new("run.csv"),
                &Names { is_time: &|name| name == "time", pick: &pick },
                most,
            )
        };
        assert!(within(6).is_ok());
        let told = within(5).expect_err("too long").to_string();
        let expected = "run.csv, row 5: the run has more than 5 numbers, in 2 columns: that is the limit\n  \
                        help: split the file into runs of 2 rows or fewer";
        assert!(told.starts_with(expected), "{told}");
    }

    #[test]
    fn what_others_write_is_read() {
        let text = b"\xef\xbb\xbftime, steer_left\r\n0,1e2\r\n\r\n0.5,nan\r\n";
        let (time, channels) = read(text, Path::new("run.csv")).expect("a run");
        assert_eq!(time, [0.0, 0.5]);
        assert_eq!(channels[&Channel::SteerLeft][0], 100.0);
        assert!(channels[&Channel::SteerLeft][1].is_nan());
    }

    #[test]
    fn mistakes_are_told_with_row_column_and_a_way_out() {
        let cases: [(&[u8], &str); 18] = [
            (b"", "run.csv: the first column is not `time`"),
            (b"time;joint_xi\n0;1\n", "run.csv, row 1: the first column is not `time`"),
            (
                b"time,joint_x\n0,1\n1,2\n",
                "run.csv, row 1, `joint_x`: there is no such column\n  help: did you mean `joint_xi`?",
            ),
            (b"time,joint_xi,joint_xi\n", "run.csv, row 1, `joint_xi`: the column is there twice"),
            (b"time,joint_xi\n0,1\n\n1,x\n", "run.csv, row 4, `joint_xi`: `x` is not a number"),
            (
                b"time,joint_xi\n0,\"1,5\"\n",
                "run.csv, row 2, `joint_xi`: `1,5` is not a number\n  help: write decimals with a point",
            ),
            (b"time,joint_xi\n0,1\n1\n", "run.csv, row 3: 1 field where the first row has 2"),
            (b"time,joint_xi\n0,1\n0,2\n", "run.csv, row 3, `time`: 0 s does not come after 0 s"),
            (b"time,joint_xi\n0,1\n\n2,2\n1,3\n", "run.csv, row 5, `time`: 1 s does not come after 2 s"),
            (b"time,joint_xi\n0,1\n,2\n", "run.csv, row 3, `time`: the time is missing"),
            (b"time,joint_xi\n0,1\n1,1e999\n", "run.csv, row 3, `joint_xi`: the number is not finite"),
            (
                b"time,joint_xi\n0,1\n\n1,-1e308\n",
                "run.csv, row 4, `joint_xi`: -1e308 is beyond ±1e9 N\n  help: leave the field of a lost sample empty",
            ),
            (b"time,temperature\n0,1\n1,10001\n", "run.csv, row 3, `temperature`: 1.0001e4 is beyond ±1e4 °C"),
            (b"time,joint_xi\n0,1\n1e300,1\n", "run.csv, row 3, `time`: 1e300 is beyond ±1e12 s"),
            (b"time,joint_xi\n0,1\n1e-300,1\n", "run.csv, row 3, `time`: 0."),
            (b"time,trigger\n0,1\n1,0.5\n", "run.csv, row 3, `trigger`: 0.5 is neither 0 nor 1"),
            (b"time,joint_xi\n0,1\n", "run.csv: there are fewer than two samples"),
            (b"time,joint_xi\n0,1\n1,\xff\n", "run.csv, row 3: is malformed: this is not text in UTF-8"),
        ];
        for (text, expected) in cases {
            let told = told(text);
            assert!(told.starts_with(expected), "{told}\n{expected}");
        }
    }
}
