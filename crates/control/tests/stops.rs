//! What stops, what turns on, and what an axis does that does not know where it is: in lock-step,
//! to the period.
use canon::Axis;
use control::job::ProgramOptions;
use control::operation::{Event, Execution, Jog, Request};
use control::{Control, ControlOptions};
use test_support::size;
use units::{Coordinate, CoordinateSpeed, Time};

pub(crate) fn powered(machine: &str) -> Control {
    let options =
        ControlOptions { seed: Some(1), ..ControlOptions::simulated(ProgramOptions::on(machine)) };
    let mut control = Control::new(options).unwrap();
    asked(&mut control, &Request::Power(true));
    until(&mut control, "ready", Control::is_ready);
    control
}

pub(crate) fn homed(machine: &str) -> Control {
    let mut control = powered(machine);
    asked(&mut control, &Request::Home(None));
    until(&mut control, "homed", Control::is_homed_all);
    control
}

fn asked(control: &mut Control, request: &Request) {
    if let Err(refused) = control.request(request) {
        panic!("{request:?}: {refused}");
    }
}

pub(crate) fn until(control: &mut Control, what: &str, mut holds: impl FnMut(&Control) -> bool) {
    let end = control.now() + Time::s(120.0);
    while !holds(control) {
        assert!(control.now() < end, "{what}: {:#?}", control.status());
        control.period();
    }
}

pub(crate) fn pass(control: &mut Control, time: Time) {
    let end = control.now() + time;
    until(control, "time passes", |control| control.now() >= end);
}

fn typed(control: &mut Control, blocks: &str) {
    asked(control, &Request::ManualDataInput(blocks.into()));
    until(control, blocks, |control| !control.execution().is_under_way());
}

fn notices(control: &mut Control) -> Vec<String> {
    let events = std::iter::from_fn(|| control.next_event());
    let notices = events.filter_map(|event| match event {
        Event::Notice(text) => Some(text),
        _ => None,
    });
    notices.collect()
}

/// The codes say what the spindle is told to do.
fn says_what_it_does(control: &Control, after: &str) {
    let status = control.status();
    let said = ["M3", "M4", "M5"].map(|code| status.codes.iter().any(|known| known == code));
    let ordered = status.spindles[0].ordered_rpm;
    let does = [ordered > 0.0, ordered < 0.0, ordered == 0.0];
    assert_eq!(said, does, "after {after}: {:?}, {ordered} rev/min", status.codes);
}

#[test]
fn a_spindle_turns_on_after_typed_blocks_until_a_word_or_a_stop_of_everything() {
    let mut control = homed("tapping-center");
    let rpm = |control: &Control| control.status().spindles[0].ordered_rpm.round();
    says_what_it_does(&control, "power on");
    for (blocks, expected) in [
        ("M3 S1200", 1200.0),
        ("G91 G0 Z-1", 1200.0),
        ("G94 G1 F500 X-1", 1200.0),
        ("S800", 800.0),
        ("M4", -800.0),
        ("G4 P0.1", -800.0),
        ("M5", 0.0),
        ("M3 S500", 500.0),
        ("M2", 0.0),
        ("M3 S600", 600.0),
    ] {
        typed(&mut control, blocks);
        pass(&mut control, Time::s(0.5));
        assert_eq!(rpm(&control), expected, "{blocks}");
        says_what_it_does(&control, blocks);
    }
    // a jog and a hold leave it turning
    asked(&mut control, &Request::Jog(Axis::X, Jog::Increment(Coordinate::new(-1.0))));
    pass(&mut control, Time::s(0.5));
    asked(&mut control, &Request::ManualDataInput("G91 G1 F600 X-20".into()));
    pass(&mut control, Time::s(0.3));
    asked(&mut control, &Request::FeedHold);
    until(&mut control, "held", |control| control.execution() == Execution::FeedHold);
    assert_eq!(rpm(&control), 600.0);
    asked(&mut control, &Request::Resume);
    until(&mut control, "over", |control| !control.execution().is_under_way());
    says_what_it_does(&control, "a hold");
    asked(&mut control, &Request::Reset);
    until(&mut control, "reset", Control::is_at_standstill);
    says_what_it_does(&control, "a reset");
    // given up
    typed(&mut control, "M3 S600");
    asked(&mut control, &Request::ManualDataInput("G91 G1 F600 X-20".into()));
    pass(&mut control, Time::s(0.3));
    asked(&mut control, &Request::Stop);
    until(&mut control, "stopped", Control::is_at_standstill);
    says_what_it_does(&control, "a stop");
    // an alarm while nothing is executed
    typed(&mut control, "M3 S600");
    asked(&mut control, &Request::EmergencyStop(true));
    until(&mut control, "an alarm", Control::has_alarm);
    pass(&mut control, Time::s(0.1));
    says_what_it_does(&control, "an emergency stop");
}

