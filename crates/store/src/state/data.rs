//! The data that are kept, and their text.
use super::Datum;
use super::changer::ChangerRecord;
use crate::parameters::Parameters;
use crate::tools;
use canon::ToolLibrary;
use diag::Diagnostic;
use serde::{Deserialize, Serialize};

/// Farthest that a reference may be from zero, mm or degrees.
const FARTHEST: f64 = 1e9;
/// Most that an override may be.
const MOST_OVERRIDE: f64 = 10.0;
/// Levels of block skip.
const SKIP_LEVELS: std::ops::RangeInclusive<u8> = 1..=9;

/// The reference of an axis whose encoder is absolute.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HomedAxis {
    /// Letter of the axis.
    pub axis: char,
    /// Machine coordinate where the encoder reads zero, mm or degrees.
    pub zero: f64,
    /// Number that the encoder changes when it loses its own reference: another one voids this.
    pub epoch: u64,
}

/// References of absolute encoders.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Homing {
    /// Those of the axes that have one.
    #[serde(default)]
    pub axis: Vec<HomedAxis>,
}

impl Homing {
    /// Reference of an axis, if its encoder has kept its own.
    pub fn of(&self, axis: char, epoch: u64) -> Option<&HomedAxis> {
        self.axis.iter().find(|homed| homed.axis == axis && homed.epoch == epoch)
    }
}

/// The program that was started last, and how far it came.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LastProgram {
    /// Its path, as it was named.
    pub path: String,
    /// SHA-256 of its texts, those of the files that it calls among them: others make the position
    /// meaningless.
    pub sha256: String,
    /// Line of the block that was being executed.
    pub line: u32,
    /// Index of that operation in the program.
    pub operation: u32,
    /// Its holes and threads that were begun in its last run.
    pub feature: u32,
    /// It had come to its end.
    pub is_completed: bool,
}

/// The unit in which lengths are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthDisplay {
    /// mm.
    #[default]
    Millimetre,
    /// in.
    Inch,
}

/// What the operator has set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Share of the programmed feed.
    pub feed_override: f64,
    /// Share of the rapids.
    pub rapid_override: f64,
    /// Share of the programmed spindle speed.
    pub spindle_override: f64,
    /// Hold after each block.
    pub single_block: bool,
    /// Stop at M1.
    pub optional_stop: bool,
    /// Levels of `/` that are left out.
    pub block_skip: Vec<u8>,
    /// Unit in which lengths are shown.
    pub units: LengthDisplay,
}

impl Default for Settings {
    /// As a control is delivered.
    fn default() -> Self {
        Self {
            feed_override: 1.0,
            rapid_override: 1.0,
            spindle_override: 1.0,
            single_block: false,
            optional_stop: false,
            block_skip: Vec::new(),
            units: LengthDisplay::default(),
        }
    }
}

/// The workpiece on the machine, and what was cut from it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorkpieceRecord {
    /// Its number on this machine, from 1.
    pub number: u32,
    /// Its name; empty: it has none.
    pub name: String,
    /// Programs that were started on it.
    pub programs: u32,
    /// Its features that are within tolerance.
    pub good: u64,
    /// Its features that are out of it.
    pub failed: u64,
    /// Its features that were not judged.
    pub not_judged: u64,
    /// It has ended.
    pub is_ended: bool,
}

/// Whose folder it is, as folders without a manifest say it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Name in the machine's file.
    pub name: String,
}

/// Files of the data.
pub(super) const FILES: [&str; 7] = [
    Parameters::FILE,
    ToolLibrary::FILE,
    Homing::FILE,
    LastProgram::FILE,
    Settings::FILE,
    WorkpieceRecord::FILE,
    ChangerRecord::FILE,
];

/// Kind and version that the file of this name begins with.
pub(super) fn kind(file: &str) -> (&'static str, u32) {
    const KNOWN: [(&str, &str, u32); 7] = [
        of::<Parameters>(),
        of::<ToolLibrary>(),
        of::<Homing>(),
        of::<LastProgram>(),
        of::<Settings>(),
        of::<WorkpieceRecord>(),
        of::<ChangerRecord>(),
    ];
    const fn of<D: Datum>() -> (&'static str, &'static str, u32) {
        (D::FILE, D::KIND, D::VERSION)
    }
    let known = KNOWN.iter().find(|(name, ..)| *name == file);
    known.map_or(("unknown", 0), |(_, kind, version)| (kind, *version))
}

