//! The page: what a browser gets once. All else it asks for.

use crate::emit::svg::{Theme, style as drawing_style};
use crate::report::style::STYLE;
use crate::source::shown;
use maud::{DOCTYPE, html};
use std::path::Path;

/// What moves the page.
pub const SCRIPT: &str = include_str!("page.js");

/// The house style of pages, that of drawings, and the page's own.
pub fn style() -> String {
    format!("{STYLE}{}{}", drawing_style(Theme::Adaptive), include_str!("page.css"))
}

/// The document, still empty.
pub fn html(file: &Path) -> String {
    let name = file.file_name().map_or_else(|| shown(file).to_string(), |name| name.to_string_lossy().into_owned());
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (name) }
                link rel="icon" href="data:,";
                link rel="stylesheet" href="page.css";
                script src="page.js" defer {}
            }
            body {
                header {
                    h1 #name { (name) }
                    output #length {}
                    span #status role="status" {}
                    span.tools {
                        button #undo disabled title="Take the last drag back (Ctrl+Z)" { "Undo" }
                        button #redo disabled title="Drag again what was taken back (Ctrl+Shift+Z)" { "Redo" }
                        label title="The written layout and the stages before the last one" {
                            input #stages type="checkbox"; "stages"
                        }
                        button #closer title="Closer (Ctrl+wheel)" aria-label="closer" { "+" }
                        button #wider title="Wider (Ctrl+wheel)" aria-label="wider" { "−" }
                        button #fit title="All of the plan" { "Fit" }
                    }
                }
                p #lost hidden {
                    "The preview does not run any more. Start " code { "lss preview" }
                    " again, and open the address that it prints."
                }
                main.preview {
                    div #sheet {
                        div #drawing {}
                        svg #handles.drawing role="group" aria-label="written vertices" {}
                        div #tip hidden {}
                        p #note role="alert" hidden {}
                    }
                    div #beside {
                        div #messages aria-live="polite" {}
                        div #facts {}
                    }
                    section #source {
                        h2 { code #file {} }
                        ol {}
                    }
                }
            }
        }
    }
    .into_string()
}
