//! One control after the other.
use super::process::{Alone, SimulatorProcess};
use control::Refused;
use control::clock;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::time::Duration;
use wire::{Error, Message, Order, Port};

/// How long a client that connects may take to state what it wants.
const PATIENCE: Duration = Duration::from_secs(5);

/// A machine simulator at its socket.
pub struct Listening {
    simulator: SimulatorProcess,
    listener: UnixListener,
    path: PathBuf,
}

impl SimulatorProcess {
    /// Listen at `path`, a Unix socket, in place of one at which no process listens any more.
    ///
    /// # Errors
    /// Another machine simulator listens there, or no socket can be made there.
    pub fn listen(self, path: &Path) -> Result<Listening, Refused> {
        Ok(Listening { simulator: self, listener: listen(path)?, path: path.to_owned() })
    }
}

impl Listening {
    /// For people: which machine it is, and which encoders.
    pub fn name(&self) -> String {
        self.simulator.who()
    }

    /// One control after the other, until a client orders the end. `lost` is told why a control is gone that did not
    /// just end.
    pub fn serve(mut self, mut lost: impl FnMut(&Error)) {
        loop {
            let Ok((stream, _)) = self.listener.accept() else { continue };
            match session(&mut self.simulator, stream) {
                Ok(After::Next) => {}
                Ok(After::Quit) => {
                    let _ = std::fs::remove_file(&self.path); // removed already
                    return;
                }
                Err(why) => lost(&why),
            }
        }
    }
}

/// What comes after a session.
#[derive(Clone, Copy, PartialEq, Eq)]
enum After {
    Next,
    Quit,
}

/// A socket of that name, in place of one at which no process listens any more.
fn listen(path: &Path) -> Result<UnixListener, Refused> {
    let failed = |e| Refused::because(format!("cannot listen at {}: {e}", path.display()));
    match UnixListener::bind(path) {
        Err(e) if e.kind() == std::io::ErrorKind::AddrInUse => {
            if UnixStream::connect(path).is_ok() {
                let path = path.display();
                return Err(Refused::because(format!(
                    "another machine simulator listens at {path} already"
                )));
            }
            std::fs::remove_file(path).map_err(failed)?;
            UnixListener::bind(path).map_err(failed)
        }
        other => other.map_err(failed),
    }
}

fn session(simulator: &mut SimulatorProcess, stream: UnixStream) -> Result<After, Error> {
    stream.set_read_timeout(Some(PATIENCE))?;
    let pace = stream.try_clone()?;
    let mut port = Port::new(stream);
    match port.take()? {
        Message::Order(order) => {
            match order {
                Order::PowerCut => simulator.leave_alone(Alone::Power),
                Order::ToolIsFree => simulator.tool_is_free(),
                Order::Status | Order::Quit => {}
            }
            port.send(&Message::Told(simulator.status()))?;
            return Ok(if order == Order::Quit { After::Quit } else { After::Next });
        }
        Message::Hello(hello) if hello.machine != simulator.name() => {
            let (has, wants) = (simulator.name(), hello.machine);
            port.send(&Message::Refused(format!(
                "this machine simulator is a {has}, and {} is set up for a {wants}: name the machine with --machine {has}",
                hello.name
            )))?;
            return Ok(After::Next);
        }
        Message::Hello(_) => port.send(&Message::Welcome(simulator.welcome()))?,
        Message::Welcome(_)
        | Message::Refused(_)
        | Message::Command(..)
        | Message::Observed(_)
        | Message::Told(_) => {
            port.send(&Message::Refused("expected a greeting or an order".into()))?;
            return Ok(After::Next);
        }
    }
    let ended = if simulator.real_time {
        in_real_time(simulator, &mut port, &pace)
    } else {
        pace.set_read_timeout(None)?;
        in_lock_step(simulator, &mut port)
    };
    if let Err(Error::Refused(why)) = &ended {
        // one that is gone already does not hear it
        let _ = port.send(&Message::Refused(why.clone()));
    }
    simulator.leave_alone(if matches!(ended, Ok(())) { Alone::Power } else { Alone::Link });
    match ended {
        // the whole cabinet is dark: no message is sent
        Ok(()) => Ok(After::Next),
        Err(Error::Gone(e)) if e.kind() == std::io::ErrorKind::UnexpectedEof => Ok(After::Next),
        Err(Error::Gone(e)) if e.kind() == std::io::ErrorKind::ConnectionReset => Ok(After::Next),
        Err(why) => Err(why),
    }
}

/// A command, as something that may be due.
fn command(simulator: &mut SimulatorProcess, message: &Message) -> Result<bus::Command, Error> {
    match message {
        Message::Command(command, engagement) => {
            simulator.hear(*engagement).map_err(Error::Refused)?;
            Ok(*command)
        }
        Message::Hello(_)
        | Message::Welcome(_)
        | Message::Refused(_)
        | Message::Observed(_)
        | Message::Order(_)
        | Message::Told(_) => {
            Err(Error::Unexpected { found: "another message", expected: "a command" })
        }
    }
}

/// Time waits for the control. Returns when the power is cut.
fn in_lock_step(
    simulator: &mut SimulatorProcess,
    port: &mut Port<UnixStream>,
) -> Result<(), Error> {
    loop {
        let order = command(simulator, &port.take()?)?;
        if !simulator.obey(&order) {
            return Ok(());
        }
        port.send(&Message::Observed(simulator.observed()))?;
    }
}

/// Time does not wait for the control: what comes too late acts a period later.
fn in_real_time(
    simulator: &mut SimulatorProcess,
    port: &mut Port<UnixStream>,
    pace: &UnixStream,
) -> Result<(), Error> {
    let period = Duration::from_secs_f64(simulator.period().value());
    let mut last = bus::Command::default();
    let mut silent = Duration::ZERO;
    let mut due = clock::now() + period;
    loop {
        let left = due.saturating_duration_since(clock::now());
        pace.set_read_timeout(Some(left.max(Duration::from_micros(1))))?;
        let answer = if let Some(message) = port.take_soon()? {
            last = command(simulator, &message)?;
            silent = Duration::ZERO;
            true
        } else {
            silent += period;
            false
        };
        std::thread::sleep(due.saturating_duration_since(clock::now()));
        // a machine simulator that was late itself has not waited for the control: its time begins anew from here
        due = clock::now().max(due) + period;
        if silent.as_secs_f64() > simulator.watchdog.value() {
            return Err(Error::Refused("silent for longer than the drives' watchdog".into()));
        }
        if !simulator.obey(&last) {
            return Ok(());
        }
        if answer {
            port.send(&Message::Observed(simulator.observed()))?;
        }
    }
}
