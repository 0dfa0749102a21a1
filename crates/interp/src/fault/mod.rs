//! How an interpretation stops: with one diagnostic for the block.
//!
//! ```text
//!   unknown   what is not known since a block was refused
//! ```
pub(crate) mod unknown;

use diag::{Diagnostic, Span};

/// A block that cannot be executed. Boxed: it is rare, and results travel on the fast path.
pub(crate) type Fault = Box<Diagnostic>;

/// What executing gives.
pub(crate) type Outcome<T = ()> = Result<T, Fault>;

/// An error at a place.
pub(crate) fn error(code: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(code, span, message)
}

/// The same, ready to be returned.
pub(crate) fn refuse<T>(code: &'static str, span: Span, message: impl Into<String>) -> Outcome<T> {
    Err(Box::new(error(code, span, message)))
}
