//! How a program is read, and on which machine, where neither is named: what its own words tell.
//!
//! ```text
//!   words of another dialect ──► that dialect, and the first built-in machine of its kind that is large enough
//!   words of a lathe, no Y    ──► a lathe
//!   else                      ──► the default machine; what it is too small for is told, with one that is not
//! ```
use crate::args::{CheckArgs, FindingsFormat, ProgramArgs};
use crate::pieces;
use control::Refused;
use control::job::options::{DecimalPoint, ProgramOptions};
use control::job::preflight;
use control::job::{DEFAULT_MACHINE, Session};
use diag::{Diagnostic, Span};
use interp::Dialect;
use std::path::Path;

/// Built-in machines that mill, the smallest first; then those for polygons, cams and gears.
const MILLS: [&str; 8] = [
    DEFAULT_MACHINE,
    "machining-center",
    "router",
    "mill-5-axis",
    "portal-mill",
    "polygon-lathe",
    "cam-grinder",
    "gear-hobber",
];
/// Those for hobby programs.
const ROUTERS: [&str; 4] = ["router", "machining-center", "mill-5-axis", "portal-mill"];
/// Those that turn.
const LATHES: [&str; 3] = ["lathe", "turning-center", "lathe-chuck-zero"];
/// Findings that another machine would not have: travel, feed, an axis, the speed of the spindle,
/// taps, the pocket; spindles for polygons, cams and gears.
const OF_THE_MACHINE: [&str; 10] =
    ["M0301", "M0303", "M0305", "M0308", "M0317", "M0321", "M0401", "M0411", "M0431", "A0403"];

/// How a program is read, and where, for which nothing was named.
const READ_AS: &str = "A0106";

/// What is added to the name of a machine where numbers without a point are read so.
const WHOLE_UNITS: &str = ", numbers without a point in whole units";

/// A program on the machine that was found for it.
pub(crate) struct Fitted {
    /// It.
    pub(crate) session: Session,
    /// Everything that is wrong.
    pub(crate) found: Vec<Diagnostic>,
    /// The machine.
    pub(crate) machine: String,
    /// A machine that would be large enough, or a reading in which nothing is wrong.
    pub(crate) hint: Option<String>,
}

/// Judge a program as it is asked for, or as its words tell.
pub(crate) fn judge(args: &CheckArgs, path: &Path, text: &[u8]) -> Result<Fitted, Refused> {
    let asked = args.source.options();
    if args.source.machine.is_some() {
        let machine = args.source.machine.clone().unwrap_or_default();
        return on(&asked, machine, path, text);
    }
    let default = Session::load(&asked, path, text)?.dialect;
    let is_asked = asked.dialect.is_some();
    let words = if is_asked { None } else { interp::looks_like(text, default) };
    // a program without an end may have been cut off: one of a folder that is summed up is read as
    // it stands
    let is_free = args.summary && !is_asked && words.is_none() && default == Dialect::LinuxCnc;
    let unended = interp::unended(text).filter(|_| is_free && !interp::is_turned(text));
    let told = words.or(unended.map(|_| Dialect::Grbl));
    let dialect = told.unwrap_or(default);
    let turned = dialect.has_turret()
        || args.summary && dialect == Dialect::LinuxCnc && interp::is_turned(text);
    let machines: &[&str] = match dialect {
        _ if turned => &LATHES,
        Dialect::Grbl => &ROUTERS,
        _ => &MILLS,
    };
    let whole_units = whole_units(args, &asked, dialect, text);
    let options = |machine: &str| ProgramOptions {
        machine: machine.into(),
        dialect: Some(dialect),
        decimal_point: whole_units
            .as_ref()
            .map(|_| DecimalPoint::Calculator)
            .or(asked.decimal_point),
        without_table: told.is_some() || turned || args.summary,
        ..asked.clone()
    };
    let first = on(&options(machines[0]), machines[0].into(), path, text)?;
    let of_end = |line| format!("no M2 or M30 up to line {line}, its last");
    let evidence =
        unended.map(of_end).or_else(|| words.map(|dialect| interp::telling_words(text, dialect)));
    let is_free = told.is_some() || turned || args.summary;
    let mut best = match nearest(&options, &machines[1..], &first.found, path, text)? {
        Some(nearest) if is_free => nearest,
        // what is checked is what is run: on the default machine, with a word of one that is large
        // enough
        Some(nearest) if errors(&nearest.found) == 0 => {
            let hint = Some(too_small(&first.found, &first.machine, &nearest.machine));
            Fitted { hint, ..first }
        }
        _ => first,
    };
    if !is_asked && best.hint.is_none() && errors(&best.found) > 0 {
        let others = other_readings(&asked, dialect, words, text);
        let other = without_fault(&asked, dialect, &others, path, text)?;
        match other {
            Some(other) if args.summary => return Ok(other.fitted),
            // what is checked is what is run: it is said how nothing would be wrong
            Some(other) if is_free || !is_sound_without_table(&asked, dialect, path, text)? => {
                best.hint = Some(other.hint());
            }
            _ => {}
        }
    }
    if let Some(reason) = whole_units {
        best.machine += WHOLE_UNITS;
        let text = format!("read with --decimal-point calculator: {reason}");
        let help = "as increments they would be a thousandth of that; --decimal-point increments reads them so";
        best.found.insert(0, Diagnostic::note("A0107", Span::default(), text).with_help(help));
    }
    if told.is_some() || turned {
        let said = said(dialect, &best.machine, evidence.as_deref());
        best.found.insert(0, said);
    }
    Ok(best)
}