#[test]
fn coolant_that_is_switched_by_hand_flows_until_the_program_a_stop_or_a_hand_switches_it() {
    let mut control = homed("tapping-center");
    let flows = |control: &Control, after: &str| {
        let status = control.status();
        let has = |code: &str| status.codes.iter().any(|known| known == code);
        let told = [status.mist, status.flood];
        assert_eq!(
            [has("M7"), has("M8"), has("M9")],
            [told[0], told[1], told == [false; 2]],
            "{after}"
        );
        told
    };
    typed(&mut control, "G91 G0 Z-1");
    asked(&mut control, &Request::Flood(true));
    pass(&mut control, Time::s(0.01));
    assert_eq!(flows(&control, "by hand"), [false, true]);
    asked(&mut control, &Request::ManualDataInput("G91 G1 F600 X-10\nM9\nX-10\nM7\nX-10".into()));
    pass(&mut control, Time::s(0.3));
    assert_eq!(flows(&control, "blocks that say nothing of it"), [false, true]);
    until(&mut control, "M9", |control| !control.status().flood);
    asked(&mut control, &Request::Flood(true));
    until(&mut control, "M7", |control| control.status().mist);
    assert_eq!(flows(&control, "M7"), [true, true], "M7 switches the mist alone");
    asked(&mut control, &Request::Flood(false));
    until(&mut control, "over", |control| !control.execution().is_under_way());
    assert_eq!(flows(&control, "the other by hand"), [true, false]);
    asked(&mut control, &Request::Power(false));
    pass(&mut control, Time::s(0.1));
    assert_eq!(flows(&control, "power off"), [false, false]);
    asked(&mut control, &Request::Power(true));
    until(&mut control, "power", Control::is_ready);
    assert_eq!(flows(&control, "power on again"), [false, false], "nothing flows by itself");
    asked(&mut control, &Request::Flood(true));
    asked(&mut control, &Request::EmergencyStop(true));
    until(&mut control, "an alarm", Control::has_alarm);
    assert_eq!(flows(&control, "an emergency stop"), [false, false]);
    let why = control.request(&Request::Flood(true)).err().map(|why| why.to_string());
    assert!(why.is_some_and(|why| why.contains("emergency stop")));
}

#[test]
fn an_axis_that_is_not_homed_goes_slowly_and_not_far_and_its_limit_switches_stop_it() {
    for (axis, speed) in [(Axis::X, 1.0), (Axis::X, -1.0), (Axis::Y, 1.0), (Axis::Z, 1.0)] {
        let mut control = powered("tapping-center");
        let far = Jog::Increment(Coordinate::new(10.1));
        assert!(control.request(&Request::Jog(axis, far)).is_err(), "too far");
        let rapid = Jog::Continuous(CoordinateSpeed::new(speed * 400.0));
        assert!(control.request(&Request::Jog(axis, rapid)).is_err(), "too fast");
        let slow = control.machine().axis(axis).unwrap().homing.fast;
        let jog = Jog::Continuous(slow * speed);
        let end = control.now() + Time::s(60.0);
        let mut said = Vec::new();
        while control.now() < end && said.is_empty() {
            let _ = control.request(&Request::Jog(axis, jog));
            pass(&mut control, Time::s(0.1));
            said.extend(notices(&mut control).into_iter().filter(|text| text.contains("switch")));
            assert!(!control.has_alarm(), "{axis:?} {speed}: {:?}", control.alarms());
        }
        assert!(said[0].contains("stands on its limit switch"), "{said:?}");
        for _ in 0..20 {
            let _ = control.request(&Request::Jog(axis, jog));
            pass(&mut control, Time::s(0.1));
        }
        assert!(!control.has_alarm(), "{axis:?} {speed}: {:?}", control.alarms());
        // and off it again
        let back = Jog::Increment(Coordinate::new(-speed * 8.0));
        asked(&mut control, &Request::Jog(axis, back));
        until(&mut control, "off the switch", |control| !control.is_moving_manually());
        assert!(!control.has_alarm());
    }
}

