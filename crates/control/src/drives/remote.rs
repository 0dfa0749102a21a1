//! A machine simulator in another process, over a socket.
use super::{Door, Drives, Opened, Opening};
use crate::Refused;
use bus::EngagedTool;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;
use wire::{Hello, Remote, Welcome};

/// See the module's header.
pub const DOOR: Door = Door { name: "simulator", address: Some("PATH"), open };

/// Longest wait for an answer of a machine simulator.
const ANSWER: Duration = Duration::from_secs(20);

fn open(opening: &Opening<'_>) -> Result<Opened, Refused> {
    let socket = opening
        .address
        .ok_or_else(|| Refused::because("a machine simulator is named by its socket"))?;
    if !opening.keeps_record {
        return Err(Refused::because(
            "a machine simulator in another process takes a state folder: name one with --state",
        ));
    }
    let hello = Hello { name: "the control".into(), machine: opening.machine.name.clone() };
    let mut remote = Remote::connect(connect(socket)?, hello).map_err(|e| gone(socket, &e))?;
    let welcome = remote.welcome().clone();
    if welcome.real_time && !opening.is_real_time {
        return Err(Refused::because(
            "this machine simulator keeps real time, and so must its control: --real-time",
        ));
    }
    remote.engage(welcome.evidence.in_work);
    Ok(Opened { drives: Box::new(remote), welcome: Some(welcome) })
}

/// Connects to the machine simulator that listens there.
///
/// # Errors
/// Nothing listens there, or what does is no machine.
pub fn connect(path: &Path) -> Result<UnixStream, Refused> {
    let failed = |e| {
        let path = path.display();
        Refused::because(format!(
            "no machine simulator listens at {path}: {e}; start one with: leadscrew simulator --machine NAME --listen {path}"
        ))
    };
    let stream = UnixStream::connect(path).map_err(failed)?;
    stream.set_read_timeout(Some(ANSWER)).map_err(failed)?;
    Ok(stream)
}

/// The refusal of a machine simulator that does not answer as it should.
pub fn gone(path: &Path, error: &wire::Error) -> Refused {
    Refused::because(format!("the machine simulator at {}: {error}", path.display()))
}

/// Machine and encoders, as the sync record knows them again.
pub fn identity(welcome: &Welcome) -> store::sync_record::Identity {
    store::sync_record::Identity {
        machine: welcome.machine.clone(),
        serial: welcome.serial,
        epoch: welcome.epoch,
    }
}

impl Drives for Remote<UnixStream> {
    fn engage(&mut self, tool: Option<EngagedTool>) {
        Self::engage(self, tool);
    }

    fn renew_tool(&mut self, number: u32) {
        Self::renew_tool(self, number);
    }

    fn lost(&self) -> Option<String> {
        Self::lost(self).map(|why| format!("the machine simulator is gone: {why}"))
    }

    fn outlives_control(&self) -> bool {
        true
    }
}
