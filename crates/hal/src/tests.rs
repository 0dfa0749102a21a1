//! The component between a HAL that is none and a control that is one: ideal drives, a spindle with
//! ramps of its own.
#![allow(clippy::unwrap_used)] // a test may panic
use crate::bench::*;
use crate::ffi::Hal;
use crate::pins::Pins;
use crate::{fake, rtapi_app_exit};
use bus::{Command, Report, SpindleCommand};
use control::job::ProgramOptions;
use control::operation::{Event, Execution, Request};
use control::{Control, ControlOptions};
use shm::{Fieldbus as _, WriteTo};
use test_support::drives::{DrivesBench, conforms};
use units::{Angle, Orientation, Time, TurnDirection};

/// All of it in one test: HAL has one component of this name at a time.
#[test]
fn a_control_taps_through_the_component_and_what_ends_leaves_the_other_running() {
    let _one = fake::one_at_a_time();
    let why = control().err().unwrap().to_string();
    assert!(why.contains("nothing named default leads drives here: loadrt leadscrew"), "{why}");

    let running = Running::start();
    fake::with(|hal| {
        let names = hal.names();
        for name in
            ["x.pos-cmd", "z.limit-neg", "spindle.0.revs", "estop-ok", "din-03", "tool-number"]
        {
            assert!(names.contains(&format!("leadscrew.{name}").as_str()), "{name}");
        }
    });

    // a tap, 10 mm deep below where Z stands, with a spindle that is only told a speed
    let mut first = homed();
    let why = control().err().unwrap().to_string();
    assert!(why.contains("another control leads the drives of default"), "{why}");
    asked(
        &mut first,
        &Request::ManualDataInput("T3 M6\nG91 G0 Z-100\nS1000 M3\nG33.1 Z-10 K1".into()),
    );
    until(&mut first, |control| control.execution() == Execution::ProgramCompleted);
    assert!(fake::with(|hal| hal.bit("connected") && hal.bit("z.enable")));

    let peaks = fake::with(|hal| hal.float("spindle.0.speed-cmd"));
    assert!(peaks.abs() <= 1000.0 + 1e-9, "{peaks}");

    // it ends: the component stops what moves and lets go
    drop(first);
    until_free();
    assert!(fake::with(|hal| !hal.bit("connected") && !hal.bit("z.enable")));

    // another control takes the machine over; its component is unloaded under it, and the control
    // says so
    let mut second = homed();
    let deepest = running.end().iter().map(|(z, _)| *z).fold(0.0, f64::min);
    assert!(deepest < -99.0 && deepest > -111.0, "{deepest}");
    let mut told = Vec::new();
    let mut note = |control: &mut Control| {
        while let Some(event) = control.next_event() {
            match event {
                Event::Alarm(alarm) => told.push(alarm.text),
                Event::Notice(text) => told.push(text),
                _ => {}
            }
        }
    };
    let end = second.now() + Time::s(30.0);
    while !second.status().alarms.iter().any(|alarm| alarm.contains("412")) {
        assert!(second.now() < end, "{:#?}", second.status());
        second.period();
        note(&mut second);
    }
    // it is said once, and whatever waits is told that it waits in vain
    for _ in 0..500 {
        second.period();
        note(&mut second);
    }
    let about = told.iter().filter(|text| text.contains("HAL component") || text.contains("412"));
    assert_eq!(about.count(), 1, "{told:#?}");
    assert!(second.stopped_by().is_some());
}

#[test]
fn a_tool_that_a_control_leaves_in_its_thread_is_taken_out_by_the_next_one_that_has_its_record() {
    let _one = fake::one_at_a_time();
    let folder = Folder::new();
    let running = Running::start();
    drop(tapping(Some(&folder.0), 106.0));
    until_free();
    assert!(fake::with(|hal| hal.float("z.pos-fb")) < -105.0);

    // a control that has no record of it moves nothing
    let mut other = control().unwrap();
    assert!(other.is_tool_in_work());
    assert!(other.request(&Request::Power(true)).is_err());
    let why = other.request(&Request::Recover).err().map(|why| why.to_string());
    assert!(why.clone().is_some_and(|why| why.contains("no sync record")), "{why:?}");
    drop(other);
    until_free();

    let mut next = control_of(Some(&folder.0)).unwrap();
    assert!(next.is_tool_in_work());
    asked(&mut next, &Request::Recover);
    until(&mut next, |control| !control.is_tool_in_work());
    assert!(fake::with(|hal| hal.float("z.pos-fb")) > -100.1);
    drop(next);
    until_free();

    // and no control after that is told of it any more
    let after = control_of(Some(&folder.0)).unwrap();
    assert!(!after.is_tool_in_work());
    drop(after);
    let off = off_thread(&running.end());
    assert!(off < 0.02, "{off} mm off its thread");
}

