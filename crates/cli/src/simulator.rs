//! `leadscrew simulator`: the machine simulator as a process of its own, and orders to one that
//! listens.
use crate::args::SimulatorArgs;
use crate::{interrupt, say};
use control::Refused;
#[cfg(target_os = "linux")]
use leadscrew::ethercat::{EmulatedDrivesOptions, emulate_drives};
use leadscrew::simulator::{SimulatorOptions, SimulatorProcess, order};
use units::Time;
use wire::Order;

/// Listen, or give an order to the machine simulator that listens.
pub(crate) fn command(args: &SimulatorArgs) -> Result<(), Refused> {
    let orders = [
        (&args.status, Order::Status),
        (&args.power_cut, Order::PowerCut),
        (&args.quit, Order::Quit),
    ];
    for (path, what) in orders {
        if let Some(path) = path {
            return say::out(&format!("{}\n", order(path, what)?));
        }
    }
    if let Some(interface) = &args.ethercat {
        return emulate(args, interface);
    }
    let Some(path) = &args.listen else {
        return Err(Refused::because("leadscrew simulator: expected --listen PATH"));
    };
    let listening = SimulatorProcess::new(&options(args))?.listen(path)?;
    say::out(&format!("listening at {}: {}\n", path.display(), listening.name()))?;
    listening.serve(|why| say::err(&format!("a control is gone: {why}\n")));
    Ok(())
}

/// Answer frames on a network interface until Ctrl-C.
#[cfg(target_os = "linux")]
fn emulate(args: &SimulatorArgs, interface: &str) -> Result<(), Refused> {
    interrupt::watch()?;
    let options = EmulatedDrivesOptions {
        source: args.source.on_a_machine(),
        seed: args.seed,
        interface: interface.to_owned(),
        priority: args.priority,
    };
    let mut unsaid = Ok(());
    emulate_drives(&options, interrupt::flag(), |machine, refused| {
        for sentence in refused {
            say::err(&format!("{sentence}\n"));
        }
        unsaid = say::out(&format!("answers on {interface} as the drives of {machine}\n"));
    })?;
    unsaid
}

#[cfg(not(target_os = "linux"))]
fn emulate(_: &SimulatorArgs, _: &str) -> Result<(), Refused> {
    Err(Refused::because("drives on a network are emulated on Linux alone"))
}

fn options(args: &SimulatorArgs) -> SimulatorOptions {
    let times = |seconds: &[f64]| seconds.iter().copied().map(Time::s).collect();
    SimulatorOptions {
        source: args.source.on_a_machine(),
        material: args.material.clone(),
        seed: args.seed,
        real_time: args.real_time,
        power_cuts: times(&args.power_cut_at),
        on_link_loss: args.on_link_loss,
        on_power_loss: args.on_power_loss,
        single_turn: args.single_turn,
        serial: args.serial,
        epoch: args.epoch,
    }
}
