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
    W0710 "not-in-catalog",
}

impl Code {
    pub fn severity(self) -> Severity {
        if self.as_str().starts_with('W') { Severity::Warning } else { Severity::Error }
    }
}
