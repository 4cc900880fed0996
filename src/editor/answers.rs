//! What the server can do, and which file answers what.

use super::client::Client;
use super::place;
use super::session::Session;
use super::{actions, completion, diagnostics, formatting, hints, hover, navigation, outline, rename, tokens};
use lsp_server::{ErrorCode, Request, Response};
use lsp_types as lsp;
use lsp_types::request::{self as ask, Request as _};
use lsp_types::{Location, TextDocumentPositionParams, Uri};

/// What the server offers.
pub fn capabilities(client: &Client) -> lsp::ServerCapabilities {
    lsp::ServerCapabilities {
        position_encoding: Some(client.encoding.kind()),
        text_document_sync: Some(lsp::TextDocumentSyncCapability::Options(lsp::TextDocumentSyncOptions {
            open_close: Some(true),
            change: Some(lsp::TextDocumentSyncKind::INCREMENTAL),
            save: Some(lsp::TextDocumentSyncSaveOptions::Supported(true)),
            ..lsp::TextDocumentSyncOptions::default()
        })),
        completion_provider: Some(lsp::CompletionOptions {
            trigger_characters: Some([".", " ", "(", "\""].map(str::to_owned).to_vec()),
            ..lsp::CompletionOptions::default()
        }),
        hover_provider: Some(lsp::HoverProviderCapability::Simple(true)),
        definition_provider: Some(lsp::OneOf::Left(true)),
        references_provider: Some(lsp::OneOf::Left(true)),
        document_highlight_provider: Some(lsp::OneOf::Left(true)),
        document_symbol_provider: Some(lsp::OneOf::Left(true)),
        workspace_symbol_provider: Some(lsp::OneOf::Left(true)),
        document_formatting_provider: Some(lsp::OneOf::Left(true)),
        code_action_provider: Some(lsp::CodeActionProviderCapability::Options(lsp::CodeActionOptions {
            code_action_kinds: Some(vec![lsp::CodeActionKind::QUICKFIX]),
            ..lsp::CodeActionOptions::default()
        })),
        rename_provider: Some(lsp::OneOf::Right(lsp::RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: lsp::WorkDoneProgressOptions::default(),
        })),
        folding_range_provider: Some(lsp::FoldingRangeProviderCapability::Simple(true)),
        selection_range_provider: Some(lsp::SelectionRangeProviderCapability::Simple(true)),
        inlay_hint_provider: Some(lsp::OneOf::Left(true)),
        semantic_tokens_provider: Some(lsp::SemanticTokensServerCapabilities::SemanticTokensOptions(
            lsp::SemanticTokensOptions {
                legend: tokens::legend(),
                full: Some(lsp::SemanticTokensFullOptions::Bool(true)),
                ..lsp::SemanticTokensOptions::default()
            },
        )),
        diagnostic_provider: Some(lsp::DiagnosticServerCapabilities::Options(lsp::DiagnosticOptions {
            identifier: Some("lss".to_owned()),
            inter_file_dependencies: true,
            ..lsp::DiagnosticOptions::default()
        })),
        ..lsp::ServerCapabilities::default()
    }
}

/// `RequestFailed` of the protocol: the request was right, but there is no answer.
const FAILED: i32 = -32803;

/// Why there is no answer.
struct Refusal(i32, String);

impl From<String> for Refusal {
    fn from(why: String) -> Self {
        Refusal(FAILED, why)
    }
}

