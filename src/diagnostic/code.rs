//! The stable codes. E01 text and syntax, E02 names and imports, E03 values and dimensions, E04 the layout's
//! geometry, E05 constraints, E06 solving, W07 warnings.

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
}

impl Code {
    pub fn severity(self) -> Severity {
        if self.as_str().starts_with('W') { Severity::Warning } else { Severity::Error }
    }
}
