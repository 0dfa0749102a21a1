//! `certificate.json`: one record per feature that was cut, for other programs to rely on.
//!
//! ```text
//!   { leadscrew, program, machine, seed, cycle_time_s, ended,
//!     alarms:   [ { number, text, line, time_s } ],
//!     features: [ { kind, line, verdict, reason, time_s, … by kind … } ] }      in the order cut
//! ```
//!
//! Keys are only ever added. Every number is finite: what could not be measured is `null`. Numbers
//! are rounded to six decimals: a micrometre of a micrometre is noise of the arithmetic.
use crate::{Error, SMALL_FILE_LIMIT, output, read_text};
use diag::{Diagnostic, Span};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::path::Path;
use units::{Angle, Force, Lead, Length, Spin, Time, Torque};

mod evidence;
mod gear;
mod milling;
mod supervision;
mod turned;
pub use evidence::{Clamping, Contact, Count, Inputs, Tolerances, sha256};
pub use gear::{Gear, ToothSize};
pub use milling::{At, Milling};
pub use supervision::{Supervision, SupervisionStop};
pub use turned::{TurnedSizes, TurnedThread};

/// Bytes a certificate may have: a feature takes about 700.
pub const CERTIFICATE_LIMIT: u64 = 256 * SMALL_FILE_LIMIT;

/// A run, and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// Version of the program that wrote it.
    pub leadscrew: String,
    /// Name of the part program.
    pub program: String,
    /// Name of the machine.
    pub machine: String,
    /// Seed of everything that scattered.
    pub seed: u64,
    /// Number of the workpiece on that machine; the first one is not stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<u32>,
    /// How long the program took on the machine.
    pub cycle_time_s: Measured,
    /// The program reached its end.
    pub ended: bool,
    /// Of the whole run: pass only if the program ended, nothing broke an invariant and every
    /// feature passed.
    #[serde(default)]
    pub verdict: Verdict,
    /// Features by their verdicts.
    #[serde(default)]
    pub count: Count,
    /// What the workpiece is made of.
    #[serde(default)]
    pub material: String,
    /// By which the features were judged.
    #[serde(default)]
    pub tolerances: Tolerances,
    /// Where the set-up has the workpiece: what was judged stands there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Clamping>,
    /// Hashes of what the run was made from.
    #[serde(default)]
    pub inputs: Inputs,
    /// What stopped or warned.
    pub alarms: Vec<Alarm>,
    /// What may never happen, and whether it did.
    #[serde(default)]
    pub invariants: Invariants,
    /// Tools that were taken off work to which they were tied, but not screwed: threads, cams,
    /// polygons, gears.
    #[serde(default)]
    pub withdrawals: Vec<Withdrawal>,
    /// What was cut, in that order.
    pub features: Vec<Feature>,
}

/// A tool that was taken off the work after a stop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Withdrawal {
    /// Program line at work.
    pub line: u32,
    /// What was being cut.
    pub cut: String,
    /// The axis that took it off first.
    pub axis: String,
    /// How far, signed.
    pub by_mm: Measured,
}

/// What was looked for in every servo period.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Invariants {
    /// Periods looked at.
    pub periods: u64,
    /// Periods in which something was wrong.
    pub violations: u64,
    /// What, each once when it began.
    pub breaches: Vec<String>,
}

/// An alarm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alarm {
    /// Its number in the manual.
    pub number: u32,
    /// Its sentence.
    pub text: String,
    /// Program line at work, if there was one.
    pub line: Option<u32>,
    /// When, since the start.
    pub time_s: Measured,
}

/// Something that was cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Feature {
    /// A drilled hole.
    Hole(Hole),
    /// A thread.
    Thread(Box<Thread>),
    /// A polygon.
    Polygon(Polygon),
    /// A cam.
    Cam(Cam),
    /// A thread turned with a single point.
    #[serde(rename = "turned-thread")]
    Turned(Box<TurnedThread>),
    /// A hobbed gear.
    Gear(Gear),
    /// The use of a mill.
    Milling(Box<Milling>),
}

/// What every feature has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Common {
    /// Program line that cut it.
    pub line: u32,
    /// Within tolerance or not.
    pub verdict: Verdict,
    /// Why it is as it is, in one sentence; as a rule only of a fail.
    pub reason: Option<String>,
    /// When it was finished, since the start.
    pub time_s: Measured,
    /// What says that the tool was in the material.
    #[serde(default)]
    pub contact: Contact,
}

/// Within tolerance or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Within.
    Pass,
    /// Not.
    Fail,
    /// It could not be measured.
    #[default]
    #[serde(rename = "not judged")]
    NotJudged,
}

impl Feature {
    /// What every feature has.
    pub const fn common(&self) -> &Common {
        match self {
            Self::Hole(hole) => &hole.common,
            Self::Thread(thread) => &thread.common,
            Self::Polygon(polygon) => &polygon.common,
            Self::Gear(gear) => &gear.common,
            Self::Milling(milling) => &milling.common,
            Self::Cam(cam) => &cam.common,
            Self::Turned(thread) => &thread.common,
        }
    }
}

