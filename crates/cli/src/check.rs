//! `leadscrew check`: everything that is wrong with programs, at once, without moving anything.
use crate::args::{CheckArgs, FindingsFormat};
use crate::causes::Causes;
use crate::pieces::{self, Pieces};
use crate::progress::Progress;
use crate::refusal;
use crate::render::{self, Source};
use crate::say;
use control::Refused;
use control::job::ProgramOptions;
use control::job::choice::{self, Choice};
use control::job::mill_stock::MilledStock;
use control::job::preflight::{self, add};
use control::job::program_files;
use control::job::table_notes::TableNotes;
use control::job::{Session, read_program};
use diag::Diagnostic;
use std::{
    collections::HashSet,
    path::{Path, PathBuf},
};

/// Of a file that is no text.
const NO_TEXT: &str = "P0191";

/// Most findings of one program that are shown; the others are counted.
const MOST_SHOWN: usize = 1000;

/// Check them all; true if none is refused.
pub(crate) fn command(args: &CheckArgs, quiet: bool) -> Result<bool, Refused> {
    let mut results = Vec::new();
    let mut causes = Causes::default();
    let (mut refused, mut remarks) = (0, 0);
    let programs = programs(&args.programs)?;
    for path in &programs {
        let name = path.display().to_string();
        let mut told = Told {
            format: args.format,
            quiet,
            only_summed: args.summary,
            results,
            errors: 0,
            others: 0,
            first: None,
            codes: Vec::new(),
            read_as: None,
            tools_from: String::new(),
        };
        if let Some(session) = long_session(args, path)? {
            in_pieces(&session, path, &name, &mut told)?;
        } else {
            match read_program(path) {
                Ok(text) => whole(args, path, &text, &mut told)?,
                Err(unreadable) if programs.len() > 1 => told.unreadable(&unreadable),
                Err(unreadable) => return Err(unreadable),
            }
        }
        if args.summary {
            causes.add(&name, told.read_as.take(), told.first.take(), told.errors, &told.codes);
        } else {
            told.sum_up(&name)?;
        }
        refused += usize::from(told.errors > 0);
        remarks += told.others;
        results = told.results;
    }
    if args.summary {
        causes.say(args.format)?;
        return Ok(refused == 0);
    }
    match args.format {
        FindingsFormat::Text if programs.len() > 1 && !quiet => say::out(&format!(
            "{}: {refused} refused, {}\n",
            plural(programs.len(), "program"),
            plural(remarks, "remark")
        ))?,
        FindingsFormat::Text => {}
        FindingsFormat::Json => say::out(&format!("{:#}\n", serde_json::Value::Array(results)))?,
        FindingsFormat::Sarif => say::out(&format!("{:#}\n", render::sarif(&results)))?,
    }
    Ok(refused == 0)
}

