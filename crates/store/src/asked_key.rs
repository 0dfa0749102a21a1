//! The keys that readers of files ask for, as data: pages of keys are made from them.
use std::ops::RangeInclusive;

/// A key that a reader asks for: what the pages of keys are made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AskedKey {
    /// The table it stands in, such as `[axes.x]`.
    pub table: String,
    /// The key as the file writes it.
    pub key: &'static str,
    /// What may stand there.
    pub value: String,
    /// A file without it is refused.
    pub must: bool,
}

/// Bounds, for people.
pub(crate) fn span(bounds: &RangeInclusive<f64>) -> String {
    let said =
        |value: f64| if value.abs() >= 1e7 { format!("{value:e}") } else { value.to_string() };
    format!("{} to {}", said(*bounds.start()), said(*bounds.end()))
}

pub(crate) fn numbers(bounds: &RangeInclusive<f64>) -> String {
    format!("number, {}", span(bounds))
}

pub(crate) fn wholes(bounds: &RangeInclusive<u32>) -> String {
    if *bounds.end() == u32::MAX {
        return format!("whole number, {} or more", bounds.start());
    }
    format!("whole number, {} to {}", bounds.start(), bounds.end())
}

pub(crate) fn choices<T>(names: &[(&str, T)]) -> String {
    names.iter().map(|(name, _)| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}
