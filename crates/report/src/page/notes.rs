//! Alarms, warnings and notes: what a reader must know before believing the figures.
use crate::record::Recorder;
use crate::svg::{Tag, escape, fixed};
use crate::{Measure, Run};
use std::collections::BTreeMap;
use verify::{Feature, FeatureKind};

/// Items shown at most of each kind; the rest is counted.
const MOST: usize = 40;

/// Alarms and notes; nothing if there are none.
pub(super) fn notes(run: &Run, recorder: &Recorder, features: &[Feature]) -> String {
    let alarms = run.alarms.iter().map(|alarm| {
        let place = place(alarm.line);
        let remedy = alarm.remedy.as_ref().map_or(String::new(), |r| format!(" {r}"));
        let when = fixed(alarm.time.value(), 3);
        ("bad", format!("✗ Alarm {} at {when} s{place}: {}{remedy}", alarm.number, alarm.text))
    });
    let notes = run.notes.iter().map(|note| {
        let place = if note.line > 0 { format!("Line {}: ", note.line) } else { String::new() };
        if note.warning {
            ("warning", format!("⚠ {place}{}", note.text))
        } else {
            ("", format!("{place}{}", note.text))
        }
    });
    let alarms = super::section::section("Alarms", &list(alarms.collect()));
    let found = unfinished(recorder).into_iter().chain(saturated(recorder));
    let found = found.chain(out_of_step(run, recorder.measure(), features));
    let all = found.chain(notes).chain(limiting(run)).collect();
    let notes = super::section::section("Notes", &list(all));
    alarms + &notes
}

fn place(line: u32) -> String {
    if line > 0 { format!(", line {line}") } else { String::new() }
}

/// What limited the taps: each reason once, with how many it held back.
fn limiting(run: &Run) -> Vec<(&'static str, String)> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for reason in run.limiting.values() {
        *counts.entry(reason).or_default() += 1;
    }
    let words = counts
        .into_iter()
        .map(|(reason, taps)| ("", format!("What limited {}: {reason}", count(taps, "tap"))));
    words.collect()
}

fn unfinished(recorder: &Recorder) -> Option<(&'static str, String)> {
    let kept = recorder.kept_taps();
    let stuck = kept.iter().find(|trace| !trace.completed)?;
    Some(("bad", format!("✗ The tap of line {} did not come out of its hole in step.", stuck.line)))
}

/// Taps whose spindle could not give what the plan asked.
fn saturated(recorder: &Recorder) -> Option<(&'static str, String)> {
    let longest = fixed(recorder.saturated_longest.value() * 1e3, 1);
    let taps = count(recorder.saturated, "tap");
    let words = format!(
        "⚠ In {taps} the spindle's drive was at its limit, for up to {longest} ms: the ramp is steeper than its torque and power allow."
    );
    (recorder.saturated > 0).then_some(("warning", words))
}

/// Threads whose sync error passed the warning limit.
fn out_of_step(
    run: &Run,
    measure: Measure,
    features: &[Feature],
) -> Option<(&'static str, String)> {
    let warn = run.limits.sync_warn;
    let numbers: Vec<_> = features
        .iter()
        .enumerate()
        .filter(|(_, f)| matches!(&f.kind, FeatureKind::Thread(t) if t.sync_error_max > warn))
        .map(|(index, _)| (index + 1).to_string())
        .collect();
    let more = if numbers.len() > 10 { ", …" } else { "" };
    let first = numbers.iter().take(10).map(String::as_str).collect::<Vec<_>>().join(", ");
    let threads = count(numbers.len(), "thread");
    let words = format!(
        "⚠ In {threads} the sync error passed the warning limit of {} {}: No. {first}{more}.",
        measure.small(warn, 0),
        measure.small_symbol()
    );
    (!numbers.is_empty()).then_some(("warning", words))
}

fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

fn list(items: Vec<(&str, String)>) -> String {
    if items.is_empty() {
        return String::new();
    }
    let more = items.len().saturating_sub(MOST);
    let mut out: String = items
        .into_iter()
        .take(MOST)
        .map(|(class, text)| Tag::new("li").class(class).text(&text))
        .collect();
    if more > 0 {
        out += &Tag::new("li").around(&escape(&format!("… and {more} more")));
    }
    Tag::new("ul").class("list").around(&out)
}
