//! Every transition of the application layer on every kind of device, and why one is refused.
use crate::support::Bench;
use esc::{
    AlState, DriveModel, Quirks, TRANSITIONS, Transition, coupler, digital_io, drive, encoder,
};

fn devices() -> Vec<esc::Device> {
    vec![coupler(0), digital_io(), drive(&DriveModel::new(1)), encoder(4096, Quirks::default())]
}

/// Bytes of outputs and inputs, and where they are.
fn process_data(kind: usize, bench: &mut Bench) {
    match kind {
        1 => {
            bench.sync_manager(0, 0x0F00, 1, 0x44);
            bench.sync_manager(1, 0x1000, 1, 0x00);
        }
        2 => bench.process_data(),
        3 => {
            bench.sync_manager(2, 0x1100, 6, 0x64);
            bench.sync_manager(3, 0x1700, 10, 0x20);
        }
        _ => {}
    }
}

fn send_outputs(kind: usize, bench: &mut Bench) {
    match kind {
        1 => drop(bench.write(0x0F00, &[0])),
        2 | 3 => drop(bench.write(0x1100, &[0; 6])),
        _ => {}
    }
}

/// Brings the first device to a state by the way of the standard.
fn bring_to(kind: usize, state: AlState, bench: &mut Bench) {
    let way: &[u8] = match state {
        AlState::Init => &[],
        AlState::PreOp => &[2],
        AlState::SafeOp => &[2, 4],
        AlState::Op => &[2, 4, 8],
        AlState::Boot => unreachable!("no emulated device has it"),
    };
    for step in way {
        send_outputs(kind, bench);
        assert_eq!(bench.request(*step), (*step, 0), "device {kind}");
    }
}

#[test]
fn every_transition_of_every_device_is_that_of_the_table() {
    for kind in 0..devices().len() {
        for (row, from) in AlState::ALL.into_iter().enumerate() {
            if from == AlState::Boot {
                continue;
            }
            for (column, to) in AlState::ALL.into_iter().enumerate() {
                let mut bench = Bench::new([devices().remove(kind)]);
                if kind >= 2 {
                    bench.mailboxes();
                }
                process_data(kind, &mut bench);
                bring_to(kind, from, &mut bench);
                send_outputs(kind, &mut bench);
                let expected = match TRANSITIONS[row][column] {
                    Transition::Refuse => (from as u8 | 0x10, 0x0011),
                    Transition::StartBootstrap => (from as u8 | 0x10, 0x0013),
                    _ => (to as u8, 0),
                };
                let found = bench.request(to as u8);
                assert_eq!(found, expected, "device {kind}, from {from:?} to {to:?}");
            }
        }
    }
}

#[test]
fn requests_of_states_that_there_are_not_are_refused() {
    for code in [0, 5, 6, 7, 9, 15] {
        let mut bench = Bench::new(devices().drain(2..3));
        assert_eq!(bench.request(code), (0x11, 0x0012), "state {code}");
    }
}

#[test]
fn an_error_is_kept_until_it_is_acknowledged() {
    let mut bench = Bench::new(devices().drain(2..3));
    bench.mailboxes();
    assert_eq!(bench.request(8), (0x11, 0x0011));
    assert_eq!(bench.request(2), (0x11, 0x0011), "without acknowledgement");
    assert_eq!(bench.request(0x12), (2, 0), "with it");
}

#[test]
fn a_mailbox_that_is_not_as_the_device_needs_it_keeps_it_in_init() {
    for (start, length, control) in [
        (0x1000, 0x80, 0x22),
        (0x1000, 0x80, 0x24),
        (0x1002, 0x80, 0x26),
        (0x1000, 0x81, 0x26),
        (0x1000, 8, 0x26),
    ] {
        let mut bench = Bench::new(devices().drain(2..3));
        bench.mailboxes();
        bench.sync_manager(0, start, length, control);
        assert_eq!(bench.request(2), (0x11, 0x0016), "{start:04X} {length} {control:02X}");
    }
}

#[test]
fn process_data_of_another_length_keep_a_drive_in_pre_op() {
    for (out, into, code) in
        [(5, 6, 0x001D), (7, 6, 0x001D), (0, 6, 0x001D), (6, 5, 0x001E), (6, 0, 0x001E)]
    {
        let mut bench = Bench::new(devices().drain(2..3));
        bench.bring_to(AlState::PreOp);
        bench.sync_manager(2, 0x1100, out, 0x64);
        bench.sync_manager(3, 0x1700, into, 0x20);
        assert_eq!(bench.request(4), (0x12, code), "{out} bytes out, {into} in");
    }
}

#[test]
fn without_outputs_a_drive_waits_in_safe_op_and_gives_up_after_five_seconds() {
    let mut bench = Bench::new(devices().drain(2..3));
    bench.bring_to(AlState::SafeOp);
    assert_eq!(bench.request(8), (4, 0));
    bench.wait_us(5_100_000);
    let status = bench.read(0x0130, 6).0;
    assert_eq!((status[0], status[4]), (0x14, 0x19));
}

#[test]
fn outputs_that_stay_away_for_longer_than_the_watchdog_end_op() {
    let mut bench = Bench::new(devices().drain(2..3));
    bench.bring_to(AlState::Op);
    bench.outputs(0, 0);
    bench.wait_us(99_000);
    assert_eq!(bench.read(0x0130, 1).0, [8]);
    bench.wait_us(2_000);
    let status = bench.read(0x0130, 6).0;
    assert_eq!((status[0], status[4]), (0x14, 0x1B));
    assert_eq!((bench.read(0x0440, 1).0, bench.read(0x0442, 1).0), (vec![0], vec![1]));
    bench.outputs(0, 0);
    assert_eq!(bench.read(0x0440, 1).0, [1]);
    // the way back: acknowledge, then outputs, then OP
    assert_eq!(bench.request(0x14), (4, 0));
    bench.outputs(0, 0);
    assert_eq!(bench.request(8), (8, 0));
}

#[test]
fn a_watchdog_that_is_turned_off_ends_nothing() {
    let mut bench = Bench::new(devices().drain(2..3));
    bench.write(0x0420, &[0, 0]);
    bench.bring_to(AlState::Op);
    bench.wait_us(10_000_000);
    assert_eq!(bench.read(0x0130, 1).0, [8]);
}

#[test]
fn a_synchronisation_that_never_begins_keeps_a_drive_from_op() {
    let mut bench = Bench::new(devices().drain(2..3));
    bench.bring_to(AlState::PreOp);
    bench.write(0x09A0, &1_000_000_u32.to_le_bytes());
    // a start that has passed
    bench.write(0x0990, &1_u64.to_le_bytes());
    assert_eq!(bench.write(0x0981, &[3]), 1);
    bench.process_data();
    assert_eq!(bench.request(4), (4, 0));
    bench.outputs(0, 0);
    assert_eq!(bench.request(8), (0x14, 0x002D));
}
