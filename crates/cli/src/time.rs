//! `leadscrew time`: how long a program takes, by the planner that would run it, and what it asks of the axes.
//!
//! Times are added up from the planner's own steps: motion, spindle ramps, waits, tool changes. Peaks are taken from the
//! setpoints as a drive would get them: differences at the servo period.
use crate::args::{Format, TimeArgs};
use crate::progress::Progress;
use crate::{render, say};
use control::Refused;
use control::job::{Session, read_program};
use plan::{Step, StepKind};
use serde_json::{Value, json};
use std::collections::BTreeMap;

mod longest;
mod peaks;
mod shares;
use longest::{Longest, Timed};
use peaks::Peaks;
pub(crate) use shares::{Added, without_jerk};
use shares::{Shares, rounded};

/// Operations that are listed without `--operations`: the longest.
const LONGEST: usize = 10;

/// What was added up.
struct Tally<'a> {
    all: Added<'a>,
    tool: u32,
    by_tool: BTreeMap<u32, Shares>,
    by_op: Longest,
    peaks: Peaks,
    steps: u64,
}

impl Tally<'_> {
    fn step(&mut self, step: &Step) {
        let time = self.all.step(step);
        if let StepKind::ChangeTool(number) = step.kind {
            self.tool = number;
        }
        self.by_tool.entry(self.tool).or_default().add(&step.kind, time);
        self.by_op.add(step.op, step.line, time);
        self.peaks.step(&step.kind);
        self.steps += 1;
    }
}

/// Say how long it takes.
pub(crate) fn command(args: &TimeArgs, quiet: bool) -> Result<bool, Refused> {
    let text = read_program(&args.program)?;
    let mut session = Session::load(&args.source.options(), &args.program, &text)?;
    let options = session.plan_options(session.machine.setup.stock.material);
    let limits = control::config::planner(&session.machine);
    let mut tally = Tally {
        all: Added::new(&limits),
        tool: session.tool(),
        by_tool: BTreeMap::new(),
        by_op: Longest::new(if args.operations { usize::MAX } else { LONGEST }),
        peaks: Peaks::new(session.machine.control.period.value()),
        steps: 0,
    };
    let began = args.timings.then(control::clock::now);
    let progress = Progress::of_lines(&text, "planning");
    let known =
        control::job::preflight::preflight_with(&mut session, &text, options, &mut |step| {
            progress.reached(step.line);
            tally.step(&step);
        });
    drop(progress);
    let took = began.map(|began| (control::clock::now() - began).as_secs_f64());
    let name = args.program.display().to_string();
    if known.is_refused() {
        return Err(Refused::program(name, text, session.drawn, known.findings));
    }
    if let Some(took) = took {
        let ratio = tally.all.shares.total() / took.max(1e-9);
        say::err(&format!("planned in {took:.3} s: {ratio:.0} times faster than it runs\n"));
    }
    let free = without_jerk(&mut session, &text, options);
    match args.format {
        Format::Text if quiet => {}
        Format::Text => {
            let source = render::Source { name: &name, text: &text, drawn: &session.drawn };
            say::err(&render::text(&known.findings, &source));
            say::out(&(people(&tally, &name) + &trade(tally.all.shares.motion(), free)))?;
        }
        Format::Json => {
            let mut value = programs(&tally, &name, &session.machine.name, args.operations);
            value["motion_time_without_jerk_limits_s"] = json!(free.map(rounded));
            say::out(&format!("{value:#}\n"))?;
        }
    }
    Ok(true)
}

fn trade(motion: f64, free: Option<f64>) -> String {
    let Some(free) = free.filter(|free| *free > 0.0) else { return String::new() };
    let more = (100.0 * (motion / free - 1.0)).max(0.0);
    format!("  without limits of jerk {free:>12.3} s in motion: they cost {more:.1} %\n")
}

fn operations(tally: &Tally) -> Vec<Value> {
    let of = |(op, (line, time)): Timed| json!({ "operation": op, "line": line, "time_s": rounded(time) });
    tally.by_op.all().into_iter().map(of).collect()
}

fn programs(tally: &Tally, name: &str, machine: &str, every: bool) -> Value {
    let mut value = tally.all.shares.json();
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
    let all = &tally.all.shares;
    let mut text =
        format!("{name}: {:.3} s, of which {:.3} s in motion\n", all.total(), all.motion());
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
