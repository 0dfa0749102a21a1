//! Numbered parameters that outlive a run, as LinuxCNC keeps them in its `.var` file.
//!
//! ```text
//!   5161<TAB>0.000000      G28's position, X          5220  work offset in force (1 is G54)
//!   5221<TAB>-250.000000   G54, X                     31…   the user's own
//! ```
//!
//! Rotary positions are in degrees and linear ones in the machine's unit: what a number means is
//! the interpreter's business.
//!
//! | code | what was found |
//! |---|---|
//! | S0601 | a line that is not a number and a value |
//! | S0602 | a number out of bounds |
//! | S0603 | a number that comes twice |
use crate::{
    Error, SMALL_FILE_LIMIT, output, read_text,
    text::{Lines, in_order},
};
use diag::Diagnostic;
use std::{
    collections::{BTreeMap, btree_map::Entry},
    fmt::Write,
    path::Path,
};

/// Highest number that a parameter may have (RS-274/NGC as LinuxCNC has it).
pub const HIGHEST: u32 = 5601;

/// Parameters by number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    values: BTreeMap<u32, f64>,
}

impl Parameters {
    /// The value, if the file has one.
    pub fn get(&self, number: u32) -> Option<f64> {
        self.values.get(&number).copied()
    }

    /// Set a value; `false`, and nothing set, if the number is not one of 1 to [`HIGHEST`] or the
    /// value is not finite.
    #[must_use]
    pub fn set(&mut self, number: u32, value: f64) -> bool {
        let good = (1..=HIGHEST).contains(&number) && value.is_finite();
        if good {
            self.values.insert(number, value);
        }
        good
    }

    /// All of them, by rising number.
    pub fn iter(&self) -> impl Iterator<Item = (u32, f64)> {
        self.values.iter().map(|(number, value)| (*number, *value))
    }

    /// Read them from text; `file` is the number that spans carry. Empty lines and lines that begin
    /// with `;` or `#` are passed over.
    ///
    /// # Errors
    /// Everything that is wrong with the text, in its order.
    pub fn parse(text: &str, file: u16) -> Result<Self, Vec<Diagnostic>> {
        let lines = Lines::of(text, file);
        let mut values = BTreeMap::new();
        let mut findings = Vec::new();
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let place = lines.span(&(start..start + line.trim_end().len()));
            start += line.len();
            match read_line(line.trim()) {
                Ok(None) => {}
                Ok(Some((number, value))) => match values.entry(number) {
                    Entry::Vacant(entry) => {
                        entry.insert(value);
                    }
                    Entry::Occupied(_) => {
                        let message = format!("parameter {number} is there twice");
                        findings.push(Diagnostic::error("S0603", place, message));
                    }
                },
                Err((code, message)) => findings.push(Diagnostic::error(code, place, message)),
            }
        }
        if findings.is_empty() { Ok(Self { values }) } else { Err(in_order(findings)) }
    }

    /// Their text: sorted, each value so that it reads back exactly.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for (number, value) in self.iter() {
            let six = format!("{value:.6}");
            let same = six.parse() == Ok(value);
            let shown = if same { six } else { value.to_string() };
            // writing to a String cannot fail
            let _ = writeln!(text, "{number}\t{shown}");
        }
        text
    }

    /// Read them from a file.
    ///
    /// # Errors
    /// When the file cannot be read, or [`Error::Refused`] with everything that is wrong with it.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text = read_text(path, "a parameter file", SMALL_FILE_LIMIT)?;
        Self::parse(&text, 0).map_err(|findings| Error::refused(path, text, findings))
    }

    /// Write them to a file, whole or not at all.
    ///
    /// # Errors
    /// When the file system refuses.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        output::write_file(path, self.to_text().as_bytes())
    }
}

