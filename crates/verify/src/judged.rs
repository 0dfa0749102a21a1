//! When and by which tool something was cut, whether it is good, and what it is: a judge of cams
//! says it of a [`GroundCam`](crate::GroundCam), and all of them together make
//! [features](crate::Feature).
use crate::Contact;
use crate::undone::Undone;
use crate::verdict::Verdict;
use units::Time;

/// One thing cut into the workpiece, measured and judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged<K> {
    /// Index of the op that ordered it.
    pub op: u32,
    /// Program line of that op.
    pub line: u32,
    /// T number of the tool that cut it; `None` if the spindle was empty.
    pub tool: Option<u32>,
    /// When the tool first entered the material; when the op ended, if it never did.
    pub time: Time,
    /// From then until the tool was last in the material.
    pub duration: Time,
    /// Whether it is good.
    pub verdict: Verdict,
    /// What says that the tool was in the material.
    pub contact: Contact,
    /// What it is, with its measures.
    pub kind: K,
}

impl<K> Judged<K> {
    /// Takes back what was said of it: a later cut, of this line, has changed it.
    pub fn destroyed(&mut self, line: u32, how: &str) {
        let later = format!("destroyed in line {line}: {how}");
        let reason = match &self.verdict {
            Verdict::Pass => format!("good when cut, {later}"),
            Verdict::Fail { reason } | Verdict::NotJudged { reason } => {
                format!("{reason}; {later}")
            }
        };
        self.verdict = Verdict::Fail { reason };
    }

    /// Takes back what was said of it, as far as a later cut is known to have changed it.
    pub fn changed(&mut self, undone: &Undone) {
        if undone.is_known {
            self.destroyed(undone.line, &undone.how);
        } else {
            self.doubted(undone.line, &undone.how);
        }
    }

    /// What was said of it may not hold any more: a later line may have changed it.
    fn doubted(&mut self, line: u32, how: &str) {
        let later = format!("not judged after line {line}: {how}");
        self.verdict = match &self.verdict {
            Verdict::Pass => Verdict::NotJudged { reason: format!("good when cut, {later}") },
            Verdict::NotJudged { reason } => {
                Verdict::NotJudged { reason: format!("{reason}; {later}") }
            }
            Verdict::Fail { reason } => Verdict::Fail { reason: reason.clone() },
        };
    }

    /// Finds something wrong with it beside what was found already.
    pub(crate) fn fails(&mut self, finding: String) {
        let reason = match &self.verdict {
            Verdict::Fail { reason } => format!("{reason}; {finding}"),
            Verdict::Pass | Verdict::NotJudged { .. } => finding,
        };
        self.verdict = Verdict::Fail { reason };
    }

    /// The same, with what it is told in another type.
    pub(crate) fn map<L>(self, of: impl FnOnce(K) -> L) -> Judged<L> {
        let Self { op, line, tool, time, duration, verdict, contact, kind } = self;
        Judged { op, line, tool, time, duration, verdict, contact, kind: of(kind) }
    }
}