/// Answers a request.
pub fn answer(session: &mut Session, request: Request) -> Response {
    let id = request.id.clone();
    let result = match request.method.as_str() {
        ask::Completion::METHOD => on::<ask::Completion>(session, request, completion),
        ask::HoverRequest::METHOD => on::<ask::HoverRequest>(session, request, hover),
        ask::GotoDefinition::METHOD => on::<ask::GotoDefinition>(session, request, definition),
        ask::References::METHOD => on::<ask::References>(session, request, references),
        ask::DocumentHighlightRequest::METHOD => {
            on::<ask::DocumentHighlightRequest>(session, request, |session, params| {
                let at = params.text_document_position_params;
                let found = session.workspace.at(&at.text_document.uri, at.position);
                Ok(found.map(|(checked, offset)| navigation::highlights(&session.workspace, &checked, offset)))
            })
        }
        ask::PrepareRenameRequest::METHOD => on::<ask::PrepareRenameRequest>(session, request, prepare_rename),
        ask::Rename::METHOD => on::<ask::Rename>(session, request, rename),
        ask::DocumentSymbolRequest::METHOD => on::<ask::DocumentSymbolRequest>(session, request, symbols),
        ask::WorkspaceSymbolRequest::METHOD => {
            on::<ask::WorkspaceSymbolRequest>(session, request, |session, params| {
                let found = outline::of_project(&mut session.workspace, &params.query);
                Ok(Some(lsp::WorkspaceSymbolResponse::Flat(found)))
            })
        }
        ask::Formatting::METHOD => on::<ask::Formatting>(session, request, |session, params| {
            let place = place::of_uri(&params.text_document.uri);
            let text = session.workspace.text(&place);
            Ok(text.and_then(|text| formatting::format(&session.workspace.lines(text))))
        }),
        ask::CodeActionRequest::METHOD => on::<ask::CodeActionRequest>(session, request, code_actions),
        ask::FoldingRangeRequest::METHOD => on::<ask::FoldingRangeRequest>(session, request, |session, params| {
            let checked = session.workspace.checked(&place::of_uri(&params.text_document.uri));
            let folds = |c: &crate::semantics::Checked| outline::folds(&session.workspace.lines_of(c, c.main), c);
            Ok(checked.map(|checked| folds(&checked)))
        }),
        ask::SelectionRangeRequest::METHOD => on::<ask::SelectionRangeRequest>(session, request, selection),
        ask::InlayHintRequest::METHOD => on::<ask::InlayHintRequest>(session, request, |session, params| {
            let place = place::of_uri(&params.text_document.uri);
            let checked = session.workspace.checked(&place);
            let (workspace, solutions) = (&session.workspace, &session.solutions);
            Ok(checked.map(|checked| hints::hints(workspace, solutions, &place, &checked, params.range)))
        }),
        ask::SemanticTokensFullRequest::METHOD => on::<ask::SemanticTokensFullRequest>(session, request, semantic),
        ask::DocumentDiagnosticRequest::METHOD => on::<ask::DocumentDiagnosticRequest>(session, request, pulled),
        other => {
            let message = format!("`{other}` is not known");
            Err(Refusal(ErrorCode::MethodNotFound as i32, message))
        }
    };
    match result {
        Ok(value) => Response::new_ok(id, value),
        Err(Refusal(code, why)) => Response::new_err(id, code, why),
    }
}

fn on<R: ask::Request>(
    session: &mut Session,
    request: Request,
    run: impl FnOnce(&mut Session, R::Params) -> Result<R::Result, Refusal>,
) -> Result<serde_json::Value, Refusal> {
    let params = serde_json::from_value(request.params);
    let params = params.map_err(|why| Refusal(ErrorCode::InvalidParams as i32, why.to_string()))?;
    let result = run(session, params)?;
    serde_json::to_value(result).map_err(|why| Refusal(ErrorCode::InternalError as i32, why.to_string()))
}

fn completion(
    session: &mut Session,
    params: lsp::CompletionParams,
) -> Result<Option<lsp::CompletionResponse>, Refusal> {
    let TextDocumentPositionParams { text_document, position } = params.text_document_position;
    let Some((checked, offset)) = session.workspace.at(&text_document.uri, position) else { return Ok(None) };
    // A space asks by itself behind a word or a number, and not while a line is indented.
    let asked = params.context.and_then(|context| context.trigger_character);
    let line = checked.text(checked.main)[..offset].rsplit('\n').next().unwrap_or_default();
    if asked.as_deref() == Some(" ") && (line.trim().is_empty() || line.ends_with("  ")) {
        return Ok(None);
    }
    let place = place::of_uri(&text_document.uri);
    let items = completion::complete(&session.workspace, &session.client, &place, &checked, offset);
    Ok(Some(lsp::CompletionResponse::Array(items)))
}

fn hover(session: &mut Session, params: lsp::HoverParams) -> Result<Option<lsp::Hover>, Refusal> {
    let TextDocumentPositionParams { text_document, position } = params.text_document_position_params;
    let found = session.workspace.at(&text_document.uri, position);
    let place = place::of_uri(&text_document.uri);
    let (workspace, solutions) = (&session.workspace, &session.solutions);
    let markdown = session.client.markdown;
    Ok(found.and_then(|(checked, offset)| hover::hover(workspace, solutions, &place, &checked, offset, markdown)))
}

fn definition(
    session: &mut Session,
    params: lsp::GotoDefinitionParams,
) -> Result<Option<lsp::GotoDefinitionResponse>, Refusal> {
    let at = params.text_document_position_params;
    let found = session.workspace.at(&at.text_document.uri, at.position);
    let found = found.map(|(checked, offset)| navigation::definition(&session.workspace, &checked, offset));
    Ok(found.filter(|all| !all.is_empty()).map(lsp::GotoDefinitionResponse::Array))
}

