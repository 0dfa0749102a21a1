//! Cam libraries and lift tables.
//!
//! ```text
//!   nodes = 720                          angle,lift          # degrees, mm: one row a line, a whole turn
//!   [[cam]]                              0.0,0.0000
//!   number = 1234                        0.5,0.0003
//!   name = "intake"                      …
//!   kind = "table"
//!   file = "intake.csv"
//!   base_mm = 34
//!   follower = "flat"
//! ```
//!
//! Kinds with a closed form: `eccentric`, `harmonic`, `lobes`, `polynomial`, `automotive`. A
//! library is read whole or refused with all that is wrong; a lift table is refused at its first
//! bad row.
use crate::{Error, SMALL_FILE_LIMIT, read_text, text::Lines};
use diag::{Diagnostic, Span};
use serde::Deserialize;
use std::{io::Read, path::Path};
use units::{Angle, Length};

/// Bytes a lift table may have.
pub const LIFT_TABLE_LIMIT: u64 = 16 << 20;
/// Rows that are read of a lift table: one more than any cam takes, so that the excess can be
/// named.
pub const MOST_ROWS: usize = 65_538;

/// A library of cams.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CamFile {
    /// Radius of the wheel that they are for; nothing: whatever is mounted.
    #[serde(default)]
    pub wheel_radius_mm: Option<f64>,
    /// Steps of a turn of the tables that the wheel follows.
    #[serde(default = "usual_nodes")]
    pub nodes: usize,
    /// The cams.
    #[serde(default)]
    pub cam: Vec<CamEntry>,
}

/// A node each half degree, as in JPH0622778B2.
const fn usual_nodes() -> usize {
    720
}

/// One cam of a library.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct CamEntry {
    /// Its number in programs.
    pub number: u32,
    /// What it is called.
    #[serde(default)]
    pub name: String,
    /// Its form.
    #[serde(flatten)]
    pub form: CamForm,
    /// How fast the work turns.
    #[serde(default)]
    pub work_speed: WorkSpeed,
    /// Follow what the follower asks for even where the contour is undercut: for tests of an axis
    /// in the air.
    #[serde(default)]
    pub path_only: bool,
}

/// How fast the work turns while a cam is ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WorkSpeed {
    /// At the programmed speed.
    #[default]
    Constant,
    /// Slower where the contact runs fast along the contour, so that as much is removed everywhere:
    /// the programmed speed is the mean.
    Even,
}

/// The form of a cam.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[allow(missing_docs)] // keys of the file, with their units
pub enum CamForm {
    Table {
        file: String,
        base_mm: f64,
        follower: FollowerKind,
        roller_radius_mm: Option<f64>,
    },
    Eccentric {
        radius_mm: f64,
        eccentricity_mm: f64,
    },
    Harmonic {
        base_mm: f64,
        lift_mm: f64,
        follower: FollowerKind,
        roller_radius_mm: Option<f64>,
    },
    Lobes {
        radius_mm: f64,
        amplitude_mm: f64,
        count: u32,
        phase_deg: f64,
    },
    Polynomial {
        base_mm: f64,
        lift_mm: f64,
        rise_deg: f64,
        dwell_deg: f64,
        fall_deg: f64,
        follower: FollowerKind,
        roller_radius_mm: Option<f64>,
    },
    Automotive {
        base_mm: f64,
        lift_mm: f64,
        half_angle_deg: f64,
        follower: FollowerKind,
        roller_radius_mm: Option<f64>,
    },
}

/// What runs on a cam.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FollowerKind {
    /// A flat face.
    Flat,
    /// A roller; `roller_radius_mm` says how large.
    Roller,
    /// An edge.
    Knife,
}

/// One row of a lift table, and where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftRow {
    /// Angle.
    pub angle: Angle,
    /// Lift.
    pub lift: Length,
    /// The row.
    pub span: Span,
}

/// Read a library.
///
/// # Errors
/// The file cannot be read, or its content is refused.
pub fn load(path: &Path) -> Result<CamFile, Error> {
    let text = read_text(path, "a cam library", SMALL_FILE_LIMIT)?;
    parse(&text).map_err(|findings| Error::refused(path, text, findings))
}

/// Read a library from text.
///
/// # Errors
/// What is wrong with it.
pub fn parse(text: &str) -> Result<CamFile, Vec<Diagnostic>> {
    let file: CamFile = toml::from_str(text).map_err(|e| {
        let at = e.span().unwrap_or(0..0);
        vec![Diagnostic::error("S1001", Lines::of(text, 0).span(&at), e.message().to_owned())]
    })?;
    let mut findings = Vec::new();
    let mut wrong = |sentence: String| {
        findings.push(Diagnostic::error("S1002", Span { line: 1, ..Span::default() }, sentence));
    };
    if let Some(radius) = file.wheel_radius_mm.filter(|r| !(*r > 0.0 && *r < 1e4)) {
        wrong(format!("expected a wheel radius above 0, found {radius} mm"));
    }
    if !(36..=65_536).contains(&file.nodes) {
        wrong(format!("expected 36 to 65536 nodes, found {}", file.nodes));
    }
    for (i, cam) in file.cam.iter().enumerate() {
        if cam.number == 0 || file.cam[..i].iter().any(|other| other.number == cam.number) {
            wrong(format!("cam number {}: expected numbers above 0, each once", cam.number));
        }
    }
    if findings.is_empty() { Ok(file) } else { Err(findings) }
}

