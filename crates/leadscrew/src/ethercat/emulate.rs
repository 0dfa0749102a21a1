//! `leadscrew simulator --ethercat`: the emulated machine on a network interface, in real time.
use super::{EmulatedMachine, NetworkInterface};
use control::drives::simulated;
use control::job::{ProgramOptions, Session};
use control::{Refused, config, run_by_deadline};
use esc::{Passed, has_ethercat_type};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Longest Ethernet frame without its checksum.
const MOST_FRAME: usize = 1514;
/// Byte of the source address, and its bit, by which a frame that has passed devices is known.
const SOURCE: (usize, u8) = (6, 0x02);

/// What is emulated, and where.
#[derive(Clone, Debug)]
pub struct EmulatedDrivesOptions {
    /// Machine and tools.
    pub source: ProgramOptions,
    /// Seed of what the control does not know; that of the machine's file if `None`.
    pub seed: Option<u64>,
    /// Network interface.
    pub interface: String,
    /// Priority of the thread among those that are run by deadline (`SCHED_FIFO`), 1 to 99.
    pub priority: u8,
}

/// Answers frames on a network interface until `stop` is set; `begins` is told the machine's name
/// and what the operating system has refused of what real time needs.
///
/// # Errors
/// The machine has no network, or the interface cannot be opened.
pub fn emulate_drives(
    options: &EmulatedDrivesOptions,
    stop: &AtomicBool,
    begins: impl FnOnce(&str, &[String]),
) -> Result<(), Refused> {
    let session = Session::load(&options.source, Path::new("-"), b"")?;
    let file = &session.machine;
    let seed = options.seed.unwrap_or(u64::from(file.simulation.seed));
    let (material, zero) = (file.setup.stock.material, session.work_zero());
    let simulated = config::simulator(file, &session.tools, material, seed, &zero);
    let machine = simulated::build_on_network(file, simulated::switched_on(simulated))?;
    let mut emulated = EmulatedMachine::new(file, machine)?;
    let interface = NetworkInterface::open(&options.interface)?;
    let refused: Vec<String> = run_by_deadline(options.priority);
    begins(&file.name, &refused);
    let period_ns = (file.control.period.value() * 1e9).round() as u64;
    let mut buffer = [0; MOST_FRAME];
    while !stop.load(Ordering::Acquire) {
        while let Some(length) = interface.receive_frame(&mut buffer) {
            let frame = &mut buffer[..length.min(MOST_FRAME)];
            let (at, bit) = SOURCE;
            if !has_ethercat_type(frame) || frame[at] & bit != 0 {
                continue;
            }
            if let Passed::Back(_) = emulated.pass(frame, interface.time_ns()) {
                // a frame that the interface does not take is lost, as on a wire
                interface.send_frame(frame);
            }
        }
        let now_ns = interface.time_ns();
        emulated.advance(now_ns);
        interface.wait_until(now_ns + period_ns / 4);
    }
    Ok(())
}
