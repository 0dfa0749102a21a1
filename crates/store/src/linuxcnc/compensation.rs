//! Compensation of an axis from `BACKLASH`, `COMP_FILE` and `COMP_FILE_TYPE` of its joint.
//!
//! ```text
//!   type 0: nominal  forward  reverse        positions, as they were measured       up = forward − nominal
//!   other:  nominal  trim     trim           added to what is commanded             up = − trim
//! ```
//!
//! LinuxCNC reads rows up to the first line that is none, and holds the first and the last row
//! beyond its table. A row beyond the travel, where no axis goes, becomes the value at the end of
//! the travel.
use super::axes::AxisOf;
use super::ini::{Entry, Ini};
use super::writer::{Cited, MachineWriter, Remark, RemarkKind, plain};
use crate::machine::COMPENSATION_POINTS;

/// A row in mm or degrees: position, deviation towards plus and towards minus.
type Row = [f64; 3];

/// What a joint states.
pub(super) struct Stated<'i> {
    backlash: Option<Cited>,
    file: Option<&'i Entry>,
    rows: Vec<Row>,
}

impl<'i> Stated<'i> {
    /// Of an axis: what is wrong with its file is said.
    pub(super) fn read(w: &mut MachineWriter, ini: &'i Ini, axis: &AxisOf) -> Self {
        let backlash =
            axis.of_joint(w, ini, "BACKLASH").map(|found| found.map(|v| v.abs() * axis.scale));
        let section = axis.joints.first().map(|joint| format!("JOINT_{joint}")).unwrap_or_default();
        let file = ini.get(&section, "COMP_FILE");
        let kind = axis.of_joint(w, ini, "COMP_FILE_TYPE");
        let measured = kind.is_none_or(|kind| kind.value == 0.0);
        let mut rows = Vec::new();
        w.section("", &axis.key());
        if let Some(entry) = file {
            match ini.compensation(&entry.value) {
                Ok(text) => rows = read_rows(text, axis.scale, measured),
                Err(why) => {
                    let text = format!("{} = {}: {why}", entry.cited(), entry.value);
                    w.say(RemarkKind::Missing, "compensation.table", &text);
                }
            }
            if rows.len() == 1 || ini.compensation(&entry.value).is_ok() && rows.is_empty() {
                let found = rows.len();
                let text = format!(
                    "{} = {}: found {found} rows of three numbers, expected two at least",
                    entry.cited(),
                    entry.value
                );
                w.say(RemarkKind::Missing, "compensation.table", &text);
                rows.clear();
            }
        }
        Self { backlash, file, rows }
    }

    /// `[axes.x.compensation]`, if there is something to compensate.
    pub(super) fn write(self, w: &mut MachineWriter, axis: &AxisOf, travel: (f64, f64)) {
        let backlash = self.backlash.filter(|found| found.value > 0.0);
        if backlash.is_none() && self.rows.is_empty() {
            return;
        }
        let key = axis.key();
        w.section(&format!("[{key}.compensation]"), &format!("{key}.compensation"));
        let (units, [at, up, down], play) = if axis.is_rotary() {
            (3600.0, ["at_deg", "up_arcsec", "down_arcsec"], "backlash_arcsec")
        } else {
            (1e3, ["at_mm", "up_um", "down_um"], "backlash_um")
        };
        if let Some(found) = backlash {
            w.taken(play, &plain(found.value * units), &found.from);
            w.line("backlash", "\"control\"", "LinuxCNC takes it up in its commands");
        }
        let Some(entry) = self.file.filter(|_| !self.rows.is_empty()) else { return };
        let mut rows = self.rows;
        if !axis.is_rotary() {
            let before = rows.len();
            rows = within(&rows, travel);
            if rows.len() < before {
                let text =
                    format!("rows beyond the travel of {} to {} are left out", travel.0, travel.1);
                w.say(RemarkKind::Taken, "table", &text);
            }
        }
        if rows.len() > COMPENSATION_POINTS {
            let text = format!("{} rows: {COMPENSATION_POINTS} are read", rows.len());
            w.say(RemarkKind::Missing, "table", &text);
            rows.truncate(COMPENSATION_POINTS);
        }
        w.text += &format!("table = [# {} = {}\n", entry.cited(), entry.value);
        for [position, upward, downward] in &rows {
            w.text += &format!(
                "    {{ {at} = {}, {up} = {}, {down} = {} }},\n",
                plain(*position),
                plain(upward * units),
                plain(downward * units)
            );
        }
        w.text += "]\n";
        let text = format!("{} rows from {} = {}", rows.len(), entry.cited(), entry.value);
        w.say(RemarkKind::Taken, "table", &text);
    }
}

