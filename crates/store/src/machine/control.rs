//! The control: its clock, what follows what, how long it waits, and the tool changer.
use super::setup::percent;
use crate::keys::Keys;
use units::{Angle, Length, Speed, Spin, Time};

/// The control.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Servo period.
    pub period: Time,
    /// Whole periods until a command takes effect, beside the one in which it is computed.
    pub command_delay_periods: u32,
    /// How programs are read, unless the command line says otherwise.
    pub dialect: &'static str,
    /// What Fanuc's parameters set, in its dialects; as most machines have it, if not stated.
    pub fanuc: Option<Fanuc>,
    /// What programs may leave to the machine.
    pub programs: Programs,
    /// Where a drilling cycle's depth is measured from; as the dialect has it, if not stated.
    pub cycle_depth: Option<CycleDepth>,
    /// Chip removal in cycles whose blocks do not say it, if stated.
    pub chip_removal: Option<ChipRemoval>,
    /// Where the tool moves aside in Fanuc's boring cycles G76 and G87: along which axis of the
    /// plane, and which way.
    pub boring_aside: Option<BoringAside>,
    /// Folders in which subprogram files are looked for, beside the program's own; separated by
    /// `:`.
    pub subprogram_path: Option<String>,
    /// What follows what in a synchronised move.
    pub synchronisation: Synchronisation,
    /// How long each wait may last before it is an alarm.
    pub waits: Waits,
    /// What is done when a geared spindle loses its phase, if it is stated; else everything stops
    /// at once.
    pub phase_loss: Option<PhaseLoss>,
    /// What the operator may change.
    pub overrides: Overrides,
    /// How moves go on into one another, if it is stated.
    pub path: Option<PathControl>,
    /// How repeated taps learn, if it is stated.
    pub learning: Option<Learning>,
    /// `workpiece_begins = "at-start"`: each start from the beginning of a program is on another
    /// workpiece; else one begins when that is asked for.
    pub start_begins_workpiece: bool,
}

/// How moves go on into one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathControl {
    /// Corners may be blended before the program has said G61 or G64.
    pub blends: bool,
    /// How far the path may be from the programmed one where G64 has no P.
    pub tolerance: Length,
}

/// How repeated taps learn.
#[derive(Clone, Debug, PartialEq)]
pub struct Learning {
    /// Share of an error that is corrected in the next stroke.
    pub gain: f64,
    /// Bandwidth of what is learnt, Hz.
    pub bandwidth_hz: f64,
    /// The file that keeps it; without one learning is off unless the command line names one.
    pub file: Option<String>,
}

/// Names of the dialects of G-code, the one that holds if a file says none first.
pub const DIALECTS: [&str; 11] = [
    "linuxcnc",
    "fanuc",
    "haas",
    "mitsubishi",
    "haas-lathe",
    "fanuc-lathe-a",
    "fanuc-lathe-b",
    "fanuc-lathe-c",
    "brother",
    "grbl",
    "toyoda",
];

/// How Fanuc's dialects count: `[control.fanuc]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fanuc {
    /// `increments = "IS-B"`: what a number without a decimal point counts.
    pub increments: Increments,
    /// `decimal_point = "calculator"`: without a point a number counts whole units.
    pub calculator: bool,
    /// `stroke_check = "outside"`: what G22 forbids is outside of its box.
    pub stroke_check_outside: bool,
}

/// What programs may leave to the machine: `[control.programs]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Programs {
    /// `unknown_m_codes = "ignored"`: M codes that neither dialect nor `[user_codes]` know have no
    /// effect.
    pub ignores_unknown_codes: bool,
    /// `end = "text"`: a program may lack M2 and M30.
    pub end_with_text: bool,
    /// What moves without F go with.
    pub feed: Option<Speed>,
}

impl Programs {
    fn read(keys: &mut Keys<'_>) -> Self {
        let codes = [("refused", false), ("ignored", true)];
        let ends = [("code", false), ("text", true)];
        let feed = keys.optional("feed_mm_per_min", 0.001..=1e6);
        Self {
            ignores_unknown_codes: keys.optional_choice("unknown_m_codes", &codes).unwrap_or(false),
            end_with_text: keys.optional_choice("end", &ends).unwrap_or(false),
            feed: feed.map(Speed::mm_per_min),
        }
    }
}

