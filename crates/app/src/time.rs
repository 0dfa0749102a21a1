//! `leadscrew time`: how long a program takes, by the planner that would run it, and what it asks of the axes.
//!
//! Times are added up from the planner's own steps: motion, spindle ramps, waits, tool changes. Peaks are taken from the
//! setpoints as a drive would get them: differences at the servo period.
use crate::args::{Format, TimeArgs};
use crate::refused::Refused;
use crate::session::{Session, read_program};
use crate::{render, say};
use plan::{Clock, MachineLimits, Step, StepKind};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use units::Jerk;

mod longest;
mod peaks;
use longest::{Longest, Timed};
use peaks::Peaks;

/// Operations that are listed without `--operations`: the longest.
const LONGEST: usize = 10;

/// What takes time, in the order of the report.
#[derive(Clone, Copy, Debug, Default)]
struct Shares {
    feed: f64,
    rapid: f64,
    tap: f64,
    wait: f64,
    dwell: f64,
    tool_change: f64,
}

impl Shares {
    fn add(&mut self, step: &StepKind, time: f64) {
        let share = match step {
            StepKind::Move(order) if order.rapid => &mut self.rapid,
            StepKind::Follow(order) if order.piece.rapid => &mut self.rapid,
            StepKind::Move(_) | StepKind::Follow(_) => &mut self.feed,
            StepKind::Tap(_) => &mut self.tap,
            StepKind::Dwell(_) => &mut self.dwell,
            StepKind::ChangeTool(_) => &mut self.tool_change,
            _ => &mut self.wait,
        };
        *share += time;
    }

    fn motion(&self) -> f64 {
        self.feed + self.rapid + self.tap
    }

    fn total(&self) -> f64 {
        self.motion() + self.wait + self.dwell + self.tool_change
    }

    fn json(&self) -> Value {
        json!({
            "total_time_s": rounded(self.total()),
            "motion_time_s": rounded(self.motion()),
            "feed_time_s": rounded(self.feed),
            "rapid_time_s": rounded(self.rapid),
            "tapping_time_s": rounded(self.tap),
            "waiting_time_s": rounded(self.wait),
            "dwell_time_s": rounded(self.dwell),
            "tool_change_time_s": rounded(self.tool_change),
        })
    }
}

/// To a microsecond.
fn rounded(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// What was added up.
struct Tally<'a> {
    limits: &'a MachineLimits,
    clock: Clock,
    all: Shares,
    tool: u32,
    by_tool: BTreeMap<u32, Shares>,
    by_op: Longest,
    peaks: Peaks,
    steps: u64,
}

impl Tally<'_> {
    fn step(&mut self, step: &Step) {
        let before = self.clock.elapsed().value();
        self.clock.count(step, self.limits);
        let time = self.clock.elapsed().value() - before;
        if let StepKind::ChangeTool(number) = step.kind {
            self.tool = number;
        }
        self.all.add(&step.kind, time);
        self.by_tool.entry(self.tool).or_default().add(&step.kind, time);
        self.by_op.add(step.op, step.line, time);
        self.peaks.step(&step.kind);
        self.steps += 1;
    }
}

