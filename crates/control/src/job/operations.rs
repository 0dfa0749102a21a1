//! A program's operations, numbered in the order in which they come; what G51.2 leaves to the
//! control is filled in.
//!
//! ```text
//!   text ─► interp ─┬─► Reading      one after the other, nothing is kept: check, time
//!                   └─► Operations   all of them, interpreted once: preflight, restart and run share them
//!                            └─► Cursor  from the beginning, or from where a program is begun in its middle
//! ```
use super::interruption::Interruption;
use super::live::Live;
use super::restart::Restart;
use crate::polygon::cuts;
use crate::polygon::oscillation::Auto;
use canon::{Answer, Op, OpKind, ProgramFrame, Tool};
use diag::Diagnostic;
use interp::{CodesInForce, OpsRest, Parameters, ToolEntry};
use std::collections::VecDeque;
use std::sync::Arc;
use units::Spin;

/// Operations that are looked at ahead for where a polygon is cut.
const LOOK_AHEAD: usize = 1000;

/// Operations with their index, and how the program writes places and lengths where the one stands
/// that came last.
pub trait Source: Iterator<Item = (u32, Op)> {
    /// Frame and units of the operation that came last.
    fn frame(&self) -> ProgramFrame;
    /// What the interpreter has found so far.
    fn findings(&self) -> Vec<Diagnostic>;
    /// It is interpreted while the machine executes: when it ends, it may wait for an answer, and
    /// what it orders has not been checked as it is.
    fn is_live(&self) -> bool {
        false
    }
    /// What the machine says to an operation that has asked.
    fn answer(&mut self, _op: u32, _answer: &Answer) {}
    /// The number of the operation that comes next.
    fn next_number(&self) -> u32 {
        0
    }
    /// What the program has left behind so far, where that is known only when it runs.
    fn left(&self) -> Option<Left> {
        None
    }
}

/// A program that is interpreted as it is read.
pub struct Reading<'a> {
    read: interp::Ops<'a>,
    ahead: VecDeque<(Op, ProgramFrame)>,
    frame: ProgramFrame,
    auto: Auto<'a>,
    next: u32,
}

impl<'a> Reading<'a> {
    /// Of a program.
    pub fn new(source: &'a [u8], setup: &'a interp::Setup, auto: Auto<'a>) -> Self {
        let (ahead, frame) = (VecDeque::new(), ProgramFrame::default());
        Self { read: interp::Ops::new(source, setup), ahead, frame, auto, next: 0 }
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

impl Source for Reading<'_> {
    fn frame(&self) -> ProgramFrame {
        self.frame
    }

    fn findings(&self) -> Vec<Diagnostic> {
        self.read.diagnostics().iter().chain(self.auto.findings()).cloned().collect()
    }
}

impl Iterator for Reading<'_> {
    type Item = (u32, Op);

