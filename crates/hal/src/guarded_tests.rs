//! What guards the machine over HAL: the emergency stop chain, drives that say that they are ready,
//! doors, and a panel.
#![allow(clippy::unwrap_used)] // a test may panic
use crate::bench::*;
use crate::fake;
use control::Control;
use control::operation::{Event, Execution, Request, Signals, Switches};
use std::path::PathBuf;
use test_support::size;

/// The mill with more in its section [hal], in a folder.
fn mill_with(folder: &Folder, section: &str) -> PathBuf {
    let mill = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines/hal/mill.toml");
    let text = std::fs::read_to_string(mill).unwrap().replace("estop = \"wired\"", section);
    std::fs::create_dir_all(&folder.0).unwrap();
    let path = folder.0.join("mill.toml");
    std::fs::write(&path, text).unwrap();
    path
}

fn led(path: &std::path::Path) -> Result<Control, String> {
    control_at(path.to_str().unwrap(), None).map_err(|why| why.to_string())
}

fn has_alarm(control: &Control, part: &str) -> bool {
    control.status().alarms.iter().any(|alarm| alarm.contains(part))
}

#[test]
fn a_control_is_refused_while_nothing_drives_the_emergency_stop_chain() {
    let _one = fake::one_at_a_time();
    let folder = Folder::new();
    let running = Running::start_unwired(TakenBy::Speed);
    let why = control().err().unwrap().to_string();
    assert!(why.contains("nothing drives estop-ok of leadscrew"), "{why}");
    for writers in [None, Some(0)] {
        fake::with(|hal| {
            if let Some(writers) = writers {
                hal.link("estop-ok", writers);
            }
            hal.set_bit("estop-ok", true); // setp, or sets
        });
        assert!(control().is_err(), "a value that was set by hand is no chain");
    }
    let none = mill_with(&folder, "estop = \"none\"");
    let mut without = home(led(&none).unwrap());
    fake::with(|hal| hal.set_bit("estop-ok", false));
    asked(&mut without, &Request::ManualDataInput("G91 G0 X-1".into()));
    until(&mut without, |control| control.execution() == Execution::ProgramCompleted);
    drop(without);
    until_free();
    running.end();
}

#[test]
fn a_chain_that_opens_and_one_whose_writer_is_gone_are_an_emergency_stop() {
    let _one = fake::one_at_a_time();
    let running = Running::start();
    let mut control = homed();
    fake::with(|hal| hal.set_bit("estop-ok", false));
    until(&mut control, |control| has_alarm(control, "emergency stop"));
    assert!(fake::with(|hal| !hal.bit("z.enable") && !hal.bit("spindle.0.enable")));
    assert_eq!(control.status().emergency_stop, "TRIGGERED");
    fake::with(|hal| hal.set_bit("estop-ok", true));
    until(&mut control, |control| control.status().emergency_stop == "ARMED");
    asked(&mut control, &Request::Reset);
    let mut control = home(control);
    assert!(fake::with(|hal| hal.bit("z.enable")));

    // a signal keeps the last value of a component that is unloaded
    fake::with(|hal| hal.lose_writer("estop-ok"));
    until(&mut control, |control| has_alarm(control, "emergency stop"));
    assert!(fake::with(|hal| hal.bit("estop-ok") && !hal.bit("z.enable")));
    drop(control);
    until_free();
    running.end();
}