const THREADS: [&str; 2] = [
    "G21 G18 G90 G94 G8\nT32 M6\nG43 H32\nS1000 M3\nG0 X11 Y0 Z6\nG76 P1.5 Z-15 I-1 J0.4 K0.985 R1.5 Q29.5 H1 E1.5 L2\nG0 X30\nM2\n",
    "G21 G18 G90 G94 G8\nT32 M6\nG43 H32\nS1000 M3\nG0 X11 Y0 Z6\nX9.8\nG33 Z-15 K1.5\nG0 X11\nZ6\nX9.5\nG33 Z-15 K1.5\nG0 X30\nM2\n",
];

/// The thread is under way; a hold comes so long after its first pass has begun.
fn held_in_thread(program: &str, after: Time) -> Control {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("thread.ngc");
    std::fs::write(&path, program).unwrap();
    let mut control = homed("lathe");
    asked(&mut control, &Request::Load(path));
    asked(&mut control, &Request::Start);
    let first = if program.contains("G76") { 6 } else { 7 };
    until(&mut control, "in the thread", |control| control.line() == first);
    pass(&mut control, after);
    asked(&mut control, &Request::FeedHold);
    control
}

#[test]
fn a_stop_after_a_hold_in_a_turned_thread_takes_the_tool_off_and_ends_the_program() {
    for (number, program) in THREADS.into_iter().enumerate() {
        let moments = [100.0, 700.0, 0.0, 250.0, 400.0, 550.0, 850.0, 1000.0, 1300.0, 1600.0];
        for ms in moments.into_iter().take(size::of(2, 10)) {
            for waits in [0.05, 1.0] {
                let mut control = held_in_thread(program, Time::s(ms / 1000.0));
                pass(&mut control, Time::s(waits));
                if !control.execution().is_under_way() {
                    continue;
                }
                asked(&mut control, &Request::Stop);
                let what = format!("thread {number}, {ms} ms, stopped {waits} s later");
                until(&mut control, &what, |control| !control.execution().is_under_way());
                until(&mut control, &what, Control::is_at_standstill);
                assert!(!control.is_tool_in_work(), "{what}");
                assert_eq!(control.execution(), Execution::Stopped, "{what}");
                asked(&mut control, &Request::Jog(Axis::X, Jog::Increment(Coordinate::new(1.0))));
            }
        }
    }
}

#[test]
fn what_a_program_says_is_heard_where_the_machine_has_come_to_it() {
    let mut control = homed("tapping-center");
    let blocks = "G91 G1 F600 X-1\n(MSG, turn the part)\nX1\n(DEBUG, done)";
    asked(&mut control, &Request::ManualDataInput(blocks.into()));
    let begins = control.now();
    let mut heard = Vec::new();
    while control.execution().is_under_way() {
        control.period();
        let now = control.now() - begins;
        heard.extend(notices(&mut control).into_iter().map(|text| (now, text)));
    }
    let said: Vec<_> = heard.iter().filter(|(_, text)| text.starts_with("line ")).collect();
    let texts: Vec<_> = said.iter().map(|(_, text)| text.as_str()).collect();
    assert_eq!(texts, ["line 2: turn the part", "line 4: done"]);
    assert!(said[0].0 > Time::s(0.09) && said[1].0 > Time::s(0.18), "{said:?}");
    let message = control.status().message.unwrap();
    assert_eq!((message.text.as_str(), message.line), ("done", 4));
}
