//! Which keys a reader asks for: it is run over a text, and each of its questions is noted.
use super::Keys;
use crate::asked_key::AskedKey;
use crate::bases::bases;
use std::cell::RefCell;
use toml::de::DeTable;

/// All keys that a reader asks for, whether the text has them or not; what is wrong with the text
/// is not said.
pub(crate) fn asked<T>(
    text: &str,
    extends: &'static str,
    base_of: &dyn Fn(&str) -> Option<&'static str>,
    read: impl FnOnce(&mut Keys<'_>) -> T,
) -> Vec<AskedKey> {
    let (root, _) = DeTable::parse_recoverable(text);
    let Ok(bases) = bases(root.get_ref(), extends, base_of) else { return Vec::new() };
    let recorder = RefCell::default();
    let below = bases.iter().collect();
    let mut keys = Keys::new(String::new(), root.get_ref(), 0..0, None, below);
    keys.recorder = Some(&recorder);
    read(&mut keys);
    drop(keys);
    recorder.into_inner()
}

impl Keys<'_> {
    /// Note what may stand at a key.
    pub(super) fn record(&self, key: &'static str, must: bool, value: impl FnOnce() -> String) {
        let Some(recorder) = self.recorder else { return };
        let mut seen = recorder.borrow_mut();
        if !seen.iter().any(|one| one.table == self.name && one.key == key) {
            seen.push(AskedKey { table: self.name.clone(), key, value: value(), must });
        }
    }

    /// Note what is asked of tables `[[key]]` that are missing.
    pub(super) fn record_heading(&self, key: &str, read: impl FnOnce(&mut Keys<'_>)) {
        if self.recorder.is_some() {
            self.read_missing(self.heading(key), read);
        }
    }

    /// Reads a table that is missing.
    pub(super) fn read_missing<T>(&self, name: String, read: impl FnOnce(&mut Keys<'_>) -> T) -> T {
        let empty = DeTable::new();
        let mut keys = Keys::missing(&empty);
        (keys.name, keys.recorder) = (name, self.recorder);
        read(&mut keys)
    }

    /// Heading of the tables `[[key]]` of this one.
    pub(super) fn heading(&self, key: &str) -> String {
        match self.name.strip_prefix('[').and_then(|n| n.strip_suffix(']')) {
            Some(parent) => format!("[[{}.{key}]]", parent.trim_matches(['[', ']'])),
            None => format!("[[{key}]]"),
        }
    }
}
