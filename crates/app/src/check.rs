//! `leadscrew check`: everything that is wrong with programs, at once, without moving anything.
use crate::args::{CheckArgs, FindingsFormat};
use crate::refused::Refused;
use crate::render::{self, Source};
use crate::say;
use crate::session::{Session, read_program};
use diag::Diagnostic;
use std::path::{Path, PathBuf};

/// Endings of files that are taken for programs in a folder.
const PROGRAM_ENDINGS: [&str; 6] = ["ngc", "nc", "tap", "gcode", "cnc", "mpf"];

/// Check them all; true if none is refused.
pub(crate) fn command(args: &CheckArgs, quiet: bool) -> Result<bool, Refused> {
    let mut good = true;
    let mut results = Vec::new();
    for path in programs(&args.programs)? {
        let text = read_program(&path)?;
        let name = path.display().to_string();
        let findings = findings(args, &path, &text)?;
        good &= !findings.iter().any(Diagnostic::is_error);
        let source = Source { name: &name, text: &text };
        match args.format {
            FindingsFormat::Text => tell(&findings, &source, quiet)?,
            FindingsFormat::Json => {
                results.extend(findings.iter().map(|f| render::json(f, &source)));
            }
            FindingsFormat::Sarif => {
                results.extend(findings.iter().map(|f| render::sarif_result(f, &source)));
            }
        }
    }
    match args.format {
        FindingsFormat::Text => {}
        FindingsFormat::Json => say::out(&format!("{:#}\n", serde_json::Value::Array(results)))?,
        FindingsFormat::Sarif => say::out(&format!("{:#}\n", render::sarif(&results)))?,
    }
    Ok(good)
}

fn findings(args: &CheckArgs, path: &Path, text: &[u8]) -> Result<Vec<Diagnostic>, Refused> {
    let mut session = Session::load(&args.source, path, text)?;
    let material = session.machine.setup.stock.material;
    let options = plan::Options {
        force_ramp: None,
        cutting_pressure_n_per_mm2: material.cutting_force_n_per_mm2,
        taps: session.taps,
    };
    let mut found = crate::preflight::preflight(&mut session, text, options).findings;
    for remark in interp::lint(text, &session.interp_setup()) {
        if found.iter().all(|f| (f.code, f.span) != (remark.code, remark.span)) {
            found.push(remark);
        }
    }
    found.sort_by_key(|f| (f.span.file, f.span.start, !f.is_error()));
    Ok(found)
}

fn tell(findings: &[Diagnostic], source: &Source<'_>, quiet: bool) -> Result<(), Refused> {
    let mut text = render::text(findings, source);
    let errors = findings.iter().filter(|f| f.is_error()).count();
    let others = findings.len() - errors;
    if errors > 0 || !quiet {
        let (e, o) = (plural(errors, "error"), plural(others, "remark"));
        text += &format!("{}: {e}, {o}\n", source.name);
    }
    say::out(&text)
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
        let unreadable = |e| Refused::because(format!("cannot read {}: {e}", path.display()));
        let mut inside = Vec::new();
        for entry in std::fs::read_dir(path).map_err(unreadable)? {
            let file = entry.map_err(unreadable)?.path();
            let ending = file.extension().and_then(|e| e.to_str()).unwrap_or("");
            if file.is_file() && PROGRAM_ENDINGS.iter().any(|e| ending.eq_ignore_ascii_case(e)) {
                inside.push(file);
            }
        }
        if inside.is_empty() {
            let endings = PROGRAM_ENDINGS.join(", .");
            let folder = path.display();
            return Err(Refused::because(format!(
                "{folder} has no programs: expected files ending in .{endings}"
            )));
        }
        inside.sort();
        found.extend(inside);
    }
    Ok(found)
}