/// What was found in one program, as it is told.
struct Told {
    format: FindingsFormat,
    quiet: bool,
    /// Nothing is told but in the table at the end.
    only_summed: bool,
    /// The first error: code, line, sentence.
    first: Option<(&'static str, u32, String)>,
    /// Codes of the errors, each once.
    codes: Vec<&'static str>,
    /// Dialect and machine.
    read_as: Option<(&'static str, String)>,
    results: Vec<serde_json::Value>,
    errors: usize,
    others: usize,
    /// The tool table that it was checked with.
    tools_from: String,
}

impl Told {
    fn tell(&mut self, found: &[Diagnostic], source: &Source<'_>) -> Result<(), Refused> {
        let left = MOST_SHOWN.saturating_sub(self.errors + self.others);
        let shown = &found[..found.len().min(left)];
        let errors = found.iter().filter(|finding| finding.is_error()).count();
        self.errors += errors;
        self.others += found.len() - errors;
        for finding in found.iter().filter(|finding| finding.is_error()) {
            if !self.codes.contains(&finding.code) {
                self.codes.push(finding.code);
            }
            if self.first.is_none() {
                self.first = Some((finding.code, finding.span.line, finding.message.clone()));
            }
        }
        if self.only_summed {
            return Ok(());
        }
        match self.format {
            FindingsFormat::Text if self.quiet => {
                let wrong: Vec<_> = shown.iter().filter(|f| f.is_error()).cloned().collect();
                say::coloured_out(&render::text(&wrong, source))
            }
            FindingsFormat::Text => say::coloured_out(&render::text(shown, source)),
            FindingsFormat::Json => {
                self.results.extend(shown.iter().map(|f| render::json(f, source)));
                Ok(())
            }
            FindingsFormat::Sarif => {
                self.results.extend(shown.iter().map(|f| render::sarif_result(f, source)));
                Ok(())
            }
        }
    }

    /// One of several that cannot be read: the others are looked at all the same.
    fn unreadable(&mut self, why: &Refused) {
        if self.only_summed {
            self.errors += 1;
            self.first = Some(("", 0, why.sentence()));
            return;
        }
        refusal::say(why);
        if self.format == FindingsFormat::Json {
            self.results.extend(refusal::findings_as_json(why));
        }
        self.errors += 1;
    }

    fn sum_up(&self, name: &str) -> Result<(), Refused> {
        if self.format != FindingsFormat::Text || self.errors == 0 && self.quiet {
            return Ok(());
        }
        let (e, o) = (plural(self.errors, "error"), plural(self.others, "remark"));
        let all = self.errors + self.others;
        let hidden = if all > MOST_SHOWN {
            format!(" (the first {MOST_SHOWN} are shown)")
        } else {
            String::new()
        };
        let tools = match &*self.tools_from {
            "" => String::new(),
            from => format!("; tools from {from}"),
        };
        say::out(&format!("{name}: {e}, {o}{hidden}{tools}\n"))
    }
}

/// A program that is held in memory.
fn whole(args: &CheckArgs, path: &Path, text: &[u8], told: &mut Told) -> Result<(), Refused> {
    if text.len() as u64 > pieces::WHOLE {
        return as_found(args, path, text, told);
    }
    let name = path.display().to_string();
    let progress = Progress::new(1, "checking");
    let Choice { options, session, notes, mut found } =
        choice::choose(&args.source.options(), path, text)?;
    drop(progress);
    told.read_as = Some((session.dialect.name(), machine_of(&options, &notes)));
    told.tools_from = session.tools_from;
    found.splice(0..0, notes);
    told.tell(&found, &Source { name: &name, text, drawn: &session.drawn })
}

/// The name of the machine, and that numbers without a point are whole units where that was chosen.
fn machine_of(options: &ProgramOptions, notes: &[Diagnostic]) -> String {
    let whole = notes.iter().any(|note| note.code == "A0107");
    let how = if whole { ", numbers without a point in whole units" } else { "" };
    format!("{}{how}", options.machine.name)
}

/// A long program that cannot be read in pieces, for its O-words lead here and there: what is found
/// is told as it goes.
fn as_found(args: &CheckArgs, path: &Path, text: &[u8], told: &mut Told) -> Result<(), Refused> {
    let name = path.display().to_string();
    let mut session = Session::load(&args.source.options(), path, text)?;
    let options = session.plan_options(session.machine.setup.stock.material);
    let drawn = session.drawn.clone();
    told.tools_from.clone_from(&session.tools_from);
    let progress = progress(path);
    let mut known = HashSet::new();
    let mut tell = |mut found: Vec<Diagnostic>, furthest: u32| {
        found.retain(|finding| known.insert((finding.code, finding.span)));
        found.sort_by_key(|f| (f.span.file, f.span.start, !f.is_error()));
        progress.set_position(furthest.into());
        progress.suspend(|| told.tell(&found, &Source { name: &name, text, drawn: &drawn }))
    };
    preflight::judge_and_tell(&mut session, text, options, &mut tell)?;
    tell(interp::lint(text, &session.interp_setup()), text.len() as u32)?;
    drop(progress);
    Ok(())
}

/// The session of a program that is read in pieces. To find the tools that are to be stood in for,
/// the whole program is needed.
fn long_session(args: &CheckArgs, path: &Path) -> Result<Option<Session>, Refused> {
    let options = args.source.options();
    match options.missing_tools {
        interp::MissingTools::Refuse => pieces::session(&options, path),
        interp::MissingTools::StandIn => Ok(None),
    }
}

/// Interpreter, planner and remarks, piece by piece; what is found in a piece is told before the
/// next one is read.
fn in_pieces(session: &Session, path: &Path, name: &str, told: &mut Told) -> Result<(), Refused> {
    let setup = session.interp_setup();
    told.tools_from.clone_from(&session.tools_from);
    let options = session.plan_options(session.machine.setup.stock.material);
    let head = pieces::head(path, MilledStock::LOOKED_AT)?;
    let mut planner = preflight::judging(session, &head, options).only_judging();
    let mut milled = MilledStock::new(&head, session);
    let mut table = TableNotes::default();
    let mut linter = interp::Linter::new(&setup);
    let (mut rest, mut index, mut first_line) = (None, 0, 1);
    let mut late = Vec::new();
    let progress = progress(path);
    let mut pieces = Pieces::open(path)?;
    while let Some(piece) = pieces.next()? {
        let mut ops = interp::Ops::of_piece(piece.text, &setup, rest.take(), piece.more_follows);
        while let Some(op) = ops.next() {
            planner.written_in(ops.frame());
            planner.push(index, &op, &mut |_| ());
            table.see(session, &op);
            milled.see(session, &op);
            index += 1;
        }
        if !piece.more_follows {
            planner.finish(&mut |_| ());
        }
        let mut found = ops.diagnostics();
        found.extend(table.take());
        add(&mut found, linter.piece(piece.text));
        // of what the planner held back, the bytes are those of a piece that is gone
        let (now, before): (Vec<_>, Vec<_>) =
            planner.take_findings().into_iter().partition(|f| f.span.line >= first_line);
        add(&mut found, now);
        late.extend(before);
        progress.suspend(|| told.tell(&found, &Source::alone(name, piece.text)))?;
        progress.inc(piece.text.len() as u64);
        first_line += memchr::memchr_iter(b'\n', piece.text).count() as u32;
        rest = Some(ops.rest());
        if found.iter().any(|finding| finding.code == NO_TEXT) {
            break; // whatever follows is none either
        }
    }
    late.extend(linter.finish());
    late.extend(milled.remark(session));
    drop(progress);
    tell_late(late, path, name, told)
}

/// How much of a long program is read, in bytes.
fn progress(path: &Path) -> Progress {
    Progress::new(path.metadata().map_or(0, |data| data.len()), "checking")
}

/// What only the end of a program shows: its lines are read once more.
fn tell_late(
    mut late: Vec<Diagnostic>,
    path: &Path,
    name: &str,
    told: &mut Told,
) -> Result<(), Refused> {
    late.sort_by_key(|finding| finding.span.line);
    let numbers: Vec<_> = late.iter().map(|finding| finding.span.line).collect();
    for (mut finding, text) in late.into_iter().zip(pieces::lines(path, &numbers)?) {
        finding.span = diag::Span { start: 0, end: text.len() as u32, ..finding.span };
        told.tell(&[finding], &Source::alone(name, &text))?;
    }
    Ok(())
}

/// A count and its noun.
pub(crate) fn plural(count: usize, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        n => format!("{n} {noun}s"),
    }
}

/// The files named, and the programs in the folders named, in the order of their names.
pub(crate) fn programs(named: &[PathBuf]) -> Result<Vec<PathBuf>, Refused> {
    let mut found = Vec::new();
    for path in named {
        if !path.is_dir() {
            found.push(path.clone());
            continue;
        }
        let inside = programs_in(path)?;
        if inside.is_empty() {
            let endings = program_files::ENDINGS.join(", .");
            let folder = path.display();
            return Err(Refused::because(format!(
                "{folder} has no programs: expected files ending in .{endings}"
            )));
        }
        found.extend(inside);
    }
    Ok(found)
}

/// The programs in a folder and in those below it. Links to folders are not followed: they may lead
/// in a circle.
fn programs_in(folder: &Path) -> Result<Vec<PathBuf>, Refused> {
    let unreadable = |e| Refused::because(format!("cannot read {}: {e}", folder.display()));
    let (mut inside, mut below) = (Vec::new(), Vec::new());
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let path = entry.path();
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            below.push(path);
        } else if path.is_file() && program_files::has_name_of_one(&path) {
            inside.push(path);
        }
    }
    inside.sort();
    below.sort();
    for folder in below {
        inside.extend(programs_in(&folder)?);
    }
    Ok(inside)
}
