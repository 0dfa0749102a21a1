//! Malformed frames: nothing panics, and what was in order works afterwards.
use crate::support::{Bench, frame};
use esc::{AlState, DatagramCommand, DriveModel, Quirks, coupler, digital_io, drive, encoder};
use proptest::prelude::*;

fn all() -> Bench {
    let mut bench = Bench::new([
        drive(&DriveModel::new(1)),
        coupler(5),
        encoder(4096, Quirks::default()),
        digital_io(),
    ]);
    bench.bring_to(AlState::Op);
    bench
}

/// Registers that do something, and any other.
fn registers() -> impl Strategy<Value = u16> {
    prop_oneof![
        Just(0x0010_u16),
        Just(0x0120),
        Just(0x0130),
        Just(0x0420),
        Just(0x0502),
        Just(0x0600),
        Just(0x0610),
        Just(0x0800),
        Just(0x0806),
        Just(0x080E),
        Just(0x0810),
        Just(0x0900),
        Just(0x0910),
        Just(0x0920),
        Just(0x0930),
        Just(0x0981),
        Just(0x0990),
        Just(0x09A0),
        Just(0x1000),
        Just(0x1080),
        Just(0x1100),
        Just(0x1700),
        Just(0x2FFF),
        any::<u16>(),
    ]
}

proptest! {
    #[test]
    fn no_datagrams_make_a_device_panic(
        list in proptest::collection::vec(
            (0_u8..15, prop_oneof![Just(0_u16), 0x1001_u16..0x1005, any::<u16>()], registers(),
             proptest::collection::vec(any::<u8>(), 0..140), 0_u64..3_000_000_000),
            1..20,
        ),
    ) {
        let mut bench = all();
        for (command, device, register, data, later) in list {
            let address = u32::from(register) << 16 | u32::from(device);
            bench.send(DatagramCommand::of(command).unwrap(), address, &data);
            bench.wait_us(later / 1_000);
        }
        bench.segment.power_cycle(bench.now_ns);
        let (_, counter) = bench.send(DatagramCommand::Brd, 0x0130_0000, &[0, 0]);
        prop_assert_eq!(counter, 4);
    }

    #[test]
    fn no_bytes_make_a_segment_panic(mut bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let mut bench = all();
        bench.segment.pass(&mut bytes, bench.now_ns + 1);
    }

    #[test]
    fn no_change_of_an_ordinary_frame_makes_a_segment_panic(
        changes in proptest::collection::vec((14_usize..200, any::<u8>()), 1..8),
        cut in 16_usize..220,
    ) {
        let mut bench = all();
        let mut sent = frame(&[
            (DatagramCommand::Frmw, 0x0910_1001, vec![0; 8]),
            (DatagramCommand::Lrw, 0, vec![0; 60]),
            (DatagramCommand::Fprd, 0x0130_1002, vec![0; 2]),
            (DatagramCommand::Fpwr, 0x1000_1001, vec![0; 64]),
        ]);
        for (at, to) in changes {
            if let Some(byte) = sent.get_mut(at) {
                *byte = to;
            }
        }
        sent.truncate(cut);
        bench.segment.pass(&mut sent, bench.now_ns + 1);
    }
}
