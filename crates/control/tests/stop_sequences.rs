//! Stops upon stops: whatever is asked for, once or three times, while a tool is in its thread, is
//! backed out or recovered, everything comes to rest within a stated time, and the tool comes out
//! whole.
use crate::stops::{homed, pass, until};
use control::Control;
use control::operation::{Event, Execution, Jog, Request};
use std::path::Path;
use test_support::size;
use units::{Coordinate, Time};

/// Motions that end by themselves or by a stop take no longer than this.
const COMES_TO_REST: Time = Time::s(30.0);

/// What is cut: a machine, a program, and the line in which the tool is tied to a spindle.
const CUTS: [(&str, &str, &str, u32); 9] = [
    (
        "tap",
        "tapping-center",
        "G21 G90 G54\nT2 M6\nG43 H2\nS6000 M3\nG0 X12 Y12 Z30\nG99 G83 Z-24 R2 Q8 F900\nG80\nG0 Z50\nT3 M6\nG43 H3\nS3000 M3\nG0 X12 Y12 Z30\nG99 G84 Z-17 R5 F3000\nG80\nG0 Z50\nM30\n",
        12,
    ),
    (
        "tap in pecks",
        "tapping-center",
        "G21 G90 G54\nT2 M6\nG43 H2\nS6000 M3\nG0 X12 Y12 Z30\nG99 G83 Z-24 R2 Q8 F900\nG80\nG0 Z50\nT3 M6\nG43 H3\nS1000 M3\nG0 X12 Y12 Z30\nG99 G84 Z-17 R5 Q5 F1000\nG80\nG0 Z50\nM30\n",
        12,
    ),
    (
        "G76",
        "lathe",
        "G21 G18 G90 G94 G8\nT32 M6\nG43 H32\nS1000 M3\nG0 X11 Y0 Z6\nG76 P1.5 Z-15 I-1 J0.4 K0.985 R1.5 Q29.5 H1 E1.5 L2\nG0 X30\nM2\n",
        6,
    ),
    (
        "G33",
        "lathe",
        "G21 G18 G90 G94 G8\nT32 M6\nG43 H32\nS1000 M3\nG0 X11 Y0 Z6\nX9.8\nG33 Z-15 K1.5\nG0 X11\nZ6\nX9.5\nG33 Z-15 K1.5\nG0 X30\nM2\n",
        7,
    ),
    (
        "feed",
        "tapping-center",
        "G21 G90 G94 G54\nT1 M6\nG43 H1\nS1000 M3\nG0 X0 Y0 Z30\nG1 F1200 X100\nX0\nM30\n",
        6,
    ),
    (
        "gear",
        "gear-hobber",
        "(GEAR WIDTH 20)\nG21 G90 G94 G17\nT23 M6\nG43 H23\nG0 X110 Y0 Z5\nM3 S300\nG81 T40 L1 Q2 P20\nG0 X75.067\nG1 Z-25 F15\nG0 X110\nG80\nM5\nG0 Z100\nM30\n",
        9,
    ),
    (
        "polygon",
        "polygon-lathe",
        "G21 G90 G94 G17\nT21 M6\nG43 H21\nG0 X75 Y0 Z5\nM3 S500\nG51.2 P1 Q2 R0 D0\nG0 X58.5 Z2\nG1 Z-20 F50\nG0 X75\nG50.2\nM5\nG0 Z100\nM30\n",
        8,
    ),
    (
        "cam",
        "cam-grinder",
        "G21 G90 G54\nG0 X248 Z-20\nG151 P1237\nG152\nG153\nG154 S60 P2\nG155\nG151 P1237 R0\nG150\nG154 X-0.1 F0.05 S60\nG154 P3\nG151 P0\nM30\n",
        10,
    ),
    ("rapid", "tapping-center", "G21 G90 G94 G54\nG0 X0 Y0 Z30\nG0 X180\nG0 X0\nM30\n", 3),
];

const CAMS: &str = include_str!("../../../programs/cams.toml");

