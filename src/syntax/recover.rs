//! What to make of a line that fits nothing: a message, and where the mistake can be fixed the line that was meant, so
//! that one slip does not bring a row of follow-up errors.

use super::build::Builder;
use super::expected::{Context, Failure, digits_around};
use super::nearest::nearest;
use super::origin::{Edit, Origin};
use super::{Grammar, Rule};
use crate::diagnostic::{Code, Diagnostic, Label};
use crate::source::Span;
use pest::Parser;
use pest::iterators::Pair;

/// As many mistakes as are looked for in one line.
const MAX_REPAIRS: usize = 4;
/// Longer lines are reported, but no repair is tried: each try parses them again.
const MAX_REPAIR_BYTES: usize = 8 << 10;
/// How many bad blocks within bad blocks are looked into.
const MAX_NESTED: usize = 4;

impl Builder<'_> {
    /// Reports what is wrong with a line, and gives what was meant if that can be told.
    pub fn recover<T>(
        &mut self,
        pair: Pair<Rule>,
        context: Context,
        build: impl for<'b> Fn(&mut Builder<'b>, Pair<Rule>) -> Option<T>,
    ) -> Option<T> {
        if self.report.is_full() {
            self.report.dropped += 1;
            return None;
        }
        let slice = pair.as_str().trim_end();
        let start = pair.as_span().start();
        let brace = opening_brace(slice);
        let mut origin = Origin::slice(self.origin, start);
        let head = match brace {
            Some(brace) => format!("{}}}", &slice[..=brace]),
            None => slice.to_string(),
        };
        let last = start + brace.unwrap_or(slice.len());
        let known = self.report.covers(self.origin.back(start), self.origin.back(last));
        let fixed = if known { None } else { self.fixed_line(context, head, &mut origin) };
        self.report.nested += 1;
        let meant = match fixed {
            Some(head) => {
                let rest = brace.map_or("", |brace| &slice[brace + 1..]);
                let kept = if brace.is_some() { head.strip_suffix('}').unwrap_or(&head) } else { &head };
                self.meant(context, &format!("{kept}{rest}"), &origin, build)
            }
            None => {
                if let Some(brace) = brace.filter(|_| self.report.nested <= MAX_NESTED) {
                    self.look_inside(context, slice, start, brace);
                }
                None
            }
        };
        self.report.nested -= 1;
        meant
    }

    /// Reports the mistakes of a line one after the other, as long as each can be fixed; gives the fixed line.
    fn fixed_line(&mut self, context: Context, mut text: String, origin: &mut Origin) -> Option<String> {
        let file = self.file;
        for round in 0..MAX_REPAIRS {
            let error = match Grammar::parse(context.entry(), &text) {
                Ok(_) => return Some(text),
                Err(error) => error,
            };
            let failure = Failure::new(&text, &error);
            let problem =
                failure.diagnostic(context, &text, |from, to| Span::new(file, origin.back(from), origin.back(to)));
            if failure.is_outside(context, &text) {
                self.report.add_outside(problem);
                return None;
            }
            let edit = if text.len() <= MAX_REPAIR_BYTES && round + 1 < MAX_REPAIRS {
                failure.candidates(context, &text).into_iter().find(|edit| helps(context, &text, &failure, edit))
            } else {
                None
            };
            let Some(edit) = edit else {
                self.report.add(problem);
                return None;
            };
            let span = Span::new(file, origin.back(edit.at), origin.back(edit.at + edit.removed));
            let earlier = edit.at + edit.removed < failure.at || edit.at + edit.removed == text.len();
            self.report.add(with_fix(problem, &text, &edit, span, earlier));
            text = origin.edit(&text, vec![edit]);
        }
        None
    }

    /// Parses and builds the fixed line. What is wrong inside its braces is recovered there.
    fn meant<T>(
        &mut self,
        context: Context,
        text: &str,
        origin: &Origin,
        build: impl for<'b> Fn(&mut Builder<'b>, Pair<Rule>) -> Option<T>,
    ) -> Option<T> {
        match Grammar::parse(context.entry(), text) {
            Ok(mut pairs) => {
                let line = pairs.next()?;
                build(&mut Builder { file: self.file, text, origin, report: self.report }, line)
            }
            Err(error) => {
                // The head was fine, so something stands behind the block.
                let file = self.file;
                let failure = Failure::new(text, &error);
                let span = |from, to| Span::new(file, origin.back(from), origin.back(to));
                self.report.add(failure.diagnostic(context, text, span));
                None
            }
        }
    }

    /// Reports what is wrong inside the braces of a line whose head could not be fixed.
    fn look_inside(&mut self, context: Context, slice: &str, start: usize, brace: usize) {
        let end = slice.rfind('}').map_or(slice.len(), |end| end + 1);
        let Some(inner) = slice.get(brace..end) else { return };
        let word = slice.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or_default();
        let layout = context == Context::Item && nearest(word, ["layout"]).is_some();
        let entry = match context {
            Context::Statement => return,
            _ if layout => Rule::only_body,
            _ => Rule::only_fields,
        };
        let Ok(mut pairs) = Grammar::parse(entry, inner) else { return };
        let Some(block) = pairs.next() else { return };
        let origin = Origin::slice(self.origin, start + brace);
        let mut builder = Builder { file: self.file, text: inner, origin: &origin, report: self.report };
        if layout {
            builder.body(block);
        } else {
            builder.fields(block);
        }
    }
}

