//! Who controls the machine: one control at a time, and no other one waits in line for it.
//!
//! ```text
//!   control A ══► control: A ─► gone ─► drives run down ─► control: free
//!   control B ──► refused at once: A has the machine          └──► B, if it is still there
//!   order     ──► a thread of its own: answered between two periods of A
//! ```
//!
//! A control that comes while another one has the machine is refused, not queued: what it wanted
//! would be done at a time of which its operator knows nothing. Only the drives' running down after
//! a control that is gone is waited for. A control that is gone by then, or was before it could be
//! heard, gets nothing done.
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::os::unix::net::UnixStream;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use wire::Error;

/// The end of running down is looked for so often, beside being told.
const LOOKS_AGAIN: Duration = Duration::from_millis(100);

/// See the module's header.
#[derive(Debug, Default)]
pub(super) struct ExclusiveControl {
    holder: Mutex<Option<Holder>>,
    freed: Condvar,
}

/// The control that has the machine.
#[derive(Debug)]
struct Holder {
    name: String,
    stream: UnixStream,
}

/// The machine is had by one control, until this is dropped.
#[derive(Debug)]
pub(super) struct HasControl<'a>(&'a ExclusiveControl);

impl Drop for HasControl<'_> {
    fn drop(&mut self) {
        *self.0.lock() = None;
        self.0.freed.notify_all();
    }
}

impl ExclusiveControl {
    fn lock(&self) -> MutexGuard<'_, Option<Holder>> {
        self.holder.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Take it for who speaks by this stream.
    ///
    /// # Errors
    /// Another one has it; or who wanted it is gone.
    pub(super) fn take(&self, name: &str, stream: &UnixStream) -> Result<HasControl<'_>, Error> {
        let own = stream.try_clone()?;
        let mut holder = self.settled();
        if let Some(Holder { name, stream }) = &*holder {
            let process = process(stream).map_or(String::new(), |id| format!(", process {id},"));
            return Err(Error::Refused(format!(
                "{name}{process} has this machine: wait for its end, or end it"
            )));
        }
        if is_gone(stream) {
            return Err(Error::Gone(std::io::ErrorKind::UnexpectedEof.into()));
        }
        *holder = Some(Holder { name: name.to_owned(), stream: own });
        drop(holder);
        Ok(HasControl(self))
    }

    /// Wait until nothing is left of a control that is gone.
    pub(super) fn settle(&self) {
        drop(self.settled());
    }

    fn settled(&self) -> MutexGuard<'_, Option<Holder>> {
        let mut holder = self.lock();
        while holder.as_ref().is_some_and(|holder| is_gone(&holder.stream)) {
            let waited = self.freed.wait_timeout(holder, LOOKS_AGAIN);
            holder = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        holder
    }

    /// Cut the connection of who has it, and wait until nothing is left of it.
    pub(super) fn cut(&self) {
        if let Some(holder) = &*self.lock() {
            // it may be cut already
            let _ = holder.stream.shutdown(std::net::Shutdown::Both);
        }
        self.settle();
    }
}

/// The other end has closed the connection, whatever it has said before.
pub(super) fn is_gone(stream: &UnixStream) -> bool {
    let mut polled = [PollFd::new(stream, PollFlags::IN)];
    let at_once = Timespec { tv_sec: 0, tv_nsec: 0 };
    poll(&mut polled, Some(&at_once)).is_ok_and(|_| polled[0].revents().contains(PollFlags::HUP))
}

/// The process at the other end, where the system tells.
fn process(stream: &UnixStream) -> Option<i32> {
    #[cfg(target_os = "linux")]
    return rustix::net::sockopt::socket_peercred(stream)
        .ok()
        .map(|peer| peer.pid.as_raw_nonzero().get());
    #[cfg(not(target_os = "linux"))]
    {
        let _ = stream;
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_control_is_refused_and_named_the_first() {
        let machine = ExclusiveControl::default();
        let [(ours, theirs), (other, _their)] = [(); 2].map(|()| UnixStream::pair().unwrap());
        let held = machine.take("a control", &ours).unwrap();
        let why = machine.take("another", &other).unwrap_err().to_string();
        assert!(why.starts_with("a control") && why.contains("has this machine"), "{why}");
        drop((held, theirs));
        assert!(machine.take("another", &other).is_ok());
    }

    #[test]
    fn who_is_gone_gets_nothing() {
        let machine = ExclusiveControl::default();
        let (ours, theirs) = UnixStream::pair().unwrap();
        assert!(!is_gone(&ours));
        drop(theirs);
        assert!(is_gone(&ours));
        assert!(matches!(machine.take("a control", &ours), Err(Error::Gone(_))));
        let (there, _their) = UnixStream::pair().unwrap();
        assert!(machine.take("another", &there).is_ok(), "it was kept for a control that is gone");
    }

    #[test]
    fn what_is_left_of_a_control_that_is_gone_is_waited_for() {
        let machine = ExclusiveControl::default();
        let (ours, theirs) = UnixStream::pair().unwrap();
        let (other, _their) = UnixStream::pair().unwrap();
        let held = machine.take("a control", &ours).unwrap();
        drop(theirs); // its drives run down from here …
        std::thread::scope(|scope| {
            let next = std::thread::Builder::new()
                .spawn_scoped(scope, || machine.take("another", &other).map(drop));
            std::thread::sleep(Duration::from_millis(20));
            drop(held); // … to here
            next.unwrap().join().unwrap().unwrap();
        });
    }
}
