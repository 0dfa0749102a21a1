//! Files with subprograms that a program calls: beside it, and along the search path.
//!
//! ```text
//!   o<pocket> call   ─► pocket.ngc        1. beside the program
//!   o123 call        ─► 123.ngc           2. in the folders of --subprograms, in their order
//!   Fanuc's M98 P12  ─► O0012.nc, 12.nc   3. in those of `subprogram_path` in the machine's file
//!   M98 <POCKET>     ─► POCKET.nc
//! ```
//!
//! Fanuc's programs are looked for with several endings, and none; numbers with an O before them
//! and without.
//!
//! A name is a file's name and nothing else: it has no folders in it, and a link that leads out of
//! its folder is not followed. So no program can read what lies elsewhere.
use crate::Refused;
use crate::job::drawn::Drawn;
use crate::job::options::ProgramOptions;
use crate::job::program_files;
use gcode::Grammar;
use std::path::{Path, PathBuf};
use store::machine::MachineFile;

/// Most files one program may draw in.
const MOST_FILES: usize = 256;
/// How files with Fanuc's programs end.
const FANUC_ENDINGS: [&str; 10] =
    [".nc", ".NC", ".cnc", ".CNC", ".tap", ".TAP", ".ngc", ".txt", ".TXT", ""];

/// Those that the program calls and does not define, and what they call in turn.
///
/// # Errors
/// Files that cannot be read, or are too large or too many.
pub fn find(
    options: &ProgramOptions,
    machine: &MachineFile,
    program: &Path,
    text: &[u8],
    grammar: Grammar,
) -> Result<Vec<Drawn>, Refused> {
    let folders = search_path(options, machine, program)?;
    let mut found: Vec<Drawn> = Vec::new();
    let calls = crate::job::dialect::macro_calls(&machine.own_codes.calls);
    let called = |text: &[u8]| {
        let mut names = interp::called_files(text, grammar);
        names.extend(interp::files_called_by_word(text, &calls, grammar));
        names
    };
    let mut wanted = called(text);
    while let Some(name) = wanted.pop() {
        if found.iter().any(|drawn| drawn.sub.name == name) {
            continue;
        }
        let Some(path) = folders.iter().find_map(|folder| named(folder, &name, grammar)) else {
            continue;
        };
        if found.len() == MOST_FILES {
            return Err(Refused::because(format!(
                "the program calls more than {MOST_FILES} subprogram files"
            )));
        }
        let mut source = store::read_bytes(&path, "a subprogram", store::PROGRAM_LIMIT)?;
        if let Err(why) = program_files::not_foreign(&source) {
            let file = path.display();
            return Err(Refused::because(format!("{file} is called, and is no program: {why}")));
        }
        gcode::end_lines_with_lf(&mut source);
        wanted.extend(called(&source));
        let path = path.display().to_string();
        found.push(Drawn { path, sub: interp::Subprogram { name, source } });
    }
    Ok(found)
}

/// The file in which a program finds a subprogram of this name.
pub fn file_of(
    options: &ProgramOptions,
    machine: &MachineFile,
    program: &Path,
    name: &str,
    grammar: Grammar,
) -> Option<PathBuf> {
    let folders = search_path(options, machine, program).ok()?;
    folders.iter().find_map(|folder| named(folder, name, grammar))
}

/// The file of a program, as its dialect names files.
fn named(folder: &Path, name: &str, grammar: Grammar) -> Option<PathBuf> {
    if grammar == Grammar::Rs274 {
        return within(folder, &format!("{name}.ngc"));
    }
    let stems = match name.parse::<u32>() {
        Ok(number) => {
            vec![format!("O{number:04}"), format!("O{number}"), format!("{number:04}"), name.into()]
        }
        Err(_) => vec![name.to_owned()],
    };
    let files = stems.iter().flat_map(|stem| FANUC_ENDINGS.map(|ending| format!("{stem}{ending}")));
    // a name that has an ending has that of a program: M98 <key.pem> finds none
    let mut files = files.filter(|file| !file.contains('.') || is_fanucs(file));
    files.find_map(|file| within(folder, &file))
}