/// A drilled hole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hole {
    /// What every feature has.
    #[serde(flatten)]
    pub common: Common,
    /// Where.
    pub x_mm: Measured,
    /// Where.
    pub y_mm: Measured,
    /// How deep.
    pub depth_mm: Measured,
    /// How wide.
    pub diameter_mm: Measured,
    /// Chips were thrown off afterwards.
    #[serde(default)]
    pub chip_removal: bool,
}

/// A thread; errors and forces are those in the material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Thread {
    /// What every feature has.
    #[serde(flatten)]
    pub common: Common,
    /// Where, on a mill.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_mm: Option<Measured>,
    /// Where, on a mill.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_mm: Option<Measured>,
    /// Where it starts, on a lathe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_mm: Option<Measured>,
    /// Such as "M6x1".
    pub size: String,
    /// Right or left.
    pub hand: Hand,
    /// Lead, without the sign of the hand.
    pub lead_mm: Measured,
    /// Depth of full thread.
    pub depth_mm: Measured,
    /// Depth of the tap's tip less the programmed one.
    pub depth_error_um: Measured,
    /// Fastest that the spindle turned.
    pub rpm_max: Measured,
    /// Largest synchronisation error.
    pub sync_error_max_um: Measured,
    /// Its root mean square.
    pub sync_error_rms_um: Measured,
    /// Largest cumulative error of the lead over the engagement.
    pub lead_error_um: Measured,
    /// How much wider than the tool the groove is, along the axis.
    pub groove_widening_um: Measured,
    /// Simple pitch diameter.
    pub pitch_diameter_mm: Measured,
    /// Tolerance class, such as "6H".
    pub class: String,
    /// What is left to the nearer limit; negative outside.
    pub margin_um: Measured,
    /// Largest torque of the cut.
    pub torque_max_n_m: Measured,
    /// Largest torque on the way in.
    #[serde(default)]
    pub torque_in_n_m: Measured,
    /// Largest torque on the way out, once the chip's root is sheared.
    #[serde(default)]
    pub torque_out_n_m: Measured,
    /// Torque that the tap makers' formula expects on the way in.
    #[serde(default)]
    pub torque_model_n_m: Measured,
    /// How far the formula is believed, each way, in percent of it.
    #[serde(default)]
    pub torque_model_band_percent: Measured,
    /// Both ways are within what the formula expects.
    #[serde(default)]
    pub torque_expected: Option<bool>,
    /// Largest axial force on the tool.
    pub axial_force_max_n: Measured,
    /// Spindle angle at which it starts.
    pub start_angle_deg: Measured,
    /// Chips were thrown off afterwards.
    pub chip_removal: bool,
    /// The tool was driven out of it by a recovery.
    pub recovered: bool,
    /// What supervision by measured torque saw, a record for each stroke; empty: not supervised.
    /// The verdict is the judge's alone.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub supervision: Vec<Supervision>,
}

/// Hand of a thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hand {
    /// Clockwise goes in.
    Right,
    /// Counter-clockwise goes in.
    Left,
}

/// A turned polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    /// What every feature has.
    #[serde(flatten)]
    pub common: Common,
    /// How many.
    pub sides: u32,
    /// Across flats.
    pub across_flats_mm: Measured,
    /// Of the worst facet, by the minimum zone.
    pub flatness_um: Measured,
    /// Of the worst facet.
    pub tilt_deg: Measured,
    /// Between facets.
    pub corner_angle_deg: Measured,
    /// Where it begins.
    pub z_from_mm: Measured,
    /// Where it ends.
    pub z_to_mm: Measured,
    /// Speed of the work.
    pub rpm: Measured,
    /// Across flats less what was programmed.
    #[serde(default)]
    pub across_flats_error_um: Measured,
    /// Largest distance of a facet from the axis less the smallest.
    #[serde(default)]
    pub facet_difference_um: Measured,
    /// Height of the feed's marks along Z, peak to valley.
    #[serde(default)]
    pub lay_um: Measured,
    /// Change of the size across flats with each millimetre towards positive Z.
    #[serde(default)]
    pub taper_um_per_mm: Measured,
    /// The same less what was programmed.
    #[serde(default)]
    pub taper_error_um_per_mm: Measured,
    /// Turn of the facets with each millimetre towards positive Z.
    #[serde(default)]
    pub twist_deg_per_mm: Measured,
    /// The same less what was programmed.
    #[serde(default)]
    pub twist_error_deg_per_mm: Measured,
    /// The machine stopped while the cutter was geared to the work.
    #[serde(default)]
    pub broken_off: bool,
}

