//! How threads are tapped and watched.
//!
//! ```text
//!   torque │▔▔▔▔▔▔▔▔╲ peak          a preset plans with a share of the drive's curve and leaves the rest
//!          │┄┄max┄┄┄┄╲              to the control; the way out may have a share of its own. The jerk
//!          │┄┄standard┄╲            of a preset is a factor on what spindle and feed are allowed.
//!          │┄┄gentle┄┄┄┄┄╲
//!          └───────────────► speed
//! ```
use super::setup::percent;
use crate::keys::Keys;
use units::{Length, Time};

/// Rigid tapping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tapping {
    /// Synchronisation error in the material that is reported.
    pub sync_warn: Length,
    /// Synchronisation error in the material that stops the machine.
    pub sync_stop: Length,
    /// How the spindle is brought to speed and back.
    pub ramp: Ramp,
    /// The spindle cannot be synchronised: feed and spindle only run at their speeds, and a
    /// tension/compression holder takes the difference.
    pub floating: bool,
    /// The preset of a run that asks for none.
    pub preset: Preset,
    /// What each preset asks of the drives, where the file says it.
    pub presets: [Option<Effort>; 4],
    /// What a peck (Q) does before the next one.
    pub peck: Peck,
    /// Taps are supervised by the torque that the spindle's drive measures; `None`: they are not.
    pub supervision: Option<TapSupervision>,
}

/// How taps are supervised by measured torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapSupervision {
    /// What a torque beyond its bounds does.
    pub on_overload: OnOverload,
    /// By this share a good hole may be off the mean of the good ones.
    pub band_share: f64,
}

/// What a torque beyond its bounds does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnOverload {
    /// An alarm; the tap comes out along its thread.
    Retract,
    /// An alarm; the tap stays in its thread.
    Stop,
    /// Nothing: what is seen is said when the hole is done.
    Report,
    /// Taps are not supervised.
    Off,
}

impl TapSupervision {
    fn read(keys: &mut Keys<'_>) -> Option<Self> {
        let reactions = [
            ("retract", OnOverload::Retract),
            ("stop", OnOverload::Stop),
            ("report", OnOverload::Report),
            ("off", OnOverload::Off),
        ];
        let on_overload = keys.choice("on_overload", &reactions);
        let band_share = percent(keys, "band_percent", 5.0..=200.0);
        Some(Self { on_overload, band_share }).filter(|_| on_overload != OnOverload::Off)
    }
}

/// How hard taps are driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// For weak work, long tools and first parts.
    Gentle,
    /// What the machine is planned with otherwise.
    Standard,
    /// A little of the control's reserve is spent.
    Fast,
    /// Nearly all of it: only where the material is known.
    Max,
}

/// What a preset asks of the drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Share of the spindle drive's torque and power that the way in is planned with.
    pub planned_share: f64,
    /// The same for the way out.
    pub return_planned_share: f64,
    /// Factor on the jerk of spindle and feed axis.
    pub jerk_share: f64,
}

/// What a peck does before the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Peck {
    /// Comes out to the R plane.
    Full,
    /// Turns back by this much of the feed's way, to break the chip.
    ChipBreak(Length),
}

/// How the spindle is brought to speed in a tap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ramp {
    /// As fast as torque, power and the feed axis allow.
    PowerCurve,
    /// From rest to the programmed speed in a straight line in this time, whatever the power curve
    /// says.
    Linear(Time),
}

impl Preset {
    /// All of them, with their names in machine files and on the command line.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("gentle", Self::Gentle),
        ("standard", Self::Standard),
        ("fast", Self::Fast),
        ("max", Self::Max),
    ];

    /// What it asks where the file does not say it; `standard` is the share that the spindle is
    /// planned with.
    const fn usual(self, standard: f64) -> Effort {
        let (planned_share, jerk_share) = match self {
            Self::Gentle => (0.5, 0.5),
            Self::Standard => (standard, 1.0),
            Self::Fast => (0.9, 1.3),
            Self::Max => (0.95, 1.6),
        };
        Effort { planned_share, return_planned_share: planned_share, jerk_share }
    }
}

impl Tapping {
    /// What a preset asks of a spindle that is planned with the share `standard`.
    pub fn effort(&self, preset: Preset, standard: f64) -> Effort {
        self.presets[preset as usize].unwrap_or_else(|| preset.usual(standard))
    }
}

impl Effort {
    fn read(keys: &mut Keys<'_>) -> Self {
        let planned_share = percent(keys, "planned_percent", 1.0..=100.0);
        Self {
            planned_share,
            return_planned_share: keys
                .optional("return_planned_percent", 1.0..=100.0)
                .map_or(planned_share, |p| p / 100.0),
            jerk_share: percent(keys, "jerk_percent", 1.0..=1000.0),
        }
    }
}

impl Peck {
    fn read(keys: &mut Keys<'_>) -> Self {
        let back = keys.optional("chip_break_mm", 0.01..=100.0);
        let full = keys.choice("retract", &[("full", true), ("chip-break", false)]);
        match back {
            _ if full => Self::Full,
            Some(mm) => Self::ChipBreak(Length::mm(mm)),
            None => {
                keys.conflict("retract", "a chip-break needs its way back `chip_break_mm`");
                Self::Full
            }
        }
    }
}

impl Tapping {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let ramp_time = keys.optional("ramp_s", 1e-3..=60.0);
        let linear = keys.choice("ramp", &[("power-curve", false), ("linear", true)]);
        if linear && ramp_time.is_none() {
            keys.conflict("ramp", "a linear ramp needs its time `ramp_s`");
        }
        let tapping = Self {
            sync_warn: Length::um(keys.number("sync_warn_um", 0.1..=10_000.0)),
            sync_stop: Length::um(keys.number("sync_stop_um", 0.1..=10_000.0)),
            ramp: match ramp_time {
                Some(s) if linear => Ramp::Linear(Time::s(s)),
                _ => Ramp::PowerCurve,
            },
            floating: keys
                .optional_choice("method", &[("synchronised", false), ("floating", true)])
                .unwrap_or(false),
            preset: keys.optional_choice("preset", &Preset::NAMES).unwrap_or(Preset::Standard),
            presets: keys
                .optional_section("presets", |k| {
                    Preset::NAMES.map(|(name, _)| k.optional_section(name, Effort::read))
                })
                .unwrap_or_default(),
            peck: keys.optional_section("peck", Peck::read).unwrap_or(Peck::Full),
            supervision: keys.optional_section("supervision", TapSupervision::read).flatten(),
        };
        if tapping.sync_stop < tapping.sync_warn {
            let least = tapping.sync_warn.in_um();
            keys.conflict(
                "sync_stop_um",
                format!("`sync_stop_um` is below the warning: expected {least} at least"),
            );
        }
        tapping
    }
}
