//! A trace in so many columns: of each signal the least and the greatest value within a column's
//! span of time, so that no peak is lost however few columns are drawn.
use super::TraceQuery;
use crate::wire::{RunTraceBody, RunTraceSignal};
use std::path::Path;
use store::trace::Reader;

/// Columns, if nothing else is asked for, and at most.
const USUAL_COLUMNS: usize = 1000;
const MOST_COLUMNS: usize = 4000;
/// Signals at once.
const MOST_SIGNALS: usize = 16;
/// The column of the time.
const TIME: &str = "time_s";

/// Columns of a trace.
///
/// # Errors
/// It cannot be read, or something is asked for that it has not: the sentence says what it has.
pub(super) fn read(path: &Path, asked: &TraceQuery) -> Result<RunTraceBody, String> {
    let names: Vec<&str> = asked.signals.split(',').filter(|name| !name.is_empty()).collect();
    if names.len() > MOST_SIGNALS {
        return Err(format!("{MOST_SIGNALS} signals at most, found {}", names.len()));
    }
    let count = asked.columns.unwrap_or(USUAL_COLUMNS);
    if !(1..=MOST_COLUMNS).contains(&count) {
        return Err(format!("columns is from 1 to {MOST_COLUMNS}, found {count}"));
    }
    let (first, last, available) = span(path)?;
    if let Some(unknown) = names.iter().find(|name| !available.iter().any(|has| has == *name)) {
        let unknown: String = unknown.chars().take(40).collect();
        return Err(format!(
            "this trace has no signal \"{unknown}\": it has {}",
            available.join(", ")
        ));
    }
    let from_s = asked.from_s.unwrap_or(0.0).max(0.0);
    let to_s = asked.to_s.unwrap_or(last - first).min(last - first);
    if to_s.partial_cmp(&from_s) != Some(std::cmp::Ordering::Greater) {
        return Err(format!(
            "to_s is greater than from_s, and this trace lasts {:.3} s",
            last - first
        ));
    }
    let signals = names.iter().map(|name| RunTraceSignal {
        name: (*name).to_owned(),
        least: vec![None; count],
        most: vec![None; count],
    });
    let mut signals: Vec<_> = signals.collect();
    let column_s = (to_s - from_s) / count as f64;
    for group in Reader::open(path).map_err(|e| e.to_string())? {
        let group = group.map_err(|e| e.to_string())?;
        let Some(times) = group.column(TIME) else { continue };
        let ends = [times.first(), times.last()].map(|t| t.map_or(0.0, |t| t - first));
        if ends[1] < from_s || ends[0] > to_s {
            continue;
        }
        for signal in &mut signals {
            let Some(values) = group.column(&signal.name) else { continue };
            for (time, value) in times.iter().zip(values) {
                let at = time - first;
                if (from_s..=to_s).contains(&at) && value.is_finite() {
                    signal.take(((at - from_s) / column_s) as usize, *value);
                }
            }
        }
    }
    let time_s = (0..count).map(|column| from_s + column as f64 * column_s).collect();
    Ok(RunTraceBody { available, from_s, to_s, time_s, signals })
}

/// Its first and its last moment, and its signals.
fn span(path: &Path) -> Result<(f64, f64, Vec<String>), String> {
    let (mut first, mut last, mut available) = (None, 0.0, Vec::new());
    for group in Reader::open(path).map_err(|e| e.to_string())? {
        let group = group.map_err(|e| e.to_string())?;
        if let Some([begin, .., end]) = group.column(TIME) {
            first.get_or_insert(*begin);
            last = *end;
        }
        if available.is_empty() {
            let names = group.numbers.iter().map(|(name, _)| name.clone());
            available = names.filter(|name| name != TIME).collect();
        }
    }
    let first = first.ok_or("the trace is empty")?;
    Ok((first, last, available))
}

impl RunTraceSignal {
    fn take(&mut self, column: usize, value: f64) {
        let column = column.min(self.least.len().saturating_sub(1));
        let least = &mut self.least[column];
        *least = Some(least.map_or(value, |least| least.min(value)));
        let most = &mut self.most[column];
        *most = Some(most.map_or(value, |most| most.max(value)));
    }
}
