//! The parameters of a request: what each may be, and the standard's error for what it is not.
use crate::path::Path;
use std::fmt;
use std::time::Duration;

/// Observations of one answer.
pub const MOST_COUNT: u64 = 10_000;
/// Observations of one answer where nothing is said of it.
const COUNT: i64 = 100;
/// Longest text of a parameter.
const LONGEST_TEXT: usize = 1024;
/// Longest time between two documents of a stream, ms.
const LONGEST_INTERVAL_MS: u64 = 24 * 3600 * 1000;
/// A document comes after so long where nothing was observed, ms, unless the client says otherwise.
const HEARTBEAT_MS: u64 = 10_000;

/// Codes of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorCode {
    /// No token, or none that is known.
    Unauthorized,
    /// There is no such device.
    NoDevice,
    /// A number is out of its range; or what was to be read is no longer kept.
    OutOfRange,
    /// More was asked for than is answered at once.
    TooMany,
    /// There is no such address.
    InvalidUri,
    /// The parameters are not those of the request, or contradict one another.
    InvalidRequest,
    /// The path is none, or names nothing.
    InvalidPath,
    /// The agent does not do this.
    Unsupported,
    /// There is no such asset.
    AssetNotFound,
    /// The agent cannot answer now.
    InternalError,
}

impl ErrorCode {
    /// As the standard writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unauthorized => "UNAUTHORIZED",
            Self::NoDevice => "NO_DEVICE",
            Self::OutOfRange => "OUT_OF_RANGE",
            Self::TooMany => "TOO_MANY",
            Self::InvalidUri => "INVALID_URI",
            Self::InvalidRequest => "INVALID_REQUEST",
            Self::InvalidPath => "INVALID_PATH",
            Self::Unsupported => "UNSUPPORTED",
            Self::AssetNotFound => "ASSET_NOT_FOUND",
            Self::InternalError => "INTERNAL_ERROR",
        }
    }
}

/// Why a request is not answered: the standard's code, and a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QueryError {
    /// The code.
    pub code: ErrorCode,
    /// The sentence.
    pub text: String,
}

impl QueryError {
    /// Of a code and a sentence.
    pub fn new(code: ErrorCode, text: impl Into<String>) -> Self {
        Self { code, text: text.into() }
    }
}

impl fmt::Display for QueryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.code.name(), self.text)
    }
}

/// Of `probe`: it has no parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeQuery;

/// Of `current`.
#[derive(Clone, Debug, PartialEq)]
pub struct CurrentQuery {
    pub(crate) path: Option<Path>,
    /// What was true when this observation had been made.
    pub(crate) at: Option<u64>,
    /// A document so often.
    pub interval: Option<Duration>,
}

/// Of `sample`.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleQuery {
    pub(crate) path: Option<Path>,
    /// The first observation; where it is not said, the first that is kept.
    pub from: Option<u64>,
    /// The last one.
    pub(crate) to: Option<u64>,
    /// So many at most; below zero: the last ones up to `from`.
    pub(crate) count: i64,
    /// A stream: a document so often, if there is something.
    pub interval: Option<Duration>,
    /// A document after so long, even if there is nothing.
    pub heartbeat: Duration,
}

/// Of `asset`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssetQuery {
    /// These; none: all.
    pub(crate) ids: Vec<String>,
    /// Of this type.
    pub(crate) kind: Option<String>,
    /// So many at most.
    pub(crate) count: usize,
    /// Those that are gone, too.
    pub(crate) with_removed: bool,
}

/// Parameters by name, each once, and none that is not known.
struct Parameters(Vec<(String, String)>);

impl Parameters {
    fn read(query: &str, known: &[&str]) -> Result<Self, QueryError> {
        let mut read: Vec<(String, String)> = Vec::new();
        for (name, value) in form_urlencoded::parse(query.as_bytes()) {
            if !known.contains(&name.as_ref()) {
                let shown: String = name.chars().take(40).collect();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                let text = format!("there is no parameter \"{shown}\" here; there are: {known}");
                return Err(QueryError::new(ErrorCode::InvalidRequest, text));
            }
            if read.iter().any(|(before, _)| *before == name) {
                let text = format!("{name} is there twice: name it once");
                return Err(QueryError::new(ErrorCode::InvalidRequest, text));
            }
            if value.len() > LONGEST_TEXT {
                let text = format!("{name} is longer than {LONGEST_TEXT} bytes");
                return Err(QueryError::new(ErrorCode::InvalidRequest, text));
            }
            read.push((name.into_owned(), value.into_owned()));
        }
        Ok(Self(read))
    }

