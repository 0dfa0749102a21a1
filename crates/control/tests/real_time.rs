//! A control that stays on, by the clock: what is asked of it acts on the servo thread's kernel,
//! and nothing is lost on the way.
use canon::Axis;
use control::job::ProgramOptions;
use control::operation::{Execution, Jog, Refusal, Request};
use control::{Control, ControlOptions, RealTimeOptions};
use std::sync::atomic::{AtomicU32, Ordering};
use units::{Coordinate, CoordinateSpeed, Time};

/// Longer than anything here takes on a computer that has something else to do.
const AT_MOST: Time = Time::s(60.0);

fn switched_on(machine: &str) -> Control {
    switched_on_by(machine, RealTimeOptions::default())
}

fn switched_on_by(machine: &str, real_time: RealTimeOptions) -> Control {
    let options = ControlOptions {
        seed: Some(1),
        real_time: Some(real_time),
        ..ControlOptions::simulated(ProgramOptions::on(machine))
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
    asked(&mut control, &Request::Jog(Axis::X, Jog::Increment(Coordinate::new(3.0))));
    until(&mut control, |control| !control.is_moving_manually());
    assert!((x(&control) - before - 3.0).abs() < 1e-6, "{} {before}", x(&control));
    asked(&mut control, &Request::Jog(Axis::X, Jog::Continuous(CoordinateSpeed::new(-10.0))));
    let began = control.now();
    until(&mut control, |control| !control.is_moving_manually());
    let (lasted, went) = (control.now() - began, before + 3.0 - x(&control));
    // 0.2 s of lease and the way to a stop; the request has reached the kernel a moment after
    // `began`
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
    let jog = Request::Jog(Axis::X, Jog::Increment(Coordinate::new(1.0)));
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

/// Homed, and on the way along what was typed.
fn under_way(typed: &str) -> (Control, f64) {
    let mut control = switched_on("bench-xyz");
    asked(&mut control, &Request::Home(None));
    until(&mut control, Control::is_homed_all);
    let begins = x(&control);
    asked(&mut control, &Request::ManualDataInput(typed.into()));
    until(&mut control, |control| x(control) > begins + 2.0);
    (control, begins)
}

/// Largest speed of X until the end, over 50 ms, mm/s.
fn fastest(control: &mut Control) -> f64 {
    let mut seen = Vec::new();
    until(control, |control| {
        seen.push((control.now(), x(control)));
        !control.execution().is_under_way()
    });
    let pairs = seen.iter().zip(seen.iter().skip(50));
    pairs.map(|(a, b)| (b.1 - a.1) / (b.0 - a.0).value()).fold(0.0, f64::max)
}

/// One move of 40 mm at 10 mm/s.
#[test]
fn more_feed_than_programmed_acts_within_a_move_that_is_under_way() {
    let (mut control, begins) = under_way("G21 G91 G1 F600 X40");
    asked(&mut control, &Request::FeedOverride(1.5));
    let most = fastest(&mut control);
    assert!((most - 15.0).abs() < 0.2, "{most} mm/s");
    assert!((x(&control) - begins - 40.0).abs() < 1e-2);
    assert!(control.status().alarms.is_empty(), "{:?}", control.status().alarms);
}

#[test]
fn single_block_stops_at_the_end_of_a_line_of_a_joined_path_that_is_under_way() {
    let typed = "G21 G91 G64 P0.05 G1 F600 X5\nX5 Y0.5\nX5 Y-0.5\nX5 Y0.5\nX5 Y-0.5\nX5 Y0.5";
    let (mut control, begins) = under_way(typed);
    asked(&mut control, &Request::SingleBlock(true));
    until(&mut control, |control| control.execution() == Execution::Interrupted);
    let went = x(&control) - begins;
    assert!(went < 21.0 && (went - 5.0 * (went / 5.0).round()).abs() < 0.01, "{went} mm");
    asked(&mut control, &Request::SingleBlock(false));
    asked(&mut control, &Request::Resume);
    until(&mut control, |control| !control.execution().is_under_way());
    assert!((x(&control) - begins - 30.0).abs() < 1e-2);
    assert!(control.status().alarms.is_empty(), "{:?}", control.status().alarms);
}

#[test]
fn a_servo_thread_that_breaks_down_is_an_alarm_and_whatever_waits_goes_on() {
    static PERIOD: AtomicU32 = AtomicU32::new(0);
    let around: fn(&mut dyn FnMut()) = |part| {
        assert!(PERIOD.fetch_add(1, Ordering::Relaxed) != 3000, "a defect, made for this test");
        part();
    };
    let real_time = RealTimeOptions { around, ..RealTimeOptions::default() };
    let mut control = switched_on_by("tapping-center", real_time);
    asked(&mut control, &Request::Jog(Axis::X, Jog::Continuous(CoordinateSpeed::new(-10.0))));
    until(&mut control, |control| !control.status().alarms.is_empty());
    let status = control.status();
    assert_eq!(control.alarms()[0].number, 412, "{status:#?}");
    assert!(!status.is_ready && control.is_at_standstill());
    let refused = control.request(&Request::Jog(Axis::X, Jog::Increment(Coordinate::new(1.0))));
    assert!(matches!(refused, Err(Refusal::State(_))), "{refused:?}");
    let before = control.now();
    until(&mut control, |control| control.now() > before + Time::s(0.01));
}

/// More steps are on their way than the kernel's queue holds: those of a program that was given up
/// are forgotten with it, wherever they are.
#[test]
fn a_long_program_is_stopped_and_begun_again_and_none_of_its_steps_is_left() {
    let mut control = switched_on("bench-xyz");
    asked(&mut control, &Request::Home(None));
    until(&mut control, Control::is_homed_all);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.ngc");
    let lines: Vec<_> = (0..4000).map(|n| format!("X{} Y{}", n % 2, (n / 2) % 2)).collect();
    let lines = lines.join("\n");
    std::fs::write(&path, format!("G21 G90 G54 G61\nG1 F6000 X0 Y0\n{lines}\nM2\n")).unwrap();
    asked(&mut control, &Request::Load(path));
    for _ in 0..3 {
        asked(&mut control, &Request::Start);
        let begun = control.now();
        until(&mut control, |control| control.line() > 20 && control.now() > begun);
        asked(&mut control, &Request::Stop);
        until(&mut control, |control| !control.execution().is_under_way());
        let stopped = (x(&control), control.line());
        for _ in 0..400 {
            control.period();
        }
        assert!(control.status().alarms.is_empty(), "{:?}", control.status().alarms);
        assert!((x(&control) - stopped.0).abs() < 1e-9, "{} {stopped:?}", x(&control));
    }
}
