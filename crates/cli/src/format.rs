//! `leadscrew fmt`: programs in canonical spacing.
use crate::args::FormatArgs;
use crate::say;
use control::Refused;
use control::job::read_program;
use std::io::Write;
use std::path::Path;

/// Format them all; with `--check` change nothing and return false if something would change.
pub(crate) fn command(args: &FormatArgs, quiet: bool) -> Result<bool, Refused> {
    let mut clean = true;
    let dialect = interp::Dialect::from(args.dialect);
    let grammar = dialect.grammar();
    for path in crate::check::programs(&args.programs)? {
        let text = read_program(&path)?;
        let other = interp::looks_like(&text, dialect).filter(|other| other.grammar() != grammar);
        if let Some(other) = other {
            // what is read wrongly would be written wrongly
            let (path, name) = (path.display(), other.name());
            say::err(&format!(
                "error: {path} looks like a program of another dialect and stays as it is: format it with --dialect {name}\n"
            ));
            clean = false;
            continue;
        }
        let anew = gcode::format(&text, grammar);
        let same = anew == text;
        if args.check {
            clean &= same;
            if !same && !quiet {
                let (name, line) = (path.display(), first_change(&text, &anew));
                say::out(&format!("{name}:{line}: not in canonical spacing\n"))?;
            }
        } else if path == Path::new("-") {
            let mut out = say::data();
            say::written(out.write_all(&anew).and_then(|()| out.flush()))?;
        } else if !same {
            replace(&path, &anew)?;
            if !quiet {
                say::out(&format!("{}: formatted\n", path.display()))?;
            }
        }
    }
    Ok(clean)
}

/// Line of the first difference, from 1.
fn first_change(old: &[u8], new: &[u8]) -> usize {
    let pairs = old.split(|b| *b == b'\n').zip(new.split(|b| *b == b'\n'));
    pairs.take_while(|(a, b)| a == b).count() + 1
}

/// Put the new text in the file's place, whole or not at all.
fn replace(path: &Path, text: &[u8]) -> Result<(), Refused> {
    let refuse =
        |e: std::io::Error| Refused::because(format!("cannot write {}: {e}", path.display()));
    let path = path.canonicalize().map_err(refuse)?;
    let permissions = std::fs::metadata(&path).map_err(refuse)?.permissions();
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(refuse)?;
    file.write_all(text).map_err(refuse)?;
    file.as_file().set_permissions(permissions).map_err(refuse)?;
    file.persist(&path).map_err(|e| refuse(e.error))?;
    Ok(())
}
