//! That a tap turns back is on the disk before it does, and no disk keeps it in its hole.
use crate::common::*;
use bus::Machine as _;
use kernel::{Kernel, RecordRequest};
use proptest::prelude::*;
use sim::SimulatedMachine;
use test_support::size;
use units::Time;

/// Tap with a disk that takes so long; how long the spindle stood at the bottom, s, and whether the
/// turn was on the disk when it turned back.
fn tap(order: &TapOrder, disk: Time) -> (f64, bool) {
    let model = machine(1);
    let mut kernel = Kernel::new(control(&model));
    kernel.keep_records();
    for kind in tapping(order) {
        kernel.push(&plan::Step { op: 0, line: 1, kind }).unwrap();
    }
    let mut machine = SimulatedMachine::new(model).unwrap();
    let sense = if order.left { -1.0 } else { 1.0 };
    let (mut underway, mut turn, mut on_disk) = (Vec::new(), None, None);
    let (mut deepest, mut stood, mut turned) = (f64::NEG_INFINITY, 0.0, None);
    while !kernel.is_over() {
        let feedback = *machine.feedback();
        assert!(feedback.time < Time::s(20.0), "it never came out");
        let command = kernel.tick(&feedback);
        let now = feedback.time;
        while let Some(request) = kernel.next_record_request() {
            match request {
                RecordRequest::Inward(number, _) => underway.push((number, now + Time::s(0.005))),
                RecordRequest::Outward(number) => {
                    turn = Some(number);
                    underway.push((number, now + disk));
                }
                RecordRequest::Out => {}
            }
        }
        underway.retain(|(number, due)| {
            let done = *due <= now;
            if done {
                kernel.acknowledge(*number);
                on_disk = on_disk.or(turn.filter(|turn| turn == number).map(|_| now));
            }
            !done
        });
        machine.exchange(&command);
        let angle = machine.truth().unwrap().spindles[0].value() * sense;
        if kernel.engaged().is_some() {
            stood += if (angle - deepest).abs() < 1e-4 { PERIOD.value() } else { 0.0 };
            deepest = deepest.max(angle);
            // a hundredth of a turn back is no swing of the loop any more
            turned = turned.or((angle < deepest - 0.01).then_some(now));
        }
    }
    assert!(kernel.faults().is_empty(), "{:?}", kernel.faults());
    (stood, on_disk.is_some_and(|at| turned.is_some_and(|turned| at <= turned)))
}

#[test]
fn a_disk_of_a_usual_machine_costs_a_tap_no_time_at_its_bottom() {
    let (quick, before) = tap(&M6, Time::s(0.001));
    let (usual, also) = tap(&M6, Time::s(0.02));
    assert!(before && also);
    assert!((usual - quick).abs() < 0.002, "{usual} s instead of {quick} s");
}

#[test]
fn a_disk_that_hangs_does_not_keep_a_tap_in_its_hole() {
    let (stood, _) = tap(&M6, Time::s(100.0));
    assert!((0.45..0.7).contains(&stood), "{stood} s");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(12, 240)))]
    #[test]
    fn the_turn_is_on_the_disk_before_any_tap_turns_back(
        rpm in 200.0..6000.0f64, depth in 3.0..25.0f64, left in any::<bool>(), disk in 0.0..0.4f64, dwell in 0.0..0.1f64,
    ) {
        let order = TapOrder { rpm, to_mm: -102.0 - depth, left, dwell_s: dwell, ..M6 };
        prop_assert!(tap(&order, Time::s(disk)).1, "{order:?}");
    }
}
