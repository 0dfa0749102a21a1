//! A program that is loaded, and one that is under way: where it is, and what is left of it.
use super::proof::Proof;
use super::timeline::Timeline;
use super::tool_path::ToolPath;
use crate::job::preflight::Proved;
use crate::job::restart::{self, Restart};
use crate::job::{Operations, Session};
use crate::{Executor, Running};
use canon::{OpKind, Position};
use std::path::PathBuf;
use std::sync::Arc;
use store::output::Folder;
use sync::recovery::Stored;
use units::{Coordinate, Length, Time};
use verify::Feature;

/// A program that is loaded.
pub(super) struct Loaded {
    pub(super) path: PathBuf,
    /// How it is read.
    pub(super) dialect: interp::Dialect,
    pub(super) name: String,
    /// Proved for what was so when it was loaded, or for what is so since; `None`: not yet.
    pub(super) proof: Option<Proof>,
    /// It is made from more than its text, which may change until it is started.
    pub(super) reads_files: bool,
    /// Where the next start begins, if not at the beginning.
    pub(super) from: Option<Searched>,
    /// Planned time from start to end; `None`: not known yet.
    pub(super) planned: Option<Time>,
    /// What a picture of it shows.
    pub(super) shown: Arc<LoadedProgram>,
}

/// A place in a program from which it is to be begun.
#[derive(Clone)]
pub(super) struct Searched {
    pub(super) from: restart::From,
    /// SHA-256 of the texts in which it was found.
    pub(super) sha256: String,
    /// Texts that were changed since the program was left were compared.
    pub(super) is_confirmed: bool,
}

/// A program that is loaded, for a client that shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedProgram {
    /// Its name.
    pub name: String,
    /// Its text.
    pub text: Vec<u8>,
    /// The way of the tool, as it was when the program was loaded.
    pub path: ToolPath,
}

/// A program, or blocks that were typed, from the start to the end.
pub(super) struct UnderWay {
    pub(super) running: Running,
    pub(super) name: String,
    pub(super) path: PathBuf,
    pub(super) session: Session,
    pub(super) text: Vec<u8>,
    pub(super) proved: Proved,
    /// What is recorded of it.
    pub(super) folder: Option<Folder>,
    /// `None`: not known yet.
    pub(super) timeline: Option<Timeline>,
    /// The operation that is executed, and since when.
    pub(super) executed: (u32, Time),
    /// Number of its first operation, and how many of its own were left out before it.
    pub(super) first: u32,
    pub(super) restart: Option<Restart>,
    /// A stop has given it up, and what moves comes to rest.
    pub(super) is_given_up: bool,
}

impl UnderWay {
    /// Its own operation, counted from 0, that the machine's number stands for.
    pub(super) fn own(&self, op: u32) -> usize {
        let from_start = op.saturating_sub(self.first) as usize;
        match &self.restart {
            None => from_start,
            Some(restart) => restart.skip + from_start.saturating_sub(restart.prelude.len()),
        }
    }

    /// A period is over.
    pub(super) fn follow(&mut self, executor: &Executor) {
        let op = executor.kernel.report().op;
        if self.executed.0 != op {
            self.executed = (op, executor.machine.feedback().time);
        }
    }

    /// Planned time of what is left of it, if it is known.
    pub(super) fn left(&self, now: Time) -> Option<Time> {
        let (op, since) = self.executed;
        let own = u32::try_from(self.own(op)).unwrap_or(u32::MAX);
        self.timeline.as_ref().map(|timeline| timeline.left(own, now - since))
    }

    /// Codes in force.
    pub(super) fn codes(&self) -> Vec<String> {
        self.proved.operations.codes_at(self.own(self.executed.0))
    }

    /// Where the operation that is executed leads the axes; of a tap, its bottom. `None`: it moves
    /// nothing, or that shows only when the machine has answered.
    pub(super) fn goal(&self) -> Option<Position> {
        if self.running.is_live() {
            return None;
        }
        match &self.proved.operations.all().get(self.own(self.executed.0))?.kind {
            OpKind::Rapid { to }
            | OpKind::Line { to, .. }
            | OpKind::Arc { to, .. }
            | OpKind::Spline { to, .. } => Some(*to),
            OpKind::Threading(thread) => Some(thread.to),
            OpKind::Tap(tap) => Some(tap.start.with(tap.axis, Coordinate::linear(tap.bottom))),
            _ => None,
        }
    }

    /// What it leaves where it was given up.
    pub(super) fn left_at(&self, op: u32) -> crate::job::Left {
        let setup = self.session.interp_setup();
        Operations::left_at(self.session.before.clone(), &self.text, &setup, self.own(op))
    }
}

/// Features from this operation on: those before are another program's, or an earlier run's.
pub(super) fn count_from(first: u32, features: &[Feature]) -> u32 {
    features.iter().filter(|feature| feature.op >= first).count() as u32
}

/// What ties a tool to the work, from when a recovery begins: the kernel forgets it then.
#[derive(Clone, Copy)]
pub(super) enum InWork {
    /// A tap on its thread, and the surface of the work.
    Tap(Stored, Length),
    /// A tool with a way off the work.
    Tool(motion::WayOut),
}