/// Drives of HAL behind the control's door for machines.
struct InHal {
    folder: Folder,
    running: Option<Running>,
}

impl DrivesBench for InHal {
    fn options(&self) -> ControlOptions {
        let machine = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines/hal/mill.toml");
        ControlOptions {
            drives: control::DrivesChoice::of(&control::drives::hal::DOOR),
            state: Some(self.folder.0.join("state")),
            ..ControlOptions::simulated(ProgramOptions::on(machine))
        }
    }

    /// HAL knows pins, not machines: what has fewer axes than the component is led.
    fn of_another_machine(&self) -> Option<ControlOptions> {
        None
    }

    fn z_mm(&self) -> f64 {
        fake::with(|hal| hal.float("z.pos-fb"))
    }

    fn outlives_control(&self) -> bool {
        true
    }

    fn without_control(&mut self) {
        until_free();
    }

    fn vanish(&mut self) -> bool {
        if let Some(running) = self.running.take() {
            running.end();
        }
        true
    }

    /// A period of HAL's thread.
    fn delay(&self) -> Time {
        Time::s(PERIOD_S)
    }
}

#[test]
fn drives_of_hal_conform() {
    let _one = fake::one_at_a_time();
    let mut bench = InHal { folder: Folder::new(), running: Some(Running::start()) };
    conforms(&mut bench);
    bench.vanish();
}

#[test]
fn a_component_that_is_unloaded_stops_spindle_and_axis_on_the_thread_before() {
    let _one = fake::one_at_a_time();
    for depth in [101.0, 105.0, 109.0] {
        let running = Running::start();
        let control = tapping(None, depth);
        let beside = std::thread::Builder::new().spawn(|| rtapi_app_exit()).unwrap();
        beside.join().unwrap();
        let stands = fake::with(|hal| hal.float("z.pos-cmd"));
        assert!(stands < -100.9 && fake::with(|hal| hal.float("spindle.0.speed-cmd-rps")) == 0.0);
        drop(control);
        let off = off_thread(&running.end());
        assert!(off < 0.02, "{depth}: {off} mm off its thread");
    }
}

#[test]
fn a_spindle_that_is_told_an_angle_taps_on_its_helix_and_is_told_where_it_is_while_it_is_off() {
    let _one = fake::one_at_a_time();
    let running = Running::start_with(TakenBy::Angle);
    let mut control = home(control_on("servo-mill.toml", None).unwrap());
    asked(&mut control, &Request::ManualDataInput(format!("{TAP}\nM19 R90")));
    until(&mut control, |control| control.execution() == Execution::ProgramCompleted);
    until(&mut control, Control::is_at_standstill);
    let stands = fake::with(|hal| hal.float("spindle.0.pos-cmd"));
    assert!((stands - stands.floor() - 0.25).abs() < 1e-9, "{stands} rev");
    asked(&mut control, &Request::Power(false));
    until(&mut control, |_| !fake::with(|hal| hal.bit("spindle.0.enable")));
    let off = fake::with(|hal| (hal.float("spindle.0.pos-cmd"), hal.float("spindle.0.revs")));
    assert!((off.0 - off.1).abs() <= 1.0 / 4096.0, "{off:?}");
    drop(control);
    until_free();
    let places = running.end();
    let deepest = places.iter().map(|(z, _)| *z).fold(0.0, f64::min);
    assert!((deepest + 110.0).abs() < 1e-3, "{deepest}");
    let off = off_thread(&places);
    assert!(off < 1e-3, "{off} mm off its thread");
}

