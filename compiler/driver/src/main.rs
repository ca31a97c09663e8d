//! The `plcc` program.

fn main() -> std::process::ExitCode {
    plcc::main()
}