#[test]
fn a_drive_is_ready_when_it_says_so_and_an_alarm_when_it_no_longer_does() {
    const PINS: [&str; 3] = ["x.ready", "z.ready", "spindle.0.ready"];
    let _one = fake::one_at_a_time();
    let folder = Folder::new();
    let running = Running::start();
    let mill = mill_with(&folder, "ready = [\"x\", \"z\", \"spindle.0\"]");
    let why = led(&mill).err().unwrap();
    assert!(PINS.iter().all(|pin| why.contains(pin)) && !why.contains("y.ready"), "{why}");

    fake::with(|hal| PINS.iter().for_each(|pin| hal.link(pin, 1)));
    let mut control = led(&mill).unwrap();
    asked(&mut control, &Request::Power(true));
    until(&mut control, |control| control.status().waiting_for.is_some());
    fake::with(|hal| PINS[1..].iter().for_each(|pin| hal.set_bit(pin, true)));
    until(&mut control, |control| !control.status().alarms.is_empty());
    assert!(has_alarm(&control, "X: "), "{:?}", control.status().alarms);

    asked(&mut control, &Request::Reset);
    fake::with(|hal| hal.set_bit("x.ready", true));
    let mut control = home(control);
    fake::with(|hal| hal.set_bit("z.ready", false));
    until(&mut control, |control| !control.status().alarms.is_empty());
    assert!(has_alarm(&control, "Z: "), "{:?}", control.status().alarms);
    fake::with(|hal| hal.set_bit("z.ready", true));
    asked(&mut control, &Request::Reset);
    let mut control = home(control);
    fake::with(|hal| hal.lose_writer("spindle.0.ready"));
    until(&mut control, |control| !control.status().alarms.is_empty());
    assert!(has_alarm(&control, "spindle 0"), "{:?}", control.status().alarms);
    drop(control);
    until_free();
    running.end();
}

#[test]
fn a_door_is_shown_holds_what_moves_and_refuses_what_would_begin() {
    let _one = fake::one_at_a_time();
    let running = Running::start();
    let mut control = homed();
    asked(&mut control, &Request::ManualDataInput("G91 G0 X-40\nG0 X40".into()));
    until(&mut control, |_| fake::with(|hal| hal.float("x.pos-fb")) < -5.0);
    fake::with(|hal| hal.set_bit("feed-inhibit", true));
    until(&mut control, |control| control.execution() == Execution::FeedHold);
    let stands = fake::with(|hal| hal.float("x.pos-cmd"));
    let shown = control.status().waiting_for.unwrap().what;
    assert!(shown.contains("feed no longer inhibited"), "{shown}");
    let why = control.request(&Request::Resume).err().unwrap().to_string();
    assert!(why.contains("holds the feed: close it first"), "{why}");
    assert!((fake::with(|hal| hal.float("x.pos-cmd")) - stands).abs() < 1e-9);
    fake::with(|hal| hal.set_bit("feed-inhibit", false));
    until(&mut control, |control| control.execution() == Execution::ProgramCompleted);

    fake::with(|hal| hal.set_bit("spindle.0.inhibit", true));
    until(&mut control, |control| {
        control.status().unmet.iter().any(|need| need.need == "spindle_not_inhibited")
    });
    let blocks = Request::ManualDataInput("S1000 M3".into());
    let why = control.request(&blocks).err().unwrap().to_string();
    assert!(why.contains("holds a spindle: close it first"), "{why}");
    drop(control);
    until_free();
    running.end();
}

#[test]
fn a_door_that_the_machines_file_relies_on_is_open_while_nothing_drives_it() {
    let _one = fake::one_at_a_time();
    let folder = Folder::new();
    let running = Running::start();
    let answer = "[hal.safety]\n\"motion.feed-inhibit\" = \"leadscrew.feed-inhibit\"\n";
    let mill = mill_with(&folder, answer);
    let why = led(&mill).err().unwrap();
    assert!(why.contains("nothing drives feed-inhibit"), "{why}");
    fake::with(|hal| hal.link("feed-inhibit", 1));
    let mut control = home(led(&mill).unwrap());
    fake::with(|hal| hal.lose_writer("feed-inhibit"));
    until(&mut control, |control| {
        control.status().unmet.iter().any(|need| need.need == "feed_not_inhibited")
    });
    drop(control);
    until_free();
    let open = "[hal.safety]\n\"motion.enable\" = \"unanswered: on signal door, mill.hal:31\"\n";
    let why = led(&mill_with(&folder, open)).err().unwrap();
    assert!(why.contains("motion.enable is unanswered: on signal door, mill.hal:31"), "{why}");
    running.end();
}

/// Presses a key for some periods.
fn press(control: &mut Control, key: &str) {
    for is_down in [true, false] {
        fake::with(|hal| hal.set_bit(key, is_down));
        live(control);
    }
}

/// Lives through periods that are enough for what was recorded before to be looked at.
fn live(control: &mut Control) {
    let mut seen = 0;
    while seen < 200 || control.periods_waiting() > 0 {
        control.period();
        control.answer_panel();
        seen += 1;
    }
}

