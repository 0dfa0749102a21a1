//! A recovery that is itself stopped by an alarm: the tool is still in its thread, that is said,
//! and the next one takes it out.
use control::job::ProgramOptions;
use control::operation::{Execution, Request};
use control::{Control, ControlOptions};

const TAP: &str = "G21 G90 G54\nT2 M6\nG43 H2\nS6000 M3\nG0 X12 Y12 Z30\nG99 G83 Z-24 R2 Q8 F900\nG80\nG0 Z50\nT3 M6\nG43 H3\nS3000 M3\nG0 X12 Y12 Z30\nG99 G84 Z-17 R5 F3000\nG80\nG0 Z50\nM30\n";
/// What is waited for comes within so many periods, a minute, or not at all.
const COMES: usize = 240_000;

fn control() -> Control {
    let options = ControlOptions {
        seed: Some(3),
        ..ControlOptions::simulated(ProgramOptions::on("tapping-center"))
    };
    Control::new(options).unwrap()
}

#[track_caller]
fn until(control: &mut Control, what: &str, is_so: impl Fn(&Control) -> bool) {
    for _ in 0..COMES {
        if is_so(control) {
            return;
        }
        control.period();
    }
    panic!("{what} does not come: {:?}", control.status());
}

#[track_caller]
fn asked(control: &mut Control, request: &Request) {
    control.request(request).unwrap_or_else(|why| panic!("{request:?}: {why}"));
}

/// A tap stands deep in its thread, and the emergency stop has been triggered.
fn stopped_in_a_tap(folder: &std::path::Path) -> Control {
    let mut control = control();
    asked(&mut control, &Request::Power(true));
    until(&mut control, "ready", |control| control.status().is_ready);
    asked(&mut control, &Request::Home(None));
    until(&mut control, "homed", |control| control.status().axes.iter().all(|axis| axis.is_homed));
    let path = folder.join("tap.ngc");
    std::fs::write(&path, TAP).unwrap();
    asked(&mut control, &Request::Load(path));
    asked(&mut control, &Request::Start);
    until(&mut control, "a tap", |control| {
        let status = control.status();
        status.activity == "tap-in" && status.axes[2].work < -8.0
    });
    stop(&mut control);
    control
}

fn stop(control: &mut Control) {
    assert!(control.breaches().is_empty(), "before {:?}", control.breaches());
    asked(control, &Request::EmergencyStop(true));
    for _ in 0..8000 {
        control.period();
    }
    assert!(!control.status().alarms.is_empty());
    assert!(control.breaches().is_empty(), "{:?}", control.breaches());
    asked(control, &Request::EmergencyStop(false));
    control.period();
}

#[test]
fn a_recovery_that_an_alarm_has_stopped_is_begun_again_and_nothing_else_moves_before() {
    let folder = tempfile::tempdir().unwrap();
    let mut control = stopped_in_a_tap(folder.path());
    for after in [20, 400, 1500] {
        assert!(control.status().is_tool_in_work);
        asked(&mut control, &Request::Recover);
        for _ in 0..after {
            control.period();
        }
        assert!(control.status().is_tool_in_work, "it is on its way");
        stop(&mut control);
        assert!(control.status().is_tool_in_work, "it was stopped after {after} periods");
        for forbidden in [Request::Reset, Request::Power(true), Request::Home(None), Request::Start]
        {
            assert!(control.request(&forbidden).is_err(), "{forbidden:?} after {after} periods");
        }
    }
    asked(&mut control, &Request::Recover);
    until(&mut control, "out", |control| !control.status().is_tool_in_work);
    let status = control.status();
    assert!(status.alarms.is_empty(), "{status:?}");
    asked(&mut control, &Request::Home(None));
    until(&mut control, "homed", |control| control.status().axes.iter().all(|axis| axis.is_homed));
    asked(&mut control, &Request::Reset);
    for _ in 0..4000 {
        control.period(); // what turns comes to rest first
    }
    // the thread was cut by the same tap, whole: it is done again from its beginning
    asked(&mut control, &Request::Start);
    until(&mut control, "the end", |control| control.execution() == Execution::ProgramCompleted);
    assert!(control.breaches().is_empty(), "{:?}", control.breaches());
}

#[test]
fn a_tool_of_a_recovery_that_was_stopped_is_free_when_the_operator_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let mut control = stopped_in_a_tap(folder.path());
    asked(&mut control, &Request::Recover);
    for _ in 0..20 {
        control.period();
    }
    stop(&mut control);
    asked(&mut control, &Request::ToolIsFree);
    assert!(!control.status().is_tool_in_work);
    asked(&mut control, &Request::Power(true));
}

