//! Everything that can be known before anything moves.
//!
//! The whole program is interpreted and planned once without moving: all findings of interpreter and planner
//! come out at once, with the planned time; tools that the table lacks get their stand-ins here if the user
//! allows them.
use crate::args::MissingTools;
use crate::session::Session;
use diag::{Diagnostic, Severity};
use plan::{Options, Planner, Start};
use units::Time;

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
    let mut findings = Vec::new();
    if session.missing_tools == MissingTools::StandIn {
        findings.extend(stand_in(session, source));
    }
    let setup = session.interp_setup();
    let mut planner = planner(session, options);
    let mut ops = interp::Ops::new(source, &setup);
    for (index, op) in ops.by_ref().enumerate() {
        planner.push(index as u32, &op, &mut |_| ());
    }
    planner.finish(&mut |_| ());
    findings.extend(ops.diagnostics().iter().cloned());
    findings.extend(planner.take_findings());
    findings.sort_by_key(|f| (f.span.file, f.span.start, f.severity != Severity::Error));
    Preflight { findings, planned: planner.duration() }
}

/// A planner for this session's machine, standing where the machine stands when it is switched on.
pub(crate) fn planner(session: &Session, options: Options) -> Planner {
    let start = Start { position: session.interp_setup().start, tool: 0 };
    let limits = crate::wiring::planner(&session.machine);
    Planner::new(limits, session.tools.clone(), options, start)
}

/// Add a tool of no length for every number that the program calls and the table lacks.
fn stand_in(session: &mut Session, source: &[u8]) -> Vec<Diagnostic> {
    let setup = session.interp_setup();
    let mut ops = interp::Ops::new(source, &setup);
    ops.by_ref().for_each(drop);
    let assumed: Vec<_> = ops.tools().iter().filter(|tool| tool.stand_in).cloned().collect();
    let note = |tool: &canon::Tool| {
        let number = tool.number;
        Diagnostic::warning(
            "A0101",
            diag::Span::default(),
            format!("tool {number} is not in the table: a stand-in of no length takes its place"),
        )
        .with_help("what it makes is not judged; add the tool to the table for a true answer")
    };
    let findings = assumed.iter().map(note).collect();
    for tool in assumed {
        session.tools.insert(tool);
    }
    findings
}
