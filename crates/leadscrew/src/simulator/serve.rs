//! One control after the other, and orders at any time.
use super::exclusive::{ExclusiveControl, is_gone};
use super::process::{Alone, SimulatorProcess};
use bus::EngagedTool;
use control::Refused;
use control::clock;
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use wire::{Error, Hello, Message, Observed, Order, Port};

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

/// Connections at a time; more are closed at once.
const MOST_CONNECTIONS: usize = 64;

impl Listening {
    /// For people: which machine it is, and which encoders.
    pub fn name(&self) -> String {
        self.simulator.who()
    }

    /// One control after the other, and orders meanwhile, until a client orders the end. `lost` is
    /// told why a control is gone that did not just end.
    pub fn serve(self, lost: impl FnMut(&Error) + Send) {
        let Self { simulator, listener, path } = self;
        let served = Served {
            simulator: Mutex::new(simulator),
            exclusive: ExclusiveControl::default(),
            ended: AtomicBool::new(false),
        };
        let (lost, connections) = (Mutex::new(lost), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            while !served.ended.load(Ordering::Acquire) {
                let Ok((stream, _)) = listener.accept() else { continue };
                if served.ended.load(Ordering::Acquire) {
                    break;
                }
                if connections.fetch_add(1, Ordering::AcqRel) >= MOST_CONNECTIONS {
                    connections.fetch_sub(1, Ordering::AcqRel);
                    continue;
                }
                let connection = || {
                    if let Err(why) = served.connection(stream, &path) {
                        lock(&lost)(&why);
                    }
                    connections.fetch_sub(1, Ordering::AcqRel);
                };
                let thread = std::thread::Builder::new().name("connection".into());
                if thread.spawn_scoped(scope, connection).is_err() {
                    connections.fetch_sub(1, Ordering::AcqRel); // the client sees it closed
                }
            }
        });
        let _ = std::fs::remove_file(&path); // removed already
    }
}

