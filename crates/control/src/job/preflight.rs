//! Everything that can be known before anything moves.
//!
//! The whole program is interpreted and planned once without moving: all findings of interpreter and planner, what is
//! legal but hurts, and what is to be said of the tool table come out at once, with the planned time; tools that the
//! table lacks get their stand-ins here if the user allows them.
//!
//! ```text
//!   check ─┐                      ┌─ interpreter   what blocks mean
//!   time  ─┼─► one preflight ─────┼─ planner       machine, tools, stock
//!   run   ─┤    one order         ├─ remarks       legal, and likely to hurt
//!   lsp   ─┘                      └─ tool table    which one, and what was not understood of it
//! ```
use crate::Refused;
use crate::job::Ops;
use crate::job::Session;
use crate::job::restart::Restart;
use canon::{Op, OpKind, Tool, ToolKind};
use diag::{Diagnostic, Severity};
use interp::MissingTools;
use plan::{Options, Planner, Start};
use std::collections::{BTreeSet, HashSet};
use units::{Length, Time};

/// What is known.
pub struct Preflight {
    /// Findings, in the order of the program.
    pub findings: Vec<Diagnostic>,
    /// Planned time from start to end.
    pub planned: Time,
}

impl Preflight {
    /// Whether the program is refused.
    pub fn is_refused(&self) -> bool {
        self.findings.iter().any(Diagnostic::is_error)
    }
}

/// Interpret and plan a program without moving. Stand-ins are added to the session's tools.
pub fn preflight(session: &mut Session, source: &[u8], options: Options) -> Preflight {
    preflight_with(session, source, options, &mut |_| ())
}

/// The same, with a look at every step.
pub fn preflight_with(
    session: &mut Session,
    source: &[u8],
    options: Options,
    look: &mut impl FnMut(plan::Step),
) -> Preflight {
    let assumed = stand_in(session, source);
    let planner = judging(session, options);
    read(session, source, planner, assumed, look, &|| true)
}

/// Plan a program of which all is known that is wrong with it, for a look at every step.
pub fn steps(
    session: &Session,
    source: &[u8],
    options: Options,
    look: &mut impl FnMut(plan::Step),
) {
    let setup = session.interp_setup();
    let mut planner = planner(session, options);
    let mut ops = Ops::new(source, &setup, session.auto());
    while let Some((index, op)) = ops.next() {
        planner.written_in(ops.frame());
        planner.push(index, &op, look);
    }
    planner.finish(look);
}

/// What is wrong with a program that is begun in its middle: what it leaves out may be missing.
pub fn wrong_from(
    session: &Session,
    source: &[u8],
    options: Options,
    restart: &Restart,
) -> Vec<Diagnostic> {
    let setup = session.interp_setup();
    let mut planner = planner(session, options).only_judging();
    let mut ops = Ops::new(source, &setup, session.auto()).begun_at(Some(restart));
    while let Some((index, op)) = ops.next() {
        planner.written_in(ops.frame());
        planner.push(index, &op, &mut |_| ());
    }
    planner.finish(&mut |_| ());
    planner.take_findings().into_iter().filter(Diagnostic::is_error).collect()
}

/// What is wrong with a program, without the time it takes; nothing, if it is broken off on the way.
pub fn judge(
    session: &mut Session,
    source: &[u8],
    options: Options,
    goes_on: &dyn Fn() -> bool,
) -> Vec<Diagnostic> {
    let assumed = stand_in(session, source);
    let planner = judging(session, options).only_judging();
    read(session, source, planner, assumed, &mut |_| (), goes_on).findings
}

/// The same for a long program: what was found since the last time is told as it goes, with the furthest byte executed.
pub fn judge_and_tell(
    session: &mut Session,
    source: &[u8],
    options: Options,
    tell: &mut impl FnMut(Vec<Diagnostic>, u32) -> Result<(), Refused>,
) -> Result<(), Refused> {
    tell(stand_in(session, source), 0)?;
    let mut planner = judging(session, options).only_judging();
    let mut table = TableNotes::default();
    let setup = session.interp_setup();
    let mut ops = Ops::new(source, &setup, session.auto());
    let mut furthest = 0;
    while let Some((index, op)) = ops.next() {
        planner.written_in(ops.frame());
        planner.push(index, &op, &mut |_| ());
        table.see(session, &op);
        if op.span.file == 0 {
            furthest = furthest.max(op.span.end);
        }
        if index % OFTEN == OFTEN - 1 {
            let mut found = planner.take_findings();
            found.extend(ops.diagnostics());
            found.extend(table.take());
            tell(found, furthest)?;
        }
    }
    planner.finish(&mut |_| ());
    let mut found = planner.take_findings();
    found.extend(ops.diagnostics());
    found.extend(table.take());
    tell(found, furthest)
}

/// Operations between two tellings, and between two looks whether anybody still wants to know.
const OFTEN: u32 = 1 << 14;

/// Of a program that does not end.
const NO_END: &str = "I0301";

fn read(
    session: &Session,
    source: &[u8],
    mut planner: Planner,
    mut findings: Vec<Diagnostic>,
    look: &mut impl FnMut(plan::Step),
    goes_on: &dyn Fn() -> bool,
) -> Preflight {
    let setup = session.interp_setup();
    let mut table = TableNotes::default();
    let mut ops = Ops::new(source, &setup, session.auto());
    while let Some((index, op)) = ops.next() {
        planner.written_in(ops.frame());
        planner.push(index, &op, look);
        table.see(session, &op);
        if index % OFTEN == OFTEN - 1 && !goes_on() {
            return Preflight { findings: Vec::new(), planned: Time::ZERO };
        }
    }
    planner.finish(look);
    findings.extend(ops.diagnostics());
    findings.extend(planner.take_findings());
    findings.extend(table.take());
    add(&mut findings, interp::lint(source, &setup));
    if session.is_subprogram {
        findings.retain(|finding| finding.code != NO_END);
    }
    Preflight { findings, planned: planner.duration() }
}