type Mistake = (&'static str, String);

fn read_line(line: &str) -> Result<Option<(u32, f64)>, Mistake> {
    if line.is_empty() || line.starts_with([';', '#']) {
        return Ok(None);
    }
    let mut words = line.split_whitespace();
    let (Some(number), Some(value), None) = (words.next(), words.next(), words.next()) else {
        return Err(("S0601", "expected a number and its value such as `5221 -250.0`".into()));
    };
    let Ok(number) = number.parse::<u32>() else {
        let message =
            format!("expected a parameter's number from 1 to {HIGHEST}, found `{number}`");
        return Err(("S0601", message));
    };
    if !(1..=HIGHEST).contains(&number) {
        let message = format!("parameter {number}: expected a number from 1 to {HIGHEST}");
        return Err(("S0602", message));
    }
    match value.parse::<f64>() {
        Ok(finite) if finite.is_finite() => Ok(Some((number, finite))),
        Ok(_) => Err(("S0602", format!("parameter {number} is {value}: expected a finite number"))),
        Err(_) => Err(("S0601", format!("parameter {number}: expected a number, found `{value}`"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sentences(text: &str) -> String {
        let found = Parameters::parse(text, 0).unwrap_err();
        let line = |d: &Diagnostic| format!("{} {} {}", d.span.line, d.code, d.message);
        found.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn linuxcncs_own_file_is_read_and_written_as_it_was() {
        let text = "5161\t0.000000\n5220\t1.000000\n5221\t-250.500000\n";
        let parameters = Parameters::parse(text, 0).unwrap();
        assert_eq!(parameters.get(5221), Some(-250.5));
        assert_eq!(parameters.get(5222), None);
        assert_eq!(parameters.to_text(), text);
    }

    #[test]
    fn lines_may_come_in_any_order_and_are_written_sorted() {
        let parameters = Parameters::parse("5220 2\r\n; a comment\n\n31\t1e-9", 0).unwrap();
        assert_eq!(parameters.to_text(), "31\t0.000000001\n5220\t2.000000\n");
    }

    #[test]
    fn all_mistakes_are_told_at_once() {
        insta::assert_snapshot!(sentences("5161 nan\n0 1\n9999 1\n31\n32 1 2\n33 one\nx 1\n34 1\n34 1\n-1 2\n"), @"
        1 S0602 parameter 5161 is nan: expected a finite number
        2 S0602 parameter 0: expected a number from 1 to 5601
        3 S0602 parameter 9999: expected a number from 1 to 5601
        4 S0601 expected a number and its value such as `5221 -250.0`
        5 S0601 expected a number and its value such as `5221 -250.0`
        6 S0601 parameter 33: expected a number, found `one`
        7 S0601 expected a parameter's number from 1 to 5601, found `x`
        9 S0603 parameter 34 is there twice
        10 S0601 expected a parameter's number from 1 to 5601, found `-1`
        ");
    }

    #[test]
    fn only_a_good_number_and_value_can_be_set() {
        let mut parameters = Parameters::default();
        assert!(!parameters.set(0, 1.0));
        assert!(!parameters.set(HIGHEST + 1, 1.0));
        assert!(!parameters.set(31, f64::NAN));
        assert_eq!(parameters, Parameters::default());
        assert!(parameters.set(31, 1.0));
    }

    #[test]
    fn a_file_keeps_them() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("shop.var");
        let mut parameters = Parameters::default();
        assert!(parameters.set(5221, 0.1 + 0.2));
        parameters.save(&path).unwrap();
        assert_eq!(Parameters::load(&path).unwrap(), parameters);
    }

    proptest! {
        #[test]
        fn what_is_written_reads_back_the_same(
            values in proptest::collection::btree_map(1..=HIGHEST, -1e15..1e15_f64, 0..20)
        ) {
            let parameters = Parameters { values };
            prop_assert_eq!(Parameters::parse(&parameters.to_text(), 0).unwrap(), parameters);
        }

        #[test]
        fn no_text_makes_the_reader_panic(text in "([-0-9.e \t\nx;]|\\PC){0,60}") {
            let _ = Parameters::parse(&text, 0);
        }
    }
}
