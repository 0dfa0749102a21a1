//! What is said of a recovery: to people, to programs, and as a picture.
use super::advice;
use crate::args::RecoverArgs;
use crate::typed;
use bus::Feedback;
use control::recovery::{Answer, Findings, Off, Outcome, Withdrawal, along_pass, pass};
use store::machine::MachineFile;
use store::sync_record::{Cut, SyncRecord};
use sync::recovery::{Mover, Point, Stored, Way};

pub(super) fn picture(record: &SyncRecord, findings: &Findings) -> String {
    let chosen = [findings.projection.unloaded, findings.projection.to];
    drawn(record, &findings.stored, findings.at, chosen, findings.direct.to)
}

/// Of a thread that is turned, where its tool goes back along it; `None` of what has no line.
pub(super) fn picture_of_pass(
    record: &SyncRecord,
    feedback: &Feedback,
    file: &MachineFile,
) -> Option<String> {
    let pass = pass(&record.stroke)?;
    let approach = file.axis(pass.axis)?.approach;
    let plan = along_pass(
        &pass,
        record.stroke.spindle,
        feedback,
        (approach.speed.of_linear(), approach.acceleration.of_linear()),
    )?;
    let at = Point {
        angle: feedback.spindles[usize::from(plan.spindle)].angle + plan.turn,
        place: feedback.axes[pass.axis.index()].position.of_linear(),
    };
    let way = plan.stored.project(at, plan.way);
    Some(drawn(record, &plan.stored, at, [way.unloaded, way.to], way.to))
}

fn drawn(
    record: &SyncRecord,
    stored: &Stored,
    at: Point,
    chosen: [Point; 2],
    direct: Point,
) -> String {
    let (stroke, place) = (&record.stroke, &record.place);
    let zero = stored.start().angle;
    let point = |p: Point| [(p.angle - zero).value(), (p.place - stroke.surface).value()];
    let wherein = match stroke.cut {
        Cut::Tap => format!("hole {} of {}", place.hole, place.program),
        _ => format!("the thread of line {} of {}", place.line, place.program),
    };
    report::recovery_svg(&report::Recovery {
        title: format!("Tool {} in {wherein}", stroke.tool),
        start: point(stored.start()),
        end: point(stored.end()),
        stop: point(at),
        chosen: chosen.map(point),
        direct: point(direct),
    })
}

/// Who moves first.
fn first(findings: &Findings) -> &'static str {
    let projection = &findings.projection;
    match projection.mover {
        _ if findings.way == Way::Straight => "feed, straight out: the tip stands over the work",
        _ if projection.unloaded != projection.from => "feed, to zero force",
        Some(Mover::Feed) => "feed",
        Some(Mover::Spindle) => "spindle",
        None => "neither: it is on its thread",
    }
}

/// How a tool that is not screwed to the work leaves it.
fn off_the_work(way: &Withdrawal) -> String {
    let by = way.infeed.to - way.infeed.from;
    let letter = way.infeed.axis.letter();
    let along = way.along.map_or_else(String::new, |leg| {
        let letter = leg.axis.letter();
        if way.together {
            format!(", then spindle and {letter} back along the thread")
        } else {
            format!(", then {letter} back by itself: the lead of its thread grows")
        }
    });
    format!("{letter} by {:+.3} mm, off the work{along}", by.value())
}

/// The command that goes on with the rest.
fn go_on(args: &RecoverArgs, record: &SyncRecord) -> String {
    let state = args.state.as_ref().map(|state| typed::quoted(&state.display().to_string()));
    let state = state.map_or_else(String::new, |state| format!(" --state {state}"));
    let from = match record.stroke.cut {
        Cut::Tap => format!("\"hole {}\"", record.place.hole),
        _ => record.place.line.to_string(),
    };
    let job = match &record.place.command[..] {
        [] => typed::quoted(&record.place.program) + &advice::option_machine(record),
        command => typed::joined(command),
    };
    let simulator = typed::quoted(&args.simulator.display().to_string());
    format!("leadscrew run {job} --simulator {simulator}{state} --from {from}")
}

pub(super) fn json(args: &RecoverArgs, answer: &Answer) -> String {
    let record = answer.record.as_ref();
    let findings = answer.findings.as_ref();
    let way = answer.withdrawal.as_ref().map(|(way, _)| way);
    let off = way.and_then(|way| way.off.ok());
    let known = findings.and_then(|f| f.bound.as_ref().ok());
    let on_thread = findings.filter(|_| known.is_some());
    let error = on_thread.map(|f| f.stored.error(f.at)).or(off.map(|off| off.length));
    let phase = on_thread.map(|f| f.stored.phase_difference(f.at)).or(off.map(|off| off.angle));
    let unknown = findings.and_then(|f| f.bound.as_ref().err().copied());
    let value = serde_json::json!({
        "outcome": match answer.outcome {
            Outcome::Recovered => "recovered",
            Outcome::Refused => "refused",
            Outcome::Nothing => "nothing-to-do",
            Outcome::NotKnownWhole => "not-known-whole",
        },
        "reason": answer.reason,
        "phase_error_before_um": error.map(units::Length::in_um),
        "phase_error_before_deg": phase.map(units::Angle::in_deg),
        "phase_error_unknown": unknown.or_else(|| way.and_then(|way| way.off.err())),
        "phase_error_bound_um": known.map(|(bound, _)| bound.in_um()),
        "overrun_mm": findings.map(|f| f.overrun.value().max(0.0)),
        "not_known_whole": not_known_whole(answer),
        "helix_error_max_um": answer.figures.as_ref().map(|f| f.helix_error_max.in_um()),
        "cut": record.map(|r| r.stroke.cut.name()),
        "moved_first": findings.map(|f| first(f).to_owned()).or_else(|| way.map(off_the_work)),
        "retreat_mm": way.map(|way| (way.infeed.to - way.infeed.from).value()),
        "hand": record.filter(|r| r.stroke.lead != units::Lead::ZERO).map(|r| if r.stroke.is_right_hand() { "right" } else { "left" }),
        "program": record.map(|r| r.place.program.as_str()),
        "line": record.map(|r| r.place.line),
        "hole": record.map(|r| r.place.hole),
        "tool": record.map(|r| r.stroke.tool),
        "dry_run": args.dry_run,
        "note": answer.note,
        "continue_with": record.filter(|_| answer.outcome.is_out()).map(|r| go_on(args, r)),
    });
    format!("{value:#}\n")
}

