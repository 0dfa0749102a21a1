//! The two ends of the stream.
use crate::frame::{HEAD, LONGEST, TAIL, decode, encode, head};
use crate::message::{Hello, Message, Observed, Order, Welcome};
use bus::{Command, EngagedTool, Feedback, Truth};
use std::io::{self, Read, Write};
use units::Time;

/// Why a frame, or the connection, is no good.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The stream is.
    #[error("the connection is gone: {}", in_words(.0))]
    Gone(#[from] io::Error),
    /// The frame begins with other bytes.
    #[error("a frame is foreign: it does not begin as one")]
    Foreign,
    /// Another layout.
    #[error("a frame has layout {0}, and this version speaks layout {VERSION}", VERSION = crate::VERSION)]
    Version(u8),
    /// Its length is beyond all bounds.
    #[error("a frame says that it is {0} bytes long: at most {LONGEST} are allowed", LONGEST = crate::LONGEST)]
    TooLong(u16),
    /// Its end is missing, or something follows it.
    #[error("a frame is torn")]
    Torn,
    /// The checksum does not fit.
    #[error("a frame has changed on its way: its checksum does not fit")]
    Checksum,
    /// The checksum fits, the content cannot be.
    #[error("a frame has its checksum right and says what cannot be")]
    Senseless,
    /// Not the next one.
    #[error("frame {found} came, and {expected} was expected")]
    Sequence {
        /// Which came.
        found: u32,
        /// Which should have come.
        expected: u32,
    },
    /// Another message than this one was due.
    #[error("{found} came, and {expected} was expected")]
    Unexpected {
        /// What came.
        found: &'static str,
        /// What was due.
        expected: &'static str,
    },
    /// The other end says no, and why.
    #[error("{0}")]
    Refused(String),
}

/// What the system says, where that is not what people say.
fn in_words(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::UnexpectedEof
        | io::ErrorKind::BrokenPipe
        | io::ErrorKind::ConnectionReset => "the other end has closed it".into(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => {
            "the other end does not answer".into()
        }
        _ => error.to_string(),
    }
}

/// One end: sends frames and takes frames, each in sequence.
#[derive(Debug)]
pub struct Port<S> {
    stream: S,
    sent: u32,
    taken: u32,
    outgoing: Vec<u8>,
    incoming: Incoming,
}

/// Bytes that were read and not taken yet: `bytes[from..to]`.
#[derive(Debug)]
struct Incoming {
    bytes: Box<[u8]>,
    from: usize,
    to: usize,
}

impl Incoming {
    fn new() -> Self {
        Self { bytes: vec![0; 2 * (HEAD + LONGEST + TAIL)].into(), from: 0, to: 0 }
    }

    fn waiting(&self) -> &[u8] {
        &self.bytes[self.from..self.to]
    }

    /// Where to read to: at least as much as a frame has.
    fn free(&mut self) -> &mut [u8] {
        if self.from == self.to {
            (self.from, self.to) = (0, 0);
        } else if self.from > 0 && self.bytes.len() - self.to < HEAD + LONGEST + TAIL {
            self.bytes.copy_within(self.from..self.to, 0);
            (self.from, self.to) = (0, self.to - self.from);
        }
        &mut self.bytes[self.to..]
    }

    /// A frame that has come whole, and its number; `None`: more of it is to come.
    fn frame(&mut self) -> Result<Option<(Message, u32)>, Error> {
        let waiting = self.waiting();
        let Some(first) = waiting.first_chunk::<HEAD>() else { return Ok(None) };
        let (_, follow) = head(first)?;
        let Some(frame) = waiting.get(..HEAD + follow) else { return Ok(None) };
        let decoded = decode(frame)?;
        self.from += HEAD + follow;
        Ok(Some(decoded))
    }
}

impl<S: Read + Write> Port<S> {
    /// On a fresh stream.
    pub fn new(stream: S) -> Self {
        let outgoing = Vec::with_capacity(1024);
        Self { stream, sent: 0, taken: 0, outgoing, incoming: Incoming::new() }
    }

    /// The stream itself.
    pub const fn stream(&self) -> &S {
        &self.stream
    }

    /// Send.
    ///
    /// # Errors
    /// The stream refuses.
    pub fn send(&mut self, message: &Message) -> Result<(), Error> {
        encode(message, self.sent, &mut self.outgoing);
        self.sent = self.sent.wrapping_add(1);
        self.stream.write_all(&self.outgoing)?;
        Ok(self.stream.flush()?)
    }

