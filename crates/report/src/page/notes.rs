//! Alarms, warnings and notes: what a reader must know before believing the figures.
use crate::Run;
use crate::record::Recorder;
use crate::svg::{Tag, escape, fixed};
use std::collections::BTreeMap;

/// Items shown at most of each kind; the rest is counted.
const MOST: usize = 40;

/// Alarms and notes; nothing if there are none.
pub(super) fn notes(run: &Run, recorder: &Recorder) -> String {
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
    let alarms = super::section("Alarms", &list(alarms.collect()));
    let notes = super::section(
        "To know",
        &list(notes.chain(limiting(run)).chain(unfinished(recorder)).collect()),
    );
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
    let words = counts.into_iter().map(|(reason, count)| {
        let taps = if count == 1 { "1 tap".into() } else { format!("{count} taps") };
        ("", format!("What limited {taps}: {reason}"))
    });
    words.collect()
}

fn unfinished(recorder: &Recorder) -> Option<(&'static str, String)> {
    let kept = recorder.kept_taps();
    let stuck = kept.iter().find(|trace| !trace.completed)?;
    Some(("bad", format!("✗ The tap of line {} did not come out of its hole in step.", stuck.line)))
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
