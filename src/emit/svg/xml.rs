//! A small typed writer: elements with attributes, escaped, one number format.
//!
//! Written here, because a drawing needs nothing of XML but elements, and one number format for all of them.

use std::fmt::Write;

use crate::base::number::trimmed;

/// An XML element.
#[derive(Clone, Debug)]
pub struct XmlElement {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Node>,
}

#[derive(Clone, Debug)]
enum Node {
    Element(XmlElement),
    Text(String),
    /// A style sheet, which has nothing to escape.
    Style(String),
}

impl XmlElement {
    pub fn new(name: &'static str) -> Self {
        XmlElement { name, attributes: Vec::new(), children: Vec::new() }
    }

    pub fn group(class: &str) -> Self {
        XmlElement::new("g").attr("class", class)
    }

    #[must_use]
    pub fn attr(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((name, value.into()));
        self
    }

    #[must_use]
    pub fn num(self, name: &'static str, value: f64) -> Self {
        self.attr(name, number(value))
    }

    #[must_use]
    pub fn text(mut self, text: impl Into<String>) -> Self {
        self.children.push(Node::Text(text.into()));
        self
    }

    #[must_use]
    pub fn with(mut self, child: XmlElement) -> Self {
        self.push(child);
        self
    }

    pub fn style(&mut self, sheet: String) {
        self.children.push(Node::Style(sheet));
    }

    pub fn push(&mut self, child: XmlElement) {
        self.children.push(Node::Element(child));
    }

    pub fn name(&self) -> &str {
        self.name
    }

    /// The value of an attribute.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(other, _)| *other == name).map(|(_, value)| value.as_str())
    }

    /// Its text, when it begins with one.
    pub fn words(&self) -> &str {
        if let Some(Node::Text(text)) = self.children.first() { text } else { "" }
    }

    /// This element and all in it, in order.
    pub fn visit(&self, each: &mut impl FnMut(&XmlElement)) {
        each(self);
        for child in &self.children {
            if let Node::Element(element) = child {
                element.visit(each);
            }
        }
    }

    /// The document with this root, one element a line.
    pub fn document(&self) -> String {
        let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        self.write(&mut out, 0);
        out
    }

    fn write(&self, out: &mut String, depth: usize) {
        let indent = " ".repeat(depth);
        let _ = write!(out, "{indent}<{}", self.name);
        for (name, value) in &self.attributes {
            let _ = write!(out, " {name}=\"");
            escape(value, out);
            out.push('"');
        }
        if self.children.is_empty() {
            out.push_str("/>\n");
            return;
        }
        out.push('>');
        // Text keeps its spaces: nothing may be put beside it.
        let inline = self.children.iter().all(|child| matches!(child, Node::Text(_)));
        if !inline {
            out.push('\n');
        }
        for child in &self.children {
            match child {
                Node::Element(element) => element.write(out, depth + 1),
                Node::Text(text) => escape(text, out),
                Node::Style(sheet) => out.push_str(sheet),
            }
        }
        let _ = writeln!(out, "{}</{}>", if inline { "" } else { &indent }, self.name);
    }
}

/// Up to three decimals: on paper a micrometre.
pub fn number(value: f64) -> String {
    trimmed(value, 3)
}

fn escape(text: &str, out: &mut String) {
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Not allowed in XML 1.0, whatever the spelling.
            '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_attributes_are_escaped() {
        let root = XmlElement::new("svg")
            .attr("a", "<\"&\u{1}")
            .with(XmlElement::new("text").text("a < b & c"))
            .with(XmlElement::new("path").num("x", -0.0001));
        assert_eq!(
            root.document(),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg a=\"&lt;&quot;&amp;\u{fffd}\">\n \
             <text>a &lt; b &amp; c</text>\n <path x=\"0\"/>\n</svg>\n"
        );
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(["12.35", "100", "0.001", "-3"].map(str::to_owned), [12.3504, 100.0, 0.001, -3.0].map(number));
    }
}
