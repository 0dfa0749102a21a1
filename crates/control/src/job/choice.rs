//! How a program is read, on which machine and with which tools, where they are not named: the one
//! place that chooses, for `check`, `time`, `run`, the library and the editor.
//!
//! ```text
//!   dialect   words of another one; a code that LinuxCNC has not, and another one has; no end, at rest
//!   machine   a hob, a polygon, a cam, a lathe's codes; else the first that is large enough
//!   tools     the built-in table, where the program's comments and its cuts agree with it; else the comments
//! ```
//!
//! Evidence decides, never the absence of findings: a wrong program stays wrong. A reading in which
//! lengths shrink, or that has words that its dialect does not have, is none.
mod reasons;

use crate::Refused;
use crate::job::options::{DecimalPoint, ProgramOptions};
use crate::job::{DEFAULT_MACHINE, Session, described, preflight};
use canon::{Op, OpKind, ToolKind, ToolLibrary};
use diag::Diagnostic;
use interp::{Dialect, SpecialWork};
use std::path::Path;

/// Built-in machines that mill, the smallest first.
const MILLS: [&str; 5] =
    [DEFAULT_MACHINE, "machining-center", "router", "mill-5-axis", "portal-mill"];
/// Those for hobby programs.
const ROUTERS: [&str; 4] = ["router", "machining-center", "mill-5-axis", "portal-mill"];
/// Machines for programs that turn.
const LATHES: [&str; 3] = ["lathe", "turning-center", "lathe-chuck-zero"];
/// Findings that another machine would not have: travel, feed, an axis, the speed of the spindle,
/// taps, the pocket; spindles for polygons, cams and gears.
const OF_THE_MACHINE: [&str; 10] =
    ["M0301", "M0303", "M0305", "M0308", "M0317", "M0321", "M0401", "M0411", "M0431", "A0403"];
/// Findings that say that a dialect does not have a word: letters, G and M codes, the percent sign
/// within a line, O-words.
const OF_THE_WORDS: [&str; 7] = ["I0101", "I0102", "I0105", "P0110", "P0140", "P0141", "P0142"];
/// A tool that the table lacks.
const MISSING_TOOL: &str = "I0611";
/// Longest text for which a choice is made; a longer one is read as it is asked for.
const LONGEST: usize = 4 << 20;

/// What was chosen for a program, and what is wrong with the program so.
pub struct Choice {
    /// What it is loaded with.
    pub options: ProgramOptions,
    /// The same, loaded.
    pub session: Session,
    /// What was chosen and why; empty where everything is as it is without a choice.
    pub notes: Vec<Diagnostic>,
    /// Everything that is wrong with the program.
    pub found: Vec<Diagnostic>,
}

impl Choice {
    fn errors(&self) -> usize {
        errors(&self.found)
    }
}

/// Chooses for a program what is not named.
///
/// # Errors
/// The machine, the tools, or another file that the options name cannot be read or is wrong.
pub fn choose(asked: &ProgramOptions, path: &Path, text: &[u8]) -> Result<Choice, Refused> {
    if !asked.chooses || text.len() > LONGEST {
        return on(asked.clone(), path, text);
    }
    let reading = Reading::of(asked, text);
    let choice = reading.fitted(asked, path, text)?;
    // what a text without an end or without words of a dialect may be, its findings tell
    if asked.dialect.is_none() && reading.is_plain() && choice.errors() > 0 {
        if let Some(other) = other_words(asked, &choice, path, text)? {
            return Ok(other);
        }
    } else if reading.is_unended && choice.found.iter().any(is_of_words) {
        return Reading::plain(text).fitted(asked, path, text);
    }
    Ok(choice)
}

/// The dialect and the machine that a text tells of by its words alone, without checking it: for an
/// editor, as it is written.
pub fn by_words(asked: &ProgramOptions, text: &[u8]) -> ProgramOptions {
    if !asked.chooses || text.len() > LONGEST {
        return asked.clone();
    }
    let reading = Reading::of(asked, text);
    reading.options(asked, reading.machines[0])
}

/// How a program is read, as its text tells.
struct Reading {
    dialect: Dialect,
    /// Words, or the missing end, that told the dialect.
    why: Option<String>,
    /// Machines that do such work, the first that is large enough is taken.
    machines: &'static [&'static str],
    /// Why none of the mills is taken.
    why_machine: Option<&'static str>,
    /// Why numbers without a point are whole units.
    whole_units: Option<String>,
    /// It has no end, and stops at rest as programs of hobby senders do.
    is_unended: bool,
}

