//! The iron: axes, spindles, magazine and workpiece for the simulator.
use canon::{Flute, Holder, Position, Tool, ToolKind, ToolLibrary};
use store::machine::{
    Axis, MachineFile, Material, Motor, PositionFrom, Reaction, Spindle, TapSeat,
};
use units::{Angle, Inertia, Lead, Length};

/// Screw lead that stands in for a linear motor: one radian a millimetre, so that N·m and N agree by 10³.
const DIRECT_LEAD: Lead = Lead::mm_per_rev(std::f64::consts::TAU);

/// A simulated machine of this file, with these tools in its magazine and nothing in its spindle; the stock is
/// clamped at `zero`.
pub(crate) fn simulator(
    machine: &MachineFile,
    tools: &ToolLibrary,
    material: Material,
    seed: u64,
    zero: &Position,
) -> sim::Config {
    let axes = machine.axes.iter().enumerate();
    let spindles = machine.spindles.iter().map(spindle).collect();
    let stock = machine.setup.stock;
    sim::Config {
        period: machine.control.period,
        substep: machine.simulation.substep,
        command_delay: machine.control.command_delay_periods as usize,
        axes: axes.filter_map(|(at, file)| Some((at, axis(file.as_ref()?)))).collect(),
        spindles,
        magazine: tools
            .iter()
            .filter(|t| t.number != 0) // 0 stands for an empty spindle
            .map(|t| tool(t, &machine.simulation.tap_seat, material))
            .collect(),
        tool: 0,
        tool_change_time: machine.tool_change.time,
        stock: Some(sim::Stock {
            top: zero.linear[2] + stock.to[2],
            thickness: Some(stock.to[2] - stock.from[2]),
            sides: Some(sim::Sides {
                x_from: zero.linear[0] + stock.from[0],
                x_to: zero.linear[0] + stock.to[0],
                y_from: zero.linear[1] + stock.from[1],
                y_to: zero.linear[1] + stock.to[1],
            }),
            material: sim::Material { cutting_n_per_mm2: material.cutting_force_n_per_mm2 },
            holes: Vec::new(),
            assume_predrilled: true,
        }),
        scatter: machine.simulation.scatter_share,
        seed,
    }
}

/// What the drives of that machine do by themselves.
pub(crate) fn left_alone(machine: &MachineFile, config: &sim::Config) -> sim::LeftAlone {
    let drives = &machine.drives;
    sim::LeftAlone {
        config: config.clone(),
        watchdog: drives.watchdog,
        on_silence: reaction(drives.on_link_loss),
        on_power_loss: reaction(drives.on_power_loss),
        bus: drives.bus.map(|bus| sim::Bus {
            farad: bus.capacitance_f,
            volt: bus.voltage_v,
            trip_volt: bus.trip_v,
        }),
    }
}

const fn reaction(file: Reaction) -> sim::Reaction {
    match file {
        Reaction::Off => sim::Reaction::Off,
        Reaction::Coast => sim::Reaction::Coast,
        Reaction::QuickStop => sim::Reaction::QuickStop,
        Reaction::CoupledStop => sim::Reaction::CoupledStop,
    }
}

fn axis(file: &Axis) -> sim::AxisModel {
    let (screw_lead, inertia) = match file.drive.motor {
        Motor::BallScrew { lead, rotating_inertia, .. } => (lead, rotating_inertia),
        Motor::Linear { motor_mass, .. } => {
            // J = m·(lead/2π)², with the lead in metres
            (DIRECT_LEAD, Inertia::kg_m2(motor_mass.value() * 1e-6))
        }
    };
    let metres_per_rad = screw_lead.value() * 1e-3 / std::f64::consts::TAU;
    let friction = &file.friction;
    sim::AxisModel {
        table: file.moving_mass,
        inertia,
        screw_lead: screw_lead * Angle::rev(1.0),
        peak_torque: units::Torque::n_m(file.drive.peak_force().value() * metres_per_rad),
        force_lag: file.drive.force_lag,
        stiffness: file.structure.stiffness,
        damping_ratio: file.structure.damping_ratio,
        backlash: file.structure.backlash,
        friction: sim::Lugre {
            bristle_stiffness: friction.bristle_stiffness,
            bristle_damping_n_s_per_m: friction.bristle_damping_n_s_per_m,
            viscous_n_s_per_m: friction.viscous_n_s_per_m,
            coulomb: friction.coulomb,
            breakaway: friction.static_force,
            stribeck: friction.stribeck_speed,
        },
        weight_share: file.weight_share,
        brake: file.drive.brake,
        encoder: match file.position_from {
            PositionFrom::Motor { counts_per_rev, .. } => {
                sim::AxisEncoder::Motor { counts_per_rev }
            }
            PositionFrom::Scale { resolution, motor } => sim::AxisEncoder::Scale {
                resolution,
                motor_counts_per_rev: motor.map(|(counts, _)| counts),
            },
        },
        start: start(file),
    }
}

