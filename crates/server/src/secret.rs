//! Files with secrets: tokens, keys, logins. Their owner alone reads and writes them.
use std::path::Path;

/// Lowest bits of a mode: what the group and others may do.
#[cfg(unix)]
const BITS_OF_OTHERS: u32 = 6;

/// Refuses a file that others than its owner can read or write.
///
/// # Errors
/// It can be; the sentence says how to mend it. A file that is not there is not refused here.
#[cfg(unix)]
pub(crate) fn check(path: &Path, what: &str) -> Result<(), String> {
    use std::os::unix::fs::PermissionsExt as _;
    let Ok(about) = std::fs::metadata(path) else { return Ok(()) };
    let mode = about.permissions().mode() & 0o7777;
    if !about.is_file() || mode.trailing_zeros() >= BITS_OF_OTHERS {
        return Ok(());
    }
    let path = path.display();
    Err(format!(
        "{what} {path} is open to others (mode {mode:04o}): expected 0600, by chmod 600 {path}"
    ))
}

/// Where files have no such modes there is nothing to check.
#[cfg(not(unix))]
pub(crate) fn check(_: &Path, _: &str) -> Result<(), String> {
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt as _;

    #[test]
    fn a_secret_is_its_owners_alone() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("key.pem");
        assert_eq!(check(&path, "the key"), Ok(()), "it is not there");
        std::fs::write(&path, "secret").expect("written");
        for (mode, is_closed) in
            [(0o600, true), (0o400, true), (0o640, false), (0o604, false), (0o620, false)]
        {
            let permissions = std::fs::Permissions::from_mode(mode);
            std::fs::set_permissions(&path, permissions).expect("set");
            let checked = check(&path, "the key");
            assert_eq!(checked.is_ok(), is_closed, "{mode:o}: {checked:?}");
            let is_named = |why: &String| why.contains("chmod 600") && why.contains("key.pem");
            assert!(checked.as_ref().err().is_none_or(is_named), "{checked:?}");
        }
    }
}
