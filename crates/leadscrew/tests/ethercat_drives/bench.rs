//! A servo process that leads emulated drives, in a thread of this process.
use crate::ethercat_drives::wire::{Moment, Shared, Wire};
use control::drives::{DrivesChoice, simulated};
use control::job::{ProgramOptions, Session};
use control::operation::Request;
use control::{Control, ControlOptions, config};
use ethercat::{Master, Storage};
use leadscrew::MachineSource;
use leadscrew::ethercat::{
    DrivesReport, EmulatedMachine, EthercatDrives, Handover, expected_network, machine_drives,
};
use shm::{ServoProcess, ServoProcessOptions};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;
use tempfile::TempDir;
use test_support::drives::DrivesBench;
use units::Time;

const MILL: &str = include_str!("../../../../machines/ethercat/mill.toml");

/// The mill of machines/ethercat; a control is not taken for dead because this computer is busy:
/// time passes faster on the wire than on the wall.
pub(crate) fn mill() -> MachineSource {
    let text = MILL.replacen("silent_after_ms = 500", "silent_after_ms = 5000", 1);
    MachineSource { name: "mill.toml".into(), text: Some(text) }
}

/// The same, homed without motion: it begins from the same places each time.
pub(crate) fn encoders_are_absolute() -> MachineSource {
    let text = mill().text.unwrap();
    let text = text.replace("method = \"switch\"", "method = \"absolute\"");
    let text = text.replace("reference_mm = -7", "reference_mm = 0");
    MachineSource { name: "mill.toml".into(), text: Some(text) }
}

/// The same with a frame a millisecond, as most networks of drives have it.
pub(crate) fn of_a_millisecond() -> MachineSource {
    let mut text = mill().text.unwrap();
    let loops = "position_gain_per_s = 40\nvelocity_bandwidth_hz = 90";
    let changes = [
        ("[control]\n", "[control]\nperiod_us = 1000\n".to_owned()),
        ("cycle_us = 250", "cycle_us = 1000".into()),
        ("follows = \"command\"", "follows = \"command\"\nobserver_bandwidth_hz = 90".into()),
        ("[spindles.drive]", format!("[spindles.loops]\n{loops}\n[spindles.drive]")),
    ];
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, &to, 1);
    }
    MachineSource { name: "mill.toml".into(), text: Some(text) }
}

/// The bench.
pub(crate) struct OnWire {
    folder: TempDir,
    name: String,
    source: MachineSource,
    pub(crate) shared: Arc<Shared>,
    pub(crate) said: Arc<Mutex<Vec<String>>>,
    thread: Option<JoinHandle<()>>,
}

impl OnWire {
    pub(crate) fn start() -> Self {
        Self::of(mill())
    }

    pub(crate) fn of(source: MachineSource) -> Self {
        static BENCHES: AtomicUsize = AtomicUsize::new(0);
        let number = BENCHES.fetch_add(1, Relaxed);
        let name = format!("ethercat-{}-{number}", std::process::id());
        let session = Session::load(&ProgramOptions::on(&source), Path::new("-"), b"").unwrap();
        let file = session.machine.clone();
        let (material, zero) = (file.setup.stock.material, session.work_zero());
        let simulated = config::simulator(&file, &session.tools, material, 1, &zero);
        let simulated = simulated::switched_on(simulated);
        let machine = simulated::build_on_network(&file, simulated).unwrap();
        let emulated = EmulatedMachine::new(&file, machine).unwrap();
        let shared = Arc::<Shared>::default();
        let wire = Wire::new(emulated, Arc::clone(&shared));
        let said = Arc::<Mutex<Vec<String>>>::default();
        let options = ServoProcessOptions {
            name: name.clone(),
            machine: Some(file.name.clone()),
            axes: std::array::from_fn(|index| file.axes[index].is_some()),
            spindles: file.spindles.len(),
            not_called: "not called",
            axis_missing: |_| "there is none".into(),
            undriven: |names| format!("there is no {names}"),
        };
        let process = ServoProcess::new(Handover::default(), options).unwrap();
        let (told, hears) = (Arc::clone(&shared), Arc::clone(&said));
        let thread = std::thread::Builder::new().spawn(move || {
            let network = expected_network(&file).unwrap();
            let storage = Storage::new();
            let mut master = Master::new(&storage, &network).unwrap();
            let drives = machine_drives(&file).unwrap();
            let mut led = EthercatDrives::new(process, drives, &network, wire);
            let is_to_end = |_: &mut Wire| {
                Wire::breathe();
                told.stop.load(Relaxed)
            };
            let say = |report| {
                let text = match report {
                    DrivesReport::Leads => "leads".to_owned(),
                    DrivesReport::Notice(text) => text,
                };
                hears.lock().unwrap().push(text);
            };
            led.run(&mut master, is_to_end, say).unwrap();
        });
        let folder = tempfile::tempdir().unwrap();
        let bench = Self { folder, name, source, shared, said, thread: Some(thread.unwrap()) };
        bench.wait_for("all devices are in OP", |bench| bench.said.lock().unwrap().len() == 1);
        bench
    }

