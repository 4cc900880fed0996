fn main() -> std::process::ExitCode {
    lss::cli::main()
}
