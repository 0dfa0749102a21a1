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
use crate::{
    AskedKey, Error, SMALL_FILE_LIMIT,
    keys::{self, Keys},
    read_text,
};
use diag::{Diagnostic, Span};
use std::{io::Read, path::Path};
use units::{Angle, Length};

/// Bytes a lift table may have.
pub const LIFT_TABLE_LIMIT: u64 = 16 << 20;
/// Rows that are read of a lift table: one more than any cam takes, so that the excess can be
/// named.
pub const MOST_ROWS: usize = 65_538;

/// A library of cams.
#[derive(Clone, Debug, PartialEq)]
pub struct CamFile {
    /// Radius of the wheel that they are for; nothing: whatever is mounted.
    pub wheel_radius_mm: Option<f64>,
    /// Steps of a turn of the tables that the wheel follows.
    pub nodes: usize,
    /// The cams.
    pub cam: Vec<CamEntry>,
}

/// A node each half degree, as in JPH0622778B2.
const USUAL_NODES: u32 = 720;
/// Most cams of a library.
const MOST_CAMS: usize = 10_000;
/// Largest length of a cam, mm; largest count of lobes.
const LARGEST_MM: f64 = 1e4;
const MOST_LOBES: u32 = 1000;

/// One cam of a library.
#[derive(Clone, Debug, PartialEq)]
pub struct CamEntry {
    /// Its number in programs.
    pub number: u32,
    /// What it is called.
    pub name: String,
    /// Its form.
    pub form: CamForm,
    /// How fast the work turns.
    pub work_speed: WorkSpeed,
    /// Follow what the follower asks for even where the contour is undercut: for tests of an axis
    /// in the air.
    pub path_only: bool,
}

/// How fast the work turns while a cam is ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WorkSpeed {
    /// At the programmed speed.
    #[default]
    Constant,
    /// Slower where the contact runs fast along the contour, so that as much is removed everywhere:
    /// the programmed speed is the mean.
    Even,
}

/// The form of a cam.
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    keys::read(text, 0, read)
}

/// Kinds of cams, as a library writes them, each with the keys that its reader asks for.
pub fn asked_keys() -> Vec<(&'static str, Vec<AskedKey>)> {
    let of = |kind: &str| {
        let text = format!("[[cam]]\nkind = \"{kind}\"\n");
        keys::asked(&text, "", &|_| None, read)
    };
    KINDS.iter().map(|(name, _)| (*name, of(name))).collect()
}

/// A profile's form, as its library names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FormKind {
    Table,
    Eccentric,
    Harmonic,
    Lobes,
    Polynomial,
    Automotive,
}

const KINDS: [(&str, FormKind); 6] = [
    ("table", FormKind::Table),
    ("eccentric", FormKind::Eccentric),
    ("harmonic", FormKind::Harmonic),
    ("lobes", FormKind::Lobes),
    ("polynomial", FormKind::Polynomial),
    ("automotive", FormKind::Automotive),
];

fn read(keys: &mut Keys<'_>) -> CamFile {
    let wheel_radius_mm = keys.optional("wheel_radius_mm", 0.001..=LARGEST_MM);
    let nodes = keys.optional_whole("nodes", 36..=65_536).unwrap_or(USUAL_NODES) as usize;
    let mut numbers = Vec::new();
    let mut entry = |keys: &mut Keys<'_>| {
        let cam = read_cam(keys);
        if numbers.contains(&cam.number) {
            keys.conflict("number", format!("cam number {}: expected each once", cam.number));
        }
        numbers.push(cam.number);
        cam
    };
    let cam =
        if keys.has("cam") { keys.sections("cam", MOST_CAMS, &mut entry) } else { Vec::new() };
    CamFile { wheel_radius_mm, nodes, cam }
}

