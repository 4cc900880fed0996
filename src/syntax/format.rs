//! Tree to text: the one way a file is laid out.
//!
//! Two spaces of indentation, one space between tokens, no alignment, so that a change of one line stays a change of
//! one line. At most one blank line in a row is kept. Numbers and units stay as written. A list stays on one line or on
//! several as its writer chose; it is spread if it is wider than [`WIDTH`] or holds a comment.

use super::tree::*;
use crate::source::Span;

/// Columns of a line before a list in it is spread.
const WIDTH: usize = 120;

/// Formats a tree. `source` is the text it was parsed from: lines that did not parse are taken over from it as they
/// are. Lines end as most lines of it do.
pub fn format(tree: &Tree, source: &str) -> String {
    let mut writer = Writer { out: String::new(), indent: 0, spread: false, trial: false, source };
    writer.nodes(&tree.items, "", |writer, item, span| writer.item(item, span));
    let (all, returned) = (source.matches('\n').count(), source.matches("\r\n").count());
    if 2 * returned > all { writer.out.replace('\n', "\r\n") } else { writer.out }
}

struct Writer<'a> {
    out: String,
    indent: usize,
    /// Put every list of the current item on several lines.
    spread: bool,
    /// Whether something is written only to see how wide it is.
    trial: bool,
    source: &'a str,
}

