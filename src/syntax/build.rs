//! pest's pairs to the tree: files, blocks with their comments, declarations.
//!
//! Every function that reads a pair gives `None` where the pair is not of the grammar's shape, which then counts as
//! a bad statement; nothing here can panic.

use super::expected::Context;
use super::origin::Origin;
use super::tree::*;
use super::{Report, Rule};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::{FileId, Span};
use pest::iterators::{Pair, Pairs};

/// Builds the tree of one parsed text.
pub(super) struct Builder<'a> {
    pub file: FileId,
    /// The text that pest saw.
    pub text: &'a str,
    /// The way from it to what the user wrote.
    pub origin: &'a Origin<'a>,
    pub report: &'a mut Report,
}

/// The next pair of a rule; those before it are skipped.
pub(super) fn take<'i>(pairs: &mut Pairs<'i, Rule>, rule: Rule) -> Option<Pair<'i, Rule>> {
    pairs.find(|pair| pair.as_rule() == rule)
}

impl Builder<'_> {
    pub fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, self.origin.back(start), self.origin.back(end))
    }

    pub fn span_of(&self, pair: &Pair<Rule>) -> Span {
        let span = pair.as_span();
        self.span(span.start(), span.end())
    }

    pub fn items(&mut self, file: Pair<Rule>) -> Block<Item> {
        self.block(file, 0, |builder, pair| match pair.as_rule() {
            Rule::bad_item => Some(builder.recover(pair, Context::Item, |b, p| b.item(p)).unwrap_or(Item::Bad)),
            Rule::EOI => None,
            _ => Some(builder.item(pair).unwrap_or(Item::Bad)),
        })
    }

    pub fn item(&mut self, pair: Pair<Rule>) -> Option<Item> {
        match pair.as_rule() {
            Rule::use_std => {
                let span = self.span_of(&pair);
                let path = take(&mut pair.into_inner(), Rule::std_path)?;
                let names = path.into_inner().filter(|part| part.as_rule() == Rule::name);
                Some(Item::Use(Use::Std { path: names.map(|name| self.name(&name)).collect(), span }))
            }
            Rule::use_file => {
                let span = self.span_of(&pair);
                let path = take(&mut pair.into_inner(), Rule::text)?;
                Some(Item::Use(Use::File { path: self.unescape(&path), span }))
            }
            Rule::let_line => self.let_line(pair).map(Item::Let),
            Rule::declaration => self.declaration(pair).map(Item::Declaration),
            Rule::layout => self.layout(pair).map(Item::Layout),
            _ => None,
        }
    }

    pub fn let_line(&mut self, pair: Pair<Rule>) -> Option<Let> {
        let mut parts = pair.into_inner();
        let name = self.name(&take(&mut parts, Rule::name)?);
        let value = self.expression(take(&mut parts, Rule::expr)?)?;
        Some(Let { name, value })
    }

    fn declaration(&mut self, pair: Pair<Rule>) -> Option<Declaration> {
        let span = self.span_of(&pair);
        let mut parts = pair.into_inner();
        let word = take(&mut parts, Rule::kind)?;
        let kind = DeclarationKind::ALL.into_iter().find(|kind| kind.word() == word.as_str())?;
        let kind_span = self.span_of(&word);
        let name = self.name(&take(&mut parts, Rule::name)?);
        let (params, from, fields) = self.after_name(parts, span, Rule::fields, Self::fields);
        Some(Declaration { kind, kind_span, name, params, from, fields, span })
    }

    fn layout(&mut self, pair: Pair<Rule>) -> Option<LayoutDeclaration> {
        let span = self.span_of(&pair);
        let mut parts = pair.into_inner();
        let name = self.name(&take(&mut parts, Rule::name)?);
        let (params, from, body) = self.after_name(parts, span, Rule::body, Self::body);
        Some(LayoutDeclaration { name, params, from, body, span })
    }

    /// Parameters, what is extended, and the block of a declaration or layout.
    fn after_name<T>(
        &mut self,
        parts: Pairs<Rule>,
        span: Span,
        block: Rule,
        build: fn(&mut Self, Pair<Rule>) -> Block<T>,
    ) -> (Block<Param>, Option<Reference>, Block<T>) {
        let mut params = Block::absent(span);
        let mut from = None;
        let mut contents = Block::absent(Span { start: span.end, ..span });
        for part in parts {
            match part.as_rule() {
                Rule::params => {
                    params = self.block(part, 1, |builder, pair| match pair.as_rule() {
                        Rule::param => {
                            let mut parts = pair.into_inner();
                            let name = builder.name(&take(&mut parts, Rule::name)?);
                            let default = builder.expression(take(&mut parts, Rule::expr)?)?;
                            Some(Param { name, default })
                        }
                        _ => None,
                    });
                }
                Rule::from => {
                    from = take(&mut part.into_inner(), Rule::reference).and_then(|pair| self.reference(pair));
                }
                rule if rule == block => contents = build(self, part),
                _ => {}
            }
        }
        (params, from, contents)
    }

    pub fn fields(&mut self, pair: Pair<Rule>) -> Block<Field> {
        self.block(pair, 1, |builder, pair| match pair.as_rule() {
            Rule::field | Rule::group => Some(builder.field(pair).unwrap_or(Field::Bad)),
            Rule::bad_field => Some(builder.recover(pair, Context::Field, |b, p| b.field(p)).unwrap_or(Field::Bad)),
            _ => None,
        })
    }

    pub fn field(&mut self, pair: Pair<Rule>) -> Option<Field> {
        let rule = pair.as_rule();
        let mut parts = pair.into_inner();
        let name = self.name(&take(&mut parts, Rule::name)?);
        if rule == Rule::group {
            let fields = self.fields(take(&mut parts, Rule::fields)?);
            return Some(Field::Group { name, fields });
        }
        let value = self.expression(take(&mut parts, Rule::expr)?)?;
        Some(Field::Value { name, value })
    }

    pub fn body(&mut self, pair: Pair<Rule>) -> Block<Statement> {
        self.block(pair, 1, |builder, pair| match pair.as_rule() {
            Rule::open_brace | Rule::close_brace => None,
            Rule::bad_statement => {
                Some(builder.recover(pair, Context::Statement, |b, p| b.statement(p)).unwrap_or(Statement::Bad))
            }
            _ => Some(builder.statement(pair).unwrap_or(Statement::Bad)),
        })
    }

    pub fn name(&self, pair: &Pair<Rule>) -> Name {
        Name { text: pair.as_str().to_string(), span: self.span_of(pair) }
    }

    pub fn reference(&mut self, pair: Pair<Rule>) -> Option<Reference> {
        let span = self.span_of(&pair);
        let mut parts = pair.into_inner();
        let name = self.name(&take(&mut parts, Rule::name)?);
        let args = take(&mut parts, Rule::args).map(|args| self.args(args));
        Some(Reference { name, args, span })
    }

    pub fn args(&mut self, pair: Pair<Rule>) -> Block<Arg> {
        self.block(pair, 1, |builder, pair| match pair.as_rule() {
            Rule::arg => {
                let mut name = None;
                for part in pair.into_inner() {
                    match part.as_rule() {
                        Rule::name => name = Some(builder.name(&part)),
                        Rule::expr => return Some(Arg { name, value: builder.expression(part)? }),
                        _ => {}
                    }
                }
                None
            }
            _ => None,
        })
    }

    /// What a text in quotes says.
    pub fn unescape(&mut self, pair: &Pair<Rule>) -> String {
        let written = pair.as_str();
        let inner = written.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(written);
        let mut said = String::with_capacity(inner.len());
        let mut chars = inner.char_indices();
        while let Some((at, c)) = chars.next() {
            match c {
                '\\' => match chars.next() {
                    Some((_, escaped @ ('"' | '\\'))) => said.push(escaped),
                    Some((_, other)) => {
                        let start = pair.as_span().start() + 1 + at;
                        let span = self.span(start, start + 1 + other.len_utf8());
                        let message = format!("`\\{other}` means nothing in a text");
                        self.report.add(
                            Diagnostic::new(Code::E0111, message, span, "only `\\\"` and `\\\\` are known")
                                .fix(span, format!("\\\\{other}")),
                        );
                        said.extend(['\\', other]);
                    }
                    None => said.push('\\'),
                },
                _ => said.push(c),
            }
        }
        said
    }

    /// The items of a bracketed list with the comments around them; `opener` is the width of the opening bracket.
    /// `item` gives `None` for pairs that are no items.
    pub fn block<T>(
        &mut self,
        pair: Pair<Rule>,
        opener: usize,
        mut item: impl FnMut(&mut Self, Pair<Rule>) -> Option<T>,
    ) -> Block<T> {
        let range = pair.as_span();
        let mut block: Block<T> = Block::absent(self.span(range.start(), range.start()));
        block.span = self.span(range.start(), range.end());
        // Comments that wait for their item, and whether a blank line comes before them.
        let mut above: Vec<String> = Vec::new();
        let mut blank_before = false;
        let mut end = range.start() + opener;
        for part in pair.into_inner() {
            let place = part.as_span();
            let newlines =
                self.text.get(end..place.start()).map_or(0, |gap| gap.bytes().filter(|b| *b == b'\n').count());
            block.multiline |= newlines > 0;
            let first = above.is_empty() && block.nodes.is_empty();
            if part.as_rule() == Rule::comment {
                let comment = part.as_str().trim_end().to_string();
                match block.nodes.last_mut() {
                    Some(node) if newlines == 0 && above.is_empty() => node.beside = Some(comment),
                    None if newlines == 0 && opener > 0 && first && block.beside_open.is_none() => {
                        block.beside_open = Some(comment)
                    }
                    _ => {
                        if newlines > 1 && above.is_empty() {
                            blank_before = !first;
                        } else if newlines > 1 {
                            above.push(String::new());
                        }
                        above.push(comment);
                    }
                }
                block.multiline = true;
                end = place.end();
                continue;
            }
            let Some(value) = item(self, part) else {
                // The closer; commas do not move the end, so that a comment after one stays beside its item.
                continue;
            };
            if newlines > 1 && above.is_empty() {
                blank_before = !first;
            } else if newlines > 1 {
                above.push(String::new());
            }
            block.nodes.push(Node {
                above: std::mem::take(&mut above),
                blank_before: std::mem::take(&mut blank_before),
                value,
                beside: None,
                span: self.span(place.start(), place.end()),
            });
            end = place.end();
        }
        if blank_before {
            above.insert(0, String::new());
        }
        block.tail = above;
        block
    }
}