/// A ground cam.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cam {
    /// What every feature has.
    #[serde(flatten)]
    pub common: Common,
    /// Name of the profile.
    pub profile: String,
    /// Speed of the work.
    pub rpm: Measured,
    /// Measured phase error.
    pub phase_error_deg: Measured,
    /// Largest contour error.
    pub contour_error_max_um: Measured,
    /// Its root mean square.
    pub contour_error_rms_um: Measured,
    /// Revolutions of the work.
    pub revolutions: Measured,
    /// Spread of the contour error on the base circle.
    #[serde(default)]
    pub run_out_um: Measured,
    /// Largest change of the contour error for each degree.
    #[serde(default)]
    pub speed_error_um_per_deg: Measured,
    /// Largest wave in the band of chatter.
    #[serde(default)]
    pub waviness_um: Measured,
    /// How many of it a turn.
    #[serde(default)]
    pub waves_per_rev: Measured,
    /// Greatest removal rate over its mean, in the last turn; 1 is even.
    #[serde(default)]
    pub removal_rate_peak: Measured,
    /// The same if the work had turned evenly.
    #[serde(default)]
    pub removal_rate_peak_even: Measured,
}

/// A number that is finite, or not known. Constructors name the unit that the key has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured(Option<f64>);

impl Measured {
    /// Not measured.
    pub const UNKNOWN: Self = Self(None);

    /// A bare number; unknown if it is not finite.
    pub fn number(value: f64) -> Self {
        Self(Some(value).filter(|v| v.is_finite()))
    }
    /// For a key that ends in `_mm`.
    pub fn mm(value: Length) -> Self {
        Self::number(value.value())
    }
    /// For a key that ends in `_um`.
    pub fn um(value: Length) -> Self {
        Self::number(value.in_um())
    }
    /// For `lead_mm`: without sign.
    pub fn lead(value: Lead) -> Self {
        Self::number(value.value().abs())
    }
    /// For a key that ends in `_deg`.
    pub fn deg(value: Angle) -> Self {
        Self::number(value.in_deg())
    }
    /// For a key with `rpm`.
    pub fn rpm(value: Spin) -> Self {
        Self::number(value.in_rpm())
    }
    /// For a key that ends in `_s`.
    pub fn s(value: Time) -> Self {
        Self::number(value.value())
    }
    /// For a key that ends in `_n_m`.
    pub fn n_m(value: Torque) -> Self {
        Self::number(value.value())
    }
    /// For a key that ends in `_n`.
    pub fn n(value: Force) -> Self {
        Self::number(value.value())
    }
    /// The number, in the key's unit.
    pub const fn value(self) -> Option<f64> {
        self.0
    }
}

impl Serialize for Measured {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        const STEPS_PER_UNIT: f64 = 1e6;
        const ROUNDED_BELOW: f64 = 1e9; // above, f64 has not many decimals left to round
        let rounded = self.0.map(|v| {
            let coarse = (v * STEPS_PER_UNIT).round() / STEPS_PER_UNIT;
            if v.abs() < ROUNDED_BELOW { coarse + 0.0 } else { v } // + 0.0: no "-0.0"
        });
        rounded.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Measured {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Option::deserialize(deserializer).map(Self)
    }
}

impl Certificate {
    /// Its text.
    ///
    /// # Panics
    /// Never: it holds nothing that JSON cannot say.
    pub fn to_json(&self) -> String {
        #[allow(clippy::expect_used)] // maps have string keys and no Serialize of ours fails
        let mut text = serde_json::to_string_pretty(self).expect("plain data serialises");
        text.push('\n');
        text
    }

    /// Write it, whole or not at all.
    ///
    /// # Errors
    /// When the file system refuses.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        output::write_file(path, self.to_json().as_bytes())
    }

    /// Read it from its text. Keys of later versions are passed over.
    ///
    /// # Errors
    /// S0701 with the place where it is not a certificate.
    pub fn parse(text: &str) -> Result<Self, Diagnostic> {
        serde_json::from_str(text).map_err(|e| {
            let before = text.split_inclusive('\n').take(e.line().saturating_sub(1));
            let start = before.map(str::len).sum::<usize>() + e.column().saturating_sub(1);
            // the parser counts bytes: a place within a letter would not be one
            let small = |n| u32::try_from(text.floor_char_boundary(n)).unwrap_or(u32::MAX);
            let line = small(e.line().max(1));
            let place = Span { file: 0, line, start: small(start), end: small(start + 1) };
            let message = e.to_string();
            let sentence = message.split(" at line ").next().unwrap_or_default();
            Diagnostic::error("S0701", place, format!("not a certificate: {sentence}"))
        })
    }

    /// Read it from its file.
    ///
    /// # Errors
    /// When the file cannot be read or is not a certificate.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text = read_text(path, "a certificate", CERTIFICATE_LIMIT)?;
        Self::parse(&text).map_err(|finding| Error::refused(path, text, vec![finding]))
    }
}