fn read_cam(keys: &mut Keys<'_>) -> CamEntry {
    let number = keys.whole("number", 1..=u32::MAX);
    let name = keys.optional_text("name").unwrap_or_default();
    let kind = keys.choice("kind", &KINDS);
    let form = read_form(kind, keys);
    let speeds = [("constant", WorkSpeed::Constant), ("even", WorkSpeed::Even)];
    CamEntry {
        number,
        name,
        form,
        work_speed: keys.optional_choice("work_speed", &speeds).unwrap_or_default(),
        path_only: keys.has("path_only") && keys.flag("path_only"),
    }
}

fn read_form(kind: FormKind, keys: &mut Keys<'_>) -> CamForm {
    let mm = |keys: &mut Keys<'_>, key| keys.number(key, 0.0..=LARGEST_MM);
    let deg = |keys: &mut Keys<'_>, key| keys.number(key, -360.0..=360.0);
    match kind {
        FormKind::Table => CamForm::Table {
            file: keys.text("file"),
            base_mm: mm(keys, "base_mm"),
            follower: follower(keys),
            roller_radius_mm: roller(keys),
        },
        FormKind::Eccentric => CamForm::Eccentric {
            radius_mm: mm(keys, "radius_mm"),
            eccentricity_mm: mm(keys, "eccentricity_mm"),
        },
        FormKind::Harmonic => CamForm::Harmonic {
            base_mm: mm(keys, "base_mm"),
            lift_mm: mm(keys, "lift_mm"),
            follower: follower(keys),
            roller_radius_mm: roller(keys),
        },
        FormKind::Lobes => CamForm::Lobes {
            radius_mm: mm(keys, "radius_mm"),
            amplitude_mm: mm(keys, "amplitude_mm"),
            count: keys.whole("count", 1..=MOST_LOBES),
            phase_deg: deg(keys, "phase_deg"),
        },
        FormKind::Polynomial => CamForm::Polynomial {
            base_mm: mm(keys, "base_mm"),
            lift_mm: mm(keys, "lift_mm"),
            rise_deg: deg(keys, "rise_deg"),
            dwell_deg: deg(keys, "dwell_deg"),
            fall_deg: deg(keys, "fall_deg"),
            follower: follower(keys),
            roller_radius_mm: roller(keys),
        },
        FormKind::Automotive => CamForm::Automotive {
            base_mm: mm(keys, "base_mm"),
            lift_mm: mm(keys, "lift_mm"),
            half_angle_deg: deg(keys, "half_angle_deg"),
            follower: follower(keys),
            roller_radius_mm: roller(keys),
        },
    }
}

fn follower(keys: &mut Keys<'_>) -> FollowerKind {
    let names = [
        ("flat", FollowerKind::Flat),
        ("roller", FollowerKind::Roller),
        ("knife", FollowerKind::Knife),
    ];
    keys.choice("follower", &names)
}

fn roller(keys: &mut Keys<'_>) -> Option<f64> {
    keys.optional("roller_radius_mm", 0.001..=LARGEST_MM)
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
            let found = parse(&format!("wheel_radius_mm = 200\n{cams}")).unwrap_err();
            found.iter().map(|f| f.message.clone()).collect::<Vec<_>>().join("\n")
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
    fn all_that_is_wrong_with_a_library_is_said_at_once() {
        let text = "nodes = 3\nweel_radius_mm = 200\n[[cam]]\nnumber = 0\nkind = \"eccentric\"\nradius = 25\neccentricity_mm = -4\n[[cam]]\nnumber = 2\nkind = \"egg\"\n";
        let found = parse(text).unwrap_err();
        for (line, part) in [
            (1, "`nodes`"),
            (2, "did you mean `wheel_radius_mm`"),
            (4, "`number` is 0"),
            (6, "did you mean `radius_mm`"),
            (7, "`eccentricity_mm` is -4"),
            (10, "egg"),
        ] {
            assert!(
                found.iter().any(|f| f.span.line == line && f.message.contains(part)),
                "{part}: {found:?}"
            );
        }
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
