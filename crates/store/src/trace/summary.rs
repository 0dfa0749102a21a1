//! What a recording holds, at a glance.
use super::{Reader, unit_of};
use crate::Error;
use std::path::Path;

/// A column of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnSummary {
    /// Its name.
    pub name: String,
    /// Its unit, by its name; empty: none.
    pub unit: &'static str,
    /// Rows in which it has a value.
    pub count: u64,
    /// Least value; NaN without any.
    pub least: f64,
    /// Greatest value; NaN without any.
    pub most: f64,
    /// Time of the value that is farthest from 0, s.
    pub farthest_s: f64,
}

/// A recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// What it says of itself.
    pub facts: Vec<(String, String)>,
    /// Rows.
    pub rows: u64,
    /// Time of the first and of the last row, s.
    pub times_s: Option<(f64, f64)>,
    /// Columns of numbers.
    pub columns: Vec<ColumnSummary>,
    /// What the kernel was doing, and in how many rows, in the order in which it first did.
    pub states: Vec<(String, u64)>,
}

impl Summary {
    /// Of a file.
    ///
    /// # Errors
    /// It cannot be read to its end.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let reader = Reader::open(path)?;
        let numbers =
            reader.columns().into_iter().filter(|n| !matches!(n.as_str(), "line" | "state"));
        let column = |name: String| ColumnSummary {
            unit: unit_of(&name),
            name,
            count: 0,
            least: f64::NAN,
            most: f64::NAN,
            farthest_s: f64::NAN,
        };
        let mut summary = Self {
            facts: reader.facts(),
            rows: 0,
            times_s: None,
            columns: numbers.map(column).collect(),
            states: Vec::new(),
        };
        for group in reader {
            let group = group?;
            summary.rows += group.rows() as u64;
            let times = group.column("time_s").unwrap_or_default();
            if let (Some(first), Some(last)) = (times.first(), times.last()) {
                summary.times_s = Some((summary.times_s.map_or(*first, |(first, _)| first), *last));
            }
            for (column, (_, values)) in summary.columns.iter_mut().zip(&group.numbers) {
                column.add(values, times);
            }
            for state in &group.state {
                // the last one goes on in most rows
                match summary.states.iter_mut().rfind(|(name, _)| name == state) {
                    Some((_, rows)) => *rows += 1,
                    None => summary.states.push((state.clone(), 1)),
                }
            }
        }
        Ok(summary)
    }

    /// Between two rows, s.
    pub fn period_s(&self) -> Option<f64> {
        let (first, last) = self.times_s?;
        (self.rows > 1).then(|| (last - first) / (self.rows - 1) as f64)
    }
}

impl ColumnSummary {
    fn add(&mut self, values: &[f64], times: &[f64]) {
        for (index, value) in values.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
            let farthest = self.least.abs().max(self.most.abs());
            if farthest.is_nan() || value.abs() > farthest {
                self.farthest_s = times.get(index).copied().unwrap_or(f64::NAN);
            }
            self.count += 1;
            // `min` and `max` leave out what is no number
            (self.least, self.most) = (self.least.min(*value), self.most.max(*value));
        }
    }
}