    /// Wait for the next one.
    ///
    /// # Errors
    /// The stream ends, or what comes is no frame.
    pub fn take(&mut self) -> Result<Message, Error> {
        let (message, sequence) = loop {
            if let Some(decoded) = self.incoming.frame()? {
                break decoded;
            }
            self.read()?;
        };
        if sequence != self.taken {
            return Err(Error::Sequence { found: sequence, expected: self.taken });
        }
        self.taken = self.taken.wrapping_add(1);
        Ok(message)
    }

    /// Wait for the next one, for as long as the stream is willing; `None`: it has not come whole.
    ///
    /// # Errors
    /// As [`Port::take`].
    pub fn take_soon(&mut self) -> Result<Option<Message>, Error> {
        use io::ErrorKind::{TimedOut, WouldBlock};
        match self.take() {
            Err(Error::Gone(e)) if matches!(e.kind(), WouldBlock | TimedOut) => Ok(None),
            other => other.map(Some),
        }
    }

    /// Reads what has come, by one call; at least a byte.
    fn read(&mut self) -> Result<(), Error> {
        loop {
            match self.stream.read(self.incoming.free()) {
                Ok(0) => return Err(Error::Gone(io::ErrorKind::UnexpectedEof.into())),
                Ok(count) => {
                    self.incoming.to += count;
                    return Ok(());
                }
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(Error::Gone(e)),
            }
        }
    }
}

/// The machine simulator, seen from the control.
#[derive(Debug)]
pub struct Remote<S> {
    port: Port<S>,
    welcome: Welcome,
    last: Observed,
    engagement: Option<EngagedTool>,
    lost: Option<Error>,
}

impl<S: Read + Write> Remote<S> {
    /// Greet the machine simulator at the other end.
    ///
    /// # Errors
    /// It does not answer, or refuses.
    pub fn connect(stream: S, hello: Hello) -> Result<Self, Error> {
        let mut port = Port::new(stream);
        port.send(&Message::Hello(hello))?;
        match port.take()? {
            Message::Welcome(welcome) => {
                Ok(Self { port, last: welcome.observed, welcome, engagement: None, lost: None })
            }
            Message::Refused(why) => Err(Error::Refused(why)),
            other => Err(Error::Unexpected { found: other.name(), expected: "a welcome" }),
        }
    }

    /// What the machine simulator said first.
    pub const fn welcome(&self) -> &Welcome {
        &self.welcome
    }

    /// Why the connection ended, once it has.
    pub const fn lost(&self) -> Option<&Error> {
        self.lost.as_ref()
    }

    /// With each command from now on: the tool that is in the work.
    pub const fn engage(&mut self, engagement: Option<EngagedTool>) {
        self.engagement = engagement;
    }

    /// A new tool of this number is in the place of the old one.
    pub fn renew_tool(&mut self, number: u32) {
        if self.lost.is_none() {
            match self.answer_to(&Message::RenewTool(number)) {
                Ok(observed) => self.last = observed,
                Err(why) => self.lost = Some(why),
            }
        }
    }

    fn ask(&mut self, command: &Command) -> Result<Observed, Error> {
        self.answer_to(&Message::Command(*command, self.engagement))
    }

    fn answer_to(&mut self, message: &Message) -> Result<Observed, Error> {
        self.port.send(message)?;
        match self.port.take()? {
            Message::Observed(observed) => Ok(observed),
            Message::Refused(why) => Err(Error::Refused(why)),
            other => Err(Error::Unexpected { found: other.name(), expected: "feedback" }),
        }
    }
}

/// Tell the machine simulator at the other end something, instead of controlling it; its answer.
///
/// # Errors
/// It does not answer, or refuses.
pub fn order(stream: impl Read + Write, order: Order) -> Result<String, Error> {
    let mut port = Port::new(stream);
    port.send(&Message::Order(order))?;
    match port.take()? {
        Message::Told(answer) => Ok(answer),
        Message::Refused(why) => Err(Error::Refused(why)),
        other => Err(Error::Unexpected { found: other.name(), expected: "an answer" }),
    }
}

/// A machine simulator whose connection is gone says that no drive is ready, for ever.
impl<S: Read + Write> bus::Machine for Remote<S> {
    fn period(&self) -> Time {
        self.welcome.period
    }

    fn feedback(&self) -> &Feedback {
        &self.last.feedback
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        if self.lost.is_none() {
            match self.ask(command) {
                Ok(observed) => self.last = observed,
                Err(why) => self.lost = Some(why),
            }
        }
        if self.lost.is_some() {
            let feedback = &mut self.last.feedback;
            feedback.time += self.welcome.period;
            feedback.axes.iter_mut().for_each(|axis| axis.ready = false);
            feedback.spindles.iter_mut().for_each(|spindle| spindle.ready = false);
        }
        &self.last.feedback
    }

    fn truth(&self) -> Option<&Truth> {
        self.last.truth.as_ref()
    }
}

#[cfg(test)]
mod tests;
