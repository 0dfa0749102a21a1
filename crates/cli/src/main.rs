//! The `leadscrew` program: what the library of this crate does with the words that were typed.
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(cli::main(std::env::args_os()))
}