/// The machine file with tables that no machine file may have as comments: what is wrong with each
/// is a remark, and the rest of the file can be used.
pub(super) fn without_refused(mut text: String, remarks: &mut Vec<Remark>) -> String {
    let Err(found) = crate::machine::parse(&text, 0) else { return text };
    let refused: Vec<_> =
        found.iter().filter(|one| one.message.starts_with("`table` of ")).collect();
    remarks.extend(refused.iter().map(|one| Remark {
        kind: RemarkKind::Missing,
        key: "compensation.table".to_owned(),
        text: format!("{}; its rows are comments in the file", one.message),
    }));
    let mut places: Vec<_> = refused.iter().map(|one| one.span.start as usize).collect();
    places.sort_unstable();
    places.dedup();
    for place in places.into_iter().rev() {
        text = commented(&text, place);
    }
    text
}

/// The table that a place is in, or that follows it, line by line as a comment.
fn commented(text: &str, place: usize) -> String {
    const BEGINS: &str = "table = [";
    let mut at = 0;
    let (mut is_within, mut is_over) = (false, false);
    let lines = text.split_inclusive('\n').map(|line| {
        at += line.len();
        is_within |= !is_over && at > place && line.starts_with(BEGINS);
        let commented = if is_within { format!("# {line}") } else { line.to_owned() };
        if is_within && line.trim_end() == "]" {
            (is_within, is_over) = (false, true);
        }
        commented
    });
    lines.collect()
}

fn read_rows(text: &str, scale: f64, measured: bool) -> Vec<Row> {
    let row = |line: &str| -> Option<Row> {
        let mut numbers = line.split_whitespace().map(str::parse::<f64>);
        let mut next = || numbers.next()?.ok().filter(|n| n.is_finite()).map(|n| n * scale);
        let (nominal, forward, reverse) = (next()?, next()?, next()?);
        let of = |value: f64| if measured { value - nominal } else { -value };
        Some([nominal, of(forward), of(reverse)])
    };
    text.lines().map_while(row).collect()
}

/// The rows within a travel, with those at its ends between which and the next ones it lies.
fn within(rows: &[Row], (from, to): (f64, f64)) -> Vec<Row> {
    let mut found = Vec::new();
    let between = |pair: &[Row], at: f64| {
        let (a, b) = (pair[0], pair[1]);
        let share = (at - a[0]) / (b[0] - a[0]);
        [at, a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])]
    };
    for (index, row) in rows.iter().enumerate() {
        if let Some(before) = index.checked_sub(1) {
            let pair = &rows[before..=index];
            for end in [from, to] {
                if pair[0][0] < end && end < row[0] {
                    found.push(between(pair, end));
                }
            }
        }
        if (from..=to).contains(&row[0]) {
            found.push(*row);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_positions_and_trims_say_the_same() {
        let measured = read_rows("0 0 -0.001\n100 100.012 100.010\nend\n200 1 1\n", 1.0, true);
        let trims = read_rows("0 0 0.001\n100 -0.012 -0.010\n", 1.0, false);
        assert_eq!(measured.len(), 2);
        for (one, other) in measured.iter().zip(&trims) {
            assert!(one.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-12), "{one:?} {other:?}");
        }
        // at 100 mm the slide is 12 µm too far
        assert!((measured[1][1] - 0.012).abs() < 1e-12);
    }

    #[test]
    fn a_table_that_is_refused_stands_as_comments_and_the_other_ones_are_kept() {
        let axis = |letter: char, um: f64| {
            format!(
                "[axes.{letter}.compensation]\ntable = [# a file\n    {{ at_mm = -100, up_um = 0, down_um = 0 }},\n    \
                 {{ at_mm = -99, up_um = {um}, down_um = {um} }},\n]\n"
            )
        };
        let machine = "extends = \"tapping-center\"\nname = \"x\"\n";
        let text = format!("{machine}{}{}", axis('x', 500.0), axis('y', 0.5));
        let mut remarks = Vec::new();
        let kept = without_refused(text.clone(), &mut remarks);
        assert_eq!(crate::machine::parse(&kept, 0).err(), None);
        let own = axis('y', 0.5);
        assert!(kept.ends_with(&own) && kept.matches("\ntable = [").count() == 1, "{kept}");
        assert!(kept.contains("# table = [# a file\n#     { at_mm = -100"), "{kept}");
        assert!(!remarks.is_empty() && remarks.iter().all(|one| one.text.contains("of X")));
        assert_eq!(without_refused(kept.clone(), &mut remarks), kept, "nothing is left to do");
    }

    #[test]
    fn a_row_beyond_the_travel_becomes_the_value_at_its_end() {
        let rows = [[-50.0, 0.0, 0.0], [50.0, 0.01, 0.02], [150.0, 0.03, 0.0]];
        let found = within(&rows, (0.0, 100.0));
        assert_eq!(found.len(), 3);
        assert_eq!(found[0], [0.0, 0.005, 0.01]);
        assert_eq!(found[1], rows[1]);
        assert_eq!(found[2][0], 100.0);
        assert!((found[2][1] - 0.02).abs() < 1e-15 && (found[2][2] - 0.01).abs() < 1e-15);
        assert_eq!(within(&rows, (-50.0, 150.0)), rows);
    }
}