fn references(session: &mut Session, params: lsp::ReferenceParams) -> Result<Option<Vec<Location>>, Refusal> {
    let TextDocumentPositionParams { text_document, position } = params.text_document_position;
    let Some((checked, offset)) = session.workspace.at(&text_document.uri, position) else { return Ok(None) };
    let place = place::of_uri(&text_document.uri);
    let with_declaration = params.context.include_declaration;
    Ok(Some(navigation::references(&mut session.workspace, &place, &checked, offset, with_declaration)))
}

fn prepare_rename(
    session: &mut Session,
    params: TextDocumentPositionParams,
) -> Result<Option<lsp::PrepareRenameResponse>, Refusal> {
    let Some((checked, offset)) = session.workspace.at(&params.text_document.uri, params.position) else {
        return Ok(None);
    };
    let (range, placeholder) = rename::prepare(&session.workspace, &checked, offset)?;
    Ok(Some(lsp::PrepareRenameResponse::RangeWithPlaceholder { range, placeholder }))
}

fn rename(session: &mut Session, params: lsp::RenameParams) -> Result<Option<lsp::WorkspaceEdit>, Refusal> {
    let TextDocumentPositionParams { text_document, position } = params.text_document_position;
    let Some((checked, offset)) = session.workspace.at(&text_document.uri, position) else { return Ok(None) };
    let place = place::of_uri(&text_document.uri);
    Ok(Some(rename::rename(&mut session.workspace, &place, &checked, offset, &params.new_name)?))
}

fn symbols(
    session: &mut Session,
    params: lsp::DocumentSymbolParams,
) -> Result<Option<lsp::DocumentSymbolResponse>, Refusal> {
    let uri: Uri = params.text_document.uri;
    let Some(checked) = session.workspace.checked(&place::of_uri(&uri)) else { return Ok(None) };
    let symbols = outline::symbols(&session.workspace.lines_of(&checked, checked.main), &checked);
    Ok(Some(match session.client.nested_symbols {
        true => lsp::DocumentSymbolResponse::Nested(symbols),
        false => {
            let location = |s: &lsp::DocumentSymbol| Location::new(uri.clone(), s.range);
            lsp::DocumentSymbolResponse::Flat(outline::flat(symbols, &location))
        }
    }))
}

fn code_actions(
    session: &mut Session,
    params: lsp::CodeActionParams,
) -> Result<Option<lsp::CodeActionResponse>, Refusal> {
    let wanted = params.context.only.as_ref();
    let fixes = |kind: &lsp::CodeActionKind| lsp::CodeActionKind::QUICKFIX.as_str().starts_with(kind.as_str());
    if wanted.is_some_and(|kinds| !kinds.iter().any(fixes)) {
        return Ok(Some(Vec::new()));
    }
    let Some(checked) = session.workspace.checked(&place::of_uri(&params.text_document.uri)) else { return Ok(None) };
    let found = actions::actions(&session.workspace, &session.client, &checked, params.range);
    Ok(Some(found.into_iter().map(lsp::CodeActionOrCommand::CodeAction).collect()))
}

fn selection(
    session: &mut Session,
    params: lsp::SelectionRangeParams,
) -> Result<Option<Vec<lsp::SelectionRange>>, Refusal> {
    let Some(checked) = session.workspace.checked(&place::of_uri(&params.text_document.uri)) else { return Ok(None) };
    let lines = session.workspace.lines_of(&checked, checked.main);
    Ok(Some(params.positions.into_iter().map(|at| outline::selection(&lines, &checked, at)).collect()))
}

fn semantic(
    session: &mut Session,
    params: lsp::SemanticTokensParams,
) -> Result<Option<lsp::SemanticTokensResult>, Refusal> {
    let checked = session.workspace.checked(&place::of_uri(&params.text_document.uri));
    Ok(checked.map(|checked| {
        let data = tokens::tokens(&session.workspace.lines_of(&checked, checked.main), &checked);
        lsp::SemanticTokensResult::Tokens(lsp::SemanticTokens { result_id: None, data })
    }))
}

fn pulled(
    session: &mut Session,
    params: lsp::DocumentDiagnosticParams,
) -> Result<lsp::DocumentDiagnosticReportResult, Refusal> {
    let checked = session.workspace.checked(&place::of_uri(&params.text_document.uri));
    let items =
        checked.map(|checked| diagnostics::of_file(&session.workspace, &session.client, &checked, checked.main));
    let report = lsp::RelatedFullDocumentDiagnosticReport {
        related_documents: None,
        full_document_diagnostic_report: lsp::FullDocumentDiagnosticReport {
            result_id: None,
            items: items.unwrap_or_default(),
        },
    };
    Ok(lsp::DocumentDiagnosticReportResult::Report(lsp::DocumentDiagnosticReport::Full(report)))
}
