//! Drives that `leadscrew drives` leads, in another process of this computer.
use super::{Door, Opened, Opening, SeatText, SharedSeat};
use crate::Refused;
use units::Time;

/// See the module's header.
pub(super) const DOOR: Door = Door { name: "process", address: Some("NAME"), open };

const TEXT: SeatText = SeatText {
    name: "leadscrew drives",
    does_not_begin: "its servo thread stands still",
    stands_still: "leadscrew drives has ended, or its servo thread stands still",
};

/// The bridge to the other process is an ordinary thread, which a busy computer holds up.
const SILENT_AFTER: Time = Time::s(0.5);

/// The process of this name.
fn open(opening: &Opening<'_>) -> Result<Opened, Refused> {
    let name = opening.address.and_then(std::path::Path::to_str);
    let name =
        name.ok_or_else(|| Refused::because("expected the name that leadscrew drives has"))?;
    let side = shm::ControlSide::find(name).map_err(|why| Refused::because(why.to_string()))?;
    let machine = &opening.machine.name;
    if !side.may_lead(machine) {
        return Err(Refused::because(format!(
            "leadscrew drives, as {name}, leads another machine than {machine}: start both with the same --machine"
        )));
    }
    let period = opening.machine.control.period;
    let times = match &opening.machine.ethercat {
        Some(network) => (period, network.silent_after, period * network.obeys_after_periods),
        None => (period, SILENT_AFTER, Time::ZERO),
    };
    Ok(Opened { drives: Box::new(SharedSeat::new(side, times, TEXT)), welcome: None })
}
