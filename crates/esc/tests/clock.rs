//! Distributed clocks: receive times, offsets, SYNC0.
use crate::support::Bench;
use esc::{AlState, DatagramCommand, DriveModel, Quirks, coupler, digital_io, drive};

#[test]
fn receive_times_show_the_way_to_the_end_of_the_wire_and_back() {
    let mut bench =
        Bench::new([coupler(0), drive(&DriveModel::new(1)), drive(&DriveModel::new(2))]);
    let (_, counter) = bench.send(DatagramCommand::Bwr, 0x0900_0000, &[0; 4]);
    assert_eq!(counter, 3);
    let mut loops = Vec::new();
    for device in 0..3 {
        let times = bench.read_of(device, 0x0900, 8).0;
        let time = |at: usize| u32::from_le_bytes(times[at..at + 4].try_into().unwrap());
        loops.push(time(4).saturating_sub(time(0)));
    }
    // a hop takes 600 ns: twice two hops, twice one, and the last device has no second port
    assert_eq!(loops, [2_400, 1_200, 0]);
}

#[test]
fn the_system_time_is_the_local_time_and_an_offset() {
    let mut bench = Bench::new([drive(&DriveModel { drift_ppb: 50_000, ..DriveModel::new(1) })]);
    let local = u64::from_le_bytes(bench.read(0x0910, 8).0.try_into().unwrap());
    bench.write(0x0920, &1_000_000_000_000_u64.to_le_bytes());
    let after = u64::from_le_bytes(bench.read(0x0910, 8).0.try_into().unwrap());
    assert_eq!((after - local) / 1_000, 1_000_000_000 + 20, "an offset, and two frames at 10 us");
}

#[test]
fn devices_without_a_clock_do_not_count() {
    let quirks = Quirks { no_clock: true, ..Quirks::default() };
    let mut bench =
        Bench::new([drive(&DriveModel { quirks, ..DriveModel::new(1) }), coupler(0), digital_io()]);
    assert_eq!(bench.send(DatagramCommand::Bwr, 0x0900_0000, &[0; 4]).1, 1);
    assert_eq!(bench.read(0x0910, 8).1, 0);
    assert_eq!(bench.read(0x0008, 2).0[0] & 4, 0);
}

#[test]
fn a_drive_goes_on_at_each_sync0_and_not_between() {
    let mut bench = Bench::new([drive(&DriveModel::new(1))]);
    bench.bring_to(AlState::PreOp);
    bench.write(0x09A0, &1_000_000_u32.to_le_bytes());
    let start = (bench.now_ns / 1_000_000 + 10) * 1_000_000;
    bench.write(0x0990, &start.to_le_bytes());
    bench.write(0x0981, &[3]);
    bench.process_data();
    assert_eq!(bench.request(4), (4, 0));
    bench.write(0x0120, &[8, 0]);
    while bench.segment.device(0).unwrap().state() != AlState::Op {
        bench.outputs(0, 0);
        bench.wait_us(100);
        assert!(bench.now_ns < start + 5_000_000, "it gets to OP once SYNC0 comes");
    }
    assert!(bench.now_ns >= start, "not before SYNC0 comes");
    let mut last = bench.read(0x1700, 6).0;
    let mut changes = Vec::new();
    for control in [6_u16, 7, 15] {
        let sent = bench.now_ns;
        bench.outputs(control, 0);
        while bench.read(0x1700, 6).0 == last {
            bench.outputs(control, 0);
            assert!(bench.now_ns < sent + 2_100_000);
        }
        last = bench.read(0x1700, 6).0;
        changes.push(bench.now_ns / 1_000_000);
    }
    assert_eq!([changes[1] - changes[0], changes[2] - changes[1]], [1, 1]);
}