/// A machine that has been stopped somewhere in a tap, with this tool, at this depth of its tip, on
/// its way in or out; `None`: the tap was over before.
fn stopped_with(folder: &std::path::Path, tool: u32, depth: f64, inward: bool) -> Option<Control> {
    let mut control = control();
    asked(&mut control, &Request::Power(true));
    until(&mut control, "ready", |control| control.status().is_ready);
    asked(&mut control, &Request::Home(None));
    until(&mut control, "homed", Control::is_homed_all);
    let path = folder.join("one.ngc");
    let text = format!(
        "G21 G90 G54\nT{tool} M6\nG43 H{tool}\nS1500 M3\nG0 X12 Y12 Z30\nG99 G84 Z-14 R5 F1500\nG80\nG0 Z50\nM30\n"
    );
    std::fs::write(&path, text).unwrap();
    asked(&mut control, &Request::Load(path));
    asked(&mut control, &Request::Start);
    for _ in 0..COMES {
        control.period();
        let activity = control.activity().name();
        let (is_in, is_out) = (activity == "tap-in", activity == "tap-out");
        let at = control.status().axes[2].work;
        if inward && is_in && at < -depth || !inward && is_out && at > -depth {
            return Some(control);
        }
        if control.execution() == Execution::ProgramCompleted {
            return None;
        }
    }
    None
}

/// Three recoveries, each stopped after a random time, and a fourth: whatever is said of the tool,
/// a recovery that is asked for while the tool is said to be in the work is begun, and the last one
/// brings it out. 2,000 at night.
#[test]
fn a_recovery_is_never_refused_for_a_false_reason_however_often_others_were_stopped_before() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = 0x2545_f491_4f6c_dd1d_u64;
    let mut chance = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (random >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut recovered, mut stopped, mut torn) = (0, 0, 0);
    for case in 0..test_support::size::of(24, 2000) {
        let tool = if chance() < 0.7 { 3 } else { 14 };
        let (depth, inward) = (chance() * 14.0 - 1.0, chance() < 0.5);
        let Some(mut control) = stopped_with(folder.path(), tool, depth, inward) else { continue };
        asked(&mut control, &Request::EmergencyStop(true));
        let mut said = format!("case {case}: T{tool}, {depth:.3} mm deep, inward {inward}");
        for attempt in 0..4 {
            for _ in 0..6000 {
                control.period();
            }
            asked(&mut control, &Request::EmergencyStop(false));
            control.period();
            let status = control.status();
            if control.broken_tool().is_some() {
                torn += 1;
                break;
            }
            if !status.is_tool_in_work {
                break;
            }
            let at = status.axes[2].work;
            if let Err(why) = control.request(&Request::Recover) {
                panic!("{said}; recovery {attempt} at {at:.4} mm: {why}");
            }
            // the last one is not stopped
            let after = if attempt == 3 { COMES } else { 1 + (chance().powi(2) * 9000.0) as usize };
            for _ in 0..after {
                control.period();
                if !control.status().is_tool_in_work {
                    break;
                }
            }
            said = format!("{said}; {attempt} from {at:.4} mm, {after} periods");
            if !control.status().is_tool_in_work {
                recovered += 1;
                break;
            }
            assert!(attempt < 3, "{said}: it does not come out: {:?}", control.status());
            stopped += 1;
            asked(&mut control, &Request::EmergencyStop(true));
        }
    }
    println!("{recovered} recovered, {stopped} recoveries stopped, {torn} torn");
    assert!(recovered > 0 && stopped > 0);
}

/// The button is released while the stop is under way, and the tool is asked out as soon as that is
/// accepted, wherever in a tap: no tap breaks of it.
#[test]
fn an_emergency_stop_that_is_released_at_once_leaves_the_tap_whole() {
    let folder = tempfile::tempdir().unwrap();
    let mut left = 0;
    let mut torn = Vec::new();
    for case in 0..test_support::size::of(16, 400) {
        let depth = -4.0 + 18.0 * f64::from(case % 16) / 16.0 + 0.037 * f64::from(case / 16);
        let Some(mut control) = stopped_with(folder.path(), 3, depth, case % 5 != 4) else {
            continue;
        };
        asked(&mut control, &Request::EmergencyStop(true));
        for _ in 0..[1, 2, 9, 40, 300][case as usize % 5] {
            control.period();
        }
        asked(&mut control, &Request::EmergencyStop(false));
        until(&mut control, "all stands", |control| {
            assert_ne!(control.execution(), Execution::ProgramCompleted, "{:?}", control.status());
            control.execution() == Execution::Stopped
        });
        if control.status().is_tool_in_work {
            left += 1;
            for _ in 0..COMES {
                if control.request(&Request::Recover).is_ok() {
                    break;
                }
                control.period();
            }
            until(&mut control, "out", |control| !control.status().is_tool_in_work);
        }
        if control.broken_tool().is_some() {
            torn.push(format!("case {case}, {depth:.3} mm"));
        }
    }
    assert!(left > 4, "{left} were left in the work");
    assert!(torn.is_empty(), "{torn:#?}");
}
