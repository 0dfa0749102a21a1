//! The control's loops, windows and waits.
use kernel::{
    AxisControl, AxisFriction, AxisWindows, Config, FeedForward, Pause, SpindleControl,
    SpindleFriction, SpindleWindows, Waits,
};
use store::machine::{Axis, Control, Follows, Loops, MachineFile, PositionFrom, Spindle};
use sync::{Prediction, SyncMode, Windows};
use units::{Force, Length, Speed, Spin, SpinAccel, Time};

/// Standard gravity (CGPM 1901).
const GRAVITY_M_PER_S2: f64 = 9.806_65;
/// Speed of moves that nobody programmed, such as going back to a path.
const GENTLE: Speed = Speed::mm_per_s(10.0);
/// Speed of turning a spindle to an angle.
const ORIENTING: Spin = Spin::rpm(300.0);

/// The control of this machine, with its own way of synchronising unless another one is asked for.
pub(crate) fn control(machine: &MachineFile, mode: Option<SyncMode>) -> Config {
    let control = &machine.control;
    let mut spindles = [None; bus::SPINDLES];
    for (slot, file) in spindles.iter_mut().zip(&machine.spindles) {
        *slot = Some(spindle(file, control.synchronisation.observer_bandwidth_hz));
    }
    Config {
        period: control.period,
        command_delay: control.period * f64::from(control.command_delay_periods),
        axes: machine.axes.each_ref().map(|file| file.as_ref().map(axis)),
        spindles,
        synchronisation: mode.unwrap_or_else(|| synchronisation(control)),
        sync_windows: Windows { warn: machine.tapping.sync_warn, stop: machine.tapping.sync_stop },
        waits: Waits {
            ready: control.waits.at_speed,
            at_speed: control.waits.at_speed,
            oriented: control.waits.oriented,
            in_position: control.waits.in_position,
            tool_change: control.waits.tool_change,
        },
        pause: Pause::GoOn,
    }
}

/// What the machine's file says a follower follows.
fn synchronisation(control: &Control) -> SyncMode {
    match control.synchronisation.follows {
        Follows::Command => SyncMode::CommandSynchronised,
        Follows::Encoder if control.synchronisation.prediction => {
            encoder(control, Prediction::Observer)
        }
        Follows::Encoder => encoder(control, Prediction::Speed),
    }
}

/// Encoder-following, with readings as old as this control makes them.
pub(crate) fn encoder(control: &Control, prediction: Prediction) -> SyncMode {
    let transport = control.command_delay_periods.min(u32::from(sync::MAX_TRANSPORT));
    SyncMode::EncoderFollowing { prediction, transport: transport as u8 }
}

fn feed_forward(loops: &Loops) -> FeedForward {
    FeedForward {
        speed: loops.velocity_feed_forward_share,
        accel: loops.acceleration_feed_forward_share,
        friction: loops.friction_feed_forward_share,
    }
}

fn axis(file: &Axis) -> AxisControl {
    let (stiffness, backlash) = match file.position_from {
        PositionFrom::Motor { .. } => (Some(file.structure.stiffness), file.structure.backlash),
        PositionFrom::Scale { .. } => (None, Length::ZERO),
    };
    let friction = &file.friction;
    AxisControl {
        position_gain: file.loops.position_gain_per_s,
        velocity_bandwidth_hz: file.loops.velocity_bandwidth_hz,
        feed_forward: feed_forward(&file.loops),
        motor_mass: file.drive.motor_mass(),
        table_mass: file.moving_mass,
        weight: Force::n(-file.weight_share * file.moving_mass.value() * GRAVITY_M_PER_S2),
        friction: AxisFriction {
            coulomb: friction.coulomb,
            breakaway: friction.static_force,
            stribeck: friction.stribeck_speed,
            bristle_stiffness: friction.bristle_stiffness,
            bristle_damping_n_s_per_m: friction.bristle_damping_n_s_per_m,
            viscous_n_s_per_m: friction.viscous_n_s_per_m,
        },
        stiffness,
        backlash,
        peak_force: file.drive.peak_force(),
        force_lag: Time::ZERO,
        gentle: (GENTLE, file.acceleration * 0.1),
        windows: AxisWindows {
            in_position: file.windows.in_position,
            settle: file.windows.settle,
            following_warn: file.windows.following_error_warn,
            following_stop: file.windows.following_error_stop,
        },
    }
}

fn spindle(file: &Spindle, observer_bandwidth_hz: f64) -> SpindleControl {
    // half of what the drive can hold for ever turns the spindle to an angle
    let orienting = SpinAccel::rev_per_s2(
        0.5 * file.continuous_torque.value() / (file.inertia.value() * std::f64::consts::TAU),
    );
    SpindleControl {
        position_gain: file.loops.position_gain_per_s,
        velocity_bandwidth_hz: file.loops.velocity_bandwidth_hz,
        feed_forward: feed_forward(&file.loops),
        inertia: file.inertia,
        friction: SpindleFriction {
            coulomb: file.friction.coulomb,
            rounding: file.friction.smoothing,
            viscous_n_m_s_per_rad: file.friction.viscous_n_m_s_per_rad,
        },
        peak_torque: file.peak_torque,
        peak_power: file.peak_power,
        torque_lag: file.torque_lag,
        observer_bandwidth_hz,
        orient: (ORIENTING.min(file.max), orienting),
        windows: SpindleWindows {
            at_speed: file.windows.at_speed_share,
            at_rest: file.windows.at_rest,
            oriented: file.windows.oriented,
            following_stop: file.windows.following_error_stop,
        },
    }
}
