//! Whether what is being found out of a program is still wanted.
use diag::{Diagnostic, Span};
use std::fmt;
use std::sync::Arc;

/// The code of the finding that stands for all that was not found out.
const INTERRUPTED: &str = "A0108";

/// Asked now and then while a program is planned: an editor that has cancelled its request, Ctrl-C
/// in Python.
#[derive(Clone, Default)]
pub struct Interruption(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

impl Interruption {
    /// `came` says whether to break off; it is asked in the thread that plans.
    pub fn by(came: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(came)))
    }

    /// Whether it has come.
    pub fn came(&self) -> bool {
        self.0.as_ref().is_some_and(|came| came())
    }

    /// What is said in place of everything else.
    pub(super) fn finding() -> Diagnostic {
        let text = "interrupted before everything in the program was seen";
        Diagnostic::error(INTERRUPTED, Span::default(), text)
    }
}

impl fmt::Debug for Interruption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Interruption").finish_non_exhaustive()
    }
}
