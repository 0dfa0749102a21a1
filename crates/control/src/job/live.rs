//! A program whose text is interpreted while the machine executes it, because it asks the machine
//! something.
//!
//! ```text
//!   text ─► interp::Live ─► Live ─► planner ─► kernel
//!                 ▲                              │
//!                 └───────────── answer ◄────────┘
//! ```
//!
//! Before it runs, the whole program is interpreted with what is assumed of the machine's answers,
//! as every program is: so it is checked, timed and begun in its middle like any other.
use super::operations::{Left, Operations, Source};
use super::restart::Restart;
use canon::{Answer, Await, Op, OpKind, ProgramFrame};
use diag::Diagnostic;
use std::collections::VecDeque;
use std::sync::Arc;

/// See the module's header.
pub struct Live {
    read: interp::Live,
    /// The same program as it was checked.
    checked: Arc<Operations>,
    prelude: VecDeque<Op>,
    /// Operations that are left out yet.
    skip: usize,
    /// Place among the checked operations.
    at: usize,
    frame: ProgramFrame,
    next: u32,
    /// Indices of the operations that wait for an answer.
    asked: VecDeque<u32>,
    /// The end of typed blocks has been said.
    has_ended: bool,
}

impl Live {
    /// A program that has been checked, from its beginning or from its middle.
    pub fn of(
        read: interp::Live,
        checked: Arc<Operations>,
        restart: Option<&Restart>,
        first: u32,
    ) -> Self {
        Self {
            read,
            checked,
            prelude: restart.map_or_else(VecDeque::new, |r| r.prelude.iter().cloned().collect()),
            skip: restart.map_or(0, |restart| restart.skip),
            at: 0,
            frame: ProgramFrame::default(),
            next: first,
            asked: VecDeque::new(),
            has_ended: false,
        }
    }

    /// The next operation of the text, whatever is left out.
    fn read_next(&mut self) -> Option<Op> {
        let Some((mut op, frame)) = self.read.next_op() else { return self.end_of_typed() };
        self.frame = frame;
        if let OpKind::Polygon(_) = op.kind {
            // what it leaves to the control has been filled in
            let checked = self.checked.all().get(self.at).filter(|known| known.span == op.span);
            op = checked.cloned().unwrap_or(op);
        }
        self.at += 1;
        Some(op)
    }

    /// Blocks that are typed end without a word of their own.
    fn end_of_typed(&mut self) -> Option<Op> {
        let ends = self.checked.is_typed() && self.read.is_over() && !self.has_ended;
        self.has_ended |= ends;
        ends.then(Op::end_of_typed)
    }

    /// What is left out is taken to have been answered as the check has assumed.
    fn leave_out(&mut self) {
        while self.skip > 0 {
            self.skip -= 1;
            let Some(op) = self.read_next() else { return };
            if let Some(answer) = assumed(&op.kind) {
                self.read.answer(&answer);
            }
        }
    }
}

/// What the check assumes that the machine answers.
fn assumed(kind: &OpKind) -> Option<Answer> {
    match kind {
        OpKind::Input(wait) => {
            let on = matches!(wait.until, Await::Rise | Await::On);
            Some(Answer::Input(Some(f64::from(u8::from(on)))))
        }
        OpKind::Probe(probe) => {
            Some(Answer::Probe { contact: probe.to, stands: probe.to, changed: true })
        }
        _ => None,
    }
}

impl Source for Live {
    fn frame(&self) -> ProgramFrame {
        self.frame
    }

    fn findings(&self) -> Vec<Diagnostic> {
        self.read.findings()
    }

    fn is_live(&self) -> bool {
        true
    }

    fn next_number(&self) -> u32 {
        self.next
    }

    fn answer(&mut self, op: u32, answer: &Answer) {
        if self.asked.front() == Some(&op) {
            self.asked.pop_front();
            self.read.answer(answer);
        }
    }

    fn left(&self) -> Option<Left> {
        let known = self.read.tools().into_iter().filter(|(tool, _)| !tool.stand_in);
        let parameters = self.read.parameters()?.clone();
        Some(Left { parameters, tools: known.collect(), rest: self.read.rest() })
    }
}

impl Iterator for Live {
    type Item = (u32, Op);

    fn next(&mut self) -> Option<(u32, Op)> {
        let op = if let Some(op) = self.prelude.pop_front() {
            op
        } else {
            self.leave_out();
            self.read_next()?
        };
        let index = self.next;
        self.next += 1;
        if interp::asks(&op.kind) {
            self.asked.push_back(index);
        }
        Some((index, op))
    }
}
