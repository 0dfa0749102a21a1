//! `leadscrew trace`: what a recording holds, and the same in other formats.
use crate::args::{TraceCommand, TraceFormat};
use crate::say;
use crate::tables::figures;
use control::Refused;
use std::path::{Path, PathBuf};
use store::trace::{Format, Summary, convert};

/// The trace in a run's folder.
const TRACE: &str = "trace.parquet";

/// Do it.
pub(crate) fn command(order: &TraceCommand, quiet: bool) -> Result<(), Refused> {
    match order {
        TraceCommand::Show { run } => show(&recording(run)?),
        TraceCommand::Convert { run, to, out } => {
            let from = recording(run)?;
            let (format, ending) = match to {
                TraceFormat::Mcap => (Format::Mcap, "mcap"),
                TraceFormat::Csv => (Format::Csv, "csv"),
                TraceFormat::Parquet => (Format::Parquet, "parquet"),
            };
            let to = out.clone().unwrap_or_else(|| from.with_extension(ending));
            if is_same(&from, &to) {
                return Err(Refused::because(format!(
                    "{} is the recording itself: say with --out where the new file shall be",
                    to.display()
                )));
            }
            let rows = convert(&from, &to, format).map_err(|e| Refused::because(e.to_string()))?;
            if quiet {
                return Ok(());
            }
            say::out(&format!("{}: {rows} periods\n", to.display()))
        }
    }
}

/// A run's folder means its trace.
fn recording(run: &Path) -> Result<PathBuf, Refused> {
    if !run.is_dir() {
        return Ok(run.to_owned());
    }
    let trace = run.join(TRACE);
    if trace.is_file() {
        return Ok(trace);
    }
    Err(Refused::because(format!(
        "{} has no {TRACE}: `leadscrew run PROGRAM --out DIR` leaves one",
        run.display()
    )))
}

fn is_same(one: &Path, other: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    real(one).is_some_and(|one| real(other) == Some(one))
}

fn show(path: &Path) -> Result<(), Refused> {
    let summary = Summary::read(path).map_err(|e| Refused::because(e.to_string()))?;
    let mut text = format!("{}\n", path.display());
    for (name, value) in &summary.facts {
        text += &format!("{name}: {value}\n");
    }
    text += &format!("{} periods", summary.rows);
    if let (Some((first, last)), Some(period)) = (summary.times_s, summary.period_s()) {
        text += &format!(", {first:.6} s to {last:.6} s, one each {:.1} µs", period * 1e6);
    }
    let row = |column: &store::trace::ColumnSummary| {
        let number =
            |value: f64| if value.is_nan() { String::new() } else { format!("{value:.4}") };
        let missing = summary.rows - column.count;
        vec![
            column.name.clone(),
            column.unit.to_owned(),
            number(column.least),
            number(column.most),
            number(column.farthest_s),
            if missing == 0 { String::new() } else { missing.to_string() },
        ]
    };
    let rows: Vec<_> = summary.columns.iter().map(row).collect();
    let heads = ["column", "unit", "least", "greatest", "farthest from 0 at, s", "without a value"];
    text += &format!("\n{}\n", figures(&heads, &rows));
    if !summary.states.is_empty() {
        let row = |(state, rows): &(String, u64)| {
            let share = *rows as f64 / summary.rows.max(1) as f64;
            vec![state.clone(), rows.to_string(), format!("{:.1}", share * 100.0)]
        };
        let rows: Vec<_> = summary.states.iter().map(row).collect();
        text += &format!("{}\n", figures(&["what the kernel did", "periods", "%"], &rows));
    }
    say::out(&text)
}
