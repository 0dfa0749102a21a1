//! A text that was interpreted and judged, and what for: as long as that is so it may be executed
//! without being proved again.
use super::timeline::Timeline;
use crate::job::preflight::Proved;
use crate::job::{ClampedStock, Session};
use canon::{Position, ToolLibrary};
use interp::Parameters;
use std::path::PathBuf;

/// What a text is proved for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Basis {
    pub(super) position: Position,
    pub(super) mounted: u32,
    /// Where the tools are, where a sequence works the changer.
    pub(super) magazine: Option<canon::Magazine>,
    pub(super) parameters: Parameters,
    pub(super) tools: ToolLibrary,
    /// Which of all that was ever in force is in force.
    pub(super) rest_number: u64,
    pub(super) block_skip: Vec<u8>,
    /// What a program before has stated of the workpiece on which it is to run.
    pub(super) stock: ClampedStock,
}

/// A text that may be executed.
pub(super) struct Fit {
    pub(super) path: PathBuf,
    pub(super) name: String,
    pub(super) text: Vec<u8>,
    pub(super) session: Session,
    pub(super) proved: Proved,
    /// `None`: it is fit, and was not planned yet.
    pub(super) timeline: Option<Timeline>,
}

impl Fit {
    /// By what it is known again that none of its texts was changed.
    pub(super) fn sha256(&self) -> String {
        self.session.texts(&self.text).sha256()
    }

    /// It is made from more than its text: subprograms in files, cams and what was measured of
    /// them.
    pub(super) fn reads_files(&self) -> bool {
        !self.session.drawn.is_empty() || !self.session.cams.library.is_empty()
    }
}

/// Which text is proved, and for what.
#[derive(Clone, PartialEq)]
pub struct ProofMark {
    pub(super) path: PathBuf,
    pub(super) basis: Basis,
}

/// What came of the program that is loaded, on this basis.
pub(super) struct Proof {
    basis: Basis,
    /// `None`: it is refused, which is said when it is started, or it also depends on files, which
    /// may change until then.
    fit: Option<Box<Fit>>,
}

impl Proof {
    /// Of a text that is fit to be executed, or is not.
    pub(super) fn of(basis: Basis, fit: Option<Fit>) -> Self {
        Self { basis, fit: fit.filter(|fit| !fit.reads_files()).map(Box::new) }
    }

    /// Whether it holds.
    pub(super) fn is_on(&self, basis: &Basis) -> bool {
        self.basis == *basis
    }

    /// The text, if it is fit and was not planned yet.
    pub(super) fn untimed(&self) -> Option<&Fit> {
        self.fit.as_deref().filter(|fit| fit.timeline.is_none())
    }

    /// The same, to be told how long it takes.
    pub(super) fn untimed_mut(&mut self) -> Option<&mut Fit> {
        self.fit.as_deref_mut().filter(|fit| fit.timeline.is_none())
    }

    /// The text, if it is fit and that is so now.
    pub(super) fn fit_on(self, basis: &Basis) -> Option<Fit> {
        self.fit.filter(|_| self.basis == *basis).map(|fit| *fit)
    }
}
