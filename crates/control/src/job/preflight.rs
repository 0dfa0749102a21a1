//! Everything that can be known before anything moves.
//!
//! The whole program is interpreted and planned once without moving (a long one that a control
//! loads is judged alone, which finds the same): all findings of interpreter and planner, what is
//! legal but hurts, and what is to be said of the tool table come out at once, with the planned
//! time; tools that the table lacks get their stand-ins here if the user allows them.
//!
//! ```text
//!   check ─┐                      ┌─ interpreter   what blocks mean
//!   time  ─┼─► one preflight ─────┼─ planner       machine, tools, stock
//!   run   ─┤    one order         ├─ remarks       legal, and likely to hurt
//!   lsp   ─┘                      └─ tool table    which one, and what was not understood of it
//! ```
use super::interruption::Interruption;
use super::mill_stock::MilledStock;
use super::operations::{Cursor, Operations, Reading, Source, share_read};
use super::restart::Restart;
use super::side_by_side::side_by_side;
use super::table_notes::TableNotes;
use crate::Refused;
use crate::job::Session;
use canon::{LengthUnit, Op, OpKind, ProgramFrame, Tool, ToolKind};
use diag::{Diagnostic, Severity};
use interp::MissingTools;
use plan::{Options, Planner, Sample, Start};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::sync::Arc;
use units::{Length, Time};

/// What is known.
pub struct Preflight {
    /// Findings, in the order of the program.
    pub findings: Vec<Diagnostic>,
    /// Planned time from start to end; `None`: it was judged, and not planned.
    pub planned: Option<Time>,
}

impl Preflight {
    /// Whether the program is refused.
    pub fn is_refused(&self) -> bool {
        self.findings.iter().any(Diagnostic::is_error)
    }
}

/// A program that was interpreted and planned once.
pub struct Proved {
    /// Its operations, for the run.
    pub operations: Arc<Operations>,
    /// What is known of it.
    pub known: Preflight,
}

/// Interpret a program, with all that has to be known of it before it is planned: stand-ins are
/// added to the session's tools. Also what is to be said of them.
pub fn interpret(session: &mut Session, source: &[u8]) -> (Arc<Operations>, Vec<Diagnostic>) {
    if session.missing_tools == MissingTools::StandIn {
        // as they were when it was loaded; a control has its own by now
        for tool in session.described.clone() {
            if session.table.is_none() || session.tools.get(tool.number).is_none() {
                session.tools.insert(tool);
            }
        }
    }
    let setup = session.interp_setup();
    let mut operations =
        Operations::after(session.before.clone(), source, &setup, &session.interruption);
    if session.depends_on_program() {
        session.prepare(operations.all());
    }
    let assumed = stand_in(session, &operations);
    operations.fill(session.auto());
    (Arc::new(operations), assumed)
}

/// Interpret and plan a program without moving, keep its operations, look at every step.
pub fn prove(
    session: &mut Session,
    source: &[u8],
    options: Options,
    look: &mut impl FnMut(plan::Step),
) -> Proved {
    prove_up_to(session, (source, usize::MAX), options, look)
}

/// The same of a program of up to so many operations; a longer one is judged, and not planned:
/// there is no look at its cuts then.
pub fn prove_up_to(
    session: &mut Session,
    (source, most): (&[u8], usize),
    options: Options,
    look: &mut impl FnMut(plan::Step),
) -> Proved {
    let (operations, assumed) = interpret(session, source);
    let mut planner = judging(session, source, options);
    let is_planned = operations.all().len() <= most;
    if !is_planned {
        planner = planner.only_judging();
    }
    let mut cursor = Cursor::new(Arc::clone(&operations), None);
    let known = read(session, source, &mut cursor, &mut planner, assumed, look);
    let planned = known.planned.filter(|_| is_planned);
    Proved { operations, known: Preflight { planned, ..known } }
}

/// The same of a program that will not run, with a look at every step and every operation: nothing
/// is kept of it where nothing has to be known ahead.
pub fn preflight_with(
    session: &mut Session,
    source: &[u8],
    options: Options,
    look: &mut impl FnMut(plan::Step),
    each: &mut impl FnMut(u32, &Op, ProgramFrame),
) -> Preflight {
    if session.depends_on_program() {
        let Proved { operations, known } = prove(session, source, options, look);
        let mut cursor = Cursor::new(operations, None);
        while let Some((index, op)) = cursor.next() {
            each(index, &op, cursor.frame());
        }
        return known;
    }
    let mut planner = judging(session, source, options);
    let setup = session.interp_setup();
    let mut reading = Reading::new(source, &setup, session.auto());
    let seen = &mut Seen { source: &mut reading, each };
    read(session, source, seen, &mut planner, Vec::new(), look)
}

