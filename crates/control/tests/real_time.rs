//! A control that stays on, by the clock: what is asked of it acts on the servo thread's kernel, and nothing is lost on the way.
#![allow(clippy::unwrap_used)] // a test may panic
use canon::{Axis, Position};
use control::job::ProgramOptions;
use control::operation::{Execution, Jog, Refusal, Request};
use control::{Control, ControlOptions, RealTimeOptions};
use units::Time;

/// Longer than anything here takes on a computer that has something else to do.
const AT_MOST: Time = Time::s(60.0);

fn switched_on(machine: &str) -> Control {
    let options = ControlOptions {
        program: ProgramOptions::on(machine),
        seed: Some(1),
        state: None,
        clamped: Position::default(),
        real_time: Some(RealTimeOptions::default()),
    };
    let mut control = Control::new(options).unwrap();
    asked(&mut control, &Request::Power(true));
    until(&mut control, |control| control.status().is_ready);
    control
}

fn asked(control: &mut Control, request: &Request) {
    if let Err(refused) = control.request(request) {
        panic!("{request:?}: {refused}");
    }
}

fn until(control: &mut Control, mut is_so: impl FnMut(&Control) -> bool) {
    let end = control.now() + AT_MOST;
    while !is_so(control) {
        assert!(control.now() < end, "{:#?}", control.status());
        control.period();
    }
}

fn x(control: &Control) -> f64 {
    control.status().axes[0].machine
}

#[test]
fn an_axis_is_jogged_by_an_increment_and_on_a_lease_that_ends_by_itself() {
    let mut control = switched_on("tapping-center");
    let before = x(&control);
    asked(&mut control, &Request::Jog(Axis::X, Jog::Increment(3.0)));
    until(&mut control, |control| !control.is_moving_manually());
    assert!((x(&control) - before - 3.0).abs() < 1e-6, "{} {before}", x(&control));
    asked(&mut control, &Request::Jog(Axis::X, Jog::Continuous(-10.0)));
    let began = control.now();
    until(&mut control, |control| !control.is_moving_manually());
    let (lasted, went) = (control.now() - began, before + 3.0 - x(&control));
    // 0.2 s of lease and the way to a stop; the request has reached the kernel a moment after `began`
    assert!(lasted < Time::s(1.5) && went > 1.0 && went < 3.5, "{lasted} {went}");
}

#[test]
fn blocks_that_are_typed_are_executed_held_and_resumed_and_judged() {
    let mut control = switched_on("bench-xyz");
    asked(&mut control, &Request::Home(None));
    until(&mut control, Control::is_homed_all);
    let typed = "G21 G91 G1 F600 X5\nG1 X-5";
    asked(&mut control, &Request::ManualDataInput(typed.into()));
    until(&mut control, |control| control.line() > 0);
    asked(&mut control, &Request::FeedHold);
    until(&mut control, |control| control.execution() == Execution::FeedHold);
    let held = x(&control);
    for _ in 0..200 {
        control.period();
    }
    assert!((x(&control) - held).abs() < 1e-9);
    let jog = Request::Jog(Axis::X, Jog::Increment(1.0));
    assert!(matches!(control.request(&jog), Err(Refusal::State(_))));
    asked(&mut control, &Request::Resume);
    until(&mut control, |control| !control.execution().is_under_way());
    assert!(control.status().alarms.is_empty(), "{:?}", control.status().alarms);
    let figures = control.real_time().unwrap();
    assert!(figures.periods > 1000, "{figures:?}");
}

#[test]
fn an_emergency_stop_is_an_alarm_and_a_reset_makes_ready_again() {
    let mut control = switched_on("tapping-center");
    asked(&mut control, &Request::EmergencyStop(true));
    until(&mut control, |control| !control.status().alarms.is_empty());
    assert!(!control.status().is_ready);
    asked(&mut control, &Request::EmergencyStop(false));
    until(&mut control, |control| control.status().emergency_stop == "ARMED");
    asked(&mut control, &Request::Reset);
    until(&mut control, |control| control.status().alarms.is_empty());
}
