//! What is known of the text that is on the disk: its checks and the layout that is shown.

use super::edit::{self, Coordinates};
use crate::base::digest::sha256;
use crate::model::Layout;
use crate::semantics::Checked;
use std::sync::Arc;

/// A checked text without mistakes, and its layout.
#[derive(Debug)]
pub struct Known {
    pub checked: Arc<Checked>,
    pub layout: Layout,
    /// Of each vertex; `None` of one that stands in another file.
    pub coordinates: Vec<Option<Coordinates>>,
    /// Tells its text from others.
    pub id: String,
}

/// What tells a text from others.
pub fn id(text: &str) -> String {
    let mut digest = sha256(text.as_bytes());
    digest.truncate(16);
    digest
}

impl Known {
    pub fn new(checked: Arc<Checked>, layout: Layout) -> Known {
        let tree = checked.tree(checked.main);
        let of = |vertex: &crate::model::Vertex| edit::coordinates(tree?, vertex.point_span);
        let coordinates = layout.vertices.iter().map(of).collect();
        Known { coordinates, id: id(checked.text(checked.main)), layout, checked }
    }

    pub fn text(&self) -> &str {
        self.checked.text(self.checked.main)
    }

    /// The line (from one) of a place in the file itself.
    pub fn line(&self, span: crate::source::Span) -> Option<usize> {
        let file = (span.file == self.checked.main).then(|| self.checked.sources.file(span.file))?;
        Some(file.line_column(span.start).0)
    }
}

/// The layout that is meant: the one of the name, or the only one. Says in a sentence why there is none.
pub fn chosen(checked: &Checked, name: Option<&str>) -> Result<Layout, String> {
    let Some(study) = &checked.study else { return Err("the file cannot be read as a layout".to_owned()) };
    let layouts = &study.analysis.layouts;
    let all = || layouts.iter().map(|l| format!("`{}`", l.name)).collect::<Vec<_>>().join(", ");
    match (name, layouts.as_slice()) {
        (Some(name), _) => layouts.iter().find(|l| l.name == name).cloned().ok_or_else(|| {
            let has = if layouts.is_empty() { "none".to_owned() } else { all() };
            format!("there is no layout `{name}` in the file; it has {has}")
        }),
        (None, [only]) => Ok(only.clone()),
        (None, []) => Err("there is no layout in the file; `layout NAME { ... }` is one".to_owned()),
        (None, _) => Err(format!("the file has several layouts, {}: say which one with --layout NAME", all())),
    }
}
