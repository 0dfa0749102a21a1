//! Stands between a control and the machine simulator, and kills the control or cuts the mains at a machine time.
//!
//! ```text
//!   control ── Command ──►       ── Command ──►  machine simulator
//!           ◄─ Observed ── Relay ◄─ Observed ──
//!                            │ at t: SIGKILL to the control, then the simulator's end is closed; or the mains fail
//! ```
//!
//! The simulator waits for the control, period by period, so that the instant is exact: the command
//! that answers the first feedback at t or later is not handed on.
//!
//! Each period costs four changes of process by way of the relay and two without it: a control that
//! nothing is to stop is connected to the simulator itself, whose socket takes its old name again.
use std::io;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use wire::{Message, Order, Port};

/// What stops a control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// SIGKILL to its process.
    Kill,
    /// The mains of the machine fail.
    PowerCut,
}

/// What the relay's thread and its owner share.
#[derive(Debug, Default)]
struct Plan {
    /// Process of the control that was started last.
    control: Option<u32>,
    /// Machine times, s, the latest first.
    stops: Vec<(f64, Stop)>,
}

#[derive(Clone, Debug, Default)]
struct Shared(Arc<Mutex<Plan>>);

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Plan> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A relay in the place of a simulator's socket.
#[derive(Debug)]
pub struct Relay {
    /// Where a control connects.
    socket: PathBuf,
    ended: Arc<AtomicBool>,
    plan: Shared,
    is_between: AtomicBool,
}

/// Where the simulator listens while the relay is at its socket.
fn behind(socket: &Path) -> PathBuf {
    socket.with_extension("behind")
}

/// Where the relay listens while the simulator is at its own socket.
fn beside(socket: &Path) -> PathBuf {
    socket.with_extension("relay")
}

impl Relay {
    /// Take the place of the socket at which a simulator listens. The controls that [`Relay::output`] starts are
    /// killed at these machine times, s, rising.
    ///
    /// # Errors
    /// The socket cannot be renamed, or none made in its place.
    pub fn in_place_of(socket: &Path, kills: &[f64]) -> io::Result<Self> {
        std::fs::rename(socket, behind(socket))?;
        let listener = UnixListener::bind(socket)?;
        let relay = Self {
            socket: socket.to_owned(),
            ended: Arc::default(),
            plan: Shared::default(),
            is_between: AtomicBool::new(true),
        };
        let ended = relay.ended.clone();
        relay.plan.lock().stops = kills.iter().rev().map(|at| (*at, Stop::Kill)).collect();
        let relayed = Relayed { behind: behind(socket), plan: relay.plan.clone() };
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

    /// From now on, what stops a control at the machine time `at`, s, and nothing else.
    pub fn stop_at(&self, at: f64, stop: Stop) {
        self.plan.lock().stops = vec![(at, stop)];
    }

    /// What has not stopped a control will not any more; whether everything had.
    #[must_use]
    pub fn cancel_stops(&self) -> bool {
        std::mem::take(&mut self.plan.lock().stops).is_empty()
    }

    /// Start a control, and wait for its end.
    ///
    /// # Errors
    /// It cannot be started.
    pub fn output(&self, command: &mut Command) -> io::Result<Output> {
        use std::process::Stdio;
        self.stand_between(!self.plan.lock().stops.is_empty())?;
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut plan = self.plan.lock();
        let child: Child = command.spawn()?;
        plan.control = Some(child.id());
        drop(plan);
        child.wait_with_output()
    }

    /// Takes the place of the simulator's socket, or gives it back.
    fn stand_between(&self, stands: bool) -> io::Result<()> {
        let [socket, behind, beside] =
            [self.socket.clone(), behind(&self.socket), beside(&self.socket)];
        match (self.is_between.swap(stands, Ordering::AcqRel), stands) {
            (true, false) => {
                std::fs::rename(&socket, beside)?;
                std::fs::rename(behind, socket)
            }
            (false, true) => {
                std::fs::rename(&socket, behind)?;
                std::fs::rename(beside, socket)
            }
            _ => Ok(()),
        }
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Release);
        // its thread waits for a client
        let is_between = self.is_between.load(Ordering::Acquire);
        let own = if is_between { self.socket.clone() } else { beside(&self.socket) };
        let _ = UnixStream::connect(own);
    }
}

/// The thread's own.
struct Relayed {
    behind: PathBuf,
    plan: Shared,
}

impl Relayed {
    /// One client, until either end is closed.
    fn session(&self, control: UnixStream) -> Result<(), wire::Error> {
        let mut control = Port::new(control);
        let mut simulator = Port::new(UnixStream::connect(&self.behind)?);
        let mut now = f64::NEG_INFINITY;
        loop {
            let asked = control.take()?;
            match self.due(now) {
                Some((Stop::Kill, process)) => return Ok(kill(process)?),
                Some((Stop::PowerCut, _)) => {
                    wire::order(UnixStream::connect(&self.behind)?, Order::PowerCut)?;
                }
                None => {}
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

    /// What stops the control that has begun, now.
    fn due(&self, now: f64) -> Option<(Stop, u32)> {
        let mut plan = self.plan.lock();
        let process = plan.control?;
        let (_, stop) = plan.stops.pop_if(|(at, _)| *at <= now)?;
        Some((stop, process))
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