impl Reading {
    fn of(asked: &ProgramOptions, text: &[u8]) -> Self {
        let is_free = asked.dialect.is_none();
        let words = if is_free { interp::looks_like(text, Dialect::LinuxCnc) } else { None };
        let turned = interp::is_turned(text);
        let is_senders = interp::stops_at_rest(text) && interp::is_for_a_sender(text);
        let end = (is_free && words.is_none() && !turned && is_senders)
            .then(|| interp::unended(text))
            .flatten();
        let told = asked.dialect.or(words).or(end.map(|_| Dialect::Grbl));
        let why = match (words, end) {
            (Some(dialect), _) => Some(interp::telling_words(text, dialect)),
            (None, Some(line)) => Some(reasons::no_end(line)),
            (None, None) => None,
        };
        Self { why, is_unended: end.is_some(), ..Self::with(told.unwrap_or_default(), asked, text) }
    }

    /// `LinuxCNC`'s, on the machine that its work tells.
    fn plain(text: &[u8]) -> Self {
        Self::with(Dialect::LinuxCnc, &ProgramOptions::on(DEFAULT_MACHINE), text)
    }

    fn with(dialect: Dialect, asked: &ProgramOptions, text: &[u8]) -> Self {
        let (machines, why_machine): (&[&str], _) = match interp::special_work(text) {
            Some(SpecialWork::Gear) => (&["gear-hobber"], Some("G81 with T and L turns a hob")),
            Some(SpecialWork::Polygon) => (&["polygon-lathe"], Some("polygons are turned")),
            Some(SpecialWork::Cam) => (&["cam-grinder"], Some("a cam is ground")),
            None if dialect == Dialect::Toyoda => {
                (&["cam-grinder"], Some("the dialect is one of cam grinders"))
            }
            None if dialect.has_turret() => (&LATHES, Some("the dialect is one of lathes")),
            None if dialect == Dialect::LinuxCnc && interp::is_turned(text) => {
                (&LATHES, Some("no Y, and codes of a lathe"))
            }
            None if dialect == Dialect::Grbl => (&ROUTERS, None),
            None => (&MILLS, None),
        };
        let is_fanucs = dialect.grammar() == gcode::Grammar::Fanuc;
        let whole_units = (is_fanucs && asked.decimal_point.is_none())
            .then(|| {
                let setup = interp::Setup { dialect, ..interp::Setup::default() };
                interp::counts_whole_units(text, &setup)
            })
            .flatten();
        Self { dialect, why: None, machines, why_machine, whole_units, is_unended: false }
    }

    /// True if nothing in the text told its dialect.
    const fn is_plain(&self) -> bool {
        self.why.is_none()
    }

    fn options(&self, asked: &ProgramOptions, machine: &str) -> ProgramOptions {
        let calculator = self.whole_units.as_ref().map(|_| DecimalPoint::Calculator);
        ProgramOptions {
            machine: machine.into(),
            dialect: Some(self.dialect),
            decimal_point: calculator.or(asked.decimal_point),
            without_table: !asked.keeps_table && (self.why.is_some() || self.why_machine.is_some()),
            chooses: false,
            ..asked.clone()
        }
    }

    /// The program on the first of the machines that is large enough, with the tools that suit it.
    fn fitted(&self, asked: &ProgramOptions, path: &Path, text: &[u8]) -> Result<Choice, Refused> {
        let (smallest, larger) = (self.machines[0], &self.machines[1..]);
        let mut first = on(self.options(asked, smallest), path, text)?;
        let mut without_table = first.options.without_table;
        let mut why_tools = None;
        if !without_table && !asked.keeps_table && first.session.table.is_none() {
            why_tools = contradiction(&first, path, text)?;
            if why_tools.is_some() {
                without_table = true;
                let options = ProgramOptions { without_table, ..first.options.clone() };
                first = on(options, path, text)?;
            }
        }
        let mut best = (None, first.errors());
        if first.found.iter().any(is_of_machine) {
            for machine in larger {
                let options = self.options(asked, machine);
                let other = on(ProgramOptions { without_table, ..options }, path, text)?;
                if other.errors() < best.1 {
                    best = (Some(other), best.1);
                    best.1 = best.0.as_ref().map_or(best.1, Choice::errors);
                }
                if best.1 == 0 {
                    break;
                }
            }
        }
        let too_small = best.0.is_some().then(|| reasons::too_small(&first.found, smallest));
        let mut choice = best.0.unwrap_or(first);
        let machine = choice.options.machine.name.clone();
        let why: Vec<String> = [self.why.clone(), self.why_machine.map(str::to_owned), too_small]
            .into_iter()
            .flatten()
            .collect();
        if !why.is_empty() {
            choice.notes.push(reasons::read_as(self.dialect, &machine, &why.join("; ")));
        }
        if let Some(why) = why_tools {
            choice.notes.push(reasons::tools(&why));
        }
        if let Some(reason) = &self.whole_units {
            choice.notes.push(reasons::whole_units(reason));
        }
        Ok(choice)
    }
}

