//! A long program is interpreted and planned in another thread while the control goes on.
#![allow(clippy::unwrap_used)] // a test may panic
use canon::{Axis, Position};
use control::job::ProgramOptions;
use control::operation::{Begun, Execution, Proving, Request};
use control::{Control, ControlOptions};
use units::Coordinate;

const TEXT: &str = "G21 G90 G54 G94\nG1 F600 X1\nX0\nM2\n";

fn homed() -> Control {
    let options = ControlOptions {
        program: ProgramOptions::on("bench-xyz"),
        seed: Some(1),
        state: None,
        simulator: None,
        hal: false,
        clamped: Position::default(),
        real_time: None,
    };
    let mut control = Control::new(options).unwrap();
    control.request(&Request::Power(true)).unwrap();
    while !control.status().is_ready {
        control.period();
    }
    control.request(&Request::Home(None)).unwrap();
    for _ in 0..10 {
        control.period();
    }
    control
}

fn proving(control: &mut Control, request: &Request) -> Box<Proving> {
    match control.begin(request) {
        Begun::Proving(proving) => proving,
        Begun::Answered(answer) => panic!("{answer:?}"),
    }
}

#[test]
fn a_program_is_read_in_another_thread_loaded_and_started_while_periods_pass() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.ngc");
    std::fs::write(&path, TEXT).unwrap();
    let mut control = homed();
    for request in [Request::Load(path), Request::Start] {
        let proving = proving(&mut control, &request);
        let thread = std::thread::scope(|scope| {
            let thread = scope.spawn(|| proving.prove());
            control.period(); // it goes on meanwhile
            thread.join().unwrap()
        });
        control.complete(thread).unwrap();
    }
    assert!(control.execution().is_under_way());
    for _ in 0..20_000 {
        control.period();
    }
    assert_eq!(control.execution(), Execution::ProgramCompleted);
}

#[test]
fn what_was_proved_for_other_offsets_than_those_in_force_is_not_executed() {
    let mut control = homed();
    let typed = Request::ManualDataInput("G1 F600 X1".into());
    let proving = proving(&mut control, &typed);
    control.request(&Request::TouchOff(Axis::X, Coordinate::new(3.0))).unwrap();
    let refused = control.complete(proving.prove()).unwrap_err().to_string();
    assert_eq!(refused, "offsets, tools or positions have changed while it was read: ask again");
    assert!(!control.execution().is_under_way());
}

#[test]
fn what_needs_no_proof_is_answered_at_once() {
    let mut control = homed();
    assert!(matches!(control.begin(&Request::FeedOverride(0.5)), Begun::Answered(Ok(_))));
    assert!(matches!(control.begin(&Request::Resume), Begun::Answered(Err(_))));
    assert!(matches!(control.begin(&Request::Start), Begun::Answered(Err(_))));
}
