//! Text to tree (pest, grammar in `grammar/lss.pest`) and tree to text (the formatter).

pub mod tree;