/// What is asked for, one after the other.
const SEQUENCES: [(&str, &[Request]); 8] = [
    ("stop", &[Request::Stop]),
    ("stop three times", &[Request::Stop, Request::Stop, Request::Stop]),
    ("hold, stop", &[Request::FeedHold, Request::Stop]),
    ("hold, retract, stop", &[Request::FeedHold, Request::Retract, Request::Stop]),
    (
        "hold, retract, stop three times",
        &[Request::FeedHold, Request::Retract, Request::Stop, Request::Stop, Request::Stop],
    ),
    (
        "hold, retract, hold, stop",
        &[Request::FeedHold, Request::Retract, Request::FeedHold, Request::Stop],
    ),
    ("hold, emergency stop", &[Request::FeedHold, Request::EmergencyStop(true)]),
    (
        "hold, retract, emergency stop",
        &[Request::FeedHold, Request::Retract, Request::EmergencyStop(true)],
    ),
];

/// The cut is under way: the line is executed.
fn under_way(folder: &Path, (_, machine, text, line): &(&str, &str, &str, u32)) -> Control {
    let mut control = homed(machine);
    let path = folder.join("cut.ngc");
    std::fs::write(&path, text).unwrap();
    // the library of cams lies beside its program
    std::fs::write(folder.join("cams.toml"), CAMS).unwrap();
    control.request(&Request::Load(path)).unwrap();
    control.request(&Request::Start).unwrap();
    until(&mut control, "the cut", |control| control.line() == *line);
    control
}

/// A tool is tied to a spindle, in the work or on its way to it.
fn is_tied(control: &Control) -> bool {
    control.status().is_tool_in_work
}

/// A tap is in its thread.
pub(crate) fn is_in_thread(control: &Control) -> bool {
    !control.status().unmet.iter().any(|unmet| unmet.need == "tap_in_thread")
}

/// Everything rests, and nothing is under way but what waits for the operator.
fn comes_to_rest(control: &mut Control, what: &str) {
    let end = control.now() + COMES_TO_REST;
    let rests = |control: &Control| {
        let is_held = control.status().activity == "held" && is_tied(control);
        control.is_at_standstill() || control.execution().is_under_way() && is_held
    };
    let mut rested = 0;
    while rested < 400 {
        assert!(control.now() < end, "{what}: it goes on: {:#?}", control.status());
        rested = if rests(control) { rested + 1 } else { 0 };
        control.period();
    }
}

/// What is left in the work is taken out by what the status offers, however often that is stopped.
fn comes_out(control: &mut Control, what: &str) {
    if control.status().emergency_stop == "TRIGGERED" {
        control.request(&Request::EmergencyStop(false)).unwrap();
        control.period();
    }
    for stopped_after in [0.03, 0.2, 0.7] {
        if !is_tied(control) {
            return;
        }
        if control.request(&Request::Recover).is_err() {
            let retracted = control.request(&Request::Retract);
            let refused = retracted.map_err(|why| why.to_string()).err();
            assert_eq!(refused, None, "{what}: {:#?}", control.status());
        }
        pass(control, Time::s(stopped_after));
        let stopped = control.request(&Request::Stop);
        pass(control, Time::s(2.0));
        if let Err(why) = stopped {
            let why = why.to_string();
            assert!(why.contains("emergency stop") || !is_tied(control), "{what}: {why}");
        }
        comes_to_rest(control, what);
    }
    if is_tied(control) && control.request(&Request::Recover).is_err() {
        control.request(&Request::Retract).unwrap_or_else(|why| panic!("{what}: {why}"));
    }
    until(control, what, |control| !is_tied(control));
    comes_to_rest(control, what);
}

