//! The files of a configuration: beside the INI file, and in the folders of LinuxCNC's library of
//! HAL files.
use super::hal::Hal;
use super::ini::{Ini, MOST_FILES};
use super::writer::{Remark, RemarkKind};
use crate::{Error, SMALL_FILE_LIMIT, read_bytes};
use std::path::{Path, PathBuf};

/// Where Debian's package and a build have their library of HAL files.
const LIBRARIES: [&str; 2] = ["/usr/share/linuxcnc/hallib", "/usr/local/share/linuxcnc/hallib"];

/// What a configuration is in Leadscrew's terms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Import {
    /// The machine file; `None`: something is wrong.
    pub text: Option<String>,
    /// What was taken, guessed, is missing, …
    pub remarks: Vec<Remark>,
    /// Its tool table, where there is one.
    pub tools: Option<PathBuf>,
}

/// Import a configuration: its INI file, the HAL files that it names, and `more`.
///
/// # Errors
/// When the INI file, or one of `more`, cannot be read; what the INI file names and is not there is
/// a remark.
pub fn read(path: &Path, more: &[PathBuf]) -> Result<Import, Error> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let text = lossy(path)?;
    let named = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into());
    let ini = Ini::read(&named, &text, &mut |name| beside(folder, name, &[]));
    let libraries = LIBRARIES.map(PathBuf::from);
    let mut file = |name: &str| beside(folder, name, &libraries);
    let mut hal = Hal::default();
    for entry in ini.entries.iter().filter(|entry| entry.section == "HAL") {
        match entry.key.as_str() {
            "HALFILE" | "POSTGUI_HALFILE" => {
                let name = entry.value.split_whitespace().next().unwrap_or_default();
                let text = if Path::new(name).extension().is_some_and(|of| of == "tcl") {
                    Err("is a Tcl script".to_owned())
                } else {
                    file(name)
                };
                match text {
                    Ok(text) => hal.read(name, &text, &ini, &mut file),
                    Err(why) => {
                        hal.unseen
                            .push((name.to_owned(), format!("{}, {name} {why}", entry.place)));
                    }
                }
            }
            "HALCMD" => hal.line(&entry.value, &entry.place, &ini, &mut file),
            _ => {}
        }
    }
    for path in more.iter().take(MOST_FILES) {
        let text = lossy(path)?;
        let name = path.display().to_string();
        let folder = path.parent().unwrap_or(Path::new(""));
        hal.read(&name, &text, &ini, &mut |name| beside(folder, name, &libraries));
    }
    let (text, mut remarks) = super::import(&ini, &hal);
    let text = text.map(|text| super::compensation::without_refused(text, &mut remarks));
    let unread = hal.unread.into_iter();
    remarks.extend(unread.map(|text| Remark {
        kind: RemarkKind::Unread,
        key: String::new(),
        text,
    }));
    remarks.sort_by_key(|remark| remark.kind);
    let tools = ini.get("EMCIO", "TOOL_TABLE").map(|entry| folder.join(&entry.value));
    Ok(Import { text, remarks, tools })
}

/// A file that a configuration names: beside it, or in a library; `LIB:` is only there.
fn beside(folder: &Path, name: &str, libraries: &[PathBuf]) -> Result<String, String> {
    let (name, in_library) = match name.strip_prefix("LIB:") {
        Some(name) => (name, true),
        None => (name, false),
    };
    let own = (!in_library).then(|| folder.join(name));
    let all = own.into_iter().chain(libraries.iter().map(|library| library.join(name)));
    let found = all.into_iter().find(|path| path.exists());
    let path = found.ok_or_else(|| "is not there".to_owned())?;
    lossy(&path).map_err(|why| why.to_string())
}

/// Its text; remarks in another encoding than UTF-8 are no reason to refuse it.
fn lossy(path: &Path) -> Result<String, Error> {
    let bytes = read_bytes(path, "a LinuxCNC configuration", SMALL_FILE_LIMIT)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
