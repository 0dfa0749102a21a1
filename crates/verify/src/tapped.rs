//! An internal thread as it was made, with its measures.
//!
//! ```text
//!                 y                         surface ──────┬─────────────┬──
//!                 │   ○ ← x, y of the axes                │  ▒       ▒  │ ↑       ↑
//!                 │                                       │  ▒ full  ▒  │ depth   │
//!                 └────── x                               │  ▒ form  ▒  │ ↓       │ tip_depth
//!                                                         │   ▒     ▒   │ chamfer │
//!                                                         └────\___/────┘         ↓
//! ```
use crate::class::ThreadClass;
use crate::gauge::Gauge;
use canon::Hand;
use units::{Angle, Force, Lead, Length, Spin, Torque};

/// An internal thread as it was made. `docs/judging.md` has the equations.
#[derive(Clone, Debug, PartialEq)]
pub struct Thread {
    /// Mean X of the axis while the tap was in the material.
    pub x: Length,
    /// Likewise Y.
    pub y: Length,
    /// Largest distance from the programmed position while in the material.
    pub position_error: Length,
    /// Designation of the size, such as `"M6x1"` or `"1/4-20 UNC"`.
    pub size: String,
    /// Which way it winds.
    pub hand: Hand,
    /// Lead of the thread asked (magnitude).
    pub lead: Lead,
    /// Length of full thread: the tip's depth less the tap's chamfer.
    pub depth: Length,
    /// Deepest point of the tap's tip below the surface.
    pub tip_depth: Length,
    /// The tip's depth less the programmed one; positive is an overrun.
    pub depth_error: Length,
    /// Fastest spindle speed in the material (magnitude).
    pub spin_max: Spin,
    /// Largest distance of the axis from the ideal helix fitted to it, in the material, in and out:
    /// how well the machine kept step, before the holder gave way.
    pub sync_error_max: Length,
    /// The same, root of the mean square over the spindle's path.
    pub sync_error_rms: Length,
    /// Depth of the tip at which `sync_error_max` occurred.
    pub sync_error_depth: Length,
    /// Largest cumulative pitch error between two places within the engagement length.
    pub lead_error: Length,
    /// How much wider, axially, the widest groove place is than the tap's tooth.
    pub groove_widening: Length,
    /// Depth of that place.
    pub widest_depth: Length,
    /// Simple pitch diameter D2s = D2 of the tap + √3·widening.
    pub pitch_diameter: Length,
    /// Virtual pitch diameter D2v = D2s − √3·|ΔPn| − fα: what a full-form gauge feels.
    pub virtual_pitch_diameter: Length,
    /// Minor diameter: that of the drilled hole, or the tap drill's if the program drilled none.
    pub minor_diameter: Length,
    /// How it is known that there was a hole to tap.
    pub hole: KnownHole,
    /// Finest class whose gauges all agree; `None` if not even the coarsest.
    pub class: Option<ThreadClass>,
    /// Class asked.
    pub class_asked: ThreadClass,
    /// The smaller of `go_margin` and `no_go_margin`; negative is out of tolerance.
    pub margin: Length,
    /// Which gauge that is.
    pub limiting_gauge: Gauge,
    /// D2v − D2: how loosely the Go gauge enters.
    pub go_margin: Length,
    /// D2 + TD2 − D2s: how surely the No-go gauge is refused.
    pub no_go_margin: Length,
    /// Distance of the minor diameter from the nearer of its limits; negative is outside.
    pub minor_margin: Length,
    /// TD2 of the class asked.
    pub pitch_diameter_tolerance: Length,
    /// Largest torque of the cut, where it can be known.
    pub torque_max: Option<Torque>,
    /// Largest torque on the way in.
    pub torque_in: Option<Torque>,
    /// Largest torque on the way out, once the chip's root is sheared: from half a turn back on.
    pub torque_out: Option<Torque>,
    /// Torque that the formula of tap makers expects of a sharp tap; `None` without a
    /// material.
    pub torque_expected: Option<Torque>,
    /// Largest axial force on the tap (magnitude), where it can be known.
    pub axial_force_max: Option<Force>,
    /// Spindle angle within a turn at which the fitted helix passes the start plane; `None`: too
    /// little was cut to fit one.
    pub start_angle: Option<Angle>,
    /// Chips were thrown off the tap after it, on the way to the next hole: seen, not only ordered.
    pub chip_removal: bool,
    /// The motion was faulted in the thread and the tap was driven out of it afterwards.
    pub recovered: bool,
    /// Sync error and widening over depth, for pictures; empty if nothing was cut.
    pub profile: Vec<ProfilePoint>,
}

/// How it is known that a hole was there before it was tapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KnownHole {
    /// It was drilled, or milled, on this workpiece.
    Seen,
    /// The program or its operator states it.
    Stated,
    /// It is not known: nothing is drilled on this workpiece, and the hole is taken to be there.
    Assumed,
}

impl Thread {
    /// How far the tap makers' formula is believed, as a share of it: they call it a guide value,
    /// and charges of a steel differ by as much (estimate).
    pub const TORQUE_BAND: f64 = 0.25;
    /// Torque of flanks in a thread that is cut, as shares of the formula (published: 10 to 30 %).
    pub const TORQUE_OUT_SHARES: [f64; 2] = [0.1, 0.3];

    /// There is a length of full thread that a gauge could be tried on: what gauges find means
    /// something.
    pub fn is_gauged(&self) -> bool {
        self.pitch_diameter > Length::ZERO
    }

    /// What the formula expects on the way in, from and to.
    pub fn torque_in_band(&self) -> Option<[Torque; 2]> {
        let band = |t: Torque| [t * (1.0 - Self::TORQUE_BAND), t * (1.0 + Self::TORQUE_BAND)];
        self.torque_expected.map(band)
    }

    /// What it expects on the way out, as uncertain as that.
    pub fn torque_out_band(&self) -> Option<[Torque; 2]> {
        let [least, most] = Self::TORQUE_OUT_SHARES;
        let band = |[low, high]: [Torque; 2]| [low * least, high * most];
        self.torque_in_band().map(band)
    }

    /// Whether both ways are within what the formula expects; `None` where that cannot be said.
    pub fn torque_is_expected(&self) -> Option<bool> {
        let within = |m: Torque, [low, high]: [Torque; 2]| low <= m && m <= high;
        let inward = within(self.torque_in?, self.torque_in_band()?);
        let outward = self.torque_out.zip(self.torque_out_band());
        Some(inward && outward.is_none_or(|(m, band)| within(m, band)))
    }

    /// Name of the class asked if the thread is within it, else of the finest that it is within,
    /// else `"none"`; `"not gauged"` where there is no full thread that a gauge could be tried on.
    pub fn class_name(&self) -> &'static str {
        if !self.is_gauged() {
            return "not gauged";
        }
        let within = self.margin >= Length::ZERO && self.minor_margin >= Length::ZERO;
        match self.class {
            Some(_) if within => self.class_asked.name(),
            Some(reached) => reached.name(),
            None => "none",
        }
    }
}

/// Sync error and cut at one depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Depth of the tap's tip.
    pub tip_depth: Length,
    /// Least and largest sync error on the way in; positive is deeper than the helix.
    pub inward: Option<[Length; 2]>,
    /// Likewise on the way out.
    pub outward: Option<[Length; 2]>,
    /// Widening of the groove at *this depth of thread*; `None` below the full form.
    pub widening: Option<Length>,
}