/// The same without planning moves that go on into one another: a sample of them is kept. The time
/// that is known counts none of them, and what only planning finds in them is not found.
pub fn preflight_sampled(
    session: &mut Session,
    source: &[u8],
    options: Options,
    look: &mut impl FnMut(plan::Step),
) -> (Preflight, Sample) {
    let planner = |session: &Session| judging(session, source, options).sampling();
    let (known, sample) = if session.depends_on_program() {
        let (operations, assumed) = interpret(session, source);
        let mut planner = planner(session);
        let mut cursor = Cursor::new(operations, None);
        let known = read(session, source, &mut cursor, &mut planner, assumed, look);
        (known, planner.take_sample())
    } else {
        let mut planner = planner(session);
        let setup = session.interp_setup();
        let mut reading = Reading::new(source, &setup, session.auto());
        let known = read(session, source, &mut reading, &mut planner, Vec::new(), look);
        (known, planner.take_sample())
    };
    (known, sample.unwrap_or_default())
}

/// Operations that something else looks at as they pass.
struct Seen<'a, S, F> {
    source: &'a mut S,
    each: &'a mut F,
}

impl<S: Source, F: FnMut(u32, &Op, ProgramFrame)> Iterator for Seen<'_, S, F> {
    type Item = (u32, Op);

    fn next(&mut self) -> Option<(u32, Op)> {
        let (index, op) = self.source.next()?;
        (self.each)(index, &op, self.source.frame());
        Some((index, op))
    }
}

impl<S: Source, F: FnMut(u32, &Op, ProgramFrame)> Source for Seen<'_, S, F> {
    fn frame(&self) -> ProgramFrame {
        self.source.frame()
    }

    fn findings(&self) -> Vec<Diagnostic> {
        self.source.findings()
    }
}

/// What is wrong with a program that is begun in its middle: what it leaves out may be missing.
pub fn wrong_from(
    session: &Session,
    operations: &Arc<Operations>,
    options: Options,
    restart: &Restart,
) -> Vec<Diagnostic> {
    let mut planner = planner(session, options).only_judging();
    plan(&mut Cursor::new(Arc::clone(operations), Some(restart)), &mut planner, &mut |_| ());
    planner.take_findings().into_iter().filter(Diagnostic::is_error).collect()
}

/// Plan operations from the first to the last.
pub fn plan(source: &mut impl Source, planner: &mut Planner, look: &mut impl FnMut(plan::Step)) {
    plan_unless(&Interruption::default(), source, planner, look);
}

/// The same; whether it was not broken off on the way.
pub fn plan_unless(
    interruption: &Interruption,
    source: &mut impl Source,
    planner: &mut Planner,
    look: &mut impl FnMut(plan::Step),
) -> bool {
    while let Some((index, op)) = source.next() {
        planner.written_in(source.frame());
        planner.push(index, &op, look);
        if is_looked(index) && interruption.came() {
            return false;
        }
    }
    planner.finish(look);
    true
}

/// What is wrong with a program, without the time it takes.
pub fn judge(session: &mut Session, source: &[u8], options: Options) -> Vec<Diagnostic> {
    if session.depends_on_program() {
        let (operations, assumed) = interpret(session, source);
        let mut planner = judging(session, source, options).only_judging();
        let mut cursor = Cursor::new(operations, None);
        return read(session, source, &mut cursor, &mut planner, assumed, &mut |_| ()).findings;
    }
    let mut planner = judging(session, source, options).only_judging();
    let setup = session.interp_setup();
    let mut reading = Reading::new(source, &setup, session.auto());
    read(session, source, &mut reading, &mut planner, Vec::new(), &mut |_| ()).findings
}

/// Planned time from start to end of a program that is not refused; `None`, if it is broken off on
/// the way. Findings are shown to people as they write, who do not wait for it.
pub fn time(session: &Session, source: &[u8], options: Options) -> Option<Time> {
    let setup = session.interp_setup();
    let mut planner = ahead(session, options);
    let mut reading = Reading::new(source, &setup, session.auto());
    plan_unless(&session.interruption, &mut reading, &mut planner, &mut |_| ())
        .then(|| planner.duration())
}

