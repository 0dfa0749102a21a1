//! A simulated machine in this process.
use super::{Door, Drives, Opened, Opening};
use crate::{Refused, config};
use bus::EngagedTool;
use sim::{Faulty, SimulatedMachine};
use store::machine::MachineFile;
use units::Time;

/// A simulated machine, and the faults that come to it.
pub type Simulation = Faulty<SimulatedMachine>;

/// See the module's header.
pub const DOOR: Door = Door { name: "simulated", address: None, open };

/// A simulated machine that has just been switched on: where its axes stand is not known.
fn open(opening: &Opening<'_>) -> Result<Opened, Refused> {
    let Opening { machine, tools, material, seed, zero, .. } = *opening;
    let simulated = switched_on(config::simulator(machine, tools, material, seed, zero));
    let alone = config::left_alone(machine, &simulated);
    let simulated = Faulty::new(build(machine, simulated)?, &[], seed).left_alone(alone);
    Ok(Opened { drives: Box::new(simulated), welcome: None })
}

/// A machine of this configuration whose axes have just got power: where they stand is not known.
pub fn switched_on(config: sim::Config) -> sim::Config {
    sim::Config { power_on: sim::PowerOn::Unknown, ..config }
}

/// A machine in which nothing fails unless it is struck; the seed is that of faults which scatter.
pub fn drives(machine: SimulatedMachine, seed: u64) -> Box<dyn Drives> {
    Box::new(Faulty::new(machine, &[], seed))
}

/// A simulated machine of this file.
///
/// # Errors
/// It has numbers that no machine can have.
pub fn build(file: &MachineFile, config: sim::Config) -> Result<SimulatedMachine, Refused> {
    let network = file.ethercat.as_ref();
    let ahead = network.map_or(Time::ZERO, |of| file.control.period * of.obeys_after_periods);
    build_commanded(file, config, ahead)
}

/// The machine of this file behind a network that brings its setpoints, each for the end of the
/// period that follows.
///
/// # Errors
/// It has numbers that no machine can have.
pub fn build_on_network(
    file: &MachineFile,
    config: sim::Config,
) -> Result<SimulatedMachine, Refused> {
    build_commanded(file, sim::Config { command_delay: 0, ..config }, Time::ZERO)
}

fn build_commanded(
    file: &MachineFile,
    config: sim::Config,
    ahead: Time,
) -> Result<SimulatedMachine, Refused> {
    let bar = config::bar(file, &config);
    let measured = config::measured_torques(file, config.seed);
    let (bosses, setter) = config::touched(file, &config);
    let simulator = SimulatedMachine::new(config).map_err(|problems| {
        let problems = problems.join("; ");
        Refused::because(format!("the machine cannot be simulated: {problems}"))
    })?;
    let simulator =
        simulator.with_inputs(config::inputs(&file.simulation.inputs)).with_touched(bosses, setter);
    let simulator = simulator.with_measured_torque(&measured);
    let (axes, spindles) = config::position_drives(file, ahead);
    let simulator = simulator.with_position_drives(&axes, &spindles);
    let simulator = match bar {
        Some(bar) => simulator.with_bar(bar),
        None => simulator,
    };
    let simulator = match config::plain_drive(file) {
        Some(drive) => simulator.with_plain_drive(drive),
        None => simulator,
    };
    let simulator = match file.simulation.tap_mishaps {
        Some(mishaps) => simulator.with_mishaps(sim::Mishaps {
            packing: mishaps.packing,
            packed_from: mishaps.packed_from,
            packed_rise: mishaps.packed_rise,
            crack: mishaps.crack,
            cracked_strength: mishaps.cracked_strength,
        }),
        None => simulator,
    };
    Ok(match file.simulation.tap_wear {
        Some(wear) => simulator.with_tap_wear(sim::TapWear {
            life: wear.life,
            rise: wear.rise_share,
            scatter: wear.scatter_share,
        }),
        None => simulator,
    })
}

impl Drives for Simulation {
    fn engage(&mut self, _: Option<EngagedTool>) {}

    fn renew_tool(&mut self, number: u32) {
        self.machine_mut().renew_tool(number);
    }

    fn lost(&self) -> Option<String> {
        None
    }

    fn outlives_control(&self) -> bool {
        false
    }

    fn simulation(&self) -> Option<&Simulation> {
        Some(self)
    }

    fn simulation_mut(&mut self) -> Option<&mut Simulation> {
        Some(self)
    }
}
