//! plcc, built as part of the tests: the same entry point as the real binary.

fn main() -> std::process::ExitCode {
    plcc::main()
}
