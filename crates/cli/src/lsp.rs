//! `leadscrew lsp`: the language server on standard input and output.
//!
//! ```text
//!   Content-Length: 52\r\n\r\n{…}  ─► thread ─► messages ─► server ─► messages ─► thread ─► standard output
//! ```
//!
//! What an editor says of the length of a message is not believed before the bytes are there:
//! memory is taken for what has come.
use control::Refused;
use control::job::options::ProgramOptions;
use leadscrew::editor::{Files, Machines};
use lsp_server::{Connection, Message};
use std::io::{self, BufRead, Read};

/// Longest line of a header, and most of them.
const LONGEST_LINE: u64 = 1024;
const MOST_LINES: usize = 32;
/// Longest message: a program of several million lines.
const LONGEST: u64 = 1 << 28;

/// Serve one editor. True if it took leave in order.
pub(crate) fn command(source: ProgramOptions) -> Result<bool, Refused> {
    let (connection, editor) = Connection::memory();
    let Connection { sender, receiver } = editor;
    let no_thread = |e| Refused::because(format!("cannot start a thread for the editor: {e}"));
    let (tell, broken) = std::sync::mpsc::channel();
    let read = move || {
        let mut input = io::stdin().lock();
        loop {
            match message(&mut input) {
                Ok(Some(message)) => {
                    if sender.send(message).is_err() {
                        return; // the server has ended
                    }
                }
                Ok(None) => return, // the editor has closed its end
                Err(why) => {
                    let _ = tell.send(why); // it is heard once the server has ended
                    return;
                }
            }
        }
    };
    std::thread::Builder::new().name("lsp-in".into()).spawn(read).map_err(no_thread)?;
    let write = move || -> io::Result<()> {
        for message in receiver {
            message.write(&mut io::stdout().lock())?;
        }
        Ok(())
    };
    let writer =
        std::thread::Builder::new().name("lsp-out".into()).spawn(write).map_err(no_thread)?;
    let host = Machines::new(source, Files);
    let served = lsp::serve(&connection, &host);
    drop(connection);
    let written = match writer.join() {
        Ok(written) => written,
        // a panic of it is a defect of ours: let it be seen as one
        Err(panic) => std::panic::resume_unwind(panic),
    };
    let pipe = |e: io::Error| Refused::because(format!("the editor's pipe broke: {e}"));
    if let Ok(why) = broken.try_recv() {
        return Err(pipe(why));
    }
    let served = served.map_err(|e| Refused::because(format!("the editor broke off: {e}")))?;
    written.map_err(pipe)?;
    Ok(served)
}

/// The next message; `None`: the editor has closed its end.
fn message(input: &mut impl BufRead) -> io::Result<Option<Message>> {
    let Some(length) = header(input)? else { return Ok(None) };
    if length > LONGEST {
        return Err(io::Error::other(format!(
            "a message of {length} bytes is announced: at most {LONGEST} are read"
        )));
    }
    let mut text = Vec::new();
    input.take(length).read_to_end(&mut text)?;
    if (text.len() as u64) < length {
        return Err(io::Error::other("it ended within a message"));
    }
    serde_json::from_slice(&text)
        .map(Some)
        .map_err(|e| io::Error::other(format!("a message is no JSON-RPC: {e}")))
}

/// The length that a header states.
fn header(input: &mut impl BufRead) -> io::Result<Option<u64>> {
    let mut length = None;
    for number in 0..MOST_LINES {
        let mut line = Vec::new();
        input.take(LONGEST_LINE).read_until(b'\n', &mut line)?;
        let line = match line.strip_suffix(b"\n") {
            Some(line) => line.strip_suffix(b"\r").unwrap_or(line),
            None if line.is_empty() && number == 0 => return Ok(None),
            None => return Err(io::Error::other("a message's header is too long or torn")),
        };
        if line.is_empty() {
            return match length {
                Some(length) => Ok(Some(length)),
                None => Err(io::Error::other("a message's header states no Content-Length")),
            };
        }
        let text = String::from_utf8_lossy(line);
        let value =
            text.split_once(':').filter(|(name, _)| name.eq_ignore_ascii_case("Content-Length"));
        if let Some((_, value)) = value {
            let value = value.trim().parse();
            length = Some(value.map_err(|_| {
                io::Error::other("a message's Content-Length is no whole number of bytes")
            })?);
        }
    }
    Err(io::Error::other("a message's header is too long or torn"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Option<Message>, String> {
        message(&mut text.as_bytes()).map_err(|e| e.to_string())
    }

    #[test]
    fn a_message_is_read_whole_whatever_the_spelling_of_its_header() {
        let body = r#"{"jsonrpc":"2.0","method":"exit"}"#;
        for name in ["Content-Length: ", "content-length:"] {
            let text = format!("Content-Type: x\r\n{name}{}\r\n\r\n{body}", body.len());
            assert!(
                matches!(read(&text), Ok(Some(Message::Notification(n))) if n.method == "exit")
            );
        }
        assert!(matches!(read(""), Ok(None)));
    }

    #[test]
    fn no_memory_is_taken_for_what_is_only_announced() {
        let huge = |length: u64| read(&format!("Content-Length: {length}\r\n\r\n{{}}"));
        assert!(huge(1 << 33).unwrap_err().contains("at most 268435456"));
        assert!(huge(u64::MAX).unwrap_err().contains("18446744073709551615"));
        assert!(huge(LONGEST).unwrap_err().contains("within a message"));
        let endless = "x".repeat(1 << 16);
        assert!(read(&endless).unwrap_err().contains("too long"));
        assert!(read(&"a: b\r\n".repeat(100)).unwrap_err().contains("too long"));
        for wrong in ["Content-Length: -1\r\n\r\n", "Content-Length: 1e3\r\n\r\n", "\r\n", "{}"] {
            assert!(read(wrong).is_err(), "{wrong:?}");
        }
    }
}
