//! Spindles geared to one another, and motions that repeat with a spindle's turn.
//!
//! ```text
//!   work spindle θ ──┬── × tool/work + phase ──────────────► tool spindle     (an electronic gear)
//!                    └── Σ a·cos(2π·m·u) + b·sin(2π·m·u) ──► an axis, or the tool spindle's phase
//!
//!   u = θ + phase·work/tool: from where the first insert passes the middle of its facet
//! ```
//!
//! Source: `G51.2`/`G50.2` of polygon turning (P:Q ratio, R phase), and the oscillation of
//! JP7525593B2.
use crate::{Axis, Position, Ratio};
use alloc::vec::Vec;
use units::{Angle, Lead, Length};

impl Polygon {
    /// Turns of the work after which the tool passes the same facets again: those of a ratio of a
    /// few turns; of one that winds a little more or less, in which time the facets turn that much.
    pub fn period(&self) -> f64 {
        let settled = self.ratio.settled().unwrap_or(self.ratio);
        f64::from(settled.master) * (settled.value() / self.ratio.value())
    }

    /// Harmonics as functions of the work spindle's own angle.
    pub fn by_work(&self, harmonics: &[Harmonic]) -> Vec<Harmonic> {
        harmonics.iter().map(|harmonic| harmonic.ahead(self.past_middle())).collect()
    }

    /// A harmonic of the work spindle's own angle, counted from the middle of the first facet.
    #[must_use]
    pub fn by_facet(&self, harmonic: &Harmonic) -> Harmonic {
        harmonic.ahead(-self.past_middle())
    }

    /// Share of the period by which the first facet's middle is past where the work stands at zero.
    fn past_middle(&self) -> f64 {
        self.phase.value() / self.ratio.value() / self.period()
    }
}

/// Polygon turning: a tool spindle geared to the work spindle, with or without oscillation.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// The work spindle, which leads; counted from 0.
    pub work: u8,
    /// The tool spindle, which follows.
    pub tool: u8,
    /// Tool turns per work turns.
    pub ratio: Ratio,
    /// Angle of the tool spindle while the work spindle's is zero.
    pub phase: Angle,
    /// What swings with the work spindle, as it is sent; none: nothing does.
    pub oscillations: Vec<Oscillation>,
    /// What swings beside that by a share of the distance of the axes at the cut, which only the
    /// cuts that follow say: amplitudes are shares of it.
    pub by_distance: Vec<Oscillation>,
    /// What shall come of it at the tool, where what is sent has the answers of the loops in it
    /// already; empty: the same.
    pub wanted: Vec<Oscillation>,
    /// The control computes what swings, within the limits of the machine; `oscillations` is empty
    /// then.
    pub auto: Option<Actuator>,
    /// What swings is sent as a measurement kept from before has it compensated.
    pub compensated: bool,
    /// The program's zero, machine coordinates of the axes: with the offsets of work and tool in
    /// force.
    pub zero: Position,
    /// Where another work offset than the first (G55 and on) has its zero; `None`: G54 is in force.
    pub own_zero: Option<Position>,
}

/// Hobbing: the work turns with the hob, tooth by tooth, and a turn more for each lead of its helix
/// that Z travels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hob {
    /// The hob's spindle, which leads; counted from 0.
    pub hob: u8,
    /// The work spindle, which follows.
    pub work: u8,
    /// Teeth of the gear.
    pub teeth: u32,
    /// Starts of the hob; negative: the work turns against it.
    pub starts: i32,
    /// Module in the normal section.
    pub module: Length,
    /// Helix angle on the pitch cylinder; positive: right hand.
    pub helix: Angle,
    /// The program's zero, machine coordinates of the axes: with the offsets of work and tool in
    /// force.
    pub zero: Position,
    /// Where another work offset than the first (G55 and on) has its zero; `None`: G54 is in force.
    pub own_zero: Option<Position>,
    /// What the drawing asks of the gear.
    pub asked: GearAsked,
}

