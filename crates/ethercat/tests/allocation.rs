//! Cycles take no memory, and two runs of them are bit-identical.
#![allow(clippy::unwrap_used)] // tests may panic
#[path = "support/mod.rs"]
#[allow(clippy::unwrap_used, dead_code)] // tests may panic, and what they share is not used by each
mod support;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use esc::Quirks;
use ethercat::cia402::Wanted;
use ethercat::{
    Ahead, AxisInputs, CountScale, DriveCommand, DriveMode, LedDrive, MachineDrives, Master, Reply,
    Storage, Terminal,
};
use support::{Wire, six_drives, six_drives_expected};
use units::{Coordinate, Time};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// Runs cycles in which all drives follow a target; returns a hash of what they did in the first
/// `hashed` of them.
fn run(cycles: i32, hashed: i32) -> u64 {
    let mut wire = Wire::new(six_drives(&Quirks::default()));
    let network = six_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    assert_no_alloc(|| {
        for cycle in 0..cycles {
            for (axis, factor) in (1..=6).enumerate() {
                let target = (cycle % 4_000 - 2_000).abs() * 50 * factor;
                let from = bus.drives()[axis].sent_target();
                let target = from + (target - from).clamp(-5_000, 5_000);
                bus.command(axis, DriveCommand { wanted: Wanted::On, target });
            }
            let outcome = bus.cycle(&mut wire);
            let Reply::Complete { reference_ns, phase_ns } = outcome.reply else {
                panic!("cycle {cycle}: {outcome:?}")
            };
            let feedback = bus.drives().iter().map(|drive| drive.feedback().position as u64);
            if cycle >= hashed {
                continue;
            }
            for word in feedback.chain([reference_ns, phase_ns.unsigned_abs()]) {
                hash = (hash ^ word).wrapping_mul(0x100_0000_01B3);
            }
        }
    });
    assert!(bus.drives().iter().all(|drive| drive.feedback().is_enabled()));
    assert_eq!(bus.counters().complete, cycles as u64);
    hash
}

#[test]
fn a_machine_is_read_and_written_without_memory() {
    let mut wire = Wire::new(six_drives(&Quirks::default()));
    let network = six_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let scale =
        CountScale { counts_per_rev: 131_072, gear: (1, 1), is_reversed: false, per_rev: 10.0 };
    let axes: Vec<LedDrive> = (0..6)
        .map(|index| LedDrive {
            index,
            drive: index,
            mode: DriveMode::Csp,
            scale,
            inputs: AxisInputs::default(),
            torque_rated: Some(units::Torque::n_m(1.27)),
        })
        .collect();
    let terminal = Terminal::Digital { device: 7, inputs_from: Some(0), outputs_from: Some(0) };
    let mut drives = MachineDrives::new(&axes, &[], &[terminal]);
    let ahead = Ahead { axes: [Time::s(3e-3); 9], spindles: [Time::ZERO; 2] };
    let mut command = bus::Command::default();
    assert_no_alloc(|| {
        for number in 0..2_000 {
            let cycle = bus.cycle(&mut wire);
            let said = drives.read(&bus, &cycle);
            for (told, said) in command.axes.iter_mut().zip(&said.axes).take(6) {
                told.enable = number > 10;
                let goes = if said.ready { 0.01 } else { 0.0 };
                told.position = said.position + Coordinate::new(goes);
            }
            drives.write(&mut bus, &command, &ahead);
        }
    });
    assert!(bus.drives().iter().all(|drive| drive.feedback().is_enabled()));
}

#[test]
fn a_hundred_thousand_cycles_take_no_memory_and_the_same_ones_are_the_same_twice() {
    let again = test_support::size::of(20_000, 100_000);
    assert_eq!(run(100_000, again), run(again, again));
}
