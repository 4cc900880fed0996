//! The lines of a file that a report shows, shortened where they are long.
//!
//! miette reads excerpts through [`miette::SourceCode`] by byte offset and would walk the whole file for each label.
//! An [`Excerpt`] holds only the lines around the labels, with offsets of its own and the true line numbers.

use std::ops::Range;

use miette::{MietteError, MietteSpanContents, SourceSpan, SpanContents};

use crate::source::{SourceFile, Span, one_line, steers};

/// Lines longer than this many bytes are cut to a window about their first label.
const LONGEST_LINE: usize = 150;
/// Bytes that a window keeps before its label.
const LEAD: usize = 60;

#[derive(Clone, Debug)]
pub(super) struct Excerpt {
    name: String,
    text: String,
    lines: Vec<ShownLine>,
    /// Where a label begins in `text`, and the column (zero-based) where it begins in the file.
    columns: Vec<(usize, usize)>,
}

#[derive(Clone, Debug)]
struct ShownLine {
    /// Zero-based line of the file.
    number: usize,
    /// In `text`, with the line break.
    range: Range<usize>,
}

impl Excerpt {
    /// The lines around the spans, and where each span lies in the excerpt. Of a span over several lines, the first
    /// line counts.
    pub fn new(file: &SourceFile, spans: &[Span]) -> (Self, Vec<SourceSpan>) {
        let places: Vec<(usize, usize)> = spans
            .iter()
            .map(|span| {
                let (line, column) = file.line_column(span.start);
                (line - 1, column - 1)
            })
            .collect();
        let mut numbers: Vec<usize> = places
            .iter()
            .flat_map(|(line, _)| line.saturating_sub(1)..=line + 1)
            .filter(|line| *line < file.line_count())
            .collect();
        numbers.sort_unstable();
        numbers.dedup();
        let mut excerpt = Excerpt {
            name: one_line(&file.name).into_owned(),
            text: String::new(),
            lines: Vec::new(),
            columns: Vec::new(),
        };
        let mut found = vec![SourceSpan::from(0..0); spans.len()];
        for number in numbers {
            let Some((offset, line)) = file.line(number) else { continue };
            let begins = excerpt.text.len();
            let here: Vec<usize> = (0..spans.len()).filter(|i| places[*i].0 == number).collect();
            let relative = |i: &usize| (spans[*i].start - offset) as usize;
            let window = window(line, here.iter().map(relative).min().unwrap_or(0));
            let lead = if window.start > 0 { "… " } else { "" };
            excerpt.text.push_str(lead);
            excerpt.text.extend(line[window.clone()].chars().map(visible));
            if window.end < line.len() {
                excerpt.text.push_str(" …");
            }
            let ends = excerpt.text.len();
            excerpt.text.push('\n');
            for i in here {
                let (from, to) = (relative(&i), (spans[i].end - offset) as usize);
                let within = |at: usize| begins + lead.len() + at.clamp(window.start, window.end) - window.start;
                let place = within(from).min(ends)..within(to).min(ends);
                excerpt.columns.push((place.start, places[i].1));
                found[i] = SourceSpan::from(place);
            }
            excerpt.lines.push(ShownLine { number, range: begins..excerpt.text.len() });
        }
        (excerpt, found)
    }
}

/// The part of a line that is shown.
fn window(line: &str, label: usize) -> Range<usize> {
    if line.len() <= LONGEST_LINE {
        return 0..line.len();
    }
    let boundary = |mut at: usize| {
        while !line.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = boundary(label.min(line.len()).saturating_sub(LEAD));
    start..boundary((start + LONGEST_LINE).min(line.len()))
}

/// Control characters could steer a terminal; the replacement is as long in UTF-8, so that offsets hold.
fn visible(c: char) -> char {
    match c {
        '\t' => ' ',
        c if !steers(c) => c,
        c => ['?', '¿', '\u{fffd}'][c.len_utf8() - 1],
    }
}

impl miette::SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let holding = |offset: usize| self.lines.partition_point(|line| line.range.end <= offset);
        let (mut first, mut last) = (holding(span.offset()), holding(span.offset() + span.len()));
        if last >= self.lines.len() || (first..last).any(|i| self.lines[i].number + 1 != self.lines[i + 1].number) {
            return Err(MietteError::OutOfBounds);
        }
        let column = self.columns.iter().find(|(at, _)| *at == span.offset()).map_or(0, |(_, column)| *column);
        let column = if before == 0 && after == 0 { column } else { 0 };
        for _ in 0..before {
            if first > 0 && self.lines[first - 1].number + 1 == self.lines[first].number {
                first -= 1;
            }
        }
        for _ in 0..after {
            if last + 1 < self.lines.len() && self.lines[last].number + 1 == self.lines[last + 1].number {
                last += 1;
            }
        }
        let range = self.lines[first].range.start..self.lines[last].range.end;
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            &self.text.as_bytes()[range.clone()],
            range.into(),
            if before == 0 && after == 0 {
                self.lines[holding(span.offset())].number
            } else {
                self.lines[first].number
            },
            column,
            last - first + 1,
        )))
    }
}
