//! The files in which Linux says what the computer is: read below a root, so that another
//! computer's can be read as well.
use rustix::fs::{Access, access};
use std::path::PathBuf;
use store::SMALL_FILE_LIMIT;

/// A computer, by its files.
#[derive(Clone, Debug)]
pub struct Computer {
    root: PathBuf,
}

impl Default for Computer {
    fn default() -> Self {
        Self::at("/")
    }
}

impl Computer {
    /// The computer whose `proc`, `sys` and `usr` are below this folder.
    pub fn at(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    pub(super) fn path(&self, file: &str) -> PathBuf {
        self.root.join(file)
    }

    /// A file's text without the white space around it; `None`: there is none that can be read.
    pub(super) fn text(&self, file: &str) -> Option<String> {
        let bytes = self.bytes(file, SMALL_FILE_LIMIT)?;
        Some(String::from_utf8_lossy(&bytes).trim().to_owned())
    }

    pub(super) fn bytes(&self, file: &str, limit: u64) -> Option<Vec<u8>> {
        store::read_bytes(&self.path(file), "a file of this computer", limit).ok()
    }

    pub(super) fn number(&self, file: &str) -> Option<f64> {
        self.text(file)?.parse().ok()
    }

    /// Names of what is in a folder, in order; none where there is no folder.
    pub(super) fn names(&self, folder: &str) -> Vec<String> {
        let Ok(entries) = std::fs::read_dir(self.path(folder)) else { return Vec::new() };
        let named = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        let mut names: Vec<_> = named.collect();
        names.sort();
        names
    }

    /// The last part of what a link leads to, such as a driver's name.
    pub(super) fn link(&self, link: &str) -> Option<String> {
        let target = std::fs::read_link(self.path(link)).ok()?;
        target.file_name()?.to_str().map(str::to_owned)
    }

    pub(super) fn has(&self, file: &str) -> bool {
        self.path(file).exists()
    }

    /// This process may write a file, given with its leading slash.
    pub(super) fn may_write(&self, file: &str) -> bool {
        let path = self.path(file.trim_start_matches('/'));
        access(path, Access::WRITE_OK).is_ok()
    }

    /// Numbers of the cores that are in use.
    pub(super) fn cores(&self) -> Vec<usize> {
        let online = self.text("sys/devices/system/cpu/online").unwrap_or_default();
        control::numbers_of_list(&online)
    }

    /// Cores that are kept free of other threads.
    pub(super) fn isolated(&self) -> Vec<usize> {
        let isolated = self.text("sys/devices/system/cpu/isolated").unwrap_or_default();
        control::numbers_of_list(&isolated)
    }
}
