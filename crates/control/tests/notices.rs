//! What is asked for again and again, or lasts, gives one notice and no flood of events.
use crate::stop_sequences::is_in_thread;
use crate::stops::{homed, pass, until};
use canon::Axis;
use control::job::ProgramOptions;
use control::operation::{Event, Execution, Jog, Request, ToolField};
use control::{Control, ControlOptions};
use test_support::size;
use units::{Angle, Coordinate, CoordinateSpeed, Spin, Time};

/// A key that is held renews its jog so often.
const RENEWED: Time = Time::s(0.1);

fn heard(control: &mut Control) -> Vec<Event> {
    core::iter::from_fn(|| control.next_event()).collect()
}

fn powered(machine: &str) -> Control {
    let options = ControlOptions::simulated(ProgramOptions::on(machine));
    let mut control = Control::new(options).expect("the built-in machine is good");
    control.request(&Request::Power(true)).expect("nothing stands in the way");
    until(&mut control, "the drives", Control::is_ready);
    control
}

fn hold_key(control: &mut Control, speed: f64, lasts: Time) {
    let end = control.now() + lasts;
    while control.now() < end {
        let jog = Jog::Continuous(CoordinateSpeed::new(speed));
        control.request(&Request::Jog(Axis::X, jog)).expect("it may be jogged");
        pass(control, RENEWED);
    }
}

#[test]
fn a_key_held_on_a_limit_switch_gives_one_notice_until_it_is_let_go() {
    let mut control = powered("tapping-center");
    let on_switch = |event: &Event| matches!(event, Event::Notice(text) if text.starts_with("X stands on its limit switch"));
    let count = |control: &mut Control| heard(control).iter().filter(|e| on_switch(e)).count();
    let mut minutes = 0;
    while count(&mut control) == 0 {
        hold_key(&mut control, 20.0, Time::s(6.0));
        minutes += 1;
        assert!(minutes < 20, "it comes to no switch");
    }
    hold_key(&mut control, 20.0, Time::s(20.0));
    assert_eq!(count(&mut control), 0, "it was said");
    pass(&mut control, Time::s(2.0));
    hold_key(&mut control, 20.0, Time::s(5.0));
    assert_eq!(count(&mut control), 1, "the key was let go, and is pressed again");
    hold_key(&mut control, -20.0, Time::s(2.0));
    assert_eq!(count(&mut control), 0);
}

/// Requests that a client may send again and again, each of which begins nothing new.
fn repeated() -> Vec<Request> {
    let x = Axis::X;
    vec![
        Request::Power(true),
        Request::EmergencyStop(true),
        Request::EmergencyStop(false),
        Request::Home(None),
        Request::Jog(x, Jog::Continuous(CoordinateSpeed::new(1.0))),
        Request::Jog(x, Jog::Increment(Coordinate::new(0.1))),
        Request::Jog(x, Jog::Handwheel(Coordinate::new(0.001))),
        Request::Jog(x, Jog::To(Coordinate::new(1e6))),
        Request::JogStop,
        Request::TurnSpindle(0, Spin::rpm(100.0)),
        Request::OrientSpindle(0, Angle::rev(0.1)),
        Request::Start,
        Request::FeedHold,
        Request::Resume,
        Request::Confirm,
        Request::Stop,
        Request::Retract,
        Request::Recover,
        Request::ToolIsFree,
        Request::AcknowledgeState,
        Request::Reset,
        Request::SingleBlock(true),
        Request::OptionalStop(true),
        Request::BlockSkip(1, true),
        Request::FeedOverride(0.5),
        Request::FeedOverride(9.0),
        Request::RapidOverride(0.5),
        Request::SpindleOverride(1.1),
        Request::TouchOff(x, Coordinate::new(1.0)),
        Request::SetWorkOffset(1, x, Coordinate::new(-200.0)),
        Request::EditTool(3, ToolField::WearLength, 0.01),
        Request::RenewTool(3),
        Request::LimitTool(3, Some(9)),
    ]
}

const TAPS: &str = "G21 G90 G54\nT3 M6\nG43 H3\nS1000 M3\nG0 X12 Y12 Z30\nG99 G84 Z-17 R5 F1000\nG80\nG0 Z50\nM0\nM30\n";

/// States in which a client may go on asking.
const STATES: [&str; 7] =
    ["off", "not homed", "ready", "in a thread", "held in a thread", "after an alarm", "at M0"];

/// A control in one of these states.
fn control_in(state: &str) -> Control {
    let options = || ControlOptions::simulated(ProgramOptions::on("tapping-center"));
    let folder = tempfile::tempdir().expect("a folder");
    let mut control = match state {
        "off" => return Control::new(options()).expect("the built-in machine is good"),
        "not homed" => return powered("tapping-center"),
        _ => homed("tapping-center"),
    };
    if state == "ready" {
        return control;
    }
    let path = folder.path().join("taps.ngc");
    std::fs::write(&path, TAPS).expect("a program");
    control.request(&Request::Load(path)).expect("it is good");
    control.request(&Request::Start).expect("it is good");
    until(&mut control, "the thread", is_in_thread);
    match state {
        "in a thread" => {}
        "held in a thread" => {
            control.request(&Request::FeedHold).expect("it runs");
            pass(&mut control, Time::s(0.5));
        }
        "after an alarm" => {
            control.request(&Request::EmergencyStop(true)).expect("always");
            pass(&mut control, Time::s(1.0));
        }
        _ => until(&mut control, "M0", |control| control.execution() == Execution::ProgramStopped),
    }
    control
}

#[test]
fn no_request_that_is_repeated_floods_the_events_in_any_state() {
    /// Far more than a change of state and its notices come to.
    const MOST: usize = 24;
    let every = size::of(STATES.len(), 1);
    for (number, request) in repeated().into_iter().enumerate().step_by(size::of(3, 1)) {
        for state in STATES.into_iter().skip(number % every).step_by(every) {
            let mut control = control_in(state);
            heard(&mut control);
            for _ in 0..200 {
                let _ = control.request(&request);
                pass(&mut control, Time::s(0.01));
            }
            let heard = heard(&mut control);
            assert!(heard.len() <= MOST, "{state}, {request:?}: {} {heard:#?}", heard.len());
        }
    }
}
