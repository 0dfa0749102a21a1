//! Which broker, as which user, below which topics: what is written on the command line and in
//! files.
use crate::secret;
use std::fmt;
use std::path::{Path, PathBuf};

/// What comes with an address that has no port.
const PORT: u16 = 1883;
/// The same over TLS.
const TLS_PORT: u16 = 8883;
/// Longest beginning of the topics, bytes.
const LONGEST_TOPIC: usize = 200;
/// User and password, if no file has them.
const VARIABLES: [&str; 2] = ["LEADSCREW_MQTT_USER", "LEADSCREW_MQTT_PASSWORD"];
/// Longest file with user and password, bytes.
const LONGEST_LOGIN: u64 = 4096;

/// Where a broker is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BrokerAddress {
    pub(crate) host: String,
    pub(crate) port: u16,
    pub(crate) is_tls: bool,
}

impl BrokerAddress {
    /// As it is typed: `mqtt://HOST`, `mqtts://HOST:PORT`.
    ///
    /// # Errors
    /// A sentence.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = |why: &str| {
            format!(
                "\"{text}\" {why}: expected mqtt://HOST or mqtt://HOST:PORT, and mqtts:// for TLS"
            )
        };
        let (is_tls, rest) = match text.split_once("://") {
            Some(("mqtt", rest)) => (false, rest),
            Some(("mqtts", rest)) => (true, rest),
            _ => return Err(wrong("is no address of an MQTT broker")),
        };
        let rest = rest.strip_suffix('/').unwrap_or(rest);
        if rest.contains('@') {
            // what stands before it may be a password, and is not said again
            let text = "user and password do not stand in the address of a broker, which others can read: \
                write them into a file, and name it with --mqtt-login FILE";
            return Err(text.to_owned());
        }
        if rest.contains(['/', '?', '#']) {
            return Err(wrong("goes on behind the host: topics begin with --mqtt-topic"));
        }
        let (host, port) = match rest.strip_prefix('[') {
            Some(rest) => {
                let (host, rest) = rest.split_once(']').ok_or_else(|| wrong("lacks its ]"))?;
                host.parse::<std::net::Ipv6Addr>()
                    .map_err(|_| wrong("has no IPv6 address in []"))?;
                let port = match rest.strip_prefix(':') {
                    None if rest.is_empty() => None,
                    None => return Err(wrong("has more than a port behind ]")),
                    port => port,
                };
                (host, port)
            }
            None => match rest.split_once(':') {
                Some((_, port)) if port.contains(':') => {
                    return Err(wrong("has more than one port (an IPv6 address stands in [])"));
                }
                Some((host, port)) => (host, Some(port)),
                None => (rest, None),
            },
        };
        let is_name = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_' | ':');
        if host.is_empty() || !host.chars().all(is_name) {
            return Err(wrong("names no host"));
        }
        let port = match port {
            None if is_tls => TLS_PORT,
            None => PORT,
            Some(port) => match port.parse() {
                Ok(port) if port != 0 => port,
                _ => return Err(wrong("has no port from 1 to 65535")),
            },
        };
        Ok(Self { host: host.to_owned(), port, is_tls })
    }
}

impl fmt::Display for BrokerAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scheme = if self.is_tls { "mqtts" } else { "mqtt" };
        let (open, close) = if self.host.contains(':') { ("[", "]") } else { ("", "") };
        write!(f, "{scheme}://{open}{}{close}:{}", self.host, self.port)
    }
}

/// With what all topics begin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TopicPrefix(pub(crate) String);

impl TopicPrefix {
    /// As it is typed.
    ///
    /// # Errors
    /// A sentence.
    pub fn parse(text: &str) -> Result<Self, String> {
        let text = text.strip_suffix('/').unwrap_or(text);
        let wrong = |why: &str| Err(format!("\"{text}\" cannot begin a topic: {why}"));
        if text.is_empty() || text.len() > LONGEST_TOPIC {
            return wrong(&format!("it has from 1 to {LONGEST_TOPIC} bytes, as in MTConnect"));
        }
        if text.starts_with('$') {
            return wrong("those that begin with $ are the broker's own");
        }
        if text.contains(['+', '#']) || text.contains(char::is_control) {
            return wrong("+, # and control characters stand in no topic");
        }
        if text.split('/').any(str::is_empty) {
            return wrong("something stands before, behind and between its /");
        }
        Ok(Self(text.to_owned()))
    }
}

/// User and password at a broker.
#[derive(Clone, PartialEq, Eq)]
pub struct BrokerLogin {
    pub(crate) user: String,
    pub(crate) password: String,
    /// The file that has it.
    pub(crate) file: Option<PathBuf>,
}

impl fmt::Debug for BrokerLogin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "BrokerLogin({})", self.user)
    }
}

