//! Random orders of an operator and of the drives' own faults: what must never be is never sent.
use crate::support::{MOST_STEP, Random, Wire, two_drives, two_drives_expected};
use esc::{DriveState, Quirks};
use ethercat::cia402::{FAULT_RESET, PdsState, Wanted};
use ethercat::{DriveCommand, Master, Storage};

#[test]
fn no_drive_with_a_fault_is_enabled_and_no_target_jumps() {
    let cycles = test_support::size::of(20_000, 2_000_000);
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let mut random = Random(11);
    let mut wanted = [DriveCommand::default(); 2];
    let (mut enabled, mut resets, mut edges) = (0_u64, 0_u64, 0_u64);
    let mut before = [0_u16; 2];
    for cycle in 0..cycles {
        for (axis, wanted) in wanted.iter_mut().enumerate() {
            if random.below(40) == 0 {
                let orders = [Wanted::Off, Wanted::On, Wanted::On, Wanted::On, Wanted::QuickStop];
                wanted.wanted = orders[random.below(5) as usize];
            }
            let sent = bus.drives()[axis].sent_target();
            wanted.target = match random.below(30) {
                0 => random.next() as i32,
                1 => sent.wrapping_add(i32::MAX),
                _ => sent.wrapping_add(random.below(1_000) as i32 - 500),
            };
            bus.command(axis, *wanted);
            if random.below(300) == 0 {
                wire.segment.device_mut(axis + 1).unwrap().fail(0, 0x8400);
            }
            if random.below(200) == 0 {
                bus.reset_fault(axis);
                resets += 1;
            }
        }
        let seen: Vec<_> = bus.drives().iter().map(|drive| *drive.feedback()).collect();
        let targets: Vec<i32> = bus.drives().iter().map(ethercat::DriveAxis::sent_target).collect();
        bus.cycle(&mut wire);
        for axis in 0..2 {
            let (drive, seen) = (&bus.drives()[axis], seen[axis]);
            let control = drive.sent_control();
            let is_faulty =
                matches!(seen.state(), Some(PdsState::Fault | PdsState::FaultReactionActive));
            assert!(!is_faulty || control & 0x0F != 0x0F, "cycle {cycle}: {control:04X}");
            assert!(control & FAULT_RESET == 0 || seen.state() == Some(PdsState::Fault));
            edges += u64::from(control & !before[axis] & FAULT_RESET != 0);
            before[axis] = control;
            if seen.is_enabled() {
                let step = drive.sent_target().wrapping_sub(targets[axis]).unsigned_abs();
                assert!(step <= MOST_STEP, "cycle {cycle}, axis {axis}: {step}");
                enabled += 1;
            } else {
                assert_eq!(drive.sent_target(), seen.position, "cycle {cycle}, axis {axis}");
            }
            let device = wire.segment.device(axis + 1).unwrap();
            let faulty = device.drive_state(0) == Some(DriveState::Fault);
            assert!(
                !faulty || device.dictionary().number(0x603F, 0) != Some(0x8611),
                "it lagged behind"
            );
        }
    }
    assert!(
        enabled > cycles as u64 / 4 && edges > 10 && edges <= resets,
        "{enabled} {edges} {resets}"
    );
}
