//! Steps, requests and records as bytes: what goes in comes out, and what is none of them is
//! refused.
#![allow(clippy::unwrap_used)] // a test may panic
use bus::{SPINDLES, Sample};
use kernel::Request;
use motion::{
    Arc, ChipThrow, Curve, Entry, Follow, Inline, Instant, Line, Move, PHASES, Pace, Path, Phase,
    Piece, Profile, SpindleStep, Step, StepKind, TapPlan,
};
use proptest::prelude::*;
use servo::{Record, Said, SetUp, Unreadable, check_request, check_step, decode, encode};
use units::{Angle, Axis, Lead, Length, Position, Spin, Time};

/// The longest message that the rings of shared memory hold.
const LONGEST_STEP: usize = 6144;
const LONGEST_RECORD: usize = 4096;

fn phase(n: u8) -> Phase {
    let n = f64::from(n);
    Phase { duration: 0.1 + n, s: n, v: -n, a: 2.0 * n, j: 0.5 }
}

fn profile(phases: u8) -> Profile {
    let mut profile = Profile::EMPTY;
    for n in 0..phases {
        assert!(profile.push(phase(n)));
    }
    profile.ending_at(Instant { s: 1.0, v: 2.0, a: 0.0 })
}

fn follow(curve: &Curve, count: u8) -> Follow {
    Follow {
        piece: Piece {
            curve: *curve,
            begin: 0.0,
            length: 1.0,
            feed: 10.0,
            rapid: false,
            entry: Entry::Smooth,
            op: 3,
            line: 4,
        },
        phases: std::array::from_fn(|n| phase(n as u8)),
        count,
        per_revolution: false,
        exact_stop: true,
        pace: Pace { share: 1.0, turning: 1.0 },
    }
}

fn tap(spindle: u8) -> TapPlan {
    TapPlan {
        axis: Axis::Z,
        spindle,
        start: Position::xyz(1.0, 2.0, 3.0),
        bottom: Length::mm(-20.0),
        deepest: Length::mm(-23.75),
        end: Length::mm(5.0),
        surface: Length::ZERO,
        lead: Lead::mm_per_rev(-1.25),
        spin: Spin::rpm(3000.0),
        return_spin: Spin::rpm(-3000.0),
        inward: profile(64),
        dwell: Time::ZERO,
        outward: profile(64),
        start_angle: Some(Angle::rev(0.25)),
        turns_at_speed: true,
        limiting: motion::TapLimiting::default(),
        torque_expected: units::Torque::n_m(1.75),
        torque_limit: Some(units::Torque::n_m(6.5)),
    }
}

fn arc(first: usize) -> Curve {
    Curve::Arc(Arc {
        from: [0.0; 9],
        to: [1.0; 9],
        plane: [first, 1],
        centre: [0.5, 0.5],
        sweep: 1.0,
        length: 2.0,
    })
}

fn steps() -> Vec<Step<Inline>> {
    let line = Curve::Line(Line { from: [0.0; 9], to: [1.0; 9], length: 3.0 });
    let path = Path::Line { from: Position::xyz(0.0, 0.0, 0.0), to: Position::xyz(1.0, 2.0, 3.0) };
    let plan = Move {
        path,
        profile: profile(7),
        rapid: true,
        per_revolution: false,
        exact_stop: true,
        floats: false,
        programmed: None,
    };
    let chips = ChipThrow {
        throw: Spin::rpm(-900.0),
        against: profile(64),
        then: Spin::ZERO,
        back: profile(64),
        axis: Axis::Z,
        level: Length::mm(2.0),
        upwards: true,
    };
    let spindle = |order| StepKind::Spindle { spindle: 1, order };
    let kinds = vec![
        StepKind::Move(plan),
        StepKind::Follow(follow(&line, PHASES as u8)),
        StepKind::Follow(follow(&arc(0), 1)),
        StepKind::Tap(tap(0)),
        spindle(SpindleStep::Turn { spin: Spin::rpm(100.0), ramp: profile(3) }),
        spindle(SpindleStep::Throw(chips)),
        spindle(SpindleStep::AwaitSpeed),
        StepKind::Dwell(Time::s(0.5)),
        StepKind::ChangeTool { tool: 7, by_hand: true },
        StepKind::WayOut(None),
        StepKind::End,
    ];
    (1..).zip(kinds).map(|(line, kind)| Step { op: line + 1, line, kind }).collect()
}

