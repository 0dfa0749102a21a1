//! Where a tap stands, how certainly, and the way it is taken out.
use super::{LONGEST, OUT};
use crate::args::RecoveryWay;
use crate::plant::Plant;
use crate::wiring;
use kernel::{EventKind, Kernel, RecoveryFigures, RecoveryPlan};
use std::f64::consts::TAU;
use store::machine::{MachineFile, Spindle};
use store::sync_record::{Stage, Stroke};
use sync::Coupling;
use sync::leaving::{Leaving, Setting};
use sync::recovery::{Direction, Point, Projection, Seat, Stored, Way};
use units::{Angle, Length};
use wire::{Stop, Welcome};

/// What is found out.
pub(super) struct Findings {
    pub(super) stored: Stored,
    pub(super) at: Point,
    pub(super) turn: Angle,
    pub(super) bound: Length,
    pub(super) why_bound: String,
    pub(super) projection: Projection,
    pub(super) direct: Projection,
    pub(super) way: Way,
}

/// Where the tap stands, and the way back onto its coupling; or why that cannot be known.
pub(super) fn find(
    stroke: &Stroke,
    stage: Stage,
    welcome: &Welcome,
    file: &MachineFile,
    way: RecoveryWay,
) -> Result<Findings, String> {
    let coupling = Coupling::line(stroke.lead, stroke.theta0, stroke.z0);
    let angle = |z: Length| stroke.theta0 + (z - stroke.z0) / stroke.lead;
    let direction = match stage {
        Stage::Inward | Stage::Out | Stage::Recovered => Direction::Inward,
        Stage::Outward => Direction::Outward,
    };
    let stored = Stored::on(coupling, angle(stroke.start), angle(stroke.bottom), direction);
    let feedback = &welcome.observed.feedback;
    let place = feedback.axes[usize::from(stroke.axis)].position;
    let reading = feedback.spindles[usize::from(stroke.spindle)].angle;
    let Some(spindle) = file.spindles.get(usize::from(stroke.spindle)) else {
        return Err(format!("the machine's file has no spindle {}", stroke.spindle));
    };
    let (turned, bound, why_bound) = if welcome.turns_lost[usize::from(stroke.spindle)] {
        let (bound, why) = shown(stroke, spindle, file.tapping.sync_stop, welcome.stop);
        let turned = stored.turn(reading, place, bound).map_err(|e| {
            format!("the spindle's encoder has lost count of its turns, and the turn cannot be shown from the axis: {e} ({why})")
        })?;
        (turned, bound, format!("single-turn encoder, turn from the axis; {why}"))
    } else {
        let count = 1.0 / f64::from(spindle.encoder_counts_per_rev);
        let bound = Length::mm(stroke.lead.value().abs() * count) + Length::um(1.0);
        (reading, bound, "multi-turn encoder".to_owned())
    };
    let at = Point { angle: turned, place };
    let setting =
        Setting { surface: stroke.surface, holder: stroke.stiffness, diameter: stroke.diameter };
    let seat = Seat { play: Length::ZERO, is_stiff: setting.is_stiff() };
    let way = match (stored.leaving(at, &setting).map_err(|e| e.to_string())?, way) {
        (Leaving::Straight, _) => Way::Straight,
        (Leaving::Along, RecoveryWay::Direct) => Way::Direct,
        (Leaving::Along, RecoveryWay::UnloadFirst) => Way::UnloadFirst(seat),
    };
    Ok(Findings {
        projection: stored.project(at, way),
        direct: stored.project(at, Way::Direct),
        stored,
        at,
        turn: turned - reading,
        bound,
        why_bound,
        way,
    })
}

/// What the distance from the coupling is shown not to exceed: the monitor's window while everything was driven, and the
/// turns that the spindle ran down alone.
fn shown(stroke: &Stroke, spindle: &Spindle, window: Length, stop: Stop) -> (Length, String) {
    let omega = stroke.spin.in_rad_per_s().abs();
    let inertia = spindle.inertia.value();
    let (turns, how) = match stop {
        Stop::Coupled => (0.0, "the drives stopped together"),
        Stop::QuickStop => {
            let torque =
                0.9 * spindle.peak_torque.value().min(spindle.peak_power.value() / omega.max(1e-9));
            (inertia * omega * omega / 2.0 / torque / TAU, "the spindle braked by itself")
        }
        Stop::Coasted | Stop::None => {
            // J·ω·dω/dθ = −(c₀ + c₁ω), from ω to 0
            let c0 = spindle.friction.coulomb.value().max(1e-9);
            let c1 = spindle.friction.viscous_n_m_s_per_rad.max(1e-12);
            let turns = inertia / c1 * (omega - c0 / c1 * (1.0 + c1 * omega / c0).ln()) / TAU;
            (turns, "the spindle may have coasted")
        }
    };
    let bound = window + Length::mm(stroke.lead.value().abs() * turns);
    (bound, format!("{how}: {:.3} mm from the thread at most", bound.value()))
}

/// Take it out.
pub(super) fn drive_out(
    plant: &mut Plant,
    file: &MachineFile,
    stroke: &Stroke,
    findings: &Findings,
) -> Result<RecoveryFigures, String> {
    let letter = canon::Axis::ALL[usize::from(stroke.axis)];
    let Some(axis) = file.axis(letter) else {
        return Err(format!("the machine's file has no axis {}", letter.letter()));
    };
    let mut kernel = Kernel::new(wiring::control(file, None, false));
    kernel.recover(RecoveryPlan {
        axis: letter,
        spindle: stroke.spindle,
        stored: findings.stored,
        turn: findings.turn,
        way: findings.way,
        spin: OUT,
        feed: (axis.gentle.speed / 10.0, axis.gentle.acceleration),
    });
    let mut figures = None;
    super::obey(&mut kernel, plant, &mut |event| {
        if let EventKind::RecoveryEnded(ended) = event {
            figures = Some(*ended);
        }
    })?;
    figures.ok_or_else(|| format!("it is not out after {LONGEST}"))
}
