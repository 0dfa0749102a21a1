//! A queue is the list of the steps that were taken and not removed, whatever is done to it.

use super::*;
use proptest::prelude::*;
use std::vec::Vec;
use units::{Axis, Length, Spin, Time};

/// One plan of each type, each with a number of its own.
struct Plans {
    moves: Move,
    follow: Follow,
    tap: TapPlan,
    ramp: Profile,
    chips: ChipThrow,
}

impl Plans {
    fn numbered(n: u32) -> Self {
        let (here, number) = (units::Position::default(), f64::from(n));
        let mut ramp = Profile::EMPTY;
        assert!(ramp.push(motion::Phase { duration: 1.0 + number, ..Default::default() }));
        let path = motion::Path::Line { from: here, to: units::Position::xyz(number, 0.0, 0.0) };
        let piece = motion::Piece {
            curve: path.curve(),
            begin: 0.0,
            length: number,
            feed: 1.0,
            rapid: false,
            entry: motion::Entry::Rest,
            op: n,
            line: n,
        };
        Self {
            moves: Move {
                path,
                profile: ramp,
                rapid: false,
                per_revolution: false,
                exact_stop: true,
                floats: false,
                programmed: None,
            },
            follow: Follow {
                piece,
                phases: Default::default(),
                count: 1,
                per_revolution: false,
                exact_stop: false,
                pace: motion::Pace { share: 1.0, turning: 1.0 },
            },
            tap: TapPlan {
                axis: Axis::Z,
                spindle: 0,
                start: here,
                bottom: Length::mm(-number),
                deepest: Length::mm(-number),
                end: Length::ZERO,
                surface: Length::ZERO,
                lead: units::Lead::mm_per_rev(-1.0),
                spin: Spin::rpm(600.0),
                return_spin: Spin::rpm(-600.0),
                inward: ramp,
                dwell: Time::ZERO,
                outward: ramp,
                start_angle: None,
                turns_at_speed: false,
                limiting: motion::TapLimiting::default(),
                torque_expected: units::Torque::n_m(1.75),
                torque_limit: Some(units::Torque::n_m(6.5)),
            },
            ramp,
            chips: ChipThrow {
                throw: Spin::rpm(-number),
                against: ramp,
                then: Spin::ZERO,
                back: ramp,
                axis: Axis::Z,
                level: Length::ZERO,
                upwards: true,
            },
        }
    }

    /// The step of a kind that is drawn.
    fn step(&self, kind: u8, op: u32) -> Step<'_> {
        let spindle = |order| StepKind::Spindle { spindle: 0, order };
        let kind = match kind {
            0 => StepKind::Move(&self.moves),
            1 => StepKind::Follow(&self.follow),
            2 => StepKind::Tap(&self.tap),
            3 => spindle(SpindleStep::Turn { spin: Spin::ZERO, ramp: &self.ramp }),
            4 => spindle(SpindleStep::Throw(&self.chips)),
            _ => StepKind::Dwell(Time::s(f64::from(op))),
        };
        Step { op, line: op + 1, kind }
    }
}

/// A step by what [`Plans::step`] takes.
type Drawn = (u8, u32);

/// How many plans of each type steps have.
fn count(steps: &[Drawn]) -> [usize; 5] {
    core::array::from_fn(|of| steps.iter().filter(|(kind, _)| usize::from(*kind) == of).count())
}

fn in_use(queue: &Queue) -> [usize; 5] {
    let Tables { moves, stretches, taps, ramps, chip_removals } = &queue.tables;
    [moves.in_use(), stretches.in_use(), taps.in_use(), ramps.in_use(), chip_removals.in_use()]
}

const SLOTS: [usize; 5] = [MOVES, STRETCHES, TAPS, RAMPS, CHIP_REMOVALS];
const FULL: [Full; 5] = [Full::Moves, Full::Stretches, Full::Taps, Full::Ramps, Full::ChipRemovals];

#[derive(Clone, Copy, Debug)]
enum Action {
    Push(u8),
    Done(usize),
    HandedBack(usize),
    GivenUp,
}

fn action() -> impl Strategy<Value = Action> {
    prop_oneof![
        30 => (0..6_u8).prop_map(Action::Push),
        6 => (1..4_usize).prop_map(Action::Done),
        1 => (0..QUEUE).prop_map(Action::HandedBack),
        1 => Just(Action::GivenUp),
    ]
}

proptest! {
    /// The queue is the list of the steps that were taken and not removed, its slots are those
    /// of their plans, and a step is refused where its slots or the places of the queue are all
    /// taken, and only there.
    #[test]
    fn slots_are_in_use_for_the_steps_that_wait_and_for_no_others(actions in proptest::collection::vec(action(), 0..400)) {
        let plans: Vec<Plans> = (0..400).map(Plans::numbered).collect();
        let mut queue = Queue::new();
        let mut waiting: Vec<Drawn> = Vec::new();
        for (op, action) in (0..).zip(actions) {
            match action {
                Action::Push(kind) => {
                    let used = count(&waiting);
                    let no_slot = (0..5).find(|&of| of == usize::from(kind) && used[of] == SLOTS[of]);
                    let expected = if waiting.len() == QUEUE {
                        Err(Full::Steps)
                    } else {
                        no_slot.map_or(Ok(()), |of| Err(FULL[of]))
                    };
                    prop_assert_eq!(queue.push(&plans[op as usize].step(kind, op)), expected);
                    waiting.extend(expected.is_ok().then_some((kind, op)));
                }
                Action::Done(steps) => {
                    queue.remove_first(steps);
                    waiting.drain(..steps.min(waiting.len()));
                }
                Action::HandedBack(stays) => {
                    queue.truncate(stays);
                    waiting.truncate(stays);
                }
                Action::GivenUp => {
                    queue.clear();
                    waiting.clear();
                }
            }
            prop_assert_eq!(queue.iter().count(), waiting.len());
            for (step, &(kind, op)) in queue.iter().zip(&waiting) {
                prop_assert_eq!(step, plans[op as usize].step(kind, op));
            }
            prop_assert_eq!(in_use(&queue), count(&waiting));
        }
        queue.clear();
        prop_assert_eq!(in_use(&queue), [0; 5]);
    }
}

#[test]
fn a_refusal_says_how_many_there_is_room_for() {
    let text = std::format!("{}", Full::Taps);
    assert_eq!(text, "the kernel's queue has room for 4 taps, and all of them are waiting");
}