/// What the drawing asks of a gear besides its teeth, module and helix; what it does not ask is as
/// usual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GearAsked {
    /// Coefficient of the profile shift.
    pub shift: f64,
    /// Pressure angle in the normal section; `None`: 20°.
    pub pressure_angle: Option<Angle>,
    /// Width of the toothed face.
    pub width: Option<Length>,
    /// Diameter over the tips; `None`: a module over the shifted reference circle.
    pub tip_diameter: Option<Length>,
    /// Allowances of the span, the upper and the lower one; `None`: the usual tolerance, each way.
    pub span: Option<[Length; 2]>,
    /// Grade of ISO 1328-1.
    pub grade: Option<u8>,
}

impl GearAsked {
    /// Pressure angle where the drawing states none (ISO 53).
    pub const PRESSURE_ANGLE: Angle = Angle::deg(20.0);

    /// Pressure angle in the normal section.
    pub fn pressure_angle(&self) -> Angle {
        self.pressure_angle.unwrap_or(Self::PRESSURE_ANGLE)
    }
}

impl Hob {
    /// Turns of the work per turns of the hob, without the helix.
    pub const fn ratio(&self) -> Ratio {
        // a number of teeth beyond 2³¹ is no gear
        let teeth =
            if self.teeth < i32::MAX.cast_unsigned() { self.teeth.cast_signed() } else { i32::MAX };
        Ratio { follower: self.starts, master: teeth }
    }

    /// Travel along Z in which a tooth winds once around: π·m·z/sin β, positive for a right-hand
    /// helix; `None` of straight teeth.
    pub fn lead(&self) -> Option<Lead> {
        let sine = libm::sin(self.helix.in_rad());
        let around = core::f64::consts::PI * self.module.value() * f64::from(self.teeth);
        (sine.abs() > 1e-9).then(|| Lead::mm_per_rev(around / sine))
    }

    /// Diameter of the pitch circle: m·z/cos β.
    pub fn pitch_diameter(&self) -> Length {
        self.module * f64::from(self.teeth) / libm::cos(self.helix.in_rad())
    }
}

/// What the control may let swing, where it computes the oscillation itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Actuator {
    /// Whatever is flattest.
    Any,
    /// X, along the line of centres.
    CentreLine,
    /// Y, across it.
    Across,
    /// X and Y.
    Both,
    /// The tool spindle's phase.
    ToolPhase,
    /// X and the tool spindle's phase.
    CentreLineAndPhase,
    /// X, Y and the tool spindle's phase.
    All,
}

/// A motion that repeats with the work spindle's turn, on top of every other.
#[derive(Clone, Debug, PartialEq)]
pub struct Oscillation {
    /// What swings.
    pub on: Oscillating,
    /// How: the sum of these.
    pub harmonics: Vec<Harmonic>,
}

/// What can swing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Oscillating {
    /// A linear axis; amplitudes are millimetres.
    Axis(Axis),
    /// The tool spindle's phase; amplitudes are revolutions of it.
    ToolPhase,
}

/// One harmonic, `cosine·cos(2π·m·u) + sine·sin(2π·m·u)`; with m = 0 the cosine is a constant. u is
/// the work's angle from where the insert at the tool spindle's zero passes the middle of its
/// facet, in the turns of the work after which the tool passes the same facets again
/// ([`Polygon::period`]): one, or P of a ratio P:Q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// Periods in the turns of the work after which the tool passes the same facets again, m.
    pub per_turn: u32,
    /// Amplitude of the cosine, mm or rev.
    pub cosine: f64,
    /// Amplitude of the sine, mm or rev.
    pub sine: f64,
}

impl Harmonic {
    /// The same with its argument ahead by a share of a turn.
    fn ahead(&self, share: f64) -> Self {
        let angle = core::f64::consts::TAU * f64::from(self.per_turn) * share;
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        Self {
            per_turn: self.per_turn,
            cosine: self.cosine * cosine + self.sine * sine,
            sine: self.sine * cosine - self.cosine * sine,
        }
    }
}
