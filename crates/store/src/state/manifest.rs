//! What a control has written last, in one file and its copy: `manifest.toml`,
//! `manifest.copy.toml`.
//!
//! ```text
//!   commit: manifest.toml ─► fsync ─► the data's own files, manifest.copy.toml ─► fsync
//!   start:  the copy of the highest generation says what was written last; a datum's file is
//!           compared with it
//! ```
//!
//! It has the text of each datum, so that a file that is damaged, older or gone costs nothing; the
//! machine whose state it is; and what differed at a start and was not acknowledged yet.
use super::changes::StateChange;
use super::seal::Datum;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;

/// The first copy, and the second.
pub(super) const MANIFESTS: [&str; 2] = ["manifest.toml", "manifest.copy.toml"];

/// The machine that a state belongs to: its name, and what coordinates mean on it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineIdentity {
    /// Name in the machine's file.
    pub name: String,
    /// Letters of its axes.
    pub axes: String,
    /// Number of its spindles.
    pub spindles: u32,
}

impl MachineIdentity {
    /// Of a machine's file.
    pub fn of(machine: &crate::machine::MachineFile) -> Self {
        Self {
            name: machine.name.clone(),
            axes: machine.axes.iter().flatten().map(|axis| axis.letter.letter()).collect(),
            spindles: machine.spindles.len() as u32,
        }
    }
}

impl fmt::Display for MachineIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, axes, spindles } = self;
        let plural = if *spindles == 1 { "" } else { "s" };
        write!(f, "`{name}` (axes {axes}, {spindles} spindle{plural})")
    }
}

/// Where and when a file was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// Generation of the manifest with which it was written.
    pub generation: u64,
    /// The moment, UTC.
    pub when: String,
    /// Mark of the folder, made when it was new.
    pub folder: String,
    /// Name of the machine.
    pub machine: String,
}

const BEGINS: &str = "# generation ";

impl Origin {
    /// The line that says it.
    pub(super) fn line(&self) -> String {
        let Self { generation, when, folder, machine } = self;
        let machine = machine.replace('\n', " ");
        format!("{BEGINS}{generation}, {when}, folder {folder}, machine {machine}\n")
    }

    /// Returns what a body's first line says of it, and the rest of the body.
    pub(super) fn split(body: &str) -> (Option<Self>, &str) {
        let read = || {
            let (line, rest) = body.split_once('\n')?;
            let mut parts = line.strip_prefix(BEGINS)?.splitn(4, ", ");
            let generation = parts.next()?.parse().ok()?;
            let when = parts.next()?.to_owned();
            let folder = parts.next()?.strip_prefix("folder ")?.to_owned();
            let machine = parts.next()?.trim_end().strip_prefix("machine ")?.to_owned();
            Some((Self { generation, when, folder, machine }, rest))
        };
        read().map_or((None, body), |(origin, rest)| (Some(origin), rest))
    }
}

/// A datum as it was written last.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenDatum {
    /// Name of its file.
    pub(super) name: String,
    /// Generation in which it was written, and the one before; 0 is none.
    pub(super) generation: u64,
    pub(super) before: u64,
    /// The moment, UTC.
    pub(super) when: String,
    /// Its text.
    pub(super) body: String,
}

/// See the module's header.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Manifest {
    /// One more at each commit.
    pub(super) generation: u64,
    /// Mark of the folder.
    pub(super) folder: String,
    /// Number of the last alarm that was kept.
    #[serde(default)]
    pub(super) alarms: u64,
    pub(super) machine: MachineIdentity,
    /// What differed at a start, and was not acknowledged.
    #[serde(default)]
    pub(super) unacknowledged: Vec<StateChange>,
    #[serde(default)]
    pub(super) file: Vec<WrittenDatum>,
}

impl Manifest {
    /// That of a new folder.
    pub(super) fn new(machine: MachineIdentity, path: &Path) -> Self {
        let seed = format!("{}:{}:{}", unix_ns(), std::process::id(), path.display());
        let mut folder = crate::certificate::sha256(seed.as_bytes());
        folder.truncate(12);
        Self { folder, machine, ..Self::default() }
    }

    pub(super) fn entry(&self, name: &str) -> Option<&WrittenDatum> {
        self.file.iter().find(|entry| entry.name == name)
    }

    /// A datum is written with this generation.
    pub(super) fn set(&mut self, name: &str, body: String) {
        let (generation, when) = (self.generation, now());
        let before = self.entry(name).map_or(0, |entry| {
            if entry.generation == generation { entry.before } else { entry.generation }
        });
        self.file.retain(|entry| entry.name != name);
        self.file.push(WrittenDatum { name: name.to_owned(), generation, before, when, body });
    }

    /// What a file's second line says.
    pub(super) fn origin(&self, entry: &WrittenDatum) -> Origin {
        Origin {
            generation: entry.generation,
            when: entry.when.clone(),
            folder: self.folder.clone(),
            machine: self.machine.name.clone(),
        }
    }
}

impl Datum for Manifest {
    const FILE: &'static str = MANIFESTS[0];
    const KIND: &'static str = "manifest";
    // the text of each datum once
    const LARGEST: u64 = 32 << 20;

    fn body(&self) -> String {
        super::data::to_toml(self)
    }

    fn parse(body: &str) -> Result<Self, String> {
        super::data::from_toml(body)
    }
}

/// When a state is written is no input of a run: it is said to people.
#[allow(clippy::disallowed_methods)]
fn unix_ns() -> u128 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.map_or(0, |since| since.as_nanos())
}

/// The moment, UTC, as `2026-11-29T17:02:37Z`.
fn now() -> String {
    utc((unix_ns() / 1_000_000_000) as i64)
}

/// Today's date, UTC, as `2026-11-29`.
pub fn today() -> String {
    now().chars().take(10).collect()
}

/// Seconds since 1970 as a date of the Gregorian calendar (Hinnant, chrono-Compatible Low-Level
/// Date Algorithms, `civil_from_days`).
fn utc(unix_s: i64) -> String {
    let (days, second) = (unix_s.div_euclid(86_400), unix_s.rem_euclid(86_400));
    let from_march = days + 719_468; // days since 0000-03-01
    let era = from_march.div_euclid(146_097);
    let of_era = from_march.rem_euclid(146_097);
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * of_year + 2) / 153;
    let day = of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    let (hour, minute) = (second / 3600, second / 60 % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{:02}Z", second % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_dates_of_the_calendar() {
        for (unix_s, date) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_790_000_000, "2026-09-21T14:13:20Z"),
        ] {
            assert_eq!(utc(unix_s), date);
        }
    }

    #[test]
    fn an_origin_reads_back_whatever_a_machine_is_called() {
        for machine in ["tapping-center", "a, b, machine c", "x y"] {
            let origin = Origin {
                generation: 7,
                when: "2026-09-21T14:13:20Z".into(),
                folder: "abc".into(),
                machine: machine.into(),
            };
            let text = format!("{}body\n", origin.line());
            assert_eq!(Origin::split(&text), (Some(origin), "body\n"));
        }
        assert_eq!(Origin::split("body\n"), (None, "body\n"));
    }
}
