//! A machine simulator in another process, behind the control's door for machines.
use control::ControlOptions;
use control::drives::DrivesChoice;
use control::job::ProgramOptions;
use leadscrew::simulator::{SimulatorOptions, SimulatorProcess, order};
use std::path::PathBuf;
use std::thread::JoinHandle;
use tempfile::TempDir;
use test_support::drives::{DrivesBench, conforms};
use units::Time;
use wire::Order;

struct Simulator {
    folder: TempDir,
    thread: Option<JoinHandle<()>>,
}

impl Simulator {
    fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let options = SimulatorOptions {
            source: ProgramOptions::on("tapping-center"),
            material: None,
            seed: None,
            real_time: false,
            power_cuts: Vec::new(),
            on_link_loss: None,
            on_power_loss: None,
            single_turn: false,
            serial: 1,
            epoch: None,
        };
        let simulator = SimulatorProcess::new(&options).unwrap();
        let listening = simulator.listen(&folder.path().join("simulator")).unwrap();
        let thread = std::thread::Builder::new().spawn(|| listening.serve(|_| ())).unwrap();
        Self { folder, thread: Some(thread) }
    }

    fn socket(&self) -> PathBuf {
        self.folder.path().join("simulator")
    }

    fn status(&self) -> serde_json::Value {
        serde_json::from_str(&order(&self.socket(), Order::Status).unwrap()).unwrap()
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        self.vanish();
    }
}

impl DrivesBench for Simulator {
    fn options(&self) -> ControlOptions {
        ControlOptions {
            drives: DrivesChoice::simulator(self.socket()),
            state: Some(self.folder.path().join("state")),
            ..ControlOptions::simulated(ProgramOptions::on("tapping-center"))
        }
    }

    fn of_another_machine(&self) -> Option<ControlOptions> {
        let state = Some(self.folder.path().join("of-another"));
        Some(ControlOptions { program: ProgramOptions::on("vfd-mill"), state, ..self.options() })
    }

    fn z_mm(&self) -> f64 {
        self.status()["z_mm"].as_f64().unwrap()
    }

    fn outlives_control(&self) -> bool {
        true
    }

    /// It has run down by itself when it answers.
    fn without_control(&mut self) {
        self.status();
    }

    fn vanish(&mut self) -> bool {
        let Some(thread) = self.thread.take() else { return true };
        order(&self.socket(), Order::Quit).unwrap();
        thread.join().unwrap();
        true
    }

    fn delay(&self) -> Time {
        Time::s(1e-3)
    }
}

#[test]
fn a_machine_simulator_conforms() {
    conforms(&mut Simulator::start());
}
