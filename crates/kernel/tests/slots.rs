//! Whatever happens to the steps of a program, the kernel can take as many plans afterwards as a
//! new one.
use crate::common::{M6, TapOrder, await_speed, control, line, machine, turn};
use bus::Machine;
use kernel::{CHIP_REMOVALS, Full, Kernel, MOVES, Order, RAMPS, TAPS, WithdrawalPlan};
use motion::{ChipThrow, Profile};
use plan::{SpindleStep, Step, StepKind};
use proptest::prelude::*;
use sim::SimulatedMachine;
use test_support::size;
use units::{Axis, Length, Position, Spin, Time};

const TAP: TapOrder = TapOrder { from_mm: 0.0, surface_mm: -2.0, to_mm: -8.0, ..M6 };

/// What comes again and again, from rest to rest.
fn cycle() -> Vec<StepKind> {
    let (zero, hole) = (Position::default(), Position::xyz(30.0, 20.0, 0.0));
    let tap = || StepKind::Tap(TAP.plan());
    vec![
        line(zero, hole, 100.0, true),
        line(hole, zero, 100.0, true),
        tap(),
        tap(),
        turn(0.0, 600.0),
        await_speed(),
        StepKind::Dwell(Time::s(0.01)),
        turn(600.0, 0.0),
        await_speed(),
        tap(),
    ]
}

fn chip_removal() -> StepKind {
    let (against, back) = (Profile::EMPTY, Profile::EMPTY);
    let (throw, then, axis) = (Spin::rpm(-600.0), Spin::ZERO, Axis::Z);
    let order = ChipThrow { throw, against, then, back, axis, level: Length::ZERO, upwards: true };
    StepKind::Spindle { spindle: 0, order: SpindleStep::Throw(Box::new(order)) }
}

/// An idle kernel takes so many steps of each kind, and then refuses one for that reason.
fn takes_as_much_as_a_new_one(kernel: &Kernel) -> Result<(), TestCaseError> {
    prop_assert!(kernel.is_idle());
    let zero = Position::default();
    let kinds = [
        (line(zero, Position::xyz(30.0, 0.0, 0.0), 100.0, true), MOVES, Full::Moves),
        (StepKind::Tap(TAP.plan()), TAPS, Full::Taps),
        (turn(0.0, 1.0), RAMPS, Full::Ramps),
        (chip_removal(), CHIP_REMOVALS, Full::ChipRemovals),
    ];
    let mut kernel = kernel.clone();
    for (kind, room, reason) in kinds {
        let step = Step { op: 0, line: 1, kind };
        for taken in 0..room {
            prop_assert_eq!(kernel.push(&step), Ok(()), "{} of {}", taken, room);
        }
        prop_assert_eq!(kernel.push(&step), Err(reason));
    }
    Ok(())
}

#[derive(Clone, Copy, Debug)]
enum Event {
    Tick(u16),
    Order(Order),
    HandBack,
    DriveLost,
    Withdraw,
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        12 => (1..1500_u16).prop_map(Event::Tick),
        2 => Just(Event::Order(Order::FeedHold)),
        3 => Just(Event::Order(Order::Resume)),
        1 => Just(Event::Order(Order::Retract)),
        1 => Just(Event::Order(Order::Abort)),
        2 => Just(Event::HandBack),
        1 => Just(Event::DriveLost),
        1 => Just(Event::Withdraw),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(24, 480)))]
    #[test]
    fn no_slot_is_lost_whatever_ends_the_steps(events in proptest::collection::vec(event(), 1..24)) {
        let model = machine(0);
        let mut kernel = Kernel::new(control(&model));
        let mut machine = SimulatedMachine::new(model).expect("the test's machine can be built");
        let steps: Vec<Step> =
            (0..).zip(cycle()).map(|(op, kind)| Step { op, line: op + 1, kind }).collect();
        let mut waiting = steps.iter().cycle().peekable();
        let mut feedback = *machine.feedback();
        let nowhere = WithdrawalPlan { legs: [None; 2] };
        for event in events {
            match event {
                Event::Tick(count) => {
                    for _ in 0..count {
                        while waiting.next_if(|step| kernel.push(step).is_ok()).is_some() {}
                        feedback = *machine.exchange(&kernel.tick(&feedback));
                    }
                }
                Event::Order(order) => kernel.order(order),
                Event::HandBack => {
                    let before = kernel.clone();
                    if let Some(back) = kernel.hand_back() {
                        prop_assert!(back.steps > 0 || before.is_idle() || !kernel.is_idle());
                    }
                }
                Event::DriveLost => {
                    let mut lost = feedback;
                    lost.axes[2].ready = false;
                    feedback = *machine.exchange(&kernel.tick(&lost));
                }
                Event::Withdraw => {
                    kernel.withdraw(nowhere);
                    takes_as_much_as_a_new_one(&kernel)?;
                }
            }
        }
        kernel.withdraw(nowhere);
        takes_as_much_as_a_new_one(&kernel)?;
    }

    /// Without events: the program of a few holes ends, and nothing is in use.
    #[test]
    fn a_program_that_ends_has_released_all_its_slots(holes in 1_usize..8) {
        let model = machine(0);
        let mut kernel = Kernel::new(control(&model));
        let mut machine = SimulatedMachine::new(model).expect("the test's machine can be built");
        let kinds = (0..holes).flat_map(|_| cycle()).collect::<Vec<_>>();
        let steps: Vec<Step> =
            (0..).zip(kinds).map(|(op, kind)| Step { op, line: op + 1, kind }).collect();
        let mut waiting = steps.iter().peekable();
        let mut feedback = *machine.feedback();
        for _ in 0..80_000 {
            while waiting.next_if(|step| kernel.push(step).is_ok()).is_some() {}
            feedback = *machine.exchange(&kernel.tick(&feedback));
            if waiting.peek().is_none() && kernel.is_idle() {
                break;
            }
        }
        prop_assert!(kernel.faults().is_empty(), "{:?}", kernel.faults());
        takes_as_much_as_a_new_one(&kernel)?;
    }
}
