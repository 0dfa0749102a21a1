//! Kernel and servo thread in a process of their own, behind the control's door for machines.
use bus::{Command, Feedback, Machine as _, Report};
use control::ControlOptions;
use control::config;
use control::drives::{DrivesChoice, simulated};
use control::job::{ProgramOptions, Session};
use shm::{Fieldbus, ServoProcess, ServoProcessOptions, WriteTo};
use sim::SimulatedMachine;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;
use tempfile::TempDir;
use test_support::drives::{DrivesBench, conforms};
use units::Time;

const MACHINE: &str = "vfd-mill";

/// The simulated machine in the place of a fieldbus, watched.
struct Watched {
    machine: SimulatedMachine,
    seen: Arc<Seen>,
}

#[derive(Default)]
struct Seen {
    z_mm: AtomicU64,
    is_led: AtomicBool,
    stop: AtomicBool,
}

impl Watched {
    fn exchange(&mut self, command: &Command, is_led: bool) {
        self.machine.exchange(command);
        let z = self.machine.truth().map(|truth| truth.axes[2].of_linear().value());
        self.seen.z_mm.store(z.unwrap_or(f64::NAN).to_bits(), Relaxed);
        self.seen.is_led.store(is_led, Relaxed);
    }
}

impl Fieldbus for Watched {
    fn read(&mut self, time: Time) -> Feedback {
        Feedback { time, ..*self.machine.feedback() }
    }

    fn write(&mut self, command: &Command, _: &Report, _: &WriteTo) {
        self.exchange(command, true);
    }

    fn off(&mut self) {
        let tool = self.machine.feedback().tool.unwrap_or(0);
        self.exchange(&Command { tool, ..Command::default() }, false);
    }

    /// Slower than the machine's time, which here passes faster than on the wall: a busy computer
    /// holds a control up, and that is not what is tested.
    fn now_ns(&self) -> i64 {
        (self.machine.feedback().time.value() * 1e9 / 16.0) as i64
    }
}

struct InAnotherProcess {
    folder: TempDir,
    name: String,
    seen: Arc<Seen>,
    thread: Option<JoinHandle<()>>,
}

impl InAnotherProcess {
    fn start() -> Self {
        let name = format!("test-{}", std::process::id());
        let session = Session::load(&ProgramOptions::on(MACHINE), Path::new("-"), b"").unwrap();
        let file = &session.machine;
        let (material, zero) = (file.setup.stock.material, session.work_zero());
        let simulated = config::simulator(file, &session.tools, material, 1, &zero);
        let machine = simulated::build(file, simulated::switched_on(simulated)).unwrap();
        let seen = Arc::<Seen>::default();
        let watched = Watched { machine, seen: Arc::clone(&seen) };
        let options = ServoProcessOptions {
            name: name.clone(),
            machine: Some(file.name.clone()),
            axes: std::array::from_fn(|index| file.axes[index].is_some()),
            spindles: file.spindles.len(),
            not_called: "not called",
            axis_missing: |_| "there is none".into(),
            undriven: |names| format!("no {names}"),
        };
        let mut process = ServoProcess::new(watched, options).unwrap();
        let period_ns = (file.control.period.value() * 1e9).round() as u64;
        let told = Arc::clone(&seen);
        let thread = std::thread::Builder::new().spawn(move || {
            while !told.stop.load(Relaxed) {
                process.update(period_ns);
                std::thread::sleep(Duration::from_micros(20)); // its time is the count of its periods
            }
        });
        let folder = tempfile::tempdir().unwrap();
        Self { folder, name, seen, thread: Some(thread.unwrap()) }
    }
}

impl DrivesBench for InAnotherProcess {
    fn options(&self) -> ControlOptions {
        ControlOptions {
            drives: format!("process:{}", self.name).parse::<DrivesChoice>().unwrap(),
            state: Some(self.folder.path().join("state")),
            ..ControlOptions::simulated(ProgramOptions::on(MACHINE))
        }
    }

    fn of_another_machine(&self) -> Option<ControlOptions> {
        let state = Some(self.folder.path().join("of-another"));
        Some(ControlOptions {
            program: ProgramOptions::on("tapping-center"),
            state,
            ..self.options()
        })
    }

    fn z_mm(&self) -> f64 {
        f64::from_bits(self.seen.z_mm.load(Relaxed))
    }

    fn outlives_control(&self) -> bool {
        true
    }

    fn without_control(&mut self) {
        for _ in 0..2000 {
            if !self.seen.is_led.load(Relaxed) {
                return;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("the drives are still led");
    }

    fn vanish(&mut self) -> bool {
        self.seen.stop.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
        true
    }

    fn delay(&self) -> Time {
        Time::s(5e-3)
    }
}

#[test]
fn drives_of_another_process_conform() {
    let mut bench = InAnotherProcess::start();
    conforms(&mut bench);
    bench.vanish();
}