/// Where a program was refused for which no machine is named: with which words nothing would be
/// wrong with it, or which machine would be large enough.
pub(crate) fn instead(source: &ProgramArgs, path: &Path, refused: &Refused) -> Option<String> {
    let Refused::Findings { name, text, .. } = refused else { return None };
    if source.machine.is_some() || text.len() as u64 > pieces::WHOLE {
        return None;
    }
    let args = CheckArgs {
        programs: vec![path.to_owned()],
        source: source.clone(),
        summary: false,
        format: FindingsFormat::Text,
    };
    let fitted = judge(&args, path, text).ok()?;
    let found = || {
        let is_other = fitted.found.first().is_some_and(|finding| finding.code == READ_AS);
        let reading = (fitted.session.dialect, None);
        let is_sound = is_other && errors(&fitted.found) == 0;
        is_sound.then(|| without_fault_hint(reading, &fitted.machine))
    };
    let hint = fitted.hint.clone().or_else(found)?;
    Some(format!("{name}: {hint}\n"))
}

/// A way to read a program.
type Reading = (Dialect, Option<DecimalPoint>);

/// How else a program may be meant, whose words tell nothing, or which is one of Fanuc's with
/// numbers without a point.
fn other_readings(
    asked: &ProgramOptions,
    tried: Dialect,
    words: Option<Dialect>,
    text: &[u8],
) -> Vec<Reading> {
    let turned = interp::is_turned(text);
    // Grbl's dialect leaves it out, and on a machining centre it ends a scaling
    let scales = text.windows(3).any(|word| word.eq_ignore_ascii_case(b"G50"));
    let (plain, whole) = (asked.decimal_point, Some(DecimalPoint::Calculator));
    let mut others = match words {
        _ if turned => vec![(Dialect::FanucLatheA, plain), (Dialect::FanucLatheA, whole)],
        None if scales => {
            vec![(Dialect::Fanuc, plain), (Dialect::Grbl, plain), (Dialect::Fanuc, whole)]
        }
        None => vec![(Dialect::Grbl, plain), (Dialect::Fanuc, plain), (Dialect::Fanuc, whole)],
        Some(told) if told.grammar() == gcode::Grammar::Fanuc => vec![(told, whole)],
        Some(_) => Vec::new(),
    };
    others.retain(|reading| {
        *reading != (tried, plain) && (reading.1 == plain || asked.decimal_point.is_none())
    });
    others
}

/// A reading in which nothing is wrong with a program.
struct WithoutFault {
    fitted: Fitted,
    reading: Reading,
}

impl WithoutFault {
    fn hint(&self) -> String {
        without_fault_hint(self.reading, &self.fitted.machine)
    }
}

fn without_fault_hint((dialect, point): Reading, machine: &str) -> String {
    let point = if point.is_some() { " --decimal-point calculator" } else { "" };
    format!(
        "nothing is wrong with it with --dialect {}{point} --machine {}",
        dialect.name(),
        machine.split(',').next().unwrap_or_default()
    )
}

/// The first of these readings in which nothing is wrong with a program.
fn without_fault(
    asked: &ProgramOptions,
    tried: Dialect,
    readings: &[Reading],
    path: &Path,
    text: &[u8],
) -> Result<Option<WithoutFault>, Refused> {
    for &(dialect, decimal_point) in readings {
        let machines: &[&str] = match dialect {
            dialect if dialect.has_turret() => &LATHES,
            Dialect::Grbl => &ROUTERS,
            _ => &MILLS,
        };
        let options = |machine: &str| ProgramOptions {
            machine: machine.into(),
            dialect: Some(dialect),
            decimal_point,
            without_table: true,
            ..asked.clone()
        };
        let first = on(&options(machines[0]), machines[0].into(), path, text)?;
        let nearest = nearest(&options, &machines[1..], &first.found, path, text)?;
        let mut fitted = nearest.unwrap_or(first);
        if errors(&fitted.found) == 0 {
            let why =
                format!("nothing is wrong with it so; with --dialect {} there is", tried.name());
            fitted.found.insert(0, said(dialect, &fitted.machine, Some(&why)));
            if decimal_point.is_some() && asked.decimal_point.is_none() {
                fitted.machine += WHOLE_UNITS;
            }
            return Ok(Some(WithoutFault { fitted, reading: (dialect, decimal_point) }));
        }
    }
    Ok(None)
}

