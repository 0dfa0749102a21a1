//! HAL's thread for tests: drives that are where they were told to be a period ago, a spindle with
//! ramps of its own, a closed emergency stop chain; and controls that lead them.
#![allow(clippy::unwrap_used)] // a test may panic
use crate::{fake, rtapi_app_exit, rtapi_app_main};
use canon::Position;
use control::job::ProgramOptions;
use control::operation::Request;
use control::{Control, ControlOptions};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use units::Time;

/// Ramps of the converter, rev/s².
pub(crate) const RAMP: f64 = 66.7;
pub(crate) const PERIOD_S: f64 = 1e-3;

/// HAL's thread, with drives that are where they were told to be a period ago.
pub(crate) struct Running {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    places: Arc<Mutex<Vec<ZAndTurns>>>,
}

/// Z, mm, and the turns of the spindle, after a period.
pub(crate) type ZAndTurns = (f64, f64);

/// What the spindle's drive is told.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum TakenBy {
    Speed,
    Angle,
}

impl Running {
    pub(crate) fn start() -> Self {
        Self::start_with(TakenBy::Speed)
    }

    pub(crate) fn start_with(drive: TakenBy) -> Self {
        let running = Self::start_unwired(drive);
        fake::with(|hal| {
            hal.link("estop-ok", 1);
            hal.set_bit("estop-ok", true);
        });
        running
    }

    /// Without an emergency stop chain.
    pub(crate) fn start_unwired(drive: TakenBy) -> Self {
        assert_eq!(rtapi_app_main(), 0, "{:?}", fake::with(|hal| hal.said.clone()));
        let stop = Arc::new(AtomicBool::new(false));
        let (told, places) = (Arc::clone(&stop), Arc::new(Mutex::new(Vec::new())));
        let seen = Arc::clone(&places);
        let thread = std::thread::Builder::new().spawn(move || {
            let (mut speed, mut turned) = (0.0_f64, 0.0);
            let mut encoder = MarkedEncoder::default();
            while !told.load(Relaxed) && fake::call(1_000_000) {
                fake::with(|hal| {
                    encoder.follow(hal);
                    for axis in ["y", "z"] {
                        hal.set_float(
                            &format!("{axis}.pos-fb"),
                            hal.float(&format!("{axis}.pos-cmd")),
                        );
                    }
                    let most = RAMP * PERIOD_S;
                    let wanted = hal.float("spindle.0.speed-cmd-rps");
                    speed += (wanted - speed).clamp(-most, most);
                    turned += speed * PERIOD_S;
                    if drive == TakenBy::Angle {
                        turned = hal.float("spindle.0.pos-cmd");
                    }
                    hal.set_float("spindle.0.revs", (turned * 4096.0).floor() / 4096.0);
                    hal.set_bit("tool-changed", hal.bit("tool-change"));
                    let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
                    seen.push((hal.float("z.pos-fb"), turned));
                });
                std::thread::sleep(Duration::from_micros(300)); // HAL's time is the count of its calls
            }
        });
        Self { stop, thread: Some(thread.unwrap()), places }
    }

