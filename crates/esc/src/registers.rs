//! Addresses of an EtherCAT slave controller, and which of them the wire may write.

/// Type of the controller; 1 byte.
pub(crate) const TYPE: u16 = 0x0000;
/// FMMUs that there are; 1 byte.
pub(crate) const FMMUS: u16 = 0x0004;
/// Sync managers that there are; 1 byte.
pub(crate) const SYNC_MANAGERS: u16 = 0x0005;
/// Process memory, KiB; 1 byte.
pub(crate) const RAM_SIZE: u16 = 0x0006;
/// What is at the four ports, two bits each.
pub(crate) const PORTS: u16 = 0x0007;
/// Features: bit 2 distributed clock, bit 3 in 64 bits, bit 8 enhanced activation of SYNC.
pub(crate) const FEATURES: u16 = 0x0008;
/// Configured station address.
pub(crate) const STATION: u16 = 0x0010;
/// Configured station alias.
pub(crate) const ALIAS: u16 = 0x0012;
/// DL control; bit 24 turns the alias on.
pub(crate) const DL_CONTROL: u16 = 0x0100;
/// DL status.
pub(crate) const DL_STATUS: u16 = 0x0110;
/// AL control.
pub(crate) const AL_CONTROL: u16 = 0x0120;
/// AL status.
pub(crate) const AL_STATUS: u16 = 0x0130;
/// AL status code.
pub(crate) const AL_CODE: u16 = 0x0134;
/// Events of which a master wants to know.
pub(crate) const EVENT_MASK: u16 = 0x0200;
/// Events for the master.
pub(crate) const EVENTS: u16 = 0x0210;
/// Divider of the watchdogs: a tick has (n + 2) · 40 ns.
pub(crate) const WATCHDOG_DIVIDER: u16 = 0x0400;
/// Ticks of the process data watchdog.
pub(crate) const WATCHDOG_TIME: u16 = 0x0420;
/// Bit 0: the process data watchdog has not expired.
pub(crate) const WATCHDOG_STATUS: u16 = 0x0440;
/// How often the process data watchdog expired.
pub(crate) const WATCHDOG_COUNT: u16 = 0x0442;
/// Who has the EEPROM.
pub(crate) const EEPROM_OWNER: u16 = 0x0500;
/// EEPROM control and status.
pub(crate) const EEPROM_CONTROL: u16 = 0x0502;
/// EEPROM word address.
pub(crate) const EEPROM_ADDRESS: u16 = 0x0504;
/// EEPROM data, 8 bytes.
pub(crate) const EEPROM_DATA: u16 = 0x0508;
/// First FMMU, 16 bytes each.
pub(crate) const FMMU: u16 = 0x0600;
/// First sync manager, 8 bytes each.
pub(crate) const SYNC_MANAGER: u16 = 0x0800;
/// Receive times of the four ports; a write latches them.
pub(crate) const RECEIVE_TIMES: u16 = 0x0900;
/// System time; a write compares.
pub(crate) const SYSTEM_TIME: u16 = 0x0910;
/// Local time at which the frame that latched came in.
pub(crate) const RECEIVE_TIME: u16 = 0x0918;
/// Offset of the system time from the local time.
pub(crate) const TIME_OFFSET: u16 = 0x0920;
/// Delay from the reference clock.
pub(crate) const TIME_DELAY: u16 = 0x0928;
/// Mean difference from the reference clock; bit 31: the local time is ahead.
pub(crate) const TIME_DIFFERENCE: u16 = 0x092C;
/// Start of the speed counter; a write resets the control loop.
pub(crate) const SPEED_COUNTER: u16 = 0x0930;
/// Which side controls the cyclic unit.
pub(crate) const CYCLIC_UNIT: u16 = 0x0980;
/// Activation of SYNC0 and SYNC1.
pub(crate) const SYNC_ACTIVATION: u16 = 0x0981;
/// First SYNC0, system time.
pub(crate) const SYNC_START: u16 = 0x0990;
/// Period of SYNC0, ns.
pub(crate) const SYNC0_PERIOD: u16 = 0x09A0;

/// FMMUs and sync managers of the emulated controllers.
pub(crate) const CHANNELS: usize = 8;
/// Bytes of registers, after which process memory begins.
pub(crate) const REGISTER_BYTES: u16 = 0x1000;
/// First and last address of the distributed clock.
const CLOCK: (u16, u16) = (0x0900, 0x09FF);
/// First and last address that the wire may write, of registers.
const WRITABLE: [(u16, u16); 24] = [
    (0x0010, 0x0011),
    (0x0100, 0x0103),
    (0x0108, 0x0109),
    (0x0120, 0x0121),
    (0x0200, 0x0201),
    (0x0300, 0x030D),
    (0x0400, 0x0401),
    (0x0410, 0x0411),
    (0x0420, 0x0421),
    (0x0442, 0x0443),
    (0x0500, 0x0500),
    (0x0502, 0x050F),
    (0x0600, 0x067F),
    (0x0800, 0x083F),
    (0x0900, 0x0903),
    (0x0910, 0x0917),
    (0x0920, 0x092B),
    (0x0930, 0x0935),
    (0x0980, 0x0981),
    (0x0990, 0x0997),
    (0x09A0, 0x09A9),
    (0x0F00, 0x0F0F),
    (0x0F10, 0x0F17),
    (0x0F80, 0x0FFF),
];

/// Returns whether the wire may write a register.
pub(crate) fn is_writable(address: u16) -> bool {
    WRITABLE.iter().any(|(first, last)| (*first..=*last).contains(&address))
}

/// Returns whether an address is one of the distributed clock.
pub(crate) fn is_clock(address: u16) -> bool {
    (CLOCK.0..=CLOCK.1).contains(&address)
}
