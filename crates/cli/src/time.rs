//! `leadscrew time`: how long a program takes, and what it asks of the axes.
use crate::args::{Format, TimeArgs};
use crate::progress::Progress;
use crate::{render, say};
use canon::LengthUnit;
use control::Refused;
use control::clock::now;
use control::job::preflight::{Preflight, preflight_with};
use leadscrew::time::{Estimate, Peak, Peaks, Shares, Timed, Times, WithoutJerk};
use leadscrew::{Job, Program};
use serde_json::{Value, json};
use units::Time;

/// Say how long it takes. Nothing is kept of a program but what is added up: it may have any
/// length.
pub(crate) fn command(args: &TimeArgs, quiet: bool) -> Result<bool, Refused> {
    let mut job = Program::open(&args.program)?.on(args.source.options())?;
    if !quiet {
        crate::run::say_chosen(&job);
    }
    let began = args.timings.then(now);
    let progress = Progress::of_lines(&job.program.text, "planning");
    let mut look = |step: &plan::Step| progress.reached(step.line);
    let (found, known) = found(&mut job, args, &mut look)?;
    drop(progress);
    if let Some(began) = began {
        let took = (now() - began).as_secs_f64();
        let ratio = found.shares().total().value() / took.max(1e-9);
        say::err(&format!("planned in {took:.3} s: {ratio:.0} times faster than it runs\n"));
    }
    let name = &job.program.name;
    match args.format {
        Format::Text if quiet => {}
        Format::Text => {
            let unit = job.session.unit;
            let (text, drawn) = (&job.program.text, &job.session.drawn);
            say::coloured_err(&render::text(
                &known.findings,
                &render::Source { name, text, drawn },
            ));
            say::out(&found.people(name, unit))?;
        }
        Format::Json => {
            say::out(&format!("{:#}\n", found.answer(&job, args.operations)))?;
        }
    }
    Ok(true)
}

/// What an estimate may be off, as a share of the time.
const WITHIN: f64 = 0.02;

/// What was found out.
pub(crate) enum ProgramTime {
    /// Every move was planned.
    Whole(Box<Times>),
    /// A sample of them.
    Sample(Estimate),
}

impl ProgramTime {
    fn shares(&self) -> &Shares {
        match self {
            Self::Whole(times) => times.shares(),
            Self::Sample(estimate) => &estimate.shares,
        }
    }

    fn people(&self, name: &str, unit: LengthUnit) -> String {
        match self {
            Self::Whole(times) => {
                people(times, name, unit) + &trade(times.shares().motion(), times.without_jerk)
            }
            Self::Sample(Estimate { shares, within, planned, stretches }) => format!(
                "{}  within ±{:.1} %: {planned} of {stretches} stretches of it were planned\n",
                shares_as_text(shares, name),
                100.0 * within,
            ),
        }
    }

    /// The same for programs.
    pub(crate) fn answer(&self, job: &Job, operations: bool) -> Value {
        match self {
            Self::Whole(times) => answer(times, job, operations),
            Self::Sample(Estimate { shares, within, planned, stretches }) => {
                let mut value = shares_as_json(shares);
                value["program"] = json!(job.program.name);
                value["machine"] = json!(job.session.machine.name);
                value["within_share"] = json!(within);
                value["planned_stretches"] = json!(planned);
                value["stretches"] = json!(stretches);
                value
            }
        }
    }
}

/// From a sample where that is asked for and is enough, else from all of it.
pub(crate) fn found(
    job: &mut Job,
    args: &TimeArgs,
    look: &mut dyn FnMut(&plan::Step),
) -> Result<(ProgramTime, Preflight), Refused> {
    if args.fast
        && let (Some(estimate), known) = job.estimate(WITHIN, &mut |step| look(step))?
    {
        return Ok((ProgramTime::Sample(estimate), known));
    }
    let (times, known) = measured(job, args.operations, look)?;
    Ok((ProgramTime::Whole(Box::new(times)), known))
}

/// How long it takes, with a look at every step of the planner.
fn measured(
    job: &mut Job,
    operations: bool,
    look: &mut dyn FnMut(&plan::Step),
) -> Result<(Times, Preflight), Refused> {
    let mut times = Times::new(&job.session, operations.then_some(usize::MAX));
    let mut free = WithoutJerk::of(&mut job.session, job.plan);
    let mut steps = |step: plan::Step| {
        look(&step);
        times.step(&step);
    };
    let mut ops = |index, op: &canon::Op, frame| {
        if let Some(free) = &mut free {
            free.op(index, op, frame);
        }
    };
    let known = preflight_with(&mut job.session, &job.program.text, job.plan, &mut steps, &mut ops);
    if known.is_refused() {
        return Err(job.refused(known.findings));
    }
    times.without_jerk = free.map(WithoutJerk::motion);
    Ok((times, known))
}

fn answer(times: &Times, job: &Job, operations: bool) -> Value {
    let mut value = programs(times, &job.program.name, &job.session.machine.name, operations);
    value["motion_time_without_jerk_limits_s"] = json!(times.without_jerk.map(rounded));
    value
}

