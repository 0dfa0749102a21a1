//! Status, features, alarms, offsets and tools as text.
use super::command::WORDS;
use canon::Axis;
use control::operation::{Control, StateChangeStatus, Status, WorkpieceStatus};
use std::fmt::Write as _;
use units::Coordinate;

/// The status line.
pub(super) fn line(status: &Status) -> String {
    let Status { mode, execution, activity, axes, program, .. } = status;
    let mut text = format!("{mode} {execution}, {activity}");
    if let Some(line) = program.as_ref().map(|program| program.line).filter(|line| *line > 0) {
        let _ = write!(text, ", line {line}");
    }
    if let Some(waiting) = &status.waiting_for {
        let _ = write!(text, ", waits for {} since {:.1} s", waiting.what, waiting.age_s);
    }
    text.push_str(" |");
    for axis in axes {
        let _ = write!(text, " {}{:.3}", axis.letter, tidy(axis.work));
    }
    let _ = write!(text, " | {}", status.work_offset);
    match status.tool {
        None => text.push_str(" T-"),
        Some(tool) => {
            let _ = write!(text, " T{tool}");
        }
    }
    if let Some(spindle) = status.spindles.first() {
        let _ = write!(text, " S{:.0}", tidy(spindle.ordered_rpm));
    }
    text
}

/// Without a sign where there is nothing.
fn tidy(value: f64) -> f64 {
    if value.abs() < 5e-4 { 0.0 } else { value }
}

/// All of it.
pub(super) fn status(status: &Status, as_json: bool) -> String {
    if as_json {
        // its values are numbers and names
        let text = serde_json::to_string_pretty(status).unwrap_or_default();
        return text + "\n";
    }
    let mut text = format!("  {}\n", line(status));
    let _ = writeln!(
        text,
        "  emergency stop {}, power {}, feed {:.0} %, rapid {:.0} %, spindle {:.0} %{}",
        status.emergency_stop,
        status.power,
        status.overrides.feed_percent,
        status.overrides.rapid_percent,
        status.overrides.spindle_percent,
        if status.overrides.is_locked { ", locked by a synchronised cut" } else { "" },
    );
    for axis in &status.axes {
        let homed = if axis.is_homed { "" } else { "  not homed" };
        let _ = writeln!(
            text,
            "  {} {:10.4} {}  machine {:10.4}{homed}",
            axis.letter,
            tidy(axis.work),
            axis.unit,
            tidy(axis.machine)
        );
    }
    if !status.codes.is_empty() {
        let _ = writeln!(text, "  {}", status.codes.join(" "));
    }
    if let Some(program) = &status.program {
        let planned = program.planned_s.map_or_else(
            || ", its time is being planned".to_owned(),
            |planned| format!(" of {planned:.1} s planned"),
        );
        let _ = writeln!(text, "  {}: {:.1} s{planned}", program.name, program.elapsed_s);
    }
    let features = status.features;
    let _ = writeln!(
        text,
        "  {}: {} features good, {} out of tolerance, {} not judged, {} programs",
        workpiece(&status.workpiece),
        features.good,
        features.failed,
        features.not_judged,
        status.workpiece.programs
    );
    for alarm in &status.alarms {
        let _ = writeln!(text, "  {alarm}");
    }
    for change in &status.state_changes {
        let StateChangeStatus { datum, before, now, why } = change;
        let _ = writeln!(text, "  state: {datum} {before} → {now}: {why}");
    }
    text
}

/// What was cut.
pub(super) fn features(control: &Control) -> String {
    let mut text = String::new();
    for said in control.features_said() {
        let _ = writeln!(text, "  {said}");
    }
    for breach in control.breaches() {
        let _ = writeln!(text, "  safety check violated: {breach}");
    }
    let Status { features: count, workpiece: work, .. } = control.status();
    if work.unlisted > 0 {
        let _ = writeln!(text, "  and {} before, in features.jsonl", work.unlisted);
    }
    let _ = writeln!(
        text,
        "  {}: {} good, {} out of tolerance, {} not judged",
        workpiece(&work),
        count.good,
        count.failed,
        count.not_judged
    );
    text
}

