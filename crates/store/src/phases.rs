//! The table of phase errors of periodic couplings, Δθ over profile and speed, with what was
//! learnt.
//!
//! ```text
//!   version = 2
//!   machine = "cam-grinder"
//!   mark = "5bd1e995"                 of the machine's drives and loops: another mark, and the table is stale
//!   [[measured]]
//!   profile = 1234
//!   form = "0c55aa01"                 mark of the profile's nodes
//!   rpm = 10.0
//!   phase_error_deg = 0.4971          θ measured less θ ideal: positive, the follower is late
//!   response = [[0.1667, 0.9999, 0.00138], …]     Hz, gain, delay in turns of the wave
//!   [[swing]]                         an oscillation of polygon turning, measured in an air cut
//!   on = "tool phase"                 or an axis, "X"
//!   form = "1f2e3d4c"                 mark of its harmonics
//!   rpm = 500.0
//!   sent = [[6, 0.0001, 0.0026], …]   periods a turn, cosine, sine: what comes out as ordered
//!   response = …
//! ```
//!
//! What all such files have in common is in `kept_file`.
use crate::kept_file::{KeptFile, Whose, mark};
use crate::{Error, SMALL_FILE_LIMIT};
use diag::Diagnostic;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Entries a table may have.
const MOST: usize = 4096;

/// What was measured of one profile at one speed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// The profile's number.
    pub profile: u32,
    /// Mark of its nodes: another form under the same number is another profile.
    pub form: String,
    /// Speed of the work, rev/min.
    pub rpm: f64,
    /// By least squares.
    pub phase_error_deg: f64,
    /// Its standard deviation.
    pub sigma_deg: f64,
    /// By the places of the maxima.
    pub by_maximum_deg: f64,
    /// By the mean shift of the flanks.
    pub by_flanks_deg: f64,
    /// Frequency in Hz, gain, delay in turns of the wave.
    #[serde(default)]
    pub response: Vec<[f64; 3]>,
    /// What learning adds to each node, nm.
    #[serde(default)]
    pub learnt_nm: Vec<f64>,
    /// Mark of the nodes for which it was learnt; empty: the profile's.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub learnt_form: String,
}

/// What was measured of one oscillation at one speed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Swung {
    /// What swings: an axis' letter, or "tool phase".
    pub on: String,
    /// Mark of its harmonics as ordered.
    pub form: String,
    /// Speed of the work, rev/min.
    pub rpm: f64,
    /// What is to be sent: periods a turn, amplitude of the cosine and of the sine, mm or rev.
    pub sent: Vec<[f64; 3]>,
    /// Frequency in Hz, gain, delay in turns of the wave.
    pub response: Vec<[f64; 3]>,
}

/// The table.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Phases {
    version: u32,
    /// Name of the machine.
    pub machine: String,
    /// Mark of its drives and loops.
    pub mark: String,
    /// What was measured.
    #[serde(default)]
    pub measured: Vec<Measured>,
    /// What was measured of oscillations.
    #[serde(default, rename = "swing", skip_serializing_if = "Vec::is_empty")]
    pub swung: Vec<Swung>,
}

/// The mark of a profile's nodes.
pub fn form_mark(nodes: &[f64]) -> String {
    let mut text = String::new();
    for node in nodes {
        text += &format!("{node:.6} ");
    }
    format!("{:08x}", mark(&text))
}

impl Measured {
    fn makes_sense(&self) -> bool {
        let figures = [
            self.rpm,
            self.phase_error_deg,
            self.sigma_deg,
            self.by_maximum_deg,
            self.by_flanks_deg,
        ];
        let all = figures.iter().chain(self.response.iter().flatten()).chain(&self.learnt_nm);
        self.rpm > 0.0 && all.into_iter().all(|x| x.is_finite())
    }
}

impl Swung {
    fn makes_sense(&self) -> bool {
        let figures = self.sent.iter().chain(&self.response).flatten();
        self.rpm > 0.0 && self.rpm.is_finite() && figures.copied().all(f64::is_finite)
    }
}

impl KeptFile for Phases {
    const WHAT: &'static str = "a table of phase errors";
    const VERSION: u32 = 2;
    const LONGEST: u64 = SMALL_FILE_LIMIT * 16;
    const CODES: [&'static str; 3] = ["S1101", "S1102", "S1103"];
    const INSTEAD: &'static str = "measure again, into a new file or after removing this one";

    fn whose(&self) -> Whose<'_> {
        Whose { version: self.version, machine: &self.machine, mark: &self.mark }
    }

    fn makes_sense(&self) -> Result<(), String> {
        if self.measured.len() + self.swung.len() > MOST {
            return Err(format!("more than {MOST} measurements"));
        }
        if let Some(bad) = self.measured.iter().find(|m| !m.makes_sense()) {
            let (profile, rpm) = (bad.profile, bad.rpm);
            return Err(format!("profile {profile} at {rpm} rpm: expected finite numbers"));
        }
        if let Some(bad) = self.swung.iter().find(|s| !s.makes_sense()) {
            let (on, rpm) = (&bad.on, bad.rpm);
            return Err(format!("oscillation of {on} at {rpm} rpm: expected finite numbers"));
        }
        Ok(())
    }
}