/// The program as these options say.
fn on(options: ProgramOptions, path: &Path, text: &[u8]) -> Result<Choice, Refused> {
    let mut session = Session::load(&options, path, text)?;
    let plan = session.plan_options(session.machine.setup.stock.material);
    let found = preflight::judge(&mut session, text, plan);
    Ok(Choice { options, session, notes: Vec::new(), found })
}

fn errors(found: &[Diagnostic]) -> usize {
    found.iter().filter(|finding| finding.is_error()).count()
}

fn is_of_machine(finding: &Diagnostic) -> bool {
    finding.is_error() && OF_THE_MACHINE.contains(&finding.code)
}

fn is_of_words(finding: &Diagnostic) -> bool {
    finding.is_error() && OF_THE_WORDS.contains(&finding.code)
}

/// Another dialect's reading of a program that has words which `LinuxCNC` does not have: all of
/// them are words there, and no length is another one.
fn other_words(
    asked: &ProgramOptions,
    first: &Choice,
    path: &Path,
    text: &[u8],
) -> Result<Option<Choice>, Refused> {
    let Some(strange) = first.found.iter().find(|finding| is_of_words(finding)) else {
        return Ok(None);
    };
    let others: &[Dialect] = if interp::is_turned(text) {
        &[Dialect::FanucLatheA]
    } else if interp::has_word(text, 'G', 50.0) {
        // Grbl's dialect leaves it out, and on a machining centre it ends a scaling
        &[Dialect::Fanuc, Dialect::Grbl]
    } else {
        &[Dialect::Grbl, Dialect::Fanuc]
    };
    for dialect in others {
        let mut reading = Reading::with(*dialect, asked, text);
        let shrinks = dialect.grammar() == gcode::Grammar::Fanuc
            && asked.decimal_point != Some(DecimalPoint::Calculator)
            && reading.whole_units.is_none()
            && interp::has_whole_lengths(text);
        if shrinks || *dialect == Dialect::Grbl && !interp::is_for_a_sender(text) {
            continue;
        }
        reading.why = Some(reasons::strange_word(strange, *dialect));
        let other = reading.fitted(asked, path, text)?;
        if !other.found.iter().any(is_of_words) && other.errors() < first.errors() {
            return Ok(Some(other));
        }
    }
    Ok(None)
}

/// Why the built-in table is not this program's: its comments say otherwise, or it lacks a tool, or
/// it was refused and a tool does there what such a tool does not do.
fn contradiction(choice: &Choice, path: &Path, text: &[u8]) -> Result<Option<String>, Refused> {
    let table = &choice.session.tools;
    for tool in described::tools(text) {
        let Some(known) = table.get(tool.number) else { continue };
        if !described::is_same(known, &tool) {
            return Ok(Some(reasons::other_tool(&tool, known)));
        }
    }
    if let Some(missing) = choice.found.iter().find(|finding| finding.code == MISSING_TOOL) {
        let text = format!("line {}: {}", missing.span.line, missing.message);
        return Ok(Some(text.replace("the tool table", "the built-in table")));
    }
    if choice.errors() == 0 {
        return Ok(None);
    }
    let options = ProgramOptions { without_table: true, ..choice.options.clone() };
    let mut session = Session::load(&options, path, text)?;
    let (operations, _) = preflight::interpret(&mut session, text);
    Ok(used_otherwise(table, operations.all()))
}

/// A tool of a table that is used for what it is not made for.
fn used_otherwise(table: &ToolLibrary, ops: &[Op]) -> Option<String> {
    let (mut mounted, mut at) = (0, canon::Position::default());
    for op in ops {
        let kind = table.get(mounted).map(|tool| &tool.kind);
        let is_drill = matches!(
            kind,
            Some(ToolKind::Drill { .. } | ToolKind::SpotDrill { .. } | ToolKind::Tap(_))
        );
        let is_tap = matches!(kind, Some(ToolKind::Tap(_)));
        let otherwise = match &op.kind {
            OpKind::ChangeTool { number } => {
                mounted = *number;
                false
            }
            OpKind::Line { to, .. } | OpKind::Arc { to, .. } | OpKind::Spline { to, .. } => {
                let aside = to.linear[0] != at.linear[0] || to.linear[1] != at.linear[1];
                at = *to;
                is_drill && aside
            }
            OpKind::Rapid { to } => {
                at = *to;
                false
            }
            OpKind::Tap(_) => kind.is_some() && !is_tap,
            OpKind::Hole(_) => is_tap,
            _ => false,
        };
        if otherwise && let Some(tool) = table.get(mounted) {
            return Some(reasons::other_use(tool, op.span.line));
        }
    }
    None
}