#[test]
fn whatever_stops_follow_each_other_everything_rests_and_the_tool_comes_out_whole() {
    let mut cases = 0;
    let every = size::of(2, 1);
    for (number, cut) in CUTS.iter().enumerate() {
        for (sequence, requests) in SEQUENCES.into_iter().skip(number % every).step_by(every) {
            let moments = [0.35, 0.05, 0.6, 0.15, 0.9, 1.2];
            for first in moments.into_iter().take(size::of(1, 6)) {
                for between in [0.04, 0.3, 1.5].into_iter().take(size::of(1, 3)) {
                    let folder = tempfile::tempdir().unwrap();
                    let mut control = under_way(folder.path(), cut);
                    let what = format!("{}, {sequence}, {first} s, each {between} s later", cut.0);
                    pass(&mut control, Time::s(first));
                    for request in requests {
                        // refused where the one before has ended it all
                        let _ = control.request(request);
                        pass(&mut control, Time::s(between));
                    }
                    pass(&mut control, Time::s(1.0));
                    comes_to_rest(&mut control, &what);
                    comes_out(&mut control, &what);
                    assert!(control.breaches().is_empty(), "{what}: {:?}", control.breaches());
                    assert!(!control.execution().is_under_way(), "{what}: {:#?}", control.status());
                    cases += 1;
                }
            }
        }
    }
    println!("{cases} sequences");
}

/// What would let a program go on is refused from its stop on, whatever was asked for before it and
/// wherever it is, with what is possible instead.
#[test]
fn after_a_stop_nothing_lets_the_program_go_on_and_the_refusal_says_what_is_possible() {
    let before: [&[Request]; 4] = [
        &[Request::Stop],
        &[Request::FeedHold, Request::Stop],
        &[Request::FeedHold, Request::Resume, Request::Stop],
        &[Request::FeedHold, Request::Stop, Request::FeedHold],
    ];
    let goes_on = [
        Request::Resume,
        Request::Confirm,
        Request::Start,
        Request::ManualDataInput("G91 G0 Z1\nG90".into()),
        Request::Jog(canon::Axis::Z, Jog::Increment(Coordinate::new(1.0))),
    ];
    let (mut refused, mut in_thread) = (0, 0);
    for cut in &CUTS {
        for requests in before.into_iter().skip(size::of(1, 0)).take(size::of(1, 4)) {
            let folder = tempfile::tempdir().unwrap();
            let mut control = under_way(folder.path(), cut);
            if cut.0.starts_with("tap") {
                until(&mut control, "the thread", is_in_thread);
            } else {
                pass(&mut control, Time::s(0.35));
            }
            for request in requests {
                let _ = control.request(request);
                pass(&mut control, Time::s(0.02));
            }
            let what = format!("{}, {requests:?}", cut.0);
            let end = control.now() + Time::s(1.0);
            while control.execution().is_under_way() && control.now() < end {
                for request in &goes_on {
                    let answer = control.request(request);
                    let said = answer.expect_err("it was stopped").to_string();
                    let (reason, remedy) = said.split_once(": ").unwrap_or_default();
                    assert!(reason.contains("stopped"), "{what}, {request:?}: {said}");
                    assert!(reason.ends_with("cannot go on"), "{what}, {request:?}: {said}");
                    assert!(remedy.contains("start it again"), "{what}, {request:?}: {said}");
                    in_thread += usize::from(remedy.contains("retract its tool"));
                    refused += 1;
                }
                pass(&mut control, Time::s(0.05));
            }
            let heard: Vec<_> = std::iter::from_fn(|| control.next_event()).collect();
            let asked = |event: &Event| matches!(event, Event::Notice(text) if text.contains("ended by an abort"));
            assert!(!heard.iter().any(asked), "{what}: {heard:?}");
        }
    }
    assert!(refused > 100 && in_thread > 50, "{refused}, {in_thread} of a tap in its thread");
}

/// A program that waits at M0 is stopped: it is confirmed in vain.
#[test]
fn a_stop_at_m0_is_not_confirmed_away() {
    let folder = tempfile::tempdir().unwrap();
    let cut = ("M0", "tapping-center", "G21 G90 G54\nG0 X0\nM0\nG0 X5\nM30\n", 3);
    let mut control = under_way(folder.path(), &cut);
    until(&mut control, "M0", |control| control.execution() == Execution::ProgramStopped);
    control.request(&Request::Stop).unwrap();
    for request in [Request::Confirm, Request::Resume] {
        let why = control.request(&request).expect_err("it was stopped").to_string();
        assert!(why.contains("cannot go on"), "{why}");
    }
    until(&mut control, "its end", |control| control.execution() == Execution::Stopped);
}