impl Writer<'_> {
    fn push(&mut self, text: &str) {
        self.out.push_str(text);
    }

    fn start_line(&mut self) {
        for _ in 0..self.indent {
            self.out.push_str("  ");
        }
    }

    fn comment_line(&mut self, comment: &str) {
        if !comment.is_empty() {
            self.start_line();
            self.push(comment);
        }
        self.push("\n");
    }

    /// Items on lines of their own, with their comments; `separator` ends each.
    fn nodes<T>(&mut self, block: &Block<T>, separator: &str, write: impl Fn(&mut Self, &T, Span)) {
        for (index, node) in block.nodes.iter().enumerate() {
            if node.blank_before && index > 0 {
                self.push("\n");
            }
            for comment in &node.above {
                self.comment_line(comment);
            }
            self.start_line();
            write(self, &node.value, node.span);
            self.push(separator);
            if let Some(comment) = &node.beside {
                self.push(" ");
                self.push(comment);
            }
            self.push("\n");
        }
        let leading = block.tail.iter().take_while(|comment| comment.is_empty() && block.nodes.is_empty()).count();
        for comment in &block.tail[leading..] {
            self.comment_line(comment);
        }
    }

    /// Writes something as it is, and if that is too wide, again with its lists spread. The first is a trial in which
    /// nothing inside is tried in turn, so the work grows with the depth of lists and not with its power.
    fn fitted(&mut self, write: impl Fn(&mut Self)) {
        if self.trial {
            return write(self);
        }
        let start = self.out.len();
        let outer = std::mem::replace(&mut self.spread, false);
        self.trial = true;
        write(self);
        self.trial = false;
        let line = self.out[..start].rfind('\n').map_or(0, |newline| newline + 1);
        if self.out[line..].lines().any(|line| line.chars().count() > WIDTH) {
            self.out.truncate(start);
            self.spread = true;
            write(self);
        }
        self.spread = outer;
    }

    /// A block in braces, always on several lines unless it is empty.
    fn braces<T>(&mut self, block: &Block<T>, write: impl Fn(&mut Self, &T, Span)) {
        if block.nodes.is_empty() && block.tail.is_empty() && block.beside_open.is_none() {
            self.push("{}");
        } else {
            self.lines("{", block, "}", "", write);
        }
    }

    /// A list or arguments between brackets. With `whole`, the list is never spread for want of room.
    fn list<T>(&mut self, open: &str, block: &Block<T>, close: &str, whole: bool, write: impl Fn(&mut Self, &T, Span)) {
        let commented = block.beside_open.is_some()
            || !block.tail.is_empty()
            || block.nodes.iter().any(|node| !node.above.is_empty() || node.beside.is_some());
        let wanted = block.multiline || (self.spread && !whole && block.nodes.len() > 1);
        if commented || (wanted && !block.nodes.is_empty()) {
            self.lines(open, block, close, ",", |writer, item, span| writer.fitted(|writer| write(writer, item, span)));
            return;
        }
        self.push(open);
        for (index, node) in block.nodes.iter().enumerate() {
            if index > 0 {
                self.push(", ");
            }
            write(self, &node.value, node.span);
        }
        self.push(close);
    }

    fn lines<T>(
        &mut self,
        open: &str,
        block: &Block<T>,
        close: &str,
        separator: &str,
        write: impl Fn(&mut Self, &T, Span),
    ) {
        self.push(open);
        if let Some(comment) = &block.beside_open {
            self.push(" ");
            self.push(comment);
        }
        self.push("\n");
        self.indent += 1;
        self.nodes(block, separator, write);
        self.indent -= 1;
        self.start_line();
        self.push(close);
    }

    /// A line that did not parse, as it was written.
    fn verbatim(&mut self, span: Span) {
        let written = self.source.get(span.start as usize..span.end as usize).unwrap_or_default();
        let written = written.trim_end().replace("\r\n", "\n");
        self.push(&written);
    }

    fn item(&mut self, item: &Item, span: Span) {
        match item {
            Item::Use(Use::Std { path, .. }) => {
                self.push("use ");
                for (index, name) in path.iter().enumerate() {
                    self.push(if index > 0 { "." } else { "" });
                    self.push(&name.text);
                }
            }
            Item::Use(Use::File { path, .. }) => {
                self.push("use ");
                self.text(path);
            }
            Item::Let(line) => self.fitted(|writer| writer.let_line(line)),
            Item::Declaration(declaration) => {
                self.push(declaration.kind.word());
                self.header(&declaration.name, &declaration.params, &declaration.from);
                if !declaration.fields.is_absent() {
                    self.push(" ");
                    self.braces(&declaration.fields, |writer, field, span| writer.field(field, span));
                }
            }
            Item::Layout(layout) => {
                self.push("layout");
                self.header(&layout.name, &layout.params, &layout.from);
                if !layout.body.is_absent() {
                    self.push(" ");
                    self.braces(&layout.body, |writer, statement, span| {
                        writer.fitted(|writer| writer.statement(statement, span));
                    });
                }
            }
            Item::Bad => self.verbatim(span),
        }
    }

    fn header(&mut self, name: &Name, params: &Block<Param>, from: &Option<Reference>) {
        self.push(" ");
        self.push(&name.text);
        self.fitted(|writer| writer.after_name(params, from));
    }

    fn after_name(&mut self, params: &Block<Param>, from: &Option<Reference>) {
        if !params.is_absent() {
            self.list("(", params, ")", false, |writer, param, _| {
                writer.push(&param.name.text);
                writer.push(": ");
                writer.expr(&param.default);
            });
        }
        if let Some(from) = from {
            self.push(" from ");
            self.reference(from);
        }
    }

    fn let_line(&mut self, line: &Let) {
        self.push("let ");
        self.push(&line.name.text);
        self.push(" = ");
        self.expr(&line.value);
    }

    fn field(&mut self, field: &Field, span: Span) {
        match field {
            Field::Value { name, value } => {
                self.push(&name.text);
                self.push(" = ");
                self.fitted(|writer| writer.expr(value));
            }
            Field::Group { name, fields } => {
                self.push(&name.text);
                self.push(" ");
                self.braces(fields, |writer, field, span| writer.field(field, span));
            }
            Field::Bad => self.verbatim(span),
        }
    }

    fn reference(&mut self, reference: &Reference) {
        self.push(&reference.name.text);
        if let Some(args) = &reference.args {
            self.args(args, false);
        }
    }

    fn args(&mut self, args: &Block<Arg>, whole: bool) {
        self.list("(", args, ")", whole, |writer, arg, _| {
            if let Some(name) = &arg.name {
                writer.push(&name.text);
                writer.push(": ");
            }
            writer.expr(&arg.value);
        });
    }

    fn text(&mut self, text: &str) {
        self.push("\"");
        for c in text.chars() {
            if matches!(c, '"' | '\\') {
                self.push("\\");
            }
            self.out.push(c);
        }
        self.push("\"");
    }
}

mod expression;
mod statement;
