//! The control's loops, windows and waits.
use kernel::{
    AxisControl, AxisEncoder, AxisFriction, AxisWindows, Config, EncoderCheckControl, EncoderPlace,
    FeedForward, OverloadReaction, Overrides, OwnRamps, Pause, PhaseLoss, SpindleControl,
    SpindleFriction, SpindleWindows, SupervisionControl, TorqueReading, Waits,
};
use store::machine::{
    self, Axis, Control, Follows, Loops, MachineFile, OnOverload, PositionFrom, Spindle,
};
use sync::{Prediction, SyncMode, Windows};
use units::{Angle, Coordinate, Force};

/// Standard gravity (CGPM 1901).
const GRAVITY_M_PER_S2: f64 = 9.806_65;

/// The control of this machine, with its own way of synchronising unless another one is asked for.
pub fn control(machine: &MachineFile, mode: Option<SyncMode>, learns: bool) -> Config {
    let control = &machine.control;
    let mut spindles = [None; bus::SPINDLES];
    for (slot, file) in spindles.iter_mut().zip(&machine.spindles) {
        // what is simulated is as its file says, and what another process reads need not be
        let check = (machine.hal.is_some() && (file.own_ramps.is_some() || file.closes_position))
            .then_some(EncoderCheckControl { index: file.encoder_index });
        let of = spindle(file, control.synchronisation.observer_bandwidth_hz);
        *slot = Some(SpindleControl { encoder_check: check, ..of });
    }
    Config {
        period: control.period,
        command_delay: control.period * f64::from(control.command_delay_periods),
        axes: machine.axes.each_ref().map(|file| file.as_ref().map(axis)),
        spindles,
        synchronisation: mode.unwrap_or_else(|| synchronisation(control)),
        sync_windows: Windows { warn: machine.tapping.sync_warn, stop: machine.tapping.sync_stop },
        waits: Waits {
            ready: control.waits.ready,
            at_speed: control.waits.at_speed,
            oriented: control.waits.oriented,
            in_position: control.waits.in_position,
            tool_change: control.waits.tool_change,
        },
        motion: super::planner(machine).motion(1.0),
        phase_loss: control.phase_loss.and_then(|loss| {
            let axis = machine.axes[loss.axis.index()].as_ref()?;
            let most = (axis.rapid, axis.acceleration);
            Some(PhaseLoss {
                window: loss.window,
                axis: loss.axis,
                by: Coordinate::linear(loss.by),
                most,
            })
        }),
        overrides: Overrides {
            feed_most: control.overrides.feed_most_share,
            spindle: (control.overrides.spindle_least_share, control.overrides.spindle_most_share),
        },
        pause: Pause::GoOn,
        probe_guard: true,
        learning: learns.then(|| crate::services::learning::how(machine)),
        compensation: super::compensation::compensation(machine),
        supervision: machine.tapping.supervision.map(|how| supervision(machine, how)),
    }
}

/// How taps are supervised: only on spindles whose drives measure their torque.
fn supervision(machine: &MachineFile, how: machine::TapSupervision) -> SupervisionControl {
    let mut readings = [None; bus::SPINDLES];
    for (reading, spindle) in readings.iter_mut().zip(&machine.spindles) {
        *reading = spindle.measured_torque.map(|measured| TorqueReading {
            delay: measured.delay,
            noise: spindle.peak_torque * measured.noise_share.max(measured.resolution_share),
        });
    }
    SupervisionControl {
        readings,
        share: how.band_share,
        reaction: match how.on_overload {
            OnOverload::Retract => OverloadReaction::Retract,
            OnOverload::Stop => OverloadReaction::Stop,
            OnOverload::Report | OnOverload::Off => OverloadReaction::Report,
        },
    }
}

/// The control of this machine as long as nothing is homed: it goes by what the encoders read, and
/// takes no errors off that count from machine zero.
pub fn unreferenced(machine: &MachineFile) -> Config {
    Config { compensation: kernel::DeviationTables::default(), ..control(machine, None, false) }
}

/// What the machine's file says a follower follows.
fn synchronisation(control: &Control) -> SyncMode {
    match control.synchronisation.follows {
        Follows::Command => SyncMode::CommandSynchronised,
        Follows::Encoder => encoder(
            control,
            match control.synchronisation.prediction {
                machine::Prediction::None => Prediction::None,
                machine::Prediction::Speed => Prediction::Speed,
                machine::Prediction::Observer => Prediction::Observer,
            },
        ),
    }
}

/// Encoder-following, with readings as old as this control makes them.
pub fn encoder(control: &Control, prediction: Prediction) -> SyncMode {
    let age = control.synchronisation.encoder_age_periods.min(u32::from(sync::MAX_TRANSPORT));
    SyncMode::EncoderFollowing { prediction, transport: age as u8 }
}

fn feed_forward(loops: &Loops) -> FeedForward {
    FeedForward {
        speed: loops.velocity_feed_forward_share,
        accel: loops.acceleration_feed_forward_share,
        friction: loops.friction_feed_forward_share,
    }
}

fn axis(file: &Axis) -> AxisControl {
    let (place, motor_count) = match file.position_from {
        PositionFrom::Motor { .. } => (EncoderPlace::Motor, None),
        PositionFrom::Scale { motor, .. } => (EncoderPlace::Scale, motor.map(|(_, count)| count)),
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
        stiffness: file.structure.stiffness,
        backlash: super::compensation::modelled_play(file),
        encoder: AxisEncoder { place, count: file.position_from.resolution(), motor_count },
        peak_force: file.drive.peak_force(),
        force_lag: file.drive.force_lag,
        approach: (file.approach.speed, file.approach.acceleration),
        travel: Some((file.travel.from, file.travel.to)),
        windows: AxisWindows {
            in_position: file.windows.in_position,
            settle: file.windows.settle,
            following_warn: file.windows.following_error_warn,
            following_stop: file.windows.following_error_stop,
        },
    }
}

fn spindle(file: &Spindle, observer_bandwidth_hz: f64) -> SpindleControl {
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
        highest: file.max,
        peak_torque: file.peak_torque,
        peak_power: file.peak_power,
        torque_lag: file.torque_lag,
        encoder_count: Angle::rev(1.0 / f64::from(file.encoder_counts_per_rev)),
        observer_bandwidth_hz,
        orient: (file.orient, file.orient_acceleration),
        own_ramps: file.own_ramps.map(|own| OwnRamps {
            delay: own.delay,
            accel: own.acceleration,
            decel: own.deceleration,
            uncertainty: own.uncertainty_share,
            repeats: (own.repeats_delay, own.repeats_share),
            creep: own.creep_share,
        }),
        closes_position: file.closes_position,
        orients: file.own_ramps.is_some_and(|own| own.orients),
        follows_orders: true,
        encoder_check: None,
        windows: SpindleWindows {
            at_speed: file.windows.at_speed_share,
            in_cut: file.windows.in_cut_share,
            at_rest: file.windows.at_rest,
            oriented: file.windows.oriented,
            following_stop: file.windows.following_error_stop,
        },
    }
}
