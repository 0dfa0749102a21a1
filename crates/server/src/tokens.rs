//! The file of tokens: who may ask from elsewhere. A token is shown once; the file has its hash.
//!
//! A token is 32 bytes of the system's randomness, so that a plain SHA-256 of it tells nothing.
use crate::role::Role;
use crate::secret;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::io::Write as _;
use std::path::Path;
use std::time::Duration;

/// Largest file.
const LARGEST: u64 = 64 << 10;
/// A server looks so often whether its file has changed.
pub(crate) const LOOKED_AT: Duration = Duration::from_secs(1);

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
    /// Seconds since 1970 at which it ends; one of a file from before ends never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    valid_until_unix_s: Option<u64>,
}

impl Token {
    /// So long from now on; `None`: for ever.
    fn left(&self, unix_s: u64) -> Option<Duration> {
        self.valid_until_unix_s.map(|until| Duration::from_secs(until.saturating_sub(unix_s)))
    }

    fn has_expired(&self, unix_s: u64) -> bool {
        self.left(unix_s).is_some_and(|left| left.is_zero())
    }
}

/// What a token says of who sends it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Known {
    /// Hash of the token: by this it is known, not by its name.
    pub(crate) sha256: String,
    pub(crate) name: String,
    pub(crate) role: Role,
    /// It ends after so long; `None`: never.
    pub(crate) left: Option<Duration>,
}

/// Why a token allows nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoToken {
    /// There is none, or it is not known.
    Unknown,
    /// Its time is over.
    Expired,
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

pub(crate) fn hash(token: &str) -> String {
    hex(&Sha256::digest(token.as_bytes()))
}

fn role_of(name: &str) -> Option<Role> {
    [Role::Viewer, Role::Operator].into_iter().find(|role| role.name() == name)
}

impl Tokens {
    /// Read a file of tokens.
    ///
    /// # Errors
    /// It is not there, others can read it, or it is none.
    pub fn read(path: &Path) -> Result<Self, String> {
        let file = read(path)?;
        if file.token.is_empty() {
            return Err(format!("{} has no token: make one with --new-token", path.display()));
        }
        Ok(Self { tokens: file.token })
    }

    /// Add a token to a file, which is made if it is not there; one of that name that has expired
    /// gives way.
    ///
    /// # Errors
    /// The file is none, or cannot be written.
    pub fn add(
        path: &Path,
        name: &str,
        role: Role,
        valid_for: Duration,
    ) -> Result<NewToken, String> {
        let now = control::clock::unix_ms() / 1000;
        let mut file = if path.exists() { read(path)? } else { File::default() };
        file.token.retain(|token| token.name != name || !token.has_expired(now));
        if file.token.iter().any(|token| token.name == name) {
            return Err(format!("{} has a token named \"{name}\" already", path.display()));
        }
        let token = random::<32>()?;
        file.token.push(Token {
            name: name.to_owned(),
            role: role.name().to_owned(),
            sha256: hash(&token),
            valid_until_unix_s: Some(now.saturating_add(valid_for.as_secs())),
        });
        let text = toml::to_string(&file).map_err(|e| e.to_string())?;
        write(path, &text).map_err(|e| format!("cannot write {}: {e}", path.display()))?;
        Ok(NewToken { token })
    }

    /// Takes a token out of a file: a server that uses the file refuses it, and all that was opened
    /// with it, within [`LOOKED_AT`].
    ///
    /// # Errors
    /// The file is none, has no such token, or cannot be written.
    pub fn revoke(path: &Path, name: &str) -> Result<(), String> {
        let mut file = read(path)?;
        let before = file.token.len();
        file.token.retain(|token| token.name != name);
        if file.token.len() == before {
            let names: Vec<_> = file.token.iter().map(|token| token.name.as_str()).collect();
            let (path, has) = (path.display(), names.join(", "));
            return Err(format!("{path} has no token named \"{name}\": it has {has}"));
        }
        let text = toml::to_string(&file).map_err(|e| e.to_string())?;
        write(path, &text).map_err(|e| format!("cannot write {}: {e}", path.display()))
    }

    /// Whose token it is, and what it allows.
    ///
    /// # Errors
    /// It is not known, or its time is over.
    pub(crate) fn find(&self, token: &str, unix_ms: u64) -> Result<Known, NoToken> {
        self.of_hash(&hash(token), unix_ms)
    }

    /// The same, by the token's hash.
    ///
    /// # Errors
    /// It is not known, or its time is over.
    pub(crate) fn of_hash(&self, sha256: &str, unix_ms: u64) -> Result<Known, NoToken> {
        let now = unix_ms / 1000;
        let found = self.tokens.iter().find(|known| known.sha256 == sha256);
        let found = found.ok_or(NoToken::Unknown)?;
        if found.has_expired(now) {
            return Err(NoToken::Expired);
        }
        let role = role_of(&found.role).ok_or(NoToken::Unknown)?;
        let (sha256, name) = (found.sha256.clone(), found.name.clone());
        Ok(Known { sha256, name, role, left: found.left(now) })
    }

    /// A token other than that of this hash has the name.
    pub(crate) fn is_of_another(&self, name: &str, sha256: &str) -> bool {
        self.tokens.iter().any(|token| token.name == name && token.sha256 != sha256)
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
    secret::check(path, "the file of tokens")?;
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
    use control::clock::unix_ms;

    #[test]
    fn a_token_is_found_by_itself_alone_and_stands_in_no_file() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("tokens.toml");
        let day = Duration::from_hours(24);
        let first = Tokens::add(&path, "desk-1", Role::Operator, day).expect("made");
        let second = Tokens::add(&path, "wall", Role::Viewer, day).expect("made");
        assert!(Tokens::add(&path, "wall", Role::Viewer, day).is_err(), "a name is one token's");
        let text = std::fs::read_to_string(&path).expect("read");
        assert!(!text.contains(&first.token) && !text.contains(&second.token));
        let tokens = Tokens::read(&path).expect("read");
        let found =
            |token: &str| tokens.find(token, unix_ms()).map(|known| (known.name, known.role));
        assert_eq!(found(&hash(&first.token)), Err(NoToken::Unknown), "its hash is none");
        assert_eq!(found(&first.token), Ok(("desk-1".into(), Role::Operator)));
        assert_eq!(found(&second.token), Ok(("wall".into(), Role::Viewer)));
        for none in ["", "x", &first.token[1..]] {
            assert_eq!(found(none), Err(NoToken::Unknown));
        }
    }

    #[test]
    fn a_token_ends_and_its_name_is_free_then_and_one_without_an_end_stays() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("tokens.toml");
        let ended = Tokens::add(&path, "wall", Role::Viewer, Duration::ZERO).expect("made");
        let find =
            |token: &NewToken| Tokens::read(&path).expect("read").find(&token.token, unix_ms());
        assert_eq!(find(&ended), Err(NoToken::Expired));
        let hour = Duration::from_hours(1);
        let next = Tokens::add(&path, "wall", Role::Viewer, hour).expect("the name is free");
        let left = find(&next).expect("it is valid").left.expect("it ends");
        assert!(left <= hour && left > Duration::from_mins(30), "{left:?}");
        assert_eq!(find(&ended), Err(NoToken::Unknown));
        let text = std::fs::read_to_string(&path).expect("read");
        let kept = text.lines().filter(|line| !line.starts_with("valid_until"));
        std::fs::write(&path, kept.collect::<Vec<_>>().join("\n")).expect("written");
        assert_eq!(find(&next).expect("as files from before are read").left, None);
    }
}
