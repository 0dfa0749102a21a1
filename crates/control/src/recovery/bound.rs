//! How certainly the encoders tell how far a tap is off its thread.
//!
//! ```text
//!   motor encoder ──screw, nut, bearings──► headstock ──holder──► tap in its helix
//!                     spring k, play              spring kh
//! ```
//!
//! The encoders know motor and spindle. What lies between the motor and the tap they do not see:
//! play, and the spring of the screw under whatever force is on it, when the tap first touched the
//! work (which fixed the helix) and now. Nor do they know the helix itself better than the axis
//! followed the spindle there. Every term is its largest value, and they are added:
//!
//! | term | | |
//! |---|---|---|
//! | counts | H/n + one count of the axis | encoders |
//! | play | b | once over |
//! | friction | Fs/k | which way the guide's friction holds the table, standing |
//! | touching | 0.4·(Fs + σ2·v + m·a)/k, a = H/2π·M/J at most | what the control's model of the screw missed when the tap touched the work |
//! | holder | e·kh/(k + kh) | of the distance e that the encoders show, what the screw gives |
//! | ground | F/k | a tap that ran too deep may press on the ground with what its core bears |
//! | helix | the largest sync error while the control lived | as the machine keeps it |
//! | screw, encoders | 3 µm + 0.1 µm/mm of the stroke | lead error and eccentricity (estimate) |
//!
//! b, Fs, σ2 and kh are taken a fifth larger than the machine's file has them, k 15 % smaller: a
//! machine is never quite as its file. A scale at the table sees the screw's spring and play: there
//! those terms are nought.
use store::machine::{Axis, PositionFrom, Spindle};
use store::sync_record::Stroke;
use units::{Force, Length};

/// By how much a machine may have more play, friction and stiffness of a holder than its file, and
/// less stiffness of its screw.
const MORE: f64 = 1.2;
const SOFTER: f64 = 0.85;
/// And what the control's model of friction and spring misses of what stretches the screw.
const MISSED: f64 = 0.4;
/// What screws and encoders are wrong by, and for each mm of a stroke (estimate: a rolled screw, an
/// encoder off its centre).
const ENCODERS: Length = Length::um(3.0);
const SCREW_PER_MM: f64 = 1e-4;

/// What the encoders cannot see, in words, and how much that is.
pub(super) struct Unseen {
    pub(super) total: Length,
    pub(super) why: String,
}

/// Of a tap that the encoders show this far off its thread. `helix`: how far the axis was from its
/// coupling at most while the control lived. `ground`: with how much force its tip may press on the
/// ground of the hole.
pub(super) fn unseen(
    stroke: &Stroke,
    axis: &Axis,
    spindle: &Spindle,
    error: Length,
    helix: Length,
    ground: Force,
) -> Unseen {
    let lead = stroke.lead.value().abs();
    let stroke_mm = (stroke.bottom - stroke.start).value().abs();
    let count = lead / f64::from(spindle.encoder_counts_per_rev);
    let encoders = ENCODERS + Length::mm(SCREW_PER_MM * stroke_mm);
    let (resolution, of_screw) = match axis.position_from {
        PositionFrom::Motor { resolution, .. } => {
            (resolution, Some(screw(stroke, axis, spindle, error)))
        }
        PositionFrom::Scale { resolution, .. } => (resolution, None),
    };
    let counts = Length::mm(count) + resolution.of_linear();
    let (play, mut spring) = of_screw.unwrap_or_default();
    if of_screw.is_some() {
        spring += Length::mm(ground.value() / (SOFTER * axis.structure.stiffness.value()));
    }
    let total = counts + encoders + play + spring + helix;
    Unseen {
        total,
        why: format!(
            "play {:.1} µm, spring of the screw {:.1} µm, thread as cut {:.1} µm, encoders {:.1} µm",
            play.in_um(),
            spring.in_um(),
            helix.in_um(),
            (counts + encoders).in_um()
        ),
    }
}

/// Play and spring of a screw whose motor carries the encoder.
fn screw(stroke: &Stroke, axis: &Axis, spindle: &Spindle, error: Length) -> (Length, Length) {
    let lead_m = stroke.lead.value().abs() * 1e-3;
    let k = SOFTER * axis.structure.stiffness.value() * 1e3; // N/m
    let holder = MORE * stroke.stiffness.value() * 1e3;
    let speed = lead_m * stroke.spin.value().abs();
    let standing = axis.friction.static_force.value();
    let moving = standing + axis.friction.viscous_n_s_per_m * speed;
    let runs_up =
        lead_m / std::f64::consts::TAU * spindle.peak_torque.value() / spindle.inertia.value();
    let pushed = axis.moving_mass.value() * runs_up.min(axis.acceleration.value() * 1e-3);
    let given = error.abs() * (holder / (k + holder));
    let spring = Length::mm((MORE * standing + MISSED * (moving + pushed)) / k * 1e3) + given;
    (axis.structure.backlash.of_linear() * MORE, spring)
}
