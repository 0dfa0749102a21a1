//! What the planner may ask of the machine.
use canon::PathMode;
use plan::{
    AxisLimits, Effort, Joining, MachineLimits, OwnRamps, Retract, SpindleLimits, Tapping,
    ToolChange,
};
use store::machine::{Axis, Follows, MachineFile, Peck, Spindle};
use units::{Force, Time};

/// Share of an axis drive's force that plans may use: the rest is for the cut and for control.
const PLANNED_SHARE: f64 = 0.9;

/// Limits from the machine's file. An axis' acceleration is what its file says, but never more than
/// the share of its drive's force that plans may use, less its weight, can give.
pub fn planner(machine: &MachineFile) -> MachineLimits {
    let windows = machine.axes.iter().flatten().map(|axis| axis.windows.settle);
    MachineLimits {
        axes: machine.axes.each_ref().map(|file| file.as_ref().map(axis)),
        spindles: machine.spindles.iter().map(spindle).collect(),
        tool_change: ToolChange {
            z: Some(machine.tool_change.z),
            x: machine.tool_change.x,
            y: machine.tool_change.y,
            pockets: machine.tool_change.pockets,
            // a sequence's steps have their own times
            time: match machine.tool_change_sequence {
                Some(_) => Time::ZERO,
                None => machine.tool_change.time,
            },
        },
        settling: windows.fold(Time::ZERO, Time::max),
        tapping: tapping(machine),
        joining: joining(machine),
        signals: Some(signals(machine)),
    }
}

/// The signals that the machine's file names.
fn signals(machine: &MachineFile) -> plan::SignalNames {
    let names = |names: &store::machine::Names| [names.digital.clone(), names.analogue.clone()];
    plan::SignalNames {
        inputs: names(&machine.inputs),
        outputs: names(&machine.outputs),
        probe: machine.probe.is_some(),
    }
}

/// Exactly along the path, unless the file says otherwise.
fn joining(machine: &MachineFile) -> Joining {
    let period = machine.control.period;
    let Some(path) = machine.control.path else { return Joining { period, ..Joining::EXACT } };
    let blend = PathMode::Blend { tolerance: None, merge: None };
    let mode = if path.blends { blend } else { PathMode::Exact };
    Joining { period, tolerance: path.tolerance, mode }
}

/// The preset in force, and what a peck does. A feed that only follows the spindle's encoder leaves
/// the thread to find its phase again, so there a peck always comes out in full.
fn tapping(machine: &MachineFile) -> Tapping {
    let file = &machine.tapping;
    let standard = machine.spindles.first().map_or(1.0, |spindle| spindle.planned_share);
    let effort = file.effort(file.preset, standard);
    let share = |margin| Effort { margin, jerk: effort.jerk_share };
    let follows_encoder = machine.control.synchronisation.follows == Follows::Encoder;
    Tapping {
        axis: canon::Axis::Z,
        retract: match file.peck {
            Peck::ChipBreak(back) if !follows_encoder => Retract::By(back),
            Peck::Full | Peck::ChipBreak(_) => Retract::Full,
        },
        inward: share(effort.planned_share),
        outward: share(effort.return_planned_share),
        own_ramps: machine.spindles.first().and_then(|spindle| spindle.own_ramps).map(own_ramps),
        coasts: coasts(&machine.drives),
    }
}

/// When a spindle is left to coast. A DC bus pays for braking where there is one, unless the
/// outputs are off.
pub(super) fn coasts(drives: &store::machine::Drives) -> plan::Coasts {
    use bus::DriveReaction;
    let coasts = |reaction| matches!(reaction, DriveReaction::Coast | DriveReaction::Off);
    let unpaid = drives.on_power_loss == DriveReaction::Off || drives.bus.is_none();
    plan::Coasts {
        on_link_loss: coasts(drives.on_link_loss),
        on_power_loss: coasts(drives.on_power_loss) && unpaid,
    }
}

fn own_ramps(file: store::machine::OwnRamps) -> OwnRamps {
    OwnRamps {
        delay: file.delay,
        accel: file.acceleration,
        decel: file.deceleration,
        uncertainty: file.uncertainty_share,
        repeats_delay: file.repeats_delay,
        repeats: file.repeats_share,
        turns_within: file.turns_within,
        creep: file.creep_share,
        orients: file.orients,
    }
}

fn axis(file: &Axis) -> AxisLimits {
    const GRAVITY_M_PER_S2: f64 = 9.806_65;
    let mass = file.drive.motor_mass() + file.moving_mass;
    let weight = Force::n(file.weight_share * file.moving_mass.value() * GRAVITY_M_PER_S2);
    let free = file.drive.peak_force() * PLANNED_SHARE - weight - file.friction.static_force;
    let possible = units::CoordinateAccel::new(free.value() / mass.value() * 1e3);
    AxisLimits {
        travel: Some((file.travel.from, file.travel.to)),
        rapid_speed: file.rapid,
        feed_speed: file.feed_most,
        accel: file.acceleration.min(possible),
        rapid_jerk: file.jerk_rapid,
        feed_jerk: file.jerk_feed,
    }
}

fn spindle(file: &Spindle) -> SpindleLimits {
    SpindleLimits {
        inertia: file.inertia,
        peak_torque: file.peak_torque,
        continuous_torque: file.continuous_torque,
        thermal_time: file.thermal_time,
        peak_power: file.peak_power,
        friction: file.friction.coulomb,
        viscous_n_m_s_per_rad: file.friction.viscous_n_m_s_per_rad,
        max_speed: file.max,
        tapping_max: file.tapping_max,
        margin: file.planned_share,
        torque_rise: file.torque_rise,
    }
}

/// What the report measures the axes against, while cutting.
pub fn path_limits(machine: &MachineFile) -> report::AxisLimits {
    let mut limits = report::AxisLimits::NONE;
    for (i, axis) in planner(machine).axes.iter().enumerate() {
        let Some(axis) = axis else { continue };
        limits.speed[i] = axis.rapid_speed;
        limits.accel[i] = axis.accel;
        limits.jerk[i] = axis.feed_jerk;
    }
    limits
}