/// Fanuc's increment systems: 0.01, 0.001 and 0.0001 mm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Increments {
    /// 0.01 mm.
    A,
    /// 0.001 mm.
    B,
    /// 0.0001 mm.
    C,
}

impl Fanuc {
    fn read(keys: &mut Keys<'_>) -> Self {
        let systems = [("IS-A", Increments::A), ("IS-B", Increments::B), ("IS-C", Increments::C)];
        let points = [("increments", false), ("calculator", true)];
        let sides = [("inside", false), ("outside", true)];
        Self {
            stroke_check_outside: keys.optional_choice("stroke_check", &sides).unwrap_or(false),
            increments: keys.optional_choice("increments", &systems).unwrap_or(Increments::B),
            calculator: keys.optional_choice("decimal_point", &points).unwrap_or(false),
        }
    }
}

/// Where a drilling cycle's Z is measured from under G91.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CycleDepth {
    /// From the R plane.
    FromRPlane,
    /// From the initial level.
    FromInitialLevel,
}

/// A way along one axis of the plane, named as in G17.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoringAside {
    /// Towards larger X.
    PlusX,
    /// Towards smaller X.
    MinusX,
    /// Towards larger Y.
    PlusY,
    /// Towards smaller Y.
    MinusY,
}

/// Chips are thrown off by turning the spindle backwards between two holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipRemoval {
    /// How fast; below the speed of the cut.
    pub spin: Spin,
    /// After each hole of a cycle whose number is a multiple of this; 0 is never.
    pub every: u32,
}

/// What the follower of a synchronised move follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follows {
    /// The one planned trajectory that the spindle is commanded to as well.
    Command,
    /// The spindle's encoder.
    Encoder,
}

/// What an axis that follows an encoder makes of its readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prediction {
    /// Position loop alone on the last angle.
    None,
    /// Velocity feed-forward as well.
    Speed,
    /// An observer predicts angle, speed and acceleration over the lag.
    Observer,
}

/// What follows what in a synchronised move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Synchronisation {
    /// Command or encoder.
    pub follows: Follows,
    /// In encoder mode: what is made of the spindle's readings.
    pub prediction: Prediction,
    /// In encoder mode: age of a reading when the axis' loop uses it.
    pub encoder_age_periods: u32,
    /// Bandwidth of that observer.
    pub observer_bandwidth_hz: f64,
}

/// What is done when a geared spindle loses its phase: the tool leaves the work before anything
/// stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseLoss {
    /// So far off the gear is lost.
    pub window: Angle,
    /// The axis that takes the tool off the work.
    pub axis: canon::Axis,
    /// How far, signed.
    pub by: Length,
}

/// Time limits of the waits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waits {
    /// Until the drives are ready after the start.
    pub ready: Time,
    /// Until the spindle turns at its ordered speed, or stands.
    pub at_speed: Time,
    /// Until the spindle holds its ordered angle.
    pub oriented: Time,
    /// Until the axes are in position.
    pub in_position: Time,
    /// Until the tool is changed.
    pub tool_change: Time,
}

/// What the operator may change, as factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overrides {
    /// Largest feed override.
    pub feed_most_share: f64,
    /// Smallest spindle override.
    pub spindle_least_share: f64,
    /// Largest spindle override.
    pub spindle_most_share: f64,
}

/// The tool changer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolChange {
    /// How long it takes once the axes are there, tool to tool.
    pub time: Time,
    /// Where Z must stand.
    pub z: Length,
    /// Where X must stand; anywhere, if not stated.
    pub x: Option<Length>,
    /// Where Y must stand; anywhere, if not stated.
    pub y: Option<Length>,
    /// Pockets of the magazine.
    pub pockets: u32,
}

