//! How far a command has come, on standard error, where that is a terminal.
//!
//! ```text
//!   terminal             a bar, from the first tenth of a second on: nothing seems to hang
//!   --progress lines     a plain line at once and every five seconds, wherever standard error goes
//!   else, or --quiet     nothing
//! ```
use crate::say;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::ops::Deref;
use std::sync::OnceLock;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// The bar is drawn anew this often, whatever the work behind it does.
const DRAWN: Duration = Duration::from_millis(100);
/// Plain lines come this often.
const LINES: Duration = Duration::from_secs(5);

/// How progress is shown.
#[derive(clap::ValueEnum, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Shown {
    /// A bar where standard error is a terminal, else nothing
    #[default]
    Auto,
    /// A plain line every five seconds
    Lines,
    /// Nothing
    Off,
}

/// What the command line says; said once, before anything begins.
static ASKED: OnceLock<Shown> = OnceLock::new();

/// Show it so, from here on.
pub(crate) fn ask(shown: Shown) {
    let _ = ASKED.set(shown); // a second time would be the same command line
}

/// Some work that takes a while. Where it goes out of scope it is over.
pub(crate) struct Progress {
    bar: ProgressBar,
    lines: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// Of so many steps of what is named.
    pub(crate) fn new(length: u64, what: &'static str) -> Self {
        let asked = ASKED.get().copied().unwrap_or_default();
        let draws = asked == Shown::Auto && std::io::stderr().is_terminal();
        let bar = ProgressBar::with_draw_target(
            Some(length.max(1)),
            if draws { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() },
        );
        // 80 columns hold it with its name
        if let Ok(style) =
            ProgressStyle::with_template("{msg:34} {bar:24} {percent:>3} %  {elapsed}")
        {
            bar.set_style(style);
        }
        bar.set_message(what);
        if draws {
            bar.enable_steady_tick(DRAWN);
        }
        let lines = (asked == Shown::Lines).then(|| in_lines(bar.clone())).flatten();
        Self { bar, lines }
    }

    /// Reading a program and planning it, told by its lines.
    pub(crate) fn of_lines(text: &[u8], what: &'static str) -> Self {
        Self::new(memchr::memchr_iter(b'\n', text).count() as u64 + 1, what)
    }

    /// As far as this line: a program that jumps back does not take back what was done.
    pub(crate) fn reached(&self, line: u32) {
        let line = u64::from(line);
        if line > self.bar.position() {
            self.bar.set_position(line);
        }
    }
}

impl Deref for Progress {
    type Target = ProgressBar;

    fn deref(&self) -> &ProgressBar {
        &self.bar
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        if let Some((stop, thread)) = self.lines.take() {
            drop(stop);
            let _ = thread.join(); // it writes lines and has nothing to report
        }
    }
}

/// A line now and then, until the sender is gone.
fn in_lines(bar: ProgressBar) -> Option<(Sender<()>, JoinHandle<()>)> {
    let (stop, stopped) = channel();
    let thread = std::thread::Builder::new().name("progress".into()).spawn(move || {
        loop {
            say::err(&line(&bar));
            if stopped.recv_timeout(LINES) != Err(RecvTimeoutError::Timeout) {
                return;
            }
        }
    });
    thread.ok().map(|thread| (stop, thread))
}

fn line(bar: &ProgressBar) -> String {
    let length = bar.length().unwrap_or(1).max(1);
    let percent = 100 * bar.position().min(length) / length;
    format!("{}: {percent} %, {:.0} s\n", bar.message(), bar.elapsed().as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plain_line_says_what_is_done_and_how_far_it_is() {
        let progress = Progress::new(600_000, "planning");
        progress.reached(150_000);
        progress.reached(7); // a loop
        assert_eq!(line(&progress), "planning: 25 %, 0 s\n");
    }
}
