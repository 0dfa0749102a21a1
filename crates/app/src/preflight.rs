//! Everything that can be known before anything moves.
//!
//! The whole program is interpreted and planned once without moving: all findings of interpreter and planner
//! come out at once, with the planned time; tools that the table lacks get their stand-ins here if the user
//! allows them.
use crate::args::MissingTools;
use crate::program::Ops;
use crate::refused::Refused;
use crate::restart::Restart;
use crate::session::Session;
use canon::{OpKind, Tool, ToolKind};
use diag::{Diagnostic, Severity};
use plan::{Options, Planner, Start};
use units::{Length, Time};

/// What is known.
pub(crate) struct Preflight {
    /// Findings, in the order of the program.
    pub(crate) findings: Vec<Diagnostic>,
    /// Planned time from start to end.
    pub(crate) planned: Time,
}

impl Preflight {
    /// Whether the program is refused.
    pub(crate) fn is_refused(&self) -> bool {
        self.findings.iter().any(Diagnostic::is_error)
    }
}

/// Interpret and plan a program without moving. Stand-ins are added to the session's tools.
pub(crate) fn preflight(session: &mut Session, source: &[u8], options: Options) -> Preflight {
    preflight_with(session, source, options, &mut |_| ())
}

/// The same, with a look at every step.
pub(crate) fn preflight_with(
    session: &mut Session,
    source: &[u8],
    options: Options,
    look: &mut impl FnMut(plan::Step),
) -> Preflight {
    let assumed = stand_in(session, source);
    read(session, source, planner(session, options), assumed, look)
}

/// What is wrong with a program that is begun in its middle: what it leaves out may be missing.
pub(crate) fn wrong_from(
    session: &Session,
    source: &[u8],
    options: Options,
    restart: &Restart,
) -> Vec<Diagnostic> {
    let setup = session.interp_setup();
    let mut planner = planner(session, options).only_judging();
    let ops = Ops::new(source, &setup, session.auto()).begun_at(Some(restart));
    for (index, op) in ops {
        planner.push(index, &op, &mut |_| ());
    }
    planner.finish(&mut |_| ());
    planner.take_findings().into_iter().filter(Diagnostic::is_error).collect()
}

/// What is wrong with a program, without the time it takes.
pub(crate) fn judge(session: &mut Session, source: &[u8], options: Options) -> Vec<Diagnostic> {
    let assumed = stand_in(session, source);
    let planner = planner(session, options).only_judging();
    read(session, source, planner, assumed, &mut |_| ()).findings
}

/// The same for a long program: what was found since the last time is told as it goes, with the furthest byte executed.
pub(crate) fn judge_and_tell(
    session: &mut Session,
    source: &[u8],
    options: Options,
    tell: &mut impl FnMut(Vec<Diagnostic>, u32) -> Result<(), Refused>,
) -> Result<(), Refused> {
    /// Operations between two tellings.
    const OFTEN: u32 = 1 << 14;
    tell(stand_in(session, source), 0)?;
    let mut planner = planner(session, options).only_judging();
    let setup = session.interp_setup();
    let mut ops = Ops::new(source, &setup, session.auto());
    let mut furthest = 0;
    while let Some((index, op)) = ops.next() {
        planner.push(index, &op, &mut |_| ());
        if op.span.file == 0 {
            furthest = furthest.max(op.span.end);
        }
        if index % OFTEN == OFTEN - 1 {
            let mut found = planner.take_findings();
            found.extend(ops.diagnostics());
            tell(found, furthest)?;
        }
    }
    planner.finish(&mut |_| ());
    let mut found = planner.take_findings();
    found.extend(ops.diagnostics());
    tell(found, furthest)
}

fn read(
    session: &Session,
    source: &[u8],
    mut planner: Planner,
    mut findings: Vec<Diagnostic>,
    look: &mut impl FnMut(plan::Step),
) -> Preflight {
    let setup = session.interp_setup();
    let mut ops = Ops::new(source, &setup, session.auto());
    for (index, op) in ops.by_ref() {
        planner.push(index, &op, look);
    }
    planner.finish(look);
    findings.extend(ops.diagnostics());
    findings.extend(planner.take_findings());
    findings.sort_by_key(|f| (f.span.file, f.span.start, f.severity != Severity::Error));
    Preflight { findings, planned: planner.duration() }
}

/// A planner for this session's machine, standing where the machine stands when it is switched on.
pub(crate) fn planner(session: &Session, options: Options) -> Planner {
    let start = Start { position: session.interp_setup().start, tool: session.tool() };
    let limits = crate::wiring::planner(&session.machine);
    let mut planner = Planner::new(limits, session.tools.clone(), options, start);
    *planner.cams() = session.cams.for_planner();
    planner
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