/// Whether a file ends as Fanuc's programs do.
fn is_fanucs(file: &str) -> bool {
    FANUC_ENDINGS.iter().any(|ending| !ending.is_empty() && file.ends_with(ending))
}

/// The folders in which files are looked for, in order. One that is not there is refused: it is a
/// slip of the pen.
fn search_path(
    options: &ProgramOptions,
    machine: &MachineFile,
    program: &Path,
) -> Result<Vec<PathBuf>, Refused> {
    let beside = match program.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    };
    let mut folders = vec![beside];
    folders.extend(options.subprograms.iter().cloned());
    are_there(folders.get(1..).unwrap_or_default())?;
    folders.extend(folders_of(&options.machine.name, machine)?);
    Ok(folders)
}

/// The folders that a machine's file lists, beside the file.
///
/// # Errors
/// A folder that is not there.
pub fn folders_of(name: &str, machine: &MachineFile) -> Result<Vec<PathBuf>, Refused> {
    let home = Path::new(name).parent().unwrap_or(Path::new(""));
    let listed = machine.control.subprogram_path.as_deref().unwrap_or_default();
    let folders = listed.split(':').filter(|name| !name.is_empty()).map(|name| home.join(name));
    let folders: Vec<_> = folders.collect();
    are_there(&folders)?;
    Ok(folders)
}

fn are_there(folders: &[PathBuf]) -> Result<(), Refused> {
    folders.iter().find(|folder| !folder.is_dir()).map_or(Ok(()), |missing| {
        let missing = missing.display();
        Err(Refused::because(format!(
            "subprograms are to be looked for in {missing}, which is no folder"
        )))
    })
}

/// A file in a folder, if it is really there.
fn within(folder: &Path, name: &str) -> Option<PathBuf> {
    if name.contains(['/', '\\', ':']) || name.starts_with('.') {
        return None;
    }
    let path = folder.join(name);
    let (folder, real) = (folder.canonicalize().ok()?, path.canonicalize().ok()?);
    (real.parent() == Some(&folder) && real.is_file()).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fanucs_programs_have_files_with_numbers_or_names() {
        let root = tempfile::tempdir().unwrap();
        for file in ["O0012.nc", "7", "POCKET.TAP"] {
            std::fs::write(root.path().join(file), "M99\n").unwrap();
        }
        let found = |name: &str| named(root.path(), name, Grammar::Fanuc);
        assert_eq!(found("12"), Some(root.path().join("O0012.nc")));
        assert_eq!(found("7"), Some(root.path().join("7")));
        assert_eq!(found("POCKET"), Some(root.path().join("POCKET.TAP")));
        assert_eq!(found("../POCKET"), None);
        std::fs::write(root.path().join("key.pem"), "secret").unwrap();
        assert_eq!(found("key.pem"), None, "M98 <key.pem> calls no program");
        assert_eq!(named(root.path(), "7", Grammar::Rs274), None);
    }

    #[test]
    fn a_name_cannot_lead_out_of_its_folder() {
        let root = tempfile::tempdir().unwrap();
        let (inside, outside) = (root.path().join("in"), root.path().join("out"));
        std::fs::create_dir_all(&inside).unwrap();
        std::fs::create_dir_all(&outside).unwrap();
        std::fs::write(outside.join("secret.ngc"), "").unwrap();
        std::fs::write(inside.join("own.ngc"), "").unwrap();
        assert!(within(&inside, "own.ngc").is_some());
        assert_eq!(within(&inside, "../out/secret.ngc"), None);
        assert_eq!(within(&inside, ".."), None);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(outside.join("secret.ngc"), inside.join("link.ngc"))
                .unwrap();
            assert_eq!(within(&inside, "link.ngc"), None);
        }
    }
}
