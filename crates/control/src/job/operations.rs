//! A program's operations, numbered in the order in which they come; what G51.2 leaves to the control is filled in.
use crate::polygon::cuts;
use crate::polygon::oscillation::Auto;
use canon::{Op, OpKind, ProgramFrame};
use diag::Diagnostic;
use std::collections::VecDeque;

/// Operations that are looked at ahead for where a polygon is cut.
const LOOK_AHEAD: usize = 1000;

/// Operations with their index.
pub struct Ops<'a> {
    read: interp::Ops<'a>,
    ahead: VecDeque<(Op, ProgramFrame)>,
    frame: ProgramFrame,
    auto: Auto<'a>,
    next: u32,
    prelude: std::vec::IntoIter<Op>,
}

impl<'a> Ops<'a> {
    /// Of a program.
    pub fn new(source: &'a [u8], setup: &'a interp::Setup, auto: Auto<'a>) -> Self {
        let read = interp::Ops::new(source, setup);
        Self {
            read,
            ahead: VecDeque::new(),
            frame: ProgramFrame::default(),
            auto,
            next: 0,
            prelude: Vec::new().into_iter(),
        }
    }

    /// The same, begun in the middle.
    pub fn begun_at(mut self, restart: Option<&crate::job::restart::Restart>) -> Self {
        if let Some(restart) = restart {
            for _ in 0..restart.skip {
                if let Some(op) = self.read.next() {
                    self.auto.see(&op.kind);
                }
            }
            self.prelude = restart.prelude.clone().into_iter();
        }
        self
    }

    /// What was found so far.
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        self.read.diagnostics().iter().chain(self.auto.findings()).cloned().collect()
    }

    /// How the program writes places and lengths where the operation stands that came last.
    pub const fn frame(&self) -> ProgramFrame {
        self.frame
    }

    fn read_next(&mut self) -> Option<(Op, ProgramFrame)> {
        let op = self.read.next()?;
        Some((op, self.read.frame()))
    }

    /// The operations after a polygon's beginning.
    fn look_ahead(&mut self) {
        while self.ahead.len() < LOOK_AHEAD {
            let Some(next) = self.read_next() else { return };
            self.ahead.push_back(next);
        }
    }
}

impl Iterator for Ops<'_> {
    type Item = (u32, Op);

    fn next(&mut self) -> Option<Self::Item> {
        // the prelude's are machine coordinates, which no block has written
        let prelude = self.prelude.next().map(|op| (op, self.frame));
        let (mut op, frame) =
            prelude.or_else(|| self.ahead.pop_front()).or_else(|| self.read_next())?;
        self.frame = frame;
        self.auto.see(&op.kind);
        if let OpKind::Polygon(polygon) = &mut op.kind {
            self.look_ahead();
            self.auto.fill(polygon, cuts::cut(self.ahead.iter().map(|(op, _)| op)), op.span);
        }
        let index = self.next;
        self.next += 1;
        Some((index, op))
    }
}