/// Add what is not there yet, and put all in the order of the program: by place, errors first.
pub fn add(found: &mut Vec<Diagnostic>, more: impl IntoIterator<Item = Diagnostic>) {
    let mut known: HashSet<_> = found.iter().map(|f| (f.code, f.span)).collect();
    found.extend(more.into_iter().filter(|finding| known.insert((finding.code, finding.span))));
    found.sort_by_key(|f| (f.span.file, f.span.start, f.severity != Severity::Error));
}

/// What is to be said of the tool table, where a program calls a tool: that it is the built-in one, and what was not
/// understood in a tool's row.
#[derive(Default)]
pub struct TableNotes {
    called: BTreeSet<u32>,
    found: Vec<Diagnostic>,
}

impl TableNotes {
    /// An operation of the program.
    pub fn see(&mut self, session: &Session, op: &Op) {
        let OpKind::ChangeTool { number: number @ 1.. } = op.kind else { return };
        let Some(tool) = session.tools.get(number) else { return };
        if !self.called.insert(number) || tool.stand_in {
            return;
        }
        match &session.table {
            None if self.called.len() == 1 => self.found.push(built_in(tool, op.span)),
            None => {}
            Some(table) => {
                let from = &session.tools_from;
                self.found.extend(table.remarks_of(number).map(|remark| {
                    let line = remark.span.line;
                    let text = format!("T{number} in {from}, line {line}: {}", remark.message);
                    Diagnostic {
                        code: "A0104",
                        severity: remark.severity,
                        ..Diagnostic::warning("A0104", op.span, text)
                    }
                }));
            }
        }
    }

    /// What was found since the last time.
    pub fn take(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.found)
    }
}

fn built_in(tool: &Tool, span: diag::Span) -> Diagnostic {
    let text = format!(
        "T{} is \"{}\" of the built-in tool table: no table is named, and none lies beside the program",
        tool.number, tool.description
    );
    Diagnostic::note("A0103", span, text)
        .with_help("--tools FILE names the shop's own; tools.toml or tool.tbl beside the program is found by itself")
}

/// A planner that also knows the workpiece.
pub fn judging(session: &Session, options: Options) -> Planner {
    let planner = planner(session, options);
    if session.cams.is_wanted() {
        return planner; // cams are ground from blanks of their own
    }
    let planner = planner.with_stock(session.stock());
    let is_assumed = session.table.is_none() && session.missing_tools == MissingTools::StandIn;
    if is_assumed { planner.with_assumed_tools() } else { planner }
}

/// A planner for this session's machine, standing where the machine stands when it is switched on.
pub fn planner(session: &Session, options: Options) -> Planner {
    let start = Start { position: session.interp_setup().start, tool: session.tool() };
    let limits = crate::config::planner(&session.machine);
    let mut planner = Planner::new(limits, session.tools.clone(), options, start);
    *planner.cams() = session.cams.for_planner();
    if turns_work(&session.machine) { planner.turning_work() } else { planner }
}

/// The machine's first spindle turns a bar: its file names it "work". A hob, a mill's spindle and a cam's axis do not.
fn turns_work(machine: &store::machine::MachineFile) -> bool {
    let is_work = machine.spindles.first().is_some_and(|spindle| spindle.name == "work");
    is_work && machine.setup.stock.bar_radius().is_some()
}

/// Add a tool of no length for every number that the program calls and the table lacks, and for an empty spindle
/// that drills, if the user allows it.
fn stand_in(session: &mut Session, source: &[u8]) -> Vec<Diagnostic> {
    if session.missing_tools == MissingTools::Refuse {
        return Vec::new();
    }
    let setup = session.interp_setup();
    let mut ops = interp::Ops::new(source, &setup);
    let mut mounted = 0;
    let mut empty_drills = false;
    for op in ops.by_ref() {
        match op.kind {
            OpKind::ChangeTool { number } => mounted = number,
            OpKind::Hole(_) => empty_drills |= mounted == 0,
            _ => {}
        }
    }
    let mut assumed: Vec<_> = ops.tools().iter().filter(|tool| tool.stand_in).cloned().collect();
    if empty_drills {
        assumed.push(no_tool());
    }
    let findings = assumed.iter().map(assumption).collect();
    for tool in assumed {
        session.tools.insert(tool);
    }
    findings
}

fn assumption(tool: &Tool) -> Diagnostic {
    let text = match tool.number {
        0 => "holes are drilled with no tool in the spindle: a stand-in takes its place".to_owned(),
        n => format!("tool {n} is not in the table: a stand-in of no length takes its place"),
    };
    Diagnostic::warning("A0101", diag::Span::default(), text)
        .with_help("what it makes is not judged; add the tool to the table for a true answer")
}

/// What an empty spindle drills with.
fn no_tool() -> Tool {
    Tool {
        number: 0,
        pocket: 0,
        length: Length::ZERO,
        diameter: Length::ZERO,
        kind: ToolKind::Other,
        description: "stand-in".into(),
        stand_in: true,
    }
}
