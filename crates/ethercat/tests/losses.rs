//! Frames that are lost, late, repeated or foreign: counted and skipped, and nothing jumps.
use crate::support::{Fate, MOST_STEP, Random, Wire, enable, two_drives, two_drives_expected};
use esc::{EMPTY_FRAME, Quirks};
use ethercat::cia402::Wanted;
use ethercat::{DriveCommand, Master, Reply, Storage};
use std::cell::Cell;
use std::rc::Rc;

type Switch = Rc<Cell<bool>>;

/// A wire on which one frame in so many has a random fate, once a switch is on.
fn bad_wire(one_in: u64, seed: u64) -> (Wire<impl FnMut(u64) -> Fate>, Switch) {
    let is_on: Switch = Rc::default();
    let switch = is_on.clone();
    let mut random = Random(seed);
    let fate = move |_| {
        if !switch.get() || random.below(one_in) != 0 {
            return Fate::Comes;
        }
        match random.below(3) {
            0 => Fate::IsLost,
            1 => Fate::ComesLate(300_000 + random.below(30_000_000)),
            _ => Fate::ComesTwice,
        }
    };
    (Wire::with_fate(two_drives(&Quirks::default()), fate), is_on)
}

#[test]
fn lost_late_and_repeated_frames_are_counted_and_targets_do_not_jump() {
    let cycles = test_support::size::of(5_000, 500_000);
    let (mut wire, is_bad) = bad_wire(8, 7);
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    enable(&mut bus, &mut wire);
    is_bad.set(true);
    let enabled_after = bus.counters().complete;
    let (mut target, mut lost_in_a_row) = (0_i32, 0);
    let mut before: Vec<i32> = bus.drives().iter().map(|d| d.feedback().position).collect();
    for cycle in 0..cycles {
        target += if (cycle / 1_000) % 2 == 0 { 400 } else { -400 };
        for axis in 0..2 {
            bus.command(axis, DriveCommand { wanted: Wanted::On, target });
        }
        let outcome = bus.cycle(&mut wire);
        lost_in_a_row = lost_in_a_row.max(outcome.missed_in_a_row);
        for (axis, before) in before.iter_mut().enumerate() {
            let position = bus.drives()[axis].feedback().position;
            let most = 400 * (lost_in_a_row + 2);
            assert!(
                position.abs_diff(*before) <= most.min(MOST_STEP),
                "cycle {cycle}, axis {axis}"
            );
            *before = position;
        }
    }
    let counters = bus.counters();
    let all = counters.complete + counters.short + counters.lost + counters.no_reference;
    assert_eq!(all - enabled_after, cycles as u64);
    assert!(counters.lost > cycles as u64 / 20, "{counters:?}");
    assert!(counters.losses.unexpected > cycles as u64 / 20, "{counters:?}");
    assert_eq!((counters.short, counters.losses.malformed), (0, 0), "{counters:?}");
    assert!(bus.drives().iter().all(|drive| drive.feedback().is_enabled()));
}

/// A checksum keeps such frames off on a wire; without it they do not end the master either.
#[test]
fn changed_answers_never_panic_and_cycles_go_on() {
    let cycles = test_support::size::of(8_000, 1_000_000);
    let is_on: Switch = Rc::default();
    let (switch, mut random) = (is_on.clone(), Random(1));
    let fate = move |_| {
        let is_changed = switch.get() && random.below(3) > 0;
        if is_changed { Fate::IsChanged(1 + random.below(8)) } else { Fate::Comes }
    };
    let mut wire = Wire::with_fate(two_drives(&Quirks::default()), fate);
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    is_on.set(true);
    for _ in 0..cycles {
        bus.cycle(&mut wire);
        bus.poll_mail(&mut wire);
    }
    let counters = bus.counters();
    assert!(counters.complete > 0 && counters.lost + counters.short + counters.no_reference > 0);
    is_on.set(false);
    // no time that was read wrongly is believed for ever
    for _ in 0..20 {
        bus.cycle(&mut wire);
    }
    for _ in 0..20 {
        assert!(matches!(bus.cycle(&mut wire).reply, Reply::Complete { .. }));
    }
}

