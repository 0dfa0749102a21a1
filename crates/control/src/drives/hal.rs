//! Drives that a component of LinuxCNC's HAL leads.
use super::{Door, Opened, Opening, SeatText, SharedSeat};
use crate::Refused;

/// See the module's header.
pub const DOOR: Door = Door { name: "hal", address: None, open };

const TEXT: SeatText = SeatText {
    name: "the HAL component",
    does_not_begin: "is its function in a thread that runs (addf leadscrew.update servo-thread, start)?",
    stands_still: "HAL does not call leadscrew.update any more: its threads are stopped, or the component is unloaded",
};

/// The component that the machine's file names.
fn open(opening: &Opening<'_>) -> Result<Opened, Refused> {
    let file = opening.machine;
    let Some(hal) = &file.hal else {
        return Err(Refused::because(format!(
            "the machine {} has no [hal] section: it says how HAL's drives are led, as in machines/hal/mill.toml",
            file.name
        )));
    };
    if !hal.unanswered.is_empty() {
        return Err(Refused::because(format!(
            "what stopped this machine in LinuxCNC has no answer in [hal.safety] of its file: {}",
            hal.unanswered.join("; ")
        )));
    }
    let side =
        shm::ControlSide::find(&hal.component).map_err(|why| Refused::because(why.to_string()))?;
    let period = file.control.period;
    let times = (period, hal.silent_after, period * hal.obeys_after_periods);
    let seat = SharedSeat::new(side, times, TEXT).watching(hal.watched);
    Ok(Opened { drives: Box::new(seat), welcome: None })
}