pub(super) fn text(args: &RecoverArgs, answer: &Answer) -> String {
    let mut text = match answer.outcome {
        Outcome::Recovered => "recovered: ".to_owned(),
        Outcome::Refused => "refused: ".to_owned(),
        Outcome::Nothing => "nothing to do: ".to_owned(),
        Outcome::NotKnownWhole => "not known to be whole: ".to_owned(),
    };
    text += &answer.reason;
    text.push('\n');
    if let Some(record) = &answer.record {
        text += &tool(record);
    }
    if let Some(findings) = &answer.findings {
        let error = findings.stored.error(findings.at);
        let phase = findings.stored.phase_difference(findings.at).in_deg();
        text += &match &findings.bound {
            Ok((bound, why)) => format!(
                "  before         {:.1} µm off its thread ({phase:.2}° of the spindle), known within {:.1} µm: {why}\n",
                error.in_um(),
                bound.in_um(),
            ),
            Err(why) => format!("  before         not known: {why}\n"),
        };
        text += &format!("  moves first    {}\n", first(findings));
    }
    if let Some((way, taken)) = &answer.withdrawal {
        text += &match way.off {
            Ok(Off { length, angle, of }) => format!(
                "  before         {:.1} µm off {of} ({:.3}° of the spindle that {}), taken to the nearest turn\n",
                length.in_um(),
                angle.in_deg(),
                if way.along.is_some() { "leads" } else { "follows" },
            ),
            Err(why) => format!("  before         not known: {why}\n"),
        };
        text += &format!("  moves first    {}\n", off_the_work(way));
        let along = answer.figures.as_ref().map_or_else(String::new, |figures| {
            format!("{:.1} µm off its thread at most, ", figures.helix_error_max.in_um())
        });
        if let Some(taken) = taken {
            text += &format!("  on the way out {along}{:.2} s\n", taken.value());
        }
    } else if let Some(figures) = &answer.figures {
        text += &format!(
            "  on the way out {:.1} µm off its thread at most, {:.2} s\n",
            figures.helix_error_max.in_um(),
            figures.duration.value()
        );
    }
    if let Some(why) = not_known_whole(answer) {
        text += &format!("  look at it     {why}. See that it is whole before you go on\n");
    }
    if let Some(note) = &answer.note {
        text += &format!("  note           {note}\n");
    }
    let is_drawn = answer.findings.is_some()
        || answer.withdrawal.as_ref().is_some_and(|(way, _)| way.together);
    if let Some(path) = args.picture.as_ref().filter(|_| is_drawn) {
        text += &format!("  picture        {}\n", path.display());
    }
    match (&answer.record, answer.outcome) {
        (Some(record), Outcome::Recovered | Outcome::NotKnownWhole) if !args.dry_run => {
            text += &format!("  go on with     {}\n", go_on(args, record));
        }
        (_, Outcome::Refused) => {
            text += &format!(
                "  help           see for yourself; once no tool is in the work: {}\n",
                advice::free_by_hand(
                    &args.simulator,
                    args.machine.as_deref(),
                    args.state.as_deref()
                )
            );
        }
        _ => {}
    }
    text
}

/// Why a tap may be broken.
fn not_known_whole(answer: &Answer) -> Option<&str> {
    answer.findings.as_ref()?.not_known_whole.as_deref()
}

/// Which tool is in the work, and where.
fn tool(record: &SyncRecord) -> String {
    let (stroke, place) = (&record.stroke, &record.place);
    let hand = if stroke.is_right_hand() { "right" } else { "left" };
    let mut lead = format!("{} mm", stroke.lead.value().abs());
    let grows = stroke.growth.value() * stroke.lead.value().signum();
    if grows != 0.0 {
        let changes = if grows > 0.0 { "growing" } else { "shrinking" };
        lead += &format!(" {changes} {} mm a turn", grows.abs());
    }
    let (number, program, line) = (stroke.tool, &place.program, place.line);
    match stroke.cut {
        Cut::Tap => format!(
            "  tap            tool {number}, {hand} hand, lead {lead}; hole {} of {program}, line {line}\n",
            place.hole,
        ),
        Cut::Thread => format!(
            "  threading pass tool {number}, {hand} hand, lead {lead}; {program}, line {line}\n"
        ),
        cut => format!("  {:<14} tool {number}; {program}, line {line}\n", cut.name()),
    }
}
