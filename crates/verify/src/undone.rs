//! What a later cut has done to a feature, by which features are known again.

/// A feature that was changed by a later cut.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undone {
    /// First op of the feature.
    pub op: u32,
    /// Line of the later cut.
    pub line: u32,
    /// What is left of it.
    pub how: String,
    /// It is known what the tool has left; `false`: no more than how far it reaches.
    pub is_known: bool,
}

/// Number of an operation of a program before, among those of the next one.
pub(crate) const fn of_before(op: u32) -> u32 {
    const BEFORE: u32 = 1 << 31;
    op | BEFORE
}
