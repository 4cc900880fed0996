//! Names by what they stand for, which a grammar of colours cannot tell.

use super::text::Lines;
use crate::semantics::Checked;
use crate::semantics::names::NameKind;
use lsp_types::{SemanticToken, SemanticTokenModifier, SemanticTokenType, SemanticTokensLegend};

const TYPES: [SemanticTokenType; 8] = [
    SemanticTokenType::VARIABLE,
    SemanticTokenType::PARAMETER,
    SemanticTokenType::CLASS,
    SemanticTokenType::NAMESPACE,
    SemanticTokenType::PROPERTY,
    SemanticTokenType::FUNCTION,
    SemanticTokenType::EVENT,
    SemanticTokenType::ENUM_MEMBER,
];

pub fn legend() -> SemanticTokensLegend {
    SemanticTokensLegend {
        token_types: TYPES.to_vec(),
        token_modifiers: vec![SemanticTokenModifier::DECLARATION, SemanticTokenModifier::READONLY],
    }
}

fn kind_of(kind: &NameKind) -> SemanticTokenType {
    match kind {
        NameKind::Value => SemanticTokenType::VARIABLE,
        NameKind::Parameter | NameKind::EffectArgument(_) => SemanticTokenType::PARAMETER,
        NameKind::Component(_) => SemanticTokenType::CLASS,
        NameKind::Layout | NameKind::Module => SemanticTokenType::NAMESPACE,
        NameKind::Field(..) => SemanticTokenType::PROPERTY,
        NameKind::Function => SemanticTokenType::FUNCTION,
        NameKind::Effect => SemanticTokenType::EVENT,
        NameKind::Vertex | NameKind::Obstacle | NameKind::Section | NameKind::Building => {
            SemanticTokenType::ENUM_MEMBER
        }
        NameKind::Induction | NameKind::Chutes | NameKind::Station => SemanticTokenType::ENUM_MEMBER,
    }
}

pub fn tokens(lines: &Lines, checked: &Checked) -> Vec<SemanticToken> {
    let Some(study) = &checked.study else { return Vec::new() };
    let mut all = Vec::new();
    let (mut line, mut character, mut last) = (0, 0, u32::MAX);
    for name in study.names.in_file(checked.main) {
        if name.span.start == last {
            continue;
        }
        last = name.span.start;
        let range = lines.of_span(name.span);
        let delta_line = range.start.line - line;
        let delta_start = if delta_line == 0 { range.start.character - character } else { range.start.character };
        (line, character) = (range.start.line, range.start.character);
        let wanted = kind_of(&name.kind);
        let token_type = TYPES.iter().position(|t| *t == wanted).unwrap_or(0) as u32;
        let readonly = u32::from(matches!(name.kind, NameKind::Value)) << 1;
        all.push(SemanticToken {
            delta_line,
            delta_start,
            length: range.end.character - range.start.character,
            token_type,
            token_modifiers_bitset: u32::from(name.declares()) | readonly,
        });
    }
    all
}
