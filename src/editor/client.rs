//! What a client says it can do.

use super::text::Encoding;
use lsp_types::{ClientCapabilities, InitializeParams, MarkupKind};

/// What of the protocol's choices a client takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Client {
    pub encoding: Encoding,
    /// Related places of diagnostics.
    pub related: bool,
    /// Links from codes to their pages.
    pub pages: bool,
    pub snippets: bool,
    pub markdown: bool,
    /// Asks for inlay hints again when told to.
    pub refreshes_hints: bool,
    /// Watches files when asked to.
    pub watches: bool,
    /// Takes symbols in a tree.
    pub nested_symbols: bool,
    /// Longest time that a layout is solved in the background, s; 0 never solves.
    pub seconds: f64,
}

impl Client {
    pub fn new(params: &InitializeParams) -> Client {
        let all = &params.capabilities;
        let text = all.text_document.as_ref();
        let published = text.and_then(|t| t.publish_diagnostics.as_ref());
        let item = text.and_then(|t| t.completion.as_ref()?.completion_item.as_ref());
        let hover = text.and_then(|t| t.hover.as_ref()?.content_format.as_ref());
        let said = params.initialization_options.as_ref().and_then(|o| o.get("solveSeconds")?.as_f64());
        Client {
            encoding: Encoding::of(all.general.as_ref().and_then(|g| g.position_encodings.as_deref())),
            related: published.and_then(|p| p.related_information).unwrap_or(false),
            pages: published.and_then(|p| p.code_description_support).unwrap_or(false),
            snippets: item.and_then(|i| i.snippet_support).unwrap_or(false),
            markdown: hover.is_none_or(|kinds| kinds.contains(&MarkupKind::Markdown)),
            refreshes_hints: refreshes_hints(all),
            watches: watches(all),
            nested_symbols: text
                .and_then(|t| t.document_symbol.as_ref()?.hierarchical_document_symbol_support)
                .unwrap_or(false),
            seconds: said.filter(|s| s.is_finite() && *s >= 0.0).unwrap_or(SECONDS),
        }
    }
}

/// As long as a reader waits without asking what is going on.
const SECONDS: f64 = 10.0;

fn refreshes_hints(all: &ClientCapabilities) -> bool {
    all.workspace.as_ref().and_then(|w| w.inlay_hint.as_ref()?.refresh_support).unwrap_or(false)
}

fn watches(all: &ClientCapabilities) -> bool {
    all.workspace.as_ref().and_then(|w| w.did_change_watched_files.as_ref()?.dynamic_registration).unwrap_or(false)
}
