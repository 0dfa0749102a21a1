//! Any frames and any mail, at any times, are executed or left alone by emulated EtherCAT devices.
#![no_main]
use esc::{DatagramCommand, DriveModel, EMPTY_FRAME, NetworkSegment, Quirks};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut segment = NetworkSegment::new([
        esc::drive(&DriveModel::new(1)),
        esc::coupler(7),
        esc::encoder(4096, Quirks::default()),
        esc::digital_io(),
    ]);
    let mut now_ns = 0;
    // by its own bytes, and as datagrams to addresses that there are
    let mut whole = bytes.to_vec();
    segment.pass(&mut whole, now_ns);
    for chunk in bytes.chunks(48) {
        let [kind, later, device, register @ ..] = chunk else { break };
        let registers = [0x0120, 0x0502, 0x0600, 0x0800, 0x0810, 0x0910, 0x0981, 0x1000, 0x1080, 0x1100];
        let register_at = match register.first() {
            Some(at) if usize::from(*at) < registers.len() => registers[usize::from(*at)],
            Some(at) => u16::from(*at) << 4,
            None => 0,
        };
        let address = u32::from(register_at) << 16 | u32::from(*device).wrapping_neg() & 0xFFFF;
        let command = DatagramCommand::of(kind % 15).map_or(0, DatagramCommand::code);
        let data = register.get(1..).unwrap_or_default();
        let mut frame = EMPTY_FRAME.to_vec();
        frame.extend([command, 0]);
        frame.extend(address.to_le_bytes());
        // mail is as long as its mailbox
        let length = if register_at == 0x1000 { 0x80 } else { data.len() };
        frame.extend((length as u16).to_le_bytes());
        frame.extend([0, 0]);
        frame.extend(data.iter().chain([0; 0x80].iter()).take(length));
        frame.extend([0, 0]);
        let datagrams = (frame.len() - 16) as u16 | 0x1000;
        frame[14..16].copy_from_slice(&datagrams.to_le_bytes());
        now_ns += u64::from(*later).pow(4);
        segment.pass(&mut frame, now_ns);
    }
});