#[test]
fn every_step_comes_out_as_it_went_in_and_fits_into_its_slot() {
    for step in steps() {
        let mut bytes = [0; LONGEST_STEP];
        let length = encode(&step, &mut bytes).unwrap();
        let read: Step<Inline> = decode(&bytes[..length]).unwrap();
        assert_eq!(read, step);
        assert_eq!(check_step(&read), Ok(()));
        for shorter in 0..length {
            assert_eq!(decode::<Step<Inline>>(&bytes[..shorter]), Err(Unreadable), "{shorter}");
        }
        assert_eq!(decode::<Step<Inline>>(&bytes[..=length]), Err(Unreadable));
        assert_eq!(encode(&step, &mut [0; 1]), None);
    }
}

#[test]
fn a_number_that_is_none_is_refused_wherever_it_stands() {
    let step = Step::<Inline> { op: 1, line: 1, kind: StepKind::Dwell(Time::s(f64::NAN)) };
    let mut bytes = [0; LONGEST_STEP];
    let length = encode(&step, &mut bytes).unwrap();
    assert_eq!(decode::<Step<Inline>>(&bytes[..length]), Err(Unreadable));
    let mut plan = tap(0);
    plan.lead = Lead::mm_per_rev(f64::NAN);
    let step = Step::<Inline> { op: 1, line: 1, kind: StepKind::Tap(plan) };
    let length = encode(&step, &mut bytes).unwrap();
    assert_eq!(decode::<Step<Inline>>(&bytes[..length]), Err(Unreadable));
}

#[test]
fn what_no_machine_has_is_refused_with_its_number() {
    let text = |kind| check_step(&Step::<Inline> { op: 0, line: 0, kind }).unwrap_err().to_string();
    let spindle = SPINDLES as u8;
    assert_eq!(text(StepKind::Tap(tap(spindle))), "a message names spindle 2: there are 2 at most");
    assert_eq!(
        text(StepKind::Release { follower: 9 }),
        "a message names spindle 9: there are 2 at most"
    );
    assert_eq!(
        text(StepKind::Follow(follow(&arc(9), 1))),
        "a message names axis 9: there are 9 at most"
    );
    assert_eq!(
        text(StepKind::Follow(follow(&arc(0), 7))),
        "a stretch of a path has 7 phases: 1 to 6 are possible"
    );
    assert_eq!(
        text(StepKind::Follow(follow(&arc(0), 0))),
        "a stretch of a path has 0 phases: 1 to 6 are possible"
    );
    let turn = Request::TurnManually(SPINDLES, Spin::ZERO, Time::ZERO);
    assert_eq!(
        check_request(&turn).unwrap_err().to_string(),
        "a message names spindle 2: there are 2 at most"
    );
}

/// Requests and replies that carry nothing: their number alone says which they are, on both sides
/// the same.
#[test]
fn every_request_and_reply_comes_out_as_it_went_in() {
    use kernel::Reply;
    let same = |one: String, other: String| assert_eq!(one, other);
    for request in [
        Request::SwitchOn,
        Request::SwitchOff,
        Request::Clear,
        Request::ClearOutputs,
        Request::RestManually,
        Request::ForgetHome(Axis::Z),
        Request::GoOn,
        Request::HandBack,
        Request::UnderWay,
        Request::GiveUp { steps: 3, at: Some(0.5) },
        Request::Answer,
        Request::KeepRecords,
        Request::Acknowledge(7),
        Request::NotWritten,
        Request::ForgetBands(7),
    ] {
        let mut bytes = [0; 1024];
        let length = encode(&request, &mut bytes).unwrap();
        let out = decode::<Request>(&bytes[..length]).unwrap();
        same(format!("{out:?}"), format!("{request:?}"));
    }
    for reply in [
        Reply::Done,
        Reply::Is(true),
        Reply::HandedBack(None),
        Reply::UnderWay(None),
        Reply::Superposed(Ok(())),
        Reply::Superposed(Err(kernel::FaultKind::TableMissing)),
    ] {
        let mut bytes = [0; 1024];
        let length = encode(&reply, &mut bytes).unwrap();
        let out = decode::<Reply>(&bytes[..length]).unwrap();
        same(format!("{out:?}"), format!("{reply:?}"));
    }
}