    fn text(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    fn path(&self) -> Result<Option<Path>, QueryError> {
        self.text("path").map(Path::parse).transpose()
    }

    /// A whole number, from least to most.
    fn number(&self, name: &str, least: i64, most: u64) -> Result<Option<i64>, QueryError> {
        let Some(text) = self.text(name) else { return Ok(None) };
        let is_number = !text.is_empty()
            && text.strip_prefix('-').unwrap_or(text).bytes().all(|byte| byte.is_ascii_digit())
            && text != "-";
        if !is_number {
            let shown: String = text.chars().take(40).collect();
            let reason = format!("{name}=\"{shown}\" is no whole number");
            return Err(QueryError::new(ErrorCode::InvalidRequest, reason));
        }
        let most = i64::try_from(most).unwrap_or(i64::MAX);
        let value: Option<i64> = text.parse().ok();
        value.filter(|value| (least..=most).contains(value)).map(Some).ok_or_else(|| {
            let reason = format!("{name} is from {least} to {most}");
            QueryError::new(ErrorCode::OutOfRange, reason)
        })
    }

    fn sequence(&self, name: &str) -> Result<Option<u64>, QueryError> {
        Ok(self.number(name, 1, u64::MAX)?.map(i64::unsigned_abs))
    }

    fn milliseconds(&self, name: &str, least: i64) -> Result<Option<Duration>, QueryError> {
        let number = self.number(name, least, LONGEST_INTERVAL_MS)?;
        Ok(number.map(|ms| Duration::from_millis(ms.unsigned_abs())))
    }
}

impl ProbeQuery {
    /// Of what stands behind `?`.
    ///
    /// # Errors
    /// There is something.
    pub fn parse(query: &str) -> Result<Self, QueryError> {
        Parameters::read(query, &[]).map(|_| Self)
    }
}

impl CurrentQuery {
    /// All that is true now.
    pub const NOW: Self = Self { path: None, at: None, interval: None };

    /// Of what stands behind `?`.
    ///
    /// # Errors
    /// The standard's.
    pub fn parse(query: &str) -> Result<Self, QueryError> {
        let read = Parameters::read(query, &["path", "at", "interval"])?;
        let (at, interval) = (read.sequence("at")?, read.milliseconds("interval", 0)?);
        if at.is_some() && interval.is_some() {
            let text = "at and interval exclude each other: what was true then does not change";
            return Err(QueryError::new(ErrorCode::InvalidRequest, text));
        }
        Ok(Self { path: read.path()?, at, interval })
    }
}

impl SampleQuery {
    /// Of what stands behind `?`.
    ///
    /// # Errors
    /// The standard's.
    pub fn parse(query: &str) -> Result<Self, QueryError> {
        let names = ["path", "from", "to", "count", "interval", "heartbeat"];
        let read = Parameters::read(query, &names)?;
        let (from, to) = (read.sequence("from")?, read.sequence("to")?);
        let count = read.number("count", i64::MIN, u64::MAX)?.unwrap_or(COUNT);
        if count == 0 {
            let text = "count is not 0: as many as there may be, below zero the last ones";
            return Err(QueryError::new(ErrorCode::OutOfRange, text));
        }
        if count.unsigned_abs() > MOST_COUNT {
            let text = format!("count is {MOST_COUNT} at most: ask for the next ones afterwards");
            return Err(QueryError::new(ErrorCode::TooMany, text));
        }
        let interval = read.milliseconds("interval", 0)?;
        let heartbeat = read.milliseconds("heartbeat", 1)?;
        if interval.is_some() && (to.is_some() || count < 0) {
            let text =
                "a stream (interval) has no end: it goes with neither to nor a count below zero";
            return Err(QueryError::new(ErrorCode::InvalidRequest, text));
        }
        if to.zip(from).is_some_and(|(to, from)| to < from) {
            let text = "to lies before from";
            return Err(QueryError::new(ErrorCode::OutOfRange, text));
        }
        if heartbeat.is_some() && interval.is_none() {
            let text = "heartbeat is of a stream: say interval, too";
            return Err(QueryError::new(ErrorCode::InvalidRequest, text));
        }
        let heartbeat = heartbeat.unwrap_or(Duration::from_millis(HEARTBEAT_MS));
        Ok(Self { path: read.path()?, from, to, count, interval, heartbeat })
    }

