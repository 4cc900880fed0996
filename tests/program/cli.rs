//! The command line: each `tests/cli/*.trycmd` is a session with its output; adding one takes no Rust.

#[test]
fn sessions() {
    trycmd::TestCases::new().case("tests/cli/*.trycmd").case("README.md").run();
}