/// Say how long it takes.
pub(crate) fn command(args: &TimeArgs, quiet: bool) -> Result<bool, Refused> {
    let text = read_program(&args.program)?;
    let mut session = Session::load(&args.source, &args.program, &text)?;
    let options = session.plan_options(session.machine.setup.stock.material);
    let limits = crate::wiring::planner(&session.machine);
    let mut tally = Tally {
        limits: &limits,
        clock: Clock::default(),
        all: Shares::default(),
        tool: 0,
        by_tool: BTreeMap::new(),
        by_op: Longest::new(if args.operations { usize::MAX } else { LONGEST }),
        peaks: Peaks::new(session.machine.control.period.value()),
        steps: 0,
    };
    let known =
        crate::preflight::preflight_with(&mut session, &text, options, &mut |s| tally.step(&s));
    let name = args.program.display().to_string();
    if known.is_refused() {
        return Err(Refused::program(name, text, session.drawn, known.findings));
    }
    let free = without_jerk(&mut session, &text, options);
    match args.format {
        Format::Text => {
            if !quiet {
                let source = render::Source { name: &name, text: &text, drawn: &session.drawn };
                say::err(&render::text(&known.findings, &source));
            }
            say::out(&(people(&tally, &name) + &trade(tally.all.motion(), free)))?;
        }
        Format::Json => {
            let mut value = programs(&tally, &name, &session.machine.name, args.operations);
            value["motion_time_without_jerk_limits_s"] = json!(free.map(rounded));
            say::out(&format!("{value:#}\n"))?;
        }
    }
    Ok(true)
}

/// Time in motion if no axis had a limit of jerk; `None`: none has one.
fn without_jerk(session: &mut Session, text: &[u8], options: plan::Options) -> Option<f64> {
    let free = Jerk::mm_per_s3(f64::INFINITY);
    let axes = &mut session.machine.axes;
    if axes.iter().flatten().all(|axis| axis.jerk_feed == free && axis.jerk_rapid == free) {
        return None;
    }
    for axis in axes.iter_mut().flatten() {
        (axis.jerk_feed, axis.jerk_rapid) = (free, free);
    }
    let limits = crate::wiring::planner(&session.machine);
    let (mut clock, mut shares) = (Clock::default(), Shares::default());
    crate::preflight::preflight_with(session, text, options, &mut |step| {
        let before = clock.elapsed().value();
        clock.count(&step, &limits);
        shares.add(&step.kind, clock.elapsed().value() - before);
    });
    Some(shares.motion())
}

fn trade(motion: f64, free: Option<f64>) -> String {
    let Some(free) = free.filter(|free| *free > 0.0) else { return String::new() };
    let more = 100.0 * (motion / free - 1.0);
    format!("  without limits of jerk {free:>12.3} s in motion: they cost {more:.1} %\n")
}

fn operations(tally: &Tally) -> Vec<Value> {
    let of = |(op, (line, time)): Timed| json!({ "operation": op, "line": line, "time_s": rounded(time) });
    tally.by_op.all().into_iter().map(of).collect()
}

fn programs(tally: &Tally, name: &str, machine: &str, every: bool) -> Value {
    let mut value = tally.all.json();
    let tools: Vec<Value> = tally
        .by_tool
        .iter()
        .map(|(tool, shares)| {
            let mut value = shares.json();
            value["tool"] = json!(tool);
            value
        })
        .collect();
    value["program"] = json!(name);
    value["machine"] = json!(machine);
    value["steps"] = json!(tally.steps);
    value["peaks"] = tally.peaks.json();
    value["tools"] = json!(tools);
    value[if every { "operations" } else { "longest_operations" }] = json!(operations(tally));
    value
}

fn people(tally: &Tally, name: &str) -> String {
    let all = &tally.all;
    let mut text =
        format!("{name}: {:.3} s, of which {:.3} s in motion\n", all.total(), all.motion());
    for (what, time) in [
        ("feed", all.feed),
        ("rapids", all.rapid),
        ("tapping", all.tap),
        ("waiting for the spindle", all.wait),
        ("dwells", all.dwell),
        ("tool changes", all.tool_change),
    ] {
        if time > 0.0 {
            text += &format!("  {what:<24} {time:>10.3} s\n");
        }
    }
    if tally.by_tool.len() > 1 {
        for (tool, shares) in &tally.by_tool {
            text += &format!("  T{tool:<23} {:>10.3} s\n", shares.total());
        }
    }
    text + &tally.peaks.text()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_jerk_costs_is_a_share_of_the_time_without() {
        assert!(trade(2.3, Some(2.0)).ends_with("they cost 15.0 %\n"));
        assert_eq!(trade(2.0, None), "");
    }
}
