//! What the operator has set.

/// What the operator has set that moves must be planned anew for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatorSettings {
    /// Share of the programmed feed; 1 or more.
    pub share: f64,
    /// Each line of the program ends at rest.
    pub stops: bool,
}

impl Default for OperatorSettings {
    fn default() -> Self {
        Self { share: 1.0, stops: false }
    }
}
