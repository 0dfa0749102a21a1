//! Lines of a log that hold up no machine: their reader may be slow, a machine in real time may not
//! wait.
//!
//! ```text
//!   in lock-step ─► standard output                                 time waits for the reader
//!   by the clock ─► bounded queue ─► a thread ─► standard output
//!                     └ full: the line is counted, and how many are missing is said when there is room again
//! ```
use crate::say;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;

/// Lines that wait for their reader.
const WAITING: usize = 4096;

/// See the module's header.
pub(crate) enum Lines {
    /// Each is written before anything goes on.
    AtOnce,
    /// Each is written when its reader has time.
    Beside(Beside),
}

/// Written by a thread of its own.
pub(crate) struct Beside {
    lines: Option<SyncSender<String>>,
    thread: Option<JoinHandle<()>>,
    missing: u64,
}

impl Lines {
    /// For a machine whose time does not wait. Where there is no thread to be had, there is no log.
    pub(crate) fn beside() -> Self {
        Self::written_by(|line| {
            // a log that cannot be written stops no machine
            let _ = say::out(line);
        })
    }

    fn written_by(write: impl FnMut(&str) + Send + 'static) -> Self {
        let (lines, to_write) = sync_channel(WAITING);
        let thread = std::thread::Builder::new().name("log".into());
        let thread = thread.spawn(move || each(&to_write, write)).ok();
        Self::Beside(Beside { lines: Some(lines), thread, missing: 0 })
    }

    /// One line.
    pub(crate) fn line(&mut self, text: &str) {
        match self {
            // a log that cannot be written stops no machine; what is said at the end tells why
            Self::AtOnce => drop(say::out(&format!("{text}\n"))),
            Self::Beside(beside) => beside.line(text),
        }
    }
}

fn each(lines: &Receiver<String>, mut write: impl FnMut(&str)) {
    for line in lines {
        write(&line);
    }
}

impl Beside {
    fn line(&mut self, text: &str) {
        let Some(lines) = &self.lines else { return };
        let before = match self.missing {
            0 => String::new(),
            1 => "one line is missing here: who reads the log is too slow\n".to_owned(),
            n => format!("{n} lines are missing here: who reads the log is too slow\n"),
        };
        match lines.try_send(format!("{before}{text}\n")) {
            Ok(()) => self.missing = 0,
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => self.missing += 1,
        }
    }
}

/// The machine has ended: what waits is written out.
impl Drop for Beside {
    fn drop(&mut self) {
        drop(self.lines.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join(); // it writes lines and has nothing to report
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    use std::sync::{Arc, Mutex};

    #[test]
    fn a_reader_that_reads_nothing_holds_up_no_machine_and_is_told_what_it_missed() {
        let (begin, begun) = channel::<()>();
        let (hold, held) = channel::<()>();
        let written = Arc::new(Mutex::new(Vec::new()));
        let into = Arc::clone(&written);
        let mut lines = Lines::written_by(move |line| {
            let _ = hold.send(());
            let _ = begun.recv(); // the first line waits for its reader, and those after it
            into.lock().unwrap().push(line.to_owned());
        });
        lines.line("0");
        held.recv().unwrap();
        for n in 1..2 * WAITING {
            lines.line(&n.to_string()); // with a pipe that is full this would never return
        }
        drop(begin);
        // once there is room again
        while !written.lock().unwrap().iter().any(|line| line.contains("missing")) {
            lines.line("again");
            std::thread::yield_now();
        }
        drop(lines);
        let written = written.lock().unwrap();
        assert_eq!(written[..3], ["0\n", "1\n", "2\n"]);
        let said = written.iter().find(|line| line.contains("missing")).unwrap();
        assert!(said.ends_with("too slow\nagain\n"), "{said}");
    }
}