impl BrokerLogin {
    /// Of a file: the user in its first line, the password in its second.
    ///
    /// # Errors
    /// A sentence.
    pub fn read(path: &Path) -> Result<Self, String> {
        let cannot = |why: &dyn fmt::Display| {
            format!("cannot read user and password from {}: {why}", path.display())
        };
        secret::check(path, "the login at the broker")?;
        let what = "a file with user and password";
        let text = store::read_text(path, what, LONGEST_LOGIN).map_err(|e| cannot(&e))?;
        let login = Self::of(&text).map(|login| Self { file: Some(path.to_owned()), ..login });
        login.ok_or_else(|| {
            cannot(&"expected two lines: the user in the first, the password in the second")
        })
    }

    /// Of the environment; `None`: it names no user.
    ///
    /// # Errors
    /// A sentence.
    pub fn of_environment() -> Option<Result<Self, String>> {
        let [user, password] = VARIABLES.map(std::env::var_os);
        let user = user.filter(|user| !user.is_empty())?;
        let text = |(name, text): (&str, std::ffi::OsString)| {
            text.into_string().map_err(|_| format!("{name} is no UTF-8"))
        };
        let password = (VARIABLES[1], password.unwrap_or_default());
        Some(
            text((VARIABLES[0], user))
                .and_then(|user| Ok(Self { user, password: text(password)?, file: None })),
        )
    }

    fn of(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let (user, password) = (lines.next()?, lines.next()?);
        let is_all = !user.is_empty() && lines.all(str::is_empty);
        is_all.then(|| {
            let (user, password) = (user.to_owned(), password.to_owned());
            Self { user, password, file: None }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn address(text: &str) -> (String, u16, bool) {
        let read = BrokerAddress::parse(text).expect("an address");
        (read.host, read.port, read.is_tls)
    }

    #[test]
    fn an_address_has_a_host_and_the_port_that_belongs_to_it() {
        assert_eq!(address("mqtt://broker.shop"), ("broker.shop".into(), 1883, false));
        assert_eq!(address("mqtts://broker.shop/"), ("broker.shop".into(), 8883, true));
        assert_eq!(address("mqtt://10.0.0.7:11883"), ("10.0.0.7".into(), 11883, false));
        assert_eq!(address("mqtts://[fd00::7]:9"), ("fd00::7".into(), 9, true));
        assert_eq!(address("mqtt://[::1]"), ("::1".into(), 1883, false));
    }

    #[test]
    fn what_is_no_address_is_told_with_one_that_works() {
        for wrong in [
            "",
            "broker",
            "http://broker",
            "mqtt://",
            "mqtt://:1883",
            "mqtt://a:0",
            "mqtt://a:65536",
            "mqtt://a:",
            "mqtt://a b",
            "mqtt://::1",
            "mqtt://[::1",
            "mqtt://[a]",
            "mqtt://[::1]7",
            "mqtt://a/topic",
            "mqtt://a?x",
            "tcp://a",
        ] {
            let why = BrokerAddress::parse(wrong).expect_err(wrong);
            assert!(why.contains("mqtt://HOST:PORT"), "{why}");
        }
        let why = BrokerAddress::parse("mqtt://me:secret@broker").expect_err("a password");
        assert!(why.contains("--mqtt-login") && !why.contains("secret"), "{why}");
    }

    #[test]
    fn topics_begin_with_what_a_broker_takes() {
        for good in ["MTConnect", "plant/hall 3", "Werk-\u{fc}/a", "MTConnect/"] {
            assert!(TopicPrefix::parse(good).is_ok(), "{good}");
        }
        for wrong in ["", "/", "/a", "a//b", "a/+", "#", "$SYS", "a\u{0}b", &"x".repeat(201)] {
            assert!(TopicPrefix::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn user_and_password_are_two_lines_and_are_not_shown() {
        let login = BrokerLogin::of("mill-7\nopen sesame\n").expect("two lines");
        assert_eq!((login.user.as_str(), login.password.as_str()), ("mill-7", "open sesame"));
        assert!(!format!("{login:?}").contains("sesame"));
        for wrong in ["", "mill-7", "\nopen sesame", "mill-7\na\nb\n"] {
            assert_eq!(BrokerLogin::of(wrong), None, "{wrong:?}");
        }
        assert!(
            BrokerLogin::of("mill-7\r\nopen sesame\r\n")
                .is_some_and(|l| l.password == "open sesame")
        );
    }

    proptest! {
        #[test]
        fn whatever_is_typed_is_an_address_that_is_read_again_or_a_sentence(text in "\\PC{0,30}", port in 1_u16..) {
            for text in [text.clone(), format!("mqtt://{text}"), format!("mqtts://{text}:{port}")] {
                match BrokerAddress::parse(&text) {
                    Ok(read) => prop_assert_eq!(BrokerAddress::parse(&read.to_string()), Ok(read)),
                    Err(why) => prop_assert!(why.len() > 20),
                }
            }
        }
    }
}
