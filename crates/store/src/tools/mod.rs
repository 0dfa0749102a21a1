//! Tool tables: the shop's own TOML, which says what each tool is, and LinuxCNC's `.tbl`, which
//! says only length and diameter and leaves the rest to a comment.
//!
//! ```text
//!   tools.toml   [[tool]] number, length_mm, kind, thread, holder …  ─┐
//!                                                                     ├─► canon::ToolLibrary
//!   tool.tbl     T3 P3 Z105.25 D6 ;M6x1 tap                          ─┘
//! ```
//!
//! Keys of a `[[tool]]`, with what stands in for those that may be left out:
//!
//! | key | of | |
//! |---|---|---|
//! | `number` | all | T number, from 1 |
//! | `pocket` | all | else the number |
//! | `length_mm` | all | gauge line to tip, G43's H; every key in `_mm` may be written in inches, as `length_in` |
//! | `diameter_mm` | all | taps: else the thread's nominal diameter |
//! | `kind` | all | drill, spot-drill, end-mill, tap, polygon-cutter, hob, threading-insert, turning-insert, grooving-insert, probe, other |
//! | `description` | all | else empty |
//! | `wear_length_mm`, `wear_radius_mm` | all | what use has added, else 0: G43 and G41 take geometry and wear together |
//! | `life` | all | `{ uses = 12, limit_uses = 500, time_s = 80, limit_time_s = 3600, cut_mm = 900, limit_cut_mm = 1e6, at_limit = "refuse" }`; each may be left out, and `at_limit` is else "remark" |
//! | `stick_out_mm` | all | from the tip to the holder; of a turning tool, from the point to its shank: else not judged |
//! | `holder_diameter_mm` | all | else only what is as thick as the tool is judged |
//! | `shank_diameter_mm` | all | of a boring bar its diameter, of a turning tool the width of its shank: else not judged |
//! | `depth_without_pecks_mm` | drill | deeper holes are to be drilled in pecks: 4 diameters, unless stated |
//! | `flute_length_mm` | drill, spot-drill, end-mill | where the flutes end; else not judged |
//! | `form` | end-mill | flat (also a face mill), bull, ball, conical (chamfer mills, engraving tools), other: not judged; else flat |
//! | `corner_radius_mm` | end-mill, bull | radius of its corner |
//! | `point_angle_deg`, `tip_diameter_mm` | end-mill, conical | full angle of its cone; its flat tip, else 0 |
//! | `teeth` | end-mill | else chip load, force and deflection are not judged |
//! | `body_material` | end-mill | carbide, hss: else its deflection is not judged; that also needs `stick_out_mm` |
//! | `max_chip_mm`, `max_depth_mm`, `max_deflection_mm` | end-mill | thickness of a tooth's chip, axial depth of the cut, deflection of the tip: else not judged |
//! | `tip_radius_mm` | polygon-cutter | from the spindle's axis to an insert's tip |
//! | `inserts`, or `insert_angles_deg` | polygon-cutter | how many, equally spaced; or where, `[0, 90]` |
//! | `flank_angle_deg`, `nose_radius_mm` or `flat_mm`, `crest_height_mm` | threading-insert | 60; by the thread's standard; partial profile |
//! | `point_angle_deg`, `nose_radius_mm`, `approach_angle_deg`, `edge_mm` | turning-insert | 80, 0.4, 95, 12 |
//! | `width_mm` | grooving-insert | |
//! | `orientation` | inserts | where the point lies from the nose, 1 to 9 by Fanuc's numbers |
//! | `nose_radius_mm` | polygon-cutter | else 0.8 |
//! | `module_mm`, or `diametral_pitch` | hob | of its normal section |
//! | `starts`, `hand` | hob | else 1, right |
//! | `pressure_angle_deg` | hob | else 20 |
//! | `addendum_mm`, `tip_radius_mm` | hob | from the datum line to the crest, else 1.25 modules; what rounds it, else 0.38 modules (ISO 53, A) |
//! | `hob_length_mm` | hob | of its threads; else whether it reaches over the teeth is not judged |
//! | `cuts_with` | hob | M3, M4: the sense in which its cutting faces look; else M3 |
//! | `point_angle_deg` | drill, spot-drill | else 118 and 90 |
//! | `thread` | tap | "M6x1", "M6", "1/4-20 UNC", "#10-32", with "-LH" for left-hand |
//! | `chamfer_pitches` | tap | 2–3 bottoming, 4–5 plug |
//! | `thread_length_mm` | tap | where the flutes end |
//! | `flute` | tap | spiral-flute, spiral-point, straight |
//! | `max_torque_n_m` | tap | torque from which on it is taken out; else 0.7 of what breaks it |
//! | `oversize_um` | tap | else the middle of class ISO 2 |
//! | `holder` | tap | `{ kind = "rigid", stiffness_n_per_um = 20 }`; soft-synchro and tension-compression also have `travel_mm` |
mod comment;
mod hob;
mod mill;
mod table;
mod tbl;
mod write;

pub use comment::{ToolComment, named};
pub use mill::of_words as mill_of_words;
pub use tbl::{TableLine, TableUnit, to_tbl};
pub use write::to_toml;

use crate::{Error, SMALL_FILE_LIMIT, read_text};
use canon::{Flute, Holder, TapTool, ThreadSize, Tool, ToolLibrary};
use diag::Diagnostic;
use std::{collections::BTreeMap, path::Path};
use units::{Length, Stiffness};

/// Tools a table may have.
pub const MOST_TOOLS: usize = 10_000;

