//! The simulated machine in the control's own process behind the door for machines.
use bus::EngagedTool;
use bus::{Command, Feedback, Machine, Truth};
use control::drives::{Door, Drives, DrivesChoice, Opened, Opening, Simulation, simulated};
use control::job::ProgramOptions;
use control::{ControlOptions, Refused};
use std::cell::Cell;
use test_support::drives::{DrivesBench, conforms};
use units::Time;

thread_local! {
    /// Where Z of the plant is, mm.
    static Z: Cell<f64> = const { Cell::new(0.0) };
}

/// A simulated machine whose plant is watched.
struct Watched(Box<dyn Drives>);

static WATCHED: Door = Door { name: "watched", address: None, open };

fn open(opening: &Opening<'_>) -> Result<Opened, Refused> {
    let Opened { drives, welcome } = (simulated::DOOR.open)(opening)?;
    Ok(Opened { drives: Box::new(Watched(drives)), welcome })
}

impl Machine for Watched {
    fn period(&self) -> Time {
        self.0.period()
    }

    fn feedback(&self) -> &Feedback {
        self.0.feedback()
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        self.0.exchange(command);
        let z = self.0.truth().map(|truth| truth.axes[2].of_linear().value());
        Z.set(z.unwrap_or(f64::NAN));
        self.0.feedback()
    }

    fn truth(&self) -> Option<&Truth> {
        self.0.truth()
    }
}

impl Drives for Watched {
    fn engage(&mut self, tool: Option<EngagedTool>) {
        self.0.engage(tool);
    }

    fn renew_tool(&mut self, number: u32) {
        self.0.renew_tool(number);
    }

    fn lost(&self) -> Option<String> {
        self.0.lost()
    }

    fn outlives_control(&self) -> bool {
        self.0.outlives_control()
    }

    fn simulation(&self) -> Option<&Simulation> {
        self.0.simulation()
    }

    fn simulation_mut(&mut self) -> Option<&mut Simulation> {
        self.0.simulation_mut()
    }
}

struct InThisProcess;

impl DrivesBench for InThisProcess {
    fn options(&self) -> ControlOptions {
        ControlOptions {
            drives: DrivesChoice::of(&WATCHED),
            ..ControlOptions::simulated(ProgramOptions::on("tapping-center"))
        }
    }

    fn of_another_machine(&self) -> Option<ControlOptions> {
        None
    }

    fn z_mm(&self) -> f64 {
        Z.get()
    }

    fn outlives_control(&self) -> bool {
        false
    }

    fn without_control(&mut self) {}

    fn vanish(&mut self) -> bool {
        false
    }

    fn delay(&self) -> Time {
        Time::s(1e-3)
    }
}

#[test]
fn a_simulated_machine_conforms() {
    conforms(&mut InThisProcess);
}

#[test]
fn a_kind_is_chosen_by_its_name_and_its_address() {
    let chosen =
        |text: &str| text.parse::<DrivesChoice>().map(|choice| (choice.door.name, choice.address));
    assert_eq!(chosen("hal"), Ok(("hal", None)));
    assert_eq!(chosen("simulated"), Ok(("simulated", None)));
    assert_eq!(chosen("simulator:/tmp/s"), Ok(("simulator", Some("/tmp/s".into()))));
    for wrong in ["", "hall", "hal:x", "simulator", "simulator:"] {
        let why = chosen(wrong).err();
        assert_eq!(
            why.as_deref(),
            Some("expected simulated, simulator:PATH, process:NAME, hal"),
            "{wrong}"
        );
    }
}