/// Whether nothing but the built-in tool table is against a program as it is read.
fn is_sound_without_table(
    asked: &ProgramOptions,
    dialect: Dialect,
    path: &Path,
    text: &[u8],
) -> Result<bool, Refused> {
    let machine = if dialect.has_turret() { LATHES[0] } else { DEFAULT_MACHINE };
    let options = ProgramOptions {
        machine: machine.into(),
        dialect: Some(dialect),
        without_table: true,
        ..asked.clone()
    };
    Ok(errors(&on(&options, machine.into(), path, text)?.found) == 0)
}

/// Why the numbers without a point of a program in a folder that is summed up are read as whole
/// units, if nothing else is asked.
fn whole_units(
    args: &CheckArgs,
    asked: &ProgramOptions,
    dialect: Dialect,
    text: &[u8],
) -> Option<String> {
    if !args.summary || asked.decimal_point.is_some() || dialect.grammar() != gcode::Grammar::Fanuc
    {
        return None;
    }
    interp::counts_whole_units(text, &interp::Setup { dialect, ..interp::Setup::default() })
}

/// Of these machines the one on which the least is wrong; none, if none is better than the one of
/// before, or if no machine would be.
fn nearest(
    options: &impl Fn(&str) -> ProgramOptions,
    machines: &[&str],
    found: &[Diagnostic],
    path: &Path,
    text: &[u8],
) -> Result<Option<Fitted>, Refused> {
    if too_small_for(found) == 0 {
        return Ok(None);
    }
    let mut best = (errors(found), None);
    for machine in machines {
        if best.0 == 0 {
            break;
        }
        let fitted = on(&options(machine), (*machine).into(), path, text)?;
        let wrong = errors(&fitted.found);
        if wrong < best.0 {
            best = (wrong, Some(fitted));
        }
    }
    Ok(best.1)
}

fn errors(found: &[Diagnostic]) -> usize {
    found.iter().filter(|finding| finding.is_error()).count()
}

fn on(
    options: &ProgramOptions,
    machine: String,
    path: &Path,
    text: &[u8],
) -> Result<Fitted, Refused> {
    let mut session = Session::load(options, path, text)?;
    let options = session.plan_options(session.machine.setup.stock.material);
    let found = preflight::judge(&mut session, text, options);
    Ok(Fitted { session, found, machine, hint: None })
}

/// How many findings another machine would not have.
fn too_small_for(found: &[Diagnostic]) -> usize {
    let is_of_machine =
        |finding: &&Diagnostic| finding.is_error() && OF_THE_MACHINE.contains(&finding.code);
    found.iter().filter(is_of_machine).count()
}

fn said(dialect: Dialect, machine: &str, evidence: Option<&str>) -> Diagnostic {
    let why = match evidence {
        Some(words) => words,
        None if dialect.has_turret() => "the dialect is one of lathes",
        None => "no Y, and codes of a lathe",
    };
    let text = format!("read with --dialect {} on --machine {machine}: {why}", dialect.name());
    Diagnostic::note(READ_AS, Span::default(), text)
        .with_help("no machine is named: its tools are taken from the program's comments, and lengths are not known")
}

/// What the machine is too small for, counted, and one that is not.
fn too_small(found: &[Diagnostic], machine: &str, other: &str) -> String {
    let kinds = [
        ("M0301", "beyond its travel"),
        ("M0303", "above its feed"),
        ("M0305", "an axis that it lacks"),
        ("M0308", "above its spindle's speed"),
        ("M0317", "a pocket that it lacks"),
        ("M0321", "above its tapping speed"),
    ];
    let count = |code: &str| found.iter().filter(|f| f.is_error() && f.code == code).count();
    let counted: Vec<_> = kinds
        .iter()
        .filter(|(code, _)| count(code) > 0)
        .map(|(code, what)| format!("{} {what}", count(code)))
        .collect();
    let counted = if counted.is_empty() { "what it lacks".to_owned() } else { counted.join(", ") };
    format!("{machine} is too small for this program ({counted}): --machine {other} is not")
}
