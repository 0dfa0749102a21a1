//! A file that a program draws in: what a finding that lies in it is shown with.

/// A file that a program draws in.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Where it lies, as it is shown.
    pub path: String,
    /// What it holds.
    pub sub: interp::Subprogram,
}
