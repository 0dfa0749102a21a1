//! The program under test, run as a user runs it.
use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};

/// Root of the tree.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Run `leadscrew` in the root of the tree.
pub(crate) fn leadscrew(arguments: &[&str]) -> Output {
    leadscrew_in(&root(), arguments)
}

/// Run `leadscrew` in a folder.
pub(crate) fn leadscrew_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(arguments)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .output()
        .unwrap()
}

/// What it wrote to standard output.
pub(crate) fn said(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// What it wrote to standard error.
pub(crate) fn complained(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}