/// The same for a long program: what was found since is told, with the furthest byte executed.
///
/// # Errors
/// What was found cannot be told any more.
pub fn judge_and_tell(
    session: &mut Session,
    source: &[u8],
    options: Options,
    tell: Tell<'_>,
) -> Result<(), Refused> {
    if session.depends_on_program() {
        let (operations, assumed) = interpret(session, source);
        tell(assumed, 0)?;
        return telling(session, source, &mut Cursor::new(operations, None), options, tell);
    }
    let setup = session.interp_setup();
    telling(session, source, &mut Reading::new(source, &setup, session.auto()), options, tell)
}

/// Who is told what was found, and the furthest byte executed.
pub type Tell<'a> = &'a mut dyn FnMut(Vec<Diagnostic>, u32) -> Result<(), Refused>;

fn telling(
    session: &Session,
    source: &[u8],
    ops: &mut impl Source,
    options: Options,
    tell: Tell<'_>,
) -> Result<(), Refused> {
    let mut planner = judging(session, source, options).only_judging();
    let (mut table, mut milled) = (TableNotes::default(), MilledStock::new(source, session));
    let mut furthest = 0;
    while let Some((index, op)) = ops.next() {
        planner.written_in(ops.frame());
        planner.push(index, &op, &mut |_| ());
        table.see(session, &op);
        milled.see(session, &op);
        if op.span.file == 0 {
            furthest = furthest.max(op.span.end);
        }
        if index % OFTEN == OFTEN - 1 {
            let mut found = planner.take_findings();
            found.extend(ops.findings());
            found.extend(table.take());
            tell(found, furthest)?;
        }
    }
    planner.finish(&mut |_| ());
    let mut found = planner.take_findings();
    found.extend(ops.findings());
    found.extend(table.take());
    found.extend(milled.remark(session));
    tell(found, furthest)
}

/// Operations between two tellings.
const OFTEN: u32 = 1 << 14;

/// Whether it is asked at this operation if the rest is still wanted: arcs under a limit of jerk
/// are planned a few hundred in a second.
const fn is_looked(index: u32) -> bool {
    index % 64 == 63
}

/// Of a program that is for no machine tool.
const OTHER_MACHINE: &str = "I0910";
/// Of a program that does not end.
const NO_END: &str = "I0301";

fn read(
    session: &Session,
    source: &[u8],
    ops: &mut impl Source,
    planner: &mut Planner,
    mut findings: Vec<Diagnostic>,
    look: &mut impl FnMut(plan::Step),
) -> Preflight {
    let (mut table, mut milled) = (TableNotes::default(), MilledStock::new(source, session));
    while let Some((index, op)) = ops.next() {
        planner.written_in(ops.frame());
        planner.push(index, &op, look);
        table.see(session, &op);
        milled.see(session, &op);
        if is_looked(index) && session.interruption.came_at(0.5 + share_read(&op, source) / 2.0) {
            return Preflight { findings: vec![Interruption::finding()], planned: None };
        }
    }
    if session.interruption.came() {
        return Preflight { findings: vec![Interruption::finding()], planned: None };
    }
    planner.finish(look);
    findings.extend(ops.findings());
    findings.extend(planner.take_findings());
    findings.extend(table.take());
    findings.extend(milled.remark(session));
    findings.extend(session.stock.remark());
    add(&mut findings, interp::lint(source, &session.interp_setup()));
    if findings.iter().any(|finding| finding.code == OTHER_MACHINE) {
        findings.retain(|finding| finding.code == OTHER_MACHINE);
    }
    if session.is_subprogram || session.before.is_typed {
        findings.retain(|finding| finding.code != NO_END);
    }
    Preflight { findings, planned: Some(planner.duration()) }
}

/// Add what is not there yet, and put all in the order of the program: by place, errors first.
pub fn add(found: &mut Vec<Diagnostic>, more: impl IntoIterator<Item = Diagnostic>) {
    let mut known: HashSet<_> = found.iter().map(|f| (f.code, f.span)).collect();
    found.extend(more.into_iter().filter(|finding| known.insert((finding.code, finding.span))));
    found.sort_by_key(|f| (f.span.file, f.span.start, f.severity != Severity::Error));
}

/// A planner of a whole program, ahead of its run, that also knows the workpiece.
pub fn judging(session: &Session, source: &[u8], options: Options) -> Planner {
    let planner = ahead(session, options);
    if session.cams.is_wanted() {
        return planner; // cams are ground from blanks of their own
    }
    let own = session.stock();
    let planner = match MilledStock::stated_in(source, session) {
        Some(block) => {
            let stock = plan::Stock { from: block.from, to: block.to, ..own };
            planner.with_stock(stock).with_stated_stock()
        }
        None => planner.with_stock(own),
    };
    let planner = planner.with_bodies(session.bodies()).with_holes(session.holes());
    let is_assumed = session.table.is_none() && session.missing_tools == MissingTools::StandIn;
    if is_assumed { planner.with_assumed_tools() } else { planner }
}

