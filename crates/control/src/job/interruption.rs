//! Whether what is being found out of a program is still wanted, and how far it is.
use diag::{Diagnostic, Span};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// The code of the finding that stands for all that was not found out.
const INTERRUPTED: &str = "A0108";

/// Asked now and then while a program is planned: an editor that has cancelled its request, Ctrl-C
/// in Python.
#[derive(Clone, Default)]
pub struct Interruption {
    came: Option<Arc<dyn Fn() -> bool + Send + Sync>>,
    progress: Option<Arc<ReadProgress>>,
}

/// How far a program has been read, for another thread.
#[derive(Debug, Default)]
pub struct ReadProgress(AtomicU32);

impl ReadProgress {
    /// Percent of it; it does not go back.
    pub fn percent(&self) -> f64 {
        f64::from(self.0.load(Relaxed)) / 10.0
    }
}

impl Interruption {
    /// `came` says whether to break off; it is asked in the thread that plans.
    pub fn by(came: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self { came: Some(Arc::new(came)), progress: None }
    }

    /// The same; `progress` shows how far it is when that is asked.
    #[must_use]
    pub fn showing(self, progress: Arc<ReadProgress>) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// Whether it has come.
    pub fn came(&self) -> bool {
        self.came.as_ref().is_some_and(|came| came())
    }

    /// Whether it has come when this share, 0 to 1, is done.
    pub fn came_at(&self, share: f64) -> bool {
        if let Some(ReadProgress(done)) = self.progress.as_deref() {
            done.fetch_max((share.clamp(0.0, 1.0) * 1000.0) as u32, Relaxed); // ‰
        }
        self.came()
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