/// Number and name of the workpiece.
fn workpiece(work: &WorkpieceStatus) -> String {
    let name = work.name.as_ref().map_or(String::new(), |name| format!(" ({name})"));
    let ended = if work.is_ended { ", ended" } else { "" };
    format!("workpiece {}{name}{ended}", work.number)
}

/// How far a tool change is, inputs as they are and as they should be, and where the tools are.
pub(super) fn sequence(control: &Control) -> String {
    let mut said = String::new();
    let on = |is: bool| if is { "on" } else { "off" };
    match control.sequence_status() {
        None => said += "no tool change is under way or half way\n",
        Some(now) => {
            let way = if now.is_back { ", being undone" } else { "" };
            let stands = if now.is_half_way { ", half way" } else { "" };
            let _ = writeln!(
                said,
                "{}, T{} to T{}: step {} of {}, {}{way}{stands}",
                now.name, now.from, now.to, now.number, now.of, now.step
            );
            if let Some(sentence) = &now.operator {
                let _ = writeln!(said, "  {sentence}");
            }
            for input in &now.inputs {
                let sign = if input.is == input.should_be { ' ' } else { '!' };
                let (is, should) = (on(input.is), on(input.should_be));
                let _ = writeln!(said, "{sign} {} is {is}, should be {should}", input.name);
            }
            if now.is_half_way {
                said += "  sequence go on, sequence undo, sequence step [back], or sequence done TOOL\n";
            }
        }
    }
    if let Some(magazine) = control.magazine_status() {
        let at = magazine.at.map_or_else(|| "not known".to_owned(), |at| at.to_string());
        let _ = write!(said, "spindle T{}, pocket at the spindle {at};", magazine.spindle);
        for (pocket, tool) in (1..).zip(&magazine.pockets).filter(|(_, tool)| **tool != 0) {
            let _ = write!(said, " {pocket}: T{tool}");
        }
        said.push('\n');
    }
    said
}

/// Alarms, oldest first.
pub(super) fn alarms(control: &Control) -> String {
    let mut text = String::new();
    for alarm in control.alarms() {
        let cleared = if alarm.is_cleared { " (cleared)" } else { "" };
        let program = alarm.program.as_deref().unwrap_or("no program");
        let _ = writeln!(text, "  {}{cleared}\n    in {program}; {}", alarm.text, alarm.remedy);
    }
    if text.is_empty() { "  none\n".into() } else { text }
}

/// Work offsets that are set.
pub(super) fn offsets(control: &Control) -> String {
    let mut text = String::new();
    for system in 1..=9 {
        let axes = control.machine().axes.iter().flatten().map(|axis| axis.letter);
        let zeros: Vec<(Axis, Coordinate)> =
            axes.map(|axis| (axis, control.zero_of(system, axis))).collect();
        if system == 1 || zeros.iter().any(|(_, at)| *at != Coordinate::ZERO) {
            let words =
                zeros.iter().map(|(axis, at)| format!("{}{:.4}", axis.letter(), at.value()));
            let name = control.work_offset_name(system);
            let _ = writeln!(text, "  {name} {}", words.collect::<Vec<_>>().join(" "));
        }
    }
    text
}

/// The tool table.
pub(super) fn tools(control: &Control) -> String {
    let mut text = String::new();
    for tool in control.tools() {
        let _ = write!(
            text,
            "  T{} {}: length {:.3} mm, diameter {:.3} mm",
            tool.number,
            tool.description,
            tool.length.value(),
            tool.diameter.value()
        );
        let (used, most) = (tool.life.used.uses, tool.life.limit.uses);
        let _ = match most {
            Some(most) => writeln!(text, ", {used} of {most} uses"),
            None => writeln!(text, ", {used} uses"),
        };
    }
    text
}

/// What can be typed.
pub(super) fn help() -> String {
    let mut text = String::new();
    for (words, what) in WORDS {
        let _ = writeln!(text, "  {words:<30} {what}");
    }
    text
}
