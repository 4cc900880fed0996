//! The stable codes. E01 text and syntax, E02 files, names and imports, E03 values and dimensions, E04 the layout's
//! geometry, E05 constraints, E06 solving, W07 warnings, E08 and W08 drawings that are imported, E09 studies.

use super::Severity;

macro_rules! codes {
    ($($code:ident $name:literal,)*) => {
        /// A stable diagnostic code.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code { $($code,)* }

        impl Code {
            /// Every code there is, in order.
            pub const ALL: &'static [Code] = &[$(Code::$code,)*];

            /// `E0301`.
            pub fn as_str(self) -> &'static str {
                match self { $(Code::$code => stringify!($code),)* }
            }

            /// A short name, `dimension-mismatch`.
            pub fn name(self) -> &'static str {
                match self { $(Code::$code => $name,)* }
            }

            /// Its page in Markdown: what, why, an example, how to fix it. Shown by `lss explain`.
            pub fn page(self) -> &'static str {
                match self { $(Code::$code => include_str!(concat!("pages/", stringify!($code), ".md")),)* }
            }
        }
    };
}

codes! {
    E0101 "unexpected-token",
    E0102 "unknown-statement",
    E0103 "unclosed-bracket",
    E0104 "unclosed-text",
    E0105 "too-deep",
    E0106 "too-large",
    E0107 "stray-character",
    E0108 "bad-number",
    E0109 "stray-bracket",
    E0110 "bad-unit-spelling",
    E0111 "bad-escape",
    E0112 "too-many-mistakes",

    E0201 "invalid-utf8",
    E0202 "import-not-found",
    E0203 "import-outside-root",
    E0204 "import-cycle",
    E0205 "unknown-import",
    E0206 "unknown-name",
    E0207 "unknown-vertex",
    E0208 "unknown-obstacle",
    E0209 "unknown-field",
    E0210 "unknown-parameter",
    E0211 "unknown-function",
    E0212 "repeated-name",
    E0213 "repeated-statement",
    E0214 "missing-statement",
    E0215 "missing-field",
    E0216 "recursive-definition",
    E0217 "no-such-layout",
    E0218 "unknown-station",

    E0301 "dimension-mismatch",
    E0302 "missing-unit",
    E0303 "unknown-unit",
    E0304 "wrong-kind-of-value",
    E0305 "not-finite",
    E0306 "out-of-range",
    E0307 "wrong-arguments",
    E0308 "not-constant",
    E0309 "limit-exceeded",
    E0310 "cart-length-not-offered",
    E0311 "inverted-range",
    E0312 "no-prices",

    E0401 "too-few-vertices",
    E0402 "coincident-vertices",
    E0403 "not-neighbours",
    E0404 "fillets-overlap",
    E0405 "loop-crosses-itself",
    E0406 "polygon-not-simple",
    E0407 "outside-building",
    E0408 "degenerate-turn",
    E0409 "off-the-straight",
    E0410 "height-not-reached",
    E0411 "two-heights",
    E0412 "section-without-place",
    E0413 "vertices-and-route",
    E0414 "no-route",

    E0501 "constraint-never-holds",
    E0502 "contradicting-statements",

    E0601 "no-feasible-layout",
    E0602 "not-met-as-written",
    E0603 "chain-does-not-close",
    E0604 "capacity-not-reached",
    E0605 "no-choice",
    E0606 "equipment-without-room",
    E0650 "not-built-yet",

    W0701 "unused-import",
    W0702 "turn-outside-limits",
    W0703 "radius-outside-limits",
    W0704 "redundant-statement",
    W0705 "implied-constraint",
    W0710 "not-in-catalog",
    W0711 "climb-not-in-catalog",
    W0712 "chain-does-not-fit",
    W0713 "feeding-conveyor",
    W0714 "more-fed-than-taken",

    E0801 "not-a-drawing",
    E0802 "unknown-drawing-unit",
    E0803 "no-centre-line",
    E0804 "loop-not-closed",
    E0805 "not-tangent",
    E0806 "unreadable-shape",
    W0801 "drawing-healed",
    W0802 "outline-left-out",

    E0901 "not-a-study",
    E0902 "unknown-study-key",
    E0903 "bad-study-value",
    E0904 "study-file-unread",
    E0905 "unknown-layout-value",
    E0906 "study-size",
}

impl Code {
    /// The code of that name: `E0301`, `e0301` or `dimension-mismatch`.
    pub fn find(name: &str) -> Option<Code> {
        Code::ALL.iter().copied().find(|c| c.as_str().eq_ignore_ascii_case(name) || c.name() == name)
    }

    pub fn severity(self) -> Severity {
        if self.as_str().starts_with('W') { Severity::Warning } else { Severity::Error }
    }
}