    fn next(&mut self) -> Option<(u32, Op)> {
        let (mut op, frame) = self.ahead.pop_front().or_else(|| self.read_next())?;
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

/// A whole program, interpreted once.
#[derive(Default)]
pub struct Operations {
    ops: Vec<Op>,
    /// Each frame, with the operation from which on it holds.
    frames: Vec<(usize, ProgramFrame)>,
    /// Codes in force, with the operation from which on they are; only on a control that is on.
    codes: Vec<(usize, CodesInForce)>,
    findings: Vec<Diagnostic>,
    /// Tools that the program calls and the table lacks.
    stand_ins: Vec<Tool>,
    /// What the program leaves behind.
    left: Left,
    /// The program asks the machine something: its text, and what it is read with.
    live: Option<Box<Asking>>,
    is_typed: bool,
}

/// Operations between two looks whether the rest is wanted.
const LOOKED_AT: usize = 1024;

/// Share of the text up to an operation.
pub(super) fn share_read(op: &Op, source: &[u8]) -> f64 {
    if op.span.file == 0 { f64::from(op.span.end) / source.len().max(1) as f64 } else { 0.0 }
}

/// A program that asks the machine something: its text, what it is read with, and what it finds in
/// force.
type Asking = (Vec<u8>, interp::Setup, Option<OpsRest>);

/// What a text finds in the control when it begins.
#[derive(Clone, Default)]
pub struct Before {
    /// What a text before it has left in force; `None`: the control was switched on just now.
    pub rest: Option<OpsRest>,
    /// It is typed: it ends without M2, its modes stay in force, and spindles turn on.
    pub is_typed: bool,
    /// The programmed speeds at which spindles turn already.
    pub turning: [Spin; bus::SPINDLES],
}

/// What a program leaves in the control when it has ended.
#[derive(Clone, Default)]
pub struct Left {
    /// The numbered parameters.
    pub parameters: Parameters,
    /// The tools that are in the table, each with what the control believes of it.
    pub tools: Vec<(Tool, ToolEntry)>,
    /// What is in force.
    pub rest: Option<OpsRest>,
}

impl Operations {
    /// Interpret a program.
    pub fn of(source: &[u8], setup: &interp::Setup) -> Self {
        Self::after(Before::default(), source, setup, &Interruption::default())
    }

    /// Interpret a text on a control that is on, as far as that is wanted.
    pub fn after(
        before: Before,
        source: &[u8],
        setup: &interp::Setup,
        interruption: &Interruption,
    ) -> Self {
        let Before { rest, is_typed, .. } = before;
        let again = rest.clone();
        let mut read = interp::Ops::of_piece(source, setup, rest, is_typed);
        let (mut ops, mut frames) = (Vec::new(), Vec::<(usize, ProgramFrame)>::new());
        let mut codes: Vec<(usize, CodesInForce)> = Vec::new();
        while let Some(op) = read.next() {
            let frame = read.frame();
            if frames.last().is_none_or(|(_, last)| *last != frame) {
                frames.push((ops.len(), frame));
            }
            if again.is_some() {
                let in_force = read.codes();
                if codes.last().is_none_or(|(_, last)| *last != in_force) {
                    codes.push((ops.len(), in_force));
                }
            }
            let share = share_read(&op, source) / 2.0;
            ops.push(op);
            if ops.len() % LOOKED_AT == 0 && interruption.came_at(share) {
                break; // who reads on breaks off, too
            }
        }
        if is_typed {
            ops.push(Op::end_of_typed());
        }
        let (stand_ins, known): (Vec<Tool>, Vec<Tool>) =
            read.tools().iter().cloned().partition(|tool| tool.stand_in);
        let entry = |tool: Tool| {
            let entry = read.tool_entry(tool.number);
            (tool, entry)
        };
        let mut left = Left {
            tools: known.into_iter().map(entry).collect(),
            parameters: read.parameters().clone(),
            rest: None,
        };
        let asks = ops.iter().any(|op| interp::asks(&op.kind));
        let live = asks.then(|| Box::new((source.to_vec(), setup.clone(), again)));
        let findings = read.diagnostics();
        left.rest = Some(read.rest());
        Self { ops, frames, codes, findings, stand_ins, left, live, is_typed }
    }

    /// The codes in force at the operation with this number, counted from 0. None are known of a
    /// program that asks the machine something: what it executes shows only then.
    pub fn codes_at(&self, op: usize) -> Vec<String> {
        let next = self.codes.partition_point(|(from, _)| *from <= op);
        let known = next.checked_sub(1).filter(|_| self.live.is_none());
        known.map_or_else(Vec::new, |at| self.codes[at].1.written())
    }

    /// What a text leaves in the control when it is given up at the operation with this number,
    /// counted from 0.
    pub fn left_at(before: Before, source: &[u8], setup: &interp::Setup, op: usize) -> Left {
        let mut read = interp::Ops::of_piece(source, setup, before.rest, before.is_typed);
        for _ in read.by_ref().take(op + 1) {}
        let parameters = read.parameters().clone();
        Left { parameters, tools: Vec::new(), rest: Some(read.rest()) }
    }

    /// Fill in what G51.2 leaves to the control.
    pub fn fill(&mut self, mut auto: Auto<'_>) {
        for at in 0..self.ops.len() {
            let (before, after) = self.ops.split_at_mut(at + 1);
            let Some(op) = before.last_mut() else { continue };
            auto.see(&op.kind);
            if let OpKind::Polygon(polygon) = &mut op.kind {
                auto.fill(polygon, cuts::cut(after.iter().take(LOOK_AHEAD)), op.span);
            }
        }
        self.findings.extend_from_slice(auto.findings());
    }

    /// For a run, from the program's beginning or from its middle: what asks the machine something
    /// is interpreted again while the machine executes.
    ///
    /// They are numbered from `first` on: those of what was done on the machine before come first.
    pub fn for_run(
        self: &Arc<Self>,
        restart: Option<&Restart>,
        first: u32,
    ) -> Box<dyn Source + Send> {
        match self.live.as_deref() {
            None => Box::new(Cursor::new(Arc::clone(self), restart).numbered_from(first)),
            Some((text, setup, rest)) => {
                let (text, setup, rest) = (text.clone(), setup.clone(), rest.clone());
                let read = if self.is_typed {
                    interp::Live::of_blocks(text, setup, rest)
                } else {
                    interp::Live::new(text, setup, rest)
                };
                Box::new(Live::of(read, Arc::clone(self), restart, first))
            }
        }
    }

    /// The first `count` of them, less what cannot have left anything in the work: nothing waits
    /// for an operator.
    #[must_use]
    pub fn that_cut_before(&self, count: usize) -> Self {
        let mut before = Self::default();
        for (at, op) in self.ops.iter().enumerate().take(count) {
            let leaves = !matches!(
                op.kind,
                OpKind::Dwell { .. }
                    | OpKind::Pause { .. }
                    | OpKind::Message(_)
                    | OpKind::Input(_)
                    | OpKind::Probe(_)
                    | OpKind::Output(_)
                    | OpKind::UserCode(_)
                    | OpKind::Coolant { .. }
            );
            if leaves {
                let frame = self.frame_of(at);
                if before.frames.last().is_none_or(|(_, last)| *last != frame) {
                    before.frames.push((before.ops.len(), frame));
                }
                before.ops.push(op.clone());
            }
        }
        let span = self.ops.get(count).map_or_else(Default::default, |op| op.span);
        before.ops.push(Op { span, kind: OpKind::End });
        before
    }

    /// They are of blocks that were typed.
    pub const fn is_typed(&self) -> bool {
        self.is_typed
    }

    /// All of them.
    pub fn all(&self) -> &[Op] {
        &self.ops
    }

    /// Tools that the program calls and the table lacks.
    pub fn stand_ins(&self) -> &[Tool] {
        &self.stand_ins
    }

    /// What the program leaves behind.
    pub const fn left(&self) -> &Left {
        &self.left
    }

    fn frame_of(&self, at: usize) -> ProgramFrame {
        let after = self.frames.partition_point(|(from, _)| *from <= at);
        after.checked_sub(1).and_then(|last| self.frames.get(last)).map(|f| f.1).unwrap_or_default()
    }
}

/// Goes through a program that was interpreted.
pub struct Cursor {
    operations: Arc<Operations>,
    prelude: VecDeque<Op>,
    at: usize,
    frame: ProgramFrame,
    next: u32,
}

impl Cursor {
    /// From the program's beginning, or from where it is begun in its middle.
    pub fn new(operations: Arc<Operations>, restart: Option<&Restart>) -> Self {
        let at = restart.map_or(0, |restart| restart.skip);
        let prelude = restart.map_or_else(VecDeque::new, |r| r.prelude.iter().cloned().collect());
        Self { operations, prelude, at, frame: ProgramFrame::default(), next: 0 }
    }

    /// The same, its operations numbered from this one on: those of what was executed on the
    /// machine before come first.
    #[must_use]
    pub const fn numbered_from(mut self, first: u32) -> Self {
        self.next = first;
        self
    }
}

impl Source for Cursor {
    fn frame(&self) -> ProgramFrame {
        self.frame
    }

    fn findings(&self) -> Vec<Diagnostic> {
        self.operations.findings.clone()
    }

    fn next_number(&self) -> u32 {
        self.next
    }
}

impl Iterator for Cursor {
    type Item = (u32, Op);

    fn next(&mut self) -> Option<(u32, Op)> {
        // the prelude's are machine coordinates, which no block has written
        let op = if let Some(op) = self.prelude.pop_front() {
            op
        } else {
            let op = self.operations.ops.get(self.at)?.clone();
            self.frame = self.operations.frame_of(self.at);
            self.at += 1;
            op
        };
        let index = self.next;
        self.next += 1;
        Some((index, op))
    }
}
