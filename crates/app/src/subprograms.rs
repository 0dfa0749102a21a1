//! Files with subprograms that a program calls: beside it, and along the search path.
//!
//! ```text
//!   o<pocket> call   ─► pocket.ngc   1. beside the program
//!   o123 call        ─► 123.ngc      2. in the folders of --subprograms, in their order
//!                                    3. in those of `subprogram_path` in the machine's file
//! ```
//!
//! A name is a file's name and nothing else: it has no folders in it, and a link that leads out of its folder is not
//! followed. So no program can read what lies elsewhere.
use crate::args::ProgramArgs;
use crate::refused::Refused;
use std::path::{Path, PathBuf};
use store::machine::MachineFile;

/// Most files one program may draw in.
const MOST_FILES: usize = 256;

/// A file that a program draws in.
#[derive(Clone, Debug)]
pub(crate) struct Drawn {
    /// Where it lies, as it is shown.
    pub(crate) path: String,
    pub(crate) sub: interp::Subprogram,
}

/// Those that the program calls and does not define, and what they call in turn.
pub(crate) fn find(
    args: &ProgramArgs,
    machine: &MachineFile,
    program: &Path,
    text: &[u8],
) -> Result<Vec<Drawn>, Refused> {
    let folders = search_path(args, machine, program)?;
    let mut found: Vec<Drawn> = Vec::new();
    let mut wanted = interp::called_files(text);
    while let Some(name) = wanted.pop() {
        if found.iter().any(|drawn| drawn.sub.name == name) {
            continue;
        }
        let Some(path) = folders.iter().find_map(|folder| within(folder, &name)) else { continue };
        if found.len() == MOST_FILES {
            return Err(Refused::because(format!(
                "the program calls more than {MOST_FILES} subprogram files"
            )));
        }
        let source = store::read_bytes(&path, "a subprogram", store::PROGRAM_LIMIT)?;
        wanted.extend(interp::called_files(&source));
        let path = path.display().to_string();
        found.push(Drawn { path, sub: interp::Subprogram { name, source } });
    }
    Ok(found)
}

/// The file in which a program finds a subprogram of this name.
pub(crate) fn file_of(
    args: &ProgramArgs,
    machine: &MachineFile,
    program: &Path,
    name: &str,
) -> Option<PathBuf> {
    search_path(args, machine, program).ok()?.iter().find_map(|folder| within(folder, name))
}

/// The folders in which files are looked for, in order. One that is not there is refused: it is a slip of the pen.
fn search_path(
    args: &ProgramArgs,
    machine: &MachineFile,
    program: &Path,
) -> Result<Vec<PathBuf>, Refused> {
    let beside = match program.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    };
    let mut folders = vec![beside];
    folders.extend(args.subprograms.iter().cloned());
    let home = Path::new(&args.machine).parent().unwrap_or(Path::new(""));
    let listed = machine.control.subprogram_path.as_deref().unwrap_or_default();
    folders.extend(listed.split(':').filter(|name| !name.is_empty()).map(|name| home.join(name)));
    if let Some(missing) = folders.iter().skip(1).find(|folder| !folder.is_dir()) {
        let missing = missing.display();
        return Err(Refused::because(format!(
            "subprograms are to be looked for in {missing}, which is no folder"
        )));
    }
    Ok(folders)
}

/// The file of a subprogram in a folder, if it is really there.
fn within(folder: &Path, name: &str) -> Option<PathBuf> {
    if name.contains(['/', '\\', ':']) || name.starts_with('.') {
        return None;
    }
    let path = folder.join(format!("{name}.ngc"));
    let (folder, real) = (folder.canonicalize().ok()?, path.canonicalize().ok()?);
    (real.parent() == Some(&folder) && real.is_file()).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_lead_out_of_its_folder() {
        let root = tempfile::tempdir().unwrap();
        let (inside, outside) = (root.path().join("in"), root.path().join("out"));
        std::fs::create_dir_all(&inside).unwrap();
        std::fs::create_dir_all(&outside).unwrap();
        std::fs::write(outside.join("secret.ngc"), "").unwrap();
        std::fs::write(inside.join("own.ngc"), "").unwrap();
        assert!(within(&inside, "own").is_some());
        assert_eq!(within(&inside, "../out/secret"), None);
        assert_eq!(within(&inside, ".."), None);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(outside.join("secret.ngc"), inside.join("link.ngc"))
                .unwrap();
            assert_eq!(within(&inside, "link"), None);
        }
    }
}
