//! Stands between a control and the machine simulator, and kills the control at a machine time.
//!
//! ```text
//!   control ── Command ──►       ── Command ──►  machine simulator
//!           ◄─ Observed ── Relay ◄─ Observed ──
//!                            │ at t: SIGKILL to the control, then the simulator's end is closed
//! ```
//!
//! The simulator waits for the control, period by period, so that the instant of the kill is exact: the command
//! that answers the first feedback at t or later is not handed on.
use std::io;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use wire::{Message, Port};

/// Process of the control that was started last.
#[derive(Clone, Debug, Default)]
struct Shared(Arc<Mutex<Option<u32>>>);

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Option<u32>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A relay in the place of a simulator's socket.
#[derive(Debug)]
pub struct Relay {
    socket: PathBuf,
    ended: Arc<AtomicBool>,
    control: Shared,
}

impl Relay {
    /// Take the place of the socket at which a simulator listens. The controls that [`Relay::output`] starts are
    /// killed at these machine times, s, rising.
    ///
    /// # Errors
    /// The socket cannot be renamed, or none made in its place.
    pub fn in_place_of(socket: &Path, kills: &[f64]) -> io::Result<Self> {
        let behind = socket.with_extension("behind");
        std::fs::rename(socket, &behind)?;
        let listener = UnixListener::bind(socket)?;
        let relay =
            Self { socket: socket.to_owned(), ended: Arc::default(), control: Shared::default() };
        let ended = relay.ended.clone();
        let kills = kills.iter().rev().copied().collect();
        let mut relayed = Relayed { behind, kills, control: relay.control.clone() };
        std::thread::Builder::new().name("relay".into()).spawn(move || {
            for control in listener.incoming().flatten() {
                if ended.load(Ordering::Acquire) {
                    break;
                }
                // a client or a simulator that is gone has ended the session
                let _ = relayed.session(control);
            }
        })?;
        Ok(relay)
    }

    /// Start a control, and wait for its end.
    ///
    /// # Errors
    /// It cannot be started.
    pub fn output(&self, command: &mut Command) -> io::Result<Output> {
        use std::process::Stdio;
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut control = self.control.lock();
        let child: Child = command.spawn()?;
        *control = Some(child.id());
        drop(control);
        child.wait_with_output()
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Release);
        // its thread waits for a client
        let _ = UnixStream::connect(&self.socket);
    }
}

/// The thread's own.
struct Relayed {
    behind: PathBuf,
    /// The latest first.
    kills: Vec<f64>,
    control: Shared,
}

impl Relayed {
    /// One client, until either end is closed.
    fn session(&mut self, control: UnixStream) -> Result<(), wire::Error> {
        let mut control = Port::new(control);
        let mut simulator = Port::new(UnixStream::connect(&self.behind)?);
        let mut now = f64::NEG_INFINITY;
        loop {
            let asked = control.take()?;
            let due = self.kills.pop_if(|at| *at <= now).is_some();
            if due && let Some(control) = *self.control.lock() {
                kill(control)?;
                return Ok(());
            }
            simulator.send(&asked)?;
            let answer = simulator.take()?;
            control.send(&answer)?;
            now = match answer {
                Message::Observed(observed) => observed.feedback.time.value(),
                Message::Welcome(welcome) => welcome.observed.feedback.time.value(),
                _ => now,
            };
        }
    }
}

/// SIGKILL, from outside.
fn kill(process: u32) -> io::Result<()> {
    let killed =
        Command::new("sh").args(["-c", "kill -KILL \"$0\"", &process.to_string()]).status()?;
    if killed.success() {
        Ok(())
    } else {
        Err(io::Error::other(format!("process {process} cannot be killed")))
    }
}
