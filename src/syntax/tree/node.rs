//! Items of lists with the comments around them, names and texts.

use crate::source::Span;

/// An item of a list with the comments that belong to it.
#[derive(Clone, Debug)]
pub struct Node<T> {
    /// Comment lines directly above the item (text with the leading `//`, trimmed at the end). An empty string
    /// stands for a blank line between comments.
    pub above: Vec<String>,
    /// Whether a blank line separates this item (with its comments) from the one before.
    pub blank_before: bool,
    pub value: T,
    /// Comment at the end of the item's (last) line.
    pub beside: Option<String>,
    pub span: Span,
}

/// Items between braces, brackets or parentheses, and the comments after the last one (an empty string stands for a
/// blank line there too).
#[derive(Clone, Debug)]
pub struct Block<T> {
    pub nodes: Vec<Node<T>>,
    /// Comments after the last item.
    pub tail: Vec<String>,
    /// Comment on the line of the opening bracket.
    pub beside_open: Option<String>,
    /// Whether the writer put it on several lines (lists and arguments keep that choice).
    pub multiline: bool,
    pub span: Span,
}

impl<T> Block<T> {
    /// A block that was not written: nothing between brackets that are not there.
    pub fn absent(span: Span) -> Self {
        Block {
            nodes: Vec::new(),
            tail: Vec::new(),
            beside_open: None,
            multiline: false,
            span: Span { end: span.start, ..span },
        }
    }

    /// Whether the brackets themselves were left out.
    pub fn is_absent(&self) -> bool {
        self.span.start == self.span.end
    }

    /// The items without their comments.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &T> + ExactSizeIterator {
        self.nodes.iter().map(|node| &node.value)
    }

    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    pub text: String,
    pub span: Span,
}

/// A text in quotes, without them.
#[derive(Clone, Debug, PartialEq)]
pub struct TextExpr {
    pub text: String,
    pub span: Span,
}
