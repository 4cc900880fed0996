//! Diagnostics for machines: one JSON object a line.

use serde_json::{Map, Value, json};

use super::{Diagnostic, Severity};
use crate::source::{SourceMap, Span};

/// One line without its line break. Lines and columns count from one, columns in characters.
pub fn line(sources: &SourceMap, diagnostic: &Diagnostic) -> String {
    let mut object = Map::new();
    object.insert("code".into(), json!(diagnostic.code.as_str()));
    object.insert("name".into(), json!(diagnostic.code.name()));
    object.insert("severity".into(), json!(diagnostic.severity().as_str()));
    object.insert("message".into(), json!(diagnostic.message));
    place(&mut object, sources, diagnostic.label.span);
    object.insert("label".into(), json!(diagnostic.label.text));
    for (key, text) in [("expected", &diagnostic.expected), ("found", &diagnostic.found), ("help", &diagnostic.help)] {
        if let Some(text) = text {
            object.insert(key.into(), json!(text));
        }
    }
    if let Some(fix) = &diagnostic.fix {
        let mut inner = Map::new();
        place(&mut inner, sources, fix.span);
        inner.insert("replacement".into(), json!(fix.replacement));
        object.insert("fix".into(), Value::Object(inner));
    }
    let related = diagnostic.others().map(|label| {
        let mut inner = Map::new();
        place(&mut inner, sources, label.span);
        inner.insert("message".into(), json!(label.text));
        Value::Object(inner)
    });
    object.insert("related".into(), Value::Array(related.collect()));
    Value::Object(object).to_string()
}

fn place(object: &mut Map<String, Value>, sources: &SourceMap, span: Span) {
    let file = sources.file(span.file);
    let (line, column) = file.line_column(span.start);
    let (end_line, end_column) = file.line_column(span.end);
    object.insert("file".into(), json!(file.name));
    object.insert("line".into(), json!(line));
    object.insert("column".into(), json!(column));
    object.insert("end_line".into(), json!(end_line));
    object.insert("end_column".into(), json!(end_column));
}

impl Severity {
    /// `error` or `warning`.
    pub fn as_str(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
        }
    }
}
