//! A message of a program, as it is shown.

/// What a program has said to its operator.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct MessageStatus {
    /// The message.
    pub text: String,
    /// Its line.
    pub line: u32,
    /// Machine time at which it was heard, s.
    pub time_s: f64,
}