    /// All from an observation on, so many at most.
    pub const fn all_from(from: u64, count: u32) -> Self {
        let heartbeat = Duration::from_millis(HEARTBEAT_MS);
        let (from, count) = (Some(from), count as i64);
        Self { path: None, from, to: None, count, interval: None, heartbeat }
    }

    /// The same, a stream that has come to this observation.
    #[must_use]
    pub fn at(&self, from: u64) -> Self {
        Self { from: Some(from), ..self.clone() }
    }
}

impl AssetQuery {
    /// Of one asset.
    pub fn one(id: &str) -> Self {
        Self { ids: vec![id.to_owned()], kind: None, count: 1, with_removed: true }
    }

    /// Of what stands behind `asset/`, and behind `?`.
    ///
    /// # Errors
    /// The standard's.
    pub fn parse(ids: &str, query: &str) -> Result<Self, QueryError> {
        let read = Parameters::read(query, &["type", "count", "removed"])?;
        let count = read.number("count", 1, MOST_COUNT)?.unwrap_or(COUNT);
        let with_removed = match read.text("removed") {
            None | Some("false") => false,
            Some("true") => true,
            Some(_) => {
                let text = "removed is true or false";
                return Err(QueryError::new(ErrorCode::InvalidRequest, text));
            }
        };
        let ids = ids.split([';', ',']).filter(|id| !id.is_empty());
        Ok(Self {
            ids: ids.map(str::to_owned).collect(),
            kind: read.text("type").map(str::to_owned),
            count: usize::try_from(count).unwrap_or(usize::MAX),
            with_removed,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(query: &str) -> ErrorCode {
        SampleQuery::parse(query).expect_err("it is wrong").code
    }

    #[test]
    fn each_mistake_has_the_code_that_the_standard_has_for_it() {
        assert_eq!(refused("from=0"), ErrorCode::OutOfRange);
        assert_eq!(refused("from=99999999999999999999999"), ErrorCode::OutOfRange);
        assert_eq!(refused("from=-3"), ErrorCode::OutOfRange);
        assert_eq!(refused("from=x"), ErrorCode::InvalidRequest);
        assert_eq!(refused("from="), ErrorCode::InvalidRequest);
        assert_eq!(refused("count=0"), ErrorCode::OutOfRange);
        assert_eq!(refused("count=10001"), ErrorCode::TooMany);
        assert_eq!(refused("count=-10001"), ErrorCode::TooMany);
        assert_eq!(refused("from=1&from=2"), ErrorCode::InvalidRequest);
        assert_eq!(refused("frm=1"), ErrorCode::InvalidRequest);
        assert_eq!(refused("interval=-1"), ErrorCode::OutOfRange);
        assert_eq!(refused("interval=100&to=7"), ErrorCode::InvalidRequest);
        assert_eq!(refused("heartbeat=100"), ErrorCode::InvalidRequest);
        assert_eq!(refused("from=9&to=7"), ErrorCode::OutOfRange);
        assert_eq!(refused("path=%2F%2FDataItem["), ErrorCode::InvalidPath);
        let code = CurrentQuery::parse("at=3&interval=100").expect_err("both").code;
        assert_eq!(code, ErrorCode::InvalidRequest);
        assert_eq!(ProbeQuery::parse("at=3").expect_err("none").code, ErrorCode::InvalidRequest);
    }

    #[test]
    fn what_is_not_said_is_what_the_standard_says() {
        let sample = SampleQuery::parse("").expect("nothing");
        assert_eq!((sample.count, sample.from, sample.interval), (100, None, None));
        assert_eq!(sample.heartbeat, Duration::from_secs(10));
        let asset = AssetQuery::parse("T1;T2", "type=CuttingTool").expect("two");
        assert_eq!(asset.ids, ["T1", "T2"]);
    }
}