/// A planner for this session's machine, standing where the machine stands when it is switched on.
pub fn planner(session: &Session, options: Options) -> Planner {
    let start = Start { position: session.interp_setup().start, tool: session.tool() };
    let limits = crate::config::planner(&session.machine);
    let mut planner = Planner::new(limits, session.tools.clone(), options, start)
        .already_turning(&session.before.turning)
        .with_changer(session.planned_changer());
    *planner.cams() = session.cams.for_planner();
    if session.machine.turned_bar().is_some() { planner.turning_work() } else { planner }
}

/// The same for a whole program ahead of its run: shape and time of its paths are planned side by
/// side.
pub fn ahead(session: &Session, options: Options) -> Planner {
    planner(session, options).side_by_side(side_by_side)
}

/// Add a tool of no length for every number that the program calls and the table lacks, and for an
/// empty spindle that drills, if the user allows it.
fn stand_in(session: &mut Session, operations: &Operations) -> Vec<Diagnostic> {
    if session.missing_tools == MissingTools::Refuse {
        return Vec::new();
    }
    let mut mounted = 0;
    let mut called = BTreeSet::new();
    let mut empty_drills = false;
    let mut leads = BTreeMap::new();
    for op in operations.all() {
        match &op.kind {
            OpKind::ChangeTool { number } => {
                mounted = *number;
                called.insert(mounted);
            }
            OpKind::Hole(_) => empty_drills |= mounted == 0,
            OpKind::Tap(tap) => {
                leads.entry(mounted).or_insert(tap.lead);
            }
            _ => {}
        }
    }
    let mut assumed = operations.stand_ins().to_vec();
    if empty_drills {
        assumed.push(no_tool());
    }
    for tool in &mut assumed {
        if let (ToolKind::Other, Some(lead)) = (&tool.kind, leads.get(&tool.number)) {
            tool.kind = ToolKind::Tap(tap_of(*lead));
        }
    }
    let is_said = |tool: &&Tool| {
        tool.number == 0 || tool.description == "stand-in" || called.contains(&tool.number)
    };
    let findings =
        assumed.iter().filter(is_said).map(|tool| assumption(tool, session.unit)).collect();
    for tool in assumed {
        session.tools.insert(tool);
    }
    findings
}

/// What a tool taps with of which only the programmed lead is known.
fn tap_of(lead: units::Lead) -> canon::TapTool {
    canon::TapTool {
        designation: format!("a thread of {:.3} mm lead", lead.abs().value()),
        lead,
        chamfer_pitches: 3.0,
        thread_length: Length::mm(1000.0),
        flute: canon::Flute::SpiralFlute,
        oversize: Length::ZERO,
        holder: canon::Holder::Rigid { stiffness: units::Stiffness::n_per_mm(20_000.0) },
        max_torque: None,
    }
}

fn assumption(tool: &Tool, unit: LengthUnit) -> Diagnostic {
    let text = match tool.number {
        0 => "holes are drilled with no tool in the spindle: a stand-in takes its place".to_owned(),
        n if tool.description == "stand-in" => {
            format!("tool {n} is not in the table: a stand-in of no length takes its place")
        }
        n => format!(
            "tool {n} is not in the table: a stand-in takes its place, by the program's comment \"{}\" {} of no length",
            tool.description,
            described(tool, unit)
        ),
    };
    Diagnostic::warning("A0101", diag::Span::default(), text)
        .with_help("what it makes is not judged; add the tool to the table for a true answer")
}

/// What a stand-in was taken for.
fn described(tool: &Tool, unit: LengthUnit) -> String {
    let kind = match &tool.kind {
        ToolKind::Drill { .. } => "a drill",
        ToolKind::SpotDrill { .. } => "a spot drill",
        ToolKind::EndMill(_) => "a mill",
        ToolKind::Tap(_) => "a tap",
        ToolKind::Insert(_) => "an insert",
        _ => "a tool",
    };
    match tool.diameter.value() {
        diameter if diameter > 0.0 => {
            let diameter = diameter / unit.in_mm();
            format!("{kind} of {diameter:.4} {},", unit.symbol())
        }
        _ => kind.to_owned(),
    }
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
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: true,
    }
}
