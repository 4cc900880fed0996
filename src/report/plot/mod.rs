//! Pictures that answer the hand: curves that zoom and show values, a plan of the track that has the same cursor, and
//! the chain in motion. A page holds its data as JSON and the scripts beside this file; uPlot draws the curves
//! (`vendor/`). It opens offline and may fetch nothing, which its content security policy says, too.

mod data;
mod plan;
mod thin;

pub use data::{Axis, Curve, Layer, LayerOf, Mark, PageData, Plan, Plot, Replay, Rounded, Shade, Spot, relative};
pub use plan::plan;
pub use thin::{cells, extremes, middles};

use super::style::STYLE;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const LIBRARY: &str = include_str!("vendor/uPlot.iife.min.js");
const LIBRARY_STYLE: &str = include_str!("vendor/uPlot.min.css");
const PLOT_STYLE: &str = include_str!("plot.css");

/// In the order in which they need each other.
const SCRIPTS: [&str; 6] = [
    include_str!("page.js"),
    include_str!("curves.js"),
    include_str!("plan.js"),
    include_str!("space.js"),
    include_str!("replay.js"),
    include_str!("start.js"),
];

/// Nothing from anywhere: what the page needs is in it.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'";

/// A page with pictures: `body` has the places that [`place`], [`plan_place`] and [`channels`] made for `data`.
pub fn document(title: &str, rules: &str, body: &Markup, data: &PageData) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(LIBRARY_STYLE)) "\n" (PreEscaped(PLOT_STYLE)) (PreEscaped(rules)) }
            }
            body {
                main {
                    (body)
                    noscript { p.note { "Curves, plan and replay need scripts, which this reader does not run. Words and tables are whole without." } }
                }
                script type="application/json" id="page-data" { (PreEscaped(block(data))) }
                script { (PreEscaped(LIBRARY)) }
                script {
                    (PreEscaped("\"use strict\";\n(() => {\n"))
                    @for script in SCRIPTS { (PreEscaped(script)) }
                    (PreEscaped("})();\n"))
                }
            }
        }
    }
    .into_string()
}

/// The data as JSON that no name in it can end: `<` is written as an escape.
fn block(data: &PageData) -> String {
    serde_json::to_string(data).unwrap_or_default().replace('<', "\\u003c")
}

/// A page's pictures, gathered while its words are written.
#[derive(Default)]
pub struct Pictures {
    pub data: PageData,
}

impl Pictures {
    /// Of a page with this name.
    pub fn new(name: &str) -> Self {
        Pictures { data: PageData { name: name.to_owned(), ..PageData::default() } }
    }

    /// Adds a plot, and says where it is drawn.
    pub fn add(&mut self, plot: Plot) -> Markup {
        let place = place(&plot);
        self.data.plots.push(plot);
        place
    }
}

/// Where a plot is drawn.
fn place(plot: &Plot) -> Markup {
    html! { div.plot id=(plot.id) style=(format!("min-height: {}px", plot.height)) {} }
}

/// Where the plan is drawn, with its buttons.
pub fn plan_place() -> Markup {
    html! { div.plan #plan {} }
}

/// How curves are asked, in words.
pub fn how() -> Markup {
    html! {
        p.note.how {
            "Drag over a stretch to see it larger, with shift to move along; double click for the whole. Ctrl and scrolling, or + and −, do the same. \
            A name below a picture turns its curve on and off. The cursor is the same in all pictures of one axis, and on a plan of the track where there is one."
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::digest::sha256;

    #[test]
    fn the_library_is_as_it_was_released() {
        let note = include_str!("vendor/README.md");
        for file in [LIBRARY, LIBRARY_STYLE] {
            assert!(note.contains(&format!("SHA-256 {} ", sha256(file.as_bytes()))));
        }
        assert!(LIBRARY.starts_with("/*! https://github.com/leeoniya/uPlot (v1.6.32) */"));
        assert!(note.contains("1.6.32"));
    }

    #[test]
    fn no_name_ends_the_data() {
        let data = PageData { name: "</script><script>alert(1)".to_owned(), ..PageData::default() };
        let page = document("t", "", &html! {}, &data);
        assert!(!page.contains("alert(1)") || page.contains("\\u003c/script>\\u003cscript>alert(1)"));
        assert_eq!(page.matches("</script>").count(), 3);
    }
}
