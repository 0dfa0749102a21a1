//! Why a network could not be started: which device, what was found, what would work.
use crate::network::DeviceIdentity;

/// A start that was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the sentences say it
pub enum StartError {
    #[error(
        "the cycle is {cycle_ns} ns, and the lead {lead_ns} ns: 62,500 to 10,000,000 ns and less than the cycle work"
    )]
    Times { cycle_ns: u32, lead_ns: u32 },
    #[error("no device answers: check cable and power")]
    NoAnswer,
    #[error(
        "no device answers, but {echoes} frames came back with an unchanged source address: the first \
         device has to set its bit 02, or the network card hears itself"
    )]
    Echoes { echoes: u64 },
    #[error("{found} devices are on the wire, {wanted} are expected")]
    Count { found: usize, wanted: usize },
    #[error(
        "device {position}, {name}: vendor {:08X}, product {:08X} is there; {:08X}, {:08X} is expected",
        found.vendor, found.product, wanted.vendor, wanted.product
    )]
    Identity { position: usize, name: String, found: DeviceIdentity, wanted: DeviceIdentity },
    #[error("{name}: it has no distributed clock; SYNC0 needs one")]
    NoClock { name: String },
    #[error("no device has a distributed clock: one has to be the reference")]
    NoReference,
    #[error("{name}: {object:04X}:{sub:02X} is refused with abort {abort:08X}")]
    Sdo { name: String, object: u16, sub: u8, abort: u32 },
    #[error(
        "{name}: {object:04X}:{sub:02X} cannot be mapped into {pdo:04X} (abort {abort:08X}): leave it out"
    )]
    Mapping { name: String, pdo: u16, object: u16, sub: u8, abort: u32 },
    #[error("{name}: {pdo:04X} is read back as {found} entries, {wanted} were written")]
    ReadBack { name: String, pdo: u16, found: usize, wanted: usize },
    #[error(
        "{name}: {object:04X} is in none of its PDOs, which cannot be changed or were left as they are"
    )]
    Missing { name: String, object: u16 },
    #[error("{name}: mode {mode} is not among those of 6502, {supported:08X}")]
    Mode { name: String, mode: &'static str, supported: u32 },
    #[error("{name}: it stays in {state} and gives AL status code {code:04X}, {text}")]
    Refused { name: String, state: &'static str, code: u16, text: String },
    #[error("{name}: emergency {code:04X}, register {register:02X}")]
    Emergency { name: String, code: u16, register: u8 },
    #[error("the process image has {bytes} bytes; {most} fit into one frame")]
    Image { bytes: usize, most: usize },
    #[error("{name} did not get from SAFE-OP to OP within {after_ms} ms")]
    NoOp { name: String, after_ms: u64 },
    #[error("the EtherCAT library gave up: {0}")]
    Library(String),
}
