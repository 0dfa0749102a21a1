//! The file of tokens: who may ask from elsewhere. A token is shown once; the file has its hash.
//!
//! A token is 32 bytes of the system's randomness, so that a plain SHA-256 of it tells nothing.
use crate::rights::Role;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::io::Write as _;
use std::path::Path;

/// Largest file.
const LARGEST: u64 = 64 << 10;

/// Tokens that are known.
#[derive(Clone, Debug, Default)]
pub struct Tokens {
    tokens: Vec<Token>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Token {
    name: String,
    role: String,
    sha256: String,
}

#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    token: Vec<Token>,
}

/// A token that was made.
#[derive(Debug)]
pub struct NewToken {
    /// The token; it stands nowhere else.
    pub token: String,
}

/// So many random bytes in hexadecimal digits.
pub(crate) fn random<const N: usize>() -> Result<String, String> {
    let mut bytes = [0_u8; N];
    getrandom::fill(&mut bytes).map_err(|e| format!("the system has no random numbers: {e}"))?;
    Ok(hex(&bytes))
}

pub(crate) fn hex(bytes: &[u8]) -> String {
    let digit = |value: u8| char::from_digit(u32::from(value), 16).unwrap_or('0'); // below 16 it is one
    bytes.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}

fn hash(token: &str) -> String {
    hex(&Sha256::digest(token.as_bytes()))
}

fn role_of(name: &str) -> Option<Role> {
    [Role::Viewer, Role::Operator].into_iter().find(|role| role.name() == name)
}

impl Tokens {
    /// Read a file of tokens.
    ///
    /// # Errors
    /// It is not there, or is none.
    pub fn read(path: &Path) -> Result<Self, String> {
        let file = read(path)?;
        if file.token.is_empty() {
            return Err(format!("{} has no token: make one with --new-token", path.display()));
        }
        Ok(Self { tokens: file.token })
    }

    /// Add a token to a file, which is made if it is not there.
    ///
    /// # Errors
    /// The file is none, or cannot be written.
    pub fn add(path: &Path, name: &str, role: Role) -> Result<NewToken, String> {
        let mut file = if path.exists() { read(path)? } else { File::default() };
        if file.token.iter().any(|token| token.name == name) {
            return Err(format!("{} has a token named \"{name}\" already", path.display()));
        }
        let token = random::<32>()?;
        file.token.push(Token {
            name: name.to_owned(),
            role: role.name().to_owned(),
            sha256: hash(&token),
        });
        let text = toml::to_string(&file).map_err(|e| e.to_string())?;
        write(path, &text).map_err(|e| format!("cannot write {}: {e}", path.display()))?;
        Ok(NewToken { token })
    }

    /// Whose token it is, and what it allows.
    pub(crate) fn find(&self, token: &str) -> Option<(String, Role)> {
        let sought = hash(token);
        let found = self.tokens.iter().find(|known| known.sha256 == sought)?;
        Some((found.name.clone(), role_of(&found.role)?))
    }
}

/// Whole or not at all; such a file is readable by its owner alone.
fn write(path: &Path, text: &str) -> std::io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let mut file = tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))?;
    file.write_all(text.as_bytes())?;
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}

fn read(path: &Path) -> Result<File, String> {
    let text = store::read_bytes(path, "a file of tokens", LARGEST).map_err(|e| e.to_string())?;
    let text = String::from_utf8_lossy(&text);
    let file: File =
        toml::from_str(&text).map_err(|e| format!("{}: {}", path.display(), e.message()))?;
    for token in &file.token {
        if role_of(&token.role).is_none() {
            return Err(format!(
                "{}: the role of \"{}\" is \"{}\": expected viewer or operator",
                path.display(),
                token.name,
                token.role
            ));
        }
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_found_by_itself_alone_and_stands_in_no_file() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("tokens.toml");
        let first = Tokens::add(&path, "desk-1", Role::Operator).expect("made");
        let second = Tokens::add(&path, "wall", Role::Viewer).expect("made");
        assert!(Tokens::add(&path, "wall", Role::Viewer).is_err(), "a name is one token's");
        let text = std::fs::read_to_string(&path).expect("read");
        assert!(!text.contains(&first.token) && !text.contains(&second.token));
        let tokens = Tokens::read(&path).expect("read");
        assert_eq!(tokens.find(&first.token), Some(("desk-1".into(), Role::Operator)));
        assert_eq!(tokens.find(&second.token), Some(("wall".into(), Role::Viewer)));
        for none in ["", "x", &first.token[1..]] {
            assert_eq!(tokens.find(none), None);
        }
    }
}