/// The text of a lift table; of one that is too large, as much of it as shows which row is one too
/// many.
///
/// # Errors
/// It cannot be read, is no text, or too large without having too many rows.
pub fn table_text(path: &Path) -> Result<String, Error> {
    const WHAT: &str = "a lift table";
    let file = crate::open(path).map_err(|cause| Error::file("read", path, cause))?;
    let mut bytes = Vec::new();
    let read = file.take(LIFT_TABLE_LIMIT + 1).read_to_end(&mut bytes);
    read.map_err(|cause| Error::file("read", path, cause))?;
    if bytes.len() as u64 > LIFT_TABLE_LIMIT {
        bytes.truncate(bytes.iter().rposition(|b| *b == b'\n').map_or(0, |end| end + 1));
        if bytes.split(|b| *b == b'\n').count() <= MOST_ROWS + 1 {
            let path = path.to_owned();
            return Err(Error::TooLarge { path, what: WHAT, limit: LIFT_TABLE_LIMIT });
        }
    }
    crate::text::utf8(path, bytes)
}

/// Read a lift table: `angle,lift` in degrees and millimetres. A first line of words, lines that
/// begin with `#` and empty lines are passed over; commas, semicolons, tabs and blanks separate.
///
/// # Errors
/// The first row that is not two numbers.
pub fn lift_rows(text: &str) -> Result<Vec<LiftRow>, Diagnostic> {
    let mut rows = Vec::new();
    let mut start = 0;
    for (number, line) in (1u32..).zip(text.split_inclusive('\n')) {
        let content = line.trim();
        let lead = line.len() - line.trim_start().len();
        let from = start + lead;
        start += line.len();
        if content.is_empty() || content.starts_with('#') {
            continue;
        }
        let at = |offset: usize| u32::try_from(offset).unwrap_or(u32::MAX);
        let span = Span { file: 0, line: number, start: at(from), end: at(from + content.len()) };
        let separate = |c: char| matches!(c, ',' | ';') || c.is_whitespace();
        let mut fields = content.split(separate).filter(|field| !field.is_empty());
        let parsed: Vec<Option<f64>> = fields.by_ref().map(|field| field.parse().ok()).collect();
        match parsed[..] {
            [Some(angle), Some(lift)] => {
                rows.push(LiftRow { angle: Angle::deg(angle), lift: Length::mm(lift), span });
                if rows.len() >= MOST_ROWS {
                    return Ok(rows);
                }
            }
            _ if rows.is_empty() && parsed.iter().all(Option::is_none) => {} // a heading
            _ => {
                let text =
                    format!("expected an angle and a lift, found \"{}\"", shortened(content));
                return Err(Diagnostic::error("S1003", span, text));
            }
        }
    }
    Ok(rows)
}

fn shortened(text: &str) -> String {
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_names_its_cams() {
        let text = "wheel_radius_mm = 200\n[[cam]]\nnumber = 7\nname = \"e\"\nkind = \"eccentric\"\nradius_mm = 25\neccentricity_mm = 4\n";
        let file = parse(text).unwrap();
        assert_eq!((file.nodes, file.cam[0].number), (720, 7));
        assert!(matches!(file.cam[0].form, CamForm::Eccentric { .. }));
    }

    #[test]
    fn a_kind_that_nobody_knows_a_missing_figure_and_a_number_given_twice_are_refused() {
        let of = |cams: &str| {
            parse(&format!("wheel_radius_mm = 200\n{cams}")).unwrap_err()[0].message.clone()
        };
        assert!(of("[[cam]]\nnumber = 1\nkind = \"egg\"\n").contains("egg"));
        assert!(
            of("[[cam]]\nnumber = 1\nkind = \"eccentric\"\nradius_mm = 25\n")
                .contains("eccentricity_mm")
        );
        let twice =
            "[[cam]]\nnumber = 1\nkind = \"eccentric\"\nradius_mm = 25\neccentricity_mm = 4\n"
                .repeat(2);
        assert!(of(&twice).contains("each once"));
    }

    #[test]
    fn a_table_is_read_with_or_without_a_heading() {
        let rows = lift_rows("angle;lift\n# a comment\n0;0.1\n\n0.5 \t 0.2\n").unwrap();
        assert_eq!(rows.len(), 2);
        assert_eq!(
            (rows[1].angle.in_deg(), rows[1].lift.value(), rows[1].span.line),
            (0.5, 0.2, 5)
        );
        let refused = lift_rows("0,1\n0.5,x\n").unwrap_err();
        assert_eq!(
            (refused.span.line, refused.message.as_str()),
            (2, "expected an angle and a lift, found \"0.5,x\"")
        );
    }
}