#[test]
fn an_axis_is_homed_to_the_index_mark_of_an_encoder_that_counts_from_it() {
    let _one = fake::one_at_a_time();
    let folder = Folder::new();
    let homing = "[axes.x.homing]\nmethod = \"switch-and-index\"\norder = 1\ndirection = \"+\"\nedge = \"off\"\nfast_mm_per_min = 3000\nslow_mm_per_min = 300\nreference_mm = -5\nswitch_mm = 2\npull_off_mm = 1\nindex_every_mm = 10\n";
    let mill = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines/hal/mill.toml");
    let text = std::fs::read_to_string(mill).unwrap();
    let absolute = "[axes.x.homing]\nmethod = \"absolute\"                   # mill.hal: pos-fb counts from machine zero\nreference_mm = 0\n";
    assert!(text.contains(absolute));
    std::fs::create_dir_all(&folder.0).unwrap();
    let path = folder.0.join("mill.toml");
    std::fs::write(&path, text.replace(absolute, homing)).unwrap();
    let running = Running::start();
    let mut control = home(control_at(path.to_str().unwrap(), None).unwrap());
    let slowest = 300.0 / 60.0 * PERIOD_S;
    for _ in 0..2 {
        // the mark that is let go of at 20 mm is at 13, and 1 mm behind it X stands
        let x = || fake::with(|hal| hal.float("x.pos-fb"));
        until(&mut control, Control::is_at_standstill);
        assert!((x() + 1.0).abs() < slowest, "{} mm from the mark", x());
        let shown = control.status().axes[0].machine;
        assert!((shown + 6.0).abs() < 1e-6, "{shown}");
        asked(&mut control, &Request::ManualDataInput("G53 G0 X-37".into()));
        until(&mut control, |control| control.execution() == Execution::ProgramCompleted);
        assert!((x() + 32.0).abs() < slowest, "pos-cmd counts from the mark: {}", x());
        asked(&mut control, &Request::Home(Some(canon::Axis::X)));
        until(&mut control, |control| !control.is_referencing() && control.is_homed_all());
    }
    drop(control);
    until_free();
    running.end();
}

#[test]
fn a_drive_that_orients_the_spindle_has_the_pins_of_linuxcnc() {
    let _one = fake::one_at_a_time();
    let hal = Hal::begin("leadscrew").unwrap();
    let mut pins = Pins::new(&hal, &crate::parameters::read().unwrap()).unwrap();
    let instantly = WriteTo {
        obeys_after: [Time::ZERO; bus::AXES],
        spindles_obey_after: [Time::ZERO; bus::SPINDLES],
        marks: shm::Marks::default(),
    };
    let mut write = |orient: Option<(f64, TurnDirection)>, locked: bool| {
        let mut command = Command::default();
        let orient = orient.map(|(at, direction)| Orientation { angle: Angle::deg(at), direction });
        command.spindles[0] =
            SpindleCommand { enable: true, orient, locked, ..SpindleCommand::default() };
        pins.write(&command, &Report::default(), &instantly);
        fake::with(|hal| {
            let bit = |name: &str| hal.bit(&format!("spindle.0.{name}"));
            let to = (hal.float("spindle.0.orient-angle"), hal.s32("spindle.0.orient-mode"));
            ((bit("orient"), bit("locked"), bit("brake")), to)
        })
    };
    let (shortest, on, back) =
        (TurnDirection::Shortest, TurnDirection::Forward, TurnDirection::Backward);
    assert_eq!(write(Some((-90.0, shortest)), false), ((true, false, false), (270.0, 0)));
    assert_eq!(write(Some((-90.0, shortest)), true), ((false, true, true), (270.0, 0)));
    assert_eq!(write(Some((10.0, on)), false).1, (10.0, 1));
    assert_eq!(write(Some((10.0, back)), false).1, (10.0, 2));
    assert_eq!(write(None, false).0, (false, false, false));
    fake::with(|hal| hal.set_bit("spindle.0.is-oriented", true));
    let said = pins.read(Time::ZERO).spindles[0];
    assert!(said.oriented && said.orient_fault == 0 && said.ready);
    pins.off();
    assert!(fake::with(|hal| hal.bit("spindle.0.brake") && !hal.bit("spindle.0.locked")));
}
