//! The component between a HAL that is none and a control that is one: ideal drives, a spindle with ramps of its own.
#![allow(clippy::unwrap_used)] // a test may panic
use crate::{fake, rtapi_app_exit, rtapi_app_main};
use canon::Position;
use control::job::ProgramOptions;
use control::operation::{Execution, Request};
use control::{Control, ControlOptions};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;
use units::Time;

/// Ramps of the converter, rev/s².
const RAMP: f64 = 66.7;
const PERIOD_S: f64 = 1e-3;

/// HAL's thread, with drives that are where they were told to be a period ago.
struct Running {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<f64>>,
}

impl Running {
    fn start() -> Self {
        assert_eq!(rtapi_app_main(), 0, "{:?}", fake::with(|hal| hal.said.clone()));
        let stop = Arc::new(AtomicBool::new(false));
        let told = Arc::clone(&stop);
        let thread = std::thread::Builder::new().spawn(move || {
            let (mut speed, mut turned, mut deepest) = (0.0_f64, 0.0, 0.0_f64);
            while !told.load(Relaxed) && fake::call(1_000_000) {
                fake::with(|hal| {
                    for axis in ["x", "y", "z"] {
                        hal.set_float(
                            &format!("{axis}.pos-fb"),
                            hal.float(&format!("{axis}.pos-cmd")),
                        );
                    }
                    let most = RAMP * PERIOD_S;
                    let wanted = hal.float("spindle.0.speed-cmd-rps");
                    speed += (wanted - speed).clamp(-most, most);
                    turned += speed * PERIOD_S;
                    hal.set_float("spindle.0.revs", (turned * 4096.0).floor() / 4096.0);
                    hal.set_bit("tool-changed", hal.bit("tool-change"));
                    deepest = deepest.min(hal.float("z.pos-fb"));
                });
                std::thread::sleep(Duration::from_micros(300)); // HAL's time is the count of its calls
            }
            deepest
        });
        Self { stop, thread: Some(thread.unwrap()) }
    }

    /// The thread stops, and the component is unloaded; how deep Z has been.
    fn end(mut self) -> f64 {
        self.stop.store(true, Relaxed);
        let deepest = self.thread.take().unwrap().join().unwrap();
        rtapi_app_exit();
        deepest
    }
}

fn control() -> Result<Control, control::Refused> {
    let mill = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines/hal/mill.toml");
    Control::new(ControlOptions {
        program: ProgramOptions::on(mill),
        seed: None,
        state: None,
        simulator: None,
        hal: true,
        clamped: Position::default(),
        real_time: None,
    })
}

fn asked(control: &mut Control, request: &Request) {
    if let Err(refused) = control.request(request) {
        panic!("{request:?}: {refused}");
    }
}

fn until(control: &mut Control, mut is_so: impl FnMut(&Control) -> bool) {
    let end = control.now() + Time::s(120.0);
    while !is_so(control) {
        assert!(control.now() < end, "{:#?}", control.status());
        control.period();
    }
}

fn homed() -> Control {
    let mut control = control().unwrap();
    asked(&mut control, &Request::Power(true));
    until(&mut control, |control| control.status().is_ready);
    asked(&mut control, &Request::Home(None));
    until(&mut control, Control::is_homed_all);
    control
}

/// All of it in one test: HAL has one component of this name at a time.
#[test]
fn a_control_taps_through_the_component_and_what_ends_leaves_the_other_running() {
    let _one = fake::one_at_a_time();
    let why = control().err().unwrap().to_string();
    assert!(why.contains("no HAL component named default is loaded"), "{why}");

    let running = Running::start();
    fake::with(|hal| {
        let names = hal.names();
        for name in
            ["x.pos-cmd", "z.limit-neg", "spindle.0.revs", "estop-in", "din-03", "tool-number"]
        {
            assert!(names.contains(&format!("leadscrew.{name}").as_str()), "{name}");
        }
    });

    // a tap, 10 mm deep below where Z stands, with a spindle that is only told a speed
    let mut first = homed();
    let why = control().err().unwrap().to_string();
    assert!(why.contains("another control leads the HAL component"), "{why}");
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

    // another control takes the machine over; its component is unloaded under it, and the control says so
    let mut second = homed();
    let deepest = running.end();
    assert!(deepest < -99.0 && deepest > -111.0, "{deepest}");
    let end = second.now() + Time::s(30.0);
    while !second.status().alarms.iter().any(|alarm| alarm.contains("412")) {
        assert!(second.now() < end, "{:#?}", second.status());
        second.period();
    }
}

/// The component has let go of its control.
fn until_free() {
    for _ in 0..1000 {
        if !fake::with(|hal| hal.bit("connected")) {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("the component is still led");
}
