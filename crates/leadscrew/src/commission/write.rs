//! The file with what was found: the old one with keys changed, each with when and by what it was
//! measured.
use super::result::MeasuredValue;
use crate::Machine;
use control::Refused;
use serde_json::{Value, json};

/// Digits of a value that are written: two more than its interval is wide.
const DIGITS: f64 = 2.0;

/// The text of the commissioned file. A built-in machine is extended; of a file the values are
/// changed, since only built-in machines can be extended.
///
/// # Errors
/// The values make no machine that can be run.
pub fn commissioned(
    old: &Machine,
    name: &str,
    findings: &[MeasuredValue],
    date: &str,
) -> Result<String, Refused> {
    let written = || findings.iter().filter(|finding| !finding.key.is_empty());
    let changes: Vec<(String, Value)> = std::iter::once(("name".to_owned(), json!(name)))
        .chain(written().map(|finding| (finding.key.clone(), json!(rounded(finding)))))
        .collect();
    let text = old.with(&changes)?.text().to_owned();
    let mut lines = vec![format!(
        "# {} as commissioned on {date}; values without a remark are those of the file before.",
        old.source().name
    )];
    let mut table = String::new();
    for line in text.lines() {
        if let Some(head) = line.strip_prefix('[') {
            head.trim_matches(['[', ']']).clone_into(&mut table);
            if table == "spindles" || table.starts_with("spindles.") {
                table = table.replacen("spindles", "spindles.0", 1);
            }
        }
        let key = line.split('=').next().unwrap_or_default().trim();
        let full = if table.is_empty() { key.to_owned() } else { format!("{table}.{key}") };
        let found = written().find(|finding| finding.key == full);
        lines.push(match found {
            Some(finding) => format!("{line}    # {}", remark(finding, date)),
            None => line.to_owned(),
        });
    }
    let text = lines.join("\n") + "\n";
    store::machine::parse(&text, 0).map_err(|findings| {
        Refused::text("the commissioned file".into(), text.as_str(), findings)
    })?;
    Ok(text)
}

fn remark(finding: &MeasuredValue, date: &str) -> String {
    let step = step_of(finding.value.half);
    let decimals = (-step.log10()).ceil().clamp(0.0, 9.0) as usize;
    let was = finding.old.map(|old| format!("; was {old}")).unwrap_or_default();
    let half = format!("{:.decimals$}", finding.value.half);
    format!("measured {date}, by {}: ± {half} {}{was}", finding.by, finding.unit)
}

/// Last place that is worth writing.
fn step_of(half: f64) -> f64 {
    10f64.powf(half.abs().max(1e-12).log10().floor() - DIGITS + 1.0)
}

/// The value with as many digits as its interval is worth, never without a sign of it.
fn rounded(finding: &MeasuredValue) -> f64 {
    let step = step_of(finding.value.half);
    let rounded = (finding.value.value / step).round() * step;
    // the shortest number that is within half a step
    let decimals = (-step.log10()).ceil().clamp(0.0, 12.0) as usize;
    format!("{rounded:.decimals$}").parse().unwrap_or(rounded)
}