/// What the threads of all connections share.
struct Served {
    simulator: Mutex<SimulatorProcess>,
    exclusive: ExclusiveControl,
    ended: AtomicBool,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A socket of that name, in place of one at which no process listens any more.
fn listen(path: &Path) -> Result<UnixListener, Refused> {
    let failed = |e| Refused::because(format!("cannot listen at {}: {e}", path.display()));
    match UnixListener::bind(path) {
        Err(e) if e.kind() == std::io::ErrorKind::AddrInUse => {
            let about = std::fs::symlink_metadata(path).map_err(failed)?;
            if !about.file_type().is_socket() {
                let path = path.display();
                return Err(Refused::because(format!(
                    "cannot listen at {path}: it is no socket, and stays as it is; name a path where there is nothing"
                )));
            }
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

impl Served {
    /// One client, until it is gone.
    fn connection(&self, stream: UnixStream, path: &Path) -> Result<(), Error> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let own = stream.try_clone()?;
        let mut port = Port::new(stream);
        let message = match port.take() {
            Err(Error::Gone(_)) => return Ok(()), // it has asked for nothing
            other => other?,
        };
        match message {
            Message::Order(order) => self.order(order, &mut port, &own, path),
            Message::Hello(hello) => self.hello(&hello, &mut port, &own),
            Message::Welcome(_)
            | Message::Refused(_)
            | Message::Command(..)
            | Message::Observed(_)
            | Message::Told(_)
            | Message::RenewTool(_) => {
                port.send(&Message::Refused("expected a greeting or an order".into()))
            }
        }
    }

    /// An order is done between two periods of the control that has the machine, for a client that
    /// waits for its answer.
    fn order(
        &self,
        order: Order,
        port: &mut Port<UnixStream>,
        own: &UnixStream,
        path: &Path,
    ) -> Result<(), Error> {
        self.exclusive.settle();
        if is_gone(own) {
            return Ok(()); // the client that wanted it is gone
        }
        match order {
            Order::Status => {}
            Order::PowerCut => self.power_cut(),
            Order::ToolIsFree => {
                match self.exclusive.take("who states that no tool is in the work", own) {
                    Ok(_held) => lock(&self.simulator).tool_is_free(),
                    Err(Error::Refused(why)) => return port.send(&Message::Refused(why)),
                    Err(why) => return Err(why),
                }
            }
            Order::Quit => {
                self.power_cut();
                self.ended.store(true, Ordering::Release);
            }
        }
        let status = lock(&self.simulator).status();
        let told = port.send(&Message::Told(status));
        if order == Order::Quit {
            // the thread that listens looks whether it is over when a client connects
            let _ = UnixStream::connect(path);
        }
        told
    }

    /// The mains fail: the drives are alone, and the whole cabinet is dark for the control.
    fn power_cut(&self) {
        lock(&self.simulator).leave_alone(Alone::Power);
        self.exclusive.cut();
    }

    /// A control reports.
    fn hello(
        &self,
        hello: &Hello,
        port: &mut Port<UnixStream>,
        own: &UnixStream,
    ) -> Result<(), Error> {
        let has = lock(&self.simulator).name().to_owned();
        if hello.machine != has {
            return port.send(&Message::Refused(format!(
                "this machine simulator is a {has}, and {} is set up for a {}: name the machine with --machine {has}",
                hello.name, hello.machine
            )));
        }
        let _held = match self.exclusive.take(&hello.name, own) {
            Ok(held) => held,
            Err(Error::Refused(why)) => return port.send(&Message::Refused(why)),
            Err(Error::Gone(_)) => return Ok(()),
            Err(why) => return Err(why),
        };
        let (welcome, session, real_time) = {
            let mut simulator = lock(&self.simulator);
            (simulator.welcome(), simulator.session(), simulator.real_time)
        };
        port.send(&Message::Welcome(welcome))?;
        let ended = if real_time {
            self.in_real_time(session, port, own)
        } else {
            own.set_read_timeout(None)?;
            self.in_lock_step(session, port)
        };
        match &ended {
            Ok(()) | Err(Error::Gone(_)) => {} // who is gone already does not hear it
            Err(why) => drop(port.send(&Message::Refused(why.to_string()))),
        }
        let mut simulator = lock(&self.simulator);
        if simulator.session() == session {
            simulator.leave_alone(if ended.is_ok() { Alone::Power } else { Alone::Link });
        }
        match ended {
            // the whole cabinet is dark: no message is sent
            Ok(()) => Ok(()),
            Err(Error::Gone(e)) if is_end(e.kind()) => Ok(()),
            Err(why) => Err(why),
        }
    }

    /// Let the machine obey for a period, and what the control is told of it if it `asks`; `None`:
    /// its mains have failed.
    fn obey(
        &self,
        session: u64,
        (command, engagement): &(bus::Command, Option<EngagedTool>),
        asks: bool,
    ) -> Result<Option<Observed>, Error> {
        let mut simulator = lock(&self.simulator);
        if simulator.session() != session {
            return Ok(None);
        }
        simulator.hear(*engagement).map_err(Error::Refused)?;
        let is_on = simulator.obey(command).map_err(Error::Refused)?;
        Ok(is_on.then(|| if asks { simulator.answer() } else { simulator.observed() }))
    }

    /// A new tool is in the place of the old one; `None`: the mains have failed.
    fn renew_tool(&self, session: u64, number: u32) -> Option<Observed> {
        let mut simulator = lock(&self.simulator);
        (simulator.session() == session).then(|| {
            simulator.renew_tool(number);
            simulator.observed()
        })
    }

    /// Time waits for the control. Returns when the power is cut.
    fn in_lock_step(&self, session: u64, port: &mut Port<UnixStream>) -> Result<(), Error> {
        loop {
            let message = port.take()?;
            let observed = if let Message::RenewTool(number) = message {
                self.renew_tool(session, number)
            } else {
                self.obey(session, &command(&message)?, true)?
            };
            let Some(observed) = observed else { return Ok(()) };
            port.send(&Message::Observed(observed))?;
        }
    }

    /// Time does not wait for the control: what comes too late acts a period later.
    fn in_real_time(
        &self,
        session: u64,
        port: &mut Port<UnixStream>,
        pace: &UnixStream,
    ) -> Result<(), Error> {
        let (period, watchdog) = {
            let simulator = lock(&self.simulator);
            (Duration::from_secs_f64(simulator.period().value()), simulator.watchdog)
        };
        let mut last = (bus::Command::default(), None);
        let mut has_spoken = false;
        let mut silent = Duration::ZERO;
        let mut due = clock::now() + period;
        loop {
            let left = due.saturating_duration_since(clock::now());
            pace.set_read_timeout(Some(left.max(Duration::from_micros(1))))?;
            let answer = if let Some(message) = port.take_soon()? {
                if let Message::RenewTool(number) = message {
                    let Some(observed) = self.renew_tool(session, number) else { return Ok(()) };
                    port.send(&Message::Observed(observed))?;
                    continue;
                }
                last = command(&message)?;
                (silent, has_spoken) = (Duration::ZERO, true);
                true
            } else {
                if has_spoken {
                    silent += period; // before that no drive is on
                }
                false
            };
            std::thread::sleep(due.saturating_duration_since(clock::now()));
            // a machine simulator that was late itself has not waited for the control: its time
            // begins anew from here
            due = clock::now().max(due) + period;
            if silent.as_secs_f64() > watchdog.value() {
                return Err(Error::Refused("silent for longer than the drives' watchdog".into()));
            }
            let observed =
                if has_spoken { self.obey(session, &last, answer)? } else { self.wait(session)? };
            let Some(observed) = observed else { return Ok(()) };
            if answer {
                port.send(&Message::Observed(observed))?;
            }
        }
    }

    /// A period in which the control has not said anything yet: it has stated nothing.
    fn wait(&self, session: u64) -> Result<Option<Observed>, Error> {
        let mut simulator = lock(&self.simulator);
        if simulator.session() != session {
            return Ok(None);
        }
        let is_on = simulator.obey(&bus::Command::default()).map_err(Error::Refused)?;
        Ok(is_on.then(|| simulator.observed()))
    }
}

/// A command, as something that may be due.
fn command(message: &Message) -> Result<(bus::Command, Option<EngagedTool>), Error> {
    match message {
        Message::Command(command, engagement) => Ok((*command, *engagement)),
        Message::Hello(_)
        | Message::Welcome(_)
        | Message::Refused(_)
        | Message::Observed(_)
        | Message::Order(_)
        | Message::Told(_)
        | Message::RenewTool(_) => {
            Err(Error::Unexpected { found: "another message", expected: "a command" })
        }
    }
}

/// The other end has closed the connection.
fn is_end(kind: std::io::ErrorKind) -> bool {
    use std::io::ErrorKind::{BrokenPipe, ConnectionReset, UnexpectedEof};
    matches!(kind, UnexpectedEof | ConnectionReset | BrokenPipe)
}