impl Phases {
    /// Nothing measured yet on this machine.
    pub fn new(machine: &str, mark: u32) -> Self {
        Self {
            version: Self::VERSION,
            machine: machine.into(),
            mark: format!("{mark:08x}"),
            measured: Vec::new(),
            swung: Vec::new(),
        }
    }

    /// Read a table for this machine; `None` if there is no file.
    ///
    /// # Errors
    /// It cannot be read, is damaged, or belongs to another machine or to other servo parameters.
    pub fn load(path: &Path, machine: &str, mark: u32) -> Result<Option<Self>, Error> {
        Self::read_for(path, machine, mark)
    }

    /// Read a table from text.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str) -> Result<Self, Vec<Diagnostic>> {
        Self::read(text)
    }

    /// Write it, whole or not at all.
    ///
    /// # Errors
    /// The file system refuses.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        self.write(path)
    }

    /// Keep a measurement in the place of an older one of the same profile and speed.
    pub fn keep(&mut self, new: Measured) {
        let same = |m: &Measured| m.profile == new.profile && (m.rpm - new.rpm).abs() < 1e-6;
        self.measured.retain(|m| !same(m));
        self.measured.push(new);
        let key = |m: &Measured| (m.profile, m.rpm);
        self.measured
            .sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
    }

    /// Keep what was measured of an oscillation, likewise.
    pub fn keep_swung(&mut self, new: Swung) {
        let same =
            |s: &Swung| s.on == new.on && s.form == new.form && (s.rpm - new.rpm).abs() < 1e-6;
        self.swung.retain(|s| !same(s));
        self.swung.push(new);
        self.swung
            .sort_by(|a, b| (&a.on, &a.form).cmp(&(&b.on, &b.form)).then(a.rpm.total_cmp(&b.rpm)));
    }

    /// What was measured of this form, by rising speed.
    pub fn of<'a>(&'a self, profile: u32, form: &'a str) -> impl Iterator<Item = &'a Measured> {
        self.measured.iter().filter(move |m| m.profile == profile && m.form == form)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Phases {
        let mut table = Phases::new("cam-grinder", 0x5bd1_e995);
        for rpm in [60.0, 10.0] {
            let response = vec![[rpm / 60.0, 0.99, 0.01]];
            table.keep(Measured {
                profile: 1234,
                form: "0c55aa01".into(),
                rpm,
                phase_error_deg: 0.5,
                response,
                ..Measured::default()
            });
        }
        table
    }

    #[test]
    fn a_table_reads_as_it_was_written_sorted_by_speed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("phases.toml");
        table().save(&path).unwrap();
        let read = Phases::load(&path, "cam-grinder", 0x5bd1_e995).unwrap().unwrap();
        assert_eq!(read, table());
        let speeds: Vec<f64> = read.of(1234, "0c55aa01").map(|m| m.rpm).collect();
        assert_eq!(speeds, [10.0, 60.0]);
        assert_eq!(read.of(1234, "another").count(), 0);
    }

    #[test]
    fn oscillations_stand_in_the_same_table_and_a_new_one_takes_the_place_of_the_old() {
        let mut table = table();
        for gain in [1.1, 1.2] {
            table.keep_swung(Swung {
                on: "tool phase".into(),
                form: "1f2e3d4c".into(),
                rpm: 500.0,
                sent: vec![[6.0, 0.0, 0.0026 / gain]],
                response: vec![[50.0, gain, 0.01]],
            });
        }
        assert_eq!(Phases::parse(&table.text()).unwrap(), table);
        assert_eq!((table.swung.len(), table.swung[0].response[0][1]), (1, 1.2));
        table.swung[0].rpm = -500.0;
        assert!(Phases::parse(&table.text()).is_err());
    }

    #[test]
    fn a_stale_a_foreign_a_newer_and_a_damaged_table_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("phases.toml");
        table().save(&path).unwrap();
        let stale = Phases::load(&path, "cam-grinder", 1).unwrap_err().to_string();
        assert!(stale.contains("has been changed since"), "{stale}");
        let foreign = Phases::load(&path, "another", 0x5bd1_e995).unwrap_err().to_string();
        assert!(foreign.contains("this is of cam-grinder"), "{foreign}");
        let text = std::fs::read_to_string(&path).unwrap();
        let newer = Phases::parse(&text.replace("version = 2", "version = 3")).unwrap_err();
        assert_eq!(newer[0].message, "expected version 2, found 3");
        let mut spoilt = table();
        spoilt.measured[0].rpm = f64::NAN;
        assert!(Phases::parse(&spoilt.text()).is_err());
        for cut in [0, text.len() / 2, text.len() - 3] {
            assert!(Phases::parse(&text[..cut]).is_err(), "cut at {cut}");
        }
    }
}
