//! Words to standard output and standard error.
//!
//! `print!` panics when nobody reads any more (`leadscrew check part.ngc | head -1`) or the disk that takes the
//! output is full. Here a reader that has gone away is no error, and anything else is one sentence.
use control::Refused;
use std::io::{self, ErrorKind, Write};

/// To standard output, as it stands.
pub(crate) fn out(text: &str) -> Result<(), Refused> {
    let mut out = io::stdout().lock();
    written(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// What became of something written to standard output.
pub(crate) fn written(result: io::Result<()>) -> Result<(), Refused> {
    match result {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Refused::because(format!("cannot write to standard output: {e}")))
        }
        _ => Ok(()),
    }
}

/// To standard error. There is nobody to tell if that fails.
pub(crate) fn err(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}