/// Text of a plain struct. Its keys are names and its values numbers, text and lists: that cannot
/// fail.
pub(super) fn to_toml<T: Serialize>(value: &T) -> String {
    toml::to_string(value).unwrap_or_default()
}

pub(super) fn from_toml<T: for<'de> Deserialize<'de>>(body: &str) -> Result<T, String> {
    toml::from_str(body).map_err(|e| one_line(e.message()))
}

fn one_line(text: &str) -> String {
    text.trim().replace('\n', ", ")
}

/// The first finding of a reader, with its line in the file.
fn first(found: Vec<Diagnostic>) -> String {
    let first = found.into_iter().next();
    first
        .map_or_else(String::new, |d| format!("line {}: {}", d.span.line + 1, one_line(&d.message)))
}

impl Datum for Parameters {
    const FILE: &'static str = "parameters.var";
    const KIND: &'static str = "parameters";

    fn body(&self) -> String {
        self.to_text()
    }

    fn parse(body: &str) -> Result<Self, String> {
        Self::parse(body, 0).map_err(first)
    }
}

impl Datum for ToolLibrary {
    const FILE: &'static str = "tools.toml";
    const KIND: &'static str = "tools";
    // ten thousand tools
    const LARGEST: u64 = 16 << 20;

    fn body(&self) -> String {
        tools::to_toml(self)
    }

    fn parse(body: &str) -> Result<Self, String> {
        tools::parse_controls_toml(body).map_err(first)
    }
}

impl Datum for Homing {
    const FILE: &'static str = "homing.toml";
    const KIND: &'static str = "homing";

    fn body(&self) -> String {
        to_toml(self)
    }

    fn parse(body: &str) -> Result<Self, String> {
        let read: Self = from_toml(body)?;
        for (at, homed) in read.axis.iter().enumerate() {
            if !"XYZABCUVW".contains(homed.axis) {
                return Err(format!("`{}` is no axis", homed.axis));
            }
            if read.axis[..at].iter().any(|other| other.axis == homed.axis) {
                return Err(format!("{} is there twice", homed.axis));
            }
            if !(-FARTHEST..=FARTHEST).contains(&homed.zero) {
                return Err(format!("the zero of {} is {}", homed.axis, homed.zero));
            }
        }
        Ok(read)
    }
}

impl Datum for LastProgram {
    const FILE: &'static str = "program.toml";
    const KIND: &'static str = "program";

    fn body(&self) -> String {
        to_toml(self)
    }

    fn parse(body: &str) -> Result<Self, String> {
        from_toml(body)
    }
}

impl Datum for Settings {
    const FILE: &'static str = "settings.toml";
    const KIND: &'static str = "settings";

    fn body(&self) -> String {
        to_toml(self)
    }

    fn parse(body: &str) -> Result<Self, String> {
        let read: Self = from_toml(body)?;
        for (name, share) in [
            ("feed", read.feed_override),
            ("rapid", read.rapid_override),
            ("spindle", read.spindle_override),
        ] {
            if !(0.0..=MOST_OVERRIDE).contains(&share) {
                return Err(format!(
                    "the {name} override is {share}: 0 to {MOST_OVERRIDE} is possible"
                ));
            }
        }
        match read.block_skip.iter().find(|level| !SKIP_LEVELS.contains(level)) {
            Some(level) => Err(format!("block skip has levels 1 to 9, and this is {level}")),
            None => Ok(read),
        }
    }
}

impl Datum for WorkpieceRecord {
    const FILE: &'static str = "workpiece.toml";
    const KIND: &'static str = "workpiece";

    fn body(&self) -> String {
        to_toml(self)
    }

    fn parse(body: &str) -> Result<Self, String> {
        from_toml(body)
    }
}

impl Datum for Machine {
    const FILE: &'static str = "machine.toml";
    const KIND: &'static str = "machine";

    fn body(&self) -> String {
        to_toml(self)
    }

    fn parse(body: &str) -> Result<Self, String> {
        from_toml(body)
    }
}