fn trade(motion: Time, free: Option<Time>) -> String {
    let Some(free) = free.filter(|free| *free > Time::ZERO) else { return String::new() };
    let more = (100.0 * (motion / free - 1.0)).max(0.0);
    format!("  without limits of jerk {:>12.3} s in motion: they cost {more:.1} %\n", free.value())
}

fn operations(times: &Times) -> Vec<Value> {
    let of = |(op, (line, time)): Timed| json!({ "operation": op, "line": line, "time_s": rounded(time) });
    times.longest().into_iter().map(of).collect()
}

fn programs(times: &Times, name: &str, machine: &str, every: bool) -> Value {
    let mut value = shares_as_json(times.shares());
    let tools: Vec<Value> = times
        .by_tool()
        .map(|(tool, shares)| {
            let mut value = shares_as_json(shares);
            value["tool"] = json!(tool);
            value
        })
        .collect();
    value["program"] = json!(name);
    value["machine"] = json!(machine);
    value["steps"] = json!(times.steps);
    value["peaks"] = peaks_as_json(times.peaks());
    value["tools"] = json!(tools);
    value[if every { "operations" } else { "longest_operations" }] = json!(operations(times));
    value
}

fn shares_as_text(all: &Shares, name: &str) -> String {
    let mut text = format!(
        "{name}: {:.3} s, of which {:.3} s in motion\n",
        all.total().value(),
        all.motion().value()
    );
    for (what, time) in [
        ("feed", all.feed),
        ("rapids", all.rapid),
        ("tapping", all.tap),
        ("threading", all.thread),
        ("turns of the work", all.turn),
        ("waiting for the spindle", all.wait),
        ("dwells", all.dwell),
        ("tool changes", all.tool_change),
    ] {
        if time > Time::ZERO {
            text += &format!("  {what:<24} {:>10.3} s\n", time.value());
        }
    }
    text
}

fn people(times: &Times, name: &str, unit: LengthUnit) -> String {
    let mut text = shares_as_text(times.shares(), name);
    if times.by_tool().len() > 1 {
        for (tool, shares) in times.by_tool() {
            text += &format!("  T{tool:<23} {:>10.3} s\n", shares.total().value());
        }
    }
    text + &peaks_as_text(times.peaks(), unit)
}

/// Times by what takes them, s.
fn shares_as_json(shares: &Shares) -> Value {
    json!({
        "total_time_s": rounded(shares.total()),
        "motion_time_s": rounded(shares.motion()),
        "feed_time_s": rounded(shares.feed),
        "rapid_time_s": rounded(shares.rapid),
        "tapping_time_s": rounded(shares.tap),
        "threading_time_s": rounded(shares.thread),
        "turning_time_s": rounded(shares.turn),
        "waiting_time_s": rounded(shares.wait),
        "dwell_time_s": rounded(shares.dwell),
        "tool_change_time_s": rounded(shares.tool_change),
    })
}

/// Seconds, to a microsecond.
fn rounded(time: Time) -> f64 {
    (time.value() * 1e6).round() / 1e6
}

fn peaks_as_json(peaks: &Peaks) -> Value {
    let of = |(letter, peak): (char, &Peak)| {
        let Peak { speed, accel, jerk } = peak;
        if is_rotary(letter) {
            return json!({
                "axis": letter.to_string(),
                "speed_deg_per_s": speed,
                "acceleration_deg_per_s2": accel,
                "jerk_deg_per_s3": jerk,
            });
        }
        json!({
            "axis": letter.to_string(),
            "speed_mm_per_s": speed,
            "acceleration_mm_per_s2": accel,
            "jerk_m_per_s3": jerk / 1e3,
        })
    };
    peaks.moved().map(of).collect()
}

fn peaks_as_text(peaks: &Peaks, unit: LengthUnit) -> String {
    let of = |(letter, peak): (char, &Peak)| {
        let Peak { speed, accel, jerk } = peak;
        if is_rotary(letter) {
            return format!("  {letter} at most {speed:.1} °/s, {accel:.0} °/s², {jerk:.0} °/s³\n");
        }
        if unit == LengthUnit::Inch {
            let [speed, accel, jerk] = [speed, accel, jerk].map(|value| value / unit.in_mm());
            return format!(
                "  {letter} at most {speed:.2} in/s, {accel:.1} in/s², {jerk:.0} in/s³\n"
            );
        }
        let jerk = jerk / 1e3;
        format!("  {letter} at most {speed:.1} mm/s, {accel:.0} mm/s², {jerk:.1} m/s³\n")
    };
    peaks.moved().map(of).collect()
}

fn is_rotary(letter: char) -> bool {
    canon::Axis::from_letter(letter).is_some_and(|axis| axis.kind() == units::AxisKind::Rotary)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_jerk_costs_is_a_share_of_the_time_without() {
        assert!(trade(Time::s(2.3), Some(Time::s(2.0))).ends_with("they cost 15.0 %\n"));
        assert_eq!(trade(Time::s(2.0), None), "");
    }
}