#[test]
fn a_start_with_changed_answers_ends_and_the_next_one_succeeds() {
    for seed in 0..test_support::size::of(20, 4_000) {
        let is_on: Switch = Rc::default();
        let (switch, mut random) = (is_on.clone(), Random(seed));
        let fate = move |_| {
            let is_changed = switch.get() && random.below(200) == 0;
            if is_changed { Fate::IsChanged(1 + random.below(8)) } else { Fate::Comes }
        };
        let mut wire = Wire::with_fate(two_drives(&Quirks::default()), fate);
        let network = two_drives_expected();
        let storage = Storage::new();
        let mut master = Master::new(&storage, &network).unwrap();
        is_on.set(true);
        let first = master.start(&mut wire).map(|_| ());
        is_on.set(false);
        // an EEPROM or a mapping may have been left as it was read wrongly
        wire.segment.power_cycle(wire.now_ns);
        let again = master.start(&mut wire).map(|_| ());
        assert_eq!(again, Ok(()), "seed {seed}, after {first:?}");
    }
}

#[test]
fn frames_of_others_are_counted_and_skipped() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let mut random = Random(3);
    for cycle in 0..1_000_u64 {
        let mut frame = EMPTY_FRAME.to_vec();
        match cycle % 4 {
            // the master's own frame, heard before a device had it
            0 => {}
            // of another protocol
            1 => frame[12..14].copy_from_slice(&[0x08, 0x00]),
            // of another master
            2 => {
                frame[6] = 0x12;
                frame.extend([7, random.below(256) as u8, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0]);
                frame[14] = 13;
            }
            // of bytes that came from anywhere
            _ => {
                frame[6] = 0x12;
                frame.extend((0..random.below(60)).map(|_| random.next() as u8));
                frame[14] = random.next() as u8;
            }
        }
        wire.inject(&frame);
        let outcome = bus.cycle(&mut wire);
        assert!(matches!(outcome.reply, Reply::Complete { .. }), "cycle {cycle}: {outcome:?}");
    }
    let losses = bus.counters().losses;
    assert_eq!((losses.echoes, losses.foreign), (250, 250), "{losses:?}");
    assert_eq!(losses.unexpected + losses.malformed, 500, "{losses:?}");
}

#[test]
fn a_start_on_a_bad_wire_succeeds_or_says_why_and_never_hangs() {
    let starts = test_support::size::of(20, 2_000);
    let mut started = 0;
    for seed in 0..starts {
        let (mut wire, is_bad) = bad_wire(400, seed);
        is_bad.set(true);
        let network = two_drives_expected();
        let storage = Storage::new();
        let mut master = Master::new(&storage, &network).unwrap();
        let result = master.start(&mut wire).map(|_| ());
        assert!(wire.now_ns < 70_000_000_000, "seed {seed}: {} ns", wire.now_ns);
        started += u64::from(result.is_ok());
        is_bad.set(false);
        let again = master.start(&mut wire).map(|_| ());
        assert_eq!(again, Ok(()), "seed {seed}, after {result:?}");
    }
    assert!(started > 0, "no start of {starts}");
}

#[test]
fn without_the_reference_clock_nothing_is_taken_for_its_time() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    wire.segment.power(0, false, wire.now_ns);
    for missed in 1..50 {
        let outcome = bus.cycle(&mut wire);
        assert_eq!((outcome.reply, outcome.missed_in_a_row), (Reply::Lost, missed));
    }
    // it comes back with another time, in INIT and without an address
    wire.segment.power(0, true, wire.now_ns);
    for _ in 0..50 {
        let outcome = bus.cycle(&mut wire);
        assert_eq!(outcome.reply, Reply::NoReference, "{outcome:?}");
    }
}

#[test]
fn a_device_that_is_gone_makes_frames_short() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let expected = bus.expected_counter();
    let position = bus.drives()[1].feedback().position;
    wire.segment.power(2, false, wire.now_ns);
    let outcome = bus.cycle(&mut wire);
    assert_eq!(outcome.reply, Reply::Short { counter: expected - 6, expected });
    assert_eq!(bus.drives()[1].feedback().position, position);
}