    pub(crate) fn wait_for(&self, what: &str, is_so: impl Fn(&Self) -> bool) {
        for _ in 0..60_000 {
            if is_so(self) {
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        panic!("waited in vain until {what}: {:?}", self.said.lock().unwrap());
    }

    /// Loses so many frames in the next tap, on the way to the devices or back.
    pub(crate) fn lose_in_tap(&self, before_devices: bool, frames: usize) {
        self.shared.loses_before.store(before_devices, Relaxed);
        self.shared.lose_in_tap.store(frames, Relaxed);
    }

    /// They are lost.
    pub(crate) fn has_lost(&self) -> bool {
        self.shared.lose_in_tap.load(Relaxed) == 0
    }

    /// What was recorded since the last call; recording goes on.
    pub(crate) fn moments(&self) -> Vec<Moment> {
        self.shared.records.store(true, Relaxed);
        std::mem::take(&mut *self.shared.moments.lock().unwrap())
    }
}

impl Drop for OnWire {
    fn drop(&mut self) {
        self.shared.stop.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            let ended = thread.join();
            assert!(std::thread::panicking() || ended.is_ok(), "{:?}", self.said.lock().unwrap());
        }
    }
}

impl DrivesBench for OnWire {
    fn options(&self) -> ControlOptions {
        ControlOptions {
            drives: format!("process:{}", self.name).parse::<DrivesChoice>().unwrap(),
            state: Some(self.folder.path().join("state")),
            ..ControlOptions::simulated(ProgramOptions::on(&self.source))
        }
    }

    fn of_another_machine(&self) -> Option<ControlOptions> {
        let state = Some(self.folder.path().join("of-another"));
        let program = ProgramOptions::on("tapping-center");
        Some(ControlOptions { program, state, ..self.options() })
    }

    fn z_mm(&self) -> f64 {
        f64::from_bits(self.shared.z_mm.load(Relaxed))
    }

    fn outlives_control(&self) -> bool {
        true
    }

    /// Half a second of the wire's time after the last drive was switched off.
    fn without_control(&mut self) {
        let began = self.shared.now_ns.load(Relaxed);
        self.wait_for("the drives are off", |bench| {
            let Shared { now_ns, led_ns, .. } = &*bench.shared;
            let since = began.max(led_ns.load(Relaxed));
            now_ns.load(Relaxed) > since + 500_000_000
        });
    }

    fn vanish(&mut self) -> bool {
        self.shared.vanishes.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join(); // it has unwound
        }
        true
    }

    fn delay(&self) -> Time {
        Time::s(5e-3)
    }
}

/// Longest that is waited for anything, machine time.
const LONGEST: Time = Time::s(60.0);

/// A control that has homed the machine.
pub(crate) fn homed(bench: &dyn DrivesBench) -> Control {
    let mut control = Control::new(bench.options()).unwrap_or_else(|why| panic!("{why}"));
    home(&mut control);
    control
}

pub(crate) fn home(control: &mut Control) {
    ask(control, &Request::Power(true));
    until(control, "drives are ready", |control| control.status().is_ready);
    ask(control, &Request::Home(None));
    until(control, "all axes are homed", |control| {
        control.is_homed_all() && !control.is_referencing() && control.is_at_standstill()
    });
}

pub(crate) fn ask(control: &mut Control, request: &Request) {
    if let Err(refused) = control.request(request) {
        panic!("{request:?} is refused: {refused}; alarms: {:?}", control.status().alarms);
    }
}

pub(crate) fn until(control: &mut Control, what: &str, mut is_so: impl FnMut(&Control) -> bool) {
    let end = control.now() + LONGEST;
    while !is_so(control) {
        assert!(control.now() < end, "waited in vain until {what}: {:#?}", control.status());
        for _ in 0..4 {
            control.period();
        }
    }
}
