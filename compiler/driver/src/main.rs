//! The `plcc` program.

use clap::Parser;
use std::process::ExitCode;

/// The passes recurse over expressions of bounded depth (`ast::MAX_DEPTH`); this is enough for all of them. Only touched
/// pages cost memory.
const STACK_BYTES: usize = 512 << 20;

fn main() -> ExitCode {
    let cli = plcc::cli::Cli::parse();
    std::panic::set_hook(Box::new(|info| {
        eprintln!("plcc has a bug: {info}");
        eprintln!("please report it with the sources that led here");
    }));
    let work = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(move || plcc::execute(cli));
    match work.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => ExitCode::from(code),
        Ok(Err(_)) => ExitCode::from(70),
        Err(e) => {
            eprintln!("plcc: cannot start a thread: {e}");
            ExitCode::from(3)
        }
    }
}