#[test]
fn a_record_with_every_alarm_fits_into_its_slot() {
    let fault = kernel::Fault {
        kind: kernel::FaultKind::MovesAgainstOrder,
        subject: kernel::Subject::Axis(Axis::W),
        value: -1.0,
        limit: 1.0,
        time: Time::s(1e5),
        op: u32::MAX,
        line: u32::MAX,
    };
    let sample = Sample {
        report: bus::Report {
            op: u32::MAX,
            line: u32::MAX,
            sync_error: Some(Length::mm(1.0)),
            ..Default::default()
        },
        ..Sample::default()
    };
    let mut all = kernel::Kernel::new(config()).picture();
    all.faults = [Some(fault); kernel::FAULTS];
    all.steps = usize::MAX;
    let record =
        Record { number: u64::MAX, sample, heard: sample.feedback, picture: all, taken: u64::MAX };
    let mut bytes = [0; LONGEST_RECORD];
    let length = encode(&record, &mut bytes).unwrap();
    let read: Record = decode(&bytes[..length]).unwrap();
    assert_eq!(format!("{read:?}"), format!("{record:?}"));
}

fn config() -> kernel::Config {
    kernel::Config {
        period: Time::s(1e-3),
        command_delay: Time::ZERO,
        axes: [None; bus::AXES],
        spindles: [None; SPINDLES],
        synchronisation: sync::SyncMode::CommandSynchronised,
        sync_windows: sync::Windows { warn: Length::mm(0.1), stop: Length::mm(1.0) },
        waits: kernel::Waits {
            ready: Time::s(1.0),
            at_speed: Time::s(1.0),
            oriented: Time::s(1.0),
            in_position: Time::s(1.0),
            tool_change: Time::s(1.0),
        },
        motion: motion::Limits::default(),
        phase_loss: None,
        overrides: kernel::Overrides::USUAL,
        pause: kernel::Pause::Wait,
        probe_guard: true,
        learning: None,
        compensation: kernel::DeviationTables::default(),
        supervision: None,
    }
}

#[test]
fn a_set_up_comes_out_as_it_went_in() {
    let set_up = SetUp {
        config: config(),
        silent_after: Time::s(0.2),
        obeys_after: [Time::s(1e-3); bus::AXES],
        spindles_obey_after: [Time::s(1e-3), Time::ZERO],
        watched: bus::WatchedInputs::default().with(bus::WatchedInput::AxisReady(8)),
    };
    let mut bytes = [0; 8192];
    let length = encode(&set_up, &mut bytes).unwrap();
    assert_eq!(decode::<SetUp>(&bytes[..length]), Ok(set_up));
}

proptest! {
    /// Whatever stands in the memory: it is refused, or it is a value whose checks hold.
    #[test]
    fn bytes_of_any_kind_are_refused_or_are_values(bytes in proptest::collection::vec(any::<u8>(), 0..700)) {
        if let Ok(step) = decode::<Step<Inline>>(&bytes) {
            let _ = check_step(&step);
        }
        if let Ok(request) = decode::<Request>(&bytes) {
            let _ = check_request(&request);
        }
        let _ = decode::<Record>(&bytes);
        let _ = decode::<Said>(&bytes);
        let _ = decode::<SetUp>(&bytes);
    }

    /// A step with some bytes changed is refused, or goes into a kernel that ticks on.
    #[test]
    fn a_step_that_was_changed_on_its_way_is_refused_or_executed_as_any_other(
        which in 0..11_usize,
        changes in proptest::collection::vec((any::<u16>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = [0; LONGEST_STEP];
        let length = encode(&steps()[which], &mut bytes).unwrap();
        for (at, value) in changes {
            bytes[usize::from(at) % length] = value;
        }
        let Ok(step) = decode::<Step<Inline>>(&bytes[..length]) else { return Ok(()) };
        if check_step(&step).is_err() {
            return Ok(());
        }
        let mut kernel = kernel::Kernel::new(config());
        kernel.push(&step).unwrap();
        for period in 1..20 {
            let feedback = bus::Feedback { time: Time::s(f64::from(period) * 1e-3), tool: Some(0), ..Default::default() };
            let command = kernel.tick(&feedback);
            prop_assert!(command.axes.iter().all(|axis| axis.position.value().is_finite()));
        }
    }
}