#[test]
fn keys_of_a_panel_ask_for_what_the_page_asks_for() {
    let _one = fake::one_at_a_time();
    let folder = Folder::new();
    std::fs::create_dir_all(&folder.0).unwrap();
    let program = folder.0.join("moves.ngc");
    std::fs::write(&program, "G21 G91\nG1 X-40 F2000\nG1 X40\nM2\n").unwrap();
    let running = Running::start();
    let mut control = homed();
    press(&mut control, "cycle-start"); // nothing is loaded
    let mut said = Vec::new();
    while let Some(event) = control.next_event() {
        if let Event::Notice(text) = event {
            said.push(text);
        }
    }
    let refused = "the panel: no program is loaded: load one first";
    assert!(said.iter().any(|text| text == refused), "{said:#?}");

    asked(&mut control, &Request::Load(program));
    press(&mut control, "cycle-start");
    assert_eq!(control.execution(), Execution::Active);
    press(&mut control, "hold");
    until(&mut control, |control| control.execution() == Execution::FeedHold);
    fake::with(|hal| hal.set_bit("hold", true));
    press(&mut control, "cycle-start");
    assert_eq!(control.execution(), Execution::FeedHold, "hold is pressed");
    fake::with(|hal| hal.set_bit("hold", false));
    press(&mut control, "cycle-start");
    assert_eq!(control.execution(), Execution::Active);
    press(&mut control, "stop");
    until(&mut control, |control| control.execution() == Execution::Stopped);
    press(&mut control, "reset");
    assert_eq!(control.execution(), Execution::Ready);

    for (pin, is_set) in [
        ("single-block", (|s| s.single_block) as fn(&Switches) -> bool),
        ("optional-stop", |s| s.optional_stop),
        ("block-skip", |s| s.block_skip.contains(&1)),
    ] {
        fake::with(|hal| hal.set_bit(pin, true));
        until(&mut control, |control| is_set(&control.status().switches));
    }
    drop(control);
    until_free();
    running.end();
}

#[test]
fn keys_of_a_panel_power_the_drives_and_home_the_axes() {
    let _one = fake::one_at_a_time();
    let running = Running::start();
    let mut control = control().unwrap();
    live(&mut control);
    press(&mut control, "home-all");
    assert!(!control.is_homed_all(), "the drives have no power");
    press(&mut control, "power-on");
    until(&mut control, |control| fake::with(|hal| hal.bit("x.enable")) && control.is_ready());
    press(&mut control, "home-all");
    until(&mut control, Control::is_homed_all);
    press(&mut control, "power-off");
    until(&mut control, |_| !fake::with(|hal| hal.bit("x.enable")));
    drop(control);
    until_free();
    running.end();
}

#[test]
fn dials_a_handwheel_and_jog_keys_move_what_the_page_would() {
    let _one = fake::one_at_a_time();
    let running = Running::start();
    let mut control = homed();
    let set = |name: &str, value: i32| fake::with(|hal| hal.set_s32(name, value));
    let number = |name: &str, value: f64| fake::with(|hal| hal.set_float(name, value));
    number("feed-override.scale", 0.01);
    number("spindle-override.scale", 0.05);
    set("feed-override.counts", -30);
    set("spindle-override.counts", 2);
    live(&mut control);
    let overrides = control.status().overrides;
    assert!((overrides.feed_percent - 70.0).abs() < 1e-3, "{overrides:?}");
    assert!((overrides.spindle_percent - 110.0).abs() < 1e-3, "{overrides:?}");
    fake::with(|hal| hal.set_bit("feed-override.direct-value", true));
    set("feed-override.counts", 55);
    live(&mut control);
    assert!((control.status().overrides.feed_percent - 55.0).abs() < 1e-3);

    // 25 counts of 0.02 mm; counts of a wheel that is not for this axis move nothing
    let x = || fake::with(|hal| hal.float("x.pos-cmd"));
    let began = x();
    number("x.jog-scale", -0.02); // X stands at its positive end
    set("x.jog-counts", 1000);
    live(&mut control);
    fake::with(|hal| hal.set_bit("x.jog-enable", true));
    for counts in 1001..=1025 {
        set("x.jog-counts", counts);
        live(&mut control);
    }
    until(&mut control, Control::is_at_standstill);
    assert!((x() - began + 0.5).abs() < 1e-6, "{} mm", x() - began);

    // 5 mm/s until the key is released; its writer is lost as well as it is released
    number("jog-speed", 300.0);
    fake::with(|hal| hal.link("x.jog-minus", 1));
    fake::with(|hal| hal.set_bit("x.jog-minus", true));
    live(&mut control);
    assert!(control.is_at_standstill(), "jog-enable is FALSE");
    fake::with(|hal| hal.set_bit("jog-enable", true));
    let began = x();
    while x() > began - 3.0 {
        live(&mut control);
    }
    fake::with(|hal| hal.lose_writer("x.jog-minus"));
    live(&mut control);
    let after = x();
    live(&mut control);
    assert!((x() - after).abs() < 1e-9, "it stands");
    drop(control);
    until_free();
    running.end();
}