/// A table that was read, and what is worth knowing about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolTable {
    /// The tools.
    pub library: ToolLibrary,
    /// Warnings and notes: words without effect, comments that were not understood.
    pub remarks: Vec<Diagnostic>,
    /// The line of the table in which each tool stands.
    pub lines: BTreeMap<u32, u32>,
}

impl ToolTable {
    /// What is worth knowing about one tool.
    pub fn remarks_of(&self, number: u32) -> impl Iterator<Item = &Diagnostic> {
        let line = self.lines.get(&number).copied();
        self.remarks.iter().filter(move |remark| Some(remark.span.line) == line)
    }
}

/// Read a table in TOML; `file` is the number that spans carry.
///
/// # Errors
/// Everything that is wrong with the text, in its order.
pub fn parse_toml(text: &str, file: u16) -> Result<ToolTable, Vec<Diagnostic>> {
    let library = table::parse(text, file, table::Origin::Shop)?;
    Ok(ToolTable { library, ..ToolTable::default() })
}

/// Kinds of tools, as a table writes them, each with the keys that its reader asks for.
pub fn asked_keys() -> Vec<(&'static str, Vec<crate::AskedKey>)> {
    table::KINDS.iter().map(|(name, _)| (*name, table::asked_keys(name))).collect()
}

/// Read a table that [`to_toml`] has written, of a control that has perhaps changed lengths and
/// diameters to what no shop's table would say.
///
/// # Errors
/// Everything that is wrong with the text, in its order.
pub fn parse_controls_toml(text: &str) -> Result<ToolLibrary, Vec<Diagnostic>> {
    if text.trim().is_empty() {
        return Ok(ToolLibrary::default());
    }
    table::parse(text, 0, table::Origin::Control)
}

/// Read a table in LinuxCNC's notation, whose lengths are in the machine's unit.
///
/// # Errors
/// Everything that is wrong with the text, in its order.
pub fn parse_tbl(text: &str, file: u16, unit: TableUnit) -> Result<ToolTable, Vec<Diagnostic>> {
    tbl::parse(text, file, unit)
}

/// Read a table from its file: `.tbl` in this unit, anything else as TOML.
///
/// # Errors
/// When the file cannot be read, or [`Error::Refused`] with everything that is wrong with it.
pub fn load(path: &Path, unit: TableUnit) -> Result<ToolTable, Error> {
    let text = read_text(path, "a tool table", SMALL_FILE_LIMIT)?;
    let table = match path.extension() {
        Some(end) if end.eq_ignore_ascii_case("tbl") => parse_tbl(&text, 0, unit),
        _ => parse_toml(&text, 0),
    };
    table.map_err(|findings| Error::refused(path, text, findings))
}

/// The tap that a bare designation stands for: bottoming chamfer, spiral flutes, class ISO 2, in a
/// rigid holder. Typical values; a TOML table states them.
pub fn usual_tap(thread: &ThreadSize) -> TapTool {
    const CHAMFER_PITCHES: f64 = 2.5;
    const LENGTH_IN_DIAMETERS: f64 = 3.5;
    TapTool {
        designation: thread.designation.clone(),
        lead: thread.lead(),
        chamfer_pitches: CHAMFER_PITCHES,
        thread_length: thread.nominal * LENGTH_IN_DIAMETERS,
        flute: Flute::SpiralFlute,
        oversize: usual_oversize(thread),
        holder: Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
        max_torque: None,
    }
}

/// Pitch diameter of a tap of class ISO 2 (for 6H) over the basic one: the middle of its field,
/// which reaches from 0.3 to 0.5 of TD2 of grade 5 (ISO 2857).
fn usual_oversize(thread: &ThreadSize) -> Length {
    const MIDDLE: f64 = 0.4;
    Length::um(MIDDLE * pitch_tolerance_grade_5_um(thread))
}

/// TD2(5) = 1.06·90·P^0.4·d^0.1 µm, d the geometric mean of the diameter step (ISO 965-1).
fn pitch_tolerance_grade_5_um(thread: &ThreadSize) -> f64 {
    const STEPS_MM: [f64; 10] = [0.99, 1.4, 2.8, 5.6, 11.2, 22.4, 45.0, 90.0, 180.0, 355.0];
    let nominal = thread.nominal.value();
    let within = STEPS_MM.windows(2).find(|step| nominal > step[0] && nominal <= step[1]);
    let mean = within.map_or(nominal, |step| (step[0] * step[1]).sqrt());
    1.06 * 90.0 * thread.pitch.value().powf(0.4) * mean.powf(0.1)
}

/// Farthest that a tool length or diameter may be from zero.
const LONGEST: Length = Length::mm(10_000.0);

/// The tools by number, or where a number comes twice.
fn without_doubles(
    tools: Vec<(Tool, diag::Span)>,
    code: &'static str,
) -> Result<ToolLibrary, Vec<Diagnostic>> {
    let mut seen = std::collections::BTreeMap::new();
    let mut findings = Vec::new();
    for (tool, place) in &tools {
        if let Some(first) = seen.get(&tool.number) {
            let message = format!("tool {} is there twice", tool.number);
            let finding = Diagnostic::error(code, *place, message);
            findings.push(finding.with_label(*first, "here for the first time"));
        } else {
            seen.insert(tool.number, *place);
        }
    }
    if findings.is_empty() {
        Ok(ToolLibrary::new(tools.into_iter().map(|(tool, _)| tool)))
    } else {
        Err(findings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_oversize_of_m6_is_two_fifths_of_118_um() {
        // TD2 5H of M6 is 118 µm by ISO 965-1's table
        let oversize = usual_oversize(&"M6".parse().unwrap()).in_um();
        assert!((oversize - 0.4 * 118.0).abs() < 1.0, "{oversize}");
    }
}