    /// Where everything has been since the last time.
    pub(crate) fn take_places(&self) -> Vec<ZAndTurns> {
        std::mem::take(&mut self.places.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The thread stops, and the component is unloaded; where everything has been.
    pub(crate) fn end(mut self) -> Vec<ZAndTurns> {
        self.stop.store(true, Relaxed);
        self.thread.take().unwrap().join().unwrap();
        rtapi_app_exit();
        self.take_places()
    }
}

/// X with its encoder, which counts from its index mark when it is asked to, and its home switch:
/// mm from where it was switched on.
#[derive(Default)]
struct MarkedEncoder {
    place: f64,
    zero: f64,
}

/// Marks of X are so far apart, the first one here.
const MARKS: (f64, f64) = (10.0, 3.0);
/// From here on the home switch of X is actuated.
const SWITCH: f64 = 20.0;

impl MarkedEncoder {
    /// The drive is where it was commanded to be.
    fn follow(&mut self, hal: &mut fake::Asked) {
        let before = self.place;
        self.place = self.zero + hal.float("x.pos-cmd");
        let number = |place: f64| ((place - MARKS.1) / MARKS.0).floor() as i32;
        if hal.bit("x.index-enable") && number(before) != number(self.place) {
            self.zero = MARKS.0 * f64::from(number(before).max(number(self.place))) + MARKS.1;
            hal.set_bit("x.index-enable", false);
        }
        hal.set_bit("x.home-sw", self.place > SWITCH);
        hal.set_float("x.pos-fb", self.place - self.zero);
    }
}

/// How far Z was off the thread of 1 mm that begins at Z-100, in the material that begins half a
/// millimetre below.
pub(crate) fn off_thread(places: &[ZAndTurns]) -> f64 {
    let inside = places.iter().filter(|(z, _)| *z < -100.5).map(|(z, turns)| z + turns);
    let (low, high) =
        inside.fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at), high.max(at)));
    (high - low) / 2.0
}

pub(crate) fn control() -> Result<Control, control::Refused> {
    control_of(None)
}

/// With its state in a folder.
pub(crate) fn control_of(state: Option<&Path>) -> Result<Control, control::Refused> {
    control_on("mill.toml", state)
}

/// Of a machine of `machines/hal`.
pub(crate) fn control_on(machine: &str, state: Option<&Path>) -> Result<Control, control::Refused> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines/hal/");
    control_at(&format!("{folder}{machine}"), state)
}

/// Of a machine whose file is here.
pub(crate) fn control_at(machine: &str, state: Option<&Path>) -> Result<Control, control::Refused> {
    Control::new(ControlOptions {
        program: ProgramOptions::on(machine),
        seed: None,
        state: state.map(Path::to_owned),
        drives: control::DrivesChoice::of(&control::drives::hal::DOOR),
        clamped: Position::default(),
        real_time: None,
    })
}

pub(crate) fn asked(control: &mut Control, request: &Request) {
    if let Err(refused) = control.request(request) {
        panic!("{request:?}: {refused}");
    }
}

pub(crate) fn until(control: &mut Control, mut is_so: impl FnMut(&Control) -> bool) {
    let end = control.now() + Time::s(120.0);
    while !is_so(control) {
        assert!(control.now() < end, "{:#?}", control.status());
        control.period();
        control.answer_panel();
    }
}

pub(crate) fn homed() -> Control {
    homed_of(None)
}

pub(crate) fn homed_of(state: Option<&Path>) -> Control {
    home(control_of(state).unwrap())
}

pub(crate) fn home(mut control: Control) -> Control {
    asked(&mut control, &Request::Power(true));
    until(&mut control, |control| control.status().is_ready);
    asked(&mut control, &Request::Home(None));
    until(&mut control, Control::is_homed_all);
    control
}

/// The component has let go of its control.
pub(crate) fn until_free() {
    for _ in 0..1000 {
        if !fake::with(|hal| hal.bit("connected")) {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("the component is still led");
}

pub(crate) const TAP: &str = "T3 M6\nG91 G0 Z-100\nS1000 M3\nG33.1 Z-10 K1";

/// A tap that has come so deep.
pub(crate) fn tapping(state: Option<&Path>, depth: f64) -> Control {
    let mut control = homed_of(state);
    asked(&mut control, &Request::ManualDataInput(TAP.into()));
    until(&mut control, |_| fake::with(|hal| hal.float("z.pos-fb")) < -depth);
    control
}

/// An empty folder, which is gone afterwards.
pub(crate) struct Folder(pub(crate) std::path::PathBuf);

impl Folder {
    pub(crate) fn new() -> Self {
        let path = std::env::temp_dir().join(format!("leadscrew-hal-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