#[test]
fn the_torque_of_a_drive_counts_where_the_file_says_so_while_something_drives_its_pin() {
    let _one = fake::one_at_a_time();
    let folder = Folder::new();
    let running = Running::start();
    let mill = mill_with(&folder, "torque = [\"z\", \"spindle.0\"]");
    let why = led(&mill).err().unwrap();
    assert!(why.contains("z.torque-fb") && why.contains("spindle.0.torque-fb"), "{why}");
    fake::with(|hal| {
        hal.link("z.torque-fb", 1);
        hal.link("spindle.0.torque-fb", 1);
        hal.set_float("z.torque-fb", 123.0);
        hal.set_float("spindle.0.torque-fb", -4.5);
        hal.set_float("x.torque-fb", 9.0);
    });
    let mut control = home(led(&mill).unwrap());
    live(&mut control);
    let scope = Signals::of(&control);
    let shown = |control: &Control, name: &str| {
        let mut values = Vec::new();
        scope.read(control, &mut values);
        scope.names().iter().position(|other| other == name).map(|at| values[at])
    };
    assert_eq!(shown(&control, "Z.measured_force_n"), Some(123.0));
    let of_x = shown(&control, "X.measured_force_n");
    assert!(of_x.is_none_or(f32::is_nan), "the file does not name it: {of_x:?}");
    assert_eq!(shown(&control, "spindle0.measured_torque_n_m"), Some(-4.5));
    assert_eq!(control.status().spindles[0].torque_n_m, Some(4.5));
    fake::with(|hal| hal.lose_writer("spindle.0.torque-fb"));
    live(&mut control);
    assert_eq!(control.status().spindles[0].torque_n_m, None, "what is not driven says nothing");
    drop(control);
    until_free();
    running.end();
}

#[test]
fn a_door_that_is_opened_at_any_instant_keeps_a_tap_over_hal_on_its_helix() {
    let _one = fake::one_at_a_time();
    let running = Running::start();
    let mut control = homed();
    asked(&mut control, &Request::ManualDataInput("T3 M6\nG91 G0 Z-100".into()));
    until(&mut control, |control| control.execution() == Execution::ProgramCompleted);
    for case in 0..size::of(4, 60) {
        running.take_places();
        let tap = "G91 S1000 M3\nG33.1 Z-10 K1\nM5";
        asked(&mut control, &Request::ManualDataInput(tap.into()));
        // instants and durations over the whole tap, each case another one
        let opens = control.now() + units::Time::s((case * 37 % 60) as f64 * 0.045);
        until(&mut control, |control| control.now() >= opens);
        let door = ["feed-inhibit", "spindle.0.inhibit"][case % 2];
        fake::with(|hal| hal.set_bit(door, true));
        let closes = control.now() + units::Time::s(0.05 + (case * 17 % 11) as f64 * 0.08);
        until(&mut control, |control| control.now() >= closes);
        fake::with(|hal| hal.set_bit(door, false));
        until(&mut control, |control| control.execution() == Execution::ProgramCompleted);
        let off = off_thread(&running.take_places());
        assert!(off < 0.02, "case {case}: {off} mm off its thread");
    }
    drop(control);
    until_free();
    running.end();
}