impl Control {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let canned = keys.optional_section("canned", Canned::read);
        Self {
            period: Time::s(keys.number("period_us", 50.0..=10_000.0) * 1e-6),
            command_delay_periods: keys.whole("command_delay_periods", 0..=16),
            dialect: keys.choice("dialect", &DIALECTS.map(|name| (name, name))),
            fanuc: keys.optional_section("fanuc", Fanuc::read),
            programs: keys.optional_section("programs", Programs::read).unwrap_or_default(),
            cycle_depth: canned.and_then(|canned| canned.depth),
            chip_removal: canned.and_then(|canned| canned.chips),
            boring_aside: canned.and_then(|canned| canned.aside),
            subprogram_path: keys.optional_text("subprogram_path"),
            synchronisation: keys.section("synchronisation", Synchronisation::read),
            waits: keys.section("waits", Waits::read),
            phase_loss: keys.optional_section("phase_loss", PhaseLoss::read),
            overrides: keys.section("overrides", Overrides::read),
            path: keys.optional_section("path", PathControl::read),
            learning: keys.optional_section("learning", |k| Learning {
                gain: k.number("gain", 0.0..=1.5),
                bandwidth_hz: k.number("bandwidth_hz", 1.0..=1000.0),
                file: k.optional_text("file"),
            }),
            start_begins_workpiece: keys
                .optional_choice("workpiece_begins", &[("by-request", false), ("at-start", true)])
                .unwrap_or(false),
        }
    }
}

/// `[control.canned]`.
#[derive(Clone, Copy)]
struct Canned {
    depth: Option<CycleDepth>,
    chips: Option<ChipRemoval>,
    aside: Option<BoringAside>,
}

impl Canned {
    fn read(keys: &mut Keys<'_>) -> Self {
        let names =
            [("r_plane", CycleDepth::FromRPlane), ("initial", CycleDepth::FromInitialLevel)];
        let depth = keys.has("z_reference").then(|| keys.choice("z_reference", &names));
        let chips = keys.optional_section("chip_removal", |k| ChipRemoval {
            spin: Spin::rpm(k.number("rpm", 1.0..=200_000.0)),
            every: k.whole("every", 0..=100_000),
        });
        let ways = [
            ("+x", BoringAside::PlusX),
            ("-x", BoringAside::MinusX),
            ("+y", BoringAside::PlusY),
            ("-y", BoringAside::MinusY),
        ];
        let aside = keys.has("boring_aside").then(|| keys.choice("boring_aside", &ways));
        Self { depth, chips, aside }
    }
}

impl Synchronisation {
    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            follows: keys
                .choice("follows", &[("command", Follows::Command), ("encoder", Follows::Encoder)]),
            prediction: keys.choice(
                "prediction",
                &[
                    ("none", Prediction::None),
                    ("speed", Prediction::Speed),
                    ("observer", Prediction::Observer),
                ],
            ),
            encoder_age_periods: keys.whole("encoder_age_periods", 0..=4),
            observer_bandwidth_hz: keys.number("observer_bandwidth_hz", 1.0..=2000.0),
        }
    }
}

impl PhaseLoss {
    fn read(keys: &mut Keys<'_>) -> Self {
        let axes = [("x", canon::Axis::X), ("y", canon::Axis::Y), ("z", canon::Axis::Z)];
        Self {
            window: Angle::deg(keys.number("window_deg", 0.01..=180.0)),
            axis: keys.choice("axis", &axes),
            by: Length::mm(keys.number("retreat_mm", -1000.0..=1000.0)),
        }
    }
}

impl Waits {
    fn read(keys: &mut Keys<'_>) -> Self {
        let mut limit = |key| Time::s(keys.number(key, 0.01..=600.0));
        Self {
            ready: limit("ready_s"),
            at_speed: limit("at_speed_s"),
            oriented: limit("oriented_s"),
            in_position: limit("in_position_s"),
            tool_change: limit("tool_change_s"),
        }
    }
}

impl PathControl {
    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            blends: keys.choice("corners", &[("exact", false), ("blend", true)]),
            tolerance: Length::mm(keys.number("tolerance_mm", 0.0001..=10.0)),
        }
    }
}

impl Overrides {
    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            feed_most_share: percent(keys, "feed_most_percent", 100.0..=400.0),
            spindle_least_share: percent(keys, "spindle_least_percent", 1.0..=100.0),
            spindle_most_share: percent(keys, "spindle_most_percent", 100.0..=400.0),
        }
    }
}

impl ToolChange {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        const FARTHEST_MM: f64 = 100_000.0;
        let bounds = -FARTHEST_MM..=FARTHEST_MM;
        Self {
            time: Time::s(keys.number("time_s", 0.0..=600.0)),
            z: Length::mm(keys.number("z_mm", bounds.clone())),
            x: keys.optional("x_mm", bounds.clone()).map(Length::mm),
            y: keys.optional("y_mm", bounds).map(Length::mm),
            pockets: keys.whole("pockets", 0..=10_000),
        }
    }
}