/// Whether the grammar gets further with an edit than without.
fn helps(context: Context, text: &str, failure: &Failure, edit: &Edit) -> bool {
    let mut fixed = text.to_string();
    fixed.replace_range(edit.at..edit.at + edit.removed, &edit.inserted);
    match Grammar::parse(context.entry(), &fixed) {
        Ok(_) => true,
        Err(error) => {
            // The first position that the edit did not touch, as it is now.
            let behind = edit.at + edit.inserted.len();
            let stopped = failure.at.max(edit.at + edit.removed) - edit.removed + edit.inserted.len();
            Failure::new(&fixed, &error).at > stopped.max(behind)
        }
    }
}

/// `earlier`: the word before the one where the grammar stopped was the wrong one.
fn with_fix(mut problem: Diagnostic, text: &str, edit: &Edit, span: Span, earlier: bool) -> Diagnostic {
    let removed = text[edit.at..edit.at + edit.removed].trim();
    let inserted = edit.inserted.trim();
    if (removed, inserted) == (",", ".") {
        return decimal_comma(text, edit.at, span);
    }
    if removed.is_empty() {
        problem.message = format!("missing `{inserted}`");
        problem.label.text = format!("expected `{inserted}` before this");
        problem.expected = Some(format!("`{inserted}`"));
    } else if inserted.is_empty() {
        problem.help = Some(format!("leave `{removed}` out"));
    } else {
        if earlier && problem.label.span != span {
            problem.message = format!("expected `{inserted}`, found `{removed}`");
            problem.label = Label { span, text: "not expected here".to_string() };
            problem = problem.expected(format!("`{inserted}`"), format!("`{removed}`"));
        }
        problem.help = Some(format!("did you mean `{inserted}`?"));
    }
    problem.fix(span, edit.inserted.clone())
}

/// `2,0` for `2.0`; `span` is the comma's.
fn decimal_comma(text: &str, comma: usize, span: Span) -> Diagnostic {
    let (before, after) = digits_around(text, comma);
    let whole =
        Span { start: span.start.saturating_sub(before.len() as u32), end: span.end + after.len() as u32, ..span };
    let (found, meant) = (format!("{before},{after}"), format!("{before}.{after}"));
    Diagnostic::new(Code::E0108, format!("`{found}` has a decimal comma"), whole, "decimals have a point")
        .expected(format!("`{meant}`"), format!("`{found}`"))
        .fix(whole, meant)
}

/// The first `{` outside of other brackets and texts.
fn opening_brace(slice: &str) -> Option<usize> {
    let mut depth = 0usize;
    let mut quoted = false;
    let mut escaped = false;
    for (at, byte) in slice.bytes().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if quoted => escaped = true,
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b'{' if depth == 0 => return Some(at),
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    None
}