/// Where an axis stands when the machine is switched on: at machine zero, or as near as its travel allows.
pub(crate) fn start(file: &Axis) -> Length {
    Length::ZERO.max(file.travel.from).min(file.travel.to)
}

fn spindle(file: &Spindle) -> sim::SpindleModel {
    sim::SpindleModel {
        inertia: file.inertia,
        peak_torque: file.peak_torque,
        peak_power: file.peak_power,
        torque_lag: file.torque_lag,
        coulomb: file.friction.coulomb,
        viscous_n_m_s_per_rad: file.friction.viscous_n_m_s_per_rad,
        rounding: file.friction.smoothing,
        encoder: sim::SpindleEncoder {
            counts_per_rev: file.encoder_counts_per_rev,
            eccentricity: Angle::ZERO,
            noise_counts: 0.0,
        },
        start: Angle::ZERO,
    }
}

/// The drive of the first spindle, if it makes its own ramps: as its file says, but for what the simulation knows
/// better.
pub(crate) fn plain_drive(machine: &MachineFile) -> Option<sim::PlainDrive> {
    let own = machine.spindles.first()?.own_ramps?;
    let real = machine.simulation.spindle_drive;
    Some(sim::PlainDrive {
        delay: own.delay,
        delay_scatter: real.delay_scatter,
        accel: own.acceleration,
        decel: own.deceleration * real.deceleration_share,
        ramp_scatter: real.ramp_scatter_share,
        speed_scatter: real.speed_scatter_share,
    })
}

fn tool(tool: &Tool, seat: &TapSeat, material: Material) -> sim::Tool {
    let kind = match &tool.kind {
        ToolKind::Drill { point_angle } | ToolKind::SpotDrill { point_angle } => {
            sim::ToolKind::Drill { diameter: tool.diameter, point_angle: *point_angle }
        }
        ToolKind::Tap(tap) => sim::ToolKind::Tap(sim::Tap {
            diameter: tool.diameter,
            lead: tap.lead,
            chamfer_pitches: tap.chamfer_pitches,
            flute_factor: flute_factor(tap.flute, material),
            thread_length: tap.thread_length,
            flank_play: seat.flank_clearance,
            flank_stiffness: seat.flank_stiffness,
            holder: holder(tap.holder),
            clutch: clutch(tap.holder),
        }),
        ToolKind::EndMill | ToolKind::PolygonCutter(_) | ToolKind::Other => sim::ToolKind::Other,
    };
    sim::Tool { number: tool.number, length: tool.length, kind }
}

/// Torque of a flute form over the formula's (tap makers' tables).
fn flute_factor(flute: Flute, material: Material) -> f64 {
    let aluminium = material.name == "AlSi";
    match flute {
        Flute::SpiralFlute if aluminium => 1.05,
        Flute::SpiralFlute => 1.15,
        Flute::SpiralPoint => 0.95,
        Flute::Straight => 1.35,
    }
}

fn holder(holder: Holder) -> sim::Holder {
    match holder {
        Holder::Rigid { stiffness } | Holder::Clutch { stiffness, .. } => {
            sim::Holder { stiffness, travel: None }
        }
        Holder::SoftSynchro { stiffness, travel }
        | Holder::TensionCompression { stiffness, travel } => {
            sim::Holder { stiffness, travel: Some(travel) }
        }
    }
}

/// What lets go of a tap in a clutch holder.
fn clutch(holder: Holder) -> Option<sim::Clutch> {
    match holder {
        Holder::Clutch { spline_length, pawl_backlash, compression, .. } => {
            Some(sim::Clutch { spline_length, pawl_backlash, compression })
        }
        Holder::Rigid { .. } | Holder::SoftSynchro { .. } | Holder::TensionCompression { .. } => {
            None
        }
    }
}
