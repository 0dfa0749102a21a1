//! The `leadscrew` program: what the library of this crate does with the words that were typed.
use std::process::ExitCode;

fn main() -> ExitCode {
    // a file that is larger than the system allows is an error of the write, not the end of a
    // control; without the handler, which fails only for want of memory, it is the latter
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
    ExitCode::from(cli::main(std::env::args_os()))
}
